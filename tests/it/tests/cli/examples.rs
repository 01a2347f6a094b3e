//! Every command in the README and in `--help` works as written, from the project's folder.

use super::Run;
use std::fs;

/// A folder with the shipped maps where the commands look for them.
fn clone() -> Run {
    let run = Run::new(&[]);
    let maps = run.path("tests/maps");
    fs::create_dir_all(&maps).unwrap();
    for entry in fs::read_dir(it::root().join("tests/maps")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, maps.join(path.file_name().unwrap())).unwrap();
    }
    run
}

/// Runs the commands of a text, which follow a prompt, and returns their number.
fn run_all(run: &Run, text: &str, prompt: &str) -> usize {
    // A command may go on in the next line.
    let text = text.replace("\\\n", " ");
    let commands =
        text.lines().filter_map(|line| line.strip_prefix(prompt)?.strip_prefix("plan-compiler "));
    // A comment may follow.
    let commands = commands.map(|line| line.split(" #").next().unwrap_or(line).trim());
    let commands: Vec<&str> = commands.collect();
    for command in &commands {
        run.done(command);
    }
    commands.len()
}

#[test]
fn the_readme_shows_commands_that_work() {
    let run = clone();
    let readme = fs::read_to_string(it::root().join("README.md")).unwrap();
    // Recording a trace takes minutes in a debug build, so `runs` tests it.
    let readme: String =
        readme.lines().filter(|line| !line.contains(".trace")).map(|l| format!("{l}\n")).collect();
    assert!(run_all(&run, &readme, "$ ") >= 6);
    let shown = readme.lines().find(|line| line.starts_with("{\"x\":-26.0")).unwrap();
    run.done("build tests/maps/yard.osm --goal gate=-17.5,17.5 -o plans.bin");
    assert_eq!(run.done("query plans.bin --layer gate/physical --at -26,-18").trim(), shown);
}

#[test]
fn help_shows_commands_that_work() {
    let run = clone();
    let help = run.done("--help");
    assert!(run_all(&run, &help, "  ") >= 12, "{help}");
    let help = run.done("comms --help");
    assert!(run_all(&run, &help, "  ") >= 3, "{help}");
    let help = run.done("convert --help");
    assert!(run_all(&run, &help, "  ") >= 3, "{help}");
    for name in
        ["plans.bin", "plans.hex", "cost.npy", "field.png", "routes.png", "reach.svg", "Iplan.dat"]
    {
        assert!(run.path(name).exists(), "{name}");
    }
}
