//! Missions of a robot that has nothing but a receiver: no compass, no odometry, and wheels
//! that are not equal. Its heading is the course of the fixes, so where the velocity is lost
//! the robot is too.

use super::faults::{Moment, watch, within};
use super::*;
use harness::mission::{self, Changes};
use robot_io::{Reason, Receiver};
use sim::{Channel, Dialect, Ending, Fault, Faulty, Mode, Pilot, PilotError, Scenario};
use std::path::Path;

/// When the receiver turns to another mode, seconds.
const TURNS_S: f64 = 20.0;

/// A map, its plans and where the robot starts.
struct Field {
    scenario: Scenario,
    start: Point,
    /// How good receiver and ranges are.
    sensors: SensorSettings,
}

impl Field {
    /// The campus, from the south of the street to the north gate.
    fn campus() -> Self {
        Self::read(&it::own_map("campus.opar"), [70.5, 15.5], SensorSettings::USUAL)
    }

    /// The field on which this went wrong once, where it lies beside the project.
    fn from_outside() -> Option<Self> {
        let path = it::real_data("field/drive")?.join("field.mission.toml");
        Some(Self::read(&path, [-60.0, -20.0], SensorSettings::PERFECT))
    }

    fn read(path: &Path, start: Point, sensors: SensorSettings) -> Self {
        let scenario = mission::scenario(path, &Changes::default());
        Self { scenario: scenario.unwrap_or_else(|error| panic!("{error}")), start, sensors }
    }

    /// Runs with a receiver that turns to `mode`, if to any; also what the robot says of the
    /// receiver, each change once.
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
        let mut listening = Listening { robot: HostPilot::new(plan), said: Vec::new() };
        let limits = limits(&plan, gps.sigma_m);
        let robot = Robot::new(body, sensors, &mut listening, limits);
        let (moments, outcome) = watch(&self.scenario.truth, robot, f64::INFINITY);
        (moments, outcome, listening.said)
    }
}

/// A robot, and what its telemetry says of its receiver, each change once.
struct Listening<'p> {
    robot: HostPilot<'p>,
    said: Vec<Receiver>,
}

impl Pilot for Listening<'_> {
    fn exchange(
        &mut self,
        sensors: &robot_io::SensorRecord,
    ) -> Result<robot_io::CommandRecord, PilotError> {
        let record = self.robot.exchange(sensors)?;
        // Before the first byte it is silent, of course.
        let last = self.said.last().copied().unwrap_or_default();
        if last != record.receiver {
            self.said.push(record.receiver);
        }
        Ok(record)
    }
}

/// Arrives within so many seconds, and touches nothing.
fn check_arrives(field: &Field, dialect: Dialect, mode: Option<Mode>, within_s: f64) {
    let (_, outcome, said) = field.run(dialect, mode);
    let what = format!("{dialect:?} {mode:?}: {:?} {}", outcome.ending, outcome.time_s);
    assert!(outcome.reached() && outcome.touches == 0, "{what}");
    assert!(outcome.time_s < within_s, "{what}");
    assert_eq!(said, [Receiver::Sound], "{what}");
}

/// Goes on until the last valid fix is stale, then stands still for the true reason to the end.
fn check_stands(field: &Field, dialect: Dialect, mode: Mode) {
    let (moments, outcome, said) = field.run(dialect, Some(mode));
    assert_eq!(outcome.ending, Some(Ending::Trapped), "{dialect:?} {mode:?}");
    assert!(within(&moments, TURNS_S..TURNS_S + 1.5).all(|m| m.reason == Reason::Driving));
    // The stale time, the delay of the receiver and the way to stop.
    for moment in within(&moments, TURNS_S + 2.5..f64::INFINITY) {
        let expected = (Reason::PoorFix, 0.0);
        assert_eq!((moment.reason, moment.speed_mps), expected, "{dialect:?} {mode:?} {moment:?}");
    }
    assert_eq!(said, [Receiver::Sound, Receiver::NoFix]);
}

/// The mission as it should be takes this long; one that loses its course never ends.
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
fn the_field_from_outside_is_crossed_in_two_minutes() {
    let Some(field) = Field::from_outside() else { return };
    check_field(&field, 130.0);
}
