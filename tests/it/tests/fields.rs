//! Fields, compared with slow references and with drawn pictures.

mod published;
mod several;
mod tolls;

use maps::Bitmap;
use plan_compiler::field::{self, Field};
use plan_compiler::search::{
    Corners, MAX_COST, Method, Query, Solver, Vectors, is_cut_short, step,
};
use plan_compiler::terrain::Terrain;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::{Cell, Direction};
use proptest::prelude::*;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// The length of a path as its numbers of steps, ordered by `straight + diagonal * sqrt 2`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Length {
    straight: i64,
    diagonal: i64,
}

impl Length {
    fn after(self, direction: Direction) -> Self {
        let is_diagonal = direction.code() % 2 == 1;
        Self {
            straight: self.straight + i64::from(!is_diagonal),
            diagonal: self.diagonal + i64::from(is_diagonal),
        }
    }

    fn cost(self) -> u32 {
        let cost =
            self.straight * i64::from(STRAIGHT_STEP) + self.diagonal * i64::from(DIAGONAL_STEP);
        u32::try_from(cost).expect("paths of these tests are short")
    }
}

impl Ord for Length {
    /// Exactly, by squares: a < b sqrt 2 if and only if a |a| < 2 b |b|.
    fn cmp(&self, other: &Self) -> Ordering {
        let straight = self.straight - other.straight;
        let diagonal = other.diagonal - self.diagonal;
        (straight * straight.abs()).cmp(&(2 * diagonal * diagonal.abs()))
    }
}

impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A plain Dijkstra search with a binary heap: the shortest lengths from the sources by the steps
/// that `step` allows.
fn dijkstra(
    size: (u32, u32),
    sources: &[Cell],
    step: impl Fn(Cell, Direction) -> Option<Cell>,
) -> Vec<Option<Length>> {
    let index = |cell: Cell| (cell.row * size.0 + cell.column) as usize;
    let mut lengths = vec![None; (size.0 * size.1) as usize];
    let mut queue: BinaryHeap<Reverse<(Length, Cell)>> =
        sources.iter().map(|&cell| Reverse((Length::default(), cell))).collect();
    while let Some(Reverse((length, cell))) = queue.pop() {
        if lengths[index(cell)].is_some() {
            continue;
        }
        lengths[index(cell)] = Some(length);
        for direction in Direction::ALL {
            if let Some(to) = step(cell, direction) {
                queue.push(Reverse((length.after(direction), to)));
            }
        }
    }
    lengths
}

/// The cell that a legal step leads to, computed independently of the search.
fn legal(blocked: &Bitmap, corners: Corners, from: Cell, direction: Direction) -> Option<Cell> {
    let (dx, dy) = direction.step();
    let at = |dx: i32, dy: i32| {
        let column = from.column.checked_add_signed(dx)?;
        let row = from.row.checked_add_signed(dy)?;
        let cell = Cell::new(column, row);
        let inside = column < blocked.columns() && row < blocked.rows();
        (inside && !blocked.get(cell)).then_some(cell)
    };
    let passes = corners == Corners::Allow || (at(dx, 0).is_some() && at(0, dy).is_some());
    let is_straight = dx == 0 || dy == 0;
    if is_straight || passes { at(dx, dy) } else { None }
}

