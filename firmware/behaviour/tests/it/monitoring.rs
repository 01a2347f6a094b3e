//! Descriptions, protection intervals and timeouts, and the reactions to them (H10, H13 to H16).

use crate::bench::check;

/// A frame with two productions. The more applicable one begins with an action with this clause.
fn two_ways(clause: &str) -> String {
    format!(
        "input a
         input hint
         fact here near 0 0 5
         fact done symbol
         fact other symbol
         action first goto 20 0; {clause}
         action second hold 200
         action end hold 100
         frame work
         = first end; when hint NB NM NS ZO PS PM PB
         = second end; when always ZO
         behaviour a work; when always PS"
    )
}

/// H10, H14: whichever description is violated, the frame chooses again among its untried
/// productions.
#[test]
fn a_violated_description_makes_the_frame_choose_anew() {
    let script = "hint=0.8333 at=9,0\nat=20,0 x5";
    check(
        &two_ways("needs here"),
        "hint=0.8333 at=9,0 x2",
        "1: a engaged, [first end], cannot start: here, [second end], second
         2: second",
    );
    check(
        &two_ways("keeps !done"),
        script,
        "1: a engaged, [first end], first
         2: end
         3: a finished, a engaged, [first end], end",
    );
    check(
        &two_ways("keeps here"),
        "hint=0.8333 at=0,0\nat=9,0 x5",
        "1: a engaged, [first end], first
         2: cannot go on: here, [second end], second
         3: second
         4: end
         5: a finished, a engaged, [first end], first
         6: cannot go on: here, [second end], second",
    );
    check(
        &two_ways("goal here"),
        script,
        "1: a engaged, [first end], first
         2: missed its goal: here, [second end], second
         3: second
         4: end
         5: a finished, a engaged, [first end], missed its goal: here, [second end], second
         6: second",
    );
    check(
        &two_ways("timeout 100"),
        "hint=0.8333 at=9,0 x5",
        "1: a engaged, [first end], first
         2: first
         3: first timed out, [second end], second
         4: second
         5: end",
    );
}

/// H14: the effects of both lists occur together at the end, and only if the goal holds.
#[test]
fn effects_and_goal_go_together() {
    let log = crate::bench::log(&two_ways("adds done; goal here"), "hint=0.8333 at=9,0\nat=20,0");
    assert!(log.contains("missed its goal"), "{log}");
    let bytes = crate::bench::blob(&two_ways("adds done; goal here"));
    let mut robot = crate::bench::Robot::new(&bytes);
    robot.go("hint=0.8333 at=9,0");
    robot.go("at=20,0");
    assert_eq!(robot.report.facts, 0, "an action that misses its goal has no effect");
    let bytes = crate::bench::blob(&two_ways("adds done; goal done"));
    let mut robot = crate::bench::Robot::new(&bytes);
    robot.go("hint=0.8333 at=9,0");
    robot.go("at=20,0");
    assert_eq!(robot.report.facts, 1 << 1, "the goal sees the effects");
}

/// H13: if an interval in force is violated, its frame chooses again in that tick.
#[test]
fn a_violated_interval_falls_back_in_that_tick() {
    check(
        "input a
         fact here near 0 0 5
         action one goto 20 0
         action two hold 100
         action three hold 200
         frame work
         = one two; protect here 0 1
         = three
         behaviour a work; when always PS",
        "at=0,0 x2
         at=9,0 x4",
        "1: a engaged, [one two], one
         2: one
         3: lost its protection: here, [three], three
         4: three
         5: a finished, a engaged, [one two], one
         6: lost its protection: here, [three], three",
    );
}

/// When the root has tried every production, the behaviour fails.
#[test]
fn when_all_has_been_tried_the_behaviour_fails() {
    check(
        &two_ways("needs here").replace("second hold 200", "second hold 200; needs done"),
        "hint=0.8333 at=9,0 x12",
        "1: a engaged, [first end], cannot start: here, [second end], cannot start: done, work NothingApplicable, a failed, -
         2: -
         11: a engaged, [first end], cannot start: here, [second end], cannot start: done, work NothingApplicable, a failed, -
         12: -",
    );
}

/// H15: the strictest constraint from the root down applies.
#[test]
fn constraints_are_inherited() {
    check(
        "input a
         action slow hold 100; speed 0.2
         action fast hold 100; speed 2; distance 1.5
         frame inner; distance 0.5
         = slow fast
         frame outer; speed 0.7
         = inner
         behaviour a outer; when always PS",
        "x2",
        "1: a engaged, [inner], [slow fast], slow<=0.2>=0.5
         2: fast<=0.7>=1.5",
    );
}

