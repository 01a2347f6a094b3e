//! One mission: world, body, sensors and pilot tick by tick, and what came of it.

use crate::body::distance;
use crate::{Body, Mode, Pilot, PilotError, Point, Scene, Sensors, Surroundings, World};
use math::scalar::wrap_angle;
use robot_io::{Commands, Reason};

/// Obstacles farther from the body than this do not matter for the closest approach, metres.
const LOOK_M: f64 = 10.0;
/// The route keeps a point for every piece of this length, metres.
const ROUTE_STEP_M: f64 = 0.5;

/// When a mission ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Length of a tick.
    pub tick_us: u64,
    /// Longer missions are given up, seconds.
    pub time_s: f64,
    /// Where the robot shall arrive, metres.
    pub goal: Point,
    /// The robot says that it has arrived, and truly is within this distance, metres.
    pub goal_tolerance_m: f64,
    /// The robot is trapped when it stays this long ...
    pub trapped_after_s: f64,
    /// ... within this distance of one spot, metres.
    pub trapped_within_m: f64,
    /// Whether arriving at the goal ends the mission. Where behaviours decide, a goal is one stop
    /// of several, and work that is to be done ends it instead.
    pub ends_at_goal: bool,
    /// A robot that stands still off the map or without a route for so long will not go on,
    /// seconds.
    pub stranded_after_s: f64,
    /// Behaviours that have worked and then have nothing to do for so long are done where the
    /// world names no work, seconds.
    pub idle_after_s: f64,
}

impl Limits {
    /// Usual limits for a map of a few hundred metres.
    pub fn to_goal(goal: Point) -> Self {
        Self {
            tick_us: 50_000,
            time_s: 900.0,
            goal,
            goal_tolerance_m: 1.5,
            trapped_after_s: 60.0,
            trapped_within_m: 5.0,
            ends_at_goal: true,
            stranded_after_s: 10.0,
            idle_after_s: 60.0,
        }
    }
}

/// How a mission ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ending {
    /// The robot is at the goal and knows it.
    Reached,
    /// All work is done, and the robot has nothing left to do.
    Done,
    /// It stayed at one spot for too long.
    Trapped,
    /// It stands still outside the map.
    OffMap,
    /// It stands still where no layer has a route.
    NoRoute,
    /// It went on for too long.
    OutOfTime,
}

impl Ending {
    /// Its name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Done => "done",
            Self::Trapped => "trapped",
            Self::OffMap => "off-map",
            Self::NoRoute => "no-route",
            Self::OutOfTime => "out-of-time",
        }
    }
}

/// What came of a mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// How it ended; `None` while it is under way.
    pub ending: Option<Ending>,
    /// Ticks so far.
    pub ticks: u64,
    /// Simulated time so far, seconds.
    pub time_s: f64,
    /// Length of the way, metres.
    pub distance_m: f64,
    /// How far it has turned in all, either way, radians.
    pub turn_rad: f64,
    /// Smallest gap between body and obstacle, metres; infinite if none came near.
    pub closest_m: f64,
    /// How often contact with an obstacle began.
    pub touches: u32,
    /// Where the robot was, a point for every half metre.
    pub route: Vec<Point>,
    /// How many ticks gave which reason, in the order of their first appearance.
    pub reasons: Vec<(Reason, u64)>,
    /// The trace hash after the last tick.
    pub trace_hash: u64,
    /// The most instructions that one tick took, where that can be counted.
    pub most_instructions: u32,
    /// What the robot's work has made of its surroundings, where there are any.
    pub surroundings: Option<Surroundings>,
}

impl Outcome {
    /// Whether the robot has arrived, or has done its work.
    pub fn reached(&self) -> bool {
        matches!(self.ending, Some(Ending::Reached | Ending::Done))
    }

    /// Number of ticks that gave a reason.
    pub fn ticks_of(&self, reason: Reason) -> u64 {
        self.reasons.iter().find(|(seen, _)| *seen == reason).map_or(0, |&(_, ticks)| ticks)
    }
}

