//! Teams that wait for each other, and such that do not.

use super::*;
use maps::problem::Source;

/// The warnings of a team of two or three whose robots have these serial plans.
fn warnings(robots: &[(&str, &str)], shared: &str) -> Vec<String> {
    let source = Arc::new(Source { name: "m".into(), text: text(robots, shared) });
    let (mission, mistakes) = mission::parse_for(&source, Some(robots[0].0));
    assert!(mistakes.is_empty(), "{mistakes:?}");
    check(&source, &mission.team)
        .iter()
        .map(|problem| format!("{problem}; {}", problem.help.clone().unwrap_or_default()))
        .collect()
}

/// Those about robots that wait for each other.
fn waits(robots: &[(&str, &str)], shared: &str) -> Vec<String> {
    let mut found = warnings(robots, shared);
    found.retain(|warning| warning.contains("may wait for each other"));
    found
}

fn text(robots: &[(&str, &str)], shared: &str) -> String {
    let names: Vec<String> = robots.iter().map(|(name, _)| format!("{name:?}")).collect();
    let mut text = format!("[team]\nrobots = [{}]\n{shared}\n", names.join(", "));
    text += "[inputs]\ntime = { source = \"time\", universe = [0, 1], missing = { then = 0 } }\n";
    text +=
        "[behaviours.go]\nplan = \"serial\"\ncriticality = { time = \"PB PB PB PB PB PB PB\" }\n";
    for (name, graph) in robots {
        text += &format!("[robots.{name}.frames.serial]\nproductions = [\"{graph}\"]\n");
    }
    text
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

/// What fails starts no part that only a success leads to.
#[test]
fn a_failure_leads_to_another_production_or_to_the_start() {
    let prepare =
        SHARED.to_owned() + "[frames.prepare]\nproductions = [\"entry -> go -> say -> exit\"]\n";
    let graph = "entry -> prepare -> wait -> exit";
    let robots = [("a", graph), ("b", graph)];
    assert_eq!(warnings(&robots, &prepare), [""; 0], "`prepare` fails without its signal");
    let other = prepare.replace("-> exit\"]", "-> exit\", \"entry -> rest -> exit\"]")
        + "[actions.rest]\ndo = \"wait 5 s\"\n";
    let found = warnings(&robots, &other);
    assert_eq!(found.len(), 1, "its other production succeeds: {found:?}");
    assert!(found[0].contains("it comes to this by a: go, rest, wait"), "{found:?}");
    let until = prepare.clone() + "until = [\"close\"]\n[facts.close]\nnear = [5, 5]\nwithin = 1\n";
    assert_eq!(warnings(&robots, &until).len(), 1, "it may end before its signal");
    let initial = prepare.replace("\"signal 1\" }", "\"signal 1\", initial = [\"all linked\"] }");
    assert_eq!(warnings(&robots, &initial), [""; 0], "the plan begins anew without it");
}

/// A loop whose next round may find nothing applicable goes on after it.
#[test]
fn a_loop_that_may_end_leads_on() {
    let lap = |rule: &str| {
        format!(
            "{SHARED}[frames.lap]\nproductions = [{{ graph = \"entry -> go -> lap -> exit\"{rule} }}]\n"
        )
    };
    let graph = "entry -> lap -> wait -> exit";
    let robots = [("a", graph), ("b", graph)];
    assert_eq!(waits(&robots, &lap("")), [""; 0], "it never ends");
    let ends = lap(", applicable = { time = \"PB PM PS ZO NS NM NB\" }");
    assert_eq!(waits(&robots, &ends).len(), 1);
}

/// A signal that begins with a wait has been sent while the wait lasts; a later one may have been.
#[test]
fn signals_side_by_side_count() {
    let both = |graph: &str| warnings(&[("a", graph), ("b", graph)], SHARED);
    assert_eq!(both("entry -> (wait | say) -> exit"), [""; 0]);
    assert_eq!(both("entry -> (say | wait) -> exit"), [""; 0]);
    let shared =
        SHARED.to_owned() + "pause = { do = \"wait 9 s\" }\nother = { do = \"signal 2\" }\n";
    let graph = "entry -> (wait | pause -> say) -> exit";
    assert_eq!(warnings(&[("a", graph), ("b", graph)], &shared).len(), 1);
    // The second signal replaces the first, for which the mate waits.
    let graph = "entry -> (wait | say -> pause -> other) -> exit";
    assert_eq!(warnings(&[("a", graph), ("b", graph)], &shared).len(), 1);
}

/// Whatever is printed about the time after a wait holds.
#[test]
fn a_robot_that_stands_again_after_its_wait_does_not_move_in_time() {
    let then = |graph: &str, actions: &str| {
        let found = waits(&[("a", graph), ("b", graph)], &(SHARED.to_owned() + actions));
        assert_eq!(found.len(), 1, "{graph}: {found:?}");
        let help = found[0].split("; it comes").next().unwrap_or_default().to_owned();
        help.split("`wait`; ").last().unwrap_or_default().to_owned()
    };
    let never = "these waits end at the latest: a after 60 s, but it never moves again by itself; \
        b after 60 s, but it never moves again by itself";
    assert_eq!(then("entry -> wait -> serial -> exit", ""), never);
    assert_eq!(then("entry -> wait -> say -> exit", ""), never);
    let again = never
        .replace("but it never moves again by itself", "and it may stand again before it moves");
    let checked =
        "check = { do = \"hold 60 s\", until = [\"mate is there\"], goal = [\"mate is there\"] }\n";
    let graph = "entry -> check -> say -> go -> exit";
    let found = waits(&[("a", graph), ("b", graph)], &(SHARED.to_owned() + checked));
    assert!(found[0].contains(&again), "{found:?}");
    assert_eq!(
        then("entry -> wait -> pause -> say -> go -> exit", "pause = { do = \"wait 9 s\" }\n"),
        again
    );
    let moves = "each moves again at the latest: a after 60 s and b after 60 s";
    assert_eq!(then("entry -> wait -> say -> go -> exit", ""), moves);
}

/// Facts about mates through inputs, and signals that wait for a mate.
#[test]
fn each_way_to_wait_for_a_mate_is_found() {
    let facts = r#"
        close = { input = "distance", at_most = 3 }
        every = { input = "linked", at_least = 1 }
        [inputs.distance]
        source = "mate-distance nearest"
        universe = [0, 40]
        missing = { then = 40 }
        [inputs.linked]
        source = "mates-linked"
        universe = [0, 1]
        [actions]
        meet = { do = "hold 30 s", until = ["close", "every"] }
        call = { do = "signal 2", until = ["mate is there"] }
    "#;
    let inputs = SHARED.replace("[actions]\n", facts);
    let graph = "entry -> meet -> go -> exit";
    let found = warnings(&[("a", graph), ("b", graph)], &inputs);
    assert!(found.len() == 1 && found[0].contains("a in `meet` and b in `meet`"), "{found:?}");
    let graph = "entry -> call -> say -> go -> exit";
    let found = warnings(&[("a", graph), ("b", graph)], &inputs);
    assert!(found.len() == 1 && found[0].contains("a in `call` and b in `call`"), "{found:?}");
}

/// A wrong code, a mate that signals nothing, and one without behaviours.
#[test]
fn signals_that_a_mate_never_sends_are_reported() {
    let (tells, waits) = ("entry -> go -> say -> exit", "entry -> wait -> go -> exit");
    let robots = [("a", tells), ("b", waits)];
    assert_eq!(warnings(&robots, SHARED), [""; 0]);
    let wrong = SHARED.replace("signals = 1", "signals = 2");
    let found = warnings(&robots, &wrong);
    assert_eq!(found.len(), 1, "{found:?}");
    let expected = "fact `mate is there` can never hold: `a` never signals 2; a signals 1; give";
    assert!(found[0].starts_with(expected), "{found:?}");
    let found = warnings(&[("a", "entry -> go -> exit"), ("b", waits)], SHARED);
    assert!(found[0].contains("never signals 1; a signals nothing; give"), "{found:?}");
    // Of any mate, one is enough; of all, each has to.
    let three = [("a", tells), ("b", waits), ("c", "entry -> go -> exit")];
    assert_eq!(warnings(&three, SHARED), [""; 0]);
    let all = SHARED.replace("\"any\"", "\"all\"");
    let found = warnings(&three, &all);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("never hold: `c` never signals 1"), "{found:?}");
    // Not of a mate whose part has a mistake.
    let broken = wrong + "[robots.a.actions]\ngo = { do = \"fly\" }\n";
    let source = Arc::new(Source { name: "m".into(), text: text(&robots, &broken) });
    let (mission, _) = mission::parse_for(&source, Some("b"));
    assert!(check(&source, &mission.team).is_empty());
    // A mate without behaviours.
    let alone = format!(
        "[team]\nrobots = [\"a\", \"b\"]\n[robots.b.inputs]\ntime = {{ source = \"time\", universe = \
         [0, 1], missing = {{ then = 0 }} }}\n[robots.b.behaviours.go]\nplan = \"serial\"\ncriticality = \
         {{ time = \"PB PB PB PB PB PB PB\" }}\n[robots.b.frames.serial]\nproductions = [\"{waits}\"]\n{}",
        SHARED.replace("[facts]", "[robots.b.facts]").replace("[actions]", "[robots.b.actions]")
    );
    let source = Arc::new(Source { name: "m".into(), text: alone });
    let (mission, _) = mission::parse_for(&source, Some("b"));
    let found = check(&source, &mission.team);
    assert!(found.len() == 1 && found[0].to_string().contains("`a` never signals 1"), "{found:?}");
}

