//! The layout of section `cells`, on which the reader and every packer must agree.
//!
//! `FORMAT.md` describes the words. Here are their constants, the sizes that follow, and the
//! arithmetic that gives a cell its cost and its direction from its root.

use crate::grid::{Cell, Direction, MAX_SIDE_CELLS, octile};

/// Bytes of a word. The section is read in whole words.
pub const WORD_BYTES: usize = 4;

/// Side of a superblock, cells, as a power of two.
pub const SUPERBLOCK_SHIFT: u32 = 5;
/// Blocks in a superblock.
pub const BLOCKS: usize = 16;
/// Cells in a block.
pub const BLOCK_CELLS: usize = 64;
/// Words of a superblock's descriptors, between its palette and its blocks.
pub const HEADER_WORDS: u32 = BLOCKS as u32 / 2;

/// Flag in a table: all cells of the superblock have the entry in the other bits. Without the
/// flag, the number is the offset of the superblock's blocks, in words.
pub const UNIFORM: u32 = 1 << 31;

/// Bits of a descriptor below its class.
pub const CLASS_SHIFT: u32 = 13;
/// Bits of a descriptor below the base of its window in the palette.
pub const BASE_SHIFT: u32 = 7;
/// Number of palette entries at which a window may begin.
pub const BASES: usize = 1 << (CLASS_SHIFT - BASE_SHIFT);
/// Most borders in a block. Up to this class, the class is the number of borders.
pub const MAX_BORDERS: u32 = 2;
/// Class of blocks with an index of 1 bit for each cell; the next three classes have 2 to 4 bits.
pub const INDEX_1: u32 = MAX_BORDERS + 1;
/// Class of blocks with an index of 4 bits for each cell.
pub const INDEX_4: u32 = INDEX_1 + 3;
/// Class of blocks whose cells have their own code and cost.
pub const OWN: u32 = INDEX_4 + 1;
/// Bits of a descriptor of class [`OWN`] below the width of its costs.
pub const OWN_SHIFT: u32 = 11;
/// Width of costs: straight and diagonal steps above a base, in 4 + 4 bits.
pub const OWN_4_4: u32 = 0;
/// Width of costs: straight and diagonal steps above a base, in 8 + 8 bits.
pub const OWN_8_8: u32 = 1;
/// Width of costs: the cost itself in 32 bits.
pub const OWN_32: u32 = 2;
/// Width of costs: the cost above a base in 24 bits, for layers with tolls.
pub const OWN_24: u32 = 3;
/// Words of a block of class [`OWN`] before its groups: the mask of its cells (2) and the base.
pub const OWN_HEADER_WORDS: usize = 3;
/// Cells in a group of a block of class [`OWN`]: their codes of 4 bits fill a word.
pub const GROUP: usize = 8;
/// Code of the goal in a block of class [`OWN`], where 0 to 7 are moves.
pub const OWN_GOAL: u8 = 8;
/// Code of a free cell without a route in a block of class [`OWN`].
pub const OWN_NO_ROUTE: u8 = 9;

/// Bits of an entry of plane `terrain`.
pub const TERRAIN_BITS: u32 = 4;
/// Bits of an entry of plane `routes`.
pub const ROUTE_BITS: u32 = 16;
/// Entry of plane `routes` for a free cell without a route. Every other entry is twice the number
/// of a root, plus one if the straight part of the path comes first.
pub const NO_ROUTE_ENTRY: u32 = u16::MAX as u32;
/// Words of a root: column and row, cost.
pub const ROOT_WORDS: u32 = 2;

/// Bits of an entry of plane `corrections`: the number of a value.
pub const CORRECTION_BITS: u32 = 16;
/// Bits of an entry of plane `limits`: a speed in cm/s, [`NO_LIMIT`] for none.
pub const LIMIT_BITS: u32 = 16;
/// Entry of plane `limits` where speed is not limited.
pub const NO_LIMIT: u32 = 0;
/// The different multipliers that the roots of a layer with tolls may have.
pub const MULTIPLIERS: usize = 16;
/// Stands for a plane that a layer with tolls does not have.
pub const NO_TABLE: u32 = u32::MAX;
/// Words that precede the roots of a layer with tolls: see [`TollHeader`].
pub const TOLL_WORDS: u32 = 4 + MULTIPLIERS as u32 / 4;
/// Bits of an entry of plane `goals`: the number of the goal that the advice leads to.
pub const GOAL_BITS: u32 = 4;
/// Words before the roots, and before the toll header, of a layer with several goals: where the table
/// of plane `goals` begins, and where the list of the goals begins.
pub const GOALS_WORDS: u32 = 2;
/// Words of a goal in the list of goals, behind their number: x and y as `f64`, metres.
pub const GOAL_WORDS: u32 = 4;
/// Bits of the rank in a layer's record; above it are the unit of costs, the flag of tolls and the
/// flag of several goals.
pub(crate) const RANK_BITS: u32 = 3;
/// Bits of the unit of costs in a layer's record.
pub(crate) const UNIT_BITS: u32 = 2;
/// The smallest unit of costs: an eighth of 1/5741 cell.
pub const MAX_UNIT: u8 = 3;

