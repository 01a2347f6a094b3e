//! One internalized plan: the answer of every cell to "where to from here?".
//!
//! W, section 2: "the robot's current location is used as an index into the plan". Plane
//! `terrain` says whether a cell is free and, if not, how to leave it. Plane `routes` names for
//! each free cell a *root*: another cell, to which one of the cell's optimal paths is as short as
//! it would be without obstacles. So `cost = cost(root) + octile(cell, root)`, exactly, and the
//! direction is towards the root. Where roots do not pay, a block holds its costs itself.

use crate::blocks::{Own, Place, Plane, Stored, superblocks};
use crate::bytes::{WORD_BYTES, Words};
use crate::directory::{Counts, LayerRecord, NameAt};
use crate::error::BlobError;
use crate::grid::{Cell, Direction, octile};
use crate::work::Work;

/// What a layer says about a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Free, with a route.
    Move {
        /// An optimal first step.
        direction: Direction,
        /// Cost to the goal in units of 1/5741 cell; see [`crate::grid::cost_metres`].
        cost: u32,
    },
    /// The goal itself.
    Goal,
    /// Free, without a route to the goal.
    NoRoute,
    /// An obstacle of this layer.
    Blocked {
        /// First step towards the nearest free cell with a route, if there is any.
        escape: Option<Direction>,
    },
    /// Not a cell of the map.
    OffMap,
}

/// What a layer says about a cell, but for the cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Free, with a route that begins with this optimal step.
    Move(Direction),
    /// The goal itself.
    Goal,
    /// Free, without a route to the goal.
    NoRoute,
    /// An obstacle of this layer.
    Blocked {
        /// First step towards the nearest free cell with a route, if there is any.
        escape: Option<Direction>,
    },
    /// Not a cell of the map.
    OffMap,
}

/// Terrain of a free cell.
pub(crate) const FREE: u32 = 0;
/// Terrain of a blocked cell without escape.
pub(crate) const NO_ESCAPE: u32 = 1;
/// Terrain of a blocked cell with an escape: this plus the direction's code.
pub(crate) const ESCAPE: u32 = 2;
const LAST_TERRAIN: u32 = ESCAPE + 7;

/// Route entry of a free cell without a route. All others are twice a root's number, plus one
/// where the straight part of the way comes first.
pub(crate) const NO_ROUTE_ENTRY: u32 = u16::MAX as u32;
/// Codes in blocks of cells that have their own: 0 to 7 are moves.
pub(crate) const OWN_GOAL: u8 = 8;
/// A free cell without a route in a block of cells that have their own code.
#[cfg(feature = "std")]
pub(crate) const OWN_NO_ROUTE: u8 = 9;

/// Bits of an entry of plane `terrain`.
pub(crate) const TERRAIN_BITS: u32 = 4;
/// Bits of an entry of plane `routes`.
pub(crate) const ROUTE_BITS: u32 = 16;
/// Words of a root: column and row, cost.
pub(crate) const ROOT_WORDS: u32 = 2;

/// One layer, read in place.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    /// The section that all offsets are counted in.
    pub(crate) section: Words<'a>,
    /// Where the tables of the planes and the roots begin.
    pub(crate) terrain: u32,
    pub(crate) routes: u32,
    pub(crate) roots: u32,
    pub(crate) root_count: u32,
    pub(crate) bytes: u32,
    pub(crate) counts: Counts,
    pub(crate) names: &'a [u8],
    pub(crate) name: NameAt,
}

/// What of a layer no earlier layer has proved.
#[derive(Clone, Copy)]
pub(crate) struct Open {
    /// Plane `terrain`.
    pub(crate) terrain: bool,
    /// The roots.
    pub(crate) roots: bool,
    /// Plane `routes`, and the fewest roots of any layer that shares it.
    pub(crate) routes_of_roots: Option<u32>,
}

