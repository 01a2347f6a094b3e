//! Blocks and superblocks: from what each cell needs to words.

use super::parts::Parts;
use crate::blocks::{
    BASE_SHIFT, BASES, BLOCK_CELLS, BLOCKS, CLASS_SHIFT, GROUP, HEADER_WORDS, INDEX_1, INDEX_4,
    OWN, OWN_4_4, OWN_8_8, OWN_32, OWN_SHIFT, class_entries, index_bits, own_words,
};
use crate::field::MOVES;
use crate::grid::{DIAGONAL_STEP, STRAIGHT_STEP};

/// What a block will hold.
#[derive(Clone, Debug)]
pub(crate) enum Block {
    /// Entries, and the cells (one bit each) that each of them is for; the others may have any of
    /// them. At most [`MAX_BLOCK_ENTRIES`]; none if no cell of the block matters.
    Palette(Vec<(u32, u64)>),
    /// Each cell's own code and cost.
    Own,
}

/// Each cell's own code and cost; `None` for a cell that does not matter.
pub(crate) type OwnCells = [Option<(u8, u32)>; BLOCK_CELLS];

/// Most entries that one block may choose from.
pub(crate) const MAX_BLOCK_ENTRIES: usize = class_entries(INDEX_4) as usize;

/// A superblock as it is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Superblock {
    /// One entry for all cells.
    Uniform(u32),
    /// A palette, descriptors, and blocks, of which this is the first word.
    Words { first: usize, words: Vec<u32> },
}

