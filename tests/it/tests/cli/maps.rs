//! Messages about mistakes in GeoJSON and OpenStreetMap files.

use super::{Run, check, golden};

/// A feature collection with one feature per line.
fn collection(features: &[&str]) -> String {
    format!("{{\"type\": \"FeatureCollection\", \"features\": [\n{}\n]}}\n", features.join(",\n"))
}

const GATE: &str = r#"{"type": "Feature", "properties": {"name": "Gate"},
 "geometry": {"type": "Point", "coordinates": [7.0005, 51.0005]}}"#;

fn check_geojson(name: &str, text: &str) {
    check(name, &[("yard.geojson", text.as_bytes())], "build yard.geojson", "");
}

fn check_osm(name: &str, text: &str) {
    check(name, &[("yard.osm", text.as_bytes())], "build yard.osm", "");
}

#[test]
fn geojson_with_mistakes() {
    let metres = r#"{"type": "Feature", "properties": {"building": "yes"}, "geometry": {"type": "Polygon",
 "coordinates": [[[385000, 5650000], [385010, 5650000], [385010, 5650010], [385000, 5650000]]]}}"#;
    let open = r#"{"type": "Feature", "properties": {"building": "yes"}, "geometry": {"type": "Polygon",
 "coordinates": [[[7.0001, 51.0001],
                  [7.0002, 51.0001],
                  [7.0002, 51.0002],
                  [7.0001, 51.0002]]]}}"#;
    let turned = r#"{"type": "Feature", "properties": {"name": "Oslo"}, "geometry": {"type": "Point",
 "coordinates": [59.91, 110.75]}}"#;
    check_geojson("geojson_mistakes", &collection(&[GATE, metres, open, turned]));
    check_geojson("geojson_cut_off", &collection(&[GATE]).replace("\n]}", ""));
    let bare = "{\"type\": \"Point\",\n \"coordinates\": [7.0005, 51.0005]}\n";
    let arguments = "build yard.geojson --format geojson";
    check("geojson_without_features", &[("yard.geojson", bare.as_bytes())], arguments, "");
    let utm = r#"{"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}"#;
    let text =
        collection(&[GATE]).replace("\"features\"", &format!("\"crs\": {utm},\n \"features\""));
    check_geojson("geojson_of_another_system", &text);
    let stray = GATE.replace("Gate", "Stray").replace("51.0005", "15.0005");
    check_geojson("geojson_stray_point", &collection(&[GATE, &stray]));
    // Many programs write the whole file in one line; an excerpt shows only the relevant part.
    let many = vec![GATE; 200].join(",");
    let one_line = collection(&[&many, open]).replace('\n', " ");
    check_geojson("geojson_in_one_line", &one_line);
}

#[test]
fn osm_with_mistakes() {
    let osm = |objects: &str| {
        format!(
            "<osm version=\"0.6\">\n<bounds minlat=\"51\" minlon=\"7\" maxlat=\"51.001\" \
             maxlon=\"7.001\"/>\n{objects}\n</osm>\n"
        )
    };
    check_osm(
        "osm_mistakes",
        &osm(
            "<node id=\"1\" lat=\"151\" lon=\"7\"/>\n<node id=\"2\" lat=\"51,0005\" lon=\"7.0005\"/>\n\
              <way id=\"3\">\n  <nd/>\n  <tag k=\"building\" v=\"yes\"/>\n</way>",
        ),
    );
    check_osm("osm_cut_off", &osm("<node id=\"1\" lat=\"51\" lon=\"7\"/>").replace("</osm>\n", ""));
    check_osm("osm_changes", "<osmChange version=\"0.6\">\n</osmChange>\n");
    check_osm("osm_without_a_goal", &osm("<node id=\"1\" lat=\"51\" lon=\"7\"/>"));
    let good = std::fs::read(it::own_map("courtyard.osm.pbf")).expect("a map of our own");
    let pbf = |name: &str, bytes: &[u8]| {
        check(name, &[("yard.osm.pbf", bytes)], "build yard.osm.pbf", "");
    };
    pbf("pbf_cut_off", &good[..good.len() - 10]);
    let mut damaged = good.clone();
    damaged[good.len() / 2] ^= 0x55;
    pbf("pbf_damaged", &damaged);
    pbf("pbf_of_something_else", b"\x7fELF\x02\x01\x00\x00\xff\xfe");
}

#[test]
fn an_extract_that_is_not_whole_is_built_with_warnings() {
    let text = std::fs::read_to_string(it::own_map("courtyard.osm")).expect("a map of our own");
    // Without the courtyard's way and a corner of the shed.
    let start = text.find("  <way id=\"203\"").expect("the way");
    let end = start + text[start..].find("</way>\n").expect("its end") + "</way>\n".len();
    let text = format!("{}{}", &text[..start], &text[end..]);
    let corner = text.find("  <node id=\"112\"").expect("the corner");
    let end = corner + text[corner..].find('\n').expect("its end") + 1;
    let text = format!("{}{}", &text[..corner], &text[end..]);
    let run = Run::new(&[("yard.osm", text.as_bytes())]);
    let ended = run.run("build yard.osm", "");
    assert_eq!(ended.status, 0, "{}", ended.err);
    let (warnings, _) = ended.err.split_once("plans.bin:").expect("a summary");
    golden("warnings_of_an_extract", "build yard.osm", warnings);
}
