//! Uniform-cost search over cells with tolls by tiles of 64 x 64 cells, a row of a tile at a time.
//!
//! As [`super::tiles`]: tiles wait in a queue by the lowest cost that an edge of another tile offers
//! them, a visit sweeps north and south until no row waits, and when no tile waits, no step anywhere
//! improves a cost. So the field is exact, and the order of visits decides the time only.
//!
//! With tolls there is no shortcut for steps along a row: after each relaxation, all columns at once
//! are tested for a step east or west that improves the next cell, and such steps are followed. A row
//! that was lowered may lower the row that it was lowered from, around a dear cell, so both of its
//! neighbours are relaxed from it.
//!
//! The search runs from the goal, so a step costs by the factor of the cell that it enters; see
//! [`super::tolled`].
//!
//! Costs of all tiles are one array, with one cache line between two rows: its first cell lies east
//! of the one row and its last cell west of the other. The number of lines of a row is odd, so that
//! the rows of a tile do not compete for the same part of the cache.

use super::advice::Rows;
use super::open::{Open, Passable, SIDE};
use super::queue::{Pending, Queue};
use super::{Corners, MAX_COST, Vectors};
use crate::field::UNREACHED;
use crate::tolls::{MOST, Tolls};
use plan_format::Cell;
use plan_format::grid::{DIAGONAL_STEP as DIAGONAL, STRAIGHT_STEP as STRAIGHT};

/// The cost of a cell that is not reached yet, or not passable.
const UNKNOWN: u32 = MAX_COST + 1;
/// Cells between one row and the next: one cache line.
const GAP: usize = 16;

const _: () = assert!(UNKNOWN.checked_add(DIAGONAL * MOST).is_some(), "no step overflows");

impl Pending {
    /// Adds a cell that may be lowered to a cost, by its row.
    #[inline(always)]
    fn add(&mut self, row: usize, cost: u32, [from_south, from_north]: [bool; 2]) {
        self.from_south |= u64::from(from_south) << row;
        self.from_north |= u64::from(from_north) << row;
        self.key = Some(self.key.map_or(cost, |key| key.min(cost)));
    }
}

/// The search and its buffers, which are reused from search to search.
#[derive(Debug, Default)]
pub(crate) struct TolledTiles {
    /// Tiles from west to east and from south to north.
    across: usize,
    down: usize,
    /// Cells from one row to the next.
    stride: usize,
    costs: Vec<u32>,
    /// What steps into each cell are multiplied by.
    multipliers: Vec<u16>,
    queue: Queue,
}

impl TolledTiles {
    /// Finds the cheapest routes to any of the goals, which are open cells.
    pub(crate) fn search(
        &mut self,
        open: &Passable,
        tolls: &Tolls,
        goals: &[Cell],
        corners: Corners,
        vectors: Vectors,
    ) {
        self.reset(open, tolls);
        for goal in goals {
            let (x, y) = (goal.column as usize, goal.row as usize);
            let at = self.index(x as isize, y as isize);
            self.costs[at] = 0;
            // The goal's row spreads when it is relaxed, from either side.
            let mut offer = Pending::default();
            for row in (y % SIDE).saturating_sub(1)..=(y % SIDE + 1).min(SIDE - 1) {
                offer.add(row, 0, [true; 2]);
            }
            self.queue.wake(y / SIDE * self.across + x / SIDE, offer);
            // Of a goal on the edge of its tile, the other tiles learn after the first visit.
        }
        vectors.run(Run { tiles: self, open, corners });
    }

    fn reset(&mut self, open: &Passable, tolls: &Tolls) {
        self.across = open.columns.div_ceil(SIDE);
        self.down = open.rows.div_ceil(SIDE);
        self.stride = self.across * SIDE + GAP;
        let cells = self.stride * (self.down * SIDE + 2) + GAP;
        self.costs.clear();
        self.costs.resize(cells, UNKNOWN);
        self.multipliers.clear();
        self.multipliers.resize(cells, 1);
        let mut all = tolls.multipliers(tolls.unit());
        for row in 0..open.rows {
            let start = self.index(0, row as isize);
            for (to, multiplier) in
                self.multipliers[start..][..open.columns].iter_mut().zip(&mut all)
            {
                *to = multiplier;
            }
        }
        self.queue.reset(self.across * self.down);
    }

