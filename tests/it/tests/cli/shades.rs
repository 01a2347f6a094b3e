//! Images of costs and of speeds, as users of Nav2 bring them.

use super::Run;
use serde_json::Value;

/// A map of 16 x 8 cells of half a metre with a wall around it, for a robot of 0.2 m.
fn grey(shade: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let pixel = |x, y| if x == 0 || x == 15 || y == 0 || y == 7 { 0 } else { shade(x, y) };
    let pixels = (0..8).flat_map(|y| (0..16).map(move |x| (x, y)));
    [b"P5 16 8 255\n".to_vec(), pixels.map(|(x, y)| pixel(x, y)).collect()].concat()
}

fn yaml(image: &str, mode: &str, thresholds: [f64; 2]) -> String {
    let [free, occupied] = thresholds;
    format!(
        "image: {image}\nmode: {mode}\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n\
         occupied_thresh: {occupied}\nfree_thresh: {free}\n"
    )
}

/// The map with a copy of it in which two areas are grey: 40 % in the west, 70 % in the east.
fn hall(mission: &str) -> Run {
    let head = "map = \"map.yaml\"\nrobot_radius = 0.2\n[goals]\ngate = [6, 2.5]\n[vehicle]\nmax_speed = 1\n";
    let greys = |x: u32, _| {
        if (2..5).contains(&x) {
            153
        } else if x > 9 {
            77
        } else {
            255
        }
    };
    Run::new(&[
        ("map.pgm", &grey(|_, _| 254)),
        ("map.yaml", yaml("map.pgm", "trinary", [0.196, 0.65]).as_bytes()),
        ("mask.pgm", &grey(greys)),
        ("scale.yaml", yaml("mask.pgm", "scale", [0.0, 1.0]).as_bytes()),
        ("trinary.yaml", yaml("mask.pgm", "trinary", [0.196, 0.65]).as_bytes()),
        ("raw.yaml", yaml("mask.pgm", "raw", [0.0, 1.0]).as_bytes()),
        ("soft.pgm", &grey(|x, y| (255 - 12 * x - y) as u8)),
        ("small.pgm", b"P5 1 1 255\n\0"),
        ("costs.npy", b"\x93NUMPY"),
        ("m.mission.toml", format!("{head}{mission}").as_bytes()),
    ])
}

/// The toll and the limit at the centre of a cell of the fourth row from the south.
fn at(run: &Run, layer: &str, column: u32) -> [Value; 2] {
    let x = 0.5 * f64::from(column) + 0.25;
    let line = run.done(&format!("query plans.bin --layer gate/{layer} --at {x},1.75"));
    let answer: Value = serde_json::from_str(&line).unwrap();
    [answer["toll"].clone(), answer["limit_mps"].clone()]
}

#[test]
fn a_speed_mask_of_nav2_limits_the_speed() {
    let run = hall(
        "[masks]\nspeed = { mask = \"scale.yaml\", type = \"percent\", base = 100.0, multiplier = -1.0 }\n",
    );
    run.done("build m.mission.toml -o plans.bin");
    // Rounded to eighths: 1 / 0.6 and 1 / 0.3.
    assert_eq!(at(&run, "physical", 3), [Value::from(1.625), Value::from(0.6)]);
    assert_eq!(at(&run, "physical", 7), [Value::from(1.0), Value::Null]);
    assert_eq!(at(&run, "physical", 11), [Value::from(3.375), Value::from(0.3)]);
    let text = run.done("verify plans.bin --map m.mission.toml");
    assert!(text.contains("; obstacles, tolls and speed limits match the map"), "{text}");
    // The mask is not part of the blob's recipe.
    std::fs::remove_file(run.path("m.mission.toml")).unwrap();
    let ended = run.run("verify plans.bin --map map.yaml", "");
    assert_eq!(ended.status, 1);
    assert!(ended.err.contains("has a speed limit of 0.6 m/s, but of none"), "{}", ended.err);
}

#[test]
fn speed_masks_are_in_metres_per_second_and_belong_to_layers() {
    let run = hall(
        "[[masks.speed]]\nmask = \"scale.yaml\"\ntype = 2\nmultiplier = 0.01\nfactor = 1\n\
         [[masks.speed]]\nmask = \"scale.yaml\"\nlayer = \"night\"\nfactor = 2\n",
    );
    run.done("build m.mission.toml -o plans.bin");
    assert_eq!(at(&run, "physical", 3), [Value::from(1.0), Value::from(0.4)]);
    assert_eq!(at(&run, "night", 3), [Value::from(2.0), Value::from(0.4)]);
    assert_eq!(at(&run, "night", 11), [Value::from(2.0), Value::from(0.7)]);
    assert_eq!(at(&run, "night", 7), [Value::from(1.0), Value::Null]);
    run.done("verify plans.bin --map m.mission.toml");
}

