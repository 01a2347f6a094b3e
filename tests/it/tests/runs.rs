//! `cargo mission` as a user runs it: outcomes, exit status, JSON output and files.

use harness::setup;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A meadow with a U of walls that opens to the west, and a closed box in the east.
const MEADOW: &str = "\
MISSION-AREA 60 40
ORIGIN 0 0
GLOBAL_REF_POINT 51.5 -0.1
CONTROL MEASURES:
WALL w1 20 10 30 10 30 30 20 30
WALL w2 45 5 55 5 55 15 45 15 45 5
PP gate 50 30
";

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn command(folder: &Path, arguments: &str) -> Command {
    command_of("mission", folder, arguments)
}

/// A program of the harness.
fn command_of(program: &str, folder: &Path, arguments: &str) -> Command {
    let program = setup::built("harness", program, "dev", None).expect("the program is built");
    let mut command = Command::new(program);
    command.args(arguments.split(' ')).current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &str) -> (i32, String, String) {
    ended(command(folder, arguments))
}

fn ended(mut command: Command) -> (i32, String, String) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().expect("no signal"), text(stdout), text(stderr))
}

/// Runs with `--json`, checks outcome and exit status, and returns the object.
fn outcome(folder: &Path, arguments: &str, expected: &str, status: i32) -> Value {
    let (ended, out, err) = run(folder, &format!("{arguments} --perfect --json"));
    let object: Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}{err}"));
    assert_eq!((object["outcome"].as_str(), ended), (Some(expected), status), "{arguments}: {out}");
    let keys: Vec<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
    let mut wanted = [
        "outcome",
        "time_s",
        "distance_m",
        "closest_m",
        "contacts",
        "turn_rad",
        "reasons",
        "trace_hash",
    ];
    wanted.sort_unstable();
    assert_eq!(keys, wanted);
    object
}

#[test]
fn outcomes_have_names_and_exit_statuses() {
    let reactive = "[gains]\npreset = \"100:0\"\nnoise = 0\n";
    let folder = folder(&[("meadow.ovl", MEADOW), ("hasty.toml", reactive)]);
    let at = folder.path();
    let reached = outcome(at, "meadow.ovl --start 10,20", "reached", 0);
    assert!(reached["distance_m"].as_f64().unwrap() > 40.0, "{reached}");
    assert!(reached["closest_m"].as_f64().unwrap() > 0.0 && reached["contacts"] == 0, "{reached}");
    assert!(reached["turn_rad"].as_f64().unwrap() > 0.5, "{reached}");
    assert!(reached["reasons"]["Driving"].as_u64().unwrap() > 100, "{reached}");
    assert_eq!(reached["trace_hash"].as_str().map(str::len), Some(16));
    outcome(at, "meadow.ovl --start 25,20 --gains 100:0", "trapped", 1);
    let stranded = outcome(at, "meadow.ovl --start 50,10", "no-route", 1);
    assert!(stranded["time_s"].as_f64().unwrap() < 30.0, "{stranded}");
    let lost = outcome(at, "meadow.ovl --start=-5,10", "off-map", 1);
    assert_eq!(lost["closest_m"], Value::Null);
    // Goals of the command line, in metres and by latitude and longitude.
    outcome(at, "meadow.ovl --start 10,20 --goal here=12,20", "reached", 0);
    let near = "meadow.ovl --start 10,20 --goal a=40,35 --goal here=12,20 --plan here";
    let near = outcome(at, near, "reached", 0);
    assert!(near["distance_m"].as_f64().unwrap() < 5.0, "{near}");
    let (status, out, _) = run(at, "meadow.ovl --start 10,20 --perfect");
    assert!(
        status == 0 && out.starts_with("outcome     Reached\nstart       10.00,20.00 m"),
        "{out}"
    );
}

