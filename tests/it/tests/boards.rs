//! Checks everything that repeats a part of the table of boards, `boards/table/boards.toml`, against it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use board_table::{BOARDS, Board, MACHINES, State};
use it::root;
use robot_io::Operator;
use robot_io::packet::{self, Uplink};

use crate::cli::Run;

/// The folders of boards below `boards/`, without that of the table's crate.
fn folders() -> BTreeSet<String> {
    let entries = fs::read_dir(root().join("boards")).expect("boards/ is readable");
    let folders = entries.map(|entry| entry.expect("an entry is readable").path());
    folders
        .filter(|path| path.join(".cargo/config.toml").is_file())
        .map(|path| path.file_name().unwrap_or_default().to_string_lossy().into_owned())
        .collect()
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The target that `cargo build` uses in a folder.
fn target(folder: &Path) -> String {
    let file = root().join(folder).join(".cargo/config.toml");
    let text = fs::read_to_string(file).expect("the folder has a configuration");
    let document = text.parse::<toml_edit::DocumentMut>().expect("it is TOML");
    document["build"]["target"].as_str().expect("it names a target").to_owned()
}

/// An address as the documents write it: `0x000C_0000`.
fn address(address: u32) -> String {
    format!("`0x{:04X}_{:04X}`", address >> 16, address & 0xFFFF)
}

/// The board's row in the table of `boards/README.md`.
fn row(board: &Board) -> String {
    let Board { name, chip, target, memory, erase_bytes, state, .. } = board;
    let (folder, state) = match state {
        State::Planned => (format!("`{name}`"), "plans only: there is **no firmware** yet"),
        State::Built => {
            (format!("[`{name}`]({name})"), "built and linked in CI, **not tried on hardware**")
        }
        State::Tried => (format!("[`{name}`]({name})"), "built and linked in CI, drove a robot"),
    };
    format!(
        "| {folder} | {chip} | `{target}` | {}, {} KiB | {}, {} KiB | {} KiB | {} KiB | {state} |",
        address(memory.program.address),
        memory.program.bytes >> 10,
        address(memory.plans.address),
        memory.plans.bytes >> 10,
        erase_bytes >> 10,
        memory.ram.bytes >> 10,
    )
}

#[test]
fn only_boards_with_firmware_have_a_folder() {
    let built = BOARDS.iter().filter(|board| board.state.has_firmware());
    assert_eq!(folders(), built.map(|board| board.name.clone()).collect());
}

#[test]
fn every_folder_builds_for_the_target_of_its_row() {
    for board in BOARDS.iter().filter(|board| board.state.has_firmware()) {
        let folder = Path::new("boards").join(&board.name);
        assert_eq!(target(&folder), board.target, "{}", board.name);
    }
    // The guest's own configuration names one of its machines.
    let guest = target(Path::new("qemu/guest"));
    assert!(MACHINES.iter().any(|machine| machine.target == guest), "{guest}");
}

#[test]
fn the_readme_of_the_boards_has_exactly_the_rows_of_the_table() {
    let readme = read("boards/README.md");
    let expected: Vec<String> = BOARDS.iter().map(row).collect();
    let rows = readme.lines().skip_while(|line| !line.starts_with("| folder |")).skip(2);
    let rows: Vec<&str> = rows.take_while(|line| line.starts_with('|')).collect();
    assert_eq!(rows, expected, "the rows must be:\n{}", expected.join("\n"));
}

#[test]
fn the_readme_names_every_board_with_firmware() {
    let readme = read("README.md");
    let shipped = readme.lines().find(|line| line.starts_with("Firmware ships for"));
    let shipped = shipped.expect("the README names the boards with firmware");
    for board in BOARDS.iter() {
        let is_named = shipped.contains(&format!("`{}`", board.name));
        assert_eq!(is_named, board.state.has_firmware(), "{}: {shipped}", board.name);
    }
}

#[test]
fn help_lists_every_board_and_marks_those_without_firmware() {
    let help = Run::new(&[]).done("build --help");
    let (_, after) = help.split_once("--board <NAME>").expect("the help has the option");
    let lines = after.lines().map(str::trim);
    let lines =
        lines.skip_while(|line| !line.starts_with("- ")).take_while(|line| !line.is_empty());
    let listed: Vec<(&str, bool)> = lines
        .filter_map(|line| line.strip_prefix("- ")?.split_once(':'))
        .map(|(name, help)| (name, !help.contains("no firmware yet")))
        .collect();
    let expected = BOARDS.iter().map(|board| (&*board.name, board.state.has_firmware()));
    assert_eq!(listed, expected.collect::<Vec<_>>(), "{help}");
}

/// A kit has GPS, link, arm button and two wheels.
#[test]
fn what_a_mission_needs_and_a_board_lacks_is_a_warning() {
    const MAP: &str = "type octile\nheight 2\nwidth 3\nmap\n...\n...\n";
    let glebe = root().join("tests/maps/glebe.mission.toml");
    let glebe = glebe.to_str().expect("the path is Unicode");
    for (mission, expected) in [
        ("", &[][..]),
        ("base_speed = 0.51", &[]),
        ("base_speed = 0.5", &["reads no compass", "creeps faster to find it again"]),
        ("max_speed = 0.5", &["reads no compass", "never finds it"]),
        ("may_creep = false", &["reads no compass", "never finds it"]),
        ("steering = \"boat\"", &["drives two wheels only: `vehicle.steering`"]),
        ("[ranges]\nrequired = true", &["reads no ranges: `ranges.required`"]),
        ("[battery]\nlow = 0.5", &["reads no inputs: `battery.low`"]),
        (
            glebe,
            &[
                "nothing gives `level` a value",
                "sets no outputs: actions of the mission that set one have no effect (2)",
            ],
        ),
    ] {
        let text = format!("map = \"a.map\"\n[goals]\ngate = [0.5, 0.5]\n[vehicle]\n{mission}\n");
        let run = Run::new(&[("a.map", MAP.as_bytes()), ("a.mission.toml", text.as_bytes())]);
        let file = if mission == glebe { glebe } else { "a.mission.toml" };
        let ended = run.run(&format!("build {file} --board pico2 -o a.uf2"), "");
        let words = ended.err.split_whitespace().filter(|word| *word != "│");
        let said = words.collect::<Vec<_>>().join(" ");
        assert_eq!(
            (ended.status, said.contains("the firmware of")),
            (0, !expected.is_empty()),
            "{said}"
        );
        for words in expected {
            assert!(said.contains(words), "{mission}: {said}");
        }
        let ended = run.run(&format!("build {file} -o a.bin"), "");
        assert!(!ended.err.contains("the firmware of"), "{mission}: {}", ended.err);
    }
}

#[test]
fn the_readme_shows_the_operators_packets() {
    let readme = read("boards/README.md");
    for (words, is_armed, is_emergency_stop) in
        [("disarmed", false, false), ("armed", true, false), ("emergency stop", true, true)]
    {
        let operator = Operator { is_armed, is_emergency_stop, manual: None };
        let packet = packet::encode(&Uplink::Operator(operator)).expect("it is short");
        let bytes: Vec<_> = packet.iter().map(|byte| format!("{byte:02x}")).collect();
        let row = format!("| {words} | `{}` |", bytes.join(" "));
        assert!(readme.contains(&row), "boards/README.md lacks the row\n{row}");
    }
}

#[test]
fn the_licences_of_every_target_are_checked() {
    let deny = read("deny.toml");
    let targets = BOARDS.iter().map(|board| &board.target);
    for target in targets.chain(MACHINES.iter().map(|machine| &machine.target)) {
        assert!(deny.contains(&format!("\"{target}\",")), "deny.toml does not list {target}");
    }
}
