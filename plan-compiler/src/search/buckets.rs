//! Uniform-cost search with buckets one step wide (Dial's method; Denardo and Fox 1979).
//!
//! Why it is exact: a bucket holds the cells whose cost lies in one interval as wide as the
//! shortest step. No step from a cell of the bucket can lead to a cost inside it, so every
//! cost found when the bucket is opened is final, whatever the order within. The longest
//! step is shorter than two widths, so three buckets are enough at any time.

use super::{Corners, MAX_COST};
use crate::bitmap::Bitmap;
use plan_format::Cell;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};

const WIDTH: u32 = STRAIGHT_STEP;
const _: () = assert!(DIAGONAL_STEP < 2 * WIDTH, "three buckets are enough");

/// Reusable buffers of the search.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    /// Cells by position in the padded grid, with the cost they were entered at.
    buckets: [Vec<(u32, u32)>; 3],
    /// One byte a cell with a border around: whether the search may enter.
    open: Vec<bool>,
    cost: Vec<u32>,
}

impl Queue {
    /// Lowers `cost` (row-major) to the cheapest way from the sources, each with the cost it
    /// starts at, through the cells whose bit in `cells` equals `through`.
    pub(crate) fn spread(
        &mut self,
        cells: &Bitmap,
        through: bool,
        sources: impl IntoIterator<Item = (Cell, u32)>,
        corners: Corners,
        cost: &mut [u32],
    ) {
        let (columns, rows) = (cells.columns() as usize, cells.rows() as usize);
        let stride = columns + 2;
        self.enter(cells, through);
        for bucket in &mut self.buckets {
            bucket.clear();
        }
        for (cell, start) in sources {
            let at = (cell.row as usize + 1) * stride + cell.column as usize + 1;
            self.offer(at, start);
        }
        self.run(stride, corners);
        if columns > 0 {
            let inner = self.cost.chunks_exact(stride).skip(1);
            for (to, from) in cost.chunks_exact_mut(columns).zip(inner).take(rows) {
                to.copy_from_slice(&from[1..=columns]);
            }
        }
    }

    fn enter(&mut self, cells: &Bitmap, through: bool) {
        let stride = cells.columns() as usize + 2;
        let padded = stride * (cells.rows() as usize + 2);
        self.cost.clear();
        self.cost.resize(padded, u32::MAX);
        self.open.clear();
        self.open.resize(padded, false);
        for row in 0..cells.rows() {
            let start = (row as usize + 1) * stride + 1;
            let words = cells.row(row);
            for column in 0..cells.columns() as usize {
                let bit = words[column / 64] >> (column % 64) & 1 == 1;
                self.open[start + column] = bit == through;
            }
        }
    }

    fn run(&mut self, stride: usize, corners: Corners) {
        let straight = [1, stride, stride.wrapping_neg(), 1usize.wrapping_neg()];
        let mut number = 0;
        let mut bucket = Vec::new();
        while self.buckets.iter().any(|bucket| !bucket.is_empty()) {
            std::mem::swap(&mut bucket, &mut self.buckets[number % 3]);
            for &(at, cost) in &bucket {
                let at = at as usize;
                if self.cost[at] != cost {
                    continue;
                }
                for step in straight {
                    self.offer(at.wrapping_add(step), cost + STRAIGHT_STEP);
                }
                for x in [1, 1usize.wrapping_neg()] {
                    for y in [stride, stride.wrapping_neg()] {
                        let is_allowed = corners == Corners::Allow
                            || self.open[at.wrapping_add(x)] && self.open[at.wrapping_add(y)];
                        if is_allowed {
                            let to = at.wrapping_add(x).wrapping_add(y);
                            self.offer(to, cost + DIAGONAL_STEP);
                        }
                    }
                }
            }
            bucket.clear();
            number += 1;
        }
    }

    /// A way to a cell at a cost: kept if the cell is open and the way better than before.
    fn offer(&mut self, at: usize, cost: u32) {
        if self.open[at] && cost < self.cost[at] && cost <= MAX_COST {
            self.cost[at] = cost;
            self.buckets[(cost / WIDTH % 3) as usize].push((at as u32, cost));
        }
    }
}
