//! Proves a blob again, cell by cell, without trusting the program that made it.
//!
//! It proves for every layer:
//! - The goals that are free, and no other cells, cost nothing.
//! - Every other free cell with a route advises a legal step to a free cell whose cost is lower by
//!   exactly that step. So following the advice reaches a goal at the stated cost.
//! - No legal step leads to a cell from which a goal would be cheaper. So, by induction along a
//!   best path, the stated cost is the least.
//! - Among equal steps, a diagonal comes before a straight one.
//! - Of several goals, a cell names the one that the cell names to which its advised step leads, and the
//!   cell of a goal that goal. So a cell names the goal that following the advice from it reaches.
//! - A free cell without a route has no legal step to a cell with a route.
//! - A blocked cell's escape is the first step of a shortest way out, found here by a plain Dijkstra
//!   search.
//! - The layer blocks every cell that the layer below it blocks.
//! - If it has tolls: what the advised step lowers the cost by is its length times a factor from 1 to
//!   32, and "lower by exactly that step" holds for all other steps with the same factor. So the blob
//!   need not record the factors. They must be the same in all plans that have the layer, and at least
//!   those of the layer below; and a speed limit at most that of the layer below.
//!
//! The blob does not record the corner rule. If any advised step cuts a corner, the rule is `allow`.
//! If none does, the field is the same under both rules: a best step that cuts a corner would be
//! diagonal, so it would have come before a straight one, and the proof has compared the cost of
//! every diagonal.
//!
//! Deliberately absent: the compiler's search.

use crate::compile::Progress;
use crate::field::{Field, GOAL, NO_ESCAPE, NO_ROUTE, UNREACHED};
use crate::field::{advised, all_cells, cells, decode, escape, is_blocked};
use crate::layers::Stack;
use crate::search::Corners;
use crate::terrain::Terrain;
use crate::tolls::{LEAST, MOST};
use maps::Bitmap;
use plan_format::layout::MAX_UNIT;
use plan_format::{Answer, Blob, Cell, Direction, Grid, Layer};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// What a proof covered, and what it found wrong.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Number of layers checked.
    pub layers: usize,
    /// Number of cells checked, all layers together.
    pub cells: usize,
    /// Whether any advised step cuts a corner; if so, all layers were proved under that rule.
    pub cuts_corners: bool,
    /// The first violations of every layer.
    pub violations: Vec<Violation>,
    /// Number of all violations, listed or not.
    pub count: usize,
}

/// A cell that breaks a rule of the proof.
#[derive(Clone, Debug)]
pub struct Violation {
    /// `PLAN/LAYER`.
    pub layer: String,
    /// Which cell.
    pub cell: Cell,
    /// Its centre, metres.
    pub at: [f64; 2],
    /// What is wrong with it.
    pub what: String,
}

/// Number of violations that are listed for each layer.
const LISTED: usize = 3;

/// Proves every cell of every layer. `progress` gets the layers done and the layers in all.
pub fn verify(blob: &Blob<'_>, progress: Progress<'_>) -> Report {
    let corners = if cuts_corners(blob) { Corners::Allow } else { Corners::Forbid };
    verify_by(blob, corners, progress)
}

