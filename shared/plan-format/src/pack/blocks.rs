//! Blocks and superblocks: from what each cell needs to bytes.

use crate::blocks::{
    BLOCK_CELLS, BLOCKS, CODES_BYTES, MAX_INDEX_BITS, OWN_4_4, OWN_8_8, OWN_32, PALETTE_AT,
    block_bytes,
};
use crate::grid::{DIAGONAL_STEP, STRAIGHT_STEP};

/// What a block will hold.
#[derive(Clone, Debug)]
pub(crate) enum Block {
    /// Entries, and the cells (one bit each) that each of them is for. At most 16; none if no
    /// cell of the block matters.
    Palette(Vec<(u16, u64)>),
    /// Each cell's own code and cost; `None` for a cell that does not matter.
    Own(Box<[Option<(u8, u32)>; BLOCK_CELLS]>),
}

/// Most entries that one block may choose from.
pub(crate) const MAX_BLOCK_ENTRIES: usize = 1 << MAX_INDEX_BITS;
/// Most entries of a superblock's palette; its length is one byte.
const MAX_PALETTE: usize = 255;

/// The bytes of a superblock; `None` if its palette would be too long.
pub(crate) fn superblock(blocks: &[Block; BLOCKS]) -> Option<Vec<u8>> {
    let palette = Palette::of(blocks)?;
    if let [entry] = palette.entries[..] {
        let [low, high] = entry.to_le_bytes();
        return Some(vec![1, low, high]);
    }
    let mut bytes = vec![palette.entries.len() as u8];
    bytes.resize(PALETTE_AT, 0);
    for entry in &palette.entries {
        bytes.extend_from_slice(&entry.to_le_bytes());
    }
    // Equal blocks of a superblock are stored once.
    let mut written: Vec<(usize, Vec<u8>)> = Vec::new();
    for (block, descriptor_at) in blocks.iter().zip((1..).step_by(2)) {
        let (class, body) = body(block, &palette);
        let rest = match (class, &body[..]) {
            (0, &[index]) => usize::from(index),
            _ => match written.iter().find(|(_, known)| *known == body) {
                Some(&(offset, _)) => offset,
                None => {
                    let offset = bytes.len();
                    bytes.extend_from_slice(&body);
                    written.push((offset, body));
                    offset
                }
            },
        };
        let descriptor = (class << 13 | rest) as u16;
        bytes[descriptor_at..descriptor_at + 2].copy_from_slice(&descriptor.to_le_bytes());
    }
    Some(bytes)
}

/// The class of a block and its bytes; for class 0, the index that goes into the descriptor.
fn body(block: &Block, palette: &Palette) -> (usize, Vec<u8>) {
    let (entries, cells) = match block {
        Block::Own(cells) => return own_body(cells),
        Block::Palette(entries) => (entries, entries.len()),
    };
    let bits = index_bits(cells);
    let base = palette.window(entries).unwrap_or(0);
    if bits == 0 {
        return (0, vec![base as u8]);
    }
    let mut body = vec![0; block_bytes(bits)];
    body[0] = base as u8;
    for &(entry, cells) in entries {
        let index = palette.entries[base..].iter().position(|&known| known == entry).unwrap_or(0);
        for cell in ones(cells) {
            let bit = cell % 8 * bits;
            let at = 1 + cell / 8 * bits + bit / 8;
            let shifted = index << (bit % 8);
            body[at] |= shifted as u8;
            // An index of three bits may straddle two bytes of its row.
            if shifted > 0xff {
                body[at + 1] |= (shifted >> 8) as u8;
            }
        }
    }
    (bits, body)
}

/// Bits of an index into so many entries.
fn index_bits(entries: usize) -> usize {
    entries.max(1).next_power_of_two().trailing_zeros() as usize
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
    entries: Vec<u16>,
}

