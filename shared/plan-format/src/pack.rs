//! From a field to the bytes of a layer.

use crate::directory::Counts;
use crate::field::{Field, GOAL, NO_ROUTE, is_blocked};
use crate::layer::CELL_BYTES;

/// A field as the blob stores it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackedLayer {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    pub(crate) cells: Vec<u8>,
    pub(crate) counts: Counts,
}

impl PackedLayer {
    /// How many cells are of each kind.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Bytes that it takes in a blob, unless it shares them with an equal layer.
    pub fn bytes(&self) -> usize {
        self.cells.len()
    }
}

/// Packs a field. The field is taken to obey its own description; the reader, which
/// [`crate::write()`] runs on its result, refuses one that does not.
pub fn pack(field: &Field) -> PackedLayer {
    let mut cells = Vec::with_capacity(field.code.len() * CELL_BYTES);
    let mut counts = Counts::default();
    for (&code, &cost) in field.code.iter().zip(&field.cost) {
        match code {
            0..=GOAL => counts.free += 1,
            NO_ROUTE => counts.unreachable += 1,
            code if is_blocked(code) => counts.blocked += 1,
            _ => {}
        }
        cells.push(code);
        cells.extend_from_slice(&cost.to_le_bytes());
    }
    PackedLayer { columns: field.columns, rows: field.rows, cells, counts }
}
