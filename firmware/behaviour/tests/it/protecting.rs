//! What behaviours protect from each other, asleep and engaged (H22, H27, H28, H34, H35).

use crate::bench::check;

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

/// An action that would violate at its end what another engaged behaviour protects does not begin. Its
/// behaviour sleeps until the other one has finished; while a parallel action of it runs, it waits.
#[test]
fn an_action_that_would_violate_what_another_one_protects_does_not_begin() {
    let mission = |plan: &str| {
        format!(
            "input a
             input b
             fact clean symbol
             action wash hold 100; adds clean
             action look hold 200
             action step hold 200
             action long hold 600
             action spray hold 100; deletes clean
             frame survey
             = wash look look; protect clean 1 3
             frame spraying
             = {plan}
             behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1
             behaviour sprayer spraying; when b NB NM NS ZO PS PM PB; resources 2"
        )
    };
    let script = "a=0.3333 b=0.5\na=0 x7";
    check(
        &mission("step spray"),
        script,
        "1: sprayer engaged, surveyor engaged, [wash look look], [step spray], wash & step
         2: look & step
         3: sprayer waits: surveyor excludes it, look
         4: sprayer interrupted by surveyor, look
         5: sprayer waits: surveyor excludes it, look
         6: surveyor finished, sprayer resumed, spray
         7: sprayer finished, sprayer engaged, [step spray], step
         8: step",
    );
    check(
        &mission("long|branch\n             frame branch\n             = step spray"),
        script,
        "1: sprayer engaged, surveyor engaged, [wash look look], [long|branch], [step spray], wash & long & step
         2: look & long & step
         3: sprayer waits: surveyor excludes it, look & long
         6: surveyor finished, long & spray
         7: sprayer finished, sprayer engaged, [long|branch], [step spray], long & step
         8: long & step",
    );
}

/// What a start-up protects while it runs excludes others too.
#[test]
fn a_start_up_protects_its_interval() {
    check(
        "input a
         input b
         fact clean symbol
         action wash hold 100; adds clean
         action look hold 200
         action step hold 200
         action spray hold 100; deletes clean
         frame prepare
         = wash look look; protect clean 1 3
         frame survey
         = step step
         frame spraying
         = step spray
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1; start-up prepare
         behaviour sprayer spraying; when b NB NM NS ZO PS PM PB; resources 2",
        "a=0.3333 b=0.5\na=0 x8",
        "1: sprayer engaged, surveyor prepares, [wash look look], [step spray], wash & step
         2: look & step
         3: sprayer waits: surveyor excludes it, look
         4: sprayer interrupted by surveyor, look
         5: sprayer waits: surveyor excludes it, look
         6: surveyor engaged, sprayer resumed, [step step], step & spray
         7: sprayer finished, sprayer engaged, [step spray], step & step
         8: step & step
         9: step & spray",
    );
}

/// A start-up that protects nothing lets others change what they like.
#[test]
fn a_start_up_without_an_interval_excludes_none() {
    check(
        "input a
         input b
         fact clean set
         action look hold 200
         action spray hold 100; deletes clean
         frame prepare
         = look look
         frame survey
         = look
         frame spraying
         = spray
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1; start-up prepare
         behaviour sprayer spraying; when b NB NM NS ZO PS PM PB; resources 2",
        "a=0.5 b=0 x1\nb=0.3333 x1",
        "1: surveyor prepares, [look look], look
         2: sprayer engaged, [spray], look & spray",
    );
}

