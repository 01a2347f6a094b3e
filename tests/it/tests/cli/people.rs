//! The compiler's help with flashing, inspecting and completing commands, and with large maps.

use super::{Run, YARD, check, check_yard, golden};
use serde_json::Value;
use std::fs;

/// An overlay without obstacles.
fn empty(width: u32, height: u32, points: &str) -> String {
    format!("MISSION-AREA {width} {height}\nCONTROL MEASURES:\n{points}")
}

#[test]
fn files_for_flashing_hold_the_blob_at_the_boards_address() {
    let run = Run::yard();
    run.done("build yard.ovl --board pico2");
    run.done("build yard.ovl --board pico2 -o plans.hex");
    run.done("build yard.ovl --board pico2 -o plans.uf2");
    let blob = fs::read(run.path("plans.bin")).unwrap();
    assert_eq!(
        of_hex(&fs::read_to_string(run.path("plans.hex")).unwrap()),
        (0x1020_0000, blob.clone())
    );
    let uf2 = fs::read(run.path("plans.uf2")).unwrap();
    let payload: Vec<u8> = uf2.chunks(512).flat_map(|block| &block[32..288]).copied().collect();
    assert!(payload.starts_with(&blob) && payload.len() - blob.len() < 256);
    assert_eq!(uf2[12..16], 0x1020_0000_u32.to_le_bytes());
    // The robot reads the blob with the padding after it.
    assert!(plan_format::Blob::parse(&payload).is_ok());
}

/// The address and the bytes of an Intel HEX file without gaps.
fn of_hex(text: &str) -> (u32, Vec<u8>) {
    let (mut segment, mut start, mut bytes) = (0, None, Vec::new());
    for line in text.lines() {
        let digits = line.strip_prefix(':').unwrap();
        let byte = |at: usize| u8::from_str_radix(&digits[2 * at..][..2], 16).unwrap();
        let record: Vec<u8> = (0..digits.len() / 2).map(byte).collect();
        assert_eq!(record.iter().fold(0u8, |sum, &byte| sum.wrapping_add(byte)), 0, "{line}");
        let (at, data) = (u16::from_be_bytes([record[1], record[2]]), &record[4..record.len() - 1]);
        assert_eq!(usize::from(record[0]), data.len());
        match record[3] {
            0 => {
                let first = *start.get_or_insert(segment + u32::from(at));
                assert_eq!(segment + u32::from(at), first + bytes.len() as u32, "{line}");
                bytes.extend_from_slice(data);
            }
            4 => segment = u32::from(u16::from_be_bytes([data[0], data[1]])) << 16,
            kind => assert_eq!((kind, line), (1, text.lines().last().unwrap())),
        }
    }
    (start.unwrap(), bytes)
}

#[test]
fn plans_that_no_board_holds_are_refused() {
    // Noise does not pack: many cells have a wall, except in the west.
    let mut seed = 1u64;
    let mut walls = String::new();
    for _ in 0..70_000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let (x, y) = ((seed >> 33 & 0x1FF).max(3), seed >> 45 & 0x1FF);
        walls += &format!("WALL w {x}.4 {y}.4 {x}.6 {y}.6\n");
    }
    let map = empty(512, 512, &walls);
    let run = Run::new(&[("noise.ovl", map.as_bytes())]);
    let build = "build noise.ovl --goal a=0.5,0.5 --board nrf52840-dk";
    let ended = run.run(build, "");
    assert_eq!((ended.status, run.names()), (1, vec!["noise.ovl".to_owned()]), "{}", ended.err);
    // This test does not depend on the packed size.
    let without_numbers = |word: &str| {
        let is_number = word.trim_start_matches('(').starts_with(|c: char| c.is_ascii_digit());
        if is_number { word.replace(|c: char| c.is_ascii_digit(), "#") } else { word.to_owned() }
    };
    let words = ended.err.split_inclusive(char::is_whitespace);
    let text: String = words.map(without_numbers).collect();
    golden("board_without_room", build, &text);
    run.done(&build.replace("nrf52840-dk", "pico2"));
}

#[test]
fn images_are_for_flashing_only() {
    let run = Run::yard();
    run.done("build yard.ovl --board stm32f405 -o plans.hex");
    let hex = fs::read(run.path("plans.hex")).unwrap();
    check("blob_as_hex", &[("plans.hex", &hex)], "inspect plans.hex", "");
    for arguments in [
        "build yard.ovl -o a.hex",
        "build yard.ovl -o a.uf2",
        "build yard.ovl -o a.uf2 --board stm32h743",
        "build yard.ovl --board arduino",
        "build yard.ovl --max-memory 0",
        "completions cobol",
        "man bild",
    ] {
        let ended = run.run(arguments, "");
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{arguments}\n{}", ended.err);
        assert!(ended.err.contains("--help"), "{}", ended.err);
    }
    assert_eq!(run.names(), ["plans.hex", "yard.ovl"]);
}

