//! GeoJSON in, map or mistakes out.

mod kinds;
mod mistakes;

use super::*;
use crate::formats::dump::outcome;
use insta::assert_snapshot;
use proptest::prelude::*;

fn check(text: &str) -> String {
    let source = Arc::new(Source { name: "a.geojson".into(), text: text.into() });
    outcome(&read(&source, &ReadOptions::default()))
}

/// Features in a box of 200 m by 100 m on the equator, accurate to a decimetre.
fn check_features(features: &str) -> String {
    let text = format!(
        "{{\"type\": \"FeatureCollection\", \"bbox\": [0, 0, 0.0018, 0.0009], \"features\": [\n\
         {features}\n]}}\n"
    );
    check(&text)
}

fn feature(kind: &str, coordinates: &str, properties: &str) -> String {
    format!(
        "{{\"type\": \"Feature\", \"properties\": {{{properties}}}, \"geometry\": \
         {{\"type\": \"{kind}\", \"coordinates\": {coordinates}}}}}"
    )
}

/// A square of 0.0001 degrees from a corner.
fn ring(lon: f64, lat: f64, side: f64) -> String {
    let (east, north) = (lon + side, lat + side);
    format!(
        "[[{lon}, {lat}], [{east}, {lat}], [{east}, {north}], [{lon}, {north}], [{lon}, {lat}]]"
    )
}

