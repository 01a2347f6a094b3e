//! A robot in a simulation: body, sensors, pilot and the outcome of its run so far.
//!
//! Sense, exchange and move are separate functions, so that all robots finish one phase of a tick
//! before any begins the next.

use crate::geometry::{Circle, distance};
use crate::{
    Actuators, Body, Ending, Limits, Mode, Outcome, Pilot, PilotError, Point, Scene, Sensors,
    StepResult, Surroundings, TICK_US, World,
};
use math::scalar::wrap_angle;
use robot_io::{CommandRecord, Commands, Reason, SensorRecord};

/// Distance between two points of the recorded route, metres.
const ROUTE_STEP_M: f64 = 0.5;
/// A strike this many ticks after the last one, or sooner, is the same: what pushes from behind waits and
/// comes again.
const STRIKE_TICKS: u64 = 20;
/// Length of a tick, seconds.
const TICK_S: f64 = TICK_US as f64 * 1e-6;

/// A robot during its run.
#[derive(Debug)]
pub struct Robot<S, P> {
    sensors: S,
    pilot: P,
    limits: Limits,
    /// The goals of a plan with several, by their numbers.
    goals: Vec<Point>,
    body: Body,
    actuators: Vec<Actuators>,
    commands: Commands,
    outcome: Outcome,
    is_touching: bool,
    /// The tick in which the robot was struck last.
    struck_at: Option<u64>,
    /// The point that the robot has stayed near, and the tick since when.
    spot: (Point, u64),
    /// Why the robot stands still, and the tick since when; `None` while it moves.
    standing: Option<(Reason, u64)>,
    /// Whether the robot has driven or held since the start.
    has_worked: bool,
}

impl<S: Sensors, P: Pilot> Robot<S, P> {
    /// A robot before its first tick.
    pub fn new(body: Body, sensors: S, pilot: P, limits: Limits) -> Self {
        let route = vec![body.position];
        Self {
            sensors,
            pilot,
            limits,
            goals: Vec::new(),
            body,
            actuators: Vec::new(),
            commands: Commands::stop(Reason::Idle),
            outcome: Outcome { closest_m: f64::INFINITY, route, ..Outcome::default() },
            is_touching: false,
            struck_at: None,
            spot: (body.position, 0),
            standing: None,
            has_worked: false,
        }
    }

    /// Lets a robot that is trapped or stranded go on until its time is over.
    pub fn to_the_end(mut self) -> Self {
        self.limits.trapped_after_s = f64::INFINITY;
        self.limits.stranded_after_s = f64::INFINITY;
        self
    }

    /// Gives the robot several goals, by their numbers: it arrives at the one that it reports.
    pub fn with_goals(mut self, goals: impl IntoIterator<Item = Point>) -> Self {
        self.goals.extend(goals);
        self
    }

    /// Lets the actuators fail.
    pub fn with_actuators(mut self, faults: impl IntoIterator<Item = Actuators>) -> Self {
        self.actuators.extend(faults);
        self
    }

    /// Ends the run after this time, seconds.
    pub fn within_time(mut self, time_s: f64) -> Self {
        self.limits.time_s = time_s;
        self
    }

    /// Adds surroundings that the robot's work changes. The run ends when that work is done.
    pub fn within(mut self, surroundings: Surroundings) -> Self {
        self.limits.time_s = surroundings.time_limit;
        self.outcome.surroundings = Some(surroundings);
        self
    }

    /// The true state of the body.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The pilot's commands of the last tick; before the first tick, a stop.
    pub fn commands(&self) -> &Commands {
        &self.commands
    }

    /// The outcome of the run so far; it no longer changes once the run has ended.
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    /// What the sensors report in the tick that ends at `time_us`.
    pub(crate) fn sense(&mut self, truth: &World, others: &[Circle], time_us: u64) -> SensorRecord {
        let inputs =
            self.outcome.surroundings.as_ref().map(Surroundings::inputs).unwrap_or_default();
        self.sensors.sense(&Scene {
            world: truth,
            others,
            body: self.body,
            antenna: self.body.position,
            mode: Mode::Autonomous,
            inputs,
            time_us,
            tick_us: TICK_US,
        })
    }

    /// The pilot's answer to a sensor record.
    pub(crate) fn exchange(&mut self, record: &SensorRecord) -> Result<CommandRecord, PilotError> {
        self.pilot.exchange(record)
    }

    /// The commands that the body follows: the pilot's, unless an actuator fails.
    pub(crate) fn driven(&mut self, commands: &Commands) -> Commands {
        let (chassis, time_us) = (self.body.chassis, self.outcome.ticks * TICK_US);
        let faults = self.actuators.iter_mut();
        faults.fold(*commands, |driven, fault| fault.obey(driven, &chassis, time_us))
    }

