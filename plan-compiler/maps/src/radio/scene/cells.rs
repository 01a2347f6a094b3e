//! Occupied cells of a file: where a ray enters and leaves them.

use super::{Kind, Ray, Stretch};
use crate::bitmap::Bitmap;
use crate::model::{CellMap, Point};
use math::Cell;
use math::scalar::wide;

/// The occupied cells of a map, without the small groups.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    corner: Point,
    resolution_m: f64,
    occupied: Bitmap,
}

impl Cells {
    /// Leaves out groups of touching cells whose longest side is at most `small_m`.
    pub(super) fn of(cells: &CellMap, small_m: f64) -> Self {
        let mut occupied = cells.occupied.clone();
        let mut seen = Bitmap::new(cells.columns(), cells.rows());
        for start in cells.occupied.iter() {
            if seen.get(start) {
                continue;
            }
            let group = group_of(start, &cells.occupied, &mut seen);
            let sides = [side(&group, |cell| cell.column), side(&group, |cell| cell.row)];
            if f64::from(sides[0].max(sides[1])) * cells.resolution_m <= small_m {
                group.iter().for_each(|cell| occupied.set(*cell, false));
            }
        }
        Self { corner: cells.corner, resolution_m: cells.resolution_m, occupied }
    }

    /// Whether the ray passes an occupied cell.
    pub(super) fn is_met_by(&self, ray: &Ray) -> bool {
        !self.walk(ray, |cell, _| !self.occupied.get(cell))
    }

    /// Appends the stretches of the ray in occupied cells; neighbouring cells are one stretch.
    pub(super) fn stretches(&self, ray: &Ray, found: &mut Vec<Stretch>) {
        let mut inside: Option<[f64; 2]> = None;
        let mut push = |span| found.push(Stretch { span, kind: Kind::Obstacle, height_m: None });
        self.walk(ray, |cell, [from, to]| {
            inside = match (inside, self.occupied.get(cell)) {
                (Some([start, _]), true) => Some([start, to]),
                (None, true) => Some([from, to]),
                (span, false) => {
                    span.into_iter().for_each(&mut push);
                    None
                }
            };
            true
        });
        inside.into_iter().for_each(push);
    }

    /// Calls `visit` with each cell of the file that the ray passes and its part of the ray, in
    /// order, until it returns false; reports whether it never did.
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(Cell, [f64; 2]) -> bool) -> bool {
        let from = [0, 1].map(|axis| (ray.at(0.0)[axis] - self.corner[axis]) / self.resolution_m);
        let along = ray.along().map(|metres| metres / self.resolution_m);
        let size = [self.occupied.columns(), self.occupied.rows()].map(f64::from);
        let Some([start, end]) = within(from, along, size) else { return true };
        let mut cell = [0, 1]
            .map(|axis| wide::floor(from[axis] + along[axis] * start).clamp(0.0, size[axis] - 1.0));
        let mut part = start;
        loop {
            // Where the ray leaves the cell along each axis.
            let leaves = [0, 1].map(|axis| {
                let edge = cell[axis] + f64::from(u8::from(along[axis] > 0.0));
                let leaves = (edge - from[axis]) / along[axis];
                if along[axis] == 0.0 { f64::INFINITY } else { leaves }
            });
            let next = leaves[0].min(leaves[1]);
            let to = next.min(end);
            let is_passed = part < to;
            if is_passed && !visit(Cell::new(cell[0] as u32, cell[1] as u32), [part, to]) {
                return false;
            }
            if next >= end {
                return true;
            }
            part = part.max(to);
            if leaves[0] == leaves[1] && !self.passes_corner(cell, along, next, &mut visit) {
                return false;
            }
            for axis in 0..2 {
                if leaves[axis] == next {
                    cell[axis] += along[axis].signum();
                }
            }
            if (0..2).any(|axis| !(0.0..size[axis]).contains(&cell[axis])) {
                return true;
            }
        }
    }

    /// Visits a cell beside the corner through which the ray leaves a cell, if both cells beside the
    /// corner are occupied: a wall of diagonal cells has no gaps.
    fn passes_corner(
        &self,
        cell: Point,
        along: Point,
        part: f64,
        visit: &mut impl FnMut(Cell, [f64; 2]) -> bool,
    ) -> bool {
        let beside = [0, 1].map(|axis| {
            let mut beside = cell;
            beside[axis] += along[axis].signum();
            // Off the grid there are no cells.
            let is_there = beside.iter().all(|index| *index >= 0.0);
            is_there.then(|| Cell::new(beside[0] as u32, beside[1] as u32))
        });
        match beside {
            [Some(a), Some(b)] if self.occupied.get(a) && self.occupied.get(b) => {
                visit(a, [part; 2])
            }
            _ => true,
        }
    }
}

/// The part of a ray, in cells, that lies on a grid; `None` if there is none.
fn within(from: Point, along: Point, size: Point) -> Option<[f64; 2]> {
    let mut span = [0.0_f64, 1.0_f64];
    for axis in 0..2 {
        if along[axis] == 0.0 {
            if !(0.0..size[axis]).contains(&from[axis]) {
                return None;
            }
            continue;
        }
        let ends = [-from[axis], size[axis] - from[axis]].map(|gap| gap / along[axis]);
        span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
    }
    (span[0] < span[1]).then_some(span)
}

/// The occupied cells that touch `start`, or touch cells that do, corners included.
fn group_of(start: Cell, occupied: &Bitmap, seen: &mut Bitmap) -> Vec<Cell> {
    let mut group = vec![start];
    seen.set(start, true);
    let mut next = 0;
    while let Some(&cell) = group.get(next) {
        next += 1;
        for row in cell.row.saturating_sub(1)..=cell.row + 1 {
            for column in cell.column.saturating_sub(1)..=cell.column + 1 {
                let neighbour = Cell::new(column, row);
                if occupied.get(neighbour) && !seen.get(neighbour) {
                    seen.set(neighbour, true);
                    group.push(neighbour);
                }
            }
        }
    }
    group
}

/// Length of a group along one axis, cells.
fn side(group: &[Cell], axis: impl Fn(&Cell) -> u32) -> u32 {
    let ends =
        group.iter().map(axis).fold((u32::MAX, 0), |(low, high), at| (low.min(at), high.max(at)));
    ends.1 - ends.0 + 1
}
