//! Planes: one small number per cell, compressed with palettes and read in constant time.
//!
//! A plane is a table of superblocks of 32 x 32 cells. A superblock is a palette and 16 blocks of
//! 8 x 8 cells. A block is one palette entry for all its cells, or entries separated by borders, or
//! an index of 1 to 4 bits per cell, or a code and a cost per cell. `FORMAT.md` describes the
//! words.
//!
//! All reads are of words of 4 bytes, so a read is one comparison and one load. Each descriptor
//! holds the offset of its block, so a look-up neither sums nor searches.
//!
//! Invariant: after [`Plane::validate`], each look-up in a palette finds a checked entry, because
//! every window that a descriptor names is checked. So validation need not visit each cell.

use crate::error::BlobError;
use crate::grid::{Cell, DIAGONAL_STEP, STRAIGHT_STEP};
use crate::layout::{
    BASE_SHIFT, BASES, BLOCKS, CLASS_SHIFT, GROUP, HEADER_WORDS, INDEX_1, INDEX_4, MAX_BORDERS,
    OWN, OWN_24, OWN_32, OWN_HEADER_WORDS, OWN_SHIFT, SUPERBLOCK_SHIFT, UNIFORM, class_entries,
    data_words, group_words, index_bits, own_words,
};
use crate::limits;
use crate::words::Words;
use crate::work::Work;

/// A plane's value for a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stored {
    /// An entry of the palette.
    Entry(u32),
    /// The cell has its own code and cost.
    Own(Own),
}

/// The address of a cell in a plane: the superblock from bit 10 on, the block in bits 6 to 9, and
/// the cell's number in the block, row by row, in bits 0 to 5. One number, so it stays in a
/// register.
#[derive(Clone, Copy)]
pub(crate) struct BlockAddress(u32);

impl BlockAddress {
    /// The address of a cell in a grid of `superblock_columns` superblocks from west to east.
    #[inline(always)]
    pub(crate) fn new(cell: Cell, superblock_columns: u32) -> Self {
        let superblock = (cell.row >> SUPERBLOCK_SHIFT)
            .wrapping_mul(superblock_columns)
            .wrapping_add(cell.column >> SUPERBLOCK_SHIFT);
        let block = (cell.row >> 3 & 3) << 2 | cell.column >> 3 & 3;
        Self(superblock << 10 | block << 6 | (cell.row & 7) << 3 | cell.column & 7)
    }

    #[inline(always)]
    fn superblock(self) -> u32 {
        self.0 >> 10
    }

    #[inline(always)]
    fn block(self) -> u32 {
        self.0 >> 6 & 15
    }

    #[inline(always)]
    fn cell(self) -> u32 {
        self.0 & 63
    }
}

/// The most entries that the windows of a superblock reach.
const MAX_ENTRIES: u32 = BASES as u32 - 1 + class_entries(INDEX_4);
const _: () = assert!(1 + BLOCKS as u32 + MAX_ENTRIES <= limits::MAX_CHECKS_PER_WORD);

const _: () = assert!(
    (limits::MAX_SIDE_CELLS >> SUPERBLOCK_SHIFT).pow(2) <= 1 << (u32::BITS - 10),
    "the superblock's number must fit"
);

/// One plane, read in place. Its entries take `ENTRY_BITS`, 4 or 16.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<'a, const ENTRY_BITS: u32> {
    /// Section `cells`; offsets count its words.
    pub(crate) section: Words<'a>,
    /// Where the table of superblocks begins.
    pub(crate) table: u32,
}

/// A descriptor of a block, in the low 16 bits; the others are ignored.
#[derive(Clone, Copy)]
struct Descriptor(u32);

impl Descriptor {
    #[inline(always)]
    fn class(self) -> u32 {
        self.0 >> CLASS_SHIFT & 7
    }

    /// Where the block's window begins in the palette.
    #[inline(always)]
    fn base(self) -> u32 {
        self.0 >> BASE_SHIFT & (BASES as u32 - 1)
    }

    /// Where the block begins, in words from the superblock's first block.
    #[inline(always)]
    fn offset(self) -> u32 {
        self.0 & ((1 << BASE_SHIFT) - 1)
    }

    /// As [`Self::offset`], for a block of class [`OWN`].
    #[inline(always)]
    fn own_offset(self) -> u32 {
        self.0 & ((1 << OWN_SHIFT) - 1)
    }

