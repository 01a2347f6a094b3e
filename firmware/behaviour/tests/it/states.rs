//! The life-cycle states of a behaviour and the transitions between them (H01, H02, H29, H34).

use crate::bench::{Robot, blob, check};
use behaviour::Phase;

/// Two behaviours that share a resource, each with two steps of 200 ms, a start-up and a shut-down.
const ALL: &str = "
    input first
    input second
    action step hold 200
    action next hold 200
    action up hold 100
    action down hold 100
    frame work
    = step:3 next
    frame prepare
    = up
    frame tidy
    = down
    behaviour a work; when first NB NM NS ZO PS PM PB; start-up prepare; shut-down tidy
    behaviour b work; when second NB NM NS ZO PS PM PB; start-up prepare; shut-down tidy
";

#[test]
fn a_failure_leaves_the_start_up_of_another_alone() {
    check(
        "input a
         action long hold 400
         action bad hold 90000; timeout 100
         frame prepare
         = long
         frame work
         = long
         frame failing
         = bad
         behaviour a work; when always PS; resources 1; start-up prepare
         behaviour b failing; when always PS; resources 2",
        "x6",
        "1: a prepares, b engaged, [long], [bad], long & bad
         2: long & bad
         3: bad timed out, failing NothingApplicable, b failed, long
         4: long
         5: a engaged, [long], long
         6: long",
    );
}

/// Every state of a behaviour, and every transition.
#[test]
fn the_states_and_the_ways_between_them() {
    check(
        ALL,
        "first=0 second=0
         first=0.5 x3
         second=0.8333
         second=0.8333 x5
         second=0 first=0.5 x6
         first=0 x9",
        "1: -
         2: a prepares, [up], up
         3: a engaged, [step:3 next], step
         4: step
         5: a interrupted by b losing 3, [down], down
         6: b prepares, [up], up
         7: b engaged, [step:3 next], step
         8: step
         9: next
         11: b finished, a prepares, [up], up
         12: a resumed, next
         13: next
         14: a finished, a prepares, [up], up
         15: a engaged, [step:3 next], step
         16: step
         17: next
         19: a finished, -
         20: -",
    );
    let table: &[(&str, [Phase; 2])] = &[
        ("first=0 second=0", [Phase::Idle, Phase::Idle]),
        ("first=0.5", [Phase::StartingUp, Phase::Idle]),
        ("x1", [Phase::Active, Phase::Idle]),
        ("second=0.8333", [Phase::Active, Phase::Idle]),
        ("x1", [Phase::ShuttingDown, Phase::Idle]),
        ("x1", [Phase::Sleeping, Phase::StartingUp]),
        ("x1", [Phase::Sleeping, Phase::Active]),
        ("second=0 x4", [Phase::Active, Phase::Sleeping]),
        // Urgent: at once, without a shut-down; the other's start-up is abandoned.
        ("second=1", [Phase::Sleeping, Phase::StartingUp]),
        ("x1", [Phase::Sleeping, Phase::Active]),
        ("first=0 second=0", [Phase::Sleeping, Phase::Active]),
        ("x9", [Phase::Sleeping, Phase::Idle]),
        // Critical again, so it wakes.
        ("first=0.5", [Phase::StartingUp, Phase::Idle]),
        ("x1", [Phase::Active, Phase::Idle]),
        ("first=0 x2", [Phase::Idle, Phase::Idle]),
    ];
    let bytes = blob(ALL);
    let mut robot = Robot::new(&bytes);
    for (number, (line, phases)) in table.iter().enumerate() {
        robot.go(line);
        let now = [robot.behaviours.phase(0), robot.behaviours.phase(1)];
        assert_eq!(now, *phases, "row {number}: {line}");
    }
    assert_eq!(robot.behaviours.components(), 0, "the pool is empty");
}

/// H02: the criticality follows the aspect of interest in every tick.
#[test]
fn criticalities_follow_their_inputs_each_tick() {
    let bytes = blob(ALL);
    let mut robot = Robot::new(&bytes);
    for sixth in 0_u8..=6 {
        let value = f32::from(sixth) / 6.0;
        robot.go(&format!("first={value} second=0"));
        let golden = value.clamp(1.0 / 18.0, 17.0 / 18.0);
        assert!((robot.report.criticalities[0] - golden).abs() < 1e-3, "{:?}", robot.report);
        assert!((robot.report.criticalities[1] - 1.0 / 18.0).abs() < 1e-3);
    }
}

