//! Borders between the areas of several goals of one plan: beyond one, another goal costs less.

use super::palette::{BORDER, PAPER};
use super::stroke::{dashes, stroke};
use super::text;
use super::view::View;
use plan_format::{Cell, Layer, Step};
use std::fmt::Write;
use svg::node::element::Group;

/// Width of a border, units, and its dashes in widths.
const WIDTH_UNITS: f64 = 2.4;
const DASHES: [f64; 2] = [3.0, 1.5];

/// The borders of a layer as a path between cells, for one of several goals each.
pub(super) fn path(layer: &Layer<'_>, view: &View) -> String {
    let grid = &view.grid;
    let step = view.step();
    let goal = |column: u32, row: u32| {
        let cell = Cell::new(column, row);
        let is_led = matches!(layer.step(cell), Step::Move(_) | Step::Goal);
        is_led.then(|| layer.goal_number(cell))
    };
    let differ = |a: Option<u8>, b: Option<u8>| a.zip(b).is_some_and(|(a, b)| a != b);
    let [width, height] = view.cell();
    let at = |column: u32, row: u32| {
        let y = f64::from(view.map[1]) - f64::from(row) * height;
        [f64::from(column) * width, y].map(text::round)
    };
    let mut path = String::new();
    let mut edge = |from: [f64; 2], to: [f64; 2]| {
        // Writing to a string does not fail.
        let _ = write!(path, "M{} {}L{} {}", from[0], from[1], to[0], to[1]);
    };
    // Edges in a line are joined, so that their dashes go on.
    let runs = |across: u32, along: u32, steps: [u32; 2], is_edge: &dyn Fn(u32, u32) -> bool| {
        let mut found: Vec<[u32; 3]> = Vec::new();
        for line in (steps[0]..across).step_by(steps[0] as usize) {
            for cell in (0..along).step_by(steps[1] as usize) {
                if !is_edge(line, cell) {
                    continue;
                }
                match found.last_mut() {
                    Some([last, _, end]) if *last == line && *end == cell => *end += steps[1],
                    _ => found.push([line, cell, cell + steps[1]]),
                }
            }
        }
        found
    };
    let upright = |column: u32, row: u32| differ(goal(column - step[0], row), goal(column, row));
    for [column, low, high] in runs(grid.columns, grid.rows, step, &upright) {
        edge(at(column, low), at(column, high));
    }
    let level = |row: u32, column: u32| differ(goal(column, row - step[1]), goal(column, row));
    for [row, low, high] in runs(grid.rows, grid.columns, [step[1], step[0]], &level) {
        edge(at(low, row), at(high, row));
    }
    path
}

/// A border, on a light casing.
pub(super) fn line(path: String, unit: f64) -> Group {
    let width = WIDTH_UNITS * unit;
    let casing = stroke(path.clone(), PAPER, width + 2.0 * unit);
    let line = stroke(path, BORDER, width).set("stroke-dasharray", dashes(&DASHES, width));
    Group::new().add(casing).add(line)
}