/// As [`verify`], for plans that keep this rule for corners.
pub fn verify_by(blob: &Blob<'_>, corners: Corners, progress: Progress<'_>) -> Report {
    let grid = blob.grid();
    let all = blob.parallel_plans().map(|parallel| parallel.layer_count()).sum();
    progress(0, all);
    let mut report = Report { cuts_corners: corners == Corners::Allow, ..Report::default() };
    // The factors of each layer, in eighths, where any plan has shown them; else 0.
    let mut known: HashMap<&str, Vec<u16>> = HashMap::new();
    for parallel in blob.parallel_plans() {
        let goals: Vec<Option<Cell>> =
            parallel.goals_m().map(|[x, y]| grid.cell_at(x, y)).collect();
        let cells: Vec<Cell> = goals.iter().copied().flatten().collect();
        let mut below: Option<(Terrain, Layer<'_>, Vec<u16>)> = None;
        for layer in parallel.layers() {
            let field = decode(grid, &layer);
            let name = format!("{}/{}", parallel.name(), layer.name());
            let (terrain, factors) = (terrain(&field), factors(&field));
            let mut found = Findings { report: &mut report, grid, layer: &name, listed: 0 };
            if let Some((below, lower, least)) = &below {
                check_nesting(below, &terrain, &mut found);
                check_tolls_nest((lower, least), (&layer, &factors), &mut found);
            }
            let known = known.entry(layer.name()).or_insert_with(|| vec![0; factors.len()]);
            check_factors(known, &factors, &mut found);
            Proof { field: &field, goals: &cells, corners }.check(&mut found);
            if goals.len() > 1 {
                check_numbers(&layer, &goals, &mut found);
            }
            report.layers += 1;
            report.cells += grid.cells();
            below = Some((terrain, layer, factors));
            progress(report.layers, all);
        }
    }
    report
}

/// Compares the blocked cells, the tolls and the speed limits of every layer with those of a map's
/// layer of the same name.
pub fn compare(blob: &Blob<'_>, expected: &Stack) -> Report {
    let grid = blob.grid();
    let mut report = Report::default();
    for parallel in blob.parallel_plans() {
        for layer in parallel.layers() {
            let name = format!("{}/{}", parallel.name(), layer.name());
            let mut found = Findings { report: &mut report, grid, layer: &name, listed: 0 };
            let expected = expected.layers().iter().find(|expected| expected.name == layer.name());
            let Some(expected) = expected else {
                found.add(Cell::new(0, 0), "the map and its mission have no such layer");
                continue;
            };
            let factors = factors(&decode(grid, &layer));
            for (cell, factor) in cells(grid).zip(factors) {
                let blocked = matches!(layer.look_up(cell), Answer::Blocked { .. });
                match (blocked, expected.terrain.blocked.get(cell)) {
                    (true, false) => found.add(cell, "blocked, but free in the map"),
                    (false, true) => found.add(cell, "free, but blocked in the map"),
                    (true, true) => {}
                    (false, false) => check_toll(&layer, cell, factor, expected, &mut found),
                }
            }
            report.layers += 1;
            report.cells += grid.cells();
        }
    }
    report
}

/// Compares the toll and the speed limit of a free cell with those of a map.
fn check_toll(
    layer: &Layer<'_>,
    cell: Cell,
    factor: u16,
    expected: &crate::layers::Layer,
    found: &mut Findings<'_>,
) {
    let tolls = expected.terrain.tolls.as_ref();
    let wanted = tolls.map_or(LEAST, |tolls| tolls.eighths(cell)) as u16;
    if factor != 0 && factor != wanted {
        let (here, there) = (factor_text(factor), factor_text(wanted));
        found.add(cell, format!("has a toll of {here}, but of {there} in the map"));
    }
    let limit = layer.speed_limit(cell);
    let wanted = expected.limits.at(cell).map(|limit| f32::from(limit) / 100.0);
    if limit != wanted {
        let text = |limit: Option<f32>| limit.map_or("none".into(), |limit| format!("{limit} m/s"));
        let (here, there) = (text(limit), text(wanted));
        found.add(cell, format!("has a speed limit of {here}, but of {there} in the map"));
    }
}

/// Gathers what is wrong with one layer.
struct Findings<'r> {
    report: &'r mut Report,
    grid: &'r Grid,
    layer: &'r str,
    listed: usize,
}

impl Findings<'_> {
    fn add(&mut self, cell: Cell, what: impl Into<String>) {
        self.report.count += 1;
        if self.listed < LISTED {
            self.listed += 1;
            let at = self.grid.centre(cell);
            let (layer, what) = (self.layer.to_owned(), what.into());
            self.report.violations.push(Violation { layer, cell, at, what });
        }
    }
}

fn terrain(field: &Field) -> Terrain {
    let mut codes = field.code.iter();
    let is_blocked = |_| codes.next().is_some_and(|&code| is_blocked(code));
    Terrain::new(Bitmap::from_fn(field.columns, field.rows, is_blocked))
}

/// Whether any advised step passes a blocked cell beside it.
fn cuts_corners(blob: &Blob<'_>) -> bool {
    let grid = blob.grid();
    let is_blocked = |layer: &Layer<'_>, cell: Option<Cell>| {
        cell.is_some_and(|cell| matches!(layer.look_up(cell), Answer::Blocked { .. }))
    };
    blob.parallel_plans().flat_map(|parallel| parallel.layers()).any(|layer| {
        cells(grid).any(|cell| match layer.look_up(cell) {
            Answer::Move { direction, .. } if direction.is_diagonal() => beside(direction)
                .into_iter()
                .any(|side| is_blocked(&layer, cell.neighbour(side, grid.columns, grid.rows))),
            _ => false,
        })
    })
}

