//! When one behaviour takes over from another (H26, H27, H32, H35, H37, H38).

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

const NESTED: &str = "
    input a
    input b
    input c
    fact gripped symbol
    fact parked symbol
    action grip hold 100; adds gripped
    action carry hold 300
    action put hold 100
    action park hold 100; adds parked
    action wait hold 300
    action leave hold 100
    action open hold 100; deletes gripped
    frame fetch
    = grip carry put; protect gripped 1 3
    frame stand
    = park wait leave; protect parked 1 3
    frame release
    = open
    behaviour fetching fetch; when a NB NM NS ZO PS PM PB
    behaviour standing stand; when b NB NM NS ZO PS PM PB
    behaviour releasing release; when c NB NM NS ZO PS PM PB
";

/// H27, H35: three behaviours; the second interrupts the first. What the first protects excludes
/// the third, which reports this and waits. So the first resumes in place of the third, before the
/// second is done, and finishes what it protects.
#[test]
fn an_excluded_behaviour_names_who_excludes_it_and_lets_it_finish() {
    check(
        NESTED,
        "a=0.3333 b=0 c=0
         b=0.5 x2
         c=0.6667 x12",
        "1: fetching engaged, [grip carry put], grip
         2: fetching interrupted by standing, standing engaged, [park wait leave], park
         3: wait
         4: releasing waits: fetching excludes it, fetching waits: standing is at no point, wait
         6: releasing waits: fetching excludes it, standing interrupted by fetching, fetching resumed, carry
         7: releasing waits: fetching is at no point, carry
         9: releasing waits: fetching is at no point, put
         10: fetching finished, releasing engaged, [open], open
         11: releasing finished, releasing engaged, [open], open",
    );
}

/// H35: above its threshold the excluded behaviour is engaged, and the report names the overruled
/// one, which finds its protection interval violated when it wakes (H28).
#[test]
fn an_urgent_behaviour_overrules_what_excludes_it() {
    check(
        NESTED,
        "a=0.3333 b=0 c=0
         b=0.5 x2
         c=1
         c=0 x2
         b=0 x8",
        "1: fetching engaged, [grip carry put], grip
         2: fetching interrupted by standing, standing engaged, [park wait leave], park
         3: wait
         4: fetching overruled by releasing, standing stopped by releasing, releasing engaged, [open], open
         5: releasing finished, standing resumed, wait
         6: wait
         7: fetching waits: standing is at no point, wait
         8: standing interrupted by fetching, fetching resumed, lost its protection: gripped, [grip carry put], grip
         9: carry
         12: put
         13: fetching finished, fetching engaged, [grip carry put], grip
         14: carry",
    );
}

/// H22, H27: what a sleeping behaviour protects is checked while others have the robot.
#[test]
fn a_violated_interval_of_a_sleeper_is_reported() {
    check(
        "input a
         input b
         fact here near 0 0 5
         action one hold 100
         action two hold 100
         action away goto 50 0
         frame stay
         = one two; protect here 0 2
         frame go
         = away
         behaviour staying stay; when a NB NM NS ZO PS PM PB
         behaviour going go; when b NB NM NS ZO PS PM PB",
        "a=0.3333 b=0 at=0,0 x1
         b=0.5 x2
         at=9,0 x2
         b=0 at=50,0 x3",
        "1: staying engaged, [one two], one
         2: staying interrupted by going, going engaged, [away], away
         3: away
         4: violates what a sleeper protects: here, away
         5: away
         6: going finished, staying resumed, lost its protection: here, [one two], one
         7: lost its protection: here, stay NothingApplicable, staying failed, -
         8: -",
    );
}

/// A sleeping behaviour protects its facts from others only while it is not dormant.
#[test]
fn a_dormant_sleeper_protects_nothing() {
    check(
        NESTED,
        "a=0.3333 b=0 c=0
         b=0.5 x2
         a=0 b=0 c=0.3333 x6",
        "1: fetching engaged, [grip carry put], grip
         2: fetching interrupted by standing, standing engaged, [park wait leave], park
         3: wait
         4: releasing waits: standing is at no point, wait
         6: standing interrupted by releasing, releasing engaged, [open], open
         7: releasing finished, releasing engaged, [open], open",
    );
}

/// Two behaviours that each violate in the end what the other protects from its first step on, and
/// a third that interrupts both.
const CIRCLE: &str = "
    input a
    input b
    input c
    fact seeded set
    fact mown set
    action sow hold 300
    action harrow hold 100; deletes mown
    action mow hold 300
    action rake hold 100; deletes seeded
    action call hold 100
    frame sowing
    = sow sow harrow; protect seeded 0 2
    frame mowing
    = mow mow rake; protect mown 0 2
    frame calling
    = call
    behaviour sower sowing; when a NB NM NS ZO PS PM PB
    behaviour mower mowing; when b NB NM NS ZO PS PM PB
    behaviour caller calling; when c NB NM NS ZO PS PM PB
