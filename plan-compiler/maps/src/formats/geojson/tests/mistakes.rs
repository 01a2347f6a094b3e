//! GeoJSON in, mistakes as a user sees them out.

use super::*;

#[test]
fn coordinates_that_are_not_degrees_are_reported_by_feature_and_position() {
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
      × coordinates of features[0] are projected metres, not degrees
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
      help: longitude comes first; these look swapped

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
fn features_that_cannot_be_read_are_all_reported() {
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

      × the geometry of features[1] cannot be read: the text "a" is where a number must be
       ╭─[a.geojson:3:87]
     2 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0]}},
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": ["a", 0]}},
       ·                                                                                       ▲
       ·                                                                                       ╰── here
     4 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[0, 0], [0, 1], [1, 1], [0, 0]]}},
       ╰────
      help: write coordinates as numbers, without quotes

      × the geometry of features[2] cannot be read: the number 0 is where a position, [longitude,
      │ latitude], must be
       ╭─[a.geojson:4:88]
     3 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": ["a", 0]}},
     4 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[0, 0], [0, 1], [1, 1], [0, 0]]}},
       ·                                                                                        ▲
       ·                                                                                        ╰── here
     5 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Circle", "coordinates": [0, 0]}},
       ╰────
      help: a Polygon has more levels of brackets: add one, or correct its type

      × the geometry of features[3] cannot be read: `Circle` is not a type of geometry
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

      × the radius of features[5] is not a length from 0 to 20000 m: wide
       ╭─[a.geojson:7:35]
     6 │ {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 1e999]}},
     7 │ {"type": "Feature", "properties": {"obstacle": true, "radius": "wide"}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ·                                   ────────────────────────────────────
     8 │ {"type": "Feature", "properties": {"obstacle": true, "radius": -1}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ╰────
      help: write it in metres, with a decimal point

      × the radius of features[6] is not a length from 0 to 20000 m: -1
       ╭─[a.geojson:8:35]
     7 │ {"type": "Feature", "properties": {"obstacle": true, "radius": "wide"}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
     8 │ {"type": "Feature", "properties": {"obstacle": true, "radius": -1}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
       ·                                   ────────────────────────────────
     9 │ {"type": "Feature"},
       ╰────
      help: write it in metres, with a decimal point

      × the properties of features[8] are not an object: a list is where an object must be
        ╭─[a.geojson:10:35]
      9 │ {"type": "Feature"},
     10 │ {"type": "Feature", "properties": []},
        ·                                   ▲
        ·                                   ╰── here
     11 │ {"type": "Point", "coordinates": [0, 0]},
        ╰────
      help: write "properties": {"building": "yes"}, or null

      × features[9] is not a feature
        ╭─[a.geojson:11:1]
     10 │ {"type": "Feature", "properties": []},
     11 │ {"type": "Point", "coordinates": [0, 0]},
        · ────────────────────┬───────────────────
        ·                     ╰── its type is not Feature
     12 │ [],
        ╰────
      help: a feature has type, geometry and properties

      × features[10] is not a feature
        ╭─[a.geojson:12:1]
     11 │ {"type": "Point", "coordinates": [0, 0]},
     12 │ [],
        · ─┬
        ·  ╰── this is not an object
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
fn files_that_are_not_maps_are_refused() {
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
      help: wrap geometries in features: their properties give their meaning

    no map
    ----
      × the file has no coordinates and no bounds
      help: check that this is the file you mean

    no map
    ----
      × the file holds no features
       ╭─[a.geojson:1:1]
     1 │ {"type": "Point", "coordinates": [1, 2]}
       · ────────────────────┬───────────────────
       ·                     ╰── neither a Feature nor a FeatureCollection with features
       ╰────
      help: wrap geometries in features: their properties give their meaning

    no map
    ----
      × coordinates of the feature are projected metres, not degrees
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
       ·                                                                         ╰── stated here
       ╰────
      help: convert them: ogr2ogr -t_srs EPSG:4326 new.geojson old.geojson

    extent -10,-10 + 20,20
    reference 51 7 at 0,0 heading 0
    point "Gate" 0,0
    ----
      × the bbox is not a box on the globe
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
      × the bbox is not a list of numbers: the text "a" is where a number must be
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
      × everything in the file lies outside its stated bounds
       ╭─[a.geojson:1:39]
     1 │ {"type": "FeatureCollection", "bbox": [0, 0, 10, 10], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                       ───────┬──────
       ·                                              ╰── this bbox
       ╰────
      help: state the bounds of the area that the robot uses, or none; check whether latitude and
            longitude are swapped

    no map
    ----
      × everything in the file lies outside its stated bounds
       ╭─[a.geojson:1:39]
     1 │ {"type": "FeatureCollection", "bbox": [51, 7, 51.1, 7.1], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                       ─────────┬────────
       ·                                                ╰── this bbox
       ╰────
      help: latitude and longitude are swapped in one of the two: exchange them there

    no map
    ----
      × the file's stated bounds have no area
       ╭─[a.geojson:1:39]
     1 │ {"type": "FeatureCollection", "bbox": [7, 51, 7, 51], "features": [{"type": "Feature", "properties": {"name": "Gate"}, "geometry": {"type": "Point", "coordinates": [7, 51]}}]}
       ·                                       ───────┬──────
       ·                                              ╰── this bbox
       ╰────
      help: state the bounds of the area that the robot uses, or none

    no map
    "#);
}
