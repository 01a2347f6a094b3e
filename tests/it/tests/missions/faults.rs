//! Missions with faults: the robot stops or drives on for the right reason, and touches nothing.

use super::*;
use robot_io::Reason;
use runtime::{Fallback, load};
use sim::{Channel, Dialect, Fault, Faulty, Pilot, Sensors, Simulation};
use std::ops::Range;

/// South of the street, with nothing nearby.
const START: Point = [70.5, 15.5];
/// Time window of the sensor faults, seconds: on the route, past the first kiosk.
const FAILURE_S: Range<f64> = 20.0..30.0;

/// The robot's state in one tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) time_s: f64,
    pub(super) reason: Reason,
    pub(super) speed_mps: f32,
    pub(super) at: Point,
}

/// Runs a robot alone in a world to the end or until `until_s` seconds.
pub(super) fn watch<S: Sensors, P: Pilot>(
    world: &World,
    robot: Robot<S, P>,
    until_s: f64,
) -> (Vec<Moment>, Outcome) {
    let mut moments = Vec::new();
    let mut simulation = Simulation::new(world, [robot]);
    let mut time_s = 0.0;
    while !simulation.is_over() && time_s < until_s {
        simulation.step().expect("the robot answers");
        let robot = &simulation.robots()[0];
        let (reason, speed_mps) = (robot.commands().reason, robot.commands().speed_mps);
        moments.push(Moment { time_s, reason, speed_mps, at: robot.body().position });
        time_s = robot.outcome().time_s;
    }
    (moments, simulation.robots()[0].outcome().clone())
}

/// The moments within a window of time.
pub(super) fn within(
    moments: &[Moment],
    window_s: Range<f64>,
) -> impl Iterator<Item = &Moment> + Clone {
    moments.iter().filter(move |moment| window_s.contains(&moment.time_s))
}

/// Runs with a failing channel, and checks that the robot arrives and touches nothing.
fn fail(fault: Fault, channel: Channel) -> Vec<Moment> {
    fail_for(fault, channel, FAILURE_S)
}

/// As [`fail`], with another window of time.
fn fail_for(fault: Fault, channel: Channel, window_s: Range<f64>) -> Vec<Moment> {
    let blob = blob(&[]);
    let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
    let Campus { world, reference, .. } = campus();
    let suite = SensorSuite::new(SensorSettings::USUAL, reference, 1);
    let sensors = Faulty::new(suite, fault, channel, window_s, 1);
    let body = Body::new(chassis(&blob), START, 0.0);
    let robot = Robot::new(body, sensors, HostPilot::new(blob), limits(&blob, 1.0));
    let (moments, outcome) = watch(world, robot, f64::INFINITY);
    let picture = || sim::picture::text(world, &outcome.route, [125.5, 240.5], 2.0);
    assert!(outcome.reached(), "{fault:?} of {channel:?}: {:?}\n{}", outcome.reasons, picture());
    assert_eq!(outcome.touches, 0, "{fault:?} of {channel:?}\n{}", picture());
    moments
}

/// The robot drives on by dead reckoning until its last fix is stale, then stands still for
/// `reason`, and drives on when fixes return.
fn check_stop(moments: &[Moment], reason: Reason, back_after_s: f64) {
    let Range { start, end } = FAILURE_S;
    let reckoning = within(moments, start..start + 1.7);
    assert!(reckoning.clone().all(|moment| moment.reason == Reason::Driving));
    assert!(reckoning.clone().any(|moment| moment.speed_mps > 0.5));
    for moment in within(moments, start + 2.3..end) {
        assert_eq!((moment.reason, moment.speed_mps), (reason, 0.0), "{moment:?}");
    }
    let back = within(moments, end + back_after_s..end + back_after_s + 5.0);
    assert!(
        back.clone().all(|moment| moment.reason == Reason::Driving),
        "{:?}",
        back.collect::<Vec<_>>()
    );
}

#[test]
fn a_lost_receiver_stops_the_robot_until_it_is_back() {
    check_stop(&fail(Fault::Drop { chance: 1.0 }, Channel::Gps), Reason::StaleFix, 0.5);
}

#[test]
fn a_garbled_receiver_is_a_lost_one() {
    check_stop(&fail(Fault::Garble { chance: 1.0 }, Channel::Gps), Reason::StaleFix, 0.5);
}

#[test]
fn a_receiver_with_some_bad_bytes_does_not_stop_the_robot() {
    let moments = fail(Fault::Garble { chance: 0.005 }, Channel::Gps);
    assert!(within(&moments, FAILURE_S).all(|moment| moment.reason == Reason::Driving));
}

