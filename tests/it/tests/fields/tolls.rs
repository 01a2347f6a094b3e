//! Fields with tolls, compared with a slow reference, packed, read back and proved.

use super::{cells, corners, legal, maps};
use controller::State;
use maps::Bitmap;
use plan_compiler::field::{self, Field};
use plan_compiler::layers::Limits;
use plan_compiler::pack::pack_with_limits;
use plan_compiler::search::{Corners, MAX_COST, Method, Query, Solver, Vectors, is_cut_short};
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::Tolls;
use plan_compiler::verify::verify;
use plan_format::mission::MissionDraft;
use plan_format::{
    Answer, Blob, Cell, Direction, Draft, Grid, Layer, LayerDraft, Origin, Parameters, PlanDraft,
    Step, write,
};
use proptest::prelude::*;
use robot_io::{Fix, Operator, Percepts};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Costs from every cell to the goal in eighths of a unit, by a plain Dijkstra search with a heap. A
/// step costs by the cell that it leaves.
fn dijkstra(blocked: &Bitmap, tolls: &Tolls, goal: Cell, corners: Corners) -> Vec<Option<u64>> {
    let (columns, rows) = (blocked.columns(), blocked.rows());
    let index = |cell: Cell| (cell.row * columns + cell.column) as usize;
    let mut costs = vec![None; (columns * rows) as usize];
    let mut queue = BinaryHeap::new();
    if goal.column < columns && goal.row < rows && !blocked.get(goal) {
        queue.push(Reverse((0u64, goal)));
    }
    while let Some(Reverse((cost, cell))) = queue.pop() {
        if costs[index(cell)].is_some() {
            continue;
        }
        costs[index(cell)] = Some(cost);
        for direction in Direction::ALL {
            if let Some(from) = legal(blocked, corners, cell, direction) {
                let step = u64::from(direction.step_cost()) * u64::from(tolls.eighths(from));
                queue.push(Reverse((cost + step, from)));
            }
        }
    }
    costs
}

/// Compares a field with the reference, cell by cell.
fn assert_right(blocked: &Bitmap, tolls: &Tolls, goal: Cell, corners: Corners, field: &Field) {
    let size = (blocked.columns(), blocked.rows());
    let index = |cell: Cell| (cell.row * size.0 + cell.column) as usize;
    let expected = dijkstra(blocked, tolls, goal, corners);
    let shift = 3 - field.unit.expect("tolls");
    for cell in cells(size) {
        let (cost, code) = (field.cost[index(cell)], field.code[index(cell)]);
        let here = expected[index(cell)];
        let in_eighths = (cost != field::UNREACHED).then(|| u64::from(cost) << shift);
        assert_eq!(in_eighths, here, "{cell:?}");
        assert_eq!(field::is_blocked(code), blocked.get(cell), "{cell:?}");
        if blocked.get(cell) {
            continue;
        }
        let toll = u64::from(tolls.eighths(cell));
        let best: Vec<Direction> = Direction::ALL
            .into_iter()
            .filter(|&direction| {
                let to = legal(blocked, corners, cell, direction);
                let rest = to.and_then(|to| expected[index(to)]);
                rest.is_some_and(|r| Some(r + u64::from(direction.step_cost()) * toll) == here)
            })
            .collect();
        match field::advised(code) {
            Some(direction) => {
                assert!(best.contains(&direction), "{cell:?} {direction:?}");
                let has_diagonal = best.iter().any(|direction| direction.is_diagonal());
                assert_eq!(direction.is_diagonal(), has_diagonal, "{cell:?} {direction:?}");
            }
            None => assert!(best.is_empty(), "{cell:?} {code}"),
        }
    }
}

/// Factors of several textures: areas with few factors, noise of any factors, or rings around the
/// obstacles.
fn tolls() -> impl Strategy<Value = (u8, Vec<u32>, u64)> {
    let factor = prop_oneof![Just(8u32), Just(12), Just(16), Just(24), 8u32..=256];
    (0u8..3, prop::collection::vec(factor, 1..20), any::<u64>())
}

