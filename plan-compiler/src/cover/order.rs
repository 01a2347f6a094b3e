//! The order of strips: the strips of a part alternate, the nearest end of another part comes next,
//! and strips that fill gaps are driven where they cost the shortest detour.

use super::rows::is_open;
use super::strips::{INSET_M, Laid, Layout};
use super::{Ground, Strip, Transition, distance};
use crate::field::{Field, UNREACHED, advised};
use crate::search::{Corners, Query, Solver};
use crate::terrain::Terrain;
use maps::{Bitmap, Point};
use plan_format::Cell;
use plan_format::grid::cost_metres;

/// Where transitions between strips may lead.
#[derive(Clone, Copy, Debug)]
pub struct Passable<'g> {
    /// Inside the area.
    pub inside: &'g Ground,
    /// On the whole map.
    pub anywhere: &'g Ground,
}

/// A blocked straight line counts as this many times its length while strips are sorted in.
const DETOUR: f64 = 3.0;

/// The strips in order, and the transitions between them.
pub(super) fn order(
    layout: &Layout,
    passable: Passable<'_>,
    start: Point,
) -> (Vec<Strip>, Vec<Transition>) {
    let strip = |laid: &Laid| {
        let [from, to] = laid.span;
        let inset = INSET_M.min((to - from) / 2.0);
        let across = layout.rows.across_m(laid.row);
        let [from, to] = [from + inset, to - inset].map(|along| layout.rows.at([along, across]));
        Strip { from, to }
    };
    let parts = layout.parts.iter().map(|part| part.iter().map(strip).collect()).collect();
    let (inside, mut anywhere) = (passable.inside, Roads::of(passable.anywhere));
    let mut strips = nearest_part_next(parts, &mut anywhere, start);
    for gap in layout.gaps.iter().map(strip) {
        insert(&mut strips, gap, inside, start);
    }
    let mut inside = Roads::of(inside);
    let transitions = strips.windows(2).map(|pair| {
        let (from, to) = (pair[0].to, pair[1].from);
        let (route, leaves) = match inside.route(from, to) {
            Some(route) => (Some(route), false),
            None => (anywhere.route(from, to), true),
        };
        // Strips that no route connects are not laid: their ground is cut off.
        let (via, length_m) = route.unwrap_or((Vec::new(), distance(from, to)));
        Transition { via, length_m, leaves }
    });
    let transitions = transitions.collect();
    (strips, transitions)
}

/// The strips of all parts, each part from the end that is nearest when its turn comes.
fn nearest_part_next(
    mut parts: Vec<Vec<Strip>>,
    roads: &mut Roads<'_>,
    start: Point,
) -> Vec<Strip> {
    let (mut strips, mut at): (Vec<Strip>, Point) = (Vec::new(), start);
    while !parts.is_empty() {
        let field = roads.field(at);
        let choices = parts.iter().enumerate().flat_map(|(index, part)| {
            (0..4).map(move |variant| (index, variant, driven(part, variant)))
        });
        let lengths = choices.map(|(index, variant, part)| {
            let to = part.first().map_or(at, |first| first.from);
            (roads.length_m(&field, at, to), index, variant)
        });
        let nearest = lengths.min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, index, variant)) = nearest else { break };
        strips.extend(driven(&parts.swap_remove(index), variant));
        at = strips.last().map_or(at, |last| last.to);
    }
    strips
}

/// The strips of a part from one of its four ends, back and forth.
fn driven(part: &[Strip], variant: usize) -> Vec<Strip> {
    let mut strips = part.to_vec();
    if variant & 2 != 0 {
        strips.reverse();
    }
    for (strip, index) in strips.iter_mut().zip(variant & 1..) {
        if index % 2 == 1 {
            *strip = reversed(*strip);
        }
    }
    strips
}

fn reversed(strip: Strip) -> Strip {
    Strip { from: strip.to, to: strip.from }
}

