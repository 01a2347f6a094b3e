//! The formulas against published values, and the model against hand-made sums of them.

use super::*;
use crate::model::{FoliageLoss, LossTerm, Radio};

#[track_caller]
fn is_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected}");
}

/// Wavelength at 2.4 GHz, metres.
const L: f64 = 299_792_458.0 / 2.4e9;

#[test]
fn free_space_is_that_of_p_525() {
    // P.525 in practical units: 32.4 + 20 log10(f / MHz) + 20 log10(d / km).
    for (ghz, metres, expected) in
        [(0.001, 1000.0, 32.45), (2.4, 250.0, 88.01), (0.9, 1000.0, 91.53), (5.8, 100.0, 87.72)]
    {
        is_near(free_space_db(metres, wavelength_m(ghz)), expected, 0.01);
    }
    assert_eq!(free_space_db(0.0, L), 0.0);
    // The laboratory's radio: a margin of 88.9 - 20 log10 d.
    let model = Model::of(&map(Vec::new()), &Settings::default());
    for metres in [1.0, 10.0, 250.0] {
        is_near(model.margin_db([0.0; 2], [0.0, metres]), 88.9 - 20.0 * wide::log10(metres), 0.06);
    }
}

#[test]
fn one_edge_is_that_of_p_526() {
    // Values of the curve J(v) of P.526, figure 9.
    for (v, expected) in [(-0.78, 0.0), (0.0, 6.0), (1.0, 13.9), (2.4, 20.5), (10.0, 32.9)] {
        is_near(knife_edge_db(v), expected, 0.05);
    }
    // T. S. Rappaport, Wireless Communications, example 4.7: wavelength 1/3 m, 1 km to either side.
    for (height, v, loss) in [(25.0, 2.74, 21.7), (0.0, 0.0, 6.0), (-25.0, -2.74, 0.0)] {
        let found = edge_parameter(height, [1000.0, 1000.0], 1.0 / 3.0);
        is_near(found, v, 0.005);
        is_near(knife_edge_db(found), loss, 0.1);
    }
}

/// The least loss is continuous where an edge begins to count.
#[test]
fn an_edge_far_below_the_line_costs_nothing() {
    is_near(knife_edge_db(-0.779), 0.0, 0.02);
    let ends = [Edge { at_m: 0.0, height_m: 10.0 }, Edge { at_m: 100.0, height_m: 10.0 }];
    assert_eq!(edges_db(&[Edge { at_m: 50.0, height_m: 6.0 }], ends, L), 0.0);
    assert_eq!(edges_db(&[], ends, L), 0.0);
}

#[test]
fn several_edges_are_those_of_deygout() {
    let ends = [Edge { at_m: 0.0, height_m: 1.0 }, Edge { at_m: 100.0, height_m: 1.0 }];
    let edge = |at_m, height_m| Edge { at_m, height_m };
    // The main edge is in the middle; the lines to its top pass 3.25 m and 1 m below the others.
    let edges = [edge(25.0, 9.25), edge(50.0, 11.0), edge(75.0, 7.0)];
    let j = |height, distances| knife_edge_db(edge_parameter(height, distances, L));
    let expected = j(10.0, [50.0, 50.0]) + j(3.25, [25.0, 25.0]) + j(1.0, [25.0, 25.0]);
    is_near(edges_db(&edges, ends, L), expected, 1e-9);
    // A fourth edge, less high than these, changes nothing.
    let more = [edges[0], edges[1], edges[2], edge(80.0, 5.0)];
    is_near(edges_db(&more, ends, L), expected, 1e-9);
}

