//! The cells of a map as obstacles: their outline, and which cell holds a point.

use crate::Point;
use maps::CellMap;
use maps::bitmap::Bitmap;
use math::scalar::wide;
use plan_format::Cell;
use std::ops::Range;

/// The cell of a map's cells that holds a point; `None` outside.
pub(super) fn cell_at(cells: &CellMap, point: Point) -> Option<Cell> {
    let [column, row] =
        [0, 1].map(|axis| wide::floor((point[axis] - cells.corner[axis]) / cells.resolution_m));
    let (columns, rows) = (cells.occupied.columns().into(), cells.occupied.rows().into());
    let is_inside = (0.0..columns).contains(&column) && (0.0..rows).contains(&row);
    is_inside.then(|| Cell::new(column as u32, row as u32))
}

/// The edges between occupied and other cells, as long as they are straight.
pub(super) fn outline(cells: &CellMap) -> Vec<[Point; 2]> {
    let occupied = &cells.occupied;
    let turned = Bitmap::from_fn(occupied.rows(), occupied.columns(), |cell| {
        occupied.get(Cell::new(cell.row, cell.column))
    });
    let metres =
        |axis: usize, count: u32| cells.corner[axis] + f64::from(count) * cells.resolution_m;
    let along_rows = edges(occupied).into_iter().map(|(row, run)| {
        [[metres(0, run.start), metres(1, row)], [metres(0, run.end), metres(1, row)]]
    });
    let along_columns = edges(&turned).into_iter().map(|(column, run)| {
        [[metres(0, column), metres(1, run.start)], [metres(0, column), metres(1, run.end)]]
    });
    along_rows.chain(along_columns).collect()
}

/// The runs of columns in which a row and the one south of it differ, each with its row.
fn edges(bitmap: &Bitmap) -> Vec<(u32, Range<u32>)> {
    let (columns, rows) = (bitmap.columns(), bitmap.rows());
    let at = |column: u32, row: u32| row < rows && bitmap.get(Cell::new(column, row));
    let mut found = Vec::new();
    for row in 0..=rows {
        let differs = |column: u32| at(column, row) != (row > 0 && at(column, row - 1));
        let mut column = 0;
        while column < columns {
            let start = column;
            while column < columns && differs(column) {
                column += 1;
            }
            if column > start {
                found.push((row, start..column));
            }
            column += 1;
        }
    }
    found
}
