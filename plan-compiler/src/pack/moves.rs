//! The moves that the advice rule allows in every cell.

use crate::field::{Field, MOVES, UNREACHED};
use plan_format::grid::{Cell, Direction};

/// Bits of the diagonal directions in a set of moves.
const DIAGONALS: u8 = 0b1010_1010;

/// A field with a border of one unreached cell, so that every cell has eight neighbours.
pub(crate) struct Bordered {
    /// Cells in a row, border included.
    pub(crate) stride: usize,
    /// From the index of a cell to that of its neighbour in each direction.
    steps: [isize; 8],
    /// Cost of each cell.
    pub(crate) cost: Vec<u32>,
    /// Moves that minimise cost + step, one bit per direction code; only diagonal ones if there are
    /// any. Empty if a cell has no route, or if its cost is not the minimum over its neighbours,
    /// which cannot happen after a search.
    pub(crate) moves: Vec<u8>,
    /// What a step out of each cell is multiplied by; 0 where that is not known. Empty without tolls.
    pub(crate) multiplier: Vec<u32>,
}

impl Bordered {
    #[inline(always)]
    pub(crate) fn new(field: &Field) -> Self {
        let (columns, rows) = (field.columns as usize, field.rows as usize);
        let stride = columns + 2;
        let mut cost = vec![UNREACHED; stride * (rows + 2)];
        if columns > 0 {
            for (row, cells) in field.cost.chunks(columns).take(rows).enumerate() {
                let at = (row + 1) * stride + 1;
                cost[at..at + cells.len()].copy_from_slice(cells);
            }
        }
        let steps = Direction::ALL.map(|direction| {
            let (dx, dy) = direction.step();
            dy as isize * stride as isize + dx as isize
        });
        let (moves, multiplier) = (vec![0; stride * (rows + 2)], Vec::new());
        let mut bordered = Self { stride, steps, cost, moves, multiplier };
        let cuts_corners = bordered.cuts_corners(field);
        let is_tolled = field.unit.is_some();
        if is_tolled {
            bordered.find_multipliers(field);
        }
        for row in 0..rows {
            if is_tolled {
                bordered.find_tolled_moves(row, columns, cuts_corners);
            } else {
                bordered.find_moves(row, columns, cuts_corners);
            }
            bordered.keep_agreeing(field, row);
        }
        bordered
    }

    /// Index of a column and a row.
    #[inline(always)]
    pub(crate) fn index(&self, column: usize, row: usize) -> usize {
        (row + 1) * self.stride + column + 1
    }

    /// Index of a cell.
    #[inline(always)]
    pub(crate) fn index_of(&self, cell: Cell) -> usize {
        self.index(cell.column as usize, cell.row as usize)
    }

    /// Cells in a row, without the border.
    pub(crate) fn columns(&self) -> usize {
        self.stride - 2
    }

    /// Rows, without the border.
    pub(crate) fn rows(&self) -> usize {
        self.cost.len() / self.stride - 2
    }

    /// The index of a neighbour.
    #[inline(always)]
    pub(crate) fn neighbour(&self, index: usize, direction: Direction) -> usize {
        index.wrapping_add_signed(self.steps[usize::from(direction.code())])
    }

    /// Whether any move of the field cuts the corner of a cell without a cost; beside a cell with a
    /// route, such a cell is blocked. If no move does, moves that do not cut corners obey the rule
    /// that the field was made with, whichever it was.
    #[inline(always)]
    fn cuts_corners(&self, field: &Field) -> bool {
        let columns = field.columns.max(1) as usize;
        field.code.chunks(columns).take(field.rows as usize).enumerate().any(|(row, codes)| {
            let start = self.index(0, row);
            let mut cuts = false;
            for direction in Direction::ALL.into_iter().filter(|direction| direction.is_diagonal())
            {
                let code = direction.code();
                let [left, right] = [(code + 1) % 8, code - 1].map(|side| {
                    let side = self.neighbour(start, Direction::from_code(side));
                    &self.cost[side..side + codes.len()]
                });
                for ((&at, &left), &right) in codes.iter().zip(left).zip(right) {
                    cuts |= (at == code) & ((left == UNREACHED) | (right == UNREACHED));
                }
            }
            cuts
        })
    }

