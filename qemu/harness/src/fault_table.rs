//! Every kind of fault of every part of the robot: does it arrive, or stand still with a reason?
//!
//! Each row of the table is one fault. Each of its runs has a fault that lasts from a random time to
//! the end. Runs are independent and seeded, so the table is the same on every machine and with any
//! number of threads.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use maps::formats::ReadOptions;
use maps::problem;
use plan_compiler::trace::Trace;
use robot_io::{CommandRecord, Reason, SensorRecord};
use sim::{
    Channel, Difference, Ending, Fault, HostPilot, Outcome, Pilot, PilotError, Point, Random,
    Recorder, Scenario, SensorSettings, Start, Stream, TICK_US, WorldFile,
};

use crate::mission;
use crate::setup::root;

/// Time of a run that does not arrive even without a fault, seconds.
const UNKNOWN_S: f64 = 120.0;
/// A robot slower than this stands still, m/s and rad/s.
const STILL: f32 = 0.01;
/// A robot that is commanded to stand for this long stands still, seconds.
const STANDS_S: f64 = 30.0;
/// A run may take this many times as long as without a fault.
const PATIENCE: f64 = 3.0;
/// And this much longer, seconds.
const PATIENCE_S: f64 = 60.0;
/// The robot has confirmed its position after this time, seconds: five fixes.
const CONFIRMED_S: f64 = 1.2;
/// The first fix comes before this time, seconds.
const FIRST_FIX_S: f64 = 0.1;
/// Seeds of further starts, for the next draw of a start that is too close to the edge of the map.
const NEXT_START: u64 = 1_000_003;
/// Time from tick to tick, seconds.
const TICK_S: f64 = TICK_US as f64 * 1e-6;

/// What each run adds to its mission: the robot stops below half a charge; it has 0.9.
pub const MISSION: &str = "[battery]\nlow = 0.5\n";

/// The maps of the table, in `tests/maps`, with the receiver of the robots there.
const MAPS: [(&str, SensorSettings); 3] = [
    ("campus.opar", SensorSettings::USUAL),
    ("yard.osm", SensorSettings::SURVEYOR),
    ("tight.ovl", SensorSettings::SURVEYOR),
];

/// One fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What fails.
    pub channel: Channel,
    /// How it fails, as a world file names it.
    pub kind: &'static str,
    /// The same with its value.
    pub fault: Fault,
}

impl Row {
    /// The row without a fault: a loss that never happens.
    pub const WITHOUT: Self =
        Self { channel: Channel::Gps, kind: "none", fault: Fault::Drop { chance: 0.0 } };

    /// Whether the robot can do something about it.
    pub fn is_judged(&self) -> bool {
        self.channel != Channel::Actuators || self.limit().is_none()
    }