/// A mission under way.
#[derive(Debug)]
pub struct Run<'w, S, P> {
    world: &'w World,
    sensors: S,
    pilot: P,
    limits: Limits,
    body: Body,
    outcome: Outcome,
    touching: bool,
    /// The spot that the robot may be trapped at, and since when.
    spot: (Point, u64),
    /// Why the robot stands still, and since when; `None` while it moves.
    standing: Option<(Reason, u64)>,
    /// Whether it has had anything to do.
    has_worked: bool,
}

impl<'w, S: Sensors, P: Pilot> Run<'w, S, P> {
    /// A mission before its first tick.
    pub fn new(world: &'w World, body: Body, sensors: S, pilot: P, limits: Limits) -> Self {
        let route = vec![body.position];
        let outcome = Outcome { closest_m: f64::INFINITY, route, ..Outcome::default() };
        let spot = (body.position, 0);
        Self {
            world,
            sensors,
            pilot,
            limits,
            body,
            outcome,
            touching: false,
            spot,
            standing: None,
            has_worked: false,
        }
    }

    /// The same with surroundings that change; the mission then ends when the work in them is done.
    pub fn within(mut self, surroundings: Surroundings) -> Self {
        self.limits.time_s = surroundings.time_limit;
        self.outcome.surroundings = Some(surroundings);
        self
    }

    /// One tick: look, think, move. Returns what the pilot said. After the end it may go on;
    /// the ending stays.
    pub fn step(&mut self) -> Result<Commands, PilotError> {
        let time_us = self.outcome.ticks * self.limits.tick_us;
        let mut record = self.sensors.sense(&Scene {
            world: self.world,
            body: self.body,
            antenna: self.body.position,
            mode: Mode::Autonomous,
            time_us,
            tick_us: self.limits.tick_us,
        });
        if let Some(surroundings) = &self.outcome.surroundings {
            record.inputs = surroundings.inputs();
        }
        let answer = self.pilot.exchange(&record)?;
        let seconds = self.limits.tick_us as f64 * 1e-6;
        let heading_before_rad = self.body.heading_rad;
        let motion = self.body.step(&answer.commands, self.world, seconds);
        let turned_rad = self.body.heading_rad - heading_before_rad;

        let outcome = &mut self.outcome;
        outcome.ticks += 1;
        outcome.time_s = (outcome.ticks * self.limits.tick_us) as f64 * 1e-6;
        outcome.distance_m += motion.distance_m;
        outcome.turn_rad += f64::from(wrap_angle(turned_rad as f32)).abs();
        if let Some(surroundings) = &mut outcome.surroundings {
            surroundings.step(self.body.position, motion.distance_m, &answer.commands, seconds);
        }
        outcome.touches += u32::from(motion.touched && !self.touching);
        outcome.trace_hash = answer.trace_hash;
        outcome.most_instructions = outcome.most_instructions.max(answer.instructions);
        self.touching = motion.touched;
        if let Some(nearest) = self.world.nearest(self.body.position, LOOK_M) {
            let gap = nearest.distance_m - self.body.chassis.radius_m;
            outcome.closest_m = outcome.closest_m.min(gap);
        }
        self.note(answer.commands.reason);
        self.judge(&answer.commands);
        Ok(answer.commands)
    }

    /// Runs to the end.
    pub fn finish(mut self) -> Result<Outcome, PilotError> {
        while self.outcome.ending.is_none() {
            self.step()?;
        }
        self.outcome.route.push(self.body.position);
        Ok(self.outcome)
    }

    /// The body as it truly is.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// What has come of it so far.
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    fn note(&mut self, reason: Reason) {
        match self.outcome.reasons.iter_mut().find(|(seen, _)| *seen == reason) {
            Some((_, ticks)) => *ticks += 1,
            None => self.outcome.reasons.push((reason, 1)),
        }
        let is_far = |&last: &Point| distance(last, self.body.position) >= ROUTE_STEP_M;
        if self.outcome.route.last().is_none_or(is_far) {
            self.outcome.route.push(self.body.position);
        }
    }

