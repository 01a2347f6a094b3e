//! One internalized plan: the answer of every cell to "where to from here?".
//!
//! W, section 2: "the robot's current location is used as an index into the plan". Plane
//! `terrain` says whether a cell is free and, if not, how to leave it. Plane `routes` names for
//! each free cell a *root*: another cell, to which one of the cell's optimal paths is as short as
//! it would be without obstacles. So `cost = cost(root) + octile(cell, root)`, exactly, and the
//! direction is towards the root. Where roots do not pay, a block holds its costs itself.

use crate::blocks::{Place, Plane, Stored, superblocks};
use crate::bytes::{u16_at, u32_at};
use crate::directory::Counts;
use crate::error::BlobError;
use crate::grid::{Cell, Direction, octile};

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

/// Terrain of a free cell.
pub(crate) const FREE: u16 = 0;
/// Terrain of a blocked cell without escape.
pub(crate) const NO_ESCAPE: u16 = 1;
/// Terrain of a blocked cell with an escape: this plus the direction's code.
pub(crate) const ESCAPE: u16 = 2;
const LAST_TERRAIN: u16 = ESCAPE + 7;

/// Route entry of a free cell without a route. All others are twice a root's number, plus one
/// where the straight part of the way comes first.
pub(crate) const NO_ROUTE_ENTRY: u16 = u16::MAX;
/// Codes in blocks of cells that have their own: 0 to 7 are moves.
pub(crate) const OWN_GOAL: u8 = 8;
/// A free cell without a route in a block of cells that have their own code.
#[cfg(feature = "std")]
pub(crate) const OWN_NO_ROUTE: u8 = 9;

/// Bytes of an entry of plane `terrain`.
pub(crate) const TERRAIN_BYTES: usize = 1;
/// Bytes of an entry of plane `routes`.
pub(crate) const ROUTE_BYTES: usize = 2;
/// Bytes of a root: column, row, cost.
pub(crate) const ROOT_BYTES: usize = 8;

/// One layer, read in place.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    pub(crate) name: &'a str,
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    pub(crate) terrain: Plane<'a, TERRAIN_BYTES>,
    pub(crate) routes: Plane<'a, ROUTE_BYTES>,
    pub(crate) roots: &'a [u8],
    pub(crate) bytes: u32,
    pub(crate) counts: Counts,
}

impl<'a> Layer<'a> {
    /// Its name, unique within its plan.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Bytes that the layer added to the blob; what it shares with layers before it counts there.
    pub fn bytes(&self) -> usize {
        self.bytes as usize
    }

    /// How many cells are of each kind.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What the layer says about a cell. Constant time; never fails.
    pub fn look_up(&self, cell: Cell) -> Answer {
        if cell.column >= self.columns || cell.row >= self.rows {
            return Answer::OffMap;
        }
        let place = Place::new(cell, superblocks(self.columns));
        // Both planes were validated, so neither is ever without an answer.
        match self.terrain.get(place) {
            Some(Stored::Entry(FREE)) => self.route(cell, place).unwrap_or(Answer::NoRoute),
            Some(Stored::Entry(NO_ESCAPE)) => Answer::Blocked { escape: None },
            Some(Stored::Entry(terrain)) => Answer::Blocked {
                escape: Some(Direction::from_code(terrain.wrapping_sub(ESCAPE) as u8)),
            },
            _ => Answer::NoRoute,
        }
    }

    fn route(&self, cell: Cell, place: Place) -> Option<Answer> {
        Some(match self.routes.get(place)? {
            Stored::Entry(NO_ROUTE_ENTRY) => Answer::NoRoute,
            Stored::Entry(entry) => {
                let root = self.roots.get(usize::from(entry >> 1) * ROOT_BYTES..)?;
                let root = Root {
                    cell: Cell::new(u16_at(root, 0)?.into(), u16_at(root, 2)?.into()),
                    cost: u32_at(root, 4)?,
                };
                let cost = root.cost_from(cell);
                match root.direction_from(cell, entry & 1 == 1) {
                    Some(direction) => Answer::Move { direction, cost },
                    None => Answer::Goal,
                }
            }
            Stored::Own { code: code @ 0..=7, cost } => {
                Answer::Move { direction: Direction::from_code(code), cost }
            }
            Stored::Own { code: OWN_GOAL, .. } => Answer::Goal,
            Stored::Own { .. } => Answer::NoRoute,
        })
    }

    /// Proves once that no look-up can fail.
    pub(crate) fn validate(&self) -> Result<(), BlobError> {
        let count = superblocks(self.columns) as usize * superblocks(self.rows) as usize;
        let roots = self.roots.len() / ROOT_BYTES;
        let roots_fit = self.roots.as_chunks::<ROOT_BYTES>().0.iter().all(|root| {
            let [x0, x1, y0, y1, ..] = *root;
            u32::from(u16::from_le_bytes([x0, x1])) < self.columns
                && u32::from(u16::from_le_bytes([y0, y1])) < self.rows
        });
        let is_route = |entry: u16| entry == NO_ROUTE_ENTRY || usize::from(entry >> 1) < roots;
        let counted = u64::from(self.counts.free)
            + u64::from(self.counts.blocked)
            + u64::from(self.counts.unreachable);
        let sound = roots_fit
            && counted == u64::from(self.columns) * u64::from(self.rows)
            && self.terrain.validate(count, false, |entry| entry <= LAST_TERRAIN)
            && self.routes.validate(count, true, is_route);
        if sound { Ok(()) } else { Err(BlobError::Cells) }
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
    pub(crate) fn cost_from(self, cell: Cell) -> u32 {
        let columns = self.cell.column.abs_diff(cell.column);
        let rows = self.cell.row.abs_diff(cell.row);
        self.cost.wrapping_add(octile(columns, rows))
    }

    /// The first step from a cell towards the root; `None` at the root itself.
    pub(crate) fn direction_from(self, cell: Cell, straight_first: bool) -> Option<Direction> {
        let mut dx = self.cell.column as i32 - cell.column as i32;
        let mut dy = self.cell.row as i32 - cell.row as i32;
        if straight_first {
            let (columns, rows) = (dx.unsigned_abs(), dy.unsigned_abs());
            if columns > rows {
                dy = 0;
            } else if columns < rows {
                dx = 0;
            }
        }
        Direction::from_signs(dx, dy)
    }
}
