//! MissionLab overlays as their authors wrote them, and our own campus.

use maps::formats::{ReadOptions, read};
use maps::problem::{Problem, Severity, draw};
use maps::{Map, Role, Shape};
use std::path::Path;

/// What the maps hold, counted by hand with `grep` in the files outside comments:
/// name, width and height, circles, walls, points besides StartPlace, start, resolution.
type Row = (&'static str, [f64; 2], usize, usize, usize, [f64; 2], Option<f64>);

const REAL: [Row; 11] = [
    ("Empty.ovl", [45.0, 45.0], 0, 0, 0, [5.0, 5.0], None),
    ("FortBenning-demo.ovl", [220.0, 220.0], 0, 84, 35, [123.0, 17.0], Some(1.0)),
    ("LOS_demo.ovl", [45.0, 45.0], 0, 21, 3, [28.0, 13.5], None),
    // ORIGIN 0.1 0.1 and StartPlace 3.2 4.54.
    ("TheWoods.ovl", [21.0, 15.0], 9, 0, 0, [3.3, 4.64], None),
    ("Walls.ovl", [30.0, 30.0], 0, 9, 0, [5.0, 5.0], None),
    // Differences of eastings and northings by Redfearn's series and a numerical meridian arc.
    ("example_utm.ovl", [20.0, 20.0], 0, 0, 1, [9.2367, 10.9988], None),
    ("gt_campus.ovl", [600.0, 400.0], 401, 8, 39, [170.1, 227.8], None),
    ("hospital.ovl", [800.0, 600.0], 20, 23, 9, [107.0, 448.5], None),
    ("recon.ovl", [200.0, 140.0], 42, 14, 8, [50.0, 65.0], None),
    // ORIGIN 0.25 0.5 and StartPlace 3.4 1.84.
    ("robot-lab1.ovl", [15.0, 10.0], 0, 0, 6, [3.65, 2.34], None),
    // One of its 117 objects is MOVABLE.
    ("urban.ovl", [400.0, 400.0], 229, 110, 11, [85.0, 192.5], None),
];

fn understood(path: &Path) -> (Map, Vec<Problem>) {
    let (map, problems) = read(path, &ReadOptions::default());
    let spoilt = problems.iter().any(|problem| problem.severity > Severity::Note);
    assert!(!spoilt, "{}", draw(&problems, false));
    (map.expect("a map without errors"), problems)
}

fn count(map: &Map, wanted: impl Fn(&Shape) -> bool) -> usize {
    map.features.iter().filter(|feature| wanted(&feature.shape)).count()
}

fn near(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4
}

#[test]
fn real_overlays_are_read_completely() {
    let Some(folder) = it::real_data("missionlab") else { return };
    for (name, size, circles, walls, points, start, resolution_m) in REAL {
        let (map, _) = understood(&folder.join(name));
        assert_eq!((map.extent.corner, map.extent.size), ([0.0, 0.0], size), "{name}");
        assert_eq!(count(&map, |shape| matches!(shape, Shape::Circle { .. })), circles, "{name}");
        assert_eq!(count(&map, |shape| matches!(shape, Shape::Polyline(_))), walls, "{name}");
        assert_eq!(map.features.len(), circles + walls, "{name}");
        assert_eq!(map.points.len(), points, "{name}");
        assert!(near(map.start.expect(name).at, start), "{name}");
        assert_eq!(map.resolution_m, resolution_m, "{name}");
    }
}

#[test]
fn a_radius_is_a_radius_and_a_diameter_is_not() {
    let Some(folder) = it::real_data("missionlab") else { return };
    let (map, _) = understood(&folder.join("recon.ovl"));
    // OBSTACLE 35 45 2, then OBJECT 35 45 2 Fixed.
    let at = |feature: &&maps::Feature| match feature.shape {
        Shape::Circle { centre: [35.0, 45.0], radius } => Some(radius),
        _ => None,
    };
    let radii: Vec<f64> = map.features.iter().filter_map(|feature| at(&feature)).collect();
    assert_eq!(radii, [2.0, 1.0]);
}

#[test]
fn a_utm_origin_places_the_map_on_the_globe() {
    let Some(folder) = it::real_data("missionlab") else { return };
    let (map, problems) = understood(&folder.join("example_utm.ovl"));
    assert!(problems.iter().any(|problem| problem.message.contains("WGS-84")));
    let reference = map.reference.expect("a reference");
    assert_eq!((reference.place.lat_e7, reference.place.lon_e7), (349_999_000, 859_999_000));
    assert_eq!(reference.at, [0.0, 0.0]);
    // "start" is as far from StartPlace as StartPlace is from the origin.
    assert_eq!(map.points[0].name, "start");
    assert!(near(map.points[0].at, [18.4734, 21.9977]), "{:?}", map.points[0].at);

    // The robot's map frame gives the same points. North of the UTM grid is not true north; the
    // reference's heading has the difference.
    let frame = math::MapFrame::new(reference.place, reference.at, reference.heading_rad);
    let place = math::GeoPoint::from_degrees(35.0001, 86.0001).expect("on the globe");
    let local = frame.to_local(place).expect("within range");
    let off = [f64::from(local.x) - 18.4734, f64::from(local.y) - 21.9977];
    // The remaining difference is the scale of the UTM grid, 0.9997 here.
    assert!(off[0].abs() < 0.01 && off[1].abs() < 0.01, "{local:?}");
}

#[test]
fn what_is_no_map_is_refused() {
    let Some(folder) = it::real_data("missionlab") else { return };
    let (map, problems) = read(&folder.join("MISSIONLAB_COPYRIGHT"), &ReadOptions::default());
    assert!(map.is_none());
    assert!(problems[0].message.ends_with("is not a map in a known format"), "{}", problems[0]);
    let (map, problems) = read(&folder, &ReadOptions::default());
    assert!(map.is_none());
    assert!(problems[0].message.ends_with("is a directory"), "{}", problems[0]);
}

#[test]
fn the_campus_is_the_same_drawn_as_overlay_and_as_opar() {
    let (overlay, _) = understood(&it::own_map("campus.ovl"));
    let (opar, _) = understood(&it::own_map("campus.opar"));
    assert_eq!(overlay.extent, opar.extent);
    for role in [Role::Obstacle, Role::Attenuating] {
        let of = |map: &Map| {
            let mut corners: Vec<Vec<[i64; 2]>> = map
                .features
                .iter()
                .filter(|feature| feature.role == role)
                .map(|feature| corners(&feature.shape))
                .collect();
            corners.sort();
            corners
        };
        assert_eq!(of(&overlay), of(&opar), "{role:?}");
    }
}

/// The distinct corners of a polygon or closed line, sorted, in decimetres: the drawings have no
/// more digits.
fn corners(shape: &Shape) -> Vec<[i64; 2]> {
    let points = match shape {
        Shape::Polyline(points) => points.clone(),
        Shape::Polygon(rings) => rings.concat(),
        Shape::Circle { .. } => panic!("the campus has no circles"),
    };
    let mut corners: Vec<[i64; 2]> = points
        .iter()
        .map(|[x, y]| [(x * 10.0).round() as i64, (y * 10.0).round() as i64])
        .collect();
    corners.sort_unstable();
    corners.dedup();
    corners
}
