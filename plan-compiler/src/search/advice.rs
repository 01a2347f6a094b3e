//! From costs to directions: for every cell an optimal first move.
//!
//! A neighbour is a good first move if its cost plus the step to it equals the cell's own cost.
//! Costs are integers, so the comparison is exact, and the eight neighbours of a cell decide it
//! alone: one pass over the field, row by row, many columns at once.
//!
//! Sixteen bits of a cost are enough, so that twice as many columns fit in a vector. The costs of two
//! neighbours with a route differ by at most one step. 2^15 is more than twice the longest step, so
//! costs that differ by a step modulo 2^15 really differ by that step. The sixteenth bit marks cells
//! without a route ([`NOWHERE`]).
//!
//! Among equally good moves a diagonal is preferred to a straight one (the paper's "minimal
//! adjacent cell"), else NE, NW, SW, SE, E, N, W, S in this order.

use super::open::SIDE;
use super::{Corners, Vectors};
use crate::field::{self, Field, UNREACHED};
use maps::Bitmap;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::{Cell, Direction};

/// A source of the costs of a search.
pub(crate) trait Rows {
    /// Reads the costs of 64 columns of a row: those of word `word` of a [`Bitmap`]'s row.
    /// [`UNREACHED`] for cells without a route and beyond the map.
    fn read(&self, row: usize, word: usize, costs: &mut [u32; SIDE]);
}

/// Fills in the costs and codes of a field whose size is set. Blocked cells get no escape yet.
pub(super) fn advise(
    costs: &impl Rows,
    blocked: &Bitmap,
    goals: &[Cell],
    corners: Corners,
    vectors: Vectors,
    field: &mut Field,
) {
    // Whole words are written, row after row. What is written beyond the end of a row lies in the
    // next row, which is overwritten later, or behind the last row.
    let cells = field.columns as usize * field.rows as usize;
    field.cost.resize(cells + SIDE, UNREACHED);
    field.code.resize(cells + SIDE, field::NO_ROUTE);
    vectors.run(Advise { costs, blocked, corners, field });
    field.cost.truncate(cells);
    field.code.truncate(cells);
    for goal in goals {
        field.code[goal.row as usize * field.columns as usize + goal.column as usize] = field::GOAL;
    }
}

/// The pass itself, compiled once for each kind of vector unit.
struct Advise<'a, R> {
    costs: &'a R,
    blocked: &'a Bitmap,
    corners: Corners,
    field: &'a mut Field,
}

impl<R: Rows> pulp::WithSimd for Advise<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { costs, blocked, corners, field } = self;
        let (columns, rows) = (field.columns as usize, field.rows as usize);
        let words = columns.div_ceil(SIDE);
        let mut near = Near::new(columns);
        let (mut read, mut found) = ([0; SIDE], [0; SIDE]);
        for row in 0..=rows {
            near.advance_row();
            if row < rows {
                let cost = &mut field.cost[row * columns..];
                for word in 0..words {
                    costs.read(row, word, &mut read);
                    near.set(word, &read);
                    if let Some(cost) = cost[word * SIDE..].first_chunk_mut() {
                        *cost = read;
                    }
                }
            } else {
                near.end();
            }
            if row > 0 {
                let code = &mut field.code[(row - 1) * columns..];
                for (word, &blocked) in blocked.row(row as u32 - 1).iter().enumerate() {
                    near.codes(word, corners, blocked, &mut found);
                    if let Some(code) = code[word * SIDE..].first_chunk_mut() {
                        *code = found;
                    }
                }
            }
        }
    }
}

/// A cell without a route, or beyond the map.
const NOWHERE: u16 = 1 << 15;
/// The bits of a cost that are compared.
const KEPT: u16 = NOWHERE - 1;

const _: () = assert!(2 * DIAGONAL_STEP < KEPT as u32, "costs one step apart stay distinct");

/// The shortened costs of a word's columns and of one column beyond either end.
type Line = [u16; SIDE + 2];

/// The shortened costs of a row and of the rows south and north of it, with one column before the
/// map and enough columns after it to fill whole words.
pub(crate) struct Near {
    lines: [Vec<u16>; 3],
}

