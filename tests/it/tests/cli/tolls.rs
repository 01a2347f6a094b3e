//! Layers with tolls and speed zones, as a user builds, asks, draws and proves them.

use super::{Run, YARD, check_mission, npy_of};
use serde_json::Value;

/// The shipped example, in a folder of its own.
fn meadow() -> Run {
    let maps = concat!(env!("CARGO_MANIFEST_DIR"), "/../maps");
    let files = ["meadow.geojson", "meadow.mission.toml"]
        .map(|name| (name, std::fs::read(format!("{maps}/{name}")).unwrap()));
    let files: Vec<(&str, &[u8])> =
        files.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
    Run::new(&files)
}

fn answer(run: &Run, layer: &str, at: &str) -> Value {
    let line = run.done(&format!("query plans.bin --layer {layer} --at {at}"));
    serde_json::from_str(&line).unwrap()
}

#[test]
fn the_meadow_is_crossed_by_its_path() {
    let run = meadow();
    run.done("build meadow.geojson");
    // In the open: no toll; in the meadow, on the path through it, in the mud, close to the barn.
    for (at, toll) in [("4,30", 1.0), ("20,25", 2.0), ("20,13.5", 1.0), ("50.2,25", 6.0)] {
        let answer = answer(&run, "school/physical", at);
        assert_eq!((&answer["toll"], &answer["limit_mps"]), (&toll.into(), &Value::Null), "{at}");
    }
    // Costs count halves of a unit here: a step of half a metre at a factor of 4.5.
    assert_eq!(answer(&run, "school/physical", "70.1,38.6")["cost_m"], 2.25);
    // Beside the barn, grown by 0.3 m: bands multiply with the meadow.
    assert_eq!(answer(&run, "school/physical", "27.2,25")["toll"], 6.0);
    assert_eq!(answer(&run, "school/physical", "26.8,25")["toll"], 3.0);
    // At 0.5 m/s instead of 1.5 m/s everything takes three times as long.
    let yard = answer(&run, "school/physical", "78,31.6");
    assert_eq!((&yard["limit_mps"], &yard["toll"]), (&0.5.into(), &3.0.into()));
    // The path is longer than the straight line, and cheaper.
    let route = run.done("query plans.bin --layer school/physical --route 4,15 --format csv");
    let points: Vec<String> = route
        .lines()
        .filter_map(|line| line.split(',').take(2).map(|n| n.parse().ok()).collect())
        .map(|point: Vec<f64>| format!("{} {}\n", point[0], point[1]))
        .collect();
    let ended = run.run("query plans.bin --layer school/physical -", &points.concat());
    let on_path = ended.out.lines().filter(|line| line.contains("\"toll\":1.0")).count();
    assert!(on_path > 60, "{on_path} of {} points", points.len());
}

#[test]
fn tolls_are_proved_with_and_without_their_map() {
    let run = meadow();
    run.done("build meadow.geojson");
    assert!(run.done("verify plans.bin").contains("proved"));
    let text = run.done("verify plans.bin --map meadow.geojson");
    assert!(text.contains("; obstacles, tolls and speed limits match the map"), "{text}");
    let mission = std::fs::read_to_string(run.path("meadow.mission.toml")).unwrap();
    for (old, new, expected) in [
        ("Mud = 6", "Mud = 5", "has a toll of 6, but of 5 in the map"),
        ("within = 1,", "within = 1.5,", "in the map"),
        (
            "yard\" = 0.5",
            "yard\" = { limit = 0.4, factor = 3 }",
            "has a speed limit of 0.5 m/s, but of",
        ),
    ] {
        std::fs::write(run.path("meadow.mission.toml"), mission.replace(old, new)).unwrap();
        // The blob's own recipe still has the old tolls.
        run.done("verify plans.bin --map meadow.geojson");
        let ended = run.run("verify plans.bin --map meadow.mission.toml", "");
        assert_eq!(ended.status, 1, "{new}");
        assert!(ended.err.contains(expected), "{new}: {}", ended.err);
    }
}

#[test]
fn tolls_are_drawn_and_exported() {
    let run = meadow();
    run.done("build meadow.geojson");
    run.done("render plans.bin --layer school/physical --route 4,15 -o meadow.svg");
    let picture = std::fs::read_to_string(run.path("meadow.svg")).unwrap();
    for text in ["toll above 1.5 up to 2", "toll above 4 up to 32"] {
        assert!(picture.contains(text), "{text}");
    }
    run.done("export plans.bin --layer school/physical --what cost -o cost.npy");
    for (what, expected) in
        [("toll", [1.0, 1.5, 2.0, 3.0, 4.5, 6.0, 9.0, 9.0]), ("limit", [0.5; 8])]
    {
        run.done(&format!("export plans.bin --layer school/physical --what {what} -o {what}.npy"));
        let bytes = npy_of(&run.path(&format!("{what}.npy")), "'<f4'", (97, 161));
        let numbers = bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
        let mut different: Vec<f32> = numbers.filter(|n| n.is_finite() && *n > 0.0).collect();
        different.sort_by(f32::total_cmp);
        different.dedup();
        let mut expected = expected.to_vec();
        expected.dedup();
        assert_eq!(different, expected, "{what}");
    }
    let text = run.done("inspect plans.bin");
    assert!(text.contains("school"), "{text}");
}

