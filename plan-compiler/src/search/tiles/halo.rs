//! What passes between tiles. Before a visit, a tile copies its halo from its neighbours. After it,
//! each neighbour learns which of its rows the tile's edges improve.
//!
//! An offer is exact, so a tile is woken only if it will improve. That bounds the number of visits:
//! each lowers the cost of at least one cell of the tile's edge.

use super::relax::{GAP, Row, cheapest, halves, line, with_halo, within};
use super::{Pending, Tile, Tiles, UNKNOWN};
use crate::search::Corners;
use crate::search::open::{Open, Passable, SIDE, TileOpen};
use plan_format::grid::{DIAGONAL_STEP as DIAGONAL, STRAIGHT_STEP as STRAIGHT};

/// The last row or column of a tile.
const LAST: isize = SIDE as isize - 1;

/// A position in a tile, by row and column.
#[inline(always)]
fn place(row: isize, column: isize) -> usize {
    line(row).wrapping_add_signed(column)
}

/// The edge row or column of a tile on the side of a step: 0 or [`LAST`].
#[inline(always)]
fn edge(step: isize) -> isize {
    if step > 0 { LAST } else { 0 }
}

/// The halo row or column on the side of a step: -1 or 64.
#[inline(always)]
fn beyond(step: isize) -> isize {
    if step > 0 { LAST + 1 } else { -1 }
}

/// Whether the cell of a row that lies east or west of the tile is passable.
#[inline(always)]
fn outer(open: Open, dx: isize) -> bool {
    if dx > 0 { open.east != 0 } else { open.west != 0 }
}

impl Tile {
    /// Copies the columns that the neighbours read.
    #[inline(always)]
    pub(super) fn keep_sides(&mut self) {
        let [west, east] = &mut self.sides;
        for row in -1..=LAST + 1 {
            let at = GAP.wrapping_add_signed(row);
            west[at] = self.cost[place(row, 0)];
            east[at] = self.cost[place(row, LAST)];
        }
    }

    /// The westernmost column (`dx` = -1) or the easternmost (1).
    #[inline(always)]
    fn side(&self, dx: isize) -> &Row {
        &self.sides[usize::from(dx > 0)]
    }
}

impl Tiles {
    /// The tile a step away, if there is one.
    #[inline(always)]
    fn neighbour(&self, [x, y]: [usize; 2], dx: isize, dy: isize) -> Option<usize> {
        let x = x.checked_add_signed(dx)?;
        let y = y.checked_add_signed(dy)?;
        (x < self.across && y < self.down).then_some(y * self.across + x)
    }

    /// A tile that this search has visited.
    #[inline(always)]
    pub(super) fn known(&self, at: usize) -> Option<&Tile> {
        if self.is_stale[at] { None } else { self.tiles.get(at) }
    }

    /// Copies the edges of the neighbouring tiles into the halo. Where a neighbour was not visited,
    /// the halo stays as it was cleared.
    #[inline(always)]
    pub(super) fn pull(&mut self, at: usize) {
        let tile = [at % self.across, at / self.across];
        for dy in -1..=1 {
            for dx in -1..=1 {
                let beside = self.neighbour(tile, dx, dy).filter(|&beside| beside != at);
                let Some(beside) = beside.filter(|&beside| !self.is_stale[beside]) else {
                    continue;
                };
                let Ok([to, from]) = self.tiles.get_disjoint_mut([at, beside]) else { continue };
                if dx == 0 {
                    let source = &from.cost[place(edge(-dy), 0)..][..SIDE];
                    to.cost[place(beyond(dy), 0)..][..SIDE].copy_from_slice(source);
                } else if dy == 0 {
                    for (row, &cost) in (0..).zip(within(from.side(-dx))) {
                        to.cost[place(row, beyond(dx))] = cost;
                    }
                } else {
                    to.cost[place(beyond(dy), beyond(dx))] = from.cost[place(edge(-dy), edge(-dx))];
                }
            }
        }
    }

    /// Wakes the neighbouring tiles that this tile's edges improve.
    #[inline(always)]
    pub(super) fn notify(&mut self, map: &Passable, at: usize, corners: Corners) {
        let tile = [at % self.across, at / self.across];
        let open = map.tile(tile[0], tile[1]);
        for dy in -1..=1 {
            for dx in -1..=1 {
                let Some(to) = self.neighbour(tile, dx, dy).filter(|&to| to != at) else {
                    continue;
                };
                let offer = if dx == 0 {
                    self.offer_row([at, to], dy, open, corners)
                } else if dy == 0 {
                    self.offer_column([at, to], dx, map, corners)
                } else {
                    self.offer_corner([at, to], [dx, dy], open, corners)
                };
                if offer.key.is_some() {
                    self.queue.wake(to, offer);
                }
            }
        }
    }

