//! Properties of every picture: it is well-formed XML, every text is inside it, and no texts
//! overlap.

use super::*;
use crate::compile::compile;
use crate::input::{Input, Options};
use crate::mission::Mission;
use maps::{Extent, Map, NamedPoint, Reference, Shape};
use math::GeoPoint;
use text::width_px;

/// A map of a size in metres with goals.
fn map(corner: Point, size: Point, goals: &[(&str, Point)]) -> Map {
    let named =
        |(name, at): &(&str, Point)| NamedPoint { name: (*name).into(), at: *at, span: 0..0 };
    let points = goals.iter().map(named).collect();
    Map { resolution_m: Some(1.0), points, ..Map::empty(Extent { corner, size }) }
}

fn blob(map: &Map) -> Vec<u8> {
    let (mission, options) = (Mission::default(), Options::default());
    let input = Input { map, source: None, mission: &mission, options: &options };
    let mut problems = Vec::new();
    compile(&input, &|_, _| {}, &mut problems).unwrap_or_else(|| panic!("{problems:?}"))
}

/// The picture of the first plan's first layer, `panels` times side by side.
fn svg_of(map: &Map, overlay: &Overlay<'_>, panels: usize, style: Style) -> String {
    let blob = blob(map);
    let blob = Blob::parse(&blob).unwrap();
    let parallel = blob.parallel_plan(0).unwrap();
    let panel = Panel { parallel, layer: parallel.layer(0).unwrap(), overlay: *overlay };
    side_by_side(&blob, &vec![panel; panels], style)
}

fn sized(size_px: u32) -> Style {
    Style { size_px, ..Style::default() }
}

fn number(node: &roxmltree::Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).and_then(|text| text.parse().ok()).unwrap_or(0.0)
}

/// The sum of the shifts of a node and of all groups around it.
fn shift(node: &roxmltree::Node<'_, '_>) -> [f64; 2] {
    let mut sum = [0.0, 0.0];
    for transform in node.ancestors().filter_map(|node| node.attribute("transform")) {
        let inside = transform.strip_prefix("translate(").and_then(|rest| rest.strip_suffix(')'));
        let inside = inside.expect("parts are shifted, not turned");
        for (axis, text) in inside.split(' ').enumerate() {
            sum[axis] += text.parse::<f64>().unwrap();
        }
    }
    sum
}

/// A text with its left, top, right and bottom.
type Boxed = (String, [f64; 4]);

fn texts(document: &roxmltree::Document<'_>) -> Vec<Boxed> {
    let nodes = document.descendants().filter(|node| node.has_tag_name("text"));
    let boxed = |node: roxmltree::Node<'_, '_>| {
        let text = node.text().unwrap_or("").trim().to_owned();
        let size = number(&node, "font-size");
        let width = width_px(&text, size);
        let [dx, dy] = shift(&node);
        let (x, y) = (number(&node, "x") + dx, number(&node, "y") + dy);
        let left = match node.attribute("text-anchor") {
            Some("middle") => x - width / 2.0,
            Some("end") => x - width,
            _ => x,
        };
        (text, [left, y - 0.74 * size, left + width, y + 0.2 * size])
    };
    nodes.map(boxed).collect()
}

/// Asserts what must hold of every picture; returns its texts, width and height.
fn check(svg: &str) -> (Vec<String>, [f64; 2]) {
    let document = roxmltree::Document::parse(svg).unwrap_or_else(|error| panic!("{error}"));
    let root = document.root_element();
    let size = [number(&root, "width"), number(&root, "height")];
    assert_eq!(root.attribute("viewBox"), Some(&*format!("0 0 {} {}", size[0], size[1])));
    assert!(root.attribute("font-family").is_some_and(|font| font.ends_with("sans-serif")));
    let texts = texts(&document);
    for (index, (text, one)) in texts.iter().enumerate() {
        let is_inside = one[0] >= 0.0 && one[1] >= 0.0 && one[2] <= size[0] && one[3] <= size[1];
        assert!(is_inside, "`{text}` at {one:?} leaves a picture of {size:?}");
        for (other_text, other) in &texts[..index] {
            let apart = one[2] <= other[0]
                || other[2] <= one[0]
                || one[3] <= other[1]
                || other[3] <= one[1];
            assert!(apart, "`{text}` at {one:?} lies over `{other_text}` at {other:?}");
        }
    }
    (texts.into_iter().map(|(text, _)| text).collect(), size)
}