/// P.526 gives two edges of like height as J(v1) + J(v2) + 10 log10((a+b)(b+c) / (b (a+b+c))), each
/// seen from the other.
#[test]
fn a_flat_roof_costs_what_p_526_gives_for_two_edges() {
    let house =
        |height| map(vec![feature(rectangle([20.0, -50.0, 40.0, 50.0]), Role::Obstacle, height)]);
    let model = Model::of(&house(Some(10.0)), &Settings::default());
    let loss = model.loss_db([0.0, 0.0], [60.0, 0.0]);
    let edge = knife_edge_db(edge_parameter(4.5, [20.0, 20.0], L));
    let expected = 2.0 * edge + 10.0 * wide::log10(40.0 * 40.0 / (20.0 * 60.0));
    let free = free_space_db(60.0, L);
    assert!(loss - free > expected, "{loss} {free} {expected}");
    is_near(loss - free, expected, 4.0);
    // Without a height the default of 6 m counts; antennas above the roof see each other.
    let low = Model::of(&house(None), &Settings::default());
    assert!(low.loss_db([0.0, 0.0], [60.0, 0.0]) < loss - 5.0);
    let mast = Settings { antenna_heights_m: [14.0, 14.0], ..Settings::default() };
    is_near(Model::of(&house(Some(10.0)), &mast).loss_db([0.0, 0.0], [60.0, 0.0]), free, 1e-9);
}

#[test]
fn foliage_is_that_of_weissberger() {
    // By hand: 0.45 x 2.4^0.284 x 10 and 1.33 x 2.4^0.284 x 100^0.588, with 2.4^0.284 = 1.28226.
    is_near(foliage_db(&WEISSBERGER, 2.4, 10.0), 5.770, 0.001);
    is_near(foliage_db(&WEISSBERGER, 2.4, 100.0), 25.576, 0.005);
    is_near(foliage_db(&WEISSBERGER, 1.0, 400.0), 45.09, 0.05);
    is_near(foliage_db(&WEISSBERGER, 1.0, 14.0), 6.3, 1e-9);
    assert_eq!(foliage_db(&WEISSBERGER, 1.0, 0.0), 0.0);
}

#[test]
fn foliage_counts_by_depth_once_and_below_its_top() {
    let wood = |x: [f64; 2], height| {
        feature(rectangle([x[0], -50.0, x[1], 50.0]), Role::Attenuating, height)
    };
    let ends = ([0.0, 0.0], [100.0, 0.0]);
    let check = |features: Vec<Feature>, settings: Settings, depth_m: f64| {
        let model = Model::of(&map(features), &settings);
        let high = settings.antenna_heights_m;
        let straight = wide::hypot(100.0, high[1] - high[0]);
        let expected = free_space_db(straight, L) + foliage_db(&WEISSBERGER, 2.4, depth_m);
        is_near(model.loss_db(ends.0, ends.1), expected, 1e-9);
    };
    let usual = Settings::default();
    check(vec![wood([20.0, 50.0], None)], usual, 30.0);
    check(vec![wood([20.0, 50.0], None), wood([40.0, 60.0], None)], usual, 40.0);
    check(vec![wood([20.0, 30.0], None), wood([70.0, 90.0], Some(1.5))], usual, 30.0);
    // The line rises from 0 to 20 m, and leaves 10 m high trees half way.
    let rising = Settings { antenna_heights_m: [0.0, 20.0], ..usual };
    check(vec![wood([20.0, 80.0], None)], rising, 30.0);
    let falling = Settings { antenna_heights_m: [20.0, 0.0], ..usual };
    check(vec![wood([20.0, 80.0], None)], falling, 30.0);
    let above = Settings { antenna_heights_m: [20.0, 20.0], ..usual };
    check(vec![wood([20.0, 80.0], None)], above, 0.0);
}

#[test]
fn a_map_gives_its_own_foliage() {
    let own = FoliageLoss { far: LossTerm { a: 2.66, ..WEISSBERGER.far }, ..WEISSBERGER };
    let wood = feature(rectangle([20.0, -50.0, 60.0, 50.0]), Role::Attenuating, None);
    let map = map(vec![wood]);
    let with = Map { radio: Some(Radio { k1: 0.0, k2: 0.0, foliage: own }), ..map.clone() };
    let loss = |map: &Map| Model::of(map, &Settings::default()).loss_db([0.0; 2], [100.0, 0.0]);
    let free = free_space_db(100.0, L);
    is_near(loss(&with) - free, 2.0 * (loss(&map) - free), 1e-9);
}

