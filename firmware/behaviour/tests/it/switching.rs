//! When one behaviour takes over from another (H26, H30, H32, H34, H37, H38).

use crate::bench::check;

/// Two behaviours; the first has three steps and these further clauses.
fn two(clauses: &str) -> String {
    format!(
        "input first
         input second
         action one hold 200
         action two hold 200
         action three hold 200
         action other hold 200
         frame work
         = one:5 two:2 three
         frame else
         = other
         behaviour a work; when first NB NM NS ZO PS PM PB {clauses}
         behaviour b else; when second NB NM NS ZO PS PM PB"
    )
}

/// H37: the earliest point is after `one`, the best after `two`.
#[test]
fn the_earliest_point_and_the_best_differ() {
    let script = "first=0.5 second=0\nsecond=0.6667 x7";
    check(
        &two(""),
        script,
        "1: a engaged, [one:5 two:2 three], one
         2: b waits: a is at no point, one
         3: a interrupted by b losing 5, b engaged, [other], other
         4: other
         5: b finished, b engaged, [other], other
         6: other
         7: b finished, b engaged, [other], other
         8: other",
    );
    check(
        &two("; best"),
        script,
        "1: a engaged, [one:5 two:2 three], one
         2: b waits: a is at no point, one
         3: b waits: a has a better point ahead, two
         4: b waits: a is at no point, two
         5: a interrupted by b losing 2, b engaged, [other], other
         6: other
         7: b finished, b engaged, [other], other
         8: other",
    );
}

/// H37: a point ahead that loses as much is no better.
#[test]
fn of_equal_points_the_earlier_one_is_best() {
    let mission = two("; best").replace("one:5 two:2", "one:3 two:3");
    check(
        &mission,
        "first=0.5 second=0\nsecond=0.6667 x2",
        "1: a engaged, [one:3 two:3 three], one
         2: b waits: a is at no point, one
         3: a interrupted by b losing 3, b engaged, [other], other",
    );
}

/// H38: the lost work is reported, at a point and at once.
#[test]
fn the_cost_of_an_unconditional_switch_is_that_of_what_ran() {
    check(
        &two(""),
        "first=0.5 second=0\nsecond=1",
        "1: a engaged, [one:5 two:2 three], one
         2: a stopped by b losing 5, b engaged, [other], other",
    );
}

/// H38: of nested and parallel components every one that runs counts, and each frame above them once.
#[test]
fn the_cost_of_what_runs_in_parallel_counts_frames_once() {
    check(
        "input first
         input second
         action one hold 400
         action two hold 400
         action done hold 100
         action other hold 200
         frame inner
         = one:1|two:2 done:64
         frame work
         = done:32 inner:4 done:16
         frame else
         = other
         behaviour a work; when first NB NM NS ZO PS PM PB
         behaviour b else; when second NB NM NS ZO PS PM PB",
        "first=0.5 second=0 x2
         second=1",
        "1: a engaged, [done:32 inner:4 done:16], done
         2: [one:1|two:2 done:64], one & two
         3: a stopped by b losing 7, b engaged, [other], other",
    );
}

/// H32: another takes over only if it is more critical by the hysteresis, and not before the
/// minimum dwell is over.
#[test]
fn hysteresis_and_dwell_keep_two_behaviours_from_chattering() {
    check(
        &two("; hysteresis 0.1"),
        "first=0.5 second=0
         second=0.55 x4
         second=0.62 x3",
        "1: a engaged, [one:5 two:2 three], one
         2: one
         3: two
         5: three
         6: b waits: a is at no point, three
         7: a finished, b engaged, [other], other
         8: other",
    );
    check(
        &two("; dwell 450"),
        "first=0.5 second=0\nsecond=0.6667 x6",
        "1: a engaged, [one:5 two:2 three], one
         2: b waits: a has just begun, one
         3: b waits: a has just begun, two
         5: b waits: a has just begun, three
         6: b waits: a is at no point, three
         7: a finished, b engaged, [other], other",
    );
    // At the vertex of tick 3, the dwell is just over.
    check(
        &two("; dwell 200"),
        "first=0.5 second=0\nsecond=0.6667 x3",
        "1: a engaged, [one:5 two:2 three], one
         2: b waits: a has just begun, one
         3: a interrupted by b losing 5, b engaged, [other], other
         4: other",
    );
}

