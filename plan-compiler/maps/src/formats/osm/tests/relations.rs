//! Multipolygons in, shapes and warnings out.

use super::*;
use crate::formats::tags::TagRules;

/// The lines of an outcome that describe shapes.
fn shapes(outcome: &str) -> Vec<&str> {
    let kinds = ["Obstacle", "Attenuating", "Zone"];
    outcome.lines().filter(|line| kinds.iter().any(|kind| line.starts_with(kind))).collect()
}

fn area(roles: [&str; 2], tag: (&str, &str)) -> String {
    let members = [(1, roles[0]), (2, roles[1])];
    [way(1, &OUTER, &[]), way(2, &INNER, &[]), relation(1, &members, &[MULTIPOLYGON, tag])].concat()
}

/// The shapes of a multipolygon with a tag, with rules.
fn shape_with(tag: (&str, &str), rules: TagRules) -> String {
    let nodes = "<node id=\"1\" lat=\"0\" lon=\"0\"/><node id=\"2\" lat=\"0\" lon=\"0.0002\"/>\
                 <node id=\"3\" lat=\"0.0002\" lon=\"0.0002\"/>";
    let ways = way(1, &[1, 2, 3, 1], &[]);
    let relation = relation(1, &[(1, "outer")], &[MULTIPOLYGON, tag]);
    let text = format!("<osm version=\"0.6\">{nodes}{ways}{relation}</osm>");
    let options = ReadOptions { tags: rules, ..ReadOptions::default() };
    let outcome = outcome(&read(&source(&text), &options));
    let shapes = shapes(&outcome);
    shapes.iter().flat_map(|line| line.split(' ').take(3)).collect::<Vec<_>>().join(" ")
}

#[test]
fn a_multipolygon_of_walls_is_its_rings() {
    let ring = "-77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586 -77.924,-27.644";
    let court = "-66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529 -66.792,-16.586";
    for tag in [("barrier", "wall"), ("barrier", "fence"), ("natural", "coastline")] {
        let outcome = check(&area(["outer", "inner"], tag));
        let expected =
            [format!("Obstacle \"\" line {ring}"), format!("Obstacle \"\" line {court}")];
        let shapes: Vec<String> = shapes(&outcome)
            .iter()
            .map(|line| line.trim_end_matches(" high 0").to_owned())
            .collect();
        assert_eq!(shapes, expected, "{tag:?}");
        assert!(outcome.contains("not used: 0") || outcome.contains("│ used: 0"), "{outcome}");
    }
}

#[test]
fn a_multipolygon_of_other_lines_is_an_area_with_courtyards() {
    for tag in [
        ("waterway", "weir"),
        ("man_made", "embankment"),
        ("railway", "rail"),
        ("highway", "steps"),
        ("natural", "cliff"),
    ] {
        let outcome = check(&area(["outer", "inner"], tag));
        let shapes = shapes(&outcome);
        assert_eq!(shapes.len(), 1, "{tag:?}: {outcome}");
        let is_area = shapes[0].starts_with("Obstacle \"\" polygon ") && shapes[0].contains(" / ");
        assert!(is_area, "{tag:?}: {outcome}");
    }
}

#[test]
fn rules_reach_every_multipolygon() {
    let rule = |text: &str| vec![text.parse().expect("a rule")];
    for tag in [("highway", "pedestrian"), ("aerialway", "station"), ("railway", "platform")] {
        let text = format!("{}={}", tag.0, tag.1);
        let block = TagRules { block: rule(&text), ..TagRules::default() };
        assert_eq!(shape_with(tag, block), "Obstacle \"\" polygon");
        let keep = TagRules { keep: rule(&text), ..TagRules::default() };
        assert_eq!(shape_with(tag, keep), format!("Zone {text:?} polygon"));
        assert_eq!(shape_with(tag, TagRules::default()), "");
    }
    let free = TagRules { free: rule("barrier"), ..TagRules::default() };
    assert_eq!(shape_with(("barrier", "wall"), free), "");
}