/// Compares a field with the references, cell by cell.
fn assert_right(blocked: &Bitmap, goal: Cell, corners: Corners, field: &Field) {
    let size = (blocked.columns(), blocked.rows());
    assert_eq!((field.columns, field.rows), size);
    let index = |cell: Cell| (cell.row * size.0 + cell.column) as usize;
    let inside = goal.column < size.0 && goal.row < size.1 && !blocked.get(goal);
    let sources: Vec<Cell> = inside.then_some(goal).into_iter().collect();
    let lengths =
        dijkstra(size, &sources, |cell, direction| legal(blocked, corners, cell, direction));
    let is_free = |cell: Cell| !blocked.get(cell);
    let routed: Vec<Cell> = cells(size).filter(|&cell| lengths[index(cell)].is_some()).collect();
    let neighbour = |cell: Cell, direction: Direction| cell.neighbour(direction, size.0, size.1);
    let ways_out = dijkstra(size, &routed, |cell, direction| {
        neighbour(cell, direction).filter(|&to| blocked.get(to))
    });

    for cell in cells(size) {
        let (cost, code) = (field.cost[index(cell)], field.code[index(cell)]);
        assert_eq!(cost, lengths[index(cell)].map_or(field::UNREACHED, Length::cost), "{cell:?}");
        assert_eq!(field::is_blocked(code), blocked.get(cell), "{cell:?}");
        // Free cells follow the lengths of routes, blocked cells those of escapes.
        let (lengths, move_) = if is_free(cell) {
            (&lengths, field::advised(code))
        } else {
            (&ways_out, field::escape(code))
        };
        let here = lengths[index(cell)];
        let best: Vec<Direction> = Direction::ALL
            .into_iter()
            .filter(|&direction| {
                let to = if is_free(cell) {
                    legal(blocked, corners, cell, direction)
                } else {
                    neighbour(cell, direction)
                        .filter(|&to| blocked.get(to) || routed.binary_search(&to).is_ok())
                };
                let length = to.and_then(|to| lengths[index(to)]);
                length.is_some_and(|length| Some(length.after(direction)) == here)
            })
            .collect();
        let has_diagonal = best.iter().any(|direction| direction.code() % 2 == 1);
        match move_ {
            Some(direction) => {
                assert!(best.contains(&direction), "{cell:?} {direction:?}");
                assert_eq!(direction.code() % 2 == 1, has_diagonal, "{cell:?} {direction:?}");
            }
            None => {
                assert!(best.is_empty(), "{cell:?}");
                let expected = match here {
                    _ if blocked.get(cell) => field::NO_ESCAPE,
                    Some(_) => field::GOAL,
                    None => field::NO_ROUTE,
                };
                assert_eq!(code, expected, "{cell:?}");
            }
        }
    }
}

/// The field of a goal among blocked cells.
fn solve(blocked: &Bitmap, goal: Cell, corners: Corners) -> Field {
    solve_by(&mut Solver::new(), blocked, goal, corners)
}

/// The same by a solver that may have solved others before.
fn solve_by(solver: &mut Solver, blocked: &Bitmap, goal: Cell, corners: Corners) -> Field {
    solver.solve(&Query { terrain: &Terrain::new(blocked.clone()), goals: &[goal], corners })
}

/// Compares the results of every method with the references.
fn assert_solved(blocked: &Bitmap, goal: Cell, corners: Corners) {
    let field = solve(blocked, goal, corners);
    assert_right(blocked, goal, corners, &field);
    for method in [Method::Tiles, Method::Buckets] {
        for vectors in Vectors::all() {
            let mut solver = Solver::with_method(method).with_vectors(vectors);
            let other = solve_by(&mut solver, blocked, goal, corners);
            assert!(other == field, "{method:?} with {} differs", vectors.name());
        }
    }
}

fn cells(size: (u32, u32)) -> impl Iterator<Item = Cell> {
    // In the order of `Cell`'s own ordering, by columns.
    (0..size.0).flat_map(move |column| (0..size.1).map(move |row| Cell::new(column, row)))
}

/// One of the eight symmetries of the square.
fn turned(cell: Cell, (columns, rows): (u32, u32), symmetry: u8) -> Cell {
    let column = if symmetry & 1 == 0 { cell.column } else { columns - 1 - cell.column };
    let row = if symmetry & 2 == 0 { cell.row } else { rows - 1 - cell.row };
    if symmetry & 4 == 0 { Cell::new(column, row) } else { Cell::new(row, column) }
}

fn turned_map(map: &Bitmap, symmetry: u8) -> Bitmap {
    let size = (map.columns(), map.rows());
    let (columns, rows) = if symmetry & 4 == 0 { size } else { (size.1, size.0) };
    let mut turned_map = Bitmap::new(columns, rows);
    for cell in map.iter() {
        turned_map.set(turned(cell, size, symmetry), true);
    }
    turned_map
}

/// Maps of several textures: noise of any density, rectangles, or walls with doors.
fn maps(side: u32) -> impl Strategy<Value = Bitmap> {
    let size = (1..=side, 1..=side);
    let noise =
        (size.clone(), 0u32..100, any::<u64>()).prop_map(|((columns, rows), share, seed)| {
            let mut state = seed | 1;
            Bitmap::from_fn(columns, rows, |_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                state % 100 < u64::from(share)
            })
        });
    let rectangle = (0..side, 0..side, 1..=side / 3 + 1, 1..=side / 3 + 1);
    let rectangles = (size, prop::collection::vec(rectangle, 0..12)).prop_map(
        |((columns, rows), rectangles)| {
            let mut map = Bitmap::new(columns, rows);
            for (column, row, width, height) in rectangles {
                for row in row..row + height {
                    map.fill(row, column, column + width);
                }
            }
            map
        },
    );
    let walls =
        (1..=side, 1..=side, 2u32..9, any::<u64>()).prop_map(|(columns, rows, spacing, seed)| {
            Bitmap::from_fn(columns, rows, |cell| {
                let wall = cell.column % spacing == 0 || cell.row % spacing == 0;
                let door = (u64::from(cell.column * 31 + cell.row * 17) ^ seed) % 5 == 0;
                wall && !door
            })
        });
    prop_oneof![noise, rectangles, walls]
}

