//! Sensors that lie: what the robot notices, and what it then does.

use crate::bench::{ORIGIN, Robot, ahead, blob, blob_at, open_field};
use math::{Vec2, scalar, vector};
use plan_format::parameters::{Gains, OnNoProgress, Steering};
use plan_format::{Blob, Parameters};
use robot_io::{Checks, Commands, Percepts, Pose, RangeReading, Reason};

pub(crate) const START: (f32, f32) = (10.0, 50.0);
const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

/// A field of 100 m with the goal in the east.
pub(crate) fn field(parameters: Parameters) -> Vec<u8> {
    blob(&[&open_field(100, 100, (90, 50))], parameters)
}

/// Everything that a good robot senses: receiver with time and velocity, odometry, gyroscope,
/// empty scans.
fn complete(robot: &Robot<'_>, last: &Commands, is_held: bool, percepts: &mut Percepts) {
    percepts.speed_mps = Some(last.speed_mps);
    percepts.turn_rate_radps = Some(last.turn_rate_radps);
    percepts.scan_us = Some(percepts.time_us);
    if let Some(fix) = &mut percepts.fix {
        let mmps = if is_held { 0.0 } else { last.speed_mps * 1e3 };
        let velocity = vector::from_angle(robot.heading_rad) * mmps;
        fix.velocity_mmps = Some([velocity.x as i32, velocity.y as i32]);
        fix.receiver_ms = Some((robot.time_us / 1_000) as u32);
    }
}

/// Drives with complete sensors that `change` alters, for `ticks` or to the goal. The body moves as
/// commanded unless `is_held`. Returns the robot and the reason of every tick.
pub(crate) fn drive<'a>(
    blob: &'a [u8],
    ticks: usize,
    is_held: bool,
    mut change: impl FnMut(usize, &mut Percepts),
) -> (Robot<'a>, Vec<Reason>) {
    let blob = Blob::parse(blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, START.0, START.1);
    let mut last = Commands::stop(Reason::NoFix);
    let mut reasons = Vec::new();
    for index in 0..ticks {
        let before = robot.clone();
        last = robot.drive_with(|percepts| {
            complete(&before, &last, is_held, percepts);
            change(index, percepts);
        });
        if is_held {
            (robot.position, robot.heading_rad) = (before.position, before.heading_rad);
        }
        reasons.push(last.reason);
        if last.reason == Reason::AtGoal {
            break;
        }
    }
    (robot, reasons)
}

/// Changes of the reasons, in their order.
pub(crate) fn story(mut reasons: Vec<Reason>) -> Vec<Reason> {
    reasons.dedup();
    reasons
}

/// Repeats the first fix from a tick on, with new arrival times.
fn repeated(from: usize, to: usize) -> impl FnMut(usize, &mut Percepts) {
    let mut first = None;
    move |index, percepts| {
        if (from..to).contains(&index) {
            let fix = *first.get_or_insert(percepts.fix.expect("a fix"));
            percepts.fix = Some(robot_io::Fix { time_us: percepts.time_us, ..fix });
        }
    }
}

#[test]
fn with_complete_sensors_nothing_is_doubted() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 3_000, false, |_, _| {});
    assert_eq!(story(reasons), [Reason::Driving, Reason::AtGoal]);
}

#[test]
fn a_receiver_that_repeats_a_solution_is_found_by_its_own_time() {
    let blob = field(Parameters::default());
    let (robot, reasons) = drive(&blob, 3_000, false, repeated(100, 400));
    assert_eq!(
        story(reasons.clone()),
        [Reason::Driving, Reason::FrozenFix, Reason::Driving, Reason::AtGoal]
    );
    let stopped = reasons.iter().position(|&reason| reason == Reason::FrozenFix).unwrap();
    assert!((140..=143).contains(&stopped), "two seconds after the last good fix: {stopped}");
    assert!(vector::length(robot.position - Vec2::new(90.5, 50.5)) < 1.5);
}

/// A receiver that is off by 30 m from tick 100 to tick 500.
#[test]
fn a_jump_is_never_believed_after_positions_that_were_proved() {
    let blob = field(Parameters::default());
    let (robot, reasons) = drive(&blob, 3_000, false, |index, percepts| {
        if (100..700).contains(&index) {
            percepts.fix.as_mut().expect("a fix").place.lat_e7 += 2_695;
        }
    });
    let expected = [Reason::Driving, Reason::JumpedFix, Reason::Driving, Reason::AtGoal];
    assert_eq!(story(reasons.clone()), expected, "thirty seconds are not enough");
    assert_eq!(reasons.iter().position(|&reason| reason == Reason::JumpedFix), Some(140));
    assert_eq!(reasons[699], Reason::JumpedFix);
    assert!(vector::length(robot.position - Vec2::new(90.5, 50.5)) < 1.5);
}