    /// The true reasons to stand still with this fault.
    pub fn true_reasons(&self) -> &'static [Reason] {
        use Channel::{Actuators, Battery, Clock, Gps, Heading, Link, Ranges};
        use Reason::{
            ClockStopped, FaultyRanges, FrozenFix, JumpedFix, LinkLost, LowBattery, NoFix,
            NoHeading, NoProgress, PoorFix, SilentRanges, StaleFix, UnreadableReceiver,
            WrongHeading,
        };
        match (self.channel, self.kind) {
            (Gps, "lost" | "intermittent") => &[NoFix, StaleFix],
            (Gps, "frozen") => &[FrozenFix],
            (Gps, "offset") => &[JumpedFix],
            (Gps, "delayed") => &[NoFix, StaleFix],
            (Gps, "garbled") => &[NoFix, StaleFix, PoorFix, UnreadableReceiver],
            (Heading, _) => &[NoHeading, WrongHeading],
            (Ranges, "lost" | "intermittent") => &[SilentRanges],
            (Ranges, _) => &[FaultyRanges],
            (Link, "lost" | "garbled") => &[LinkLost],
            (Battery, _) => &[LowBattery],
            (Clock, "lost" | "frozen" | "garbled") => &[ClockStopped],
            // A clock that runs unevenly makes fixes late.
            (Clock, "intermittent") => &[ClockStopped, StaleFix],
            (Actuators, "lost" | "intermittent") => &[NoProgress],
            _ => &[],
        }
    }

    /// The robot stands within this time of the fault, seconds. It needs longer where the fault does
    /// not show at first: garbled ranges in the open, motors that answer now and then.
    pub fn within_s(&self) -> f64 {
        match (self.channel, self.kind) {
            (Channel::Ranges, "garbled") => 60.0,
            (Channel::Actuators, "intermittent") => 300.0,
            (Channel::Actuators, _) => 15.0,
            (Channel::Clock, "intermittent") => 30.0,
            _ => 5.0,
        }
    }

    /// What no robot with these sensors can know or do.
    pub fn limit(&self) -> Option<&'static str> {
        match (self.channel, self.kind) {
            (Channel::Gps, "offset") => {
                Some("not detectable: an offset from the first fixes on, before any was confirmed")
            }
            (Channel::Gps, "delayed") => Some("not detectable: a delay from the first fix on"),
            (Channel::Ranges, "frozen") => {
                Some("not detectable: an empty scan that is repeated, as on open ground")
            }
            // The brakes count on the vehicle's latency.
            (Channel::Actuators, "delayed") => {
                Some("not judged, not detected: motors that answer later than vehicle.latency says")
            }
            (Channel::Actuators, "frozen" | "offset" | "garbled") => {
                Some("not judged: a body that follows other commands cannot be stopped by them")
            }
            _ => None,
        }
    }
}

/// All rows of the table, by part and kind.
pub fn rows() -> Vec<Row> {
    use Channel::{Actuators, Battery, Clock, Gps, Heading, Link, Odometry, Ranges};
    let channels = [Gps, Heading, Odometry, Ranges, Link, Battery, Clock, Actuators];
    let rows = channels.into_iter().flat_map(|channel| {
        // In the unit of the channel: metres, radians, m/s, a share, seconds.
        let offset = match channel {
            Gps => [30.0, 0.0],
            Heading => [0.7, 0.0],
            // Below the threshold.
            Battery => [-0.5, 0.0],
            Clock => [100.0, 0.0],
            Actuators => [0.3, 0.2],
            _ => [0.5, 0.0],
        };
        // A motor that answers after a second is not the robot that its parameters describe.
        let late = if channel == Actuators { 2 } else { 20 };
        [
            ("lost", Fault::Drop { chance: 1.0 }),
            ("frozen", Fault::Freeze),
            ("offset", Fault::Jump { offset }),
            ("delayed", Fault::Delay { ticks: late }),
            ("garbled", Fault::Garble { chance: 1.0 }),
            ("intermittent", Fault::Drop { chance: 0.5 }),
        ]
        .map(|(kind, fault)| Row { channel, kind, fault })
    });
    // A packet has no offset.
    rows.filter(|row| (row.channel, row.kind) != (Link, "offset")).collect()
}

/// The result of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// The robot arrived.
    pub is_reached: bool,
    /// Why it stands still, and after how many seconds of the fault it came to stand.
    pub stood: Option<(Reason, f64)>,
    /// It left the map.
    pub has_left: bool,
    /// It touched an obstacle; all are mapped.
    pub has_touched: bool,
    /// Whether a scan showed anything since the fault began.
    pub has_seen: bool,
    /// The reason of its last tick.
    pub last: Reason,
    /// How to repeat it.
    pub journey: Case,
}

/// What one run drives: enough to repeat it with a world file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Case {
    /// The map, in `tests/maps`.
    pub map: &'static str,
    /// Seed of the sensors.
    pub seed: u64,
    /// Start, metres.
    pub start: Point,
    /// Heading at the start, radians.
    pub heading_rad: f64,
    /// Time from which the fault lasts, seconds.
    pub from_s: f64,
    /// Time limit, seconds.
    pub limit_s: f64,
}

