//! Frames that end by a condition or a timeout, choices that spare what is protected, behaviours that
//! run once, and the way back to the place left.

use crate::bench::{Robot, blob, check};

/// A frame ends as soon as its `until` holds, whatever runs below it, and has its effects; one whose
/// `until` holds already is done at once.
#[test]
fn a_frame_ends_as_soon_as_its_until_holds() {
    check(
        "input a
         fact full level a 0.5 1
         fact fed symbol
         action step hold 200
         action end hold 100; needs fed
         frame feed; until full; adds fed
         = step feed
         frame work
         = feed end
         behaviour a work; when always PS",
        "a=0 x4
         a=1 x4",
        "1: a engaged, [feed end], [step feed], step
         2: step
         3: [step feed], step
         4: step
         5: end
         6: a finished, a engaged, [feed end], end",
    );
}

/// Of behaviours that run together, each ends its own frames.
#[test]
fn a_frame_ends_for_its_own_behaviour() {
    check(
        "input a
         fact full level a 0.5 1
         action step hold 900
         action feed hold 900
         frame work
         = step
         frame feeding; until full
         = feed
         behaviour a work; when always PS; resources 1
         behaviour b feeding; when always PS; resources 2; once",
        "a=0 x2
         a=1 x2",
        "1: a engaged, b engaged, [step], [feed], step & feed
         2: step & feed
         3: b finished, step
         4: step",
    );
}

/// The goal of a frame is checked at that end too.
#[test]
fn a_frame_that_ends_by_its_until_may_miss_its_goal() {
    check(
        "input a
         fact full level a 0.5 1
         fact near near 0 0 1
         action step hold 900
         action other hold 200
         frame feed; until full; goal near
         = step
         = other
         frame work
         = feed
         = other
         behaviour a work; when always PS",
        "a=0 at=9,9 x2
         a=1 x2",
        "1: a engaged, [feed], [step], step
         2: step
         3: missed its goal: near, [other], other
         4: other",
    );
}

/// A frame fails after its timeout, which counts from its first decomposition through all its
/// choices and rounds.
#[test]
fn a_frame_fails_after_its_timeout() {
    let mission = |production: &str| {
        format!(
            "input a
             fact never symbol
             action step hold 200
             action cannot hold 200; goal never
             action other hold 900
             frame slow; timeout 450
             {production}
             frame work
             = slow
             = other
             behaviour a work; when always PS"
        )
    };
    check(
        &mission("= step slow"),
        "x7",
        "1: a engaged, [slow], [step slow], step
         2: step
         3: [step slow], step
         4: step
         5: [step slow], step
         6: slow timed out, [other], other
         7: other",
    );
    check(
        &mission("= cannot\n= other"),
        "x7",
        "1: a engaged, [slow], [cannot], cannot
         2: cannot
         3: missed its goal: never, [other], other
         4: other
         6: slow timed out, [other], other
         7: other",
    );
}

/// The time that a behaviour sleeps does not count for the timeouts of its frames.
#[test]
fn a_frame_does_not_time_out_while_its_behaviour_sleeps() {
    check(
        "input a
         input b
         action step hold 200
         action other hold 100
         frame slow; timeout 450
         = step step step
         frame work
         = slow
         frame else
         = other else
         behaviour a work; when a NB NM NS ZO PS PM PB
         behaviour b else; when b NB NM NS ZO PS PM PB",
        "a=0.5 b=0 x2
         b=0.6667 x9
         b=0 x6",
        "1: a engaged, [slow], [step step step], step
         2: step
         3: a interrupted by b, b engaged, [other else], other
         4: [other else], other
         12: b interrupted by a, a resumed, step
         13: step
         15: slow timed out, work NothingApplicable, a failed, -
         16: -",
    );
}

/// A frame that ends by a condition inside a loop is not left out when the loop restarts.
#[test]
fn a_timed_frame_in_between_is_not_cut_out_of_a_loop() {
    let mission = |clause: &str| {
        format!(
            "input a
             fact never symbol
             action step hold 100
             frame outer
             = step inner
             frame inner{clause}
             = step outer
             behaviour a outer; when always PS"
        )
    };
    let components = |clause: &str| {
        let bytes = blob(&mission(clause));
        let mut robot = Robot::new(&bytes);
        let counts = (0..8).map(|_| {
            robot.go("x1");
            robot.behaviours.components()
        });
        counts.max()
    };
    let in_place = components("");
    assert!(components("; until never") > in_place);
    assert!(components("; timeout 9000") > in_place);
}