/// The first fixes are off by 30 m, or the robot is carried that far and armed anew.
#[test]
fn a_jump_away_from_an_unproved_position_is_believed_after_ten_seconds() {
    for (wrong, disarmed) in [(0..3, 9_999..9_999), (0..100, 100..101)] {
        let blob = field(Parameters::default());
        let (_, reasons) = drive(&blob, 400, false, |index, percepts| {
            if wrong.contains(&index) {
                percepts.fix.as_mut().expect("a fix").place.lat_e7 += 2_695;
            }
            percepts.operator.is_armed = !disarmed.contains(&index);
        });
        let mut expected = vec![Reason::Driving, Reason::JumpedFix, Reason::Driving];
        if disarmed.start < 400 {
            expected.splice(1..1, [Reason::Disarmed, Reason::Driving]);
        }
        assert_eq!(story(reasons.clone()), expected, "{wrong:?}");
        let again = reasons.iter().rposition(|&reason| reason == Reason::JumpedFix).unwrap() + 1;
        assert_eq!(again, wrong.end + 200, "{wrong:?}");
    }
}

/// From tick 100 on, what the receiver sends arrives a second later.
#[test]
fn fixes_that_arrive_late_are_found_by_the_time_of_the_receiver() {
    for (late_ticks, has_time, is_found) in [(20, true, true), (4, true, false), (20, false, false)]
    {
        let blob = field(Parameters::default());
        let mut sent = Vec::new();
        let (_, reasons) = drive(&blob, 300, false, |index, percepts| {
            let fix = percepts.fix.as_mut().expect("a fix");
            fix.receiver_ms = fix.receiver_ms.filter(|_| has_time);
            let now_us = fix.time_us;
            sent.push(*fix);
            if index >= 100 {
                let arrived = sent[index.saturating_sub(late_ticks).max(99)];
                // The latest fix keeps the time when it arrived.
                let time_us = if index < 100 + late_ticks { arrived.time_us } else { now_us };
                *fix = robot_io::Fix { time_us, ..arrived };
            }
        });
        let expected: &[Reason] =
            if is_found { &[Reason::Driving, Reason::StaleFix] } else { &[Reason::Driving] };
        assert_eq!(story(reasons), expected, "{late_ticks} {has_time}");
    }
}

/// Leap seconds, receivers that learn the date, and clocks that leap do not make fixes late.
#[test]
fn a_receiver_that_sets_its_time_is_not_late() {
    for (robot_leap_us, receiver_leap_ms) in
        [(0, -2_000), (0, 2_000), (0, -86_000), (100_000_000, 0)]
    {
        let blob = field(Parameters::default());
        let (_, reasons) = drive(&blob, 300, false, |index, percepts| {
            let fix = percepts.fix.as_mut().expect("a fix");
            let ms = 90_000 + fix.receiver_ms.expect("a time") as i32;
            fix.receiver_ms = Some((ms + if index < 100 { 0 } else { receiver_leap_ms }) as u32);
            if index >= 100 {
                fix.time_us += robot_leap_us;
                percepts.time_us += robot_leap_us;
                percepts.scan_us = Some(percepts.time_us);
            }
        });
        assert_eq!(story(reasons), [Reason::Driving], "{robot_leap_us} {receiver_leap_ms}");
    }
}

/// The robot turns as commanded while its clock goes back by a second, or ahead by 100 s.
#[test]
fn a_clock_that_is_set_does_not_make_the_compass_wrong() {
    for set_us in [-1_000_000, 100_000_000] {
        let blob = field(Parameters::default());
        let blob = Blob::parse(&blob).expect("the blob is valid");
        let mut robot = Robot::new(blob, START.0, START.1);
        for tick in 0..60 {
            robot.heading_rad = scalar::wrap_angle(robot.heading_rad + 0.05);
            let mut percepts = Percepts { turn_rate_radps: Some(1.0), ..robot.percepts() };
            if tick >= 40 {
                percepts.time_us = percepts.time_us.saturating_add_signed(set_us);
                percepts.fix = None;
            }
            let blob = robot.blob;
            let sensed = controller::explain(&blob, &mut robot.state, &percepts).sensed;
            assert!(!sensed.is_compass_wrong, "{set_us} {tick}");
            assert_eq!(sensed.heading_rad, Some(robot.heading_rad), "{set_us} {tick}");
            let turn = Commands { turn_rate_radps: 1.0, ..Commands::stop(Reason::Driving) };
            robot.state.track.commanded(&turn);
            robot.time_us += crate::bench::TICK_US;
        }
    }
}

