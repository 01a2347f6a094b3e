//! From costs with tolls to directions: as [`super::advice`], with steps that depend on the cell.

use super::advice::Rows;
use super::open::SIDE;
use super::{Corners, Query, Vectors};
use crate::field::{self, Field, UNREACHED};
use plan_format::Direction;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};

/// Fills in the costs and codes of a field whose size is set. Blocked cells get no escape yet.
pub(super) fn advise(costs: &impl Rows, query: &Query<'_>, vectors: Vectors, field: &mut Field) {
    let (columns, rows) = (field.columns as usize, field.rows as usize);
    field.cost.resize(columns * rows, UNREACHED);
    field.code.resize(columns * rows, field::NO_ROUTE);
    vectors.run(Advise { costs, query, field });
    for goal in query.goals.iter().filter(|&&goal| query.terrain.is_free(goal)) {
        field.code[goal.row as usize * columns + goal.column as usize] = field::GOAL;
    }
}

/// The pass itself, compiled once for each kind of vector unit.
struct Advise<'a, R> {
    costs: &'a R,
    query: &'a Query<'a>,
    field: &'a mut Field,
}

impl<R: Rows> pulp::WithSimd for Advise<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { costs, query, field } = self;
        let (columns, rows) = (field.columns as usize, field.rows as usize);
        let Some(tolls) = &query.terrain.tolls else { return };
        let mut multipliers = tolls.multipliers(tolls.unit());
        let words = columns.div_ceil(SIDE);
        // Rows south of the current one, the current one, and north of it, with a column beyond
        // either end.
        let mut lines = [(); 3].map(|()| vec![UNREACHED; words * SIDE + 2]);
        let mut toll = vec![1; columns];
        let mut read = [0; SIDE];
        for row in 0..=rows {
            lines.rotate_left(1);
            if row < rows {
                for word in 0..words {
                    costs.read(row, word, &mut read);
                    lines[2][1 + word * SIDE..][..SIDE].copy_from_slice(&read);
                }
                field.cost[row * columns..][..columns].copy_from_slice(&lines[2][1..=columns]);
            } else {
                lines[2].fill(UNREACHED);
            }
            if row > 0 {
                for (toll, multiplier) in toll.iter_mut().zip(&mut multipliers) {
                    *toll = u32::from(multiplier);
                }
                let code = &mut field.code[(row - 1) * columns..][..columns];
                match query.corners {
                    Corners::Allow => codes::<true>(&lines, &toll, code),
                    Corners::Forbid => codes::<false>(&lines, &toll, code),
                }
                for cells in query.terrain.blocked.runs(row as u32 - 1) {
                    let cells = cells.start as usize..cells.end as usize;
                    code[cells].fill(field::NO_ESCAPE);
                }
            }
        }
    }
}

/// The codes of a row, from its costs and those of the rows around it.
#[inline(always)]
fn codes<const ALLOW: bool>(lines: &[Vec<u32>; 3], toll: &[u32], code: &mut [u8]) {
    let columns = code.len();
    let line = |row: usize, from: usize| &lines[row][from..from + columns];
    let [sw, s, se] = [0, 1, 2].map(|from| line(0, from));
    let [w, here, e] = [0, 1, 2].map(|from| line(1, from));
    let [nw, n, ne] = [0, 1, 2].map(|from| line(2, from));
    let toll = &toll[..columns];
    for x in 0..columns {
        let cost = here[x];
        let (straight, diagonal) = (STRAIGHT_STEP * toll[x], DIAGONAL_STEP * toll[x]);
        let is_good = |there: u32, step: u32| (there.wrapping_add(step) == cost) & (there < cost);
        let passes = |a: u32, b: u32| ALLOW || (a != UNREACHED) & (b != UNREACHED);
        // From the least to the most preferred; each overrides the one before.
        let mut best = u32::from(field::NO_ROUTE);
        let mut offer = |good: bool, direction: Direction| {
            best = if good { direction as u32 } else { best };
        };
        offer(is_good(s[x], straight), Direction::S);
        offer(is_good(w[x], straight), Direction::W);
        offer(is_good(n[x], straight), Direction::N);
        offer(is_good(e[x], straight), Direction::E);
        offer(is_good(se[x], diagonal) & passes(s[x], e[x]), Direction::SE);
        offer(is_good(sw[x], diagonal) & passes(s[x], w[x]), Direction::SW);
        offer(is_good(nw[x], diagonal) & passes(n[x], w[x]), Direction::NW);
        offer(is_good(ne[x], diagonal) & passes(n[x], e[x]), Direction::NE);
        code[x] = if cost == UNREACHED { field::NO_ROUTE } else { best as u8 };
    }
}