/// H19, H24: of the applicable productions a frame takes one that spares what is protected now, even
/// if another one is more applicable; if all are doubtful, it takes the most applicable.
#[test]
fn a_choice_spares_what_is_protected() {
    let mission = |second: &str| {
        format!(
            "input a
             fact clean set
             action step hold 200
             action spoil hold 200; deletes clean
             frame cross
             = spoil; when always PM
             = {second}; when always PS
             frame work
             = step cross step; protect clean 0 2
             behaviour a work; when always PS"
        )
    };
    check(
        &mission("step"),
        "x5",
        "1: a engaged, [step cross step], step
         2: step
         3: [step], step
         4: step",
    );
    check(
        &mission("spoil step"),
        "x5",
        "1: a engaged, [step cross step], step
         2: step
         3: [spoil], spoil
         4: spoil
         5: step",
    );
}

/// What a sleeping behaviour protects is spared as well. A loop whose only applicable production is
/// doubtful goes on with it.
#[test]
fn a_choice_spares_what_sleepers_protect() {
    let mission = |second: &str| {
        format!(
            "input c
             fact clean set
             action look hold 100
             action step hold 100
             action spoil hold 100; deletes clean
             action call hold 9000
             frame survey
             = look look look; protect clean 0 3
             frame calling
             = call
             frame cross
             = spoil; when always PM
             = {second}; when always PS
             frame work
             = step step step cross
             behaviour a survey; when always ZO; resources 1
             behaviour b work; when always PS; resources 2
             behaviour c calling; when c NB NM NS ZO PS PM PB; resources 1"
        )
    };
    let script = "c=0 x1\nc=0.6667 x5";
    check(
        &mission("step"),
        script,
        "1: b engaged, a engaged, [look look look], [step step step cross], look & step
         2: a interrupted by c, c engaged, [call], step & call
         3: step & call
         4: [step], step & call
         5: b finished, b waits: a excludes it, call
         6: b waits: a excludes it, call",
    );
    let log = crate::bench::log(&mission("spoil cross"), script);
    assert!(log.contains("4: [spoil], spoil & call"), "{log}");
}

/// A behaviour that runs once is not engaged again after it has finished; one that has failed is.
#[test]
fn a_behaviour_that_runs_once_is_not_engaged_again() {
    let mission = |clause: &str| {
        format!(
            "input a
             fact ready symbol
             action step hold 100{clause}
             action other hold 100
             frame work
             = step
             frame else
             = other
             behaviour a work; when always PM; once
             behaviour b else; when always PS"
        )
    };
    check(
        &mission(""),
        "x30",
        "1: a engaged, [step], step
         2: a finished, b engaged, [other], other
         3: b finished, b engaged, [other], other",
    );
    let log = crate::bench::log(&mission("; needs ready"), "x30");
    assert_eq!(log.matches("a failed").count(), 3, "{log}");
}

/// H34: a start-up drives back to the place at which the behaviour was interrupted, and ends at once
/// if it was not.
#[test]
fn a_start_up_returns_to_the_place_left() {
    check(
        "input a
         input b
         action drive goto 20 0
         action back return
         action other goto 0 9
         frame work
         = drive
         frame prepare
         = back
         frame else
         = other
         behaviour a work; when a NB NM NS ZO PS PM PB; start-up prepare
         behaviour b else; when b NB NM NS ZO PS PM PB",
        "a=0.5 b=0 at=0,0 x1
         at=7,3 b=1
         at=5,5 x1
         at=0,9 b=0
         at=4,4 x1
         at=7,3 x2",
        "1: a prepares, [back], a engaged, [drive], drive
         2: a stopped by b, b engaged, [other], other
         3: other
         4: b finished, a prepares, [back], back to 7,3
         5: back to 7,3
         6: a resumed, drive
         7: drive",
    );
}

/// A frame chooses in the tick in which an action ends, and already by the facts that this end changes.
#[test]
fn a_choice_knows_the_facts_of_the_same_tick() {
    check(
        "input fuel
         input full; of fact loaded
         fact loaded symbol
         action load hold 100; adds loaded
         action bring hold 300
         action search hold 300
         frame next
         = bring; when full NB NB NB NB PB PB PB
         = search; when full PB PB PB PB NB NB NB
         frame work
         = load next
         behaviour a work; when fuel PS PS PS PS PS PS PS",
        "fuel=0.5 x4",
        "1: a engaged, [load next], load
         2: [bring], bring
         3: bring",
    );
}
