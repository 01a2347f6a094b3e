//! How a tick joins schemas, edge, legs astern and drive, for each blend.

use crate::bench::{Robot, behaving_blob, behaving_blob_with, blob, open_field};
use controller::detour::Rule;
use controller::{Explanation, explain};
use math::Vec2;
use plan_format::parameters::{BackOut, Blend, Gains, Steering};
use plan_format::{Blob, Parameters};
use robot_io::{Percepts, RangeReading, Reason};

const QUIET: Gains = Gains { reactive: 0.5, plan: 1.0, noise: 0.0 };

/// Without noise.
fn blended(blend: Blend) -> Parameters {
    Parameters { blend, gains: QUIET, ..Parameters::default() }
}

/// One tick of a robot at a position, with percepts that `change` may alter.
fn once(
    blob: &[u8],
    (x, y): (f32, f32),
    heading_rad: f32,
    change: impl FnOnce(&mut Percepts),
) -> Explanation {
    let mut robot = Robot::new(Blob::parse(blob).expect("the blob is valid"), x, y);
    robot.heading_rad = heading_rad;
    let mut percepts = robot.percepts();
    change(&mut percepts);
    explain(&robot.blob, &mut robot.state, &percepts)
}

/// The goal attracts beside the advice in the paper's mixes, and not where the route leads; what an
/// action aims at attracts always.
#[test]
fn the_goal_attracts_where_the_advice_does_not_lead() {
    let map = "
        ........
        .######.
        ......#G
        ......##";
    for (blend, attracts) in [(Blend::Paper, true), (Blend::Route, false)] {
        let told = once(&blob(&[map], blended(blend)), (1.5, 1.5), 0.0, |_| {});
        let vectors = told.blend.expect("it drives").vectors;
        assert!(vectors.advice != Vec2::zeros(), "{blend:?}");
        assert_eq!(vectors.goal != Vec2::zeros(), attracts, "{blend:?}: {vectors:?}");
        let there = behaving_blob_with(map, blended(blend), "goto 4.5 0.5");
        let told = once(&there, (1.5, 1.5), 0.0, |_| {});
        assert!(told.blend.expect("it drives").vectors.goal != Vec2::zeros(), "{blend:?}");
    }
}

/// Close to the edge, the default blend drives inwards; the paper's mixes turn to their vector.
#[test]
fn the_papers_mixes_are_not_led_along_the_edge() {
    let map = open_field(20, 20, (19, 10));
    for (blend, is_led) in [(Blend::Paper, false), (Blend::Route, true)] {
        // Straight ahead to the east, 0.1 m beside the southern edge.
        let east = behaving_blob_with(&map, blended(blend), "ahead 0 8000");
        let told = once(&east, (10.0, 0.1), 0.0, |_| {});
        assert_eq!(told.commands.reason, Reason::Driving);
        let turn_radps = told.commands.turn_rate_radps;
        assert_eq!(turn_radps > 0.1, is_led, "{blend:?}: {turn_radps}");
        assert!(is_led || turn_radps == 0.0, "{blend:?}: {turn_radps}");
    }
    // Just off the map both are.
    for blend in [Blend::Paper, Blend::Route] {
        let east = behaving_blob_with(&map, blended(blend), "ahead 0 8000");
        let told = once(&east, (10.0, -0.1), 0.0, |_| {});
        assert!(told.commands.turn_rate_radps > 0.1, "{blend:?}: {:?}", told.commands);
    }
}

/// A robot that faces the edge and would only drive on says that the map ends; one that is led
/// turns.
#[test]
fn a_robot_that_only_wants_off_the_map_says_so() {
    let map = open_field(20, 20, (19, 10));
    for (blend, expected) in [(Blend::Paper, Reason::OffMap), (Blend::Route, Reason::Driving)] {
        let mut parameters = blended(blend);
        parameters.vehicle.latency_us = 1_000_000;
        let east = behaving_blob_with(&map, parameters, "ahead 0 8000");
        // Fixes have steps of a centimetre.
        let told = once(&east, (19.994, 10.0), 0.0, |_| {});
        assert_eq!((told.commands.reason, told.commands.speed_mps), (expected, 0.0), "{blend:?}");
    }
}

/// A reading waits for the next tick, and a command holds until the one after it: a mission that says
/// less than these 0.1 s brakes as with them.
#[test]
fn the_brakes_count_with_two_ticks_at_least() {
    let map = open_field(20, 5, (19, 2));
    let speed_mps = |latency_us| {
        let mut parameters = Parameters::default();
        parameters.vehicle.latency_us = latency_us;
        let ahead = RangeReading { bearing_rad: 0.0, distance_m: 0.8 };
        let blob = blob(&[&map], parameters);
        let told = once(&blob, (9.5, 2.5), 0.0, |percepts| {
            percepts.ranges = [ahead].into_iter().collect();
            percepts.speed_mps = Some(1.0);
        });
        assert_eq!(told.commands.reason, Reason::Driving, "{latency_us}");
        told.commands.speed_mps
    };
    assert_eq!([speed_mps(0), speed_mps(50_000)], [speed_mps(100_000); 2]);
    assert!(speed_mps(300_000) < speed_mps(100_000) - 0.1);
}

