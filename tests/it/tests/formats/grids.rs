//! Maps that consist of cells: ROS and MovingAI.

use super::{inspected, picture};
use crate::cli::Run;
use insta::assert_snapshot;

/// Black, 205 grey (unknown) and white cells, the first row in the north.
const GREYS: &[u8] = b"P2\n6 4\n255\n\
    255 255 255 255 255 255\n\
    255   0   0 205 255 255\n\
    255   0 255 205 255 255\n\
    255 255 255 255 255 255\n";

fn settings(yaw: &str) -> String {
    format!(
        "image: yard.pgm\nresolution: 1\norigin: [0, 0, {yaw}]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
}

fn built(yaw: &str, options: &str) -> Run {
    let yaml = settings(yaw);
    let run = Run::new(&[("yard.yaml", yaml.as_bytes()), ("yard.pgm", GREYS)]);
    run.done(&format!("build yard.yaml --robot-radius 0 {options}"));
    run
}

#[test]
fn unknown_cells_are_what_the_user_says() {
    for (option, expected) in [
        ("", "......\n.###..\n.#.#..\n......\n"),
        ("--unknown obstacle", "......\n.###..\n.#.#..\n......\n"),
        ("--unknown free", "......\n.##...\n.#....\n......\n"),
    ] {
        let run = built("0", &format!("--goal a=0.5,0.5 {option}"));
        assert_eq!(picture(&run, "a/physical"), expected, "{option}");
        run.done(&format!("verify plans.bin --map yard.yaml {option}"));
    }
    // The blob records how its map was read.
    let run = built("0", "--goal a=0.5,0.5 --unknown free");
    run.done("verify plans.bin --map yard.yaml");
    assert_eq!(run.run("verify plans.bin --map yard.yaml --robot-radius 1", "").status, 1);
    let ended = run.run("build yard.yaml --robot-radius 0 --goal a=3.5,1.5", "");
    assert_eq!(ended.status, 1, "a goal in an unknown cell");
    run.done("build yard.yaml --robot-radius 0 --goal a=3.5,1.5 --unknown free");
}

#[test]
fn an_image_is_turned_by_its_yaw() {
    // A quarter turn about the south-west corner is exact, although files round the angle.
    let run = built("1.5708", "--goal a=-0.5,0.5");
    assert_eq!(inspected(&run)["corner_m"], serde_json::json!([-4.0, 0.0]));
    assert_snapshot!(picture(&run, "a/physical"), @"
    ....
    ....
    .##.
    .#..
    .##.
    ....
    ");
    // The counts are those of the file.
    let ended = run.run("build yard.yaml --robot-radius 0 --goal a=-0.5,0.5", "");
    let counted = "6 x 4 cells of 1 m: 19 free, 3 occupied, 2 unknown";
    assert!(ended.err.contains(counted), "{}", ended.err);
    let run = built("3.14159265", "--goal a=-0.5,-0.5");
    assert_eq!(inspected(&run)["corner_m"], serde_json::json!([-6.0, -4.0]));
    assert_snapshot!(picture(&run, "a/physical"), @"
    ......
    ..#.#.
    ..###.
    ......
    ");
    // By half of that, cells that overlap a blocked one are blocked, and so is what lies outside.
    let run = built("0.78539816", "--goal a=-0.078,0.75 --resolution 0.5 --unknown free");
    assert_snapshot!(picture(&run, "a/physical"), @"
    ################
    ################
    ################
    ########.#######
    #######...######
    ######.....#####
    ########....####
    ########.....###
    ########....####
    ########...#####
    #.######..######
    ########.#######
    ###.############
    ################
    #####.##########
    ################
    ");
    run.done("verify plans.bin --map yard.yaml --resolution 0.5 --unknown free");
}

/// Real maps: the cells of the blob are those of the trinary rule, for both treatments of unknown
/// cells.
#[test]
fn real_images_have_the_counted_cells() {
    let Some(folder) = it::real_data("ros") else { return };
    let counts = std::fs::read_to_string(folder.join("expected_counts.tsv")).expect("counts");
    let mut compared = 0;
    for line in counts.lines().skip(1) {
        let columns: Vec<&str> = line.split('\t').collect();
        let [yaml, _, width, height, _, _, side, origin, .., free, unknown, first] = columns[..]
        else {
            panic!("{line}")
        };
        let number = |text: &str| text.trim().parse::<f64>().expect("a number");
        let numbers = |text: &str| {
            let inner = text.trim_matches(['[', ']', '(', ')']);
            inner.split(',').map(number).collect::<Vec<f64>>()
        };
        let (origin, first, side) = (numbers(origin), numbers(first), number(side));
        let goal = [0, 1].map(|axis| origin[axis] + (first[axis] + 0.5) * side);
        let cells = number(width) * number(height);
        let map = folder.join(yaml).canonicalize().expect("a map");
        for (option, expected) in
            [("obstacle", number(free)), ("free", number(free) + number(unknown))]
        {
            let run = Run::new(&[]);
            let [x, y] = goal;
            run.done(&format!(
                "build|{}|--robot-radius|0|--unknown|{option}|--goal|a={x},{y}",
                map.display()
            ));
            let said = inspected(&run);
            let layer = &said["plans"][0]["layers"][0];
            let count = |name: &str| layer[name].as_f64().expect("a count");
            // Enclosed free cells are counted separately.
            let free = count("free") + count("unreachable");
            assert_eq!((free, count("blocked")), (expected, cells - expected), "{yaml} {option}");
            compared += 1;
        }
    }
    assert_eq!(compared, 6);
}

/// The longest path of every scenario, compared with the answer of `query`.
#[test]
fn real_scenarios_have_their_lengths() {
    let Some(folder) = it::real_data("movingai") else { return };
    let mut compared = 0;
    for file in std::fs::read_dir(&folder).expect("a folder") {
        let path = file.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "scen") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("text");
        let entries = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        let length = |entry: &Vec<&str>| entry[8].parse::<f64>().expect("a length");
        let entries = entries.filter(|entry| entry.len() == 9);
        let entry = entries.max_by(|a, b| length(a).total_cmp(&length(b))).expect("an entry");
        let map = folder.join(entry[1].rsplit('/').next().expect("a name"));
        let map = map.canonicalize().expect("a map");
        let rows: f64 = entry[3].parse().expect("rows");
        // Rows count from the north.
        let at = |x: &str, y: &str| {
            let number = |text: &str| text.parse::<f64>().expect("a coordinate");
            format!("{},{}", number(x) + 0.5, rows - number(y) - 0.5)
        };
        let run = Run::new(&[]);
        run.done(&format!("build|{}|--goal|a={}", map.display(), at(entry[6], entry[7])));
        let start = at(entry[4], entry[5]);
        let said = run.done(&format!("query plans.bin --layer a/physical --at {start}"));
        let said: serde_json::Value = serde_json::from_str(&said).expect("JSON");
        let (got, expected) = (said["cost_m"].as_f64().expect("a cost"), length(&entry));
        assert!((got - expected).abs() <= expected * 6e-6 + 1e-3, "{path:?}: {got} {expected}");
        compared += 1;
    }
    assert!(compared >= 6, "{compared} files");
}
