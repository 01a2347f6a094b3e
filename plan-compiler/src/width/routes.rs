//! How many routes pass each cell.

use crate::field::{Field, GOAL, advised};
use plan_format::{Cell, Direction};

/// The routes of a field: one from each cell that has one.
pub(super) struct Routes<'f> {
    field: &'f Field,
    /// What each direction adds to the index of a cell.
    steps: [isize; 8],
    /// Routes through each cell, its own included.
    through: Vec<u32>,
    /// Number of all routes.
    all: u32,
}

/// A cell whose routes have been passed on.
const DONE: u8 = u8::MAX;

impl<'f> Routes<'f> {
    /// Counts the routes through every cell. Cells whose advice leads in a circle, as in a damaged
    /// blob, are left out.
    pub(super) fn count(field: &'f Field) -> Self {
        let columns = field.columns as isize;
        let steps = Direction::ALL.map(|direction| {
            let (dx, dy) = direction.step();
            dy as isize * columns + dx as isize
        });
        let mut routes = Self { field, steps, through: vec![0; field.code.len()], all: 0 };
        // Neighbours whose routes have not arrived yet.
        let mut waiting = vec![0_u8; field.code.len()];
        for index in 0..field.code.len() {
            if let Some(next) = routes.next(index) {
                waiting[next] += 1;
            }
            if routes.has_route(index) {
                routes.through[index] = 1;
                routes.all += 1;
            }
        }
        for start in 0..field.code.len() {
            let mut index = start;
            while waiting[index] == 0 {
                waiting[index] = DONE;
                let Some(next) = routes.next(index) else { break };
                routes.through[next] = routes.through[next].saturating_add(routes.through[index]);
                waiting[next] -= 1;
                index = next;
            }
        }
        routes
    }

    fn has_route(&self, index: usize) -> bool {
        self.field.code.get(index).is_some_and(|&code| advised(code).is_some() || code == GOAL)
    }

    /// The cell that the advice of a cell leads to.
    pub(super) fn next(&self, index: usize) -> Option<usize> {
        let direction = advised(*self.field.code.get(index)?)?;
        // Advice never leads off the grid, except in a damaged blob.
        let next = index.checked_add_signed(self.steps[direction.code() as usize])?;
        (next < self.field.code.len()).then_some(next)
    }

    /// The cells with at least one in `part` of all routes, in the order of their indices.
    pub(super) fn trunk(&self, part: u32) -> Vec<usize> {
        let least = self.all.div_ceil(part).max(1);
        let cells = self.through.iter().enumerate();
        cells.filter(|&(_, &through)| through >= least).map(|(index, _)| index).collect()
    }

    /// The share of all routes that pass a cell.
    pub(super) fn share_through(&self, index: usize) -> f64 {
        let through = self.through.get(index).copied().unwrap_or(0);
        f64::from(through) / f64::from(self.all.max(1))
    }

    /// The share of all routes that cross the line between two cells.
    pub(super) fn share_across(&self, ends: [Cell; 2]) -> f64 {
        let columns = self.field.columns as usize;
        let index = |cell: Cell| cell.row as usize * columns + cell.column as usize;
        let mut line: Vec<usize> = line(ends).map(index).collect();
        line.sort_unstable();
        // A route is counted where it leaves the line.
        let leaves = |&&index: &&usize| {
            self.next(index).is_some_and(|next| line.binary_search(&next).is_err())
        };
        line.iter().filter(leaves).map(|&index| self.share_through(index)).sum()
    }
}

/// The cells of a line without diagonal steps, so that no diagonal step of a route crosses it
/// between two cells.
fn line([from, to]: [Cell; 2]) -> impl Iterator<Item = Cell> {
    let (dx, dy) = (from.column.abs_diff(to.column), from.row.abs_diff(to.row));
    let mut done = [0_u64; 2];
    let towards = |from: u32, to: u32, steps: u64| {
        if to >= from { from + steps as u32 } else { from - steps as u32 }
    };
    (0..=dx + dy).map(move |_| {
        let cell =
            Cell::new(towards(from.column, to.column, done[0]), towards(from.row, to.row, done[1]));
        // The axis whose next step lies nearer along the line.
        let is_along_x = (1 + 2 * done[0]) * u64::from(dy) < (1 + 2 * done[1]) * u64::from(dx);
        done[usize::from(!is_along_x)] += 1;
        cell
    })
}
