//! Whole missions on the campus, on the host: which robots arrive, are trapped or touch something.
//!
//! The runs use all of the product except a board: the map reader, the compiler's blob, the
//! receiver's bytes, the runtime's tasks and the controller.

use maps::problem::Source;
use maps::{Map, Reference};
use maps::{formats, source};
use math::Vec2;
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::parse;
use plan_format::{Answer, Blob, Cell};
use sim::{
    Body, Chassis, HostPilot, Limits, Outcome, Point, Random, ReceiverSettings, Robot,
    SensorSettings, SensorSuite, Stream, World,
};
use std::sync::{Arc, OnceLock};

mod company;
mod faults;
mod receivers;
mod starts;

/// The campus: its map and its true world.
struct Campus {
    map: Map,
    world: World,
    reference: Reference,
}

fn campus() -> &'static Campus {
    static CAMPUS: OnceLock<Campus> = OnceLock::new();
    CAMPUS.get_or_init(|| Campus::read("campus.opar"))
}

impl Campus {
    fn read(name: &str) -> Self {
        let (map, problems) = formats::read(&it::own_map(name), &Default::default());
        let map = map.unwrap_or_else(|| panic!("{name} is readable: {problems:?}"));
        let reference = map.reference.expect("the campus lies on the globe");
        Self { world: World::of_map(&map), map, reference }
    }

    /// The blob of the shipped mission with some of its text replaced.
    fn blob(&self, replacements: &[(&str, &str)]) -> Vec<u8> {
        let path = it::own_map("campus.mission.toml");
        let (shipped, _) = source::read_text(&path).expect("the mission is readable");
        let mut text = shipped.text.clone();
        for (from, to) in replacements {
            assert!(text.contains(from), "the shipped mission has no `{from}`");
            text = text.replace(from, to);
        }
        let (mission, mut problems) = parse(&Arc::new(Source { name: shipped.name.clone(), text }));
        let options = Options::default();
        let input = Input { map: &self.map, source: None, mission: &mission, options: &options };
        let blob = compile(&input, &|_, _| {}, &mut problems);
        assert!(problems.is_empty(), "{problems:?}");
        blob.expect("without problems there is a blob")
    }
}

/// The blob of the campus and its shipped mission with some text replaced.
fn blob(replacements: &[(&str, &str)]) -> Vec<u8> {
    campus().blob(replacements)
}

/// The body that the shipped mission describes.
fn chassis(blob: &Blob<'_>) -> Chassis {
    Chassis::of(&blob.parameters().vehicle)
}

/// A robot of the shipped mission, before its first tick.
fn robot<'p>(
    blob: Blob<'p>,
    start: Point,
    heading_rad: f64,
    sensors: SensorSettings,
    seed: u64,
) -> Robot<SensorSuite, HostPilot<'p>> {
    let sigma_m = sensors.gps.map_or(0.0, |gps| gps.sigma_m);
    let body = Body::new(chassis(&blob), start, heading_rad);
    let sensors = SensorSuite::new(sensors, &campus().reference, seed);
    Robot::new(body, sensors, HostPilot::new(blob), limits(&blob, sigma_m))
}

#[test]
fn the_overlay_is_the_same_campus() {
    let blobs = [blob(&[]), Campus::read("campus.ovl").blob(&[])];
    let [opar, overlay] = blobs.each_ref().map(|blob| Blob::parse(blob).expect("a good blob"));
    let grid = opar.grid();
    assert_eq!(grid, overlay.grid());
    let places = [opar, overlay].map(|plan| {
        let frame = plan.map_frame().expect("the campus lies on the globe");
        frame.to_geodetic(Vec2::new(200.0, 30.0))
    });
    assert!(places[0].lat_e7.abs_diff(places[1].lat_e7) <= 2, "{places:?}");
    assert!(places[0].lon_e7.abs_diff(places[1].lon_e7) <= 2, "{places:?}");

    let mut routes = 0;
    for name in ["north-gate", "south-gate", "depot", "laboratory-court"] {
        let plans = [opar, overlay].map(|plan| plan.find(name).expect("the mission names it"));
        for layer in ["physical", "comms"] {
            let [a, b] = plans.map(|plan| {
                let mut layers = (0..plan.layer_count()).filter_map(|i| plan.layer(i));
                layers.find(|found| found.name() == layer).expect("both maps have attenuation")
            });
            let cells = (0..grid.rows)
                .flat_map(|row| (0..grid.columns).map(move |column| Cell::new(column, row)));
            for cell in cells {
                // Inside a building the overlay has unreachable floor, OPAR a solid block.
                if let Answer::Move { cost, .. } = a.look_up(cell) {
                    let same = matches!(b.look_up(cell), Answer::Move { cost: c, .. } if c == cost);
                    assert!(same, "{name}/{layer} at {cell:?}");
                    routes += 1;
                }
            }
        }
    }
    assert!(routes > 200_000, "{routes} cells were compared");
}

/// Limits of a run. The robot stops where it believes the goal to be; its receiver is almost always
/// less than three sigma off.
fn limits(blob: &Blob<'_>, sigma_m: f64) -> Limits {
    let goal = blob.goal().expect("the mission has a goal");
    let tolerance_m = f64::from(blob.parameters().schemas.goal_tolerance_m);
    Limits {
        goal_tolerance_m: tolerance_m + 0.2 + 3.0 * sigma_m,
        ..Limits::to_goal([f64::from(goal.x), f64::from(goal.y)])
    }
}
