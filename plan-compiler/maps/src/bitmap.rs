//! A set of a grid's cells, one bit each.
//!
//! Each row starts on a new word, so a row is filled, compared and read 64 cells at a time. Bits
//! beyond the last column are always zero.

use math::Cell;

/// A set of cells; row 0 is in the south, the lowest bit of a word in the west.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Bitmap {
    columns: u32,
    rows: u32,
    words_per_row: usize,
    words: Vec<u64>,
}

impl Bitmap {
    /// The empty set.
    pub fn new(columns: u32, rows: u32) -> Self {
        let words_per_row = columns.div_ceil(64) as usize;
        Self { columns, rows, words_per_row, words: vec![0; words_per_row * rows as usize] }
    }

    /// The set of the cells for which `holds` is true.
    pub fn from_fn(columns: u32, rows: u32, mut holds: impl FnMut(Cell) -> bool) -> Self {
        let mut bitmap = Self::new(columns, rows);
        for row in 0..rows {
            for column in 0..columns {
                let cell = Cell::new(column, row);
                if holds(cell) {
                    bitmap.set(cell, true);
                }
            }
        }
        bitmap
    }

    /// Cells from west to east.
    #[inline]
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Cells from south to north.
    #[inline]
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Whether the set holds a cell; false off the grid.
    #[inline]
    pub fn get(&self, cell: Cell) -> bool {
        self.place(cell).is_some_and(|(word, bit)| self.words[word] & bit != 0)
    }

    /// Adds or removes a cell; ignores cells off the grid.
    #[inline]
    pub fn set(&mut self, cell: Cell, value: bool) {
        if let Some((word, bit)) = self.place(cell) {
            if value {
                self.words[word] |= bit;
            } else {
                self.words[word] &= !bit;
            }
        }
    }

    /// Adds the cells of one row from column `from` up to, not including, `to`.
    pub fn fill(&mut self, row: u32, from: u32, to: u32) {
        if row < self.rows {
            let to = to.min(self.columns);
            each_word(from, to, |word, mask| {
                self.words[row as usize * self.words_per_row + word] |= mask;
            });
        }
    }

    /// The words of one row, 64 cells each; empty off the grid.
    #[inline]
    pub fn row(&self, row: u32) -> &[u64] {
        let start = row as usize * self.words_per_row;
        self.words.get(start..start + self.words_per_row).unwrap_or_default()
    }

    /// The words of one row, mutable; bits beyond the last column must stay zero.
    #[inline]
    pub fn row_mut(&mut self, row: u32) -> &mut [u64] {
        let start = row as usize * self.words_per_row;
        self.words.get_mut(start..start + self.words_per_row).unwrap_or_default()
    }

    /// The cells of the set, by rows from the south, each from the west.
    pub fn iter(&self) -> impl Iterator<Item = Cell> + '_ {
        (0..self.rows).flat_map(move |row| {
            self.row(row).iter().zip((0..).step_by(64)).flat_map(move |(&word, first)| {
                // Each step drops the lowest set bit.
                std::iter::successors((word != 0).then_some(word), |&left| {
                    let left = left & (left - 1);
                    (left != 0).then_some(left)
                })
                .map(move |left| Cell::new(first + left.trailing_zeros(), row))
            })
        })
    }

    /// Number of cells in the set.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Adds the cells of `other`, a set on a grid of the same size.
    pub fn add_all(&mut self, other: &Self) {
        debug_assert_eq!((self.columns, self.rows), (other.columns, other.rows));
        for (ours, theirs) in self.words.iter_mut().zip(&other.words) {
            *ours |= theirs;
        }
    }

    /// The runs of neighbouring cells of one row that are in the set, from the west.
    pub fn runs(&self, row: u32) -> impl Iterator<Item = std::ops::Range<u32>> + '_ {
        let words = self.row(row);
        let columns = self.columns;
        // First column at or after `from` whose membership is `wanted`.
        let next = move |from: u32, wanted: bool| {
            let mut index = from / 64;
            let mut mask = u64::MAX << (from % 64);
            while let Some(&word) = words.get(index as usize) {
                let found = if wanted { word & mask } else { !word & mask };
                if found != 0 {
                    return (index * 64 + found.trailing_zeros()).min(columns);
                }
                (index, mask) = (index + 1, u64::MAX);
            }
            columns
        };
        let mut at = 0;
        std::iter::from_fn(move || {
            let start = next(at, true);
            at = next(start, false);
            (start < at).then_some(start..at)
        })
    }

    /// Whether every cell of `other`, a set on a grid of the same size, is in this set.
    pub fn contains_all(&self, other: &Self) -> bool {
        self.columns == other.columns
            && self.rows == other.rows
            && self.words.iter().zip(&other.words).all(|(ours, theirs)| theirs & !ours == 0)
    }

    fn place(&self, cell: Cell) -> Option<(usize, u64)> {
        let inside = cell.column < self.columns && cell.row < self.rows;
        inside.then(|| {
            let word = cell.row as usize * self.words_per_row + cell.column as usize / 64;
            (word, 1 << (cell.column % 64))
        })
    }
}

/// Calls `act` with the index and the mask of every word that holds columns `from..to`.
pub(crate) fn each_word(from: u32, to: u32, mut act: impl FnMut(usize, u64)) {
    let mut from = from;
    while from < to {
        let word = from / 64;
        let end = to.min((word + 1) * 64);
        let ones = u64::MAX >> (64 - (end - from));
        act(word as usize, ones << (from % 64));
        from = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_cross_words() {
        let mut bitmap = Bitmap::new(200, 3);
        bitmap.fill(1, 60, 140);
        bitmap.fill(1, 190, 300);
        bitmap.fill(7, 0, 10);
        bitmap.fill(2, 5, 5);
        let cells: Vec<Cell> = bitmap.iter().collect();
        let expected: Vec<Cell> =
            (60..140).chain(190..200).map(|column| Cell::new(column, 1)).collect();
        assert_eq!(cells, expected);
        assert_eq!(bitmap.count(), 90);
        assert!(bitmap.get(Cell::new(64, 1)) && !bitmap.get(Cell::new(200, 1)));
        bitmap.set(Cell::new(64, 1), false);
        bitmap.set(Cell::new(0, 3), true);
        assert_eq!(bitmap.count(), 89);
    }

    #[test]
    fn runs_are_the_cells_of_a_row() {
        for columns in [1, 63, 64, 65, 128, 200] {
            for step in [1, 2, 3, 7, 61, 64, 65] {
                let bitmap = Bitmap::from_fn(columns, 2, |cell| {
                    cell.row == 1 && (cell.column / step) % 2 == 0
                });
                let runs: Vec<_> = bitmap.runs(1).collect();
                assert!(runs.windows(2).all(|pair| pair[0].end < pair[1].start), "{runs:?}");
                let cells: Vec<Cell> =
                    runs.into_iter().flatten().map(|column| Cell::new(column, 1)).collect();
                assert_eq!(cells, bitmap.iter().collect::<Vec<_>>(), "{columns} {step}");
                assert_eq!((bitmap.runs(0).count(), bitmap.runs(2).count()), (0, 0));
            }
        }
    }

    #[test]
    fn containment_is_by_cells_and_size() {
        let small = Bitmap::from_fn(70, 2, |cell| cell.column == 69);
        let large = Bitmap::from_fn(70, 2, |cell| cell.column >= 60);
        assert!(large.contains_all(&small) && !small.contains_all(&large));
        assert!(!large.contains_all(&Bitmap::new(70, 3)));
    }
}
