//! The route that a layer's advice gives from a point.
//!
//! It is the route of a robot that follows the advice only: from the centre of a cell to the centre
//! of the next one. Inside an obstacle it follows the escape.

use advice::{Choice, Kind, advise};
use maps::Point;
use plan_format::grid::cost_metres;
use plan_format::parameters::Selection;
use plan_format::{Answer, Grid, Layer, ParallelPlan};

/// A route to the goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// The start, the centres of the cells on the route, and the goal, metres.
    pub points: Vec<Point>,
    /// Length from the centre of the first cell to the centre of the goal's cell, metres.
    pub length_m: f64,
    /// The number of the goal among those of its plan.
    pub goal: u8,
}

/// Why there is no route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRoute {
    /// The start is off the map.
    OffMap,
    /// The layer has no route from the start.
    Unreachable,
    /// The advice leads in a circle or off the map: the blob differs from what the compiler wrote.
    Astray,
}

impl std::fmt::Display for NoRoute {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::OffMap => "it is off the map",
            Self::Unreachable => "obstacles separate it from the goal",
            Self::Astray => "the advice does not lead to the goal",
        })
    }
}

/// A part of a route on which a robot follows one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// The layer's index in its plan, 0 for the least constrained.
    pub layer: u8,
    /// Centres of cells, metres; its first point is the last one of the stretch before.
    pub points: Vec<Point>,
    /// Its length, metres.
    pub length_m: f64,
}

/// Follows the advice of a plan from a point to the goal, with the layer that the robot would choose
/// in each cell.
pub fn choose(
    grid: &Grid,
    parallel: &ParallelPlan<'_>,
    selection: Selection,
    start: Point,
) -> Result<Vec<Stretch>, NoRoute> {
    let mut cell = grid.cell_at(start[0], start[1]).ok_or(NoRoute::OffMap)?;
    let (mut choice, mut at) = (Choice::default(), start);
    let mut stretches: Vec<Stretch> = Vec::new();
    // Where layers are chosen again in each cell, a route may pass a cell once for each.
    for _ in 0..grid.cells() * parallel.layer_count().max(1) {
        let advice = advise(parallel, Some(cell), selection, &mut choice);
        let layer = advice.layer.ok_or(NoRoute::Unreachable)?;
        if stretches.last().is_none_or(|last| last.layer != layer) {
            stretches.push(Stretch { layer, points: vec![at], length_m: 0.0 });
        }
        let Some(last) = stretches.last_mut() else { return Err(NoRoute::Astray) };
        match advice.kind {
            Kind::Goal => {
                let number = parallel.layer(layer.into()).map_or(0, |own| own.goal_number(cell));
                let goal = parallel.goals_m().nth(number.into()).unwrap_or(parallel.goal_m());
                last.points.push(goal);
                return Ok(stretches);
            }
            Kind::Move | Kind::Escape => {}
            Kind::NoRoute => return Err(NoRoute::Unreachable),
            Kind::OffMap => return Err(NoRoute::Astray),
        }
        let direction = advice.direction.ok_or(NoRoute::Astray)?;
        cell = cell.neighbour(direction, grid.columns, grid.rows).ok_or(NoRoute::Astray)?;
        at = grid.centre(cell);
        last.points.push(at);
        last.length_m += cost_metres(direction.step_cost(), grid.resolution_m);
    }
    Err(NoRoute::Astray)
}

