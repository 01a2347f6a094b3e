//! What the cells of a grid are to a robot: the ground that a search runs over.
//!
//! [`Terrain::nests_in`] says what "at least as constrained" means, for the stack of layers and for
//! the proofs of [`crate::verify`].

use crate::tolls::Tolls;
use maps::Bitmap;
use plan_format::Cell;

/// What the cells of a grid are to a robot.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Terrain {
    /// The cells that the robot's centre must not enter.
    pub blocked: Bitmap,
    /// What steps out of the other cells cost; `None` if all cost their length.
    pub tolls: Option<Tolls>,
}

impl Terrain {
    /// The terrain in which these cells are blocked and all others free, without tolls.
    pub fn new(blocked: Bitmap) -> Self {
        Self { blocked, tolls: None }
    }

    /// The same terrain with these tolls on the same grid.
    pub fn with_tolls(self, tolls: Tolls) -> Self {
        Self { tolls: Some(tolls).filter(|tolls| !tolls.is_none()), ..self }
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.blocked.columns(), self.blocked.rows()]
    }

    /// Whether a cell may be entered; `false` off the grid.
    pub fn is_free(&self, cell: Cell) -> bool {
        let [columns, rows] = self.size();
        cell.column < columns && cell.row < rows && !self.blocked.get(cell)
    }

    /// Whether every cell that is blocked below is blocked here.
    pub fn nests_in(&self, below: &Self) -> bool {
        self.blocked.contains_all(&below.blocked)
    }

    /// The cells that are blocked below but free here: none if this terrain nests.
    pub fn gaps<'t>(&'t self, below: &'t Self) -> impl Iterator<Item = Cell> + 't {
        below.blocked.iter().filter(|&cell| !self.blocked.get(cell))
    }
}
