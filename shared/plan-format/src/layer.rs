//! One internalized plan: the answer of every cell to "where to from here?".
//!
//! W, section 2: "the robot's current location is used as an index into the plan".

use crate::bytes::u32_at;
use crate::directory::Counts;
use crate::error::BlobError;
use crate::grid::{Cell, Direction};

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

/// Bytes of a cell: its code and its cost. The codes are those of a field.
pub(crate) const CELL_BYTES: usize = 5;
const GOAL: u8 = 8;
const NO_ROUTE: u8 = 9;
const NO_ESCAPE: u8 = 10;
const ESCAPE: u8 = 16;
const UNREACHED: u32 = u32::MAX;

/// One layer, read in place.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    pub(crate) name: &'a str,
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    pub(crate) cells: &'a [u8],
    pub(crate) counts: Counts,
}

impl<'a> Layer<'a> {
    /// Its name, unique within its plan.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Bytes of its cells in the blob.
    pub fn bytes(&self) -> usize {
        self.cells.len()
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
        let index = cell.row as usize * self.columns as usize + cell.column as usize;
        // The lengths were checked when the blob was parsed, so nothing is out of range.
        self.at(index * CELL_BYTES).unwrap_or(Answer::OffMap)
    }

    fn at(&self, offset: usize) -> Option<Answer> {
        let code = *self.cells.get(offset)?;
        let cost = u32_at(self.cells, offset + 1)?;
        match code {
            0..=7 if cost != UNREACHED => {
                Some(Answer::Move { direction: Direction::from_code(code), cost })
            }
            GOAL if cost == 0 => Some(Answer::Goal),
            NO_ROUTE if cost == UNREACHED => Some(Answer::NoRoute),
            NO_ESCAPE if cost == UNREACHED => Some(Answer::Blocked { escape: None }),
            ESCAPE..=23 if cost == UNREACHED => {
                Some(Answer::Blocked { escape: Some(Direction::from_code(code)) })
            }
            _ => None,
        }
    }

    /// Proves once that no look-up can fail and that the counts are true.
    pub(crate) fn validate(&self) -> Result<(), BlobError> {
        let cells = u64::from(self.columns) * u64::from(self.rows);
        if self.cells.len() as u64 != cells * CELL_BYTES as u64 {
            return Err(BlobError::Cells);
        }
        let mut counts = Counts::default();
        for offset in (0..self.cells.len()).step_by(CELL_BYTES) {
            match self.at(offset).ok_or(BlobError::Cells)? {
                Answer::Move { .. } | Answer::Goal => counts.free += 1,
                Answer::NoRoute => counts.unreachable += 1,
                Answer::Blocked { .. } => counts.blocked += 1,
                Answer::OffMap => return Err(BlobError::Cells),
            }
        }
        if counts == self.counts { Ok(()) } else { Err(BlobError::Cells) }
    }
}
