//! Blocks and superblocks: from what each cell needs to bytes.

use crate::blocks::{
    BLOCK_CELLS, BLOCKS, MAX_INDEX_BITS, NARROW_BITS, OWN_4_4, OWN_8_8, OWN_32, WIDE, WIDE_BITS,
    index_bytes, palette_at,
};
use crate::field::MOVES;
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
/// Most entries of a superblock's palette.
const MAX_PALETTE: usize = (!WIDE) as usize;

/// How a plane stores its entries.
#[derive(Clone, Copy)]
pub(crate) struct Entries {
    /// Bytes of an entry, 1 or 2.
    pub(crate) bytes: usize,
    /// The entry where none matters.
    pub(crate) filler: u16,
}

/// The bytes of a superblock; `None` if its palette would be too long.
pub(crate) fn superblock(blocks: &[Block; BLOCKS], plane: Entries) -> Option<Vec<u8>> {
    let palette = Palette::of(blocks, plane.filler)?;
    let entries: Vec<u8> = palette
        .entries
        .iter()
        .flat_map(|entry| entry.to_le_bytes().into_iter().take(plane.bytes))
        .collect();
    if palette.entries.len() == 1 {
        return Some([&[1], &entries[..]].concat());
    }
    let wide = wide(blocks, &palette, &entries);
    Some(match narrow(blocks, &palette, &entries) {
        Some(narrow) if narrow.len() <= wide.len() => narrow,
        _ => wide,
    })
}

/// One byte for each block's class and window, then the indices in the order of the blocks.
fn narrow(blocks: &[Block; BLOCKS], palette: &Palette, entries: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = vec![palette.entries.len() as u8];
    let mut data = Vec::new();
    for block in blocks {
        let Block::Palette(wanted) = block else { return None };
        let base = palette.window(wanted).unwrap_or(0);
        let indices = indices(wanted, &palette.entries[base..]);
        let class = indices.len() / index_bytes(1);
        if base >> NARROW_BITS > 0 {
            return None;
        }
        bytes.push((class << NARROW_BITS | base) as u8);
        data.extend(indices);
    }
    bytes.extend_from_slice(entries);
    bytes.extend(data);
    Some(bytes)
}

/// Two bytes for each block's class and place; equal blocks are stored once.
fn wide(blocks: &[Block; BLOCKS], palette: &Palette, entries: &[u8]) -> Vec<u8> {
    let mut bytes = vec![palette.entries.len() as u8 | WIDE];
    bytes.resize(palette_at(true), 0);
    bytes.extend_from_slice(entries);
    let mut written: Vec<(usize, Vec<u8>)> = Vec::new();
    for (block, descriptor_at) in blocks.iter().zip((1..).step_by(2)) {
        let (class, body) = match block {
            Block::Own(cells) => own_body(cells),
            Block::Palette(wanted) => {
                let base = palette.window(wanted).unwrap_or(0);
                let indices = indices(wanted, &palette.entries[base..]);
                (indices.len() / index_bytes(1), [&[base as u8], &indices[..]].concat())
            }
        };
        let rest = if class == 0 {
            usize::from(body[0])
        } else if let Some(&(offset, _)) = written.iter().find(|(_, known)| *known == body) {
            offset
        } else {
            let offset = bytes.len();
            bytes.extend_from_slice(&body);
            written.push((offset, body));
            offset
        };
        let descriptor = (class << WIDE_BITS | rest) as u16;
        bytes[descriptor_at..descriptor_at + 2].copy_from_slice(&descriptor.to_le_bytes());
    }
    bytes
}

/// Each cell's index into a window of the palette, 0 where it does not matter.
fn indices(wanted: &[(u16, u64)], window: &[u16]) -> Vec<u8> {
    let bits = index_bits(wanted.len());
    let mut rows = vec![0; index_bytes(bits)];
    for &(entry, cells) in wanted {
        let index = window.iter().position(|&known| known == entry).unwrap_or(0);
        for cell in ones(cells) {
            let bit = cell % 8 * bits;
            let at = cell / 8 * bits + bit / 8;
            let shifted = index << (bit % 8);
            if shifted > 0 {
                rows[at] |= shifted as u8;
            }
            // An index of three bits may straddle two bytes of its row.
            if shifted > 0xff {
                rows[at + 1] |= (shifted >> 8) as u8;
            }
        }
    }
    rows
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
    fn of(blocks: &[Block; BLOCKS], filler: u16) -> Option<Self> {
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
            // Nothing matters, or every block has its own cells.
            [] => palette.entries.resize(if own { 2 } else { 1 }, filler),
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
    let mask = cells.iter().rev().fold(0u64, |mask, cell| mask << 1 | u64::from(cell.is_some()));
    let mut body = mask.to_le_bytes().to_vec();
    let cells: Vec<(u8, u32)> = cells.iter().flatten().copied().collect();
    body.push(cells.len() as u8);
    body.extend(cells.chunks(2).map(|pair| pair[0].0 | pair.get(1).map_or(0, |cell| cell.0 << 4)));
    // Only moves have a cost; the others are given one that costs nothing to store.
    let moves = cells.iter().filter(|&&(code, _)| code < MOVES);
    let steps: Option<Vec<(u32, u32)>> = moves.map(|&(_, cost)| steps(cost)).collect();
    let least = |steps: &[(u32, u32)]| {
        let straight = steps.iter().map(|step| step.0).min().unwrap_or(0);
        (straight, steps.iter().map(|step| step.1).min().unwrap_or(0))
    };
    let widest = |steps: &[(u32, u32)]| {
        let (straight, diagonal) = least(steps);
        steps.iter().map(|step| (step.0 - straight).max(step.1 - diagonal)).max().unwrap_or(0)
    };
    let Some(steps) = steps.filter(|steps| widest(steps) <= 0xff) else {
        body.extend(cells.iter().flat_map(|(_, cost)| cost.to_le_bytes()));
        return (OWN_32, body);
    };
    let class = if widest(&steps) <= 0xf { OWN_4_4 } else { OWN_8_8 };
    let (straight, diagonal) = least(&steps);
    body.extend_from_slice(&(straight * STRAIGHT_STEP + diagonal * DIAGONAL_STEP).to_le_bytes());
    let mut steps = steps.into_iter();
    for (code, _) in cells {
        let step = if code < MOVES { steps.next() } else { None };
        let (straight, diagonal) = step.map_or((0, 0), |s| (s.0 - straight, s.1 - diagonal));
        if class == OWN_4_4 {
            body.push((straight | diagonal << 4) as u8);
        } else {
            body.extend_from_slice(&[straight as u8, diagonal as u8]);
        }
    }
    (class, body)
}

/// Bytes that a block of own cells takes.
pub(crate) fn own_length(cells: &[Option<(u8, u32)>; BLOCK_CELLS]) -> usize {
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
