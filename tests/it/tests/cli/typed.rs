//! What people type, and the one line that fixes it.

use super::{Ended, Run, YARD, check, golden};
use plan_compiler::trace::Trace;
use plan_format::Blob;
use robot_io::Percepts;
use serde_json::Value;
use std::fs;

/// The yard with a place on the globe.
fn yard_on_the_globe() -> String {
    YARD.replace("ORIGIN 0 0", "ORIGIN 0 0\nGLOBAL_REF_POINT 51.5 -0.1")
}

/// What the program says of a wrong command line.
fn usage(name: &str, run: &Run, arguments: &str) {
    let ended = run.run(arguments, "");
    assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{arguments}\n{}", ended.err);
    golden(name, arguments, &ended.err);
}

#[test]
fn command_lines_that_are_nearly_right() {
    let run = Run::yard();
    fs::write(run.path("my yard.ovl"), YARD).unwrap();
    usage("typed_blank_in_a_goal", &run, "build yard.ovl --goal d=5, 5");
    usage("typed_goal_without_a_name", &run, "build yard.ovl --goal 0,25");
    usage("typed_unit", &run, "build yard.ovl --resolution 0.25m");
    usage("typed_unit_of_another_kind", &run, "build yard.ovl --robot-radius 25cm");
    usage("typed_blank_in_a_name", &run, "build my yard.ovl");
    usage("typed_compile", &run, "compile yard.ovl");
    usage("typed_place_without_a_name", &run, "comms yard.ovl --place 0,25");
    usage("typed_place_with_two_positions", &run, "comms yard.ovl --place dock=5,5;900,900");
    usage("typed_page_of_two_words", &run, "man build render");
    usage("typed_negative_width", &run, "cover yard.ovl --area gate --width -1");
    usage("typed_tick", &run, "explain yard.trace --tick newest");
    usage("typed_place_that_is_none", &run, "build yard.ovl --goal d=geo:151.5,-33.8");
    for (word, command) in [
        ("make", "build"),
        ("plan", "build"),
        ("info", "inspect"),
        ("show", "inspect"),
        ("draw", "render"),
    ] {
        let ended = run.run(&format!("{word} yard.ovl"), "");
        let tip = format!("tip: `{word}` is called `{command}` here");
        assert!(ended.status == 2 && ended.err.contains(&tip), "{}", ended.err);
    }
    assert_eq!(run.names(), ["my yard.ovl", "yard.ovl"]);
}

/// Notes are neither warnings nor errors, also where a command fails.
#[test]
fn a_quiet_command_prints_no_notes() {
    let map = fs::read(it::own_map("yard.osm")).unwrap();
    let run = Run::new(&[("yard.osm", &map)]);
    for (options, has_note) in [("", true), (" -q", false)] {
        let ended = run.run(&format!("build yard.osm --goal a=999,999{options}"), "");
        assert_eq!((ended.status, ended.err.contains('☞')), (1, has_note), "{}", ended.err);
        assert!(ended.err.contains("outside the map"), "{}", ended.err);
    }
}

/// A command that is printed runs as it stands, whatever the file's name.
#[test]
fn printed_commands_quote_names() {
    let name = "ya$(id)rd (1).ovl";
    let run = Run::new(&[(name, YARD.as_bytes())]);
    let ended = run.run(&format!("build|{name}|--board|nrf52840-dk|-o|my plans.bin"), "");
    assert!(ended.status == 0 && ended.err.contains(" 'my plans.bin'\n"), "{}", ended.err);
    let ended = run.run(&format!("inspect|{name}"), "");
    let command = format!("`plan-compiler build '{name}' -o plans.bin`");
    assert!(ended.err.replace("\n        ", " ").contains(&command), "{}", ended.err);
}

/// A trace whose decisions differ was cut between ticks, damaged, or recorded by another build: nothing
/// tells which.
#[test]
fn a_trace_that_was_changed_is_not_called_one_of_another_build() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let blob = fs::read(run.path("plans.bin")).unwrap();
    let percepts = |tick: u64| Percepts { time_us: tick * 50_000, ..Percepts::default() };
    let mut trace = Trace { blob, percepts: (0..4).map(percepts).collect(), hash: 0 };
    trace.hash = trace.replayed_hash(&Blob::parse_exact(&trace.blob).unwrap());
    let write = |trace: &Trace| fs::write(run.path("a.trace"), trace.to_bytes()).unwrap();
    write(&trace);
    assert_eq!(run.run("explain a.trace", "").err, "");
    trace.percepts.pop();
    write(&trace);
    for arguments in ["explain a.trace", "explain a.trace --tick last -q"] {
        let Ended { status, out, err } = run.run(arguments, "");
        assert!(status == 0 && !out.contains("build") && !out.contains("warning"), "{out}");
        let err = err.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        let expected = "the trace was changed or cut off, or another build recorded it";
        assert!(err.contains(expected), "{err}");
    }
    trace.percepts.clear();
    write(&trace);
    let ended = run.run("explain a.trace --tick last", "");
    assert_eq!((ended.status, ended.out.as_str()), (1, ""), "{}", ended.err);
    assert!(ended.err.contains("a.trace: the trace has no ticks"), "{}", ended.err);
}

