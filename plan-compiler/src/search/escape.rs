//! The way out of blocked cells: a robot whose position falls into an obstacle, because of a poor fix
//! or a coarse map, still gets an answer.
//!
//! The escape of a blocked cell is the first move of the cheapest way through blocked cells to a free
//! cell with a route. Steps, costs and ties are those of the search; there is no corner rule. A
//! blocked cell without such a way has no escape.
//!
//! Most blocked cells lie on a shore: beside a cell with a route, so that one step leads out. Those
//! are found 64 at a time; only the cells behind them need a search.

use super::advice::{Near, Rows};
use super::open::{Passable, SIDE};
use super::shores::Shores;
use super::tiles::Tiles;
use super::{Corners, Vectors};
use crate::field::{ESCAPE, Field, MOVES, NO_ESCAPE};
use maps::Bitmap;

/// Fills in the codes of a field's blocked cells, once its free cells are done.
pub(crate) fn escape(tiles: &mut Tiles, vectors: Vectors, blocked: &Bitmap, field: &mut Field) {
    let shores = Shores::of(blocked, &field.cost);
    tiles.flood(&Passable::of(&shores.deep, true), &shores, vectors);
    let costs = Depths { shores: &shores, tiles };
    vectors.run(Escape { costs, blocked, field });
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
            near.advance_row();
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