    /// Where a cell is stored; one row and one column beyond the tiles are, too.
    #[inline(always)]
    fn index(&self, x: isize, y: isize) -> usize {
        (GAP + (y + 1) as usize * self.stride).wrapping_add_signed(x)
    }

    #[inline(always)]
    fn visit_all(&mut self, open: &Passable, corners: Corners) {
        while let Some((at, pending)) = self.queue.next() {
            self.visit(open, at, pending, corners);
            self.notify(open, at, corners);
        }
    }

    /// Lowers the costs of a tile as far as its cells and those around it allow.
    #[inline(always)]
    fn visit(&mut self, open: &Passable, at: usize, pending: Pending, corners: Corners) {
        let Pending { mut from_south, mut from_north, .. } = pending;
        let (word, south) = (at % self.across, at / self.across * SIDE);
        let all = u64::MAX >> (SIDE - (open.rows - south).min(SIDE));
        while (from_south | from_north) & all != 0 {
            from_south &= all;
            while from_south != 0 {
                let row = from_south.trailing_zeros() as usize;
                from_south &= from_south - 1;
                let y = (south + row) as isize;
                if self.relax(open, word, y, y - 1, corners) {
                    from_south |= 1 << row << 1 & all;
                    from_north |= 1 << row >> 1;
                }
            }
            from_north &= all;
            while from_north != 0 {
                let row = 63 - from_north.leading_zeros() as usize;
                from_north &= !(1 << row);
                let y = (south + row) as isize;
                if self.relax(open, word, y, y + 1, corners) {
                    from_north |= 1 << row >> 1;
                    from_south |= 1 << row << 1 & all;
                }
            }
        }
    }

    /// Lowers a row of a tile by the steps from the row `before` it, on either side, and along itself.
    /// Returns whether that changed it.
    #[inline(always)]
    fn relax(
        &mut self,
        open: &Passable,
        word: usize,
        y: isize,
        before: isize,
        corners: Corners,
    ) -> bool {
        let (here, there) = (open.at(word, y), open.at(word, before));
        if here.cells == 0 {
            return false;
        }
        let x = (word * SIDE) as isize;
        let (row, source) = (self.index(x, y) - 1, self.index(x, before) - 1);
        let (target, source): (&mut [u32], &[u32]) = if row < source {
            let (low, high) = self.costs.split_at_mut(source);
            (&mut low[row..], high)
        } else {
            let (low, high) = self.costs.split_at_mut(row);
            (high, &low[source..])
        };
        let multipliers = &self.multipliers[row..];
        let (Some(target), Some(source), Some(multipliers)) =
            (target.first_chunk_mut(), source.first_chunk(), multipliers.first_chunk())
        else {
            return false;
        };
        let changed = step_over(target, source, multipliers, here.passes(there, corners));
        let slopes = slopes(target, multipliers, here);
        let moved = spread(target, multipliers, here.cells, slopes);
        changed | moved
    }

    /// Wakes the neighbouring tiles that this tile's edges improve.
    #[inline(always)]
    fn notify(&mut self, open: &Passable, at: usize, corners: Corners) {
        let [x, y] = [at % self.across, at / self.across].map(|tile| (tile * SIDE) as isize);
        let last = SIDE as isize - 1;
        let beside = |dx: isize, dy: isize| {
            let tile = [at % self.across, at / self.across];
            let x = tile[0].checked_add_signed(dx).filter(|&x| x < self.across)?;
            let y = tile[1].checked_add_signed(dy).filter(|&y| y < self.down)?;
            Some(y * self.across + x)
        };
        let mut offers = [(0, Pending::default()); 8];
        let mut count = 0;
        for dy in [-1, 0, 1] {
            for dx in [-1, 0, 1] {
                let Some(to) = beside(dx, dy).filter(|&to| to != at) else { continue };
                let far = |step: isize| if step > 0 { last + 1 } else { -1 };
                let offer = match (dx, dy) {
                    (0, _) => self.offer_row(open, [x, y + far(dy)], dy, corners),
                    (_, 0) => self.offer_column(open, [x + far(dx), y], dx, corners),
                    _ => self.offer_corner(open, [x + far(dx), y + far(dy)], [dx, dy], corners),
                };
                offers[count] = (to, offer);
                count += 1;
            }
        }
        for (to, offer) in offers.into_iter().take(count) {
            if offer.key.is_some() {
                self.queue.wake(to, offer);
            }
        }
    }