impl Case {
    /// The text of a world file in which `cargo mission` repeats the run of a row, with its `seed` and
    /// [`MISSION`] in the mission.
    pub fn world(&self, row: &Row) -> String {
        let Self { start: [x, y], heading_rad, from_s, limit_s, .. } = self;
        let sensors = MAPS.iter().find(|(map, _)| *map == self.map).map(|(_, sensors)| sensors);
        let sigma_m = sensors.and_then(|sensors| sensors.gps).map_or(0.0, |gps| gps.sigma_m);
        // A battery that lasts, so that its input can fail.
        let mut world = format!(
            "start = [{x:?}, {y:?}]\nheading = {heading_rad:?}\ntime_limit = {limit_s:?}\n\
             gps_sigma = {sigma_m:?}\n[tanks.battery]\nchannel = 0\nlevel = 0.9\n\
             use_per_m = 0.0001\nfill_per_s = 0.0\nat = [{x:?}, {y:?}]\nwithin = 1\n"
        );
        if *row == Row::WITHOUT {
            return world;
        }
        let value = match row.fault {
            Fault::Drop { chance } if chance < 1.0 => format!("value = {chance:?}\n"),
            // The table has no modes of the receiver.
            Fault::Drop { .. } | Fault::Freeze | Fault::Mode(_) => String::new(),
            Fault::Jump { offset: [first, second] } if row.channel.has_two_numbers() => {
                format!("value = [{first:?}, {second:?}]\n")
            }
            Fault::Jump { offset: [only, _] } => format!("value = {only:?}\n"),
            Fault::Delay { ticks } => {
                format!("value = {:?}\n", (ticks as u64 * TICK_US) as f64 * 1e-6)
            }
            Fault::Garble { chance } => format!("value = {chance:?}\n"),
        };
        world += &format!(
            "[[faults]]\nsensor = \"{}\"\nkind = \"{}\"\nfrom = {from_s:?}\n{value}",
            row.channel.name(),
            row.kind
        );
        world
    }
}

impl Run {
    /// Whether nothing went wrong, for this fault, or the fault cannot be detected.
    pub fn is_sound(&self, row: &Row) -> bool {
        let is_good = self.is_reached || self.stands_truly(row);
        is_good && !self.has_left && !self.has_touched || !self.is_detectable(row)
    }

    /// Whether a robot with these sensors can know of the fault; see [`Row::limit`].
    fn is_detectable(&self, row: &Row) -> bool {
        match (row.channel, row.kind) {
            (Channel::Gps, "offset") => self.journey.from_s >= CONFIRMED_S,
            (Channel::Gps, "delayed") => self.journey.from_s >= FIRST_FIX_S,
            (Channel::Ranges, "frozen") => self.has_seen,
            _ => true,
        }
    }

    /// Whether the robot stands in time for a true reason.
    pub fn stands_truly(&self, row: &Row) -> bool {
        // A link that fails before its second packet has not ordered to arm.
        let is_never_armed = row.channel == Channel::Link && self.journey.from_s < TICK_S;
        let is_true = |reason| {
            row.true_reasons().contains(&reason) || is_never_armed && reason == Reason::Disarmed
        };
        self.stood.is_some_and(|(reason, after_s)| is_true(reason) && after_s <= row.within_s())
    }
}

/// One row with its runs, in the order of maps and seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Filled {
    /// The fault.
    pub row: Row,
    /// Its runs.
    pub runs: Vec<Run>,
}

impl Filled {
    /// Number of runs for which something holds.
    pub fn count(&self, holds: impl Fn(&Run) -> bool) -> usize {
        self.runs.iter().filter(|run| holds(run)).count()
    }

    /// The runs that are not sound.
    pub fn failures(&self) -> impl Iterator<Item = &Run> {
        let is_wanted = |run: &&Run| !run.is_sound(&self.row) && self.row.is_judged();
        self.runs.iter().filter(is_wanted)
    }

