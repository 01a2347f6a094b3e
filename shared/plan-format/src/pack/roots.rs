//! Roots, handed from cell to cell outwards from the goal.
//!
//! A cell takes the root of a neighbour that its optimal moves lead to, if from the cell too the
//! way to that root is as short as without obstacles; else that neighbour becomes a root. What
//! leads by a root and is straight to the root's own root is straight to the root as well, so the
//! nearest root on a way serves at least the cells that any farther one does: only the nearest is
//! handed on, and the farther ones are found through it.
//!
//! Cells are visited in buckets of cost one straight step wide: no step is shorter, so inside a
//! bucket no cell leads to another and their order does not matter. That takes linear time.

use super::moves::Bordered;
use crate::field::{Field, GOAL, UNREACHED};
use crate::grid::{Cell, Direction, STRAIGHT_STEP};
use crate::layer::{Root, direction};

/// The number of no root.
pub(crate) const NO_ROOT: u32 = u32::MAX;

/// Where a root serves fewer cells than this, what they say by themselves takes hardly more bytes,
/// and is found in a fraction of the time. Noise of 20 % obstacles has a root for every six cells, a
/// maze for every three, noise of 5 % for every 25, and a city for every 500.
const CELLS_PER_ROOT: usize = 8;
/// That is looked at after so many cells each.
const LOOK: usize = 4_096;

/// The roots of a field.
pub(crate) struct Roots {
    /// By their numbers.
    pub(crate) roots: Vec<Root>,
    /// The root that each root had before it became one; [`NO_ROOT`] for a goal.
    pub(crate) parents: Vec<u32>,
    /// The number of each cell's root, a root's own for itself; bordered as [`Bordered`].
    pub(crate) of_cell: Vec<u32>,
}

/// Whether a cell may refer to a root.
#[inline]
fn serves(root: Root, cell: Cell, cost: u32, moves: u8) -> bool {
    let allowed = |straight_first| {
        direction(cell, root.cell, straight_first)
            .is_some_and(|direction| moves >> direction.code() & 1 == 1)
    };
    root.cost_from(cell) == cost && (allowed(false) || allowed(true))
}

impl Roots {
    pub(crate) fn new(field: &Field, bordered: &Bordered) -> Self {
        let of_cell = vec![NO_ROOT; bordered.cost.len()];
        let mut this = Self { roots: Vec::new(), parents: Vec::new(), of_cell };
        for (cell, _) in field.code.iter().enumerate().filter(|&(_, &code)| code == GOAL) {
            let columns = field.columns as usize;
            let index = bordered.index(cell % columns, cell / columns);
            if bordered.cost.get(index) == Some(&0) {
                this.make_root(index, bordered);
            }
        }
        for (visited, index) in by_cost(bordered).into_iter().enumerate() {
            this.of_cell[index as usize] = this.choose(index as usize, bordered);
            if visited % LOOK == LOOK - 1 && this.roots.len() * CELLS_PER_ROOT > visited {
                return Self::none(bordered);
            }
        }
        this
    }

    /// No roots at all.
    fn none(bordered: &Bordered) -> Self {
        let of_cell = vec![NO_ROOT; bordered.cost.len()];
        Self { roots: Vec::new(), parents: Vec::new(), of_cell }
    }

    fn choose(&mut self, index: usize, bordered: &Bordered) -> u32 {
        let (column, row) = bordered.column_row(index);
        let cell = Cell::new(column, row);
        let (cost, moves) = (bordered.cost[index], bordered.moves[index]);
        let (mut best, mut last) = (NO_ROOT, NO_ROOT);
        for direction in directions(moves) {
            let number = self.of_cell[bordered.neighbour(index, direction)];
            let is_better = best == NO_ROOT || number < best;
            if number != last
                && number != NO_ROOT
                && is_better
                && serves(self.roots[number as usize], cell, cost, moves)
            {
                best = number;
            }
            last = number;
        }
        if best != NO_ROOT {
            return best;
        }
        // Beside it may be a way of the same length that passes a root.
        for direction in Direction::ALL {
            let number = self.of_cell[bordered.neighbour(index, direction)];
            if number != NO_ROOT && serves(self.roots[number as usize], cell, cost, moves) {
                return number;
            }
        }
        match directions(moves).next() {
            Some(direction) => self.make_root(bordered.neighbour(index, direction), bordered),
            None => NO_ROOT,
        }
    }

    /// Makes a cell a root; its number.
    fn make_root(&mut self, index: usize, bordered: &Bordered) -> u32 {
        let (column, row) = bordered.column_row(index);
        let number = self.roots.len() as u32;
        self.roots.push(Root { cell: Cell::new(column, row), cost: bordered.cost[index] });
        self.parents.push(std::mem::replace(&mut self.of_cell[index], number));
        number
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
