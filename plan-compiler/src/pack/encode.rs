//! Encodes blocks and superblocks as words.

use super::parts::Parts;
use crate::field::MOVES;
use plan_format::Superblock;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::layout::{
    BASE_SHIFT, BASES, BLOCK_CELLS, BLOCKS, CLASS_SHIFT, GROUP, HEADER_WORDS, INDEX_1, INDEX_4,
    OWN, OWN_4_4, OWN_8_8, OWN_24, OWN_32, OWN_SHIFT, class_entries, index_bits, own_words,
};

/// The contents of a block.
#[derive(Clone, Debug)]
pub(crate) enum Block {
    /// Entries, each with its cells (one bit per cell); all other cells may have any entry. At most
    /// [`MAX_BLOCK_ENTRIES`]; empty if no cell of the block matters.
    Palette(Vec<(u32, u64)>),
    /// Each cell's own code and cost.
    Own,
}

/// The cells of a block that have their own code and cost.
pub(crate) struct OwnCells {
    /// One bit per cell.
    mask: u64,
    count: usize,
    /// The codes of these cells, in the order of the mask. The rest are filled with a code that is
    /// not a move.
    codes: [u8; BLOCK_CELLS],
    /// The costs of these cells, in the order of the mask.
    costs: [u32; BLOCK_CELLS],
}

impl OwnCells {
    /// None yet.
    pub(crate) fn new() -> Self {
        Self { mask: 0, count: 0, codes: [MOVES; BLOCK_CELLS], costs: [0; BLOCK_CELLS] }
    }

    /// Adds the next cell of the block if it matters; all moves do. It does not branch, since the
    /// processor could not predict the branch in noise and mazes.
    #[inline(always)]
    pub(crate) fn add(&mut self, cell: usize, matters: bool, code: u8, cost: u32) {
        let at = self.count % BLOCK_CELLS;
        (self.codes[at], self.costs[at]) = (code, cost);
        self.mask |= u64::from(matters) << cell;
        self.count += usize::from(matters);
    }
}

/// Most entries that one block may choose from.
pub(crate) const MAX_BLOCK_ENTRIES: usize = class_entries(INDEX_4) as usize;

/// The superblock of 16 blocks. `entry_bits` is 4 or 16. `filler` is the entry for cells that do
/// not matter. `own` writes the words of the own cells of the block at a position and returns the
/// width of their costs.
pub(crate) fn superblock(
    blocks: &[&Block; BLOCKS],
    entry_bits: u32,
    filler: u32,
    own: impl Fn(usize, &mut Vec<u32>) -> u32,
) -> Superblock {
    let (encodings, palette) = encodings(blocks);
    let is_plain = encodings.iter().all(|encoding| matches!(encoding.class, Class::Plain));
    if let (true, [] | [_]) = (is_plain, &palette.entries[..]) {
        return Superblock::Uniform(palette.entries.first().copied().unwrap_or(filler));
    }
    let Palette { mut entries, bases } = palette;
    let mut descriptors = [0u16; BLOCKS];
    let mut data = Data::default();
    let mut words = Vec::with_capacity(own_words(OWN_32, BLOCK_CELLS));
    // Blocks of own cells come last, since their descriptors reach farther.
    let (own_blocks, others): (Vec<usize>, Vec<usize>) =
        (0..BLOCKS).partition(|&at| matches!(encodings[at].class, Class::Own));
    for at in others {
        let (encoding, base) = (&encodings[at], bases[at]);
        words.clear();
        let class = encoding.write(&entries[base.min(entries.len())..], &mut words);
        let length = class_entries(class) as usize;
        if entries.len() < base + length {
            entries.resize(base + length, entries.last().copied().unwrap_or(filler));
        }
        let offset = data.put(&words);
        descriptors[at] = (class << CLASS_SHIFT) as u16 | (base << BASE_SHIFT | offset) as u16;
    }
    for at in own_blocks {
        words.clear();
        let width = own(at, &mut words);
        let offset = data.put(&words);
        descriptors[at] = (OWN << CLASS_SHIFT | width << OWN_SHIFT) as u16 | offset as u16;
    }
    let palette = palette_words(&entries, entry_bits);
    let pairs = descriptors.as_chunks::<2>().0.iter();
    let header = pairs.map(|&[low, high]| u32::from(low) | u32::from(high) << 16);
    Superblock::Words {
        first: palette.len() + HEADER_WORDS as usize,
        words: palette.into_iter().chain(header).chain(data.words).collect(),
    }
}

