//! Follows "How to add" in the README: adds a schema, a map format and a board to a copy of the
//! project by the documented steps, and uses the result.
//!
//! Each step edits one file. A step fails if the README does not name its file or if it no longer
//! fits the code.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use harness::setup;
use it::root;

/// A copy of the project's sources, and the steps of the README to follow.
struct Tree {
    folder: tempfile::TempDir,
    steps: String,
}

impl Tree {
    /// Copies the project and reads the steps below the README's heading that begins with `part`.
    fn following(part: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        copy(root(), folder.path());
        let readme = fs::read_to_string(root().join("README.md")).expect("there is a README");
        let heading = format!("#### {part}");
        let (_, steps) = readme.split_once(&heading).expect("the README has this part");
        let end = steps.find("\n#").unwrap_or(steps.len());
        Self { folder, steps: steps[..end].to_owned() }
    }

    fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    /// Checks that the steps name a file or folder.
    fn step(&self, file: &str) {
        assert!(self.steps.contains(&format!("`{file}`")), "no step names {file}:\n{}", self.steps);
    }

    fn new_file(&self, file: &str, named: &str, text: &str) {
        self.step(named);
        fs::write(self.path(file), text).expect("the copy can be written");
    }

    fn edit(&self, file: &str, edits: &[(&str, &str)]) {
        self.step(file);
        let mut text = fs::read_to_string(self.path(file)).expect("a file of the project");
        for (after, insert) in edits {
            let at = text.find(after).unwrap_or_else(|| panic!("{file} has no {after:?}"));
            text.insert_str(at + after.len(), insert);
        }
        fs::write(self.path(file), text).expect("the copy can be written");
    }

    /// Repeats each line that contains one of the words `old`, with these replaced by `new`.
    fn beside(&self, file: &str, old: &[&str], new: &[&str]) {
        self.step(file);
        let text = fs::read_to_string(self.path(file)).expect("a file of the project");
        let mut lines = Vec::new();
        for line in text.lines() {
            lines.push(line.to_owned());
            if old.iter().any(|old| line.contains(old)) {
                let renamed = old
                    .iter()
                    .zip(new)
                    .fold(line.to_owned(), |line, (old, new)| line.replace(old, new));
                lines.push(renamed);
            }
        }
        fs::write(self.path(file), lines.join("\n") + "\n").expect("the copy can be written");
    }

    /// Runs cargo in the copy, with a separate build folder that is kept for the next run.
    fn cargo(&self, folder: &str, arguments: &[&str]) -> String {
        let target = setup::target_folder().join("how-to-add");
        let output = Command::new(env!("CARGO"))
            .args(arguments)
            .current_dir(self.path(folder))
            .env("CARGO_TARGET_DIR", target)
            // Optimisation and debug information would only slow the build down.
            .env("CARGO_PROFILE_DEV_OPT_LEVEL", "0")
            .env("CARGO_PROFILE_DEV_DEBUG", "0")
            .env_remove("RUSTFLAGS")
            .output()
            .expect("cargo runs");
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "cargo {arguments:?}:\n{errors}");
        String::from_utf8_lossy(&output.stdout).into_owned() + &errors
    }
}

/// Copies a folder, except build output and git's own folder.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("the copy can be written");
    for entry in fs::read_dir(from).expect("a folder is readable") {
        let entry = entry.expect("an entry is readable");
        let name = entry.file_name();
        if name == "target" || name == ".git" {
            continue;
        }
        let (from, to) = (entry.path(), to.join(&name));
        if from.is_dir() {
            copy(&from, &to);
        } else {
            fs::copy(from, to).expect("the copy can be written");
        }
    }
}

