//! Position and heading from the sensors, and how long they count.

use crate::bench::{ORIGIN, TICK_US, armed, blob_at, open_field};
use controller::sense::{Sensed, Track, sense};
use math::{Vec2, scalar};
use plan_format::parameters::Steering;
use plan_format::{Blob, Origin, Parameters};
use robot_io::{Commands, Fix, Percepts, Reason};

const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

/// A track, and a clock that advances by a tick at each look.
struct Watch<'a> {
    blob: Blob<'a>,
    track: Track,
    time_us: u64,
}

impl<'a> Watch<'a> {
    fn new(origin: Origin) -> Self {
        let goal = Some(Vec2::new(50.0, 50.0));
        let blob = Blob::without_map(Parameters::default(), Some(origin), goal);
        Self { blob, track: Track::default(), time_us: 10_000_000 }
    }

    fn fix(&self, x: f32, y: f32) -> Fix {
        let frame = self.blob.map_frame().expect("there is an origin");
        Fix {
            time_us: self.time_us,
            is_valid: true,
            place: frame.to_geodetic(Vec2::new(x, y)),
            accuracy_mm: 100,
            velocity_mmps: None,
            receiver_ms: None,
        }
    }

    fn look(&mut self, percepts: Percepts) -> Sensed {
        let percepts = Percepts { time_us: self.time_us, ..percepts };
        self.time_us += TICK_US;
        sense(&self.blob, &mut self.track, &percepts)
    }
}

fn near(position: Result<Vec2, Reason>, x: f32, y: f32) -> bool {
    position.is_ok_and(|position| (position - Vec2::new(x, y)).amax() < 0.03)
}

#[test]
fn between_fixes_the_position_is_carried_on() {
    let mut watch = Watch::new(ORIGIN);
    let fix = Some(watch.fix(5.0, 5.0));
    let moving =
        Percepts { fix, heading_rad: Some(0.0), speed_mps: Some(2.0), ..Percepts::default() };
    assert!(near(watch.look(moving.clone()).position, 5.0, 5.0));
    for tick in 1..=20 {
        let sensed = watch.look(moving.clone());
        assert!(near(sensed.position, 5.0 + 0.1 * tick as f32, 5.0), "{tick}: {sensed:?}");
    }
}

#[test]
fn a_turn_is_carried_on_along_its_arc() {
    let mut watch = Watch::new(ORIGIN);
    let fix = Some(watch.fix(0.0, 0.0));
    watch.look(Percepts { fix, heading_rad: Some(0.0), ..Percepts::default() });
    // A quarter of a circle of 1 m radius takes 31.4 ticks at these speeds.
    let turning =
        Percepts { fix, speed_mps: Some(1.0), turn_rate_radps: Some(1.0), ..Percepts::default() };
    let last = (0..31).map(|_| watch.look(turning.clone())).last().unwrap();
    assert!(near(last.position, scalar::sin(1.55), 1.0 - scalar::cos(1.55)), "{last:?}");
    assert!((last.heading_rad.unwrap() - 1.55).abs() < 1e-3);
}

#[test]
fn without_odometry_the_last_commands_stand_in() {
    let mut watch = Watch::new(ORIGIN);
    let fix = Some(watch.fix(5.0, 5.0));
    watch.look(Percepts { fix, heading_rad: Some(QUARTER), ..Percepts::default() });
    let commands = Commands { speed_mps: 1.0, ..Commands::stop(Reason::Driving) };
    watch.track.commanded(&commands);
    let sensed = watch.look(Percepts { fix, ..Percepts::default() });
    assert!(near(sensed.position, 5.0, 5.05), "{sensed:?}");
}