/// The superblock of 16 blocks. `entry_bits` is 4 or 16, `filler` the entry where none matters, and
/// `own` gives the cells of a block by its position.
pub(crate) fn superblock(
    blocks: &[&Block; BLOCKS],
    entry_bits: u32,
    filler: u32,
    own: impl Fn(usize) -> OwnCells,
) -> Superblock {
    let mut plans = blocks.map(Plan::of);
    let palette = loop {
        if let Some(palette) = Palette::of(&plans) {
            break palette;
        }
        give_way(&mut plans, entry_bits);
    };
    let is_plain = plans.iter().all(|plan| matches!(plan.class, Class::Plain));
    if let (true, [] | [_]) = (is_plain, &palette.entries[..]) {
        return Superblock::Uniform(palette.entries.first().copied().unwrap_or(filler));
    }
    let mut entries = palette.entries.clone();
    let mut descriptors = [0u16; BLOCKS];
    let mut data = Data::default();
    // Blocks of own cells stand last: their descriptors reach farther.
    let (own_plans, others): (Vec<usize>, Vec<usize>) =
        (0..BLOCKS).partition(|&at| matches!(plans[at].class, Class::Own));
    for at in others {
        let plan = &plans[at];
        let base = palette.window(plan).unwrap_or(0);
        let (class, words) = plan.words(&entries[base.min(entries.len())..]);
        let length = class_entries(class) as usize;
        if entries.len() < base + length {
            entries.resize(base + length, entries.last().copied().unwrap_or(filler));
        }
        let offset = data.put(words);
        descriptors[at] = (class << CLASS_SHIFT) as u16 | (base << BASE_SHIFT | offset) as u16;
    }
    for at in own_plans {
        let (width, words) = own_block(&own(at));
        let offset = data.put(words);
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

/// The words of a palette, which runs backwards.
fn palette_words(entries: &[u32], entry_bits: u32) -> Vec<u32> {
    let word = |entries: &[u32]| {
        entries.iter().rev().fold(0, |word: u32, entry| word << entry_bits | entry)
    };
    entries.chunks(32 / entry_bits as usize).rev().map(word).collect()
}

/// Makes room in a palette: the block with the most entries gets its own cells or, in a plane that
/// has none of these, all blocks share all entries, which are few.
fn give_way(plans: &mut [Plan<'_>; BLOCKS], entry_bits: u32) {
    if entry_bits < 16 {
        let mut all: Vec<u32> = plans.iter().flat_map(|plan| plan.entries()).collect();
        all.sort_unstable();
        all.dedup();
        for plan in plans.iter_mut().filter(|plan| plan.wanted.len() > 1) {
            plan.class = Class::Indexed;
            plan.window.clone_from(&all);
        }
        return;
    }
    if let Some(plan) = plans.iter_mut().max_by_key(|plan| plan.window.len()) {
        plan.class = Class::Own;
        plan.window.clear();
    }
}

/// How a block will be stored.
struct Plan<'b> {
    class: Class,
    /// Entries that must stand together in the palette; for parts, in this order.
    window: Vec<u32>,
    wanted: &'b [(u32, u64)],
}

enum Class {
    Plain,
    Parted(Parts),
    Indexed,
    Own,
}

impl<'b> Plan<'b> {
    fn of(block: &'b Block) -> Self {
        let Block::Palette(wanted) = block else {
            return Self { class: Class::Own, window: Vec::new(), wanted: &[] };
        };
        let mut window: Vec<u32> = wanted.iter().map(|&(entry, _)| entry).collect();
        let class = if wanted.len() <= 1 {
            Class::Plain
        } else if let Some(parts) = parts(wanted) {
            window = parts.order.iter().map(|&at| wanted[at].0).collect();
            Class::Parted(parts)
        } else {
            Class::Indexed
        };
        Self { class, window, wanted }
    }

    fn entries(&self) -> impl Iterator<Item = u32> {
        self.wanted.iter().map(|&(entry, _)| entry)
    }

    /// Class and words of the block, with the palette from its window on.
    fn words(&self, window: &[u32]) -> (u32, Vec<u32>) {
        match &self.class {
            Class::Parted(parts) => (parts.borders.len() as u32, parts.borders.clone()),
            _ => {
                let class = index_class(self.window.len());
                (class, indices(self.wanted, window, class))
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

/// Words after the descriptors; equal blocks are stored once.
#[derive(Default)]
struct Data {
    words: Vec<u32>,
    known: Vec<(usize, usize)>,
}

impl Data {
    /// Where a block stands.
    fn put(&mut self, block: Vec<u32>) -> usize {
        let is_equal = |&(start, end): &(usize, usize)| self.words[start..end] == block[..];
        if let Some(&(start, _)) = self.known.iter().find(|&range| is_equal(range)) {
            return start;
        }
        let start = self.words.len();
        self.words.extend(block);
        if self.words.len() > start {
            self.known.push((start, self.words.len()));
            return start;
        }
        0
    }
}

/// Each cell's index into a window of the palette, 0 where it does not matter.
fn indices(wanted: &[(u32, u64)], window: &[u32], class: u32) -> Vec<u32> {
    if class == 0 {
        return Vec::new();
    }
    let mut cells = [0u8; BLOCK_CELLS];
    for &(entry, mask) in wanted {
        let index = window.iter().position(|&known| known == entry).unwrap_or(0) as u8;
        if index > 0 {
            ones(mask).for_each(|cell| cells[cell] = index);
        }
    }
    let part = |shift: u32, bits: u32| {
        let word = move |cells: &[u8]| {
            let number = |&cell: &u8| u32::from(cell) >> shift & ((1 << bits) - 1);
            cells.iter().rev().fold(0, |word: u32, cell| word << bits | number(cell))
        };
        cells.chunks(32 / bits as usize).map(word)
    };
    match index_bits(class) {
        3 => part(0, 2).chain(part(2, 1)).collect(),
        bits => part(0, bits).collect(),
    }
}

/// The class of a block of so many entries in any order.
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

/// Entries in which each block has a window that holds all of its own.
struct Palette {
    entries: Vec<u32>,
}

impl Palette {
    /// `None` if some window would begin where no descriptor reaches.
    fn of(plans: &[Plan<'_>; BLOCKS]) -> Option<Self> {
        let mut wanted: Vec<&Plan<'_>> =
            plans.iter().filter(|plan| !plan.window.is_empty()).collect();
        // Long windows first: the short ones then often lie within.
        wanted.sort_by_key(|plan| std::cmp::Reverse(plan.window.len()));
        let mut palette = Self { entries: Vec::new() };
        for plan in wanted {
            if palette.window(plan).is_none() {
                palette.append(plan);
            }
            palette.window(plan).filter(|&base| base < BASES)?;
        }
        Some(palette)
    }

    /// Where the window of a block begins.
    fn window(&self, plan: &Plan<'_>) -> Option<usize> {
        let wanted = &plan.window[..];
        if let Class::Parted(_) = plan.class {
            return self.entries.windows(wanted.len()).position(|window| window == wanted);
        }
        let length = class_entries(index_class(wanted.len())) as usize;
        (0..self.entries.len()).find(|&base| {
            let window = &self.entries[base..self.entries.len().min(base + length)];
            wanted.iter().all(|entry| window.contains(entry))
        })
    }

    /// Adds a window, using what of it stands at the end already.
    fn append(&mut self, plan: &Plan<'_>) {
        let wanted = &plan.window[..];
        if let Class::Parted(_) = plan.class {
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

/// The width of the costs and the words of a block of cells that have their own code and cost: the
/// smallest that holds them.
fn own_block(cells: &OwnCells) -> (u32, Vec<u32>) {
    let mask = cells.iter().rev().fold(0u64, |mask, cell| mask << 1 | u64::from(cell.is_some()));
    let cells: Vec<(u8, u32)> = cells.iter().flatten().copied().collect();
    let (width, base, costs) = own_costs(&cells);
    let mut words = vec![mask as u32, (mask >> 32) as u32, base];
    for (group, costs) in cells.chunks(GROUP).zip(costs.chunks(GROUP)) {
        words.push(group.iter().rev().fold(0, |word, &(code, _)| word << 4 | u32::from(code)));
        let bits = 8 << width;
        let word = |costs: &[u32]| {
            costs.iter().rev().fold(0, |word: u64, &cost| word << bits | u64::from(cost)) as u32
        };
        words.extend(costs.chunks(32 / bits).map(word));
    }
    debug_assert_eq!(words.len(), own_words(width, cells.len()));
    (width, words)
}

/// The width of costs, their base, and the costs as they are stored. Only moves have one; the
/// others are given one that costs nothing to store.
fn own_costs(cells: &[(u8, u32)]) -> (u32, u32, Vec<u32>) {
    let is_move = |cell: &&(u8, u32)| cell.0 < MOVES;
    let steps: Option<Vec<(u32, u32)>> =
        cells.iter().filter(is_move).map(|&(_, cost)| steps(cost)).collect();
    let least = |of: fn(&(u32, u32)) -> u32, steps: &[(u32, u32)]| steps.iter().map(of).min();
    let highest = |of: fn(&(u32, u32)) -> u32, steps: &[(u32, u32)]| steps.iter().map(of).max();
    let steps = steps.unwrap_or_default();
    let straight = least(|step| step.0, &steps).unwrap_or(0);
    let diagonal = least(|step| step.1, &steps).unwrap_or(0);
    let widest = (highest(|step| step.0, &steps).unwrap_or(0) - straight)
        .max(highest(|step| step.1, &steps).unwrap_or(0) - diagonal);
    if steps.len() < cells.iter().filter(is_move).count() || widest > 0xff {
        return (OWN_32, 0, cells.iter().map(|&(_, cost)| cost).collect());
    }
    let width = if widest <= 0xf { OWN_4_4 } else { OWN_8_8 };
    let mut steps = steps.into_iter();
    let stored = cells.iter().map(|cell| {
        let step = if is_move(&cell) { steps.next() } else { None };
        step.map_or(0, |step| (step.0 - straight) | ((step.1 - diagonal) << (4 << width)))
    });
    (width, straight * STRAIGHT_STEP + diagonal * DIAGONAL_STEP, stored.collect())
}

/// Straight and diagonal steps `(a, b)` with `a 5741 + b 8119 = cost`, as few diagonal ones as can
/// be; `None` if no path has this cost.
fn steps(cost: u32) -> Option<(u32, u32)> {
    let diagonal = cost % STRAIGHT_STEP * INVERSE % STRAIGHT_STEP;
    let straight = cost.checked_sub(diagonal.checked_mul(DIAGONAL_STEP)?)? / STRAIGHT_STEP;
    Some((straight, diagonal))
}

/// The inverse of the diagonal step modulo the straight one.
const INVERSE: u32 = {
    let mut inverse = 1;
    while (inverse * (DIAGONAL_STEP % STRAIGHT_STEP)) % STRAIGHT_STEP != 1 {
        inverse += 1;
    }
    inverse
};
