//! Pictures of the important cases, and random shapes against slow, exact definitions.

use super::*;
use crate::model::{Extent, Role};
use math::Cell;
use proptest::prelude::*;

const SIDE: u32 = 12;

fn map(shapes: Vec<Shape>) -> Map {
    let feature = |shape| Feature {
        shape,
        role: Role::Obstacle,
        name: String::new(),
        height_m: None,
        span: 0..0,
    };
    let extent = Extent { corner: [0.0, 0.0], size: [f64::from(SIDE); 2] };
    Map { features: shapes.into_iter().map(feature).collect(), ..Map::empty(extent) }
}

fn grid(columns: u32, rows: u32) -> Grid {
    Grid { columns, rows, resolution_m: 1.0, corner_m: [0.0, 0.0] }
}

fn blocked(map: &Map, grid: &Grid, robot_radius_m: f64) -> Bitmap {
    rasterise(map, grid, &|_| true, &RasterOptions { robot_radius_m, fill_walls: false })
}

/// North up, one character a cell.
fn picture(bitmap: &Bitmap) -> String {
    let line = |row| {
        let cells = (0..bitmap.columns()).map(|column| bitmap.get(Cell::new(column, row)));
        cells.map(|set| if set { '#' } else { '.' }).collect::<String>() + "\n"
    };
    (0..bitmap.rows()).rev().map(line).collect()
}

#[track_caller]
fn check(map: &Map, radius: f64, expected: &[&str]) {
    let grid = grid(expected[0].len() as u32, expected.len() as u32);
    let expected: String = expected.iter().map(|line| format!("{line}\n")).collect();
    assert_eq!(picture(&blocked(map, &grid, radius)), expected);
}

#[test]
fn a_line_on_a_cell_edge_touches_the_cell_that_owns_the_edge() {
    let wall = Shape::Polyline(vec![[2.0, 1.0], [2.0, 3.0]]);
    check(&map(vec![wall]), 0.0, &[".....", "..#..", "..#..", "..#..", "....."]);
    let wall = Shape::Polyline(vec![[1.0, 2.0], [3.0, 2.0]]);
    check(&map(vec![wall]), 0.0, &[".....", ".....", ".###.", ".....", "....."]);
}

#[test]
fn diagonals_through_lattice_points_touch_only_their_cells() {
    let rising = Shape::Polyline(vec![[1.0, 1.0], [4.0, 4.0]]);
    check(&map(vec![rising]), 0.0, &["....#", "...#.", "..#..", ".#...", "....."]);
    let falling = Shape::Polyline(vec![[1.0, 4.0], [4.0, 1.0]]);
    check(&map(vec![falling]), 0.0, &[".#...", ".##..", "..##.", "...##", "....."]);
}

#[test]
fn growth_is_by_a_closed_disc() {
    let point = Shape::Circle { centre: [2.5, 2.5], radius: 0.0 };
    // Cells own their southern and western edges, so the disc's tips touch one cell more in
    // the north and in the east.
    check(&map(vec![point]), 1.5, &["..#..", ".###.", ".####", ".###.", "....."]);
    let wall = Shape::Polyline(vec![[2.5, 0.0], [2.5, 5.0]]);
    check(&map(vec![wall]), 0.5, &["..##.", "..##.", "..##."]);
    let disc = Shape::Circle { centre: [2.5, 2.5], radius: 1.0 };
    check(&map(vec![disc]), 0.5, &["..#..", ".###.", ".####", ".###.", "....."]);
}

#[test]
fn polygons_are_filled_but_for_their_holes() {
    let outer = vec![[1.0, 1.0], [6.0, 1.0], [6.0, 5.0], [1.0, 5.0]];
    let hole = vec![[2.5, 2.5], [4.5, 2.5], [4.5, 3.5], [2.5, 3.5]];
    let rings = map(vec![Shape::Polygon(vec![outer.clone(), hole])]);
    let expected =
        ["........", ".######.", ".######.", ".######.", ".######.", ".######.", "........"];
    check(&rings, 0.0, &expected);
    let wide_hole = vec![[2.0, 2.0], [5.0, 2.0], [5.0, 4.0], [2.0, 4.0]];
    let rings = map(vec![Shape::Polygon(vec![outer, wide_hole])]);
    // The hole is open: its southern and western edges belong to the polygon.
    let expected =
        ["........", ".######.", ".######.", ".##..##.", ".######.", ".######.", "........"];
    check(&rings, 0.0, &expected);
}

#[test]
fn an_outline_that_overlaps_itself_is_solid() {
    let twice = [[0.5, 0.5], [4.5, 0.5], [4.5, 4.5], [0.5, 4.5]].repeat(2);
    check(&map(vec![Shape::Polygon(vec![twice])]), 0.0, &["#####"; 5]);
}

