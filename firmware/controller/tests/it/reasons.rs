//! Trouble is data: the tests reach every reason and check what the robot then does.

use crate::bench::{ORIGIN, Robot, ahead, armed, behaving_blob, blob, blob_at, open_field};
use math::{GeoPoint, Vec2};
use plan_format::parameters::{Gains, OnTrouble};
use plan_format::{Blob, Parameters};
use robot_io::{Manual, Operator, Percepts, Reason, Receiver};

/// The goal in the east, a walled-in pocket in the west, an obstacle in the middle.
const MAP: &str = "
    .#..........
    .#...##....G
    .#..........";
const START: (f32, f32) = (3.5, 1.5);
const POCKET: (f32, f32) = (0.5, 1.5);
const OBSTACLE: (f32, f32) = (5.5, 1.5);
const OUTSIDE: (f32, f32) = (3.5, -4.0);
const GOAL: (f32, f32) = (11.5, 1.5);

/// What the robot does in its last tick.
#[derive(Debug, PartialEq)]
enum Does {
    Drives,
    Stops,
}
use Does::{Drives, Stops};

/// Reason and reaction after `ticks` with good percepts that `change` alters.
fn after(
    ticks: usize,
    blob: Blob<'_>,
    at: (f32, f32),
    change: &dyn Fn(usize, &mut Percepts),
) -> (Reason, Does) {
    let mut robot = Robot::new(blob, at.0, at.1);
    let mut last = None;
    for index in 0..ticks {
        last = Some(robot.tick_with(|percepts| change(index, percepts)));
    }
    let commands = last.expect("at least one tick");
    let moves = commands.speed_mps != 0.0 || commands.turn_rate_radps != 0.0;
    (commands.reason, if moves { Drives } else { Stops })
}

/// Index among all reasons. A new reason does not compile until it is listed here, and then
/// the test below fails until a case reaches it.
fn index_of(reason: Reason) -> usize {
    use Reason::*;
    let all = [
        Driving,
        AtGoal,
        Escaping,
        NoPlan,
        NoRoute,
        OffMap,
        NoFix,
        StaleFix,
        PoorFix,
        JumpedFix,
        DistantFix,
        NoHeading,
        ObstacleStop,
        Disarmed,
        EmergencyStop,
        Manual,
        NoOrigin,
        Holding,
        Idle,
        UnreadableReceiver,
        UncheckedReceiver,
        NoPositionMessage,
        SilentRanges,
        FaultyRanges,
        FrozenFix,
        WrongHeading,
        NoProgress,
        ClockStopped,
        LinkLost,
        OutsideFence,
        NotReady,
        LowBattery,
    ];
    match reason {
        Driving | AtGoal | Escaping | NoPlan | NoRoute | OffMap | NoFix | StaleFix | PoorFix
        | JumpedFix | DistantFix | NoHeading | ObstacleStop | Disarmed | EmergencyStop | Manual
        | NoOrigin | Holding | Idle | UnreadableReceiver | UncheckedReceiver
        | NoPositionMessage | SilentRanges | FaultyRanges | FrozenFix | WrongHeading
        | NoProgress | ClockStopped | LinkLost | OutsideFence | NotReady | LowBattery => {
            all.iter().position(|&other| other == reason).expect("it is listed")
        }
    }
}

/// Percepts without any fix, and with this state of the receiver.
fn heard(receiver: Receiver) -> impl Fn(usize, &mut Percepts) {
    move |_, percepts| (percepts.fix, percepts.receiver) = (None, receiver)
}

