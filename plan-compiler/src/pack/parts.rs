//! Blocks whose rows are split by borders, with one entry after the other from west to east.
//!
//! Walls, the ridges between two exits of a building and the limits of a root's area are nearly
//! straight on the scale of eight cells, so most blocks of two or three entries have them in the
//! same order in every row. A border takes half a byte per row; indices take at least one byte.

use plan_format::layout::MAX_BORDERS;

/// The order of a block's entries from west to east, and the borders between them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Parts {
    /// Indices of the given sets.
    pub(crate) order: Vec<usize>,
    /// One word per border, with 4 bits per row, the southernmost row lowest: the first column east
    /// of the border.
    pub(crate) borders: Vec<u32>,
}

impl Parts {
    /// Borders that separate sets of cells, if the sets have the same order in all rows. Cells
    /// outside all sets may be anywhere.
    pub(crate) fn of(sets: &[u64]) -> Option<Self> {
        if !(2..=MAX_BORDERS as usize + 1).contains(&sets.len()) {
            return None;
        }
        let mut order: Vec<usize> = (0..sets.len()).collect();
        // If two sets have the same order in all rows, pairwise comparison sorts them; checked
        // below.
        for last in (1..order.len()).rev() {
            for at in 0..last {
                if !is_before(sets[order[at]], sets[order[at + 1]]) {
                    order.swap(at, at + 1);
                }
            }
        }
        let pairs = (0..order.len()).flat_map(|a| (a + 1..order.len()).map(move |b| (a, b)));
        for (a, b) in pairs {
            is_before(sets[order[a]], sets[order[b]]).then_some(())?;
        }
        let behind = |at: usize| order[at..].iter().fold(0, |cells, &set| cells | sets[set]);
        let borders = (1..order.len()).map(|at| border(behind(at))).collect();
        Some(Self { order, borders })
    }
}

/// Whether in every row all cells of one set lie west of all cells of another.
fn is_before(west: u64, east: u64) -> bool {
    let rows = west.to_le_bytes().into_iter().zip(east.to_le_bytes());
    rows.into_iter().all(|(west, east)| 8 - west.leading_zeros() <= east.trailing_zeros())
}

/// The border west of a set of cells.
fn border(behind: u64) -> u32 {
    let rows = behind.to_le_bytes().into_iter().rev();
    rows.fold(0, |word, row| word << 4 | row.trailing_zeros())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_split_from_west_to_east() {
        let west = 0x0f0f_0f0f_0f0f_0f0f;
        let south = 0xffff_ffff;
        let halves = Parts { order: vec![1, 0], borders: vec![0x4444_4444] };
        assert_eq!(Parts::of(&[!west, west]), Some(halves));
        let thirds = Parts::of(&[!south, !west & south, west & south]).unwrap();
        assert_eq!(thirds.borders.len(), 2);
        let checkers = 0xaa55_aa55_aa55_aa55;
        assert_eq!(Parts::of(&[checkers, !checkers]), None);
        // The rest may lie anywhere; a row without a set has its border at the end.
        let corners = Parts { order: vec![0, 1], borders: vec![0x7888_8888] };
        assert_eq!(Parts::of(&[1, 1 << 63]), Some(corners));
    }
}
