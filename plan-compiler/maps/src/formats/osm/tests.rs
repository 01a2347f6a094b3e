//! XML in, map or mistakes out; readable XML must give the same map as PBF.

mod binary;
mod kinds;
mod mistakes;
mod relations;
mod writer;

use super::*;
use crate::formats::dump::{dump, outcome};
use crate::problem::{Severity, draw as drawn};
use insta::assert_snapshot;
use proptest::prelude::*;
use writer::Nodes;

fn source(text: &str) -> Arc<Source> {
    Arc::new(Source { name: "a.osm".into(), text: text.into() })
}

fn read_with(bytes: &[u8]) -> (Option<Map>, Vec<Problem>) {
    read_binary(Path::new("a.pbf"), bytes, &ReadOptions::default())
}

/// The result for a text, after comparing it with that of its binary encoding.
fn check_file(text: &str) -> String {
    let read_text = read(&source(text), &ReadOptions::default());
    let has_error = read_text.1.iter().any(|problem| problem.severity == Severity::Error);
    if let (Some(map), false) = (&read_text.0, has_error) {
        let extract = xml::parse(&source(text), &mut Vec::new()).unwrap();
        for nodes in [Nodes::Dense, Nodes::Plain] {
            let (binary, problems) = read_with(&writer::write(&extract, nodes));
            assert_eq!(dump(&binary.expect("a map")), dump(map));
            assert_eq!(without_places(&problems), without_places(&read_text.1));
        }
    }
    outcome(&read_text)
}

/// Problems as text without the excerpts, which a binary file does not have.
fn without_places(problems: &[Problem]) -> String {
    let problems = problems.iter().map(|problem| Problem { place: None, ..problem.clone() });
    drawn(&problems.collect::<Vec<_>>(), false)
}

/// Objects in a box of 200 m by 100 m on the equator, with nodes 1 to 8 at the corners of two
/// squares, one within the other, and 9 in the middle of both.
fn check(objects: &str) -> String {
    let nodes = [(1, 2, 2), (2, 6, 2), (3, 6, 6), (4, 2, 6)];
    let within = [(5, 3, 3), (6, 5, 3), (7, 5, 5), (8, 3, 5), (9, 4, 4)];
    let nodes = nodes
        .iter()
        .chain(&within)
        .map(|(id, x, y)| format!("  <node id=\"{id}\" lat=\"0.000{y}\" lon=\"0.000{x}\"/>\n"));
    check_file(&format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<osm version=\"0.6\">\n\
         \x20 <bounds minlat=\"0\" minlon=\"0\" maxlat=\"0.0009\" maxlon=\"0.0018\"/>\n\
         {}{objects}\n</osm>\n",
        nodes.collect::<String>()
    ))
}