type Case<'a> =
    (&'a str, &'a [u8], (f32, f32), usize, &'a dyn Fn(usize, &mut Percepts), Reason, Does);

#[test]
fn w14_w23_every_reason_is_reached_and_defined() {
    let stops = blob(&[MAP], Parameters::default());
    let mut reactive = Parameters::default();
    reactive.trouble.no_route = OnTrouble::Reactive;
    reactive.trouble.off_map = OnTrouble::Reactive;
    let goes_on = blob(&[MAP], reactive);
    let mut waits = Parameters::default();
    waits.vehicle.may_creep = false;
    let waits = blob(&[MAP], waits);
    let plan_only = Parameters { gains: Gains::PLAN_ONLY, ..Parameters::paper() };
    let plan_only = blob(&[MAP], plan_only);
    let mut fenced = Parameters::default();
    fenced.safety.fence_radius_m = 2.0;
    let fenced = blob(&[MAP], fenced);
    let mut guarded = Parameters::default();
    guarded.safety.battery_low = 10.0;
    let guarded = blob(&[MAP], guarded);
    let unknown_place = blob_at(&[MAP], Parameters::default(), None);

    let [holding, idle] = ["PS", "NB"].map(|label| behaving_blob(MAP, label, "hold 60000"));

    let nothing = |_: usize, _: &mut Percepts| {};
    let then = |change: fn(&mut Percepts)| {
        move |index: usize, percepts: &mut Percepts| {
            if index > 0 {
                change(percepts)
            }
        }
    };
    let first_fix_only = |index: usize, percepts: &mut Percepts| {
        if let (true, Some(fix)) = (index > 0, &mut percepts.fix) {
            fix.time_us = 1_000_000;
            percepts.speed_mps = Some(0.0);
        }
    };
    let poor = |_: usize, p: &mut Percepts| p.fix.as_mut().unwrap().is_valid = false;
    let inaccurate = |_: usize, p: &mut Percepts| p.fix.as_mut().unwrap().accuracy_mm = 5_001;
    let jumped = then(|p| {
        p.fix.as_mut().unwrap().place.lat_e7 += 100_000;
        p.speed_mps = Some(0.0);
    });
    let distant = |_: usize, p: &mut Percepts| {
        p.fix.as_mut().unwrap().place = GeoPoint { lat_e7: 0, lon_e7: 0 }
    };
    let no_fix = |_: usize, p: &mut Percepts| p.fix = None;
    let unreadable = heard(Receiver::Unreadable);
    let unchecked = heard(Receiver::Unchecked);
    let no_position = heard(Receiver::NoPosition);
    let no_solution = heard(Receiver::NoFix);
    let silent = heard(Receiver::Silent);
    let no_compass = |_: usize, p: &mut Percepts| p.heading_rad = None;
    let still = |_: usize, p: &mut Percepts| {
        p.heading_rad = None;
        p.fix.as_mut().unwrap().velocity_mmps = Some([0, 0]);
    };
    let blocked = |_: usize, p: &mut Percepts| p.ranges = [ahead(0.5)].into_iter().collect();
    let lost_ranges = |index: usize, p: &mut Percepts| {
        p.scan_us = Some(if index == 0 { p.time_us } else { 1_000_000 });
    };
    let garbled = |_: usize, p: &mut Percepts| {
        (p.scan_us, p.garbled_ranges) = (Some(p.time_us), 1);
    };
    let repeated = |_: usize, p: &mut Percepts| p.fix.as_mut().unwrap().receiver_ms = Some(7);
    let standing = |index: usize, p: &mut Percepts| {
        let fix = p.fix.as_mut().unwrap();
        (fix.receiver_ms, fix.velocity_mmps) = (Some(50 * index as u32), Some([0, 0]));
    };
    let turning = |_: usize, p: &mut Percepts| {
        (p.turn_rate_radps, p.heading_rad) = (Some(1.0), Some(-2.5));
    };
    let same_time = |_: usize, p: &mut Percepts| p.time_us = 1_000_000;
    let moved = then(|p| p.fix.as_mut().unwrap().place.lat_e7 += 300);
    let low = |_: usize, p: &mut Percepts| p.inputs[0] = Some(9.0);
    let low_by_hand = |_: usize, p: &mut Percepts| {
        p.inputs[0] = Some(9.0);
        p.operator.manual = Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.0 });
    };
    let lost_link =
        |_: usize, p: &mut Percepts| (p.operator.is_armed, p.is_link_lost) = (false, true);
    let disarmed = |_: usize, p: &mut Percepts| p.operator.is_armed = false;
    let emergency = |_: usize, p: &mut Percepts| p.operator.is_emergency_stop = true;
    let by_hand = |_: usize, p: &mut Percepts| {
        p.operator.manual = Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.0 });
    };

    use Reason::{NoPositionMessage, UncheckedReceiver, UnreadableReceiver};
    let table: &[Case<'_>] = &[
        ("all is well", &stops, START, 1, &nothing, Reason::Driving, Drives),
        ("at the goal", &stops, GOAL, 1, &nothing, Reason::AtGoal, Stops),
        ("in an obstacle", &stops, OBSTACLE, 1, &nothing, Reason::Escaping, Drives),
        ("in the pocket", &stops, POCKET, 1, &nothing, Reason::NoRoute, Stops),
        ("in the pocket, reactive", &goes_on, POCKET, 1, &nothing, Reason::NoRoute, Drives),
        ("off the map", &stops, OUTSIDE, 1, &nothing, Reason::OffMap, Stops),
        ("off the map, reactive", &goes_on, OUTSIDE, 1, &nothing, Reason::OffMap, Drives),
        ("never a fix", &stops, START, 9, &no_fix, Reason::NoFix, Stops),
        ("an unreadable receiver", &stops, START, 9, &unreadable, UnreadableReceiver, Stops),
        ("sentences without checksums", &stops, START, 9, &unchecked, UncheckedReceiver, Stops),
        ("messages without a position", &stops, START, 9, &no_position, NoPositionMessage, Stops),
        ("a receiver without a fix", &stops, START, 9, &no_solution, Reason::PoorFix, Stops),
        ("a silent receiver", &stops, START, 9, &silent, Reason::NoFix, Stops),
        ("the fix is frozen, 2 s", &stops, START, 41, &first_fix_only, Reason::Driving, Drives),
        ("the fix is frozen", &stops, START, 42, &first_fix_only, Reason::StaleFix, Stops),
        ("the fix is not valid", &stops, START, 1, &poor, Reason::PoorFix, Stops),
        ("the fix is inaccurate", &stops, START, 1, &inaccurate, Reason::PoorFix, Stops),
        ("the fix jumped, 2 s", &stops, START, 41, &jumped, Reason::Driving, Drives),
        ("the fix jumped", &stops, START, 42, &jumped, Reason::JumpedFix, Stops),
        ("the fix is far away", &stops, START, 1, &distant, Reason::DistantFix, Stops),
        ("no heading at all", &stops, START, 9, &no_compass, Reason::NoHeading, Stops),
        ("a course to find", &stops, START, 9, &still, Reason::NoHeading, Drives),
        ("it must not creep", &waits, START, 9, &still, Reason::NoHeading, Stops),
        ("something ahead", &plan_only, START, 1, &blocked, Reason::ObstacleStop, Drives),
        ("ranges lost, 0.5 s", &stops, START, 11, &lost_ranges, Reason::Driving, Drives),
        ("ranges lost", &stops, START, 12, &lost_ranges, Reason::SilentRanges, Stops),
        ("garbled ranges", &stops, START, 9, &garbled, Reason::FaultyRanges, Stops),
        ("one solution repeated", &stops, START, 42, &repeated, Reason::FrozenFix, Stops),
        ("wheels that turn in place", &stops, START, 42, &standing, Reason::NoProgress, Stops),
        ("a frozen compass", &stops, START, 24, &turning, Reason::WrongHeading, Stops),
        ("a clock that stands", &stops, START, 12, &same_time, Reason::ClockStopped, Stops),
        ("outside the fence", &fenced, START, 2, &moved, Reason::OutsideFence, Stops),
        ("a low battery", &guarded, START, 42, &low, Reason::LowBattery, Stops),
        ("not ready", &guarded, START, 1, &low_by_hand, Reason::NotReady, Stops),
        ("the link is lost", &stops, START, 1, &lost_link, Reason::LinkLost, Stops),
        ("disarmed", &stops, START, 1, &disarmed, Reason::Disarmed, Stops),
        ("emergency stop", &stops, START, 1, &emergency, Reason::EmergencyStop, Stops),
        ("by hand", &stops, START, 1, &by_hand, Reason::Manual, Drives),
        ("holding", &holding, START, 1, &nothing, Reason::Holding, Stops),
        ("nothing to do", &idle, START, 1, &nothing, Reason::Idle, Stops),
        ("no origin", &unknown_place, START, 1, &nothing, Reason::NoOrigin, Stops),
    ];
    let mut reached = vec![false; 32];
    for (name, blob, at, ticks, change, reason, does) in table {
        let blob = Blob::parse(blob).expect("the blob is valid");
        let (result, did) = after(*ticks, blob, *at, *change);
        assert_eq!((&result, &did), (reason, does), "{name}");
        reached[index_of(result)] = true;
    }

    let without_map = |goal| Blob::without_map(Parameters::default(), Some(ORIGIN), goal);
    let to_a_goal = after(1, without_map(Some(Vec2::new(9.0, 9.0))), START, &nothing);
    assert_eq!(to_a_goal, (Reason::NoPlan, Drives));
    assert_eq!(after(1, without_map(None), START, &nothing), (Reason::NoPlan, Stops));
    reached[index_of(Reason::NoPlan)] = true;
    assert!(reached.iter().all(|&reached| reached), "{reached:?}");
}

