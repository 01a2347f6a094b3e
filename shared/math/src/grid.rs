//! The cell grid: cells, the eight directions, and integer costs.

use crate::Vec2;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Cost of a step east, north, west or south. [`DIAGONAL_STEP`] divided by it is a Pell
/// convergent of the square root of two (relative error 1.5e-8). So costs are integers, ties
/// are exact and every order of relaxation gives the same field.
pub const STRAIGHT_STEP: u32 = 5741;
/// Cost of a diagonal step.
pub const DIAGONAL_STEP: u32 = 8119;

/// Cells along one side of the largest cell grid.
pub const MAX_SIDE_CELLS: u32 = 16_384;
/// Smallest and largest side of a cell, metres.
pub const RESOLUTION_RANGE_M: (f64, f64) = (0.001, 1_000.0);
/// Largest coordinate of a cell grid, metres from the map's origin. Single-precision positions
/// have a step of 8 mm there.
pub const MAX_COORDINATE_M: f64 = 100_000.0;

/// A cost to the goal in metres: `resolution x (a + b sqrt 2)` for a cost of `a` straight and
/// `b` diagonal steps.
///
/// ```
/// use math::grid::{DIAGONAL_STEP, STRAIGHT_STEP, cost_metres};
/// // Three steps straight and one diagonally, in cells of half a metre.
/// let cost_m = cost_metres(3 * STRAIGHT_STEP + DIAGONAL_STEP, 0.5);
/// assert!((cost_m - 0.5 * (3.0 + 2.0_f64.sqrt())).abs() < 1e-7);
/// ```
pub fn cost_metres(cost: u32, resolution_m: f64) -> f64 {
    f64::from(cost) / f64::from(STRAIGHT_STEP) * resolution_m
}

/// Cost of the shortest path of `dx` columns and `dy` rows without obstacles.
#[inline]
pub const fn octile(dx: u32, dy: u32) -> u32 {
    let (short, long) = if dx < dy { (dx, dy) } else { (dy, dx) };
    short * (DIAGONAL_STEP - STRAIGHT_STEP) + long * STRAIGHT_STEP
}

/// One of the eight directions that a layer can advise, in the order of their codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Direction {
    /// East, code 0.
    E = 0,
    /// North-east, code 1.
    NE = 1,
    /// North, code 2.
    N = 2,
    /// North-west, code 3.
    NW = 3,
    /// West, code 4.
    W = 4,
    /// South-west, code 5.
    SW = 5,
    /// South, code 6.
    S = 6,
    /// South-east, code 7.
    SE = 7,
}

impl Direction {
    /// All directions, in the order of their codes.
    pub const ALL: [Self; 8] =
        [Self::E, Self::NE, Self::N, Self::NW, Self::W, Self::SW, Self::S, Self::SE];

    /// The direction of a code; only the lowest three bits count.
    #[inline]
    pub const fn from_code(code: u8) -> Self {
        Self::ALL[(code & 7) as usize]
    }

    /// Code of the direction, 0 to 7.
    #[inline]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Columns and rows of one step.
    #[inline]
    pub const fn step(self) -> (i32, i32) {
        match self {
            Self::E => (1, 0),
            Self::NE => (1, 1),
            Self::N => (0, 1),
            Self::NW => (-1, 1),
            Self::W => (-1, 0),
            Self::SW => (-1, -1),
            Self::S => (0, -1),
            Self::SE => (1, -1),
        }
    }

    /// The direction of a step with these signs; `None` if both are 0.
    #[inline]
    pub const fn from_signs(dx: i32, dy: i32) -> Option<Self> {
        // A table, indexed by both signs modulo 4, is faster than branches: every tick calls
        // this.
        const BY_SIGNS: [Option<Direction>; 16] = {
            let mut table = [None; 16];
            let mut code = 0;
            while code < 8 {
                let direction = Direction::from_code(code);
                let (dx, dy) = direction.step();
                table[((dy & 3) << 2 | dx & 3) as usize] = Some(direction);
                code += 1;
            }
            table
        };
        // Fewer instructions than `signum`.
        const fn sign(number: i32) -> u32 {
            (number >> 31) as u32 | number.wrapping_neg() as u32 >> 31
        }
        BY_SIGNS[(sign(dy) << 2 & 12 | sign(dx) & 3) as usize]
    }

    /// Whether a step changes both column and row.
    #[inline]
    pub const fn is_diagonal(self) -> bool {
        self as u8 & 1 == 1
    }

    /// Cost of one step.
    #[inline]
    pub const fn step_cost(self) -> u32 {
        if self.is_diagonal() { DIAGONAL_STEP } else { STRAIGHT_STEP }
    }

    /// The opposite direction.
    #[inline]
    pub const fn reversed(self) -> Self {
        Self::from_code(self as u8 + 4)
    }

    /// Unit vector, x east, y north.
    pub const fn unit(self) -> Vec2 {
        const D: f32 = core::f32::consts::FRAC_1_SQRT_2;
        match self {
            Self::E => Vec2::new(1.0, 0.0),
            Self::NE => Vec2::new(D, D),
            Self::N => Vec2::new(0.0, 1.0),
            Self::NW => Vec2::new(-D, D),
            Self::W => Vec2::new(-1.0, 0.0),
            Self::SW => Vec2::new(-D, -D),
            Self::S => Vec2::new(0.0, -1.0),
            Self::SE => Vec2::new(D, -D),
        }
    }

