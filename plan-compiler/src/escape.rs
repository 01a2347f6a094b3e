//! The way out of blocked cells, so that a robot whose position falls into an obstacle (a
//! poor fix, a coarse map) still gets an answer.
//!
//! The escape of a blocked cell is the first move of the cheapest way through blocked cells
//! to a free cell with a route: the same steps and costs as the search, no rule about
//! corners, ties as in the search. A blocked cell that cannot reach such a cell through
//! blocked cells alone has none.
//!
//! Most blocked cells lie on a shore: beside a cell with a route, so that one step leads out.
//! Those are found 64 at a time; only from there inward a search is needed.

use crate::bitmap::Bitmap;
use crate::pack::field::{ESCAPE, Field, MOVES, NO_ESCAPE, UNREACHED};
use crate::search::advice::{Near, Rows};
use crate::search::open::{Passable, SIDE};
use crate::search::tiles::Tiles;
use crate::search::{Corners, Vectors};
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};

/// Fills in the codes of the blocked cells of a field whose free cells are done.
pub(crate) fn escape(tiles: &mut Tiles, vectors: Vectors, blocked: &Bitmap, field: &mut Field) {
    let shores = Shores::of(blocked, &field.cost);
    tiles.flood(&Passable::of(&shores.deep, true), &shores, vectors);
    let costs = Depths { shores: &shores, tiles };
    vectors.run(Escape { costs, blocked, field });
}

/// What is known of the costs of leaving blocked cells without a search.
pub(crate) struct Shores {
    /// Cells with a route, where the way out ends.
    routed: Bitmap,
    /// Blocked cells that one straight step leads out of.
    straight: Bitmap,
    /// Other blocked cells that one diagonal step leads out of.
    diagonal: Bitmap,
    /// All other blocked cells.
    deep: Bitmap,
}

impl Shores {
    fn of(blocked: &Bitmap, cost: &[u32]) -> Self {
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

    /// The costs of a word of a row: 0 for cells with a route, [`UNREACHED`] where a search is
    /// needed or there is no way.
    #[inline(always)]
    pub(crate) fn word(&self, row: u32, word: usize) -> [u32; SIDE] {
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

/// The costs of leaving all blocked cells.
struct Depths<'a> {
    shores: &'a Shores,
    tiles: &'a Tiles,
}

impl Rows for Depths<'_> {
    #[inline(always)]
    fn read(&self, row: usize, word: usize, costs: &mut [u32; SIDE]) {
        let shores = self.shores.word(row as u32, word);
        if self.shores.deep.row(row as u32).get(word).is_some_and(|&deep| deep != 0) {
            self.tiles.read(row, word, costs);
            for (cost, shore) in costs.iter_mut().zip(shores) {
                *cost = shore.min(*cost);
            }
        } else {
            *costs = shores;
        }
    }
}

/// The directions from the costs, compiled once for each kind of vector unit.
struct Escape<'a> {
    costs: Depths<'a>,
    blocked: &'a Bitmap,
    field: &'a mut Field,
}

impl pulp::WithSimd for Escape<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { costs, blocked, field } = self;
        let (columns, rows) = (field.columns as usize, field.rows as usize);
        let mut near = Near::new(columns);
        let (mut read, mut moves) = ([0; SIDE], [0; SIDE]);
        for row in 0..=rows {
            near.go_north();
            if row < rows {
                for word in 0..columns.div_ceil(SIDE) {
                    costs.read(row, word, &mut read);
                    near.set(word, &read);
                }
            } else {
                near.end();
            }
            if row > 0 {
                let code = &mut field.code[(row - 1) * columns..][..columns];
                let words = blocked.row(row as u32 - 1).iter().enumerate();
                for (word, &blocked) in words.filter(|&(_, &blocked)| blocked != 0) {
                    near.codes(word, Corners::Allow, 0, &mut moves);
                    mark(blocked, &mut code[word * SIDE..], &moves);
                }
            }
        }
    }
}

/// Turns the moves of the blocked cells of a word into escapes.
#[inline(always)]
fn mark(blocked: u64, code: &mut [u8], moves: &[u8; SIDE]) {
    let bytes = blocked.to_le_bytes().into_iter();
    for (byte, (code, moves)) in bytes.zip(code.chunks_mut(8).zip(moves.chunks(8))) {
        for (bit, (code, &go)) in code.iter_mut().zip(moves).enumerate() {
            let escape = if go < MOVES { ESCAPE + go } else { NO_ESCAPE };
            *code = if byte & 1 << bit != 0 { escape } else { *code };
        }
    }
}
