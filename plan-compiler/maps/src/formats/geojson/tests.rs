//! GeoJSON in, map or mistakes out.

mod kinds;

use super::*;
use crate::formats::dump::outcome;
use insta::assert_snapshot;
use proptest::prelude::*;

fn check(text: &str) -> String {
    let source = Arc::new(Source { name: "a.geojson".into(), text: text.into() });
    outcome(&read(&source, &ReadOptions::default()))
}

/// Features in a box that is 200 m by 100 m on the equator, to the decimetre.
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
      ☞ the map is 200.4 m x 99.5 m, by the bounds that the file states; 0,0 is its centre, latitude
      │ 0.00045, longitude 0.0009; obstacles: 11, areas that weaken radio: 2, zones: 1, named points:
      │ 1, not used: 3 (building=no 1, name=Shop 1, nothing said 1)
      help: 0,0 depends on the file: `origin = [0.00045, 0.0009]` in the mission file or --origin
            0.00045,0.0009 keeps it where it is when the map is drawn anew

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
      ☞ the map is 20 m x 20 m, 10 m around what it draws; 0,0 is its centre, latitude 51.0005,
      │ longitude 7.001; obstacles: 0, areas that weaken radio: 0, zones: 0, named points: 1, not
      │ used: 0
      help: 0,0 depends on the file: `origin = [51.0005, 7.001]` in the mission file or --origin
            51.0005,7.001 keeps it where it is when the map is drawn anew

    extent -10,-10 + 20,20
    reference 51.0005 7.001 at 0,0 heading 0
    point "Gate" 0,0
    "#);
}

#[test]
fn coordinates_that_are_no_degrees_are_told_by_feature_and_place() {
    let features = [
        feature("Point", "[385000.5, 5650000.25]", r#""name": "metres""#),
        feature("LineString", "[[0, 0],\n  [51.5, 181]]", r#""obstacle": true"#),
        feature("Point", "[45.5, 91.5]", r#""name": "turned""#),
        feature("Polygon", "[[[0, 0], [0, 1], [1, 1]]]", r#""building": true"#),
        feature("Polygon", "[[[0, 0], [0, 1], [0, 0]]]", r#""building": true"#),
        feature("Polygon", "[]", r#""building": true"#),
        feature("Polygon", "[[]]", r#""building": true"#),
        feature("LineString", "[[0, 0]]", r#""obstacle": true"#),
    ];
    assert_snapshot!(check_features(&features.join(",\n")), @r#"
      × coordinates of features[0] are metres of some projection, not degrees
       ╭─[a.geojson:2:100]
     1 │ {"type": "FeatureCollection", "bbox": [0, 0, 0.0018, 0.0009], "features": [
     2 │ {"type": "Feature", "properties": {"name": "metres"}, "geometry": {"type": "Point", "coordinates": [385000.5, 5650000.25]}},
       ·                                                                                                    ───────────┬──────────
       ·                                                                                                               ╰── these
     3 │ {"type": "Feature", "properties": {"obstacle": true}, "geometry": {"type": "LineString", "coordinates": [[0, 0],
       ╰────
      help: convert them: ogr2ogr -t_srs EPSG:4326 new.geojson old.geojson

      × coordinates of features[1] are off the globe
       ╭─[a.geojson:4:3]
     3 │ {"type": "Feature", "properties": {"obstacle": true}, "geometry": {"type": "LineString", "coordinates": [[0, 0],
     4 │   [51.5, 181]]}},
       ·   ─────┬─────
       ·        ╰── these
     5 │ {"type": "Feature", "properties": {"name": "turned"}, "geometry": {"type": "Point", "coordinates": [45.5, 91.5]}},
       ╰────
      help: write longitude, then latitude, in degrees of WGS-84

      × coordinates of features[2] are off the globe
       ╭─[a.geojson:5:100]
     4 │   [51.5, 181]]}},
     5 │ {"type": "Feature", "properties": {"name": "turned"}, "geometry": {"type": "Point", "coordinates": [45.5, 91.5]}},
       ·                                                                                                    ──────┬─────
       ·                                                                                                          ╰── these
     6 │ {"type": "Feature", "properties": {"building": true}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [1, 1]]]}},
       ╰────
      help: longitude comes first; these look the other way round

      × a ring of features[3] is not closed
       ╭─[a.geojson:6:120]
     5 │ {"type": "Feature", "properties": {"name": "turned"}, "geometry": {"type": "Point", "coordinates": [45.5, 91.5]}},
     6 │ {"type": "Feature", "properties": {"building": true}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [1, 1]]]}},
       ·                                                                                                                        ───┬──
       ·                                                                                                                           ╰── its last position differs from its first
     7 │ {"type": "Feature", "properties": {"building": true}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [0, 0]]]}},
       ╰────
      help: repeat the ring's first position at its end

      × a ring of features[4] has fewer than four positions
       ╭─[a.geojson:7:120]
     6 │ {"type": "Feature", "properties": {"building": true}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [1, 1]]]}},
     7 │ {"type": "Feature", "properties": {"building": true}, "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [0, 0]]]}},
       ·                                                                                                                        ───┬──
       ·                                                                                                                           ╰── it ends here
     8 │ {"type": "Feature", "properties": {"building": true}, "geometry": {"type": "Polygon", "coordinates": []}},
       ╰────
      help: add what is missing, or leave the feature out

      × a line of features[7] has fewer than two positions
        ╭─[a.geojson:10:106]
      9 │ {"type": "Feature", "properties": {"building": true}, "geometry": {"type": "Polygon", "coordinates": [[]]}},
     10 │ {"type": "Feature", "properties": {"obstacle": true}, "geometry": {"type": "LineString", "coordinates": [[0, 0]]}}
        ·                                                                                                          ───┬──
        ·                                                                                                             ╰── it ends here
     11 │ ]}
        ╰────
      help: add what is missing, or leave the feature out

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    "#);
}