    /// How often the robot stood for each reason.
    pub fn reasons(&self) -> BTreeMap<String, usize> {
        let mut reasons = BTreeMap::new();
        for (reason, _) in self.runs.iter().filter_map(|run| run.stood) {
            *reasons.entry(format!("{reason:?}")).or_insert(0) += 1;
        }
        reasons
    }

    /// Longest time from the fault until the robot stood, seconds.
    pub fn latest_stand_s(&self) -> Option<f64> {
        self.runs.iter().filter_map(|run| Some(run.stood?.1)).reduce(f64::max)
    }

    /// Whether all runs are sound, or the row is not judged. Without a fault, all must arrive.
    pub fn is_sound(&self) -> bool {
        let is_without = self.row == Row::WITHOUT;
        let holds = |run: &Run| run.is_sound(&self.row) && (run.is_reached || !is_without);
        !self.row.is_judged() || self.runs.iter().all(holds)
    }
}

/// A start on a map, and what the run from there does without a fault.
struct Journey<'m> {
    map: &'static str,
    scenario: &'m Scenario,
    start: Start,
    /// Time until the goal, seconds.
    usual_s: f64,
    /// The run without a fault.
    without: Option<Run>,
}

/// Runs `seeds` journeys on each map for each row, on all cores. The first row of the result is the
/// same journeys without a fault. `advance` is called once a run.
/// The error is a message for the user.
pub fn fill(
    rows: &[Row],
    first_seed: u64,
    seeds: u64,
    advance: &(dyn Fn() + Sync),
) -> Result<Vec<Filled>, String> {
    let mut scenarios = Vec::new();
    for (name, sensors) in MAPS {
        scenarios.push((name, scenario(name)?, sensors));
    }
    let places: Vec<(usize, u64)> = (0..scenarios.len())
        .flat_map(|map| (0..seeds).map(move |number| (map, first_seed.wrapping_add(number))))
        .collect();
    let journeys = in_parallel(places.len(), |index| {
        let (map, seed) = places[index];
        let (name, scenario, sensors) = &scenarios[map];
        Journey::new(name, scenario, *sensors, seed)
    });
    let journeys = journeys.into_iter().collect::<Result<Vec<_>, String>>()?;
    let runs = in_parallel(rows.len() * journeys.len(), |index| {
        let run = journeys[index % journeys.len()].run(&rows[index / journeys.len()]);
        advance();
        run
    });
    let runs = runs.into_iter().collect::<Result<Vec<_>, String>>()?;
    let without = journeys.iter().filter_map(|journey| journey.without).collect();
    let first = Filled { row: Row::WITHOUT, runs: without };
    let filled = rows.iter().zip(runs.chunks(journeys.len()));
    let filled = filled.map(|(row, runs)| Filled { row: *row, runs: runs.to_vec() });
    Ok([first].into_iter().chain(filled).collect())
}

/// A map with its mission, whose robot stops when its battery is low.
fn scenario(name: &str) -> Result<Scenario, String> {
    let path = root().join("tests/maps").join(name);
    let (map, problems) = maps::formats::read(&path, &ReadOptions::default());
    let map = map.ok_or_else(|| problem::draw(&problems, false))?;
    let mission = fs::read_to_string(path.with_extension("mission.toml"))
        .map_err(|error| format!("the mission of {name}: {error}"))?;
    // `map = ...` is for a mission that is given without its map.
    let lines = mission.lines().filter(|line| !line.starts_with("map = "));
    let mission = lines.collect::<Vec<_>>().join("\n") + "\n" + MISSION;
    mission::of_map(&map, &mission, &Difference::default(), 0)
}