#[test]
fn emergency_stop_disarm_and_manual_outrank_everything_in_this_order() {
    let blob = blob(&[MAP], Parameters::default());
    let manual = Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.5 });
    // armed, emergency stop, by hand
    let table = [
        (true, false, None, Reason::Driving),
        (true, false, manual, Reason::Manual),
        (true, true, manual, Reason::EmergencyStop),
        (true, true, None, Reason::EmergencyStop),
        (false, false, manual, Reason::Disarmed),
        (false, true, manual, Reason::EmergencyStop),
        (false, false, None, Reason::Disarmed),
    ];
    for (is_armed, is_emergency_stop, manual, reason) in table {
        for has_fix in [true, false] {
            let mut robot = Robot::new(Blob::parse(&blob).unwrap(), START.0, START.1);
            let commands = robot.tick_with(|percepts| {
                percepts.operator = Operator { is_armed, is_emergency_stop, manual };
                percepts.fix = percepts.fix.filter(|_| has_fix);
            });
            let reason = if has_fix || reason != Reason::Driving { reason } else { Reason::NoFix };
            assert_eq!(commands.reason, reason);
            if matches!(reason, Reason::Disarmed | Reason::EmergencyStop) {
                assert_eq!((commands.speed_mps, commands.turn_rate_radps), (0.0, 0.0));
            }
        }
    }
}

