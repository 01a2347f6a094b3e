//! Roots, handed from cell to cell outwards from the goal.
//!
//! A cell takes the root of a neighbour on one of its optimal moves, if the cell's route to that
//! root is also as short as without obstacles; otherwise that neighbour becomes a root. If a route
//! passes a root and is straight to the root's own root, it is straight to the root as well. So the
//! nearest root on a route serves at least the cells that any farther root serves: only the nearest
//! is passed on, and the farther ones are its ancestors.
//!
//! Cells are visited in cost buckets as wide as one straight step. No step is shorter, so no cell
//! of a bucket leads to another of the same bucket and their order does not matter. This takes
//! linear time.

use super::moves::Bordered;
use crate::field::{Field, GOAL, UNREACHED};
use plan_format::grid::{Cell, Direction, STRAIGHT_STEP};
use plan_format::layout::{Root, first_step};
use std::ops::Range;

/// Sentinel: no root.
pub(crate) const NO_ROOT: u32 = u32::MAX;

/// If roots serve fewer cells than this on average, own cells take hardly more bytes and a fraction
/// of the time. Noise with 20 % obstacles has a root per 6 cells, a maze per 3, noise with 5 % per
/// 25, and a city per 500.
const CELLS_PER_ROOT: usize = 8;
/// Cells between two checks of that ratio.
const CHECK_INTERVAL_CELLS: usize = 4_096;

/// The roots of a field.
pub(crate) struct Roots {
    /// The roots by number.
    pub(crate) roots: Vec<Root>,
    /// The root that each root's cell had before it became a root; [`NO_ROOT`] for a goal.
    pub(crate) parents: Vec<u32>,
    /// The number of each cell's root; a root has its own number. Indexed as in [`Bordered`].
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
        // A neighbour that is not on an optimal move may have a root that serves the cell.
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

    /// Makes a cell a root and returns its number.
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

/// A cost at the end of a bucket with enough cells below it to decide whether roots pay, so that
/// not all cells have to be sorted first.
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

/// The cells with moves and a cost in a range, bucket by bucket, as [words](Cell::to_word).
#[inline(always)]
pub(crate) fn by_cost(bordered: &Bordered, range: Range<u32>) -> Vec<u32> {
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

/// Calls `act` with each cell that has moves and a cost in a range. Most ranges contain few or most
/// cells of a row, so 32 cells are skipped at a time.
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