#[test]
fn walls_that_close_are_filled_on_request() {
    let loop_ = vec![[0.5, 0.5], [4.5, 0.5], [4.5, 4.5], [0.5, 4.5], [0.5, 0.5]];
    let map = map(vec![Shape::Polyline(loop_)]);
    check(&map, 0.0, &["#####", "#...#", "#...#", "#...#", "#####"]);
    let options = RasterOptions { robot_radius_m: 0.0, fill_walls: true };
    assert_eq!(rasterise(&map, &grid(5, 5), &|_| true, &options).count(), 25);
}

#[test]
fn cells_that_reach_outside_the_boundary_are_blocked() {
    let mut map = map(Vec::new());
    map.boundary = Some(vec![[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.5]]);
    check(&map, 1.0, &["#####", "#####", "#...#", "#...#", "#####"]);
    // The same numbers after georeferencing.
    map.boundary =
        Some(vec![[1.0 + 3e-10, 1.0], [4.0 - 3e-10, 1.0 + 2e-10], [4.0, 3.0], [1.0, 3.5]]);
    check(&map, 0.0, &["#####", "#####", "#...#", "#...#", "#####"]);
}

#[test]
fn what_rounding_cannot_place_blocks_both_sides() {
    let grid = Grid { columns: 6, rows: 1, resolution_m: 0.1, corner_m: [0.0, 0.0] };
    let wall = Shape::Polyline(vec![[0.3, 0.0], [0.3, 0.1]]);
    assert_eq!(picture(&blocked(&map(vec![wall]), &grid, 0.0)), "..##..\n");
    let wall = Shape::Polyline(vec![[0.2, 0.0], [0.2, 0.1]]);
    assert_eq!(picture(&blocked(&map(vec![wall]), &grid, 0.0)), "..#...\n");
}

#[test]
fn no_number_makes_it_panic() {
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0, 3.0];
    for a in odd {
        for b in odd {
            let points = vec![[a, b], [b, 2.0], [1.0, a], [a, a]];
            let mut map = map(vec![
                Shape::Circle { centre: [a, b], radius: b },
                Shape::Polyline(points.clone()),
                Shape::Polygon(vec![points.clone(), Vec::new(), vec![[a, b]]]),
            ]);
            map.boundary = Some(points);
            blocked(&map, &grid(5, 5), a);
        }
    }
    let mut empty = map(vec![Shape::Polygon(Vec::new()), Shape::Polyline(Vec::new())]);
    empty.boundary = Some(Vec::new());
    assert_eq!(blocked(&empty, &grid(3, 2), 0.0).count(), 6, "no area, all outside");
}

/// Whether a segment meets a square, in quarters of a cell: some t in 0..=1 puts both of its
/// coordinates into the square, which is half-open, or open on all sides.
fn meets(a: [i64; 2], b: [i64; 2], cell: Cell, open: bool) -> bool {
    // Bounds of t as fractions with positive denominators, and whether they are excluded.
    let mut low = (0i64, 1i64, false);
    let mut high = (1i64, 1i64, false);
    for (axis, index) in [cell.column, cell.row].into_iter().enumerate() {
        let (from, to) = (4 * i64::from(index), 4 * i64::from(index) + 4);
        let step = b[axis] - a[axis];
        if step == 0 {
            let inside = from <= a[axis] && a[axis] < to && !(open && a[axis] == from);
            if !inside {
                return false;
            }
            continue;
        }
        let bounds = [((from - a[axis]), open), ((to - a[axis]), true)];
        let [enter, leave] = if step > 0 { bounds } else { [bounds[1], bounds[0]] };
        let (sign, size) = (step.signum(), step.abs());
        let enter = (enter.0 * sign, size, enter.1);
        let leave = (leave.0 * sign, size, leave.1);
        let order = |p: (i64, i64, bool), q: (i64, i64, bool)| (p.0 * q.1).cmp(&(q.0 * p.1));
        if order(enter, low).is_gt() || (order(enter, low).is_eq() && enter.2) {
            low = enter;
        }
        if order(leave, high).is_lt() || (order(leave, high).is_eq() && leave.2) {
            high = leave;
        }
    }
    let (left, right) = (low.0 * high.1, high.0 * low.1);
    left < right || (left == right && !low.2 && !high.2)
}

/// Winding number of a ring about a point that is on no edge, in eighths of a cell.
fn winding(ring: &[[i64; 2]], [x, y]: [i64; 2]) -> i32 {
    let mut turns = 0;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        let side = (b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1]);
        if a[1] <= y && b[1] > y && side > 0 {
            turns += 1;
        } else if a[1] > y && b[1] <= y && side < 0 {
            turns -= 1;
        }
    }
    turns
}

fn holds_centre(ring: &[[i64; 2]], cell: Cell) -> bool {
    let ring: Vec<[i64; 2]> = ring.iter().map(|point| point.map(|value| 2 * value)).collect();
    let centre = [cell.column, cell.row].map(|index| 8 * i64::from(index) + 4);
    winding(&ring, centre) != 0
}

