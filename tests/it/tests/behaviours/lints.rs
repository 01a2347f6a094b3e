//! Messages about missions that compile but would fail.

use super::{check, compiled};

/// Inputs and actions for short missions.
const WORLD: &str = r#"
[inputs]
fuel = { source = "fuel", missing = { then = 0 } }
battery = { source = "battery", missing = { then = 0 } }
[actions]
drive = { do = "follow gate", timeout_s = 10 }
wait = { do = "hold 5 s" }
beep = { do = "signal 1" }
"#;

#[track_caller]
fn in_world(name: &str, text: &str) {
    check(name, &format!("{WORLD}{text}"));
}

#[test]
fn thresholds() {
    in_world(
        "lint_thresholds",
        r#"
[frames.work]
threshold = 0.99
productions = [{ graph = "entry -> drive -> wait -> beep -> exit", applicable = { battery = "NB PB PB PB PB PB PB" } }]
[behaviours.work]
criticality = { fuel = "NB NB PB PB PB PB PB" }
dormant = 0.01
unconditional = 0.94
[behaviours.other]
plan = "work"
criticality = { fuel = "NB NB PB PB PB PB PB" }
dormant = 0.8
unconditional = 0.7
"#,
    );
}

#[test]
fn h02_behaviours_that_never_run_and_productions_never_applicable() {
    in_world(
        "lint_never_runs",
        r#"
[frames.work]
productions = [
  { name = "never", graph = "entry -> drive -> exit", applicable = { battery = "NB NB NB NB NB NB NB" } },
  { name = "always", graph = "entry -> wait -> beep -> exit" },
]
[behaviours.asleep]
plan = "work"
criticality = { fuel = "NB NB NB NB NB NB NB" }
"#,
    );
    in_world(
        "lint_never_first",
        r#"
[frames.work]
productions = ["entry -> drive -> wait -> beep -> exit"]
[behaviours.first]
plan = "work"
criticality = { fuel = "PM PM PM PM PM PM PM" }
[behaviours.second]
plan = "work"
criticality = { fuel = "PS PS PS PS PS PS PS", battery = "PS PS PS PS PS PS PS" }
"#,
    );
}

#[test]
fn h07_loops_that_grow_or_never_end() {
    in_world(
        "lint_recursion",
        r#"
[facts]
safe = true
[frames.middle]
productions = ["entry -> middle -> drive -> exit"]
[frames.beside]
productions = ["entry -> (beep | beside) -> exit"]
[frames.spanned]
productions = [{ graph = "entry -> drive -> spanned -> exit", protect = ["safe from drive to spanned"] }]
[behaviours.a]
plan = "spanned"
criticality = { fuel = "PM PM PM PM PM PM PM", battery = "NB NB NB NB NB NB NB" }
"#,
    );
    // The loop keeps each frame with constraints in the plan once: `outer`, `inner`, `outer`.
    in_world(
        "lint_recursion_with_constraints",
        r#"
[facts]
safe = true
[frames.outer]
productions = [{ graph = "entry -> wait -> inner -> exit", applicable = { fuel = "NB NB PB PB PB PB PB" } }]
[frames.inner]
goal = ["safe"]
productions = ["entry -> drive -> outer -> exit"]
[behaviours.a]
plan = "outer"
criticality = { fuel = "PM PM PM PM PM PM PM", battery = "NB NB NB NB NB NB NB" }
"#,
    );
    in_world(
        "lint_recursion_too_deep",
        r#"
[frames.one]
max_speed = 1
productions = ["entry -> wait -> two -> exit", "entry -> wait -> three -> exit", "entry -> wait -> four -> exit"]
[frames.two]
max_speed = 2
productions = ["entry -> wait -> one -> exit", "entry -> wait -> three -> exit"]
[frames.three]
max_speed = 3
productions = ["entry -> wait -> one -> exit", "entry -> wait -> two -> exit"]
[frames.four]
max_speed = 4
productions = ["entry -> wait -> one -> exit"]
[behaviours.a]
plan = "one"
criticality = { fuel = "PM PM PM PM PM PM PM", battery = "NB NB NB NB NB NB NB" }
"#,
    );
    in_world(
        "lint_never_ends",
        r#"
[frames.patrol]
productions = ["entry -> drive -> wait -> beep -> patrol -> exit"]
[behaviours.patrol]
criticality = { fuel = "NB NB PM PM PM PM PM", battery = "PM PM PM PM PM PM PM" }
"#,
    );
}