#[test]
fn fixes_that_no_motion_explains_stop_the_robot_until_they_are_back() {
    let jump = Fault::Jump { offset: [900.0, 0.0] };
    check_stop(&fail(jump, Channel::Gps), Reason::JumpedFix, 0.5);
}

#[test]
fn a_jump_that_lasts_is_not_believed_while_the_robot_is_armed() {
    let lasting_s = FAILURE_S.start..FAILURE_S.end + 6.0;
    let moments = fail_for(Fault::Jump { offset: [-100.0, 0.0] }, Channel::Gps, lasting_s.clone());
    let window = within(&moments, lasting_s.start..lasting_s.end + 15.0);
    let mut reasons: Vec<Reason> = window.clone().map(|moment| moment.reason).collect();
    reasons.dedup();
    assert_eq!(reasons, [Reason::Driving, Reason::JumpedFix, Reason::Driving]);
    for moment in window.filter(|moment| moment.reason != Reason::Driving) {
        assert_eq!(moment.speed_mps, 0.0, "{moment:?}");
    }
}

#[test]
fn a_short_jump_is_ridden_out_by_dead_reckoning() {
    let blob = blob(&[]);
    let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
    let Campus { world, reference, .. } = campus();
    let suite = SensorSuite::new(SensorSettings::USUAL, reference, 1);
    let jump = Fault::Jump { offset: [0.0, 120.0] };
    let sensors = Faulty::new(suite, jump, Channel::Gps, 20.0..21.5, 1);
    let body = Body::new(chassis(&blob), START, 0.0);
    let robot = Robot::new(body, sensors, HostPilot::new(blob), limits(&blob, 1.0));
    let (moments, _) = watch(world, robot, 30.0);
    assert!(within(&moments, 5.0..30.0).all(|moment| moment.reason == Reason::Driving));
}

#[test]
fn a_frozen_receiver_stops_the_robot_until_it_is_back() {
    check_stop(&fail(Fault::Freeze, Channel::Gps), Reason::FrozenFix, 0.5);
}

#[test]
fn lost_ranges_stop_the_robot_until_they_are_back() {
    let moments = fail(Fault::Drop { chance: 1.0 }, Channel::Ranges);
    for moment in within(&moments, FAILURE_S.start + 0.7..FAILURE_S.end) {
        assert_eq!((moment.reason, moment.speed_mps), (Reason::SilentRanges, 0.0), "{moment:?}");
    }
}

#[test]
fn late_fixes_stop_the_robot_until_they_are_timely_again() {
    // Their own time shows that they are three seconds late.
    check_stop(&fail(Fault::Delay { ticks: 60 }, Channel::Gps), Reason::StaleFix, 0.5);
}

#[test]
fn garbled_and_lost_readings_of_the_other_sensors_are_survived() {
    fail(Fault::Garble { chance: 0.3 }, Channel::Heading);
    fail(Fault::Garble { chance: 0.3 }, Channel::Odometry);
    fail(Fault::Garble { chance: 0.1 }, Channel::Ranges);
    fail(Fault::Drop { chance: 1.0 }, Channel::Heading);
    fail(Fault::Drop { chance: 1.0 }, Channel::Odometry);
    fail(Fault::Freeze, Channel::Heading);
}

#[test]
fn faults_add_up_and_the_same_seed_gives_the_same_mission() {
    let run = |seed| {
        let blob = blob(&[]);
        let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
        let Campus { world, reference, .. } = campus();
        let suite = SensorSuite::new(SensorSettings::USUAL, reference, seed);
        let lossy = Faulty::new(suite, Fault::Drop { chance: 0.3 }, Channel::Gps, 5.0..60.0, seed);
        let bad = Fault::Garble { chance: 0.01 };
        let worse = Faulty::new(lossy, bad, Channel::Gps, 20.0..90.0, seed + 1);
        let late = Faulty::new(worse, Fault::Delay { ticks: 4 }, Channel::Ranges, 0.0..90.0, seed);
        let body = Body::new(chassis(&blob), START, 0.0);
        let robot = Robot::new(body, late, HostPilot::new(blob), limits(&blob, 1.0));
        robot.run(world).expect("the robot answers")
    };
    let outcome = run(7);
    assert!(outcome.reached() && outcome.touches == 0, "{:?}", outcome.reasons);
    assert_eq!(run(7), outcome);
    assert_ne!(run(8).trace_hash, outcome.trace_hash);
}

#[test]
fn a_robot_without_a_receiver_stands_still() {
    let blob = blob(&[]);
    let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
    let deaf = SensorSettings { gps: None, ..SensorSettings::USUAL };
    let (moments, outcome) = watch(&campus().world, robot(blob, START, 0.0, deaf, 1), 20.0);
    assert!(moments.iter().all(|moment| moment.reason == Reason::NoFix));
    assert_eq!(outcome.distance_m, 0.0);
}

