//! The area that a team has seen (W, section 3): each robot senses three by three metres about its
//! position, less the obstacles.
//!
//! The area is counted in square cells. It is sampled along the motion, as the square of the paper,
//! whose sides stay parallel to the map's, and as a disc as wide as the square. A square sweeps up
//! to 41 % more ground along a diagonal, so the disc shows what of a difference is only that.

use crate::geometry::distance;
use crate::{Point, World};
use maps::{Extent, Shape};

/// Half the side of the square, and radius of the disc, metres (W, section 3).
const REACH_M: f64 = 1.5;
/// Side of a cell, metres.
const CELL_M: f64 = 0.25;
/// Distance between two samples of the motion, metres. Along a diagonal, a longer one misses corners.
const STEP_M: f64 = 0.1;

/// The ground of a map that robots can see: everything but its obstacles.
#[derive(Clone, Debug)]
pub struct Ground {
    corner: Point,
    columns: usize,
    rows: usize,
    /// Whether the centre of a cell is in an obstacle, row by row.
    blocked: Vec<bool>,
}

impl Ground {
    /// The ground of an area less these obstacles. A closed wall encloses no ground.
    pub fn new<'s>(extent: &Extent, obstacles: impl IntoIterator<Item = &'s Shape>) -> Self {
        let [columns, rows] = extent.size.map(|size| (size / CELL_M) as usize);
        let blocked = vec![false; columns * rows];
        let mut ground = Self { corner: extent.corner, columns, rows, blocked };
        obstacles.into_iter().for_each(|shape| ground.block(&filled(shape)));
        ground
    }

    fn block(&mut self, shape: &Shape) {
        let world = World::new([shape]);
        let Some([low, high]) = world.bounds() else { return };
        let [west, south] = [0, 1].map(|axis| self.index(axis, low[axis]));
        let [east, north] = [0, 1].map(|axis| self.index(axis, high[axis]));
        for row in south..=north.min(self.rows.saturating_sub(1)) {
            for column in west..=east.min(self.columns.saturating_sub(1)) {
                let cell = row * self.columns + column;
                self.blocked[cell] |= world.is_inside(self.centre(column, row));
            }
        }
    }

    /// The column or row of a coordinate; 0 outside.
    fn index(&self, axis: usize, metres: f64) -> usize {
        ((metres - self.corner[axis]) / CELL_M).max(0.0) as usize
    }

    fn centre(&self, column: usize, row: usize) -> Point {
        let [x, y] = self.corner;
        [x + (column as f64 + 0.5) * CELL_M, y + (row as f64 + 0.5) * CELL_M]
    }
}

/// A wall that ends where it begins is a building.
fn filled(shape: &Shape) -> Shape {
    match shape {
        Shape::Polyline(points) if points.len() > 3 && points.first() == points.last() => {
            Shape::Polygon(vec![points.clone()])
        }
        shape => shape.clone(),
    }
}

/// What a team has seen so far.
#[derive(Clone, Debug)]
pub struct Coverage<'g> {
    ground: &'g Ground,
    /// Bits of each cell: seen by a square, seen by a disc.
    seen: Vec<u8>,
    /// The last sample of each robot.
    last: Vec<Option<Point>>,
}

const SQUARE: u8 = 1;
const DISC: u8 = 2;

impl<'g> Coverage<'g> {
    /// Nothing is seen yet by any of the robots.
    pub fn new(ground: &'g Ground, robots: usize) -> Self {
        Self { ground, seen: vec![0; ground.blocked.len()], last: vec![None; robots] }
    }