/// Heading sources in order of rank: the compass, the velocity of the fix (mm/s east, north),
/// the heading known before. The map is turned by a quarter.
#[test]
fn headings_come_from_compass_then_course_then_turn_rate() {
    let turned = Origin { heading_rad: f64::from(QUARTER), ..ORIGIN };
    // compass, velocity, odometry, known before (map axes), expected (map axes)
    let table = [
        (Some(0.3), None, None, None, Some(0.3 + QUARTER)),
        (Some(0.3), Some([0, 2000]), None, None, Some(0.3 + QUARTER)),
        (None, Some([700, 0]), None, None, Some(QUARTER)),
        (None, Some([0, 700]), None, Some(0.1), Some(-2.0 * QUARTER)),
        (None, Some([700, 0]), Some(-0.6), None, Some(-QUARTER)),
        (None, Some([400, 0]), None, None, None),
        (None, Some([400, 0]), None, Some(0.1), Some(0.15)),
        (None, None, None, Some(0.1), Some(0.15)),
        (None, None, None, None, None),
    ];
    for (compass, velocity, odometry, before, expected) in table {
        let mut watch = Watch::new(turned);
        let known = before.map(|heading: f32| scalar::wrap_angle(heading - QUARTER));
        watch.look(Percepts { heading_rad: known, ..Percepts::default() });
        let fix = Fix { velocity_mmps: velocity, ..watch.fix(1.0, 1.0) };
        let sensed = watch.look(Percepts {
            fix: Some(fix),
            heading_rad: compass,
            speed_mps: odometry,
            turn_rate_radps: Some(1.0),
            ..Percepts::default()
        });
        let case = (compass, velocity, odometry, before);
        match (sensed.heading_rad, expected) {
            (None, None) => {}
            (Some(is), Some(should)) => {
                assert!(
                    scalar::wrap_angle(is - should).abs() < 5e-3,
                    "{case:?}: {is} not {should}"
                );
            }
            other => panic!("{case:?}: {other:?}"),
        }
    }
}

/// fusioncore 109, ArduPilot 31376: the antenna of a robot that turns on the spot moves sideways. That is
/// not its course; the turn rate carries the heading on.
#[test]
fn a_turn_on_the_spot_shows_no_course() {
    let heading = |turn_rate_radps: f32| {
        let mut watch = Watch::new(ORIGIN);
        watch.look(Percepts { heading_rad: Some(0.0), ..Percepts::default() });
        let fix = Fix { velocity_mmps: Some([0, 700]), ..watch.fix(1.0, 1.0) };
        let turn_rate_radps = Some(turn_rate_radps);
        watch.look(Percepts { fix: Some(fix), turn_rate_radps, ..Percepts::default() }).heading_rad
    };
    let is_near = |heading_rad: Option<f32>, expected: f32| {
        heading_rad.is_some_and(|heading_rad| (heading_rad - expected).abs() < 5e-3)
    };
    assert!(is_near(heading(1.0), QUARTER), "a wide arc");
    assert!(is_near(heading(2.6), 2.6 * 0.05) && is_near(heading(-2.6), -2.6 * 0.05));
}

/// A receiver that sends GGA before RMC completes the position with its velocity in a later tick, with the
/// same time. The robot has no compass.
#[test]
fn a_velocity_that_comes_after_its_position_gives_the_course() {
    let mut watch = Watch::new(ORIGIN);
    let mut look = |velocity_mmps| {
        let receiver_ms = Some((watch.time_us / 1_000_000 * 1_000) as u32);
        let fix = Some(Fix { velocity_mmps, receiver_ms, ..watch.fix(1.0, 1.0) });
        watch.look(Percepts { fix, ..Percepts::default() })
    };
    assert_eq!(look(None).heading_rad, None);
    let completed = look(Some([0, 700]));
    assert!(completed.heading_rad.is_some_and(|rad| (rad - QUARTER).abs() < 5e-3));
    assert!(near(completed.position, 1.0, 1.0));
    // Once more with another velocity: the receiver repeats itself.
    assert_eq!(look(Some([700, 0])).heading_rad, completed.heading_rad);
}

/// Five good positions in a row prove where the robot is; five among others that jump do not. Then the
/// other place is believed once it has been consistent for ten seconds.
#[test]
fn positions_between_jumps_do_not_prove_the_first_place() {
    for (before, is_proved) in [(6, true), (0, false)] {
        let mut watch = Watch::new(ORIGIN);
        let mut last = |x: f32, count: u32| {
            let look = |_: u32| {
                watch.time_us += 200_000;
                let fix = Some(watch.fix(x, 0.0));
                watch.look(Percepts { fix, operator: armed(), ..Percepts::default() }).position
            };
            (0..count).map(look).last()
        };
        last(0.0, before);
        for _ in 0..6 {
            last(0.0, 1);
            last(100.0, 1);
        }
        let other = last(100.0, 60).expect("there are positions");
        assert_eq!(near(other, 100.0, 0.0), !is_proved, "{before}: {other:?}");
    }
}

