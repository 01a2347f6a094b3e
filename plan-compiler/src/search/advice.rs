//! From costs to directions: for every cell an optimal first move.
//!
//! A neighbour is a good first move if its cost and the step to it make the cell's own cost.
//! Costs are integers, so that is a comparison for equality, and every cell is decided by its
//! eight neighbours alone: one pass over the field, row by row, many columns at once.
//!
//! Sixteen bits of a cost are enough for that, and twice as many columns fit in a vector.
//! The costs of two cells with a route, one step apart, differ by that step at most; so if they
//! differ by a step modulo 2^15, which is more than twice the longest, they do so in truth. The
//! sixteenth bit says that there is no route ([`NOWHERE`]).
//!
//! Among equally good moves a diagonal is preferred to a straight one (the paper's "minimal
//! adjacent cell"), else NE, NW, SW, SE, E, N, W, S in this order.

use super::Corners;
use crate::bitmap::Bitmap;
use plan_format::field::{self, Field, UNREACHED};
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::{Cell, Direction};

/// Where the costs of a search come from.
pub(crate) trait Rows {
    /// Writes the costs of a row, [`UNREACHED`] where there is none.
    fn read(&self, row: usize, cost: &mut [u32]);
}

/// Fills in a field, whose arrays have their right lengths: the costs, and the codes of all
/// cells, blocked ones being left without an escape.
pub(super) fn advise(
    costs: &impl Rows,
    blocked: &Bitmap,
    goal: Option<Cell>,
    corners: Corners,
    field: &mut Field,
) {
    pulp::Arch::new().dispatch(Advise { costs, blocked, corners, field });
    if let Some(goal) = goal {
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
        let columns = field.columns as usize;
        if field.cost.is_empty() {
            return;
        }
        let mut near = Near::new(columns);
        let rows = field.cost.len() / columns;
        for row in 0..=rows {
            if row < rows {
                let cost = &mut field.cost[row * columns..][..columns];
                costs.read(row, cost);
                near.go_north(cost);
            } else {
                near.go_beyond();
            }
            if row > 0 {
                let code = &mut field.code[(row - 1) * columns..][..columns];
                near.codes(corners, blocked.row(row as u32 - 1), code);
            }
        }
    }
}

/// A cell without a route, or beyond the map.
const NOWHERE: u16 = 1 << 15;
/// The bits that costs are compared by.
const KEPT: u16 = NOWHERE - 1;

const _: () = assert!(2 * DIAGONAL_STEP < KEPT as u32, "steps are told apart");

/// Columns that are decided at once: whole vectors, however long.
const BLOCK: usize = 64;
/// The shortened costs of a block's columns and of one beside it at either end.
type Line = [u16; BLOCK + 2];

/// A row's costs and those of the rows south and north of it, shortened, with a column beyond the
/// map before them and as many after them as make whole blocks.
pub(crate) struct Near {
    lines: [Vec<u16>; 3],
}

impl Near {
    /// South of all rows of a map.
    pub(crate) fn new(columns: usize) -> Self {
        Self { lines: [(); 3].map(|()| vec![NOWHERE; columns.next_multiple_of(BLOCK) + 2]) }
    }

    /// Takes in the costs of the next row north.
    #[inline(always)]
    pub(crate) fn go_north(&mut self, cost: &[u32]) {
        self.lines.rotate_left(1);
        for (short, &cost) in self.lines[2][1..].iter_mut().zip(cost) {
            *short = if cost == UNREACHED { NOWHERE } else { cost as u16 & KEPT };
        }
    }

    /// There is no further row north.
    #[inline(always)]
    pub(crate) fn go_beyond(&mut self) {
        self.lines.rotate_left(1);
        self.lines[2].fill(NOWHERE);
    }

    /// The codes of the row's cells. Of those that are not `blocked`, by words as in a [`Bitmap`],
    /// one without a move has no route, be it the goal.
    #[inline(always)]
    pub(crate) fn codes(&self, corners: Corners, blocked: &[u64], code: &mut [u8]) {
        match corners {
            Corners::Allow => self.codes_by::<true>(blocked, code),
            Corners::Forbid => self.codes_by::<false>(blocked, code),
        }
    }

    #[inline(always)]
    fn codes_by<const ALLOW: bool>(&self, blocked: &[u64], code: &mut [u8]) {
        let [south, here, north] = &self.lines;
        for (at, code) in code.chunks_mut(BLOCK).enumerate() {
            let start = at * BLOCK;
            let (Some(south), Some(here), Some(north)) = (
                south[start..].first_chunk(),
                here[start..].first_chunk(),
                north[start..].first_chunk(),
            ) else {
                return;
            };
            let blocked = blocked.get(at).copied().unwrap_or(0);
            let codes = block::<ALLOW>([south, here, north], blocked);
            match code.first_chunk_mut() {
                Some(code) => *code = codes,
                None => code.copy_from_slice(&codes[..code.len()]),
            }
        }
    }
}

/// The codes of the columns of a block, from the lines south of them, through them and north of
/// them, which begin a column before and end a column after.
#[inline(always)]
fn block<const ALLOW: bool>([south, here, north]: [&Line; 3], blocked: u64) -> [u8; BLOCK] {
    let mut codes = [0; BLOCK];
    // Sixteen bits at a time, so that a vector holds as many to be tested as costs.
    for (word, first) in [0, 16, 32, 48].map(|first| ((blocked >> first) as u16, first)) {
        for lane in 0..16 {
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
    codes
}

/// The code of a free cell from its cost and those around it, in the order of directions.
///
/// A blocked neighbour is told by its cost: neighbours of a cell with a route have a route, if
/// they are free.
#[inline(always)]
fn best<const ALLOW: bool>(cost: u16, around: [u16; 8]) -> u16 {
    let straight = cost.wrapping_sub(STRAIGHT_STEP as u16) & KEPT;
    let diagonal = cost.wrapping_sub(DIAGONAL_STEP as u16) & KEPT;
    let [e, ne, n, nw, w, sw, s, se] = around;
    let passes = |a: u16, b: u16| ALLOW || (a | b) < NOWHERE;
    // From the least preferred to the most, each overriding the one before.
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
