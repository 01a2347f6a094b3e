//! `plan-compiler render` as a user runs it.

use super::{Run, YARD};
use std::fs;
use std::path::Path;

/// Width and height of a PNG.
fn sides(png: &Path) -> (u32, u32) {
    let png = fs::read(png).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    (side(16), side(20))
}

/// The texts of an SVG.
fn texts(svg: &Path) -> Vec<String> {
    let svg = fs::read_to_string(svg).unwrap();
    let parts = svg.split("<text").skip(1).filter_map(|part| part.split_once('>'));
    parts.filter_map(|(_, rest)| Some(rest.split_once("</text>")?.0.trim().to_owned())).collect()
}

#[test]
fn pictures_are_drawn_and_small() {
    let run = Run::yard();
    run.done("build yard.ovl");
    run.done("render plans.bin --layer gate/comms -o plan.svg --map yard.ovl");
    let texts = texts(&run.path("plan.svg"));
    for text in ["gate/comms", "gate", "shed", "cost to the goal, m", "obstacle", "zone", "goal"] {
        assert!(texts.iter().any(|found| found == text), "{text} is missing in {texts:?}");
    }
    // A picture of a large map is not larger.
    let large = YARD.replace("40 30", "1600 1500");
    fs::write(run.path("large.ovl"), large).unwrap();
    run.done("build large.ovl");
    run.done("render plans.bin --layer gate/comms -o large.svg");
    assert!(fs::metadata(run.path("large.svg")).unwrap().len() < 2_000_000);
}

#[test]
fn pictures_have_the_size_that_was_asked_for() {
    let run = Run::yard();
    run.done("build yard.ovl");
    for (size, expected) in [("", 1200), ("--size 500", 500), ("--size 2000", 2000)] {
        run.done(&format!("render plans.bin --layer gate/comms -o plan.png {size}"));
        let (width, height) = sides(&run.path("plan.png"));
        // Cells of whole pixels may leave some room.
        let longer = width.max(height);
        assert!(
            longer <= expected && longer > expected * 9 / 10,
            "{width} x {height} of {expected}"
        );
    }
    run.done("render plans.bin --layers -o all.png --size 900");
    let (width, height) = sides(&run.path("all.png"));
    assert!(width.max(height) <= 900, "{width} x {height}");
    for size in ["199", "8001", "big", "-5"] {
        let ended = run.run(&format!("render plans.bin --layers -o x.png --size={size}"), "");
        assert_eq!(ended.status, 2, "{size}: {}", ended.err);
    }
}

#[test]
fn arrows_can_be_left_out_and_routes_have_marks() {
    let run = Run::yard();
    run.done("build yard.ovl");
    run.done("render plans.bin --layer gate/physical --route 3,3 -o with.svg");
    run.done("render plans.bin --layer gate/physical --route 3,3 --no-arrows -o without.svg");
    let (with, without) = (texts(&run.path("with.svg")), texts(&run.path("without.svg")));
    for text in ["route that follows the advice", "start", "goal", "goal of another plan"] {
        let has = |texts: &[String]| texts.iter().any(|found| found == text);
        assert!(has(&with) && has(&without), "{text} is missing in {with:?} or {without:?}");
    }
    assert!(with.contains(&"advice".to_owned()) && !without.contains(&"advice".to_owned()));
}

#[test]
fn names_that_the_font_lacks_are_warned_of_in_a_png_only() {
    let run = Run::new(&[("yard.ovl", YARD.replace("PP shed", "PP \"北門\"").as_bytes())]);
    run.done("build yard.ovl");
    let ended = run.run("render plans.bin --layer gate/physical -o plan.png", "");
    assert_eq!(ended.status, 0, "{}", ended.err);
    assert!(ended.err.contains("the font has no 北門"), "{}", ended.err);
    let ended = run.run("render plans.bin --layer gate/physical -o plan.svg", "");
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    assert!(texts(&run.path("plan.svg")).contains(&"北門".to_owned()));
}

#[test]
fn radio_has_isolines_with_their_decibels() {
    let run = Run::yard();
    run.done("comms yard.ovl --place base=3,3 --threshold 45 -o reach.svg --quiet");
    let texts = texts(&run.path("reach.svg"));
    let decibels: Vec<f64> =
        texts.iter().filter_map(|text| text.strip_suffix(" dB")?.parse().ok()).collect();
    assert!(decibels.len() >= 4 && decibels.contains(&45.0), "{texts:?}");
    for text in ["equal margin, dB", "threshold, 45 dB", "margin of the link, dB"] {
        assert!(texts.iter().any(|found| found == text), "{text} is missing in {texts:?}");
    }
}

#[test]
fn several_goals_have_borders_between_them() {
    let run = Run::yard();
    for (goals, has_border) in [("fuel=3,3;36,26", true), ("fuel=3,3", false)] {
        run.done(&format!("build yard.ovl --goal {goals}"));
        run.done("render plans.bin --layer fuel/physical -o plan.svg");
        let texts = texts(&run.path("plan.svg"));
        assert_eq!(texts.contains(&"border between goals".to_owned()), has_border, "{texts:?}");
    }
}

#[test]
fn a_route_shows_the_layers_that_the_robot_chooses() {
    let mission =
        "selection = \"dynamic\"\n[goals]\nspot = [8, 18]\n[layers]\nnight = ['NoFlyZone1']\n";
    let files: [(&str, &[u8]); 2] =
        [("yard.ovl", YARD.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
    let run = Run::new(&files);
    run.done("build yard.ovl --resolution 0.5");
    let render = "render plans.bin --layer spot/night --route 30,22 -o plan.svg";
    let text = run.run(&format!("{render} --chosen"), "");
    assert_eq!(text.status, 0, "{}", text.err);
    let said = format!("{}{}", text.out, text.err);
    assert!(said.contains("spot from (30, 22): comms ") && said.contains(", night "), "{said}");
    let found = texts(&run.path("plan.svg"));
    for text in ["route by layer comms", "route by layer night", "start"] {
        assert!(found.iter().any(|found| found == text), "{text} is missing in {found:?}");
    }
    // Without a start there is no route.
    assert_eq!(run.run("render plans.bin --chosen -o plan.svg", "").status, 2);
}
