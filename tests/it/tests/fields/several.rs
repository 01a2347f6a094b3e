//! Fields of several goals: compared with the fields of each goal alone, packed, read back, followed
//! cell by cell, and proved.

use super::{corners, maps};
use maps::Bitmap;
use plan_compiler::field::{self, Field};
use plan_compiler::pack::{Numbered, pack, with_goals};
use plan_compiler::search::{Corners, Method, Query, Solver, Vectors};
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::Tolls;
use plan_compiler::verify::{Report, verify};
use plan_format::mission::MissionDraft;
use plan_format::{
    Answer, Blob, Cell, Draft, Grid, Layer, LayerDraft, Parameters, PlanDraft, limits, write,
};
use proptest::prelude::*;

/// The field of some goals by every method and vector unit, which must agree.
fn solve(terrain: &Terrain, goals: &[Cell], corners: Corners) -> Field {
    let query = Query { terrain, goals, corners };
    let field = Solver::new().solve(&query);
    for method in [Method::Tiles, Method::Buckets] {
        for vectors in Vectors::all() {
            let other = Solver::with_method(method).with_vectors(vectors).solve(&query);
            assert!(other == field, "{method:?} with {} differs", vectors.name());
        }
    }
    field
}

/// The goals that are on the map and free, with their numbers.
fn ends(terrain: &Terrain, goals: &[Cell]) -> Vec<Numbered> {
    (0..).zip(goals.iter().copied()).filter(|&(_, cell)| terrain.is_free(cell)).collect()
}

/// A blob with one plan to several goals on a grid of 1 m; at least one goal is on it.
fn blob(field: &Field, terrain: &Terrain, goals: &[Cell]) -> Vec<u8> {
    let packed = with_goals(pack(field), &ends(terrain, goals)).unwrap();
    let centre = |cell: &Cell| [f64::from(cell.column) + 0.5, f64::from(cell.row) + 0.5];
    let (columns, rows) = (field.columns, field.rows);
    write(&Draft {
        grid: Grid { columns, rows, resolution_m: 1.0, corner_m: [0.0, 0.0] },
        origin: None,
        parameters: Parameters::default(),
        plans: vec![PlanDraft {
            name: "fuel".into(),
            goals_m: goals.iter().map(centre).collect(),
            layers: vec![LayerDraft { name: "physical".into(), rank: 0, packed }],
        }],
        mission: MissionDraft::default(),
    })
    .unwrap()
}

/// The cell at the end of the advice from a cell with a route, step by step.
fn followed(layer: &Layer<'_>, field: &Field, from: Cell) -> Cell {
    let mut cell = from;
    for _ in 0..=field.cost.len() {
        match layer.look_up(cell) {
            Answer::Move { direction, .. } => {
                cell = cell.neighbour(direction, field.columns, field.rows).expect("on the map");
            }
            Answer::Goal => return cell,
            other => panic!("{cell:?} {other:?}"),
        }
    }
    panic!("the advice from {from:?} leads nowhere");
}

fn tolls() -> impl Strategy<Value = Option<Vec<u32>>> {
    let factor = prop_oneof![Just(8u32), Just(16), 8u32..=256];
    prop::option::of(prop::collection::vec(factor, 1..9))
}

