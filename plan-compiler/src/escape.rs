//! The way out of blocked cells, so that a robot whose position falls into an obstacle (a
//! poor fix, a coarse map) still gets an answer.
//!
//! The escape of a blocked cell is the first move of the cheapest way through blocked cells
//! to a free cell with a route: the same steps and costs as the search, no rule about
//! corners, ties as in the search. A blocked cell that cannot reach such a cell through
//! blocked cells alone has none.

use crate::bitmap::Bitmap;
use crate::search::Corners;
use crate::search::advice::{PREFERENCE, step_cost};
use crate::search::buckets::Queue;
use plan_format::field::{self, Field};
use plan_format::{Cell, Direction};

/// Fills in the codes of the blocked cells of a field whose free cells are done.
pub(crate) fn escape(queue: &mut Queue, blocked: &Bitmap, field: &mut Field) {
    let (columns, rows) = (field.columns, field.rows);
    let index = |cell: Cell| cell.row as usize * columns as usize + cell.column as usize;
    let neighbours = |cell: Cell| {
        PREFERENCE.into_iter().filter_map(move |direction| {
            cell.neighbour(direction, columns, rows).map(|to| (direction, to))
        })
    };
    let has_route = |cell: Cell| field.cost[index(cell)] != field::UNREACHED;
    let shores: Vec<(Cell, u32)> = blocked
        .iter()
        .filter_map(|cell| {
            let steps = neighbours(cell).filter(|&(_, to)| has_route(to));
            steps.map(|(direction, _)| step_cost(direction)).min().map(|cost| (cell, cost))
        })
        .collect();
    let mut cost = vec![field::UNREACHED; field.cost.len()];
    queue.spread(blocked, true, shores, Corners::Allow, &mut cost);
    let after = |cell: Cell| if has_route(cell) { 0 } else { cost[index(cell)] };
    let codes: Vec<(usize, u8)> = blocked
        .iter()
        .filter(|&cell| cost[index(cell)] != field::UNREACHED)
        .filter_map(|cell| {
            neighbours(cell)
                .find(|&(direction, to)| {
                    after(to).checked_add(step_cost(direction)) == Some(cost[index(cell)])
                })
                .map(|(direction, _): (Direction, _)| {
                    (index(cell), field::ESCAPE + direction.code())
                })
        })
        .collect();
    for (at, code) in codes {
        field.code[at] = code;
    }
}
