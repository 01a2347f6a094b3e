//! One yard in three encodings: GeoJSON, OpenStreetMap XML, and OpenStreetMap PBF as osmium writes it.

use super::{inspected, picture};
use crate::cli::Run;
use insta::assert_snapshot;

const FILES: [&str; 3] = ["courtyard.geojson", "courtyard.osm", "courtyard.osm.pbf"];

fn built(file: &str, options: &str) -> Run {
    let bytes = std::fs::read(it::own_map(file)).expect("a map of our own");
    let run = Run::new(&[(file, &bytes)]);
    run.done(&format!("build {file} {options}"));
    run
}

#[test]
fn the_yard_has_its_courtyard_walls_and_wood() {
    let run = built("courtyard.osm", "--resolution 2 --robot-radius 0");
    assert_snapshot!(picture(&run, "Gate/physical"), @"
    ....................................
    ....................................
    ....................................
    ....................................
    ......................#####.........
    .....#############....#####.........
    .....#############....#####.........
    .....#############....#####.........
    .....#############....#####.........
    .....#############....#####.........
    .....#############..................
    .....####.....####..................
    .....####.....####..................
    .....####.....####..................
    .....####.....####..................
    .....####.....####...########.......
    .....####.....####...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....................#..............
    .....................#..............
    .....................#..............
    .....................#..............
    .....................#..............
    ");
    assert_snapshot!(picture(&run, "Gate/comms"), @"
    ....................................
    ............................#######.
    ............................#######.
    ............................#######.
    ......................#####.#######.
    .....#############....#####.#######.
    .....#############....#####.#######.
    .....#############....#####.#######.
    .....#############....#####.#######.
    .....#############....#####.#######.
    .....#############..........#######.
    .....####.....####..........#######.
    .....####.....####..........#######.
    .....####.....####..........#######.
    .....####.....####..................
    .....####.....####...########.......
    .....####.....####...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....#############...#..............
    .....................#..............
    .....................#..............
    .....................#..............
    .....................#..............
    .....................#..............
    ");
}

#[test]
fn every_encoding_gives_the_same_bytes() {
    for options in ["", "--resolution 0.5 --robot-radius 0.4", "--corners allow"] {
        let blobs = FILES
            .map(|file| std::fs::read(built(file, options).path("plans.bin")).expect("a blob"));
        assert!(blobs[0] == blobs[1] && blobs[1] == blobs[2], "{options}");
    }
}

#[test]
fn places_on_the_globe_are_places_of_the_map() {
    for file in FILES {
        let run = built(file, "");
        let said = inspected(&run);
        assert_eq!((&said["columns"], &said["rows"]), (&71.into(), &56.into()), "{file}");
        assert_eq!(said["origin"]["lat_deg"], 51.00025);
        assert_eq!(said["origin"]["lon_deg"], 7.0005);
        // Named points are goals, the kiosk is none; an area weakens radio, so there are two layers.
        let plans = said["plans"].as_array().expect("plans");
        let names: Vec<_> = plans.iter().map(|plan| plan["name"].as_str()).collect();
        assert_eq!(names, [Some("Gate"), Some("Courtyard")]);
        assert_eq!(plans[0]["layers"].as_array().map(Vec::len), Some(2));

        let ask = |layer: &str, at: &str| -> serde_json::Value {
            let line = run.done(&format!("query plans.bin --layer {layer} --geo {at}"));
            serde_json::from_str(&line).expect("JSON")
        };
        assert_eq!(ask("Gate/physical", "51.00004,7.0009")["direction"], "goal");
        // The courtyard is free, but closed.
        let inside = ask("Gate/physical", "51.00025,7.00033");
        assert_eq!((&inside["cell"], inside["cost_m"].is_null()), (&"free".into(), true));
        assert_eq!(ask("Gate/physical", "51.00012,7.00020")["cell"], "blocked");
        // The wood blocks in one layer only; the ruin does not block.
        assert_eq!(ask("Gate/physical", "51.00035,7.0009")["cell"], "free");
        assert_eq!(ask("Gate/comms", "51.00035,7.0009")["cell"], "blocked");
        assert_eq!(ask("Gate/physical", "51.00005,7.00007")["cell"], "free");
        assert_eq!(ask("Gate/physical", "51.1,7.0009")["cell"], "off-map");
        run.done(&format!("verify plans.bin --map {file}"));
    }
}

#[test]
fn the_content_decides_what_a_file_is() {
    for file in FILES {
        let bytes = std::fs::read(it::own_map(file)).expect("a map of our own");
        let run = Run::new(&[("yard", &bytes)]);
        run.done("build yard");
        assert_eq!(inspected(&run)["columns"], 71, "{file}");
    }
    // `--format` outranks the content: the result is an error, not an accidental map.
    let bytes = std::fs::read(it::own_map("courtyard.osm")).expect("a map of our own");
    let run = Run::new(&[("yard.osm", &bytes)]);
    assert_eq!(run.run("build yard.osm --format geojson", "").status, 1);
    run.done("build yard.osm --format osm");
}

/// The blob records the meaning of the tags and the origin, so a comparison needs no options, and a
/// comparison with other options finds the difference.
#[test]
fn a_blob_knows_what_its_tags_meant() {
    let options = "--block natural=wood --free barrier=hedge --open-gates --origin 51.0002,7.0004";
    let run = built("yard.osm", options);
    run.done("verify plans.bin --map yard.osm");
    for other in ["--free barrier", "--origin 51.0001,7.0004"] {
        let ended = run.run(&format!("verify plans.bin --map yard.osm {other}"), "");
        assert_eq!(ended.status, 1, "{other}: {}", ended.err);
    }
}