impl<'m> Journey<'m> {
    /// Draws a start, and drives from there without a fault.
    fn new(
        map: &'static str,
        scenario: &'m Scenario,
        sensors: SensorSettings,
        seed: u64,
    ) -> Result<Self, String> {
        let starts = (0_u64..)
            .map(|draw| scenario.draw_start(seed.wrapping_add(draw.wrapping_mul(NEXT_START))));
        let position = starts
            .map_while(|start| start)
            .find(|start| is_on_map(scenario, *start))
            .ok_or(format!("{map}: no start is clear"))?;
        let heading_rad = Random::new(seed, Stream::Obstacles).between(-PI, PI);
        let start = Start { position, heading_rad, seed, sensors };
        let mut journey = Self { map, scenario, start, usual_s: UNKNOWN_S, without: None };
        let case = journey.case(&Row::WITHOUT);
        let (run, outcome) = journey.drive(&Row::WITHOUT, &case)?;
        if run.is_reached {
            journey.usual_s = outcome.time_s;
        }
        journey.without = Some(run);
        Ok(journey)
    }

    /// Drives with a fault from a random time of the journey on.
    fn run(&self, row: &Row) -> Result<Run, String> {
        Ok(self.drive(row, &self.case(row))?.0)
    }

    /// What a run with the fault of a row drives.
    fn case(&self, row: &Row) -> Case {
        let mut random = Random::new(self.start.seed, Stream::Fault);
        let is_without = *row == Row::WITHOUT;
        Case {
            map: self.map,
            seed: self.start.seed,
            start: self.start.position,
            heading_rad: self.start.heading_rad,
            from_s: if is_without { 0.0 } else { random.between(0.0, 0.9) * self.usual_s },
            limit_s: PATIENCE * self.usual_s + PATIENCE_S,
        }
    }

    /// The world of a run, and where it begins: as its world file says.
    fn prepared(&self, row: &Row, case: &Case) -> Result<(Scenario, Start), String> {
        let WorldFile { surroundings, conditions, .. } = case.world(row).parse()?;
        let scenario = Scenario { surroundings: Some(surroundings), ..self.scenario.clone() };
        let scenario = scenario.under(conditions);
        let sensors = scenario.sensors();
        Ok((scenario, Start { sensors, ..self.start }))
    }

    fn drive(&self, row: &Row, case: &Case) -> Result<(Run, Outcome), String> {
        let (scenario, start) = self.prepared(row, case)?;
        self.drive_by(&scenario, &start, case, HostPilot::new(scenario.plan()))
    }

    /// Lets a pilot drive until the robot arrives, stands still or takes too long.
    fn drive_by(
        &self,
        scenario: &Scenario,
        start: &Start,
        case: &Case,
        pilot: impl Pilot,
    ) -> Result<(Run, Outcome), String> {
        let from_s = case.from_s;
        let has_seen = Cell::new(false);
        let pilot = Watched { pilot, from_s, time_s: 0.0, has_seen: &has_seen };
        let robot = scenario.robot(start, pilot)?.to_the_end();
        let plan = scenario.plan();
        let mut simulation = scenario.simulation([robot]);
        let (mut has_left, mut standing) = (false, None);
        loop {
            simulation.step().map_err(|error| error.to_string())?;
            let robot = &simulation.robots()[0];
            let (outcome, commands, body) = (robot.outcome(), robot.commands(), robot.body());
            let at = body.position.map(|x| x as f32);
            has_left |= plan.cell_at(math::Vec2::new(at[0], at[1])).is_none();
            let rates = [commands.speed_mps, commands.turn_rate_radps, body.speed_mps as f32];
            let is_still = rates.iter().all(|rate| rate.abs() < STILL);
            standing = match standing {
                _ if !is_still => None,
                Some(since) => Some(since),
                None => Some(outcome.ticks),
            };
            let stood_s = |since: u64| ((outcome.ticks - since) * TICK_US) as f64 * 1e-6;
            let has_stood = standing.is_some_and(|since| stood_s(since) >= STANDS_S);
            // Before the fault, a robot may wait for its first fix.
            let has_stood = has_stood && outcome.time_s > from_s + STANDS_S;
            if outcome.ending.is_none() && !has_stood {
                continue;
            }
            let is_reached = outcome.ending == Some(Ending::Reached);
            let since = standing.filter(|_| !is_reached && has_stood);
            let after_s = |since: u64| ((since * TICK_US) as f64 * 1e-6 - from_s).max(0.0);
            let run = Run {
                is_reached,
                stood: since.map(|since| (commands.reason, after_s(since))),
                has_left,
                has_touched: outcome.touches > 0,
                has_seen: has_seen.get(),
                last: commands.reason,
                journey: *case,
            };
            return Ok((run, outcome.clone()));
        }
    }
}