impl Palette {
    fn of(blocks: &[Block; BLOCKS]) -> Option<Self> {
        let mut wanted: Vec<&Vec<(u16, u64)>> = blocks
            .iter()
            .filter_map(|block| match block {
                Block::Palette(entries) if !entries.is_empty() => Some(entries),
                _ => None,
            })
            .collect();
        // Long windows first: the short ones then often lie within.
        wanted.sort_by_key(|entries| std::cmp::Reverse(entries.len()));
        let mut palette = Self { entries: Vec::new() };
        for entries in wanted {
            if palette.window(entries).is_none() {
                palette.append(entries);
            }
        }
        let own = blocks.iter().any(|block| matches!(block, Block::Own(_)));
        match palette.entries[..] {
            // Nothing matters, or every block has its own cells: any entry will do.
            [] => palette.entries.resize(if own { 2 } else { 1 }, 0),
            // A palette of one entry stands for a whole superblock.
            [only] if own => palette.entries.push(only),
            _ => {}
        }
        (palette.entries.len() <= MAX_PALETTE).then_some(palette)
    }

    /// Where a window begins that holds all these entries.
    fn window(&self, wanted: &[(u16, u64)]) -> Option<usize> {
        let length = 1 << index_bits(wanted.len());
        (0..self.entries.len()).find(|&base| {
            let window = &self.entries[base..self.entries.len().min(base + length)];
            wanted.iter().all(|(entry, _)| window.contains(entry))
        })
    }

    /// Adds a window for entries, using those of them that stand at the end already.
    fn append(&mut self, wanted: &[(u16, u64)]) {
        let is_wanted = |entry: &u16| wanted.iter().any(|(wanted, _)| wanted == entry);
        let mut kept = self.entries.iter().rev().take_while(|entry| is_wanted(entry)).count();
        kept = kept.min(wanted.len());
        let tail: Vec<u16> = self.entries[self.entries.len() - kept..].to_vec();
        self.entries
            .extend(wanted.iter().map(|&(entry, _)| entry).filter(|entry| !tail.contains(entry)));
    }
}

/// The class and bytes of cells that have their own code and cost: the smallest that holds them.
fn own_body(cells: &[Option<(u8, u32)>; BLOCK_CELLS]) -> (usize, Vec<u8>) {
    let mut body = vec![0; CODES_BYTES];
    for (cell, &content) in cells.iter().enumerate() {
        let code = content.map_or(0, |(code, _)| code);
        body[cell / 2] |= code << (cell % 2 * 4);
    }
    let costs = cells.map(|content| content.filter(|&(code, _)| code < 8).map(|(_, cost)| cost));
    let steps = costs.map(|cost| cost.map(|cost| steps(cost).unwrap_or((0, u32::MAX))));
    let known = || steps.iter().flatten().copied();
    let least = known().fold((u32::MAX, u32::MAX), |l, s| (l.0.min(s.0), l.1.min(s.1)));
    let base =
        least.0.wrapping_mul(STRAIGHT_STEP).wrapping_add(least.1.wrapping_mul(DIAGONAL_STEP));
    let widest = known().map(|s| (s.0 - least.0).max(s.1 - least.1)).max().unwrap_or(0);
    let class = match widest {
        _ if least.1 == u32::MAX && known().next().is_some() => OWN_32,
        0..=15 => OWN_4_4,
        16..=255 => OWN_8_8,
        _ => OWN_32,
    };
    if class == OWN_32 {
        body.extend(costs.iter().flat_map(|cost| cost.unwrap_or(0).to_le_bytes()));
        return (class, body);
    }
    body.extend_from_slice(&base.to_le_bytes());
    for step in steps {
        let (straight, diagonal) = step.map_or((0, 0), |s| (s.0 - least.0, s.1 - least.1));
        if class == OWN_4_4 {
            body.push((straight | diagonal << 4) as u8);
        } else {
            body.extend_from_slice(&[straight as u8, diagonal as u8]);
        }
    }
    (class, body)
}

/// Bytes that a block of own cells takes.
pub(crate) fn own_bytes(cells: &[Option<(u8, u32)>; BLOCK_CELLS]) -> usize {
    own_body(cells).1.len()
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
