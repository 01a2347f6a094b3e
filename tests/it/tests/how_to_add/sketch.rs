//! Sketches: a line `sketch`, then rows from the north, `#` an obstacle, 1 m a cell.

use super::lines::Lines;
use crate::bitmap::Bitmap;
use crate::model::{CellMap, Map, Unknown};
use crate::problem::{Problem, Source};
use math::Cell;
use std::sync::Arc;

/// What `--help` says of this format.
pub const CONVENTIONS: &str = "\
Sketch   (.sketch) Cells of 1 m, the south-west corner at 0,0; rows come from the north.";

/// Whether a text is a sketch: its first line says so.
pub fn recognises(text: &str) -> bool {
    text.starts_with("sketch\n")
}

/// Reads a sketch, and every row that is shorter than the first.
pub fn read(source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let lines: Vec<_> = Lines::of(&source.text).skip(1).collect();
    let rows = u32::try_from(lines.len()).unwrap_or(0);
    let columns = lines.first().map_or(0, |line| line.len() as u32);
    if rows == 0 || columns == 0 {
        return (None, vec![Problem::error("the sketch has no cells")]);
    }
    let mut problems = Vec::new();
    let mut occupied = Bitmap::new(columns, rows);
    for (row, line) in (0..rows).rev().zip(lines) {
        if line.len() as u32 != columns {
            let problem = Problem::error(format!("a row is not of {columns} cells"));
            problems.push(problem.at(source, line.clone(), "this one"));
        }
        for (column, symbol) in (0..columns).zip(source.text[line].bytes()) {
            occupied.set(Cell::new(column, row), symbol == b'#');
        }
    }
    let cells = CellMap {
        resolution_m: 1.0,
        corner: [0.0; 2],
        occupied,
        unknown: Bitmap::new(columns, rows),
        unknown_as: Unknown::default(),
        turned_from: None,
    };
    (Some(Map::of_cells(cells)), problems)
}