    /// The direction's name: `E`, `NE` and so on.
    pub const fn name(self) -> &'static str {
        match self {
            Self::E => "E",
            Self::NE => "NE",
            Self::N => "N",
            Self::NW => "NW",
            Self::W => "W",
            Self::SW => "SW",
            Self::S => "S",
            Self::SE => "SE",
        }
    }
}

/// A cell by column (from the west) and row (from the south), each from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Cell {
    /// Column, from the west.
    pub column: u32,
    /// Row, from the south.
    pub row: u32,
}

impl Cell {
    /// The cell in a column and row.
    #[inline]
    pub const fn new(column: u32, row: u32) -> Self {
        Self { column, row }
    }

    /// Column in the low and row in the high half of a word, as the blob stores a root's cell.
    #[inline(always)]
    pub const fn to_word(self) -> u32 {
        self.column | self.row << 16
    }

    /// The cell of a word from [`Cell::to_word`].
    #[inline(always)]
    pub const fn of_word(word: u32) -> Self {
        Self::new(word & 0xffff, word >> 16)
    }

    /// The neighbour in a direction; `None` off a cell grid of this size.
    #[inline]
    pub const fn neighbour(self, direction: Direction, columns: u32, rows: u32) -> Option<Self> {
        let (dx, dy) = direction.step();
        let column = self.column.wrapping_add_signed(dx);
        let row = self.row.wrapping_add_signed(dy);
        if column < columns && row < rows { Some(Self { column, row }) } else { None }
    }
}

/// A cell grid: `cell = floor((position - corner) / resolution)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Grid {
    /// Cells from west to east, 1 ..= [`MAX_SIDE_CELLS`].
    pub columns: u32,
    /// Cells from south to north, 1 ..= [`MAX_SIDE_CELLS`].
    pub rows: u32,
    /// Side of a cell, metres.
    pub resolution_m: f64,
    /// South-west corner, map metres; may be negative.
    pub corner_m: [f64; 2],
}

impl Grid {
    /// Whether every number is within its limit.
    pub fn is_valid(&self) -> bool {
        let side = 1..=MAX_SIDE_CELLS;
        let reach = |corner: f64, cells: u32| {
            corner.abs().max((corner + f64::from(cells) * self.resolution_m).abs())
        };
        side.contains(&self.columns)
            && side.contains(&self.rows)
            && (RESOLUTION_RANGE_M.0..=RESOLUTION_RANGE_M.1).contains(&self.resolution_m)
            && reach(self.corner_m[0], self.columns) <= MAX_COORDINATE_M
            && reach(self.corner_m[1], self.rows) <= MAX_COORDINATE_M
    }

    /// Number of cells.
    #[inline]
    pub fn cells(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Index in a row-major array, row 0 in the south.
    #[inline]
    pub fn index(&self, cell: Cell) -> usize {
        cell.row as usize * self.columns as usize + cell.column as usize
    }

    /// The cell at a position (map metres); `None` off the map. Double precision, for the host;
    /// the robot's blob does the same in single precision.
    pub fn cell_at(&self, x: f64, y: f64) -> Option<Cell> {
        let column = crate::scalar::wide::floor((x - self.corner_m[0]) / self.resolution_m);
        let row = crate::scalar::wide::floor((y - self.corner_m[1]) / self.resolution_m);
        let inside = (0.0..f64::from(self.columns)).contains(&column)
            && (0.0..f64::from(self.rows)).contains(&row);
        inside.then(|| Cell::new(column as u32, row as u32))
    }

    /// The centre of a cell, map metres.
    pub fn centre(&self, cell: Cell) -> [f64; 2] {
        [
            self.corner_m[0] + (f64::from(cell.column) + 0.5) * self.resolution_m,
            self.corner_m[1] + (f64::from(cell.row) + 0.5) * self.resolution_m,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_signs_agree() {
        for (code, direction) in Direction::ALL.into_iter().enumerate() {
            assert_eq!(direction.code() as usize, code);
            let (dx, dy) = direction.step();
            assert_eq!(Direction::from_signs(dx * 7, dy * 7), Some(direction));
            assert_eq!(direction.reversed().step(), (-dx, -dy));
            assert!((crate::vector::length(direction.unit()) - 1.0).abs() < 1e-6);
        }
        assert_eq!(Direction::from_signs(0, 0), None);
    }

    #[test]
    fn cells_are_half_open() {
        let grid = Grid { columns: 20, rows: 10, resolution_m: 0.05, corner_m: [-0.5, 0.0] };
        assert_eq!(grid.cell_at(-0.5, 0.0), Some(Cell::new(0, 0)));
        assert_eq!(grid.cell_at(0.4999, 0.4999), Some(Cell::new(19, 9)));
        assert_eq!(grid.cell_at(0.5, 0.0), None);
        assert_eq!(grid.cell_at(0.0, -1e-9), None);
        assert_eq!(grid.cell_at(f64::NAN, 0.0), None);
    }
}
