//! Rotates cells, as a ROS map's yaw demands.
//!
//! Quarter turns are exact. Any other angle resamples the cells on an upright grid of the same
//! resolution: a cell is occupied if its interior meets an occupied cell's, otherwise unknown if
//! it meets an unknown cell's. So no blocked cell becomes free. Cells outside the rotated
//! rectangle are outside the map's boundary.

use crate::bitmap::Bitmap;
use crate::model::{CellMap, Point};
use math::Cell;
use math::scalar::wide;

/// A rotation counts as a quarter turn if no corner of a cell differs by more than this, in
/// cells: 1.5708 is meant to be a right angle.
const SAME: f64 = 0.01;

/// Upright cells, and the outline of the rotated rectangle unless it is upright too.
///
/// `yaw_rad` is counter-clockwise about the south-west corner. Returns `None`, before it
/// allocates, if a side would have more cells than `limit`.
pub(super) fn turned(
    cells: CellMap,
    yaw_rad: f64,
    limit: u32,
) -> Option<(CellMap, Option<Vec<Point>>)> {
    let farthest = f64::from(cells.columns()) + f64::from(cells.rows());
    if let Some(quarters) = quarters(yaw_rad, farthest) {
        return Some((by_quarters(cells, quarters), None));
    }
    let (cells, outline) = by_angle(&cells, yaw_rad, limit)?;
    Some((cells, Some(outline)))
}

/// The quarter turns from 0 to 3 that an angle means for cells up to this far away, in cells; `None`
/// if it is another angle.
pub(super) fn quarters(yaw_rad: f64, farthest: f64) -> Option<usize> {
    let quarters = wide::floor(yaw_rad / std::f64::consts::FRAC_PI_2 + 0.5);
    let rest = yaw_rad - quarters * std::f64::consts::FRAC_PI_2;
    (rest.abs() * farthest <= SAME).then(|| quarters.rem_euclid(4.0) as usize)
}

fn by_quarters(cells: CellMap, quarters: usize) -> CellMap {
    let (columns, rows) = (cells.columns(), cells.rows());
    let [x, y] = cells.corner;
    let side = |count: u32| f64::from(count) * cells.resolution_m;
    // Source of each cell, and how far the rectangle reaches west and south of its pivot.
    type Source = fn(Cell, u32, u32) -> Cell;
    let (size, corner, source): ((u32, u32), Point, Source) = match quarters {
        1 => ((rows, columns), [x - side(rows), y], |to, _, rows| {
            Cell::new(to.row, rows - 1 - to.column)
        }),
        2 => ((columns, rows), [x - side(columns), y - side(rows)], |to, columns, rows| {
            Cell::new(columns - 1 - to.column, rows - 1 - to.row)
        }),
        3 => ((rows, columns), [x, y - side(columns)], |to, columns, _| {
            Cell::new(columns - 1 - to.row, to.column)
        }),
        _ => return cells,
    };
    let turn =
        |set: &Bitmap| Bitmap::from_fn(size.0, size.1, |to| set.get(source(to, columns, rows)));
    let turned_from = Some(cells.counts());
    let (occupied, unknown) = (turn(&cells.occupied), turn(&cells.unknown));
    CellMap { corner, occupied, unknown, turned_from, ..cells }
}

