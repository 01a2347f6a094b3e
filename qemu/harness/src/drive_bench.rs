//! The driving benchmark: does a robot with default parameters get there, untouched, and how fast?
//!
//! A [`Course`] is a map with a start and a goal; courses come from [`worlds`]. A [`Row`] drives all
//! courses of a suite under one [`Setting`]: what of the map the robot knows, its sensors and its
//! steering. Every run is seeded by its course and independent of the others, so the numbers are the
//! same on every machine, with any number of threads, and for any division into shards.
//!
//! Source of the score and of the worlds: the BARN challenge (Xiao et al. 2022, "Autonomous ground
//! navigation in highly constrained spaces").

pub mod table;
pub mod worlds;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use plan_compiler::trace::Trace;
use plan_format::parameters::Steering;
use serde::{Deserialize, Serialize};
use sim::scenario::route_m;
use sim::{
    Conditions, Difference, Disc, HostPilot, Outcome, Pilot, Random, Recorder, Repeat, Scenario,
    SensorSettings, Start, Stream,
};

use crate::mission;
pub use worlds::{Course, Suite};

/// What differs between the rows of a suite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Share of the obstacles that the robot's map lacks, in percent.
    pub unmapped_percent: u8,
    /// Whether discs cross the course at 1 m/s.
    pub has_discs: bool,
    /// Whether the sensors have the usual errors, with a GPS of 2 cm, or none.
    pub has_usual_sensors: bool,
    /// The vehicle.
    pub vehicle: VehicleKind,
}

/// A vehicle of the benchmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VehicleKind {
    /// Turns on the spot.
    Differential,
    /// Turns on circles of at least 0.5 m.
    Ackermann,
    /// Turns while it moves, and drifts.
    Boat,
}

impl VehicleKind {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Differential => "differential",
            Self::Ackermann => "ackermann",
            Self::Boat => "boat",
        }
    }

    fn steering(self) -> Steering {
        match self {
            Self::Differential => Steering::Differential,
            Self::Ackermann => Steering::Ackermann,
            Self::Boat => Steering::Boat,
        }
    }
}

/// One line of the table: a suite under a setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The suite.
    pub suite: Suite,
    /// The setting.
    pub setting: Setting,
}

/// The rows of the whole table.
pub fn rows() -> Vec<Row> {
    let plain = Setting {
        unmapped_percent: 0,
        has_discs: false,
        has_usual_sensors: false,
        vehicle: VehicleKind::Differential,
    };
    let usual = Setting { has_usual_sensors: true, ..plain };
    let unmapped = |unmapped_percent| Setting { unmapped_percent, ..plain };
    let of = |vehicle| Setting { vehicle, ..plain };
    let settings: &[Setting] = &[
        plain,
        usual,
        unmapped(10),
        unmapped(30),
        unmapped(100),
        Setting { has_discs: true, ..plain },
        of(VehicleKind::Ackermann),
        of(VehicleKind::Boat),
    ];
    let is_driven = |suite: Suite, setting: &Setting| match suite {
        Suite::Barn | Suite::City => true,
        // Without its one obstacle on the map, a course of these suites is another course.
        Suite::Doors | Suite::Corridors | Suite::Courtyards => setting.unmapped_percent == 0,
        Suite::Campus => setting.vehicle == VehicleKind::Differential,
    };
    let rows = Suite::ALL.iter().flat_map(|&suite| {
        let driven = settings.iter().filter(move |setting| is_driven(suite, setting));
        driven.map(move |&setting| Row { suite, setting })
    });
    rows.collect()
}

/// The result of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Its number among all runs, so that shards can be merged.
    pub number: usize,
    /// Number of its row in [`rows`].
    pub row: usize,
    /// Name of its course.
    pub course: String,
    /// Whether the plan has a route from the start; runs without one are not driven.
    pub has_route: bool,
    /// Whether the robot arrived.
    pub is_reached: bool,
    /// How often it touched an obstacle, or a disc that it had seen in time to stop, as it moved.
    pub contacts: u32,
    /// How often a disc ran into it, which stood, moved away or could not have seen it in time.
    pub strikes: u32,
    /// Time, seconds.
    pub time_s: f64,
    /// Time of the shortest path at top speed, seconds.
    pub optimal_s: f64,
    /// Distance driven, metres.
    pub distance_m: f64,
    /// Sum of all turns, radians.
    pub turn_rad: f64,
    /// Smallest gap to an obstacle, metres; `None` if none came near.
    pub closest_m: Option<f64>,
    /// The trace hash; in JSON 16 hexadecimal digits, since not every reader has whole numbers of 64
    /// bits.
    #[serde(with = "hex")]
    pub trace_hash: u64,
}

