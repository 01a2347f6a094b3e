//! Drawn maps, and their fields by a slow and readable search: the reference for the layers of a blob.

use plan_compiler::field::{ESCAPE, Field, GOAL, NO_ESCAPE, NO_ROUTE, UNREACHED};
use plan_format::{Answer, Cell, Direction, Layer, Step};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A map as a picture, north at the top: `.` free, `#` blocked, `G` the goal.
pub(super) struct Picture {
    pub(super) columns: u32,
    pub(super) rows: u32,
    pub(super) blocked: Vec<bool>,
    pub(super) goal: usize,
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for row in (0..self.rows as usize).rev() {
            let start = row * self.columns as usize;
            let sign = |index| match self.blocked[index] {
                true => '#',
                false if index == self.goal => 'G',
                false => '.',
            };
            writeln!(
                f,
                "{}",
                (start..start + self.columns as usize).map(sign).collect::<String>()
            )?;
        }
        Ok(())
    }
}

impl Picture {
    pub(super) fn of(lines: &[&str]) -> Self {
        let cells: Vec<u8> = lines.iter().rev().flat_map(|line| line.bytes()).collect();
        Self {
            columns: lines[0].len() as u32,
            rows: lines.len() as u32,
            blocked: cells.iter().map(|&cell| cell == b'#').collect(),
            goal: cells.iter().position(|&cell| cell == b'G').unwrap(),
        }
    }

    pub(super) fn cell(&self, index: usize) -> Cell {
        Cell::new(index as u32 % self.columns, index as u32 / self.columns)
    }

    fn neighbour(&self, index: usize, direction: Direction) -> Option<usize> {
        let cell = self.cell(index).neighbour(direction, self.columns, self.rows)?;
        Some((cell.row * self.columns + cell.column) as usize)
    }

    /// A step between free cells, by the rule of corners.
    fn step(&self, index: usize, direction: Direction, cut_corners: bool) -> Option<usize> {
        let to = self.neighbour(index, direction)?;
        let (dx, dy) = direction.step();
        let beside = |dx, dy| {
            let side = Direction::from_signs(dx, dy).and_then(|side| self.neighbour(index, side));
            side.is_some_and(|side| !self.blocked[side])
        };
        let clear = cut_corners || !direction.is_diagonal() || beside(dx, 0) && beside(0, dy);
        (clear && !self.blocked[to]).then_some(to)
    }

    /// The field of the picture by a slow and readable search: Dijkstra with a heap.
    pub(super) fn field(&self, cut_corners: bool) -> Field {
        let cost = self
            .spread(vec![self.goal], |index, direction| self.step(index, direction, cut_corners));
        let routed = (0..cost.len()).filter(|&index| cost[index] != UNREACHED).collect();
        let escape = self.spread(routed, |index, direction| {
            self.neighbour(index, direction).filter(|&to| self.blocked[to])
        });
        // Diagonal steps before straight ones, as the advice rule has it.
        let order = [1, 3, 5, 7, 0, 2, 4, 6].map(Direction::from_code);
        let downhill = |index: usize, cost: &[u32], to: &dyn Fn(Direction) -> Option<usize>| {
            order.into_iter().find(|&direction| {
                to(direction).is_some_and(|to| {
                    cost[to].checked_add(direction.step_cost()) == Some(cost[index])
                })
            })
        };
        let code = (0..cost.len()).map(|index| match () {
            () if self.blocked[index] => {
                let way = downhill(index, &escape, &|direction| self.neighbour(index, direction));
                way.map_or(NO_ESCAPE, |direction| ESCAPE + direction.code())
            }
            () if index == self.goal => GOAL,
            () => downhill(index, &cost, &|direction| self.step(index, direction, cut_corners))
                .map_or(NO_ROUTE, Direction::code),
        });
        Field { columns: self.columns, rows: self.rows, unit: None, code: code.collect(), cost }
    }

    /// Uniform-cost search from several cells.
    fn spread(
        &self,
        from: Vec<usize>,
        step: impl Fn(usize, Direction) -> Option<usize>,
    ) -> Vec<u32> {
        let mut cost = vec![UNREACHED; self.blocked.len()];
        let mut open = BinaryHeap::new();
        for index in from {
            cost[index] = 0;
            open.push(Reverse((0, index)));
        }
        while let Some(Reverse((reached, index))) = open.pop() {
            for direction in Direction::ALL {
                let Some(to) = step(index, direction) else { continue };
                let next = reached + direction.step_cost();
                if reached == cost[index] && next < cost[to] {
                    cost[to] = next;
                    open.push(Reverse((next, to)));
                }
            }
        }
        cost
    }

    /// Every look-up against the field: the same, but for the choice that the advice rule leaves.
    pub(super) fn check(&self, field: &Field, layer: &Layer<'_>, cut_corners: bool) {
        for index in 0..field.cost.len() {
            let answer = layer.look_up(self.cell(index));
            assert_eq!(layer.step(self.cell(index)), step_of(answer), "cell {index}");
            let expected = answer_of(field, index);
            let (Answer::Move { direction, cost }, Answer::Move { direction: given, .. }) =
                (answer, expected)
            else {
                assert_eq!(answer, expected, "cell {index}");
                continue;
            };
            assert_eq!(cost, field.cost[index], "cost of cell {index}");
            assert_eq!(direction.is_diagonal(), given.is_diagonal(), "advice in cell {index}");
            let to = self.step(index, direction, cut_corners).expect("a step that is allowed");
            assert_eq!(field.cost[to] + direction.step_cost(), cost, "step from cell {index}");
        }
    }
}

/// The expected answer for a cell of a field.
pub(super) fn answer_of(field: &Field, index: usize) -> Answer {
    match field.code[index] {
        code @ 0..GOAL => {
            Answer::Move { direction: Direction::from_code(code), cost: field.cost[index] }
        }
        GOAL => Answer::Goal,
        NO_ROUTE => Answer::NoRoute,
        NO_ESCAPE => Answer::Blocked { escape: None },
        code => Answer::Blocked { escape: Some(Direction::from_code(code)) },
    }
}

/// An answer without its cost.
fn step_of(answer: Answer) -> Step {
    match answer {
        Answer::Move { direction, .. } => Step::Move(direction),
        Answer::Goal => Step::Goal,
        Answer::NoRoute => Step::NoRoute,
        Answer::Blocked { escape } => Step::Blocked { escape },
        Answer::OffMap => Step::OffMap,
    }
}
