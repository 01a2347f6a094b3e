//! Teams that wait for each other, and such that do not.

use super::*;
use maps::problem::Source;

/// The warnings of a team of two or three whose robots have these serial plans.
fn warnings(robots: &[(&str, &str)], shared: &str) -> Vec<String> {
    let names: Vec<String> = robots.iter().map(|(name, _)| format!("{name:?}")).collect();
    let mut text = format!("[team]\nrobots = [{}]\n{shared}\n", names.join(", "));
    text += "[inputs]\ntime = { source = \"time\", universe = [0, 1], missing = { then = 0 } }\n";
    text +=
        "[behaviours.go]\nplan = \"serial\"\ncriticality = { time = \"PB PB PB PB PB PB PB\" }\n";
    for (name, graph) in robots {
        text += &format!("[robots.{name}.frames.serial]\nproductions = [\"{graph}\"]\n");
    }
    let source = Arc::new(Source { name: "m".into(), text });
    let (mission, mistakes) = mission::parse_for(&source, Some(robots[0].0));
    assert!(mistakes.is_empty(), "{mistakes:?}");
    check(&source, &mission.team)
        .iter()
        .map(|problem| format!("{problem}; {}", problem.help.clone().unwrap_or_default()))
        .collect()
}

const SHARED: &str = r#"
[facts]
"all linked" = { linked = "all" }
"mate is there" = { mate = "any", signals = 1 }
[actions]
go = { do = "go-to 5, 5" }
say = { do = "signal 1" }
wait = { do = "hold 60 s", until = ["mate is there"] }
gather = { do = "hold 40 s", until = ["all linked"] }
"#;

#[test]
fn w37_robots_that_signal_only_after_the_other_wait_for_each_other() {
    let found = warnings(
        &[("a", "entry -> go -> wait -> say -> exit"), ("b", "entry -> go -> wait -> say -> exit")],
        SHARED,
    );
    assert_eq!(found.len(), 1, "{found:?}");
    let expected = "`a` and `b` may wait for each other: a in `wait` and b in `wait`; each moves \
        again at the latest: a after 60 s and b after 60 s; it comes to this by a: go, wait; b: \
        go, wait;";
    assert!(found[0].starts_with(expected), "{}", found[0]);
}

#[test]
fn robots_that_signal_before_they_wait_do_not() {
    let graph = "entry -> go -> say -> wait -> exit";
    assert_eq!(warnings(&[("a", graph), ("b", graph)], SHARED), [""; 0]);
    let first = "entry -> go -> say -> exit";
    assert_eq!(warnings(&[("a", first), ("b", "entry -> wait -> say -> exit")], SHARED), [""; 0]);
}

/// A robot that stands within a frame may wait for the frame's end.
#[test]
fn frames_that_end_by_mates_are_waits_too() {
    let shared = SHARED.to_owned()
        + "stand = { do = \"wait 90 s\" }\n[frames.meeting]\nproductions = [\"entry -> stand -> exit\"]\n";
    let graph = "entry -> go -> meeting -> say -> exit";
    let robots = [("a", graph), ("b", graph)];
    assert_eq!(warnings(&robots, &shared), [""; 0], "nothing ends it for a mate");
    let meeting = shared.clone() + "until = [\"mate is there\"]\n";
    let found = warnings(&robots, &meeting);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("a in `stand` and b in `stand`"), "{found:?}");
    assert!(found[0].contains("a after 90 s and b after 90 s"), "{found:?}");
    let found = warnings(&robots, &(meeting + "timeout_s = 20\n"));
    assert!(found[0].contains("a after 20 s and b after 20 s"), "{found:?}");
    // Its own end does not need the mate.
    let own = shared.replace("wait 90 s\"", "wait 90 s\", until = [\"near\"]")
        + "until = [\"mate is there\"]\n[facts.near]\nnear = [5, 5]\nwithin = 1\n";
    assert_eq!(warnings(&robots, &own), [""; 0]);
}

/// Three in a ring cannot be seen from two of them.
#[test]
fn a_ring_of_three_is_found() {
    let graph = "entry -> go -> gather -> exit";
    let found = warnings(&[("a", graph), ("b", graph), ("c", "entry -> go -> exit")], SHARED);
    assert!(found[0].contains("a after 40 s and b after 40 s"), "{found:?}");
    let found = warnings(&[("a", graph), ("b", graph), ("c", graph)], SHARED);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("`a`, `b` and `c` may wait"), "{found:?}");
    // Each waits for the next one's signal: no two of them wait for each other.
    let ring = [("a", "b"), ("b", "c"), ("c", "a")].map(|(name, next)| {
        format!("[robots.{name}.facts]\n\"mate is there\" = {{ mate = \"{next}\", signals = 1 }}\n")
    });
    let graph = "entry -> wait -> say -> exit";
    let robots = [("a", graph), ("b", graph), ("c", graph)];
    let found = warnings(&robots, &(SHARED.to_owned() + &ring.concat()));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("`a`, `b` and `c` may wait"), "{found:?}");
}
