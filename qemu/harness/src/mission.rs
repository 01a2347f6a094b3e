//! A map and its mission, compiled and ready to be driven through.

use std::path::Path;

use math::Vec2;
use plan_compiler::compile::compile;
use plan_compiler::formats::{self, ReadOptions};
use plan_compiler::input::{Input, Options};
use plan_compiler::map::Map;
use plan_compiler::mission::{self, Goal, Mission, Named};
use plan_compiler::numbers::pair;
use plan_compiler::problem::has_errors;
use plan_compiler::problem::{self, Place, Problem, Source};
use plan_compiler::source;
use plan_format::grid::cost_metres;
use plan_format::parameters::Gains;
use plan_format::{Answer, Blob, Layer, ParallelPlan};
use sim::{
    Body, Chassis, Limits, Pilot, Point, Random, ReceiverSettings, Run, SensorSettings,
    SensorSuite, Stream, Surroundings, World,
};

/// The mixes of the paper by their names in a mission file (W, section 4).
pub const PRESETS: [(&str, Gains); 4] = [
    ("100:0", Gains::REACTIVE_ONLY),
    ("66:34", Gains::MOSTLY_REACTIVE),
    ("34:66", Gains::MOSTLY_PLAN),
    ("0:100", Gains::PLAN_ONLY),
];

/// What is to be different from the mission file.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// The parallel plan to follow.
    pub plan: Option<String>,
    /// The gains.
    pub gains: Option<Gains>,
    /// Goals instead of those of mission and map.
    pub goals: Vec<Goal>,
}

/// How a run begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Where, metres.
    pub position: Point,
    /// Radians counter-clockwise from east.
    pub heading_rad: f64,
    /// Of everything that is drawn by chance.
    pub seed: u64,
    /// How good the sensors are.
    pub sensors: SensorSettings,
}

/// A compiled mission.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The map.
    pub map: Map,
    /// The plans, as a robot gets them.
    pub blob: Vec<u8>,
    /// What its work changes, from the file beside the map if there is one.
    pub surroundings: Option<Surroundings>,
}

impl Scenario {
    /// Compiles a map, with the mission file beside it, or a mission file that names its map.
    /// The error lists everything that is wrong, as `plan-compiler build` does.
    pub fn compile(path: &Path, changes: &Changes) -> Result<Self, String> {
        let mut problems = Vec::new();
        let scenario = Self::read_and_compile(path, changes, &mut problems);
        let scenario = scenario.filter(|_| !has_errors(&problems));
        scenario.ok_or_else(|| problem::draw(&problems, false))
    }

    fn read_and_compile(
        path: &Path,
        changes: &Changes,
        problems: &mut Vec<Problem>,
    ) -> Option<Self> {
        let is_mission = path.extension().is_some_and(|extension| extension == "toml");
        let beside = path.with_extension("mission.toml");
        let mut mission = match path {
            path if is_mission => read_mission(path, problems)?,
            _ if beside.exists() => read_mission(&beside, problems).unwrap_or_default(),
            _ => Mission::default(),
        };
        let map_path = match (&mission.map, is_mission) {
            (Some(map), true) => map.clone(),
            (None, true) => {
                let message = format!("{} does not name its map", path.display());
                problems.push(Problem::error(message).mend("give the map's file instead"));
                return None;
            }
            (_, false) => path.to_owned(),
        };
        // Beside the mission, which may be one of several of its map; otherwise beside the map.
        let mut surroundings = Surroundings::beside(path, problems);
        if surroundings.is_none() && is_mission && !has_errors(problems) {
            surroundings = Surroundings::beside(&map_path, problems);
        }
        if let Some(name) = &changes.plan {
            mission.plan = Some(asked_for(name));
        }
        mission.parameters.gains = changes.gains.unwrap_or(mission.parameters.gains);
        let (map, found) = formats::read(&map_path, &mission.reading(ReadOptions::default()));
        let is_incomplete = has_errors(&found);
        problems.extend(found);
        let map = map.filter(|_| !is_incomplete)?;
        let options = Options { goals: changes.goals.clone(), ..Options::default() };
        let input = Input { map: &map, source: None, mission: &mission, options: &options };
        let blob = compile(&input, &|_, _| (), problems)?;
        Some(Self { map, blob, surroundings })
    }