#[test]
fn a_schema_and_a_format_are_added_by_the_steps_of_the_readme() {
    let tree = Tree::following("A schema");
    tree.new_file(
        "firmware/schemas/src/head_east.rs",
        "firmware/schemas/src",
        include_str!("how_to_add/head_east.rs"),
    );
    tree.edit(
        "firmware/schemas/src/lib.rs",
        &[
            ("pub mod follow_plan;", "\npub mod head_east;"),
            ("pub use follow_plan::follow_plan;", "\npub use head_east::head_east;"),
        ],
    );
    tree.edit(
        "shared/plan-format/src/parameters.rs",
        &[
            ("pub avoid_gain: f32,", "\n    /// Gain of head-east.\n    pub east_gain: f32,"),
            ("avoid_gain: 1.0,", "\n                east_gain: 0.0,"),
            (
                "(\"schemas.avoid_gain\", self.schemas.avoid_gain, 0.0, 100.0),",
                "\n            (\"schemas.east_gain\", self.schemas.east_gain, 0.0, 100.0),",
            ),
        ],
    );
    tree.edit(
        "firmware/schemas/src/blend.rs",
        &[
            ("pub avoid: Vec2,", "\n    /// Of head-east.\n    pub east: Vec2,"),
            ("vectors.avoid * schemas.avoid_gain", " + vectors.east * schemas.east_gain"),
            ("avoid: Vec2::new(-0.5, 0.0),", "\n        east: Vec2::new(1.0, 0.0),"),
            ("avoid: -east * SATURATED,", " east,"),
            ("Vectors { goal, avoid,", " east: advice,"),
        ],
    );
    tree.edit(
        "firmware/controller/src/lib.rs",
        &[(
            "avoid: vector::rotated(repulsion.vector, aim.heading_rad),",
            "\n        east: schemas::head_east(),",
        )],
    );
    tree.edit(
        "plan-compiler/src/mission/keys.rs",
        &[(
            "|m, v| m.parameters.schemas.avoid_gain = v as f32,\n    ),",
            "\n    number(\n        \"schemas\",\n        \"east_gain\",\n        \"\",\n        \
             \"0.0\",\n        \"Gain of head-east.\",\n        \
             |m, v| m.parameters.schemas.east_gain = v as f32,\n    ),",
        )],
    );

    let format = Tree { steps: Tree::following("A map format").steps, ..tree };
    format.new_file(
        "plan-compiler/maps/src/formats/sketch.rs",
        "plan-compiler/maps/src/formats",
        include_str!("how_to_add/sketch.rs"),
    );
    let old = ["Movingai", "movingai", "MovingAI map", "\"map\""];
    let new = ["Sketch", "sketch", "sketch", "\"sketch\""];
    format.beside("plan-compiler/maps/src/formats.rs", &old[..], &new[..]);
    grow_the_list(&format.path("plan-compiler/maps/src/formats.rs"));
    format.edit(
        "plan-compiler/src/cli/help.rs",
        &[("movingai::CONVENTIONS,", "\n        sketch::CONVENTIONS,")],
    );
    // At the start of the list of imports.
    format.edit("plan-compiler/src/cli/help.rs", &[("use maps::formats::{", "sketch, ")]);

    // The schema: its golden vectors hold, and a mission can set its gain.
    let output = format.cargo("", &["test", "--package", "wayfield-schemas", "--lib"]);
    assert!(output.contains("head_east::tests::golden_vectors ... ok"), "{output}");
    // The format: map text in, field out.
    let map = format.path("yard.sketch");
    fs::write(&map, "sketch\n.....\n.###.\n.....\n").expect("a map is written");
    let mission = "[goals]\neast = [4.5, 0.5]\n[schemas]\neast_gain = 0.5\n";
    fs::write(format.path("yard.mission.toml"), mission).expect("a mission is written");
    let run = ["run", "--quiet", "--package", "wayfield-plan-compiler", "--"];
    let build = ["build", "yard.sketch", "--robot-radius", "0", "-o", "plans.bin"];
    format.cargo("", &[&run[..], &build[..]].concat());
    let query = ["query", "plans.bin", "--layer", "east/physical", "--at", "2.5,2.5"];
    let output = format.cargo("", &[&run[..], &query[..]].concat());
    // Two steps along the bar, then round its end without cutting the corner.
    assert!(output.contains("\"cost_m\":4,") || output.contains("\"cost_m\":4.0,"), "{output}");
}

/// Adds one to the length of the list of all formats.
fn grow_the_list(path: &Path) {
    let text = fs::read_to_string(path).expect("a file of the project");
    let (before, after) = text.split_once("ALL: [Self; ").expect("the list of formats");
    let (count, after) = after.split_once(']').expect("its length");
    let count: usize = count.parse().expect("its length");
    fs::write(path, format!("{before}ALL: [Self; {}]{after}", count + 1)).expect("it is written");
}

#[test]
fn a_board_is_added_by_the_steps_of_its_readme() {
    let steps = fs::read_to_string(root().join("boards/README.md")).expect("there is a README");
    let (_, steps) = steps.split_once("## Add a board").expect("it has the steps");
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy(root(), folder.path());
    let copied = Tree { folder, steps: steps.to_owned() };
    copy(&copied.path("boards/nrf52840-dk"), &copied.path("boards/my-rover"));
    copied.step("nrf52840-dk");
    for file in ["Cargo.toml", ".cargo/config.toml", "board.rs", "robot.rs"] {
        copied.step(file);
        let inside = if file.ends_with(".rs") { format!("src/{file}") } else { file.to_owned() };
        assert!(copied.path("boards/my-rover").join(inside).is_file(), "{file} is copied");
    }
    let manifest = copied.path("boards/my-rover/Cargo.toml");
    let text = fs::read_to_string(&manifest).expect("the manifest is copied");
    fs::write(&manifest, text.replace("nrf52840-dk", "my-rover")).expect("it is written");
    copied.step("table/boards.toml");
    let table = copied.path("boards/table/boards.toml");
    let text = fs::read_to_string(&table).expect("the table is copied");
    let row = text.split("\n\n").find(|row| row.starts_with("[board.nrf52840-dk]"));
    let row = row.expect("the board has a row").replace("nrf52840-dk", "my-rover");
    fs::write(&table, format!("{text}\n{row}\n")).expect("it is written");
    let config = fs::read_to_string(copied.path("boards/my-rover/.cargo/config.toml"));
    let config = config.expect("the folder's own target is copied");
    let target = config.split('"').nth(1).expect("it names a target").to_owned();
    setup::rust_target(&target).unwrap_or_else(|error| panic!("{error}"));
    copied.cargo("boards/my-rover", &["check", "--quiet", "--profile", "firmware"]);
}
