//! Exact shapes to blocked cells.
//!
//! A cell is the half-open square `[x, x + 1) x [y, y + 1)` in units of the resolution. It is
//! blocked if it holds a point of an obstacle grown by the robot's radius (the Minkowski sum
//! with a closed disc). So with radius 0 a cell is blocked if the shape touches it. Everything
//! outside the map's boundary polygon is blocked: a cell is free only if all of it lies in the
//! closed polygon. Neither the boundary nor the border of the grid grows.
//!
//! Method. Every shape is made of *capsules*, the points within the radius of a segment.
//! A capsule is convex, so in one row of cells it covers an interval of columns; the interval's
//! ends follow from where the capsule's outline meets the row's edges. A circle is a capsule of
//! length 0. A line is one capsule per segment. A polygon is one capsule per edge, plus the
//! untouched cells whose centre is inside. So the work grows with the rows that a shape spans,
//! not with its cells.
//!
//! Rounding. Points are converted to units of cells in double precision. A coordinate exactly on
//! a cell's edge is taken as exact. One that misses an edge by less than [`NOISE`] may have been
//! meant to lie on it (0.3 / 0.1 is 2.999...), so the cells on both sides are blocked: never less
//! than the shape. The boundary is lenient instead: a cell is outside only if it reaches farther
//! out than [`NOISE`].
//!
//! Cells that the file gives follow their own rule: see `cells`.

mod cells;

use crate::bitmap::Bitmap;
use crate::model::{CellMap, Feature, Map, Point, Shape};
use math::Grid;
use math::scalar::wide;

/// Distance from a cell's edge below which rounding may decide, in cells. Positions of up to
/// 16,384 cells keep steps of 4e-12.
pub const NOISE: f64 = 1e-9;

/// How shapes are rasterised.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RasterOptions {
    /// Obstacles grow by this, metres: the radius of a circle around the robot's centre.
    pub robot_radius_m: f64,
    /// Whether closed lines are solid inside. Overlays draw buildings as closed walls; without
    /// this their interiors are free but unreachable.
    pub fill_walls: bool,
}

/// The cells that a robot's centre must not enter.
///
/// These are the cells touched by a feature for which `is_obstacle` holds or by a blocked cell of
/// the file, both grown by the robot's radius, and the cells outside the map's boundary.
pub fn rasterise(
    map: &Map,
    grid: &Grid,
    is_obstacle: &dyn Fn(&Feature) -> bool,
    options: &RasterOptions,
) -> Bitmap {
    let mut raster = Raster {
        grid: *grid,
        radius: options.robot_radius_m.max(0.0) / grid.resolution_m,
        blocked: Bitmap::new(grid.columns, grid.rows),
    };
    for feature in map.features.iter().filter(|feature| is_obstacle(feature)) {
        match &feature.shape {
            Shape::Circle { centre, radius } => raster.circle(*centre, *radius),
            Shape::Polyline(points) if options.fill_walls && is_closed(points) => {
                raster.polygon(std::slice::from_ref(points));
            }
            Shape::Polyline(points) => raster.line(points),
            Shape::Polygon(rings) => raster.polygon(rings),
        }
    }
    if let Some(cells) = &map.cells {
        cells::block(cells, grid, raster.radius, &mut raster.blocked);
    }
    if let Some(boundary) = &map.boundary {
        raster.outside(boundary);
    }
    raster.blocked
}

/// Blocks the cells that the blocked cells of another file touch, grown by the robot's radius.
pub fn keep_out(cells: &CellMap, grid: &Grid, robot_radius_m: f64, blocked: &mut Bitmap) {
    cells::block(cells, grid, robot_radius_m.max(0.0) / grid.resolution_m, blocked);
}

fn is_closed(points: &[Point]) -> bool {
    points.len() > 3 && points.first() == points.last()
}

/// Blocks the cells of one shape after another.
struct Raster {
    grid: Grid,
    /// The robot's radius, cells.
    radius: f64,
    blocked: Bitmap,
}