/// The two straight directions beside a diagonal one.
fn beside(diagonal: Direction) -> [Direction; 2] {
    [Direction::from_code(diagonal.code() + 7), Direction::from_code(diagonal.code() + 1)]
}

/// The factor of each cell in eighths, from the costs along its move; 0 if it has none.
fn factors(field: &Field) -> Vec<u16> {
    let shift = MAX_UNIT - field.unit.unwrap_or(0);
    let all = all_cells(field.columns, field.rows);
    all.map(|cell| field.multiplier(cell).map_or(0, |toll| (toll << shift) as u16)).collect()
}

fn factor_text(eighths: u16) -> f32 {
    f32::from(eighths) / LEAST as f32
}

/// Compares the factors of a layer with those that other plans have shown, and adds them.
fn check_factors(known: &mut [u16], factors: &[u16], found: &mut Findings<'_>) {
    for ((cell, known), &factor) in cells(found.grid).zip(known).zip(factors) {
        if factor == 0 || *known == factor {
            continue;
        }
        if *known != 0 {
            let (here, there) = (factor_text(factor), factor_text(*known));
            found.add(cell, format!("has a toll of {here}, but of {there} in another plan"));
        }
        *known = factor;
    }
}

/// Checks that tolls and speed limits are at least as strict as in the layer below.
fn check_tolls_nest(
    (below, least): (&Layer<'_>, &[u16]),
    (layer, factors): (&Layer<'_>, &[u16]),
    found: &mut Findings<'_>,
) {
    for ((cell, &factor), &least) in cells(found.grid).zip(factors).zip(least) {
        if factor != 0 && factor < least {
            let (here, there) = (factor_text(factor), factor_text(least));
            found.add(cell, format!("has a toll of {here}, but of {there} in the layer below"));
        }
        let highest = below.speed_limit(cell);
        if highest.is_some_and(|highest| layer.speed_limit(cell).is_none_or(|l| l > highest)) {
            found.add(cell, "has a higher speed limit than the layer below");
        }
    }
}

fn check_nesting(below: &Terrain, terrain: &Terrain, found: &mut Findings<'_>) {
    if terrain.nests_in(below) {
        return;
    }
    for cell in terrain.gaps(below) {
        found.add(cell, "free, but blocked in the layer below");
    }
}

/// Checks that each cell with a route names the goal to which its advice leads.
fn check_numbers(layer: &Layer<'_>, goals: &[Option<Cell>], found: &mut Findings<'_>) {
    let grid = found.grid;
    for cell in cells(grid) {
        let number = layer.goal_number(cell);
        match layer.look_up(cell) {
            Answer::Move { direction, .. } => {
                let next = cell.neighbour(direction, grid.columns, grid.rows);
                let next = next.map(|next| layer.goal_number(next));
                if next.is_some_and(|next| next != number) {
                    found.add(cell, "its goal is not that of its advised step");
                }
            }
            // Of several goals in one cell, the first.
            Answer::Goal
                if goals.iter().position(|&at| at == Some(cell)) != Some(number.into()) =>
            {
                found.add(cell, "names another goal than its own");
            }
            _ => {}
        }
    }
}

/// The proof of one layer.
struct Proof<'f> {
    field: &'f Field,
    goals: &'f [Cell],
    corners: Corners,
}

impl Proof<'_> {
    fn check(&self, found: &mut Findings<'_>) {
        let ways_out = self.ways_out();
        for cell in cells(found.grid) {
            if let Err(what) = self.check_cell(cell, &ways_out) {
                found.add(cell, what);
            }
        }
    }

    fn check_cell(&self, cell: Cell, ways_out: &[u32]) -> Result<(), String> {
        let code = self.code(cell);
        if is_blocked(code) {
            return self.check_escape(cell, ways_out);
        }
        if (code == GOAL) != self.goals.contains(&cell) {
            return Err("the goal is not where the plan says".into());
        }
        let cost = self.cost(cell);
        let has_cost = if code == GOAL { cost == 0 } else { cost != UNREACHED };
        if has_cost != (code != NO_ROUTE) {
            return Err("its cost and its advice disagree".into());
        }
        let advised_step = self.advised_step(cell, code)?;
        // The goal is never left.
        let toll = advised_step.map_or(1, |(_, toll)| toll);
        for direction in Direction::ALL {
            let Some(next) = self.step(cell, direction) else { continue };
            let through = self.cost(next).checked_add(direction.step_cost() * toll);
            let Some(through) = through.filter(|_| self.cost(next) != UNREACHED) else { continue };
            let is_advised_diagonal = advised(code).is_none_or(Direction::is_diagonal);
            if through < cost {
                let name = direction.name();
                return Err(format!("costs {cost}, but a step {name} would cost {through}"));
            } else if through == cost && direction.is_diagonal() && !is_advised_diagonal {
                return Err(format!("a diagonal step {} is as good", direction.name()));
            }
        }
        Ok(())
    }

    /// The step that a cell's code advises, which must be legal, and what the cell multiplies steps
    /// by: it follows from what the step lowers the cost by.
    fn advised_step(&self, cell: Cell, code: u8) -> Result<Option<(Direction, u32)>, String> {
        let Some(direction) = advised(code) else { return Ok(None) };
        let name = direction.name();
        self.step(cell, direction).ok_or_else(|| format!("no step {name} is legal"))?;
        let allowed = match self.field.unit {
            None => 1..=1,
            Some(unit) => 1 << unit..=MOST >> (MAX_UNIT - unit),
        };
        let toll = self.field.multiplier(cell).filter(|toll| allowed.contains(toll));
        let toll = toll.ok_or_else(|| {
            format!("a step {name} does not lower the cost {} by its own cost", self.cost(cell))
        })?;
        Ok(Some((direction, toll)))
    }

    fn check_escape(&self, cell: Cell, ways_out: &[u32]) -> Result<(), String> {
        let way_out = self.at(ways_out, cell);
        let Some(direction) = escape(self.code(cell)) else {
            let closed = way_out == UNREACHED;
            return if closed { Ok(()) } else { Err("blocked without an escape".into()) };
        };
        let next = cell.neighbour(direction, self.field.columns, self.field.rows);
        let through = next
            .map(|next| self.at(ways_out, next))
            .and_then(|rest| rest.checked_add(direction.step_cost()));
        if way_out != UNREACHED && through == Some(way_out) {
            Ok(())
        } else {
            Err(format!("the escape {} is not on a shortest way out", direction.name()))
        }
    }

    /// The cost of the shortest way out of every blocked cell, through blocked cells and
    /// without a corner rule, to a free cell with a route; 0 in those.
    fn ways_out(&self) -> Vec<u32> {
        let (columns, rows) = (self.field.columns, self.field.rows);
        let has_route = |&cost: &u32| if cost == UNREACHED { UNREACHED } else { 0 };
        let mut least: Vec<u32> = self.field.cost.iter().map(has_route).collect();
        let mut queue = BinaryHeap::new();
        let all = all_cells(columns, rows);
        // Only cells beside a blocked one can be the end of a way out.
        let starts = all.filter(|&cell| self.at(&least, cell) == 0).filter(|cell| {
            let mut around = Direction::ALL.iter();
            around.any(|&d| cell.neighbour(d, columns, rows).is_some_and(|n| self.blocks(n)))
        });
        queue.extend(starts.map(|cell| Reverse((0_u32, cell))));
        while let Some(Reverse((cost, cell))) = queue.pop() {
            if cost > self.at(&least, cell) {
                continue;
            }
            for direction in Direction::ALL {
                let Some(next) = cell.neighbour(direction, columns, rows) else { continue };
                let through = cost.saturating_add(direction.step_cost());
                if self.blocks(next) && through < self.at(&least, next) {
                    least[self.index(next)] = through;
                    queue.push(Reverse((through, next)));
                }
            }
        }
        least
    }

    /// The cell that a legal step leads to.
    fn step(&self, cell: Cell, direction: Direction) -> Option<Cell> {
        let neighbour = |direction| cell.neighbour(direction, self.field.columns, self.field.rows);
        let next = neighbour(direction).filter(|&next| !self.blocks(next))?;
        let cuts = direction.is_diagonal()
            && beside(direction).into_iter().any(|d| neighbour(d).is_none_or(|c| self.blocks(c)));
        (self.corners == Corners::Allow || !cuts).then_some(next)
    }

    fn index(&self, cell: Cell) -> usize {
        cell.row as usize * self.field.columns as usize + cell.column as usize
    }

    fn at(&self, costs: &[u32], cell: Cell) -> u32 {
        costs.get(self.index(cell)).copied().unwrap_or(UNREACHED)
    }

    fn cost(&self, cell: Cell) -> u32 {
        self.at(&self.field.cost, cell)
    }

    fn code(&self, cell: Cell) -> u8 {
        self.field.code.get(self.index(cell)).copied().unwrap_or(NO_ESCAPE)
    }

    fn blocks(&self, cell: Cell) -> bool {
        is_blocked(self.code(cell))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::ESCAPE;
    use crate::search::{Query, solve};

    /// What the proof says of a field.
    fn check(field: &Field, goal: Cell, corners: Corners) -> Vec<String> {
        let (columns, rows) = (field.columns, field.rows);
        let grid = Grid { columns, rows, resolution_m: 1.0, corner_m: [0.0, 0.0] };
        let mut report = Report::default();
        let mut found = Findings { report: &mut report, grid: &grid, layer: "a/b", listed: 0 };
        Proof { field, goals: &[goal], corners }.check(&mut found);
        assert!(report.count >= report.violations.len());
        report.violations.into_iter().map(|violation| violation.what).collect()
    }

    /// A free, a blocked and a walled-in part; `#` is blocked, row 0 at the bottom.
    fn room() -> Terrain {
        let rows = [
            "..........",
            ".###..###.",
            ".#.#..#...",
            ".###.##...",
            "....#.....",
            "..........",
            "######....",
            ".....#....",
        ];
        let at =
            |cell: Cell| rows[rows.len() - 1 - cell.row as usize].as_bytes()[cell.column as usize];
        Terrain::new(Bitmap::from_fn(10, 8, |cell| at(cell) == b'#'))
    }

    #[test]
    fn right_fields_are_proved() {
        for corners in [Corners::Forbid, Corners::Allow] {
            for goal in [Cell::new(0, 7), Cell::new(9, 0), Cell::new(5, 3), Cell::new(0, 0)] {
                let field = solve(&Query { terrain: &room(), goals: &[goal], corners });
                assert_eq!(check(&field, goal, corners), [""; 0]);
            }
        }
    }

    #[test]
    fn a_field_is_wrong_by_the_other_rule() {
        let goal = Cell::new(0, 7);
        let field = solve(&Query { terrain: &room(), goals: &[goal], corners: Corners::Allow });
        assert_ne!(check(&field, goal, Corners::Forbid), [""; 0]);
    }

    #[test]
    fn every_change_of_any_cell_is_found() {
        let goal = Cell::new(9, 7);
        let right = solve(&Query { terrain: &room(), goals: &[goal], corners: Corners::Forbid });
        for index in 0..right.code.len() {
            for code in (0..=NO_ESCAPE).chain(ESCAPE..ESCAPE + 8) {
                let mut wrong = right.clone();
                wrong.code[index] = code;
                let found = check(&wrong, goal, Corners::Forbid);
                // Another obstacle is another map; whether it is the right one, only a
                // comparison with that map tells. Another move may be as good.
                if is_blocked(code) != is_blocked(right.code[index]) {
                    continue;
                }
                let cell = Cell::new(index as u32 % 10, index as u32 / 10);
                let as_good = advised(code).is_some_and(|direction| {
                    let next = cell.neighbour(direction, 10, 8).map(|c| c.row * 10 + c.column);
                    let rest = next.and_then(|next| right.cost.get(next as usize)).copied();
                    rest.and_then(|rest| rest.checked_add(direction.step_cost()))
                        == Some(right.cost[index])
                });
                let tie = as_good || escape(code).is_some();
                assert!(code == right.code[index] || tie || !found.is_empty(), "{index} {code}");
            }
            for change in [-1_i64, 1, 5741] {
                let cost = i64::from(right.cost[index]) + change;
                let Ok(cost) = u32::try_from(cost) else { continue };
                let mut wrong = right.clone();
                wrong.cost[index] = cost;
                let found = check(&wrong, goal, Corners::Forbid);
                assert!(is_blocked(right.code[index]) || !found.is_empty(), "{index} {change}");
            }
        }
    }
}