#[test]
fn files_of_another_kind_are_named() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let blob = fs::read(run.path("plans.bin")).unwrap();
    let trace = b"WAYTRACE\x01\0 and more";
    let files: [(&str, &[u8]); 4] = [
        ("plans.bin", &blob),
        ("yard.ovl", YARD.as_bytes()),
        ("yard.mission.toml", b"map = \"yard.ovl\"\n"),
        ("drive.trace", trace),
    ];
    check("kind_blob_to_explain", &files, "explain plans.bin", "");
    check("kind_trace_to_inspect", &files, "inspect drive.trace", "");
    check("kind_map_to_inspect", &files, "inspect yard.ovl", "");
    check("kind_map_to_query", &files, "query yard.ovl --at 1,1", "");
    check("kind_mission_to_verify", &files, "verify yard.mission.toml", "");
    check("kind_nothing_to_explain", &files, "explain yard.ovl", "");
}

#[test]
fn one_layer_needs_no_name_and_several_are_listed() {
    let run = Run::yard();
    run.done("build yard.ovl --goal shed=5,25 -o one.bin");
    let named = run.done("query one.bin --layer shed/physical --at 3,3");
    assert_eq!(run.done("query one.bin --at 3,3"), named);
    run.done("export one.bin --what cost -o cost.npy");
    run.done("render one.bin -o field.svg");
    run.done("build yard.ovl");
    usage("layer_of_several", &run, "query plans.bin --at 3,3");
    usage("layer_of_several_to_export", &run, "export plans.bin --what cost -o cost.npy");
    usage("layer_of_several_to_render", &run, "render plans.bin -o field.svg");
}

#[test]
fn points_are_asked_as_they_come() {
    let run = Run::yard();
    run.done("build yard.ovl --goal shed=5,25");
    let lines = "x,y\n3 3\n3,3\n3\t3\n3 3 0.5\n{x: 3, y: 3, z: 0}\n\n# none\n{\"x\":3,\"y\":3}\n";
    let ended = run.run("query plans.bin -", lines);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let one = run.done("query plans.bin --at 3,3");
    assert_eq!(ended.out, one.repeat(6));
    // Its own answers are points again.
    assert_eq!(run.run("query plans.bin -", &ended.out).out, ended.out);
}

