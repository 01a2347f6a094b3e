//! The same field found by other crates, each used as its documentation advises, with the same
//! neighbours and costs. What does not depend on the goal is built before the timing.

use crate::maps::cells;
use ::maps::Bitmap;
use direction::Directions;
use grid_search::{
    Coord, CostCell, CostGrid, DistanceMap, SearchConfig, SearchContext, Size, SolidGrid,
};
use petgraph::csr::Csr;
use plan_compiler::search::{Corners, Query, step};
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::Tolls;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::layout::MAX_UNIT;
use plan_format::{Cell, Direction};

/// What is searched, with what steps are multiplied by.
pub(crate) struct Ground<'q> {
    query: &'q Query<'q>,
    /// By the cell that a robot leaves.
    multipliers: Vec<u32>,
}

impl<'q> Ground<'q> {
    pub(crate) fn new(query: &'q Query<'q>) -> Self {
        let Terrain { blocked, tolls } = query.terrain;
        let unit = tolls.as_ref().map_or(0, Tolls::unit);
        let multiplier =
            |cell| tolls.as_ref().map_or(1, |tolls| tolls.eighths(cell) >> (MAX_UNIT - unit));
        Self { query, multipliers: cells(blocked).map(multiplier).collect() }
    }

    fn multiplier(&self, cell: Cell) -> u32 {
        self.multipliers[(cell.row * self.query.terrain.blocked.columns() + cell.column) as usize]
    }

    /// The steps from a cell away from the goal, with their costs: a robot takes them the other way,
    /// so they cost by the cell that they lead to.
    fn steps(&self, cell: Cell) -> impl Iterator<Item = (Cell, u32)> {
        let Query { terrain, corners, .. } = *self.query;
        Direction::ALL.into_iter().filter_map(move |direction| {
            let is_straight = direction.code().is_multiple_of(2);
            let cost = if is_straight { STRAIGHT_STEP } else { DIAGONAL_STEP };
            step(terrain, cell, direction, corners).map(|to| (to, cost * self.multiplier(to)))
        })
    }
}

/// `grid_search`: a distance map over a grid of costs by cell and direction; keeps buffers.
pub(crate) struct GridSearch {
    grid: Open,
    context: SearchContext<u32>,
    distances: DistanceMap<u32>,
}

struct Open {
    size: [i32; 2],
    open: Vec<bool>,
    multipliers: Vec<u32>,
    corners: Corners,
}

impl Open {
    fn at(&self, x: i32, y: i32) -> Option<bool> {
        let inside = (0..self.size[0]).contains(&x) && (0..self.size[1]).contains(&y);
        inside.then(|| self.open[(y * self.size[0] + x) as usize])
    }
}

impl SolidGrid for Open {
    fn is_solid(&self, coord: Coord) -> Option<bool> {
        self.at(coord.x, coord.y).map(|open| !open)
    }
}

impl CostGrid for Open {
    type Cost = u32;

    fn cost(&self, to: Coord, direction: direction::Direction) -> Option<CostCell<u32>> {
        let step = direction.coord();
        let is_open = self.at(to.x, to.y)?;
        let is_straight = step.x == 0 || step.y == 0;
        let passes = is_straight
            || self.corners == Corners::Allow
            || (self.at(to.x - step.x, to.y)? && self.at(to.x, to.y - step.y)?);
        let cost = if is_straight { STRAIGHT_STEP } else { DIAGONAL_STEP };
        let cost = cost * self.multipliers[(to.y * self.size[0] + to.x) as usize];
        Some(if is_open && passes { CostCell::Cost(cost) } else { CostCell::Solid })
    }
}

impl GridSearch {
    pub(crate) fn new(ground: &Ground<'_>) -> Self {
        let (map, corners) = (&ground.query.terrain.blocked, ground.query.corners);
        let multipliers = ground.multipliers.clone();
        let size = Size::new(map.columns(), map.rows());
        let open = cells(map).map(|cell| !map.get(cell)).collect();
        Self {
            grid: Open {
                size: [map.columns() as i32, map.rows() as i32],
                open,
                multipliers,
                corners,
            },
            context: SearchContext::new(size),
            distances: DistanceMap::new(size),
        }
    }

    pub(crate) fn solve(&mut self, goal: Cell) {
        let start = Coord::new(goal.column as i32, goal.row as i32);
        let config = SearchConfig::default();
        self.context
            .populate_distance_map(&self.grid, start, Directions, config, &mut self.distances)
            .expect("the goal is on the grid");
    }

    pub(crate) fn cost(&self, cell: Cell) -> Option<u32> {
        self.distances.cost(Coord::new(cell.column as i32, cell.row as i32))
    }
}

/// `pathfinding`: Dijkstra over successors that are computed on demand. Returns the costs by cell.
pub(crate) fn pathfinding(ground: &Ground<'_>) -> impl Fn(Cell) -> Option<u32> + use<> {
    let goal = ground.query.goals[0];
    let all = pathfinding::prelude::dijkstra_all(&goal, |&cell| ground.steps(cell));
    move |cell| if cell == goal { Some(0) } else { all.get(&cell).map(|&(_, cost)| cost) }
}

/// `petgraph`: Dijkstra over a compressed sparse graph.
pub(crate) struct Petgraph {
    graph: Csr<(), u32, petgraph::Directed, u32>,
    columns: u32,
}

impl Petgraph {
    pub(crate) fn new(ground: &Ground<'_>) -> Self {
        let map = &ground.query.terrain.blocked;
        let columns = map.columns();
        let node = |cell: Cell| cell.row * columns + cell.column;
        let mut edges: Vec<(u32, u32, u32)> = cells(map)
            .filter(|&cell| !map.get(cell))
            .flat_map(|cell| ground.steps(cell).map(move |(to, cost)| (node(cell), node(to), cost)))
            .collect();
        edges.sort_unstable();
        let mut graph = Csr::from_sorted_edges(&edges).expect("edges are sorted");
        while graph.node_count() < cells(map).count() {
            graph.add_node(());
        }
        Self { graph, columns }
    }

    /// Returns the costs by cell.
    pub(crate) fn solve(&self, goal: Cell) -> impl Fn(Cell) -> Option<u32> + use<> {
        let columns = self.columns;
        let node = move |cell: Cell| cell.row * columns + cell.column;
        let all = petgraph::algo::dijkstra(&self.graph, node(goal), None, |edge| *edge.weight());
        move |cell| all.get(&node(cell)).copied()
    }
}

/// `eikonal`: its shortest paths on a grid (not its fast marching method), which cut corners.
pub(crate) struct Eikonal(eikonal::CostField);

impl Eikonal {
    pub(crate) fn new(map: &Bitmap) -> Self {
        let size = (map.rows() as usize, map.columns() as usize);
        let obstacles = ndarray::Array2::from_shape_fn(size, |(row, column)| {
            map.get(Cell::new(column as u32, row as u32))
        });
        Self(eikonal::CostField::with_obstacles(&obstacles))
    }

    pub(crate) fn solve(&self, goal: Cell) -> eikonal::graph::SolveResult {
        eikonal::graph::solve(&self.0, (goal.row as usize, goal.column as usize))
            .expect("the goal is on the grid")
    }
}