/// Five robots with sixteen behaviours each have a million combinations of first steps. Searching all of
/// them took longer than a user waits.
#[test]
fn the_search_of_a_large_team_ends() {
    const TEAM: &str = "[team]\nrobots = [\"a\", \"b\", \"c\", \"d\", \"e\"]\n[inputs]\n\
        time = { source = \"time\", universe = [0, 1] }\n[facts]\nready = { linked = \"all\" }\n";
    let of = |until: &str| {
        let behaviours = (0..16).map(|n| {
            format!(
                "[behaviours.b{n}]\ncriticality = {{ time = \"PB PB PB PB PB PB PB\" }}\n\
                 [frames.b{n}]\nproductions = [\"entry -> w{n} -> exit\"]\n\
                 [actions.w{n}]\ndo = \"hold 60 s\"\n{until}\n"
            )
        });
        let text = TEAM.to_owned() + &behaviours.collect::<String>();
        let source = Arc::new(Source { name: "m".into(), text });
        let (mission, mistakes) = mission::parse_for(&source, Some("a"));
        assert!(mistakes.is_empty(), "{mistakes:?}");
        check(&source, &mission.team).iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let found = of("until = [\"ready\"]");
    assert_eq!(found.len(), MAX_LISTED + 2, "{found:?}");
    assert_eq!(found[MAX_LISTED], "at least 197 more ways to wait for each other");
    assert!(found[MAX_LISTED + 1].contains("not all were searched"), "{found:?}");
    // Nothing is to be searched where no robot waits.
    assert_eq!(of(""), [""; 0]);
}
