//! Behaviours that run together (H30, H31), and the bounds.

use crate::bench::{Robot, blob, check};
use monitor::{Node, Relation};
use proptest::prelude::*;

const THREE: &str = "
    input a
    input b
    input c
    action drive hold 300
    action look hold 200
    action both hold 200
    frame driving
    = drive driving
    frame looking
    = look looking
    frame all
    = both
    behaviour driver driving; when a NB NM NS ZO PS PM PB; resources 1
    behaviour looker looking; when b NB NM NS ZO PS PM PB; resources 2
    behaviour taker all; when c NB NM NS ZO PS PM PB; resources 3
";

/// H31: behaviours that share no resource run together.
#[test]
fn behaviours_that_share_nothing_run_together() {
    check(
        THREE,
        "a=0.5 b=0.3333 c=0 x7",
        "1: driver engaged, looker engaged, [drive driving], [look looking], drive & look
         2: drive & look
         3: [look looking], drive & look
         4: [drive driving], drive & look
         5: [look looking], drive & look
         6: drive & look
         7: [drive driving], [look looking], drive & look",
    );
}

/// If a behaviour needs the resources of two others, each yields at its own point: for a long time
/// they have no common point.
#[test]
fn several_in_the_way_yield_one_after_the_other() {
    check(THREE, "a=0.5 b=0.3333 c=0\nc=0.6667 x5\nc=0 x3", "1: driver engaged, looker engaged, [drive driving], [look looking], drive & look
         2: taker waits: driver is at no point, taker waits: looker is at no point, drive & look
         3: taker waits: driver is at no point, looker interrupted by taker, drive
         4: driver interrupted by taker, taker engaged, [both], both
         5: both
         6: taker finished, taker engaged, [both], both
         7: driver waits: taker is at no point, looker waits: taker is at no point, both
         8: taker finished, driver resumed, looker resumed, [drive driving], [look looking], drive & look
         9: drive & look");
}

/// No behaviour is put to sleep while the minimum dwell of another one would still block the claim.
#[test]
fn none_yields_while_another_may_not() {
    let dwelling = THREE.replace("resources 1", "resources 1; dwell 900");
    check(&dwelling, "a=0.5 b=0.3333 c=0\nc=0.6667 x9", "1: driver engaged, looker engaged, [drive driving], [look looking], drive & look
         2: taker waits: driver has just begun, taker waits: looker is at no point, drive & look
         3: taker waits: driver has just begun, [look looking], drive & look
         4: taker waits: driver has just begun, taker waits: looker is at no point, [drive driving], drive & look
         5: taker waits: driver has just begun, [look looking], drive & look
         6: taker waits: driver has just begun, taker waits: looker is at no point, drive & look
         7: taker waits: driver has just begun, [drive driving], [look looking], drive & look
         8: taker waits: driver has just begun, taker waits: looker is at no point, drive & look
         9: taker waits: driver has just begun, [look looking], drive & look
         10: taker waits: looker is at no point, driver interrupted by taker, look");
}

/// While a behaviour waits for one resource, others use the other resources that it needs.
#[test]
fn who_waits_for_the_heavier_blocks_nobody_else() {
    check(
        THREE,
        "a=0.6667 b=0 c=0.5 x1\nb=0.3333 x2",
        "1: driver engaged, [drive driving], drive
         2: looker engaged, [look looking], drive & look
         3: drive & look",
    );
}

/// H05: parallel edges start in one tick and join. At most eight actions run at once; the others
/// wait.
#[test]
fn at_most_eight_actions_run_at_once() {
    check(
        "input a
         action step hold 100
         action end signal 7
         frame work
         = step|step|step|step|step|step|step|step|end|step end
         behaviour a work; when always PS",
        "x4",
        "1: a engaged, [step|step|step|step|step|step|st], step & step & step & step & step & step & step
         2: step & end & step
         3: end
         4: a finished, a engaged, [step|step|step|step|step|step|st], step & step & step & step & step & step & step",
    );
}

/// H43: at most eight steps per tick, so a plan of many actions that end at once takes several
/// ticks.
#[test]
fn steps_in_a_tick_are_bounded() {
    check(
        "input a
         action on set 1 on
         action off set 1 off
         action end signal 7
         frame work
         = on off on off on off on off on off end
         behaviour a work; when always PS",
        "x3",
        "1: a engaged, [on off on off on off on off on o], -
         2: end
         3: a finished, a engaged, [on off on off on off on off on o], -",
    );
}

/// A plan that is too deep, or too large for the pool, fails with a reason.
#[test]
fn what_finds_no_room_fails_with_a_reason() {
    check(
        "input a
         action step hold 100
         frame deep
         = deep step
         behaviour a deep; when always PS",
        "x2",
        "1: a engaged, [deep step], [deep step], [deep step], [deep step], [deep step], [deep step], [deep step], deep TooDeep, -
         2: deep NothingApplicable, deep NothingApplicable, deep NothingApplicable, deep NothingApplicable, deep NothingApplicable, deep NothingApplicable, deep NothingApplicable, a failed, -",
    );
    check(
        "input a
         action step hold 100
         frame wide
         = step|step|step|step|step|step|step|step|step|step|step|step|step|step|step
         behaviour a wide; when always PS; resources 1
         behaviour b wide; when always PS; resources 2
         behaviour c wide; when always PS; resources 4
         behaviour d wide; when always PS; resources 8",
        "x1",
        "1: a engaged, b engaged, c engaged, d engaged, [step|step|step|step|step|step|st], [step|step|step|step|step|step|st], wide NoRoom, c failed, [step|step|step|step|step|step|st], step & step & step & step & step & step & step & step",
    );
}

/// Productions of four stages of up to three components, over short and long actions and a frame.
fn random_productions() -> impl Strategy<Value = String> {
    let part = prop::sample::select(vec!["short", "long", "inner"]);
    let stage = prop::collection::vec(part, 1..4).prop_map(|parts| parts.join("|"));
    prop::collection::vec(stage, 1..4).prop_map(|stages| stages.join(" "))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// H18: two components run at the same time only if the grid has no entry for them: no path of
    /// the graph leads from one to the other.
    #[test]
    fn h18_only_components_without_order_run_at_once(outer in random_productions()) {
        let bytes = blob(&format!(
            "input a
             action short hold 100
             action long hold 300
             action last hold 200
             frame work
             = {outer}
             frame inner
             = long short|last long
             behaviour a work; when always PS"
        ));
        let mut robot = Robot::new(&bytes);
        for _ in 0..30 {
            robot.go("x1");
            let grid = robot.behaviours.grid();
            for (at, one) in robot.running.iter().enumerate() {
                for other in &robot.running[..at] {
                    let [x, y] = [one, other].map(|part| Node::from(part.component));
                    let relation = grid.relation(&robot.mission, x, y);
                    prop_assert_eq!(relation, Some(Relation::NE), "{}", outer);
                }
            }
        }
    }
}