impl Raster {
    fn circle(&mut self, centre: Point, radius_m: f64) {
        let centre = self.in_cells(centre);
        let radius = self.radius + radius_m.max(0.0) / self.grid.resolution_m;
        self.capsule(Capsule { a: centre, b: centre, radius });
    }

    fn line(&mut self, points: &[Point]) {
        let points: Vec<Point> = points.iter().map(|&point| self.in_cells(point)).collect();
        for ends in points.windows(2) {
            self.capsule(Capsule { a: ends[0], b: ends[1], radius: self.radius });
        }
        if let [point] = points[..] {
            self.capsule(Capsule { a: point, b: point, radius: self.radius });
        }
    }

    fn polygon(&mut self, rings: &[Vec<Point>]) {
        for ring in rings {
            let mut closed = ring.clone();
            closed.extend(ring.first());
            self.line(&closed);
        }
        let rings: Vec<Vec<Point>> = rings
            .iter()
            .map(|ring| ring.iter().map(|&point| self.in_cells(point)).collect())
            .collect();
        let Some((outer, holes)) = rings.split_first() else { return };
        let mut outer = Interior::of(outer, self.grid.rows);
        let mut holes: Vec<Interior<'_>> =
            holes.iter().map(|hole| Interior::of(hole, self.grid.rows)).collect();
        for row in outer.rows() {
            let spans = outer.spans(row);
            let within: Vec<[f64; 2]> = holes.iter_mut().flat_map(|hole| hole.spans(row)).collect();
            for span in subtract(&spans, within) {
                self.fill_centres(row, span);
            }
        }
    }

    fn outside(&mut self, boundary: &[Point]) {
        let ring: Vec<Point> = boundary.iter().map(|&point| self.in_cells(point)).collect();
        let mut interior = Interior::of(&ring, self.grid.rows);
        let everywhere = [[-1.0, f64::from(self.grid.columns) + 1.0]];
        for row in 0..self.grid.rows {
            for span in subtract(&everywhere, interior.spans(row)) {
                self.fill_centres(row, span);
            }
        }
        for (&a, &b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            self.crossing(a, b);
        }
    }

    /// Blocks the cells that hold a point of the capsule.
    fn capsule(&mut self, capsule: Capsule) {
        let [south, north] = capsule.extent(1);
        let Some(rows) = covered(south, north, true, self.grid.rows) else { return };
        for row in rows {
            let edge = f64::from(row);
            let [west, east] = [capsule.reach(edge, -1.0), capsule.reach(edge, 1.0)];
            if let Some(columns) = covered(west.x, east.x, east.attained, self.grid.columns) {
                self.blocked.fill(row, columns.start, columns.end);
            }
        }
    }

    /// Blocks the cells whose interior a boundary's edge crosses by more than noise. A cell that
    /// the edge only borders lies wholly on one side.
    fn crossing(&mut self, a: Point, b: Point) {
        let edge = Capsule { a, b, radius: 0.0 };
        let [south, north] = edge.extent(1);
        let Some(rows) = crossed(south, north, self.grid.rows) else { return };
        for row in rows {
            let [west, east] = [-1.0, 1.0].map(|side| edge.reach(f64::from(row), side).x);
            if let Some(columns) = crossed(west, east, self.grid.columns) {
                self.blocked.fill(row, columns.start, columns.end);
            }
        }
    }

    /// Blocks the cells of a row whose centres lie in a span.
    fn fill_centres(&mut self, row: u32, [west, east]: [f64; 2]) {
        let from = wide::ceil(west - 0.5).max(0.0);
        let to = wide::ceil(east - 0.5).max(0.0);
        self.blocked.fill(row, from as u32, to as u32);
    }

    fn in_cells(&self, point: Point) -> Point {
        let [x, y] = self.grid.corner_m;
        [(point[0] - x) / self.grid.resolution_m, (point[1] - y) / self.grid.resolution_m]
    }
}

/// The half-open squares along one axis that hold a point of the interval from `low` to
/// `high`, `high` itself only if it is `attained`.
///
/// Whether the lower end is attained does not matter: points slightly above it lie in the same
/// square.
fn covered(low: f64, high: f64, attained: bool, count: u32) -> Option<std::ops::Range<u32>> {
    let first = if is_just_above(low) { wide::floor(low) - 1.0 } else { wide::floor(low) };
    let end = if attained || is_just_below(high) {
        wide::floor(high) + if is_just_below(high) { 2.0 } else { 1.0 }
    } else {
        wide::ceil(high)
    };
    within(first, end, count)
}

