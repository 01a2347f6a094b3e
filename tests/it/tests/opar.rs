//! OPAR scenarios in the layouts that the original reader accepts.

use maps::formats::{ReadOptions, read};
use maps::problem::draw;
use maps::{FoliageLoss, LossTerm, Map, Radio, Role, Shape};

fn understood(name: &str) -> Option<Map> {
    let path = it::real_data("opar")?.join(name);
    let (map, problems) = read(&path, &ReadOptions::default());
    assert!(problems.is_empty(), "{}", draw(&problems, false));
    map
}

/// Checks the outlines' first corners against values computed independently of the reader: the
/// differences in degrees times a degree's length on WGS-84 at section 2's latitude.
fn check(map: &Map, expected: &[(Role, f64, usize, [f64; 2])]) {
    assert_eq!(map.features.len(), expected.len());
    for (feature, (role, height, corners, first)) in map.features.iter().zip(expected) {
        assert_eq!(feature.role, *role, "{}", feature.name);
        assert_eq!(feature.height_m, Some(*height), "{}", feature.name);
        let Shape::Polygon(rings) = &feature.shape else { panic!("{:?}", feature.shape) };
        assert_eq!((rings.len(), rings[0].len()), (1, *corners), "{}", feature.name);
        let [x, y] = rings[0][0];
        assert!((x - first[0]).abs() < 1e-3 && (y - first[1]).abs() < 1e-3, "{x} {y} {first:?}");
    }
}

#[test]
fn a_layout_with_bare_words_between_the_parts() {
    let Some(map) = understood("farm.opar") else { return };
    assert_eq!(map.title.as_deref(), Some("Farm"));
    assert_eq!((map.extent.corner, map.extent.size), ([0.0, 0.0], [200.0, 160.0]));
    let boundary = [[0.0, 0.0], [180.0, 0.0], [200.0, 90.0], [120.0, 160.0], [0.0, 140.0]];
    assert_eq!(map.boundary.as_deref(), Some(&boundary[..]));
    let foliage = FoliageLoss {
        cutoff_m: 14.0,
        near: LossTerm { a: 0.45, b: 0.284, c: 1.0 },
        far: LossTerm { a: 1.33, b: 0.284, c: 0.588 },
    };
    assert_eq!(map.radio, Some(Radio { k1: 0.9, k2: 1.1, foliage }));
    let reference = map.reference.expect("a reference");
    assert_eq!((reference.place.lat_deg(), reference.place.lon_deg()), (51.0, 7.0));
    assert_eq!(map.start.as_ref().map(|start| start.at), Some([0.0, 0.0]));
    check(
        &map,
        &[
            (Role::Obstacle, 6.5, 4, [30.0025, 30.0037]),
            (Role::Attenuating, 9.0, 4, [80.0043, 20.0024]),
            (Role::Obstacle, 4.0, 3, [120.0029, 100.0011]),
        ],
    );
}

#[test]
fn a_layout_with_comments_and_annotations() {
    let Some(map) = understood("street-canyon.opar") else { return };
    assert_eq!(map.title.as_deref(), Some("Street canyon, two blocks"));
    assert_eq!((map.extent.corner, map.extent.size), ([0.0, 0.0], [250.0, 250.0]));
    check(
        &map,
        &[
            (Role::Obstacle, 14.0, 4, [20.0074, 60.0068]),
            (Role::Obstacle, 10.0, 6, [20.0074, 110.0310]),
            (Role::Obstacle, 22.0, 4, [139.9594, 60.0068]),
            (Role::Obstacle, 9.0, 4, [149.9631, 120.0136]),
            (Role::Obstacle, 12.0, 4, [30.0111, 175.0291]),
            (Role::Obstacle, 18.0, 4, [139.9594, 190.0031]),
            (Role::Attenuating, 7.0, 4, [95.0353, 69.9895]),
            (Role::Attenuating, 6.0, 4, [110.0409, 160.0552]),
            (Role::Attenuating, 5.0, 4, [5.0019, 9.9827]),
        ],
    );
}