/// A number as hexadecimal digits.
mod hex {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(super) fn serialize<S: Serializer>(number: &u64, out: S) -> Result<S::Ok, S::Error> {
        out.serialize_str(&format!("{number:016x}"))
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(text: D) -> Result<u64, D::Error> {
        u64::from_str_radix(&String::deserialize(text)?, 16).map_err(D::Error::custom)
    }
}

impl Run {
    /// Whether the robot arrived without contact.
    pub fn is_success(&self) -> bool {
        self.is_reached && self.contacts == 0
    }

    /// Score of the BARN challenge: success x OT / clip(time, 2 OT, 8 OT), at most 0.5.
    pub fn score(&self) -> f64 {
        if !self.is_success() {
            return 0.0;
        }
        self.optimal_s / self.time_s.clamp(2.0 * self.optimal_s, 8.0 * self.optimal_s)
    }
}

/// A run and the route that it drove, for pictures.
#[derive(Clone, Debug)]
pub struct Driven {
    /// The result.
    pub run: Run,
    /// The driven route.
    pub outcome: Outcome,
    /// Where and in which world.
    pub scenario: Scenario,
    /// The start.
    pub start: Start,
}

/// What all shards of one table have in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// The suites, in order.
    pub suites: Vec<Suite>,
    /// The text that rows contain.
    pub only: String,
    /// Courses of each suite whose number is not fixed.
    pub count: u32,
    /// Seed of the first generated course.
    pub seed: u64,
    /// Whether the suite barn has the worlds of the challenge; otherwise seeded ones.
    pub has_challenge: bool,
    /// Number of runs of all shards together.
    pub runs: usize,
}

/// What to drive.
#[derive(Clone, Debug)]
pub struct Drives {
    /// The courses of all suites.
    pub courses: Vec<Course>,
    /// Only these rows, by their number in [`rows`].
    pub rows: Vec<usize>,
    /// Index and count of shards: drives only runs whose number leaves that remainder.
    pub shard: (usize, usize),
}

impl Drives {
    /// All runs of the plan: row and course.
    fn runs(&self) -> Vec<(usize, usize, &Course)> {
        let all = rows();
        let runs = self.rows.iter().flat_map(|&row| {
            let suite = all[row].suite;
            let courses = self.courses.iter().filter(move |course| course.suite == suite);
            courses.map(move |course| (row, course))
        });
        let (index, count) = self.shard;
        let numbered = runs.enumerate().map(|(number, (row, course))| (number, row, course));
        numbered.filter(|(number, ..)| number % count == index).collect()
    }

    /// Number of runs.
    pub fn count(&self) -> usize {
        self.runs().len()
    }

    /// Number of runs of all shards together.
    pub fn count_of_all(&self) -> usize {
        Self { shard: (0, 1), ..self.clone() }.count()
    }

    /// Drives all runs on all cores and calls `step` after each. The order of the results is that
    /// of the runs. The error is a message for the user.
    pub fn drive(&self, step: &(dyn Fn() + Sync)) -> Result<Vec<Run>, String> {
        let (all, runs) = (rows(), self.runs());
        let next = AtomicUsize::new(0);
        let threads = std::thread::available_parallelism().map_or(1, |count| count.get());
        let work = || {
            let mut done = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(&(number, row, course)) = runs.get(index) else { return Ok(done) };
                let driven = drive(row, &all[row].setting, course)?;
                done.push(Run { number, ..driven.run });
                step();
            }
        };
        let results: Vec<Result<Vec<Run>, String>> = std::thread::scope(|scope| {
            let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            let joined = workers.into_iter().map(|worker| worker.join());
            joined.map(|done| done.expect("a worker panics only with its run")).collect()
        });
        let mut done = Vec::new();
        for result in results {
            done.extend(result?);
        }
        done.sort_by_key(|run| run.number);
        Ok(done)
    }
}

/// Drives one course under a setting.
pub fn drive(row: usize, setting: &Setting, course: &Course) -> Result<Driven, String> {
    let (scenario, start) = prepared(setting, course)?;
    let result = run(row, course, &scenario, &start, HostPilot::new(scenario.plan()));
    let (run, outcome) = result?;
    Ok(Driven { run, outcome, scenario, start })
}

/// As [`drive`], with the trace of the run.
pub fn record(row: usize, setting: &Setting, course: &Course) -> Result<(Driven, Trace), String> {
    let (scenario, start) = prepared(setting, course)?;
    let mut recorder = Recorder::new(HostPilot::new(scenario.plan()));
    let (run, outcome) = run(row, course, &scenario, &start, &mut recorder)?;
    let percepts = recorder.finish();
    let trace = Trace { blob: scenario.blob.clone(), percepts, hash: outcome.trace_hash };
    Ok((Driven { run, outcome, scenario, start }, trace))
}

/// The world of a course, and where the robot starts.
fn prepared(setting: &Setting, course: &Course) -> Result<(Scenario, Start), String> {
    let scenario = scenario(setting, course)?;
    let sensors =
        if setting.has_usual_sensors { SensorSettings::SURVEYOR } else { SensorSettings::PERFECT };
    let Course { start, heading_rad, seed, .. } = *course;
    Ok((scenario, Start { position: start, heading_rad, seed, sensors }))
}

