//! Uniform-cost search over cells with tolls, with buckets no wider than the shortest step; for mazes
//! of narrow corridors.
//!
//! Why it is exact: as in [`super::buckets`], no step from a cell of a bucket leads to a cost inside
//! that bucket's interval, so every cost is final when its bucket is opened. The width is the largest
//! power of two up to the shortest step, so that a shift finds the bucket of a cost. The longest step,
//! a diagonal one out of the dearest cell, decides how many buckets are open at a time: they form a
//! ring.
//!
//! The search runs from the goal, so the step that it takes to a cell is the one that a robot takes
//! out of that cell: it costs by the factor of the cell that the search enters.
//!
//! Three moves are never tried: back to the cell before, and to the two cells beside it that the cell
//! before reaches by a step which is not longer. They are strictly dearer, whatever the factors are.

use super::advice::Rows;
use super::buckets::Enter;
use super::open::{Passable, SIDE};
use super::{Corners, MAX_COST, Vectors};
use crate::field::UNREACHED;
use crate::tolls::{MOST, Tolls};
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::{Cell, Direction};

const _: () = assert!(MAX_COST.checked_add(DIAGONAL_STEP * MOST).is_some(), "no step overflows");

/// What the search knows of a cell, together, so that a visit touches one cache line.
#[derive(Clone, Copy, Debug)]
struct Node {
    cost: u32,
    /// What a step out of the cell is multiplied by.
    multiplier: u16,
    /// One bit for each open move.
    moves: u8,
}

/// A route to a cell.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// The cell's index in row-major order, and above it the code of the last move.
    at_and_by: u32,
    cost: u32,
}

/// Bits of a cell's index; the sides of a grid are at most 2^14.
const AT_BITS: u32 = 28;

/// The moves worth trying after each move, one bit each; all after none, which has code 8.
const WORTHWHILE: [u8; 9] = {
    let mut table = [0xff; 9];
    let mut by = 0;
    while by < 8 {
        // Back, and half back to both sides; after a diagonal move, those are the straight moves to
        // the cells beside it.
        let back = 1u8 << ((by + 4) % 8) | 1 << ((by + 3) % 8) | 1 << ((by + 5) % 8);
        table[by] = !back;
        by += 1;
    }
    table
};
const START: u32 = 8;

/// Reusable buffers of the search.
#[derive(Debug, Default)]
pub(crate) struct Tolled {
    columns: usize,
    nodes: Vec<Node>,
    moves: Vec<u8>,
    ring: Vec<Vec<Entry>>,
}

impl Tolled {
    /// Finds the cheapest routes to any of the goals, which are open cells.
    pub(crate) fn search(
        &mut self,
        open: &Passable,
        tolls: &Tolls,
        goals: &[Cell],
        corners: Corners,
        vectors: Vectors,
    ) {
        let columns = open.columns;
        self.columns = columns;
        self.moves.resize(columns * open.rows, 0);
        vectors.run(Enter { open, corners, moves: &mut self.moves });
        self.nodes.clear();
        let nodes = self.moves.iter().zip(tolls.multipliers(tolls.unit()));
        self.nodes.extend(nodes.map(|(&moves, multiplier)| Node {
            cost: UNREACHED,
            multiplier,
            moves,
        }));
        let range = self.nodes.iter().fold((u16::MAX, 1), |(least, most), node| {
            (least.min(node.multiplier), most.max(node.multiplier))
        });
        let shift = (STRAIGHT_STEP * u32::from(range.0.min(range.1))).ilog2();
        let buckets = (((DIAGONAL_STEP * u32::from(range.1)) >> shift) + 2).next_power_of_two();
        self.ring.iter_mut().for_each(Vec::clear);
        self.ring.resize(buckets as usize, Vec::new());
        for goal in goals {
            let at = goal.row as usize * columns + goal.column as usize;
            self.nodes[at].cost = 0;
            self.ring[0].push(Entry { at_and_by: at as u32 | START << AT_BITS, cost: 0 });
        }
        self.run(columns, shift);
    }

    /// Empties the buckets in order, starting with that of the goals.
    fn run(&mut self, columns: usize, shift: u32) {
        let steps = Direction::ALL.map(|direction| {
            let (dx, dy) = direction.step();
            (columns as isize * dy as isize + dx as isize) as usize
        });
        let mask = self.ring.len() - 1;
        let (mut bucket, mut empty) = (0, 0);
        let mut now = Vec::new();
        while empty <= mask {
            std::mem::swap(&mut now, &mut self.ring[bucket & mask]);
            empty = if now.is_empty() { empty + 1 } else { 0 };
            for &Entry { at_and_by, cost } in &now {
                let at = (at_and_by & ((1 << AT_BITS) - 1)) as usize;
                let node = self.nodes[at];
                if node.cost != cost {
                    continue;
                }
                let mut moves = node.moves & WORTHWHILE[(at_and_by >> AT_BITS) as usize];
                while moves != 0 {
                    let by = moves.trailing_zeros();
                    moves &= moves - 1;
                    let to = at.wrapping_add(steps[by as usize]);
                    let next = &mut self.nodes[to];
                    let step = if by.is_multiple_of(2) { STRAIGHT_STEP } else { DIAGONAL_STEP };
                    let cost = cost + step * u32::from(next.multiplier);
                    if cost < next.cost && cost <= MAX_COST {
                        next.cost = cost;
                        let entry = Entry { at_and_by: to as u32 | by << AT_BITS, cost };
                        self.ring[(cost >> shift) as usize & mask].push(entry);
                    }
                }
            }
            now.clear();
            std::mem::swap(&mut now, &mut self.ring[bucket & mask]);
            bucket += 1;
        }
    }
}

impl Rows for Tolled {
    #[inline(always)]
    fn read(&self, row: usize, word: usize, costs: &mut [u32; SIDE]) {
        let line = &self.nodes[row * self.columns..][..self.columns];
        costs.fill(UNREACHED);
        for (cost, node) in costs.iter_mut().zip(&line[word * SIDE..]) {
            *cost = node.cost;
        }
    }
}
