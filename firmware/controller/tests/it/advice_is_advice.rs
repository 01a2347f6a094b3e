//! W15: the plan is advice only. It never replaces reactive control, and reactive control
//! does not depend on it.

use crate::bench::{ORIGIN, Robot, blob, open_field};
use math::{scalar, vector};
use plan_format::parameters::{Gains, OnNoProgress, SchemaParameters, Selection};
use plan_format::{Blob, Parameters};
use robot_io::{Percepts, RangeReading, Reason};

const MAP: &str = "
    ....................
    ......####..........
    ......####..........
    ..........#........G
    .......####.........
    ....................";

fn with_gains(gains: Gains) -> Parameters {
    Parameters { gains, ..Parameters::paper() }
}

/// Ranges that change from tick to tick.
fn passing_obstacles(time_us: u64, percepts: &mut Percepts) {
    let tick = (time_us / 50_000) as f32;
    percepts.ranges = [1.0, 2.0, 4.0]
        .map(|distance_m| RangeReading {
            bearing_rad: scalar::wrap_angle(tick * 0.3 + distance_m),
            distance_m: distance_m + 0.5 * scalar::sin(tick * 0.1),
        })
        .into_iter()
        .collect();
}

/// The bits of speed and turn rate along a run of `ticks`.
fn run(blob: Blob<'_>, ticks: usize) -> Vec<(u32, u32)> {
    let mut robot = Robot::new(blob, 1.5, 2.5);
    let mut bits = |_| {
        let time_us = robot.time_us;
        let commands = robot.drive_with(|percepts| passing_obstacles(time_us, percepts));
        (commands.speed_mps.to_bits(), commands.turn_rate_radps.to_bits())
    };
    (0..ticks).map(&mut bits).collect()
}

#[test]
fn w15_a_planning_gain_of_zero_is_pure_reactive_control_bit_for_bit() {
    let reactive = with_gains(Gains::REACTIVE_ONLY);
    let blob = blob(&[MAP], reactive);
    let blob = Blob::parse(&blob).unwrap();
    let without_map = Blob::without_map(reactive, Some(ORIGIN), blob.goal());
    let with_map = run(blob, 400);
    assert_eq!(with_map, run(without_map, 400));
    assert!(with_map.iter().any(|bits| *bits != with_map[0]), "something happened");
}

/// Even if the mission's own mix weakens or silences the reactive schemas.
#[test]
fn w15_without_a_map_every_mix_is_pure_reactive_control() {
    let plan_for = |gains| {
        Blob::without_map(with_gains(gains), Some(ORIGIN), Some(math::Vec2::new(19.5, 2.5)))
    };
    let expected = run(plan_for(Gains::REACTIVE_ONLY), 400);
    for gains in [Gains::MOSTLY_REACTIVE, Gains::MOSTLY_PLAN, Gains::PLAN_ONLY] {
        assert_eq!(run(plan_for(gains), 400), expected, "{gains:?}");
    }
}

#[test]
fn w15_the_advice_has_an_effect_where_it_has_a_gain() {
    let mixed = blob(&[MAP], with_gains(Gains::MOSTLY_PLAN));
    let reactive = blob(&[MAP], with_gains(Gains::REACTIVE_ONLY));
    let bits = |blob| run(Blob::parse(blob).unwrap(), 400);
    assert_ne!(bits(&mixed), bits(&reactive));
}

/// An obstacle stands within the margin on the advised route: the robot turns away from it,
/// whatever the mix.
#[test]
fn w15_repulsion_within_the_margin_beats_the_advice() {
    for gains in [Gains::REACTIVE_ONLY, Gains::MOSTLY_REACTIVE, Gains::MOSTLY_PLAN] {
        let blob = blob(&[&open_field(20, 5, (19, 2))], with_gains(gains));
        let mut robot = Robot::new(Blob::parse(&blob).unwrap(), 1.5, 2.5);
        let slightly_left = RangeReading { bearing_rad: 0.2, distance_m: 0.75 };
        let commands =
            robot.tick_with(|percepts| percepts.ranges = [slightly_left].into_iter().collect());
        assert!(commands.turn_rate_radps < -0.9, "{gains:?}: {commands:?}");
        assert_eq!(commands.speed_mps, 0.0, "{gains:?}: it must not drive on");
    }
}