/// Whether the body of a robot there is on the map.
fn is_on_map(scenario: &Scenario, [x, y]: Point) -> bool {
    let radius_m = f64::from(scenario.plan().parameters().vehicle.radius_m);
    let corners =
        [-radius_m, radius_m].map(|by_m| math::Vec2::new((x + by_m) as f32, (y + by_m) as f32));
    corners.into_iter().all(|corner| scenario.plan().cell_at(corner).is_some())
}

/// A pilot, and whether a scan showed it anything since a time.
struct Watched<'w, P> {
    pilot: P,
    from_s: f64,
    time_s: f64,
    has_seen: &'w Cell<bool>,
}

impl<P: Pilot> Pilot for Watched<'_, P> {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        let shows = sensors.ranges.as_ref().is_some_and(|ranges| !ranges.is_empty());
        self.has_seen.set(self.has_seen.get() || shows && self.time_s >= self.from_s);
        self.time_s += TICK_US as f64 * 1e-6;
        self.pilot.exchange(sensors)
    }
}

/// The trace of a run, for `plan-compiler explain`. The error is a message for the user.
pub fn record(row: &Row, case: &Case) -> Result<Trace, String> {
    let (map, sensors) = MAPS.into_iter().find(|(map, _)| *map == case.map).ok_or("no such map")?;
    let scenario = scenario(map)?;
    let journey = Journey::new(map, &scenario, sensors, case.seed)?;
    let (scenario, start) = journey.prepared(row, case)?;
    let mut recorder = Recorder::new(HostPilot::new(scenario.plan()));
    let (_, outcome) = journey.drive_by(&scenario, &start, case, &mut recorder)?;
    let percepts = recorder.finish();
    Ok(Trace { blob: scenario.blob.clone(), percepts, hash: outcome.trace_hash })
}

