//! Narrow passages: in warnings, in `inspect`, in `verify` and in pictures. Several maps follow
//! public reports of robots that stood before doors that their maps showed open.

use super::{Ended, Run};
use insta::assert_snapshot;
use math::scalar::wide;
use serde_json::Value;
use std::fs;

/// A room of 12 m by 8 m with a wall across it and a door of a width, `turned` about its middle,
/// degrees.
fn door(width_m: f64, turned: f64, shift_m: f64) -> String {
    let (sine, cosine) = (wide::sin(turned.to_radians()), wide::cos(turned.to_radians()));
    let at = |along: f64, across: f64| {
        let (x, y) =
            (6.0 + shift_m + across * cosine - along * sine, 4.0 + across * sine + along * cosine);
        format!("{x} {y}")
    };
    let half = 0.5 * width_m;
    format!(
        "MISSION-AREA 12 8\nCONTROL MEASURES:\nWALL south {} {}\nWALL north {} {}\n",
        at(-9.0, 0.0),
        at(-half, 0.0),
        at(half, 0.0),
        at(9.0, 0.0)
    )
}

fn with_mission(map: &str, mission: &str) -> Run {
    Run::new(&[("room.ovl", map.as_bytes()), ("room.mission.toml", mission.as_bytes())])
}

/// The passages of the first layer: `least-most at x,y`, and whether they are too narrow.
fn passages(run: &Run) -> Vec<String> {
    let said: Value = serde_json::from_str(&run.done("inspect plans.bin --json")).unwrap();
    let listed = said["plans"][0]["layers"][0]["passages"].as_array().unwrap();
    let text = |passage: &Value| {
        let number = |value: &Value| value.as_f64().unwrap();
        let [least, most] = [0, 1].map(|end| number(&passage["width_m"][end]));
        let [x, y] = [0, 1].map(|axis| number(&passage["at_m"][axis]));
        let verdict = if passage["is_too_narrow"] == true { ", too narrow" } else { "" };
        format!("{least:.2}-{most:.2} at {x:.1},{y:.1}{verdict}")
    };
    listed.iter().map(text).collect()
}

/// The warnings of a build and the passages of its blob.
fn built(map: &str, mission: &str) -> String {
    let run = with_mission(map, mission);
    let Ended { status, err, .. } = run.run("build room.ovl --quiet", "");
    assert_eq!(status, 0, "{err}");
    format!("{err}{}", passages(&run).join("\n"))
}

const DISTANCES: &str = "[vehicle]\nradius = 0.3\nstop_distance = 0.3\n[schemas]\navoid_margin = 0.5\n\
    avoid_sphere = 5\n";