#[test]
fn a_wrong_command_line_and_wrong_input_have_different_statuses() {
    let far = "map = \"meadow.ovl\"\nplan = \"nowhere\"\n[goals]\na = [99, 99]\n";
    let gone = "map = \"other.opar\"\n";
    let disc = "start = [10, 20]\n[[discs]]\nradius = 1\nspeed = 0\npath = [[10.5, 20]]\n";
    let folder = folder(&[
        ("meadow.ovl", MEADOW),
        ("far.toml", far),
        ("gone.toml", gone),
        ("disc.ovl", MEADOW),
        ("disc.world.toml", disc),
    ]);
    let at = folder.path();
    for (arguments, status, part) in [
        ("meadow.ovl --gains 1:1", 2, "the presets are"),
        ("meadow.ovl --start 1", 2, "--start"),
        ("meadow.ovl --goal 12,20", 2, "needs a name"),
        ("meadwo.ovl", 3, "did you mean meadow.ovl?"),
        ("meadow.ovl --plan gaet", 3, "did you mean `gate`?"),
        ("meadow.ovl --plan gate --goal x=12,20", 3, "there is no plan `gate` to follow"),
        ("far.toml", 3, "there is no plan `nowhere` to follow"),
        ("far.toml", 3, "outside the map"),
        ("disc.ovl", 3, "is inside a disc, which starts at (10.50, 20.00); choose another start"),
        ("gone.toml", 3, "check the path; it is relative to the mission file"),
        ("meadow.ovl --goal d=99,99", 3, "outside the map"),
        ("meadow.ovl --start 30,20", 3, "close to an obstacle; a clear position nearby: --start"),
    ] {
        let (ended, out, err) = run(at, arguments);
        assert_eq!((ended, out.as_str()), (status, ""), "{arguments}: {err}");
        assert!(err.contains(part), "{arguments}: {err}");
    }
}

/// The warnings of `plan-compiler build`, those of the whole team included; the JSON stays pure.
#[test]
fn warnings_go_to_standard_error() {
    let team = r#"
        map = "meadow.ovl"
        [team]
        robots = ["a", "b"]
        [inputs]
        time = { source = "time", universe = [0, 1], missing = { then = 0 } }
        [behaviours.go]
        criticality = { time = "PB PB PB PB PB PB PB" }
        once = true
        [frames]
        go = { productions = ["entry -> await -> tell -> drive -> exit"] }
        [facts]
        called = { mate = "any", signals = 1 }
        [actions]
        await = { do = "hold 5 s", until = ["called"] }
        tell = { do = "signal 1" }
        drive = { do = "follow gate" }
    "#;
    let folder = folder(&[("meadow.ovl", MEADOW), ("team.mission.toml", team)]);
    let arguments = "team.mission.toml --robot a --start 10,20 --perfect --json";
    let (status, out, err) = run(folder.path(), arguments);
    assert!(status == 0 && out.starts_with('{'), "{out}{err}");
    assert!(err.contains("`a` and `b` may wait for each other"), "{err}");
    assert!(!err.contains("what the plans need"), "no notes: {err}");
}

/// A note says where the simulator places the map; the JSON stays pure.
#[test]
fn a_map_without_a_place_on_the_globe_is_driven() {
    let flat = "MISSION-AREA 30 30\nORIGIN 0 0\nCONTROL MEASURES:\nPP a 5 5\n";
    let grid = "type octile\nheight 12\nwidth 12\nmap\n".to_owned()
        + &"............\n".repeat(5)
        + "..@@@@@@@@..\n"
        + &"............\n".repeat(6);
    let folder = folder(&[("flat.ovl", flat), ("grid.map", &grid)]);
    for (arguments, note) in [
        ("flat.ovl --start 20,20", "south-west corner (0.00, 0.00) at 45 N, 8 E"),
        ("grid.map --start 6,2 --goal far=6,10", "south-west corner (0.00, 0.00) at 45 N, 8 E"),
    ] {
        outcome(folder.path(), arguments, "reached", 0);
        let (_, out, err) = run(folder.path(), &format!("{arguments} --perfect --json"));
        assert!(err.starts_with("note: ") && err.contains(note), "{err}");
        assert!(out.starts_with('{') && out.ends_with("}\n"), "{out}");
    }
}

#[test]
fn a_world_is_found_beside_the_mission_or_the_map() {
    let folder = folder(&[
        ("meadow.ovl", MEADOW),
        ("meadow.world.toml", "start = [10, 20]\ntime_limit = 300\n"),
        ("short.mission.toml", "map = \"meadow.ovl\"\n"),
        ("short.world.toml", "start = [48, 30]\n"),
        ("long.mission.toml", "map = \"meadow.ovl\"\n"),
    ]);
    let at = folder.path();
    // Without work, the run ends at the goal.
    let far = outcome(at, "meadow.ovl", "reached", 0)["distance_m"].as_f64().unwrap();
    let near = outcome(at, "short.mission.toml", "reached", 0)["distance_m"].as_f64().unwrap();
    let long = outcome(at, "long.mission.toml", "reached", 0)["distance_m"].as_f64().unwrap();
    assert!(near < 3.0 && far > 40.0 && long == far, "{near} {far} {long}");
    fs::write(at.join("meadow.world.toml"), "start = [10, 20]\ntime_limit = 5\n").unwrap();
    outcome(at, "meadow.ovl", "out-of-time", 1);
    // With work, arriving at the goal is not enough.
    fs::write(at.join("meadow.world.toml"), "start = [48, 30]\ntime_limit = 20\nsignal = 7\n")
        .unwrap();
    outcome(at, "meadow.ovl", "out-of-time", 1);
    // The mistakes of map, mission and world are reported together.
    fs::write(at.join("meadow.world.toml"), "strat = [1, 2]\nheading = 'east'\n").unwrap();
    fs::write(at.join("meadow.mission.toml"), "resolutoin = 1\n").unwrap();
    let (status, _, err) = run(at, "meadow.ovl");
    assert_eq!(status, 3, "{err}");
    for part in [
        "meadow.mission.toml:1:1",
        "did you mean `resolution`?",
        "`start` is missing",
        "meadow.world.toml:1:1",
        "did you mean `start`?",
        "meadow.world.toml:2:11",
        "`heading` must be a number",
    ] {
        assert!(err.contains(part), "{part} is missing in\n{err}");
    }
}

