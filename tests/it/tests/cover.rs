//! Coverage and fuel: the shipped glebe is mown strip by strip, and robots turn back to refuel while
//! their tanks still lead them there.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::work::record_with;
use harness::mission::{self, Changes};
use harness::setup;
use it::own_map;
use maps::{Extent, Map};
use plan_compiler::cover::{Area, Asked, Strip, covered, site};
use plan_compiler::project::{Request, load};
use serde_json::Value;
use sim::{Difference, Ending, Scenario, SensorSettings};
use tempfile::TempDir;

/// Width of the mower, metres.
const WIDTH_M: f64 = 3.0;

/// W27: coverage, fuel and radio in one mission. The robot drives over at least 95 % of the ground
/// that it may enter, touches nothing, and refuels on its way.
#[test]
fn w27_the_glebe_is_mown_as_its_mission_drives() {
    let path = own_map("glebe.mission.toml");
    let scenario = mission::scenario(&path, &Changes::default());
    let scenario = scenario.unwrap_or_else(|problems| panic!("{problems}"));
    let (outcome, story, _) = record_with(&scenario, scenario.sensors());
    assert_eq!((outcome.ending, outcome.touches), (Some(Ending::Done), 0), "{outcome:?}");
    let refuelled = story.turns.iter().filter(|turn| turn.interrupted_at_once == Some(false));
    assert!(refuelled.count() >= 1, "a tank is not enough for the whole field");

    let mut problems = Vec::new();
    let project = load(Request { path, ..Request::default() }, &mut problems).expect("a project");
    let area = Area::named(&project.map, "Glebe").expect("the map has the area");
    let site = site(&project.input(), area, Asked::default(), &mut problems).expect("it is free");
    let legs = outcome.route.windows(2).map(|leg| Strip { from: leg[0], to: leg[1] });
    let driven = covered(&site.ground.grid, &legs.collect::<Vec<_>>(), WIDTH_M / 2.0);
    let ground = site.ground.cells.count();
    let mown = site.ground.cells.iter().filter(|cell| driven.get(*cell)).count();
    assert!(mown * 100 >= ground * 95, "{mown} of {ground} cells are mown");
    let plan = scenario.plan();
    let pump = plan.parallel_plans().next().expect("there are plans");
    assert_eq!((pump.name(), pump.layer_count()), ("pump", 2), "the other layer is `comms`");
}

/// The shipped strips are those that the command writes today.
#[test]
fn the_strips_of_the_glebe_are_up_to_date() {
    let folder = tempfile::tempdir().expect("there is room");
    for name in ["glebe.geojson", "glebe.mission.toml"] {
        fs::copy(own_map(name), folder.path().join(name)).expect("there is room");
    }
    let mission = folder.path().join("glebe.mission.toml");
    let mut command = Command::new(setup::plan_compiler().expect("the program is built"));
    command.arg("cover").arg(&mission).args(["--area", "Glebe", "--width", "3", "--leave", "1"]);
    let output = command.arg("--plan-each").arg("-o").arg(&mission).output();
    let output = output.expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = |path| fs::read_to_string(path).expect("it is readable");
    assert_eq!(text(mission), text(own_map("glebe.mission.toml")));
}

/// Each mistake has an exit status and a message with help, and leaves no file.
#[test]
fn mistakes_are_reported_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("there is room");
    let map = own_map("glebe.geojson");
    for (arguments, status, expected) in [
        ("--area glebe --width 3 -o a.png", 1, "did you mean `Glebe`?"),
        ("--area Pond --width 3 -o a.png", 1, "is an obstacle"),
        ("--area Glebe --width 0 -o a.png", 2, "above 0"),
        ("--area Glebe --width 3 --angle inf -o a.png", 2, "not a finite number"),
        ("--area Glebe --width 99 -o a.png", 1, "only 60 m long"),
        ("--area Glebe --width 0.2 -o a.png", 1, "--resolution 0.05"),
        ("--area Glebe --width 3 --overlap 2 -o a.png", 1, "at most half the width"),
        ("--area Glebe --width 3 --layer phys -o a.png", 1, "did you mean `physical`?"),
        ("--area Glebe --width 3 --edge 40 -o a.png", 1, "no cell that the robot may enter"),
        ("--area Glebe --width 3 --start 50,16 -o a.png", 1, "blocked or off the map"),
        ("--area Glebe --width 3 -o a.pdf", 2, ".toml, .csv, .geojson, .svg or .png"),
        ("--area Glebe --width 1 -o a.toml", 1, "beside the one that it adds to"),
        ("--corner 1,1 --corner 9,9 --width 1 -o a.png", 1, "at least 3 corners"),
        ("--corner 1,1 --corner 9,9 --corner 9,1 --corner 1,9 --width 1", 1, "not a polygon"),
        ("--width 1", 2, "--area"),
    ] {
        let mut command = Command::new(setup::plan_compiler().expect("the program is built"));
        let command = command.current_dir(folder.path()).arg("cover").arg(&map);
        let output = command.args(arguments.split(' ')).output().expect("the program runs");
        let message = String::from_utf8_lossy(&output.stderr);
        let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(status), "{arguments}: {message}");
        assert!(message.replace("│ ", "").contains(expected), "{arguments}: {message}");
        assert_eq!(fs::read_dir(folder.path()).expect("it is readable").count(), 0, "{arguments}");
    }
}

