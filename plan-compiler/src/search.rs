//! The search: from every cell the exact cost to the goal, and the best first move. With several
//! goals, to the one that costs least.
//!
//! Uniform-cost search over the eight neighbours (W, section 2.1). Costs are integers,
//! [`STRAIGHT_STEP`] and [`DIAGONAL_STEP`] for a step. So ties are exact, every correct order of
//! relaxation gives the same field, and tests compare the fast methods bit by bit with a plain
//! Dijkstra search.
//!
//! There are two methods; a [`Solver`] chooses the one that suits the map:
//!
//! - `tiles`: tiles of 64 x 64 cells in a priority queue; inside a tile, whole rows at a time in
//!   vector instructions. By far the faster on open maps.
//! - `buckets`: cell by cell in the order of costs, in buckets one step wide. For mazes of narrow
//!   corridors, where a tile would be visited repeatedly for a single cell.
//!
//! Maps with tolls have forms of their own of both methods, `tolled_tiles` and `tolled`. There a step
//! costs by the cell that it leaves, and costs count fractions of the unit, see
//! [`crate::tolls::Tolls::unit`].
//!
//! Each method is one file that explains how it works and why it is exact. `advice` then finds the
//! moves in one pass over the costs, and `escape` finds the ways out of blocked cells.
//!
//! A cost has 32 bits. The largest, [`MAX_COST`], is a path of about 700,000 cells. Cells farther
//! away are marked unreachable; [`is_cut_short`] reports whether there are any.
//!
//! Deliberately absent: choosing among equally good moves the one that packs best. Here the choice
//! is fixed (see `advice`); the packer, which knows the whole field, may choose again.
//!
//! [`STRAIGHT_STEP`]: plan_format::grid::STRAIGHT_STEP
//! [`DIAGONAL_STEP`]: plan_format::grid::DIAGONAL_STEP

pub(crate) mod advice;
mod buckets;
mod escape;
pub(crate) mod open;
mod queue;
mod shores;
pub(crate) mod tiles;
mod tolled;
mod tolled_advice;
mod tolled_tiles;
mod vectors;

use crate::field::{self, Field};
use crate::terrain::Terrain;
use crate::tolls::{MOST, Tolls};
use open::Passable;
use plan_format::grid::DIAGONAL_STEP;
use plan_format::{Cell, Direction};
pub use vectors::Vectors;

/// Whether a diagonal step may pass beside blocked cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Corners {
    /// Both cells beside a diagonal step must be free.
    #[default]
    Forbid,
    /// Only the end of a diagonal step must be free, as in the papers.
    Allow,
}

/// How a field is computed. Both methods give the same field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Tiles of 64 x 64 cells, a row at a time.
    #[default]
    Tiles,
    /// Cell by cell, in buckets one step wide.
    Buckets,
}

/// The largest cost of a field. The range above lets the fast methods add steps without overflow.
pub const MAX_COST: u32 = 0xF000_0000;

/// A map has narrow corridors if fewer than one in NARROW free cells is the corner of a free square
/// of 2 x 2 cells. In noise of 45 % obstacles it is one in 6; in a maze of corridors one cell wide
/// it is none.
const NARROW: u64 = 12;

/// What to search for: the routes over one terrain to one goal, or to the cheapest of several.
#[derive(Clone, Copy, Debug)]
pub struct Query<'t> {
    /// The ground.
    pub terrain: &'t Terrain,
    /// The ends of all routes. No route leads to a goal that is blocked or off the grid.
    pub goals: &'t [Cell],
    /// Whether diagonal steps may cut corners.
    pub corners: Corners,
}

/// Computes the field of a query: the cost and the best first move of every free cell, and the way
/// out of every blocked cell.
pub fn solve(query: &Query<'_>) -> Field {
    Solver::new().solve(query)
}

/// Solves one query after another and keeps its buffers between them: on large maps, allocating
/// costs more than searching.
#[derive(Debug, Default)]
pub struct Solver {
    /// The last terrain, kept with what was derived from it: several goals may share it.
    terrain: Terrain,
    open: Passable,
    suitable: Method,
    tiles: tiles::Tiles,
    buckets: buckets::Queue,
    tolled: tolled::Tolled,
    tolled_tiles: tolled_tiles::TolledTiles,
    method: Option<Method>,
    vectors: Vectors,
}

