//! Missions with work, simulated with body, sensors, tanks that drain and strips to work.
//!
//! They are the paper's ploughing field (Hasemann, tables 4 to 6 and figures 3 and 4), on the host
//! and in QEMU, and its other examples (table 1), all as shipped.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use harness::mission::{self, Changes};
use harness::{Build, Machine, QemuPilot, setup};
use it::own_map;
use plan_compiler::trace::Trace;
use plan_compiler::trace::story::{self, Story, Turn};
use sim::{Ending, HostPilot, Outcome, Pilot, Recorder, Scenario, SensorSettings, Start};

/// The shipped mission, with some of its world's text replaced.
fn plough(replacements: &[(&str, &str)]) -> Scenario {
    let path = own_map("plough.world.toml");
    let mut text = std::fs::read_to_string(path).expect("the world is readable");
    for (from, to) in replacements {
        assert!(text.contains(from), "the shipped world has no `{from}`");
        text = text.replace(from, to);
    }
    let scenario = mission::scenario(&own_map("plough.ovl"), &Changes::default());
    let scenario = scenario.unwrap_or_else(|problems| panic!("{problems}"));
    Scenario { surroundings: Some(text.parse().expect("the world is sound")), ..scenario }
}

/// The ploughing field with a tank that falls to level `to` after `after_m` metres.
fn leaking(after_m: u32, to: f64) -> Scenario {
    let leak = format!("output = 1\nleak = {{ after_m = {after_m}, to = {to} }}");
    plough(&[("output = 1 ", &leak), ("# its tap", "\n# its tap")])
}

fn run(scenario: &Scenario, pilot: impl Pilot) -> Outcome {
    run_with(scenario, scenario.sensors(), pilot)
}

fn run_with(scenario: &Scenario, sensors: SensorSettings, pilot: impl Pilot) -> Outcome {
    let surroundings = scenario.surroundings.as_ref().expect("there is a world file");
    let start =
        Start { position: surroundings.start, heading_rad: surroundings.heading, seed: 1, sensors };
    let robot = scenario.robot(&start, pilot).expect("the body is clear of obstacles");
    robot.run(&scenario.truth).expect("the robot answers")
}

/// Runs on the host to the end.
fn record(scenario: &Scenario) -> (Outcome, Story, Trace) {
    record_with(scenario, scenario.sensors())
}

/// As [`record`], with these sensors.
pub(crate) fn record_with(scenario: &Scenario, sensors: SensorSettings) -> (Outcome, Story, Trace) {
    let mut recorder = Recorder::new(HostPilot::new(scenario.plan()));
    let outcome = run_with(scenario, sensors, &mut recorder);
    let percepts = recorder.finish();
    let story = story::of(&scenario.plan(), &percepts);
    let trace = Trace { blob: scenario.blob.clone(), percepts, hash: outcome.trace_hash };
    (outcome, story, trace)
}

/// How often each strip was begun and done.
fn strips(outcome: &Outcome) -> Vec<(u32, u32)> {
    let surroundings = outcome.surroundings.as_ref().expect("there is a field");
    surroundings.fields["field ready"].work.iter().map(|work| (work.begun, work.done)).collect()
}

fn interruption(turn: &&Turn) -> bool {
    turn.interrupted_at_once.is_some()
}