/// H34: the start-up runs before a plan is engaged and before it is resumed; the shut-down runs
/// before it sleeps, but not after an unconditional switch.
#[test]
fn start_up_and_shut_down_frame_the_work() {
    check(
        ALL,
        "first=0.5 second=0 x2
         second=0.8333 x3
         second=0 x12",
        "1: a prepares, [up], up
         2: a engaged, [step:3 next], step
         3: b waits: a is at no point, step
         4: a interrupted by b losing 3, [down], down
         5: b prepares, [up], up
         6: b engaged, b interrupted by a, [down], down
         7: a prepares, [up], up
         8: a resumed, next
         9: next
         10: a finished, a prepares, [up], up
         11: a engaged, [step:3 next], step
         12: step
         13: next
         15: a finished, a prepares, [up], up
         16: a engaged, [step:3 next], step
         17: step",
    );
    check(
        ALL,
        "first=0.5 second=0 x2\nsecond=1 x3",
        "1: a prepares, [up], up
         2: a engaged, [step:3 next], step
         3: a stopped by b losing 3, b prepares, [up], up
         4: b engaged, [step:3 next], step
         5: step",
    );
}

/// H34: if a start-up fails, its behaviour fails and rests; if a shut-down fails, the other
/// behaviour proceeds.
#[test]
fn activities_that_fail() {
    let never =
        ALL.replace("action up hold 100", "fact never symbol\naction up hold 100; needs never");
    check(
        &never,
        "first=0.5 second=0 x12",
        "1: a prepares, [up], cannot start: never, prepare NothingApplicable, a failed, -
         2: -
         11: a prepares, [up], cannot start: never, prepare NothingApplicable, a failed, -
         12: -",
    );
    let never = ALL.replace("action down hold 100", "action down hold 9999; timeout 100");
    check(
        &never,
        "first=0.5 second=0 x3\nsecond=0.6667 x4",
        "1: a prepares, [up], up
         2: a engaged, [step:3 next], step
         3: step
         4: a interrupted by b losing 3, [down], down
         5: b waits: a is shutting down, down
         6: down timed out, b waits: a is shutting down, tidy NothingApplicable, -
         7: b prepares, [up], up",
    );
}

/// H29: a dormant behaviour is not engaged. An active one that becomes dormant completes its plan;
/// a sleeping one wakes only when it is critical again.
#[test]
fn dormant_behaviours_begin_nothing_and_end_what_they_have_begun() {
    let mission = "
        input first
        input second
        action step hold 200
        frame work
        = step step
        behaviour a work; when first NB NM NS ZO PS PM PB
        behaviour b work; when second NB NM NS ZO PS PM PB
    ";
    check(
        mission,
        "first=0 second=0 x2
         first=0.5
         first=0 x5
         first=0.5
         first=0 second=0.5 x9
         second=0 x2
         first=0.5 x2",
        "1: -
         3: a engaged, [step step], step
         4: step
         7: a finished, -
         8: -
         9: a engaged, [step step], step
         10: b waits: a is at no point, step
         11: a interrupted by b, b engaged, [step step], step
         12: step
         15: b finished, b engaged, [step step], step
         16: step
         19: b finished, -
         20: -
         21: a resumed, step
         22: step",
    );
}

/// A failed behaviour rests for a second while another has the robot.
#[test]
fn a_behaviour_that_has_failed_rests() {
    check(
        "input first
         input second
         fact never symbol
         action cannot hold 100; needs never
         action step hold 2000
         frame hopeless
         = cannot
         frame work
         = step
         behaviour a hopeless; when first NB NM NS ZO PS PM PB
         behaviour b work; when second NB NM NS ZO PS PM PB",
        "first=0.6667 second=0.5 x22",
        "1: a engaged, [cannot], cannot start: never, hopeless NothingApplicable, a failed, -
         2: b engaged, [step], step
         3: step
         11: a waits: b is at no point, step
         22: b finished, a engaged, [cannot], cannot start: never, hopeless NothingApplicable, a failed, -",
    );
}

/// A plan that is interrupted before its root is decomposed is decomposed when it resumes.
#[test]
fn a_plan_that_has_not_begun_can_be_interrupted_and_resumed() {
    check(
        "input first
         input second
         action step hold 200
         frame work
         = step
         behaviour a work; when first NB NM NS ZO PS PM PB; start-up work
         behaviour b work; when second NB NM NS ZO PS PM PB",
        "first=0.5 second=0 x2
         second=1
         second=0 x5",
        "1: a prepares, [step], step
         2: step
         3: a engaged, a stopped by b, b engaged, [step], step
         4: a waits: b is at no point, step
         5: b finished, a prepares, [step], step
         6: step
         7: a resumed, [step], step
         8: step",
    );
}

/// During a pause, neither the action's time nor its timeout advances.
#[test]
fn time_stands_still_during_a_pause() {
    check(
        "input first
         action step hold 300; timeout 400
         frame work
         = step
         behaviour a work; when always PS",
        "x2
         paused=60000 x3",
        "1: a engaged, [step], step
         2: step
         4: a finished, a engaged, [step], step
         5: step",
    );
}
