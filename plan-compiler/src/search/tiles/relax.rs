//! Relaxing a row of a tile: 64 cells at once.
//!
//! A row is first lowered by the steps from the row before it: three neighbours, all columns at once,
//! which the compiler turns into vector instructions. Then it is lowered by steps along itself. The
//! invariant is that a row is *closed*: no step along it improves it. Keeping it closed seems to need
//! a scan, column after column. It rarely does:
//!
//! - Let two rows be closed, and one be lowered by steps from the other. A cell lowered to
//!   `c` from a neighbour in the other row offers `c + straight` to the next cell of its own
//!   row. That cell has a diagonal step of its own from the same neighbour or from the cell
//!   beside that one; the other row being closed, and a diagonal shorter than two straight
//!   steps, this is at least as good. So the lowered row is closed already, except where an
//!   obstacle takes the diagonal away, which is at the ends of obstacles in the other row
//!   ([`ends`]). There, and at the halo, the step along the row is tried, and followed for as
//!   long as it improves cells ([`spread_east`]).
//! - In a row without obstacles, a cost from the halo spreads as a ramp over the whole row, again all
//!   columns at once.
//!
//! After a row has changed, the row after it must be relaxed. The row that it was lowered from needs
//! another look only if a step along the row was used: steps from the other row alone never lead back
//! to it with profit, because it was closed.

#[cfg(target_arch = "x86_64")]
mod avx512;

use super::UNKNOWN;
use crate::search::Corners;
use crate::search::open::{Open, SIDE, TileOpen};
use plan_format::grid::{DIAGONAL_STEP as DIAGONAL, STRAIGHT_STEP as STRAIGHT};
use pulp::Simd;

/// Cells between one row of a tile and the next: one cache line, so that rows are aligned. The first
/// is the halo east of the one row, the last the halo west of the other.
pub(super) const GAP: usize = 16;

/// From one row of a tile to the next.
const STRIDE: usize = SIDE + GAP;
/// Cells of a tile with its halo, and before them the gap that the first row has too.
pub(super) const CELLS: usize = GAP + STRIDE * (SIDE + 2);
/// The cells of a row and the gaps on both sides of it.
pub(super) type Row = [u32; GAP + SIDE + GAP];

/// Where a row of a tile starts; rows -1 and 64 are the halo. Columns -1 and 64 are too.
#[inline(always)]
pub(super) const fn line(row: isize) -> usize {
    GAP + STRIDE * (row + 1) as usize
}

const _: () = assert!(
    UNKNOWN as u64 + DIAGONAL as u64 + (SIDE as u64 + 1) * STRAIGHT as u64 <= u32::MAX as u64,
    "steps from unknown cells do not overflow"
);
const _: () = assert!(STRAIGHT < DIAGONAL && DIAGONAL < 2 * STRAIGHT, "the arguments above");

/// A straight step for every column up to here.
const RAMP: [u32; SIDE] = {
    let mut ramp = [0; SIDE];
    let mut column = 1;
    while column < SIDE {
        ramp[column] = ramp[column - 1] + STRAIGHT;
        column += 1;
    }
    ramp
};

/// The result of relaxing a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relaxed {
    /// The row after it should be relaxed from it.
    pub(super) has_changed: bool,
    /// The row before it should be relaxed from it, too.
    pub(super) leads_back: bool,
}

/// Lowers a row by the steps from the row `before` it, on either side, and along itself.
#[inline(always)]
pub(super) fn relax<S: Simd>(
    simd: S,
    cost: &mut [u32; CELLS],
    open: TileOpen<'_>,
    row: usize,
    before: isize,
    corners: Corners,
) -> Relaxed {
    let (here, there) = (open.row(row as isize), open.row(before));
    let (row, before) = (line(row as isize), line(before));
    let is_plain = here.cells & there.cells == u64::MAX
        && there.west & !here.west == 0
        && there.east & !here.east == 0;
    if is_plain {
        relax_plain(cost, row, before)
    } else {
        relax_masked(simd, cost, row, before, [here, there], corners)
    }
}

/// A row to lower and the row before it, out of one tile.
#[inline(always)]
fn pair(cost: &mut [u32; CELLS], row: usize, before: usize) -> (&mut [u32; SIDE], &Row) {
    let [row, source] = [row, before - GAP];
    let (target, source) = if row < source {
        let (low, high) = cost.split_at_mut(source);
        (low[row..].first_chunk_mut(), high.first_chunk())
    } else {
        let (low, high) = cost.split_at_mut(row);
        (high.first_chunk_mut(), low[source..].first_chunk())
    };
    let (Some(target), Some(source)) = (target, source) else { unreachable_row() };
    (target, source)
}

