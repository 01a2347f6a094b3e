//! Uniform-cost search with buckets one step wide (Dial 1969; Denardo and Fox 1979).
//!
//! Why it is exact: a bucket contains the cells whose costs lie in one interval as wide as the
//! shortest step. No step from a cell of the bucket leads to a cost inside that interval, so every
//! cost is final when its bucket is opened, in whatever order its cells are taken. The longest step
//! is shorter than two intervals, so three buckets are enough at any time.
//!
//! Most moves need not be tried. A move is useless if the previous cell leads to the same place at a
//! lower cost, which depends on the move that led here and on the moves that are open here
//! ([`Pruning`]). Only strictly dearer ways are left out, so the result does not depend on which of
//! several equal ways reached a cell first.

use super::advice::Rows;
use super::open::{Passable, SIDE, moves};
use super::{Corners, MAX_COST, Vectors};
use crate::field::UNREACHED;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::{Cell, Direction};

const WIDTH: u32 = STRAIGHT_STEP;
const _: () = assert!(DIAGONAL_STEP < 2 * WIDTH, "three buckets are enough");

/// A route to a cell.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// The cell's index in row-major order.
    at: u32,
    cost: u32,
    /// The code of the last move, or [`START`].
    by: u8,
}

/// Stands for the move that led to a goal: none.
const START: u8 = 8;

/// Reusable buffers of the search.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    columns: usize,
    buckets: [Vec<Entry>; 3],
    /// For each cell, one bit for each open move.
    moves: Vec<u8>,
    cost: Vec<u32>,
}

impl Queue {
    /// Finds the cheapest routes to any of the goals, which are open cells.
    pub(crate) fn search(
        &mut self,
        open: &Passable,
        goals: &[Cell],
        corners: Corners,
        vectors: Vectors,
    ) {
        let columns = open.columns;
        let cells = columns * open.rows;
        self.columns = columns;
        self.cost.clear();
        self.cost.resize(cells, UNREACHED);
        self.moves.resize(cells, 0);
        vectors.run(Enter { open, corners, moves: &mut self.moves });
        self.buckets.iter_mut().for_each(Vec::clear);
        for goal in goals {
            let at = goal.row as usize * columns + goal.column as usize;
            self.cost[at] = 0;
            self.buckets[0].push(Entry { at: at as u32, cost: 0, by: START });
        }
        self.run(columns, corners);
    }

    /// Empties the buckets in order, starting with that of the goals.
    fn run(&mut self, columns: usize, corners: Corners) {
        let pruning = match corners {
            Corners::Forbid => &FORBID,
            Corners::Allow => &ALLOW,
        };
        let steps = Direction::ALL.map(|direction| {
            let (dx, dy) = direction.step();
            (columns as isize * dy as isize + dx as isize) as usize
        });
        let [mut now, mut next, mut later] = std::mem::take(&mut self.buckets);
        let mut limit = 2 * WIDTH;
        loop {
            for &Entry { at, cost, by } in &now {
                let at = at as usize;
                if self.cost[at] != cost {
                    continue;
                }
                let mut moves = pruning[usize::from(by)][usize::from(self.moves[at])];
                while moves != 0 {
                    let by = moves.trailing_zeros() as u8;
                    moves &= moves - 1;
                    let to = at.wrapping_add(steps[usize::from(by)]);
                    let cost =
                        cost + if by.is_multiple_of(2) { STRAIGHT_STEP } else { DIAGONAL_STEP };
                    if cost < self.cost[to] && cost <= MAX_COST {
                        self.cost[to] = cost;
                        let bucket = if cost < limit { &mut next } else { &mut later };
                        bucket.push(Entry { at: to as u32, cost, by });
                    }
                }
            }
            now.clear();
            if next.is_empty() && later.is_empty() {
                break;
            }
            (now, next, later) = (next, later, now);
            limit = limit.saturating_add(WIDTH);
        }
        self.buckets = [now, next, later];
    }
}

impl Rows for Queue {
    #[inline(always)]
    fn read(&self, row: usize, word: usize, costs: &mut [u32; SIDE]) {
        let line = &self.cost[row * self.columns..][..self.columns];
        let known = &line[word * SIDE..];
        match known.first_chunk() {
            Some(known) => *costs = *known,
            None => {
                costs.fill(UNREACHED);
                costs[..known.len()].copy_from_slice(known);
            }
        }
    }
}

/// Fills in the moves of every cell, compiled once for each kind of vector unit.
pub(super) struct Enter<'a> {
    pub(super) open: &'a Passable,
    pub(super) corners: Corners,
    pub(super) moves: &'a mut [u8],
}

impl pulp::WithSimd for Enter<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { open, corners, moves: all } = self;
        for (row, line) in (0..).zip(all.chunks_mut(open.columns.max(1))) {
            for (word, out) in line.chunks_mut(SIDE).enumerate() {
                let [south, here, north] = [row - 1, row, row + 1].map(|row| open.at(word, row));
                out.copy_from_slice(&moves(south, here, north, corners)[..out.len()]);
            }
        }
    }
}

/// The moves worth trying, by the move that led here (or [`START`]) and the open moves.
type Pruning = [[u8; 256]; 9];

static FORBID: Pruning = pruning(false);
static ALLOW: Pruning = pruning(true);

const fn pruning(allow: bool) -> Pruning {
    let mut table = [[0; 256]; 9];
    let mut by = 0;
    while by < 9 {
        let mut open = 0;
        while open < 256 {
            table[by as usize][open] = worthwhile(open as u8, by, allow);
            open += 1;
        }
        by += 1;
    }
    table
}

/// Which of the open moves to try after the move `by`.
const fn worthwhile(open: u8, by: u8, allow: bool) -> u8 {
    if by == START {
        return open;
    }
    /// The bit of the direction some eighths of a turn to the left of `by`.
    const fn turned(by: u8, eighths: u8) -> u8 {
        1 << ((by + eighths) % 8)
    }
    // Ahead, and half left and half right of it: never dearer than a way without this cell.
    let mut keep = turned(by, 0) | turned(by, 1) | turned(by, 7);
    // To a side: the cell before leads there by a diagonal, if that is open, or else, when it
    // was left by a diagonal, by two straight steps.
    let sides = [(2, 3), (6, 5)];
    let mut side = 0;
    while side < 2 {
        let (aside, behind) = sides[side];
        let is_straight = by.is_multiple_of(2);
        let is_needed = match (is_straight, allow) {
            // The diagonal back to that side is open exactly if the one past this cell was.
            (true, false) => open & turned(by, behind) == 0,
            // It is always open.
            (true, true) => false,
            // Both straight steps lead through cells that the diagonal needed open.
            (false, false) => false,
            // They lead through the cell half behind, beside the diagonal.
            (false, true) => open & turned(by, behind) == 0,
        };
        if is_needed {
            keep |= turned(by, aside);
        }
        side += 1;
    }
    open & keep
}
