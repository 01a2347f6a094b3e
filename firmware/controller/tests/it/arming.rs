//! What the robot needs before it may drive: checks, fence, battery, link.

use crate::bench::{ORIGIN, Robot};
use crate::doubt::{START, drive, field, story};
use controller::{State, tick};
use math::Vec2;
use plan_format::parameters::ArmingChecks;
use plan_format::{Blob, Parameters};
use robot_io::{Checks, Manual, Operator, Percepts, Pose, Reason};

#[test]
fn the_fence_lies_around_the_place_of_arming() {
    let mut parameters = Parameters::default();
    parameters.safety.fence_radius_m = 20.0;
    let blob = field(parameters);
    let (robot, reasons) = drive(&blob, 600, false, |_, _| {});
    assert_eq!(story(reasons), [Reason::Driving, Reason::OutsideFence]);
    assert!((robot.position.x - START.0 - 20.0).abs() < 0.5, "{:?}", robot.position);
}

/// Without a blob or a plan, by hand: within the fence at full speed, outside at cautious speed.
#[test]
fn the_fence_needs_no_blob_and_slows_a_driver_down() {
    let mut parameters = Parameters::default();
    parameters.safety.fence_radius_m = 20.0;
    let blob = Blob::without_map(parameters, None, None);
    let frame = math::MapFrame::new(ORIGIN.place, [0.0, 0.0], 0.0);
    let mut state = State::new(&blob);
    let manual = Some(Manual { speed_mps: 1.5, turn_rate_radps: 0.0 });
    let mut at = |number: u64, x: Option<f32>| {
        let fix = x.map(|x| robot_io::Fix {
            time_us: number * 50_000,
            is_valid: true,
            place: frame.to_geodetic(Vec2::new(x, 0.0)),
            accuracy_mm: 500,
            velocity_mmps: None,
            receiver_ms: None,
        });
        let operator = Operator { is_armed: true, manual, ..Operator::default() };
        let percepts = Percepts { time_us: number * 50_000, fix, operator, ..Percepts::default() };
        let commands = tick(&blob, &mut state, &percepts);
        (commands.reason, commands.speed_mps, state.checks().has(Checks::FENCE))
    };
    assert_eq!(at(1, None), (Reason::NotReady, 0.0, true), "nothing shows where the fence is");
    assert_eq!(at(2, Some(0.0)), (Reason::Manual, 1.5, false));
    assert_eq!(at(3, Some(19.0)), (Reason::Manual, 1.5, false));
    assert_eq!(at(4, Some(21.0)), (Reason::Manual, 0.3, true));
    assert_eq!(at(5, None), (Reason::Manual, 0.3, true), "it may be outside");
    assert_eq!(at(6, Some(-5.0)), (Reason::Manual, 1.5, false));
}

#[test]
fn a_low_battery_stops_the_robot_until_it_is_disarmed() {
    let mut parameters = Parameters::default();
    parameters.safety.battery_low = 10.5;
    let blob = field(parameters);
    let (_, reasons) = drive(&blob, 500, false, |index, percepts| {
        // Motors that start pull it down for a moment; without load it recovers.
        percepts.inputs[0] = Some(match index {
            100..=110 | 200..=260 => 10.0,
            _ => 11.5,
        });
        percepts.operator.is_armed = index != 400;
    });
    let expected = [Reason::Driving, Reason::LowBattery, Reason::Disarmed, Reason::Driving];
    assert_eq!(story(reasons), expected);
}

#[test]
fn the_checks_name_what_is_missing_and_gate_the_first_motion_only() {
    let blob = field(Parameters::default());
    let checks = |change: &dyn Fn(&mut Percepts)| {
        let blob = Blob::parse(&blob).expect("the blob is valid");
        let mut robot = Robot::new(blob, START.0, START.1);
        robot.tick_with(change);
        robot.state.checks().names().collect::<Vec<_>>()
    };
    assert_eq!(checks(&|_| {}), [""; 0]);
    assert_eq!(checks(&|p| p.fix = None), ["position"]);
    assert_eq!(checks(&|p| p.heading_rad = None), ["heading"]);
    assert_eq!(checks(&|p| (p.scan_us, p.garbled_ranges) = (Some(p.time_us), 2)), ["ranges"]);
    let nothing = Blob::without_map(Parameters::default(), None, None);
    let mut state = State::new(&nothing);
    let armed = Operator { is_armed: true, ..Operator::default() };
    tick(&nothing, &mut state, &Percepts { operator: armed, ..Percepts::default() });
    assert_eq!(state.checks().names().collect::<Vec<_>>(), ["position", "heading", "plan"]);
}