#[test]
fn routes_are_written_for_ros_for_tables_and_for_maps() {
    let map = yard_on_the_globe();
    let run = Run::new(&[("yard.ovl", map.as_bytes())]);
    run.done("build yard.ovl --goal shed=5,25");
    let route: Value = serde_json::from_str(&run.done("query plans.bin --route 3,3")).unwrap();
    assert_eq!((&route["layer"], &route["frame_id"]), (&"shed/physical".into(), &"map".into()));
    let poses = route["poses"].as_array().unwrap();
    let cost: Value = serde_json::from_str(&run.done("query plans.bin --at 3,3")).unwrap();
    assert!((route["length_m"].as_f64().unwrap() - cost["cost_m"].as_f64().unwrap()).abs() < 1e-6);
    assert_eq!((&poses[0]["x"], &poses[0]["y"]), (&3.0.into(), &3.0.into()));
    let last = poses.last().unwrap();
    assert_eq!((&last["x"], &last["y"]), (&5.0.into(), &25.0.into()));
    // The robot looks north on most of the way.
    let north = poses
        .iter()
        .filter(|pose| (pose["yaw"].as_f64().unwrap() - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    assert!(north.count() > 15, "{poses:?}");

    let table = run.done("query plans.bin --route 3,3 --format csv");
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!((lines.len(), lines[0]), (poses.len() + 1, "x,y,yaw,lat,lon"));
    assert!(lines[1].starts_with("3,3,"), "{table}");

    let drawn: Value =
        serde_json::from_str(&run.done("query plans.bin --route 3,3 --format geojson")).unwrap();
    let geometry = &drawn["features"][0]["geometry"];
    assert_eq!(geometry["type"], "LineString");
    assert_eq!(geometry["coordinates"].as_array().unwrap().len(), poses.len());
    let [lon, lat] = [0, 1].map(|axis| geometry["coordinates"][0][axis].as_f64().unwrap());
    // The place leads back to the same route.
    let again = run.done(&format!("query plans.bin --route geo:{lat},{lon}"));
    let again: Value = serde_json::from_str(&again).unwrap();
    assert!((again["poses"][0]["x"].as_f64().unwrap() - 3.0).abs() < 0.02, "{again}");
    let far = run.run("query plans.bin --route geo:-0.1,51.5", "");
    assert!(far.status == 1 && far.err.contains("too far away"), "{}", far.err);

    let plain = Run::yard();
    plain.done("build yard.ovl --goal shed=5,25");
    assert!(plain.done("query plans.bin --route 3,3 --format csv").starts_with("x,y,yaw\n"));
    let blob = fs::read(plain.path("plans.bin")).unwrap();
    let files = [("plans.bin", blob.as_slice())];
    let geojson = "query plans.bin --route 3,3 --format geojson";
    check("route_without_a_place_on_the_globe", &files, geojson, "");
    check("query_route_from_inside", &files, "query plans.bin --route 17,13", "");
}

#[test]
fn goals_are_places_on_the_globe() {
    let map = yard_on_the_globe();
    let run = Run::new(&[("yard.ovl", map.as_bytes())]);
    run.done("build yard.ovl --goal here=5,25");
    let route = run.done("query plans.bin --route 5,25 --format csv");
    let place = route.lines().nth(1).unwrap().splitn(4, ',').nth(3).unwrap();
    let (lat, lon) = place.split_once(',').unwrap();
    run.done(&format!("build yard.ovl --goal here=geo:{lat},{lon} -o geo.bin"));
    let mission = format!("[goals]\nhere = {{ lat = {lat}, lon = {lon} }}\n");
    fs::write(run.path("table.toml"), mission).unwrap();
    run.done("build yard.ovl --mission table.toml -o table.bin");
    let mission = format!("[goals]\nhere = \"geo:{lat},{lon}\"\n");
    fs::write(run.path("text.toml"), mission).unwrap();
    run.done("build yard.ovl --mission text.toml -o text.bin");
    for name in ["geo.bin", "table.bin", "text.bin"] {
        let said: Value =
            serde_json::from_str(&run.done(&format!("inspect {name} --json"))).unwrap();
        let goal = [0, 1].map(|axis| said["plans"][0]["goal_m"][axis].as_f64().unwrap());
        assert!((goal[0] - 5.0).abs() < 0.02 && (goal[1] - 25.0).abs() < 0.02, "{goal:?}");
    }
    let files = [("yard.ovl", map.as_bytes())];
    check("goal_far_away", &files, "build yard.ovl --goal d=geo:48.85,2.35", "");
    check("goal_swapped", &files, "build yard.ovl --goal d=geo:-0.1,51.5", "");
    check("goal_in_degrees", &files, "build yard.ovl --goal d=51.5,-0.1", "");
    let files = [("yard.ovl", YARD.as_bytes())];
    check("goal_on_no_globe", &files, "build yard.ovl --goal d=geo:51.5,-0.1", "");
    let mission = "[goals]\na = { lat = 51.5 }\nb = { lat = 151.5, lon = 1 }\n\
                   c = { lat = \"51N\", lon = 0 }\nd = { at = [1, 1], lat = 1, lon = 1 }\n\
                   e = { lat = 51.5, lng = 0 }\nf = \"geo:51.5\"\n";
    let files = [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    check("goals_on_the_globe_with_mistakes", &files, "build yard.ovl", "");
}

#[test]
fn speeds_that_contradict_each_other() {
    let mission = "[vehicle]\ncautious_speed = 3\nbase_speed = 2\nmax_speed = 1\n";
    let files = [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    check("mission_speeds", &files, "build yard.ovl", "");
}

#[test]
fn speeds_that_the_robot_cannot_stop_from_are_refused() {
    let mission = "[vehicle]\nmax_speed = 9\nstop_distance = 0.5\n[fixes]\nmax_jump = 6\n\
        [schemas]\navoid_margin = 0.2\navoid_sphere = 2\n";
    let files = [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    check("mission_brakes", &files, "build yard.ovl", "");
}

#[test]
fn what_follows_from_the_body_is_shown() {
    let run = Run::yard();
    let mission = "[vehicle]\nradius = 0.45\nmax_speed = 2\nbraking = 1\nmax_turn_rate = 1\n";
    fs::write(run.path("yard.mission.toml"), mission).unwrap();
    run.done("build yard.ovl");
    let text = run.done("inspect plans.bin");
    let drive: Vec<&str> =
        text.lines().skip_while(|line| !line.contains("drive ")).take(3).collect();
    assert_eq!(
        drive,
        [
            "  drive   blends along the route, at 2 m/s; stops within 2.2 m from 2 m/s and sees 10 m",
            "          keeps 0.03 m, margin 0.03 m, sphere 2.2 m",
            "          turns at 1 (2.222 would follow) rad/s at most, cautious at 0.3 m/s, looks 0.72 m \
             ahead",
        ]
    );
    let said: Value = serde_json::from_str(&run.done("inspect plans.bin --json")).unwrap();
    let drive = &said["drive"];
    assert_eq!((&drive["stopping_distance_m"], &drive["blend"]), (&2.2.into(), &"route".into()));
    assert_eq!(drive["values"]["max_turn_rate_radps"], 1.0);
    assert_eq!(drive["follows"]["max_turn_rate_radps"], 2.222222);
    // The option outranks the mission's body only where the mission gives none.
    fs::write(run.path("yard.mission.toml"), "[vehicle]\nmax_speed = 2\n").unwrap();
    run.done("build yard.ovl --robot-radius 0.6");
    let said: Value = serde_json::from_str(&run.done("inspect plans.bin --json")).unwrap();
    assert_eq!(said["drive"]["values"]["stop_distance_m"], 0.04);
}

/// Blocked cells of the first layer.
fn blocked(run: &Run, build: &str) -> u64 {
    run.done(build);
    let said: Value = serde_json::from_str(&run.done("inspect plans.bin --json")).unwrap();
    said["plans"][0]["layers"][0]["blocked"].as_u64().unwrap()
}

#[test]
fn obstacles_are_grown_by_the_vehicle_unless_something_is_said() {
    let run = Run::yard();
    let by = |radius: &str| {
        blocked(&run, &format!("build yard.ovl --goal a=3,3 --robot-radius {radius}"))
    };
    let [none, usual, wide] = ["0", "0.3", "0.8"].map(by);
    assert!(none < usual && usual < wide, "{none} {usual} {wide}");
    assert_eq!(blocked(&run, "build yard.ovl --goal a=3,3"), usual);
    fs::write(run.path("yard.mission.toml"), "[vehicle]\nradius = 0.8\n").unwrap();
    assert_eq!(blocked(&run, "build yard.ovl --goal a=3,3"), wide);
    fs::write(run.path("yard.mission.toml"), "robot_radius = 0\n[vehicle]\nradius = 0.8\n")
        .unwrap();
    assert_eq!(blocked(&run, "build yard.ovl --goal a=3,3"), none);
    // A world of a point.
    let grid = "type octile\nheight 3\nwidth 5\nmap\n.....\n..@..\n.....\n";
    fs::write(run.path("grid.map"), grid).unwrap();
    assert_eq!(blocked(&run, "build grid.map --goal a=0.5,0.5"), 1);
}

#[test]
fn a_blob_knows_how_it_was_built() {
    let run = Run::yard();
    fs::write(run.path("night.toml"), "[layers]\nnight = [\"NoFlyZone1\"]\n").unwrap();
    for options in [
        "--robot-radius 0.7",
        "--robot-radius 0 --fill-walls --resolution 0.5",
        "--mission night.toml --corners allow",
    ] {
        run.done(&format!("build yard.ovl --goal a=3,3 {options}"));
        let proof = run.done("verify plans.bin --map yard.ovl");
        assert!(proof.contains("the obstacles match the map"), "{options}: {proof}");
        run.done("render plans.bin --layer a/physical --map yard.ovl -o field.svg");
        // What is given outranks it.
        let ended = run.run("verify plans.bin --map yard.ovl --robot-radius 1.5", "");
        assert_eq!(ended.status, 1, "{options}: {}", ended.err);
    }
    let opar = "Farm\n51.0\n7.0\n4\n0\n0\n40\n0\n40\n40\n0\n40\n1\n1\n14\n0.45\n0.284\n1\n1.33\n\
                0.284\n0.588\n3\n5\n51.0\n7.0\n4\n10\n10\n20\n10\n20\n20\n10\n20\n";
    fs::write(run.path("farm.opar"), opar).unwrap();
    run.done("build farm.opar --goal a=3,3 --opar-type 3=building --opar-order ne -o farm.bin");
    run.done("verify farm.bin --map farm.opar");
}

#[test]
fn an_unrelated_map_is_refused() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let blob = fs::read(run.path("plans.bin")).unwrap();
    let larger = YARD.replace("40 30", "50 30");
    let elsewhere = yard_on_the_globe();
    let other = YARD.replace("OBSTACLE 30 10 2.5", "OBSTACLE 25 25 2.5");
    for (name, map) in [("larger", &larger), ("elsewhere", &elsewhere), ("other", &other)] {
        let files = [("plans.bin", blob.as_slice()), ("map.ovl", map.as_bytes())];
        check(&format!("verify_map_{name}"), &files, "verify plans.bin --map map.ovl", "");
        let render = "render plans.bin --layer gate/physical --map map.ovl -o field.svg";
        check(&format!("render_map_{name}"), &files, render, "");
    }
}