    /// What an edge row offers to the row beyond it.
    #[inline(always)]
    fn offer_row(
        &self,
        open: &Passable,
        [x, y]: [isize; 2],
        dy: isize,
        corners: Corners,
    ) -> Pending {
        let word = x as usize / SIDE;
        let passes = open.at(word, y).passes(open.at(word, y - dy), corners);
        let (row, source) = (self.index(x, y) - 1, self.index(x, y - dy) - 1);
        let mut offer = Pending::default();
        let (Some(target), Some(source), Some(multipliers)) = (
            self.costs[row..].first_chunk::<{ SIDE + 2 }>(),
            self.costs[source..].first_chunk(),
            self.multipliers[row..].first_chunk(),
        ) else {
            return offer;
        };
        let mut lowered = *target;
        if step_over(&mut lowered, source, multipliers, passes) {
            let lowest = lowered.iter().zip(target).filter(|(new, old)| new < old);
            let lowest = lowest.map(|(&new, _)| new).min().unwrap_or(UNKNOWN);
            offer.add(y as usize % SIDE, lowest, [dy > 0, dy < 0]);
        }
        offer
    }

    /// What an edge column offers to the column beyond it.
    #[inline(always)]
    fn offer_column(
        &self,
        open: &Passable,
        [x, y]: [isize; 2],
        dx: isize,
        corners: Corners,
    ) -> Pending {
        let word = x as usize / SIDE;
        let from = (x - dx) as usize;
        let mut offer = Pending::default();
        let is_open = |x: usize, row: Open| row.cells >> (x % SIDE) & 1 != 0;
        let rows = (open.rows as isize - y).min(SIDE as isize);
        for row in y..y + rows {
            let at = self.index(x, row);
            if !is_open(x as usize, open.at(word, row)) {
                continue;
            }
            let multiplier = u32::from(self.multipliers[at]);
            let level = self.costs[self.index(x - dx, row)] + STRAIGHT * multiplier;
            let mut cost = level;
            let mut sides = [true; 2];
            for (side, dy) in [-1, 1].into_iter().enumerate() {
                // Other tiles offer what lies beyond the column.
                let inside = (y..y + rows).contains(&(row + dy));
                let passes = corners == Corners::Allow
                    || (is_open(x as usize, open.at(word, row + dy))
                        && is_open(from, open.at(from / SIDE, row)));
                if inside && passes {
                    let diagonal = self.costs[self.index(x - dx, row + dy)] + DIAGONAL * multiplier;
                    if diagonal < cost {
                        cost = diagonal;
                        // Works only in the sweep that comes from its row.
                        sides = [side == 0, side == 1];
                    }
                }
            }
            if cost < self.costs[at] {
                offer.add(row as usize % SIDE, cost, sides);
            }
        }
        offer
    }

    /// What a corner offers to the cell diagonally beyond it.
    #[inline(always)]
    fn offer_corner(
        &self,
        open: &Passable,
        [x, y]: [isize; 2],
        [dx, dy]: [isize; 2],
        corners: Corners,
    ) -> Pending {
        let is_open = |x: isize, y: isize| {
            let x = x as usize;
            open.at(x / SIDE, y).cells >> (x % SIDE) & 1 != 0
        };
        let passes = corners == Corners::Allow || (is_open(x - dx, y) && is_open(x, y - dy));
        let at = self.index(x, y);
        let cost =
            self.costs[self.index(x - dx, y - dy)] + DIAGONAL * u32::from(self.multipliers[at]);
        let mut offer = Pending::default();
        if passes && is_open(x, y) && cost < self.costs[at] {
            offer.add(y as usize % SIDE, cost, [dy > 0, dy < 0]);
        }
        offer
    }
}

/// 64 columns of a row with a column beyond either end.
type Columns<T> = [T; SIDE + 2];