/// Without a time of its own, a frozen receiver is found by the motion; so is one whose time goes
/// on. A velocity of 0 says that the robot stands, and then the wheels turn in place.
#[test]
fn a_position_that_does_not_follow_the_motion_is_found() {
    for (has_time, velocity, expected) in [
        (false, None, Reason::FrozenFix),
        (true, None, Reason::FrozenFix),
        (true, Some([900, 0]), Reason::FrozenFix),
        (true, Some([0, 0]), Reason::NoProgress),
        (false, Some([0, 0]), Reason::FrozenFix),
    ] {
        let blob = field(Parameters::default());
        let mut place = None;
        let (_, reasons) = drive(&blob, 600, false, |index, percepts| {
            let fix = percepts.fix.as_mut().expect("a fix");
            fix.receiver_ms = fix.receiver_ms.filter(|_| has_time);
            if index >= 100 {
                fix.place = *place.get_or_insert(fix.place);
                fix.velocity_mmps = velocity;
            }
        });
        let case = (has_time, velocity);
        assert_eq!(story(reasons.clone()), [Reason::Driving, expected], "{case:?}");
        let stopped = reasons.iter().position(|&reason| reason == expected).unwrap();
        assert!(stopped < 180, "{case:?}: {stopped}");
    }
}

/// The wheels turn in place, or the motors are dead: the fixes waver about one point.
#[test]
fn a_stuck_robot_makes_no_progress() {
    for has_odometry in [true, false] {
        let blob = field(Parameters::default());
        let (_, reasons) = drive(&blob, 600, true, |index, percepts| {
            percepts.fix.as_mut().expect("a fix").place.lat_e7 += (index % 5) as i32;
            percepts.speed_mps = percepts.speed_mps.filter(|_| has_odometry);
        });
        assert_eq!(story(reasons), [Reason::Driving, Reason::NoProgress], "{has_odometry}");
    }
}

#[test]
fn without_progress_the_robot_stops_or_goes_on_as_its_mission_says() {
    let mut parameters = Parameters::default();
    parameters.progress.on_none = OnNoProgress::Continue;
    let blob = field(parameters);
    let (robot, reasons) = drive(&blob, 600, true, |_, _| {});
    assert_eq!(story(reasons), [Reason::Driving]);
    assert!(robot.state.stuck.is_none(), "it is noticed all the same");
}

/// A new order to arm is a new attempt.
#[test]
fn disarming_ends_the_stop_for_want_of_progress() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 130, true, |index, percepts| {
        percepts.operator.is_armed = index != 120;
    });
    let expected = [Reason::Driving, Reason::NoProgress, Reason::Disarmed, Reason::Driving];
    assert_eq!(story(reasons), expected);
}

/// A compass that is frozen, or off by a constant angle, from a tick on.
#[test]
fn a_wrong_compass_is_found_by_course_and_turn_rate() {
    let offset = |by: f32| move |_: f32, heading: f32| heading + by;
    let frozen = |first: f32, _: f32| first;
    type Compass<'a> = &'a dyn Fn(f32, f32) -> f32;
    let cases: [(&str, Compass<'_>); 5] = [
        ("frozen", &frozen),
        ("0.8 rad to the left", &offset(0.8)),
        ("0.8 rad to the right", &offset(-0.8)),
        ("a quarter", &offset(QUARTER)),
        ("reversed", &offset(2.0 * QUARTER)),
    ];
    for (name, wrong) in cases {
        for from in [0, 100] {
            let blob = field(Parameters::default());
            let mut first = None;
            let (robot, reasons) = drive(&blob, 4_000, false, |index, percepts| {
                let heading = percepts.heading_rad.expect("a heading");
                if index >= from {
                    let first = *first.get_or_insert(heading);
                    percepts.heading_rad = Some(wrong(first, heading));
                }
            });
            let expected = [Reason::Driving, Reason::AtGoal];
            assert_eq!(story(reasons), expected, "{name} from {from}: {:?}", robot.position);
        }
    }
}

/// Without a receiver that shows the course, a compass that is known to be wrong stops the robot.
#[test]
fn a_frozen_compass_without_a_course_stops_the_robot() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 1_000, false, |_, percepts| {
        percepts.fix.as_mut().expect("a fix").velocity_mmps = None;
        percepts.heading_rad = Some(1.0);
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::WrongHeading]);
}