#[test]
fn sizes_are_said_with_what_they_would_be_unpacked() {
    let run = Run::yard();
    let built: Value =
        serde_json::from_str(&run.done("build yard.ovl --json --board pico2")).unwrap();
    let said: Value = serde_json::from_str(&run.done("inspect plans.bin --json")).unwrap();
    assert_eq!((&built["output"], &built["board"]), (&"plans.bin".into(), &"pico2".into()));
    assert!(built["time_ms"].as_f64().unwrap() > 0.0);
    for field in said.as_object().unwrap().keys() {
        assert_eq!(built[field], said[field], "{field}");
    }
    // Three layers of 40 x 30 cells of 4 + 32 bits.
    let layer = &said["plans"][0]["layers"][0];
    assert_eq!((&layer["raw_bytes"], &said["raw_bytes"]), (&5400.into(), &16_200.into()));
    let per_cell = layer["bytes"].as_f64().unwrap() / 1200.0;
    assert_eq!(layer["bytes_per_cell"], per_cell);
    let text = run.done("inspect plans.bin");
    assert!(text.contains(&format!("{per_cell:.3} per cell")) && text.contains("16200"), "{text}");
    assert!(text.contains("gains   0.5 reactive, 1 plan, 0.05 noise"), "{text}");
    let link = "link    lost after 1 s without a message, then disarms and stands still";
    assert!(text.contains(link), "{text}");
    let proved: Value = serde_json::from_str(&run.done("verify plans.bin --json")).unwrap();
    assert_eq!((&proved["cells"], &proved["layers"]), (&3600.into(), &3.into()));
}

#[test]
fn ways_are_drawn_where_advice_leads() {
    let run = Run::yard();
    run.done("build yard.ovl");
    let ended = run.run("render plans.bin --layer gate/physical --route 3,3 -o way.svg", "");
    let cost: Value =
        serde_json::from_str(&run.done("query plans.bin --layer gate/physical --at 3,3")).unwrap();
    let metres = (cost["cost_m"].as_f64().unwrap() * 1e3).round() / 1e3;
    assert_eq!((ended.status, ended.err), (0, format!("gate/physical: {metres} m from (3, 3)\n")));
    let titles = |arguments: &str| {
        run.done(&format!("render plans.bin --layers {arguments} -o layers.svg"));
        let svg = fs::read_to_string(run.path("layers.svg")).unwrap();
        let title = svg.split_once("<title>").unwrap().1.split_once("</title>").unwrap().0;
        title.trim().to_owned()
    };
    assert_eq!(titles(""), "gate/physical, gate/comms");
    assert_eq!(titles("--layer shed/physical"), "shed/physical");
    let blob = fs::read(run.path("plans.bin")).unwrap();
    let blob = [("plans.bin", blob.as_slice())];
    // Inside the house, and off the map.
    let render =
        |from: &str| format!("render plans.bin --layer gate/physical --route {from} -o way.svg");
    check("route_from_inside", &blob, &render("17,13"), "");
    check("route_from_off_the_map", &blob, &render("-1,13"), "");
}

#[test]
fn maps_too_large_for_memory_are_refused_with_the_numbers() {
    let map = empty(16_384, 16_384, "PP gate 1 1\n");
    check("memory", &[("map.ovl", map.as_bytes())], "build map.ovl", "");
    check_yard("memory_limit_below_any_need", "build yard.ovl --max-memory 0.01");
}

#[test]
fn ways_that_no_cost_can_say_are_warned_of() {
    // A corridor of 1,200 x 1,200 cells that turns after every other row.
    let side = 1200;
    let walls: String = (1..side)
        .step_by(2)
        .map(|row| {
            let from = if row % 4 == 1 { 0.5 } else { 1.5 };
            let (y, to) = (f64::from(row) + 0.5, f64::from(side) - 2.0 + from);
            format!("WALL w {from} {y} {to} {y}\n")
        })
        .collect();
    let map = empty(side as u32, side as u32, &format!("{walls}PP gate 0.5 0.5\n"));
    let run = Run::new(&[("snake.ovl", map.as_bytes())]);
    let ended = run.run("build snake.ovl", "");
    assert_eq!(ended.status, 0, "{}", ended.err);
    golden("warning_too_far", "build snake.ovl", ended.err.split_once("plans.bin:").unwrap().0);
}

#[test]
fn shells_and_man_get_what_they_read() {
    let run = Run::new(&[("yard.ovl", YARD.as_bytes())]);
    for (shell, part) in
        [("bash", "complete -F"), ("zsh", "#compdef plan-compiler"), ("fish", "complete -c")]
    {
        let script = run.done(&format!("completions {shell}"));
        assert!(script.contains(part) && script.contains("robot-radius"), "{script}");
    }
    // Bash names where it is on the command line, then looks up what may follow there.
    let script = run.done("completions bash");
    let states: Vec<&str> = script
        .lines()
        .filter_map(|line| line.trim().strip_prefix("cmd=\"")?.strip_suffix('"'))
        .filter(|state| !state.is_empty())
        .collect();
    assert!(states.contains(&"plan__compiler"), "{script}");
    for state in states {
        let label = format!("{state})");
        assert!(script.lines().any(|line| line.trim() == label), "{state} leads nowhere");
    }
    let page = run.done("man");
    assert!(
        page.contains(".TH plan-compiler 1") && page.contains("plan\\-compiler\\-build"),
        "{page}"
    );
    let page = run.done("man build");
    let version = concat!("v", env!("CARGO_PKG_VERSION"));
    assert!(page.contains("robot\\-radius") && page.contains(version), "{page}");
}
