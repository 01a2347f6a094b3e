//! Sketches: a line `sketch`, then rows from the north; `#` is an obstacle, and a cell is 1 m.

use super::lines::Lines;
use crate::bitmap::Bitmap;
use crate::model::{CellMap, Map, Unknown};
use crate::problem::{Problem, Source};
use math::Cell;
use std::sync::Arc;

/// The help on this format.
pub const CONVENTIONS: &str = "\
Sketch   (.sketch) Cells of 1 m, the south-west corner at 0,0; rows from the north.";

/// Whether a text is a sketch, by its first line.
pub fn recognises(text: &str) -> bool {
    text.starts_with("sketch\n")
}

/// Reads a sketch, and reports every row with another length than the first.
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
            let problem = Problem::error(format!("a row does not have {columns} cells"));
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