#[test]
fn w14_a_jump_is_believed_once_time_explains_it() {
    let mut watch = Watch::new(ORIGIN);
    let mut position_after = |x: f32, seconds: f32| {
        watch.time_us += (seconds * 1e6) as u64;
        let fix = Some(watch.fix(x, 0.0));
        let Sensed { position, .. } = watch.look(Percepts { fix, ..Percepts::default() });
        position.map(|position| position.x.round())
    };
    assert_eq!(position_after(0.0, 0.0), Ok(0.0));
    assert_eq!(position_after(10.0, 0.5), Ok(0.0), "10 m in half a second: refused");
    assert_eq!(position_after(0.5, 0.5), Ok(1.0), "back again");
    assert_eq!(position_after(10.0, 1.0), Ok(10.0), "9.5 m in a second: believed");
    assert_eq!(position_after(110.0, 7.0), Ok(110.0), "100 m in 7 s");
    assert_eq!(position_after(10.0, 1.0), Ok(110.0), "100 m in a second");
    assert_eq!(position_after(10.0, 3.0), Err(Reason::JumpedFix));
    assert_eq!(
        position_after(10.0, 3.0),
        Err(Reason::JumpedFix),
        "time alone does not explain it now"
    );
    assert_eq!(position_after(10.0, 3.0), Err(Reason::JumpedFix));
    assert_eq!(position_after(10.0, 1.0), Ok(10.0), "it has been there for 10 s");
}

/// Whatever the limit on jumps: a wrong first fix is a matter of seconds.
#[test]
fn a_wrong_first_fix_never_locks_the_robot_out() {
    for (max_jump_mps, wrong_m) in [(0.1, 15_000.0), (1.0, 300.0), (15.0, 15_000.0)] {
        let mut parameters = Parameters::default();
        parameters.fixes.max_jump_mps = max_jump_mps;
        let blob = Blob::without_map(parameters, Some(ORIGIN), None);
        let mut watch = Watch { blob, ..Watch::new(ORIGIN) };
        let fix = Some(watch.fix(wrong_m, 0.0));
        assert!(watch.look(Percepts { fix, ..Percepts::default() }).position.is_ok());
        let seconds = (0..1_000).find(|_| {
            let fix = Some(watch.fix(5.0, 5.0));
            near(watch.look(Percepts { fix, ..Percepts::default() }).position, 5.0, 5.0)
        });
        let ticks = seconds.expect("the true fixes win");
        assert!((190..=220).contains(&ticks), "{max_jump_mps} m/s: {ticks} ticks");
    }
}

/// Reflections that move about are never consistent, so they never become the position.
#[test]
fn jumps_to_different_places_are_never_believed() {
    let mut watch = Watch::new(ORIGIN);
    let fix = Some(watch.fix(0.0, 0.0));
    watch.look(Percepts { fix, ..Percepts::default() });
    for tick in 0..2_000 {
        let fix = Some(watch.fix(500.0 + (tick % 7) as f32 * 300.0, 0.0));
        let position = watch.look(Percepts { fix, ..Percepts::default() }).position;
        assert!(near(position, 0.0, 0.0) || position == Err(Reason::JumpedFix), "{position:?}");
    }
}

#[test]
fn a_refused_fix_does_not_renew_the_last_good_one() {
    let mut watch = Watch::new(ORIGIN);
    let fix = Some(watch.fix(0.0, 0.0));
    watch.look(Percepts { fix, ..Percepts::default() });
    for _ in 0..40 {
        let poor = Some(Fix { is_valid: false, ..watch.fix(0.0, 0.0) });
        assert!(watch.look(Percepts { fix: poor, ..Percepts::default() }).position.is_ok());
    }
    let poor = Some(Fix { is_valid: false, ..watch.fix(0.0, 0.0) });
    let sensed = watch.look(Percepts { fix: poor, ..Percepts::default() });
    assert_eq!(sensed.position, Err(Reason::PoorFix));
}

/// A frozen receiver or a wrong time stamp must not look like a new fix.
#[test]
fn fixes_age_whatever_their_time_stamps_say() {
    for stamp_us in [0, 9_000_000, 10_000_000, 11_000_000, u64::MAX] {
        let mut watch = Watch::new(ORIGIN);
        let fix = Some(Fix { time_us: stamp_us, ..watch.fix(0.0, 0.0) });
        let usable = (0..50)
            .filter(|_| watch.look(Percepts { fix, ..Percepts::default() }).position.is_ok());
        let expected = match stamp_us {
            0 => 0,
            9_000_000 => 21,
            _ => 41,
        };
        assert_eq!(usable.count(), expected, "stamped {stamp_us}");
    }
}

