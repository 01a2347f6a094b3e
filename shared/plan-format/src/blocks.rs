//! Planes: one small number for every cell, in palettes, read in constant time.
//!
//! A plane is a table of superblocks of 32 x 32 cells, a superblock is a palette and 16 blocks of
//! 8 x 8 cells, and a block is one palette entry for all its cells, or an index of 1 to 4 bits for
//! each, or each cell's own code and cost. `FORMAT.md` gives the bytes.
//!
//! Invariant: after [`Plane::validate`] every look-up finds an entry, because an index beyond a
//! palette means its last entry. Nothing has to be proved cell by cell.

use crate::bytes::{array_at, u16_at, u32_at};
use crate::grid::{Cell, DIAGONAL_STEP, STRAIGHT_STEP};

/// Side of a superblock, cells, as a power of two.
pub(crate) const SUPERBLOCK_SHIFT: u32 = 5;
/// Blocks in a superblock.
pub(crate) const BLOCKS: usize = 16;
/// Cells in a block.
pub(crate) const BLOCK_CELLS: usize = 64;
/// Zero bytes at the end of the section, so that four bytes can be read wherever a block ends.
pub(crate) const SLACK_BYTES: usize = 4;

/// Block classes up to this are the bits of an index.
pub(crate) const MAX_INDEX_BITS: usize = 4;
/// The class of blocks whose cells have their own code and cost, the cost as straight and diagonal
/// steps above a base in 4 + 4 bits.
pub(crate) const OWN_4_4: usize = 5;
/// As [`OWN_4_4`], in 8 + 8 bits.
pub(crate) const OWN_8_8: usize = 6;
/// As [`OWN_4_4`], but the cost itself in 32 bits.
pub(crate) const OWN_32: usize = 7;

/// In the first byte of a superblock, beside the palette's length: descriptors are wide.
pub(crate) const WIDE: u8 = 0x80;
/// Bits of a narrow descriptor below its class: where the block's window begins in the palette.
pub(crate) const NARROW_BITS: usize = 5;
/// Bits of a wide descriptor below its class: where the block begins in the superblock, or, of
/// class 0, its index into the palette.
pub(crate) const WIDE_BITS: usize = 13;

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
            block: (((cell.row >> 3) & 3) * 4 + ((cell.column >> 3) & 3)) as usize,
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
    /// Bytes of an entry, 1 or 2.
    pub(crate) entry_bytes: usize,
}

impl<'a> Plane<'a> {
    /// What the plane says of a cell; never `None` in a plane that was validated.
    pub(crate) fn get(&self, place: Place) -> Option<Stored> {
        let superblock = self.superblock(place.superblock)?;
        let Some((wide, length)) = superblock.several() else {
            return superblock.entry(1, 0).map(Stored::Entry);
        };
        let palette = palette_at(wide);
        let (class, base, data) = if wide {
            let descriptor = usize::from(u16_at(superblock.bytes, 1 + 2 * place.block)?);
            let (class, rest) = (descriptor >> WIDE_BITS, descriptor % (1 << WIDE_BITS));
            match class {
                0 => (0, rest, 0),
                1..=MAX_INDEX_BITS => (class, usize::from(*superblock.bytes.get(rest)?), rest + 1),
                _ => return own(superblock.bytes.get(rest..)?, class, place),
            }
        } else {
            let descriptor = usize::from(*superblock.bytes.get(1 + place.block)?);
            let before = classes_before(superblock.bytes, place.block)?;
            let data = palette + length * self.entry_bytes + index_bytes(1) * before;
            (descriptor >> NARROW_BITS, descriptor % (1 << NARROW_BITS), data)
        };
        let index = if class == 0 {
            base
        } else {
            let row = u32_at(superblock.bytes, data + place.row * class)?;
            base + (row >> (place.column * class)) as usize % (1 << class)
        };
        superblock.entry(palette, index.min(length - 1)).map(Stored::Entry)
    }

    fn superblock(&self, index: usize) -> Option<Superblock<'a>> {
        let offset = u32_at(self.section, (self.table as usize).checked_add(4 * index)?)?;
        let bytes = self.section.get(offset as usize..)?;
        Some(Superblock { bytes, entry_bytes: self.entry_bytes })
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
                .is_some_and(|superblock| superblock.validate(own_allowed, &is_entry).is_some())
        })
    }
}

/// The section from where a superblock begins.
#[derive(Clone, Copy)]
struct Superblock<'a> {
    bytes: &'a [u8],
    entry_bytes: usize,
}