/// A boat drifts: its course differs from its heading, and the compass is right.
#[test]
fn the_drift_of_a_boat_is_not_held_against_its_compass() {
    let mut parameters = Parameters::default();
    parameters.vehicle.steering = Steering::Boat;
    let blob = field(parameters);
    let (_, reasons) = drive(&blob, 3_000, false, |_, percepts| {
        let fix = percepts.fix.as_mut().expect("a fix");
        fix.velocity_mmps = fix.velocity_mmps.map(|[east, north]| [east, north + 1_500]);
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::AtGoal]);
}

/// Somebody turns the robot, which has no gyroscope; or the compass leaps and comes back.
#[test]
fn a_leap_of_the_compass_is_believed_if_it_lasts_and_nothing_contradicts_it() {
    let blob = field(Parameters::default());
    let blob = Blob::parse(&blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, START.0, START.1);
    let mut heading_after = |ticks: usize, compass_rad: f32| {
        let mut sensed = None;
        for _ in 0..ticks {
            let percepts = Percepts { heading_rad: Some(compass_rad), ..robot.percepts() };
            robot.time_us += crate::bench::TICK_US;
            let blob = robot.blob;
            sensed = controller::explain(&blob, &mut robot.state, &percepts).sensed.heading_rad;
            // Nothing turns the robot.
            robot.state.track.commanded(&Commands::stop(Reason::Driving));
        }
        sensed
    };
    assert_eq!(heading_after(10, 0.5), Some(0.5));
    assert_eq!(heading_after(10, 2.0), Some(0.5), "a leap of half a second");
    assert_eq!(heading_after(10, 0.5), Some(0.5));
    assert_eq!(heading_after(70, 2.0), Some(0.5));
    assert_eq!(heading_after(20, 2.0), Some(2.0), "it has stayed there for four seconds");
}

#[test]
fn scans_that_stay_the_same_while_the_robot_moves_are_frozen() {
    let blob = field(Parameters::default());
    let post = RangeReading { bearing_rad: 2.0, distance_m: 6.0 };
    let scan = |moves: bool| {
        move |index: usize, percepts: &mut Percepts| {
            let distance_m = if moves { 6.0 + 0.001 * (index % 3) as f32 } else { 6.0 };
            percepts.ranges = [RangeReading { distance_m, ..post }].into_iter().collect();
        }
    };
    let (_, reasons) = drive(&blob, 300, false, scan(true));
    assert_eq!(story(reasons), [Reason::Driving]);
    let (robot, reasons) = drive(&blob, 300, false, scan(false));
    assert_eq!(story(reasons), [Reason::Driving, Reason::FaultyRanges]);
    assert!(robot.position.x < START.0 + 4.0, "{:?}", robot.position);
    // A robot that stands sees the same thing.
    let (_, reasons) = drive(&blob, 300, true, |index, percepts| {
        scan(false)(index, percepts);
        percepts.operator.is_armed = index > 250;
    });
    assert_eq!(reasons[251], Reason::Driving);
}

/// Eight posts around the robot's way, as a range finder with noise sees them from `at`.
fn posts(at: Vec2, heading_rad: f32, index: usize) -> Vec<RangeReading> {
    const POSTS: [(f32, f32); 8] = [
        (16.4, 50.7),
        (14.0, 55.0),
        (9.0, 56.0),
        (5.0, 54.0),
        (4.0, 50.5),
        (6.0, 46.0),
        (11.0, 44.0),
        (15.0, 46.0),
    ];
    let seen = POSTS.iter().map(|&(x, y)| {
        let to = vector::rotated(Vec2::new(x, y) - at, -heading_rad);
        let noise_m = 0.001 * (index % 3) as f32;
        RangeReading { bearing_rad: vector::angle(to), distance_m: vector::length(to) + noise_m }
    });
    seen.collect()
}