fn edges(ring: &[[i64; 2]]) -> impl Iterator<Item = ([i64; 2], [i64; 2])> + '_ {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

fn metres(points: &[[i64; 2]]) -> Vec<Point> {
    points.iter().map(|point| point.map(|quarters| quarters as f64 / 4.0)).collect()
}

/// Distance from the closed square of a cell to a segment.
fn distance(a: Point, b: Point, cell: Cell) -> f64 {
    let low = [f64::from(cell.column), f64::from(cell.row)];
    let to_square = |p: Point| {
        let outside = |axis: usize| (low[axis] - p[axis]).max(p[axis] - low[axis] - 1.0).max(0.0);
        wide::hypot(outside(0), outside(1))
    };
    // Distance to a convex set is convex along a line, so ternary search finds the minimum.
    let at = |t: f64| to_square([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
    let (mut low_t, mut high_t) = (0.0, 1.0);
    for _ in 0..200 {
        let (third, two_thirds) = (low_t + (high_t - low_t) / 3.0, high_t - (high_t - low_t) / 3.0);
        if at(third) <= at(two_thirds) {
            high_t = two_thirds;
        } else {
            low_t = third;
        }
    }
    at(low_t).min(at(high_t)).min(at(0.0)).min(at(1.0))
}

fn cells() -> impl Iterator<Item = Cell> {
    (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| Cell::new(column, row)))
}

fn points(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<[i64; 2]>> {
    prop::collection::vec([-10i64..58, -10i64..58], count)
}

proptest! {
    #[test]
    fn lines_touch_exactly_what_they_touch(line in points(2..5)) {
        let got = blocked(&map(vec![Shape::Polyline(metres(&line))]), &grid(SIDE, SIDE), 0.0);
        for cell in cells() {
            let expected = line.windows(2).any(|ends| meets(ends[0], ends[1], cell, false));
            prop_assert_eq!(got.get(cell), expected, "{:?}", cell);
        }
    }

    #[test]
    fn polygons_touch_exactly_what_they_touch(outer in points(3..7), hole in points(3..5)) {
        let shape = Shape::Polygon(vec![metres(&outer), metres(&hole)]);
        let got = blocked(&map(vec![shape]), &grid(SIDE, SIDE), 0.0);
        for cell in cells() {
            let touched = edges(&outer).chain(edges(&hole)).any(|(a, b)| meets(a, b, cell, false));
            let inside = holds_centre(&outer, cell) && !holds_centre(&hole, cell);
            prop_assert_eq!(got.get(cell), touched || inside, "{:?}", cell);
        }
    }

    #[test]
    fn only_cells_wholly_inside_the_boundary_are_free(boundary in points(3..7)) {
        let mut map = map(Vec::new());
        map.boundary = Some(metres(&boundary));
        let got = blocked(&map, &grid(SIDE, SIDE), 0.0);
        for cell in cells() {
            let crossed = edges(&boundary).any(|(a, b)| meets(a, b, cell, true));
            let expected = crossed || !holds_centre(&boundary, cell);
            prop_assert_eq!(got.get(cell), expected, "{:?}", cell);
        }
    }

    #[test]
    fn growth_is_exact(line in points(1..4), radius in 0.01f64..4.0) {
        let line = metres(&line);
        let got = blocked(&map(vec![Shape::Polyline(line.clone())]), &grid(SIDE, SIDE), radius);
        let circle = Shape::Circle { centre: line[0], radius: radius / 2.0 };
        let disc = blocked(&map(vec![circle]), &grid(SIDE, SIDE), radius / 2.0);
        for cell in cells() {
            let segments = line.windows(2).map(|ends| distance(ends[0], ends[1], cell));
            let from_first = distance(line[0], line[0], cell);
            let nearest = segments.fold(f64::INFINITY, f64::min).min(from_first);
            for (got, nearest) in [(&got, nearest), (&disc, from_first)] {
                // Exactly on an edge the answer depends on which edges a cell owns.
                if (nearest - radius).abs() > 1e-6 {
                    prop_assert_eq!(got.get(cell), nearest < radius, "{:?}", cell);
                }
            }
        }
    }
}

/// Each of its edges crosses every row: twenty million crossings in total.
#[test]
fn a_zigzag_ring_is_stored_row_by_row() {
    let (rows, edges) = (1000, 20_000);
    let ring: Vec<Point> = (0..edges)
        .map(|n| [f64::from(n) * 1e-2, if n % 2 == 0 { 0.0 } else { f64::from(rows) }])
        .collect();
    let mut interior = Interior::of(&ring, rows);
    assert_eq!(interior.rows(), 0..rows);
    for row in (0..rows).step_by(97) {
        let spans = interior.spans(row);
        assert!(!spans.is_empty() && spans.len() < ring.len());
        assert!(interior.crossing.len() + interior.waiting.len() <= ring.len());
    }
    assert!(interior.crossing.capacity() <= 2 * ring.len());
}
