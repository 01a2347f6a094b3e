//! Blocked cells on a shore: one step leads out of them, so they need no search.

use super::open::{Passable, SIDE};
use crate::field::UNREACHED;
use maps::Bitmap;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};

/// The costs of leaving blocked cells, as far as they are known without a search.
pub(super) struct Shores {
    /// Cells with a route, where a way out ends.
    pub(super) routed: Bitmap,
    /// Blocked cells that one straight step leads out of.
    straight: Bitmap,
    /// Other blocked cells that one diagonal step leads out of.
    diagonal: Bitmap,
    /// All other blocked cells.
    pub(super) deep: Bitmap,
}

impl Shores {
    pub(super) fn of(blocked: &Bitmap, cost: &[u32]) -> Self {
        let (columns, rows) = (blocked.columns(), blocked.rows());
        let mut routed = Bitmap::new(columns, rows);
        for (row, cost) in (0..).zip(cost.chunks_exact(columns.max(1) as usize)) {
            for (word, cost) in routed.row_mut(row).iter_mut().zip(cost.chunks(SIDE)) {
                for (half, cost) in cost.chunks(32).enumerate() {
                    let bits = cost.iter().enumerate().fold(0, |bits, (lane, &cost)| {
                        bits | if cost == UNREACHED { 0 } else { 1u32 << lane }
                    });
                    *word |= u64::from(bits) << (32 * half);
                }
            }
        }
        let routed_cells = Passable::of(&routed, true);
        let [mut straight, mut diagonal, mut deep] = [(); 3].map(|()| Bitmap::new(columns, rows));
        for row in 0..rows {
            for (word, &blocked) in blocked.row(row).iter().enumerate() {
                if blocked == 0 {
                    continue;
                }
                let row_at = row as isize;
                let [south, here, north] =
                    [row_at - 1, row_at, row_at + 1].map(|row| routed_cells.at(word, row));
                let beside = here.west_open() | here.east_open() | south.cells | north.cells;
                let across =
                    south.west_open() | south.east_open() | north.west_open() | north.east_open();
                straight.row_mut(row)[word] = blocked & beside;
                diagonal.row_mut(row)[word] = blocked & !beside & across;
                deep.row_mut(row)[word] = blocked & !beside & !across;
            }
        }
        Self { routed, straight, diagonal, deep }
    }

    /// The costs of a word of a row: 0 for cells with a route, [`UNREACHED`] if a search is needed.
    #[inline(always)]
    pub(super) fn word(&self, row: u32, word: usize) -> [u32; SIDE] {
        let [routed, straight, diagonal] = [&self.routed, &self.straight, &self.diagonal]
            .map(|bitmap| bitmap.row(row).get(word).copied().unwrap_or(0))
            .map(|word| [word as u32, (word >> 32) as u32]);
        let mut costs = [UNREACHED; SIDE];
        for half in 0..2 {
            for lane in 0..32 {
                let bit = 1u32 << lane;
                let outer = if diagonal[half] & bit != 0 { DIAGONAL_STEP } else { UNREACHED };
                let inner = if straight[half] & bit != 0 { STRAIGHT_STEP } else { outer };
                costs[half * 32 + lane] = if routed[half] & bit != 0 { 0 } else { inner };
            }
        }
        costs
    }
}