    /// The plans as a robot sees them.
    pub fn plan(&self) -> Blob<'_> {
        Blob::parse_exact(&self.blob).expect("the compiler reads back what it writes")
    }

    /// The parallel plan that the robot follows.
    pub fn parallel_plan(&self) -> ParallelPlan<'_> {
        let plan = self.plan();
        plan.parallel_plan(plan.parameters().plan.into()).expect("a compiled blob has plans")
    }

    /// The layer that the robot follows from a place: the most constrained one that has a
    /// route from there; `None` where none has.
    pub fn layer_from(&self, place: Point) -> Option<Layer<'_>> {
        let (plan, parallel) = (self.plan(), self.parallel_plan());
        let mut layers =
            (0..parallel.layer_count()).rev().filter_map(|index| parallel.layer(index));
        layers.find(|layer| way_m(&plan, layer, place).is_some())
    }

    /// A place with a route where the body is clear of obstacles, drawn by chance; `None`
    /// where many draws find none.
    pub fn draw_start(&self, world: &World, seed: u64) -> Option<Point> {
        const DRAWS: usize = 100_000;
        let (plan, mut random) = (self.plan(), Random::new(seed, Stream::Start));
        let grid = plan.grid();
        let mut draw = |axis: usize, cells: u32| {
            let low = grid.corner_m[axis];
            random.between(low, low + f64::from(cells) * grid.resolution_m)
        };
        let radius_m = plan.parameters().vehicle.radius_m.into();
        (0..DRAWS)
            .map(|_| [draw(0, grid.columns), draw(1, grid.rows)])
            .find(|&point| self.layer_from(point).is_some() && world.is_clear(point, radius_m))
    }

    /// When a run ends: it has arrived where the robot believes the goal to be, which its
    /// receiver puts up to three sigma off in almost all cases.
    fn limits(&self, start: &Start) -> Limits {
        let sigma_m = start.sensors.gps.map_or(0.0, |gps| gps.sigma_m);
        let tolerance_m = f64::from(self.plan().parameters().schemas.goal_tolerance_m);
        Limits {
            goal_tolerance_m: tolerance_m + 0.2 + 3.0 * sigma_m,
            ends_at_goal: self.plan().mission().behaviours().is_empty(),
            ..Limits::to_goal(self.parallel_plan().goal_m())
        }
    }

    /// What stands on the map.
    pub fn world(&self) -> World {
        World::of_map(&self.map)
    }

    /// The usual sensors, with the receiver that the surroundings' file says.
    pub fn sensors(&self) -> SensorSettings {
        let usual = SensorSettings::USUAL;
        let said = self.surroundings.as_ref().and_then(|surroundings| surroundings.gps_sigma);
        let gps =
            usual.gps.map(|gps| ReceiverSettings { sigma_m: said.unwrap_or(gps.sigma_m), ..gps });
        SensorSettings { gps, ..usual }
    }

    /// A run before its first tick; an error says why there cannot be one.
    pub fn run<'w, P: Pilot>(
        &self,
        world: &'w World,
        start: &Start,
        pilot: P,
    ) -> Result<Run<'w, SensorSuite, P>, String> {
        let reference = self.map.reference.as_ref();
        let reference = reference.ok_or(
            "the map does not say where on the globe it lies, and the robot drives by GPS; give \
             it a reference: GLOBAL_REF_POINT LAT LON in an overlay",
        )?;
        let vehicle = self.plan().parameters().vehicle;
        let chassis = Chassis { radius_m: vehicle.radius_m.into(), ..Chassis::default() };
        if !world.is_clear(start.position, chassis.radius_m) {
            let nearest = near_clear(world, start.position, chassis.radius_m);
            let elsewhere = nearest.map_or_else(
                || "start elsewhere: --start X,Y".to_owned(),
                |at| format!("a clear place near it: --start {:.2},{:.2}", at[0], at[1]),
            );
            let at = pair(start.position);
            return Err(format!("at the start {at} the body stands in an obstacle; {elsewhere}"));
        }
        let sensors = SensorSuite::new(start.sensors, reference, start.seed);
        let body = Body::new(chassis, start.position, start.heading_rad);
        let run = Run::new(world, body, sensors, pilot, self.limits(start));
        Ok(match &self.surroundings {
            Some(surroundings) => run.within(surroundings.clone()),
            None => run,
        })
    }
}

/// A place near another one where a body is clear of obstacles, of those on rings about it.
fn near_clear(world: &World, about: Point, radius_m: f64) -> Option<Point> {
    const RINGS: u32 = 200;
    const RING_M: f64 = 0.25;
    let steps = [-1.0, 0.0, 1.0];
    let directions = steps.iter().flat_map(|x| steps.iter().map(move |y| [*x, *y]));
    (1..=RINGS).find_map(|ring| {
        let reach_m = f64::from(ring) * RING_M;
        let mut places =
            directions.clone().map(|step| [0, 1].map(|axis| about[axis] + reach_m * step[axis]));
        places.find(|&place| world.is_clear(place, radius_m))
    })
}

/// Length of a layer's route from a place to the goal, metres; `None` where there is none.
pub fn way_m(blob: &Blob<'_>, layer: &Layer<'_>, from: Point) -> Option<f64> {
    let cell = blob.cell_at(Vec2::new(from[0] as f32, from[1] as f32))?;
    match layer.look_up(cell) {
        Answer::Move { cost, .. } => Some(cost_metres(cost, blob.grid().resolution_m)),
        Answer::Goal => Some(0.0),
        _ => None,
    }
}

fn read_mission(path: &Path, problems: &mut Vec<Problem>) -> Option<Mission> {
    let (text, found) = source::read_text(path).map_err(|problem| problems.push(problem)).ok()?;
    let (mission, mistakes) = mission::parse(&text);
    problems.extend(found.into_iter().chain(mistakes));
    if has_errors(problems) { None } else { Some(mission) }
}

/// A name that stands in no file.
fn asked_for(name: &str) -> Named {
    let source = Source { name: "--plan".to_owned(), text: name.to_owned() };
    let place = Place { source: source.into(), span: 0..name.len(), label: "asked for".to_owned() };
    Named { name: name.to_owned(), place }
}
