//! The binary rule on small scenes, and against dense samples of random lines.

mod losses;

use super::*;
use crate::bitmap::Bitmap;
use crate::model::{CellMap, Extent, Feature, Map, Point, Role, Shape, Unknown};
use math::Cell;
use math::scalar::wide;
use proptest::prelude::*;

fn rectangle([x0, y0, x1, y1]: [f64; 4]) -> Shape {
    Shape::Polygon(vec![vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]])
}

fn feature(shape: Shape, role: Role, height_m: Option<f64>) -> Feature {
    Feature { shape, role, name: String::new(), height_m, span: 0..0 }
}

fn map(features: Vec<Feature>) -> Map {
    let extent = Extent { corner: [0.0, 0.0], size: [250.0, 250.0] };
    Map { features, ..Map::empty(extent) }
}

/// Obstacles without a height.
fn obstacles(shapes: Vec<Shape>) -> Map {
    map(shapes.into_iter().map(|shape| feature(shape, Role::Obstacle, None)).collect())
}

#[track_caller]
fn check_sight(map: &Map, settings: &Settings, a: Point, b: Point, expected: bool) {
    let sight = Sight::of(map, settings);
    assert_eq!(sight.is_linked(a, b), expected, "{a:?} to {b:?}");
    assert_eq!(sight.is_linked(b, a), expected, "{b:?} to {a:?}");
}

#[test]
fn a_line_is_free_or_broken() {
    let usual = Settings::default();
    let check = |map: &Map, a, b, expected| check_sight(map, &usual, a, b, expected);
    let house = obstacles(vec![rectangle([10.0, 10.0, 20.0, 30.0])]);
    check(&house, [0.0, 20.0], [40.0, 20.0], false);
    check(&house, [0.0, 31.0], [40.0, 31.0], true);
    check(&house, [0.0, 20.0], [9.0, 20.0], true);
    check(&house, [15.0, 20.0], [16.0, 21.0], false);
    check(&house, [15.0, 0.0], [15.0, 9.9], true);
    check(&house, [0.0, 20.0], [0.0, 20.0], true);
    // It lies diagonally before the corner.
    check(&house, [5.0, 12.0], [12.0, 5.0], true);
    check(&house, [9.0, 12.0], [12.0, 9.0], false);
    let wall = obstacles(vec![Shape::Polyline(vec![[10.0, 0.0], [10.0, 20.0], [30.0, 20.0]])]);
    check(&wall, [0.0, 5.0], [20.0, 5.0], false);
    check(&wall, [0.0, 5.0], [20.0, 30.0], false);
    check(&wall, [11.0, 1.0], [29.0, 19.0], true);
    check(&wall, [0.0, 21.0], [40.0, 21.0], true);
    let silo = obstacles(vec![Shape::Circle { centre: [20.0, 20.0], radius: 5.0 }]);
    check(&silo, [0.0, 24.9], [40.0, 24.9], false);
    check(&silo, [0.0, 25.1], [40.0, 25.1], true);
    check(&silo, [0.0, 20.0], [14.0, 20.0], true);
}

#[test]
fn a_courtyard_is_open_inside() {
    let ring = |low: f64, high: f64| vec![[low, low], [high, low], [high, high], [low, high]];
    let mut hole = ring(20.0, 40.0);
    for _ in 0..2 {
        let house = obstacles(vec![Shape::Polygon(vec![ring(10.0, 50.0), hole.clone()])]);
        let usual = Settings::default();
        check_sight(&house, &usual, [22.0, 22.0], [38.0, 38.0], true);
        check_sight(&house, &usual, [22.0, 22.0], [12.0, 22.0], false);
        check_sight(&house, &usual, [22.0, 22.0], [0.0, 22.0], false);
        check_sight(&house, &usual, [12.0, 22.0], [13.0, 22.0], false);
        // Readers keep the direction in which a file gives a ring.
        hole.reverse();
    }
}

#[test]
fn small_flat_and_attenuating_features_let_a_line_pass() {
    let line = ([0.0, 20.0], [40.0, 20.0]);
    let check = |map: &Map, settings: &Settings, expected| {
        check_sight(map, settings, line.0, line.1, expected);
    };
    let usual = Settings::default();
    let post = obstacles(vec![Shape::Circle { centre: [20.0, 20.0], radius: 1.5 }]);
    check(&post, &usual, true);
    check(&post, &Settings { small_m: 2.9, ..usual }, false);
    let lake = rectangle([10.0, 10.0, 30.0, 30.0]);
    check(&map(vec![feature(lake.clone(), Role::Obstacle, Some(0.0))]), &usual, true);
    let wood = map(vec![feature(lake.clone(), Role::Attenuating, None)]);
    check(&wood, &usual, true);
    check(&wood, &Settings { areas_block: true, ..usual }, false);
    check(
        &map(vec![feature(lake, Role::Zone, None)]),
        &Settings { areas_block: true, ..usual },
        true,
    );
}

fn cell_map(rows: &[&str]) -> Map {
    let (columns, count) = (rows[0].len() as u32, rows.len() as u32);
    let at = |cell: Cell| rows[(count - 1 - cell.row) as usize].as_bytes()[cell.column as usize];
    let of = |kind: u8| Bitmap::from_fn(columns, count, |cell| at(cell) == kind);
    Map::of_cells(CellMap {
        resolution_m: 2.0,
        corner: [-4.0, 10.0],
        occupied: of(b'#'),
        unknown: of(b'?'),
        unknown_as: Unknown::Obstacle,
        turned_from: None,
    })
}