#[test]
fn a_layer_has_the_tolls_of_those_below_and_does_not_free_a_cell() {
    let mission = "[goals]\nspot = [8, 18]\n[layers.physical]\ntoll = { NoFlyZone1 = 2 }\n\
                   [layers.night]\nareas = ['NoFlyZone1']\ntoll = { 'NoCommZone west' = 4, NoFlyZone1 = 1 }\n\
                   clearance = [{ within = 0.5, factor = 8 }]\n";
    let files: [(&str, &[u8]); 2] =
        [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    let run = Run::new(&files);
    run.done("build yard.ovl --resolution 0.5");
    run.done("verify plans.bin --map yard.ovl");
    assert_eq!(answer(&run, "spot/physical", "30,22")["toll"], 2.0);
    assert_eq!(answer(&run, "spot/physical", "3,3")["toll"], 1.0);
    assert_eq!(answer(&run, "spot/night", "30,22")["cell"], "blocked");
    assert_eq!(answer(&run, "spot/night", "11.6,10")["cell"], "blocked");
    // The house, grown by 0.3 m, and its band.
    assert_eq!(answer(&run, "spot/night", "11.2,10")["toll"], 8.0);
    assert_eq!(answer(&run, "spot/physical", "11.2,10")["toll"], 1.0);
}

#[test]
fn layers_without_tolls_answer_as_before() {
    let run = Run::new(&[("yard.ovl", YARD.as_bytes())]);
    run.done("build yard.ovl --goal spot=8,18");
    let answer = answer(&run, "spot/physical", "3,3");
    assert!(answer.get("toll").is_none() && answer.get("limit_mps").is_none(), "{answer}");
}

#[test]
fn products_beyond_the_highest_factor_are_cut_with_a_warning() {
    let mission = "[goals]\nspot = [8, 18]\n[layers.physical]\ntoll = { NoFlyZone1 = 16 }\n\
                   speed = { NoFlyZone1 = { limit = 1, factor = 4 } }\n";
    let files: [(&str, &[u8]); 2] =
        [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    let run = Run::new(&files);
    let ended = run.run("build yard.ovl --resolution 0.5", "");
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.err.contains("tolls multiply to more than 32"), "{}", ended.err);
    assert_eq!(answer(&run, "spot/physical", "30,22")["toll"], 32.0);
}

#[test]
fn mistakes_in_tolls_are_reported_together() {
    check_mission(
        "mission_tolls",
        "[goals]\nspot = [8, 18]\n[layers.night]\narea = ['NoFlyZone1']\n\
         toll = { NoFlyZone1 = 1.3, Swamp = 40, Ice = 0.5 }\n\
         clearance = [{ within = 0.5 }, { within = 0, factor = 2 }]\nspeed = { Yard = 0 }\n",
    );
}

#[test]
fn kinds_of_objects_are_areas() {
    let maps = concat!(env!("CARGO_MANIFEST_DIR"), "/../maps");
    let map = std::fs::read_to_string(format!("{maps}/meadow.geojson")).unwrap();
    let map = map.replace("\"layer\": \"Meadow\"", "\"landuse\": \"grass\"");
    let mission = "resolution = 0.5\norigin = [51, 7]\n[goals]\nschool = [70, 38]\n\
                   [layers.physical]\ntoll = { 'landuse=grass' = 2, Path = 1 }\n";
    let files: [(&str, &[u8]); 2] =
        [("meadow.geojson", map.as_bytes()), ("meadow.mission.toml", mission.as_bytes())];
    let run = Run::new(&files);
    run.done("build meadow.geojson");
    assert_eq!(answer(&run, "school/physical", "20,25")["toll"], 2.0);
    assert_eq!(answer(&run, "school/physical", "20,13.5")["toll"], 1.0);
    assert_eq!(answer(&run, "school/physical", "4,30")["toll"], 1.0);
    // The pond stays an obstacle.
    assert_eq!(answer(&run, "school/physical", "58,10")["cell"], "blocked");
    run.done("verify plans.bin --map meadow.geojson");
}