#[test]
fn a_robot_beside_a_wall_escapes_and_arrives() {
    let blob = blob(&[]);
    let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
    // 0.6 m south of the library's western arm, closer than any advice leads.
    let beside = [45.0, 59.4];
    let (moments, outcome) =
        watch(&campus().world, robot(blob, beside, 0.0, SensorSettings::PERFECT, 1), f64::INFINITY);
    let first = moments.iter().find(|moment| moment.reason != Reason::NoFix);
    assert_eq!(first.map(|moment| moment.reason), Some(Reason::Escaping));
    assert!(outcome.reached() && outcome.touches == 0, "{:?}", outcome.reasons);
}

#[test]
fn outside_the_map_the_robot_stops_or_reacts_as_its_mission_says() {
    let west_of_the_map = [-6.0, 30.0];
    let stopping = blob(&[]);
    let plans = Blob::parse(&stopping).expect("the compiler writes what the robot reads");
    let (moments, outcome) = watch(
        &campus().world,
        robot(plans, west_of_the_map, 0.0, SensorSettings::PERFECT, 1),
        10.0,
    );
    assert!(moments.iter().skip(1).all(|moment| moment.reason == Reason::OffMap));
    assert_eq!(outcome.distance_m, 0.0);

    let reacting = blob(&[("[goals]", "[trouble]\noff_map = \"reactive\"\n\n[goals]")]);
    let plans = Blob::parse(&reacting).expect("the compiler writes what the robot reads");
    let robot = robot(plans, west_of_the_map, 0.0, SensorSettings::PERFECT, 1);
    let (_, outcome) = watch(&campus().world, robot, f64::INFINITY);
    assert!(outcome.reached() && outcome.touches == 0, "{:?}", outcome.reasons);
}

/// A robot that the wind or the error of its position has carried just over the edge, by less than its
/// radius of 0.4 m, drives back onto its map and reaches its goal, whatever its heading.
#[test]
fn just_beyond_the_edge_the_robot_drives_back() {
    let blends = [blob(&[]), blob(&[("preset = \"34:66\"\n", "")])];
    let starts = [(-0.1, 0.0), (-0.25, 1.6), (-0.25, 3.1), (-0.35, -1.6)];
    for (bytes, (x, heading_rad)) in blends.iter().flat_map(|blend| starts.map(|at| (blend, at))) {
        let plans = Blob::parse(bytes).expect("the compiler writes what the robot reads");
        let robot = robot(plans, [x, 30.0], heading_rad, SensorSettings::PERFECT, 1);
        let (moments, outcome) = watch(&campus().world, robot, f64::INFINITY);
        assert!(outcome.reached() && outcome.touches == 0, "{x} {:?}", outcome.reasons);
        assert!(moments.iter().all(|moment| moment.reason != Reason::OffMap), "{x}");
    }
}

#[test]
fn with_a_damaged_blob_the_robot_uses_its_fallback_or_stands_still() {
    let mut bytes = blob(&[]);
    let blob = Blob::parse(&bytes).expect("the compiler writes what the robot reads");
    let (parameters, origin, limits) = (*blob.parameters(), blob.origin(), limits(&blob, 0.0));
    let body = Body::new(chassis(&blob), [125.5, 60.5], 0.0);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;

    let Campus { world, reference, .. } = campus();
    let run = |fallback: &Fallback| {
        let loaded = load(&bytes, fallback);
        assert!(loaded.refusal.is_some());
        let sensors = SensorSuite::new(SensorSettings::PERFECT, reference, 1);
        let pilot = HostPilot::new(loaded.blob);
        watch(world, Robot::new(body, sensors, pilot, limits), 300.0)
    };
    let goal = Some(Vec2::new(125.5, 240.5));
    let (_, outcome) = run(&Fallback { parameters, origin, goal });
    assert!(outcome.reached() && outcome.touches == 0, "{:?}", outcome.reasons);
    assert!(outcome.ticks_of(Reason::NoPlan) > 0 && outcome.ticks_of(Reason::Driving) == 0);

    let (moments, outcome) = run(&Fallback::default());
    assert_eq!(outcome.distance_m, 0.0);
    assert!(moments.iter().all(|moment| moment.at == body.position));
}

#[test]
fn a_receiver_with_nmea_works_as_well() {
    let blob = blob(&[]);
    let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
    let gps = ReceiverSettings { dialect: Dialect::Nmea, ..ReceiverSettings::ONE_METRE };
    let sensors = SensorSettings { gps: Some(gps), ..SensorSettings::USUAL };
    let outcome =
        robot(blob, START, 0.0, sensors, 1).run(&campus().world).expect("the robot answers");
    assert!(outcome.reached() && outcome.touches == 0, "{:?}", outcome.reasons);
}
