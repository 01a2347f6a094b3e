//! An index of the parts of a world: which are near a point or along a ray.

use super::{Part, bounds};
use crate::Point;
use math::scalar::wide;

/// Smallest side of an index cell, metres. A range sensor reaches over a few such cells.
const CELL_M: f64 = 4.0;
/// Most index cells along the longer side; a larger world gets larger cells.
const MAX_SIDE_CELLS: f64 = 1024.0;

/// Square cells, each with the parts that cross it.
#[derive(Clone, Debug)]
pub(super) struct Index {
    corner: Point,
    cell_m: f64,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<u32>>,
}

impl Index {
    pub(super) fn new(parts: &[Part]) -> Self {
        let [low, high] = bounds(parts).unwrap_or_default();
        let longest = (high[0] - low[0]).max(high[1] - low[1]);
        let cell_m = CELL_M.max(longest / MAX_SIDE_CELLS);
        let count = |axis: usize| ((high[axis] - low[axis]) / cell_m) as usize + 1;
        let (columns, rows) = (count(0), count(1));
        let mut index =
            Self { corner: low, cell_m, columns, rows, cells: vec![Vec::new(); columns * rows] };
        for (number, part) in parts.iter().enumerate() {
            for cell in index.cells_of(part.bounds()) {
                // A long slanted segment misses most cells of its bounding box.
                if part.nearest(index.centre(cell)).distance_m <= cell_m {
                    index.cells[cell].push(number as u32);
                }
            }
        }
        index
    }

    fn column(&self, x: f64) -> f64 {
        wide::floor((x - self.corner[0]) / self.cell_m)
    }

    fn row(&self, y: f64) -> f64 {
        wide::floor((y - self.corner[1]) / self.cell_m)
    }

    fn centre(&self, cell: usize) -> Point {
        let at = |axis: usize, count: usize| self.corner[axis] + (count as f64 + 0.5) * self.cell_m;
        [at(0, cell % self.columns), at(1, cell / self.columns)]
    }

    /// The index cells that a box overlaps.
    fn cells_of(&self, [low, high]: [Point; 2]) -> impl Iterator<Item = usize> + use<> {
        let span = |from: f64, to: f64, count: usize| {
            (from.max(0.0) as usize)..((to + 1.0).clamp(0.0, count as f64) as usize)
        };
        let columns = span(self.column(low[0]), self.column(high[0]), self.columns);
        let rows = span(self.row(low[1]), self.row(high[1]), self.rows);
        let width = self.columns;
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    /// Calls `seen` for every part within a box, for some parts twice and for some outside.
    pub(super) fn within(&self, corners: [Point; 2], seen: &mut dyn FnMut(u32)) {
        for cell in self.cells_of(corners) {
            self.cells[cell].iter().for_each(|&part| seen(part));
        }
    }

    /// Walks the cells along a ray (Amanatides and Woo 1987). `seen` gets the parts of a cell and
    /// the distance along the ray where the cell ends, and returns whether to continue.
    pub(super) fn walk(
        &self,
        from: Point,
        along: Point,
        most_m: f64,
        seen: &mut dyn FnMut(&[u32], f64) -> bool,
    ) {
        let mut cell = [self.column(from[0]), self.row(from[1])];
        let mut next = [f64::INFINITY; 2];
        for axis in 0..2 {
            if along[axis] != 0.0 {
                let edge = cell[axis] + if along[axis] > 0.0 { 1.0 } else { 0.0 };
                let edge_m = self.corner[axis] + edge * self.cell_m;
                next[axis] = (edge_m - from[axis]) / along[axis];
            }
        }
        let mut entered = 0.0;
        while entered <= most_m {
            let axis = usize::from(next[1] < next[0]);
            if let Some(parts) = self.parts_at(cell)
                && !seen(parts, next[axis])
            {
                return;
            }
            entered = next[axis];
            cell[axis] += along[axis].signum();
            next[axis] += self.cell_m / along[axis].abs();
        }
    }

    fn parts_at(&self, [column, row]: Point) -> Option<&[u32]> {
        let inside =
            column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        inside.then(|| self.cells[row as usize * self.columns + column as usize].as_slice())
    }
}
