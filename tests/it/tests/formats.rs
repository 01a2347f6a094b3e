//! Map formats, read by the built binary: the tests compare cells and answers.

mod damaged;
mod field;
mod field_grids;
mod globe;
mod grids;
mod masks;

use crate::cli::Run;

/// The blocked cells of a layer as text: `#` blocked, north up.
fn picture(run: &Run, layer: &str) -> String {
    run.done(&format!("export plans.bin --layer {layer} --what blocked -o blocked.csv"));
    let text = std::fs::read_to_string(run.path("blocked.csv")).expect("an export");
    let row = |line: &str| {
        let cells = line.split(',').map(|cell| match cell.trim() {
            "0" => '.',
            "1" => '#',
            other => panic!("{other}"),
        });
        cells.collect::<String>() + "\n"
    };
    text.lines().rev().map(row).collect()
}

/// The output of `inspect`.
fn inspected(run: &Run) -> serde_json::Value {
    serde_json::from_str(&run.done("inspect plans.bin --json")).expect("JSON")
}