/// What a robot that is armed inside its fence of 20 m reports while this changes from tick 100 on.
fn fenced(mut change: impl FnMut(usize, &mut Percepts)) -> Vec<Reason> {
    let mut parameters = Parameters::default();
    parameters.safety.fence_radius_m = 20.0;
    let blob = field(parameters);
    let (_, reasons) = drive(&blob, 200, false, |index, percepts| {
        if index >= 100 {
            change(index, percepts);
        }
    });
    story(reasons)
}

/// paparazzi 3105, betaflight 15454: a fix that cannot be used does not prove that the robot is outside. It
/// dead-reckons, and poses take over where the fixes end.
#[test]
fn a_fix_that_cannot_be_used_does_not_put_the_robot_outside_its_fence() {
    // Three of four fixes cannot be used, and are 100 m to the north.
    let spoilt = |spoil: fn(&mut robot_io::Fix)| {
        fenced(|index, percepts| {
            let fix = percepts.fix.as_mut().expect("a fix");
            if !index.is_multiple_of(4) {
                fix.place.lat_e7 += 9_000;
                spoil(fix);
            }
        })
    };
    assert_eq!(spoilt(|fix| fix.is_valid = false), [Reason::Driving]);
    assert_eq!(spoilt(|fix| fix.accuracy_mm = 6_000), [Reason::Driving]);
    assert!(spoilt(|_| ()).contains(&Reason::OutsideFence), "a fix that can be used counts");
    let mut start = None;
    let poses = fenced(|_, percepts| {
        // The robot drives east.
        let from = *start.get_or_insert(percepts.time_us);
        let x_m = 16.2 + 1.6e-6 * (percepts.time_us - from) as f32;
        percepts.pose = Some(Pose {
            time_us: percepts.time_us,
            position_m: [x_m, 50.0],
            heading_rad: Some(0.0),
            accuracy_mm: 20,
        });
        percepts.fix = None;
    });
    assert_eq!(poses, [Reason::Driving]);
}

/// A battery that has a threshold and is not read keeps the robot from being armed; readings that are
/// missing now and then do not make up for low ones.
#[test]
fn a_battery_that_is_not_read_is_not_full() {
    let mut parameters = Parameters::default();
    parameters.safety.battery_low = 10.5;
    let blob = field(parameters);
    let (_, reasons) = drive(&blob, 20, false, |_, _| {});
    assert_eq!(story(reasons), [Reason::NotReady]);
    // Facing away from the goal, it would only turn.
    let turned = |_: usize, percepts: &mut Percepts| percepts.heading_rad = Some(3.0);
    let (robot, reasons) = drive(&blob, 20, false, turned);
    assert_eq!((story(reasons), robot.heading_rad), (vec![Reason::NotReady], 0.0));
    assert_eq!(robot.state.checks().names().collect::<Vec<_>>(), ["battery"]);
    let (_, reasons) = drive(&blob, 300, false, |index, percepts| {
        let volts = if index < 100 { 11.5 } else { 10.0 };
        percepts.inputs[0] = Some(volts).filter(|_| index % 2 == 0);
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::LowBattery]);
    // Armed, it drives on without a reading; armed anew, it does not.
    let (robot, reasons) = drive(&blob, 300, false, |index, percepts| {
        percepts.inputs[0] = Some(11.5).filter(|_| index < 100);
        percepts.operator.is_armed = index != 290;
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::Disarmed, Reason::NotReady]);
    assert!(robot.state.checks().has(Checks::BATTERY));
}

/// By default a battery that is low when the robot is armed keeps it from driving by hand too.
#[test]
fn arming_with_a_failing_check_is_refused_unless_the_mission_asks_for_none() {
    for (checks, expected) in
        [(ArmingChecks::All, Reason::NotReady), (ArmingChecks::None, Reason::Manual)]
    {
        let mut parameters = Parameters::default();
        parameters.safety.battery_low = 10.5;
        parameters.safety.checks = checks;
        let blob = field(parameters);
        let manual = Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.0 });
        let (robot, reasons) = drive(&blob, 20, false, |_, percepts| {
            percepts.inputs[0] = Some(9.0);
            percepts.operator.manual = manual;
        });
        assert_eq!(story(reasons), [expected]);
        assert!(robot.state.checks().has(Checks::BATTERY));
    }
}

#[test]
fn link_loss_has_a_reason_of_its_own() {
    let blob = field(Parameters::default());
    for (is_link_lost, expected) in [(true, Reason::LinkLost), (false, Reason::Disarmed)] {
        let (_, reasons) = drive(&blob, 20, false, |index, percepts| {
            if index >= 10 {
                (percepts.operator.is_armed, percepts.is_link_lost) = (false, is_link_lost);
            }
        });
        assert_eq!(story(reasons), [Reason::Driving, expected]);
    }
}
