//! Small samples of what servers, editors and converters write.

use super::*;
use crate::formats::tags::TagRules;

/// The four corners of a building of 20 m by 12 m near Greenwich.
const CORNERS: [(f64, f64); 4] = [
    (51.4778461, -0.0016439),
    (51.4778461, -0.0013561),
    (51.4779539, -0.0013561),
    (51.4779539, -0.0016439),
];
const BOUNDS: &str = "<bounds minlat=\"51.4777921\" minlon=\"-0.0017879\" maxlat=\"51.4780079\" maxlon=\"-0.0012121\"/>";
const BUILDING_TAG: &str = "<tag k=\"building\" v=\"yes\"/>";

fn nodes() -> String {
    let node = |(index, (lat, lon)): (usize, &(f64, f64))| {
        format!("<node id=\"{}\" lat=\"{lat}\" lon=\"{lon}\"/>\n", index + 1)
    };
    CORNERS.iter().enumerate().map(node).collect()
}

fn refs(nodes: &[usize]) -> String {
    nodes.iter().map(|node| format!("<nd ref=\"{node}\"/>")).collect()
}

fn read_as(text: &str, options: &ReadOptions) -> (Map, String) {
    let (map, problems) = read(&source(text), options);
    let messages = drawn(&problems, false);
    (map.unwrap_or_else(|| panic!("no map\n{messages}")), messages)
}

fn in_osm(objects: &str) -> (Map, String) {
    read_as(&format!("<osm version=\"0.6\">{objects}</osm>"), &ReadOptions::default())
}

/// Expects an error with these words.
fn refuses(text: &str, words: &[&str]) {
    let (map, problems) = read(&source(text), &ReadOptions::default());
    let messages = drawn(&problems, false).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(map.is_none(), "{text}");
    words.iter().for_each(|word| assert!(messages.contains(word), "{word} missing in\n{messages}"));
}