/// The results of `work` for 0 up to `count`, in this order, computed on all cores.
fn in_parallel<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut done: Vec<(usize, T)> = std::thread::scope(|scope| {
        let worker = || {
            let mut mine = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= count {
                    return mine;
                }
                mine.push((index, work(index)));
            }
        };
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a worker ends")).collect()
    });
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Number of runs of a table.
pub fn run_count(rows: &[Row], seeds: u64) -> u64 {
    rows.len() as u64 * MAPS.len() as u64 * seeds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_sound_if_it_arrives_or_stands_with_a_true_reason() {
        let reached = Run {
            is_reached: true,
            stood: None,
            has_left: false,
            has_touched: false,
            has_seen: true,
            last: Reason::Driving,
            journey: Case { from_s: 9.0, ..Case::default() },
        };
        let after = |seconds, reason| {
            let stood = Some((reason, seconds));
            Run { is_reached: false, stood, ..reached }
        };
        let stood = |reason| after(3.0, reason);
        let early = Case { from_s: 0.5, ..Case::default() };
        let first = Case { from_s: 0.05, ..Case::default() };
        let row = |channel, kind| {
            let has = |row: &Row| (row.channel, row.kind) == (channel, kind);
            rows().into_iter().find(has).expect("a row")
        };
        let (lost, offset) = (row(Channel::Gps, "lost"), row(Channel::Gps, "offset"));
        let (delayed, frozen) = (row(Channel::Gps, "delayed"), row(Channel::Ranges, "frozen"));
        for (run, row, is_sound) in [
            (reached, lost, true),
            (stood(Reason::StaleFix), lost, true),
            (after(9.0, Reason::StaleFix), lost, false),
            (stood(Reason::FaultyRanges), lost, false),
            (stood(Reason::AtGoal), lost, false),
            (Run { is_reached: false, ..reached }, lost, false),
            (Run { has_left: true, ..reached }, lost, false),
            (Run { has_touched: true, ..stood(Reason::StaleFix) }, lost, false),
            (stood(Reason::JumpedFix), offset, true),
            (stood(Reason::OffMap), offset, false),
            // What cannot be detected is not judged.
            (Run { journey: early, ..stood(Reason::OffMap) }, offset, true),
            (Run { journey: early, ..stood(Reason::OffMap) }, lost, false),
            (Run { journey: early, ..stood(Reason::OffMap) }, delayed, false),
            (Run { journey: first, ..stood(Reason::OffMap) }, delayed, true),
            (Run { has_touched: true, ..reached }, frozen, false),
            (Run { has_touched: true, has_seen: false, ..reached }, frozen, true),
            (Run { has_touched: true, has_seen: false, ..reached }, lost, false),
            (stood(Reason::StaleFix), row(Channel::Odometry, "offset"), false),
        ] {
            assert_eq!(run.is_sound(&row), is_sound, "{run:?} {row:?}");
        }
    }

    #[test]
    fn every_part_fails_in_every_way() {
        let rows = rows();
        assert_eq!(rows.len(), 8 * 6 - 1);
        let judged = rows.iter().filter(|row| row.is_judged()).count();
        assert_eq!(judged, rows.len() - 4);
    }

    /// The world file of a run has its fault to the last bit, and its receiver.
    #[test]
    fn the_world_file_of_a_run_repeats_it() {
        let (map, sensors) = MAPS[2];
        let case = Case {
            map,
            seed: 7,
            start: [1.0 / 3.0, 2.0],
            heading_rad: -0.1,
            from_s: 10.0 / 3.0,
            limit_s: 90.0,
        };
        for row in rows() {
            let world: WorldFile = case.world(&row).parse().expect("the world is sound");
            let window_s = case.from_s..f64::INFINITY;
            let fault = sim::PlannedFault { channel: row.channel, fault: row.fault, window_s };
            assert_eq!(world.conditions.faults, [fault], "{row:?}");
            let gps = sensors.gps.expect("the robots have a receiver");
            assert_eq!(world.surroundings.gps_sigma, Some(gps.sigma_m));
            assert_eq!((world.surroundings.start, world.surroundings.heading), (case.start, -0.1));
        }
        let scenario = scenario(map).expect("the map is sound");
        let row = rows().into_iter().find(|row| row.kind == "lost").expect("a row");
        let journey = Journey::new(map, &scenario, sensors, 7).expect("a start is clear");
        let run = journey.run(&row).expect("it ends");
        let (_, start) = journey.prepared(&row, &run.journey).expect("the world is sound");
        assert_eq!(format!("{:?}", start.sensors), format!("{sensors:?}"));
    }

    #[test]
    fn seeds_go_on_beyond_the_largest() {
        let table = fill(&[], u64::MAX, 2, &|| ()).expect("the maps are sound");
        let seeds: Vec<u64> = table[0].runs.iter().map(|run| run.journey.seed).collect();
        assert_eq!(seeds[..2], [u64::MAX, 0]);
    }

    #[test]
    fn work_in_parallel_keeps_its_order() {
        assert_eq!(in_parallel(100, |index| index * 2), (0..200).step_by(2).collect::<Vec<_>>());
    }

    /// Two journeys a map: a lost receiver makes every robot stand, and the table repeats.
    #[test]
    fn a_lost_receiver_makes_every_robot_stand() {
        let lost = rows().into_iter().filter(|row| row.kind == "lost");
        let lost: Vec<Row> = lost.filter(|row| row.channel == Channel::Gps).collect();
        let table = fill(&lost, 1, 2, &|| ()).expect("the maps are sound");
        assert_eq!(table.len(), 2);
        assert_eq!(table[1].count(|run| run.stood.is_some() || run.is_reached), 6, "{table:?}");
        assert_eq!(table[1].count(|run| run.has_touched || run.has_left), 0, "{table:?}");
        assert_eq!(table, fill(&lost, 1, 2, &|| ()).expect("the maps are sound"));
    }
}
