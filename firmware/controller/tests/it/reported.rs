//! Cases after public reports about other autopilots and robots.

use crate::bench::{ORIGIN, Robot, ahead};
use crate::doubt::{START, drive, field, story};
use controller::detour::Rule;
use controller::{State, tick};
use math::Vec2;
use plan_format::parameters::ArmingChecks;
use plan_format::{Blob, Parameters};
use robot_io::{Checks, Fix, Manual, Operator, Percepts, RangeReading, Reason, Receiver};

/// PX4-ECL 957: a range finder once found stuck stayed so, although it worked again.
#[test]
fn a_range_finder_that_thaws_is_used_again() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 400, false, |index, percepts| {
        let is_frozen = (100..300).contains(&index);
        let distance_m = if is_frozen { 6.0 } else { 6.0 + 0.001 * (index % 5) as f32 };
        let reading = RangeReading { bearing_rad: 2.0, distance_m };
        percepts.ranges = [reading].into_iter().collect();
    });
    let expected = [Reason::Driving, Reason::FaultyRanges, Reason::Driving];
    assert_eq!(story(reasons), expected);
}

/// MOLA 69: a second publisher mixed fixes at the map's origin into those of the receiver.
#[test]
fn a_second_source_of_fixes_far_away_is_refused() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 3_000, false, |index, percepts| {
        if index > 0 && index.is_multiple_of(2) {
            let fix = percepts.fix.as_mut().expect("a fix");
            (fix.place, fix.velocity_mmps) = (ORIGIN.place, Some([0, 0]));
        }
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::AtGoal]);
}

/// ArduPilot 7206: the heading flipped when a rover drove in reverse.
#[test]
fn driving_astern_does_not_turn_the_heading() {
    let blob = field(Parameters::default());
    let (robot, reasons) = drive(&blob, 400, false, |index, percepts| {
        if index < 300 {
            percepts.operator.manual = Some(Manual { speed_mps: -1.0, turn_rate_radps: 0.0 });
        } else {
            // Without the compass, the heading is the course, or astern its opposite.
            percepts.heading_rad = None;
            percepts.operator.manual = Some(Manual { speed_mps: -1.0, turn_rate_radps: 0.2 });
        }
    });
    assert_eq!(story(reasons), [Reason::Manual]);
    let mut state = robot.state.clone();
    let sensed = controller::explain(&robot.blob, &mut state, &robot.percepts()).sensed;
    let error = math::scalar::wrap_angle(sensed.heading_rad.unwrap() - robot.heading_rad);
    assert!(error.abs() < 0.1 && !sensed.is_heading_wrong, "{error} rad");
}

/// ArduPilot 3220: with a fence and without a fix, arming was refused even without checks, because
/// a fence whose centre is set later, elsewhere, is worse than none.
#[test]
fn a_fence_without_a_centre_is_not_silently_off() {
    for (checks, expected) in
        [(ArmingChecks::All, (Reason::NotReady, 0.0)), (ArmingChecks::None, (Reason::Manual, 0.3))]
    {
        let mut parameters = Parameters::default();
        parameters.safety.fence_radius_m = 50.0;
        parameters.safety.checks = checks;
        let blob = Blob::without_map(parameters, None, None);
        let mut state = State::new(&blob);
        let manual = Some(Manual { speed_mps: 1.5, turn_rate_radps: 0.0 });
        let operator = Operator { is_armed: true, manual, ..Operator::default() };
        for time_us in [0, 50_000, 100_000] {
            let percepts = Percepts { time_us, operator, ..Percepts::default() };
            let commands = tick(&blob, &mut state, &percepts);
            assert_eq!((commands.reason, commands.speed_mps), expected, "{checks:?}");
            assert!(state.checks().has(Checks::FENCE));
        }
    }
}

/// ArduPilot 32977: a failsafe for want of a position stopped rovers that are driven by hand.
#[test]
fn driving_by_hand_needs_no_position() {
    let blob = field(Parameters::default());
    let (robot, reasons) = drive(&blob, 100, false, |_, percepts| {
        (percepts.fix, percepts.heading_rad) = (None, None);
        percepts.operator.manual = Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.0 });
    });
    assert_eq!(story(reasons), [Reason::Manual]);
    assert!(robot.position.x > START.0 + 4.0);
}

