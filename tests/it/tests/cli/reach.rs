//! `plan-compiler comms` as a user runs it.

use super::{Run, YARD, check, check_yard, npy};
use serde_json::Value;

/// A radio in the yard that a house can break.
const MISSION: &str = "\
map = \"yard.ovl\"
resolution = 0.5
[radio]
places = { base = [3, 3], mate = \"gate\" }
threshold = 45
";

fn with_mission() -> Run {
    Run::new(&[("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", MISSION.as_bytes())])
}

#[test]
fn the_array_the_summary_and_the_layer_agree() {
    let run = with_mission();
    let text = run.done("comms yard.ovl --json -o margins.npy");
    let summary: Value = serde_json::from_str(&text).unwrap();
    run.done("build yard.ovl --goal spot=8,18");
    for layer in ["physical", "comms"] {
        run.done(&format!("export plans.bin --layer spot/{layer} --what blocked -o {layer}.npy"));
    }
    let margins: Vec<f32> = npy(&run.path("margins.npy"), "'<f4'")
        .chunks_exact(4)
        .map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap()))
        .collect();
    let [physical, comms] = ["physical.npy", "comms.npy"].map(|name| npy(&run.path(name), "'|u1'"));
    assert_eq!((margins.len(), physical.len()), (4800, 4800));
    for ((margin, physical), comms) in margins.iter().zip(&physical).zip(&comms) {
        assert_eq!(*comms == 1, *physical == 1 || *margin < 45.0);
    }
    let free = physical.iter().filter(|blocked| **blocked == 0).count();
    let reached = comms.iter().filter(|blocked| **blocked == 0).count();
    assert!(0 < reached && reached < free);
    assert_eq!(summary["free_cells"], free);
    assert_eq!(summary["out_of_reach"], free - reached);
    assert_eq!(summary["places"][1]["at_m"], serde_json::json!([35.0, 25.0]));
    // The blob is proved against the map, by its own recipe and by the mission.
    run.done("verify plans.bin --map yard.ovl");
    run.done("verify plans.bin --map yard.mission.toml");
    let changed = MISSION.replace("45", "55");
    std::fs::write(run.path("yard.mission.toml"), changed).unwrap();
    run.done("verify plans.bin --map yard.ovl");
    assert_eq!(run.run("verify plans.bin --map yard.mission.toml", "").status, 1);
}

#[test]
fn places_and_options_of_the_command_line_replace_those_of_the_mission() {
    let run = with_mission();
    let text = run.done("comms yard.ovl");
    assert!(text.contains("below 45 dB") && text.contains("  at least one of them: "), "{text}");
    let text = run.done("comms yard.mission.toml --place here=5,5 --threshold 5 --power 20");
    assert!(text.contains("below 5 dB") && text.ends_with("  here at (5, 5): 35.5 %\n"), "{text}");
    let text = run.done("comms yard.ovl --need any");
    assert!(text.contains("  all of them: "), "{text}");
    for picture in ["reach.svg", "reach.png"] {
        assert_eq!(run.done(&format!("comms yard.ovl -q -o {picture}")), "");
        assert!(run.path(picture).exists());
    }
}

#[test]
fn mistakes_in_radios_are_reported_together() {
    check_yard("comms_places", "comms yard.ovl --place a=1,1 --place a=15,12 -o no/reach.png");
    let mission =
        "[radio]\npower = 'high'\nplaces = { base = 'gaet', other = [1] }\nneed = 'both'\n";
    let files: [(&str, &[u8]); 2] =
        [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    check("comms_mission", &files, "comms yard.ovl", "");
    let run = Run::yard();
    for (arguments, expected) in [
        ("comms yard.ovl", "no place to reach"),
        ("comms yard.ovl --place a=1,1 -o reach.txt", ".svg, .png or .npy"),
        ("comms yard.ovl --place a=1,1 --frequency 2400", "a number from 0.03 to 100 GHz"),
    ] {
        let ended = run.run(arguments, "");
        assert!(ended.status == 2 && ended.err.contains(expected), "{}", ended.err);
    }
}

/// The mistake is in the mission, not on the command line.
#[test]
fn a_mistake_in_the_table_radio_is_shown_in_its_line() {
    let mission = "map = \"yard.ovl\"\n[radio]\nplaces = { base = [[3, 3], [5, 5]] }\n";
    let files = [("yard.ovl", YARD.as_bytes()), ("rad.mission.toml", mission.as_bytes())];
    check("comms_of_a_mission_with_a_mistake", &files, "comms rad.mission.toml", "");
}