/// Follows the advice of a layer from a point to the goal.
pub fn follow(
    grid: &Grid,
    parallel: &ParallelPlan<'_>,
    layer: &Layer<'_>,
    start: Point,
) -> Result<Route, NoRoute> {
    let mut cell = grid.cell_at(start[0], start[1]).ok_or(NoRoute::OffMap)?;
    let mut points = vec![start];
    let mut cost = 0u64;
    // A route with more steps than cells passes a cell twice.
    for _ in 0..grid.cells() {
        let direction = match layer.look_up(cell) {
            Answer::Goal => {
                let goal = layer.goal_number(cell);
                points.push(parallel.goals_m().nth(goal.into()).unwrap_or(parallel.goal_m()));
                let step_m = cost_metres(1, grid.resolution_m);
                return Ok(Route { points, length_m: cost as f64 * step_m, goal });
            }
            Answer::Move { direction, .. } | Answer::Blocked { escape: Some(direction) } => {
                direction
            }
            Answer::Blocked { escape: None } | Answer::NoRoute => return Err(NoRoute::Unreachable),
            Answer::OffMap => return Err(NoRoute::Astray),
        };
        cost += u64::from(direction.step_cost());
        cell = cell.neighbour(direction, grid.columns, grid.rows).ok_or(NoRoute::Astray)?;
        points.push(grid.centre(cell));
    }
    Err(NoRoute::Astray)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::pack;
    use crate::search::{Corners, Query, solve};
    use crate::terrain::Terrain;
    use maps::Bitmap;
    use plan_format::{Blob, Cell, Draft, LayerDraft, Parameters, PlanDraft, write};

    /// Follows a layer over cells of half a metre that starts at (10, 20): `#` is blocked,
    /// `G` the goal; the first line is the northernmost row.
    fn follow_in(picture: &[&str], start: Point) -> Result<Route, NoRoute> {
        let (columns, rows) = (picture[0].len() as u32, picture.len() as u32);
        let at =
            |cell: Cell| picture[(rows - 1 - cell.row) as usize].as_bytes()[cell.column as usize];
        let blocked = Bitmap::from_fn(columns, rows, |cell| at(cell) == b'#');
        let goal = Bitmap::from_fn(columns, rows, |cell| at(cell) == b'G').iter().next().unwrap();
        let grid = Grid { columns, rows, resolution_m: 0.5, corner_m: [10.0, 20.0] };
        let packed = pack(&solve(&Query {
            terrain: &Terrain::new(blocked),
            goals: &[goal],
            corners: Corners::Forbid,
        }));
        let goal_m = grid.centre(goal);
        let layers = vec![LayerDraft { name: "physical".into(), rank: 0, packed }];
        let blob = write(&Draft {
            grid,
            origin: None,
            parameters: Parameters::default(),
            plans: vec![PlanDraft { name: "g".into(), goals_m: vec![goal_m], layers }],
            mission: Default::default(),
        })
        .unwrap();
        let blob = Blob::parse_exact(&blob).unwrap();
        let parallel = blob.find("g").unwrap();
        follow(&grid, &parallel, &parallel.layer(0).unwrap(), start)
    }

    #[test]
    fn the_advice_is_followed_from_the_very_start_to_the_very_goal() {
        let route = follow_in(&["....", ".##G", "...."], [10.1, 20.9]).unwrap();
        let expected = [
            [10.1, 20.9],
            [10.25, 21.25],
            [10.75, 21.25],
            [11.25, 21.25],
            [11.75, 21.25],
            [11.75, 20.75],
        ];
        assert_eq!(route.points[0], expected[0]);
        assert_eq!(route.points.last(), Some(&[11.75, 20.75]));
        assert_eq!(route.points.len(), expected.len() + 1);
        assert!((route.length_m - 2.5).abs() < 1e-9, "{}", route.length_m);
    }

    #[test]
    fn out_of_obstacles_it_is_led_and_otherwise_refused() {
        let inside = follow_in(&["G...", "####", "####"], [10.25, 20.25]).unwrap();
        assert_eq!(inside.points[..3], [[10.25, 20.25], [10.25, 20.75], [10.25, 21.25]]);
        assert_eq!(inside.length_m, 1.0);
        assert_eq!(follow_in(&["G.#."], [11.75, 20.0]), Err(NoRoute::Unreachable));
        assert_eq!(follow_in(&["G.#."], [12.0, 20.0]), Err(NoRoute::OffMap));
        assert_eq!(follow_in(&["G"], [10.0, 20.0]).unwrap().points, [[10.0, 20.0], [10.25, 20.25]]);
    }
}