fn tolls_on(map: &Bitmap, (texture, factors, seed): (u8, Vec<u32>, u64)) -> Tolls {
    let mut state = seed | 1;
    let mut next = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 20) as usize
    };
    Tolls::from_fn(map.columns(), map.rows(), |cell| match texture {
        0 => {
            let area = (cell.column / 13 * 7 + cell.row / 9 * 3) as usize;
            factors[area % factors.len()]
        }
        1 => factors[next() % factors.len()],
        _ => {
            let near = |radius: u32| {
                let (west, south) =
                    (cell.column.saturating_sub(radius), cell.row.saturating_sub(radius));
                (south..=cell.row + radius).any(|row| {
                    (west..=cell.column + radius).any(|column| {
                        column < map.columns()
                            && row < map.rows()
                            && map.get(Cell::new(column, row))
                    })
                })
            };
            (1..=3)
                .find(|&radius| near(radius))
                .map_or(8, |radius| factors[radius as usize % factors.len()])
        }
    })
}

fn solve(blocked: &Bitmap, tolls: &Tolls, goal: Cell, corners: Corners) -> Option<Field> {
    let terrain = Terrain::new(blocked.clone()).with_tolls(tolls.clone());
    terrain.tolls.as_ref()?;
    let query = Query { terrain: &terrain, goals: &[goal], corners };
    let field = Solver::new().solve(&query);
    assert!(!is_cut_short(&query, &field));
    for method in [Method::Tiles, Method::Buckets] {
        for vectors in Vectors::all() {
            let other = Solver::with_method(method).with_vectors(vectors).solve(&query);
            assert!(other == field, "{method:?} with {} differs", vectors.name());
        }
    }
    Some(field)
}

/// The blob of a field, whose goal is a cell of a grid of 1 m.
fn blob(field: &Field, limits: &Limits, goal: Cell) -> Vec<u8> {
    write(&draft_of(field, limits, goal)).unwrap()
}

fn draft_of(field: &Field, limits: &Limits, goal: Cell) -> Draft {
    let packed = pack_with_limits(field, limits);
    let (columns, rows) = (field.columns, field.rows);
    Draft {
        grid: Grid { columns, rows, resolution_m: 1.0, corner_m: [0.0, 0.0] },
        origin: None,
        parameters: Parameters::default(),
        plans: vec![PlanDraft {
            name: "goal".into(),
            goals_m: vec![[f64::from(goal.column) + 0.5, f64::from(goal.row) + 0.5]],
            layers: vec![LayerDraft { name: "physical".into(), rank: 0, packed }],
        }],
        mission: MissionDraft::default(),
    }
}