#[test]
fn more_limits_than_a_blob_holds_are_lowered() {
    let run = hall("[masks]\nspeed = { mask = \"soft.pgm\", base = 120, multiplier = -1 }\n");
    let ended = run.run("build m.mission.toml -o plans.bin", "");
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.err.contains("different speed limits, but a blob holds 15"), "{}", ended.err);
    run.done("export plans.bin --layer gate/physical --what limit -o limit.npy");
    let numbers = super::npy_of(&run.path("limit.npy"), "'<f4'", (8, 16));
    let mut limits: Vec<f32> =
        numbers.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    // The shade of each pixel in percent, below 100 % of 1 m/s.
    for (index, &limit) in limits.iter().enumerate() {
        let [x, y] = [index as u32 % 16, 7 - index as u32 / 16];
        let is_inside = (2..14).contains(&x) && (2..6).contains(&y);
        if !is_inside || limit == 0.0 || limit.is_infinite() {
            continue;
        }
        let dark = (f64::from(12 * x + y) / 255.0 * 100.0).round();
        assert!(f64::from(limit) <= (120.0 - dark) / 100.0 + 1e-6, "{x} {y}");
        assert!(f64::from(limit) >= (120.0 - dark) / 100.0 * 0.8, "{x} {y} {limit}");
    }
    limits.retain(|limit| limit.is_finite() && *limit > 0.0);
    limits.sort_by(f32::total_cmp);
    limits.dedup();
    assert!((10..=15).contains(&limits.len()), "{limits:?}");
    run.done("verify plans.bin --map m.mission.toml");
}

#[test]
fn shades_are_costs() {
    for (costs, expected) in [
        ("{ image = \"scale.yaml\", black = 11 }", [5.0, 1.0, 8.0]),
        ("{ image = \"mask.pgm\", black = 11 }", [5.0, 1.0, 8.0]),
        ("{ image = \"mask.pgm\", white = 2, black = 1 }", [1.625, 2.0, 1.25]),
        // Of the greys, only 77 is a percentage.
        ("{ image = \"raw.yaml\", black = 11 }", [1.0, 1.0, 8.75]),
    ] {
        let run = hall(&format!("[layers.physical]\ncosts = {costs}\n"));
        run.done("build m.mission.toml -o plans.bin");
        let tolls = [3, 7, 11].map(|column| at(&run, "physical", column)[0].clone());
        assert_eq!(tolls, expected.map(Value::from), "{costs}");
        run.done("verify plans.bin --map m.mission.toml");
    }
}

#[test]
fn what_shades_cannot_mean_is_named() {
    for (mission, status, words) in [
        (
            "[masks]\nspeed = { mask = \"trinary.yaml\", base = 100, multiplier = -1 }",
            1,
            "in mode trinary they are unknown",
        ),
        (
            "[masks]\nspeed = { mask = \"scale.yaml\", multiplier = -1 }",
            1,
            "free cells a speed below 0.05 m/s, the first at (1.25, 1.25)",
        ),
        ("[masks]\nspeed = { mask = \"scale.yaml\", base = 200 }", 0, "scale.yaml limits no speed"),
        (
            "[masks]\nspeed = { mask = \"small.pgm\" }",
            1,
            "small.pgm does not have the cells of the plan",
        ),
        ("[masks]\nspeed = { base = 100 }", 1, "a speed mask has no `mask`"),
        (
            "[masks]\nspeed = { mask = \"scale.yaml\", type = \"kmh\" }",
            1,
            "`masks.speed.type` cannot be \"kmh\"",
        ),
        ("[masks]\nspeed = { mask = \"sclae.yaml\" }", 1, "scale.yaml?"),
        (
            "[masks]\nkeepout = \"scale.yaml\"",
            0,
            "grey pixels of scale.yaml do not keep the robot out",
        ),
        (
            "[layers.physical]\ncosts = \"mask.pgm\"",
            1,
            "mask.pgm does not say which factors its shades mean",
        ),
        (
            "[layers.physical]\ncosts = { image = \"mask.pgm\" }",
            1,
            "`layers.physical.costs` has no `black`",
        ),
        (
            "[layers.physical]\ncosts = { image = \"small.pgm\", black = 2 }",
            1,
            "small.pgm does not have the cells of the plan",
        ),
        (
            "[layers.physical]\ncosts = { image = \"costs.npy\", black = 2 }",
            1,
            "costs.npy is not an image",
        ),
        (
            "[layers.physical]\ncosts = { image = \"mask.pgm\", black = 40 }",
            1,
            "`layers.physical.costs.black` must be a number from 1 to 32",
        ),
    ] {
        let run = hall(&format!("{mission}\n"));
        let ended = run.run("build m.mission.toml -o plans.bin", "");
        assert!(ended.err.contains(words), "{mission}: {}", ended.err);
        assert_eq!(ended.status, status, "{mission}: {}", ended.err);
    }
}

#[test]
fn a_mask_of_speeds_is_not_replaced_by_the_output() {
    let run = hall("[masks]\nspeed = { mask = \"scale.yaml\", base = 100, multiplier = -1 }\n");
    for output in ["scale.yaml", "mask.pgm"] {
        let ended = run.run(&format!("build m.mission.toml -o {output}"), "");
        assert_eq!(ended.status, 1, "{output}");
        assert!(ended.err.contains("is also the input"), "{output}: {}", ended.err);
    }
}