/// Inserts a strip where it makes the sequence the least longer.
fn insert(strips: &mut Vec<Strip>, gap: Strip, ground: &Ground, start: Point) {
    let leg = |a: Point, b: Point| {
        let straight = distance(a, b);
        if straight < 2.0 * INSET_M || is_open(ground, a, b) { straight } else { DETOUR * straight }
    };
    let added = |at: usize, gap: &Strip| {
        let before = if at == 0 { start } else { strips[at - 1].to };
        let after = strips.get(at).map(|next| next.from);
        let direct = after.map_or(0.0, |after| leg(before, after));
        leg(before, gap.from) + after.map_or(0.0, |after| leg(gap.to, after)) - direct
    };
    let choices = (0..=strips.len()).flat_map(|at| [(at, gap), (at, reversed(gap))]);
    let best =
        choices.map(|(at, gap)| (added(at, &gap), at, gap)).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, at, gap)) = best {
        strips.insert(at, gap);
    }
}

/// Shortest routes over a ground.
pub(super) struct Roads<'g> {
    ground: &'g Ground,
    terrain: Terrain,
    solver: Solver,
}

impl<'g> Roads<'g> {
    pub(super) fn of(ground: &'g Ground) -> Self {
        let [columns, rows] = [ground.cells.columns(), ground.cells.rows()];
        let blocked = Bitmap::from_fn(columns, rows, |cell| !ground.cells.get(cell));
        Self { ground, terrain: Terrain::new(blocked), solver: Solver::new() }
    }

    /// The costs of all cells to a point.
    pub(super) fn field(&mut self, to: Point) -> Field {
        let mut field = Field::default();
        // A point off the map is reached from nowhere.
        let goal = self.ground.grid.cell_at(to[0], to[1]).unwrap_or(Cell::new(u32::MAX, u32::MAX));
        let query = Query { terrain: &self.terrain, goals: &[goal], corners: Corners::Forbid };
        self.solver.routes_into(&query, &mut field);
        field
    }

    /// Length of the route from a point to the goal of a field, metres; infinite without one.
    fn length_m(&self, field: &Field, goal: Point, from: Point) -> f64 {
        let grid = &self.ground.grid;
        let cost = grid.cell_at(from[0], from[1]).map(|cell| field.cost[grid.index(cell)]);
        match cost {
            Some(cost) if cost != UNREACHED => {
                cost_metres(cost, grid.resolution_m).max(distance(from, goal))
            }
            // Behind all that can be reached, the nearest first.
            _ => 1e9 + distance(from, goal),
        }
    }

    /// The turning points of the shortest route, and its length; `None` if there is none.
    fn route(&mut self, from: Point, to: Point) -> Option<(Vec<Point>, f64)> {
        if is_open(self.ground, from, to) {
            return Some((Vec::new(), distance(from, to)));
        }
        let (grid, field) = (self.ground.grid, self.field(to));
        let mut cell = grid.cell_at(from[0], from[1])?;
        let mut line = vec![from];
        while let Some(direction) = advised(field.code[grid.index(cell)]) {
            cell = cell.neighbour(direction, grid.columns, grid.rows)?;
            line.push(grid.centre(cell));
        }
        if field.cost[grid.index(cell)] != 0 {
            return None;
        }
        line.push(to);
        let via = self.pulled(&line);
        let all: Vec<Point> = [from].into_iter().chain(via.iter().copied()).chain([to]).collect();
        let length = all.windows(2).map(|leg| distance(leg[0], leg[1])).sum();
        Some((via, length))
    }

    /// The corners that are left of a line if every stretch is made straight that may be.
    fn pulled(&self, line: &[Point]) -> Vec<Point> {
        let (mut corners, mut at) = (Vec::new(), 0);
        while at + 1 < line.len() {
            let straight = |to: &usize| is_open(self.ground, line[at], line[*to]);
            let next = (at + 1..line.len()).rev().find(straight).unwrap_or(at + 1);
            if next + 1 < line.len() {
                corners.push(line[next]);
            }
            at = next;
        }
        corners
    }
}