impl Superblock<'_> {
    /// Whether the descriptors are wide, and the palette's length; `None` where one entry serves
    /// all cells and follows at once.
    fn several(&self) -> Option<(bool, usize)> {
        let first = *self.bytes.first()?;
        let length = usize::from(first & !WIDE);
        (first > 1 && length > 0).then_some((first & WIDE != 0, length))
    }

    /// An entry of the palette that begins at an offset.
    fn entry(&self, palette: usize, index: usize) -> Option<u16> {
        let at = palette + index * self.entry_bytes;
        if self.entry_bytes == 1 {
            self.bytes.get(at).map(|&entry| entry.into())
        } else {
            u16_at(self.bytes, at)
        }
    }

    fn validate(&self, own_allowed: bool, is_entry: impl Fn(u16) -> bool) -> Option<()> {
        let Some((wide, length)) = self.several() else {
            let is_single = self.bytes.first() == Some(&1);
            return (is_single && is_entry(self.entry(1, 0)?)).then_some(());
        };
        for index in 0..length {
            is_entry(self.entry(palette_at(wide), index)?).then_some(())?;
        }
        if wide { self.validate_wide(own_allowed) } else { self.validate_narrow(length) }
    }

    fn validate_narrow(&self, length: usize) -> Option<()> {
        let descriptors = self.bytes.get(1..=BLOCKS)?;
        let classes = descriptors.iter().map(|descriptor| usize::from(descriptor >> NARROW_BITS));
        let most = classes.clone().max()?;
        let data = palette_at(false) + length * self.entry_bytes;
        let end = data + classes.map(index_bytes).sum::<usize>();
        (most <= MAX_INDEX_BITS && end + SLACK_BYTES <= self.bytes.len()).then_some(())
    }

    fn validate_wide(&self, own_allowed: bool) -> Option<()> {
        for block in 0..BLOCKS {
            let descriptor = usize::from(u16_at(self.bytes, 1 + 2 * block)?);
            let class = descriptor >> WIDE_BITS;
            let rest = self.bytes.get(descriptor % (1 << WIDE_BITS)..)?;
            let bytes = match class {
                0 => 0,
                1..=MAX_INDEX_BITS => 1 + index_bytes(class),
                _ if own_allowed => own_bytes(class, mask_of(rest)?.count_ones() as usize),
                _ => return None,
            };
            rest.get(..bytes + SLACK_BYTES)?;
        }
        Some(())
    }
}

/// Where the palette begins: after its length and the descriptors.
pub(crate) const fn palette_at(wide: bool) -> usize {
    if wide { 1 + 2 * BLOCKS } else { 1 + BLOCKS }
}

/// Bytes of the indices of a block.
pub(crate) const fn index_bytes(class: usize) -> usize {
    class * BLOCK_CELLS / 8
}

/// The classes of all blocks before one, added up. Four narrow descriptors at a time: their
/// classes are small enough to be added in the top byte of a product.
fn classes_before(superblock: &[u8], block: usize) -> Option<usize> {
    let sum = |descriptors: u32| {
        (((descriptors >> NARROW_BITS) & 0x0707_0707).wrapping_mul(0x0101_0101) >> 24) as usize
    };
    let mut total = 0;
    for word in 0..block / 4 {
        total += sum(u32_at(superblock, 1 + 4 * word)?);
    }
    let rest = u32_at(superblock, 1 + block / 4 * 4)?;
    Some(total + sum(rest & ((1 << (8 * (block % 4))) - 1)))
}

/// Where costs of their own are stored: after the mask, and the codes of 4 bits each.
fn own_costs_at(cells: usize) -> usize {
    8 + cells.div_ceil(2)
}

/// Bytes of a block in which so many cells have their own code and cost.
pub(crate) fn own_bytes(class: usize, cells: usize) -> usize {
    own_costs_at(cells)
        + match class {
            OWN_4_4 => 4 + cells,
            OWN_8_8 => 4 + 2 * cells,
            _ => 4 * cells,
        }
}

/// Which cells of such a block have a code and a cost.
fn mask_of(block: &[u8]) -> Option<u64> {
    array_at(block, 0).map(u64::from_le_bytes)
}

/// A cell's own code and cost in a block of such a class. A cell that has none is answered like
/// the next one that has; the terrain never asks for it.
fn own(block: &[u8], class: usize, place: Place) -> Option<Stored> {
    let mask = mask_of(block)?;
    let cells = mask.count_ones() as usize;
    let before = (1u64 << (place.row * 8 + place.column)) - 1;
    let rank = ((mask & before).count_ones() as usize).min(cells.saturating_sub(1));
    let codes = *block.get(8 + rank / 2)?;
    let code = if rank.is_multiple_of(2) { codes & 15 } else { codes >> 4 };
    let at = own_costs_at(cells);
    if class == OWN_32 {
        return Some(Stored::Own { code, cost: u32_at(block, at + 4 * rank)? });
    }
    let base = u32_at(block, at)?;
    let (straight, diagonal) = if class == OWN_4_4 {
        let steps = *block.get(at + 4 + rank)?;
        (steps & 15, steps >> 4)
    } else {
        let [straight, diagonal] = array_at(block, at + 4 + 2 * rank)?;
        (straight, diagonal)
    };
    let above = u32::from(straight) * STRAIGHT_STEP + u32::from(diagonal) * DIAGONAL_STEP;
    Some(Stored::Own { code, cost: base.wrapping_add(above) })
}
