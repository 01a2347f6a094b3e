//! What running actions make the robot do.

use math::{Vec2, vector};
use plan_format::{Blob, Origin};
use robot_io::{Commands, Reason};

use crate::bench::{ORIGIN, Robot, behaving_blob, behaving_blob_at, open_field};

fn ticks(actions: &str, count: usize) -> Vec<Commands> {
    let blob = behaving_blob(&open_field(30, 30, (25, 15)), "PS", actions);
    let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), 5.5, 15.5);
    (0..count).map(|_| robot.tick_with(|_| {})).collect()
}

/// H15: the robot keeps to the maximum speed inherited from plan frame and action, 0.5 m/s.
#[test]
fn follow_and_go_to_drive_within_the_inherited_speed() {
    for action in ["follow", "goto 25.5 15.5"] {
        let commands = ticks(action, 1)[0];
        assert_eq!(commands.reason, Reason::Driving);
        assert!((0.4..=0.5).contains(&commands.speed_mps), "{commands:?}");
    }
}

/// On a map whose y axis points to the east, the direction is still that of the compass.
#[test]
fn move_ahead_drives_by_the_compass() {
    use core::f32::consts::FRAC_PI_2;
    for (heading_rad, direction_rad, expected) in [
        (0.0, 0.0, Vec2::new(1.0, 0.0)),
        (0.0, FRAC_PI_2, Vec2::new(0.0, 1.0)),
        (f64::from(FRAC_PI_2), FRAC_PI_2, Vec2::new(-1.0, 0.0)),
    ] {
        let origin = Origin { heading_rad, ..ORIGIN };
        let action = format!("ahead {direction_rad} 8000, hold 60000");
        let blob = behaving_blob_at(&open_field(30, 30, (25, 15)), origin, "PS", &action);
        let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), 15.5, 15.5);
        let from = robot.position;
        let reasons: Vec<_> = (0..400)
            .map(|_| {
                // A compass shows the heading on the globe.
                let compass_rad = robot.heading_rad - heading_rad as f32;
                robot.drive_with(|percepts| percepts.heading_rad = Some(compass_rad)).reason
            })
            .collect();
        assert_eq!((reasons[80], reasons[399]), (Reason::Driving, Reason::Holding));
        let driven = robot.position - from;
        // 0.5 m/s for 8 s, and the turn at the start.
        assert!((2.0..=4.1).contains(&driven.dot(&expected)), "{driven:?}");
        assert!(vector::length(driven) < driven.dot(&expected) * 1.3, "{driven:?}");
    }
}

/// From all sides the robot enters a dock from its front.
#[test]
fn a_dock_is_entered_from_its_front() {
    let map = open_field(30, 30, (25, 25));
    let blob = behaving_blob(&map, "PS", "dock 15 15 1.5708 400, hold 60000");
    for (x, y) in [(15.0, 3.0), (15.0, 27.0), (3.0, 15.0), (27.0, 17.0), (16.5, 16.0), (12.0, 12.5)]
    {
        let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), x, y);
        let docked = (0..4_000).any(|_| robot.drive_with(|_| {}).reason == Reason::Holding);
        assert!(docked, "({x}, {y}) ended at {:?}", robot.position);
        let offset = robot.position - Vec2::new(15.0, 15.0);
        assert!(vector::length(offset) < 1.05, "{offset:?}");
        let north_rad = core::f32::consts::FRAC_PI_2;
        assert!((robot.heading_rad - north_rad).abs() < 0.5, "({x}, {y}): {}", robot.heading_rad);
        assert!(offset.y < 0.0 && offset.x.abs() < 0.5, "({x}, {y}): {offset:?}");
    }
}

/// Being within the goal's tolerance, 1 m, is not enough beside the dock, behind it or turned away.
#[test]
fn a_robot_near_a_dock_still_enters_it_from_its_front() {
    use core::f32::consts::{FRAC_PI_2, FRAC_PI_4};
    let map = open_field(30, 30, (25, 25));
    let blob = behaving_blob(&map, "PS", "dock 15 15 1.5708 400, hold 60000");
    for (x, y, heading_rad) in [
        (15.7, 15.0, FRAC_PI_2),
        (14.3, 15.1, -FRAC_PI_2),
        (15.0, 15.6, FRAC_PI_2),
        (15.2, 15.5, -FRAC_PI_2),
        (15.0, 14.5, -FRAC_PI_2),
        (15.1, 14.4, 0.0),
    ] {
        let case = (x, y, heading_rad);
        let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), x, y);
        robot.heading_rad = heading_rad;
        let reasons: Vec<_> = (0..2_000).map(|_| robot.drive_with(|_| {}).reason).collect();
        assert_eq!((reasons[0], reasons[1_999]), (Reason::Driving, Reason::Holding), "{case:?}");
        let offset = robot.position - Vec2::new(15.0, 15.0);
        assert!(offset.y < 0.0 && offset.x.abs() < -offset.y + 0.05, "{case:?}: {offset:?}");
        let error_rad = (robot.heading_rad - FRAC_PI_2).abs();
        assert!(error_rad < FRAC_PI_4 + 0.05, "{case:?}: {error_rad}");
    }
}

