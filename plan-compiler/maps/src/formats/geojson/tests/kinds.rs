//! Small samples of what converters, servers and editors write.

use super::*;
use crate::formats::tags::TagRules;
use crate::model::{Role, Shape};
use crate::problem::draw as drawn;

const HALL: &str = "[[[-0.0016439, 51.4778461], [-0.0013561, 51.4778461], [-0.0013561, 51.4779539], \
                    [-0.0016439, 51.4779539], [-0.0016439, 51.4778461]]]";

fn read_as(text: &str, options: &ReadOptions) -> (Option<Map>, String) {
    let source = Arc::new(Source { name: "a.geojson".into(), text: text.into() });
    let (map, problems) = read(&source, options);
    let messages = drawn(&problems, false).replace('\u{2502}', " ");
    let map = map.filter(|_| !has_errors(&problems));
    (map, messages.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn collection(features: &[String], head: &str) -> String {
    format!("{{\"type\": \"FeatureCollection\", {head}\"features\": [{}]}}", features.join(", "))
}

fn map(text: &str) -> (Map, String) {
    let (map, messages) = read_as(text, &ReadOptions::default());
    (map.unwrap_or_else(|| panic!("no map of {text}\n{messages}")), messages)
}

fn obstacles(map: &Map) -> usize {
    map.features.iter().filter(|feature| feature.role == Role::Obstacle).count()
}

fn reports(text: &str, words: &[&str]) {
    let (_, messages) = read_as(text, &ReadOptions::default());
    words.iter().for_each(|word| assert!(messages.contains(word), "{word} missing in\n{messages}"));
}

fn hall(properties: &str) -> String {
    feature("Polygon", HALL, properties)
}

/// A cut inside a multi-byte letter gives an error with its place.
#[test]
fn what_is_cut_off_after_any_letter_is_an_error_with_its_place() {
    let whole = collection(
        &[hall("\"n\u{e4}me\": \"\u{1f333} \u{e9}\", \"building\": \"y\u{e9}s\"")],
        "\"n\u{f6}\": \"\u{fc}\", ",
    );
    for (end, _) in whole.char_indices().skip(1) {
        for tail in ["", "\u{e9}", "\u{1f333}\u{1f333}", "\u{fffd}\n\u{fffd}"] {
            let (map, messages) =
                read_as(&format!("{}{tail}", &whole[..end]), &ReadOptions::default());
            assert!(map.is_none() && messages.contains("a.geojson:"), "{end} {tail}: {messages}");
        }
    }
    let garbage =
        format!("{{ \"{}e\": \"Featu{}reColl", "\u{fffd}".repeat(80), "\u{fffd}".repeat(6));
    reports(&garbage, &["this is not GeoJSON", "a.geojson:1:"]);
}

#[test]
fn properties_of_converters_are_understood() {
    for properties in [
        r#""tags": {"building": "yes"}, "id": 1, "meta": {}"#,
        r#""osm_id": "1", "other_tags": "\"building\"=>\"yes\",\"height\"=>\"3\"""#,
        r#""all_tags": "{\"building\": \"yes\"}""#,
        r#""BUILDING": "YES""#,
        r#""barrier": "wall;fence""#,
    ] {
        let (map, messages) = map(&collection(&[hall(properties)], ""));
        assert_eq!(obstacles(&map), 1, "{properties}\n{messages}");
    }
}

#[test]
fn ignored_features_are_reported() {
    let field = hall(r#""Layer": "Obstacles", "SubClasses": "AcDbEntity""#);
    reports(
        &collection(&[field], ""),
        &[
            "\u{26a0} nothing on the map is an obstacle",
            "zones, which only a mission can use: Obstacles",
        ],
    );
    let lots = [hall(r#""LANDUSE": "lot""#), hall(r#""LANDUSE": "lot""#), hall("")];
    reports(
        &collection(&lots, ""),
        &[
            "\u{26a0} nothing on the map is an obstacle; not used: LANDUSE=lot 2, no tags 1",
            "--block KEY=VALUE",
        ],
    );
    let centre =
        feature("Point", "[-0.0015, 51.4779]", r#""building": "yes", "@geometry": "center""#);
    reports(
        &collection(&[centre], ""),
        &["\u{26a0} drawn as points, without an outline: building=yes 1"],
    );
    let null = r#"{"type": "Feature", "properties": {"building": "yes"}, "geometry": null}"#;
    reports(
        &collection(&[null.into(), hall(r#""building": 1"#)], ""),
        &["\u{26a0} without coordinates, so not on the map: building=yes 1"],
    );
}

#[test]
fn geometries_without_positions_are_not_drawn() {
    for (kind, coordinates) in [
        ("Point", "[]"),
        ("Polygon", "[[]]"),
        ("MultiPolygon", "[ ]"),
        ("LineString", "null"),
        ("MultiPoint", "[]"),
    ] {
        let empty = feature(kind, coordinates, r#""name": "a""#);
        let (map, messages) = map(&collection(&[empty, hall(r#""building": "yes""#)], ""));
        assert_eq!((obstacles(&map), map.points.len()), (1, 0), "{kind}");
        assert!(
            messages.contains("\u{26a0} without coordinates, so not on the map: name=a 1"),
            "{messages}"
        );
    }
}

#[test]
fn systems_are_known_by_name_and_by_code() {
    let with =
        |crs: &str| collection(&[hall(r#""building": "yes""#)], &format!("\"crs\": {crs}, "));
    for crs in [
        r#"{"type": "EPSG", "properties": {"code": 4326}}"#,
        r#"{"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC::CRS84"}}"#,
        r#"{"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG:6.18:4326"}}"#,
        "null",
    ] {
        assert_eq!(obstacles(&map(&with(crs)).0), 1, "{crs}");
    }
    let help = "ogr2ogr -t_srs EPSG:4326";
    reports(&with(r#"{"type": "EPSG", "properties": {"code": 3857}}"#), &["in EPSG:3857", help]);
    reports(
        &with(r#"{"type": "name", "properties": {"name": "EPSG:32630"}}"#),
        &["in EPSG:32630", help],
    );
}

#[test]
fn features_one_after_the_other_are_a_map() {
    let [one, two] =
        [hall(r#""building": "yes""#), feature("Point", "[-0.0014, 51.4778]", r#""name": "gate""#)];
    for text in [
        format!("{one}\n{two}\n"),
        format!("{one}\r\n\r\n{two}"),
        format!("\u{1e}{one}\n\u{1e}{two}\n"),
        format!("{}\n{two}", collection(std::slice::from_ref(&one), "")),
    ] {
        assert!(recognises(&text), "{text}");
        let (map, _) = map(&text);
        assert_eq!((obstacles(&map), map.points.len()), (1, 1), "{text}");
    }
    assert_eq!(obstacles(&map(&format!("\u{1e}{one}\n")).0), 1);
    reports(
        &format!("{one}\n{}", &two[..40]),
        &["record 2 of the sequence is not a feature", "a.geojson:2:"],
    );
    reports(&format!("{one}\n{{\"type\": \"Point\"}}"), &["records[1] is not a feature"]);
}

#[test]
fn formats_mistaken_for_geojson_are_named() {
    reports(r#"{"type": "Topology", "objects": {}, "arcs": []}"#, &["TopoJSON", "mapshaper"]);
    reports(
        r#"{"geometryType": "esriGeometryPolygon", "features": [{"attributes": {}}]}"#,
        &["ArcGIS", "ogr2ogr"],
    );
    reports(r#"{"type": "Polygon", "coordinates": []}"#, &["wrap geometries in features"]);
    reports(
        &collection(&[feature("Point", r#"["-0.0015", "51.4779"]"#, "")], ""),
        &["without quotes"],
    );
}

#[test]
fn swapped_coordinates_are_suspected() {
    let swapped = "[[[51.4778461, -0.0016439], [51.4778461, -0.0013561], [51.4779539, -0.0013561], [51.4778461, -0.0016439]]]";
    let wrong = feature("Polygon", swapped, r#""building": "yes""#);
    reports(
        &collection(std::slice::from_ref(&wrong), ""),
        &[
            "\u{26a0} the map lies at latitude -0.0015, longitude 51.4779, on open sea or ice",
            "swapped",
        ],
    );
    let bbox = "\"bbox\": [-0.0018, 51.4777, -0.0012, 51.4781], ";
    reports(
        &collection(&[wrong], bbox),
        &["outside its stated bounds", "latitude and longitude are swapped in one of the two"],
    );
    let (_, messages) = map(&collection(&[hall(r#""building": "yes""#)], ""));
    assert!(!messages.contains('\u{26a0}'), "{messages}");
}

#[test]
fn the_file_or_the_user_says_where_the_origin_is() {
    let shed = feature("Point", "[-0.001, 51.479]", r#""obstacle": "shed""#);
    let head = "\"origin\": [-0.0015, 51.4779], ";
    let origin = GeoPoint::from_degrees(51.4779, -0.0015);
    for features in [vec![hall("\"building\": 1")], vec![hall("\"building\": 1"), shed]] {
        let (there, messages) = map(&collection(&features, head));
        assert_eq!(there.reference.map(|it| it.place), origin, "{messages}");
        let other = GeoPoint::from_degrees(51.4778, -0.0016);
        let options = ReadOptions { origin: other, ..ReadOptions::default() };
        let (there, _) = read_as(&collection(&features, head), &options);
        assert_eq!(there.and_then(|map| map.reference).map(|it| it.place), other);
    }
    reports(&collection(&[hall("")], "\"origin\": [0, 91], "), &["the origin is off the globe"]);
    reports(&collection(&[hall("")], "\"origin\": 3, "), &["the origin is not a position"]);
    reports(
        &collection(&[hall("")], "\"origin\": [51.4779, -0.0015], "),
        &["are swapped, in the origin or in the map"],
    );
}

#[test]
fn gates_open_the_fence_whose_corner_they_are() {
    let fence = "[[-0.0016, 51.4778], [-0.0014, 51.4778], [-0.0012, 51.4778]]";
    let fence = feature("LineString", fence, r#""barrier": "fence""#);
    let gate = feature("Point", "[-0.0014, 51.4778]", r#""barrier": "gate""#);
    let text = collection(&[fence, gate], "");
    assert_eq!(obstacles(&map(&text).0), 1);
    let tags = TagRules { open_gates: true, ..TagRules::default() };
    let (open, messages) = read_as(&text, &ReadOptions { tags, ..ReadOptions::default() });
    assert_eq!(open.map(|map| obstacles(&map)), Some(2), "{messages}");
}

#[test]
fn holes_that_share_an_edge_are_one() {
    let square = |x: f64| ring(x, 0.0001, 0.0001);
    let outer = ring(0.0, 0.0, 0.0009);
    let touching = format!("[{outer}, {}, {}]", square(0.0001), square(0.0002));
    let (map, _) = map(&collection(&[feature("Polygon", &touching, "\"building\": 1")], ""));
    let Shape::Polygon(rings) = &map.features[0].shape else { panic!("{map:?}") };
    assert_eq!(rings.iter().map(Vec::len).collect::<Vec<_>>(), [4, 6]);
}

#[test]
fn a_position_takes_no_more_memory_than_its_numbers() {
    assert_eq!(size_of::<Position>(), 16);
    let corners = 100_000;
    let ring: Vec<String> =
        (0..corners).chain([0]).map(|n| format!("[{}e-7,{}]", n % 2, n)).collect();
    let pieces = coordinates::pieces("Polygon", &format!("[[{}]]", ring.join(","))).expect("read");
    assert!(matches!(&pieces[..], [Piece::Polygon(rings)] if rings[0].len() == corners + 1));
}

#[test]
fn endless_lists_are_refused_before_they_are_read() {
    let many =
        format!("{{\"type\": \"FeatureCollection\", \"features\": [{}]}}", "[],".repeat(MAX_LISTS));
    reports(&many, &["the file has 8388609 lists"]);
    let many = feature("Point", "[0, 0]", &"\"a\": 0, ".repeat(20_000));
    reports(&collection(&[many.replace(", }", "}")], ""), &["more than 10000 members"]);
}

#[test]
fn a_radius_beyond_any_map_is_an_error() {
    let tree = |radius: &str| {
        feature("Point", "[-0.0015, 51.4779]", &format!(r#""natural": "tree", "radius": {radius}"#))
    };
    for radius in ["20001", "1e300", "\"4,5\"", "-4", "\"big\""] {
        let shown = radius.trim_matches('"');
        let message =
            format!("\u{d7} the radius of features[0] is not a length from 0 to 20000 m: {shown}");
        reports(&collection(&[tree(radius)], ""), &[&message]);
    }
    for radius in ["20000", "\"4 m\"", "\"12 ft\"", "0"] {
        let (drawn, messages) = map(&collection(&[tree(radius)], ""));
        assert_eq!(obstacles(&drawn), 1, "{radius} {messages}");
    }
}

#[test]
fn each_member_of_a_list_is_a_value() {
    for properties in [
        r#""highway": ["footway", "steps"]"#,
        r#""highway": "['footway', 'steps']""#,
        r#""highway": "[\"footway\", \"steps\"]""#,
        r#""building": ["yes", "no"]"#,
        r#""building": [true]"#,
        r#""tags": [{"key": "building", "value": "yes"}]"#,
        r#""tags": "{'building': 'yes', 'name': \"O'Hara's\"}""#,
        r#""tags": {"highway": ["footway", "steps"]}"#,
    ] {
        let (map, messages) = map(&collection(&[hall(properties)], ""));
        assert!(obstacles(&map) > 0, "{properties}\n{messages}");
    }
    let named = r#""tags": "{'building': 'yes', 'name': \"O'Hara's\"}""#;
    assert_eq!(map(&collection(&[hall(named)], "")).0.features[0].name, "O'Hara's");
}

#[test]
fn bounds_wider_than_half_the_globe_are_not_called_swapped() {
    let text = collection(&[hall(r#""building": "yes""#)], "\"bbox\": [-180, -90, 180, 90], ");
    let text = text.replace("-0.001", "7.001");
    reports(&text, &["by the file's bounds the map is 40076 km x", "this bbox"]);
}

/// What overpass turbo writes of an area whose ways were only partly fetched.
#[test]
fn areas_that_are_not_whole_are_reported() {
    let line = "[[-0.0016439, 51.4778461], [-0.0013561, 51.4778461], [-0.0013561, 51.4779539]]";
    let open = feature("LineString", line, r#""building": "yes""#);
    let words = "\u{26a0} outlines that do not close: 1; drawn as walls with free ground inside";
    reports(&collection(&[open], ""), &[words]);
    let tainted = hall(r#""building": "yes", "@tainted": true"#);
    let words = "\u{26a0} objects that lack parts, marked `@tainted`: 1; drawn without them";
    reports(&collection(&[tainted], ""), &[words, "out geom;"]);
    let whole = [hall(r#""building": "yes", "@tainted": false"#), hall(r#""barrier": "wall""#)];
    let (_, messages) = map(&collection(&whole, ""));
    assert!(!messages.contains('\u{26a0}'), "{messages}");
    let walls = [feature("LineString", line, r#""barrier": "wall""#)];
    assert!(!map(&collection(&walls, "")).1.contains('\u{26a0}'));
}

#[test]
fn what_json_does_not_allow_is_named() {
    let nan = collection(&[hall(r#""building": "yes", "height": NaN"#)], "");
    reports(&nan, &["NaN is not allowed in JSON", "write null", "a.geojson:1:"]);
    let inf = collection(&[hall(r#""building": "yes""#)], "\"bbox\": [-Infinity, 0, 1, 1], ");
    reports(&inf, &["-Infinity is not allowed in JSON", "write null"]);
    let place = collection(&[hall("").replace("51.4778461", "NaN")], "");
    reports(&place, &["NaN is not allowed in JSON"]);
    let comma = "a comma before a closing bracket is not allowed in JSON";
    reports(&collection(&[hall(r#""building": "yes","#)], ""), &[comma, "remove the comma"]);
    reports(&collection(&[hall("")], "").replace("]}", ",\n]}"), &[comma]);
    // A file that was cut off is still called that.
    let cut = collection(&[hall("")], "").replace("]}", "");
    reports(&cut, &["check where it was cut off"]);
}

#[test]
fn coordinates_of_another_shape_are_explained() {
    let building = r#""building": "yes""#;
    for (coordinates, message, help) in [
        (
            format!("[{HALL}]"),
            "a list is where a number must be",
            "a Polygon has fewer levels of brackets",
        ),
        (
            HALL.replace("[[[", "[[").replace("]]]", "]]"),
            "the number -0.0016439 is where",
            "a Polygon has more levels of brackets",
        ),
        (
            HALL.replace("51.4778461", "\"51.4778461\""),
            "the text \"51.4778461\" is where a number must be",
            "without quotes",
        ),
        (
            HALL.replace("51.4778461", "null"),
            "null is where a number must be",
            "remove the position",
        ),
    ] {
        let text = collection(&[feature("Polygon", &coordinates, building)], "");
        reports(&text, &["the geometry of features[0] cannot be read", message, help]);
        let (_, messages) = read_as(&text, &ReadOptions::default());
        for word in ["f64", "sequence", "invalid type"] {
            assert!(!messages.contains(word), "{messages}");
        }
    }
}

#[test]
fn a_feature_without_a_place_is_shown() {
    let null =
        "{\"type\": \"Feature\", \"properties\": {\"building\": \"yes\"}, \"geometry\": null}";
    let nested = null.replace("null", "{\"geometry\": {}}");
    let empty = feature("Polygon", "[]", r#""building": "yes""#);
    for feature in [null, &nested, &empty] {
        let text = collection(&[hall(""), format!("\n{feature}")], "");
        reports(
            &text,
            &[
                "without coordinates, so not on the map: building=yes 1",
                "a.geojson:2:",
                "give it coordinates, or remove it",
            ],
        );
    }
}

#[test]
fn degrees_in_well_known_text_are_accepted() {
    let with = |name: &str| {
        let crs = format!(r#""crs": {{"type": "name", "properties": {{"name": "{name}"}}}}, "#);
        collection(&[hall(r#""building": "yes""#)], &crs)
    };
    for name in [
        r#"GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\"]]"#,
        r#"GEOGCRS[\"WGS 84\",DATUM[\"World Geodetic System 1984\"]]"#,
        r#"GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\"]]"#,
    ] {
        assert_eq!(obstacles(&map(&with(name)).0), 1, "{name}");
    }
    let utm = r#"PROJCS[\"WGS 84 / UTM zone 32N\",GEOGCS[\"WGS 84\"]]"#;
    reports(&with(utm), &["not in degrees of WGS-84"]);
    reports(&with(r#"GEOGCS[\"OSGB 1936\"]"#), &["not in degrees of WGS-84"]);
}