const SIDE_BITS: u32 = MAX_SIDE_CELLS.trailing_zeros();
const _: () = assert!(SIDE_BITS == 14, "two bits of a multiplier fit beside each coordinate");

/// An entry of plane `terrain`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terrain {
    /// A free cell: entry 0.
    Free,
    /// A blocked cell from which no free cell with a route can be reached: entry 1.
    NoEscape,
    /// A blocked cell and the first step out of it: entry 2 plus the direction's code.
    Escape(Direction),
}

impl Terrain {
    const FIRST_ESCAPE: u32 = 2;

    /// The number that the plane holds.
    #[inline(always)]
    pub const fn entry(self) -> u32 {
        match self {
            Self::Free => 0,
            Self::NoEscape => 1,
            Self::Escape(direction) => Self::FIRST_ESCAPE + direction.code() as u32,
        }
    }

    /// The meaning of an entry; an arbitrary escape from [`Terrain::ENTRIES`] on.
    #[inline(always)]
    pub(crate) const fn of_entry(entry: u32) -> Self {
        match entry {
            0 => Self::Free,
            1 => Self::NoEscape,
            _ => Self::Escape(Direction::from_code(entry.wrapping_sub(Self::FIRST_ESCAPE) as u8)),
        }
    }

    /// Number of entries of plane `terrain`.
    pub(crate) const ENTRIES: u32 = Self::FIRST_ESCAPE + Direction::ALL.len() as u32;
}

/// Superblocks along a side of a grid, from the side's length in cells.
#[inline(always)]
pub const fn superblocks(cells: u32) -> u32 {
    cells.wrapping_add((1 << SUPERBLOCK_SHIFT) - 1) >> SUPERBLOCK_SHIFT
}

/// Bits of each cell's index in a block of class [`INDEX_1`] to [`INDEX_4`].
#[inline(always)]
pub const fn index_bits(class: u32) -> u32 {
    class - MAX_BORDERS
}

/// Entries in the palette window of a block of a class below [`OWN`].
#[inline]
pub const fn class_entries(class: u32) -> u32 {
    if class < INDEX_1 { class + 1 } else { 1 << index_bits(class) }
}

/// Words of a block of a class below [`OWN`].
#[inline]
pub const fn data_words(class: u32) -> usize {
    if class < INDEX_1 { class as usize } else { index_bits(class) as usize * BLOCK_CELLS / 32 }
}

/// Words of a full group in a block of class [`OWN`].
#[inline(always)]
pub(crate) const fn group_words(width: u32) -> u32 {
    // Eight costs of 8, 16, 32 or 24 bits, behind a word of codes.
    1 + if width == OWN_24 { 6 } else { 2 << width }
}

/// Words of a block of class [`OWN`], from the width of its costs and the number of cells that have
/// their own code and cost.
#[inline]
pub const fn own_words(width: u32, cells: usize) -> usize {
    let full = group_words(width) as usize;
    let last = cells % GROUP;
    let last_words = if last == 0 { 0 } else { 1 + ((full - 1) * last).div_ceil(GROUP) };
    OWN_HEADER_WORDS + cells / GROUP * full + last_words
}

/// A cell to which other cells refer, and its cost to the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Root {
    /// The cell.
    pub cell: Cell,
    /// Its cost to the goal, units of 1/5741 cell.
    pub cost: u32,
}

impl Root {
    /// The words of a root in the section.
    #[inline]
    pub const fn words(self) -> [u32; ROOT_WORDS as usize] {
        [self.cell.to_word(), self.cost]
    }

    /// The cost of a cell that refers to this root.
    #[inline(always)]
    pub fn cost_from(self, cell: Cell) -> u32 {
        let columns = self.cell.column.abs_diff(cell.column);
        let rows = self.cell.row.abs_diff(cell.row);
        self.cost.wrapping_add(octile(columns, rows))
    }
}

/// What precedes the roots of a layer with tolls. Offsets are words of section `cells`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TollHeader {
    /// Where the table of plane `corrections` begins.
    pub corrections: u32,
    /// Where the [`Correction`]s begin that entries of plane `corrections` number, one word each.
    pub values: u32,
    /// The number of these values, at least 1.
    pub value_count: u32,
    /// Where the table of plane `limits` begins, or [`NO_TABLE`].
    pub limits: u32,
    /// What roots multiply steps by, less 1, in the layer's unit; four a word, the first lowest.
    pub multipliers: [u8; MULTIPLIERS],
}

