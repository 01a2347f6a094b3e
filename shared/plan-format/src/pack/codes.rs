//! The codes of a field, block by block.

use crate::blocks::BLOCK_CELLS;
use crate::field::{Field, NO_ROUTE};
use crate::grid::Cell;

/// The codes of a block's cells.
pub(crate) struct Codes(pub(crate) [u8; BLOCK_CELLS]);

/// The code of a cell that is not on the map.
const OFF_MAP: u8 = u8::MAX;

/// The codes of the block whose south-west cell this is. Cells that the field's array lacks are
/// free without a route.
pub(crate) fn codes_of(field: &Field, corner: Cell) -> Codes {
    let mut codes = [OFF_MAP; BLOCK_CELLS];
    let columns = (field.columns.saturating_sub(corner.column) as usize).min(8);
    let rows = (field.rows.saturating_sub(corner.row) as usize).min(8);
    for (row, cells) in codes.chunks_mut(8).take(rows).enumerate() {
        let start = (corner.row as usize + row) * field.columns as usize + corner.column as usize;
        let given = field.code.get(start..).unwrap_or_default();
        let cells = &mut cells[..columns];
        cells.fill(NO_ROUTE);
        let given = &given[..given.len().min(columns)];
        cells[..given.len()].copy_from_slice(given);
    }
    Codes(codes)
}

impl Codes {
    fn mask(&self, is: impl Fn(u8) -> bool) -> u64 {
        let mut bits = [0; BLOCK_CELLS];
        for (bit, &code) in bits.iter_mut().zip(&self.0) {
            *bit = u8::from(is(code));
        }
        let bytes = bits.as_chunks::<8>().0.iter();
        let gather = |&row: &[u8; 8]| {
            (u64::from_le_bytes(row).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
        };
        let mut rows = bytes.map(gather);
        u64::from_le_bytes(std::array::from_fn(|_| rows.next().unwrap_or(0)))
    }

    /// The cells with this code.
    pub(crate) fn equal_to(&self, code: u8) -> u64 {
        self.mask(|other| other == code)
    }

    /// The cells with a code up to this.
    pub(crate) fn up_to(&self, code: u8) -> u64 {
        self.mask(|other| other <= code)
    }

    /// Every code with its cells, lowest first, but for cells that are not on the map.
    pub(crate) fn all(&self) -> Vec<(u8, u64)> {
        let mut left = !self.equal_to(OFF_MAP);
        let mut all = Vec::new();
        while left != 0 {
            let code = self.0[left.trailing_zeros() as usize];
            let cells = self.equal_to(code);
            left &= !cells;
            all.push((code, cells));
        }
        all.sort_unstable();
        all
    }
}