    /// Fills in the moves of one row, direction by direction, so that each is one plain loop.
    #[inline(always)]
    fn find_moves(&mut self, row: usize, columns: usize, cuts_corners: bool) {
        let start = self.index(0, row);
        let row_at = |index: usize| &self.cost[index..index + columns];
        let here = row_at(start);
        let around = Direction::ALL.map(|direction| row_at(self.neighbour(start, direction)));
        let moves = &mut self.moves[start..start + columns];
        for (direction, there) in Direction::ALL.into_iter().zip(around) {
            let (dx, dy) = direction.step();
            let beside = start.wrapping_add_signed(dx as isize);
            let above = start.wrapping_add_signed(dy as isize * self.stride as isize);
            let step = direction.step_cost();
            let bit = 1 << direction.code();
            let cells = moves.iter_mut().zip(here).zip(there);
            // Without short circuits, so that the compiler can vectorise the loop.
            let lowers =
                |cost: u32, there: u32| (there.wrapping_add(step) == cost) & (there < cost);
            if !direction.is_diagonal() || cuts_corners {
                for ((found, &cost), &there) in cells {
                    *found |= if lowers(cost, there) { bit } else { 0 };
                }
                continue;
            }
            // Straight steps between free cells are always allowed, so a neighbour of a cell with a
            // route is blocked exactly if it was not reached.
            for (((found, &cost), &there), (&beside, &above)) in
                cells.zip(row_at(beside).iter().zip(row_at(above)))
            {
                let clear = (beside != UNREACHED) & (above != UNREACHED);
                *found |= if lowers(cost, there) & clear { bit } else { 0 };
            }
        }
    }

    /// Fills in the multipliers from the field's own moves.
    fn find_multipliers(&mut self, field: &Field) {
        self.multiplier = vec![0; self.cost.len()];
        for row in 0..field.rows {
            for column in 0..field.columns {
                let cell = Cell::new(column, row);
                let index = self.index_of(cell);
                self.multiplier[index] = field.multiplier(cell).unwrap_or(0);
            }
        }
    }

    /// As [`Self::find_moves`], with steps that depend on the cell.
    #[inline(always)]
    fn find_tolled_moves(&mut self, row: usize, columns: usize, cuts_corners: bool) {
        let start = self.index(0, row);
        let cells = start..start + columns;
        for direction in Direction::ALL {
            let (dx, dy) = direction.step();
            let there = self.neighbour(start, direction);
            let beside = start.wrapping_add_signed(dx as isize);
            let above = start.wrapping_add_signed(dy as isize * self.stride as isize);
            let (step, bit) = (direction.step_cost(), 1 << direction.code());
            let needs_sides = direction.is_diagonal() && !cuts_corners;
            let costs = self.cost[cells.clone()].iter().zip(&self.cost[there..there + columns]);
            let sides =
                self.cost[beside..beside + columns].iter().zip(&self.cost[above..above + columns]);
            let known = costs.zip(sides).zip(&self.multiplier[cells.clone()]);
            let moves = self.moves[cells.clone()].iter_mut();
            for (found, (((&cost, &there), (&beside, &above)), &multiplier)) in moves.zip(known) {
                let lowers =
                    (there.wrapping_add(step.wrapping_mul(multiplier)) == cost) & (there < cost);
                let clear = !needs_sides | (beside != UNREACHED) & (above != UNREACHED);
                *found |= if lowers & clear { bit } else { 0 };
            }
        }
    }

    /// Drops straight moves if there are diagonal ones, and drops all moves if the field's own
    /// advice is not among them.
    #[inline(always)]
    fn keep_agreeing(&mut self, field: &Field, row: usize) {
        let start = self.index(0, row);
        let columns = field.columns as usize;
        let codes = field.code.get(row * columns..).unwrap_or_default();
        for (column, found) in self.moves[start..start + columns].iter_mut().enumerate() {
            if *found & DIAGONALS != 0 {
                *found &= DIAGONALS;
            }
            let code = codes.get(column).copied().unwrap_or(MOVES);
            if code >= MOVES || *found >> code & 1 == 0 {
                *found = 0;
            }
        }
    }
}
