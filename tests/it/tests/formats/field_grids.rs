//! ROS and MovingAI files of users that once failed, compared with their table, and similar files of
//! our own.

use super::inspected;
use crate::cli::Run;
use std::path::Path;

/// Checks a build against an entry of the table: alternatives of `blocked=N`, `blocked=A..B`,
/// `says=WORD`, `quiet:says=WORD` and `refused`.
fn holds(expected: &str, map: &Path, goal: &str) -> Result<(), String> {
    let run = Run::new(&[]);
    let map = map.display();
    let build = format!("build|{map}|--robot-radius|0|--goal|a={goal}");
    let ended = run.run(&build, "");
    let quiet = run.run(&format!("--quiet|{build}"), "").err;
    let blocked = || {
        let counted = inspected(&run)["plans"][0]["layers"][0]["blocked"].as_u64();
        counted.expect("a count")
    };
    let says = |words: &str, text: &str| {
        words.trim_matches(['(', ')']).split('|').any(|word| text.contains(word))
    };
    let is_met = |alternative: &str| match alternative.split_once('=') {
        None => alternative == "refused" && ended.status == 1,
        Some(("says", words)) => says(words, &ended.err),
        Some(("quiet:says", words)) => says(words, &quiet),
        Some(("blocked", count)) if ended.status == 0 => match count.split_once("..") {
            Some((low, high)) => {
                let number = |text: &str| text.parse::<u64>().expect("a number");
                (number(low)..=number(high)).contains(&blocked())
            }
            None => count.parse() == Ok(blocked()),
        },
        Some(_) => false,
    };
    if expected.split(" or ").any(is_met) {
        return Ok(());
    }
    Err(format!("{map}: expected {expected}, got {}\n{}\n{quiet}", ended.status, ended.err))
}

#[test]
fn inputs_that_once_failed_are_as_their_table_says() {
    let Some(folder) = it::real_data("field/maps") else { return };
    let folder = folder.canonicalize().expect("a folder");
    let table = std::fs::read_to_string(folder.join("expected.tsv")).expect("a table");
    let mut compared = 0;
    for line in table.lines().filter(|line| !line.starts_with('#')) {
        let (name, expected) = line.split_once('\t').expect("two columns");
        let (map, goal) = match name.split_once('_').expect("a format").0 {
            "ros" => (folder.join(name).join("map.yaml"), "0.75,3.75"),
            "movingai" => (folder.join(name), "1.5,1.5"),
            _ => continue,
        };
        holds(expected, &map, goal).unwrap_or_else(|reason| panic!("{reason}"));
        compared += 1;
    }
    assert!(compared >= 6, "{compared} rows");
}

/// A yard of 8 by 6 cells: a fence with a gate, a hut, and a corner of unknown cells.
const YARD: [&str; 6] = ["########", "#.....??", "#.##..??", "#.##...#", "......##", "########"];

/// The yard as pixels of grey and alpha, row by row from the north.
fn pixels(hole: u8) -> Vec<[u8; 2]> {
    let symbols = YARD.iter().flat_map(|row| row.bytes());
    let pixel = |symbol| match symbol {
        b'#' => [0, 255],
        b'.' => [254, 255],
        _ => [254, hole],
    };
    symbols.map(pixel).collect()
}

fn settings(image: &str, free_thresh: &str) -> String {
    format!(
        "image: {image}\nresolution: 0.5\norigin: [3, -1, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
         free_thresh: {free_thresh}\n"
    )
}

/// The yard's PGM, with the unknown corner in the grey that ROS map savers write.
fn pgm(line_end: &str) -> Vec<u8> {
    let mut bytes = format!("P5{line_end}8 6{line_end}255{line_end}").into_bytes();
    bytes.extend(pixels(0).iter().map(|[grey, alpha]| if *alpha == 0 { 205 } else { *grey }));
    bytes
}

#[track_caller]
fn check(files: &[(&str, &[u8])], expected: &str) {
    let run = Run::new(files);
    let map = run.path(files[0].0);
    holds(expected, &map, "3.75,-0.25").unwrap_or_else(|reason| panic!("{reason}"));
}

#[test]
fn twins_of_ros_maps() {
    let plain = settings("yard.pgm", "0.196");
    let blocked = YARD.concat().bytes().filter(|symbol| *symbol != b'.').count();
    let counted = format!("blocked={blocked}");
    check(&[("yard.yaml", plain.as_bytes()), ("yard.pgm", &pgm("\n"))], &counted);
    let tabs = plain.replace(": ", ":\t");
    check(&[("yard.yaml", tabs.as_bytes()), ("yard.pgm", &pgm("\n"))], &counted);
    check(&[("yard.yaml", plain.as_bytes()), ("yard.pgm", &pgm("\r\n"))], "refused");
    let quarter = settings("yard.pgm", "0.25");
    check(&[("yard.yaml", quarter.as_bytes()), ("yard.pgm", &pgm("\n"))], "quiet:says=⚠");
    let degrees = plain.replace("-1, 0]", "-1, 180]");
    check(&[("yard.yaml", degrees.as_bytes()), ("yard.pgm", &pgm("\n"))], "quiet:says=180 rad");
    let mut more = pgm("\n");
    more.push(0);
    check(&[("yard.yaml", plain.as_bytes()), ("yard.pgm", &more)], "refused");
    let less = &more[..more.len() - 2];
    check(&[("yard.yaml", plain.as_bytes()), ("yard.pgm", less)], "refused");
}

#[test]
fn twins_of_movingai_maps() {
    let rows = YARD.map(|row| row.replace('#', "@").replace('?', "T")).join("\n");
    let text = format!("type octile\nheight 6\nwidth 8\nmap\n{rows}\n");
    let blocked = YARD.concat().bytes().filter(|symbol| *symbol != b'.').count();
    for line_end in ["\r", "\r\n", "\n\r", "\n\n", " \n", "\r\r\n"] {
        let run = Run::new(&[("yard.map", text.replace('\n', line_end).as_bytes())]);
        holds(&format!("blocked={blocked}"), &run.path("yard.map"), "1.5,1.5")
            .unwrap_or_else(|reason| panic!("{line_end:?} {reason}"));
    }
    for (from, to) in [("height 6", "height 5"), ("width 8", "width 9"), ("map\n", "")] {
        let run = Run::new(&[("yard.map", text.replace(from, to).as_bytes())]);
        assert_eq!(run.run("build yard.map --goal a=1.5,1.5", "").status, 1, "{to}");
    }
}