const OVERLAY_MARKS: [(Mark, Point, &str); 4] = [
    (Mark::Start, [1.0, 1.0], "start"),
    (Mark::Stop, [9.0, 8.0], "stopped before the end"),
    (Mark::GaveWay, [3.0, 3.0], "gave way at a point of its plan"),
    (Mark::Interrupted, [5.0, 3.0], "interrupted at once"),
];

#[test]
fn a_picture_says_what_it_shows() {
    let goals = [("gate", [15.5, 8.5]), ("shed", [3.5, 6.5])];
    let mut map = map([0.0, 0.0], [20.0, 10.0], &goals);
    let wall = Shape::Polyline(vec![[10.0, 0.0], [10.0, 7.0]]);
    let cage = vec![[16.0, 1.0], [19.0, 1.0], [19.0, 4.0], [16.0, 4.0], [16.0, 1.0]];
    for (shape, role) in [
        (wall, Role::Obstacle),
        (Shape::Polyline(cage), Role::Obstacle),
        (Shape::Circle { centre: [5.0, 2.0], radius: 1.0 }, Role::Attenuating),
    ] {
        let name = String::new();
        map.features.push(Feature { shape, role, name, height_m: None, span: 0..0 });
    }
    let points = [[1.0, 1.0], [9.0, 8.0], [15.5, 8.5]];
    let routes = [Piece { name: "driven route", style: 0, points: &points }];
    let features = &map.features;
    let overlay =
        Overlay { features, routes: &routes, marks: &OVERLAY_MARKS, ..Overlay::default() };
    let svg = svg_of(&map, &overlay, 1, sized(1000));
    let (texts, size) = check(&svg);
    for text in [
        "gate/physical",
        "gate",
        "shed",
        "cost to the goal, m",
        "obstacle",
        "weakens radio",
        "too close for the robot",
        "no route to the goal",
        "advice",
        "driven route",
        "start",
        "goal",
        "goal of another plan",
        "stopped before the end",
        "interrupted at once",
        "y",
        "0",
        "20 m",
        "10 m",
    ] {
        assert!(texts.iter().any(|found| found == text), "`{text}` is missing in {texts:?}");
    }
    assert!((990.0..=1000.0).contains(&size[0].max(size[1])), "{size:?}");
    let bare = svg_of(&map, &overlay, 1, Style { has_arrows: false, ..sized(1000) });
    assert!(!check(&bare).0.contains(&"advice".to_owned()));
    assert!(bare.len() < svg.len());
}

#[test]
fn pictures_of_all_shapes_and_sizes_are_in_order() {
    let far = [41_231.25, 90_007.5];
    for (corner, size) in [
        ([0.0, 0.0], [1.0, 1.0]),
        ([-10.0, 5.0], [20.0, 10.0]),
        ([0.0, 0.0], [1000.0, 1.0]),
        ([0.0, 0.0], [1.0, 1000.0]),
        (far, [30.0, 300.0]),
        (far, [300.0, 30.0]),
        ([-9e4, -9e4], [64.0, 64.0]),
    ] {
        let goal = [corner[0] + size[0] - 0.5, corner[1] + size[1] - 0.5];
        let map = map(corner, size, &[("the northern gate of the campus", goal)]);
        let marks = OVERLAY_MARKS.map(|(mark, at, text)| {
            (
                mark,
                [corner[0] + at[0].min(size[0] / 2.0), corner[1] + at[1].min(size[1] / 2.0)],
                text,
            )
        });
        let overlay = Overlay { marks: &marks, ..Overlay::default() };
        for px in [200, 300, 500, 1200, 2000] {
            let svg = svg_of(&map, &overlay, 1, sized(px));
            let (_, [width, height]) = check(&svg);
            assert!(width.max(height) <= f64::from(px), "{size:?}: {width} x {height} of {px}");
            assert!(svg.len() < 1_000_000, "{size:?} at {px}: {} bytes", svg.len());
        }
    }
}

