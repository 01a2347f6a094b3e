//! The rows of a sweep: parallel lines across a ground, cut where the robot must not go.
//!
//! A point has the coordinate `u` along the rows and `v` across them. Rows are at most a quarter of a
//! cell apart, and never on the border of cells where they are parallel to it.

use super::Ground;
use maps::{Bitmap, Point};
use math::scalar::wide;
use plan_format::Grid;
use rayon::prelude::*;

/// A part of a row, metres along it.
pub(super) type Span = [f64; 2];

/// Rows across the tool's width, at least.
const ROWS_A_WIDTH: f64 = 16.0;
/// Pieces of a line that are shorter than this are points, metres.
const POINT_M: f64 = 1e-9;

/// The rows of a sweep.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    cos: f64,
    sin: f64,
    /// The lowest edge of the ground, metres across.
    lowest_m: f64,
    /// Distance of neighbouring rows, metres.
    pub(super) step_m: f64,
    /// Side of a cell, metres.
    pub(super) resolution_m: f64,
    /// The parts of each row that lie in the ground.
    pub(super) spans: Vec<Vec<Span>>,
}

impl Rows {
    /// The rows of a ground in a direction, degrees counter-clockwise from east, for a tool of this
    /// width.
    pub(super) fn of(ground: &Ground, angle_deg: f64, width_m: f64) -> Self {
        let resolution_m = ground.grid.resolution_m;
        // An even number of rows a cell: halfway between two of them lies the border of two cells.
        let halves = wide::ceil(ROWS_A_WIDTH * resolution_m / (2.0 * width_m)).max(2.0);
        let step_m = resolution_m / (2.0 * halves);
        let angle = angle_deg.to_radians();
        let [cos, sin] = [wide::cos(angle), wide::sin(angle)].map(snapped);
        let mut rows = Self { cos, sin, lowest_m: 0.0, step_m, resolution_m, spans: Vec::new() };
        let Some(box_m) = bounds(ground) else { return rows };
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]]
            .map(|[x, y]: [usize; 2]| rows.in_sweep([box_m[x][0], box_m[y][1]]));
        let least = |axis: usize| corners.iter().fold(f64::INFINITY, |low, at| low.min(at[axis]));
        let most = |axis: usize| corners.iter().fold(-f64::INFINITY, |high, at| high.max(at[axis]));
        rows.lowest_m = least(1);
        let count = wide::ceil((most(1) - least(1)) / step_m - 1e-6).max(0.0) as usize;
        let (west, east) = (least(0), most(0));
        rows.spans = (0..count)
            .into_par_iter()
            .map(|row| {
                let across = rows.across_m(row);
                let [a, b] = [rows.at([west, across]), rows.at([east, across])];
                let pieces = runs(&ground.grid, &ground.cells, a, b);
                pieces.into_iter().map(|[from, to]| [west + from, west + to]).collect()
            })
            .collect();
        rows
    }

    /// Where a row lies, metres across.
    pub(super) fn across_m(&self, row: usize) -> f64 {
        self.lowest_m + (row as f64 + 0.5) * self.step_m
    }

    /// The point of the map at a place of the sweep.
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> Point {
        [u * self.cos - v * self.sin, u * self.sin + v * self.cos]
    }

    fn in_sweep(&self, [x, y]: Point) -> [f64; 2] {
        [x * self.cos + y * self.sin, y * self.cos - x * self.sin]
    }
}

/// Sines of right angles are exact.
fn snapped(value: f64) -> f64 {
    let nearest = wide::floor(value + 0.5);
    if (value - nearest).abs() < 1e-12 { nearest } else { value }
}

/// The corners of the box around a ground's cells, metres; `None` if it has none.
fn bounds(ground: &Ground) -> Option<[Point; 2]> {
    let mut cells = ground.cells.iter();
    let first = cells.next()?;
    let start = [first.column, first.row, first.column, first.row];
    let [west, south, east, north] = cells.fold(start, |[w, s, e, n], cell| {
        [w.min(cell.column), s.min(cell.row), e.max(cell.column), n.max(cell.row)]
    });
    let side = ground.grid.resolution_m;
    let at = |column: u32, row: u32| {
        let [x, y] = ground.grid.corner_m;
        [x + f64::from(column) * side, y + f64::from(row) * side]
    };
    Some([at(west, south), at(east + 1, north + 1)])
}

/// The parts of a segment that lie in cells of a set, as distances from its start, metres.
pub(super) fn runs(grid: &Grid, cells: &Bitmap, a: Point, b: Point) -> Vec<Span> {
    let length = super::distance(a, b);
    let in_cells = |at: Point, axis: usize| (at[axis] - grid.corner_m[axis]) / grid.resolution_m;
    // Where the segment passes from cell to cell.
    let mut cuts = vec![0.0, length];
    for axis in 0..2 {
        let (from, to) = (in_cells(a, axis), in_cells(b, axis));
        if (to - from).abs() < 1e-12 {
            continue;
        }
        let last = wide::floor(from.max(to));
        let mut line = wide::ceil(from.min(to));
        while line <= last {
            cuts.push((line - from) / (to - from) * length);
            line += 1.0;
        }
    }
    cuts.sort_by(f64::total_cmp);
    let mut runs: Vec<Span> = Vec::new();
    for piece in cuts.windows(2).filter(|piece| piece[1] - piece[0] > POINT_M) {
        let share = (piece[0] + piece[1]) / 2.0 / length;
        let middle = [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * share);
        let is_free = grid.cell_at(middle[0], middle[1]).is_some_and(|cell| cells.get(cell));
        match runs.last_mut() {
            _ if !is_free => {}
            Some(last) if piece[0] - last[1] <= 2.0 * POINT_M => last[1] = piece[1],
            _ => runs.push([piece[0], piece[1]]),
        }
    }
    runs
}

/// Whether the whole segment lies in cells of a set.
pub(super) fn is_open(ground: &Ground, a: Point, b: Point) -> bool {
    let length = super::distance(a, b);
    if length <= POINT_M {
        return ground.grid.cell_at(a[0], a[1]).is_some_and(|cell| ground.cells.get(cell));
    }
    match runs(&ground.grid, &ground.cells, a, b)[..] {
        [[from, to]] => from <= POINT_M && to >= length - 2.0 * POINT_M,
        _ => false,
    }
}