    fn judge(&mut self, commands: &Commands) {
        let reason = commands.reason;
        let limits = &self.limits;
        let now = self.outcome.ticks;
        let seconds_since = |tick: u64| ((now - tick) * limits.tick_us) as f64 * 1e-6;
        // A robot that waits on purpose is not trapped.
        let waits = matches!(reason, Reason::Holding | Reason::Idle);
        if waits || distance(self.spot.0, self.body.position) > limits.trapped_within_m {
            self.spot = (self.body.position, now);
        }
        self.standing = match self.standing {
            _ if commands.speed_mps != 0.0 || commands.turn_rate_radps != 0.0 => None,
            Some((before, since)) if before == reason => Some((before, since)),
            _ => Some((reason, now)),
        };
        self.has_worked |= matches!(reason, Reason::Driving | Reason::Holding);
        let stood_s = |why: Reason| match self.standing {
            Some((reason, since)) if reason == why => seconds_since(since),
            _ => 0.0,
        };
        let is_there = distance(self.body.position, limits.goal) <= limits.goal_tolerance_m;
        let work = self.outcome.surroundings.as_ref().filter(|world| world.has_work());
        let is_done = match work {
            Some(work) => work.is_done(reason),
            None => self.has_worked && stood_s(Reason::Idle) >= limits.idle_after_s,
        };
        let arrives = limits.ends_at_goal && work.is_none();
        let ending = if is_done {
            Some(Ending::Done)
        } else if arrives && reason == Reason::AtGoal && is_there {
            Some(Ending::Reached)
        } else if stood_s(Reason::OffMap) >= limits.stranded_after_s {
            Some(Ending::OffMap)
        } else if stood_s(Reason::NoRoute) >= limits.stranded_after_s {
            Some(Ending::NoRoute)
        } else if seconds_since(self.spot.1) >= limits.trapped_after_s {
            Some(Ending::Trapped)
        } else if self.outcome.time_s >= limits.time_s {
            Some(Ending::OutOfTime)
        } else {
            None
        };
        self.outcome.ending = self.outcome.ending.or(ending);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Chassis, SensorSettings, SensorSuite};
    use math::GeoPoint;
    use plan_compiler::map::{Reference, Shape};
    use robot_io::{CommandRecord, Receiver, SensorRecord};

    /// Drives straight ahead and says that it is at the goal after so many ticks.
    struct Straight(u64);

    impl Pilot for Straight {
        fn exchange(&mut self, _: &SensorRecord) -> Result<CommandRecord, PilotError> {
            self.0 = self.0.saturating_sub(1);
            let reason = if self.0 == 0 { Reason::AtGoal } else { Reason::Driving };
            let commands = Commands { speed_mps: 1.0, ..Commands::stop(reason) };
            let receiver = Receiver::Sound;
            Ok(CommandRecord {
                time_us: 0,
                commands,
                trace_hash: self.0,
                instructions: 0,
                receiver,
            })
        }
    }

    fn straight(ticks: u64, goal: Point) -> Outcome {
        let wall = Shape::Polyline(vec![[20.0, -5.0], [20.0, 5.0]]);
        let world = World::new([&wall]);
        let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
        let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
        let sensors = SensorSuite::new(SensorSettings::USUAL, &reference, 1);
        let body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
        let run = Run::new(&world, body, sensors, Straight(ticks), Limits::to_goal(goal));
        run.finish().expect("this pilot always answers")
    }

    #[test]
    fn a_mission_is_reached_only_at_the_goal() {
        let there = straight(200, [9.0, 0.0]);
        assert!(there.reached() && there.touches == 0, "{there:?}");
        // Ten seconds at 1 m/s, a third of a metre lost while speeding up.
        assert!((there.distance_m - 9.67).abs() < 0.05, "{there:?}");
        assert_eq!(there.closest_m, f64::INFINITY, "the wall is beyond the look");
        assert_eq!(there.reasons, [(Reason::Driving, 199), (Reason::AtGoal, 1)]);
    }