#[test]
fn panels_share_a_legend() {
    let map = map([0.0, 0.0], [40.0, 30.0], &[("gate", [20.5, 20.5])]);
    for panels in [2, 3, 4, 8] {
        for px in [500, 1200, 2000] {
            let (texts, [width, height]) =
                check(&svg_of(&map, &Overlay::default(), panels, sized(px)));
            assert!(width.max(height) <= f64::from(px), "{panels} at {px}: {width} x {height}");
            let legends = texts.iter().filter(|text| *text == "cost to the goal, m").count();
            assert!(legends == 1 || px == 500, "{panels} at {px}: {legends} legends");
        }
    }
}

#[test]
fn names_of_any_kind_break_nothing() {
    let names = ["<&>\"'", "北門 🚜 東", "ворота Öß", "]]>&amp;", "مرحبا", "a", "b", "c", "d"];
    let goals: Vec<(&str, Point)> =
        names.iter().zip(1..).map(|(name, i)| (*name, [f64::from(i) * 3.0, 10.5])).collect();
    let map = map([0.0, 0.0], [40.0, 30.0], &goals);
    let caption =
        "a\u{1b}[31m\u{202e}caption\u{0} that is much too long for any picture ".repeat(9);
    let overlay = Overlay { caption: &caption, ..Overlay::default() };
    let svg = svg_of(&map, &overlay, 1, sized(700));
    let (texts, _) = check(&svg);
    for name in ["<&>\"'", "北門 🚜 東", "ворота Öß"] {
        assert!(texts.iter().any(|text| text == name), "{name} is missing in {texts:?}");
    }
    assert!(!svg.contains('\u{1b}') && !svg.contains('\u{202e}'));
    assert!(png(&svg).is_ok_and(|png| png.starts_with(b"\x89PNG")));
    let crowd: Vec<String> = (0..60).map(|index| format!("goal number {index}")).collect();
    let goals: Vec<(&str, Point)> =
        crowd.iter().map(|name| (name.as_str(), [20.5, 15.5])).collect();
    let crowd: Vec<(&str, Point)> = goals
        .iter()
        .zip(0..)
        .map(|((name, at), i)| (*name, [at[0] + f64::from(i % 8), at[1] + f64::from(i / 8)]))
        .collect();
    check(&svg_of(
        &self::map([0.0, 0.0], [40.0, 30.0], &crowd),
        &Overlay::default(),
        1,
        sized(700),
    ));
}

#[test]
fn north_is_where_the_map_says() {
    let mut map = map([0.0, 0.0], [20.0, 20.0], &[("a", [5.5, 5.5])]);
    assert!(check(&svg_of(&map, &Overlay::default(), 1, sized(600))).0.contains(&"y".to_owned()));
    let place = GeoPoint::from_degrees(47.0, 8.0).unwrap();
    // The y axis points east, so north is to the left.
    let heading_rad = std::f64::consts::FRAC_PI_2;
    map.reference = Some(Reference { place, at: [0.0, 0.0], heading_rad });
    let svg = svg_of(&map, &Overlay::default(), 1, sized(600));
    let document = roxmltree::Document::parse(&svg).unwrap();
    let label =
        texts(&document).into_iter().find(|(text, _)| text == "N").expect("there is north").1;
    let needle = document.descendants().find(|node| {
        node.has_tag_name("path")
            && node.attribute("stroke-linejoin") == Some("round")
            && node.parent().is_some_and(|group| {
                group.children().any(|child| child.text().is_some_and(|t| t.trim() == "N"))
            })
    });
    let needle = needle.expect("there is a needle");
    let tip: Vec<f64> = needle.attribute("d").unwrap()[1..]
        .split(['L', ' '])
        .take(2)
        .map(|n| n.parse().unwrap())
        .collect();
    let [dx, dy] = shift(&needle);
    assert!((tip[1] + dy - (label[1] + label[3]) / 2.0).abs() < 4.0, "it lies flat");
    assert!(tip[0] + dx > label[0], "the letter is at its left end");
}