#[test]
fn features_that_cannot_be_read_are_all_told() {
    let features = [
        feature("Point", "[0]", ""),
        feature("Point", "[\"a\", 0]", ""),
        feature("Polygon", "[[0, 0], [0, 1], [1, 1], [0, 0]]", ""),
        feature("Circle", "[0, 0]", ""),
        feature("Point", "[0, 1e999]", ""),
        feature("Point", "[0, 0]", r#""obstacle": true, "radius": "wide""#),
        feature("Point", "[0, 0]", r#""obstacle": true, "radius": -1"#),
        "{\"type\": \"Feature\"}".into(),
        "{\"type\": \"Feature\", \"properties\": []}".into(),
        "{\"type\": \"Point\", \"coordinates\": [0, 0]}".into(),
        "[]".into(),
        "{\"type\": \"Feature\", \"geometry\": {\"type\": \"GeometryCollection\", \
         \"geometries\": [{\"type\": \"GeometryCollection\", \"geometries\": []}]}}"
            .into(),
    ];
    assert_snapshot!(check_features(&features.join(",\n")), @r#"
      × the geometry of features[0] cannot be read: a position has two numbers, longitude and latitude
       ╭─[a.geojson:2:86]
     1 │ {"type": "FeatureCollection", "bbox": [0, 0, 0.0018, 0.0009], "features": [
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0]}},
       ·                                                                                      ▲
       ·                                                                                      ╰── here
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": ["a", 0]}},
       ╰────
      help: a geometry has a type and coordinates that are nested as deep as it asks for

      × the geometry of features[1] cannot be read: invalid type: string "a", expected f64
       ╭─[a.geojson:3:87]
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0]}},
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": ["a", 0]}},
       ·                                                                                       ▲
       ·                                                                                       ╰── here
     4 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[0, 0], [0, 1], [1, 1], [0, 0]]}},
       ╰────
      help: write coordinates as numbers, without quotes

      × the geometry of features[2] cannot be read: invalid type: integer `0`, expected a position:
      │ [longitude, latitude]
       ╭─[a.geojson:4:88]
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": ["a", 0]}},
     4 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[0, 0], [0, 1], [1, 1], [0, 0]]}},
       ·                                                                                        ▲
       ·                                                                                        ╰── here
     5 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Circle", "coordinates": [0, 0]}},
       ╰────
      help: a geometry has a type and coordinates that are nested as deep as it asks for

      × the geometry of features[3] cannot be read: `Circle` is no type of geometry
       ╭─[a.geojson:5:51]
     4 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[0, 0], [0, 1], [1, 1], [0, 0]]}},
     5 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Circle", "coordinates": [0, 0]}},
       ·                                                   ────────────────────┬────────────────────
       ·                                                                       ╰── this one
     6 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 1e999]}},
       ╰────
      help: a geometry has a type and coordinates that are nested as deep as it asks for

      × the geometry of features[4] cannot be read: number out of range
       ╭─[a.geojson:6:92]
     5 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Circle", "coordinates": [0, 0]}},
     6 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 1e999]}},
       ·                                                                                            ▲
       ·                                                                                            ╰── here
     7 │ {"type": "Feature", "properties": {"obstacle": true, "radius": "wide"}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ╰────
      help: a geometry has a type and coordinates that are nested as deep as it asks for

      × the radius of features[5] is no length
       ╭─[a.geojson:7:35]
     6 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 1e999]}},
     7 │ {"type": "Feature", "properties": {"obstacle": true, "radius": "wide"}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ·                                   ────────────────────────────────────
     8 │ {"type": "Feature", "properties": {"obstacle": true, "radius": -1}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ╰────
      help: write it in metres

      × the radius of features[6] is no length
       ╭─[a.geojson:8:35]
     7 │ {"type": "Feature", "properties": {"obstacle": true, "radius": "wide"}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
     8 │ {"type": "Feature", "properties": {"obstacle": true, "radius": -1}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ·                                   ────────────────────────────────
     9 │ {"type": "Feature"},
       ╰────
      help: write it in metres

      × the properties of features[8] are no object: invalid type: sequence, expected an object
        ╭─[a.geojson:10:35]
      9 │ {"type": "Feature"},
     10 │ {"type": "Feature", "properties": []},
        ·                                   ▲
        ·                                   ╰── here
     11 │ {"type": "Point", "coordinates": [0, 0]},
        ╰────
      help: write "properties": {"building": "yes"}, or null

      × features[9] is no feature
        ╭─[a.geojson:11:1]
     10 │ {"type": "Feature", "properties": []},
     11 │ {"type": "Point", "coordinates": [0, 0]},
        · ────────────────────┬───────────────────
        ·                     ╰── its type is not Feature
     12 │ [],
        ╰────
      help: a feature has type, geometry and properties

      × features[10] is no feature
        ╭─[a.geojson:12:1]
     11 │ {"type": "Point", "coordinates": [0, 0]},
     12 │ [],
        · ─┬
        ·  ╰── this is no object
     13 │ {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [{"type": "GeometryCollection", "geometries": []}]}}
        ╰────
      help: a feature has type, geometry and properties

      × the geometry of features[11] cannot be read
        ╭─[a.geojson:13:79]
     12 │ [],
     13 │ {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [{"type": "GeometryCollection", "geometries": []}]}}
        ·                                                                               ────────────────────────┬───────────────────────
        ·                                                                                                       ╰── a collection within a collection
     14 │ ]}
        ╰────
      help: take the inner collection apart

    extent -100.188,-49.758 + 200.375,99.517
    reference 0.00045 0.0009 at 0,0 heading 0
    Obstacle "" circle -100.188,-49.758 radius 0
    Obstacle "" circle -100.188,-49.758 radius 0
    "#);
}

