//! Planes: one small number for every cell, in palettes, read in constant time.
//!
//! A plane is a table of superblocks of 32 x 32 cells, a superblock is a palette and 16 blocks of
//! 8 x 8 cells, and a block is one palette entry for all its cells, or an index of 1 to 4 bits for
//! each, or each cell's own code and cost. `FORMAT.md` gives the bytes.
//!
//! Invariant: after [`Plane::validate`] every look-up finds an entry, because an index beyond a
//! palette means its last entry. Nothing has to be proved cell by cell.

use crate::bytes::{u16_at, u32_at};
use crate::grid::{Cell, DIAGONAL_STEP, STRAIGHT_STEP};

/// Side of a superblock, cells, as a power of two.
pub(crate) const SUPERBLOCK_SHIFT: u32 = 5;
/// Blocks in a superblock.
pub(crate) const BLOCKS: usize = 16;
/// Cells in a block.
pub(crate) const BLOCK_CELLS: usize = 64;
/// Most bits of an index in a block.
pub(crate) const MAX_INDEX_BITS: usize = 4;
/// Block classes above [`MAX_INDEX_BITS`]: every cell with its own code and cost, the cost in 4 + 4
/// bits, 8 + 8 bits (straight and diagonal steps above a base) or 32 bits.
pub(crate) const OWN_4_4: usize = 5;
/// See [`OWN_4_4`].
pub(crate) const OWN_8_8: usize = 6;
/// See [`OWN_4_4`].
pub(crate) const OWN_32: usize = 7;
/// Where the palette of a superblock begins: after its length and the descriptors.
pub(crate) const PALETTE_AT: usize = 1 + 2 * BLOCKS;
/// Bytes of the codes in a block whose cells have their own: 4 bits each.
pub(crate) const CODES_BYTES: usize = BLOCK_CELLS / 2;
/// Zero bytes at the end of the section, so that four bytes can be read wherever a block ends.
pub(crate) const SLACK_BYTES: usize = 4;

/// What a plane says of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stored {
    /// An entry of the palette.
    Entry(u16),
    /// The cell's own code (4 bits) and cost.
    Own { code: u8, cost: u32 },
}

/// Where a cell stands in a plane.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    superblock: usize,
    block: usize,
    row: usize,
    column: usize,
}

impl Place {
    /// The place of a cell in a grid so many superblocks wide.
    pub(crate) fn new(cell: Cell, superblock_columns: u32) -> Self {
        let superblock = (cell.row >> SUPERBLOCK_SHIFT)
            .wrapping_mul(superblock_columns)
            .wrapping_add(cell.column >> SUPERBLOCK_SHIFT);
        Self {
            superblock: superblock as usize,
            block: (cell.row >> 1 & 0b1100 | cell.column >> 3 & 0b11) as usize,
            row: (cell.row & 7) as usize,
            column: (cell.column & 7) as usize,
        }
    }
}

/// How many superblocks lie along a side of so many cells.
pub(crate) const fn superblocks(cells: u32) -> u32 {
    cells.div_ceil(1 << SUPERBLOCK_SHIFT)
}

/// One plane, read in place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<'a> {
    /// The section that offsets are counted in.
    pub(crate) section: &'a [u8],
    /// Where the table of superblocks begins.
    pub(crate) table: u32,
}

/// The most bytes that a superblock's blocks may lie from its beginning.
const OFFSET_MASK: usize = (1 << 13) - 1;