/// W28: every tick reads the gains.
#[test]
fn w28_a_change_of_gains_takes_effect_at_the_next_tick() {
    let map = open_field(40, 40, (39, 10));
    let blobs =
        [Gains::REACTIVE_ONLY, Gains::PLAN_ONLY].map(|gains| blob(&[&map], with_gains(gains)));
    let [reactive, plan_only] = [&blobs[0], &blobs[1]].map(|blob| Blob::parse(blob).unwrap());
    let mut robot = Robot::new(reactive, 1.5, 1.5);
    let before = robot.tick_with(|_| {});
    robot.blob = plan_only;
    let after = robot.tick_with(|_| {});
    // The goal is at 13 degrees; the plan advises north-east first.
    assert!(after.turn_rate_radps > before.turn_rate_radps + 0.3, "{before:?} {after:?}");
}

/// W25 through the whole tick: the robot crosses the border of the second layer.
#[test]
fn w25_dynamic_selection_acts_at_the_tick_of_the_crossing() {
    let free = "........\n........\n.......G";
    let walled = "#.......\n#.......\n#......G";
    let parameters = Parameters { selection: Selection::Dynamic, ..with_gains(Gains::PLAN_ONLY) };
    let blob = blob(&[free, walled], parameters);
    let mut robot = Robot::new(Blob::parse(&blob).unwrap(), 1.5, 2.5);
    for (x, expected) in [(1.5, Reason::Driving), (0.5, Reason::Driving), (1.5, Reason::Driving)] {
        robot.carry_to(x);
        assert_eq!(robot.tick_with(|_| {}).reason, expected);
        assert_eq!(robot.state.progress.choice.layer(), None, "the choice stays open");
    }
}

/// W17: on a course of 22.5 degrees the plan alone alternates between east and north-east; the
/// mixes smooth that.
#[test]
fn w17_blending_smooths_the_bias_of_eight_directions() {
    let map = open_field(110, 50, (105, 43));
    let turning = |gains: Gains| {
        let blob = blob(&[&map], with_gains(Gains { noise: 0.0, ..gains }));
        let mut robot = Robot::new(Blob::parse(&blob).unwrap(), 5.5, 2.0);
        let mut turned_rad = 0.0;
        for _ in 0..4_000 {
            let before_rad = robot.heading_rad;
            let commands = robot.drive_with(|_| {});
            turned_rad += scalar::wrap_angle(robot.heading_rad - before_rad).abs();
            if commands.reason == Reason::AtGoal {
                return turned_rad;
            }
        }
        panic!("{gains:?}: the goal was not reached, but {:?}", robot.position);
    };
    let plan_only = turning(Gains::PLAN_ONLY);
    for mix in [Gains::MOSTLY_REACTIVE, Gains::MOSTLY_PLAN] {
        let mixed = turning(mix);
        assert!(
            mixed < 0.9 * plan_only,
            "{mix:?} turned {mixed} rad, the plan alone {plan_only} rad"
        );
    }
}