#[test]
fn wander_moves_and_hold_does_not() {
    let wandering = ticks("wander 10000", 40);
    assert!(wandering.iter().any(|commands| commands.turn_rate_radps != 0.0));
    let holding = ticks("hold 10000", 3)[2];
    assert_eq!((holding.reason, holding.speed_mps), (Reason::Holding, 0.0));
}

/// An output keeps its value until the next change; a signal lasts one tick.
#[test]
fn outputs_and_signals_reach_the_commands() {
    let all = ticks("set 3 on, hold 100, signal 7, set 3 off, hold 100", 5);
    let outputs: Vec<u16> = all.iter().map(|commands| commands.outputs).collect();
    let signals: Vec<u16> = all.iter().map(|commands| commands.signal).collect();
    assert_eq!(outputs, [8, 8, 8, 0, 0]);
    assert_eq!(signals, [0, 0, 7, 0, 0]);
}

/// A finished behaviour that is still critical starts again.
#[test]
fn a_finished_behaviour_begins_again_while_it_is_critical() {
    let all = ticks("signal 9", 6);
    assert!(all.iter().filter(|commands| commands.signal == 9).count() >= 2);
}

/// While the robot is disarmed or the emergency stop is pressed, all outputs are off. Afterwards they
/// have the state that they had.
#[test]
fn outputs_are_off_while_the_robot_is_stopped() {
    let actions = "set 3 on, hold 60000";
    let blob = behaving_blob(&open_field(30, 30, (25, 15)), "PS", actions);
    let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), 5.5, 15.5);
    assert_eq!(robot.tick_with(|_| {}).outputs, 8);
    assert_eq!(robot.tick_with(|percepts| percepts.operator.is_emergency_stop = true).outputs, 0);
    assert_eq!(robot.tick_with(|_| {}).outputs, 8);
    assert_eq!(robot.tick_with(|percepts| percepts.operator.is_armed = false).outputs, 0);
    // Ordered to arm again, it is not armed while a check fails.
    let garbled = robot.tick_with(|percepts| {
        (percepts.scan_us, percepts.garbled_ranges) = (Some(percepts.time_us), 2);
    });
    assert_eq!((garbled.reason, garbled.outputs), (Reason::NotReady, 0));
    assert_eq!(robot.tick_with(|percepts| percepts.scan_us = Some(percepts.time_us)).outputs, 8);
}

/// An order to arm does not arm the robot while a check fails: its plans wait and its outputs stay off.
#[test]
fn plans_and_outputs_wait_until_the_checks_have_passed() {
    let actions = "set 3 on, hold 100, set 3 off, set 4 on, hold 60000";
    let blob = behaving_blob(&open_field(30, 30, (25, 15)), "PS", actions);
    let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), 5.5, 15.5);
    for tick in 0..40 {
        let commands = robot.tick_with(|percepts| percepts.heading_rad = None);
        assert_eq!((commands.reason, commands.outputs), (Reason::NotReady, 0), "{tick}");
    }
    let commands = robot.tick_with(|_| {});
    assert_eq!((commands.reason, commands.outputs), (Reason::Holding, 8));
    // An armed robot goes on without its heading.
    let after = (0..4).map(|_| robot.tick_with(|percepts| percepts.heading_rad = None)).last();
    assert_eq!(after.map(|commands| commands.outputs), Some(16));
}

/// Off the map, actions without a plan stand still like those with one, unless the mission lets the
/// robot drive there.
#[test]
fn without_a_plan_the_robot_obeys_off_map_too() {
    for action in ["follow", "goto 25.5 15.5", "wander 10000"] {
        let blob = behaving_blob(&open_field(30, 30, (25, 15)), "PS", action);
        let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), -3.5, 15.5);
        let commands = robot.tick_with(|_| {});
        assert_eq!((commands.reason, commands.speed_mps), (Reason::OffMap, 0.0), "{action}");
    }
}