#[test]
fn a_clock_that_runs_backwards_starts_a_new_history() {
    let mut watch = Watch::new(ORIGIN);
    let fix = Some(watch.fix(0.0, 0.0));
    assert!(watch.look(Percepts { fix, ..Percepts::default() }).position.is_ok());
    watch.time_us = 5_000_000;
    let sensed = watch.look(Percepts { fix, ..Percepts::default() });
    assert_eq!(sensed.position, Err(Reason::NoFix));
    let fix = Some(watch.fix(0.0, 0.0));
    assert!(watch.look(Percepts { fix, ..Percepts::default() }).position.is_ok());
}

#[test]
fn a_map_without_a_place_on_the_globe_has_no_positions() {
    let blob = blob_at(&[&open_field(3, 3, (1, 1))], Parameters::default(), None);
    let blob = Blob::parse(&blob).unwrap();
    let sensed = sense(&blob, &mut Track::default(), &Percepts::default());
    assert_eq!((sensed.position, sensed.heading_rad), (Err(Reason::NoOrigin), None));
}

/// A robot that is stuck is commanded to turn, and its gyroscope reports nonsense. The compass shows the
/// truth, so it is right.
#[test]
fn a_gyroscope_that_leaps_does_not_condemn_the_compass() {
    let mut watch = Watch::new(ORIGIN);
    for tick in 0..80_u16 {
        let turn = Commands { turn_rate_radps: 1.0, ..Commands::stop(Reason::Driving) };
        watch.track.commanded(&turn);
        let turn_rate_radps = Some(if tick.is_multiple_of(2) { 3.2 } else { -3.2 });
        let fix = Some(watch.fix(5.0, 5.0));
        let heading_rad = Some(0.3);
        let sensed = watch.look(Percepts {
            fix,
            heading_rad,
            turn_rate_radps,
            operator: armed(),
            ..Percepts::default()
        });
        assert!(!sensed.is_compass_wrong, "{tick}");
    }
}

/// The course contradicts the compass by a quarter turn. That proves the compass wrong after three
/// seconds (the first course counts as one), but not on a boat, which drifts, and not where the
/// robot is carried.
#[test]
fn a_course_proves_the_compass_wrong_where_the_robot_drives_by_itself() {
    let wrong_after = |steering: Steering, speed_mps: f32| {
        let mut parameters = Parameters::default();
        parameters.vehicle.steering = steering;
        let blob = Blob::without_map(parameters, Some(ORIGIN), Some(Vec2::new(50.0, 50.0)));
        let mut watch = Watch { blob, ..Watch::new(ORIGIN) };
        (0..200_u16).find(|&tick| {
            let north_m = 0.05 * f32::from(tick);
            let fix = Fix { velocity_mmps: Some([0, 1_000]), ..watch.fix(0.0, north_m) };
            let percepts = Percepts {
                fix: Some(fix),
                heading_rad: Some(0.0),
                speed_mps: Some(speed_mps),
                operator: armed(),
                ..Percepts::default()
            };
            watch.look(percepts).is_compass_wrong
        })
    };
    let found = wrong_after(Steering::Differential, 1.0);
    assert!(found.is_some_and(|tick| (39..=43).contains(&tick)), "after 2 s: {found:?}");
    assert_eq!(wrong_after(Steering::Boat, 1.0), None);
    assert_eq!(wrong_after(Steering::Differential, 0.0), None);
}

/// Wheels turn, and the positions waver around one place: the robot is stuck. If they repeat one place,
/// their source is frozen.
#[test]
fn positions_that_waver_show_a_stuck_robot_and_those_that_do_not_a_frozen_source() {
    let last = |waver_m: f32| {
        let mut watch = Watch::new(ORIGIN);
        let mut fix = watch.fix(5.0, 5.0);
        let mut was_stuck = false;
        for tick in 0..100_u16 {
            let forward = Commands { speed_mps: 1.0, ..Commands::stop(Reason::Driving) };
            watch.track.commanded(&forward);
            if tick.is_multiple_of(4) {
                let off_m = if tick % 24 < 12 { waver_m } else { 0.0 };
                fix = watch.fix(5.0 + off_m, 5.0);
            }
            let percepts = Percepts {
                fix: Some(fix),
                heading_rad: Some(0.0),
                speed_mps: Some(1.0),
                operator: armed(),
                ..Percepts::default()
            };
            let sensed = watch.look(percepts);
            was_stuck |= sensed.is_stuck;
            if sensed.position.is_err() {
                return (was_stuck, sensed.position.err());
            }
        }
        (was_stuck, None)
    };
    assert_eq!(last(0.05), (true, None));
    assert_eq!(last(0.0), (false, Some(Reason::FrozenFix)));
}