/// A mix with mostly plan, and the plan alone, lead out of a trap that keeps a reactive robot with
/// the paper's blend.
#[test]
fn a_plan_leads_out_of_a_pocket_that_holds_a_reactive_robot() {
    let map = "
        ..............................
        ..............................
        ..............................
        ..............................
        ..............................
        ..............................
        ..........#######.............
        ................#.............
        ................#.............
        ................#.............
        ................#.............
        ................#............G
        ................#.............
        ................#.............
        ................#.............
        ................#.............
        ..........#######.............
        ..............................
        ..............................
        ..............................
        ..............................
        ..............................
        ..............................";
    let route = |gains| Parameters { gains, ..Parameters::default() };
    let avoiding_the_past = |parameters: Parameters| {
        let schemas = SchemaParameters { past_gain: 3.0, ..parameters.schemas };
        Parameters { schemas, ..parameters }
    };
    for (parameters, arrives) in [
        (with_gains(Gains::MOSTLY_PLAN), true),
        (with_gains(Gains::PLAN_ONLY), true),
        (with_gains(Gains::REACTIVE_ONLY), false),
        // Where it has been repels it.
        (avoiding_the_past(with_gains(Gains::REACTIVE_ONLY)), true),
        (route(Gains::MOSTLY_PLAN), true),
        // A detour along the walls leads out without the plan.
        (route(Gains::REACTIVE_ONLY), true),
    ] {
        let gains = parameters.gains;
        let blob = blob(&[map], parameters);
        let blob = Blob::parse(&blob).unwrap();
        let mut robot = Robot::new(blob, 13.5, 11.5);
        let arrived = (0..4_000).any(|_| {
            let (position, heading_rad) = (robot.position, robot.heading_rad);
            let ring = |percepts: &mut Percepts| {
                percepts.ranges =
                    (0..16).filter_map(|i| ray(&blob, position, heading_rad, i)).collect();
            };
            robot.drive_with(ring).reason == Reason::AtGoal
        });
        assert_eq!(arrived, arrives, "{gains:?} ended at {:?}", robot.position);
    }
}

/// The map shows a door in the wall, and it is closed. The robot looks for a way along the wall in both
/// directions, gives up, and tries again when it is armed anew.
#[test]
fn a_robot_before_a_closed_door_gives_up() {
    let open = "
        ################
        #.......#......#
        #.......#......#
        #.......#......#
        #..............#
        #..............#
        #.............G#
        #.......#......#
        #.......#......#
        #.......#......#
        ################";
    let shut = |line: &str| line.replace("#..............#", "#.......#......#");
    let closed = shut(open).replace("#.............G#", "#.......#.....G#");
    for (on_none, gives_up) in [(OnNoProgress::Stop, true), (OnNoProgress::Continue, false)] {
        let mut parameters = Parameters::default();
        parameters.progress.on_none = on_none;
        let known = blob(&[open], parameters);
        let truth = blob(&[&closed], parameters);
        let truth = Blob::parse(&truth).unwrap();
        let mut robot = Robot::new(Blob::parse(&known).unwrap(), 3.5, 5.5);
        let mut tick = |is_armed: bool| {
            let (position, heading_rad) = (robot.position, robot.heading_rad);
            let see = |percepts: &mut Percepts| {
                percepts.operator.is_armed = is_armed;
                percepts.ranges =
                    (0..16).filter_map(|i| ray(&truth, position, heading_rad, i)).collect();
            };
            (robot.drive_with(see).reason, robot.position)
        };
        let told = (0..8_000).position(|_| tick(true).0 == Reason::NoProgress);
        assert_eq!(told.is_some(), gives_up, "{told:?}");
        if gives_up {
            let (_, before) = tick(false);
            let reasons: Vec<Reason> = (0..200).map(|_| tick(true).0).collect();
            assert!(!reasons.contains(&Reason::NoProgress), "{reasons:?}");
            assert!(vector::length(tick(true).1 - before) > 0.3);
        }
    }
}

/// The obstacle cell that ray `index` of sixteen meets first, within 8 m.
fn ray(blob: &Blob<'_>, from: math::Vec2, heading_rad: f32, index: usize) -> Option<RangeReading> {
    let bearing_rad = scalar::wrap_angle(index as f32 * (scalar::TAU / 16.0));
    let direction = vector::from_angle(heading_rad + bearing_rad);
    let layer = blob.parallel_plan(0)?.layer(0)?;
    let is_blocked = |distance_m: &f32| {
        let cell = blob.cell_at(from + direction * *distance_m);
        cell.is_some_and(|cell| matches!(layer.look_up(cell), plan_format::Answer::Blocked { .. }))
    };
    let distance_m = (0..160).map(|i| i as f32 * 0.05).find(is_blocked)?;
    Some(RangeReading { bearing_rad, distance_m })
}
