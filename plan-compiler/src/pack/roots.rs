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
use plan_format::grid::{Cell, Direction, STRAIGHT_STEP};
use plan_format::layout::{Root, first_step};
use std::ops::Range;

/// Sentinel: no root.
pub(crate) const NO_ROOT: u32 = u32::MAX;

/// Where a root serves fewer cells than this, what they say by themselves takes hardly more bytes,
/// and is found in a fraction of the time. Noise of 20 % obstacles has a root for every six cells, a
/// maze for every three, noise of 5 % for every 25, and a city for every 500.
const CELLS_PER_ROOT: usize = 8;
/// Cells between two checks of that ratio.
const CHECK_INTERVAL_CELLS: usize = 4_096;

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
#[inline(always)]
fn serves(root: Root, cell: Cell, cost: u32, moves: u8) -> bool {
    let allowed = |straight_first| {
        first_step(cell, root.cell, straight_first)
            .is_some_and(|direction| moves >> direction.code() & 1 == 1)
    };
    root.cost_from(cell) == cost && (allowed(false) || allowed(true))
}

impl Roots {
    #[inline(always)]
    pub(crate) fn new(field: &Field, bordered: &Bordered) -> Self {
        let of_cell = vec![NO_ROOT; bordered.cost.len()];
        let mut this = Self { roots: Vec::new(), parents: Vec::new(), of_cell };
        for (row, codes) in (0..field.rows).zip(field.code.chunks(field.columns.max(1) as usize)) {
            if !codes.contains(&GOAL) {
                continue;
            }
            for (column, _) in (0..).zip(codes).filter(|&(_, &code)| code == GOAL) {
                let goal = Cell::new(column, row);
                if bordered.cost.get(bordered.index_of(goal)) == Some(&0) {
                    this.make_root(goal, bordered);
                }
            }
        }
        let near = near(bordered);
        let mut visited = 0;
        for costs in [0..near, near..UNREACHED] {
            for cell in by_cost(bordered, costs).into_iter().map(Cell::of_word) {
                this.of_cell[bordered.index_of(cell)] = this.choose(cell, bordered);
                visited += 1;
                if visited % CHECK_INTERVAL_CELLS == 0
                    && this.roots.len() * CELLS_PER_ROOT > visited
                {
                    this.roots.clear();
                    this.parents.clear();
                    return this;
                }
            }
        }
        this
    }

    #[inline(always)]
    fn choose(&mut self, cell: Cell, bordered: &Bordered) -> u32 {
        let index = bordered.index_of(cell);
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
            Some(direction) => {
                let (dx, dy) = direction.step();
                let column = cell.column.wrapping_add_signed(dx);
                let row = cell.row.wrapping_add_signed(dy);
                self.make_root(Cell::new(column, row), bordered)
            }
            None => NO_ROOT,
        }
    }

    /// Makes a cell a root; its number.
    fn make_root(&mut self, cell: Cell, bordered: &Bordered) -> u32 {
        let index = bordered.index_of(cell);
        let number = self.roots.len() as u32;
        self.roots.push(Root { cell, cost: bordered.cost[index] });
        self.parents.push(std::mem::replace(&mut self.of_cell[index], number));
        number
    }
}

/// The directions in a set of moves.
#[inline(always)]
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

/// A cost, at the end of a bucket, below which enough cells lie to see whether roots pay. Else all
/// cells would have to be put in order first.
#[inline(always)]
fn near(bordered: &Bordered) -> u32 {
    let mut near = 32 * STRAIGHT_STEP;
    let is_enough = |near: u32| {
        let cells = bordered.cost.iter().zip(&bordered.moves);
        let count: u32 = cells.map(|(&cost, &moves)| u32::from((cost < near) & (moves != 0))).sum();
        count as usize > CHECK_INTERVAL_CELLS
    };
    while near < UNREACHED / 2 && !is_enough(near) {
        near *= 2;
    }
    near
}

/// The cells that have moves and costs in a range, bucket by bucket: [words](Cell::to_word).
#[inline(always)]
fn by_cost(bordered: &Bordered, range: Range<u32>) -> Vec<u32> {
    let first = range.start / STRAIGHT_STEP;
    let bucket = |cost: u32| (cost / STRAIGHT_STEP - first) as usize;
    let mut counts: Vec<u32> = Vec::new();
    each(bordered, &range, |_, cost| {
        let bucket = bucket(cost);
        if bucket >= counts.len() {
            counts.resize(bucket + 1, 0);
        }
        counts[bucket] += 1;
    });
    let mut total = 0;
    for count in &mut counts {
        total += std::mem::replace(count, total);
    }
    let mut order = vec![0; total as usize];
    each(bordered, &range, |cell, cost| {
        let place = &mut counts[bucket(cost)];
        order[*place as usize] = cell.to_word();
        *place += 1;
    });
    order
}

/// Calls `act` with each cell that has moves and a cost in a range. Most ranges hold few cells of a
/// row or most, so a run of 32 is passed over at once.
#[inline(always)]
fn each(bordered: &Bordered, range: &Range<u32>, mut act: impl FnMut(Cell, u32)) {
    const MANY: usize = 32;
    let is_one = |cost: u32, moves: u8| (moves != 0) & (range.start <= cost) & (cost < range.end);
    for row in 0..bordered.rows() {
        let start = bordered.index(0, row);
        let cells = start..start + bordered.columns();
        let costs = bordered.cost[cells.clone()].chunks(MANY);
        let moves = bordered.moves[cells].chunks(MANY);
        for ((costs, moves), column) in costs.zip(moves).zip((0..).step_by(MANY)) {
            let mut any = false;
            for (&cost, &moves) in costs.iter().zip(moves) {
                any |= is_one(cost, moves);
            }
            if any {
                for ((&cost, &moves), column) in costs.iter().zip(moves).zip(column..) {
                    if is_one(cost, moves) {
                        act(Cell::new(column, row as u32), cost);
                    }
                }
            }
        }
    }
}
