//! Strips over random areas with obstacles, and over areas that people reported.

use super::*;
use crate::compile::compile;
use crate::input::{Input, Options};
use crate::mission::{Mission, parse};
use maps::problem::{Source, draw, has_errors};
use maps::{Extent, Feature, Map, Role, Shape};
use plan_format::{Blob, Cell};
use proptest::prelude::*;

/// Side of the map, metres.
const SIDE_M: f64 = 60.0;

fn feature(name: &str, role: Role, shape: Shape) -> Feature {
    Feature { shape, role, name: name.to_owned(), height_m: None, span: 0..0 }
}

fn map(area: Vec<Point>, obstacles: &[Shape]) -> Map {
    let extent = Extent { corner: [0.0, 0.0], size: [SIDE_M, SIDE_M] };
    let mut features = vec![feature("field", Role::Zone, Shape::Polygon(vec![area]))];
    features.extend(obstacles.iter().map(|shape| feature("", Role::Obstacle, shape.clone())));
    Map { features, ..Map::empty(extent) }
}

fn rectangle([west, south]: Point, [width, height]: Point) -> Vec<Point> {
    let (east, north) = (west + width, south + height);
    vec![[west, south], [east, south], [east, north], [west, north]]
}

fn settings(width_m: f64, angle_deg: Option<f64>) -> Settings {
    Settings { width_m, overlap_m: 0.0, angle_deg, leave_m2: 0.0, start: [0.0, 0.0] }
}

/// The site of the area `field`, and its strips.
fn covered_site(
    map: &Map,
    [resolution_m, radius_m]: [f64; 2],
    settings: Settings,
) -> Result<(Site, Cover), String> {
    let mission = Mission::of_no_file();
    let options = Options {
        resolution_m: Some(resolution_m),
        robot_radius_m: Some(radius_m),
        ..Options::default()
    };
    let input = Input { map, source: None, mission: &mission, options: &options };
    let mut problems = Vec::new();
    let area = Area::named(map, "field").map_err(|found| draw(&found, false))?;
    let site = site(&input, area, Asked::default(), &mut problems);
    let site = site.ok_or_else(|| draw(&problems, false))?;
    let settings = Settings { start: site.start, ..settings };
    let cover = cover(&site.ground, site.passable(), &site.area.edges_deg(), &settings);
    Ok((site, cover))
}

/// Distance of a point from the outline or the inside of a shape, metres.
fn gap_m(shape: &Shape, at: Point) -> f64 {
    match shape {
        Shape::Circle { centre, radius } => (distance(*centre, at) - radius).max(0.0),
        Shape::Polyline(points) => outline_m(points, at),
        Shape::Polygon(rings) => {
            let [x, y] = at;
            let is_inside = rings[0].iter().zip(rings[0].iter().cycle().skip(1)).fold(
                false,
                |inside, ([ax, ay], [bx, by])| {
                    let crosses =
                        (*ay > y) != (*by > y) && x < (bx - ax) * (y - ay) / (by - ay) + ax;
                    inside != crosses
                },
            );
            let mut ring = rings[0].clone();
            ring.push(ring[0]);
            if is_inside { 0.0 } else { outline_m(&ring, at) }
        }
    }
}

fn outline_m(points: &[Point], at: Point) -> f64 {
    let edges = points.windows(2).map(|ends| Strip { from: ends[0], to: ends[1] });
    edges.map(|edge| distance_to(&edge, at)).fold(f64::INFINITY, f64::min)
}

/// Points of a segment, a twentieth of a metre apart.
fn samples(from: Point, to: Point) -> impl Iterator<Item = Point> {
    let count = (distance(from, to) / 0.05) as usize + 1;
    (0..=count).map(move |index| {
        let share = index as f64 / count as f64;
        [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share]
    })
}

