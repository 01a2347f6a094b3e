//! The `plan-compiler` binary as a user runs it, each time in a new folder. The tests check its exit
//! status, its output and the files that it writes.
//!
//! Its error messages are in `tests/golden/errors`, one file per class of mistakes.
//! `INSTA_UPDATE=always cargo test -p it cli` rewrites them.

mod examples;
mod goals;
mod hostile;
mod maps;
mod passages;
mod people;
mod pictures;
mod reach;
mod shades;
mod tolls;
mod typed;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A yard of 40 m by 30 m with one building, a tree and two named points.
const YARD: &str = "\
SITE yard
MISSION-AREA 40 30
ORIGIN 0 0
CONTROL MEASURES:
PP StartPlace 3 3
PP gate 35 25
PP shed 5 25
WALL house 12 8  22 8  22 18  12 18  12 8
OBSTACLE 30 10 2.5
BOUNDARY \"NoCommZone west\" 0 20  10 20  10 30  0 30
BOUNDARY NoFlyZone1 28 20  32 20  32 24  28 24
";

/// The binary in a new folder.
pub(crate) struct Run {
    pub(super) folder: TempDir,
}

/// The result of a run.
pub(crate) struct Ended {
    pub(crate) status: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Run {
    pub(crate) fn new(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        Self { folder }
    }

    fn yard() -> Self {
        Self::new(&[("yard.ovl", YARD.as_bytes())])
    }

    pub(crate) fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    /// Runs with arguments that are separated by `|`, or by spaces if there is no `|`.
    pub(crate) fn run(&self, arguments: &str, input: &str) -> Ended {
        let by = if arguments.contains('|') { '|' } else { ' ' };
        let mut child = Command::new(harness::setup::plan_compiler().unwrap())
            .args(arguments.split(by).filter(|argument| !argument.is_empty()))
            .current_dir(self.folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let input = input.to_owned();
        // A program that does not read its input closes the pipe.
        let feeding = std::thread::spawn(move || {
            let _ = std::io::Write::write_all(&mut stdin, input.as_bytes());
        });
        let output = child.wait_with_output().unwrap();
        feeding.join().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Ended {
            status: output.status.code().expect("an exit status, not a signal"),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    }

    /// Runs a command that must succeed.
    pub(crate) fn done(&self, arguments: &str) -> String {
        let ended = self.run(arguments, "");
        assert_eq!(ended.status, 0, "{arguments}\n{}", ended.err);
        ended.out
    }

    /// Names of the files in the folder.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// Checks that a mistake ends with status 1, reports the message of the golden file, prints nothing,
/// and leaves every file unchanged, whether the output existed or not.
fn check(name: &str, files: &[(&str, &[u8])], arguments: &str, input: &str) {
    for output_exists in [false, true] {
        let run = Run::new(files);
        if output_exists && !run.path("plans.bin").exists() {
            fs::write(run.path("plans.bin"), "before").unwrap();
        }
        let before = run.names();
        let plans_before = fs::read(run.path("plans.bin")).ok();
        let ended = run.run(arguments, input);
        let ending = (ended.status, ended.out.as_str());
        assert_eq!(ending, (1, ""), "{name}\n{}", ended.err);
        assert_eq!(run.names(), before, "{name} left files");
        assert_eq!(fs::read(run.path("plans.bin")).ok(), plans_before, "{name} changed a file");
        golden(name, arguments, &ended.err);
    }
}

/// Compares with `tests/golden/errors/NAME.snap`.
fn golden(name: &str, arguments: &str, err: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(it::root().canonicalize().unwrap().join("tests/golden/errors"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(format!("plan-compiler {}", arguments.replace('|', " ")));
    settings.bind(|| insta::assert_snapshot!(name, err));
}

/// As [`check`], in the yard.
fn check_yard(name: &str, arguments: &str) {
    check(name, &[("yard.ovl", YARD.as_bytes())], arguments, "");
}

/// As [`check`], in the yard with a mission beside it.
fn check_mission(name: &str, mission: &str) {
    let files = [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    check(name, &files, "build yard.ovl", "");
}

/// As [`check`], for an overlay of its own.
fn check_overlay(name: &str, overlay: &str) {
    check(name, &[("map.ovl", overlay.as_bytes())], "build map.ovl", "");
}

#[test]
fn goals_that_cannot_be_had() {
    check_yard("goal_in_obstacle", "build yard.ovl --goal gate=30,10");
    check_yard("goal_outside", "build yard.ovl --goal gate=-1,10");
    check_yard("goal_named_twice", "build yard.ovl --goal gate=1,1 --goal gate=2,2");
    check_yard(
        "goals_wrong_in_several_ways",
        "build yard.ovl --goal a=30,10 --goal b=90,1 --goal b=1,1",
    );
    let nothing = "MISSION-AREA 40 30\nCONTROL MEASURES:\nOBSTACLE 5 5 1\n";
    check_overlay("no_goal_at_all", nothing);
    let many: String = (0..65).map(|i| format!("g{i} = [38, {}]\n", i % 28)).collect();
    check_mission("too_many_goals", &format!("[goals]\n{many}"));
}

#[test]
fn areas_that_cannot_be_compiled() {
    let area = |size: &str| format!("MISSION-AREA {size}\nCONTROL MEASURES:\nPP gate 1 1\n");
    check_overlay("area_too_large", &area("20000 100"));
    check_overlay("area_of_a_billion_metres", &area("1000000000 1000000000"));
    check_overlay("area_absurd", &area("1e300 1e300"));
    check_overlay("area_empty", &area("0 0"));
    let full = "MISSION-AREA 10 10\nCONTROL MEASURES:\nPP gate 1 1\nOBSTACLE 5 5 20\n";
    check_overlay("no_free_cell", full);
    check_yard("resolution_zero", "build yard.ovl --resolution 0");
    check_yard(
        "resolution_negative_and_radius_too",
        "build yard.ovl --resolution -1 --robot-radius -2",
    );
    check_yard("resolution_nan", "build yard.ovl --resolution nan");
    check_yard("resolution_absurd", "build yard.ovl --resolution 1e-300");
    check_mission("resolution_zero_in_mission", "resolution = 0\n");
}

#[test]
fn files_that_are_no_maps() {
    check("binary", &[("map.ovl", b"\x7fELF\x02\x01\x00\x00\xff\xfe")], "build map.ovl", "");
    check("empty", &[("map.ovl", b"")], "build map.ovl", "");
    check("unknown_format", &[("letter.txt", b"Dear reader,\n")], "build letter.txt", "");
    check("missing", &[("yard.ovl", YARD.as_bytes())], "build yrad.ovl", "");
    check("directory", &[], "build .", "");
}

#[test]
fn a_map_without_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let run = Run::yard();
    fs::set_permissions(run.path("yard.ovl"), fs::Permissions::from_mode(0o0)).unwrap();
    // The superuser may read everything.
    if fs::read(run.path("yard.ovl")).is_err() {
        let ended = run.run("build yard.ovl", "");
        assert_eq!(ended.status, 1);
        assert!(ended.err.contains("no permission to read yard.ovl"), "{}", ended.err);
    }
}

#[test]
fn missions_with_mistakes() {
    check_mission("mission_not_toml", "resolution = \n[goals\n");
    check_mission(
        "mission_unknown_keys",
        "resolutoin = 1\nmax_speed = 2\n[vehicel]\n[vehicle]\nspeed = 1\n",
    );
    check_mission(
        "mission_wrong_types",
        "resolution = \"fine\"\ncorners = \"sometimes\"\nfill_walls = 1\n[goals]\na = [1]\nb = 3\n\
         c = { layers = [1] }\n\"d/e\" = [1, 1]\n[vehicle]\nmax_speed = 1000\nsteering = 2\n",
    );
    check_mission(
        "mission_unknown_names",
        "plan = \"gaet\"\n[goals]\ngate = \"gaet\"\nshed = { at = [20, 25], layers = [\"comm\"] }\n\
         [layers]\nnight = [\"NoFlyZone2\"]\n",
    );
    check_mission("mission_no_such_plan", "plan = \"gaet\"\n");
    check_mission(
        "mission_goal_in_a_layer_asked_for",
        "[goals]\nhut = { at = [5, 25], layers = [\"physical\", \"comms\"] }\n",
    );
    check_mission(
        "mission_too_many_layers",
        &(0..8).fold("[layers]\n".to_owned(), |text, i| format!("{text}l{i} = [\"NoFlyZone1\"]\n")),
    );
    let files: [(&str, &[u8]); 1] = [("yard.mission.toml", b"resolution = 1\n")];
    check("mission_without_a_map", &files, "build yard.mission.toml", "");
    let files: [(&str, &[u8]); 1] = [("yard.mission.toml", b"map = \"yard.ovl\"\n")];
    check("mission_of_a_missing_map", &files, "build yard.mission.toml", "");
}

#[cfg(unix)]
#[test]
fn no_command_replaces_what_it_reads() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let layer = "plans.bin --layer gate/physical";
    for (command, read, link) in [
        (format!("export {layer} --what cost"), "plans.bin", "plans.npy"),
        (format!("render {layer}"), "plans.bin", "plans.svg"),
        (format!("render {layer} --map yard.ovl"), "yard.ovl", "yard.svg"),
        ("graph plans.bin".to_owned(), "plans.bin", "plans.dot"),
        ("convert plans.bin".to_owned(), "plans.bin", "Iplan.dat"),
    ] {
        let before = fs::read(run.path(read)).unwrap();
        std::os::unix::fs::symlink(read, run.path(link)).unwrap();
        let ended = run.run(&format!("{command} -o {link}"), "");
        let is_refused = ended.status == 1 && ended.err.contains("is also the input");
        assert!(is_refused, "{command}\n{}", ended.err);
        assert_eq!(fs::read(run.path(read)).unwrap(), before, "{command}");
    }
}

#[test]
fn outputs_that_cannot_be_written() {
    check_yard("output_folder_missing", "build yard.ovl -o no/such/plans.bin");
    check_yard("output_is_the_input", "build yard.ovl -o yard.ovl");
    check_yard("output_is_a_directory", "build yard.ovl -o .");
    // With all else that is wrong, and before anything is searched.
    check_yard(
        "output_folder_missing_and_goal_outside",
        "build yard.ovl --goal a=-1,0 -o no/a.bin",
    );
    check_yard("output_below_a_file", "build yard.ovl -o yard.ovl/plans.bin");
}

#[test]
fn blobs_that_are_refused() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let good = fs::read(run.path("plans.bin")).unwrap();
    check("blob_as_map", &[("plans.bin", &good)], "build plans.bin -o new.bin", "");
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    let blob = |name: &str, bytes: &[u8], arguments: &str| {
        check(name, &[("plans.bin", bytes)], arguments, "");
    };
    blob("blob_rubbish", b"this is not a blob, however long it may be made", "inspect plans.bin");
    blob("blob_truncated", &good[..good.len() - 1], "inspect plans.bin --json");
    blob("blob_flipped", &flipped, "verify plans.bin");
    blob("blob_empty", b"", "query plans.bin --layer a/b --at 1,1");
    blob("layer_unknown", &good, "query plans.bin --layer gate/phisical --at 1,1");
    blob("no_place_on_the_globe", &good, "query plans.bin --layer gate/physical --geo 1,1");
    let files = [("plans.bin", good.as_slice()), ("yard.ovl", YARD.as_bytes())];
    check("verify_other_radius", &files, "verify plans.bin --map yard.ovl --robot-radius 0.4", "");
    check("verify_other_corners", &files, "verify plans.bin --map yard.ovl --corners allow", "");
    check("verify_neither_file", &files, "verify plan.bin --map yrad.ovl", "");
    check("verify_other_grid", &files, "verify plans.bin --map yard.ovl --resolution 0.5", "");
}

#[test]
fn wrong_usage_ends_with_2() {
    let run = Run::yard();
    run.done("build yard.ovl");
    for arguments in [
        "",
        "bild yard.ovl",
        "build",
        "build yard.ovl --goal gate",
        "build yard.ovl --goal gate=1",
        "build yard.ovl --goal gate=nan,1",
        "build yard.ovl --goal =1,1",
        "build yard.ovl --resolution fine",
        "build yard.ovl --corners maybe",
        "build yard.ovl --opar-type 3=river",
        "query plans.bin --layer gate/physical",
        "query plans.bin --layer gate --at 1,1",
        "query plans.bin --layer gate/physical --at 1;1",
        "export plans.bin --layer gate/physical --what cost -o cost.txt",
        "render plans.bin --layer gate/physical -o picture.gif",
    ] {
        let ended = run.run(arguments, "");
        assert_eq!(ended.status, 2, "{arguments}\n{}", ended.err);
        assert!(ended.err.contains("--help") || ended.err.contains("Usage"), "{}", ended.err);
    }
    assert_eq!(run.names(), ["plans.bin", "yard.ovl"]);
}

#[test]
fn help_teaches_by_examples_and_says_what_is_assumed() {
    let run = Run::new(&[]);
    let help = run.done("--help");
    for part in [
        "Examples:",
        "--goal gate=-17.5,17.5",
        "OPAR",
        "WGS-84",
        "--opar-units",
        "Clarke",
        "GeoJSON",
        "MovingAI",
    ] {
        assert!(help.contains(part), "{part} is missing in\n{help}");
    }
    assert!(run.done("build --help").contains("--robot-radius"));
}

#[test]
fn warnings_do_not_stop_a_build() {
    let mission = "[layers]\nnight = [\"NoFlyZone1\"]\n";
    let points = "PP lost 99 99\nPP inside 30 10\nPP gate 1 1\n";
    let map = format!("{YARD}{points}");
    let run = Run::new(&[("yard.ovl", map.as_bytes()), ("yard.mission.toml", mission.as_bytes())]);
    let ended = run.run("build yard.ovl", "");
    assert_eq!(ended.status, 0, "{}", ended.err);
    let (warnings, summary) = ended.err.split_once("plans.bin:").expect("a summary");
    golden("warnings", "build yard.ovl", warnings);
    assert!(summary.contains("40 x 30 cells of 1 m"), "{summary}");
    assert_eq!(run.run("build yard.ovl --quiet", "").err, warnings);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let mission = "map = \"yard.ovl\"\nrobot_radius = 0.5\n[goals]\nhere = [5, 5]\n";
    let run = Run::new(&[("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())]);
    run.done("build yard.ovl -o a.bin");
    run.done("build yard.mission.toml -o b.bin");
    run.done("build yard.ovl --mission yard.mission.toml -o c.bin");
    let read = |name| fs::read(run.path(name)).unwrap();
    assert_eq!(read("a.bin"), read("b.bin"));
    assert_eq!(read("a.bin"), read("c.bin"));
    run.done("verify a.bin --map yard.ovl");
    // The command line outranks the mission.
    run.done("build yard.ovl --robot-radius 0 --goal here=5,5 -o d.bin");
    assert_ne!(read("a.bin"), read("d.bin"));
}

#[test]
fn inspect_says_what_the_blob_holds() {
    let run = Run::yard();
    run.done("build yard.ovl --robot-radius 0");
    let said: Value = serde_json::from_str(&run.done("inspect plans.bin --json")).unwrap();
    assert_eq!(said["bytes"], fs::metadata(run.path("plans.bin")).unwrap().len());
    assert_eq!((&said["columns"], &said["rows"]), (&40.into(), &30.into()));
    assert_eq!(said["resolution_m"], 1.0);
    assert_eq!(said["corner_m"], serde_json::json!([0.0, 0.0]));
    assert_eq!(said["origin"], Value::Null);
    let plans = said["plans"].as_array().unwrap();
    let names: Vec<&Value> = plans.iter().map(|plan| &plan["name"]).collect();
    assert_eq!(names, ["gate", "shed"]);
    assert_eq!(plans[0]["goal_m"], serde_json::json!([35.0, 25.0]));
    // The shed lies in the zone without communications.
    let layers = |plan: &Value| plan["layers"].as_array().unwrap().len();
    assert_eq!((layers(&plans[0]), layers(&plans[1])), (2, 1));
    let layer = &plans[0]["layers"][0];
    let count = |name: &str| layer[name].as_u64().unwrap();
    assert_eq!(layer["name"], "physical");
    assert_eq!(count("free") + count("blocked") + count("unreachable"), 40 * 30);
    // The inside of the house: 9 m by 9 m of free cells that the wall does not touch.
    assert_eq!(count("unreachable"), 81);
    let text = run.done("inspect plans.bin");
    assert!(text.contains("gate/physical") && !text.contains("  team "), "{text}");
    assert_eq!(said.get("team"), None);
}

#[test]
fn inspect_names_the_robot_of_a_team() {
    let mission = b"[team]\nrobots = [\"a\", \"b\", \"c\"]\n";
    let run = Run::new(&[("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission)]);
    run.done("build yard.ovl --robot b");
    let text = run.done("inspect plans.bin");
    assert!(text.contains("  team    robot 2 of 3, `b`\n"), "{text}");
    let said: Value = serde_json::from_str(&run.done("inspect plans.bin --json")).unwrap();
    assert_eq!(said["team"], serde_json::json!({ "robot": 2, "robots": 3, "name": "b" }));
}

#[test]
fn query_answers_every_point() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let ended = run.run(
        "query plans.bin --layer gate/physical -",
        "35.5 25.5\n 34.5 24.5 \n\n34.5 25.9\n30 10\n17 13\n-1 5\n40 5\n1e300 0\n",
    );
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let lines: Vec<Value> =
        ended.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let row = |line: &Value| {
        let text = |name: &str| line[name].as_str().unwrap_or("-").to_owned();
        (text("direction"), text("cell"), line["escape"].as_bool().unwrap())
    };
    let expected = [
        ("goal", "free", false),
        ("NE", "free", false),
        ("E", "free", false),
        ("", "blocked", true),
        ("-", "free", false),
        ("-", "off-map", false),
        ("-", "off-map", false),
        ("-", "off-map", false),
    ];
    assert_eq!(lines.len(), expected.len());
    for (line, (direction, cell, escape)) in lines.iter().zip(expected) {
        let (got_direction, got_cell, got_escape) = row(line);
        assert_eq!((got_cell.as_str(), got_escape), (cell, escape), "{line}");
        // The direction out of a circle's middle is not defined.
        assert!(direction.is_empty() || direction == got_direction, "{line}");
    }
    assert_eq!(lines[0]["cost_m"], 0.0);
    assert!((lines[1]["cost_m"].as_f64().unwrap() - std::f64::consts::SQRT_2).abs() < 1e-6);
    assert_eq!(lines[3]["cost_m"], Value::Null);
    let keys: Vec<&str> = ["x", "y", "cost_m", "direction", "escape", "cell"].into();
    let first = ended.out.lines().next().unwrap();
    assert!(keys.windows(2).all(|pair| first.find(pair[0]) < first.find(pair[1])), "{first}");
    let one = run.done("query plans.bin --layer gate/physical --at -1,5");
    assert_eq!(one.trim(), ended.out.lines().nth(5).unwrap());
}

#[test]
fn wrong_lines_of_input_are_named_after_the_others_are_answered() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let ended =
        run.run("query plans.bin --layer gate/physical -", "1 1\none two\n3\n4 4 4 4\nnan 1\n2 2");
    assert_eq!((ended.status, ended.out.lines().count()), (1, 2));
    golden("query_lines_that_are_no_points", "query plans.bin --layer gate/physical -", &ended.err);
}

#[test]
fn a_reader_that_has_had_enough_is_no_failure() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let mut child = Command::new(harness::setup::plan_compiler().unwrap())
        .args(["query", "plans.bin", "--layer", "gate/physical", "-"])
        .current_dir(run.folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut stdin = child.stdin.take().unwrap();
    // More answers than a pipe holds; the program may close its end before it has all.
    let _ = std::io::Write::write_all(&mut stdin, "1 1\n".repeat(100_000).as_bytes());
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty());
}

#[test]
fn arrays_agree_with_the_look_up() {
    let run = Run::yard();
    run.done("build yard.ovl --resolution 0.5");
    for what in ["cost", "direction", "blocked"] {
        for kind in ["npy", "csv"] {
            run.done(&format!(
                "export plans.bin --layer gate/comms --what {what} -o {what}.{kind}"
            ));
        }
    }
    let blob = fs::read(run.path("plans.bin")).unwrap();
    let blob = plan_format::Blob::parse_exact(&blob).unwrap();
    let layer = blob.find("gate").unwrap().layer(1).unwrap();
    let cost = npy(&run.path("cost.npy"), "'<f4'");
    let direction = npy(&run.path("direction.npy"), "'|i1'");
    let blocked = npy(&run.path("blocked.npy"), "'|u1'");
    let cells = (0..60).flat_map(|row| (0..80).map(move |c| plan_format::Cell::new(c, row)));
    for (index, cell) in cells.enumerate() {
        use plan_format::{Answer, grid::cost_metres};
        let infinite = f32::INFINITY;
        let (cost_m, code, is_blocked) = match layer.look_up(cell) {
            Answer::Goal => (0.0, -1, 0),
            Answer::Move { direction, cost } => {
                (cost_metres(cost, 0.5) as f32, direction.code() as i8, 0)
            }
            Answer::NoRoute => (infinite, -2, 0),
            Answer::Blocked { .. } => (infinite, -2, 1),
            Answer::OffMap => panic!("{cell:?} is on the map"),
        };
        let bytes = cost[4 * index..][..4].try_into().unwrap();
        assert_eq!(f32::from_le_bytes(bytes), cost_m, "{cell:?}");
        assert_eq!((direction[index] as i8, blocked[index]), (code, is_blocked), "{cell:?}");
    }
    let csv = fs::read_to_string(run.path("cost.csv")).unwrap();
    let from_text: Vec<u8> = csv
        .lines()
        .flat_map(|line| line.split(','))
        .flat_map(|number| number.parse::<f32>().unwrap().to_le_bytes())
        .collect();
    assert_eq!(from_text, cost);
    assert_eq!(csv.lines().count(), 60);
}

/// The numbers of an array of 60 rows and 80 columns.
fn npy(path: &Path, kind: &str) -> Vec<u8> {
    npy_of(path, kind, (60, 80))
}

/// The numbers of an array of these rows and columns.
fn npy_of(path: &Path, kind: &str, (rows, columns): (u32, u32)) -> Vec<u8> {
    let bytes = fs::read(path).unwrap();
    let header = String::from_utf8_lossy(&bytes[10..128]);
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"));
    let shape = format!("'shape': ({rows}, {columns})");
    for part in [kind, "'fortran_order': False", &shape] {
        assert!(header.contains(part), "{header}");
    }
    bytes[128..].to_vec()
}

#[test]
fn the_campus_is_built_and_proved_by_its_mission() {
    let folder = tempfile::tempdir().unwrap();
    let run = Run { folder };
    for map in ["campus.opar", "campus.ovl"] {
        let map = it::own_map(map);
        let map = map.canonicalize().unwrap();
        run.done(&format!("build|{}", map.display()));
        let proof = run.done(&format!("verify|plans.bin|--map|{}", map.display()));
        assert!(proof.contains("proved"), "{proof}");
    }
}