/// A mission with one behaviour that is critical for ten minutes and runs these actions.
fn behaviour(actions: &str, graph: &str) -> String {
    format!(
        "map = \"meadow.ovl\"\nplan = \"gate\"\n[inputs]\nclock = {{ source = \"time\", universe = [0, 600] }}\n\
         [behaviours.go]\ncriticality = {{ clock = \"PS PS PS PS PS PS NB\" }}\n\
         [frames.go]\nproductions = [\"entry -> {graph} -> exit\"]\n[actions]\n{actions}"
    )
}

#[test]
fn a_long_hold_and_a_short_idle_time_do_not_end_a_run() {
    let hold =
        behaviour("wait = { do = \"hold 100 s\" }\ndone = { do = \"signal 7\" }\n", "wait -> done");
    let folder = folder(&[
        ("meadow.ovl", MEADOW),
        ("hold.mission.toml", &hold),
        ("hold.world.toml", "start = [10, 20]\ntime_limit = 300\nsignal = 7\n"),
        ("quiet.mission.toml", &hold),
        ("quiet.world.toml", "start = [10, 20]\ntime_limit = 130\n"),
    ]);
    let held = outcome(folder.path(), "hold.mission.toml", "done", 0);
    assert!((held["time_s"].as_f64().unwrap() - 100.0).abs() < 2.0, "{held}");
    // Without work, a run does not end as soon as the robot is idle.
    let quiet = outcome(folder.path(), "quiet.mission.toml", "out-of-time", 1);
    assert_eq!(quiet["time_s"], 130.0);
}

#[test]
fn a_closed_pipe_is_not_a_failure() {
    let folder = folder(&[("meadow.ovl", MEADOW)]);
    let mut child = command(folder.path(), "meadow.ovl --start 48,30 --perfect")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let ended = child.wait_with_output().unwrap();
    let err = String::from_utf8(ended.stderr).unwrap();
    assert_eq!((ended.status.code(), err.as_str()), (Some(0), ""));
}

/// The files that a run reads: map, mission, world and the map of the truth.
fn a_whole_project() -> TempDir {
    folder(&[
        ("meadow.ovl", MEADOW),
        ("meadow.mission.toml", "plan = \"gate\"\n"),
        ("meadow.world.toml", "start = [48, 30]\ntruth = \"built.ovl\"\n"),
        ("built.ovl", MEADOW),
    ])
}

#[cfg(unix)]
#[test]
fn no_run_replaces_what_it_reads() {
    let folder = a_whole_project();
    let at = folder.path();
    std::os::unix::fs::symlink("built.ovl", at.join("link.png")).unwrap();
    let contents = || {
        let mut files: Vec<_> =
            fs::read_dir(at).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (fs::read(&path).unwrap(), path)).collect::<Vec<_>>()
    };
    let before = contents();
    for (options, part) in [
        ("--trace meadow.ovl", "the output meadow.ovl is also the input"),
        ("--trace ./meadow.mission.toml", "is also the input"),
        ("--trace meadow.world.toml", "is also the input"),
        ("--trace built.ovl", "is also the input"),
        ("--picture link.png", "the output link.png is also the input"),
        ("--trace a.svg --picture ./a.svg", "--trace and --picture both write a.svg"),
    ] {
        let (status, out, err) = run(at, &format!("meadow.ovl {options}"));
        assert_eq!((status, out.as_str()), (3, ""), "{options}: {err}");
        assert!(err.contains(part), "{options}: {err}");
        assert!(contents() == before, "{options} changed a file");
    }
    // The same holds for the tables that `experiment` puts together.
    let table = "what --csv wrote\n";
    fs::write(at.join("a.csv"), table).unwrap();
    let (status, _, err) = ended(command_of("experiment", at, "--merge a.csv --csv ./a.csv"));
    assert!(status == 3 && err.contains("is also the input"), "{status}: {err}");
    assert_eq!(fs::read_to_string(at.join("a.csv")).unwrap(), table);
}