impl<'a> Plane<'a> {
    /// What the plane says of a cell; never `None` in a plane that was validated.
    pub(crate) fn get(&self, place: Place) -> Option<Stored> {
        let superblock = self.superblock(place.superblock)?;
        let length = usize::from(*superblock.first()?);
        if length == 1 {
            return u16_at(superblock, 1).map(Stored::Entry);
        }
        let descriptor = usize::from(u16_at(superblock, 1 + 2 * place.block)?);
        let (class, rest) = (descriptor >> 13, descriptor & OFFSET_MASK);
        let index = match class {
            0 => rest,
            1..=MAX_INDEX_BITS => {
                let base = usize::from(*superblock.get(rest)?);
                let row = u32_at(superblock, rest + 1 + place.row * class)?;
                base + (row >> (place.column * class)) as usize % (1 << class)
            }
            _ => return own(superblock.get(rest..)?, class, place),
        };
        let last = length.checked_sub(1)?;
        u16_at(superblock, PALETTE_AT + 2 * index.min(last)).map(Stored::Entry)
    }

    fn superblock(&self, index: usize) -> Option<&'a [u8]> {
        let offset = u32_at(self.section, (self.table as usize).checked_add(4 * index)?)?;
        self.section.get(offset as usize..)
    }

    /// Proves once that every cell of so many superblocks has an entry that `is_entry` accepts or,
    /// where `own_allowed`, its own code and cost.
    pub(crate) fn validate(
        &self,
        superblocks: usize,
        own_allowed: bool,
        is_entry: impl Fn(u16) -> bool,
    ) -> bool {
        (0..superblocks).all(|index| {
            self.superblock(index)
                .is_some_and(|bytes| is_superblock(bytes, own_allowed, &is_entry).is_some())
        })
    }
}

/// `Some` if every block of the superblock at the start of `bytes` can be read.
fn is_superblock(bytes: &[u8], own_allowed: bool, is_entry: impl Fn(u16) -> bool) -> Option<()> {
    let length = usize::from(*bytes.first()?);
    if length == 1 {
        return is_entry(u16_at(bytes, 1)?).then_some(());
    }
    let palette = bytes.get(PALETTE_AT..)?.get(..2 * length)?;
    for entry in palette.as_chunks::<2>().0 {
        is_entry(u16::from_le_bytes(*entry)).then_some(())?;
    }
    let descriptors = bytes.get(1..PALETTE_AT)?;
    for descriptor in descriptors.as_chunks::<2>().0 {
        let descriptor = usize::from(u16::from_le_bytes(*descriptor));
        let (class, rest) = (descriptor >> 13, descriptor & OFFSET_MASK);
        if class <= MAX_INDEX_BITS {
            (length > 0).then_some(())?;
        } else {
            own_allowed.then_some(())?;
        }
        if class > 0 {
            bytes.get(rest..)?.get(..block_bytes(class) + SLACK_BYTES)?;
        }
    }
    Some(())
}

/// Bytes of a block by its class, without its descriptor.
pub(crate) const fn block_bytes(class: usize) -> usize {
    match class {
        0 => 0,
        1..=MAX_INDEX_BITS => 1 + class * BLOCK_CELLS / 8,
        OWN_4_4 => 4 + BLOCK_CELLS + CODES_BYTES,
        OWN_8_8 => 4 + 2 * BLOCK_CELLS + CODES_BYTES,
        _ => 4 * BLOCK_CELLS + CODES_BYTES,
    }
}

/// A cell's own code and cost in a block of such a class.
fn own(block: &[u8], class: usize, place: Place) -> Option<Stored> {
    let cell = place.row * 8 + place.column;
    let codes = *block.get(cell / 2)?;
    let code = if cell.is_multiple_of(2) { codes & 15 } else { codes >> 4 };
    let cost = if class == OWN_32 {
        u32_at(block, CODES_BYTES + 4 * cell)?
    } else {
        let base = u32_at(block, CODES_BYTES)?;
        let (straight, diagonal) = if class == OWN_4_4 {
            let both = *block.get(CODES_BYTES + 4 + cell)?;
            (both & 15, both >> 4)
        } else {
            let both = u16_at(block, CODES_BYTES + 4 + 2 * cell)?;
            (both as u8, (both >> 8) as u8)
        };
        base.wrapping_add(u32::from(straight) * STRAIGHT_STEP + u32::from(diagonal) * DIAGONAL_STEP)
    };
    Some(Stored::Own { code, cost })
}