    /// Takes over the body's new state at the end of a tick, and updates the outcome.
    pub(crate) fn arrive(&mut self, answer: &CommandRecord, (body, result): (Body, StepResult)) {
        let turned_rad = body.heading_rad - self.body.heading_rad;
        self.body = body;
        self.commands = answer.commands;
        let outcome = &mut self.outcome;
        if outcome.ending.is_some() {
            return;
        }
        outcome.ticks += 1;
        outcome.time_s = (outcome.ticks * TICK_US) as f64 * 1e-6;
        outcome.distance_m += result.distance_m;
        outcome.turn_rad += f64::from(wrap_angle(turned_rad as f32)).abs();
        if let Some(surroundings) = &mut outcome.surroundings {
            surroundings.step(body.position, result.distance_m, &answer.commands, TICK_S);
        }
        outcome.touches += u32::from(result.touched && !self.is_touching);
        outcome.trace_hash = answer.trace_hash;
        outcome.goal = answer.goal;
        outcome.most_instructions = outcome.most_instructions.max(answer.instructions);
        if result.struck {
            let is_new = self.struck_at.is_none_or(|at| outcome.ticks - at > STRIKE_TICKS);
            outcome.strikes += u32::from(is_new);
            self.struck_at = Some(outcome.ticks);
        }
        self.is_touching = result.touched;
        outcome.closest_m = outcome.closest_m.min(result.closest_m);
        self.note(answer.commands.reason);
        self.judge(&answer.commands);
        if self.outcome.ending.is_some() {
            self.outcome.route.push(body.position);
        }
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
        let seconds_since = |tick: u64| ((now - tick) * TICK_US) as f64 * 1e-6;
        // A robot that holds or has nothing to do is not trapped.
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
        let reported = self.outcome.goal.and_then(|number| self.goals.get(usize::from(number)));
        let goal = reported.copied().unwrap_or(limits.goal);
        let is_there = distance(self.body.position, goal) <= limits.goal_tolerance_m;
        let work = self.outcome.surroundings.as_ref().filter(|world| world.has_work());
        let is_done = match work {
            // Without behaviours, a robot at its goal has nothing left to do.
            Some(work) if limits.ends_at_goal && reason == Reason::AtGoal => {
                work.is_done(Reason::Idle)
            }
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
        self.outcome.ending = ending;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Chassis, SensorSettings, SensorSuite};
    use maps::{Reference, Shape};
    use math::GeoPoint;
    use robot_io::{CommandRecord, Receiver, SensorRecord};

    /// Drives straight ahead and reports that it is at the goal after a number of ticks.
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
                checks: robot_io::Checks::default(),
                news: None,
                goal: None,
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
        let robot = Robot::new(body, sensors, Straight(ticks), Limits::to_goal(goal));
        robot.run(&world).expect("this pilot always answers")
    }

    #[test]
    fn a_goal_is_reached_only_where_it_is() {
        let there = straight(200, [9.0, 0.0]);
        assert!(there.reached() && there.touches == 0, "{there:?}");
        // Ten seconds at 1 m/s, a third of a metre lost while speeding up.
        assert!((there.distance_m - 9.67).abs() < 0.05, "{there:?}");
        assert_eq!(there.closest_m, f64::INFINITY, "the wall is farther than LOOK_M");
        assert_eq!(there.reasons, [(Reason::Driving, 199), (Reason::AtGoal, 1)]);
    }

    /// Stands still and reports each reason for its number of ticks, the last one to the end.
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
            let checks = robot_io::Checks::default();
            Ok(CommandRecord {
                time_us: 0,
                commands,
                trace_hash: 0,
                instructions: 0,
                receiver,
                checks,
                news: None,
                goal: None,
            })
        }
    }

    #[test]
    fn a_robot_that_stands_still_ends_for_its_reason() {
        use Reason::{Driving, Holding, Idle, NoFix, NoRoute, OffMap};
        for (reasons, work, expected) in [
            (&[(1, NoFix), (1, OffMap)][..], "", (Ending::OffMap, 10)),
            (&[(100, NoFix), (1, NoRoute)], "", (Ending::NoRoute, 15)),
            // Less than 10 s off the map.
            (&[(190, OffMap), (1, NoFix)], "", (Ending::Trapped, 60)),
            // A robot that holds for 100 s is not trapped; after the hold it may be.
            (&[(2_000, Holding), (1, NoFix)], "", (Ending::Trapped, 160)),
            // A robot is done if it worked and then stayed idle, not if it is idle in between or
            // never worked.
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
            let robot = Robot::new(body, sensors, Still(reasons.to_vec()), limits);
            let text = format!("start = [0, 0]\ntime_limit = 200\n{work}");
            let robot = robot.within(text.parse().expect("it is sound"));
            let outcome = robot.run(&world).expect("this pilot always answers");
            let (ending, seconds) = expected;
            assert_eq!(outcome.ending, Some(ending), "{reasons:?}");
            assert!((outcome.time_s - f64::from(seconds)).abs() <= 0.5, "{reasons:?} {outcome:?}");
        }
    }

    /// A robot without behaviours stands at its goal when its fields are done.
    #[test]
    fn fields_are_done_at_the_goal_without_behaviours() {
        let text = "start = [0, 0]\n[fields.lane]\nchannel = 3\nwithin = 1\n\
            strips = [[[1, 0], [7, 0]]]\n";
        for (ticks, expected) in [(200, Ending::Done), (2_000, Ending::Trapped)] {
            let world = World::new([]);
            let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
            let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
            let sensors = SensorSuite::new(SensorSettings::PERFECT, &reference, 1);
            let body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
            let limits = Limits { trapped_within_m: 900.0, ..Limits::to_goal([9.0, 0.0]) };
            let robot = Robot::new(body, sensors, Straight(ticks), limits);
            let robot = robot.within(text.parse().expect("it is sound"));
            let outcome = robot.run(&world).expect("this pilot always answers");
            assert_eq!(outcome.ending, Some(expected), "{ticks}: {outcome:?}");
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
            let robot = Robot::new(body, sensors, Straight(200), limits);
            let robot = robot.within(text.parse().expect("it is sound"));
            let outcome = robot.run(&world).expect("this pilot always answers");
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
