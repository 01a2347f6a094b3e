//! `plan-compiler convert` as a user runs it: maps, blobs and MissionLab's Iplan.dat, one into
//! the other and back.
//!
//! Its error messages are in `tests/golden/errors`, beside those of the other commands.

use maps::Map;
use maps::formats::iplan;
use maps::problem::Source;
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::Mission;
use plan_format::Blob;
use proptest::bool::weighted;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use tempfile::TempDir;

/// A yard of 6 m by 4 m; the goals of a plan for it lie on both sides of a tree.
const YARD: &str = "type octile\nheight 4\nwidth 6\nmap\n......\n..TT..\n..T...\n......\n";
const PLAN: &str = "BEGIN_PLAN\nP\nyard.map\nORDERED\nFALSE\n<0.5,0.5>\n1\nMOVETO\n1\n<4.5,2.5>\n";

/// The binary in a new folder.
struct Run {
    folder: TempDir,
}

impl Run {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Exit status and messages.
    fn run(&self, arguments: &str) -> (i32, String) {
        let output = Command::new(harness::setup::plan_compiler().unwrap())
            .args(arguments.split(' '))
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    }

    fn done(&self, arguments: &str) {
        let (status, said) = self.run(arguments);
        assert_eq!(status, 0, "{arguments}\n{said}");
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// Checks that a mistake ends with status 1, reports the message of the golden file, and leaves every
/// file unchanged, whether the output existed or not.
fn check(name: &str, files: &[(&str, &str)], arguments: &str, output: &str) {
    for output_exists in [false, true] {
        let run = Run::new(files);
        if output_exists && !run.path(output).exists() {
            fs::write(run.path(output), "before").unwrap();
        }
        let before = (run.names(), fs::read(run.path(output)).ok());
        let (status, said) = run.run(arguments);
        assert_eq!(status, 1, "{name}\n{said}");
        assert_eq!((run.names(), fs::read(run.path(output)).ok()), before, "{name}");
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path(it::root().canonicalize().unwrap().join("tests/golden/errors"));
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.set_description(format!("plan-compiler {arguments}"));
        settings.bind(|| insta::assert_snapshot!(name, said));
    }
}

/// The yard with its plan, as Iplan.dat.
fn iplan() -> String {
    let run = Run::new(&[("yard.map", YARD), ("yard.pcf", PLAN)]);
    run.done("convert yard.pcf -o Iplan.dat");
    run.text("Iplan.dat")
}

#[test]
fn a_map_becomes_an_iplan() {
    let text = iplan();
    let (header, map) = text.split_once("BEGIN_MAP\n").unwrap();
    assert_eq!(header, "yard\nyard.pcf\nORDERED\nFALSE\nTEXT\n1\n");
    let (contingency, rest) = map.split_once("END_MAP\n").unwrap();
    // Six columns of four values, each from the south.
    let values = "\
        0 1 2 3  1 1.414 2.414 3.414  2 9998 9998 4.414  3 4 9998 5.414  \
        4 4.414 5.414 6.414  5 5.414 5.828 6.828";
    let values = values.split_whitespace().collect::<Vec<_>>().join("\n");
    let expected = format!("contingency/physical \n6 \n4 \n1 \n0 \n0 \n#Data\n{values}\n");
    assert_eq!(contingency, expected);
    assert!(rest.starts_with(
        "START_ELEMENT\nMOVETO\nBEGIN_MAP\nmoveto-1/physical \n6 \n4 \n1 \n4 \n2 \n#Data\n"
    ));
    assert!(rest.ends_with("END_MAP\nEND_FILE\n"));
    assert_eq!(rest.lines().count(), 10 + 24 + 2);
}

#[test]
fn an_iplan_there_and_back_is_the_same() {
    let run = Run::new(&[("Iplan.dat", &iplan())]);
    for corners in ["forbid", "allow"] {
        run.done(&format!("convert Iplan.dat --corners {corners} -o plans.bin"));
        run.done("convert plans.bin -o there.dat");
        run.done(&format!("convert there.dat --corners {corners} -o back.bin"));
        assert!(
            fs::read(run.path("plans.bin")).unwrap() == fs::read(run.path("back.bin")).unwrap()
        );
        let same = |text: &str| text.lines().skip(2).map(String::from).collect::<Vec<_>>();
        let is_same = same(&run.text("there.dat")) == same(&run.text("Iplan.dat"));
        assert_eq!(is_same, corners == "forbid", "costs round the tree differ by the rule");
    }
}

#[test]
fn a_blob_becomes_what_is_flashed_and_nothing_else_of_it_changes() {
    let run = Run::new(&[("yard.map", YARD)]);
    run.done("convert yard.map --goal gate=0.5,0.5 -o plans.bin");
    run.done("build yard.map --goal gate=0.5,0.5 -o built.bin");
    assert_eq!(fs::read(run.path("plans.bin")).unwrap(), fs::read(run.path("built.bin")).unwrap());
    run.done("convert plans.bin -o copy.BIN");
    assert_eq!(fs::read(run.path("plans.bin")).unwrap(), fs::read(run.path("copy.BIN")).unwrap());
    run.done("convert plans.bin --board nrf52840-dk -o plans.hex");
    run.done("build yard.map --goal gate=0.5,0.5 --board nrf52840-dk -o built.hex");
    assert_eq!(run.text("plans.hex"), run.text("built.hex"));
}

#[test]
fn what_an_iplan_cannot_say_is_told() {
    let overlay = "MISSION-AREA 4 4\nORIGIN 0 0\nCONTROL MEASURES:\nPP gate 1 1\n\
                   BOUNDARY NoCommZone 2 2  4 2  4 4  2 4\n";
    let run = Run::new(&[("yard.ovl", overlay)]);
    let (status, said) = run.run("convert yard.ovl --robot-radius 0 -o Iplan.dat");
    assert_eq!(status, 0, "{said}");
    insta::assert_snapshot!(said, @"
    ⚠ the obstacles of layer `gate/comms` differ from those of the first layer
    help: MissionLab reads a file whose maps have different obstacles, but `build` does not; a
          mission can choose the layers of its goals

    ☞ an Iplan.dat starts at 0,0: its positions are the map's minus 0.5,0.5
    ");
}

#[test]
fn the_command_line_is_checked() {
    let run = Run::new(&[("yard.map", YARD)]);
    run.done("convert yard.map --goal gate=0.5,0.5 -o plans.bin");
    for (arguments, said) in [
        ("convert yard.map -o plans.txt", "must end in .dat, .bin, .hex or .uf2"),
        ("convert yard.map -o plans", "must end in .dat, .bin, .hex or .uf2"),
        ("convert yard.map", "--output"),
        ("convert plans.bin -o plans.hex", "so name the board"),
        ("convert plans.bin --corners allow -o Iplan.dat", "with `build`"),
        ("convert plans.bin --goal a=1,1 -o Iplan.dat", "with `build`"),
        ("convert plans.bin --format iplan -o Iplan.dat", "with `build`"),
        ("convert plans.bin --unknown free -o Iplan.dat", "with `build`"),
        ("convert plans.bin --max-memory 1 -o Iplan.dat", "with `build`"),
    ] {
        let (status, err) = run.run(arguments);
        assert_eq!(status, 2, "{arguments}\n{err}");
        assert!(err.contains(said), "{arguments}\n{err}");
    }
}

#[test]
fn mistakes_are_told() {
    let plan = iplan();
    let at = plan.rfind("9998\n9998").unwrap();
    let other = format!("{}1{}", &plan[..at], &plan[at + 4..]);
    let wrong =
        plan.replacen("6 \n4 \n1 \n0 \n", "6 \n4 \n0 \n0 \n", 1).replacen("5.414", "far", 1);
    let wrong = wrong.replacen("MOVETO", "FLYTO", 1);
    for (name, text) in [
        ("iplan_wrong_in_several_ways", wrong.as_str()),
        ("iplan_of_different_obstacles", &other),
        ("iplan_cut_off", &plan[..plan.len() - 20]),
        ("iplan_of_floats", &plan.replace("TEXT", "FLOAT")),
    ] {
        check(name, &[("Iplan.dat", text)], "convert Iplan.dat -o plans.bin", "plans.bin");
    }
    for (name, files) in [
        ("pcf_without_its_map", &[("yard.pcf", PLAN)][..]),
        ("pcf_of_a_plan", &[("yard.pcf", PLAN), ("yard.map", PLAN)]),
        ("pcf_wrong_in_several_ways", &[("yard.map", YARD), ("yard.pcf", &PLAN.replace('<', "("))]),
    ] {
        check(name, files, "build yard.pcf", "plans.bin");
    }
    let files = [("yard.map", YARD), ("yard.pcf", PLAN)];
    check("pcf_onto_its_map", &files, "build yard.pcf -o yard.map", "yard.map");
    let files = [("Iplan.dat", plan.as_str())];
    check("convert_onto_itself", &files, "convert Iplan.dat -o ./Iplan.dat", "Iplan.dat");
    check("convert_a_missing_file", &files, "convert Iplam.dat -o plans.bin", "plans.bin");
    let damaged = [("plans.bin", "WAYFIELD and nothing else")];
    check("convert_a_damaged_blob", &damaged, "convert plans.bin -o Iplan.dat", "Iplan.dat");
    let hex = [("plans.hex", ":00000001FF\n")];
    check("convert_hex", &hex, "convert plans.hex -o Iplan.dat", "Iplan.dat");
    // A corridor there and back again, until its end is too far away.
    let rows = ["..", ".@"].map(|row| format!("{}{row}", ".".repeat(9_997)));
    let long = format!("type octile\nheight 2\nwidth 9999\nmap\n{}\n{}\n", rows[0], rows[1]);
    let arguments = "convert long.map --goal gate=0.5,0.5 -o Iplan.dat";
    check("convert_what_is_too_far", &[("long.map", &long)], arguments, "Iplan.dat");
}

/// An Iplan.dat with one goal and placeholders for the costs.
fn drawn(blocked: &[Vec<bool>], resolution: &str, goal: [f64; 2]) -> String {
    let (columns, rows, [x, y]) = (blocked.len(), blocked[0].len(), goal);
    let values =
        blocked.iter().flatten().map(|is_blocked| if *is_blocked { "9998\n" } else { "0\n" });
    let values: String = values.collect();
    let map = format!(
        "BEGIN_MAP\nm\n{columns}\n{rows}\n{resolution}\n{x}\n{y}\n#Data\n{values}END_MAP\n"
    );
    format!("p\nm.map\nORDERED\nFALSE\nTEXT\n0\n{map}END_FILE\n")
}

/// The map of an Iplan.dat, and the Iplan.dat written from its plans.
fn there_and_back(text: &str) -> (Map, String) {
    let source = Source { name: "Iplan.dat".into(), text: text.into() };
    let (map, mut problems) = iplan::read(&Arc::new(source));
    let map = map.unwrap();
    let input = Input {
        map: &map,
        source: None,
        mission: &Mission::default(),
        options: &Options::default(),
    };
    let blob = compile(&input, &|_, _| {}, &mut problems).unwrap();
    let blob = Blob::parse_exact(&blob).unwrap();
    assert!(plan_compiler::iplan::check(&blob).is_empty());
    let mut out = Vec::new();
    plan_compiler::iplan::write(&mut out, &blob, "plans.bin").unwrap();
    (map, String::from_utf8(out).unwrap())
}

proptest! {
    #[test]
    fn obstacles_goal_and_frame_survive(
        mut blocked in (1..9_usize, 1..9_usize)
            .prop_flat_map(|(x, y)| vec(vec(weighted(0.3), y), x)),
        resolution in select(vec!["0.1", "0.25", "0.333", "1", "3", "250"]),
        (part_x, part_y) in (0.0..1.0_f64, 0.0..1.0_f64),
    ) {
        let side: f64 = resolution.parse().unwrap();
        let sizes = [blocked.len(), blocked[0].len()].map(|cells| cells as f64);
        let cell = [(part_x * sizes[0]).floor(), (part_y * sizes[1]).floor()];
        blocked[cell[0] as usize][cell[1] as usize] = false;
        // A fifth of a cell away from the middle, to the micrometre.
        let goal = cell.map(|along| ((along + 0.2) * side * 1e6).round() / 1e6);
        let (map, text) = there_and_back(&drawn(&blocked, resolution, goal));
        let (again, same_text) = there_and_back(&text);
        prop_assert_eq!(&again.cells, &map.cells);
        prop_assert_eq!(again.points[0].at, goal);
        prop_assert_eq!(&again.points[0].name, "contingency");
        prop_assert_eq!(same_text, text);
    }
}

/// The lines that differ, with both texts.
fn differing<'t>(a: &'t str, b: &'t str) -> Vec<(usize, &'t str, &'t str)> {
    assert_eq!(a.lines().count(), b.lines().count());
    let lines = a.lines().zip(b.lines()).enumerate();
    lines.filter(|(_, (a, b))| a != b).map(|(index, (a, b))| (index + 1, a, b)).collect()
}

fn real(name: &str) -> Option<PathBuf> {
    it::real_data("missionlab").map(|folder| folder.join(name))
}

fn beside(run: &Run, file: &Path) -> String {
    let name = file.file_name().unwrap().to_str().unwrap().to_owned();
    fs::copy(file, run.path(&name)).unwrap();
    name
}

/// The historic program's queue overwrote the costs of some cells with worse ones. Only these and the
/// names differ, whether the new file comes from the obstacles or from a copy.
#[test]
fn the_historic_plan_comes_out_again_but_for_its_bug() {
    let Some(file) = real("Iplan.dat") else { return };
    let run = Run::new(&[]);
    beside(&run, &file);
    run.done("convert Iplan.dat --corners allow -o plans.bin");
    run.done("convert plans.bin -o copy.dat");
    let (original, copy) = (run.text("Iplan.dat"), run.text("copy.dat"));
    let lines = differing(&original, &copy);
    let is_name = |line: usize| [1, 2, 8, 48_419].contains(&line);
    assert_eq!(lines.iter().filter(|(line, ..)| is_name(*line)).count(), 4);
    let costs: Vec<_> = lines.iter().filter(|(line, ..)| !is_name(*line)).collect();
    let per_map = [7, 5];
    for ((map, count), range) in
        ["first", "second"].iter().zip(per_map).zip([15..48_415, 48_426..96_826])
    {
        assert_eq!(costs.iter().filter(|(line, ..)| range.contains(line)).count(), count, "{map}");
    }
    assert_eq!(costs.len(), 12);
    for (line, original, copy) in costs {
        let above = original.parse::<f64>().unwrap() - copy.parse::<f64>().unwrap();
        assert!((0.035..0.385).contains(&above), "line {line}: {original} and {copy}");
    }
    run.done("convert copy.dat --corners allow -o again.bin");
    assert!(fs::read(run.path("plans.bin")).unwrap() == fs::read(run.path("again.bin")).unwrap());
}

#[test]
fn the_historic_plan_file_names_a_map_that_must_lie_beside_it() {
    let Some(file) = real("FortBenningConfig-benning.pcf") else { return };
    let run = Run::new(&[]);
    let name = beside(&run, &file);
    let (status, said) = run.run(&format!("build {name}"));
    assert_eq!(status, 1);
    assert!(said.contains("there is no file FortBenningTracePoints.ovl"), "{said}");
    // Another map of the same place, under the name that is asked for.
    fs::copy(file.with_file_name("FortBenning-demo.ovl"), run.path("FortBenningTracePoints.ovl"))
        .unwrap();
    let (status, said) = run.run(&format!("build {name}"));
    assert_eq!(status, 0, "{said}");
    for goal in ["moveto-1 to (141, 104)", "contingency to (150, 128)"] {
        assert!(said.contains(goal), "{said}");
    }
}
