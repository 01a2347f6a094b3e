//! Messages about texts that cannot be compiled.

use super::check;

#[test]
fn inputs() {
    check(
        "mistakes_in_inputs",
        r#"
[inputs]
a = 5
b = { sorce = "fuel" }
c = { source = "fule", missing = { then = 0 } }
d = { source = "fuel" }
e = { source = "distance 1, 2", missing = { hold = 1 } }
f = { source = "custom 9", missing = { then = 0 } }
g = { source = "time", universe = [1, 1] }
h = { source = "cost-to-goal gaet", universe = [0, 100], missing = { then = 0 } }
i = { source = "price gate/coms", universe = [0, 100], missing = { then = 0 } }
j = { rules = { k = "NB NB NB NB NB NB NB" } }
k = { rules = { j = "NB NB NB NB NB NB NB" } }
l = { source = "time", universe = "0..1" }
"it's" = { source = "time", universe = [0, 1] }
n = { source = "range-left gaet", full = 100, universe = [0, 9], missing = { then = 0 } }
o = { source = "range-left gate", full = 0, channel = "fule", universe = [0, 9], missing = { then = 0 } }
p = { source = "range-left gate", universe = [0, 9], missing = { then = 0 } }
q = { source = "time", full = 9, universe = [0, 9] }
m = { source = "time", universe = [0, 1], rules = { d = "NB NB NB NB NB NB NB" } }
"#,
    );
}

#[test]
fn rows() {
    check(
        "mistakes_in_rows",
        r#"
[inputs.fuel]
source = "fuel"
missing = { then = 0 }
[behaviours.a]
criticality = { fuel = "PB PB PM PM NB NB" }
[behaviours.b]
criticality = { fuel = "PB PB PM PM NB NB LOW" }
[behaviours.c]
criticality = { fuel = 7 }
[behaviours.d]
criticality = {}
[behaviours.e]
plan = "e"
[behaviours.f]
criticality = "PB PB PM PM NB NB NB"
[behaviours.g]
criticality = { feul = "PB PB PM PM NB NB NB" }
inference = "max"
dwell_s = -1
swich = "best"
plan = "nothing"
"#,
    );
}

/// A fact has two labels, an input seven.
#[test]
fn rows_of_facts() {
    check(
        "mistakes_in_rows_of_facts",
        r#"
[inputs]
fuel = { source = "fuel", missing = { then = 0 } }
[facts]
"tank full" = { input = "fuel", at_least = 0.98 }
[actions]
go = { do = "go-to 1, 2" }
[frames]
go_on = { productions = ["entry -> go -> exit"] }
[behaviours.a]
plan = "go_on"
criticality = { "tank full" = "PB PB PM PM NB NB NB" }
[behaviours.b]
plan = "go_on"
criticality = { fuel = "PB NB" }
[behaviours.c]
plan = "go_on"
criticality = { "tank fall" = "PB NB" }
[behaviours.d]
plan = "go_on"
criticality = { "tank full" = "PB PM NB" }
"#,
    );
}

/// Frames and behaviours that end by themselves.
#[test]
fn ends() {
    check(
        "mistakes_in_ends",
        r#"
[facts]
full = false
[actions]
go = { do = "go-to 1, 2" }
back = { do = "return 1, 2" }
[frames]
a = { productions = ["entry -> go -> exit"], until = ["ful"], timeout_s = 0 }
b = { productions = ["entry -> go -> back -> exit"], until = ["full", "not full"], timout_s = 5 }
[behaviours.a]
criticality = { full = "PS NB" }
once = "yes"
"#,
    );
}

#[test]
fn facts() {
    check(
        "mistakes_in_facts",
        r#"
[facts]
a = "symbol"
b = {}
c = { inside = [0, 0, 60] }
d = { inside = [60, 0, 0, 40] }
e = { near = [1, 2] }
f = { near = [1, 2], inside = [0, 0, 1, 1] }
g = { input = "fuel" }
h = { input = "fuel", at_least = 2, at_most = 1 }
i = { input = "fuel", at_least = 2 }
j = { no_progress = 0.5 }
"not k" = false
"#,
    );
}

#[test]
fn actions() {
    check(
        "mistakes_in_actions",
        r#"
[facts]
done = false
there = { near = [1, 2], within = 3 }
[actions]
a = { do = "goto 1, 2" }
b = { do = "follow gaet" }
c = { do = "follow gate at 34:166" }
d = { do = "hold 5" }
e = { do = "hold 5 s", timeout_s = 5 }
f = { do = "set-output 16 on" }
g = { do = "signal" }
h = { do = "hold 1 s", initial = ["doen"], add = ["there"] }
i = { do = "hold 1 s", initial = ["done", "not done"], max_speed = "fast" }
j = { do = "hold 1 s", add = ["done"], delete = ["done"] }
k = { initial = ["done"] }
l = { do = "hold 1 s", goals = ["done"] }
m = "hold 1 s"
n = { do = "move-ahead north for 5 s" }
o = { do = "move-ahead 90" }
p = { do = "dock 1, 2 facing 90" }
q = { do = "dock 1, 2 facing 90 from 0 m" }
[frames.a]
productions = ["entry -> a -> exit"]
"#,
    );
}

