//! Roots, handed from cell to cell outwards from the goal.
//!
//! A cell takes the root of a neighbour that its optimal moves lead to, if from the cell too the
//! way to that root is as short as without obstacles; else that neighbour becomes a root. Cells
//! are visited in buckets of cost one straight step wide: no step is shorter, so inside a bucket
//! no cell leads to another and their order does not matter. That takes linear time.

use super::moves::Bordered;
use crate::field::{Field, GOAL, UNREACHED};
use crate::grid::{Cell, Direction, STRAIGHT_STEP};
use crate::layer::Root;
use std::collections::HashMap;

/// The number of no root.
pub(crate) const NO_ROOT: u32 = u32::MAX;

/// The roots of a field.
pub(crate) struct Roots {
    /// By their numbers.
    pub(crate) roots: Vec<Root>,
    /// The number of each cell's root, bordered as [`Bordered`].
    pub(crate) of_cell: Vec<u32>,
}

/// How a cell may refer to a root: bit 0 diagonal steps first, bit 1 straight steps first.
/// 0 if it may not.
#[inline]
pub(crate) fn ways(root: Root, cell: Cell, cost: u32, moves: u8) -> u8 {
    if root.cost_from(cell) != cost {
        return 0;
    }
    let allowed = |straight_first| match root.direction_from(cell, straight_first) {
        Some(direction) => moves >> direction.code() & 1,
        None => u8::from(cost == 0),
    };
    let columns = root.cell.column.abs_diff(cell.column);
    let rows = root.cell.row.abs_diff(cell.row);
    // Where only one of straight and diagonal steps is needed, both ways are the same.
    if columns == 0 || rows == 0 || columns == rows {
        return 3 * allowed(false);
    }
    allowed(false) | allowed(true) << 1
}

impl Roots {
    pub(crate) fn new(field: &Field, bordered: &Bordered) -> Self {
        let mut this = Self { roots: Vec::new(), of_cell: vec![NO_ROOT; bordered.cost.len()] };
        let mut root_at = HashMap::new();
        for (cell, _) in field.code.iter().enumerate().filter(|&(_, &code)| code == GOAL) {
            let columns = field.columns as usize;
            let index = bordered.index(cell % columns, cell / columns);
            if bordered.cost.get(index) == Some(&0) {
                this.of_cell[index] = this.root_of(index, bordered, &mut root_at);
            }
        }
        for index in by_cost(bordered) {
            this.of_cell[index as usize] = this.choose(index as usize, bordered, &mut root_at);
        }
        this
    }

    fn choose(
        &mut self,
        index: usize,
        bordered: &Bordered,
        root_at: &mut HashMap<usize, u32>,
    ) -> u32 {
        let (column, row) = bordered.column_row(index);
        let cell = Cell::new(column, row);
        let (cost, moves) = (bordered.cost[index], bordered.moves[index]);
        // The lowest number is the oldest root, nearest to the goal, which most cells share.
        let mut best = NO_ROOT;
        let mut last = NO_ROOT;
        for direction in directions(moves) {
            let number = self.of_cell[bordered.neighbour(index, direction)];
            if number < best
                && number != last
                && ways(self.roots[number as usize], cell, cost, moves) != 0
            {
                best = number;
            }
            last = number;
        }
        if best != NO_ROOT {
            return best;
        }
        match directions(moves).next() {
            Some(direction) => {
                self.root_of(bordered.neighbour(index, direction), bordered, root_at)
            }
            None => NO_ROOT,
        }
    }

    /// The number of the root that stands at a cell, which becomes one if it is none.
    fn root_of(
        &mut self,
        index: usize,
        bordered: &Bordered,
        root_at: &mut HashMap<usize, u32>,
    ) -> u32 {
        *root_at.entry(index).or_insert_with(|| {
            let (column, row) = bordered.column_row(index);
            self.roots.push(Root { cell: Cell::new(column, row), cost: bordered.cost[index] });
            self.roots.len() as u32 - 1
        })
    }
}

/// The directions in a set of moves.
pub(crate) fn directions(moves: u8) -> impl Iterator<Item = Direction> {
    let mut left = moves;
    std::iter::from_fn(move || {
        (left != 0).then(|| {
            let code = left.trailing_zeros() as u8;
            left &= left - 1;
            Direction::from_code(code)
        })
    })
}

/// The cells that have moves, bucket by bucket.
fn by_cost(bordered: &Bordered) -> Vec<u32> {
    let bucket = |cost: u32| (cost / STRAIGHT_STEP) as usize;
    let routed = || {
        let cells = bordered.cost.iter().zip(&bordered.moves).enumerate();
        cells.filter(|&(_, (_, &moves))| moves != 0).map(|(index, (&cost, _))| (index, cost))
    };
    let buckets = routed().map(|(_, cost)| bucket(cost) + 1).max().unwrap_or(0);
    debug_assert!(buckets <= bucket(UNREACHED) + 1);
    let mut starts = vec![0u32; buckets + 1];
    for (_, cost) in routed() {
        starts[bucket(cost) + 1] += 1;
    }
    for next in 1..starts.len() {
        starts[next] += starts[next - 1];
    }
    let mut order = vec![0; starts.last().map_or(0, |&count| count as usize)];
    for (index, cost) in routed() {
        let place = &mut starts[bucket(cost)];
        order[*place as usize] = index as u32;
        *place += 1;
    }
    order
}