/// Lets a pilot drive a course, if there is a route.
fn run(
    row: usize,
    course: &Course,
    scenario: &Scenario,
    start: &Start,
    pilot: impl Pilot,
) -> Result<(Run, Outcome), String> {
    let mut run = Run {
        number: 0,
        row,
        course: course.name.clone(),
        has_route: scenario.layer_from(start.position).is_some(),
        is_reached: false,
        contacts: 0,
        strikes: 0,
        time_s: 0.0,
        optimal_s: course.optimal_s.unwrap_or_else(|| optimal_s(scenario, course)),
        distance_m: 0.0,
        turn_rad: 0.0,
        closest_m: None,
        trace_hash: 0,
    };
    if !run.has_route {
        return Ok((run, Outcome::default()));
    }
    let robot = scenario.robot(start, pilot)?.within_time(course.time_limit_s());
    let outcome = scenario.run(robot).map_err(|error| error.to_string())?;
    run.is_reached = outcome.reached();
    run.contacts = outcome.touches;
    run.strikes = outcome.strikes;
    run.time_s = outcome.time_s;
    run.distance_m = outcome.distance_m;
    run.turn_rad = outcome.turn_rad;
    run.closest_m = outcome.closest_m.is_finite().then_some(outcome.closest_m);
    run.trace_hash = outcome.trace_hash;
    Ok((run, outcome))
}

fn scenario(setting: &Setting, course: &Course) -> Result<Scenario, String> {
    let steering = match setting.vehicle.steering() {
        Steering::Differential => "",
        Steering::Ackermann => {
            "steering = \"ackermann\"\nmin_turn_radius = 0.5\nback_out = \"always\"\n"
        }
        Steering::Boat => "steering = \"boat\"\nback_out = \"always\"\n",
    };
    let Course { radius_m, max_speed_mps, resolution_m, goal: [x, y], .. } = course;
    // What a user gives; everything else follows.
    let mission = format!(
        "resolution = {resolution_m}\n[goals]\ngoal = [{x}, {y}]\n[vehicle]\nradius = {radius_m}\n\
         max_speed = {max_speed_mps}\n{steering}"
    );
    let unmapped = f64::from(setting.unmapped_percent) / 100.0;
    let difference = Difference { unmapped, ..Difference::default() };
    let scenario = mission::of_map(&course.map, &mission, &difference, course.seed)?;
    let discs = if setting.has_discs { discs(course) } else { Vec::new() };
    Ok(scenario.under(Conditions { discs, ..Conditions::default() }))
}

/// Three discs that cross the way from start to goal at 1 m/s.
fn discs(course: &Course) -> Vec<Disc> {
    let mut random = Random::new(course.seed, Stream::Obstacles);
    let Course { start, goal, .. } = course;
    let along = [goal[0] - start[0], goal[1] - start[1]];
    let length_m = math::scalar::wide::hypot(along[0], along[1]);
    let aside = [-along[1] / length_m, along[0] / length_m];
    let shares = [0.35, 0.55, 0.75];
    let disc = |share: f64| {
        let middle = [0, 1].map(|axis| start[axis] + share * along[axis]);
        let at = |side_m: f64| [0, 1].map(|axis| middle[axis] + side_m * aside[axis]);
        let start_m = random.between(0.0, 4.0);
        let path = vec![at(-2.0), at(2.0)];
        Disc { radius_m: 0.25, path, speed_mps: 1.0, repeat: Repeat::Back, start_m }
    };
    shares.map(disc).into()
}

/// Time of the shortest path on the true map at top speed, seconds.
fn optimal_s(scenario: &Scenario, course: &Course) -> f64 {
    let from = course.start;
    let plan = scenario.plan();
    let layer = scenario.layer_from(from);
    let route = layer.and_then(|layer| route_m(&plan, &layer, from));
    let to = course.goal;
    let straight_m = math::scalar::wide::hypot(to[0] - from[0], to[1] - from[1]);
    route.unwrap_or(straight_m) / course.max_speed_mps
}

/// The courses of some suites: `barn` is the folder of the challenge's worlds, and `count` the
/// courses of each suite whose number is not fixed, as that of doors and corridors is. The error is
/// a message for the user.
pub fn courses(
    suites: &[Suite],
    barn: Option<&Path>,
    count: usize,
    seed: u64,
) -> Result<Vec<Course>, String> {
    let each = suites.iter().map(|suite| suite.courses(barn, count, seed));
    each.collect::<Result<Vec<_>, _>>().map(|courses| courses.concat())
}

/// Whether run `a` is worse than run `b`: a failure before a success, then the slower one.
pub fn is_worse(a: &Run, b: &Run) -> bool {
    let excess = |run: &Run| run.time_s / run.optimal_s.max(1e-3);
    match (a.is_success(), b.is_success()) {
        (false, true) => true,
        (true, false) => false,
        _ => excess(a) > excess(b),
    }
}