/// A mistake in the project is reported with them, so nothing has run.
#[test]
fn outputs_that_cannot_be_written_are_reported_before_the_run() {
    let folder = a_whole_project();
    for (options, expected, part) in [
        ("--picture x.jpg", 2, "the picture's name must end in .svg or .png"),
        ("--picture x", 2, "the picture's name must end in .svg or .png"),
        ("--trace no/x", 3, "cannot write no/x: the folder does not exist"),
        ("--picture no/x.png", 3, "cannot write no/x.png: the folder does not exist"),
        ("--trace .", 3, ". is a directory"),
    ] {
        let (status, out, err) = run(folder.path(), &format!("meadow.ovl --plan gaet {options}"));
        assert_eq!((status, out.as_str()), (expected, ""), "{options}: {err}");
        assert!(err.contains(part), "{options}: {err}");
        assert_eq!(err.contains("did you mean `gate`?"), expected == 3, "{options}: {err}");
    }
    for options in ["--seed -1", "--pilot host --seed -1"] {
        let (status, _, err) = run(folder.path(), &format!("meadow.ovl {options}"));
        assert!(status == 2 && err.contains("invalid value '-1' for '--seed"), "{options}: {err}");
    }
}

/// A full disk is not a run that failed, and a program that reads the JSON must learn of it.
#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written_has_the_status_of_files() {
    let folder = a_whole_project();
    let (status, _, err) = run(folder.path(), "meadow.ovl --perfect --trace /dev/full");
    assert!(status == 3 && err.contains("cannot write /dev/full"), "{status}: {err}");
    for options in ["--json", "--perfect"] {
        let mut command = command(folder.path(), &format!("meadow.ovl {options}"));
        command.stdout(fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
        let (status, _, err) = ended(command);
        assert!(status == 3 && err.contains("cannot write to standard output"), "{status}: {err}");
    }
}

/// Missions of users: a hold longer than a minute, and a patrol that sleeps for a while.
#[test]
fn missions_of_users_end_as_intended() {
    let Some(data) = it::real_data("field/missions") else { return };
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(data).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    for (name, wrong) in [("26_percent", "trapped"), ("m13", "trapped")] {
        let (_, out, err) = run(folder.path(), &format!("{name}.mission.toml --perfect --json"));
        let object: Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}{err}"));
        assert_ne!(object["outcome"], wrong, "{name}: {out}");
    }
    let (_, out, _) = run(folder.path(), "m02.mission.toml --perfect --json");
    let object: Value = serde_json::from_str(&out).unwrap();
    // At 305 s, `charge` ends, and `patrol` sleeps for one more tick.
    assert!(object["time_s"].as_f64().unwrap() > 310.0, "{out}");
}

/// Of several goals, the summary, the JSON and the explanation of a trace name the one that was reached.
#[test]
fn the_goal_that_was_reached_is_named() {
    let shipped = ["stations.ovl", "stations.mission.toml"]
        .map(|name| (name, fs::read_to_string(it::own_map(name)).unwrap()));
    let files: Vec<(&str, &str)> = shipped.iter().map(|(name, text)| (*name, &text[..])).collect();
    let folder = folder(&files);
    let drive = "stations.ovl --start 36,10 --perfect";
    let (status, out, err) = run(folder.path(), &format!("{drive} --trace drive.trace"));
    assert!(status == 0 && out.contains("outcome     Reached fuel[0] at 20,6\n"), "{out}{err}");
    let (_, out, _) = run(folder.path(), &format!("{drive} --json"));
    let object: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&object["goal"], &object["goal_m"]), (&"fuel[0]".into(), &json!([20.0, 6.0])));
    let explained = |arguments: &[&str]| {
        let mut command = Command::new(setup::plan_compiler().unwrap());
        let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let story = explained(&["explain", "drive.trace"]);
    assert!(story.contains("because: Driving (fuel[0])"), "{story}");
    assert!(story.contains("because: AtGoal (fuel[0])"), "{story}");
    let last = explained(&["explain", "drive.trace", "--tick", "last"]);
    assert!(last.contains("goal       fuel[0]\n") && last.contains(", fuel[0]\n"), "{last}");
}