/// ArduPilot 647: a copter armed with a poor fix found itself outside its fence and flew off to a
/// wrong home. Here the robot stands, and a new order to arm sets the fence anew.
#[test]
fn a_fence_around_a_wrong_first_fix_stops_the_robot() {
    let mut parameters = Parameters::default();
    parameters.safety.fence_radius_m = 50.0;
    let blob = field(parameters);
    let (robot, reasons) = drive(&blob, 600, false, |index, percepts| {
        if index == 0 {
            percepts.fix.as_mut().expect("a fix").place.lat_e7 += 30_000;
        }
        percepts.operator.is_armed = !(400..402).contains(&index);
    });
    assert!(robot.position.x > START.0 + 5.0, "{:?}", robot.position);
    let reasons = story(reasons);
    assert!(reasons.contains(&Reason::OutsideFence), "{reasons:?}");
    assert_eq!(reasons[reasons.len() - 2..], [Reason::Disarmed, Reason::Driving]);
}

/// Mowglinext 694: the receiver's driver repeated one position with new time stamps for minutes,
/// at rest and on the move. At rest that is not a fault.
#[test]
fn a_position_that_stays_the_same_at_rest_is_not_frozen() {
    let blob = field(Parameters::default());
    let blob = Blob::parse(&blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, START.0, START.1);
    for number in 0..2_400_u32 {
        let place = blob.map_frame().expect("an origin").to_geodetic(Vec2::new(10.0, 50.0));
        robot.tick_with(|percepts| {
            percepts.operator.is_armed = false;
            percepts.fix =
                Some(Fix { place, receiver_ms: Some(number * 50), ..percepts.fix.expect("a fix") });
        });
    }
    assert_eq!(robot.tick_with(|_| {}).reason, Reason::Driving);
}

/// Somebody stands before a robot that waits to be armed for a minute. Then it has its whole patience:
/// the time of waiting begins no detour.
#[test]
fn waiting_for_the_operator_begins_no_detour() {
    let mut parameters = Parameters::default();
    parameters.schemas.detour_after_us = 1_000_000;
    let blob = field(parameters);
    let blob = Blob::parse(&blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, START.0, START.1);
    let mut rules = Vec::new();
    for index in 0..1_300 {
        let mut percepts = robot.percepts();
        percepts.operator.is_armed = index >= 1_200;
        percepts.scan_us = Some(percepts.time_us);
        percepts.ranges = [ahead(0.45)].into_iter().collect();
        (percepts.speed_mps, percepts.turn_rate_radps) = (Some(0.0), Some(0.0));
        let explained = controller::explain(&robot.blob, &mut robot.state, &percepts);
        rules.push(explained.blend.map(|blend| blend.rule));
        robot.time_us += crate::bench::TICK_US;
    }
    assert_eq!(rules[1_200..1_220], [Some(Rule::Swirl); 20]);
    assert_eq!(rules[1_225], Some(Rule::Detour), "after 1 s");
}

/// DevSidus 33: a receiver that has reported that it has no fix falls silent, or its bytes become noise.
/// Its state is the reason, not what it said before.
#[test]
fn the_state_of_a_receiver_without_a_good_fix_is_the_reason() {
    for (receiver, expected) in [
        (Receiver::NoFix, Reason::PoorFix),
        (Receiver::Unreadable, Reason::UnreadableReceiver),
        (Receiver::Unchecked, Reason::UncheckedReceiver),
        (Receiver::NoPosition, Reason::NoPositionMessage),
        (Receiver::Silent, Reason::NoFix),
    ] {
        let blob = field(Parameters::default());
        let (_, reasons) = drive(&blob, 200, false, |index, percepts| {
            let fix = percepts.fix.as_mut().expect("a fix");
            (fix.is_valid, fix.time_us) = (false, fix.time_us.min(2_000_000));
            percepts.receiver = if index < 60 { Receiver::NoFix } else { receiver };
        });
        assert_eq!((reasons[10], reasons[199]), (Reason::PoorFix, expected));
    }
}