";

/// H35: a dormant sleeper protects nothing, so another one may be engaged that violates it. When
/// both sleep and are critical again, they exclude each other: the more critical one overrules.
#[test]
fn sleepers_that_exclude_each_other_do_not_lock_the_robot() {
    check(
        CIRCLE,
        "a=0.5 b=0 c=0 x2
         c=0.6667 x2
         a=0 b=0.5 c=0 x2
         c=0.6667 x3
         a=0.6667 c=0 x9",
        "1: sower engaged, [sow sow harrow], sow
         2: sow
         3: caller waits: sower is at no point, sow
         4: sower interrupted by caller, caller engaged, [call], call
         5: caller finished, mower engaged, [mow mow rake], mow
         6: mow
         7: caller waits: mower is at no point, mow
         8: mower interrupted by caller, caller engaged, [call], call
         9: caller finished, caller engaged, [call], call
         10: caller finished, sower waits: mower excludes it, mower waits: sower excludes it, mower overruled by sower, sower resumed, sow
         11: sow
         13: harrow
         14: sower finished, sower engaged, [sow sow harrow], sow
         15: sow",
    );
}

/// A chain of sleepers: the first waits for the second, which waits for the third. The third
/// resumes first, then the second, both at the priority of the first.
#[test]
fn a_chain_of_sleepers_resumes_from_its_end() {
    let chain = "
        input a
        input b
        input c
        input d
        fact x set
        fact y set
        action one hold 100
        action ends-y hold 100; deletes y
        action ends-x hold 100; deletes x
        action call hold 100
        frame first
        = ends-x
        frame second
        = one one ends-y; protect x 0 2
        frame third
        = one one one; protect y 0 2
        frame calling
        = call
        behaviour f first; when a NB NM NS ZO PS PM PB
        behaviour s second; when b NB NM NS ZO PS PM PB
        behaviour t third; when c NB NM NS ZO PS PM PB
        behaviour caller calling; when d NB NM NS ZO PS PM PB
    ";
    check(
        chain,
        "a=0 b=0.3333 c=0 d=0 x1
         d=0.6667 x1
         b=0 c=0.3333 d=0 x1
         d=0.6667 x1
         a=0.5 b=0.3333 d=0 x8",
        "1: s engaged, [one one ends-y], one
         2: s interrupted by caller, caller engaged, [call], call
         3: caller finished, t engaged, [one one one], one
         4: t interrupted by caller, caller engaged, [call], call
         5: caller finished, f waits: s excludes it, s waits: t excludes it, t resumed, one
         6: f waits: s excludes it, t interrupted by s, s resumed, one
         7: s interrupted by f, f engaged, [ends-x], ends-x
         8: f finished, f engaged, [ends-x], ends-x",
    );
}

/// What a shut-down gives up need not be waited for, and is protected no more while its behaviour
/// sleeps; the start-up restores it before the plan goes on.
#[test]
fn a_shut_down_frees_an_interval_and_the_start_up_restores_it() {
    let freeing = CIRCLE
        .replace("behaviour sower sowing;", "behaviour sower sowing; start-up setting; shut-down stowing;")
        .replace("action call", "action set hold 100; adds seeded\naction stow hold 100; deletes seeded\nframe setting\n= set\nframe stowing\n= stow\naction call");
    check(
        &freeing,
        "a=0.5 b=0 c=0 x3
         b=0.6667 x10
         b=0 x6",
        "1: sower prepares, [set], set
         2: sower engaged, [sow sow harrow], sow
         3: sow
         4: mower waits: sower is at no point, sow
         5: sower interrupted by mower, [stow], stow
         6: mower engaged, [mow mow rake], mow
         7: mow
         12: rake
         13: mower finished, mower engaged, [mow mow rake], mow
         14: sower waits: mower is at no point, mow
         19: mower interrupted by sower, sower prepares, [set], set",
    );
}

