//! Coverage and fuel: the shipped glebe is mown strip by strip, and robots turn back to refuel while
//! their tanks still lead them there.

use std::fs;
use std::process::Command;

use crate::work::record_with;
use harness::mission::{self, Changes};
use harness::setup;
use it::own_map;
use maps::{Extent, Map};
use plan_compiler::cover::{Area, Asked, Strip, covered, site};
use plan_compiler::project::{Request, load};
use sim::{Difference, Ending, Scenario, SensorSettings};

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