#[test]
fn a_mapped_door_that_the_margin_closes_is_warned_of_everywhere() {
    let mission = format!("resolution = 0.1\n[goals]\nhall = [9, 4]\n{DISTANCES}");
    assert_snapshot!(built(&door(1.0, 0.0, 0.0), &mission), @"
      ⚠ the routes to `hall` pass between obstacles 0.9 to 1.1 m apart at (6.05, 4.05), but the robot
      │ needs 1.6 m
      help: its body of 0.6 m stops within 0.3 m and is repelled within 0.5 m of obstacles; set
            stop_distance and avoid_margin to 0.14 at most, or set robot_radius = 0.8, so that the
            routes avoid the passage

    0.90-1.10 at 6.0,4.0, too narrow
    ");
    let run = with_mission(&door(1.0, 0.0, 0.0), &mission);
    run.done("build room.ovl");
    let text = run.done("inspect plans.bin");
    assert!(text.contains("; too narrow: the robot needs 1.6 m"), "{text}");
    let proved = run.run("verify plans.bin --json", "");
    assert!(proved.err.contains("the routes to `hall` pass between"), "{}", proved.err);
    let json: Value = serde_json::from_str(&proved.out).unwrap();
    assert_eq!(json["too_narrow"][0]["layer"], "hall/physical");
    assert_eq!(json["too_narrow"][0]["needed_width_m"], 1.6);
    run.done("render plans.bin -o door.svg");
    let svg = fs::read_to_string(run.path("door.svg")).unwrap();
    assert!(svg.contains("too narrow: below 1.6 m"));
    // What the help offers is enough.
    let offered = mission
        .replace("avoid_margin = 0.5", "avoid_margin = 0.1")
        .replace("stop_distance = 0.3", "stop_distance = 0.1");
    let run = with_mission(&door(1.0, 0.0, 0.0), &offered);
    assert_eq!(run.run("build room.ovl --quiet", "").err, "");
    run.done("render plans.bin -o door.svg");
    let svg = fs::read_to_string(run.path("door.svg")).unwrap();
    assert!(svg.contains("narrow passage") && !svg.contains("too narrow"));
}

#[test]
fn the_stated_width_contains_the_true_one() {
    for (width, turned, shift, resolution) in [
        (1.0, 0.0, 0.0, 0.1),
        (1.0, 0.0, 0.037, 0.1),
        (1.2, 45.0, 0.0, 0.1),
        (1.2, 45.0, 0.021, 0.05),
        (1.5, 30.0, 0.05, 0.1),
        (0.9, -20.0, 0.013, 0.05),
        (2.0, 60.0, 0.01, 0.2),
        (1.1, 0.0, 0.011, 0.02),
    ] {
        let mission = format!("resolution = {resolution}\n[goals]\nhall = [10.5, 4]\n{DISTANCES}");
        let run = with_mission(&door(width, turned, shift), &mission);
        run.done("build room.ovl");
        let found = passages(&run);
        let numbers: Vec<f64> =
            found[0].split(['-', ' ', ',']).filter_map(|word| word.parse().ok()).collect();
        let [least, most, x, y] = numbers[..] else { panic!("{found:?}") };
        let slack = 0.5 * resolution;
        assert!(
            (least - slack..=most + slack).contains(&width) && most - least < 3.0 * resolution,
            "{width} m turned by {turned} in cells of {resolution}: {found:?}"
        );
        let off = wide::hypot(x - 6.0 - shift, y - 4.0);
        assert!(off < 2.0 * resolution + 0.1, "{found:?}");
    }
}

#[test]
fn reports_of_robots_that_stood_before_open_doors() {
    // ros-navigation/navigation2, issue 5625: "this car could go through a narrow space, but due to
    // inflation radius, it can't": a car 0.45 m from its centre to its corners, inflated by 0.35 m.
    let corridor = "MISSION-AREA 10 4\nCONTROL MEASURES:\nWALL s 3 0  3 1.4  7 1.4  7 0\n\
        WALL n 3 4  3 2.5  7 2.5  7 4\n";
    let car = "resolution = 0.05\nrobot_radius = 0.35\n[goals]\nend = [9, 2]\n[vehicle]\n\
        radius = 0.45\nstop_distance = 0.1\n[schemas]\navoid_margin = 0.35\n";
    assert_snapshot!(built(corridor, car), @"
      ⚠ obstacles are grown by 0.35 m, less than the vehicle's radius of 0.45 m: the robot is advised
      │ to go where it does not fit
      help: leave robot_radius out, or make it at least vehicle.radius

      ⚠ the routes to `end` pass between obstacles 1.05 to 1.15 m apart at (2.98, 1.98), but the robot
      │ needs 1.6 m
      help: its body of 0.9 m stops within 0.1 m and is repelled within 0.35 m of obstacles; set
            stop_distance and avoid_margin to 0.07 at most, or set robot_radius = 0.8, so that the
            routes avoid the passage

    1.05-1.15 at 3.0,2.0, too narrow
    ");
    // turtlebot/turtlebot_apps, issue 94: two values of one radius, 0.18 and 0.46 m.
    let turtle = "resolution = 0.05\nrobot_radius = 0.18\n[goals]\nend = [9, 2]\n[vehicle]\n\
        radius = 0.46\nstop_distance = 0.1\n[schemas]\navoid_margin = 0.1\n";
    assert_snapshot!(built(&corridor.replace("2.5", "2.2"), turtle), @"
      ⚠ obstacles are grown by 0.18 m, less than the vehicle's radius of 0.46 m: the robot is advised
      │ to go where it does not fit
      help: leave robot_radius out, or make it at least vehicle.radius

      ⚠ the routes to `end` pass between obstacles 0.76 to 0.86 m apart at (2.93, 1.8), but the robot
      │ needs 1.12 m
      help: its body of 0.92 m stops within 0.1 m and is repelled within 0.1 m of obstacles; set
            robot_radius = 0.56, so that the routes avoid the passage

    0.76-0.86 at 2.9,1.8, too narrow
    ");
    // ros-navigation/navigation2, issue 6100: the path hugs the wall where a corridor turns.
    let bend = "MISSION-AREA 10 10\nCONTROL MEASURES:\nWALL in 0 4  6 4  6 0\n\
        WALL out 0 4.9  6.9 4.9  6.9 0\n";
    let hugging = "resolution = 0.05\n[goals]\nend = [6.45, 0.4]\n[vehicle]\nradius = 0.2\n\
        stop_distance = 0.1\n[schemas]\navoid_margin = 0.3\n";
    assert_snapshot!(built(bend, hugging), @"
      ⚠ only 1979 of 36074 free cells have a route to goal `end` in layer `physical`
      help: it is enclosed, perhaps because the robot's radius or coarse cells close a door; `plan-
            compiler render` shows where

      ⚠ the routes to `end` pass between obstacles 0.85 to 0.95 m apart at (0.53, 4.48), but the robot
      │ needs 1 m
      help: its body of 0.4 m is repelled within 0.3 m of obstacles; set avoid_margin to 0.22 at most,
            or set robot_radius = 0.5, so that the routes avoid the passage

    0.85-0.95 at 0.5,4.5, too narrow
    ");
    // ArduPilot/ardupilot, pull request 34205, and its wiki, issue 3099: OA_MARGIN_MAX, 5 m here, is
    // the distance that the rover keeps, not how far it looks.
    let fences = "MISSION-AREA 60 40\nCONTROL MEASURES:\nWALL a 30 0  30 16\nWALL b 30 24  30 40\n";
    let rover = "resolution = 0.5\n[goals]\nhome = [50, 20]\n[vehicle]\nradius = 0.6\n\
        stop_distance = 1\n[schemas]\navoid_margin = 5\n";
    assert_snapshot!(built(fences, rover), @"
      ⚠ the routes to `home` pass between obstacles 7.2 to 8.2 m apart at (29.75, 20), but the robot
      │ needs 11.2 m
      help: its body of 1.2 m is repelled within 5 m of obstacles; set avoid_margin to 2.99 at most,
            or set robot_radius = 5.6, so that the routes avoid the passage

    7.20-8.20 at 29.8,20.0, too narrow
    ");
    // ros-planning/navigation, issue 22: cells that are inflated slightly too far close a doorway
    // that is exactly as wide as the robot needs.
    let exact = "resolution = 0.05\n[goals]\nhall = [9, 4]\n[vehicle]\nradius = 0.3\n\
        stop_distance = 0.1\n[schemas]\navoid_margin = 0.1\n";
    assert_snapshot!(built(&door(0.8, 0.0, 0.0), exact), @"
      ⚠ the routes to `hall` pass between obstacles 0.75 to 0.85 m apart at (6.03, 4.03), but the
      │ robot needs 0.8 m
      help: its body of 0.6 m stops within 0.1 m and is repelled within 0.1 m of obstacles; set
            stop_distance and avoid_margin to 0.07 at most, or set robot_radius = 0.4, so that the
            routes avoid the passage

    0.75-0.85 at 6.0,4.0, too narrow
    ");
}

#[test]
fn cells_of_a_grid_map_are_obstacles_as_they_are() {
    // A corridor of one cell of 1 m; nothing is grown.
    let map = "type octile\nheight 5\nwidth 12\nmap\n....@@@.....\n....@@@.....\n............\n\
        ....@@@.....\n....@@@.....\n";
    let run = Run::new(&[("a.map", map.as_bytes())]);
    let mission = "robot_radius = 0\n[goals]\nend = [11.5, 2.5]\n[vehicle]\nradius = 0.3\nstop_distance = 0.2\n\
        [schemas]\navoid_margin = 0.3\n";
    fs::write(run.path("a.mission.toml"), mission).unwrap();
    run.done("build a.map");
    assert_eq!(passages(&run), ["1.00-3.00 at 4.5,2.5, too narrow"]);
}