/// Drives 150 ticks among [`posts`]; `change` alters the scan of a tick and its time. Returns the
/// changes of the reasons and how far the robot came after tick 50.
fn among_posts(
    mut change: impl FnMut(usize, &[Vec<RangeReading>], &mut Percepts),
) -> (Vec<Reason>, f32) {
    let blob = field(Parameters::default());
    let blob = Blob::parse(&blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, START.0, START.1);
    let (mut reasons, mut scans, mut from_m) = (Vec::new(), Vec::new(), 0.0);
    for index in 0..150 {
        scans.push(posts(robot.position, robot.heading_rad, index));
        let commands = robot.drive_with(|percepts| {
            percepts.ranges = scans[index].iter().copied().collect();
            percepts.scan_us = Some(percepts.time_us);
            change(index, &scans, percepts);
        });
        reasons.push(commands.reason);
        if index == 50 {
            from_m = robot.position.x;
        }
    }
    (story(reasons), robot.position.x - from_m)
}

#[test]
fn posts_that_are_passed_raise_no_doubt() {
    assert_eq!(among_posts(|_, _, _| {}).0, [Reason::Driving]);
    // Every third scan arrives.
    let (reasons, _) = among_posts(|index, scans, percepts| {
        let last = index - index % 3;
        percepts.ranges = scans[last].iter().copied().collect();
        percepts.scan_us = percepts.scan_us.map(|us| us - 50_000 * (index - last) as u64);
    });
    assert_eq!(reasons, [Reason::Driving]);
}

/// From tick 50 on the range finder measures half a metre too much; from tick 100 on it is right.
#[test]
fn ranges_that_leap_together_are_wrong_until_they_leap_back() {
    for (by_m, until, expected) in [
        (0.5, 999, &[Reason::Driving, Reason::FaultyRanges][..]),
        (-0.5, 999, &[Reason::Driving, Reason::FaultyRanges]),
        (0.5, 100, &[Reason::Driving, Reason::FaultyRanges, Reason::Driving]),
        (0.1, 999, &[Reason::Driving]),
    ] {
        let (reasons, came_m) = among_posts(|index, _, percepts| {
            if (50..until).contains(&index) {
                percepts.ranges.iter_mut().for_each(|reading| reading.distance_m += by_m);
            }
        });
        assert_eq!(reasons, expected, "{by_m} m until {until}");
        assert!(expected != [Reason::Driving, Reason::FaultyRanges] || came_m < 0.1, "{came_m} m");
    }
    // One obstacle that comes out from behind another has not leapt.
    let (reasons, _) = among_posts(|index, _, percepts| {
        if index >= 50 {
            percepts.ranges[0].distance_m += 0.5;
        }
    });
    assert_eq!(reasons, [Reason::Driving]);
}

/// A range finder with noise that repeats a scan is frozen long before two metres.
#[test]
fn a_noisy_range_finder_that_freezes_is_found_soon() {
    let (reasons, came_m) = among_posts(|index, scans, percepts| {
        percepts.ranges = scans[index.min(50)].iter().copied().collect();
    });
    assert_eq!(reasons, [Reason::Driving, Reason::FaultyRanges]);
    assert!(came_m < 0.5, "{came_m} m");
}

/// Some scans in the open are empty, and a garbled one among them may look sound.
#[test]
fn garbled_scans_stop_the_robot_until_as_many_were_sound() {
    let (reasons, _) = among_posts(|index, _, percepts| match index {
        50..100 if index % 4 == 0 => percepts.ranges.clear(),
        50..100 if index % 4 != 1 => percepts.garbled_ranges = 1,
        _ => {}
    });
    assert_eq!(reasons, [Reason::Driving, Reason::FaultyRanges, Reason::Driving]);
    let (reasons, _) = among_posts(|index, _, percepts| {
        percepts.garbled_ranges = u8::from(index % 5 == 1);
    });
    assert_eq!(reasons, [Reason::Driving], "a few are tolerated");
}

