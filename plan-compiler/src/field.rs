//! A layer before packing: the cost and the advice of every cell.
//!
//! Arrays are row-major, row 0 in the south, `columns` cells a row. A cell's code says what
//! its look-up answers; its cost is [`UNREACHED`] unless the code is a move or the goal.

use crate::tolls::MOST;
use plan_format::grid::cost_metres;
use plan_format::layout::MAX_UNIT;
use plan_format::{Answer, Cell, Direction, Grid, Layer};

/// The cost of a cell without a route: blocked, or cut off from the goal.
pub const UNREACHED: u32 = u32::MAX;
/// Codes below this are a move: the code of its [`Direction`].
pub const MOVES: u8 = 8;
/// The goal itself.
pub const GOAL: u8 = 8;
/// A free cell without a route to the goal.
pub const NO_ROUTE: u8 = 9;
/// A blocked cell that no free cell with a route can be reached from.
pub const NO_ESCAPE: u8 = 10;
/// A blocked cell with an escape: this plus the code of its [`Direction`].
pub const ESCAPE: u8 = 16;

/// The cost and the advice of every cell of one layer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Field {
    /// Cells from west to east.
    pub columns: u32,
    /// Cells from south to north.
    pub rows: u32,
    /// If there are tolls, the unit of costs: they count 1/2^unit of 1/5741 cell.
    pub unit: Option<u8>,
    /// Cost to the goal, in units of 1/5741 cell; [`UNREACHED`] where there is no route.
    pub cost: Vec<u32>,
    /// The code of every cell: a move (0 to 7), [`GOAL`], [`NO_ROUTE`], [`NO_ESCAPE`] or
    /// [`ESCAPE`] plus a direction.
    pub code: Vec<u8>,
}

/// Whether a code belongs to a blocked cell.
pub const fn is_blocked(code: u8) -> bool {
    code >= NO_ESCAPE
}

/// The advised direction of a free cell with a route; `None` at the goal and elsewhere.
pub const fn advised(code: u8) -> Option<Direction> {
    if code < MOVES { Some(Direction::from_code(code)) } else { None }
}

/// The escape direction of a blocked cell; `None` if it has none or the cell is free.
pub const fn escape(code: u8) -> Option<Direction> {
    if code >= ESCAPE { Some(Direction::from_code(code - ESCAPE)) } else { None }
}

impl Field {
    /// What a step out of a cell is multiplied by, from the costs along the cell's move: 1 in every
    /// cell without tolls. `None` without a move, or if the costs contradict each other.
    pub fn multiplier(&self, cell: Cell) -> Option<u32> {
        let index = |cell: Cell| cell.row as usize * self.columns as usize + cell.column as usize;
        let direction = advised(*self.code.get(index(cell))?)?;
        let next = cell.neighbour(direction, self.columns, self.rows)?;
        let drop = self.cost.get(index(cell))?.checked_sub(*self.cost.get(index(next))?)?;
        let step = direction.step_cost();
        let multiplier = drop / step;
        let is_one = drop.is_multiple_of(step) && (1..=MOST).contains(&multiplier);
        is_one.then_some(multiplier)
    }
}

/// The factor of a cell of a layer in eighths, from the costs along the cell's move; `None` without a
/// move.
pub fn eighths_of(grid: &Grid, layer: &Layer<'_>, cell: Cell) -> Option<u32> {
    let Answer::Move { direction, cost } = layer.look_up_exact(cell) else { return None };
    let next = cell.neighbour(direction, grid.columns, grid.rows)?;
    let rest = match layer.look_up_exact(next) {
        Answer::Move { cost, .. } => cost,
        Answer::Goal => 0,
        _ => return None,
    };
    let multiplier = cost.checked_sub(rest)? / direction.step_cost();
    Some(multiplier << (MAX_UNIT - layer.unit()))
}

/// A cost of [`Layer::look_up_exact`], metres.
pub fn exact_metres(grid: &Grid, layer: &Layer<'_>, cost: u32) -> f64 {
    cost_metres(cost, grid.resolution_m) / f64::from(1_u32 << layer.unit())
}

/// All cells of a grid, row by row from the south.
pub(crate) fn cells(grid: &Grid) -> impl Iterator<Item = Cell> + use<> {
    all_cells(grid.columns, grid.rows)
}

/// All cells of a grid of this size, row by row from the south.
pub(crate) fn all_cells(columns: u32, rows: u32) -> impl Iterator<Item = Cell> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| Cell::new(column, row)))
}

/// Decodes a layer into arrays.
pub(crate) fn decode(grid: &Grid, layer: &Layer<'_>) -> Field {
    let (mut cost, mut code) = (Vec::with_capacity(grid.cells()), Vec::with_capacity(grid.cells()));
    for cell in cells(grid) {
        let (cell_cost, cell_code) = match layer.look_up_exact(cell) {
            Answer::Move { direction, cost } => (cost, direction.code()),
            Answer::Goal => (0, GOAL),
            Answer::NoRoute => (UNREACHED, NO_ROUTE),
            Answer::Blocked { escape: Some(direction) } => (UNREACHED, ESCAPE + direction.code()),
            Answer::Blocked { escape: None } | Answer::OffMap => (UNREACHED, NO_ESCAPE),
        };
        cost.push(cell_cost);
        code.push(cell_code);
    }
    let unit = layer.has_tolls().then(|| layer.unit());
    Field { columns: grid.columns, rows: grid.rows, unit, cost, code }
}