/// A sleeper of whose facts one is violated protects the others still.
#[test]
fn what_is_not_violated_stays_protected() {
    let log = crate::bench::log(
        "input a
         input b
         input c
         fact here near 0 0 5
         fact calm set
         action look hold 200
         action call hold 900
         action shout hold 100; deletes calm
         frame survey
         = look look look; protect here calm 0 3
         frame calling
         = call
         frame shouting
         = shout
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB
         behaviour caller calling; when b NB NM NS ZO PS PM PB
         behaviour shouter shouting; when c NB NM NS ZO PS PM PB; resources 2",
        "a=0.3333 b=0 c=0 at=0,0 x1
         b=0.5 x2
         at=9,0 x1
         c=0.6667 x1",
    );
    assert!(log.contains("4: violates what a sleeper protects: here"), "{log}");
    assert!(log.contains("5: shouter waits: surveyor excludes it"), "{log}");
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

/// The mission of the next tests: the sprayer soils at the end what the surveyor keeps clean. `more`
/// are further behaviours.
fn spraying(plan: &str, more: &str) -> String {
    format!(
        "input a
         input b
         input c
         fact clean symbol
         action wash hold 100; adds clean
         action look hold 100
         action step hold 200
         action long hold 600
         action haul hold 100
         action spray hold 100; deletes clean
         frame survey
         = wash look look look look; protect clean 1 5
         frame spraying
         = {plan}
         frame hauling
         = haul haul haul
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1
         behaviour sprayer spraying; when b NB NM NS ZO PS PM PB; resources 2
         {more}"
    )
}

/// The surveyor goes first only while the sprayer waits for it. Before that, any more critical
/// behaviour takes its place.
#[test]
fn who_protects_goes_first_only_while_another_one_waits_for_it() {
    let hauler = "behaviour hauler hauling; when c NB NM NS ZO PS PM PB; resources 1";
    check(
        &spraying("long spray", hauler),
        "a=0.3333 b=0.6667 c=0 x2\nc=0.5 x3",
        "1: sprayer engaged, surveyor engaged, [wash look look look look], [long spray], wash & long
         2: look & long
         3: surveyor interrupted by hauler, hauler engaged, [haul haul haul], long & haul
         4: long & haul",
    );
    check(
        &spraying("step spray", hauler),
        "a=0.3333 b=0.6667 c=0 x3\nc=0.5 x3",
        "1: sprayer engaged, surveyor engaged, [wash look look look look], [step spray], wash & step
         2: look & step
         3: sprayer waits: surveyor excludes it, look
         4: sprayer interrupted by surveyor, look
         5: sprayer waits: surveyor excludes it, look
         6: surveyor finished, sprayer resumed, hauler engaged, [haul haul haul], spray & haul",
    );
}

/// One branch is done and waits with its end, the other waits with its beginning: who protects goes
/// first all the same.
#[test]
fn who_protects_goes_first_for_one_that_waits_twice() {
    let mission = spraying(
        "slow|branch\n         frame branch\n         = step spray",
        "behaviour hauler hauling; when c NB NM NS ZO PS PM PB; resources 1",
    );
    check(
        &mission
            .replace("action haul", "action slow hold 200; deletes clean\n         action haul"),
        "a=0.3333 b=0.6667 c=0 x3\nc=0.5 x4",
        "1: sprayer engaged, surveyor engaged, [wash look look look look], [slow|branch], [step spray], wash & slow & step
         2: look & slow & step
         3: sprayer waits: surveyor excludes it, sprayer waits: surveyor excludes it, look & slow
         6: surveyor finished, hauler engaged, [haul haul haul], spray & haul
         7: sprayer finished, sprayer engaged, [slow|branch], [step spray], slow & step & haul",
    );
}

/// A behaviour that waits with an action running keeps its resources.
#[test]
fn a_behaviour_that_waits_keeps_its_resources() {
    check(
        &spraying(
            "long|branch\n         frame branch\n         = step spray",
            "behaviour hauler hauling; when c NB NM NS ZO PS PM PB; resources 2",
        ),
        "a=0.3333 b=0.6667 c=0.5 x7",
        "1: sprayer engaged, surveyor engaged, [wash look look look look], [long|branch], [step spray], wash & long & step
         2: look & long & step
         3: sprayer waits: surveyor excludes it, look & long
         6: surveyor finished, long & spray
         7: sprayer finished, sprayer engaged, surveyor engaged, [wash look look look look], [long|branch], [step spray], wash & long & step",
    );
}

/// One that waits and becomes urgent overrules what the other one protects, and is not put to sleep.
#[test]
fn a_behaviour_that_waits_goes_on_when_it_becomes_urgent() {
    check(&spraying("step spray", ""), "a=0.3333 b=0.5 x3\nb=1 x2",
        "1: sprayer engaged, surveyor engaged, [wash look look look look], [step spray], wash & step
         2: look & step
         3: sprayer waits: surveyor excludes it, look
         4: look & spray
         5: sprayer finished, surveyor overruled by sprayer, sprayer engaged, [step spray], look & step");
}

/// A behaviour that waits for a sleeper does not hold up those that have nothing to do with either:
/// their actions that take no time follow each other in one tick.
#[test]
fn who_waits_does_not_delay_others() {
    check(
        "input a
         input b
         input c
         fact clean set
         action look hold 100
         action haul hold 300
         action blink set 3 on
         action rest hold 100
         action spray hold 100; deletes clean
         frame survey
         = look look look; protect clean 0 3
         frame hauling
         = haul
         frame blinking
         = blink blink blink rest
         frame spraying
         = spray
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1
         behaviour hauler hauling; when b NB NM NS ZO PS PM PB; resources 1
         behaviour sprayer spraying; when c NB NM NS ZO PS PM PB; resources 2
         behaviour blinker blinking; when always PS; resources 4",
        "a=0.3333 b=0 c=0 x1
         b=0.5 x2
         c=0.4 x3",
        "1: blinker engaged, surveyor engaged, [look look look], [blink blink blink rest], look & rest
         2: blinker finished, blinker engaged, surveyor interrupted by hauler, hauler engaged, [haul], [blink blink blink rest], haul & rest
         3: blinker finished, blinker engaged, [blink blink blink rest], haul & rest
         4: blinker finished, blinker engaged, sprayer waits: surveyor excludes it, [blink blink blink rest], haul & rest
         5: hauler finished, blinker finished, blinker engaged, hauler engaged, sprayer waits: surveyor excludes it, [haul], [blink blink blink rest], haul & rest
         6: blinker finished, blinker engaged, sprayer waits: surveyor excludes it, [blink blink blink rest], haul & rest",
    );
}

/// The sprayer waits for a sleeping surveyor, which in turn would wet what the keeper keeps dry. So the
/// keeper goes first, at the sprayer's priority, and the sprayer overrules neither.
#[test]
fn a_chain_of_behaviours_that_wait_ends_at_one_that_goes_on() {
    check(
        "input a
         input b
         input c
         input d
         input e
         fact clean set
         fact dry set
         action look hold 100
         action mop hold 100; deletes dry
         action haul hold 900
         action keep hold 100
         action spray hold 100; deletes clean
         frame survey
         = look look mop; protect clean 0 3
         frame hauling
         = haul
         frame keeping
         = keep keep keep keep keep; protect dry 0 5
         frame spraying
         = spray
         behaviour surveyor survey; when a NB NM NS ZO PS PM PB; resources 1
         behaviour hauler hauling; when b NB NM NS ZO PS PM PB; resources 1
         behaviour keeper keeping; when c NB NM NS ZO PS PM PB; resources 4
         behaviour sprayer spraying; when d NB NM NS ZO PS PM PB; resources 2
         behaviour rival hauling; when e NB NM NS ZO PS PM PB; resources 4",
        "a=0.3333 b=0 c=0 d=0 e=0 x1
         b=0.5 x1
         b=0 c=0.3333 x1
         d=0.6667 e=0.5 x9",
        "1: surveyor engaged, [look look mop], look
         2: surveyor interrupted by hauler, hauler engaged, [haul], haul
         3: surveyor waits: hauler is at no point, keeper engaged, [keep keep keep keep keep], haul & keep
         4: sprayer waits: surveyor excludes it, surveyor waits: keeper excludes it, haul & keep
         8: keeper finished, sprayer waits: surveyor excludes it, surveyor waits: hauler is at no point, rival engaged, [haul], haul & haul
         9: sprayer waits: surveyor excludes it, surveyor waits: hauler is at no point, haul & haul
         11: hauler finished, sprayer waits: surveyor excludes it, surveyor resumed, look & haul
         12: sprayer waits: surveyor excludes it, mop & haul",
    );
}

/// Of two behaviours whose actions would each violate at their ends what the other one protects, one
/// waits and the other one goes on. Their protection began while these actions were running.
#[test]
fn of_two_that_wait_for_each_other_one_goes_on() {
    check(
        "input a
         input b
         fact one symbol
         fact two symbol
         action long hold 200; deletes two
         action set hold 100; adds one
         action look hold 600
         action slow hold 200; deletes one
         action put hold 100; adds two
         action see hold 600
         frame looking
         = set look; protect one 1 2
         frame seeing
         = put see; protect two 1 2
         frame left
         = long|looking
         frame right
         = slow|seeing
         behaviour a left; when a NB NM NS ZO PS PM PB; resources 1
         behaviour b right; when b NB NM NS ZO PS PM PB; resources 2",
        "a=0.5 b=0.4 x6",
        "1: a engaged, b engaged, [long|looking], [set look], [slow|seeing], [put see], long & set & slow & put
         2: long & look & slow & see
         3: a waits: b excludes it, long & look & see
         4: lost its protection: one, a waits: b excludes it, looking NothingApplicable, left NothingApplicable, a failed, see
         5: see",
    );
}

/// A sleeping behaviour protects also that a fact does not hold. Of two such facts, it gives up the one
/// that is violated and keeps the other one.
#[test]
fn a_sleeper_protects_what_must_not_hold() {
    check(
        "input a
         input b
         input c
         input d
         fact open symbol
         fact lit level d 0.5 1
         action look hold 100
         action pass hold 100
         action unlock hold 100; adds open
         frame guarding
         = look look look; protect !open !lit 0 3
         frame passing
         = pass
         frame opening
         = unlock
         behaviour guard guarding; when a NB NM NS ZO PS PM PB
         behaviour passer passing; when b NB NM NS ZO PS PM PB
         behaviour opener opening; when c NB NM NS ZO PS PM PB",
        "a=0.5 b=0 c=0 d=0 x1
         b=0.7 x1
         d=1 x1
         b=0 c=0.7 d=0 x6",
        "1: guard engaged, [look look look], look
         2: guard interrupted by passer, passer engaged, [pass], pass
         3: passer finished, violates what a sleeper protects: lit, passer engaged, [pass], pass
         4: passer finished, opener waits: guard excludes it, guard resumed, look
         5: opener waits: guard is at no point, look
         6: guard finished, opener engaged, [unlock], unlock
         7: opener finished, opener engaged, [unlock], unlock",
    );
}

/// A shelter whose end violates what a beacon protects. The beacon's plan is short, and it is always
/// critical.
fn sheltering(beacon: &str, more: &str) -> String {
    format!(
        "input a
         input b
         input c
         fact up set
         action fold hold 300; deletes up
         action ping hold 200
         action look hold 300
         frame shelter
         = fold
         frame beacon
         {beacon}
         frame survey
         = look
         behaviour sheltering shelter; when a NB NM NS ZO PS PM PB; resources 1
         behaviour signalling beacon; when b NB NM NS ZO PS PM PB; resources 2
         {more}"
    )
}

/// A beacon that begins anew as soon as it has ended, in its plan or by a loop, does not keep a more
/// critical behaviour from ending: it waits for one end, not for all.
#[test]
fn who_is_awaited_does_not_begin_again_before_the_one_that_waits() {
    check(
        &sheltering("= ping; protect up 0 1", ""),
        "a=0 b=0.3333 c=0 x1\na=0.6667 x7",
        "1: signalling engaged, [ping], ping
         2: sheltering waits: signalling excludes it, ping
         3: signalling finished, sheltering engaged, signalling engaged, [fold], [ping], fold & ping
         4: fold & ping
         5: signalling finished, signalling engaged, [ping], fold & ping
         6: sheltering waits: signalling excludes it, fold & ping
         7: sheltering waits: signalling excludes it, signalling finished, fold
         8: sheltering finished, sheltering engaged, signalling engaged, [fold], [ping], fold & ping",
    );
    check(
        &sheltering("= ping beacon; protect up 0 1", ""),
        "a=0 b=0.3333 c=0 x1\na=0.6667 x7",
        "1: signalling engaged, [ping beacon], ping
         2: sheltering waits: signalling excludes it, ping
         3: sheltering engaged, [fold], [ping beacon], fold & ping
         4: fold & ping
         5: [ping beacon], fold & ping
         6: sheltering waits: signalling excludes it, fold & ping
         7: sheltering waits: signalling excludes it, fold
         8: sheltering finished, sheltering engaged, [fold], [ping beacon], fold & ping",
    );
}

/// Two others are in the way, one by a resource and one by what it protects, and never end in the same
/// tick. Each stays away once it has ended.
#[test]
fn two_in_the_way_need_not_end_at_once() {
    let survey = "behaviour surveying survey; when c NB NM NS ZO PS PM PB; resources 1";
    check(
        &sheltering("= ping; protect up 0 1", survey),
        "a=0 b=0.3333 c=0.5 x2\na=0.6667 x9",
        "1: surveying engaged, signalling engaged, [ping], [look], ping & look
         2: ping & look
         3: signalling finished, sheltering waits: surveying is at no point, signalling engaged, [ping], ping & look
         4: surveying finished, sheltering waits: signalling excludes it, ping
         5: signalling finished, sheltering engaged, signalling engaged, [fold], [ping], fold & ping
         6: fold & ping
         7: signalling finished, signalling engaged, [ping], fold & ping
         8: sheltering waits: signalling excludes it, fold & ping
         9: sheltering waits: signalling excludes it, signalling finished, fold
         10: sheltering finished, sheltering engaged, signalling engaged, [fold], [ping], fold & ping
         11: lost its protection: up, beacon NothingApplicable, signalling failed, fold",
    );
}

/// The same with two that go on and on: one needs the resource, one protects. And with two that protect.
#[test]
fn two_in_the_way_that_go_on_and_on_are_passed_too() {
    let survey = "behaviour surveying survey; when c NB NM NS ZO PS PM PB; resources 1";
    let endless = sheltering("= ping beacon; protect up 0 1", survey);
    let endless = endless.replace("= look", "= look survey");
    check(
        &endless,
        "a=0 b=0.3333 c=0.5 x2\na=0.6667 x11",
        "1: surveying engaged, signalling engaged, [ping beacon], [look survey], ping & look
         2: ping & look
         3: sheltering waits: surveying is at no point, [ping beacon], ping & look
         4: sheltering waits: signalling excludes it, [look survey], ping & look
         5: sheltering waits: surveying is at no point, look
         7: surveying interrupted by sheltering, sheltering engaged, [fold], [ping beacon], fold & ping
         8: fold & ping
         9: [ping beacon], fold & ping
         10: sheltering waits: signalling excludes it, fold & ping
         11: sheltering waits: signalling excludes it, fold
         12: sheltering finished, sheltering engaged, [fold], [ping beacon], fold & ping
         13: lost its protection: up, beacon NothingApplicable, signalling failed, fold");
    let flag = "frame flag
         = wait flag; protect up 0 1
         action wait hold 300
         behaviour flagging flag; when c NB NM NS ZO PS PM PB; resources 4";
    let both = sheltering("= ping beacon; protect up 0 1", flag);
    check(
        &both,
        "a=0 b=0.3333 c=0.5 x2\na=0.6667 x11",
        "1: flagging engaged, signalling engaged, [ping beacon], [wait flag], ping & wait
         2: ping & wait
         3: sheltering waits: flagging excludes it, [ping beacon], ping & wait
         4: sheltering waits: signalling excludes it, ping
         5: sheltering engaged, [fold], [ping beacon], [wait flag], fold & ping & wait
         6: fold & ping & wait
         7: [ping beacon], fold & ping & wait
         8: sheltering waits: signalling excludes it, sheltering waits: flagging excludes it, [wait flag], fold & ping & wait
         9: sheltering waits: signalling excludes it, sheltering waits: flagging excludes it, fold & wait
         10: sheltering waits: flagging excludes it, fold & wait
         11: sheltering waits: flagging excludes it, fold
         12: sheltering finished, sheltering engaged, [fold], [ping beacon], [wait flag], fold & ping & wait
         13: lost its protection: up, lost its protection: up, beacon NothingApplicable, signalling failed, flag NothingApplicable, flagging failed, fold");
}

/// A done action whose end others forbid fails after its timeout, like any other. The beacon does not
/// come to an end.
#[test]
fn an_action_that_waits_at_its_end_has_a_timeout() {
    let endless =
        sheltering("= ping; protect up 0 1", "").replace("ping hold 200", "ping hold 9000");
    let endless = endless.replace("fold hold 300", "fold hold 300; timeout 600");
    check(
        &endless,
        "a=0.6667 b=0 x1\nb=0.3333 x9",
        "1: sheltering engaged, [fold], fold
         2: signalling engaged, [ping], fold & ping
         3: fold & ping
         4: sheltering waits: signalling excludes it, fold & ping
         8: sheltering waits: signalling excludes it, fold timed out, shelter NothingApplicable, sheltering failed, ping
         9: ping",
    );
}

/// From its unconditional threshold on a behaviour does not wait for less critical ones. A more critical
/// one it does not interrupt, whatever that one's threshold is.
#[test]
fn an_urgent_behaviour_waits_for_a_more_critical_one() {
    let mission = "
        input a
        input b
        action step hold 200
        action stride hold 300
        frame steps
        = step step
        frame strides
        = stride stride
        behaviour low steps; when a NB NM NS ZO PS PM PB; resources 1; unconditional 0.6
        behaviour high strides; when b NB NM NS ZO PS PM PB; resources 1
    ";
    check(
        mission,
        "a=0.6667 b=0.8333 x4\nb=0 x3\nb=0.8333 x3",
        "1: high engaged, [stride stride], stride
         2: stride
         5: high stopped by low, low engaged, [step step], step
         6: step
         8: high waits: low is at no point, step
         9: low finished, high resumed, stride
         10: stride",
    );
}