/// The situations of a fact in rules are that it holds and that it does not hold.
#[test]
fn facts_in_rules() {
    in_world(
        "lint_facts_in_rules",
        r#"
[facts]
loaded = false
[frames.fetch]
add = ["loaded"]
productions = ["entry -> drive -> exit"]
[frames.bring]
delete = ["loaded"]
productions = [
  { graph = "entry -> drive -> exit", applicable = { loaded = "NB PB" } },
  { name = "never", graph = "entry -> wait -> exit", applicable = { loaded = "NB NM" }, inference = "product" },
]
threshold = 0.3
[behaviours.fetch]
criticality = { loaded = "PM NB" }
dwell_s = 0
[behaviours.bring]
criticality = { loaded = "NB PM", fuel = "PB PB PB PB PB PB PB" }
dwell_s = 0
[behaviours.never]
plan = "bring"
criticality = { loaded = "NB NB" }
"#,
    );
}

/// A loop that its frame's `until` ends, and one that only a timeout ends. The symbol that ends
/// one of them is never added.
#[test]
fn frames_that_end() {
    in_world(
        "lint_frames_that_end",
        r#"
[facts]
done = false
low = { input = "fuel", at_most = 0.2 }
[frames.patrol]
until = ["low"]
productions = ["entry -> drive -> wait -> patrol -> exit"]
[frames.search]
timeout_s = 60
productions = [{ graph = "entry -> drive -> beep -> search -> exit", protect = ["not low from drive to beep"] }]
[frames.wait_for]
until = ["done"]
productions = ["entry -> wait -> exit"]
[frames.outer]
productions = ["entry -> wait -> wait_for -> exit"]
[behaviours.patrol]
criticality = { fuel = "NB NB PM PM PM PM PM", battery = "PM PM PM PM PM PM PM" }
[behaviours.search]
criticality = { battery = "NB NB PM PM PM PM PB" }
[behaviours.outer]
criticality = { battery = "NB NB PM PM PM PM PB" }
"#,
    );
}

#[test]
fn h32_mutual_interruption() {
    in_world(
        "lint_mutual_interruption",
        r#"
[frames.work]
productions = ["entry -> drive -> wait -> beep -> exit"]
[behaviours.one]
plan = "work"
criticality = { fuel = "PM PM PM PS PS PS PS" }
dwell_s = 0
[behaviours.two]
plan = "work"
criticality = { fuel = "PS PS PS PM PM PM PM", battery = "PS PS PS PM PM PM PM" }
"#,
    );
}

/// While `watch` sleeps inside its interval, `chat` runs and `flee` is excluded.
const SHUT_OUT: &str = r#"
[facts]
camera = false
[actions.open]
do = "signal 2"
add = ["camera"]
[actions.shut]
do = "signal 3"
delete = ["camera"]
[frames.watch]
productions = [{ graph = "entry -> open -> drive -> wait -> shut -> exit", protect = ["camera from drive to wait"] }]
[frames.chat]
productions = ["entry -> wait -> beep -> exit"]
[frames.flee]
productions = ["entry -> shut -> drive -> exit"]
[behaviours.watch]
criticality = { fuel = "NM NM NM NM NM NM NM", battery = "NM NM NM NM NM NM NM" }
[behaviours.chat]
criticality = { battery = "PS PS PS NB NB NB NB" }
[behaviours.flee]
criticality = { fuel = "PB PM PM NB NB NB NB" }
"#;

#[test]
fn h35_intervals_that_pile_up() {
    in_world("lint_shut_out", SHUT_OUT);
    let never_at_once = SHUT_OUT.replace("PB PM PM NB NB NB NB", "PM PM PM NB NB NB NB");
    in_world("lint_shut_out_for_good", &never_at_once);
}