/// Areas of 13 x 9 cells with these factors.
fn terrain(map: &Bitmap, factors: Option<&Vec<u32>>) -> Terrain {
    let terrain = Terrain::new(map.clone());
    let Some(factors) = factors else { return terrain };
    let factor = |cell: Cell| {
        let area = (cell.column / 13 * 7 + cell.row / 9 * 3) as usize;
        factors[area % factors.len()]
    };
    terrain.with_tolls(Tolls::from_fn(map.columns(), map.rows(), factor))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 250, failure_persistence: None, ..Default::default() })]

    /// W51: the nearest goal by cost is chosen, and each cell names it.
    #[test]
    fn a_field_of_several_goals_is_the_least_of_their_fields(
        map in maps(100), corners in corners(), factors in tolls(),
        goals in prop::collection::vec((0u32..100, 0u32..100), 2..=limits::MAX_GOALS),
    ) {
        let goals: Vec<Cell> =
            goals.into_iter().map(|(column, row)| Cell::new(column, row)).collect();
        let terrain = terrain(&map, factors.as_ref());
        let field = solve(&terrain, &goals, corners);
        let single: Vec<Field> =
            goals.iter().map(|&goal| solve(&terrain, &[goal], corners)).collect();
        for (index, &cost) in field.cost.iter().enumerate() {
            let least = single.iter().map(|field| field.cost[index]).min();
            prop_assert_eq!(Some(cost), least);
        }
        let any_on_map = goals.iter().any(|goal| goal.column < map.columns() && goal.row < map.rows());
        if !any_on_map {
            return Ok(());
        }
        let bytes = blob(&field, &terrain, &goals);
        let blob = Blob::parse(&bytes).unwrap();
        let plan = blob.parallel_plan(0).unwrap();
        prop_assert_eq!(plan.goal_count(), goals.len());
        let layer = plan.layer(0).unwrap();
        for (index, &cost) in field.cost.iter().enumerate() {
            let cell = Cell::new(index as u32 % field.columns, index as u32 / field.columns);
            if cost == field::UNREACHED {
                let answer = layer.look_up(cell);
                let has_route = matches!(answer, Answer::Move { .. } | Answer::Goal);
                prop_assert!(!has_route, "{:?}", answer);
                continue;
            }
            let end = followed(&layer, &field, cell);
            let number = usize::from(layer.goal_number(cell));
            prop_assert_eq!(goals.iter().position(|&goal| goal == end), Some(number), "{:?}", cell);
            prop_assert_eq!(single[number].cost[index], cost, "{:?}", cell);
        }
        let report = verify(&blob, &|_, _| ());
        prop_assert!(report.count == 0, "{:?}", report.violations);
    }
}

/// What the proof says of a plan with these goals, whose cells name goals by these numbers.
fn proof(listed: &[Cell], numbered: &[Numbered]) -> Report {
    let terrain = Terrain::new(Bitmap::new(40, 10));
    let field = solve(&terrain, listed, Corners::Forbid);
    let packed = with_goals(pack(&field), numbered).unwrap();
    let mut draft = draft_of(&blob(&field, &terrain, listed));
    draft.plans[0].layers[0].packed = packed;
    verify(&Blob::parse(&write(&draft).unwrap()).unwrap(), &|_, _| ())
}

/// A draft with the grid and the goals of a blob, and a layer without cells.
fn draft_of(bytes: &[u8]) -> Draft {
    let blob = Blob::parse(bytes).unwrap();
    let packed = pack(&Field { columns: 40, rows: 10, ..Field::default() });
    Draft {
        grid: *blob.grid(),
        origin: None,
        parameters: Parameters::default(),
        plans: vec![PlanDraft {
            name: "fuel".into(),
            goals_m: blob.parallel_plan(0).unwrap().goals_m().collect(),
            layers: vec![LayerDraft { name: "physical".into(), rank: 0, packed }],
        }],
        mission: MissionDraft::default(),
    }
}

#[test]
fn the_proof_finds_cells_that_name_a_wrong_goal() {
    let [a, b, c] = [Cell::new(3, 3), Cell::new(30, 8), Cell::new(17, 1)];
    assert_eq!(proof(&[a, b, c], &[(0, a), (1, b), (2, c)]).count, 0);
    // Numbers of goals exchanged: every goal's own cell is wrong, and nothing else.
    let exchanged = proof(&[a, b, c], &[(0, b), (1, a), (2, c)]);
    assert_eq!(exchanged.count, 2, "{:?}", exchanged.violations);
    assert!(exchanged.violations[0].what.contains("another goal than its own"));
    // Routes that name another goal than the one to which they go on.
    let moved = proof(&[a, b, c], &[(0, a), (1, b), (2, c), (1, Cell::new(4, 4))]);
    assert!(moved.violations.iter().any(|v| v.what.contains("advised step")), "{moved:?}");
}

/// Many goals cost a small part of a layer, and one goal not a byte.
#[test]
fn goals_take_few_bytes() {
    let map = Bitmap::from_fn(250, 250, |cell| cell.column % 40 > 30 && cell.row % 50 > 35);
    let terrain = Terrain::new(map);
    let all: Vec<Cell> = (0..16).map(|i| Cell::new(5 + i * 67 % 250, 5 + i * 43 % 250)).collect();
    let bytes = |goals: &[Cell]| {
        let field = solve(&terrain, goals, Corners::Forbid);
        let plain = pack(&field);
        let labelled = with_goals(plain.clone(), &ends(&terrain, goals)).unwrap();
        (labelled.bytes() - plain.bytes(), plain.bytes())
    };
    for (count, most) in [(2, 900), (3, 1_600), (16, 6_500)] {
        let (goals, rest) = bytes(&all[..count]);
        eprintln!("{count} goals: {goals} bytes beside {rest}");
        assert!(goals <= most, "{count} goals take {goals} bytes");
    }
}
