//! From costs to directions: for every cell an optimal first move.
//!
//! A neighbour is a good first move if its cost and the step to it make the cell's own cost.
//! Costs are integers, so that is a comparison for equality, and every cell is decided by its
//! eight neighbours alone: one pass over the field, row by row, many columns at once.
//!
//! Among equally good moves a diagonal is preferred to a straight one (the paper's "minimal
//! adjacent cell"), else NE, NW, SW, SE, E, N, W, S in this order.

use super::Corners;
use crate::bitmap::Bitmap;
use plan_format::Direction;
use plan_format::field::{self, Field, UNREACHED};
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};

/// Where the costs of a search come from.
pub(crate) trait Rows {
    /// Writes the costs of a row, [`UNREACHED`] where there is none.
    fn read(&self, row: usize, cost: &mut [u32]);
}

/// Fills in a field, whose arrays have their right lengths: the costs, and the codes of all
/// cells, blocked ones being left without an escape.
pub(super) fn advise(costs: &impl Rows, blocked: &Bitmap, corners: Corners, field: &mut Field) {
    let nowhere = vec![UNREACHED; field.columns as usize];
    pulp::Arch::new().dispatch(Advise { costs, blocked, corners, nowhere: &nowhere, field });
}

/// The pass itself, compiled once for each kind of vector unit.
struct Advise<'a, R> {
    costs: &'a R,
    blocked: &'a Bitmap,
    corners: Corners,
    nowhere: &'a [u32],
    field: &'a mut Field,
}

impl<R: Rows> pulp::WithSimd for Advise<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { costs, blocked, corners, nowhere, field } = self;
        let (columns, rows) = (field.columns as usize, field.rows as usize);
        if columns == 0 || rows == 0 {
            return;
        }
        costs.read(0, &mut field.cost[..columns]);
        for row in 0..rows {
            let start = row * columns;
            if row + 1 < rows {
                costs.read(row + 1, &mut field.cost[start + columns..][..columns]);
            }
            let line = |row: usize| field.cost.get(row * columns..(row + 1) * columns);
            let near = Near {
                south: row.checked_sub(1).and_then(line).unwrap_or(nowhere),
                here: &field.cost[start..][..columns],
                north: line(row + 1).unwrap_or(nowhere),
            };
            let code = &mut field.code[start..][..columns];
            near.codes(corners, code);
            mark(blocked.row(row as u32), code);
        }
    }
}

/// Overwrites the codes of blocked cells.
#[inline(always)]
fn mark(blocked: &[u64], code: &mut [u8]) {
    for (&word, code) in blocked.iter().zip(code.chunks_mut(64)) {
        if word == 0 {
            continue;
        }
        for (byte, code) in word.to_le_bytes().into_iter().zip(code.chunks_mut(8)) {
            for (bit, code) in code.iter_mut().enumerate() {
                *code = if byte & 1 << bit != 0 { field::NO_ESCAPE } else { *code };
            }
        }
    }
}

/// A row's costs and those of the rows beside it.
pub(crate) struct Near<'a> {
    pub(crate) south: &'a [u32],
    pub(crate) here: &'a [u32],
    pub(crate) north: &'a [u32],
}

impl Near<'_> {
    /// The codes of the row's cells, all taken for free.
    #[inline(always)]
    pub(crate) fn codes(&self, corners: Corners, code: &mut [u8]) {
        match corners {
            Corners::Allow => self.codes_by::<true>(code),
            Corners::Forbid => self.codes_by::<false>(code),
        }
    }

    #[inline(always)]
    fn codes_by<const ALLOW: bool>(&self, code: &mut [u8]) {
        let last = code.len() - 1;
        code[0] = self.outer::<ALLOW>(0);
        if last > 0 {
            code[last] = self.outer::<ALLOW>(last);
            let inner = &mut code[1..last];
            let count = inner.len();
            let [w, c, e] = [0, 1, 2].map(|shift| &self.here[shift..][..count]);
            let [sw, s, se] = [0, 1, 2].map(|shift| &self.south[shift..][..count]);
            let [nw, n, ne] = [0, 1, 2].map(|shift| &self.north[shift..][..count]);
            for x in 0..count {
                let around = [e[x], ne[x], n[x], nw[x], w[x], sw[x], s[x], se[x]];
                inner[x] = best::<ALLOW>(c[x], around) as u8;
            }
        }
    }

    /// The code of a cell at the map's western or eastern border.
    #[inline(always)]
    fn outer<const ALLOW: bool>(&self, x: usize) -> u8 {
        let at = |line: &[u32], x: usize| line.get(x).copied().unwrap_or(UNREACHED);
        let (west, east) = (x.wrapping_sub(1), x + 1);
        let around = [
            at(self.here, east),
            at(self.north, east),
            at(self.north, x),
            at(self.north, west),
            at(self.here, west),
            at(self.south, west),
            at(self.south, x),
            at(self.south, east),
        ];
        best::<ALLOW>(self.here[x], around) as u8
    }
}

/// The code of a free cell from its cost and those around it, in the order of directions.
///
/// A blocked neighbour is told by its cost: neighbours of a cell with a route have a route, if
/// they are free. [`UNREACHED`] plus a step wraps to less than any cost but 0.
#[inline(always)]
fn best<const ALLOW: bool>(cost: u32, around: [u32; 8]) -> u32 {
    let straight = cost.wrapping_sub(STRAIGHT_STEP);
    let diagonal = cost.wrapping_sub(DIAGONAL_STEP);
    let [e, ne, n, nw, w, sw, s, se] = around;
    let passes = |a: u32, b: u32| ALLOW || (a != UNREACHED) & (b != UNREACHED);
    // From the least preferred to the most, each overriding the one before.
    let mut code = if cost == 0 { u32::from(field::GOAL) } else { u32::from(field::NO_ROUTE) };
    let mut offer = |good: bool, direction: Direction| {
        code = if good { direction as u32 } else { code };
    };
    offer(s == straight, Direction::S);
    offer(w == straight, Direction::W);
    offer(n == straight, Direction::N);
    offer(e == straight, Direction::E);
    offer((se == diagonal) & passes(s, e), Direction::SE);
    offer((sw == diagonal) & passes(s, w), Direction::SW);
    offer((nw == diagonal) & passes(n, w), Direction::NW);
    offer((ne == diagonal) & passes(n, e), Direction::NE);
    code
}