/// Waiting does not count as stuck: progress is measured from the start of each action that drives.
#[test]
fn progress_is_counted_for_each_drive() {
    check(
        "input a
         fact stuck stuck 2 300
         action wait hold 1000
         action drive goto 20 0; keeps !stuck
         action give-up signal 3
         frame go
         = drive
         = drive
         = give-up
         frame work
         = wait go
         behaviour a work; when always PS",
        "at=0,0 x11
         at=3,0 x2
         at=3,0 x9",
        "1: a engaged, [wait go], wait
         2: wait
         11: [drive], drive
         12: drive
         16: cannot go on: stuck, [drive], drive
         17: drive
         21: cannot go on: stuck, [give-up], give-up
         22: a finished, a engaged, [wait go], wait",
    );
}

/// What begins beside a drive and does not drive itself does not restart the measurement.
#[test]
fn progress_is_measured_beside_other_actions() {
    check(
        "input a
         fact stuck stuck 2 300
         action drive goto 20 0; keeps !stuck
         action short hold 100
         frame wait
         = short short short short short short short
         frame go
         = drive|wait
         behaviour a go; when always PS",
        "at=0,0 x6",
        "1: a engaged, [drive|wait], [short short short short short sh], drive & short
         2: drive & short
         6: cannot go on: stuck, go NothingApplicable, a failed, -",
    );
}

/// An action ends as soon as its `until` holds; a signal is reported at least once.
#[test]
fn until_signals_and_outputs() {
    check(
        "input a
         fact high level a 0.5 1
         action wait hold 9999; until high
         action tell signal 4; until high
         action light set 2 on
         frame work
         = wait tell light wait
         behaviour a work; when always PS",
        "a=0 x3
         a=1 x4",
        "1: a engaged, [wait tell light wait], wait
         2: wait
         4: tell
         5: a finished, -
         6: a engaged, [wait tell light wait], tell
         7: a finished, -",
    );
}

/// Each action sets its own output and leaves the others as they are, also if they have that state
/// already.
#[test]
fn outputs_are_set_one_by_one() {
    let bytes = crate::bench::blob(
        "input a
         action one-on set 1 on
         action two-on set 2 on
         action one-off set 1 off
         action wait hold 100
         frame go
         = one-on wait two-on one-on wait one-off wait one-off wait
         behaviour a go; when always PS",
    );
    let mut robot = crate::bench::Robot::new(&bytes);
    let outputs = [(); 4].map(|()| {
        robot.go("x1");
        robot.behaviours.outputs()
    });
    assert_eq!(outputs, [0b010, 0b110, 0b100, 0b100]);
}

/// H21: a doubt is reported before its component is due.
#[test]
fn doubts_are_reported_in_advance() {
    check(
        "input a
         fact done symbol
         action step hold 9000
         action spoil hold 9000; deletes done
         action make hold 100; adds done
         action use hold 100; needs done
         frame work
         = step make|spoil use
         behaviour a work; when always PS",
        "doubts=shown x6",
        "1: a engaged, [step make|spoil use], step
         2: step
         4: may lose: done, step
         5: step",
    );
}

/// H22, H23: of two behaviours that run together, the doubts of both are reported.
#[test]
fn doubts_of_all_that_run_are_looked_at() {
    let log = crate::bench::log(
        "input a
         fact done symbol
         action step hold 90000
         action spoil hold 100; deletes done
         action use hold 100; needs done
         action make hold 100; adds done
         frame work
         = step spoil use make
         behaviour a work; when always PS; resources 1
         behaviour b work; when always PS; resources 2",
        "doubts=shown x40",
    );
    assert!(log.matches("may lose: done").count() >= 2, "{log}");
    assert!(log.matches("may lack: done").count() >= 2, "{log}");
}

/// A robot that stands by intent is not stuck, however long: only an action that drives can be.
#[test]
fn a_robot_that_holds_is_not_stuck() {
    check(
        "input a
         fact stuck stuck 2 300
         action near goto 3 0
         action watch hold 1000; keeps !stuck
         frame go
         = near watch
         behaviour a go; when always PS",
        "at=0,0 x1
         at=3,0 x9",
        "1: a engaged, [near watch], near
         2: watch",
    );
}

/// Two signals that are due in one tick are both sent, one after the other. A signal that waits is
/// silent while another one begins.
#[test]
fn each_signal_has_a_tick_of_its_own() {
    check(
        "input a
         fact never symbol
         action wait hold 200
         action first signal 3
         action second signal 4
         action both signal 5; until never
         frame go
         = wait first|second
         frame alarm
         = both
         behaviour a go; when always PS
         behaviour b alarm; when always PS; resources 2",
        "x6",
        "1: a engaged, b engaged, [wait first|second], [both], wait & both
         2: wait & both
         3: first
         4: second
         5: a finished, a engaged, [wait first|second], wait & both
         6: wait & both",
    );
}