/// While scans are missing, the last one moves along with the robot.
#[test]
fn old_readings_are_where_the_obstacles_are_now() {
    let blob = field(Parameters::default());
    let blob = Blob::parse(&blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, START.0, START.1);
    let scan = posts(robot.position, robot.heading_rad, 0);
    let scan_us = Some(robot.time_us);
    for tick in 0..9 {
        let mut percepts = Percepts {
            ranges: scan.iter().copied().collect(),
            scan_us,
            speed_mps: Some(1.5),
            turn_rate_radps: Some(1.0),
            ..robot.percepts()
        };
        let blob = robot.blob;
        controller::explain(&blob, &mut robot.state, &percepts);
        robot.state.track.correct(&mut percepts);
        let expected = posts(robot.position, robot.heading_rad, 0);
        for (reading, expected) in percepts.ranges.iter().zip(expected) {
            let at = |r: &RangeReading| vector::from_angle(r.bearing_rad) * r.distance_m;
            let off_m = vector::length(at(reading) - at(&expected));
            assert!(off_m < 0.1, "tick {tick}: {reading:?} {expected:?}");
        }
        robot.time_us += crate::bench::TICK_US;
        let step = vector::from_angle(robot.heading_rad + 0.025) * 0.075;
        robot.position += step;
        robot.heading_rad += 0.05;
    }
}

#[test]
fn absent_silent_and_clear_ranges_differ() {
    let mut required = Parameters::default();
    required.ranges.is_required = true;
    // required, scans arrive, they end at tick 100
    for (is_required, has_ranges, ends, expected) in [
        (false, false, false, &[Reason::Driving][..]),
        (true, false, false, &[Reason::SilentRanges]),
        (true, true, false, &[Reason::Driving]),
        (false, true, true, &[Reason::Driving, Reason::SilentRanges]),
    ] {
        let blob = field(if is_required { required } else { Parameters::default() });
        let mut last_us = None;
        let (_, reasons) = drive(&blob, 200, false, |index, percepts| {
            if index < 100 || !ends {
                last_us = Some(percepts.time_us).filter(|_| has_ranges);
            }
            percepts.scan_us = last_us;
        });
        assert_eq!(story(reasons), expected, "{is_required} {has_ranges} {ends}");
    }
}

#[test]
fn a_clock_that_stands_stops_the_robot() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 200, false, |index, percepts| {
        if (100..150).contains(&index) {
            percepts.time_us = 6_000_000;
        }
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::ClockStopped, Reason::Driving]);
}

/// A clock that stands at every second tick is wrong within 10 s; one at every fifth tick is merely
/// coarse.
#[test]
fn a_clock_that_stands_at_every_second_tick_stops_the_robot() {
    for (every, is_wrong) in [(2, true), (5, false)] {
        let blob = field(Parameters::default());
        let (_, reasons) = drive(&blob, 300, false, |index, percepts| {
            if index >= 100 && index % every == 0 {
                percepts.time_us -= crate::bench::TICK_US;
                percepts.scan_us = Some(percepts.time_us);
            }
        });
        assert_eq!(reasons[299] == Reason::ClockStopped, is_wrong, "{every}: {:?}", reasons[299]);
    }
}

/// Set once, a clock is right again; one that shows any time is not.
#[test]
fn a_clock_that_leaps_again_and_again_stops_the_robot() {
    for (leaps, is_wrong) in [(1, false), (40, true)] {
        let blob = field(Parameters::default());
        let (_, reasons) = drive(&blob, 140, false, |index, percepts| {
            if (100..100 + leaps).contains(&index) {
                percepts.time_us = 1_000_000 * (index as u64 * 7_919 % 5_003);
            }
        });
        assert_eq!(reasons[139] == Reason::ClockStopped, is_wrong, "{leaps}: {:?}", reasons[139]);
    }
}

/// The range finder leaps by half a metre; then the clock is set back. The readings are still wrong.
#[test]
fn a_clock_that_is_set_back_does_not_make_a_sensor_right_again() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 200, false, |index, percepts| {
        let off_m = if index >= 100 { 0.5 } else { 0.0 };
        percepts.ranges = (0..6)
            .map(|sector| RangeReading {
                bearing_rad: sector as f32 * 0.8 - 2.0,
                distance_m: 5.0 + off_m,
            })
            .collect();
        // A part of the noise that every range finder has.
        percepts.ranges[0].distance_m += 0.01 * (index % 3) as f32;
        let set_back_us = if index >= 150 { 3_000_000 } else { 0 };
        percepts.time_us -= set_back_us;
        percepts.scan_us = Some(percepts.time_us);
        percepts.fix = percepts.fix.map(|fix| robot_io::Fix { time_us: percepts.time_us, ..fix });
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::FaultyRanges]);
}