    /// What the tile's edge row offers to the tile north (`dy` = 1) or south (-1) of it.
    #[inline(always)]
    fn offer_row(
        &self,
        [at, to]: [usize; 2],
        dy: isize,
        open: TileOpen<'_>,
        corners: Corners,
    ) -> Pending {
        let (here, there) = (open.row(beyond(dy)), open.row(edge(dy)));
        let passes = here.passes(there, corners);
        let source = self.tiles[at].cost[place(edge(dy), -1)..].first_chunk();
        let target = match self.known(to) {
            Some(tile) => tile.cost[place(edge(-dy), 0)..].first_chunk(),
            None => Some(&[UNKNOWN; SIDE]),
        };
        let (Some(source), Some(target)) = (source, target) else { return Pending::default() };
        let mut lowest = UNKNOWN;
        for half in 0..2 {
            let passes = halves(passes, half);
            for lane in 0..32 {
                let x = half * 32 + lane;
                let cost = cheapest(source, x, passes, 1 << lane);
                lowest = lowest.min(if cost < target[x] { cost } else { UNKNOWN });
            }
        }
        self.offer(edge(-dy), dy > 0, lowest)
    }

    /// What the tile's edge column offers to the tile east (`dx` = 1) or west (-1) of it.
    #[inline(always)]
    fn offer_column(
        &self,
        [at, to]: [usize; 2],
        dx: isize,
        map: &Passable,
        corners: Corners,
    ) -> Pending {
        let source = with_halo(self.tiles[at].side(dx));
        let target = self.known(to).map_or(&[UNKNOWN; SIDE], |to| within(to.side(-dx)));
        let [open, south, north] = map.side(to, -dx).passes(map.side(at, dx), corners);
        // Other tiles offer what lies beyond the column.
        let passes = [open, south & !1, north & !(1 << LAST)];
        let mut result = Pending::default();
        let mut lowest = UNKNOWN;
        for half in 0..2 {
            let passes = halves(passes, half);
            let (mut from_south, mut from_north) = (0, 0);
            for lane in 0..32 {
                let (row, bit) = (half * 32 + lane, 1u32 << lane);
                let [open, south, north] = passes.map(|mask| mask & bit != 0);
                let level = source[row + 1] + STRAIGHT;
                let south = if south { source[row] + DIAGONAL } else { UNKNOWN };
                let north = if north { source[row + 2] + DIAGONAL } else { UNKNOWN };
                let cost = level.min(south).min(north);
                let is_better = open & (cost < target[row]);
                lowest = lowest.min(if is_better { cost } else { UNKNOWN });
                // A straight step across works in either sweep, and best in the one that comes from
                // lower costs. A diagonal step works only in the sweep that comes from its row.
                let is_northward =
                    if level == cost { source[row] <= source[row + 2] } else { south <= north };
                from_south |= if is_better & is_northward { bit } else { 0 };
                from_north |= if is_better & !is_northward { bit } else { 0 };
            }
            result.from_south |= u64::from(from_south) << (32 * half);
            result.from_north |= u64::from(from_north) << (32 * half);
        }
        result.key = (lowest != UNKNOWN).then_some(lowest);
        result
    }

    /// What the tile's corner offers to the tile diagonally beside it.
    #[inline(always)]
    fn offer_corner(
        &self,
        [at, to]: [usize; 2],
        [dx, dy]: [isize; 2],
        open: TileOpen<'_>,
        corners: Corners,
    ) -> Pending {
        let (here, there) = (open.row(beyond(dy)), open.row(edge(dy)));
        let passes =
            corners == Corners::Allow || (here.cells >> edge(dx) & 1 != 0 && outer(there, dx));
        let cost = self.tiles[at].cost[place(edge(dy), edge(dx))] + DIAGONAL;
        let old = self.known(to).map_or(UNKNOWN, |to| to.cost[place(edge(-dy), edge(-dx))]);
        let is_better = passes && outer(here, dx) && cost < old;
        self.offer(edge(-dy), dy > 0, if is_better { cost } else { UNKNOWN })
    }

    /// An offer for one row, to be relaxed from the south or from the north; `None` if the cost is
    /// unknown.
    #[inline(always)]
    fn offer(&self, row: isize, northward: bool, cost: u32) -> Pending {
        let key = (cost != UNKNOWN).then_some(cost);
        Pending {
            from_south: u64::from(northward) << row,
            from_north: u64::from(!northward) << row,
            key,
        }
    }
}
