//! Maps as text in, passages as text out.

use super::gap::nearest;
use super::*;
use crate::search::{Corners, Query, solve};
use crate::terrain::Terrain;

/// Cells of half a metre: `#` is blocked, `G` the goal; the first line is the northernmost row.
fn picture(lines: &[&str]) -> (Bitmap, Cell, Grid) {
    let (columns, rows) = (lines[0].len() as u32, lines.len() as u32);
    let at = |cell: Cell| lines[(rows - 1 - cell.row) as usize].as_bytes()[cell.column as usize];
    let blocked = Bitmap::from_fn(columns, rows, |cell| at(cell) == b'#');
    let goal = Bitmap::from_fn(columns, rows, |cell| at(cell) == b'G').iter().next().unwrap();
    (blocked, goal, Grid { columns, rows, resolution_m: 0.5, corner_m: [0.0, 0.0] })
}

/// A body of 0.2 m that keeps `beside_m`.
fn need(beside_m: f64) -> Need {
    let width_m = 2.0 * (0.2 + beside_m);
    Need { width_m, radius_m: 0.2, stop_m: 0.1, margin_m: beside_m }
}

/// The passages of a map whose obstacles were grown by 0.25 m: width, place and percent of routes.
fn found(lines: &[&str], need: &Need) -> Vec<String> {
    let (blocked, goal, grid) = picture(lines);
    let terrain = Terrain::new(blocked.clone());
    let field = solve(&Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid });
    let site = Site { grid: &grid, solid: &blocked, grown_m: 0.25, need: *need };
    let text = |passage: &Passage| {
        let percent = (100.0 * passage.share).round();
        let [width, at] = in_words(passage);
        format!("{width} at {at}, {percent} %")
    };
    passages(&field, &site).iter().map(text).collect()
}

#[test]
fn a_door_is_found_with_its_width() {
    let rooms = [
        "...........#............",
        "...........#............",
        "...........#............",
        ".....................G..",
        "........................",
        "...........#............",
        "...........#............",
        "...........#............",
    ];
    assert_eq!(found(&rooms, &need(0.6)), ["1.5 to 2.5 m at (5.75, 2), 48 %"]);
    // What is far wider than the robot needs is not a passage.
    assert_eq!(found(&rooms, &Need { width_m: 0.3, ..need(0.0) }), [""; 0]);
}

#[test]
fn a_corridor_is_one_passage_at_its_narrowest_place() {
    let corridor = [
        "....####################....",
        "....####################....",
        "....####################....",
        "..........................G.",
        "............................",
        "....########....########....",
        "....########....########....",
        "....########....########....",
    ];
    // The bay in the south is not wide enough to make two passages of it.
    assert_eq!(found(&corridor, &need(0.6)).len(), 1);
    let bottle = [
        "....####################....",
        "....####################....",
        "....########...#########....",
        "....########...#########....",
        "..........................G.",
        "....########...#########....",
        "....########...#########....",
        "....########...#########....",
        "....####################....",
    ];
    // Between the two ends is a room three times as wide.
    assert_eq!(
        found(&bottle, &need(0.6)),
        ["1 to 2 m at (2.25, 2.25), 35 %", "1 to 2 m at (7.75, 2.25), 59 %"]
    );
}

#[test]
fn a_passage_that_few_routes_use_is_left_out() {
    let closet = [
        "..............######",
        "..............#...##",
        "..............##.###",
        "....................",
        "....................",
        ".G..................",
        "....................",
    ];
    assert_eq!(found(&closet, &need(0.6)), [""; 0]);
    // The same slit in the way of all routes counts.
    let slit = [
        "......######........",
        "......######........",
        ".G..................",
        "......######........",
        "......######........",
    ];
    assert_eq!(found(&slit, &need(0.6)).len(), 1);
}

#[test]
fn one_side_is_not_a_passage_nor_is_the_edge_of_the_map() {
    let beside = ["..............", "....######....", "..............", ".............G"];
    assert_eq!(found(&beside, &need(5.0)), [""; 0]);
    assert_eq!(found(&["G"], &need(5.0)), [""; 0]);
    assert_eq!(found(&["#G#", ".#."], &need(5.0)), [""; 0]);
}

#[test]
fn posts_are_measured_from_edge_to_edge_in_any_direction() {
    let posts = [
        "#...........#",
        ".#.........#.",
        "..#.......#..",
        "...#.....#...",
        "....#...#....",
        ".............",
        "......G......",
        ".............",
    ];
    assert_eq!(found(&posts, &need(0.6)), ["2 to 3 m at (3.25, 1.75), 37 %"]);
    let diagonal = [
        "########........",
        "#######.........",
        "######..........",
        "#####..........G",
        "####..........##",
        "###..........###",
        "##..........####",
        "#..........#####",
        "..........######",
    ];
    // From one stair to the other: 4 free columns and 5 free rows, or 5 and 4.
    let least_m = 0.5 * wide::hypot(4.0, 5.0) + 2.0 * 0.25;
    let text = found(&diagonal, &need(0.9));
    assert!(text[0].starts_with(&format!("{least_m:.1} to")), "{text:?}, {least_m}");
    assert_eq!(text.len(), 1);
}

#[test]
fn areas_that_only_a_higher_layer_blocks_are_not_sides() {
    // The same wall once as an obstacle and once as an area that weakens radio.
    let wall = ["....#....", "....#....", ".......G.", "....#....", "....#...."];
    let (blocked, goal, grid) = picture(&wall);
    let terrain = Terrain::new(blocked.clone());
    let field = solve(&Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid });
    let nothing = Bitmap::new(grid.columns, grid.rows);
    let count = |solid: &Bitmap| {
        passages(&field, &Site { grid: &grid, solid, grown_m: 0.25, need: need(0.6) }).len()
    };
    assert_eq!([count(&blocked), count(&nothing)], [1, 0]);
}

