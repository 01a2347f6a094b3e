//! From a field to the superblocks of a layer.
//!
//! The time depends only on the number of cells: moves are found row by row, roots bucket by
//! bucket, and blocks one after the other. The stored advice is correct by construction, because a
//! cell refers to a root only if the reader's own arithmetic then gives its cost and one of its
//! allowed moves. Cells of a field that contradicts itself are stored with their own code and cost.

mod codes;
mod cover;
mod encode;
mod moves;
mod parts;
mod roots;
mod serve;

use crate::field::{Field, NO_ROUTE, is_blocked};
use cover::Covering;
use encode::{Block, superblock};
use plan_format::layout::{
    BLOCKS, NO_ROUTE_ENTRY, OWN_4_4, ROUTE_BITS, TERRAIN_BITS, Terrain, superblocks,
};
use plan_format::{Counts, PackedLayer, PackedPlane};

/// Packs a field. Cells missing from its arrays count as free without a route.
pub fn pack(field: &Field) -> PackedLayer {
    pulp::Arch::new().dispatch(Pack(field))
}

/// The packing itself, compiled once for each kind of vector unit. Its hot functions are inlined,
/// so they are compiled for that unit too.
struct Pack<'f>(&'f Field);

impl pulp::WithSimd for Pack<'_> {
    type Output = PackedLayer;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> PackedLayer {
        packed(self.0)
    }
}

#[inline(always)]
fn packed(field: &Field) -> PackedLayer {
    let block_columns = superblocks(field.columns) as usize * 4;
    let block_rows = superblocks(field.rows) as usize * 4;
    let bordered = moves::Bordered::new(field);
    let roots = roots::Roots::new(field, &bordered);
    let codes = codes::by_block(field, block_columns, block_rows);
    let covering = Covering { codes: &codes, bordered: &bordered, roots: &roots, block_columns };
    let routes = covering.choose();
    let terrain: Vec<Block> = codes.iter().map(|codes| Block::Palette(codes.terrain())).collect();
    let none = |_, _: &mut Vec<u32>| OWN_4_4;
    let own = |block, words: &mut Vec<u32>| covering.own(block, words);
    PackedLayer {
        columns: field.columns,
        rows: field.rows,
        terrain: plane(&terrain, block_columns, TERRAIN_BITS, Terrain::Free.entry(), none),
        routes: plane(&routes.blocks, block_columns, ROUTE_BITS, NO_ROUTE_ENTRY, own),
        roots: routes.roots.iter().flat_map(|root| root.words()).collect(),
        counts: counts(field),
    }
}

#[inline(always)]
fn counts(field: &Field) -> Counts {
    let (mut blocked, mut unreachable) = (0, 0);
    for &code in &field.code {
        blocked += u32::from(is_blocked(code));
        unreachable += u32::from(code == NO_ROUTE);
    }
    let free = field.code.len() as u32 - blocked - unreachable;
    let all = u64::from(field.columns) * u64::from(field.rows);
    unreachable += all.saturating_sub(field.code.len() as u64) as u32;
    Counts { free, blocked, unreachable }
}

/// The superblocks of blocks in row-major order.
#[inline(always)]
fn plane(
    blocks: &[Block],
    block_columns: usize,
    entry_bits: u32,
    filler: u32,
    own: impl Fn(usize, &mut Vec<u32>) -> u32,
) -> PackedPlane {
    let block_rows = blocks.len().checked_div(block_columns).unwrap_or(0);
    let mut superblocks = Vec::with_capacity(blocks.len() / BLOCKS);
    for row in (0..block_rows).step_by(4) {
        for column in (0..block_columns).step_by(4) {
            let index = |at: usize| (row + at / 4) * block_columns + column + at % 4;
            let sixteen: [&Block; BLOCKS] = std::array::from_fn(|at| &blocks[index(at)]);
            superblocks
                .push(superblock(&sixteen, entry_bits, filler, |at, words| own(index(at), words)));
        }
    }
    PackedPlane { superblocks }
}