impl Near {
    /// Starts south of the first row.
    pub(crate) fn new(columns: usize) -> Self {
        Self { lines: [(); 3].map(|()| vec![NOWHERE; columns.next_multiple_of(SIDE) + 2]) }
    }

    /// Advances to the next row; then the costs of the row north of it must be set.
    #[inline(always)]
    pub(crate) fn advance_row(&mut self) {
        let [south, here, north] = &mut self.lines;
        std::mem::swap(south, here);
        std::mem::swap(here, north);
    }

    /// Marks that there is no row to the north.
    #[inline(always)]
    pub(crate) fn end(&mut self) {
        self.lines[2].fill(NOWHERE);
    }

    /// Sets the costs of a word of the row to the north.
    #[inline(always)]
    pub(crate) fn set(&mut self, word: usize, costs: &[u32; SIDE]) {
        let line = &mut self.lines[2][1 + word * SIDE..][..SIDE];
        for (short, &cost) in line.iter_mut().zip(costs) {
            *short = if cost == UNREACHED { NOWHERE } else { cost as u16 & KEPT };
        }
    }

    /// The codes of a word of the row; those beyond the map mean nothing. A free cell without a move
    /// is coded as without a route, the goal too.
    #[inline(always)]
    pub(crate) fn codes(
        &self,
        word: usize,
        corners: Corners,
        blocked: u64,
        found: &mut [u8; SIDE],
    ) {
        let [south, here, north] = &self.lines;
        let start = word * SIDE;
        let (Some(south), Some(here), Some(north)) = (
            south[start..].first_chunk(),
            here[start..].first_chunk(),
            north[start..].first_chunk(),
        ) else {
            return;
        };
        match corners {
            Corners::Allow => codes::<true>([south, here, north], blocked, found),
            Corners::Forbid => codes::<false>([south, here, north], blocked, found),
        }
    }
}

/// The codes of a word's columns, from the costs of the rows south of it, of its own row and north of
/// it. Each row begins one column before the word and ends one column after.
#[inline(always)]
fn codes<const ALLOW: bool>(
    [south, here, north]: [&Line; 3],
    blocked: u64,
    codes: &mut [u8; SIDE],
) {
    // Sixteen bits at a time, so that a vector has as many test bits as costs.
    for (word, first) in [0, 32].map(|first| ((blocked >> first) as u32, first)) {
        for lane in 0..32 {
            let x = first + lane;
            let around = [
                here[x + 2],
                north[x + 2],
                north[x + 1],
                north[x],
                here[x],
                south[x],
                south[x + 1],
                south[x + 2],
            ];
            let free = best::<ALLOW>(here[x + 1], around);
            let is_blocked = word & 1 << lane != 0;
            codes[x] = if is_blocked { field::NO_ESCAPE } else { free as u8 };
        }
    }
}

/// The code of a free cell from its cost and those around it, in the order of directions.
///
/// The cost shows whether a neighbour is blocked: a free neighbour of a cell with a route has a
/// route.
#[inline(always)]
fn best<const ALLOW: bool>(cost: u16, around: [u16; 8]) -> u16 {
    let straight = cost.wrapping_sub(STRAIGHT_STEP as u16) & KEPT;
    let diagonal = cost.wrapping_sub(DIAGONAL_STEP as u16) & KEPT;
    let [e, ne, n, nw, w, sw, s, se] = around;
    let passes = |a: u16, b: u16| ALLOW || (a < NOWHERE) & (b < NOWHERE);
    // From the least to the most preferred; each overrides the one before.
    let mut code = u16::from(field::NO_ROUTE);
    let mut offer = |good: bool, direction: Direction| {
        code = if good { direction as u16 } else { code };
    };
    offer(s == straight, Direction::S);
    offer(w == straight, Direction::W);
    offer(n == straight, Direction::N);
    offer(e == straight, Direction::E);
    offer((se == diagonal) & passes(s, e), Direction::SE);
    offer((sw == diagonal) & passes(s, w), Direction::SW);
    offer((nw == diagonal) & passes(n, w), Direction::NW);
    offer((ne == diagonal) & passes(n, e), Direction::NE);
    if cost < NOWHERE { code } else { u16::from(field::NO_ROUTE) }
}
