//! The nearest free cell: where a goal or a start inside an obstacle was probably meant.

use maps::{Bitmap, Point};
use math::scalar::wide;
use plan_format::{Cell, Grid};

/// The free cell whose centre is nearest to a point; of equals, the first from the south-west.
pub(super) fn nearest_free(grid: &Grid, blocked: &Bitmap, to: Point) -> Option<Cell> {
    let squared = |cell: Cell| {
        let [x, y] = grid.centre(cell);
        (x - to[0]) * (x - to[0]) + (y - to[1]) * (y - to[1])
    };
    // The cell of the point itself comes first: its centre need not be the nearest.
    let own = grid.cell_at(to[0], to[1]).filter(|&cell| !blocked.get(cell));
    if own.is_some() {
        return own;
    }
    let index = |axis: usize, count: u32| {
        let at = wide::floor((to[axis] - grid.corner_m[axis]) / grid.resolution_m);
        at.clamp(0.0, f64::from(count.saturating_sub(1))) as u32
    };
    let (column, row) = (index(0, grid.columns), index(1, grid.rows));
    let mut best: Option<(f64, Cell)> = None;
    // Rows from the nearest outwards, as long as they can contain a nearer cell.
    for away in 0..grid.rows {
        let near = [row.checked_sub(away), row.checked_add(away).filter(|row| *row < grid.rows)];
        let in_reach = |row: &u32| {
            let apart = grid.centre(Cell::new(0, *row))[1] - to[1];
            best.is_none_or(|(squared, _)| apart * apart <= squared)
        };
        let rows: Vec<u32> = near.into_iter().flatten().filter(in_reach).collect();
        if rows.is_empty() && best.is_some() {
            break;
        }
        for row in rows {
            let is_free = |column: &u32| !blocked.get(Cell::new(*column, row));
            // On either side, only the first free cell can be the nearest.
            let west = (0..column).rev().find(is_free);
            let east = (column..grid.columns).find(is_free);
            for cell in [west, east].into_iter().flatten().map(|column| Cell::new(column, row)) {
                let found = (squared(cell), cell);
                let order = |(squared, cell): (f64, Cell)| (squared, cell.row, cell.column);
                if best.is_none_or(|best| order(found) < order(best)) {
                    best = Some(found);
                }
            }
        }
    }
    best.map(|(_, cell)| cell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_nearest_free_cell_is_that_of_a_search_through_all(
            columns in 1u32..90, rows in 1u32..12, free in prop::collection::vec((0u32..90, 0u32..12), 0..6),
            east in -80i32..320, north in -80i32..80,
        ) {
            // Quarters of a metre: many cells are equally near.
            let [x, y] = [east, north].map(|quarters| f64::from(quarters) / 4.0);
            let grid = Grid { columns, rows, resolution_m: 0.5, corner_m: [-3.0, 1.0] };
            let blocked = Bitmap::from_fn(columns, rows, |cell| !free.contains(&(cell.column, cell.row)));
            let squared = |cell: Cell| {
                let [east, north] = grid.centre(cell);
                (east - x) * (east - x) + (north - y) * (north - y)
            };
            let own = grid.cell_at(x, y).filter(|&cell| !blocked.get(cell));
            let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| Cell::new(column, row)));
            let cells = cells.filter(|&cell| !blocked.get(cell));
            let expected = own.or_else(|| cells.min_by(|&a, &b| squared(a).total_cmp(&squared(b))));
            prop_assert_eq!(nearest_free(&grid, &blocked, [x, y]), expected);
        }
    }
}