fn by_angle(cells: &CellMap, yaw_rad: f64, limit: u32) -> Option<(CellMap, Vec<Point>)> {
    let (sin, cos) = (wide::sin(yaw_rad), wide::cos(yaw_rad));
    let forth = |[x, y]: Point| [cos * x - sin * y, sin * x + cos * y];
    let back = |[x, y]: Point| [cos * x + sin * y, cos * y - sin * x];
    let (width, height) = (f64::from(cells.columns()), f64::from(cells.rows()));
    let outline = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(forth);
    let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
        outline.iter().map(|at| at[axis]).reduce(pick).unwrap_or_default()
    };
    let low = [bound(0, f64::min), bound(1, f64::min)];
    let size = [0, 1].map(|axis| wide::ceil(bound(axis, f64::max) - low[axis]) as u32);
    if size.iter().any(|side| *side > limit) {
        return None;
    }
    // Mean width of an upright and a rotated unit square. Two such squares overlap if their
    // centres are nearer than this along both squares' axes (separating axes).
    let nearer = (1.0 + sin.abs() + cos.abs()) / 2.0;
    let meets = |from: Point, to: Cell| {
        let apart = [from[0] - f64::from(to.column) - 0.5, from[1] - f64::from(to.row) - 0.5];
        let is_near = |[x, y]: Point| x.abs() < nearer && y.abs() < nearer;
        is_near(apart) && is_near(forth(apart))
    };
    let mut upright = CellMap {
        resolution_m: cells.resolution_m,
        corner: [0, 1].map(|axis| cells.corner[axis] + low[axis] * cells.resolution_m),
        occupied: Bitmap::new(size[0], size[1]),
        unknown: Bitmap::new(size[0], size[1]),
        unknown_as: cells.unknown_as,
        turned_from: Some(cells.counts()),
    };
    for row in 0..size[1] {
        for column in 0..size[0] {
            let centre = back([low[0] + f64::from(column) + 0.5, low[1] + f64::from(row) + 0.5]);
            let near = |at: f64, count: u32| {
                let limit = f64::from(count);
                let first = wide::floor(at - nearer - 0.5).clamp(0.0, limit) as u32;
                first..wide::ceil(at + nearer + 0.5).clamp(0.0, limit) as u32
            };
            let (mut occupied, mut unknown) = (false, false);
            for from_row in near(centre[1], cells.rows()) {
                for from_column in near(centre[0], cells.columns()) {
                    let from = Cell::new(from_column, from_row);
                    if meets(centre, from) {
                        occupied |= cells.occupied.get(from);
                        unknown |= cells.unknown.get(from);
                    }
                }
            }
            let cell = Cell::new(column, row);
            upright.occupied.set(cell, occupied);
            upright.unknown.set(cell, unknown && !occupied);
        }
    }
    let metres = |at: Point| [0, 1].map(|axis| cells.corner[axis] + at[axis] * cells.resolution_m);
    Some((upright, outline.map(metres).to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Unknown;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn cells(columns: u32, rows: u32, seed: u64) -> CellMap {
        let mut state = seed | 1;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state % 4
        };
        let kinds: Vec<u64> = (0..columns * rows).map(|_| random()).collect();
        let of = |wanted| {
            Bitmap::from_fn(columns, rows, |cell| {
                kinds[(cell.row * columns + cell.column) as usize] == wanted
            })
        };
        let (occupied, unknown) = (of(0), of(1));
        let unknown_as = Unknown::Obstacle;
        CellMap {
            resolution_m: 0.5,
            corner: [3.0, -2.0],
            occupied,
            unknown,
            unknown_as,
            turned_from: None,
        }
    }

    /// As the tested function; the results of these tests are never too large.
    fn turned(cells: CellMap, yaw_rad: f64) -> (CellMap, Option<Vec<Point>>) {
        super::turned(cells, yaw_rad, 16_384).unwrap()
    }

    #[test]
    fn a_result_that_is_too_large_is_refused() {
        let map = cells(70, 70, 1);
        assert!(super::turned(map.clone(), 0.78, 98).is_none());
        assert!(super::turned(map.clone(), 0.78, 99).is_some());
        assert!(super::turned(map, FRAC_PI_2, 70).is_some());
    }

    #[test]
    fn a_quarter_turn_is_exact() {
        let mut map = cells(3, 2, 0);
        map.occupied = Bitmap::new(3, 2);
        map.unknown = Bitmap::new(3, 2);
        map.occupied.set(Cell::new(2, 0), true);
        map.unknown.set(Cell::new(0, 1), true);
        // The pivot is 3 m, -2 m; the cell 1 to 1.5 m east of it moves north of it.
        for (yaw, corner) in [(PI, [1.5, -3.0]), (-FRAC_PI_2, [3.0, -3.5])] {
            assert_eq!(turned(map.clone(), yaw).0.corner, corner);
        }
        // Files write the angle rounded.
        let (turned, outline) = turned(map, FRAC_PI_2 + 3.7e-6);
        assert_eq!(outline, None);
        assert_eq!((turned.columns(), turned.rows(), turned.corner), (2, 3, [2.0, -2.0]));
        assert_eq!(turned.occupied.iter().collect::<Vec<_>>(), [Cell::new(1, 2)]);
        assert_eq!(turned.unknown.iter().collect::<Vec<_>>(), [Cell::new(0, 0)]);
    }

    proptest! {
        #[test]
        fn four_quarter_turns_change_nothing(columns in 1u32..70, rows in 1u32..9, seed: u64) {
            let map = cells(columns, rows, seed);
            for quarters in [1.0, -1.0, 2.0, 5.0] {
                let mut again = map.clone();
                for _ in 0..4 {
                    again = turned(again, quarters * FRAC_PI_2).0;
                    // Each turn is about the current south-west corner.
                    again = CellMap { corner: map.corner, turned_from: None, ..again };
                }
                prop_assert_eq!(&again, &map);
            }
        }

        #[test]
        fn no_point_of_an_occupied_cell_becomes_free(
            columns in 1u32..12, rows in 1u32..12, seed: u64, yaw in -7.0..7.0_f64,
        ) {
            let map = cells(columns, rows, seed);
            let (upright, _) = turned(map.clone(), yaw);
            let at = |set: &Bitmap, corner: Point, [x, y]: Point| {
                let index = |at: f64, corner: f64| wide::floor((at - corner) / 0.5) as i64;
                let (column, row) = (index(x, corner[0]), index(y, corner[1]));
                let cell = Cell::new(u32::try_from(column).ok()?, u32::try_from(row).ok()?);
                (cell.column < set.columns() && cell.row < set.rows()).then(|| set.get(cell))
            };
            let (sin, cos) = (wide::sin(yaw), wide::cos(yaw));
            // Points well inside the cells, so that rounding decides nothing.
            for step in 0..u64::from(columns) * u64::from(rows) * 25 {
                let fifth = |n: u64| (n as f64 + 0.5) / 5.0 * 0.5;
                let [x, y] = [step % (u64::from(columns) * 5), step / (u64::from(columns) * 5)]
                    .map(fifth);
                let from = [x + 3.0, y - 2.0];
                let to = [3.0 + cos * x - sin * y, -2.0 + sin * x + cos * y];
                let occupied = at(&map.occupied, map.corner, from).unwrap();
                let unknown = at(&map.unknown, map.corner, from).unwrap();
                let now_occupied = at(&upright.occupied, upright.corner, to);
                let now_unknown = at(&upright.unknown, upright.corner, to);
                prop_assert!(now_occupied.is_some());
                prop_assert!(!occupied || now_occupied == Some(true), "{:?}", from);
                let known = now_occupied == Some(false) && now_unknown == Some(false);
                prop_assert!(!(unknown && known), "{:?}", from);
            }
            // A cell farther than a cell's diagonal from every occupied cell stays free.
            for cell in upright.occupied.iter() {
                let centre = [cell.column, cell.row].map(|index| (f64::from(index) + 0.5) * 0.5);
                let [x, y] = [0, 1].map(|axis| upright.corner[axis] + centre[axis] - map.corner[axis]);
                let [x, y] = [cos * x + sin * y, cos * y - sin * x];
                let is_near = map.occupied.iter().any(|from| {
                    let apart = [x - (f64::from(from.column) + 0.5) * 0.5, y - (f64::from(from.row) + 0.5) * 0.5];
                    wide::hypot(apart[0], apart[1]) <= 0.5 * std::f64::consts::SQRT_2
                });
                prop_assert!(is_near, "{cell:?}");
            }
        }
    }
}