/// H32: two behaviours with nearly equal criticalities and noisy inputs alternate only as often as
/// dwell and hysteresis allow.
#[test]
fn noise_makes_nobody_chatter() {
    use crate::bench::{Robot, blob};
    use behaviour::Decision;
    let mission = "
        input first
        input second
        action step hold 100
        frame work
        = step work
        behaviour a work; when first NB NM NS ZO PS PM PB; CLAUSE
        behaviour b work; when second NB NM NS ZO PS PM PB; CLAUSE
    ";
    let switches = |clause: &str| {
        let bytes = blob(&mission.replace("CLAUSE", clause));
        let mut robot = Robot::new(&bytes);
        let mut count = 0;
        for tick in 0_u32..400 {
            let noise = f64::from(tick.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
            robot.go(&format!("first={} second={}", 0.5 + 0.1 * noise, 0.5 - 0.1 * noise));
            let decisions = &robot.report.decisions;
            let is_switch = |d: &&Decision| matches!(d, Decision::Interrupted { .. });
            count += decisions.iter().filter(is_switch).count();
        }
        count
    };
    assert!(switches("hysteresis 0") > 50);
    assert!(switches("dwell 2000") <= 20);
    assert_eq!(switches("hysteresis 0.15"), 0);
}

/// Of two equally critical behaviours, the engaged one keeps the robot, whatever their order in the
/// mission.
#[test]
fn equals_do_not_interrupt_each_other() {
    check(
        &two(""),
        "first=0 second=0.5
         first=0.5 x3",
        "1: b engaged, [other], other
         2: other
         3: b finished, a engaged, [one:5 two:2 three], one
         4: one",
    );
}

/// Two urgent behaviours do not chatter around the threshold.
#[test]
fn the_hysteresis_holds_among_the_urgent_too() {
    check(
        &two("; hysteresis 0.05"),
        "first=1 second=0
         first=0.985 second=1
         first=0.9 x2",
        "1: a engaged, [one:5 two:2 three], one
         2: one
         3: a stopped by b, b engaged, [other], other
         4: other",
    );
}

/// Above its threshold a behaviour is engaged at once, despite the other's dwell; below, it waits.
#[test]
fn urgency_knows_no_dwell() {
    check(
        &two("; dwell 9000"),
        "first=0.5 second=0.8333 x1\nfirst=0.9 x3\nsecond=1",
        "1: b engaged, [other], other
         2: a waits: b is at no point, other
         3: b finished, a engaged, [one:5 two:2 three], one
         4: one
         5: a stopped by b, b engaged, [other], other",
    );
}

/// H30: a switching point is a vertex where no action runs. Parallel branches reach vertices at
/// different times, so they are interrupted where they join.
#[test]
fn parallel_branches_are_interrupted_where_they_join() {
    check(
        "input first
         input second
         action long hold 400
         action short hold 100
         action after hold 100
         action other hold 100
         frame branch
         = short:7 short:7
         frame work
         = long:2|branch:3 after
         frame else
         = other
         behaviour a work; when first NB NM NS ZO PS PM PB
         behaviour b else; when second NB NM NS ZO PS PM PB",
        "first=0.5 second=0
         second=0.6667 x6",
        "1: a engaged, [long:2|branch:3 after], [short:7 short:7], long & short
         2: b waits: a is at no point, long & short
         3: b waits: a is at no point, long
         5: a interrupted by b losing 5, b engaged, [other], other
         6: b finished, b engaged, [other], other",
    );
}

/// Actions that end at once pass a vertex within a tick; a waiting behaviour still takes over
/// there.
#[test]
fn a_vertex_that_is_passed_within_a_tick_is_a_point_too() {
    check(
        "input first
         input second
         fact armed symbol
         action arm set 1 on; adds armed
         action step hold 200
         action lift set 1 off
         action other hold 100; deletes armed
         frame work
         = arm step lift step; protect armed 1 3
         frame else
         = other
         behaviour a work; when first NB NM NS ZO PS PM PB
         behaviour b else; when second NB NM NS ZO PS PM PB",
        "first=0.5 second=0
         second=0.6667 x7",
        "1: a engaged, [arm step lift step], step
         2: b waits: a is at no point, step
         3: b waits: a is at no point, -
         4: a interrupted by b, b engaged, [other], other
         5: b finished, b engaged, [other], other",
    );
}

/// H34: a start-up is not interrupted conditionally: the other waits until the plan has begun and is
/// at a point.
#[test]
fn a_start_up_is_not_interrupted_conditionally() {
    check(
        "input a
         input b
         action prepare hold 200
         action check hold 200
         action work hold 200
         action other hold 200
         frame setting
         = prepare check
         frame plan
         = work work
         frame else
         = other
         behaviour worker plan; when a NB NM NS ZO PS PM PB; start-up setting
         behaviour taker else; when b NB NM NS ZO PS PM PB",
        "a=0.5 b=0 x1
         b=0.6667 x7",
        "1: worker prepares, [prepare check], prepare
         2: taker waits: worker is at no point, prepare
         3: taker waits: worker is at no point, check
         5: worker engaged, worker interrupted by taker, taker engaged, [other], other
         6: other
         7: taker finished, taker engaged, [other], other
         8: other",
    );
}

/// H37: a better point ahead does not count if what is protected there excludes the other: then the
/// earliest point is the one.
#[test]
fn a_better_point_inside_an_interval_is_none() {
    check(
        "input a
         input b
         fact clean set
         action one hold 200
         action two hold 200
         action three hold 200
         action other hold 200; deletes clean
         frame work
         = one:5 two:2 three; protect clean 2 3
         frame else
         = other
         behaviour a work; when a NB NM NS ZO PS PM PB; best
         behaviour b else; when b NB NM NS ZO PS PM PB",
        "a=0.5 b=0 x1
         b=0.6667 x4",
        "1: a engaged, [one:5 two:2 three], one
         2: b waits: a is at no point, one
         3: a interrupted by b losing 5, b engaged, [other], other
         4: other
         5: b finished, b engaged, [other], other",
    );
}
