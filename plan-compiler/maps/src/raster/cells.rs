//! Transfers the cells that a file gives to the grid of a plan.
//!
//! Each is a half-open square, like the grid's cells. A cell of the grid is blocked if it overlaps
//! a blocked cell of the file or lies nearer to one than the robot's radius. So with the same grid
//! and radius 0 the cells stay as they are, coarser cells are blocked if any part of them is, and
//! finer cells inherit.
//!
//! Two half-open intervals that only meet share no point, and their smallest distance, 0, is not
//! attained; the same holds for every distance between two such squares. So both comparisons are
//! strict. Edges within [`NOISE`] of each other count as the same edge: three cells of 0.1 m make
//! one of 0.3 m.

use super::NOISE;
use crate::bitmap::Bitmap;
use crate::model::CellMap;
use math::Grid;
use math::scalar::wide;
use std::ops::Range;

/// Blocks the cells that a file's blocked cells touch, grown by `radius` in cells of the grid.
pub(super) fn block(cells: &CellMap, grid: &Grid, radius: f64, blocked: &mut Bitmap) {
    let theirs = cells.blocked();
    let is_same = cells.resolution_m == grid.resolution_m
        && cells.corner == grid.corner_m
        && (theirs.columns(), theirs.rows()) == (grid.columns, grid.rows);
    if is_same && radius == 0.0 {
        blocked.add_all(&theirs);
        return;
    }
    // A line between the file's cells, in cells of the grid.
    let line = |axis: usize, index: u32| {
        let at = cells.corner[axis] + f64::from(index) * cells.resolution_m;
        (at - grid.corner_m[axis]) / grid.resolution_m
    };
    for row in 0..theirs.rows() {
        let (south, north) = (line(1, row), line(1, row + 1));
        for run in theirs.runs(row) {
            let (west, east) = (line(0, run.start), line(0, run.end));
            for row in overlapped(south - radius, north + radius, grid.rows) {
                let gap = gap(f64::from(row), south, north);
                let reach = wide::sqrt(((radius - gap) * (radius + gap)).max(0.0));
                let columns = overlapped(west - reach, east + reach, grid.columns);
                blocked.fill(row, columns.start, columns.end);
            }
        }
    }
}

/// Distance of the cell from `at` to `at + 1` to an interval; 0 if they overlap.
fn gap(at: f64, low: f64, high: f64) -> f64 {
    (at - high).max(low - (at + 1.0)).max(0.0)
}