    /// Sees what is about a robot's position, if it has moved far enough since its last sample.
    pub fn visit(&mut self, robot: usize, at: Point) {
        if self.last[robot].is_some_and(|last| distance(last, at) < STEP_M) {
            return;
        }
        self.last[robot] = Some(at);
        let ground = self.ground;
        let [west, south] = [0, 1].map(|axis| ground.index(axis, at[axis] - REACH_M));
        let [east, north] = [0, 1].map(|axis| ground.index(axis, at[axis] + REACH_M));
        for row in south..=north.min(ground.rows.saturating_sub(1)) {
            for column in west..=east.min(ground.columns.saturating_sub(1)) {
                let [x, y] = ground.centre(column, row);
                let (dx, dy) = ((x - at[0]).abs(), (y - at[1]).abs());
                let in_square = u8::from(dx <= REACH_M && dy <= REACH_M) * SQUARE;
                let in_disc = u8::from(dx * dx + dy * dy <= REACH_M * REACH_M) * DISC;
                self.seen[row * ground.columns + column] |= in_square | in_disc;
            }
        }
    }

    /// The area seen as squares, m^2.
    pub fn square_m2(&self) -> f64 {
        self.area_m2(SQUARE)
    }

    /// The area seen as discs, m^2.
    pub fn disc_m2(&self) -> f64 {
        self.area_m2(DISC)
    }

    fn area_m2(&self, bit: u8) -> f64 {
        let cells = self.seen.iter().zip(&self.ground.blocked);
        let seen = cells.filter(|&(seen, blocked)| seen & bit != 0 && !blocked).count();
        seen as f64 * CELL_M * CELL_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: Extent = Extent { corner: [-20.0, -20.0], size: [60.0, 60.0] };

    fn driven(ground: &Ground, ways: &[[Point; 2]]) -> [f64; 2] {
        let mut coverage = Coverage::new(ground, ways.len());
        for step in 0..=1_000 {
            let share = f64::from(step) / 1_000.0;
            for (robot, [from, to]) in ways.iter().enumerate() {
                let at = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
                coverage.visit(robot, at);
            }
        }
        [coverage.square_m2(), coverage.disc_m2()]
    }

    /// Ten metres straight and ten diagonally; two robots on one way see what one sees.
    #[test]
    fn a_way_covers_its_length_times_the_width() {
        let ground = Ground::new(&FIELD, []);
        let close = |found: [f64; 2], expected: [f64; 2]| {
            let is_close = |i: usize| (found[i] - expected[i]).abs() <= 0.04 * expected[i];
            assert!(is_close(0) && is_close(1), "{found:?} for {expected:?}");
        };
        let disc_m2 = std::f64::consts::PI * REACH_M * REACH_M;
        let east = [[0.0, 0.0], [10.0, 0.0]];
        close(driven(&ground, &[east]), [39.0, 30.0 + disc_m2]);
        close(driven(&ground, &[east, east]), [39.0, 30.0 + disc_m2]);
        // Not along the diagonals of the cells, whose centres would lie on the border.
        let side = 10.0 * std::f64::consts::FRAC_1_SQRT_2;
        let diagonal = [[0.06, 0.13], [0.06 + side, 0.13 + side]];
        close(driven(&ground, &[diagonal]), [30.0 * 1.414 + 9.0, 30.0 + disc_m2]);
        close(driven(&ground, &[east, [[0.0, 20.0], [10.0, 20.0]]]), [78.0, 60.0 + 2.0 * disc_m2]);
    }

    /// The square is cut in half by a building whose wall is the way, and by the edge of the map.
    #[test]
    fn obstacles_and_what_is_off_the_map_do_not_count() {
        let wall = vec![[-5.0, 0.0], [15.0, 0.0], [15.0, 9.0], [-5.0, 9.0], [-5.0, 0.0]];
        let building = Shape::Polyline(wall);
        let post = Shape::Circle { centre: [5.0, -1.0], radius: 0.5 };
        let way = [[0.0, 0.0], [10.0, 0.0]];
        let half = driven(&Ground::new(&FIELD, [&building]), &[way])[0];
        assert!((half - 19.5).abs() < 0.7, "{half}");
        let less = driven(&Ground::new(&FIELD, [&building, &post]), &[way])[0];
        assert!((half - less - 0.785).abs() < 0.1, "{half} {less}");
        let edge = driven(&Ground::new(&FIELD, []), &[[[0.0, -20.0], [10.0, -20.0]]])[0];
        assert!((edge - 19.5).abs() < 0.7, "{edge}");
    }
}