/// An editor dropped one of the nodes at 0,0. In XML the excerpt shows it, in PBF its id.
#[test]
fn the_cause_of_an_absurd_extent_is_named() {
    let file = |bounds: &str| {
        let nodes = [(1, 51.0, 7.0), (2, 0.0, 0.0), (3, 51.0, 7.001), (4, 51.001, 7.0)];
        let nodes = nodes
            .map(|(id, lat, lon)| format!("<node id=\"{id}\" lat=\"{lat}\" lon=\"{lon}\"/>\n"));
        format!("<osm version=\"0.6\">\n{bounds}{}</osm>\n", nodes.concat())
    };
    let stray = file("");
    let extract = xml::parse(&source(&stray), &mut Vec::new()).unwrap();
    let binary = read_with(&writer::write(&extract, Nodes::Dense));
    let bounds = "<bounds minlat=\"50\" minlon=\"7\" maxlat=\"52\" maxlon=\"8\"/>\n";
    let beside = "<bounds minlat=\"7\" minlon=\"51\" maxlat=\"7.1\" maxlon=\"51.1\"/>\n";
    let outcomes = [
        check_file(&stray),
        outcome(&binary),
        check_file(&file(bounds)),
        check_file(&file(beside)),
    ];
    assert_snapshot!(outcomes.join("----\n"), @r#"
      × the map is 704 km x 5650 km, but a plan is valid up to 20 km from its centre
       ╭─[a.osm:3:1]
     2 │ <node id="1" lat="51" lon="7"/>
     3 │ <node id="2" lat="0" lon="0"/>
       · ───────────────┬──────────────
       ·                ╰── this
     4 │ <node id="3" lat="51" lon="7.001"/>
       ╰────
      help: crop the map to the area that the robot uses; one stray point can cause this; node 2 at
            latitude 0, longitude 0: far from the others, which lie about latitude 51, longitude 7

    no map
    ----
      × the map is 704 km x 5650 km, but a plan is valid up to 20 km from its centre
      help: crop the map to the area that the robot uses; one stray point can cause this; node 2 at
            latitude 0, longitude 0: far from the others, which lie about latitude 51, longitude 7

    no map
    ----
      × by the file's bounds the map is 71 km x 223 km, but a plan is valid up to 20 km from its
      │ centre
       ╭─[a.osm:2:1]
     1 │ <osm version="0.6">
     2 │ <bounds minlat="50" minlon="7" maxlat="52" maxlon="8"/>
       · ───────────────────────────┬───────────────────────────
       ·                            ╰── this
     3 │ <node id="1" lat="51" lon="7"/>
       ╰────
      help: state the bounds of the area that the robot uses, or none

    no map
    ----
      × everything in the file lies outside its stated bounds
       ╭─[a.osm:2:1]
     1 │ <osm version="0.6">
     2 │ <bounds minlat="7" minlon="51" maxlat="7.1" maxlon="51.1"/>
       · ─────────────────────────────┬─────────────────────────────
       ·                              ╰── this
     3 │ <node id="1" lat="51" lon="7"/>
       ╰────
      help: latitude and longitude are swapped in one of the two: exchange them there

    no map
    "#);
}

fn way(id: i64, nodes: &[i64], tags: &[(&str, &str)]) -> String {
    let nodes: String = nodes.iter().map(|node| format!("<nd ref=\"{node}\"/>")).collect();
    format!("<way id=\"{id}\">{nodes}{}</way>\n", self::tags(tags))
}

fn relation(id: i64, members: &[(i64, &str)], tags: &[(&str, &str)]) -> String {
    let members = members
        .iter()
        .map(|(way, role)| format!("<member type=\"way\" ref=\"{way}\" role=\"{role}\"/>"));
    let members: String = members.collect();
    format!("<relation id=\"{id}\">{members}{}</relation>\n", self::tags(tags))
}

fn tags(tags: &[(&str, &str)]) -> String {
    tags.iter().map(|(key, value)| format!("<tag k=\"{key}\" v=\"{value}\"/>")).collect()
}

const OUTER: [i64; 5] = [1, 2, 3, 4, 1];
const INNER: [i64; 5] = [5, 6, 7, 8, 5];
const BUILDING: (&str, &str) = ("building", "yes");
const MULTIPOLYGON: (&str, &str) = ("type", "multipolygon");

#[test]
fn ways_are_areas_and_walls() {
    let objects = [
        way(1, &OUTER, &[("building", "house"), ("name", "Hall"), ("building:levels", "2")]),
        way(2, &OUTER, &[("building", "no")]),
        way(3, &OUTER, &[("barrier", "fence")]),
        way(4, &[1, 2], &[("barrier", "hedge"), ("height", "1.5")]),
        way(5, &OUTER, &[("barrier", "hedge"), ("area", "yes")]),
        way(6, &INNER, &[("natural", "wood"), ("name", "Spinney")]),
        way(7, &INNER, &[("landuse", "forest")]),
        way(8, &[1, 2, 3], &[("highway", "service")]),
        way(9, &[1, 2], &[]),
        way(10, &[1, 2, 3], &[BUILDING]),
    ];
    assert_snapshot!(check(&objects.concat()), @r#"
      ⚠ outlines that do not close: 1; drawn as walls with free ground inside
      help: cut the extract out with whole objects: `osmium extract --strategy smart`

      ☞ the map is 200.4 m x 99.5 m, by the file's bounds; 0,0 is its centre, latitude 0.00045,
      │ longitude 0.0009; obstacles: 5, areas that weaken radio: 2, zones: 0, named points: 0, not
      │ used: 2 (building=no 1, highway=service 1)
      help: 0,0 depends on the file: `origin = [0.00045, 0.0009]` in the mission file or --origin
            0.00045,0.0009 keeps it in place when the map changes

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    Obstacle "Hall" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586 high 6
    Obstacle "" line -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586 -77.924,-27.644
    Obstacle "" line -77.924,-27.644 -33.396,-27.644 high 1.5
    Obstacle "" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586
    Attenuating "Spinney" polygon -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529
    Attenuating "forest" polygon -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529
    Obstacle "" line -77.924,-27.644 -33.396,-27.644 -33.396,16.586
    "#);
}

#[test]
fn nodes_are_goals_where_they_say_so() {
    let node = |id: i64, tags: &[(&str, &str)]| {
        format!("<node id=\"{id}\" lat=\"0.0001\" lon=\"0.0002\">{}</node>\n", self::tags(tags))
    };
    let objects = [
        node(20, &[("name", "Gate &amp; lodge"), ("goal", "yes")]),
        node(21, &[("name", "Shop")]),
        node(22, &[("name", "Pond"), ("goal", "no")]),
        node(23, &[("goal", "yes")]),
        node(24, &[BUILDING]),
        "<node id=\"-1\" lat=\"0\" lon=\"0\" action=\"delete\"><tag k=\"name\" v=\"x\"/></node>"
            .into(),
    ];
    assert_snapshot!(check(&objects.concat()), @r#"
      ⚠ drawn as points, without an outline: building=yes 1; each blocks one cell
      help: fetch it with outlines: in Overpass end the query with `out geom;`, or with `(._;>;); out
            body;`, or give the point a `radius` in metres

      ☞ the map is 200.4 m x 99.5 m, by the file's bounds; 0,0 is its centre, latitude 0.00045,
      │ longitude 0.0009; obstacles: 1, areas that weaken radio: 0, zones: 0, named points: 1, not
      │ used: 3 (goal=yes 1, name=Pond 1, name=Shop 1)
      help: 0,0 depends on the file: `origin = [0.00045, 0.0009]` in the mission file or --origin
            0.00045,0.0009 keeps it in place when the map changes

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    Obstacle "" circle -77.924,-38.701 radius 0
    point "Gate & lodge" -77.924,-38.701
    "#);
}

#[test]
fn relations_are_areas_with_courtyards() {
    let objects = [
        way(1, &OUTER, &[]),
        way(2, &INNER, &[("natural", "wood")]),
        way(3, &[1, 2, 3], &[]),
        way(4, &[1, 4, 3], &[BUILDING]),
        relation(1, &[(1, "outer"), (2, "inner")], &[MULTIPOLYGON, BUILDING, ("height", "9")]),
        // Joined from two ways; one is reversed and an area itself.
        relation(2, &[(2, "inner"), (3, "outer"), (4, "")], &[MULTIPOLYGON, BUILDING]),
        // Two outer rings; the hole belongs to the ring around it.
        relation(3, &[(2, "outer"), (1, "outer"), (2, "inner")], &[MULTIPOLYGON, BUILDING]),
        relation(4, &[(1, "outer")], &[MULTIPOLYGON, ("landuse", "forest")]),
        relation(5, &[(1, "outer")], &[("type", "boundary"), BUILDING]),
        relation(6, &[(1, "outer")], &[MULTIPOLYGON, ("landuse", "grass")]),
    ];
    assert_snapshot!(check(&objects.concat()), @r#"
      ☞ the map is 200.4 m x 99.5 m, by the file's bounds; 0,0 is its centre, latitude 0.00045,
      │ longitude 0.0009; obstacles: 4, areas that weaken radio: 2, zones: 0, named points: 0, not
      │ used: 2 (building=yes 1, landuse=grass 1)
      help: 0,0 depends on the file: `origin = [0.00045, 0.0009]` in the mission file or --origin
            0.00045,0.0009 keeps it in place when the map changes

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    Attenuating "wood" polygon -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529
    Obstacle "" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586 / -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529 high 9
    Obstacle "" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586 / -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529
    Obstacle "" polygon -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529 / -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529
    Obstacle "" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586 / -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529
    Attenuating "forest" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586
    "#);
}

#[test]
fn an_area_whose_outer_way_has_the_tags_keeps_its_courtyard() {
    let objects = [
        way(1, &OUTER, &[BUILDING, ("name", "Old")]),
        way(2, &INNER, &[]),
        relation(1, &[(1, "outer"), (2, "inner")], &[MULTIPOLYGON]),
    ];
    assert_snapshot!(check(&objects.concat()), @r#"
      ☞ the map is 200.4 m x 99.5 m, by the file's bounds; 0,0 is its centre, latitude 0.00045,
      │ longitude 0.0009; obstacles: 1, areas that weaken radio: 0, zones: 0, named points: 0, not
      │ used: 0
      help: 0,0 depends on the file: `origin = [0.00045, 0.0009]` in the mission file or --origin
            0.00045,0.0009 keeps it in place when the map changes

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    Obstacle "Old" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586 -77.924,16.586 / -66.792,-16.586 -44.528,-16.586 -44.528,5.529 -66.792,5.529
    "#);
}

#[test]
fn what_an_extract_leaves_out_is_counted() {
    let objects = [
        way(1, &[1, 2, 99, 3, 98, 1], &[BUILDING]),
        way(2, &[97, 96], &[("barrier", "wall")]),
        way(3, &[1, 2, 3], &[]),
        relation(1, &[(3, "outer"), (50, "outer"), (51, "inner")], &[MULTIPOLYGON, BUILDING]),
        relation(2, &[(52, "outer")], &[MULTIPOLYGON, ("landuse", "forest")]),
    ];
    assert_snapshot!(check(&objects.concat()), @r#"
      ⚠ outlines that lack nodes: 2, nodes missing: 4; drawn without them
      help: cut the extract out with whole objects: `osmium extract --strategy smart`

      ⚠ areas that lack ways: 2, ways missing: 3; drawn without them
      help: cut the extract out with whole objects: `osmium extract --strategy smart`

      ⚠ outlines that do not close: 1; drawn as walls with free ground inside
      help: cut the extract out with whole objects: `osmium extract --strategy smart`

      ⚠ without coordinates, so not on the map: barrier=wall 1, landuse=forest 1
      help: fetch it with outlines: in Overpass end the query with `out geom;`, or with `(._;>;); out
            body;`

      ☞ the map is 200.4 m x 99.5 m, by the file's bounds; 0,0 is its centre, latitude 0.00045,
      │ longitude 0.0009; obstacles: 2, areas that weaken radio: 0, zones: 0, named points: 0, not
      │ used: 0
      help: 0,0 depends on the file: `origin = [0.00045, 0.0009]` in the mission file or --origin
            0.00045,0.0009 keeps it in place when the map changes

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    Obstacle "" polygon -77.924,-27.644 -33.396,-27.644 -33.396,16.586
    Obstacle "" line -77.924,-27.644 -33.396,-27.644 -33.396,16.586
    "#);
}

/// An extract with everything that the encoding has.
fn sample() -> Vec<u8> {
    let text = format!(
        "<osm><bounds minlat=\"51\" minlon=\"7\" maxlat=\"51.001\" maxlon=\"7.001\"/>\
         <node id=\"1\" lat=\"51\" lon=\"7\"/><node id=\"2\" lat=\"51.0005\" lon=\"7.0005\">{}</node>\
         {}{}</osm>",
        tags(&[("name", "Gate"), ("goal", "yes")]),
        way(1, &[1, 2], &[("barrier", "wall")]),
        relation(1, &[(1, "outer"), (2, "inner")], &[MULTIPOLYGON, BUILDING]),
    );
    let extract = xml::parse(&source(&text), &mut Vec::new()).unwrap();
    writer::write(&extract, Nodes::Dense)
}

fn refusal(bytes: &[u8]) -> String {
    let (map, problems) = read_with(bytes);
    assert!(map.is_none());
    problems.into_iter().map(|problem| problem.message).collect()
}

#[test]
fn damaged_binary_files_are_refused() {
    let good = sample();
    assert!(is_binary(Path::new("a.bin"), &good));
    assert!(is_binary(Path::new("a.osm.PBF"), b"\x00rubbish"));
    assert!(!is_binary(Path::new("a.pbf"), b"<osm/>"));
    let starts = |bytes: &[u8], reason: &str| {
        let got = refusal(bytes);
        assert!(got.starts_with(&format!("a.pbf cannot be read: {reason}")), "{got}");
    };
    starts(&good[..good.len() - 1], "");
    starts(b"", "it is not an OpenStreetMap file");
    starts(b"\x7fELF\x02\x01\x01\x00", "");
    // Valid member types are 0 to 2.
    let kinds = good.windows(4).rposition(|bytes| bytes == [0x52, 2, 1, 1]).expect("kinds");
    let mut other_kind = good.clone();
    other_kind[kinds + 2] = 7;
    starts(&other_kind, "it is damaged");
    let other = writer::with_feature(&good, "OsmSchema-V0.7");
    starts(&other, "it needs a reader that understands OsmSchema-V0.7");
}

proptest! {
    /// Any cut or change gives a result without a panic.
    #[test]
    fn nothing_panics(at in 0usize..4_000, to: u8, cut: bool) {
        let mut bytes = sample();
        let at = at % bytes.len();
        if cut { bytes.truncate(at) } else { bytes[at] = to }
        let _ = read_with(&bytes);
    }

    #[test]
    fn no_text_panics(at in 0usize..4_000, with in "[<>/\"&=a-z0-9\u{e9}]{0,3}", cut in 0usize..30) {
        let mut text = format!(
            "<osm><bounds minlat=\"51\" minlon=\"7\" maxlat=\"51.001\" maxlon=\"7.001\"/>\n\
             <node id=\"1\" lat=\"51\" lon=\"7\"/>\n{}</osm>",
            way(1, &[1, 2], &[BUILDING])
        );
        let at = at % text.len();
        text.replace_range(at..(at + cut).min(text.len()), &with);
        let _ = read(&source(&text), &ReadOptions::default());
    }
}
