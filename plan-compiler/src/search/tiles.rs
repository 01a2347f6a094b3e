//! Uniform-cost search by tiles of 64 x 64 cells, a row of a tile at a time.
//!
//! A tile holds the best costs known so far. A visit lowers them to the cheapest routes that its own
//! cells and a halo of one cell around it allow. Then the neighbouring tiles that these costs improve
//! are put in a queue, ordered by the lowest cost waiting for them. When the queue is empty, no step
//! anywhere improves a cost: the field is exact. The order of visits decides the time, never the
//! result. On open maps a tile is visited once, and each of its rows is relaxed 1.1 to 1.5 times.
//!
//! [`relax`] explains how a row is relaxed and why it hardly ever needs a scan; [`halo`] explains
//! what passes between tiles.

mod halo;
mod relax;

use super::advice::Rows;
use super::open::{Open, Passable, SIDE};
use super::queue::{Pending, Queue};
use super::shores::Shores;
use super::{Corners, MAX_COST, Vectors};
use crate::field::UNREACHED;
use plan_format::Cell;
use pulp::Simd;
use relax::{CELLS, Row, line, relax, spread_east, spread_west};

/// The cost of a cell that is not reached yet, or not passable.
const UNKNOWN: u32 = MAX_COST + 1;

/// The costs of one tile with its halo; see [`line`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Tile {
    cost: [u32; CELLS],
    /// Copies of the westernmost and the easternmost column after the last visit, stored like rows:
    /// reading a column of `cost` would touch a cache line for each cell.
    sides: [Row; 2],
}

/// The search and its buffers, which are reused from search to search.
#[derive(Debug, Default)]
pub(crate) struct Tiles {
    /// Tiles from west to east and from south to north.
    across: usize,
    down: usize,
    tiles: Vec<Tile>,
    /// Whether a tile still holds the costs of an earlier search.
    is_stale: Vec<bool>,
    queue: Queue,
}

impl Tiles {
    /// Finds the cheapest routes to any of the goals, which are open cells.
    pub(crate) fn search(
        &mut self,
        map: &Passable,
        goals: &[Cell],
        corners: Corners,
        vectors: Vectors,
    ) {
        self.reset(map);
        for &goal in goals {
            self.start(map, goal);
        }
        vectors.run(Run { tiles: self, map, shores: None, corners });
    }

    /// Sets the cost of a goal to 0, spreads it along its row, and wakes its tile.
    fn start(&mut self, map: &Passable, goal: Cell) {
        let (x, y) = (goal.column as usize, goal.row as usize);
        let at = y / SIDE * self.across + x / SIDE;
        self.freshen(at);
        let cost = &mut self.tiles[at].cost;
        let start = line(y as isize % SIDE as isize);
        cost[start + x % SIDE] = 0;
        let open = map.at(x / SIDE, y as isize).cells;
        spread_east(cost, start, x as isize % SIDE as isize, open);
        spread_west(cost, start, x as isize % SIDE as isize, open);
        let row = 1u64 << (y % SIDE);
        self.queue.wake(at, Pending { from_south: row << 1, from_north: row >> 1, key: Some(0) });
    }

    /// Finds the cheapest ways out of the deep cells, starting from the shores.
    pub(super) fn flood(&mut self, deep: &Passable, shores: &Shores, vectors: Vectors) {
        self.reset(deep);
        let corners = Corners::Allow;
        vectors.run(Run { tiles: self, map: deep, shores: Some(shores), corners });
    }

    fn reset(&mut self, map: &Passable) {
        self.across = map.columns.div_ceil(SIDE);
        self.down = map.rows.div_ceil(SIDE);
        let count = self.across * self.down;
        if self.tiles.len() < count {
            self.tiles.resize(count, Tile { cost: [UNKNOWN; CELLS], sides: [[UNKNOWN; _]; 2] });
        }
        self.is_stale.clear();
        self.is_stale.resize(count, true);
        self.queue.reset(count);
    }

    /// Clears what an earlier search left in a tile. Done when the tile is first needed, so that it
    /// is then in the cache.
    #[inline(always)]
    fn freshen(&mut self, at: usize) {
        if std::mem::take(&mut self.is_stale[at]) {
            self.tiles[at].cost.fill(UNKNOWN);
        }
    }