fn corners() -> impl Strategy<Value = Corners> {
    prop_oneof![Just(Corners::Forbid), Just(Corners::Allow)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn fields_equal_the_reference(
        // Large enough for two tiles and the transfer between them.
        map in maps(100), corners in corners(), column in 0u32..100, row in 0u32..100,
    ) {
        let goal = Cell::new(column, row);
        assert_solved(&map, goal, corners);
    }

    #[test]
    fn costs_turn_with_the_map(
        map in maps(80), corners in corners(), column in 0u32..80, row in 0u32..80,
    ) {
        let size = (map.columns(), map.rows());
        let goal = Cell::new(column % size.0, row % size.1);
        let field = solve(&map, goal, corners);
        for symmetry in 1..8 {
            let other =
                solve(&turned_map(&map, symmetry), turned(goal, size, symmetry), corners);
            for cell in cells(size) {
                let to = turned(cell, size, symmetry);
                prop_assert_eq!(
                    field.cost[(cell.row * size.0 + cell.column) as usize],
                    other.cost[(to.row * other.columns + to.column) as usize]
                );
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    #[test]
    fn large_fields_equal_the_reference(
        map in maps(300), corners in corners(), column in 0u32..300, row in 0u32..300,
    ) {
        let goal = Cell::new(column % map.columns(), row % map.rows());
        assert_solved(&map, goal, corners);
    }
}

#[test]
fn a_reused_solver_gives_the_same_fields() {
    let mut solver = Solver::new();
    for (columns, rows) in [(70, 40), (3, 200), (130, 130), (1, 1), (64, 64)] {
        for corners in [Corners::Forbid, Corners::Allow] {
            let map =
                Bitmap::from_fn(columns, rows, |cell| (cell.column * 7 + cell.row * 13) % 11 == 0);
            let goal = Cell::new(columns / 2, rows / 3);
            assert_eq!(solve_by(&mut solver, &map, goal, corners), solve(&map, goal, corners));
        }
    }
}

/// Draws advice as arrows, north up: `*` the goal, `?` no route. Blocked cells are `#`.
fn arrows(field: &Field) -> Vec<String> {
    picture(field, |code| match field::advised(code) {
        Some(direction) => arrow(direction),
        None if field::is_blocked(code) => '#',
        None if code == field::GOAL => '*',
        None => '?',
    })
}

/// Draws escapes as arrows. Blocked cells without an escape are `#`, free cells `.`.
fn escapes(field: &Field) -> Vec<String> {
    picture(field, |code| match field::escape(code) {
        Some(direction) => arrow(direction),
        None if field::is_blocked(code) => '#',
        None => '.',
    })
}

fn arrow(direction: Direction) -> char {
    ['→', '↗', '↑', '↖', '←', '↙', '↓', '↘'][usize::from(direction.code())]
}

fn picture(field: &Field, symbol: impl Fn(u8) -> char) -> Vec<String> {
    let rows = field.code.chunks(field.columns as usize).rev();
    rows.map(|row| row.iter().map(|&code| symbol(code)).collect()).collect()
}

/// Solves a drawn map (`#` blocked, `*` the goal), and checks the field and its drawing.
#[track_caller]
fn check(
    map: &[&str],
    corners: Corners,
    draw: fn(&Field) -> Vec<String>,
    expected: &[&str],
) -> Field {
    let rows = map.len() as u32;
    let symbol = |cell: Cell| map[(rows - 1 - cell.row) as usize].as_bytes()[cell.column as usize];
    let columns = map[0].len() as u32;
    let blocked = Bitmap::from_fn(columns, rows, |cell| symbol(cell) == b'#');
    let goal = cells((columns, rows)).find(|&cell| symbol(cell) == b'*');
    let goal = goal.unwrap_or(Cell::new(columns, rows));
    let field = solve(&blocked, goal, corners);
    assert_right(&blocked, goal, corners, &field);
    assert_eq!(draw(&field), expected);
    field
}

#[test]
fn without_obstacles_the_cost_is_the_octile_distance() {
    let goal = Cell::new(37, 5);
    let field = solve(&Bitmap::new(100, 70), goal, Corners::Forbid);
    for cell in cells((100, 70)) {
        let expected = plan_format::grid::octile(
            cell.column.abs_diff(goal.column),
            cell.row.abs_diff(goal.row),
        );
        assert_eq!(field.cost[(cell.row * 100 + cell.column) as usize], expected);
    }
}

#[test]
fn the_corner_rule_decides_about_diagonals() {
    let map = ["...", ".#.", "..*"];
    check(&map, Corners::Allow, arrows, &["→↘↓", "↘#↓", "→→*"]);
    check(&map, Corners::Forbid, arrows, &["→→↓", "↓#↓", "→→*"]);
    let gap = [".#", "#*"];
    check(&gap, Corners::Allow, arrows, &["↘#", "#*"]);
    check(&gap, Corners::Forbid, arrows, &["?#", "#*"]);
}

#[test]
fn pockets_have_no_route_and_blocked_cells_an_escape() {
    let map = ["......", ".####.", ".#..#.", ".####.", "*....."];
    let expected = ["↓←←←←←", "↓####↓", "↓#??#↓", "↓####↓", "*←←←←←"];
    check(&map, Corners::Forbid, arrows, &expected);
    let expected = ["......", ".↑↑↑→.", ".←..→.", ".←↓↓→.", "......"];
    check(&map, Corners::Forbid, escapes, &expected);
}

#[test]
fn without_a_free_goal_nothing_has_a_route() {
    let map = ["..", "#."];
    let field = check(&map, Corners::Forbid, arrows, &["??", "#?"]);
    assert!(field.cost.iter().all(|&cost| cost == field::UNREACHED));
    assert_eq!(escapes(&field), ["..", "#."]);
    let everything = Bitmap::from_fn(3, 3, |_| true);
    let field = solve(&everything, Cell::new(1, 1), Corners::Allow);
    assert!(field.code.iter().all(|&code| code == field::NO_ESCAPE));
    assert!(solve(&Bitmap::new(0, 0), Cell::new(0, 0), Corners::Allow).code.is_empty());
}

/// A corridor one cell wide that folds back and forth over the whole map.
fn folded_corridor(columns: u32, rows: u32) -> Bitmap {
    Bitmap::from_fn(columns, rows, |cell| {
        let door = if cell.row % 4 == 1 { columns - 1 } else { 0 };
        cell.row % 2 == 1 && cell.column != door
    })
}

#[test]
fn paths_that_are_too_long_are_reported() {
    for (rows, too_long) in [(1_099, false), (1_299, true)] {
        let columns = 1_200;
        let map = folded_corridor(columns, rows);
        let goal = Cell::new(0, 0);
        let field = solve(&map, goal, Corners::Forbid);
        let terrain = Terrain::new(map.clone());
        let query = Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid };
        let tiles = solve_by(&mut Solver::with_method(Method::Tiles), &map, goal, Corners::Forbid);
        assert!(tiles == field);
        let length = u64::from(rows.div_ceil(2)) * u64::from(columns + 1) - 2;
        let cost = length * u64::from(STRAIGHT_STEP);
        assert_eq!(cost > u64::from(MAX_COST), too_long);
        assert_eq!(is_cut_short(&query, &field), too_long);
        assert_eq!(field.code.contains(&field::NO_ROUTE), too_long);
        let farthest = field.cost.iter().filter(|&&cost| cost != field::UNREACHED).max();
        let farthest = u64::from(*farthest.expect("the goal"));
        if too_long {
            assert!(farthest + u64::from(STRAIGHT_STEP) > u64::from(MAX_COST));
        } else {
            assert_eq!(farthest, cost);
        }
    }
}

#[test]
fn following_the_advice_spends_exactly_the_cost() {
    let map = Bitmap::from_fn(90, 75, |cell| (cell.column * 5 + cell.row * 3) % 17 < 4);
    for corners in [Corners::Forbid, Corners::Allow] {
        let goal = cells((90, 75)).find(|&cell| !map.get(cell)).expect("a free cell");
        let field = solve(&map, goal, corners);
        let terrain = Terrain::new(map.clone());
        let index = |cell: Cell| (cell.row * 90 + cell.column) as usize;
        for start in cells((90, 75)).filter(|&cell| field.cost[index(cell)] != field::UNREACHED) {
            let (mut cell, mut length) = (start, Length::default());
            while let Some(direction) = field::advised(field.code[index(cell)]) {
                cell = step(&terrain, cell, direction, corners).expect("an allowed step");
                length = length.after(direction);
            }
            assert_eq!((cell, length.cost()), (goal, field.cost[index(start)]));
        }
    }
}
