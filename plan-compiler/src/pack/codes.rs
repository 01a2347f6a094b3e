//! The codes of a field, block by block.

use super::serve::gather;
use crate::field::{ESCAPE, Field, NO_ESCAPE, NO_ROUTE};
use plan_format::Direction;
use plan_format::layout::{BLOCK_CELLS, TERRAIN_BITS, Terrain};

/// The codes of a block's cells.
#[derive(Clone)]
pub(crate) struct Codes(pub(crate) [u8; BLOCK_CELLS]);

// Entries of plane `terrain`, as bytes like the codes.
const TERRAIN_FREE: u8 = Terrain::Free.entry() as u8;
const TERRAIN_NO_ESCAPE: u8 = Terrain::NoEscape.entry() as u8;
const TERRAIN_ESCAPE: u8 = Terrain::Escape(Direction::from_code(0)).entry() as u8;

/// The code of a cell that is not on the map.
const OFF_MAP: u8 = u8::MAX;

/// The codes of a field's blocks in row-major order, including blocks beyond the map. Cells missing
/// from the field's array count as free without a route.
#[inline(always)]
pub(crate) fn by_block(field: &Field, block_columns: usize, block_rows: usize) -> Vec<Codes> {
    let columns = field.columns as usize;
    let mut blocks = vec![Codes([OFF_MAP; BLOCK_CELLS]); block_columns * block_rows];
    for row in 0..field.rows as usize {
        let given = field.code.get(row * columns..).unwrap_or_default();
        let given = &given[..given.len().min(columns)];
        let blocks = &mut blocks[row / 8 * block_columns..][..block_columns];
        for (block, first) in blocks.iter_mut().zip((0..columns).step_by(8)) {
            let cells = &mut block.0[row % 8 * 8..][..8];
            let given = given.get(first..).unwrap_or_default();
            match given.first_chunk::<8>() {
                Some(given) => cells.copy_from_slice(given),
                None => {
                    cells[..8.min(columns - first)].fill(NO_ROUTE);
                    cells[..given.len()].copy_from_slice(given);
                }
            }
        }
    }
    blocks
}

impl Codes {
    #[inline(always)]
    fn mask(&self, is: impl Fn(u8) -> bool) -> u64 {
        let mut bits = [0; BLOCK_CELLS];
        for (bit, &code) in bits.iter_mut().zip(&self.0) {
            *bit = u8::from(is(code));
        }
        let bytes = bits.as_chunks::<8>().0.iter();
        let mut rows = bytes.map(|&row| gather(u64::from_le_bytes(row)) as u8);
        u64::from_le_bytes(std::array::from_fn(|_| rows.next().unwrap_or(0)))
    }

    /// The cells with this code.
    #[inline(always)]
    pub(crate) fn equal_to(&self, code: u8) -> u64 {
        self.mask(|other| other == code)
    }

    /// The cells with a code up to this.
    #[inline(always)]
    pub(crate) fn up_to(&self, code: u8) -> u64 {
        self.mask(|other| other <= code)
    }

    /// The terrain entries of a block, lowest first, each with its cells; cells off the map are
    /// left out.
    #[inline(always)]
    pub(crate) fn terrain(&self) -> Vec<(u32, u64)> {
        let terrain = Self(self.0.map(|code| match code {
            OFF_MAP => OFF_MAP,
            ESCAPE.. => TERRAIN_ESCAPE + (code - ESCAPE) % 8,
            NO_ESCAPE.. => TERRAIN_NO_ESCAPE,
            _ => TERRAIN_FREE,
        }));
        let mut left = !terrain.equal_to(OFF_MAP);
        let mut all = Vec::with_capacity(1 << TERRAIN_BITS);
        while left != 0 {
            let kind = terrain.0[left.trailing_zeros() as usize];
            let cells = terrain.equal_to(kind);
            left &= !cells;
            all.push((u32::from(kind), cells));
        }
        all.sort_unstable();
        all
    }
}