    /// Sets the costs of a tile to those of the shores, closes its rows, and wakes it.
    #[inline(always)]
    fn seed(&mut self, deep: &Passable, at: usize, shores: &Shores) {
        let open = deep.tile(at % self.across, at / self.across);
        let is_shut = |row| {
            let Open { cells, west, east } = open.row(row);
            cells | west | east == 0
        };
        if (-1..=SIDE as isize).all(is_shut) {
            return;
        }
        self.freshen(at);
        let (tx, y) = (at % self.across, at / self.across * SIDE);
        let mut rows = 0;
        for row in 0..SIDE.min(deep.rows - y) {
            let cost = &mut self.tiles[at].cost;
            let start = line(row as isize);
            let known = shores.word((y + row) as u32, tx);
            for (cost, known) in cost[start..][..SIDE].iter_mut().zip(known) {
                *cost = known.min(UNKNOWN);
            }
            let here = open.row(row as isize);
            rows |= u64::from(here.cells != 0) << row;
            let mut shores = !here.cells & here.east_open();
            while shores != 0 {
                spread_east(cost, start, shores.trailing_zeros() as isize, here.cells);
                shores &= shores - 1;
            }
            let mut shores = !here.cells & here.west_open();
            while shores != 0 {
                spread_west(cost, start, shores.trailing_zeros() as isize, here.cells);
                shores &= shores - 1;
            }
        }
        self.tiles[at].keep_sides();
        if rows != 0 {
            self.queue.wake(at, Pending { from_south: rows, from_north: rows, key: Some(0) });
        }
    }

    /// Visits tiles until none waits.
    #[inline(always)]
    fn visit_all<S: Simd>(&mut self, simd: S, map: &Passable, corners: Corners) {
        while let Some((at, pending)) = self.queue.next() {
            self.visit(simd, map, at, pending, corners);
        }
    }

    /// Lowers the costs of a tile as far as it and its halo allow, sweeping north and south until no
    /// row waits.
    #[inline(always)]
    fn visit<S: Simd>(
        &mut self,
        simd: S,
        map: &Passable,
        at: usize,
        pending: Pending,
        corners: Corners,
    ) {
        let Pending { mut from_south, mut from_north, .. } = pending;
        let open = map.tile(at % self.across, at / self.across);
        self.freshen(at);
        self.pull(at);
        let rows = map.rows - at / self.across * SIDE;
        let all = u64::MAX >> (SIDE - rows.min(SIDE));
        let cost = &mut self.tiles[at].cost;
        while (from_south | from_north) & all != 0 {
            from_south &= all;
            while from_south != 0 {
                let row = from_south.trailing_zeros() as usize;
                from_south &= from_south - 1;
                let relaxed = relax(simd, cost, open, row, row as isize - 1, corners);
                from_south |= u64::from(relaxed.has_changed) << row << 1 & all;
                from_north |= u64::from(relaxed.leads_back) << row >> 1;
            }
            from_north &= all;
            while from_north != 0 {
                let row = 63 - from_north.leading_zeros() as usize;
                from_north &= !(1 << row);
                let relaxed = relax(simd, cost, open, row, row as isize + 1, corners);
                from_north |= u64::from(relaxed.has_changed) << row >> 1;
                from_south |= u64::from(relaxed.leads_back) << row << 1;
            }
        }
        self.tiles[at].keep_sides();
        self.notify(map, at, corners);
    }
}

/// The search itself, compiled once for each kind of vector unit. Everything that it calls is
/// inlined, so that it is compiled for the same unit.
struct Run<'a> {
    tiles: &'a mut Tiles,
    map: &'a Passable,
    shores: Option<&'a Shores>,
    corners: Corners,
}

impl pulp::WithSimd for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { tiles, map, shores, corners } = self;
        if let Some(shores) = shores {
            for at in 0..tiles.across * tiles.down {
                tiles.seed(map, at, shores);
            }
        }
        // The corner rule is a constant in each branch, so that the loops contain one rule only.
        match corners {
            Corners::Forbid => tiles.visit_all(simd, map, Corners::Forbid),
            Corners::Allow => tiles.visit_all(simd, map, Corners::Allow),
        }
    }
}

impl Rows for Tiles {
    #[inline(always)]
    fn read(&self, row: usize, word: usize, costs: &mut [u32; SIDE]) {
        let at = row / SIDE * self.across + word;
        let start = line((row % SIDE) as isize);
        match self.known(at) {
            Some(tile) => {
                for (out, &cost) in costs.iter_mut().zip(&tile.cost[start..]) {
                    *out = if cost == UNKNOWN { UNREACHED } else { cost };
                }
            }
            None => costs.fill(UNREACHED),
        }
    }
}