/// A number out of range is not an unknown action.
#[test]
fn ranges_in_actions() {
    check(
        "mistakes_in_ranges",
        r#"
[inputs]
a = { source = "custom 6", missing = { then = 0 } }
b = { source = "output 16" }
[actions]
a = { do = "set-output 16 on" }
b = { do = "signal 70000" }
c = { do = "signal 0" }
d = { do = "hold -5 s" }
e = { do = "wander 1e9 s" }
f = { do = "dock 30, 12 facing 400 from -3 m" }
g = { do = "move-ahead 500 for 5 s" }
h = { do = "follow gate at 34:166" }
i = { do = "signal 1.5" }
"#,
    );
}

/// Each mistake once, and not what follows from it.
#[test]
fn parameters() {
    check(
        "mistakes_in_parameter_names",
        r#"
[facts]
"at(x, y)" = { near = ["{x}", "{y}"], within = 1.5 }
[actions]
"to(x, y)" = { do = "go-to {x}, {z}", goal = ["at({x}, {y})"] }
"same(x, x)" = { do = "go-to {x}, {x}" }
"rest(x)" = { do = "hold {x} s" }
"slow(x)" = { do = "hold {x} s", max_sped = 1 }
lone = { do = "go-to {x}, 12" }
[frames]
a = { productions = ["entry -> to(1, 2) -> same(3, 4) -> rest(long) -> exit"] }
b = { productions = ["entry -> rest (5) -> slow(1) -> slow(2) -> lone -> exit", "entry => a -> exit"] }
c = { productions = ["entry -> slow(3, 4) -> exit"] }
"#,
    );
    check(
        "mistakes_in_endless_parameters",
        r#"
[actions]
"rest(x)" = { do = "hold {x} s" }
[frames]
"f(x)" = { productions = ["entry -> rest({x}) -> f({x}1) -> exit"] }
a = { productions = ["entry -> f(1) -> exit"] }
"#,
    );
}

/// The help for an unknown name does not lead to a name that is refused.
#[test]
fn names() {
    check(
        "mistakes_in_names",
        r#"
[facts]
full = false
[actions]
"go home along the very long road to the north" = { do = "hold 1 s" }
rest = { do = "hold 1 s", initial = ["exit"], until = ["not not not full"] }
[frames]
a = { productions = ["entry -> go home along the very long road to the north -> exit"] }
b = { productions = ["entry -> go back along the very long road to the south -> exit"] }
[behaviours.a]
criticality = { full = "PS NB" }
unconditional = 0.05
"#,
    );
}

#[test]
fn frames() {
    check(
        "mistakes_in_frames",
        r#"
[facts]
safe = true
[actions]
one = { do = "hold 1 s" }
two = { do = "hold 2 s" }
[frames.a]
[frames.b]
productions = ["entry -> one -> tow -> exit"]
[frames.c]
productions = ["entry -> one | two -> exit", "entry -> (one -> exit"]
[frames.d]
productions = [
  { graph = "entry -> one -> two -> exit", protect = ["safe from two to one", "safe from one", "sfae from one to two", "safe from one to three"] },
]
[frames.e]
productions = [{ name = "no graph" }]
[frames.f]
productions = [{ graph = """
  entry -one-> 1 -two-> exit;
  entry -two-> 2""" }]
[frames.g]
productions = [{ graph = "entry -> one -> two -> exit", work = { three = 1, one = -1 } }]
[frames.h]
productions = [{ graph = "entry -> one -> exit", aplicable = { fuel = "NB" } }]
"#,
    );
}

#[test]
fn limits() {
    let many = |count: usize, entry: &dyn Fn(usize) -> String| -> String {
        (0..count).map(entry).collect::<Vec<String>>().join("\n")
    };
    let facts = many(65, &|index| format!("f{index} = false"));
    let actions = many(65, &|index| format!("a{index} = {{ do = 'signal 1' }}"));
    check("limits_of_tables", &format!("[facts]\n{facts}\n[actions]\n{actions}\n"));

    let resources =
        many(17, &|index| format!("a{index} = {{ do = 'signal 1', resources = ['r{index}'] }}"));
    let productions = many(17, &|index| format!("'entry -> a{index} -> exit',"));
    let text = format!(
        "[actions]\n{resources}\n[frames]\nf = {{ productions = [{}] }}",
        productions.replace('\n', "")
    );
    check("limits_of_resources_and_alternatives", &text);

    let long = "n".repeat(33);
    check(
        "limits_of_names",
        &format!("[actions]\n{long} = {{ do = 'signal 1' }}\nexit = {{ do = 'signal 1' }}"),
    );
}

#[test]
fn tables_that_are_none() {
    check("mistakes_in_tables", "inputs = 5\nbehavours = {}\n[goals]\ngate = [1, 2]\n");
}