/// Every cell of the ground is near a strip; no strip comes close to an obstacle or to the edge;
/// transitions stay inside.
fn check(map: &Map, site: &Site, cover: &Cover, width_m: f64) {
    let grid = &site.ground.grid;
    let within_m = width_m / 2.0 + grid.resolution_m / 2.0 + 1e-6;
    for cell in site.ground.cells.iter() {
        let at = grid.centre(cell);
        let nearest = cover.strips.iter().map(|strip| distance_to(strip, at));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest <= within_m, "{at:?} is {nearest} m from a strip");
    }
    let obstacles = map.features.iter().filter(|feature| feature.role == Role::Obstacle);
    let obstacles: Vec<&Feature> = obstacles.collect();
    let angle = cover.angle_deg.to_radians();
    let (cos, sin) = (wide::cos(angle), wide::sin(angle));
    for strip in &cover.strips {
        let least_m = grid.resolution_m / 2.0 - 1e-6;
        assert!(strip.length_m() >= least_m, "{strip:?} is {} m long", strip.length_m());
        let along = [strip.to[0] - strip.from[0], strip.to[1] - strip.from[1]];
        assert!((along[0] * sin - along[1] * cos).abs() < 1e-6, "{strip:?} is not at {angle}");
        for at in samples(strip.from, strip.to) {
            for obstacle in &obstacles {
                let gap = gap_m(&obstacle.shape, at);
                assert!(gap >= site.radius_m - 1e-6, "{strip:?} passes {obstacle:?} at {gap} m");
            }
            for ring in site.area.outlines() {
                let gap = outline_m(&ring, at);
                assert!(gap >= site.edge_m - 1e-6, "{strip:?} passes the edge at {gap} m");
            }
        }
    }
    for (line, transition) in cover.transition_lines().iter().zip(&cover.transitions) {
        let ground = if transition.leaves { &site.anywhere } else { &site.inside };
        for leg in line.windows(2) {
            assert!(rows::is_open(ground, leg[0], leg[1]), "{line:?} is blocked");
        }
    }
    assert_eq!(cover.transitions.len() + 1, cover.strips.len());
}

/// A polygon around the middle of the map.
fn area() -> impl Strategy<Value = Vec<Point>> {
    let corner = prop::collection::vec(12.0..28.0_f64, 3..9);
    (corner, 0.0..1.0_f64).prop_map(|(radii, turn)| {
        let count = radii.len() as f64;
        let at = |(index, radius): (usize, f64)| {
            let angle = std::f64::consts::TAU * (index as f64 / count + turn);
            [30.0 + radius * wide::cos(angle), 30.0 + radius * wide::sin(angle)]
        };
        radii.into_iter().enumerate().map(at).collect()
    })
}