#[test]
fn a_wall_that_a_route_leaves_is_not_a_passage() {
    // Routes come along the wall from both ends and leave it diagonally and straight.
    let wall = [
        "....................",
        ".........G..........",
        "....................",
        "....................",
        "....................",
        "....................",
        ".##################.",
    ];
    assert_eq!(found(&wall, &need(0.6)), [""; 0]);
    let stairs = [
        "................#",
        "...............##",
        "..............###",
        ".............####",
        "............#####",
        "...........######",
        "..........#######",
        "G........########",
    ];
    assert_eq!(found(&stairs, &need(0.6)), [""; 0]);
}

/// Plain reference: the distance to the nearest blocked cell of a sector, cell by cell.
fn nearest_by_hand(blocked: &Bitmap, from: Cell, axis: [f64; 2]) -> Option<f64> {
    let edge = |one: u32, other: u32| (f64::from(one.abs_diff(other)) - 0.5).max(0.0);
    let in_sector = |cell: &Cell| {
        let dx = f64::from(cell.column) - f64::from(from.column);
        let dy = f64::from(cell.row) - f64::from(from.row);
        dx * axis[0] + dy * axis[1] >= wide::hypot(dx, dy) * 0.5 && (dx, dy) != (0.0, 0.0)
    };
    let distance =
        |cell: Cell| wide::hypot(edge(cell.column, from.column), edge(cell.row, from.row));
    blocked.iter().filter(in_sector).map(distance).min_by(f64::total_cmp)
}

#[test]
fn the_nearest_cell_of_a_sector_is_that_of_a_plain_search() {
    let mut state = 7_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as u32
    };
    for round in 0..2000 {
        let (columns, rows) = (1 + random() % 150, 1 + random() % 40);
        let part = 2 + round % 90;
        let mut blocked = Bitmap::from_fn(columns, rows, |_| random() % part == 0);
        let from = Cell::new(random() % columns, random() % rows);
        blocked.set(from, false);
        // Angles that no cell lies at, so that rounding does not decide.
        let angle = f64::from(random() % 1000) * 0.0123 + 0.001;
        let axis = [wide::cos(angle), wide::sin(angle)];
        let expected = nearest_by_hand(&blocked, from, axis);
        let found = nearest(&blocked, from, axis, 400).map(|(distance, _)| distance);
        assert_eq!(found, expected, "{from:?} {angle} of {columns} x {rows}");
        let near = nearest(&blocked, from, axis, 3).map(|(distance, _)| distance);
        assert_eq!(near, expected.filter(|distance| *distance <= 3.0));
    }
}

#[test]
fn advice_that_leads_in_a_circle_ends_the_count() {
    // East, west: the two cells advise each other.
    let field = Field { columns: 3, rows: 1, unit: None, cost: vec![1, 1, 0], code: vec![0, 4, 8] };
    let routes = Routes::count(&field);
    assert_eq!(routes.trunk(1), [0; 0]);
}

#[test]
fn a_warning_says_what_would_fit() {
    let passage = |at_m, width_m| Passage { at_m, width_m, share: 0.5 };
    let layer = |plan: &str, passages: &[Passage]| LayerPassages {
        plan: plan.into(),
        layer: "physical".into(),
        passages: passages.to_vec(),
    };
    let door = passage([10.0, 5.0], [0.9, 1.1]);
    let wide = passage([50.0, 5.0], [1.7, 1.9]);
    let slit = passage([20.0, 5.0], [0.4, 0.6]);
    let layers = [layer("hall", &[door.clone(), wide]), layer("gate", &[slit, door])];
    let said: Vec<String> = warnings(&layers, &need(0.6))
        .iter()
        .map(|problem| format!("{problem}\n{}", problem.help.as_deref().unwrap()))
        .collect();
    assert_eq!(
        said,
        [
            "the routes to `gate` pass between obstacles 0.4 to 0.6 m apart at (20, 5), but the \
             robot needs 1.6 m\nits body of 0.4 m stops within 0.1 m and is repelled within 0.6 m \
             of obstacles; set robot_radius = 0.8, so that the routes avoid the passage",
            "the routes to `hall` and 1 more pass between obstacles 0.9 to 1.1 m apart at (10, 5), \
             but the robot needs 1.6 m\nits body of 0.4 m is repelled within 0.6 m of obstacles; \
             set avoid_margin to 0.25 at most, or set robot_radius = 0.8, so that the routes avoid \
             the passage",
        ]
    );
    let many: Vec<Passage> =
        (0..7).map(|index| passage([10.0 * f64::from(index), 0.0], [0.9, 1.1])).collect();
    let said = warnings(&[layer("hall", &many)], &need(0.6));
    assert_eq!(said.len(), 5);
    assert!(said[4].message.ends_with("; 2 more passages are too narrow"), "{}", said[4]);
    assert!(warnings(&[layer("hall", &many)], &need(0.25)).is_empty());
    // A passage that may be too narrow is warned of.
    assert_eq!(warnings(&[layer("hall", &many)], &need(0.3)).len(), 5);
}

#[test]
fn the_need_is_the_body_and_the_larger_distance_that_acts() {
    let mut parameters = Parameters::default();
    parameters.vehicle.radius_m = 0.3;
    parameters.vehicle.stop_distance_m = 0.1;
    parameters.schemas.avoid_margin_m = 0.5;
    let need = Need::of(&parameters);
    assert!((need.width_m - 1.6).abs() < 1e-6);
    parameters.gains.reactive = 0.0;
    let need = Need::of(&parameters);
    assert!((need.width_m - 0.8).abs() < 1e-6);
}