/// Runs `cover` with arguments that are separated by spaces: the status and both outputs.
fn run(folder: &Path, arguments: &str) -> (Option<i32>, String, String) {
    let mut command = Command::new(setup::plan_compiler().expect("the program is built"));
    let command = command.current_dir(folder).arg("cover").args(arguments.split(' '));
    let Output { status, stdout, stderr } = command.output().expect("the program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (status.code(), text(&stdout), text(&stderr))
}

/// The corners of a field that goes on for 5 m beyond the map of [`field`].
const FIELD: &str = "--corner 5,5 --corner 45,5 --corner 45,25 --corner 5,25";

/// A folder with a map of 40 m by 30 m.
fn field() -> TempDir {
    const MAP: &str = "MISSION-AREA 40 30\nORIGIN 0 0\nCONTROL MEASURES:\nPP StartPlace* 2 2\n\
                       PP gate 2 2\n";
    let folder = tempfile::tempdir().expect("there is room");
    fs::write(folder.path().join("field.ovl"), MAP).expect("there is room");
    folder
}

/// A mission at the output that is not the one that is added to stays, unless it would not change.
#[test]
fn a_mission_that_is_not_the_input_is_not_replaced() {
    let folder = field();
    let there = folder.path().join("own.mission.toml");
    let by_hand = "map = \"field.ovl\"\n[goals]\nhome = [2, 2]\n";
    fs::write(&there, by_hand).expect("there is room");
    let cover = &format!("field.ovl {FIELD} --width 4 -o own.mission.toml");
    let (status, out, err) = run(folder.path(), cover);
    assert_eq!((status, out.as_str()), (Some(1), ""), "{err}");
    assert!(err.contains("own.mission.toml exists and would be replaced"), "{err}");
    assert!(err.contains("plan-compiler cover own.mission.toml ..."), "{err}");
    assert_eq!(fs::read_to_string(&there).expect("it is readable"), by_hand);
    fs::remove_file(&there).expect("it is there");
    assert_eq!(run(folder.path(), cover).0, Some(0));
    assert_eq!(run(folder.path(), cover).0, Some(0), "the same again");
    let added = &format!("own.mission.toml {FIELD} --width 5 -o own.mission.toml");
    assert_eq!(run(folder.path(), added).0, Some(0), "added to");
    assert_eq!(run(folder.path(), cover).0, Some(1), "another width");
}

/// What is not covered, or is so only because cells have a size, is printed.
#[test]
fn the_summary_hides_nothing() {
    let folder = field();
    let (status, out, err) = run(folder.path(), &format!("field.ovl {FIELD} --width 3 --edge 0"));
    assert_eq!(status, Some(0), "{err}");
    assert!(err.contains("100 m2 of the area lie off the map"), "{err}");
    assert!(out.contains("% within half the width and half a cell of a strip, "), "{out}");
    let json = run(folder.path(), &format!("field.ovl {FIELD} --width 3 --edge 0 --json")).1;
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!((json["area_m2"].as_f64(), json["off_map_m2"].as_f64()), (Some(800.0), Some(100.0)));
    let share = |name: &str| json[name].as_f64().expect(name);
    assert!(share("covered_share_of_half_width") <= share("covered_share"), "{json}");
    // A smaller --edge does not help where it is 0.
    let slanted = "field.ovl --corner 5,5 --corner 35,9 --corner 8,25 --width 1 --robot-radius 0";
    let (_, _, err) = run(folder.path(), slanted);
    let help = "use a finer --resolution";
    assert!(err.contains(help) && !err.contains("make --edge smaller"), "{err}");
}

/// The area is of use to this command, and mistakes about it do not hide others.
#[test]
fn the_area_is_not_the_only_thing_that_is_looked_at() {
    let folder = tempfile::tempdir().expect("there is room");
    let ring = "[[7.0,51.0],[7.0006,51.0],[7.0006,51.0003],[7.0,51.0003],[7.0,51.0]]";
    let feature = |name: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"layer\":\"{name}\"}},\"geometry\":\
             {{\"type\":\"Polygon\",\"coordinates\":[{ring}]}}}}"
        )
    };
    let write = |name: &str, features: &[String]| {
        let list = features.join(",");
        let text = format!("{{\"type\":\"FeatureCollection\",\"features\":[{list}]}}");
        fs::write(folder.path().join(name), text).expect("there is room");
    };
    write("one.geojson", &[feature("A")]);
    write("two.geojson", &[feature("A"), feature("B")]);
    let (status, _, err) = run(folder.path(), "one.geojson --area A --width 3");
    assert!(status == Some(0) && !err.contains("nothing on the map is an obstacle"), "{err}");
    let (status, _, err) = run(folder.path(), "two.geojson --area A --width 3");
    assert!(status == Some(0) && err.contains("which only a mission can use: B"), "{err}");

    let wrong = "one.geojson --area X --width 3 --start 999,9 --layer phys";
    let (status, _, err) = run(folder.path(), wrong);
    for part in ["no area named `X`", "(999, 9) is blocked or off the map", "no layer `phys`"] {
        assert!(status == Some(1) && err.contains(part), "{part} is missing in\n{err}");
    }
    let (_, _, err) = run(folder.path(), &wrong.replace('X', "A"));
    for part in ["(999, 9) is blocked or off the map", "no layer `phys`"] {
        assert_eq!(err.matches(part).count(), 1, "{part}\n{err}");
    }
    let (status, _, err) =
        run(folder.path(), "one.geojson --area A --width 3 --plan-each -o a.csv");
    assert!(status == Some(2) && err.contains("end the output's name in .toml"), "{err}");
}

