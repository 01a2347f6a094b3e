//! Keep-out masks: additional maps of cells that a mission names.

use super::picture;
use crate::cli::Run;
use insta::assert_snapshot;
use std::fs;

const OVERLAY: &str = "MISSION-AREA 8 6\nCONTROL MEASURES:\nPP a 7.5 0.5\nWALL w 4 2 4 4\n";
/// Two cells of 1.5 m, the western one black.
const MASK: &[u8] = b"P2 2 1 255 0 254";

fn yaml(origin: &str) -> String {
    format!(
        "image: mask.pgm\nresolution: 1.5\norigin: [{origin}]\nnegate: 0\noccupied_thresh: 0.65\n\
         free_thresh: 0.196\n"
    )
}

fn yard(mission: &str, origin: &str) -> Run {
    Run::new(&[
        ("yard.ovl", OVERLAY.as_bytes()),
        ("yard.mission.toml", mission.as_bytes()),
        ("mask.yaml", yaml(origin).as_bytes()),
        ("mask.pgm", MASK),
    ])
}

#[test]
fn a_mask_of_its_own_cells_keeps_out() {
    let run = yard("[masks]\nkeepout = \"mask.yaml\"\n", "1, 1, 0");
    run.done("build yard.ovl --robot-radius 0");
    assert_snapshot!(picture(&run, "a/physical"), @"
    ........
    ....#...
    ....#...
    .##.#...
    .##.....
    ........
    ");
    run.done("verify plans.bin --map yard.ovl");
    // Grown by the robot's radius like any obstacle.
    run.done("build yard.ovl --robot-radius 0.25");
    assert_snapshot!(picture(&run, "a/physical"), @"
    ........
    ...##...
    ...##...
    #####...
    #####...
    ###.....
    ");
}

#[test]
fn a_mask_may_belong_to_a_layer_and_may_be_turned() {
    let run = yard("[masks.keepout]\nnight = [\"mask.yaml\"]\n", "3, 1, 1.5708");
    run.done("build yard.ovl --robot-radius 0");
    let plain = "........\n....#...\n....#...\n....#...\n........\n........\n";
    assert_eq!(picture(&run, "a/physical"), plain);
    assert_snapshot!(picture(&run, "a/night"), @"
    ........
    ....#...
    ....#...
    .##.#...
    .##.....
    ........
    ");
}

#[test]
fn what_a_mask_cannot_do_is_told() {
    for (mission, origin, status, words) in [
        ("[masks]\nspeed = \"mask.yaml\"\n", "1, 1, 0", 1, "`masks.speed` must be a table"),
        ("[masks]\nkeep_out = \"mask.yaml\"\n", "1, 1, 0", 1, "`keep_out` is not a kind of mask"),
        ("[masks]\nkeepout = \"msak.yaml\"\n", "1, 1, 0", 1, "mask.yaml?"),
        ("[masks]\nkeepout = 3\n", "1, 1, 0", 1, "the name of a file, or a list"),
        ("[masks]\nkeepout = \"yard.ovl\"\n", "1, 1, 0", 1, "yard.ovl is not a mask"),
        ("[masks]\nkeepout = { \"a/b\" = \"mask.yaml\" }\n", "1, 1, 0", 1, "cannot be the name"),
        ("[masks]\nkeepout = \"mask.yaml\"\n", "100, 1, 0", 0, "does not overlap the map"),
        ("[masks]\nkeepout = \"mask.yaml\"\n", "6.75, 0, 0", 0, "goal `a`"),
    ] {
        let run = yard(mission, origin);
        let ended = run.run("build yard.ovl", "");
        assert!(ended.err.contains(words), "{mission}: {}", ended.err);
        // The mask covers the only goal, so there is none.
        let status = if origin == "6.75, 0, 0" { 1 } else { status };
        assert_eq!(ended.status, status, "{mission}: {}", ended.err);
    }
}

#[test]
fn a_mask_is_not_replaced_by_the_output() {
    let run = yard("[masks]\nkeepout = \"mask.yaml\"\n", "1, 1, 0");
    for output in ["mask.yaml", "mask.pgm"] {
        let ended = run.run(&format!("build yard.ovl -o {output}"), "");
        assert_eq!(ended.status, 1, "{output}");
        assert!(ended.err.contains("is also the input"), "{output}: {}", ended.err);
    }
    assert_eq!(fs::read(run.path("mask.pgm")).unwrap(), MASK);
}

#[test]
fn the_image_of_a_map_is_not_replaced_by_the_output() {
    // The content of an image decides its format, not its name.
    let yaml = yaml("0, 0, 0").replace("mask.pgm", "map.png");
    let run = Run::new(&[("map.yaml", yaml.as_bytes()), ("map.png", MASK)]);
    run.done("build map.yaml --goal a=2,1 --robot-radius 0");
    for command in [
        "build map.yaml --goal a=2,1 --robot-radius 0",
        "comms map.yaml --place a=2,1 --robot-radius 0",
        "render plans.bin --layer a/physical --map map.yaml",
    ] {
        let ended = run.run(&format!("{command} -o map.png"), "");
        assert_eq!(ended.status, 1, "{command}");
        let message = "the output map.png is also the input";
        assert!(ended.err.contains(message), "{command}: {}", ended.err);
        assert_eq!(fs::read(run.path("map.png")).unwrap(), MASK, "{command}");
    }
}