    /// Stands still and gives these reasons, each for so many ticks, the last one for ever.
    struct Still(Vec<(u64, Reason)>);

    impl Pilot for Still {
        fn exchange(&mut self, _: &SensorRecord) -> Result<CommandRecord, PilotError> {
            let left = &mut self.0;
            if left.len() > 1 && left[0].0 == 0 {
                left.remove(0);
            }
            left[0].0 = left[0].0.saturating_sub(1);
            let commands = Commands::stop(left[0].1);
            let receiver = robot_io::Receiver::Sound;
            Ok(CommandRecord { time_us: 0, commands, trace_hash: 0, instructions: 0, receiver })
        }
    }

    #[test]
    fn a_robot_that_stands_still_ends_for_its_reason() {
        use Reason::{Driving, Holding, Idle, NoFix, NoRoute, OffMap};
        for (reasons, work, expected) in [
            (&[(1, NoFix), (1, OffMap)][..], "", (Ending::OffMap, 10)),
            (&[(100, NoFix), (1, NoRoute)], "", (Ending::NoRoute, 15)),
            // For a moment only.
            (&[(190, OffMap), (1, NoFix)], "", (Ending::Trapped, 60)),
            // A hold of 100 s is not trapped; what follows may be.
            (&[(2_000, Holding), (1, NoFix)], "", (Ending::Trapped, 160)),
            // Nothing to do between two things is not done, and nothing at all neither.
            (&[(20, Driving), (1, Idle), (600, Holding), (1, Idle)], "", (Ending::Done, 91)),
            (&[(1, Idle)], "", (Ending::OutOfTime, 200)),
            (&[(20, Driving), (1, Idle)], "signal = 7\n", (Ending::OutOfTime, 200)),
        ] {
            let world = World::new([]);
            let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
            let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
            let sensors = SensorSuite::new(SensorSettings::PERFECT, &reference, 1);
            let body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
            let limits = Limits { ends_at_goal: false, ..Limits::to_goal([0.0, 0.0]) };
            let run = Run::new(&world, body, sensors, Still(reasons.to_vec()), limits);
            let text = format!("start = [0, 0]\ntime_limit = 200\n{work}");
            let run = run.within(text.parse().expect("it is sound"));
            let outcome = run.finish().expect("this pilot always answers");
            let (ending, seconds) = expected;
            assert_eq!(outcome.ending, Some(ending), "{reasons:?}");
            assert!((outcome.time_s - f64::from(seconds)).abs() <= 0.5, "{reasons:?} {outcome:?}");
        }
    }

    #[test]
    fn a_goal_with_a_world_that_names_no_work_is_reached() {
        for (text, expected) in [
            ("start = [0, 0]\n", Ending::Reached),
            ("start = [0, 0]\nsignal = 7\ntime_limit = 30\n", Ending::OutOfTime),
        ] {
            let world = World::new([]);
            let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
            let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
            let sensors = SensorSuite::new(SensorSettings::PERFECT, &reference, 1);
            let body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
            let limits = Limits::to_goal([9.0, 0.0]);
            let run = Run::new(&world, body, sensors, Straight(200), limits);
            let outcome = run.within(text.parse().expect("it is sound")).finish();
            let outcome = outcome.expect("this pilot always answers");
            assert_eq!(outcome.ending, Some(expected), "{text}");
        }
    }

    #[test]
    fn a_robot_that_pushes_a_wall_touches_it_once_and_is_trapped() {
        let stuck = straight(1_000_000, [30.0, 0.0]);
        assert_eq!(stuck.ending, Some(Ending::Trapped));
        assert_eq!(stuck.touches, 1);
        assert!(stuck.closest_m.abs() < 1e-6 && stuck.time_s < 100.0, "{stuck:?}");
    }
}