    /// The width of the costs in a block of class [`OWN`].
    #[inline(always)]
    fn own_width(self) -> u32 {
        self.0 >> OWN_SHIFT & 3
    }
}

// Fields of up to 16 bits never straddle two words, so a rotation moves a field to the low bits.
// Rotation takes its count modulo 32, so the code does not compute the modulo.
impl<'a, const ENTRY_BITS: u32> Plane<'a, ENTRY_BITS> {
    /// The value for a cell; never `None` after [`Plane::validate`].
    #[inline(always)]
    pub(crate) fn get(&self, address: BlockAddress) -> Option<Stored> {
        let first = self.section.get(self.table.wrapping_add(address.superblock()))?;
        if first & UNIFORM != 0 {
            return Some(Stored::Entry(first & !UNIFORM));
        }
        let descriptor = self.descriptor(first, address.block())?;
        let class = descriptor.class();
        let index = if class == 0 {
            0
        } else if class <= MAX_BORDERS {
            self.part(first + descriptor.offset(), class, address.cell())?
        } else if class <= INDEX_4 {
            self.index(first + descriptor.offset(), index_bits(class), address.cell())?
        } else {
            let data = first + descriptor.own_offset();
            let own = Own::find(self.section, data, descriptor.own_width(), address.cell());
            return own.map(Stored::Own);
        };
        self.entry(first, descriptor.base() + index).map(Stored::Entry)
    }

    /// The descriptor of a block; descriptors precede the first block.
    #[inline(always)]
    fn descriptor(&self, first: u32, block: u32) -> Option<Descriptor> {
        let pair = self.section.get(first.wrapping_sub(HEADER_WORDS).wrapping_add(block / 2))?;
        Some(Descriptor(pair.rotate_right(block << 4)))
    }

    /// An entry of the palette, which precedes the descriptors and runs backwards.
    #[inline(always)]
    fn entry(&self, first: u32, index: u32) -> Option<u32> {
        let bit = index * ENTRY_BITS;
        let word = self.section.get(first.wrapping_sub(HEADER_WORDS + 1 + bit / 32))?;
        Some(word.rotate_right(bit) & ((1 << ENTRY_BITS) - 1))
    }

    /// The number of a block's borders that are not east of a cell.
    #[inline(always)]
    fn part(&self, data: u32, borders: u32, cell: u32) -> Option<u32> {
        let is_behind = |border: u32| border.rotate_right(cell >> 3 << 2) & 15 <= cell & 7;
        let first = u32::from(is_behind(self.section.get(data)?));
        if borders == 1 {
            return Some(first);
        }
        Some(first + u32::from(is_behind(self.section.get(data + 1)?)))
    }

    /// A cell's index of `bits` bits. Three bits are stored as two and then one, so that none
    /// straddles two words.
    #[inline(always)]
    fn index(&self, data: u32, bits: u32, cell: u32) -> Option<u32> {
        if bits != 3 {
            return self.bits(data, bits, cell);
        }
        let low = self.bits(data, 2, cell)?;
        Some(self.bits(data + data_words(INDEX_1 + 1) as u32, 1, cell)? << 2 | low)
    }

    #[inline(always)]
    fn bits(&self, data: u32, bits: u32, cell: u32) -> Option<u32> {
        let bit = cell * bits;
        let word = self.section.get(data + bit / 32)?;
        Some(word.rotate_right(bit) & ((1 << bits) - 1))
    }

    /// Proves once that every cell of `superblocks` superblocks has an entry that `is_entry`
    /// accepts or, if `own_allowed`, its own code and cost.
    pub(crate) fn validate(
        &self,
        superblocks: u32,
        own_allowed: bool,
        is_entry: impl Fn(u32) -> bool,
        work: &mut Work<impl FnMut()>,
    ) -> Result<(), BlobError> {
        work.spend(superblocks)?;
        let table = self.section.range(self.table, superblocks).ok_or(BlobError::Cells)?;
        for &word in table {
            let first = u32::from_le_bytes(word);
            if first & UNIFORM == 0 {
                let entries = self.entries(first, own_allowed).ok_or(BlobError::Cells)?;
                work.spend(BLOCKS as u32 + entries)?;
                let mut all = 0..entries;
                if !all.all(|index| self.entry(first, index).is_some_and(&is_entry)) {
                    return Err(BlobError::Cells);
                }
            } else if !is_entry(first & !UNIFORM) {
                return Err(BlobError::Cells);
            }
        }
        Ok(())
    }