/// An obstacle within the margin makes the robot cautious, unless the obstacle has no weight.
#[test]
fn a_robot_is_cautious_where_an_obstacle_repels_it() {
    for (reactive, avoid_gain, is_cautious) in
        [(0.5, 1.0, true), (0.5, 0.25, true), (0.0, 1.0, false), (0.5, 0.0, false)]
    {
        let mut parameters = blended(Blend::Paper);
        parameters.gains.reactive = reactive;
        parameters.schemas.avoid_gain = avoid_gain;
        let cautious_mps = parameters.vehicle.cautious_speed_mps;
        let distance_m = parameters.vehicle.radius_m + 0.01;
        let behind = RangeReading { bearing_rad: core::f32::consts::PI, distance_m };
        let blob = blob(&[&open_field(20, 5, (19, 2))], parameters);
        let told = once(&blob, (9.5, 2.5), 0.0, |percepts| {
            percepts.ranges = [behind].into_iter().collect()
        });
        let case = (reactive, avoid_gain, told.commands);
        assert_eq!(told.commands.reason, Reason::Driving, "{case:?}");
        let wanted_mps = told.blend.expect("it drives").sum.x * parameters.vehicle.base_speed_mps;
        assert!(wanted_mps > cautious_mps + 0.2, "{case:?}");
        assert_eq!(told.commands.speed_mps <= cautious_mps, is_cautious, "{case:?}");
    }
}

/// A car at the end of an alley backs out with the default blend only.
#[test]
fn the_papers_mixes_do_not_back_out() {
    let map = "
        ##########
        G.........
        ##########";
    let walls = |percepts: &mut Percepts| {
        let ray = |number: u8| {
            let bearing_rad =
                math::scalar::wrap_angle(f32::from(number) * (math::scalar::TAU / 16.0));
            let direction = math::vector::from_angle(bearing_rad);
            let across = 0.35 / direction.y.abs().max(1e-3);
            let along = if direction.x > 0.0 { 0.27 } else { 8.5 } / direction.x.abs().max(1e-3);
            RangeReading { bearing_rad, distance_m: across.min(along) }
        };
        percepts.ranges = (0..16).map(ray).filter(|reading| reading.distance_m < 8.0).collect();
    };
    for (blend, backs_out) in [(Blend::Paper, false), (Blend::Route, true)] {
        let mut parameters = blended(blend);
        parameters.vehicle.steering = Steering::Ackermann;
        parameters.vehicle.back_out = BackOut::Always;
        parameters.vehicle.radius_m = 0.25;
        parameters.vehicle.min_turn_radius_m = 0.8;
        let told = once(&blob(&[map], parameters), (9.5, 1.5), 0.0, walls);
        let rule = told.blend.expect("it drives").rule;
        assert_eq!(rule == Rule::BackOut, backs_out, "{blend:?}: {:?}", told.commands);
    }
}

/// Of several goals, the one that is approached is named; a single one is not.
#[test]
fn the_goal_that_is_approached_is_named() {
    let both = blob(&["G......G"], Parameters::default());
    for (x, expected) in [(2.5, 0), (5.5, 1)] {
        let mut robot = Robot::new(Blob::parse(&both).expect("the blob is valid"), x, 0.5);
        robot.tick_with(|_| {});
        assert_eq!(robot.state.goal(), Some(expected));
    }
    let one = blob(&["G......."], Parameters::default());
    let mut robot = Robot::new(Blob::parse(&one).expect("the blob is valid"), 2.5, 0.5);
    robot.tick_with(|_| {});
    assert_eq!(robot.state.goal(), None);
}

/// The time of an emergency stop, or of being disarmed, does not count for a plan.
#[test]
fn plans_pause_while_the_robot_is_stopped() {
    let blob = behaving_blob(&open_field(30, 30, (25, 15)), "PS", "hold 500, signal 7");
    let signal_after = |stopped: fn(&mut Percepts)| {
        let mut robot = Robot::new(Blob::parse(&blob).expect("the blob is valid"), 5.5, 15.5);
        (0..3).for_each(|_| assert_eq!(robot.tick_with(|_| {}).signal, 0));
        (0..40).for_each(|_| assert_eq!(robot.tick_with(stopped).signal, 0));
        (0..20).position(|_| robot.tick_with(|_| {}).signal == 7)
    };
    let expected = Some(7);
    assert_eq!(signal_after(|percepts| percepts.operator.is_emergency_stop = true), expected);
    assert_eq!(signal_after(|percepts| percepts.operator.is_armed = false), expected);
}