#[test]
fn every_geometry_is_drawn() {
    let square = ring(0.0, 0.0, 0.0001);
    let hole = ring(0.00002, 0.00002, 0.00002);
    let other = ring(0.001, 0.0005, 0.0001);
    let features = [
        feature("Polygon", &format!("[{square}, {hole}]"), r#""building": "yes", "height": 7.5"#),
        feature("MultiPolygon", &format!("[[{square}], [{other}]]"), r#""obstacle": true"#),
        feature("LineString", "[[0, 0], [0.001, 0, 12]]", r#""building": 1, "name": "Wall""#),
        feature("MultiLineString", "[[[0, 0], [0.001, 0]]]", r#""barrier": "fence""#),
        feature("Polygon", &format!("[{square}]"), r#""barrier": "hedge""#),
        feature("Point", "[0.0009, 0.00045]", r#""obstacle": "tree", "radius": 2.5"#),
        feature("MultiPoint", "[[0, 0], [0.001, 0]]", r#""obstacle": "post""#),
        feature("Polygon", &format!("[{square}]"), r#""natural": "wood", "height": "9 m""#),
        feature("Polygon", &format!("[{square}]"), r#""layer": "comms", "name": "north""#),
        feature("Polygon", &format!("[{square}]"), r#""layer": "night", "height": 3"#),
        feature("Point", "[0.0009, 0.0009]", r#""name": " Gate ""#),
        feature("Point", "[0.0009, 0.0009]", r#""name": "Shop", "goal": false"#),
        feature("Polygon", &format!("[{square}]"), r#""building": "no""#),
        r#"{"type": "Feature", "geometry": null, "properties": null}"#.into(),
        format!(
            "{{\"type\": \"Feature\", \"properties\": {{\"building\": \"yes\"}}, \"geometry\": \
             {{\"type\": \"GeometryCollection\", \"geometries\": [{{\"type\": \"Point\", \
             \"coordinates\": [0, 0]}}, {{\"type\": \"Polygon\", \"coordinates\": [{square}]}}]}}}}"
        ),
    ];
    assert_snapshot!(check_features(&features.join(",\n")), @r#"
      ☞ the map is 200.4 m x 99.5 m, by the file's bounds; 0,0 is its centre, latitude 0.00045,
      │ longitude 0.0009; obstacles: 11, areas that weaken radio: 2, zones: 1, named points: 1, not
      │ used: 3 (building=no 1, name=Shop 1, no tags 1)
      help: 0,0 depends on the file: `origin = [0.00045, 0.0009]` in the mission file or --origin
            0.00045,0.0009 keeps it in place when the map changes

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    Obstacle "" polygon -89.056,-49.758 -89.056,-38.701 -100.188,-38.701 -100.188,-49.758 / -95.735,-47.547 -95.735,-45.335 -97.961,-45.335 -97.961,-47.547 high 7.5
    Obstacle "" polygon -89.056,-49.758 -89.056,-38.701 -100.188,-38.701 -100.188,-49.758
    Obstacle "" polygon 22.264,5.529 22.264,16.586 11.132,16.586 11.132,5.529
    Obstacle "Wall" line -100.188,-49.758 11.132,-49.758
    Obstacle "" line -100.188,-49.758 11.132,-49.758
    Obstacle "" line -100.188,-49.758 -89.056,-49.758 -89.056,-38.701 -100.188,-38.701 -100.188,-49.758
    Obstacle "" circle 0,0 radius 2.5
    Obstacle "" circle -100.188,-49.758 radius 0
    Obstacle "" circle 11.132,-49.758 radius 0
    Attenuating "wood" polygon -89.056,-49.758 -89.056,-38.701 -100.188,-38.701 -100.188,-49.758 high 9
    Attenuating "north" polygon -89.056,-49.758 -89.056,-38.701 -100.188,-38.701 -100.188,-49.758
    Zone "night" polygon -89.056,-49.758 -89.056,-38.701 -100.188,-38.701 -100.188,-49.758
    Obstacle "" circle -100.188,-49.758 radius 0
    Obstacle "" polygon -89.056,-49.758 -89.056,-38.701 -100.188,-38.701 -100.188,-49.758
    point "Gate" 0,49.758
    "#);
}

#[test]
fn a_feature_may_stand_alone_and_its_coordinates_make_the_extent() {
    let text = feature("Point", "[7.001, 51.0005]", r#""name": "Gate""#);
    assert_snapshot!(check(&text), @r#"
      ☞ the map is 20 m x 20 m, 10 m around its contents; 0,0 is its centre, latitude 51.0005,
      │ longitude 7.001; obstacles: 0, areas that weaken radio: 0, zones: 0, named points: 1, not
      │ used: 0
      help: 0,0 depends on the file: `origin = [51.0005, 7.001]` in the mission file or --origin
            51.0005,7.001 keeps it in place when the map changes

    extent -10,-10 + 20,20
    reference 51.0005 7.001 at 0,0 heading 0
    point "Gate" 0,0
    "#);
}

/// Points at the position, not at its feature, and blames neither of two equally distant groups.
#[test]
fn the_position_that_makes_the_extent_absurd_is_shown() {
    let collection = |features: &[String]| {
        let text = features.join(",\n");
        check(&format!("{{\"type\": \"FeatureCollection\", \"features\": [\n{text}\n]}}"))
    };
    let gate = feature("Point", "[7, 51]", "");
    let wall = "[[7, 51], [7.001, 51], [7.001, 15.001], [7.001, 51.001]]";
    let wall = feature("LineString", wall, "\"building\": 1");
    let nowhere = feature("Point", "[0, 0]", "");
    let outcomes = [
        collection(&[nowhere.clone(), gate.clone(), gate.clone()]),
        collection(&[gate.clone(), wall]),
        collection(&[gate, nowhere]),
    ];
    assert_snapshot!(outcomes.join("----\n"), @r#"
      × the map is 704 km x 5650 km, but a plan is valid up to 20 km from its centre
       ╭─[a.geojson:2:84]
     1 │ {"type": "FeatureCollection", "features": [
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ·                                                                                    ───┬──
       ·                                                                                       ╰── far from the others, which lie about latitude 51, longitude 7
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [7, 51]}},
       ╰────
      help: crop the map to the area that the robot uses; one stray point can cause this

    no map
    ----
      × the map is 1 km x 3993 km, but a plan is valid up to 20 km from its centre
       ╭─[a.geojson:3:125]
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [7, 51]}},
     3 │ {"type": "Feature", "properties": {"building": 1}, "geometry": {"type": "LineString", "coordinates": [[7, 51], [7.001, 51], [7.001, 15.001], [7.001, 51.001]]}}
       ·                                                                                                                             ───────┬───────
       ·                                                                                                                                    ╰── far from the others, which lie about latitude 51, longitude 7.001
     4 │ ]}
       ╰────
      help: crop the map to the area that the robot uses; one stray point can cause this

    no map
    ----
      × the map is 704 km x 5650 km, but a plan is valid up to 20 km from its centre
       ╭─[a.geojson:2:84]
     1 │ {"type": "FeatureCollection", "features": [
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [7, 51]}},
       ·                                                                                    ───┬───
       ·                                                                                       ╰── either this or the part about latitude 0, longitude 0 is misplaced
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 0]}}
       ╰────
      help: crop the map to the area that the robot uses; one stray point can cause this

    no map
    "#);
}

#[test]
fn a_known_system_is_accepted() {
    for name in ["urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"] {
        let point = feature("Point", "[7, 51]", r#""name": "Gate""#);
        let crs = format!("{{\"type\": \"name\", \"properties\": {{\"name\": \"{name}\"}}}}");
        let text = format!(
            "{{\"type\": \"FeatureCollection\", \"crs\": {crs}, \"name\": \"yard\", \
             \"features\": [{point}]}}"
        );
        assert!(check(&text).contains("title \"yard\""), "{}", check(&text));
    }
}

proptest! {
    /// Any cut or change gives a result without a panic.
    #[test]
    fn nothing_panics(at in 0usize..2_000, with in "[\\[\\]{}\",:0-9.e-]{0,3}", cut in 0usize..30) {
        let square = ring(0.0, 0.0, 0.0001);
        let mut text = format!(
            "{{\"type\": \"FeatureCollection\", \"bbox\": [0, 0, 0.001, 0.001], \"features\": [{}, {}]}}",
            feature("Polygon", &format!("[{square}]"), r#""building": "yes", "height": "3""#),
            feature("Point", "[0.0005, 0.0005]", r#""name": "Gate", "radius": 3"#),
        );
        let at = at % text.len();
        text.replace_range(at..(at + cut).min(text.len()), &with);
        check(&text);
    }

    #[test]
    fn any_nesting_is_survived(depth in 0usize..3_000) {
        let deep = format!("{}{}", "[".repeat(depth), "]".repeat(depth));
        check_features(&feature("Polygon", &deep, "\"building\": 1"));
        check_features(&feature("Point", "[0, 0]", &format!("\"a\": {deep}")));
    }
}