impl Solver {
    /// A solver without buffers yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// A solver that uses one method on every map.
    pub fn with_method(method: Method) -> Self {
        Self { method: Some(method), ..Self::default() }
    }

    /// The same solver with the given kind of vector unit instead of the best.
    pub fn with_vectors(self, vectors: Vectors) -> Self {
        Self { vectors, ..self }
    }

    /// As [`solve`].
    pub fn solve(&mut self, query: &Query<'_>) -> Field {
        let mut field = Field::default();
        self.solve_into(query, &mut field);
        field
    }

    /// As [`solve`], into a field that is overwritten.
    pub fn solve_into(&mut self, query: &Query<'_>, field: &mut Field) {
        self.routes_into(query, field);
        escape::escape(&mut self.tiles, self.vectors, &query.terrain.blocked, field);
    }

    /// As [`solve`] without the ways out of blocked cells, into a field that is overwritten.
    pub fn routes_into(&mut self, query: &Query<'_>, field: &mut Field) {
        let Query { terrain, goals, corners } = *query;
        [field.columns, field.rows] = terrain.size();
        let goals: Vec<Cell> = goals.iter().copied().filter(|&at| terrain.is_free(at)).collect();
        let vectors = self.vectors;
        if self.terrain != *terrain {
            self.terrain.clone_from(terrain);
            self.open.fill(&terrain.blocked, false);
            self.suitable = suitable(&self.open, vectors);
        }
        let method = self.method.unwrap_or(self.suitable);
        let blocked = &terrain.blocked;
        field.unit = terrain.tolls.as_ref().map(Tolls::unit);
        if let Some(tolls) = &terrain.tolls {
            return match method {
                Method::Tiles => {
                    self.tolled_tiles.search(&self.open, tolls, &goals, corners, vectors);
                    tolled_advice::advise(&self.tolled_tiles, query, vectors, field);
                }
                Method::Buckets => {
                    self.tolled.search(&self.open, tolls, &goals, corners, vectors);
                    tolled_advice::advise(&self.tolled, query, vectors, field);
                }
            };
        }
        match method {
            Method::Tiles => {
                self.tiles.search(&self.open, &goals, corners, vectors);
                advice::advise(&self.tiles, blocked, &goals, corners, vectors, field);
            }
            Method::Buckets => {
                self.buckets.search(&self.open, &goals, corners, vectors);
                advice::advise(&self.buckets, blocked, &goals, corners, vectors, field);
            }
        }
    }
}

/// The method that is faster on a map.
fn suitable(open: &Passable, vectors: Vectors) -> Method {
    let (free, wide) = vectors.run(open::Texture(open));
    if wide * NARROW >= free { Method::Tiles } else { Method::Buckets }
}

/// Whether a free cell has no route only because it is farther away than [`MAX_COST`].
pub fn is_cut_short(query: &Query<'_>, field: &Field) -> bool {
    let Query { terrain, corners, .. } = *query;
    let cost = |cell: Cell| {
        let index = cell.row as usize * field.columns as usize + cell.column as usize;
        field.cost.get(index).copied().unwrap_or(field::UNREACHED)
    };
    let highest = field.cost.iter().filter(|&&cost| cost != field::UNREACHED).max();
    let longest = DIAGONAL_STEP * if terrain.tolls.is_some() { MOST } else { 1 };
    if highest.is_none_or(|&highest| highest < MAX_COST - longest) {
        return false;
    }
    let cells = field::all_cells(field.columns, field.rows);
    cells.filter(|&cell| terrain.is_free(cell) && cost(cell) == field::UNREACHED).any(|cell| {
        Direction::ALL.into_iter().any(|direction| {
            step(terrain, cell, direction, corners)
                .is_some_and(|neighbour| cost(neighbour) != field::UNREACHED)
        })
    })
}

/// The cell that one step in a direction leads to, if it is free and the step allowed.
pub fn step(terrain: &Terrain, cell: Cell, direction: Direction, corners: Corners) -> Option<Cell> {
    let [columns, rows] = terrain.size();
    let free = |cell: Cell, towards: Direction| {
        cell.neighbour(towards, columns, rows).filter(|&at| terrain.is_free(at))
    };
    let code = direction.code();
    let is_allowed = corners == Corners::Allow
        || code.is_multiple_of(2)
        || [code + 7, code + 1]
            .into_iter()
            .all(|side| free(cell, Direction::from_code(side)).is_some());
    if is_allowed { free(cell, direction) } else { None }
}