#[test]
fn h36_waits_have_a_bound_or_are_named() {
    // The whole loop is protected, and ends only when the other would be pleased anyway.
    in_world(
        "lint_waits_for_ever",
        r#"
[facts]
warm = true
[actions.cool]
do = "signal 2"
delete = ["warm"]
[frames.all]
productions = [{ graph = "entry -> rounds -> beep -> exit", protect = ["warm from rounds to rounds"] }]
[frames.rounds]
productions = [{ graph = "entry -> drive -> wait -> rounds -> exit", applicable = { fuel = "PB PB PB PB PB PB NB" } }]
[frames.cooling]
productions = ["entry -> cool -> drive -> exit"]
[behaviours.all]
criticality = { fuel = "PS PS PS PS PS PS NB" }
[behaviours.cooling]
criticality = { battery = "PM PM NB NB NB NB NB" }
"#,
    );
}

/// The bound equals the sum computed by hand: 10 s until driving times out or 4 s until the frame
/// does, half a second for the end of each, and a dwell of a second.
#[test]
fn h36_a_bound_worked_out_by_hand() {
    let text = format!(
        "{WORLD}{}",
        r#"
[frames.work]
productions = ["entry -> drive -> wait -> exit"]
[behaviours.one]
plan = "work"
criticality = { fuel = "PS PS PS PS PS PS PS" }
[behaviours.two]
plan = "work"
criticality = { battery = "PM PM NB NB NB NB NB" }
"#
    );
    let timed = text.replace("[frames.work]\n", "[frames.work]\ntimeout_s = 4\n");
    assert_ne!(text, timed);
    for (text, bound) in [(text, "11.5 s"), (timed, "5.5 s")] {
        let (_, problems) = compiled(&text);
        let note = problems.iter().map(ToString::to_string).find(|p| p.contains("longest waits"));
        // `one` waits for the dwell of `two`, then at most until `drive` or its frame has ended.
        let note = note.expect("waits are reported");
        assert!(note.contains(&format!("`two` {bound} (behind `one`)")), "{note}");
    }
}

#[test]
fn h31_what_runs_side_by_side_must_not_need_the_same() {
    in_world(
        "lint_side_by_side",
        r#"
[frames.work]
productions = ["entry -> (drive | wait) -> beep -> exit"]
[behaviours.work]
criticality = { fuel = "PS PS PS PS PS PS PS", battery = "PS PS PS PS PS PS PS" }
"#,
    );
}

#[test]
fn budgets() {
    let mut deep = String::new();
    for level in 0..8 {
        let next = if level == 7 { "drive".to_owned() } else { format!("level{}", level + 1) };
        deep += &format!(
            "[frames.level{level}]\nproductions = [\"entry -> {next} -> wait -> beep -> exit\"]\n"
        );
    }
    deep += "[behaviours.deep]\nplan = \"level0\"\ncriticality = { fuel = \"PS PS PS PS PS PS PS\", battery = \"PS PS PS PS PS PS PS\" }\n";
    in_world("lint_depth", &deep);

    let mut wide = String::new();
    for number in 0..7 {
        wide += &format!(
            "[frames.wide{number}]\nproductions = [\"entry -> drive -> wait -> drive -> wait -> beep -> drive -> exit\"]\n"
        );
        wide += &format!(
            "[behaviours.wide{number}]\ncriticality = {{ fuel = \"PS PS PS PS PS PS PS\", battery = \"NB NM NS ZO PS PM PB\" }}\n"
        );
    }
    in_world("lint_components", &wide);
}

#[test]
fn what_is_never_used() {
    in_world(
        "lint_unused",
        r#"
[facts]
forgotten = false
[frames.work]
productions = ["entry -> drive -> exit"]
[frames.left]
productions = ["entry -> wait -> exit"]
[behaviours.work]
criticality = { fuel = "PS PS PS PS PS PS PS" }
"#,
    );
}

/// Eight inputs have too many combinations of labels; the only message is that they are too many.
#[test]
fn what_is_too_much_to_look_through_is_said() {
    let mut text = WORLD.to_owned();
    let mut rows = Vec::new();
    for number in 1..=5 {
        text += &format!(
            "[inputs.i{number}]\nsource = \"custom {number}\"\nmissing = {{ then = 0 }}\n"
        );
        rows.push(format!("i{number} = \"PB PM PS ZO NS NM NB\""));
    }
    rows.push("fuel = \"PB PM PS ZO NS NM NB\"".into());
    rows.push("battery = \"PB PM PS ZO NS NM NB\"".into());
    text += &format!(
        "[frames.work]\nproductions = [\"entry -> drive -> wait -> beep -> exit\"]\n\
         [behaviours.work]\ncriticality = {{ {} }}\n",
        rows.join(", ")
    );
    check("lint_too_many_inputs", &text);
}