/// The colour of the picture of an empty map of 20 by 10 cells at a point of the map.
fn colour_at(overlay: &Overlay<'_>, at: Point) -> [u8; 3] {
    let mut map = map([-10.0, 5.0], [40.0, 20.0], &[("a", [27.0, 22.0])]);
    map.resolution_m = Some(2.0);
    let style = Style { has_arrows: false, ..Style::default() };
    let svg = svg_of(&map, overlay, 1, style);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let image = document.descendants().find(|node| node.has_tag_name("image")).unwrap();
    let [left, top] = shift(&image);
    let cell = number(&image, "width") / 20.0;
    let pixels = resvg::tiny_skia::Pixmap::decode_png(&png(&svg).unwrap()).unwrap();
    let (x, y) = (left + (at[0] + 10.0) / 2.0 * cell, top + (25.0 - at[1]) / 2.0 * cell);
    let pixel = pixels.pixel(x as u32, y as u32).unwrap();
    [pixel.red(), pixel.green(), pixel.blue()]
}

#[test]
fn what_was_driven_lies_over_the_cells_in_the_maps_own_metres() {
    let points = [[-8.0, 7.0], [6.0, 7.0], [6.0, 20.0]];
    let routes = [Piece { name: "driven route", style: 0, points: &points }];
    let overlay = Overlay { routes: &routes, ..Overlay::default() };
    let driven = palette::rgb(palette::ROUTES[0]);
    for at in [[-7.5, 7.0], [0.0, 7.0], [6.0, 15.0]] {
        assert_eq!(colour_at(&overlay, at), driven, "{at:?}");
        assert_ne!(colour_at(&Overlay::default(), at), driven, "{at:?}");
    }
    // Cells are drawn in the picture's PNG, too, and the goal's cell in the first band's colour.
    let goals_cell = colour_at(&Overlay::default(), [26.2, 22.2]);
    assert_eq!(goals_cell, palette::band(0, 12));
}

#[test]
fn a_large_map_makes_no_large_picture() {
    let map = map([0.0, 0.0], [3000.0, 2000.0], &[("gate", [20.5, 20.5])]);
    for px in [500, 2000] {
        let svg = svg_of(&map, &Overlay::default(), 1, sized(px));
        check(&svg);
        assert!(svg.len() < 2_000_000, "{} bytes at {px}", svg.len());
    }
}

#[test]
fn a_picture_of_a_reach_says_what_it_shows() {
    use crate::comms::{Margins, Need};
    use maps::radio::{Model, Settings};
    let mut map = map([-10.0, 0.0], [90.0, 60.0], &[]);
    for (shape, role) in [
        (Shape::Polyline(vec![[30.0, 0.0], [30.0, 40.0]]), Role::Obstacle),
        (Shape::Circle { centre: [50.0, 20.0], radius: 8.0 }, Role::Attenuating),
    ] {
        map.features.push(Feature { shape, role, name: String::new(), height_m: None, span: 0..0 });
    }
    let grid =
        plan_format::Grid { columns: 90, rows: 60, resolution_m: 1.0, corner_m: [-10.0, 0.0] };
    let blocked = maps::Bitmap::from_fn(90, 60, |cell| cell.column == 40 && cell.row < 40);
    let model = Model::of(&map, &Settings::default());
    let places = [("base".to_owned(), [2.5, 3.5]), ("mate".to_owned(), [70.5, 50.5])];
    let at = places.each_ref().map(|(_, at)| *at);
    let margins = Margins::of(&model, &grid, &at, Need::All, 30.0, &blocked);
    let shown = Reach {
        title: "yard: link to the worst place",
        grid: &grid,
        heading_rad: Some(0.3),
        margins: &margins,
        threshold_db: 30.0,
        blocked: &blocked,
        features: &map.features,
        places: &places,
    };
    for px in [300, 1000, 2000] {
        let svg = reach(&shown, px);
        let (texts, [width, height]) = check(&svg);
        assert!(width.max(height) <= f64::from(px));
        for text in [
            "yard: link to the worst place",
            "margin of the link, dB",
            "threshold, 30 dB",
            "out of reach, below 30 dB",
            "place",
            "base",
            "mate",
            "obstacle",
            "weakens radio",
        ] {
            let is_there = texts.iter().any(|found| found == text);
            assert!(is_there || px == 300, "`{text}` is missing in {texts:?}");
        }
    }
}
