//! What running actions make the robot do.

use plan_format::Blob;
use robot_io::{Commands, Reason};

use crate::bench::{Robot, behaving_blob, open_field};

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
    assert_eq!(robot.tick_with(|_| {}).outputs, 8);
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
