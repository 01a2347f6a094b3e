//! From a field to the superblocks of a layer.
//!
//! The work grows with the number of cells alone: optimal moves by row, roots in the order of
//! buckets, blocks one after the other. What is stored obeys the advice rule by construction,
//! because a cell refers to a root only if the reader's own arithmetic then gives its cost and one
//! of its allowed moves; cells of a field that contradicts itself are stored as they are.

mod blocks;
mod cover;
mod moves;
mod roots;

use crate::blocks::{BLOCKS, superblocks};
use crate::directory::Counts;
use crate::field::{Field, NO_ROUTE, escape, is_blocked};
use crate::layer::{ESCAPE, FREE, NO_ESCAPE, NO_ROUTE_ENTRY, ROUTE_BYTES, Root, TERRAIN_BYTES};
use blocks::{Block, Entries};
use cover::Covering;

const TERRAIN: Entries = Entries { bytes: TERRAIN_BYTES, filler: FREE };
const ROUTES: Entries = Entries { bytes: ROUTE_BYTES, filler: NO_ROUTE_ENTRY };

/// A field as the blob stores it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedLayer {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    pub(crate) terrain: PackedPlane,
    pub(crate) routes: PackedPlane,
    pub(crate) roots: Vec<u8>,
    pub(crate) counts: Counts,
}

impl PackedLayer {
    /// How many cells are of each kind.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Bytes that it takes in a blob at most: what layers have alike is stored once.
    pub fn bytes(&self) -> usize {
        self.terrain.bytes.len() + self.routes.bytes.len() + self.roots.len()
    }
}

/// The superblocks of a plane, each by itself, in the order of the grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PackedPlane {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl PackedPlane {
    /// The bytes of each superblock.
    pub(crate) fn superblocks(&self) -> impl Iterator<Item = &[u8]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.bytes[start..end])
    }
}

/// Packs a field. Cells that its arrays lack are free without a route.
pub fn pack(field: &Field) -> PackedLayer {
    let block_columns = superblocks(field.columns) as usize * 4;
    let block_rows = superblocks(field.rows) as usize * 4;
    let bordered = moves::Bordered::new(field);
    let roots = roots::Roots::new(field, &bordered);
    let covering =
        Covering { field, bordered: &bordered, roots: &roots, block_columns, block_rows };
    let routes = covering.choose();
    PackedLayer {
        columns: field.columns,
        rows: field.rows,
        terrain: plane(&terrain(field, block_columns, block_rows), block_columns, TERRAIN, |_| {
            [None; 64]
        }),
        routes: plane(&routes.blocks, block_columns, ROUTES, |block| covering.own(block)),
        roots: routes.roots.iter().flat_map(root_bytes).collect(),
        counts: counts(field),
    }
}

fn root_bytes(root: &Root) -> [u8; 8] {
    let [x0, x1] = (root.cell.column as u16).to_le_bytes();
    let [y0, y1] = (root.cell.row as u16).to_le_bytes();
    let [c0, c1, c2, c3] = root.cost.to_le_bytes();
    [x0, x1, y0, y1, c0, c1, c2, c3]
}

fn counts(field: &Field) -> Counts {
    let mut counts = Counts::default();
    for &code in &field.code {
        match code {
            NO_ROUTE => counts.unreachable += 1,
            code if is_blocked(code) => counts.blocked += 1,
            _ => counts.free += 1,
        }
    }
    let all = u64::from(field.columns) * u64::from(field.rows);
    counts.unreachable += all.saturating_sub(field.code.len() as u64) as u32;
    counts
}

/// What is in the way, block by block.
fn terrain(field: &Field, block_columns: usize, block_rows: usize) -> Vec<Block> {
    let columns = field.columns as usize;
    let mut masks = vec![[0u64; ESCAPE as usize + 8]; block_columns * block_rows];
    if columns > 0 {
        for (row, codes) in field.code.chunks(columns).take(field.rows as usize).enumerate() {
            for (column, &code) in codes.iter().enumerate() {
                let terrain = match escape(code) {
                    Some(direction) => ESCAPE + u16::from(direction.code()),
                    None if is_blocked(code) => NO_ESCAPE,
                    None => FREE,
                };
                let block = row / 8 * block_columns + column / 8;
                masks[block][terrain as usize] |= 1 << (row % 8 * 8 + column % 8);
            }
        }
    }
    let entries = |masks: &[u64; ESCAPE as usize + 8]| {
        let used = masks.iter().enumerate().filter(|&(_, &cells)| cells != 0);
        Block::Palette(used.map(|(terrain, &cells)| (terrain as u16, cells)).collect())
    };
    masks.iter().map(entries).collect()
}

/// The superblocks of blocks that stand in the order of their grid.
fn plane(
    blocks: &[Block],
    block_columns: usize,
    entries: Entries,
    own: impl Fn(usize) -> [Option<(u8, u32)>; 64],
) -> PackedPlane {
    let mut packed = PackedPlane { bytes: Vec::new(), ends: Vec::new() };
    let block_rows = blocks.len().checked_div(block_columns).unwrap_or(0);
    for row in (0..block_rows).step_by(4) {
        for column in (0..block_columns).step_by(4) {
            let index = |block: usize| (row + block / 4) * block_columns + column + block % 4;
            let sixteen: [Block; BLOCKS] = std::array::from_fn(|at| blocks[index(at)].clone());
            let bytes = blocks::superblock(&sixteen, entries).or_else(|| {
                let own = |at| Block::Own(Box::new(own(index(at))));
                blocks::superblock(&std::array::from_fn(own), entries)
            });
            packed.bytes.extend_from_slice(&bytes.unwrap_or_default());
            packed.ends.push(packed.bytes.len());
        }
    }
    packed
}