/// The cells along one axis that overlap an interval by more than noise.
fn overlapped(low: f64, high: f64, count: u32) -> Range<u32> {
    let limit = f64::from(count);
    let first = wide::floor(low + NOISE).clamp(0.0, limit);
    let end = wide::ceil(high - NOISE).clamp(0.0, limit);
    first as u32..end as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Map, Unknown};
    use crate::raster::{RasterOptions, rasterise};
    use math::Cell;
    use proptest::prelude::*;

    /// Cells from a picture, north up: `#` occupied, `?` unknown.
    fn cell_map(rows: &[&str], resolution_m: f64, corner: [f64; 2]) -> CellMap {
        let (columns, count) = (rows[0].len() as u32, rows.len() as u32);
        let symbol =
            |cell: Cell| rows[(count - 1 - cell.row) as usize].as_bytes()[cell.column as usize];
        let of = |wanted: u8| Bitmap::from_fn(columns, count, |cell| symbol(cell) == wanted);
        let (occupied, unknown) = (of(b'#'), of(b'?'));
        let unknown_as = Unknown::Obstacle;
        CellMap { resolution_m, corner, occupied, unknown, unknown_as, turned_from: None }
    }

    #[track_caller]
    fn check(cells: &CellMap, grid: &Grid, robot_radius_m: f64, expected: &[&str]) {
        let options = RasterOptions { robot_radius_m, fill_walls: false };
        let blocked = rasterise(&Map::of_cells(cells.clone()), grid, &|_| true, &options);
        let rows = (0..grid.rows).rev().map(|row| {
            let columns = 0..grid.columns;
            let symbol = |column| if blocked.get(Cell::new(column, row)) { '#' } else { '.' };
            columns.map(symbol).collect::<String>()
        });
        assert_eq!(rows.collect::<Vec<_>>(), expected);
    }

    fn grid(columns: u32, rows: u32, resolution_m: f64, corner_m: [f64; 2]) -> Grid {
        Grid { columns, rows, resolution_m, corner_m }
    }

    #[test]
    fn on_the_files_own_grid_cells_are_as_they_are() {
        let mut cells = cell_map(&["#...", "..?.", "...#"], 0.05, [-10.0, 3.1]);
        let own = grid(4, 3, 0.05, [-10.0, 3.1]);
        check(&cells, &own, 0.0, &["#...", "..#.", "...#"]);
        cells.unknown_as = Unknown::Free;
        check(&cells, &own, 0.0, &["#...", "....", "...#"]);
    }

    #[test]
    fn coarser_cells_are_blocked_by_any_part_and_finer_ones_inherit() {
        let cells =
            cell_map(&["......", "......", "..#...", "......", "......", ".....#"], 0.1, [0.0; 2]);
        check(&cells, &grid(2, 2, 0.3, [0.0; 2]), 0.0, &["#.", ".#"]);
        check(&cells, &grid(3, 3, 0.2, [0.0; 2]), 0.0, &["...", ".#.", "..#"]);
        // Edges that do not coincide: 0.2 to 0.3 lies in the first and the second cell.
        check(&cells, &grid(4, 4, 0.25, [0.0; 2]), 0.0, &["....", "....", "##..", "..#."]);
        let finer = cell_map(&[".#", "?."], 0.3, [0.0; 2]);
        check(
            &finer,
            &grid(6, 6, 0.1, [0.0; 2]),
            0.0,
            &["...###", "...###", "...###", "###...", "###...", "###..."],
        );
    }

    #[test]
    fn the_radius_grows_squares_exactly() {
        let cells = cell_map(
            &[".......", ".......", ".......", "...#...", ".......", ".......", "......."],
            1.0,
            [0.0; 2],
        );
        let own = grid(7, 7, 1.0, [0.0; 2]);
        let ring = [".......", ".......", "..###..", "..###..", "..###..", ".......", "......."];
        // Any radius above 0 reaches the neighbours.
        check(&cells, &own, 0.01, &ring);
        // A radius of exactly one cell does not reach beyond them.
        check(&cells, &own, 1.0, &ring);
        let cross = [".......", "..###..", ".#####.", ".#####.", ".#####.", "..###..", "......."];
        check(&cells, &own, 1.2, &cross);
        // The corner cells of the ring of two are sqrt 2 away.
        check(&cells, &own, 1.41, &cross);
        let square = [".......", ".#####.", ".#####.", ".#####.", ".#####.", ".#####.", "......."];
        check(&cells, &own, 1.42, &square);
    }

    proptest! {
        #[test]
        fn blocked_cells_follow_the_definition(
            occupied in prop::collection::vec((0u32..9, 0u32..9), 0..8),
            ratio in 1u32..8, shift in 0u32..4, radius in 0u32..12,
        ) {
            // Quarters of a cell are exact in floating point.
            let (resolution_m, corner) = (1.0, [f64::from(shift) * -0.25; 2]);
            let mut map = Bitmap::new(9, 9);
            for &(column, row) in &occupied {
                map.set(Cell::new(column, row), true);
            }
            let unknown = Bitmap::new(9, 9);
            let unknown_as = Unknown::Obstacle;
            let cells = CellMap { resolution_m, corner, occupied: map, unknown, unknown_as, turned_from: None };
            let (side, radius) = (f64::from(ratio) * 0.25, f64::from(radius) * 0.25);
            let grid = grid(12, 12, side, [0.0; 2]);
            let mut got = Bitmap::new(12, 12);
            block(&cells, &grid, radius / side, &mut got);
            let expected = Bitmap::from_fn(12, 12, |cell| {
                occupied.iter().any(|&(column, row)| {
                    let theirs = [column, row].map(|at| f64::from(at) + corner[0]);
                    let ours = [cell.column, cell.row].map(|at| f64::from(at) * side);
                    let gaps = [0, 1].map(|axis| {
                        (ours[axis] - (theirs[axis] + 1.0)).max(theirs[axis] - (ours[axis] + side))
                    });
                    let overlap = gaps[0] < 0.0 && gaps[1] < 0.0;
                    let [dx, dy] = gaps.map(|gap| gap.max(0.0));
                    overlap || dx * dx + dy * dy < radius * radius
                })
            });
            prop_assert_eq!(got, expected);
        }
    }
}