/// A wall around a relation leaves its outer way, a building, what it is.
#[test]
fn a_fence_around_an_area_hides_nothing() {
    let objects = [
        way(1, &OUTER, &[BUILDING]),
        relation(1, &[(1, "outer")], &[MULTIPOLYGON, ("barrier", "fence")]),
    ];
    let outcome = check(&objects.concat());
    let kinds: Vec<&str> =
        shapes(&outcome).iter().filter_map(|line| line.split(' ').nth(2)).collect();
    assert_eq!(kinds, ["polygon", "line"], "{outcome}");
}

#[test]
fn an_entrance_opens_the_fence_of_a_multipolygon() {
    let objects = [
        "<node id=\"20\" lat=\"0.0002\" lon=\"0.0004\"><tag k=\"barrier\" v=\"entrance\"/></node>"
            .to_owned(),
        way(1, &[1, 20, 2, 3, 4, 1], &[]),
        relation(1, &[(1, "outer")], &[MULTIPOLYGON, ("barrier", "fence")]),
    ];
    let outcome = check(&objects.concat());
    assert_eq!(shapes(&outcome).len(), 2, "{outcome}");
}

/// A square east of the two of [`check`].
fn east() -> String {
    let nodes = [(20, 9, 2), (21, 12, 2), (22, 12, 5), (23, 9, 5)];
    let nodes = nodes.map(|(id, x, y)| {
        format!("<node id=\"{id}\" lat=\"0.000{y}\" lon=\"{}\"/>", 1e-4 * f64::from(x))
    });
    nodes.concat() + &way(3, &[20, 21, 22, 23, 20], &[])
}

#[test]
fn no_ring_is_lost_by_a_wrong_role() {
    let outside = east()
        + &way(1, &OUTER, &[])
        + &relation(7, &[(1, "outer"), (3, "inner")], &[MULTIPOLYGON, BUILDING]);
    let swapped = area(["inner", "outer"], BUILDING);
    for (objects, expected) in [(outside, "relation 7"), (swapped, "relation 1")] {
        let outcome = check(&objects);
        let kinds: Vec<bool> = shapes(&outcome)
            .iter()
            .map(|line| line.contains(" polygon ") && !line.contains('/'))
            .collect();
        assert_eq!(kinds, [true, true], "{outcome}");
        let warning = format!("inner rings outside every outer ring: 1, first in {expected}");
        assert!(outcome.contains(&warning), "{outcome}");
    }
    let only = way(1, &OUTER, &[]) + &relation(1, &[(1, "inner")], &[MULTIPOLYGON, BUILDING]);
    let outcome = check(&only);
    assert_eq!(shapes(&outcome).len(), 1, "{outcome}");
    assert!(!outcome.contains("without coordinates"), "{outcome}");
}

/// Where the outer ring is cut off, an island must not become an obstacle.
#[test]
fn islands_of_a_cut_lake_stay_free() {
    let lake = |members: &[(i64, &str)]| {
        let objects = [
            way(1, &[1, 2, 3], &[]),
            way(2, &INNER, &[]),
            relation(1, members, &[MULTIPOLYGON, ("natural", "water")]),
        ];
        check(&objects.concat())
    };
    let cut = lake(&[(1, "outer"), (2, "inner")]);
    assert_eq!(shapes(&cut).len(), 1, "{cut}");
    let absent = lake(&[(50, "outer"), (2, "inner")]);
    assert!(shapes(&absent).is_empty(), "{absent}");
    // The outline without the corner that the file lacks runs through the island.
    let corner = way(1, &[1, 2, 99, 4, 1], &[])
        + &way(2, &INNER, &[])
        + &relation(1, &[(1, "outer"), (2, "inner")], &[MULTIPOLYGON, ("natural", "water")]);
    let corner = check(&corner);
    assert_eq!(shapes(&corner).len(), 1, "{corner}");
}
