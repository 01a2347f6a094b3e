//! A packed layer: the words that a packer makes and the writer stores.

use crate::directory::Counts;
use crate::layout::WORD_BYTES;

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
    /// The words of all roots, in the order of their numbers; see [`crate::layout::Root::words`].
    pub roots: Vec<u32>,
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
        WORD_BYTES * (self.terrain.words() + self.routes.words() + self.roots.len())
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