/// A robot that another behaviour leads away gets back by a plan, if there is one.
#[test]
fn a_mission_with_other_behaviours_asks_for_plans() {
    let folder = tempfile::tempdir().expect("there is room");
    for name in ["glebe.geojson", "glebe.mission.toml"] {
        fs::copy(own_map(name), folder.path().join(name)).expect("there is room");
    }
    let cover = "glebe.geojson --area Glebe --width 4 -o";
    let warning = "after another behaviour (refuel)";
    let (status, _, err) = run(folder.path(), &format!("{cover} a.mission.toml"));
    assert!(status == Some(0) && err.contains(warning) && err.contains("--plan-each"), "{err}");
    let (status, _, err) = run(folder.path(), &format!("{cover} b.mission.toml --plan-each"));
    assert!(status == Some(0) && !err.contains(warning), "{err}");
    // The example of the program's help, driven: with plans, the robot returns after refuelling.
    fs::copy(own_map("glebe.world.toml"), folder.path().join("b.world.toml")).expect("room");
    let scenario = mission::scenario(&folder.path().join("b.mission.toml"), &Changes::default());
    let scenario = scenario.unwrap_or_else(|problems| panic!("{problems}"));
    let (outcome, ..) = record_with(&scenario, scenario.sensors().without_error());
    assert_eq!((outcome.ending, outcome.touches), (Some(Ending::Done), 0), "{outcome:?}");
    let mut help = Command::new(setup::plan_compiler().expect("the program is built"));
    let help = help.arg("--help").output().expect("the program runs").stdout;
    let help = String::from_utf8_lossy(&help).into_owned();
    assert!(help.contains("--area Glebe --width 4 --plan-each "), "{help}");
}

/// A tank for 400 m, a robot that drives away from the pump at (10, 10), and a margin of 30 m: after
/// d metres the tank leads 400 - d m, and the pump is as far as at the start and d m more. So the
/// robot turns after (400 - 30 - distance at the start) / 2 m, the earlier the farther away it began,
/// although its tank is fuller then.
#[test]
fn a_robot_turns_back_while_its_tank_leads_to_the_pump() {
    const MISSION: &str = "
resolution = 0.5
plan = 'pump'
[goals]
pump = [10.25, 10.25]
[vehicle]
radius = 0.3
max_speed = 1.5
[inputs]
reserve = { source = 'range-left pump', full = 400, universe = [0, 100], missing = { then = 0 } }
[facts]
'enough fuel' = { input = 'reserve', at_least = 30 }
[behaviours]
work = { criticality = { 'enough fuel' = 'PS PS' } }
refuel = { criticality = { 'enough fuel' = 'PB NB' }, unconditional = 0.8 }
[frames]
work = { productions = ['entry -> away -> exit'] }
refuel = { productions = ['entry -> back -> exit'] }
[actions]
away = { do = 'go-to 390, 10.25', timeout_s = 900 }
back = { do = 'follow pump' }
";
    for begin_m in [10.0, 110.0] {
        let extent = Extent { corner: [0.0, 0.0], size: [400.0, 20.0] };
        let scenario = mission::of_map(&Map::empty(extent), MISSION, &Difference::default(), 1);
        let scenario = scenario.unwrap_or_else(|problems| panic!("{problems}"));
        let world = format!(
            "start = [{}, 10.25]\ntime_limit = 1200\n[tanks.fuel]\nchannel = 1\nlevel = 1\n\
             use_per_m = 0.0025\nfill_per_s = 0.05\nat = [10.25, 10.25]\nwithin = 2\n",
            10.25 + begin_m
        );
        let surroundings = Some(world.parse().expect("the world is sound"));
        let scenario = Scenario { surroundings, ..scenario };
        let (outcome, ..) = record_with(&scenario, SensorSettings::PERFECT);
        let farthest = outcome.route.iter().map(|at| at[0]).fold(0.0, f64::max);
        let turned_m = farthest - 10.25 - begin_m;
        let expected_m = (400.0 - 30.0 - begin_m) / 2.0;
        assert!((turned_m - expected_m).abs() < 2.0, "{turned_m} m, not {expected_m} m");
    }
}