/// A stand-in keeps the priority of the one for which it goes on, although the two share no
/// resource: the hauler, more critical than the stand-in, does not interrupt it again.
#[test]
fn a_stand_in_keeps_its_priority_where_no_resource_is_shared() {
    check(
        "input a
         input b
         input c
         fact clean set
         action look hold 100
         action haul hold 100
         action spray set 1 on; deletes clean
         frame survey
         = look look look look; protect clean 0 4
         frame hauling
         = haul haul haul haul
         frame spraying
         = spray
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1
         behaviour hauler hauling; when b NB NM NS ZO PS PM PB; resources 1
         behaviour sprayer spraying; when c NB NM NS ZO PS PM PB; resources 2",
        "a=0.3333 b=0 c=0 x1
         b=0.5 x2
         c=0.6667 x7",
        "1: surveyor engaged, [look look look look], look
         2: surveyor interrupted by hauler, hauler engaged, [haul haul haul haul], haul
         3: haul
         4: sprayer waits: surveyor excludes it, hauler interrupted by surveyor, surveyor resumed, look
         5: sprayer waits: surveyor excludes it, look
         7: surveyor finished, sprayer engaged, hauler resumed, [spray], sprayer finished, haul
         8: sprayer engaged, [spray], sprayer finished, haul
         9: hauler finished, sprayer engaged, hauler engaged, [haul haul haul haul], [spray], sprayer finished, haul
         10: sprayer engaged, [spray], sprayer finished, haul",
    );
}

/// What one engaged behaviour does to what another protects is judged while both run: an action
/// that would violate it at its end waits there, and a further one does not start.
#[test]
fn an_engaged_behaviour_does_not_violate_what_another_one_protects() {
    check(
        "input a
         input b
         fact clean symbol
         action wash hold 100; adds clean
         action look hold 300
         action spray hold 200; deletes clean
         frame survey
         = wash look look; protect clean 1 3
         frame spraying
         = spray spray
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1
         behaviour sprayer spraying; when b NB NM NS ZO PS PM PB; resources 2",
        "a=0.3333 b=0.5 x12",
        "1: sprayer engaged, surveyor engaged, [wash look look], [spray spray], wash & spray
         2: look & spray
         3: sprayer waits: surveyor excludes it, look & spray
         8: surveyor finished, surveyor engaged, [wash look look], wash & spray
         9: look & spray
         10: sprayer waits: surveyor excludes it, look & spray",
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

/// H28: if several frames deviate when a plan wakes, the outermost starts again, and only that one.
#[test]
fn of_several_deviations_the_outermost_starts_again() {
    check(
        "input a
         input b
         fact here set
         action one hold 200
         action two hold 200
         action away hold 100; deletes here
         frame inner
         = one two; protect here 0 2
         frame work
         = one inner; protect here 0 2
         frame else
         = away
         behaviour a work; when a NB NM NS ZO PS PM PB
         behaviour b else; when b NB NM NS ZO PS PM PB",
        "a=0.5 b=0 x5
         b=1 x2
         b=0 x2",
        "1: a engaged, [one inner], one
         2: one
         3: [one two], one
         4: one
         5: two
         6: a stopped by b, b engaged, [away], away
         7: b finished, b engaged, [away], away
         8: b finished, a resumed, lost its protection: here, [one inner], one
         9: lost its protection: here, work NothingApplicable, a failed, -",
    );
}

/// H22, H34: what a start-up or a shut-down may violate counts as much as what the plan may.
#[test]
fn the_effects_of_activities_exclude_too() {
    for clause in ["start-up soiling", "shut-down soiling"] {
        let mission = format!(
            "input a
             input b
             input c
             fact clean set
             action look hold 200
             action soil hold 100; deletes clean
             action call hold 100
             action other hold 100
             frame soiling
             = soil
             frame survey
             = look look look; protect clean 0 3
             frame calling
             = call
             frame else
             = other
             behaviour surveyor survey; when a NB NM NS ZO PS PM PB
             behaviour caller calling; when b NB NM NS ZO PS PM PB
             behaviour taker else; when c NB NM NS ZO PS PM PB; {clause}"
        );
        let log = crate::bench::log(
            &mission,
            "a=0.3333 b=0 c=0 x1
             b=0.5 x2
             b=0 c=0.6667 x3",
        );
        assert!(log.contains("taker waits: surveyor excludes it"), "{clause}\n{log}");
    }
}

/// A protected fact with `not` is violated by what makes the fact true.
#[test]
fn what_must_not_hold_is_protected_too() {
    let log = crate::bench::log(
        "input a
         input b
         input c
         fact open symbol
         action look hold 200
         action call hold 100
         action unlock hold 100; adds open
         frame survey
         = look look look; protect !open 0 3
         frame calling
         = call
         frame unlocking
         = unlock
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB
         behaviour caller calling; when b NB NM NS ZO PS PM PB
         behaviour taker unlocking; when c NB NM NS ZO PS PM PB",
        "a=0.3333 b=0 c=0 x1
         b=0.5 x2
         b=0 c=0.6667 x3",
    );
    assert!(log.contains("taker waits: surveyor excludes it"), "{log}");
}