/// The open squares along one axis that hold a point of the interval, give or take noise.
fn crossed(low: f64, high: f64, count: u32) -> Option<std::ops::Range<u32>> {
    within(wide::floor(low + NOISE), wide::ceil(high - NOISE), count)
}

fn within(first: f64, end: f64, count: u32) -> Option<std::ops::Range<u32>> {
    let first = first.max(0.0);
    let end = end.min(f64::from(count));
    (first < end).then_some(first as u32..end as u32)
}

fn is_just_above(x: f64) -> bool {
    let above = x - wide::floor(x);
    0.0 < above && above < NOISE
}

fn is_just_below(x: f64) -> bool {
    let below = wide::ceil(x) - x;
    0.0 < below && below < NOISE
}

/// The points within a radius of a segment, in cells.
#[derive(Clone, Copy, Debug)]
struct Capsule {
    a: Point,
    b: Point,
    radius: f64,
}

/// How far a capsule reaches in one row of cells.
#[derive(Clone, Copy, Debug)]
struct Reach {
    x: f64,
    /// Whether a point of the row attains `x`; otherwise points only approach it towards the
    /// northern edge, which belongs to the next row.
    attained: bool,
}

impl Capsule {
    /// Lowest and highest coordinate along an axis.
    fn extent(&self, axis: usize) -> [f64; 2] {
        let (a, b) = (self.a[axis], self.b[axis]);
        [a.min(b) - self.radius, a.max(b) + self.radius]
    }

    /// How far east (`side` = 1) or west (-1) the capsule reaches in the row of cells whose
    /// southern edge is at `edge`, which the capsule must meet.
    fn reach(&self, edge: f64, side: f64) -> Reach {
        let [south, north] = self.extent(1);
        // The southernmost of the points that are farthest out.
        let tip = if side * (self.a[0] - self.b[0]) > 0.0
            || (self.a[0] == self.b[0] && self.a[1] < self.b[1])
        {
            self.a
        } else {
            self.b
        };
        let tip_north = if self.a[0] == self.b[0] { self.a[1].max(self.b[1]) } else { tip[1] };
        if tip_north < edge {
            // The outline recedes northward from the row's southern edge.
            Reach { x: self.outline(edge.min(north), side), attained: true }
        } else if tip[1] < edge + 1.0 {
            Reach { x: tip[0] + side * self.radius, attained: true }
        } else {
            // It advances up to the row's northern edge, where the next row begins.
            let x = self.outline((edge + 1.0).max(south), side);
            // A row that the capsule touches only by noise must keep the touched cells.
            Reach { x, attained: edge + 1.0 < south }
        }
    }

    /// The capsule's easternmost (westernmost) x at a height.
    fn outline(&self, y: f64, side: f64) -> f64 {
        let caps = [self.a, self.b].into_iter().filter_map(|end| {
            let dy = (y - end[1]).abs();
            let chord = (self.radius - dy) * (self.radius + dy);
            (dy <= self.radius + NOISE).then(|| end[0] + side * wide::sqrt(chord.max(0.0)))
        });
        let farthest = caps.chain(self.flank(y, side)).map(|x| side * x);
        side * farthest.fold(f64::NEG_INFINITY, f64::max)
    }

    /// x of the capsule's straight side at a height, if the side reaches it.
    fn flank(&self, y: f64, side: f64) -> Option<f64> {
        let [dx, dy] = [self.b[0] - self.a[0], self.b[1] - self.a[1]];
        if dy == 0.0 {
            return None;
        }
        let length = wide::hypot(dx, dy);
        // The normal that points to the wanted side.
        let sign = if dy > 0.0 { side } else { -side };
        let offset = [sign * dy / length * self.radius, -sign * dx / length * self.radius];
        let along = y - (self.a[1] + offset[1]);
        let is_between = along * dy >= 0.0 && along.abs() <= dy.abs();
        is_between.then(|| self.a[0] + offset[0] + along * dx / dy)
    }
}