/// What fits its type and cannot be meant: values that never occur, weights that are not shares.
#[test]
fn values_that_cannot_be_meant() {
    in_world(
        "lint_values",
        r#"
[facts]
full = { input = "battery", at_least = 90 }
late = { input = "clock", at_least = 900 }
[inputs.clock]
source = "time"
universe = [0, 600]
[inputs.level]
source = "custom 1"
universe = [10, 0]
missing = { then = -1 }
[actions.ride]
do = "follow gate at 34:60"
until = ["full", "late"]
[frames.work]
productions = ["entry -> ride -> drive -> wait -> beep -> exit"]
[behaviours.work]
criticality = { fuel = "PS PS PS PS PS PS PS", level = "PS PS PS PS PS PS PS", clock = "PS PS PS PS PS PS PS" }
"#,
    );
}

/// Components that contradict what their own production protects, and conditions that are never
/// met.
#[test]
fn contradictions() {
    in_world(
        "lint_contradictions",
        r#"
[facts]
clean = true
ready = false
done = true
[actions.wash]
do = "hold 2 s"
delete = ["clean"]
[actions.soil]
do = "hold 2 s"
transient = ["not clean"]
[actions.last]
do = "hold 2 s"
delete = ["clean"]
initial = ["ready"]
until = ["not done"]
[frames.inner]
productions = ["entry -> wash -> exit"]
[frames.work]
productions = [
  { graph = "entry -> drive -> wash -> wait -> exit", protect = ["clean from drive to wait"] },
  { graph = "entry -> drive -> soil -> beep -> exit", protect = ["clean from drive to beep"] },
  { graph = "entry -> drive -> inner -> beep -> exit", protect = ["clean from drive to beep"] },
  { graph = "entry -> drive -> last -> exit", protect = ["clean from drive to last"] },
]
[behaviours.work]
criticality = { fuel = "PS PS PS PS PS PS PS", battery = "PS PS PS PS PS PS PS" }
"#,
    );
}

/// Seven levels of twelve productions have millions of states. The search for waits stops at its
/// limit, which the note says; so time and memory have a bound.
#[test]
fn h36_the_search_for_waits_has_a_limit() {
    let mut text = String::from(WORLD);
    let graphs = ["l1 -> beep -> l3 -> beep -> l5", "l2", "wait", "l4", "wait", "l6", "wait"];
    for (level, graph) in graphs.into_iter().enumerate() {
        let one = format!("\"entry -> {graph} -> exit\"");
        let all = vec![one; 12].join(", ");
        text += &format!("[frames.l{level}]\nproductions = [{all}]\n");
    }
    for (name, row) in [("a", "PS PS PS PS PS PS NB"), ("b", "NB NB PM PM PM PM NB")] {
        text += &format!(
            "[behaviours.{name}]\nplan = \"l0\"\ncriticality = {{ battery = \"{row}\" }}\n"
        );
    }
    let begun = std::time::Instant::now();
    let (draft, problems) = compiled(&text);
    let took = begun.elapsed();
    assert!(draft.is_some(), "{problems:?}");
    let said: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert!(
        said.iter().any(|said| said.contains("an unknown time (too many states)")),
        "{said:#?}"
    );
    assert!(took.as_secs() < 10, "{took:?}");
}

/// Behaviours that share no resource may exclude each other all the same: the bound counts what the
/// other one protects, and a protection without an end is named.
#[test]
fn h36_waits_count_intervals_without_a_shared_resource() {
    in_world(
        "lint_waits_for_intervals",
        r#"
[facts]
clean = true
[actions.spray]
do = "set-output 1 on"
delete = ["clean"]
[frames.survey]
productions = [{ graph = "entry -> rounds -> beep -> exit", protect = ["clean from rounds to rounds"] }]
[frames.rounds]
productions = [{ graph = "entry -> drive -> wait -> rounds -> exit", applicable = { fuel = "PB PB PB PB PB PB NB" } }]
[frames.spraying]
productions = ["entry -> spray -> exit"]
[behaviours.survey]
criticality = { fuel = "PS PS PS PS PS PS NB" }
[behaviours.spraying]
criticality = { battery = "PM PM NB NB NB NB NB" }
"#,
    );
}