/// Compares every look-up with the field, but for the choice that the advice rule leaves.
fn assert_reads(field: &Field, layer: &Layer<'_>) {
    for (index, (&cost, &code)) in field.cost.iter().zip(&field.code).enumerate() {
        let cell = Cell::new(index as u32 % field.columns, index as u32 / field.columns);
        let (answer, step) = (layer.look_up_exact(cell), layer.step(cell));
        match (answer, step) {
            (Answer::Move { direction, cost: read }, Step::Move(same)) => {
                assert_eq!((read, direction), (cost, same), "{cell:?}");
                let given = field::advised(code).expect("a move");
                assert_eq!(direction.is_diagonal(), given.is_diagonal(), "{cell:?}");
            }
            (Answer::Goal, Step::Goal) => assert_eq!(code, field::GOAL, "{cell:?}"),
            (Answer::NoRoute, Step::NoRoute) => assert_eq!(code, field::NO_ROUTE, "{cell:?}"),
            (Answer::Blocked { escape }, Step::Blocked { escape: same }) => {
                assert_eq!((escape, escape), (field::escape(code), same), "{cell:?}");
            }
            other => panic!("{cell:?} {other:?}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn fields_with_tolls_are_exact_and_packed_without_loss(
        map in maps(100), corners in corners(), column in 0u32..100, row in 0u32..100,
        texture in tolls(),
    ) {
        let tolls = tolls_on(&map, texture);
        let goal = Cell::new(column, row);
        let Some(field) = solve(&map, &tolls, goal, corners) else { return Ok(()) };
        assert_right(&map, &tolls, goal, corners, &field);
        let inside = column < map.columns() && row < map.rows() && !map.get(goal);
        let goal = if inside { goal } else { Cell::new(0, 0) };
        let bytes = blob(&field, &Limits::default(), goal);
        let blob = Blob::parse(&bytes).unwrap();
        let layer = blob.parallel_plan(0).unwrap().layer(0).unwrap();
        assert_reads(&field, &layer);
        // 400 bytes for the fixed parts of the planes, which dominate on small maps.
        let most = layer.raw_bytes() + 400;
        prop_assert!(layer.bytes() <= most, "{} of {most} bytes", layer.bytes());
        if inside {
            let report = verify(&blob, &|_, _| ());
            prop_assert!(report.count == 0, "{:?}", report.violations);
        }
    }
}

/// Fields that no search would produce: any code with any cost, in any unit.
fn fields() -> impl Strategy<Value = Field> {
    let costs = prop_oneof![0..100_000u32, any::<u32>(), (0..40u32).prop_map(|steps| steps * 5741)];
    let codes = prop_oneof![0..=field::NO_ESCAPE, field::ESCAPE..field::ESCAPE + 8];
    (1..40u32, 1..40u32, 0u8..4).prop_flat_map(move |(columns, rows, unit)| {
        let cells = (columns * rows) as usize;
        let cost = prop::collection::vec(costs.clone(), cells);
        let code = prop::collection::vec(codes.clone(), cells);
        (cost, code).prop_map(move |(cost, code)| Field {
            columns,
            rows,
            unit: Some(unit),
            cost,
            code,
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..Default::default() })]

    #[test]
    fn layers_with_tolls_answer_as_fields_that_contradict_themselves(field in fields()) {
        let bytes = blob(&field, &Limits::default(), Cell::new(0, 0));
        let layer = Blob::parse(&bytes).unwrap().parallel_plan(0).unwrap().layer(0).unwrap();
        for (index, (&cost, &code)) in field.cost.iter().zip(&field.code).enumerate() {
            let cell = Cell::new(index as u32 % field.columns, index as u32 / field.columns);
            let expected = match code {
                0..field::MOVES => Answer::Move { direction: Direction::from_code(code), cost },
                field::GOAL => Answer::Goal,
                field::NO_ROUTE => Answer::NoRoute,
                code => Answer::Blocked { escape: field::escape(code) },
            };
            prop_assert_eq!(layer.look_up_exact(cell), expected);
        }
    }
}

#[test]
fn a_step_costs_by_the_cell_that_it_leaves() {
    // Two cells of toll 4 between a start in the west and the goal in the east.
    let tolls = Tolls::from_fn(5, 1, |cell| if (1..3).contains(&cell.column) { 32 } else { 8 });
    let field = solve(&Bitmap::new(5, 1), &tolls, Cell::new(4, 0), Corners::Forbid).unwrap();
    assert_eq!(field.unit, Some(0));
    assert_eq!(field.cost, [10, 9, 5, 1, 0].map(|steps| steps * 5741));
    assert_eq!(field.multiplier(Cell::new(2, 0)), Some(4));
    assert_eq!(field.multiplier(Cell::new(4, 0)), None);
}

#[test]
fn routes_that_cost_too_much_are_reported() {
    let (columns, rows) = (2_000, 30);
    let tolls = Tolls::from_fn(columns, rows, |cell| if cell.row > 25 { 255 } else { 256 });
    let map = Bitmap::new(columns, rows);
    let terrain = Terrain::new(map.clone()).with_tolls(tolls);
    let goal = Cell::new(0, 0);
    let query = Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid };
    let field = Solver::new().solve(&query);
    assert!(!is_cut_short(&query, &field));
    // Eighths of the factors, so a unit of an eighth: 2,741 cells of factor 32 are the most.
    let tolls = Tolls::from_fn(3_000, 2, |cell| if cell.column == 7 { 9 } else { 256 });
    let terrain = Terrain::new(Bitmap::new(3_000, 2)).with_tolls(tolls);
    let query = Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid };
    let field = Solver::new().solve(&query);
    assert!(is_cut_short(&query, &field));
    let farthest = field.cost.iter().filter(|&&cost| cost != field::UNREACHED).max();
    assert!(*farthest.unwrap() > MAX_COST - 8119 * 256);
}

#[test]
fn limits_are_read_in_every_cell() {
    let zone = |low: u32, high: u32| {
        Bitmap::from_fn(70, 40, |cell| (low..high).contains(&(cell.column + cell.row)))
    };
    let mut limits = Limits::default();
    limits.lower(&zone(10, 50), 1.5);
    limits.lower(&zone(30, 60), 0.25);
    for step in 0..13 {
        limits.lower(&zone(61 + step, 62 + step), 2.0 + f64::from(step));
    }
    let field = Solver::new().solve(&Query {
        terrain: &Terrain::new(Bitmap::new(70, 40)),
        goals: &[Cell::new(3, 3)],
        corners: Corners::Forbid,
    });
    let bytes = blob(&field, &limits, Cell::new(3, 3));
    let layer = Blob::parse(&bytes).unwrap().parallel_plan(0).unwrap().layer(0).unwrap();
    let mut limited = 0;
    for cell in cells((70, 40)) {
        let expected = limits.at(cell).map(|limit| f32::from(limit) / 100.0);
        assert_eq!(layer.speed_limit(cell), expected, "{cell:?}");
        limited += usize::from(expected.is_some());
    }
    assert!(limited > 1_000);
    assert_eq!(layer.speed_limit(Cell::new(40, 10)), Some(0.25));
    assert_eq!(layer.speed_limit(Cell::new(70, 10)), None);
    for (index, &cost) in field.cost.iter().enumerate().filter(|&(_, &cost)| cost > 0) {
        let cell = Cell::new(index as u32 % 70, index as u32 / 70);
        assert!(matches!(layer.look_up(cell), Answer::Move { cost: read, .. } if read == cost));
    }
}

/// The speeds that the controller commands a robot that drives east over open ground, by its x, m.
fn commanded_speeds(limits: &Limits) -> Vec<(f32, f32)> {
    let goal = Cell::new(60, 10);
    let terrain = Terrain::new(Bitmap::new(70, 20));
    let field =
        Solver::new().solve(&Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid });
    let mut draft = draft_of(&field, limits, goal);
    let place = math::GeoPoint { lat_e7: 510_000_000, lon_e7: 70_000_000 };
    draft.origin = Some(Origin { place, at_m: [0.0, 0.0], heading_rad: 0.0 });
    let bytes = write(&draft).unwrap();
    let blob = Blob::parse(&bytes).unwrap();
    let frame = blob.map_frame().expect("an origin");
    let mut state = State::new(&blob);
    let mut speeds = Vec::new();
    for tick in 1..=400u64 {
        let (time_us, x) = (tick * 50_000, 5.0 + tick as f32 * 0.05);
        let fix = Fix {
            time_us,
            is_valid: true,
            place: frame.to_geodetic(math::Vec2::new(x, 10.5)),
            accuracy_mm: 100,
            velocity_mmps: Some([1_000, 0]),
            receiver_ms: Some(tick as u32 * 50),
        };
        let operator = Operator { is_armed: true, ..Operator::default() };
        let heading_rad = Some(0.0);
        let percepts =
            Percepts { time_us, fix: Some(fix), heading_rad, operator, ..Percepts::default() };
        speeds.push((x, controller::tick(&blob, &mut state, &percepts).speed_mps));
    }
    speeds
}

#[test]
fn the_robot_obeys_a_speed_zone_while_it_is_inside() {
    let mut limits = Limits::default();
    limits.lower(&Bitmap::from_fn(70, 20, |cell| (12..18).contains(&cell.column)), 0.4);
    let speeds = commanded_speeds(&limits);
    let fastest = |range: std::ops::Range<f32>| {
        let inside = speeds.iter().filter(|(x, _)| range.contains(x));
        inside.map(|&(_, speed)| speed).fold(0.0, f32::max)
    };
    assert!(fastest(7.0..11.8) > 1.0, "{}", fastest(7.0..11.8));
    assert!((0.3..=0.4).contains(&fastest(12.2..17.8)), "{}", fastest(12.2..17.8));
    assert!(fastest(18.2..24.0) > 1.0, "{}", fastest(18.2..24.0));
}