fn obstacle() -> impl Strategy<Value = Shape> {
    let place = || (10.0..50.0_f64, 10.0..50.0_f64);
    prop_oneof![
        (place(), 0.2..4.0_f64)
            .prop_map(|((x, y), radius)| { Shape::Circle { centre: [x, y], radius } }),
        (place(), (0.5..8.0_f64, 0.5..8.0_f64)).prop_map(|((x, y), (width, height))| {
            Shape::Polygon(vec![rectangle([x, y], [width, height])])
        }),
        (place(), place()).prop_map(|((a, b), (c, d))| Shape::Polyline(vec![[a, b], [c, d]])),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn random_areas_are_covered_without_touching_obstacles(
        area in area(),
        obstacles in prop::collection::vec(obstacle(), 0..6),
        resolution_m in prop_oneof![Just(0.5), Just(0.4), Just(1.0)],
        radius_m in prop_oneof![Just(0.0), 0.1..1.5_f64],
        width_m in 1.0..6.0_f64,
        angle in prop_oneof![Just(None), Just(Some(0.0)), (0.0..180.0_f64).prop_map(Some)],
    ) {
        let map = map(area, &obstacles);
        // An area that is all blocked is refused; that is another test's matter.
        if let Ok((site, cover)) =
            covered_site(&map, [resolution_m, radius_m], settings(width_m, angle))
        {
            check(&map, &site, &cover, width_m);
        }
    }
}

/// A rectangle has as many strips as fit and one for the rest. Fields of 48 x 48 m with a tool of
/// 11 m are known to lose their last strip (Fields2Cover, issues 70 and 167).
#[test]
fn rectangles_have_no_strip_too_many_and_none_too_few() {
    for (size, expected) in [([48.0, 48.0], 5), ([48.0, 56.0], 5), ([44.0, 44.0], 4)] {
        let map = map(rectangle([1.0, 2.0], size), &[]);
        let (site, cover) = covered_site(&map, [0.5, 0.0], settings(11.0, None)).unwrap();
        check(&map, &site, &cover, 11.0);
        assert_eq!(cover.strips.len(), expected, "{size:?}");
        assert_eq!(cover.turns(), 2 * (expected - 1));
        // Back and forth.
        for pair in cover.strips.windows(2) {
            assert!(distance(pair[0].to, pair[1].from) < 11.5, "{pair:?}");
        }
    }
}

/// Obstacles split a field, and transitions between strips lead around them.
#[test]
fn transitions_lead_around_obstacles() {
    let pond = Shape::Circle { centre: [30.0, 30.0], radius: 8.0 };
    let hedge = Shape::Polyline(vec![[12.0, 20.0], [12.0, 58.0]]);
    let map = map(rectangle([2.0, 2.0], [56.0, 56.0]), &[pond, hedge]);
    for angle in [Some(0.0), Some(90.0), Some(37.0), None] {
        let (site, cover) = covered_site(&map, [0.5, 0.4], settings(4.0, angle)).unwrap();
        check(&map, &site, &cover, 4.0);
        assert!(cover.transitions.iter().all(|transition| !transition.leaves));
        // A field without obstacles of this size takes 784 m.
        assert!(cover.strips_m() < 900.0, "{} m", cover.strips_m());
    }
}

/// Fields that people reported to other planners: inner rings that are crossed (Fields2Cover, issue 131),
/// a slim slanted obstacle (193), a concave area that is left between strips (cockpit, issue 1422), a
/// tool that is wider than the robot (full_coverage_path_planner, issue 58).
#[test]
fn fields_that_other_planners_had_trouble_with() {
    let square = || rectangle([0.0, 0.0], [50.0, 50.0]);
    let rings = [rectangle([10.0, 10.0], [5.0, 15.0]), rectangle([20.0, 20.0], [5.0, 5.0])];
    let slanted = vec![[0.0, 0.0], [32.78, 1.58], [31.0, 58.0], [-0.6, 57.0]];
    let slanted = slanted.into_iter().map(|[x, y]: Point| [x + 1.0, y]).collect();
    let slim = vec![[5.7, 5.65], [7.3, 5.65], [5.4, 52.7], [4.1, 52.6]];
    let comb = vec![
        [5.0, 5.0],
        [55.0, 5.0],
        [55.0, 50.0],
        [45.0, 50.0],
        [45.0, 15.0],
        [35.0, 15.0],
        [35.0, 50.0],
        [25.0, 50.0],
        [25.0, 15.0],
        [15.0, 15.0],
        [15.0, 50.0],
        [5.0, 50.0],
    ];
    let polygons = |rings: &[Vec<Point>]| {
        rings.iter().map(|ring| Shape::Polygon(vec![ring.clone()])).collect()
    };
    let fields: [(Vec<Point>, Vec<Shape>, f64, f64); 4] = [
        (square(), polygons(&rings), 3.0, 1.5),
        (slanted, polygons(&[slim]), 2.0, 0.5),
        (comb, Vec::new(), 2.5, 0.5),
        (square(), polygons(&rings), 6.0, 0.15),
    ];
    for (area, obstacles, width_m, radius_m) in fields {
        let map = map(area, &obstacles);
        for angle in [Some(0.0), Some(90.0), Some(45.0), None] {
            let found = covered_site(&map, [0.5, radius_m], settings(width_m, angle));
            let (site, cover) = found.unwrap();
            check(&map, &site, &cover, width_m);
            assert!(cover.transitions.iter().all(|transition| !transition.leaves), "{angle:?}");
        }
    }
}

/// What a wall cuts off is not covered, and counts as such.
#[test]
fn ground_that_cannot_be_reached_is_left() {
    let wall = Shape::Polyline(vec![[40.0, 0.0], [40.0, 60.0]]);
    let map = map(rectangle([10.0, 10.0], [40.0, 20.0]), &[wall]);
    let (site, cover) = covered_site(&map, [0.5, 0.3], settings(2.0, None)).unwrap();
    check(&map, &site, &cover, 2.0);
    assert!(cover.strips.iter().all(|strip| strip.from[0] < 40.0 && strip.to[0] < 40.0));
    assert!(site.cut_off.get(Cell::new(90, 40)) && site.ground.cells.get(Cell::new(60, 40)));
}

/// A slanted triangle and a star had strips from a point to itself.
#[test]
fn no_strip_is_a_point() {
    let triangle = vec![[7.0, 5.0], [52.0, 15.0], [12.0, 45.0]];
    let star = (0..10).map(|corner| {
        let (radius, angle) =
            (if corner % 2 == 0 { 22.0 } else { 9.0 }, f64::from(corner) * 0.628 + 0.1);
        [30.0 + radius * wide::cos(angle), 30.0 + radius * wide::sin(angle)]
    });
    for (area, width_m) in [(triangle, 5.0), (star.collect(), 2.0)] {
        let map = map(area, &[]);
        for angle in [None, Some(0.0), Some(37.0)] {
            let (site, cover) = covered_site(&map, [0.5, 0.3], settings(width_m, angle)).unwrap();
            check(&map, &site, &cover, width_m);
        }
    }
}

/// A field that goes on beyond the map was reported as covered by 100 %.
#[test]
fn what_lies_off_the_map_is_measured() {
    let hole = rectangle([62.0, 12.0], [4.0, 4.0]);
    let mut map = map(rectangle([40.0, 10.0], [40.0, 10.0]), &[]);
    map.features[0].shape = Shape::Polygon(vec![rectangle([40.0, 10.0], [40.0, 10.0]), hole]);
    let (site, _) = covered_site(&map, [0.5, 0.3], settings(3.0, None)).unwrap();
    assert!((site.off_map_m2 - 184.0).abs() < 1e-6, "{}", site.off_map_m2);
    // So does what lies outside the map's own outline.
    map.boundary = Some(rectangle([0.0, 0.0], [50.0, 60.0]));
    let (site, _) = covered_site(&map, [0.5, 0.3], settings(3.0, None)).unwrap();
    assert!((site.off_map_m2 - 284.0).abs() < 1e-6, "{}", site.off_map_m2);
    map.boundary = None;
    map.features[0].shape = Shape::Polygon(vec![rectangle([0.0, 0.0], [60.0, 60.0])]);
    let (site, _) = covered_site(&map, [0.5, 0.3], settings(3.0, None)).unwrap();
    assert_eq!(site.off_map_m2, 0.0);
}

#[test]
fn areas_with_mistakes_are_refused() {
    let named = |map: &Map, name: &str| Area::named(map, name).err().map(|all| draw(&all, false));
    let bow = vec![[10.0, 10.0], [20.0, 20.0], [20.0, 10.0], [10.0, 20.0]];
    let pond = Shape::Circle { centre: [30.0, 30.0], radius: 8.0 };
    let mut map = map(bow.clone(), std::slice::from_ref(&pond));
    map.features[1].name = "pond".to_owned();
    map.features.push(feature("path", Role::Zone, Shape::Polyline(vec![[0.0, 0.0], [9.0, 9.0]])));
    for (name, expected) in [
        ("fields", "did you mean `field`?"),
        ("xyz", "the map has: field, path"),
        ("pond", "is an obstacle"),
        ("path", "is an open line"),
        ("field", "is not a polygon"),
    ] {
        let found = named(&map, name).unwrap_or_default();
        assert!(found.contains(expected), "{name}: {found}");
    }
    assert!(corners(&bow).is_err() && corners(&bow[..2]).is_err());
    assert!(corners(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).is_err());
    assert!(corners(&rectangle([0.0, 0.0], [2.0, 2.0])).is_ok());
    let all = self::map(rectangle([25.0, 25.0], [10.0, 10.0]), &[pond]);
    let blocked = covered_site(&all, [0.5, 0.4], settings(2.0, None));
    assert!(blocked.is_err_and(|text| text.contains("no cell that the robot may enter")));
    let off = self::map(rectangle([100.0, 100.0], [10.0, 10.0]), &[]);
    let off = covered_site(&off, [0.5, 0.4], settings(2.0, None));
    assert!(off.is_err_and(|text| text.contains("lies off the map")));
}

/// The mission of a field is built as it is, has a plan to its first strip, and keeps what it was
/// added to; a second run replaces the first.
#[test]
fn a_mission_is_built_as_it_is_written() {
    let pond = Shape::Circle { centre: [30.0, 30.0], radius: 6.0 };
    let map = map(rectangle([5.0, 5.0], [50.0, 50.0]), &[pond]);
    let (_, cover) = covered_site(&map, [0.5, 0.4], settings(5.0, None)).unwrap();
    let base = "# Mine.\nmap = 'old.ovl'\n[goals]\nhome = [2, 2]\n[facts]\nready = true\n\
                [actions]\nrest = { do = 'hold 1 s' }\n";
    let writing = Writing {
        base: Some(base),
        map: "field.ovl",
        points: &[],
        set: &[("resolution", 0.5.into())],
        width_m: 5.0,
        plan_each: false,
        speed_mps: 1.0,
        title: "field",
    };
    let text = mission(&cover, &writing).unwrap();
    assert!(text.contains("# Mine.") && text.contains("home = [2, 2]"), "{text}");
    let (read, mut problems) = parse(&Source { name: "m".to_owned(), text: text.clone() }.into());
    let options = Options::default();
    let input = Input { map: &map, source: None, mission: &read, options: &options };
    let blob = compile(&input, &|_, _| (), &mut problems);
    assert!(!has_errors(&problems), "{}", draw(&problems, false));
    let blob = blob.expect("a blob");
    let blob = Blob::parse_exact(&blob).expect("it is sound");
    assert!(blob.parallel_plans().any(|plan| plan.name() == "strip 1"));
    assert_eq!(blob.mission().behaviours().len(), 1);
    let again = mission(&cover, &Writing { base: Some(&text), ..writing }).unwrap();
    assert_eq!(again, text);
}

/// Names that begin as those of strips are the user's; those that are equal are refused, except in a
/// mission that the command wrote.
#[test]
fn a_second_run_replaces_the_first_and_nothing_of_the_user() {
    let map = map(rectangle([5.0, 5.0], [50.0, 50.0]), &[]);
    let cover_by = |width_m| covered_site(&map, [0.5, 0.4], settings(width_m, None)).unwrap().1;
    let (narrow, broad) = (cover_by(5.0), cover_by(10.0));
    let mine = "[goals]\n\"strip mall\" = [2, 2]\n\"strip 01\" = [3, 3]\n[frames]\n\
                \"strip club\" = {}\n\"strips of land\" = {}\n[actions]\n\
                \"go to strip mall\" = { do = \"hold 1 s\" }\n";
    fn writing<'a>(base: &'a str, title: &'a str, width_m: f64) -> Writing<'a> {
        Writing {
            base: Some(base),
            map: "field.ovl",
            points: &[],
            set: &[],
            width_m,
            plan_each: true,
            speed_mps: 1.0,
            title,
        }
    }
    let first = mission(&narrow, &writing(mine, "first", 2.0)).unwrap();
    let second = mission(&broad, &writing(&first, "second", 3.0)).unwrap();
    for text in [&first, &second] {
        let names = mine.lines().filter(|line| line.starts_with('"'));
        names.for_each(|line| assert!(text.contains(line), "{line} is gone from\n{text}"));
    }
    assert!(first.contains("\"strip 10\" = ") && !second.contains("\"strip 10\" = "), "{second}");
    // The tolerance follows the width, unless it is the user's.
    assert!(first.contains("goal_tolerance = 0.5 #") && second.contains("goal_tolerance = 0.75 #"));
    let own = second.replace("0.75 # by cover, from the width", "0.3 # mine");
    let third = mission(&narrow, &writing(&own, "third", 2.0)).unwrap();
    assert!(third.contains("goal_tolerance = 0.3 # mine"), "{third}");
    // One title, also below a comment of the user.
    let below = format!("# Mine.\n{second}");
    let again = mission(&broad, &writing(&below, "again", 3.0)).unwrap();
    assert!(again.starts_with("# Mine.\n# Strips by `plan-compiler cover`: again\n"), "{again}");
    assert_eq!(again.matches("# Strips by").count(), 1, "{again}");
    for (table, name, value) in [
        ("goals", "strip 3", "[2, 2]"),
        ("frames", "cover", "{}"),
        ("behaviours", "cover", "{}"),
        ("facts", "at strip", "true"),
        ("actions", "skip strip", "{ do = \"hold 9 s\" }"),
        ("actions", "work(x, y)", "{ do = \"hold 9 s\" }"),
    ] {
        let base = format!("[{table}]\n\"{name}\" = {value}\n");
        let refused = mission(&narrow, &writing(&base, "refused", 2.0)).unwrap_err();
        let expected = format!("the mission has `{name}` in [{table}], a name that strips need");
        assert_eq!(refused.message, expected);
        assert_eq!(refused.help, Some(format!("rename `{name}` wherever the mission uses it")));
    }
}

#[test]
fn more_strips_than_a_mission_holds_are_refused() {
    let map = map(rectangle([5.0, 5.0], [50.0, 50.0]), &[]);
    let (_, cover) = covered_site(&map, [0.5, 0.4], settings(1.0, None)).unwrap();
    let writing = Writing {
        base: None,
        map: "field.ovl",
        points: &[],
        set: &[],
        width_m: 1.0,
        plan_each: false,
        speed_mps: 1.0,
        title: "field",
    };
    let refused = mission(&cover, &writing).unwrap_err();
    assert!(refused.message.contains("a mission holds 64"), "{}", refused.message);
}
