//! A packed layer: the words that a packer makes and the writer stores.

use crate::directory::Counts;
use crate::layout::{MULTIPLIERS, TOLL_WORDS, WORD_BYTES};

/// The words of one layer. [`crate::write()`] refuses a layer that the reader would refuse.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedLayer {
    /// Cells from west to east.
    pub columns: u32,
    /// Cells from south to north.
    pub rows: u32,
    /// Whether each cell is free and, if it is not, how to leave it.
    pub terrain: PackedPlane,
    /// The root of each free cell, or its own code and cost.
    pub routes: PackedPlane,
    /// The words of all roots, in the order of their numbers; see [`crate::layout::Root::words`] and
    /// [`crate::layout::TolledRoot::words`].
    pub roots: Vec<u32>,
    /// What a layer with tolls has besides; `None` without tolls.
    pub tolls: Option<PackedTolls>,
    /// For each cell with a route the number of the goal that the advice leads to; `None` if the plan
    /// has one goal.
    pub goals: Option<PackedPlane>,
    /// The number of cells of each kind.
    pub counts: Counts,
}

impl PackedLayer {
    /// The number of cells of each kind.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Upper bound of its bytes in a blob, which stores words that layers share only once.
    pub fn bytes(&self) -> usize {
        let tolls = self.tolls.as_ref().map_or(0, PackedTolls::words);
        let goals = self.goals.as_ref().map_or(0, PackedPlane::words);
        WORD_BYTES * (self.terrain.words() + self.routes.words() + self.roots.len() + tolls + goals)
    }
}

/// What a layer with tolls has besides roots.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedTolls {
    /// The unit of costs; see [`crate::Layer::unit`].
    pub unit: u8,
    /// For each cell the number of its correction.
    pub corrections: PackedPlane,
    /// The corrections, at least one; see [`crate::layout::TollHeader::values`].
    pub values: Vec<u32>,
    /// For each cell its speed limit, cm/s; `None` without limits.
    pub limits: Option<PackedPlane>,
    /// What roots multiply steps by, less 1, by the number that roots have.
    pub multipliers: [u8; MULTIPLIERS],
}

impl PackedTolls {
    /// Upper bound of its words in a blob.
    fn words(&self) -> usize {
        let limits = self.limits.as_ref().map_or(0, PackedPlane::words);
        TOLL_WORDS as usize + self.corrections.words() + self.values.len() + limits
    }
}

/// The superblocks of a plane: row by row from the south-west, in the order of the grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedPlane {
    /// [`crate::layout::superblocks`] of the columns times that of the rows.
    pub superblocks: Vec<Superblock>,
}

impl PackedPlane {
    /// Upper bound of its words in a blob, table included.
    fn words(&self) -> usize {
        let words = |superblock: &Superblock| match superblock {
            Superblock::Uniform(_) => 1,
            Superblock::Words { words, .. } => 1 + words.len(),
        };
        self.superblocks.iter().map(words).sum()
    }
}

/// A superblock as it is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Superblock {
    /// One entry for all cells.
    Uniform(u32),
    /// Palette, descriptors and blocks.
    Words {
        /// Index of the first word of the blocks.
        first: usize,
        /// All words.
        words: Vec<u32>,
    },
}