/// The blocks of a superblock whose entries do not fit its palette beside those of the others.
pub(crate) fn too_many(blocks: &[&Block; BLOCKS]) -> impl Iterator<Item = usize> + use<> {
    let (encodings, _) = encodings(blocks);
    let is_own = encodings.map(|encoding| matches!(encoding.class, Class::Own));
    (0..BLOCKS).filter(move |&at| is_own[at])
}

/// How blocks are stored, and their palette. Blocks that do not fit it get own cells.
fn encodings<'b>(blocks: &[&'b Block; BLOCKS]) -> ([Encoding<'b>; BLOCKS], Palette) {
    let mut encodings = blocks.map(Encoding::of);
    loop {
        if let Some(palette) = Palette::of(&encodings) {
            return (encodings, palette);
        }
        free_palette(&mut encodings);
    }
}

/// The words of a palette, which is stored backwards.
fn palette_words(entries: &[u32], entry_bits: u32) -> Vec<u32> {
    let word = |entries: &[u32]| {
        entries.iter().rev().fold(0, |word: u32, entry| word << entry_bits | entry)
    };
    entries.chunks(32 / entry_bits as usize).rev().map(word).collect()
}

/// Frees room in a palette. If all entries are few, as in planes without own cells, all blocks share
/// them; otherwise the block with the most entries gets own cells.
fn free_palette(encodings: &mut [Encoding<'_>; BLOCKS]) {
    let mut all: Vec<u32> = encodings.iter().flat_map(|encoding| encoding.entries()).collect();
    all.sort_unstable();
    all.dedup();
    if all.len() <= MAX_BLOCK_ENTRIES {
        for encoding in encodings.iter_mut().filter(|encoding| encoding.wanted.len() > 1) {
            encoding.class = Class::Indexed;
            encoding.window.clone_from(&all);
        }
        return;
    }
    if let Some(encoding) = encodings.iter_mut().max_by_key(|encoding| encoding.window.len()) {
        encoding.class = Class::Own;
        encoding.window.clear();
    }
}

/// How a block will be stored.
struct Encoding<'b> {
    class: Class,
    /// Entries that must be adjacent in the palette; in this order if the block is split into
    /// parts.
    window: Vec<u32>,
    wanted: &'b [(u32, u64)],
}

enum Class {
    Plain,
    Split(Parts),
    Indexed,
    Own,
}

impl<'b> Encoding<'b> {
    fn of(block: &'b Block) -> Self {
        let Block::Palette(wanted) = block else {
            return Self { class: Class::Own, window: Vec::new(), wanted: &[] };
        };
        let mut window: Vec<u32> = wanted.iter().map(|&(entry, _)| entry).collect();
        let class = if wanted.len() <= 1 {
            Class::Plain
        } else if let Some(parts) = parts(wanted) {
            window = parts.order.iter().map(|&at| wanted[at].0).collect();
            Class::Split(parts)
        } else {
            Class::Indexed
        };
        Self { class, window, wanted }
    }

    fn entries(&self) -> impl Iterator<Item = u32> {
        self.wanted.iter().map(|&(entry, _)| entry)
    }

    /// Writes the words of the block; `window` is the palette from its window on. Returns its
    /// class.
    fn write(&self, window: &[u32], words: &mut Vec<u32>) -> u32 {
        match &self.class {
            Class::Split(parts) => {
                words.extend_from_slice(&parts.borders);
                parts.borders.len() as u32
            }
            _ => {
                let class = index_class(self.window.len());
                write_indices(self.wanted, window, class, words);
                class
            }
        }
    }
}

fn parts(wanted: &[(u32, u64)]) -> Option<Parts> {
    match *wanted {
        [(_, a), (_, b)] => Parts::of(&[a, b]),
        [(_, a), (_, b), (_, c)] => Parts::of(&[a, b, c]),
        _ => None,
    }
}

/// The words after the descriptors. Equal blocks are stored once.
#[derive(Default)]
struct Data {
    words: Vec<u32>,
    known: Vec<(usize, usize)>,
}

impl Data {
    /// Stores a block and returns its offset.
    fn put(&mut self, block: &[u32]) -> usize {
        let is_equal = |&(start, end): &(usize, usize)| self.words[start..end] == *block;
        if let Some(&(start, _)) = self.known.iter().find(|&range| is_equal(range)) {
            return start;
        }
        if block.is_empty() {
            return 0;
        }
        let start = self.words.len();
        self.words.extend_from_slice(block);
        self.known.push((start, self.words.len()));
        start
    }
}

/// Writes each cell's index into a window of the palette, 0 where it does not matter.
fn write_indices(wanted: &[(u32, u64)], window: &[u32], class: u32, words: &mut Vec<u32>) {
    if class == 0 {
        return;
    }
    let mut cells = [0u8; BLOCK_CELLS];
    for &(entry, mask) in wanted {
        let index = window.iter().position(|&known| known == entry).unwrap_or(0) as u8;
        if index > 0 {
            ones(mask).for_each(|cell| cells[cell] = index);
        }
    }
    let mut write = |shift: u32, bits: u32| {
        for cells in cells.chunks(32 / bits as usize) {
            let number = |&cell: &u8| u32::from(cell) >> shift & ((1 << bits) - 1);
            words.push(cells.iter().rev().fold(0, |word, cell| word << bits | number(cell)));
        }
    };
    match index_bits(class) {
        3 => {
            write(0, 2);
            write(2, 1);
        }
        bits => write(0, bits),
    }
}

/// The class of a block whose entries may be in any order, from their number.
pub(crate) fn index_class(entries: usize) -> u32 {
    let fits = |&class: &u32| entries <= class_entries(class) as usize;
    if entries <= 1 { 0 } else { (INDEX_1..INDEX_4).find(fits).unwrap_or(INDEX_4) }
}

/// The numbers of the bits that are set.
pub(crate) fn ones(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (bits != 0).then(|| {
            let bit = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            bit
        })
    })
}

