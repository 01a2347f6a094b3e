//! Plans with several goals, as a user builds, asks, draws and proves them.

use super::{Run, YARD, npy_of};
use serde_json::{Value, json};

/// The shipped example, in a folder of its own.
fn stations() -> Run {
    let maps = it::root().join("tests/maps");
    let files = ["stations.ovl", "stations.mission.toml"]
        .map(|name| (name, std::fs::read(maps.join(name)).unwrap()));
    let files: Vec<(&str, &[u8])> =
        files.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
    Run::new(&files)
}

/// The yard with a mission.
fn yard(mission: &str) -> Run {
    Run::new(&[("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())])
}

fn parsed(line: &str) -> Value {
    serde_json::from_str(line).unwrap()
}

/// W51: behind the fence the nearest pump in a straight line is not the one that costs least.
#[test]
fn the_stations_lead_to_the_pump_that_costs_least() {
    let run = stations();
    let built = run.run("build stations.ovl", "");
    assert_eq!((built.status, built.err.contains("warning")), (0, false), "{}", built.err);
    let mut costs = Vec::new();
    for (at, goal, end) in [
        ("36,10", 0, [20.0, 6.0]),
        ("44,20", 1, [46.0, 10.0]),
        ("10,25", 2, [8.0, 34.0]),
        ("46,10", 1, [46.0, 10.0]),
    ] {
        let answer = parsed(&run.done(&format!("query plans.bin --at {at}")));
        assert_eq!(answer["goal"], goal, "{at}: {answer}");
        costs.push(answer["cost_m"].as_f64().unwrap());
        let route = parsed(&run.done(&format!("query plans.bin --route {at}")));
        assert_eq!(route["goal"], goal, "{at}");
        let last = route["poses"].as_array().and_then(|poses| poses.last()).unwrap();
        assert_eq!([&last["x"], &last["y"]], [&json!(end[0]), &json!(end[1])], "{at}");
    }
    assert!(costs[0] > 16.0 && costs[0] < 20.0 && costs[3] == 0.0, "{costs:?}");
    let map = run.done("query plans.bin --route 36,10 --format geojson");
    assert_eq!(parsed(&map)["features"][0]["properties"]["goal"], 0);
    // Where there is no route there is no goal either.
    assert_eq!(parsed(&run.done("query plans.bin --at 41,10")).get("goal"), None);
    let text = run.done("inspect plans.bin");
    assert!(text.contains("fuel to the cheapest of (20, 6), (46, 10), (8, 34)"), "{text}");
    let described = parsed(&run.done("inspect plans.bin --json"));
    assert_eq!(described["plans"][0]["goals_m"], json!([[20.0, 6.0], [46.0, 10.0], [8.0, 34.0]]));
    assert!(run.done("verify plans.bin --map stations.ovl").contains("proved"));
}

#[test]
fn several_goals_are_drawn_and_exported_but_not_converted() {
    let run = stations();
    run.done("build stations.ovl");
    run.done("render plans.bin --route 36,10 -o stations.svg");
    let picture = std::fs::read_to_string(run.path("stations.svg")).unwrap();
    for name in ["fuel[0]", "fuel[1]", "fuel[2]"] {
        assert!(picture.contains(name), "{name}");
    }
    run.done("export plans.bin --what goal -o goal.npy");
    let numbers = npy_of(&run.path("goal.npy"), "'|i1'", (80, 120));
    for goal in [0u8, 1, 2, -2i8 as u8] {
        assert!(numbers.iter().filter(|&&number| number == goal).count() > 100, "{goal}");
    }
    let refused = run.run("convert plans.bin -o Iplan.dat", "");
    assert_eq!((refused.status, run.path("Iplan.dat").exists()), (1, false));
    assert!(refused.err.contains("plan `fuel` leads to 3 goals"), "{}", refused.err);
}

#[test]
fn goals_of_the_command_line_may_be_several() {
    let run = stations();
    run.done("build|stations.ovl|--goal|any=20,6;46,10|--goal|one=8,34");
    let answer = |layer: &str, at: &str| {
        parsed(&run.done(&format!("query plans.bin --layer {layer} --at {at}")))
    };
    assert_eq!(answer("any/physical", "50,10")["goal"], 1);
    assert_eq!(answer("one/physical", "50,10").get("goal"), None);
    let seventeen = vec!["1,1"; 17].join(";");
    let refused = run.run(&format!("build|stations.ovl|--goal|any={seventeen}"), "");
    assert!(refused.status == 2 && refused.err.contains("leads to 16"), "{}", refused.err);
}

/// A goal without a route is left out with a warning as long as another one is left.
#[test]
fn a_goal_that_no_route_can_lead_to_is_named() {
    // In turn: free, in the house, off the map, where radio is weak, and the cell of the first.
    let mission = "[goals]\nany = [[35.2, 25.2], [15, 12], [90, 5], 'shed', [35.4, 25.4]]\n";
    let run = yard(mission);
    let built = run.run("build yard.ovl --resolution 1 --fill-walls", "");
    assert_eq!(built.status, 0, "{}", built.err);
    for text in [
        "goal `any[1]` at (15, 12) is inside an obstacle; it is left out",
        "goal `any[2]` at (90, 5) is outside the map; it is left out",
        "goals `any[0]` and `any[4]` are in one cell",
        "`any[3]` is inside an area that layer `comms` avoids",
    ] {
        assert!(built.err.contains(text), "{text}: {}", built.err);
    }
    let kept = "any to the cheapest of (35.2, 25.2), (5, 25), (35.4, 25.4)\n";
    assert!(built.err.contains(kept), "{}", built.err);
    run.done("verify plans.bin --map yard.ovl");
    let goal = |layer: &str| {
        parsed(&run.done(&format!("query plans.bin --layer any/{layer} --at 6,18")))["goal"].clone()
    };
    // The others keep their numbers.
    assert_eq!([goal("physical"), goal("comms")], [json!(3), json!(0)]);
}

#[test]
fn it_is_an_error_if_no_goal_is_left() {
    let refused = |goals: &str, expected: &[&str]| {
        let run = yard(&format!("[goals]\n{goals}\n"));
        let ended = run.run("build yard.ovl --fill-walls", "");
        assert_eq!((ended.status, run.path("plans.bin").exists()), (1, false), "{goals}");
        for text in expected {
            assert!(ended.err.contains(text), "{goals}: {text}: {}", ended.err);
        }
    };
    refused(
        "any = [[15, 12], [90, 5]]",
        &[
            "`any[0]` at (15, 12) is inside an obstacle\n",
            "`any[1]` at (90, 5) is outside the map\n",
        ],
    );
    refused(
        "any = { at = [[5, 25], [6, 25]], layers = ['comms'] }",
        &["goal `any` is everywhere inside an area that layer `comms` avoids"],
    );
    refused("any = [[35, 25], 'shde']", &["did you mean `shed`?"]);
    // All mistakes at once.
    refused(
        "a = [[1, 2], [3]]\nb = [[1, 2], 3]\nc = ['gate', { at = [1, 2], layers = [] }]\nd = []\n\
         e = ['gate', { lat = 51, lat0 = 1 }]\nf = [[[1, 2]], 'gate']",
        &[
            "member `a[1]` is not a position",
            "`goals.b[1]` must be a position",
            "`c[1]` has layers of its own",
            "goal `d` is not a position",
            "goal `e[1]`",
            "member `f[0]` is not a position",
        ],
    );
    let many = vec!["[1, 2]"; 17].join(", ");
    refused(&format!("a = [{many}]"), &["goal `a` has 17 positions, but a plan leads to 16"]);
}

/// A list of every form, in every way to write it, gives the same blob.
#[test]
fn lists_of_goals_may_be_written_in_every_form() {
    let blob = |mission: &str| {
        let run = yard(mission);
        run.done("build yard.ovl");
        std::fs::read(run.path("plans.bin")).unwrap()
    };
    let plain = blob("[goals]\nany = [[35, 25], [5, 25]]\n");
    assert_eq!(blob("[goals]\nany = ['gate', 'shed']\n"), plain);
    assert_eq!(blob("[goals]\nany = { at = ['gate', [5, 25]] }\n"), plain);
    assert_eq!(blob("[goals]\nany = [{ at = 'gate' }, { at = [5, 25] }]\n"), plain);
    assert_eq!(blob("[[goals.any]]\nat = 'gate'\n[[goals.any]]\nat = [5, 25]\n"), plain);
    // One position in a list is one goal.
    assert_eq!(blob("[goals]\nany = [[35, 25]]\n"), blob("[goals]\nany = [35, 25]\n"));
}

/// What a search of others got wrong or had to settle: each is a map of free and blocked cells.
#[test]
fn people_reported() {
    let check = |map: &str, goals: &str, at: &str, expected: (i64, f64)| {
        let rows: Vec<&str> = map.lines().collect();
        let (width, height) = (rows[0].len(), rows.len());
        let text = format!("type octile\nheight {height}\nwidth {width}\nmap\n{map}\n");
        let run = Run::new(&[("rooms.map", text.as_bytes())]);
        run.done(&format!("build|rooms.map|--goal|any={goals}"));
        let answer = parsed(&run.done(&format!("query plans.bin --at {at}")));
        let cost = answer["cost_m"].as_f64().unwrap();
        assert_eq!(answer["goal"], expected.0, "{map}\n{answer}");
        assert!((cost - expected.1).abs() < 1e-6, "{map}\n{cost}");
    };
    let open = [".........."; 10].join("\n");
    let with_post = [["..........\n"; 8].concat(), ".@........\n..........".into()].concat();
    // grid_pathfinding #5: (9, 9) was chosen from (0, 0) instead of (2, 2).
    check(&with_post, "2.5,2.5;9.5,9.5", "0.5,0.5", (0, 4.0));
    // finisterra #40: the first of the list was chosen, not the nearest.
    check(&open, "9.5,9.5;2.5,2.5", "0.5,2.5", (1, 2.0));
    // recastnavigation #369: the goal nearest to the end of the path need not be the one reached.
    check("......\n@@@@@.\n......", "0.5,2.5;3.5,0.5", "0.5,0.5", (1, 3.0));
    check("......\n@@@@@.\n......", "0.5,2.5;3.5,0.5", "2.5,2.5", (0, 2.0));
}
