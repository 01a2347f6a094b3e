//! The search: from one goal to every cell, the exact cost and the best first move.
//!
//! Uniform-cost search over the eight neighbours (Wagner and Arkin, internalized plans,
//! section 2.1). Costs are integers, [`STRAIGHT_STEP`] and [`DIAGONAL_STEP`] for a step, so
//! that ties are exact and every correct order of relaxation gives the same field; that is
//! what lets the fast methods be compared bit by bit with a plain Dijkstra search.
//!
//! There are two methods, and a [`Solver`] takes the one that suits the map:
//!
//! - `tiles`: squares of 64 x 64 cells in a priority queue, inside them whole rows at a time
//!   in vector instructions. Faster by far wherever there is room.
//! - `buckets`: cell by cell in the order of costs, in buckets one step wide. For mazes of
//!   narrow corridors, where tiles would be visited again and again for a single cell.
//!
//! Each is one file that says how it works and why it is exact. `advice` then finds the moves
//! in one pass over the costs, and `escape` the ways out of blocked cells.
//!
//! A cost needs 32 bits, which is enough for [`MAX_COST`]: some 700,000 cells of path. Cells
//! farther away than that are left without a route; [`is_cut_short`] tells whether any was.
//!
//! Deliberately absent: the choice among equally good moves by what packs best. Here it is
//! fixed (see `advice`); a packer that knows the field may choose anew.
//!
//! [`STRAIGHT_STEP`]: plan_format::grid::STRAIGHT_STEP
//! [`DIAGONAL_STEP`]: plan_format::grid::DIAGONAL_STEP

pub(crate) mod advice;
mod buckets;
mod escape;
pub(crate) mod open;
mod shores;
pub(crate) mod tiles;
mod vectors;

use crate::field::{self, Field};
use crate::terrain::Terrain;
use open::Passable;
use plan_format::grid::DIAGONAL_STEP;
use plan_format::{Cell, Direction};
pub use vectors::Vectors;

/// Whether a diagonal step may pass between or beside blocked cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Corners {
    /// A diagonal step needs both cells that it passes between free.
    #[default]
    Forbid,
    /// A diagonal step needs only its end free (the papers' behaviour).
    Allow,
}

/// How a field is found. The field is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Tiles of 64 x 64 cells, a row at a time.
    #[default]
    Tiles,
    /// Cell by cell, in buckets one step wide.
    Buckets,
}

/// The highest cost of a field. What lies above is room for the fast methods to add steps
/// without overflow.
pub const MAX_COST: u32 = 0xF000_0000;

/// Corridors are narrow where fewer than one in so many free cells begins a square of four
/// that are free. Noise of 45 % obstacles still has one in 6; a maze of corridors one cell
/// wide has none.
const NARROW: u64 = 12;

/// What is searched for: every way to one goal over one terrain.
#[derive(Clone, Copy, Debug)]
pub struct Query<'t> {
    /// The ground.
    pub terrain: &'t Terrain,
    /// Where every route ends. Where it is blocked or off the grid, no cell has a route.
    pub goal: Cell,
    /// Whether diagonal steps may cut corners.
    pub corners: Corners,
}

/// The field of one goal: the cost and the best first move of every free cell, and the way out of
/// every blocked one.
pub fn solve(query: &Query<'_>) -> Field {
    Solver::new().solve(query)
}

/// Solves for one goal after another and keeps its buffers in between: on large maps fresh
/// memory costs more than the search.
#[derive(Debug, Default)]
pub struct Solver {
    /// The last terrain, and what is known of it: it may have several goals.
    terrain: Terrain,
    open: Passable,
    suitable: Method,
    tiles: tiles::Tiles,
    buckets: buckets::Queue,
    method: Option<Method>,
    vectors: Vectors,
}

impl Solver {
    /// A solver without buffers yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// A solver that uses one method whatever the map.
    pub fn with_method(method: Method) -> Self {
        Self { method: Some(method), ..Self::default() }
    }

    /// The same solver with a kind of vector unit that need not be the best.
    pub fn with_vectors(self, vectors: Vectors) -> Self {
        Self { vectors, ..self }
    }

    /// As [`solve`].
    pub fn solve(&mut self, query: &Query<'_>) -> Field {
        let mut field = Field { columns: 0, rows: 0, cost: Vec::new(), code: Vec::new() };
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
        let Query { terrain, goal, corners } = *query;
        [field.columns, field.rows] = terrain.size();
        let goal = terrain.is_free(goal).then_some(goal);
        let vectors = self.vectors;
        if self.terrain != *terrain {
            self.terrain.clone_from(terrain);
            self.open.fill(&terrain.blocked, false);
            self.suitable = suitable(&self.open, vectors);
        }
        let blocked = &terrain.blocked;
        match self.method.unwrap_or(self.suitable) {
            Method::Tiles => {
                self.tiles.search(&self.open, goal, corners, vectors);
                advice::advise(&self.tiles, blocked, goal, corners, vectors, field);
            }
            Method::Buckets => {
                self.buckets.search(&self.open, goal, corners, vectors);
                advice::advise(&self.buckets, blocked, goal, corners, vectors, field);
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
    if highest.is_none_or(|&highest| highest < MAX_COST - DIAGONAL_STEP) {
        return false;
    }
    let (columns, rows) = (field.columns, field.rows);
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| Cell::new(column, row)));
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
