//! Roots in a field with tolls, handed from cell to cell outwards from the goal.
//!
//! As in [`super::roots`], a cell takes the root of a neighbour on one of its optimal moves. What
//! differs from the multiplied way to that root is a *correction*, of the cost and perhaps of the first
//! step: the route leaves dear cells, such as those along a wall, within a few steps, and then goes on
//! as the root says. So all cells at one distance from a wall have few different corrections. A route
//! through a wide area of another factor would have a correction that grows with every step; after
//! a few changes of the correction a new root is made instead, with the factor of the area.

use super::moves::Bordered;
use super::roots::{NO_ROOT, by_cost, directions};
use crate::field::{Field, GOAL, UNREACHED};
use plan_format::grid::{Cell, Direction};
use plan_format::layout::{MULTIPLIERS, TolledRoot, first_step, tolled_cost};

/// Most changes of the correction on the way from a cell to its root. On cities, 1 packs bands around
/// obstacles and wide areas about equally well; 0 packs areas alone better, and bands much worse.
const MAX_CHANGES: u8 = 1;
/// The same where factors change from cell to cell: a gradient has more factors than roots can have
/// multipliers, and packs best with 3.
const MAX_CHANGES_OF_GRADIENTS: u8 = 3;

/// A cell to which others refer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    pub(crate) cell: Cell,
    pub(crate) cost: u32,
    /// Number of its multiplier.
    pub(crate) number: u8,
    multiplier: u32,
}

impl Site {
    /// What the cost of a cell exceeds what this root says, modulo 2^32.
    #[inline(always)]
    pub(crate) fn excess(&self, cell: Cell, cost: u32) -> u32 {
        cost.wrapping_sub(tolled_cost(self.cell, self.cost, self.multiplier, cell))
    }

    /// The root as it is stored.
    pub(crate) fn stored(&self) -> TolledRoot {
        TolledRoot { cell: self.cell, cost: self.cost, multiplier: self.number }
    }

    /// For both orders of steps, whether the first step from a cell is one of its moves; at the goal,
    /// whether the root is the goal.
    #[inline(always)]
    pub(crate) fn leads(&self, cell: Cell, moves: u8) -> [bool; 2] {
        [false, true].map(|straight_first| match first_step(cell, self.cell, straight_first) {
            Some(direction) => moves >> direction.code() & 1 == 1,
            None => self.cost == 0,
        })
    }
}

/// The roots of a field with tolls.
pub(crate) struct Sites {
    pub(crate) roots: Vec<Site>,
    /// The root that each root's cell had before it became a root; [`NO_ROOT`] for a goal.
    pub(crate) parents: Vec<u32>,
    /// The number of each cell's root. Indexed as in [`Bordered`].
    pub(crate) of_cell: Vec<u32>,
    /// The multipliers that roots may have.
    pub(crate) multipliers: Vec<u32>,
    changes: Vec<u8>,
    max_changes: u8,
}

impl Sites {
    pub(crate) fn new(field: &Field, bordered: &Bordered) -> Self {
        let all = bordered.cost.len();
        let mut multipliers = by_frequency(&bordered.multiplier, field.unit.unwrap_or(0));
        let is_gradient = multipliers.len() > MULTIPLIERS;
        multipliers.truncate(MULTIPLIERS);
        let mut this = Self {
            roots: Vec::new(),
            parents: Vec::new(),
            of_cell: vec![NO_ROOT; all],
            multipliers,
            changes: vec![0; all],
            max_changes: if is_gradient { MAX_CHANGES_OF_GRADIENTS } else { MAX_CHANGES },
        };
        let one = 1 << field.unit.unwrap_or(0);
        let cells = crate::field::all_cells(field.columns, field.rows);
        for (goal, _) in cells.zip(&field.code).filter(|&(_, &code)| code == GOAL) {
            if bordered.cost[bordered.index_of(goal)] == 0 {
                this.make_root(goal, one, bordered);
            }
        }
        for cell in by_cost(bordered, 0..UNREACHED).into_iter().map(Cell::of_word) {
            this.choose(cell, bordered);
        }
        this
    }

    /// Gives a cell a root.
    #[inline(always)]
    fn choose(&mut self, cell: Cell, bordered: &Bordered) {
        let index = bordered.index_of(cell);
        let (cost, moves) = (bordered.cost[index], bordered.moves[index]);
        let mut best: Option<(u8, u32)> = None;
        for direction in directions(moves) {
            let next = bordered.neighbour(index, direction);
            let number = self.of_cell[next];
            if number == NO_ROOT {
                continue;
            }
            let root = self.roots[number as usize];
            let same = root.leads(cell, moves) != [false; 2]
                && root.excess(cell, cost)
                    == root.excess(stepped(cell, direction), bordered.cost[next]);
            let offer = (self.changes[next] + u8::from(!same), number);
            best = Some(best.map_or(offer, |best| best.min(offer)));
        }
        if let Some((changes, number)) = best.filter(|&(changes, _)| changes <= self.max_changes) {
            self.of_cell[index] = number;
            self.changes[index] = changes;
            return;
        }
        if let Some(direction) = directions(moves).next() {
            let next = stepped(cell, direction);
            self.of_cell[index] = self.make_root(next, bordered.multiplier[index], bordered);
        }
    }

    /// Makes a cell a root for steps with a multiplier, or one close to it, and returns its number.
    fn make_root(&mut self, cell: Cell, multiplier: u32, bordered: &Bordered) -> u32 {
        let distance = |&&known: &&u32| known.abs_diff(multiplier);
        let closest = self.multipliers.iter().min_by_key(distance).copied().unwrap_or(1);
        let place = self.multipliers.iter().position(|&known| known == closest);
        let index = bordered.index_of(cell);
        let number = self.roots.len() as u32;
        let cost = bordered.cost[index];
        let place = place.unwrap_or(0) as u8;
        self.roots.push(Site { cell, cost, number: place, multiplier: closest });
        self.parents.push(std::mem::replace(&mut self.of_cell[index], number));
        self.changes[index] = 0;
        number
    }
}

/// The cell that a step leads to.
#[inline(always)]
fn stepped(cell: Cell, direction: Direction) -> Cell {
    let (dx, dy) = direction.step();
    Cell::new(cell.column.wrapping_add_signed(dx), cell.row.wrapping_add_signed(dy))
}

/// All multipliers, those of most cells first; always that of factor 1 before all.
fn by_frequency(multiplier: &[u32], unit: u8) -> Vec<u32> {
    let mut counts = [0u32; crate::tolls::MOST as usize + 1];
    for &multiplier in multiplier {
        counts[multiplier as usize] += 1;
    }
    counts[0] = 0;
    counts[1 << unit] = u32::MAX;
    let mut all: Vec<u32> = (1..counts.len() as u32).collect();
    all.retain(|&multiplier| counts[multiplier as usize] > 0);
    all.sort_by_key(|&multiplier| std::cmp::Reverse(counts[multiplier as usize]));
    all
}
