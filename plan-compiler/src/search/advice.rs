//! From costs to directions: for every cell an optimal first move.

use super::{Corners, step};
use crate::bitmap::Bitmap;
use plan_format::field::{self, Field};
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::{Cell, Direction};

/// The order in which equally good moves are preferred: a diagonal before a straight one (the
/// paper's "minimal adjacent cell"), else this order.
pub(crate) const PREFERENCE: [Direction; 8] = [
    Direction::NE,
    Direction::NW,
    Direction::SW,
    Direction::SE,
    Direction::E,
    Direction::N,
    Direction::W,
    Direction::S,
];

/// What a step in a direction costs.
pub(crate) fn step_cost(direction: Direction) -> u32 {
    if direction.code().is_multiple_of(2) { STRAIGHT_STEP } else { DIAGONAL_STEP }
}

/// Fills in the codes of a field whose costs are done.
pub(super) fn advise(blocked: &Bitmap, corners: Corners, field: &mut Field) {
    let index = |cell: Cell| cell.row as usize * field.columns as usize + cell.column as usize;
    for row in 0..field.rows {
        for column in 0..field.columns {
            let cell = Cell::new(column, row);
            let at = index(cell);
            field.code[at] = match field.cost[at] {
                _ if blocked.get(cell) => field::NO_ESCAPE,
                field::UNREACHED => field::NO_ROUTE,
                0 => field::GOAL,
                cost => PREFERENCE
                    .into_iter()
                    .find(|&direction| {
                        step(blocked, cell, direction, corners).is_some_and(|to| {
                            field.cost[index(to)].checked_add(step_cost(direction)) == Some(cost)
                        })
                    })
                    .map_or(field::NO_ROUTE, Direction::code),
            };
        }
    }
}