    /// The number of palette entries that a superblock's windows reach; `None` if a block exceeds
    /// the section or its class is not allowed.
    fn entries(&self, first: u32, own_allowed: bool) -> Option<u32> {
        let mut entries = 0;
        for block in 0..BLOCKS as u32 {
            let descriptor = self.descriptor(first, block)?;
            let class = descriptor.class();
            let (data, words) = match class {
                0..=INDEX_4 => (first + descriptor.offset(), data_words(class)),
                OWN if own_allowed => {
                    let data = first + descriptor.own_offset();
                    let low = self.section.get(data)?.count_ones();
                    let high = self.section.get(data + 1)?.count_ones();
                    (data, own_words(descriptor.own_width(), (low + high) as usize))
                }
                _ => return None,
            };
            if words > 0 {
                self.section.get(data + words as u32 - 1)?;
            }
            if class <= INDEX_4 {
                entries = entries.max(descriptor.base() + class_entries(class));
            }
        }
        Some(entries)
    }
}

/// A cell that has its own code and cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Own {
    /// Where the block begins: the mask of its cells, then the base of their costs.
    data: u32,
    width: u32,
    /// Where the cell's group of eight begins: a word of codes, then the costs.
    group: u32,
    /// Number of the block's cells before it.
    rank: u32,
}

impl Own {
    /// A cell of a block. For a cell that is not in the mask the result is arbitrary; only free
    /// cells are looked up, and a packer puts those into the mask.
    #[inline(always)]
    fn find(section: Words<'_>, data: u32, width: u32, cell: u32) -> Option<Self> {
        let rank = ones_before(section.get(data)?, section.get(data + 1)?, cell);
        let group = data + OWN_HEADER_WORDS as u32 + rank / GROUP as u32 * group_words(width);
        Some(Self { data, width, group, rank })
    }

    #[inline(always)]
    pub(crate) fn code(self, section: Words<'_>) -> Option<u32> {
        Some(section.get(self.group)?.rotate_right(4 * self.rank) & 15)
    }

    #[inline(always)]
    pub(crate) fn cost(self, section: Words<'_>) -> Option<u32> {
        let (costs, member) = (self.group + 1, self.rank % GROUP as u32);
        if self.width == OWN_32 {
            return section.get(costs + member);
        }
        let base = section.get(self.data + 2)?;
        if self.width == OWN_24 {
            // Four costs take three words.
            let (first, bit) = (costs + 3 * member / 4, 24 * member % 32);
            let low = section.get(first)? >> bit;
            let high = if bit > 8 { section.get(first + 1)? << (32 - bit) } else { 0 };
            return Some(base.wrapping_add((low | high) & 0xff_ffff));
        }
        let half = 4 << self.width;
        let bit = 2 * half * member;
        let steps = section.get(costs + bit / 32)?.rotate_right(bit);
        let mask = (1 << half) - 1;
        let above = (steps & mask) * STRAIGHT_STEP + (steps >> half & mask) * DIAGONAL_STEP;
        Some(base.wrapping_add(above))
    }
}

/// The number of bits set below a bit, in a mask of two words. Cortex-M has no instruction for it,
/// so both words are summed together.
#[inline(always)]
fn ones_before(low: u32, high: u32, bit: u32) -> u32 {
    let below = (1u32 << (bit % 32)) - 1;
    let (low, high) = if bit < 32 { (low & below, 0) } else { (low, high & below) };
    let pairs = |word: u32| word - (word >> 1 & 0x5555_5555);
    let fours = |word: u32| (word & 0x3333_3333) + (word >> 2 & 0x3333_3333);
    // At most 8 in each half byte, so the sum of both words fits.
    let both = fours(pairs(low)) + fours(pairs(high));
    let bytes = (both & 0x0f0f_0f0f) + (both >> 4 & 0x0f0f_0f0f);
    bytes.wrapping_mul(0x0101_0101) >> 24
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_bits_are_counted_below_a_bit() {
        for mask in [0u64, u64::MAX, 0x8000_0001_8000_0001, 0x0123_4567_89ab_cdef] {
            for bit in 0..64 {
                let expected = (mask & ((1 << bit) - 1)).count_ones();
                assert_eq!(ones_before(mask as u32, (mask >> 32) as u32, bit), expected);
            }
        }
    }
}