#[track_caller]
fn golden(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(it::root().canonicalize().unwrap().join("tests/golden/work"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// H26, figure 4: the tank falls to ZO while the robot ploughs a strip forward. Refuelling waits for
/// point 2, after the strip back; no strip is ploughed twice, and the loop ends when the field is
/// ready.
#[test]
fn h26_at_zo_the_tractor_refuels_after_the_strip_back() {
    let (outcome, story, _) = record(&plough(&[]));
    assert_eq!(outcome.ending, Some(Ending::Done), "{outcome:?}");
    assert_eq!((strips(&outcome), outcome.touches), (vec![(1, 1); 6], 0));
    let switches: Vec<&Turn> = story.turns.iter().filter(interruption).collect();
    assert_eq!(switches.len(), 3);
    for switch in switches {
        assert_eq!(switch.interrupted_at_once, Some(false), "{switch:?}");
    }
    let mut text = String::new();
    for turn in &story.turns {
        writeln!(text, "{}", turn.text).unwrap();
    }
    let surroundings = outcome.surroundings.expect("there is a field");
    golden("turns", &(text + &surroundings.summary().join("\n")));
}

/// H28, H38: the tank falls to NM or NB in the middle of a strip, forward or back. The switch is at
/// once, only that strip is ploughed again, and the lost work is as in the mission.
#[test]
fn h28_at_nm_or_nb_the_strip_is_ploughed_again() {
    // Metres driven in the middle of strip 1 and of strip 2.
    for (strip, after_m, lost_work) in [(0, 145, 2), (1, 215, 0)] {
        for level in [1.0 / 6.0, 0.05] {
            let (outcome, story, _) = record(&leaking(after_m, level));
            assert_eq!(outcome.ending, Some(Ending::Done), "{outcome:?}");
            let mut expected = vec![(1, 1); 6];
            expected[strip] = (2, 1);
            assert_eq!(strips(&outcome), expected, "strip {strip}, level {level}");
            let first = story.turns.iter().find(interruption).expect("there is a switch");
            assert_eq!(first.interrupted_at_once, Some(true), "{first:?}");
            let cost = format!("at the cost of {lost_work}");
            assert!(first.text.ends_with(&cost), "{first:?}");
        }
    }
}

/// N07: a whole field, with both kinds of switching, has the same trace in QEMU as on the host.
#[test]
fn n07_ploughing_has_the_same_trace_everywhere() {
    for scenario in [plough(&[]), leaking(145, 0.1)] {
        let on_host = run(&scenario, HostPilot::new(scenario.plan()));
        for machine in [Machine::CortexM4F, Machine::CortexM3] {
            let pilot = QemuPilot::boot(machine, Build::Release, &scenario.blob);
            let in_qemu = run(&scenario, pilot.unwrap_or_else(|error| panic!("{error}")));
            assert_eq!(in_qemu.trace_hash, on_host.trace_hash, "{}", machine.name());
            assert_eq!(in_qemu.surroundings, on_host.surroundings);
        }
    }
}

/// H45: the other examples of the paper's table 1 reach their ends, and can be drawn.
#[test]
fn h45_the_examples_come_to_their_ends() {
    let folder = tempfile::tempdir().expect("there is room");
    for (name, interruptions) in [("assembly", 0), ("planet", 1), ("shop", 0)] {
        let scenario = mission::scenario(&own_map(&format!("{name}.ovl")), &Changes::default());
        let scenario = scenario.unwrap_or_else(|problems| panic!("{problems}"));
        let (outcome, story, _) = record(&scenario);
        assert_eq!((outcome.ending, outcome.touches), (Some(Ending::Done), 0), "{name}");
        assert_eq!(story.turns.iter().filter(interruption).count(), interruptions, "{name}");
        let picture = folder.path().join(format!("{name}.svg"));
        let mut command = Command::new(setup::plan_compiler().expect("the program is built"));
        command.arg("graph").arg(own_map(&format!("{name}.mission.toml"))).arg("-o").arg(&picture);
        let output = command.output().expect("the program runs");
        let messages = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !messages.contains("warning"), "{name}: {messages}");
        let drawn = std::fs::read_to_string(&picture).expect("there is a picture");
        assert!(drawn.contains("<svg"), "{name}");
    }
}

fn explain(trace: &Path, arguments: &[&str]) -> String {
    let program = setup::plan_compiler().expect("the program is built");
    let output = Command::new(program).arg("explain").arg(trace).args(arguments).output();
    let output = output.expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("it writes text")
}

/// `explain` lists the switches between behaviours and explains single ticks: the last one that
/// waits for a point, the switch there, and a switch at once.
#[test]
fn explain_lists_switches_and_explains_ticks() {
    let folder = tempfile::tempdir().expect("there is room");
    let write = |name: &str, trace: &Trace| -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, trace.to_bytes()).expect("there is room");
        path
    };
    let (_, story, trace) = record(&plough(&[("time_limit = 3600", "time_limit = 200")]));
    let path = write("zo.trace", &trace);
    golden("explain_turns", &explain(&path, &[]));
    let switch = story.turns.iter().find(interruption).expect("there is a switch").tick;
    golden("explain_waiting", &explain(&path, &["--tick", &(switch - 1).to_string()]));
    golden("explain_at_a_point", &explain(&path, &["--tick", &switch.to_string()]));

    let leaking = leaking(145, 0.1);
    let (_, story, trace) = record(&leaking);
    let path = write("nb.trace", &trace);
    let switch = story.turns.iter().find(interruption).expect("there is a switch").tick;
    golden("explain_at_once", &explain(&path, &["--tick", &switch.to_string()]));
}