impl Open {
    /// What the layer of a number has to prove, of all layer records of a blob.
    pub(crate) fn of(number: usize, record: &LayerRecord, layers: &[u8]) -> Self {
        let (mut terrain, mut roots, mut routes) = (true, true, true);
        let mut fewest = record.root_count;
        let records = (0..layers.len() / LayerRecord::BYTES).map_while(|index| {
            LayerRecord::get(layers, index).map(|record| (index < number, record))
        });
        for (is_earlier, other) in records {
            if other.routes == record.routes {
                fewest = fewest.min(other.root_count);
                routes &= !is_earlier;
            }
            if is_earlier {
                terrain &= other.terrain != record.terrain;
                roots &= (other.roots, other.root_count) != (record.roots, record.root_count);
            }
        }
        Self { terrain, roots, routes_of_roots: routes.then_some(fewest.into()) }
    }
}

/// What stands in the planes about a cell.
enum Found {
    Root { number: u32, straight_first: bool },
    Own(Own),
    NoRoute,
    Blocked(Option<Direction>),
    OffMap,
}

impl<'a> Layer<'a> {
    /// Its name, unique within its plan.
    pub fn name(&self) -> &'a str {
        // Names were validated.
        self.name.get(self.names).unwrap_or_default()
    }

    /// Bytes that the layer added to the blob; what it shares with layers before it counts there.
    pub fn bytes(&self) -> usize {
        self.bytes as usize
    }

    /// Bytes that the layer would take as plain arrays: 4 bits of advice and 32 of cost a cell.
    pub fn raw_bytes(&self) -> usize {
        let cells = self.columns as usize * self.rows as usize;
        cells.div_ceil(2) + 4 * cells
    }

    /// How many cells are of each kind.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What the layer says about a cell. Constant time; never fails.
    pub fn look_up(&self, cell: Cell) -> Answer {
        // Both planes were validated, so no number is ever missing.
        match self.find(cell) {
            Found::Root { number, straight_first } => {
                self.root(number).map_or(Answer::NoRoute, |root| root.answer(cell, straight_first))
            }
            Found::Own(own) => match (own.code(self.section), own.cost(self.section)) {
                (Some(code @ 0..=7), Some(cost)) => {
                    Answer::Move { direction: Direction::from_code(code as u8), cost }
                }
                (Some(code), _) if code == OWN_GOAL.into() => Answer::Goal,
                _ => Answer::NoRoute,
            },
            Found::NoRoute => Answer::NoRoute,
            Found::Blocked(escape) => Answer::Blocked { escape },
            Found::OffMap => Answer::OffMap,
        }
    }

    /// As [`Layer::look_up`], for a sixth less time without the cost.
    pub fn step(&self, cell: Cell) -> Step {
        match self.find(cell) {
            Found::Root { number, straight_first } => match self.root_cell(number) {
                Some(root) => direction(cell, root, straight_first).map_or(Step::Goal, Step::Move),
                None => Step::NoRoute,
            },
            Found::Own(own) => match own.code(self.section) {
                Some(code @ 0..=7) => Step::Move(Direction::from_code(code as u8)),
                Some(code) if code == OWN_GOAL.into() => Step::Goal,
                _ => Step::NoRoute,
            },
            Found::NoRoute => Step::NoRoute,
            Found::Blocked(escape) => Step::Blocked { escape },
            Found::OffMap => Step::OffMap,
        }
    }

    #[inline(always)]
    fn find(&self, cell: Cell) -> Found {
        if cell.column >= self.columns || cell.row >= self.rows {
            return Found::OffMap;
        }
        let place = Place::new(cell, superblocks(self.columns));
        match self.terrain_at(place) {
            FREE => {}
            NO_ESCAPE => return Found::Blocked(None),
            terrain => {
                let code = terrain.wrapping_sub(ESCAPE) as u8;
                return Found::Blocked(Some(Direction::from_code(code)));
            }
        }
        match self.routes().get(place) {
            Some(Stored::Entry(entry)) if entry != NO_ROUTE_ENTRY => {
                Found::Root { number: entry >> 1, straight_first: entry & 1 == 1 }
            }
            Some(Stored::Own(own)) => Found::Own(own),
            _ => Found::NoRoute,
        }
    }

    #[inline(always)]
    fn terrain_at(&self, place: Place) -> u32 {
        match self.terrain().get(place) {
            Some(Stored::Entry(terrain)) => terrain,
            _ => NO_ESCAPE,
        }
    }

    #[inline(always)]
    fn terrain(&self) -> Plane<'a, TERRAIN_BITS> {
        Plane { section: self.section, table: self.terrain }
    }

    #[inline(always)]
    fn routes(&self) -> Plane<'a, ROUTE_BITS> {
        Plane { section: self.section, table: self.routes }
    }

    #[inline(always)]
    fn root_cell(&self, number: u32) -> Option<Cell> {
        self.section.get(self.roots.wrapping_add(number * ROOT_WORDS)).map(Cell::of_word)
    }

    #[inline(always)]
    fn root(&self, number: u32) -> Option<Root> {
        let cost = self.section.get(self.roots.wrapping_add(number * ROOT_WORDS + 1))?;
        Some(Root { cell: self.root_cell(number)?, cost })
    }

    /// Proves once that no look-up can fail. What `open` does not name was proved with an earlier
    /// layer.
    pub(crate) fn validate(
        &self,
        open: Open,
        work: &mut Work<impl FnMut()>,
    ) -> Result<(), BlobError> {
        let count = superblocks(self.columns) * superblocks(self.rows);
        let counted = u64::from(self.counts.free)
            + u64::from(self.counts.blocked)
            + u64::from(self.counts.unreachable);
        if counted != u64::from(self.columns) * u64::from(self.rows) {
            return Err(BlobError::Cells);
        }
        if open.roots {
            work.spend(self.root_count)?;
            self.validate_roots().ok_or(BlobError::Cells)?;
        }
        if open.terrain {
            self.terrain().validate(count, false, |terrain| terrain <= LAST_TERRAIN, work)?;
        }
        if let Some(roots) = open.routes_of_roots {
            let is_route = |entry: u32| entry == NO_ROUTE_ENTRY || entry >> 1 < roots;
            self.routes().validate(count, true, is_route, work)?;
        }
        Ok(())
    }

    fn validate_roots(&self) -> Option<()> {
        let roots = self.section.range(self.roots, self.root_count * ROOT_WORDS)?;
        let mut roots = roots.iter().step_by(ROOT_WORDS as usize);
        let fit = roots.all(|root| {
            let [x0, x1, y0, y1]: [u8; WORD_BYTES] = *root;
            u32::from(u16::from_le_bytes([x0, x1])) < self.columns
                && u32::from(u16::from_le_bytes([y0, y1])) < self.rows
        });
        fit.then_some(())
    }
}