/// A row with its halo.
#[inline(always)]
pub(super) fn with_halo(row: &Row) -> &[u32; SIDE + 2] {
    let Some(row) = row[GAP - 1..].first_chunk() else { unreachable_row() };
    row
}

/// A row without its halo.
#[inline(always)]
pub(super) fn within(row: &Row) -> &[u32; SIDE] {
    let Some(row) = row[GAP..].first_chunk() else { unreachable_row() };
    row
}

/// Relaxes a row without obstacles from another. A halo cell of the row may be closed only if
/// the one beside it is, so no diagonal from the halo is forbidden.
#[inline(always)]
fn relax_plain(cost: &mut [u32; CELLS], row: usize, before: usize) -> Relaxed {
    let halo = [cost[row - 1], cost[row + SIDE]];
    let (target, source) = pair(cost, row, before);
    let source = with_halo(source);
    // Also the diagonals from the halo of the row before, which may be newer than the halo with which
    // that row was closed.
    let west = (halo[0] + STRAIGHT).min(source[0] + DIAGONAL);
    let east = (halo[1] + STRAIGHT).min(source[SIDE + 1] + DIAGONAL);
    let mut has_changed = false;
    for x in 0..SIDE {
        let straight = source[x + 1] + STRAIGHT;
        let diagonal = source[x].min(source[x + 2]) + DIAGONAL;
        let along = (west + RAMP[x]).min(east + RAMP[SIDE - 1 - x]);
        let old = target[x];
        let new = straight.min(diagonal).min(along).min(old);
        has_changed |= new != old;
        target[x] = new;
    }
    let leads_back = is_source(halo[0], source[0]) || is_source(halo[1], source[SIDE + 1]);
    Relaxed { has_changed, leads_back: has_changed && leads_back }
}

/// Whether a halo cell leads into the neighbouring open row at a lower cost than that row's own halo
/// cell: whether it is cheaper by more than the difference of a diagonal and a straight step.
#[inline(always)]
fn is_source(halo: u32, beside: u32) -> bool {
    halo + (DIAGONAL - STRAIGHT) < beside
}

/// Relaxes a row with obstacles.
#[inline(always)]
fn relax_masked<S: Simd>(
    simd: S,
    cost: &mut [u32; CELLS],
    row: usize,
    before: usize,
    [here, there]: [Open; 2],
    corners: Corners,
) -> Relaxed {
    let (target, source) = pair(cost, row, before);
    let changed = step_over(simd, target, source, here.passes(there, corners));
    let mut leads_back = false;
    // A cost from the halo leads back as in a row without obstacles, as far as the row before has no
    // obstacles either.
    let reached = spread_east(cost, row, -1, here.cells);
    if reached != 0 {
        let is_clear = !there.cells & (u64::MAX >> (63 - reached.min(63))) == 0;
        leads_back |= !is_clear || is_source(cost[row - 1], cost[before - 1]);
    }
    let reached_west = spread_west(cost, row, SIDE as isize, here.cells);
    if reached_west != 0 {
        let is_clear = !there.cells & (u64::MAX << (63 - reached_west.min(63))) == 0;
        leads_back |= !is_clear || is_source(cost[row + SIDE], cost[before + SIDE]);
    }
    let has_changed = changed || reached | reached_west != 0;
    if changed {
        leads_back |= close(simd, cost, row, here, ends(here, there, corners));
        // Between two obstacles, a route may go down and up again.
        leads_back |= corners == Corners::Allow && here.cells & !there.cells != 0;
    }
    Relaxed { has_changed, leads_back }
}

/// Lowers a row by the steps from the row before it, into the cells that may be entered
/// straight, from the west and from the east. Returns whether that changed it.
#[inline(always)]
#[cfg_attr(not(target_arch = "x86_64"), expect(unused_variables))]
fn step_over<S: Simd>(simd: S, target: &mut [u32; SIDE], source: &Row, passes: [u64; 3]) -> bool {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = avx512::of(simd) {
        return avx512::step_over(simd, target, source, passes);
    }
    let source = with_halo(source);
    let mut has_changed = false;
    for half in 0..2 {
        let passes = halves(passes, half);
        for lane in 0..32 {
            let x = half * 32 + lane;
            let old = target[x];
            let new = cheapest(source, x, passes, 1 << lane).min(old);
            has_changed |= new != old;
            target[x] = new;
        }
    }
    has_changed
}

/// One half of some masks: words of 32 bits, so that a vector has as many test bits as costs.
#[inline(always)]
pub(super) fn halves(masks: [u64; 3], half: usize) -> [u32; 3] {
    masks.map(|mask| (mask >> (32 * half)) as u32)
}