/// The corners of the only feature's rings.
fn rings(map: &Map) -> Vec<usize> {
    assert_eq!(map.features.len(), 1, "{map:?}");
    match &map.features[0].shape {
        Shape::Polygon(rings) => rings.iter().map(Vec::len).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn bounds_of_joined_files_are_one_and_those_of_ways_none() {
    let east = BOUNDS.replace("-0.0012121", "-0.0006364").replace("-0.0017879", "-0.0012121");
    let way = format!(
        "<way id=\"1\"><bounds minlat=\"0\" minlon=\"0\" maxlat=\"1\" maxlon=\"1\"/>{}{BUILDING_TAG}</way>",
        refs(&[1, 2, 3, 4, 1])
    );
    let (map, _) = in_osm(&format!("{BOUNDS}{east}{}{way}", nodes()));
    let [width, height] = map.extent.size.map(f64::round);
    assert_eq!((width, height), (80.0, 24.0));
    let (map, _) = in_osm(&format!("<bound box=\"51.47,-0.002,51.48,-0.001\"/>{}{way}", nodes()));
    assert_eq!(map.extent.size[1].round(), 1113.0);
}

/// Overpass's `out geom;`: places beside references, and in members.
#[test]
fn places_in_ways_and_members_are_used() {
    let nd = |at: usize| {
        format!("<nd ref=\"{at}\" lat=\"{}\" lon=\"{}\"/>", CORNERS[at - 1].0, CORNERS[at - 1].1)
    };
    let way: String = [1, 2, 3, 4, 1].map(nd).concat();
    let (map, _) = in_osm(&format!("<way id=\"1\">{way}{BUILDING_TAG}</way>"));
    assert_eq!(rings(&map), [4]);
    let bare = |at: usize| nd(at).replace(&format!("ref=\"{at}\" "), "");
    let member = |id: usize, nodes: &[usize]| {
        let nodes: String = nodes.iter().map(|at| bare(*at)).collect();
        format!("<member type=\"way\" ref=\"{id}\" role=\"outer\">{nodes}</member>")
    };
    let relation = format!(
        "<relation id=\"1\">{}{}<tag k=\"type\" v=\"multipolygon\"/>{BUILDING_TAG}</relation>",
        member(7, &[1, 2, 3]),
        member(8, &[1, 4, 3])
    );
    let (map, messages) = in_osm(&relation);
    assert_eq!(rings(&map), [4], "{messages}");
    // Cut off at the border of the requested area.
    let (_, messages) = in_osm(&relation.replace(&bare(2), "<nd/>"));
    assert!(messages.contains("nodes missing: 1"), "{messages}");
}

#[test]
fn repeated_members_count_once() {
    let ways =
        format!("<way id=\"1\">{}</way><way id=\"2\">{}</way>", refs(&[1, 2, 3]), refs(&[3, 4, 1]));
    let member = |id: usize| format!("<member type=\"way\" ref=\"{id}\" role=\"outer\"/>");
    let relation = format!(
        "<relation id=\"1\">{}{}{}<tag k=\"type\" v=\"multipolygon\"/>{BUILDING_TAG}</relation>",
        member(1),
        member(2),
        member(1)
    );
    let (map, messages) = in_osm(&format!("{BOUNDS}{}{ways}{relation}", nodes()));
    assert_eq!(rings(&map), [4], "{messages}");
}

#[test]
fn courtyards_that_share_a_wall_are_one() {
    let within =
        [(5, 50, 20), (6, 100, 20), (7, 100, 80), (8, 50, 80), (9, 150, 20), (10, 150, 80)];
    let nodes: String = [(1, 0, 0), (2, 200, 0), (3, 200, 100), (4, 0, 100)]
        .iter()
        .chain(&within)
        .map(|(id, x, y)| {
            format!(
                "<node id=\"{id}\" lat=\"{}\" lon=\"{}\"/>",
                f64::from(*y) * 1e-6,
                f64::from(*x) * 1e-6
            )
        })
        .collect();
    let ways = [[1, 2, 3, 4, 1], [5, 6, 7, 8, 5], [6, 9, 10, 7, 6]];
    let ways: String = ways
        .iter()
        .enumerate()
        .map(|(id, nodes)| format!("<way id=\"{}\">{}</way>", id + 1, refs(nodes)))
        .collect();
    let member =
        |id: usize, role: &str| format!("<member type=\"way\" ref=\"{id}\" role=\"{role}\"/>");
    let relation = |tags: &str| {
        format!(
            "<relation id=\"1\">{}{}{}<tag k=\"type\" v=\"multipolygon\"/>{tags}</relation>",
            member(1, "outer"),
            member(2, "inner"),
            member(3, "inner")
        )
    };
    let (map, _) = in_osm(&format!("{nodes}{ways}{}", relation(BUILDING_TAG)));
    assert_eq!(rings(&map), [4, 6]);
    // As before 2017: the outer way has the tags, the relation only a source.
    let old = ways.replacen("</way>", &format!("{BUILDING_TAG}</way>"), 1);
    let (map, _) = in_osm(&format!("{nodes}{old}{}", relation("<tag k=\"source\" v=\"survey\"/>")));
    assert_eq!(rings(&map), [4, 6]);
}

#[test]
fn deleted_objects_are_gone_and_the_newest_version_counts() {
    let way = |attributes: &str, tag: &str| {
        format!("<way id=\"1\" {attributes}>{}{tag}</way>", refs(&[1, 2, 3, 4, 1]))
    };
    let count = |ways: &str| in_osm(&format!("{BOUNDS}{}{ways}", nodes())).0.features.len();
    assert_eq!(count(&way("version=\"1\"", BUILDING_TAG)), 1);
    let old = way("version=\"1\" visible=\"true\"", BUILDING_TAG);
    assert_eq!(count(&format!("{old}<way id=\"1\" version=\"2\" visible=\"false\"/>")), 0);
    assert_eq!(count(&format!("<way id=\"1\" version=\"2\" visible=\"false\"/>{old}")), 0);
    assert_eq!(count(&way("action=\"delete\"", BUILDING_TAG)), 0);
    assert_eq!(count(&format!("{old}{}", way("version=\"3\"", ""))), 0);
    assert_eq!(count(&format!("{}{old}", way("version=\"3\"", BUILDING_TAG))), 1);
}

#[test]
fn objects_without_their_outline_are_reported() {
    let reports = |objects: &str, words: &[&str]| {
        let (map, messages) = in_osm(&format!("{BOUNDS}{objects}"));
        let messages = messages.split_whitespace().collect::<Vec<_>>().join(" ");
        words
            .iter()
            .for_each(|word| assert!(messages.contains(word), "{word} missing in\n{messages}"));
        assert!(messages.contains('\u{26a0}'), "{messages}");
        map
    };
    let nowhere = "without coordinates, so not on the map: building=yes 1";
    reports(
        &format!("<way id=\"1\"><center lat=\"51.4779\" lon=\"-0.0015\"/>{BUILDING_TAG}</way>"),
        &[nowhere, "out geom;"],
    );
    reports(&format!("<way id=\"1\">{}{BUILDING_TAG}</way>", refs(&[1, 2, 3])), &[nowhere]);
    reports(
        &format!(
            "<relation id=\"1\"><tag k=\"type\" v=\"multipolygon\"/>{BUILDING_TAG}</relation>"
        ),
        &[nowhere],
    );
    let node = format!("<node id=\"1\" lat=\"51.4779\" lon=\"-0.0015\">{BUILDING_TAG}</node>");
    let map = reports(&node, &["drawn as points, without an outline: building=yes 1"]);
    assert_eq!(map.features.len(), 1);
}

#[test]
fn ways_without_any_node_are_named() {
    let words = ["the file has 1 ways and relations, but no positions of nodes", "out geom;"];
    refuses(&format!("<osm><way id=\"1\">{}{BUILDING_TAG}</way></osm>", refs(&[1, 2])), &words);
    let way =
        "{\"type\": \"way\", \"id\": 1, \"nodes\": [1, 2], \"tags\": {\"building\": \"yes\"}}";
    refuses(&format!("{{\"version\": 0.6, \"elements\": [{way}]}}"), &words);
}

#[test]
fn a_map_without_obstacles_lists_its_objects() {
    let way = |id: usize, key: &str, value: &str| {
        format!("<way id=\"{id}\">{}<tag k=\"{key}\" v=\"{value}\"/></way>", refs(&[1, 2]))
    };
    let ways =
        [way(1, "highway", "track"), way(2, "highway", "track"), way(3, "landuse", "meadow")];
    let (_, messages) = in_osm(&format!("{BOUNDS}{}{}", nodes(), ways.concat()));
    let messages = messages.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(messages.contains("\u{26a0} nothing on the map is an obstacle; not used: highway=track 2, landuse=meadow 1"), "{messages}");
    // An empty field with bounds is accepted.
    let (_, messages) = in_osm(&format!("{BOUNDS}{}", nodes()));
    assert!(!messages.contains('\u{26a0}'), "{messages}");
}

#[test]
fn water_blocks_a_rover_and_carries_a_boat() {
    let pond =
        format!("<way id=\"1\">{}<tag k=\"natural\" v=\"water\"/></way>", refs(&[1, 2, 3, 4, 1]));
    let file = format!("<osm>{BOUNDS}{}{pond}</osm>", nodes());
    let (map, _) = read_as(&file, &ReadOptions::default());
    assert_eq!(rings(&map), [4]);
    let free = vec!["natural=water".parse().expect("a rule")];
    let tags = TagRules { free, ..TagRules::default() };
    let (map, messages) = read_as(&file, &ReadOptions { tags, ..ReadOptions::default() });
    assert!(
        map.features.is_empty() && messages.contains("not used: natural=water 1"),
        "{messages}"
    );
}

#[test]
fn gates_open_their_fence_on_request() {
    let gate = "<node id=\"5\" lat=\"51.4778461\" lon=\"-0.0015\"><tag k=\"barrier\" v=\"gate\"/><tag k=\"width\" v=\"3\"/></node>";
    let fence = format!(
        "<way id=\"1\">{}<tag k=\"barrier\" v=\"fence\"/></way>",
        refs(&[1, 5, 2, 3, 4, 1])
    );
    let file = format!("<osm>{BOUNDS}{}{gate}{fence}</osm>", nodes());
    let (map, _) = read_as(&file, &ReadOptions::default());
    assert!(
        matches!(&map.features[..], [Feature { shape: Shape::Polyline(line), .. }] if line.len() == 6)
    );
    let open = ReadOptions {
        tags: TagRules { open_gates: true, ..TagRules::default() },
        ..ReadOptions::default()
    };
    let (map, messages) = read_as(&file, &open);
    let ends: Vec<Point> = map
        .features
        .iter()
        .flat_map(|feature| match &feature.shape {
            Shape::Polyline(line) => [line[0], line[line.len() - 1]],
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(ends.len(), 4, "{messages}");
    let gap = ends[2][0] - ends[1][0];
    assert!((gap - 3.0).abs() < 1e-6, "{gap}");
    let (_, messages) = read_as(&file.replace("gate", "stile"), &open);
    assert!(messages.contains("the map has no gates"), "{messages}");
}

#[test]
fn an_origin_that_is_given_is_kept() {
    let origin = GeoPoint::from_degrees(51.4779, -0.0015);
    let options = ReadOptions { origin, ..ReadOptions::default() };
    let place = |objects: &str| {
        let (map, messages) = read_as(&format!("<osm>{}{objects}</osm>", nodes()), &options);
        assert!(messages.contains("0,0 is the given origin"), "{messages}");
        map.reference.map(|reference| reference.place)
    };
    assert_eq!(place(""), origin);
    assert_eq!(place("<node id=\"9\" lat=\"51.49\" lon=\"-0.001\"/>"), origin);
    let (_, messages) = in_osm(&nodes());
    assert!(
        messages.contains("--origin") && messages.contains("depends on the file"),
        "{messages}"
    );
}

#[test]
fn an_answer_of_overpass_in_json_is_the_same_map() {
    let nodes: Vec<String> = CORNERS
        .iter()
        .enumerate()
        .map(|(index, (lat, lon))| {
            format!("{{\"type\": \"node\", \"id\": {}, \"lat\": {lat}, \"lon\": {lon}}}", index + 1)
        })
        .collect();
    let way = "{\"type\": \"way\", \"id\": 1, \"nodes\": [1, 2, 3, 4, 1], \"tags\": {\"building\": \"yes\"}}";
    let answer = |elements: &str, more: &str| {
        format!(
            "{{\"version\": 0.6, \"generator\": \"Overpass API\", \"elements\": [{elements}]{more}}}"
        )
    };
    let (map, _) =
        read_as(&answer(&format!("{}, {way}", nodes.join(", ")), ""), &ReadOptions::default());
    assert_eq!(rings(&map), [4]);
    let places: Vec<String> = [0, 1, 2, 3, 0]
        .map(|at| format!("{{\"lat\": {}, \"lon\": {}}}", CORNERS[at].0, CORNERS[at].1))
        .to_vec();
    let geometry = format!("\"geometry\": [{}]", places.join(", "));
    let with_geometry = way.replace("\"tags\"", &format!("{geometry}, \"tags\""));
    let (map, _) = read_as(&answer(&with_geometry, ""), &ReadOptions::default());
    assert_eq!(rings(&map), [4]);
    let relation = format!(
        "{{\"type\": \"relation\", \"id\": 1, \"members\": [{{\"type\": \"way\", \"ref\": 5, \"role\": \"outer\", {geometry}}}], \"tags\": {{\"type\": \"multipolygon\", \"building\": \"yes\"}}}}"
    );
    let (map, _) = read_as(&answer(&relation, ""), &ReadOptions::default());
    assert_eq!(rings(&map), [4]);
    let (_, messages) = read_as(
        &answer(&nodes.join(", "), ", \"remark\": \"Query timed out\""),
        &ReadOptions::default(),
    );
    assert!(messages.contains("the server remarks: Query timed out"), "{messages}");
    refuses(
        &answer("{\"type\": \"node\"}", ""),
        &["not an answer from Overpass", "missing field `id`"],
    );
    let whole = answer("{\"type\": \"way\", \"id\": 1, \"\u{e9}", "");
    let cut = whole.split_inclusive('\u{e9}').next().expect("a letter");
    refuses(cut, &["not an answer from Overpass", "a.osm:1:"]);
}

#[test]
fn files_that_are_not_extracts_are_named() {
    refuses(
        "<osmChange version=\"0.6\"><delete><way id=\"1\"/></delete></osmChange>",
        &["list of changes (.osc)", "osmium apply-changes"],
    );
    refuses(
        "<?xml version=\"1.0\"?><!DOCTYPE html><html><p>Error: runtime error, see <osm</p></html>",
        &["web page"],
    );
    refuses("<gpx></gpx>", &["not an OpenStreetMap extract"]);
}

/// Limits refuse quadratic work and endless nesting.
#[test]
fn attributes_and_nesting_are_bounded() {
    let attributes: String = (0..100_000).map(|n| format!(" a{n}=\"\"")).collect();
    refuses(&format!("<osm><node{attributes}/></osm>"), &["more than 64 attributes"]);
    refuses("<osm><node id=\"1\" id=\"2\"/></osm>", &["is given twice"]);
    refuses(&format!("<osm>{}", "<a>".repeat(100_000)), &["nested deeper than 64"]);
    refuses(&format!("<osm>{}", "<node/>".repeat(100_000)), &["<node> has no id"]);
}

#[test]
fn a_text_beyond_the_budget_is_refused() {
    let text = format!("<osm><way id=\"1\">{}</way></osm>", "<nd ref=\"1\"/>".repeat(1000));
    let mut problems = Vec::new();
    assert!(xml::parse_within(&source(&text), &mut problems, 8 << 10).is_none());
    assert!(
        problems[0].message.contains("larger than a robot's map needs to be"),
        "{}",
        problems[0]
    );
    assert!(xml::parse_within(&source(&text), &mut Vec::new(), 32 << 10).is_some());
}

#[test]
fn a_radius_that_is_not_a_length_is_an_error() {
    let tree = |radius: &str| {
        let tags = format!("<tag k=\"natural\" v=\"tree\"/><tag k=\"radius\" v=\"{radius}\"/>");
        let node = format!("<node id=\"5\" lat=\"51.4779\" lon=\"-0.0015\">{tags}</node>");
        let text = format!("<osm version=\"0.6\">{BOUNDS}\n{node}</osm>");
        let (map, problems) = read(&source(&text), &ReadOptions::default());
        (map, drawn(&problems, false))
    };
    for radius in ["4", "4 m", "12 ft", "0"] {
        let (map, messages) = tree(radius);
        assert!(map.is_some() && !messages.contains('\u{d7}'), "{messages}");
    }
    for radius in ["4,5", "-4", "big", "3-4", "20001"] {
        let (_, messages) = tree(radius);
        let message =
            format!("\u{d7} the radius of node 5 is not a length from 0 to 20000 m: {radius}");
        assert!(messages.contains(&message) && messages.contains("a.osm:2:"), "{messages}");
    }
    // Of what does not block, a radius has no effect.
    let (map, messages) = in_osm(&format!(
        "{BOUNDS}<node id=\"5\" lat=\"51.4779\" lon=\"-0.0015\"><tag k=\"radius\" v=\"big\"/></node>"
    ));
    assert!(map.features.is_empty(), "{messages}");
}
