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

/// One plane, read in place. Its entries take `ENTRY_BYTES`, 1 or 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<'a, const ENTRY_BYTES: usize> {
    /// The section that offsets are counted in.
    pub(crate) section: &'a [u8],
    /// Where the table of superblocks begins.
    pub(crate) table: u32,
}

impl<'a, const ENTRY_BYTES: usize> Plane<'a, ENTRY_BYTES> {
    /// What the plane says of a cell; never `None` in a plane that was validated.
    #[inline(always)]
    pub(crate) fn get(&self, place: Place) -> Option<Stored> {
        let superblock = self.superblock(place.superblock)?;
        let first = superblock.first()?;
        if first == 1 {
            return superblock.entry(1, 0).map(Stored::Entry);
        }
        if first & WIDE != 0 {
            return superblock.get_wide(place);
        }
        let length = usize::from(first);
        let (class, base, before) = superblock.narrow_descriptor(place.block)?;
        let data = palette_at(false) + length * ENTRY_BYTES + index_bytes(1) * before;
        let index = superblock.index(class, base, data, place)?;
        superblock.entry(palette_at(false), index.min(length - 1)).map(Stored::Entry)
    }

    #[inline(always)]
    fn superblock(&self, index: usize) -> Option<Superblock<'a, ENTRY_BYTES>> {
        let offset = u32_at(self.section, (self.table as usize).checked_add(4 * index)?)?;
        Some(Superblock { bytes: self.section.get(offset as usize..)? })
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
struct Superblock<'a, const ENTRY_BYTES: usize> {
    bytes: &'a [u8],
}

impl<const ENTRY_BYTES: usize> Superblock<'_, ENTRY_BYTES> {
    /// The palette's length, and whether descriptors are wide. One entry, that of all cells, has
    /// no descriptors before it.
    #[inline(always)]
    fn first(&self) -> Option<u8> {
        self.bytes.first().copied().filter(|&first| first & !WIDE != 0)
    }

    /// An entry of the palette that begins at an offset.
    #[inline(always)]
    fn entry(&self, palette: usize, index: usize) -> Option<u16> {
        let at = palette + index * ENTRY_BYTES;
        if ENTRY_BYTES == 1 {
            self.bytes.get(at).map(|&entry| entry.into())
        } else {
            u16_at(self.bytes, at)
        }
    }

    /// Class and window of a block, and the classes of all blocks before it added up: four
    /// descriptors at a time, as none of the four sums comes near the size of a byte.
    #[inline(always)]
    fn narrow_descriptor(&self, block: usize) -> Option<(usize, usize, usize)> {
        let words: &[[u8; 4]; BLOCKS / 4] =
            self.bytes.get(1..=BLOCKS)?.as_chunks().0.try_into().ok()?;
        let classes = |word: [u8; 4]| (u32::from_le_bytes(word) >> NARROW_BITS) & 0x0707_0707;
        let [first, second, third, _] = *words;
        let word = *words.get(block / 4)?;
        let mut sums = classes(word) & ((1 << (8 * (block % 4))) - 1);
        if block >= 4 {
            sums += classes(first);
        }
        if block >= 8 {
            sums += classes(second);
        }
        if block >= 12 {
            sums += classes(third);
        }
        let before = (sums.wrapping_mul(0x0101_0101) >> 24) as usize;
        let descriptor = usize::from((u32::from_le_bytes(word) >> (8 * (block % 4))) as u8);
        Some((descriptor >> NARROW_BITS, descriptor % (1 << NARROW_BITS), before))
    }

    /// A cell's index into the palette.
    #[inline(always)]
    fn index(&self, class: usize, base: usize, data: usize, place: Place) -> Option<usize> {
        if class == 0 {
            return Some(base);
        }
        let row = u32_at(self.bytes, data + place.row * class)?;
        Some(base + (row >> (place.column * class)) as usize % (1 << class))
    }

    fn get_wide(&self, place: Place) -> Option<Stored> {
        let last = usize::from(self.first()? & !WIDE) - 1;
        let descriptor = usize::from(u16_at(self.bytes, 1 + 2 * place.block)?);
        let (class, rest) = (descriptor >> WIDE_BITS, descriptor % (1 << WIDE_BITS));
        let index = match class {
            0 => rest,
            1..=MAX_INDEX_BITS => {
                let base = usize::from(*self.bytes.get(rest)?);
                self.index(class, base, rest + 1, place)?
            }
            _ => return own(self.bytes.get(rest..)?, class, place),
        };
        self.entry(palette_at(true), index.min(last)).map(Stored::Entry)
    }

    fn validate(&self, own_allowed: bool, is_entry: impl Fn(u16) -> bool) -> Option<()> {
        let first = self.first()?;
        if first == 1 {
            return is_entry(self.entry(1, 0)?).then_some(());
        }
        let (wide, length) = (first & WIDE != 0, usize::from(first & !WIDE));
        for index in 0..length {
            is_entry(self.entry(palette_at(wide), index)?).then_some(())?;
        }
        if wide { self.validate_wide(own_allowed) } else { self.validate_narrow(length) }
    }

    fn validate_narrow(&self, length: usize) -> Option<()> {
        let descriptors = self.bytes.get(1..=BLOCKS)?;
        let classes = descriptors.iter().map(|descriptor| usize::from(descriptor >> NARROW_BITS));
        let most = classes.clone().max()?;
        let data = palette_at(false) + length * ENTRY_BYTES;
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
                _ if own_allowed => {
                    let (mask, count) = own_mask(rest)?;
                    (mask.count_ones() as usize == count).then_some(())?;
                    own_bytes(class, count)
                }
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

/// Where the codes of 4 bits begin in a block of cells that have their own: after the mask of those
/// cells and their number.
const CODES_AT: usize = 9;

/// Where their costs begin.
#[inline(always)]
fn own_costs_at(cells: usize) -> usize {
    CODES_AT + cells.div_ceil(2)
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

/// Which cells of such a block have a code and a cost, and how many they are.
#[inline(always)]
fn own_mask(block: &[u8]) -> Option<(u64, usize)> {
    let mask = array_at(block, 0).map(u64::from_le_bytes)?;
    Some((mask, usize::from(*block.get(CODES_AT - 1)?)))
}

/// A cell's own code and cost in a block of such a class. A cell that has none is answered with
/// what stands where its own would be; the terrain never asks for it.
fn own(block: &[u8], class: usize, place: Place) -> Option<Stored> {
    let (mask, cells) = own_mask(block)?;
    let rank = ones_before(mask, place.row * 8 + place.column);
    let codes = *block.get(CODES_AT + rank / 2)?;
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

/// How many of the lowest bits are set, in two halves for 32-bit machines.
#[inline(always)]
fn ones_before(mask: u64, bit: usize) -> usize {
    let below = |half: u32| (half & ((1 << (bit % 32)) - 1)).count_ones();
    let low = mask as u32;
    let ones = if bit < 32 { below(low) } else { low.count_ones() + below((mask >> 32) as u32) };
    ones as usize
}
