//! From a field to the superblocks of a layer.
//!
//! The time depends only on the number of cells: moves are found row by row, roots bucket by
//! bucket, and blocks one after the other. The stored advice is correct by construction, because a
//! cell refers to a root only if the reader's own arithmetic then gives its cost and one of its
//! allowed moves. Cells of a field that contradicts itself are stored with their own code and cost.

mod codes;
mod corrections;
mod cover;
mod encode;
mod goals;
mod moves;
mod parts;
mod roots;
mod serve;
mod tolled;

use crate::field::{Field, NO_ROUTE, is_blocked};
use crate::layers::Limits;
use cover::Covering;
use encode::{Block, superblock};
pub use goals::{Numbered, with_goals};
use plan_format::layout::{
    BLOCK_CELLS, BLOCKS, CORRECTION_BITS, Correction, LIMIT_BITS, MULTIPLIERS, NO_LIMIT,
    NO_ROUTE_ENTRY, OWN_4_4, ROUTE_BITS, TERRAIN_BITS, Terrain, superblocks,
};
use plan_format::{Cell, Counts, PackedLayer, PackedPlane, PackedTolls, Superblock};

/// Packs a field. Cells missing from its arrays count as free without a route.
pub fn pack(field: &Field) -> PackedLayer {
    pulp::Arch::new().dispatch(Pack(field))
}

/// As [`pack`], with the speed limits of the layer.
pub fn pack_with_limits(field: &Field, limits: &Limits) -> PackedLayer {
    let mut packed = pack(field);
    if limits.is_none() {
        return packed;
    }
    let everywhere = || PackedPlane {
        superblocks: vec![Superblock::Uniform(0); blocks_of([field.columns, field.rows]) / BLOCKS],
    };
    // Roots without tolls are roots with multiplier 1.
    let mut tolls = packed.tolls.take().unwrap_or_else(|| PackedTolls {
        unit: 0,
        corrections: everywhere(),
        values: vec![Correction::NONE.word()],
        limits: None,
        multipliers: [0; MULTIPLIERS],
    });
    tolls.limits = Some(limits_plane(field, limits));
    packed.tolls = Some(tolls);
    packed
}

/// Blocks of a layer, in row-major order; their number is that of a whole number of superblocks.
fn blocks_of([columns, rows]: [u32; 2]) -> usize {
    superblocks(columns) as usize * superblocks(rows) as usize * BLOCKS
}

fn limits_plane(field: &Field, limits: &Limits) -> PackedPlane {
    let block_columns = superblocks(field.columns) as usize * 4;
    let block = |index: usize| {
        let (column, row) = (index % block_columns, index / block_columns);
        let mut entries: Vec<(u32, u64)> = Vec::new();
        for at in 0..BLOCK_CELLS {
            let cell = Cell::new((8 * column + at % 8) as u32, (8 * row + at / 8) as u32);
            if cell.column >= field.columns || cell.row >= field.rows {
                continue;
            }
            let limit = limits.at(cell).map_or(NO_LIMIT, u32::from);
            match entries.iter_mut().find(|entry| entry.0 == limit) {
                Some(entry) => entry.1 |= 1 << at,
                None => entries.push((limit, 1 << at)),
            }
        }
        Block::Palette(entries)
    };
    let blocks: Vec<Block> = (0..blocks_of([field.columns, field.rows])).map(block).collect();
    plane(&blocks, block_columns, LIMIT_BITS, NO_LIMIT, |_, _| OWN_4_4)
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
    if let Some(unit) = field.unit {
        return packed_with_tolls(field, &bordered, unit);
    }
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
        tolls: None,
        goals: None,
        counts: counts(field),
    }
}

/// As [`packed`], for a field with tolls.
fn packed_with_tolls(field: &Field, bordered: &moves::Bordered, unit: u8) -> PackedLayer {
    let block_columns = superblocks(field.columns) as usize * 4;
    let block_rows = superblocks(field.rows) as usize * 4;
    let codes = codes::by_block(field, block_columns, block_rows);
    let sites = tolled::Sites::new(field, bordered);
    let search = corrections::Search { codes: &codes, bordered, sites: &sites, block_columns };
    let found = search.choose();
    let terrain: Vec<Block> = codes.iter().map(|codes| Block::Palette(codes.terrain())).collect();
    let none = |_, _: &mut Vec<u32>| OWN_4_4;
    let own = |block, words: &mut Vec<u32>| {
        let corner =
            Cell::new(8 * (block % block_columns) as u32, 8 * (block / block_columns) as u32);
        cover::own_cells(bordered, &codes[block], corner).write(words)
    };
    let mut multipliers = [0; MULTIPLIERS];
    for (stored, multiplier) in multipliers.iter_mut().zip(&sites.multipliers) {
        *stored = (multiplier - 1) as u8;
    }
    PackedLayer {
        columns: field.columns,
        rows: field.rows,
        terrain: plane(&terrain, block_columns, TERRAIN_BITS, Terrain::Free.entry(), none),
        routes: plane(&found.routes, block_columns, ROUTE_BITS, NO_ROUTE_ENTRY, own),
        roots: found.roots,
        tolls: Some(PackedTolls {
            unit,
            corrections: plane(&found.corrections, block_columns, CORRECTION_BITS, 0, none),
            values: found.values,
            limits: None,
            multipliers,
        }),
        goals: None,
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