/// Lowers a row by the steps from another, into the cells that may be entered straight, from the west
/// and from the east. Returns whether that changed it.
#[inline(always)]
fn step_over(
    target: &mut Columns<u32>,
    source: &Columns<u32>,
    multipliers: &Columns<u16>,
    passes: [u64; 3],
) -> bool {
    let mut has_changed = false;
    for half in 0..2 {
        let passes = passes.map(|mask| (mask >> (32 * half)) as u32);
        for lane in 0..32 {
            let x = half * 32 + lane;
            let [open, west, east] = passes.map(|mask| mask & (1 << lane) != 0);
            let multiplier = u32::from(multipliers[x + 1]);
            let from_west = if west { source[x] } else { UNKNOWN };
            let from_east = if east { source[x + 2] } else { UNKNOWN };
            let straight = if open { source[x + 1] } else { UNKNOWN };
            let diagonal = from_west.min(from_east) + DIAGONAL * multiplier;
            let old = target[x + 1];
            let new = (straight + STRAIGHT * multiplier).min(diagonal).min(old);
            has_changed |= new != old;
            target[x + 1] = new;
        }
    }
    has_changed
}

/// The open columns that a step from the next column west, and from the next column east, improves.
#[inline(always)]
fn slopes(row: &Columns<u32>, multipliers: &Columns<u16>, here: Open) -> [u64; 2] {
    let [mut east, mut west] = [[0u32; 2]; 2];
    for half in 0..2 {
        let (mut from_west, mut from_east) = (0, 0);
        for lane in 0..32 {
            let x = half * 32 + lane;
            let step = STRAIGHT * u32::from(multipliers[x + 1]);
            from_west |= if row[x] + step < row[x + 1] { 1u32 << lane } else { 0 };
            from_east |= if row[x + 2] + step < row[x + 1] { 1u32 << lane } else { 0 };
        }
        east[half] = from_west;
        west[half] = from_east;
    }
    [east, west].map(|[low, high]| (u64::from(low) | u64::from(high) << 32) & here.cells)
}

/// Follows the steps along a row into these columns for as long as they improve open cells. Returns
/// whether there were any.
#[inline(always)]
fn spread(
    row: &mut Columns<u32>,
    multipliers: &Columns<u16>,
    open: u64,
    [mut eastward, mut westward]: [u64; 2],
) -> bool {
    let has_changed = eastward | westward != 0;
    while eastward != 0 {
        let mut x = eastward.trailing_zeros() as usize;
        while x < SIDE && open >> x & 1 != 0 {
            let cost = row[x] + STRAIGHT * u32::from(multipliers[x + 1]);
            if cost >= row[x + 1] {
                break;
            }
            row[x + 1] = cost;
            x += 1;
        }
        // The columns before x are done.
        eastward &= u64::MAX.checked_shl(x as u32 + 1).unwrap_or(0);
    }
    while westward != 0 {
        let mut x = 63 - westward.leading_zeros() as usize;
        loop {
            let cost = row[x + 2] + STRAIGHT * u32::from(multipliers[x + 1]);
            if open >> x & 1 == 0 || cost >= row[x + 1] {
                break;
            }
            row[x + 1] = cost;
            if x == 0 {
                break;
            }
            x -= 1;
        }
        westward &= !(u64::MAX << x);
    }
    has_changed
}

/// The search itself, compiled once for each kind of vector unit.
struct Run<'a> {
    tiles: &'a mut TolledTiles,
    open: &'a Passable,
    corners: Corners,
}

impl pulp::WithSimd for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { tiles, open, corners } = self;
        // The corner rule is a constant in each branch, so that the loops contain one rule only.
        match corners {
            Corners::Forbid => tiles.visit_all(open, Corners::Forbid),
            Corners::Allow => tiles.visit_all(open, Corners::Allow),
        }
    }
}

impl Rows for TolledTiles {
    #[inline(always)]
    fn read(&self, row: usize, word: usize, costs: &mut [u32; SIDE]) {
        let start = self.index((word * SIDE) as isize, row as isize);
        for (out, &cost) in costs.iter_mut().zip(&self.costs[start..]) {
            *out = if cost == UNKNOWN { UNREACHED } else { cost };
        }
    }
}
