//! Missions of a robot with a receiver but neither compass nor odometry, and with unequal wheels.
//! Its heading is the course of the fixes, so without the velocity of the fixes it is lost.

use super::faults::{Moment, watch, within};
use super::*;
use harness::mission::{self, Changes};
use robot_io::{Reason, Receiver};
use sim::{Channel, Dialect, Ending, Fault, Faulty, Mode, Pilot, PilotError, Scenario};
use std::path::Path;

/// Time when the receiver changes to another mode, seconds.
const TURNS_S: f64 = 20.0;

/// A scenario, the robot's start and its sensors.
struct Field {
    scenario: Scenario,
    start: Point,
    /// Errors of the receiver and the ranges.
    sensors: SensorSettings,
}

impl Field {
    /// The campus, from the south of the street to the north gate.
    fn campus() -> Self {
        Self::read(&it::own_map("campus.opar"), [70.5, 15.5], SensorSettings::USUAL)
    }

    /// The field on which a user's robot once got lost; `None` if its files are missing.
    fn of_a_user() -> Option<Self> {
        let path = it::real_data("field/drive")?.join("field.mission.toml");
        Some(Self::read(&path, [-60.0, -20.0], SensorSettings::PERFECT))
    }

    fn read(path: &Path, start: Point, sensors: SensorSettings) -> Self {
        let scenario = mission::scenario(path, &Changes::default());
        Self { scenario: scenario.unwrap_or_else(|error| panic!("{error}")), start, sensors }
    }

    /// Runs with a receiver that changes to `mode`, if given. Also returns the states of the
    /// receiver that the robot reports, each change once.
    fn run(&self, dialect: Dialect, mode: Option<Mode>) -> (Vec<Moment>, Outcome, Vec<Receiver>) {
        let plan = self.scenario.plan();
        let gps = self.sensors.gps.expect("it has a receiver");
        let gps = ReceiverSettings { dialect, ..gps };
        let sensors = SensorSettings {
            gps: Some(gps),
            compass_sigma_rad: None,
            odometry_sigma: None,
            ..self.sensors
        };
        let reference = self.scenario.map.reference.expect("the map lies on the globe");
        let suite = SensorSuite::new(sensors, &reference, 1);
        let turned = Fault::Mode(mode.unwrap_or(Mode::Autonomous));
        let sensors = Faulty::new(suite, turned, Channel::Gps, TURNS_S..1e6, 1);
        let chassis = Chassis { drift_radps: 0.03, ..chassis(&plan) };
        let body = Body::new(chassis, self.start, 0.0);
        let mut listening = Listening { robot: HostPilot::new(plan), reported: Vec::new() };
        let limits = limits(&plan, gps.sigma_m);
        let robot = Robot::new(body, sensors, &mut listening, limits);
        let (moments, outcome) = watch(&self.scenario.truth, robot, f64::INFINITY);
        (moments, outcome, listening.reported)
    }
}

/// A robot, and the states of the receiver that its telemetry reports, each change once.
struct Listening<'p> {
    robot: HostPilot<'p>,
    reported: Vec<Receiver>,
}

impl Pilot for Listening<'_> {
    fn exchange(
        &mut self,
        sensors: &robot_io::SensorRecord,
    ) -> Result<robot_io::CommandRecord, PilotError> {
        let record = self.robot.exchange(sensors)?;
        // Before the first byte, the receiver is silent.
        let last = self.reported.last().copied().unwrap_or_default();
        if last != record.receiver {
            self.reported.push(record.receiver);
        }
        Ok(record)
    }
}

/// Checks that the robot arrives within `within_s` seconds and touches nothing.
fn check_arrives(field: &Field, dialect: Dialect, mode: Option<Mode>, within_s: f64) {
    let (_, outcome, reported) = field.run(dialect, mode);
    let what = format!("{dialect:?} {mode:?}: {:?} {}", outcome.ending, outcome.time_s);
    assert!(outcome.reached() && outcome.touches == 0, "{what}");
    assert!(outcome.time_s < within_s, "{what}");
    assert_eq!(reported, [Receiver::Sound], "{what}");
}

/// Checks that the robot drives until the last valid fix is stale, and then stands still to the end
/// with the right reason.
fn check_stands(field: &Field, dialect: Dialect, mode: Mode) {
    let (moments, outcome, reported) = field.run(dialect, Some(mode));
    assert_eq!(outcome.ending, Some(Ending::Trapped), "{dialect:?} {mode:?}");
    assert!(within(&moments, TURNS_S..TURNS_S + 1.5).all(|m| m.reason == Reason::Driving));
    // 2.5 s for the stale time, the delay of the receiver and braking.
    for moment in within(&moments, TURNS_S + 2.5..f64::INFINITY) {
        let expected = (Reason::PoorFix, 0.0);
        assert_eq!((moment.reason, moment.speed_mps), expected, "{dialect:?} {mode:?} {moment:?}");
    }
    assert_eq!(reported, [Receiver::Sound, Receiver::NoFix]);
}

/// Checks all dialects and modes. The robot arrives within `within_s`, or stops where it must; a
/// robot that lost its course would do neither.
fn check_field(field: &Field, within_s: f64) {
    for dialect in [Dialect::Nmea, Dialect::Ubx] {
        check_arrives(field, dialect, None, within_s);
        check_arrives(field, dialect, Some(Mode::Fixed), within_s);
        for mode in [Mode::Void, Mode::NoFix] {
            check_stands(field, dialect, mode);
        }
    }
}

#[test]
fn without_a_compass_the_course_survives_corrections_and_stops_where_it_is_void() {
    check_field(&Field::campus(), 300.0);
}

#[test]
fn the_field_of_a_user_is_crossed_in_two_minutes() {
    let Some(field) = Field::of_a_user() else { return };
    check_field(&field, 130.0);
}