#[test]
fn occupied_cells_break_a_line() {
    let map = cell_map(&[
        "........", //
        ".##...#.", //
        "..##..?.", //
        "........",
    ]);
    let usual = Settings::default();
    let at = |column: f64, row: f64| [-4.0 + 2.0 * column, 10.0 + 2.0 * row];
    let check = |a: [f64; 2], b: [f64; 2], expected| {
        check_sight(&map, &usual, at(a[0], a[1]), at(b[0], b[1]), expected);
    };
    check([0.5, 2.5], [4.5, 2.5], false);
    check([0.5, 0.5], [7.5, 0.5], true);
    check([0.5, 1.5], [3.5, 0.5], true);
    check([0.5, 0.5], [2.5, 3.5], false);
    // Beyond the file's cells there is nothing.
    check([-9.0, -1.0], [20.0, -1.0], true);
    check([-9.0, 1.2], [20.0, 1.4], false);
    // A single cell of 2 m is small, and unknown cells let radio pass.
    check([5.5, 2.5], [7.5, 2.5], true);
    check([5.5, 1.5], [7.5, 1.5], true);
}

#[test]
fn diagonal_walls_and_touching_houses_have_no_gaps() {
    let usual = Settings::default();
    let diagonal = cell_map(&[
        "#....", //
        ".#...", //
        "..#..", //
        "...#.",
    ]);
    let at = |column: f64, row: f64| [-4.0 + 2.0 * column, 10.0 + 2.0 * row];
    for shift in [0.0, 1.0] {
        let (a, b) = (at(0.5 + shift, 0.5 + shift), at(1.5 + shift, 1.5 + shift));
        check_sight(&diagonal, &usual, a, b, shift == 0.0);
    }
    // Exactly through the corner where two occupied cells touch.
    let (a, b) = (at(0.5, 2.5), at(1.5, 3.5));
    check_sight(&diagonal, &usual, a, b, false);
    let model = Model::of(&diagonal, &usual);
    let free = free_space_db(wide::hypot(2.0, 2.0), wavelength_m(2.4));
    assert!(model.loss_db(a, b) > free + 20.0);
    let touching =
        obstacles(vec![rectangle([0.0, 0.0, 10.0, 10.0]), rectangle([10.0, 10.0, 20.0, 20.0])]);
    check_sight(&touching, &usual, [5.0, 15.0], [15.0, 5.0], false);
    let beside =
        obstacles(vec![rectangle([0.0, 0.0, 10.0, 10.0]), rectangle([10.0, 0.0, 20.0, 10.0])]);
    check_sight(&beside, &usual, [10.0, -5.0], [10.0, 15.0], false);
}

/// Whether a point lies inside a shape.
fn holds(shape: &Shape, [x, y]: Point) -> bool {
    match shape {
        Shape::Circle { centre, radius } => wide::hypot(x - centre[0], y - centre[1]) < *radius,
        Shape::Polygon(rings) => {
            rings
                .iter()
                .map(|ring| {
                    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
                    edges
                        .filter(|(a, b)| {
                            (a[1] > y) != (b[1] > y)
                                && x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
                        })
                        .count()
                })
                .sum::<usize>()
                % 2
                == 1
        }
        Shape::Polyline(_) => false,
    }
}

fn point() -> impl Strategy<Value = Point> {
    [0.0..100.0, 0.0..100.0]
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (point(), 2.0..20.0).prop_map(|(centre, radius)| Shape::Circle { centre, radius }),
        [point(), point(), point()].prop_map(|points| Shape::Polygon(vec![points.to_vec()])),
        (point(), 5.0..20.0).prop_map(|([x, y], side): (Point, f64)| {
            let ring =
                |s: f64| vec![[x - s, y - s], [x + s, y - s], [x + s, y + s], [x - s, y + s]];
            Shape::Polygon(vec![ring(side), ring(side / 2.0)])
        }),
    ]
}

proptest! {
    #[test]
    fn stretches_are_where_dense_samples_are_inside(
        shapes in prop::collection::vec(shape(), 1..6), a in point(), b in point(),
    ) {
        const SAMPLES: usize = 2000;
        let map = obstacles(shapes.clone());
        let settings = Settings { small_m: 0.0, ..Settings::default() };
        let sight = Sight::of(&map, &settings);
        let scene = scene::Scene::of(&map, &settings, |_| true);
        let (ray, is_exchanged) = scene::Ray::between(a, b);
        let mut stretches = Vec::new();
        scene.stretches(&ray, &mut stretches);
        prop_assert_eq!(sight.is_linked(a, b), stretches.is_empty());
        prop_assert_eq!(sight.is_linked(a, b), sight.is_linked(b, a));
        for sample in 0..SAMPLES {
            let part = (sample as f64 + 0.5) / SAMPLES as f64;
            let at = [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * part);
            let part = if is_exchanged { 1.0 - part } else { part };
            let is_near_an_end = |span: &[f64; 2]| span.iter().any(|end| (end - part).abs() < 1e-9);
            if stretches.iter().any(|stretch| is_near_an_end(&stretch.span)) {
                continue;
            }
            let expected = shapes.iter().filter(|shape| holds(shape, at)).count();
            let inside = |span: [f64; 2]| span[0] < part && part < span[1];
            let found = stretches.iter().filter(|stretch| inside(stretch.span)).count();
            prop_assert_eq!(found, expected, "{:?}", at);
        }
    }
}