/// The last scan before the range finder falls silent has a time stamp of the future, as after a clock
/// that was set back: it becomes too old all the same.
#[test]
fn a_scan_with_a_time_stamp_of_the_future_is_one_scan() {
    let blob = field(Parameters::default());
    let (_, reasons) = drive(&blob, 200, false, |index, percepts| {
        let silent_from = 1_000_000 + 100 * crate::bench::TICK_US;
        percepts.scan_us =
            Some(if index < 100 { percepts.time_us } else { silent_from + 60_000_000 });
    });
    assert_eq!(story(reasons), [Reason::Driving, Reason::SilentRanges]);
}

/// From tick 60 on the odometry is off, frozen, or any number; the receiver reports the truth.
#[test]
fn odometry_that_contradicts_commands_and_receiver_does_not_count() {
    type Wrong<'a> = &'a dyn Fn(usize, f32, f32) -> f32;
    let offset = |_: usize, _: f32, speed: f32| speed + 0.5;
    let frozen = |_: usize, first: f32, _: f32| first;
    let garbled = |index: usize, _: f32, _: f32| [0.0, 1.9, -1.2, 0.01, 1e9][index * 7 % 5];
    let cases: [(&str, Wrong<'_>); 3] =
        [("offset", &offset), ("frozen", &frozen), ("garbled", &garbled)];
    for (name, wrong) in cases {
        let blob = field(Parameters::default());
        let blob = Blob::parse(&blob).expect("the blob is valid");
        let mut robot = Robot::new(blob, START.0, START.1);
        let (mut last, mut first) = (Commands::stop(Reason::NoFix), None);
        for index in 0..300 {
            let before = robot.clone();
            let commanded_mps = last.speed_mps;
            last = robot.drive_with(|percepts| {
                complete(&before, &last, false, percepts);
                let speed = percepts.speed_mps.expect("odometry");
                if index >= 60 {
                    let first = *first.get_or_insert(speed);
                    percepts.speed_mps = Some(wrong(index, first, speed));
                }
                // The robot starts and stops.
                percepts.ranges = [].into_iter().collect();
                if index % 100 > 70 {
                    percepts.ranges = [ahead(0.4)].into_iter().collect();
                }
            });
            // Twenty ticks after a start or a stop.
            if index > 160 && (20..70).contains(&(index % 100)) {
                let mut percepts = robot.percepts();
                percepts.speed_mps = Some(9.0);
                robot.state.track.correct(&mut percepts);
                let off_mps = percepts.speed_mps.expect("odometry") - commanded_mps;
                assert!(off_mps.abs() < 0.35, "{name} {index}: {off_mps} m/s");
            }
        }
    }
}

/// Neither odometry nor fixes show what is commanded.
#[test]
fn motors_that_do_not_answer_are_found_in_seconds() {
    for noise_m in [0, 5] {
        let blob = field(Parameters::default());
        let (_, reasons) = drive(&blob, 300, false, |_, _| {});
        assert_eq!(story(reasons), [Reason::Driving]);
        let (_, reasons) = drive(&blob, 300, true, |index, percepts| {
            percepts.fix.as_mut().expect("a fix").place.lat_e7 += noise_m * (index % 5) as i32;
            (percepts.speed_mps, percepts.turn_rate_radps) = (Some(0.0), Some(0.0));
        });
        assert_eq!(story(reasons.clone()), [Reason::Driving, Reason::NoProgress]);
        let stopped = reasons.iter().position(|&reason| reason == Reason::NoProgress).unwrap();
        assert!(stopped < 70, "{stopped}");
    }
}

/// The receiver claims velocities and never gives a course.
#[test]
fn creeping_for_a_heading_ends() {
    let blob = field(Parameters::default());
    let blind = |_: usize, percepts: &mut Percepts| {
        percepts.heading_rad = None;
        percepts.fix.as_mut().expect("a fix").velocity_mmps = Some([0, 0]);
    };
    let (robot, reasons) = drive(&blob, 600, false, blind);
    assert_eq!(story(reasons.clone()), [Reason::NoHeading]);
    let crept_m = robot.position.x - START.0;
    assert!((8.0..9.5).contains(&crept_m), "{crept_m} m");
    assert!(robot.state.checks().has(Checks::HEADING));
}

fn pose(robot: &Robot<'_>) -> Pose {
    Pose {
        time_us: robot.time_us,
        position_m: robot.position.into(),
        heading_rad: Some(robot.heading_rad),
        accuracy_mm: 20,
    }
}

/// Drives to the goal by poses, on a map without a place on the globe.
#[test]
fn poses_replace_fixes_and_need_no_place_on_the_globe() {
    let map = open_field(30, 30, (25, 15));
    for (origin, period) in [(None, 1), (None, 10), (Some(ORIGIN), 4)] {
        let blob = blob_at(&[&map], Parameters::default(), origin);
        let blob = Blob::parse(&blob).expect("the blob is valid");
        let mut robot = Robot::new(blob, 3.0, 15.0);
        let mut latest = None;
        let arrived = (0..2_000).any(|tick| {
            if tick % period == 0 {
                latest = Some(pose(&robot));
            }
            let change = |percepts: &mut Percepts| {
                (percepts.fix, percepts.heading_rad, percepts.pose) = (None, None, latest);
            };
            robot.drive_with(change).reason == Reason::AtGoal
        });
        assert!(arrived, "{origin:?} every {period} ticks: {:?}", robot.position);
    }
}

#[test]
fn poses_win_over_fixes_while_they_are_fresh_and_are_judged_like_them() {
    let blob = field(Parameters::default());
    let blob = Blob::parse(&blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, 20.0, 50.0);
    let mut latest = pose(&robot);
    let mut look = |robot: &mut Robot<'_>, ticks: usize, change: &dyn Fn(&mut Pose)| {
        for _ in 0..ticks {
            latest.time_us = robot.time_us;
            change(&mut latest);
            // The fixes are 3 m off.
            robot.tick_with(|percepts| {
                percepts.pose = Some(latest);
                let at = Vec2::new(23.0, 50.0);
                percepts.fix.as_mut().unwrap().place =
                    blob.map_frame().expect("an origin").to_geodetic(at);
                percepts.operator.is_armed = false;
            });
        }
        let mut state = robot.state.clone();
        let percepts = Percepts { time_us: robot.time_us, ..Percepts::default() };
        let sensed = controller::explain(&blob, &mut state, &percepts).sensed;
        sensed.position.map(|position| position.x.round())
    };
    assert_eq!(look(&mut robot, 10, &|_| {}), Ok(20.0), "the pose wins");
    assert_eq!(look(&mut robot, 10, &|pose| pose.accuracy_mm = 6_000), Ok(20.0), "not stale yet");
    assert_eq!(look(&mut robot, 40, &|_| {}), Ok(23.0), "the fix takes over");
    assert_eq!(look(&mut robot, 1, &|pose| pose.accuracy_mm = 20), Ok(20.0), "and back");
}

#[test]
fn a_map_without_a_place_and_poses_that_end_say_so() {
    let blob = blob_at(&[&open_field(30, 30, (25, 15))], Parameters::default(), None);
    let blob = Blob::parse(&blob).expect("the blob is valid");
    let mut robot = Robot::new(blob, 3.0, 15.0);
    let mut reason_at = |pose: Option<Pose>, ticks: usize| {
        let tick = |_| robot.tick_with(|percepts| percepts.pose = pose).reason;
        (0..ticks).map(tick).last()
    };
    assert_eq!(reason_at(None, 5), Some(Reason::NoOrigin));
    let pose = Pose {
        time_us: 1_250_000,
        position_m: [3.0, 15.0],
        heading_rad: Some(0.0),
        accuracy_mm: 20,
    };
    assert_eq!(reason_at(Some(pose), 1), Some(Reason::Driving));
    assert_eq!(reason_at(Some(pose), 50), Some(Reason::StaleFix));
    let poor = Pose { time_us: 4_000_000, accuracy_mm: 9_000, ..pose };
    assert_eq!(reason_at(Some(poor), 1), Some(Reason::PoorFix));
}

/// An obstacle that blocks the way is not a want of progress: the robot waits until it is gone.
#[test]
fn waiting_before_an_obstacle_is_not_a_want_of_progress() {
    let gains = Gains { noise: 0.0, ..Gains::PLAN_ONLY };
    let blend = plan_format::parameters::Blend::Paper;
    let parameters = Parameters { gains, blend, ..Parameters::default() };
    let blob = field(parameters);
    let (_, reasons) = drive(&blob, 3_000, true, |index, percepts| {
        percepts.ranges = [ahead(0.31 + 1e-4 * (index % 3) as f32)].into_iter().collect();
    });
    assert_eq!(story(reasons), [Reason::ObstacleStop]);
}