impl TollHeader {
    /// The words of the header.
    pub fn words(&self) -> [u32; TOLL_WORDS as usize] {
        let numbers = |first: usize| {
            u32::from_le_bytes(core::array::from_fn(|at| self.multipliers[first + at]))
        };
        let [corrections, values] = [self.corrections, self.values];
        let [a, b, c, d] = [numbers(0), numbers(4), numbers(8), numbers(12)];
        [corrections, values, self.value_count, self.limits, a, b, c, d]
    }
}

/// What a cell's answer differs from what its root says, in a layer with tolls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Correction(u32);

impl Correction {
    /// The answer is as the root says.
    pub const NONE: Self = Self(Self::AS_ROOT);
    const COST_BITS: u32 = 28;
    const AS_ROOT: u32 = 8 << Self::COST_BITS;

    /// A correction by a cost, modulo 2^32, and of the first step if one is given. `None` if the cost
    /// exceeds 28 bits with its sign.
    pub fn new(cost: u32, step: Option<Direction>) -> Option<Self> {
        let low = cost & ((1 << Self::COST_BITS) - 1);
        let step = step.map_or(Self::AS_ROOT, |step| u32::from(step.code()) << Self::COST_BITS);
        Some(Self(low | step)).filter(|correction| correction.cost() == cost)
    }

    /// The correction of a word.
    #[inline(always)]
    pub const fn of_word(word: u32) -> Self {
        Self(word)
    }

    /// The word of the correction.
    pub const fn word(self) -> u32 {
        self.0
    }

    /// What is added to the cost, modulo 2^32.
    #[inline(always)]
    pub const fn cost(self) -> u32 {
        const UNUSED: u32 = u32::BITS - Correction::COST_BITS;
        ((self.0 << UNUSED) as i32 >> UNUSED) as u32
    }

    /// The first step; `None` if the root decides.
    #[inline(always)]
    pub fn step(self) -> Option<Direction> {
        let code = self.0 >> Self::COST_BITS;
        if code < 8 { Some(Direction::from_code(code as u8)) } else { None }
    }
}

/// The root of a cell in a layer with tolls. A step on the way to it costs `multiplier` times as much
/// as without tolls, and the cell's correction makes up for what differs from that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TolledRoot {
    /// The cell.
    pub cell: Cell,
    /// Its cost to the goal, in the layer's unit.
    pub cost: u32,
    /// Number of its multiplier in [`TollHeader::multipliers`].
    pub multiplier: u8,
}

impl TolledRoot {
    /// The words of a root in the section.
    pub const fn words(self) -> [u32; ROOT_WORDS as usize] {
        let number = self.multiplier as u32;
        let (low, high) = (number & 3, number >> 2 & 3);
        let word = self.cell.to_word() | low << SIDE_BITS | high << (SIDE_BITS + 16);
        [word, self.cost]
    }

    /// The cell in the first word of a root.
    #[inline(always)]
    pub(crate) const fn cell_of(word: u32) -> Cell {
        const SIDES: u32 = (1 << SIDE_BITS) - 1;
        Cell::of_word(word & (SIDES | SIDES << 16))
    }

    /// The number of the multiplier in the first word of a root.
    #[inline(always)]
    pub(crate) const fn multiplier_of(word: u32) -> u32 {
        word >> SIDE_BITS & 3 | word >> (SIDE_BITS + 16) << 2
    }
}

/// The cost of a cell that refers to a root at a cost and with a multiplier, before its correction.
#[inline(always)]
pub fn tolled_cost(root: Cell, root_cost: u32, multiplier: u32, cell: Cell) -> u32 {
    let (columns, rows) = (root.column.abs_diff(cell.column), root.row.abs_diff(cell.row));
    root_cost.wrapping_add(octile(columns, rows).wrapping_mul(multiplier))
}

/// The first step from a cell towards another; `None` if they are the same.
#[inline(always)]
pub fn first_step(from: Cell, to: Cell, straight_first: bool) -> Option<Direction> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terrain_comes_back_from_its_entry() {
        let escapes = Direction::ALL.map(Terrain::Escape);
        let all = [Terrain::Free, Terrain::NoEscape].into_iter().chain(escapes);
        for (entry, terrain) in (0..).zip(all) {
            assert_eq!(terrain.entry(), entry);
            assert_eq!(Terrain::of_entry(entry), terrain);
            assert!(entry < Terrain::ENTRIES);
        }
        assert_eq!(Terrain::ENTRIES, 10);
    }
}