/// Entries that contain, for each block, a window with all of its entries.
struct Palette {
    entries: Vec<u32>,
    /// Where the window of each block begins.
    bases: [usize; BLOCKS],
}

impl Palette {
    /// `None` if a window would begin beyond the reach of a descriptor.
    fn of(encodings: &[Encoding<'_>; BLOCKS]) -> Option<Self> {
        let mut wanted: Vec<usize> =
            (0..BLOCKS).filter(|&at| !encodings[at].window.is_empty()).collect();
        // Long windows first: short ones are then often inside them.
        wanted.sort_by_key(|&at| std::cmp::Reverse(encodings[at].window.len()));
        let mut palette = Self { entries: Vec::new(), bases: [0; BLOCKS] };
        for at in wanted {
            let encoding = &encodings[at];
            let base = palette.window(encoding).or_else(|| {
                palette.append(encoding);
                palette.window(encoding)
            });
            palette.bases[at] = base.filter(|&base| base < BASES)?;
        }
        Some(palette)
    }

    /// The start of the first window that serves a block.
    fn window(&self, encoding: &Encoding<'_>) -> Option<usize> {
        let wanted = &encoding.window[..];
        let &first = wanted.first()?;
        if let Class::Split(_) = encoding.class {
            return self.entries.windows(wanted.len()).position(|window| window == wanted);
        }
        let length = class_entries(index_class(wanted.len())) as usize;
        if !wanted[1..].iter().all(|entry| self.entries.contains(entry)) {
            return None;
        }
        // Only windows that contain the first entry need a check.
        let mut next = 0;
        for (at, _) in self.entries.iter().enumerate().filter(|&(_, &entry)| entry == first) {
            let from = next.max((at + 1).saturating_sub(length));
            next = at + 1;
            let serves = |&base: &usize| {
                let window = &self.entries[base..self.entries.len().min(base + length)];
                wanted[1..].iter().all(|entry| window.contains(entry))
            };
            if let Some(base) = (from..next).find(serves) {
                return Some(base);
            }
        }
        None
    }

    /// Adds a window; reuses the part of it that is already at the end.
    fn append(&mut self, encoding: &Encoding<'_>) {
        let wanted = &encoding.window[..];
        if let Class::Split(_) = encoding.class {
            let kept =
                (0..wanted.len()).rev().find(|&kept| self.entries.ends_with(&wanted[..kept]));
            self.entries.extend_from_slice(&wanted[kept.unwrap_or(0)..]);
            return;
        }
        let kept = self.entries.iter().rev().take_while(|entry| wanted.contains(entry)).count();
        let tail = self.entries[self.entries.len() - kept.min(wanted.len())..].to_vec();
        self.entries.extend(wanted.iter().filter(|entry| !tail.contains(entry)));
    }
}

impl OwnCells {
    /// Writes the words of the block. Returns the width of the costs: the smallest that holds them.
    #[inline(always)]
    pub(crate) fn write(&self, words: &mut Vec<u32>) -> u32 {
        let (width, base, costs) = self.stored();
        words.extend([self.mask as u32, (self.mask >> 32) as u32, base]);
        let groups = self.codes.chunks_exact(GROUP).zip(costs.chunks_exact(GROUP));
        for (group, (codes, costs)) in groups.take(self.count.div_ceil(GROUP)).enumerate() {
            words.push(codes.iter().rev().fold(0, |word, &code| word << 4 | u32::from(code & 15)));
            let word = |costs: &[u32], bits: u32| {
                costs.iter().rev().fold(0, |word, &cost| word << bits | cost)
            };
            let count = GROUP.min(self.count - group * GROUP);
            match width {
                OWN_4_4 => words.extend(costs[..count].chunks(4).map(|costs| word(costs, 8))),
                OWN_8_8 => words.extend(costs[..count].chunks(2).map(|costs| word(costs, 16))),
                OWN_24 => words.extend(bytes_of_24(&costs[..count]).chunks(4).map(|bytes| {
                    bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte))
                })),
                _ => words.extend_from_slice(&costs[..count]),
            }
        }
        width
    }

    /// As [`Self::stored`], without counting steps.
    fn stored_whole(&self) -> (u32, u32, [u32; BLOCK_CELLS]) {
        let moves = || self.costs.iter().zip(&self.codes).filter(|&(_, &code)| code < MOVES);
        let least = moves().map(|(&cost, _)| cost).min().unwrap_or(0);
        let above = self.costs.map(|cost| cost.wrapping_sub(least));
        let fits = moves().all(|(&cost, _)| cost - least < 1 << 24);
        if fits { (OWN_24, least, above) } else { (OWN_32, 0, self.costs) }
    }

    /// The width of the costs, their base, and the costs as stored. Only moves have a cost; other
    /// cells get one that does not make the width larger.
    #[inline(always)]
    fn stored(&self) -> (u32, u32, [u32; BLOCK_CELLS]) {
        // One plain loop per result, so that the compiler can vectorise each.
        let [mut straight, mut diagonal] = [[0; BLOCK_CELLS]; 2];
        for (diagonal, &cost) in diagonal.iter_mut().zip(&self.costs) {
            *diagonal = cost % STRAIGHT_STEP * INVERSE % STRAIGHT_STEP;
        }
        for ((straight, &diagonal), &cost) in straight.iter_mut().zip(&diagonal).zip(&self.costs) {
            *straight = cost.wrapping_sub(diagonal * DIAGONAL_STEP) / STRAIGHT_STEP;
        }
        let mut all_are_paths = true;
        for ((&diagonal, &cost), &code) in diagonal.iter().zip(&self.costs).zip(&self.codes) {
            all_are_paths &= (code >= MOVES) | (diagonal * DIAGONAL_STEP <= cost);
        }
        let range = |steps: &[u32; BLOCK_CELLS]| {
            let (mut least, mut most) = (u32::MAX, 0);
            for (&count, &code) in steps.iter().zip(&self.codes) {
                least = least.min(if code < MOVES { count } else { u32::MAX });
                most = most.max(if code < MOVES { count } else { 0 });
            }
            [least, most]
        };
        let ([least_straight, most_straight], [least_diagonal, most_diagonal]) =
            (range(&straight), range(&diagonal));
        if least_straight > most_straight {
            return (OWN_4_4, 0, [0; BLOCK_CELLS]);
        }
        let widest = (most_straight - least_straight).max(most_diagonal - least_diagonal);
        if !all_are_paths || widest > 0xff {
            return self.stored_whole();
        }
        let width = if widest <= 0xf { OWN_4_4 } else { OWN_8_8 };
        let mut stored = [0; BLOCK_CELLS];
        for (cell, stored) in stored.iter_mut().enumerate() {
            let straight = straight[cell].wrapping_sub(least_straight);
            let diagonal = diagonal[cell].wrapping_sub(least_diagonal);
            let is_move = self.codes[cell] < MOVES;
            *stored = if is_move { straight | diagonal << (4 << width) } else { 0 };
        }
        (width, least_straight * STRAIGHT_STEP + least_diagonal * DIAGONAL_STEP, stored)
    }
}

/// The three lowest bytes of each cost.
fn bytes_of_24(costs: &[u32]) -> Vec<u8> {
    costs.iter().flat_map(|cost| cost.to_le_bytes().into_iter().take(3)).collect()
}

// [`OwnCells::stored`] solves `straight * 5741 + diagonal * 8119 = cost` with the fewest diagonal
// steps, less than 5741, by the inverse of the diagonal step modulo the straight one.
const _: () = assert!(STRAIGHT_STEP.checked_mul(DIAGONAL_STEP).is_some(), "no step overflows");
const _: () = assert!(STRAIGHT_STEP.checked_mul(STRAIGHT_STEP).is_some(), "nor does a remainder");

/// The inverse of the diagonal step modulo the straight one.
const INVERSE: u32 = {
    let mut inverse = 1;
    while (inverse * (DIAGONAL_STEP % STRAIGHT_STEP)) % STRAIGHT_STEP != 1 {
        inverse += 1;
    }
    inverse
};