/// The robot stays at its goal while the position wavers by up to two tolerances.
#[test]
fn an_arrival_lasts_until_the_robot_is_moved_away_or_disarmed() {
    let map = open_field(30, 30, (15, 15));
    let blob = blob(&[&map], Parameters::default());
    let mut robot = Robot::new(Blob::parse(&blob).unwrap(), 11.0, 15.5);
    let mut reason_at = |x: f32, is_armed: bool| {
        robot.carry_to(x);
        robot.tick_with(|percepts| percepts.operator = Operator { is_armed, ..armed() }).reason
    };
    let walk = [
        (14.0, true, Reason::Driving),
        (14.6, true, Reason::AtGoal),
        (13.6, true, Reason::AtGoal),
        (13.4, true, Reason::Driving),
        (13.6, true, Reason::Driving),
        (14.6, true, Reason::AtGoal),
        (13.6, true, Reason::AtGoal),
        (13.6, false, Reason::Disarmed),
        (13.6, true, Reason::Driving),
    ];
    for (x, is_armed, expected) in walk {
        assert_eq!(reason_at(x, is_armed), expected, "at {x}");
    }
}

#[test]
fn near_the_goal_behind_a_wall_is_not_at_the_goal() {
    let map = "
        .........
        ....#G...
        ....#....
        ....#....";
    let mut parameters = Parameters::default();
    parameters.schemas.goal_tolerance_m = 2.5;
    let blob = blob(&[map], parameters);
    for (x, expected) in [(3.5, Reason::Driving), (7.5, Reason::AtGoal)] {
        let mut robot = Robot::new(Blob::parse(&blob).unwrap(), x, 2.0);
        assert_eq!(robot.tick_with(|_| {}).reason, expected, "at {x}");
    }
}

/// W29: the choice counts from where the robot is armed, not from where it was switched on.
#[test]
fn w29_a_static_choice_is_made_at_the_start() {
    let free = "......\n.....G";
    let cut = ".#....\n.#...G";
    let blob = blob(&[free, cut], Parameters::default());
    let mut robot = Robot::new(Blob::parse(&blob).unwrap(), 0.5, 0.5);
    let mut layer_at = |x: f32, is_armed: bool| {
        robot.carry_to(x);
        robot.tick_with(|percepts| percepts.operator = Operator { is_armed, ..armed() });
        robot.state.progress.choice.layer()
    };
    assert_eq!(layer_at(0.5, false), Some(0), "provisional");
    assert_eq!(layer_at(2.5, false), Some(1), "provisional");
    assert_eq!(layer_at(2.5, true), Some(1));
    assert_eq!(layer_at(0.5, true), Some(1), "kept");
}