/// The cost of entering column `x` from the row `source`, which starts at column -1. The
/// `bit` is that of the column in the masks of cells that may be entered straight, from the
/// west and from the east.
#[inline(always)]
pub(super) fn cheapest(source: &[u32; SIDE + 2], x: usize, passes: [u32; 3], bit: u32) -> u32 {
    let [open, west, east] = passes.map(|mask| mask & bit != 0);
    let from_west = if west { source[x] } else { UNKNOWN };
    let from_east = if east { source[x + 2] } else { UNKNOWN };
    let straight = if open { source[x + 1] } else { UNKNOWN };
    (straight + STRAIGHT).min(from_west.min(from_east) + DIAGONAL)
}

/// The cells from which a step east, and a step west, along the row may lower a cost after the row
/// was lowered from the row `there`: where an obstacle in that row takes a diagonal away. The outer
/// cells may have been lowered from a halo newer than that row.
#[inline(always)]
fn ends(here: Open, there: Open, corners: Corners) -> [u64; 2] {
    let [eastward, westward] = match corners {
        Corners::Forbid => [there.cells & !there.east_open(), there.cells & !there.west_open()],
        Corners::Allow => [!there.cells; 2],
    };
    [here.cells & (eastward | 1), here.cells & (westward | 1 << 63)]
}

/// Closes a row by following the steps east and west from some cells. Returns whether that
/// changed it.
#[inline(always)]
fn close<S: Simd>(
    simd: S,
    cost: &mut [u32; CELLS],
    row: usize,
    here: Open,
    ends: [u64; 2],
) -> bool {
    let [mut eastward, mut westward] = ends;
    // Testing all columns at once costs as much as testing a few one by one.
    if (eastward | westward).count_ones() > 14 {
        let Some(cost) = cost[row - GAP..].first_chunk() else { unreachable_row() };
        let [east, west] = slopes(simd, cost);
        eastward &= east;
        westward &= west;
    }
    let mut reached = 0;
    while eastward != 0 {
        reached |= spread_east(cost, row, eastward.trailing_zeros() as isize, here.cells);
        eastward &= eastward - 1;
    }
    while westward != 0 {
        let x = 63 - westward.leading_zeros();
        reached |= spread_west(cost, row, x as isize, here.cells);
        westward &= !(1 << x);
    }
    reached != 0
}

/// The columns whose cost is more than a straight step below that of the next column east,
/// and west.
#[inline(always)]
#[cfg_attr(not(target_arch = "x86_64"), expect(unused_variables))]
fn slopes<S: Simd>(simd: S, row: &Row) -> [u64; 2] {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = avx512::of(simd) {
        return avx512::slopes(simd, row);
    }
    let row = with_halo(row);
    let [mut east, mut west] = [[0u32; 2]; 2];
    for half in 0..2 {
        let (mut lower_east, mut lower_west) = (0, 0);
        for lane in 0..32 {
            let x = half * 32 + lane;
            let next = row[x + 1] + STRAIGHT;
            lower_east |= if next < row[x + 2] { 1u32 << lane } else { 0 };
            lower_west |= if next < row[x] { 1u32 << lane } else { 0 };
        }
        east[half] = lower_east;
        west[half] = lower_west;
    }
    [east, west].map(|[low, high]| u64::from(low) | u64::from(high) << 32)
}

/// Follows the steps east from a column, which may be the halo, for as long as they improve
/// open cells. Returns how many they improved.
#[inline(always)]
pub(super) fn spread_east(cost: &mut [u32; CELLS], row: usize, x: isize, open: u64) -> usize {
    let first = (x + 1) as usize;
    let mut value = cost[row + first - 1] + STRAIGHT;
    let mut at = first;
    while at < SIDE && open >> at & 1 != 0 && value < cost[row + at] {
        cost[row + at] = value;
        value += STRAIGHT;
        at += 1;
    }
    at - first
}

/// Follows the steps west from a column, as [`spread_east`] does east.
#[inline(always)]
pub(super) fn spread_west(cost: &mut [u32; CELLS], row: usize, x: isize, open: u64) -> usize {
    let first = x as usize;
    let mut value = cost[row + first] + STRAIGHT;
    let mut at = first;
    while at > 0 && open >> (at - 1) & 1 != 0 && value < cost[row + at - 1] {
        at -= 1;
        cost[row + at] = value;
        value += STRAIGHT;
    }
    first - at
}

/// Rows lie inside their tile by [`CELLS`] and [`line`].
#[cold]
fn unreachable_row() -> ! {
    unreachable!("a row lies inside its tile")
}