#[test]
fn walls_count_where_they_are_the_better_way() {
    let house = obstacles(vec![rectangle([20.0, -50.0, 40.0, 50.0])]);
    let free = free_space_db(60.0, L);
    let check = |wall_db, a: Point, b: Point, excess: f64| {
        let settings = Settings { wall_db: Some(wall_db), ..Settings::default() };
        let distance = wide::hypot(a[0] - b[0], a[1] - b[1]);
        let found = Model::of(&house, &settings).loss_db(a, b) - free_space_db(distance, L);
        is_near(found, excess, 1e-9);
    };
    check(10.0, [0.0, 0.0], [60.0, 0.0], 20.0);
    check(10.0, [30.0, 0.0], [60.0, 0.0], 10.0);
    check(10.0, [25.0, 0.0], [35.0, 0.0], 0.0);
    let over = Model::of(&house, &Settings::default()).loss_db([0.0, 0.0], [60.0, 0.0]) - free;
    check(100.0, [0.0, 0.0], [60.0, 0.0], over);
}

#[test]
fn a_wall_is_one_edge_and_a_post_is_ignored() {
    let wall = Shape::Polyline(vec![[20.0, -50.0], [20.0, 50.0]]);
    let post = Shape::Circle { centre: [30.0, 0.0], radius: 1.0 };
    let model = Model::of(&obstacles(vec![wall, post]), &Settings::default());
    let edge = knife_edge_db(edge_parameter(5.0, [20.0, 40.0], L));
    is_near(model.loss_db([0.0, 0.0], [60.0, 0.0]), free_space_db(60.0, L) + edge, 1e-9);
}

/// The same numbers on every machine: the sum over many links, bit for bit.
#[test]
fn losses_are_the_same_bits_everywhere() {
    let shapes = vec![
        rectangle([40.0, 50.0, 66.0, 120.0]),
        Shape::Circle { centre: [150.0, 150.0], radius: 20.0 },
        Shape::Polyline(vec![[0.0, 180.0], [120.0, 200.0], [240.0, 170.0]]),
    ];
    let mut map = obstacles(shapes);
    map.features.push(feature(rectangle([80.0, 20.0, 140.0, 90.0]), Role::Attenuating, Some(8.0)));
    let settings = Settings { antenna_heights_m: [2.0, 0.5], ..Settings::default() };
    let model = Model::of(&map, &settings);
    let at = |index: u32| [f64::from(index * 37 % 250) + 0.5, f64::from(index * 91 % 250) + 0.25];
    let losses = (0..200).map(|index| model.loss_db(at(index), at(index * 7 + 3)));
    let hash = losses.fold(0_u64, |hash, loss| hash.rotate_left(5) ^ loss.to_bits());
    assert_eq!(hash, 4_924_977_619_139_042_743);
}

proptest! {
    #[test]
    fn losses_are_symmetric_and_at_least_those_of_free_space(
        shapes in prop::collection::vec(shape(), 0..6), a in point(), b in point(),
        heights in [0.5..15.0, 0.5..15.0], is_foliage: bool,
    ) {
        let role = if is_foliage { Role::Attenuating } else { Role::Obstacle };
        let map = map(shapes.into_iter().map(|shape| feature(shape, role, None)).collect());
        let there = Settings { antenna_heights_m: heights, ..Settings::default() };
        let back = Settings { antenna_heights_m: [heights[1], heights[0]], ..there };
        let loss = Model::of(&map, &there).loss_db(a, b);
        prop_assert_eq!(loss.to_bits(), Model::of(&map, &back).loss_db(b, a).to_bits());
        let straight = wide::hypot(wide::hypot(a[0] - b[0], a[1] - b[1]), heights[1] - heights[0]);
        prop_assert!(loss >= free_space_db(straight, L) - 1e-9 && loss.is_finite());
    }
}