#[test]
fn files_that_are_no_maps_are_refused() {
    let collection = |more: &str| {
        let point = feature("Point", "[7, 51]", r#""name": "Gate""#);
        check(&format!("{{\"type\": \"FeatureCollection\", {more} \"features\": [{point}]}}"))
    };
    let utm = r#""crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}},"#;
    let outcomes = [
        check("{\"type\": \"FeatureCollection\",\n  \"features\": [{\"type\": \"Feature\""),
        check("{\"type\": \"FeatureCollection\"}"),
        check("{\"type\": \"FeatureCollection\", \"features\": []}"),
        check("{\"type\": \"Point\", \"coordinates\": [1, 2]}"),
        check(&feature("Point", "[385000, 5650000]", "")),
        collection(utm),
        collection("\"bbox\": [7, 52, 8, 51],"),
        collection("\"bbox\": [7, \"a\"],"),
        collection("\"bbox\": [0, 0, 10, 10],"),
        collection("\"bbox\": [51, 7, 51.1, 7.1],"),
        collection("\"bbox\": [7, 51, 7, 51],"),
    ];
    assert_snapshot!(outcomes.join("----\n"), @r#"
      × this is not GeoJSON: EOF while parsing an object
       ╭─[a.geojson:2:33]
     1 │ {"type": "FeatureCollection",
     2 │   "features": [{"type": "Feature"
       ·                                 ▲
       ·                                 ╰── here
       ╰────
      help: a GeoJSON map is an object of type FeatureCollection; check where it was cut off

    no map
    ----
      × the file holds no features
       ╭─[a.geojson:1:1]
     1 │ {"type": "FeatureCollection"}
       · ──────────────┬──────────────
       ·               ╰── neither a Feature nor a FeatureCollection with features
       ╰────
      help: wrap geometries in features: their properties say what they are

    no map
    ----
      × the file draws nothing and states no bounds
      help: check that this is the file you mean

    no map
    ----
      × the file holds no features
       ╭─[a.geojson:1:1]
     1 │ {"type": "Point", "coordinates": [1, 2]}
       · ────────────────────┬───────────────────
       ·                     ╰── neither a Feature nor a FeatureCollection with features
       ╰────
      help: wrap geometries in features: their properties say what they are

    no map
    ----
      × coordinates of the feature are metres of some projection, not degrees
       ╭─[a.geojson:1:84]
     1 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [385000, 5650000]}}
       ·                                                                                    ────────┬────────
       ·                                                                                            ╰── these
       ╰────
      help: convert them: ogr2ogr -t_srs EPSG:4326 new.geojson old.geojson

    no map
    ----
      × the coordinates are in urn:ogc:def:crs:EPSG::25832, not in degrees of WGS-84
       ╭─[a.geojson:1:38]
     1 │ {"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}, "features": [{"type": "Feature", "properties": {"name": "G
       ·                                      ───────────────────────────────────┬───────────────────────────────────
       ·                                                                         ╰── said here
       ╰────
      help: convert them: ogr2ogr -t_srs EPSG:4326 new.geojson old.geojson

    extent -10,-10 + 20,20
    reference 51 7 at 0,0 heading 0
    point "Gate" 0,0
    ----
      × the bbox is no box on the globe
       ╭─[a.geojson:1:39]
     1 │ {"type": "FeatureCollection", "bbox": [7, 52, 8, 51], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                       ───────┬──────
       ·                                              ╰── this one
       ╰────
      help: write west, south, east, north in degrees, or leave it out

    extent -10,-10 + 20,20
    reference 51 7 at 0,0 heading 0
    point "Gate" 0,0
    ----
      × the bbox is no list of numbers: invalid type: string "a", expected f64
       ╭─[a.geojson:1:45]
     1 │ {"type": "FeatureCollection", "bbox": [7, "a"], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                             ▲
       ·                                             ╰── here
       ╰────
      help: write west, south, east, north in degrees, or leave it out

    extent -10,-10 + 20,20
    reference 51 7 at 0,0 heading 0
    point "Gate" 0,0
    ----
      × all that the file draws lies outside the bounds that it states
       ╭─[a.geojson:1:39]
     1 │ {"type": "FeatureCollection", "bbox": [0, 0, 10, 10], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                       ───────┬──────
       ·                                              ╰── this bbox
       ╰────
      help: state the bounds of the part that the robot will drive in, or none; check whether latitude
            and longitude are swapped

    no map
    ----
      × all that the file draws lies outside the bounds that it states
       ╭─[a.geojson:1:39]
     1 │ {"type": "FeatureCollection", "bbox": [51, 7, 51.1, 7.1], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                       ─────────┬────────
       ·                                                ╰── this bbox
       ╰────
      help: latitude and longitude are swapped in one of both: exchange them there

    no map
    ----
      × the bounds that the file states have no area
       ╭─[a.geojson:1:39]
     1 │ {"type": "FeatureCollection", "bbox": [7, 51, 7, 51], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                       ───────┬──────
       ·                                              ╰── this bbox
       ╰────
      help: state the bounds of the part that the robot will drive in, or none

    no map
    "#);
}

/// Not the feature but the position in it, and no one of two that are as far from each other.
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
      × the map is 704 km x 5650 km, but a plan holds for 20 km around its centre
       ╭─[a.geojson:2:84]
     1 │ {"type": "FeatureCollection", "features": [
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ·                                                                                    ───┬──
       ·                                                                                       ╰── far from the others, which lie about latitude 51, longitude 7
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [7, 51]}},
       ╰────
      help: cut the part out that the robot will drive in; one stray point is enough

    no map
    ----
      × the map is 1 km x 3993 km, but a plan holds for 20 km around its centre
       ╭─[a.geojson:3:125]
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [7, 51]}},
     3 │ {"type": "Feature", "properties": {"building": 1}, "geometry": {"type": "LineString", "coordinates": [[7, 51], [7.001, 51], [7.001, 15.001], [7.001, 51.001]]}}
       ·                                                                                                                             ───────┬───────
       ·                                                                                                                                    ╰── far from the others, which lie about latitude 51, longitude 7.001
     4 │ ]}
       ╰────
      help: cut the part out that the robot will drive in; one stray point is enough

    no map
    ----
      × the map is 704 km x 5650 km, but a plan holds for 20 km around its centre
       ╭─[a.geojson:2:84]
     1 │ {"type": "FeatureCollection", "features": [
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [7, 51]}},
       ·                                                                                    ───┬───
       ·                                                                                       ╰── either this or what lies about latitude 0, longitude 0 is astray
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 0]}}
       ╰────
      help: cut the part out that the robot will drive in; one stray point is enough

    no map
    "#);
}

#[test]
fn a_known_system_is_welcome() {
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
    /// Whatever is cut or changed: an answer, and no panic.
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
