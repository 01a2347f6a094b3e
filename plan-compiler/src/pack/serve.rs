//! Which cells of a block a root serves, for all 64 cells at a time.

use super::moves::Bordered;
use plan_format::grid::{Cell, DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::layout::BLOCK_CELLS;
use plan_format::layout::Root;

/// The properties of a block's cells that decide which roots serve them.
pub(crate) struct BlockCells {
    column: i32,
    row: i32,
    cost: [i32; BLOCK_CELLS],
    /// For each direction, the cells that may move there.
    moves: [u64; 8],
    /// Cells that may refer to a root at all.
    pub(crate) routed: u64,
}

/// The lowest bit of each byte.
const BYTES: u64 = 0x0101_0101_0101_0101;

/// What a diagonal step saves over two straight ones.
const SAVED: i32 = (2 * STRAIGHT_STEP - DIAGONAL_STEP) as i32;

impl BlockCells {
    /// The cells in `routed` of the block with this south-west cell.
    #[inline(always)]
    pub(crate) fn new(bordered: &Bordered, corner: Cell, routed: u64) -> Self {
        let mut cost = [-1; BLOCK_CELLS];
        let mut moves = [0; 8];
        let rows = cost.as_chunks_mut::<8>().0;
        for ((y, cost), routed) in rows.iter_mut().enumerate().zip(routed.to_le_bytes()) {
            if routed == 0 {
                continue;
            }
            let start = bordered.index(corner.column as usize, corner.row as usize + y);
            let end = bordered.cost.len().min(start + 8);
            for (cost, &given) in cost.iter_mut().zip(&bordered.cost[start..end]) {
                *cost = given as i32;
            }
            let mut bits = [0; 8];
            bits[..end - start].copy_from_slice(&bordered.moves[start..end]);
            for (direction, moves) in moves.iter_mut().enumerate() {
                *moves |= gather(u64::from_le_bytes(bits) >> direction & BYTES) << (8 * y);
            }
        }
        Self { column: corner.column as i32, row: corner.row as i32, cost, moves, routed }
    }

    /// The cells that may refer to a root: with diagonal steps first, and with straight steps
    /// first.
    #[inline(always)]
    pub(crate) fn served_by(&self, root: Root) -> [u64; 2] {
        // Towards the root, from each column and each row of the block.
        let dx: [i32; 8] =
            std::array::from_fn(|x| root.cell.column as i32 - self.column - x as i32);
        let dy: [i32; 8] = std::array::from_fn(|y| root.cell.row as i32 - self.row - y as i32);
        let straight = self.straight(root, dx, dy);
        if straight == 0 {
            return [0; 2];
        }
        let columns =
            |is: fn(i32) -> bool| (0..8).fold(0, |m, x| m | u64::from(is(dx[x])) << x) * BYTES;
        let rows = |is: fn(i32) -> bool| {
            (0..8).fold(0, |mask, y| mask | (255 * u64::from(is(dy[y]))) << (8 * y))
        };
        let (east, west) = (columns(|dx| dx > 0), columns(|dx| dx < 0));
        let (north, south) = (rows(|dy| dy > 0), rows(|dy| dy < 0));
        let (flat, upright) = (!north & !south, !east & !west);
        let [e, ne, n, nw, w, sw, s, se] = self.moves;
        let along_row = east & e | west & w;
        let along_column = north & n | south & s;
        let diagonal = east & (north & ne | south & se) | west & (north & nw | south & sw);
        let goal = if root.cost == 0 { flat & upright } else { 0 };
        let both = straight & (goal | flat & along_row | upright & along_column);
        if straight & !flat & !upright == 0 {
            return [both; 2];
        }
        let [wide, high] = longer(dx[0], dy);
        let straight_first = wide & along_row | high & along_column | !wide & !high & diagonal;
        [both | straight & diagonal, both | straight & !flat & !upright & straight_first]
    }

    /// The cells whose cost equals that of a route to the root without obstacles.
    #[inline(always)]
    fn straight(&self, root: Root, dx: [i32; 8], dy: [i32; 8]) -> u64 {
        let long = dx.map(|dx| dx.wrapping_abs().wrapping_mul(STRAIGHT_STEP as i32));
        let saved = dx.map(|dx| dx.wrapping_abs().wrapping_mul(SAVED));
        let mut straight = 0;
        for (y, cost) in self.cost.as_chunks::<8>().0.iter().enumerate() {
            let high = (root.cost as i32)
                .wrapping_add(dy[y].wrapping_abs().wrapping_mul(STRAIGHT_STEP as i32));
            let saved_high = dy[y].wrapping_abs().wrapping_mul(SAVED);
            let mut equal = [0u8; 8];
            for x in 0..8 {
                let saved = saved[x].min(saved_high);
                equal[x] = u8::from(high.wrapping_add(long[x]).wrapping_sub(saved) == cost[x]);
            }
            straight |= gather(u64::from_le_bytes(equal)) << (8 * y);
        }
        straight & self.routed
    }
}

/// The cells that are farther from a root in columns than in rows, and the reverse. `east` is the
/// distance of the root from the first column, `north` from each row.
#[inline(always)]
fn longer(east: i32, north: [i32; 8]) -> [u64; 2] {
    // A row whose first `columns` bits are set.
    let first = |columns: i32| (1u64 << columns.clamp(0, 8)) - 1;
    let (mut wide, mut high) = (0, 0);
    for (y, north) in north.into_iter().enumerate() {
        // In columns from `west` to `east` the distance in columns is at most that in rows.
        let (west, east) = (east - north.abs(), east + north.abs());
        wide |= (first(west) | 255 & !first(east + 1)) << (8 * y);
        high |= (first(east) & !first(west + 1)) << (8 * y);
    }
    [wide, high]
}

/// Eight bytes of 0 or 1 as eight bits.
#[inline(always)]
pub(crate) fn gather(bytes: u64) -> u64 {
    bytes.wrapping_mul(0x0102_0408_1020_4080) >> 56
}