/// The inside of a ring at the height of each row's centres, by the non-zero winding rule: an
/// outline that overlaps itself is solid.
///
/// Callers ask for rows from south to north. Only the edges that cross the current row are
/// visited, and only its crossings are stored: a ring whose edges all span the map has as many
/// crossings as edges in every row, billions in total.
struct Interior<'r> {
    ring: &'r [Point],
    row_count: u32,
    /// Edges sorted by the first row whose centre they cross, the southernmost last.
    waiting: Vec<u32>,
    /// Edges that cross the current row.
    crossing: Vec<u32>,
    rows: std::ops::Range<u32>,
}

impl<'r> Interior<'r> {
    fn of(ring: &'r [Point], row_count: u32) -> Self {
        let mut interior =
            Self { ring, row_count, waiting: Vec::new(), crossing: Vec::new(), rows: 0..0 };
        let count = ring.len().min(u32::MAX as usize) as u32;
        let mut waiting: Vec<u32> =
            (0..count).filter(|edge| !interior.rows_of(*edge).is_empty()).collect();
        waiting.sort_unstable_by_key(|edge| std::cmp::Reverse(interior.rows_of(*edge).start));
        let first = waiting.last().map_or(0, |edge| interior.rows_of(*edge).start);
        let end = waiting.iter().map(|edge| interior.rows_of(*edge).end).max().unwrap_or(first);
        (interior.waiting, interior.rows) = (waiting, first..end);
        interior
    }

    /// Rows that have an inside.
    fn rows(&self) -> std::ops::Range<u32> {
        self.rows.clone()
    }

    /// The ends of an edge; an edge has the index of its first point.
    fn ends(&self, edge: u32) -> [Point; 2] {
        let first = edge as usize;
        let second = if first + 1 < self.ring.len() { first + 1 } else { 0 };
        [self.ring[first], self.ring[second]]
    }

    /// The rows whose centres an edge crosses.
    fn rows_of(&self, edge: u32) -> std::ops::Range<u32> {
        // Rows whose centres are at or above a height.
        let row_from = |y: f64| wide::ceil(y - 0.5).clamp(0.0, f64::from(self.row_count)) as u32;
        let [a, b] = self.ends(edge);
        row_from(a[1].min(b[1]))..row_from(a[1].max(b[1]))
    }

    /// Spans from west to east. Rows must be asked for in ascending order.
    fn spans(&mut self, row: u32) -> Vec<[f64; 2]> {
        while let Some(edge) = self.waiting.last().copied()
            && self.rows_of(edge).start <= row
        {
            self.waiting.pop();
            self.crossing.push(edge);
        }
        let mut crossing = std::mem::take(&mut self.crossing);
        crossing.retain(|edge| row < self.rows_of(*edge).end);
        let height = f64::from(row) + 0.5;
        let crossings = crossing.iter().map(|edge| {
            let [a, b] = self.ends(*edge);
            let x = a[0] + (height - a[1]) * (b[0] - a[0]) / (b[1] - a[1]);
            (x, if a[1] < b[1] { 1 } else { -1 })
        });
        let spans = wound(crossings.collect());
        self.crossing = crossing;
        spans
    }
}

/// The spans between crossings where the winding number is not zero.
fn wound(mut crossings: Vec<(f64, i32)>) -> Vec<[f64; 2]> {
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut winding = 0;
    let mut spans = Vec::new();
    for pair in crossings.windows(2) {
        winding += pair[0].1;
        if winding != 0 {
            spans.push([pair[0].0, pair[1].0]);
        }
    }
    spans
}

/// Sorted spans minus other spans.
fn subtract(spans: &[[f64; 2]], mut without: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    without.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut left = Vec::new();
    for &[mut west, east] in spans {
        for &[from, to] in &without {
            if to <= west || from >= east {
                continue;
            }
            if from > west {
                left.push([west, from]);
            }
            west = to;
        }
        if west < east {
            left.push([west, east]);
        }
    }
    left
}

#[cfg(test)]
mod tests;
