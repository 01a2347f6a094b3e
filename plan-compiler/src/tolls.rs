//! Tolls: what a step costs more in some cells than in others.
//!
//! Every cell has a factor; a step costs its length times the factor of the cell that it leaves. So
//! the cost of a route does not depend on its goal's own factor. Factors count eighths, from 1 to 32,
//! so costs stay integers and exact. A factor of at least 1 keeps the cost of a route at least its
//! length. A toll makes a free cell dear; it neither blocks nor frees a cell.
//!
//! Source: W, section 5, "cost functions"; cost maps of Nav2.

use plan_format::Cell;
use plan_format::layout::MAX_UNIT;

/// Eighths of the lowest factor.
pub const LEAST: u32 = 8;
/// Eighths of the highest factor.
pub const MOST: u32 = 256;

/// The factor of every cell of a grid.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tolls {
    columns: u32,
    /// Eighths less 1, row by row from the south.
    cells: Vec<u8>,
}

impl Tolls {
    /// Factors in eighths, held between [`LEAST`] and [`MOST`].
    pub fn from_fn(columns: u32, rows: u32, mut eighths: impl FnMut(Cell) -> u32) -> Self {
        let all = (0..rows).flat_map(|row| (0..columns).map(move |column| Cell::new(column, row)));
        let cells = all.map(|cell| (eighths(cell).clamp(LEAST, MOST) - 1) as u8).collect();
        Self { columns, cells }
    }

    /// A factor of 1 in every cell.
    pub fn none(columns: u32, rows: u32) -> Self {
        Self::from_fn(columns, rows, |_| LEAST)
    }

    /// The factor of a cell, eighths; [`LEAST`] off the grid.
    pub fn eighths(&self, cell: Cell) -> u32 {
        let index = cell.row as usize * self.columns as usize + cell.column as usize;
        self.cells.get(index).map_or(LEAST, |&cell| u32::from(cell) + 1)
    }

    /// Whether every factor is 1.
    pub fn is_none(&self) -> bool {
        self.cells.iter().all(|&cell| u32::from(cell) + 1 == LEAST)
    }

    /// Multiplies by the factors of other tolls on the same grid, and cuts products at [`MOST`].
    /// Products are rounded up to eighths. Returns the number of cells that were cut.
    pub fn multiply(&mut self, other: &Self) -> usize {
        let mut cut = 0;
        for (cell, &other) in self.cells.iter_mut().zip(&other.cells) {
            let product = ((u32::from(*cell) + 1) * (u32::from(other) + 1)).div_ceil(LEAST);
            cut += usize::from(product > MOST);
            *cell = (product.min(MOST) - 1) as u8;
        }
        cut
    }

    /// The coarsest unit in which all step costs are integers: they count 1/2^unit of 1/5741 cell.
    pub fn unit(&self) -> u8 {
        let bits = self.cells.iter().fold(LEAST, |bits, &cell| bits | (u32::from(cell) + 1));
        MAX_UNIT - bits.trailing_zeros() as u8
    }

    /// What a step out of each cell is multiplied by in a [unit](Self::unit), row by row.
    pub(crate) fn multipliers(&self, unit: u8) -> impl Iterator<Item = u16> {
        let shift = MAX_UNIT - unit;
        self.cells.iter().map(move |&cell| (u16::from(cell) + 1) >> shift)
    }
}

/// A factor in eighths, from one that a person wrote; `None` if it is not a multiple of 1/8 from 1 to
/// 32.
pub fn eighths(factor: f64) -> Option<u32> {
    let eighths = factor * f64::from(LEAST);
    let is_one = eighths.fract() == 0.0 && (f64::from(LEAST)..=f64::from(MOST)).contains(&eighths);
    is_one.then_some(eighths as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tolls(eighths: [u32; 4]) -> Tolls {
        Tolls::from_fn(4, 1, |cell| eighths[cell.column as usize])
    }

    #[test]
    fn factors_multiply_up_to_the_highest() {
        let mut some = tolls([8, 9, 128, 256]);
        assert_eq!(some.multiply(&tolls([8, 9, 24, 16])), 2);
        assert_eq!(
            [0, 1, 2, 3].map(|column| some.eighths(Cell::new(column, 0))),
            [8, 11, 256, 256]
        );
    }

    #[test]
    fn the_unit_is_as_coarse_as_the_factors_allow() {
        let unit = |factor| tolls([8, 16, factor, 256]).unit();
        assert_eq!([8, 20, 18, 9].map(unit), [0, 1, 2, 3]);
        let halves = tolls([8, 12, 16, 256]);
        assert_eq!(halves.multipliers(halves.unit()).collect::<Vec<_>>(), [2, 3, 4, 64]);
    }

    #[test]
    fn only_eighths_from_1_to_32_are_factors() {
        assert_eq!([1.0, 1.125, 32.0].map(eighths), [Some(8), Some(9), Some(256)]);
        assert_eq!([0.5, 1.1, 32.125, f64::NAN].map(eighths), [None; 4]);
    }
}