/// A cell that others refer to, and its cost to the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Root {
    pub(crate) cell: Cell,
    pub(crate) cost: u32,
}

impl Root {
    /// The cost of a cell whose way leads by this root.
    #[inline(always)]
    pub(crate) fn cost_from(self, cell: Cell) -> u32 {
        let columns = self.cell.column.abs_diff(cell.column);
        let rows = self.cell.row.abs_diff(cell.row);
        self.cost.wrapping_add(octile(columns, rows))
    }

    #[inline(always)]
    fn answer(self, cell: Cell, straight_first: bool) -> Answer {
        match direction(cell, self.cell, straight_first) {
            Some(direction) => Answer::Move { direction, cost: self.cost_from(cell) },
            None => Answer::Goal,
        }
    }
}

/// The first step from a cell towards another; `None` if they are the same.
#[inline(always)]
pub(crate) fn direction(from: Cell, to: Cell, straight_first: bool) -> Option<Direction> {
    let mut dx = to.column as i32 - from.column as i32;
    let mut dy = to.row as i32 - from.row as i32;
    if straight_first {
        // Squares take fewer instructions than signs, and sides are below 2^15.
        let (columns, rows) = (dx * dx, dy * dy);
        if columns > rows {
            dy = 0;
        } else if columns < rows {
            dx = 0;
        }
    }
    Direction::from_signs(dx, dy)
}
