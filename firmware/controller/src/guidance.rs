//! Puts the advice into context: decides whether to drive, where to and with which gains.

use advice::{Advice, Choice, Kind, advise, advise_by_gains};
use math::{Vec2, scalar, vector};
use plan_format::grid::STRAIGHT_STEP;
use plan_format::parameters::{Blend, Gains, OnTrouble, Selection};
use plan_format::{Blob, Cell, Direction, Layer, ParallelPlan, Step};
use robot_io::Reason;

use crate::edge;

/// What the schemas need from plan and goal in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guidance {
    /// The advised step; `None` without advice.
    pub step: Option<Direction>,
    /// The advice as a vector of length 1: the step's direction, or the direction of the route
    /// ahead; zero without advice.
    pub ahead: Vec2,
    /// The layer that gave the advice; `None` without advice.
    pub layer: Option<u8>,
    /// Cost of the way to the goal, metres: that of the route, or without one the distance.
    pub way_m: f32,
    /// The goal, map metres; of several, the one that the advice leads to.
    pub goal: Vec2,
    /// What tells one destination from another: the goal, of several the first.
    pub destination: Vec2,
    /// Weights of the blend.
    pub gains: Gains,
    /// What the robot is doing.
    pub reason: Reason,
}

impl Guidance {
    /// Guidance straight to a goal, without advice.
    pub fn straight(position: Vec2, goal: Vec2, gains: Gains, reason: Reason) -> Self {
        let way_m = vector::length(goal - position);
        let (ahead, destination) = (Vec2::zeros(), goal);
        Self { step: None, ahead, layer: None, way_m, goal, destination, gains, reason }
    }
}

/// Which parallel plan to follow, and with which gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Index of the parallel plan.
    pub plan: u16,
    /// Weights of the blend.
    pub gains: Gains,
}

/// The robot's progress with its parallel plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Index of the parallel plan.
    pub plan: u16,
    /// The layer that a static selection chose.
    pub choice: Choice,
    /// The robot has reached the goal and has not left it since.
    pub is_at_goal: bool,
    /// Of a plan with several goals, the number of the one that the robot approaches or has reached;
    /// `None` before the first advice.
    pub goal: Option<u8>,
}

/// A robot at its goal stands still until it is this many tolerances away from it: a position
/// that wavers by less than a tolerance must not start it again.
const LEAVING: f32 = 2.0;

/// Cells that the advice looks ahead where they are as large as the body or larger.
const FEWEST_CELLS_AHEAD: u32 = 4;
/// As far ahead as this the straight line leads through free cells, because a diagonal step needs
/// both of its neighbours free.
const SAFE_CELLS_AHEAD: u32 = 2;
/// Most cells that the advice looks ahead: each costs a look-up.
const MOST_CELLS_AHEAD: f32 = 8.0;

/// Length of the longest obstacle-free path over cells, divided by the straight line: the
/// square root of 4 - 2 sqrt 2, at 22.5 degrees.
const OCTILE_EXCESS: f32 = 1.082_392_2;

/// Looks up the plan; `channels` are the input channels, which may hold gains of layers. The error is
/// the reason to stand still.
///
/// Every choice is provisional until the operator arms the robot, because the mission starts at
/// that position. So disarming resets the static selection and the arrival.
pub fn guide(
    blob: &Blob<'_>,
    target: &Target,
    progress: &mut Progress,
    position: Vec2,
    channels: &[Option<f32>],
    is_armed: bool,
) -> Result<Guidance, Reason> {
    if !is_armed || progress.plan != target.plan {
        *progress = Progress { plan: target.plan, ..Progress::default() };
    }
    let parallel_plan = blob.parallel_plan(usize::from(target.plan));
    let guided = match &parallel_plan {
        Some(plan) => weigh(blob, plan, target, progress, position, channels)
            .map(|guidance| Guidance { destination: plan.goal(), ..guidance }),
        None => without_map(blob, target, progress, position),
    };
    progress.is_at_goal = guided == Err(Reason::AtGoal);
    guided
}

/// Guidance without a plan: only the fallback can have a goal.
fn without_map(
    blob: &Blob<'_>,
    target: &Target,
    progress: &Progress,
    position: Vec2,
) -> Result<Guidance, Reason> {
    let goal = blob.goal().ok_or(Reason::NoPlan)?;
    if stays(blob, progress, position, goal) {
        return Err(Reason::AtGoal);
    }
    straight(blob, position, goal, reactive_only(target), Reason::NoPlan)
}

/// Without advice the reactive schemas must drive, even if their own gain is 0.
fn reactive_only(target: &Target) -> Gains {
    Gains { reactive: 1.0, plan: 0.0, noise: target.gains.noise }
}

/// Whether a robot that has reached a goal has not left it since.
fn stays(blob: &Blob<'_>, progress: &Progress, position: Vec2, goal: Vec2) -> bool {
    let tolerance_m = blob.parameters().schemas.goal_tolerance_m;
    progress.is_at_goal && vector::length(goal - position) <= LEAVING * tolerance_m
}

/// Guidance straight to a goal, without advice, until the robot is there.
#[inline(never)]
fn straight(
    blob: &Blob<'_>,
    position: Vec2,
    goal: Vec2,
    gains: Gains,
    reason: Reason,
) -> Result<Guidance, Reason> {
    let guidance = Guidance::straight(position, goal, gains, reason);
    let is_near = guidance.way_m <= blob.parameters().schemas.goal_tolerance_m;
    if is_near { Err(Reason::AtGoal) } else { Ok(guidance) }
}

fn weigh(
    blob: &Blob<'_>,
    parallel_plan: &ParallelPlan<'_>,
    target: &Target,
    progress: &mut Progress,
    position: Vec2,
    channels: &[Option<f32>],
) -> Result<Guidance, Reason> {
    let goal_of = |progress: &Progress| match progress.goal {
        Some(number) => parallel_plan.goal_at(number),
        None => parallel_plan.goal(),
    };
    if stays(blob, progress, position, goal_of(progress)) {
        return Err(Reason::AtGoal);
    }
    // With a gain of 0 the plan is not looked up, so its trouble has no effect either.
    if target.gains.plan == 0.0 {
        progress.goal = nearest_goal(blob, parallel_plan, position);
        return straight(blob, position, goal_of(progress), target.gains, Reason::Driving);
    }
    let parameters = blob.parameters();
    let cell = edge::cell(blob, position);
    let advice = match parameters.selection {
        Selection::Gains(rule) => {
            let gains = rule.of_channels(channels);
            let hysteresis = rule.hysteresis;
            advise_by_gains(parallel_plan, cell, &gains, hysteresis, &mut progress.choice)
        }
        selection => advise(parallel_plan, cell, selection, &mut progress.choice),
    };
    let layer = || advice.layer.and_then(|index| parallel_plan.layer(usize::from(index)));
    // Without a route the goal stays that of the last one, so that it does not change with every
    // obstacle that the robot touches.
    if parallel_plan.has_several_goals()
        && matches!(advice.kind, Kind::Move | Kind::Goal)
        && let Some((layer, cell)) = layer().zip(cell)
    {
        progress.goal = Some(layer.goal_number(cell));
    }
    let goal = goal_of(progress);
    let distance_m = vector::length(goal - position);
    let in_trouble = |policy, reason| match policy {
        OnTrouble::Stop => Err(reason),
        OnTrouble::Reactive => straight(blob, position, goal, reactive_only(target), reason),
    };
    let with_advice = |reason| {
        let straight = Guidance::straight(position, goal, target.gains, reason);
        Ok(Guidance {
            step: advice.direction,
            ahead: ahead(blob, parallel_plan, &advice, position),
            layer: advice.layer,
            way_m: advice.cost.map_or(distance_m, |cost| cost_metres(blob, cost)),
            ..straight
        })
    };
    let is_near = distance_m <= parameters.schemas.goal_tolerance_m;
    match advice.kind {
        Kind::Goal => Err(Reason::AtGoal),
        Kind::Move if is_near && is_there(blob, layer(), advice.cost, position, distance_m) => {
            Err(Reason::AtGoal)
        }
        Kind::Move => with_advice(Reason::Driving),
        Kind::Escape => with_advice(Reason::Escaping),
        Kind::NoRoute => in_trouble(parameters.trouble.no_route, Reason::NoRoute),
        Kind::OffMap => in_trouble(parameters.trouble.off_map, Reason::OffMap),
    }
}

/// The number of the goal that is nearest in a straight line, of those to which the least constrained
/// layer leads: for a robot that does without advice. `None` if the plan has one goal.
#[inline(never)]
fn nearest_goal(blob: &Blob<'_>, plan: &ParallelPlan<'_>, position: Vec2) -> Option<u8> {
    if !plan.has_several_goals() {
        return None;
    }
    let mut nearest = (f32::INFINITY, None);
    for number in 0..plan.goal_count() as u8 {
        let goal = plan.goal_at(number);
        let cell = blob.cell_at(goal);
        let is_end = plan.layer(0).zip(cell).is_some_and(|(l, cell)| l.step(cell) == Step::Goal);
        let distance_m = vector::length(goal - position);
        if is_end && distance_m < nearest.0 {
            nearest = (distance_m, Some(number));
        }
    }
    nearest.1
}

/// The advice as a vector of length 1.
///
/// With [`Blend::Route`], it points from the robot to the centre of a cell of the route, the
/// look-ahead away. That cuts a corner by a part of the look-ahead, which follows from the body's
/// radius. Over coarse cells the robot still looks [`FEWEST_CELLS_AHEAD`] cells ahead, if the
/// straight line to them leads through free cells, and else [`SAFE_CELLS_AHEAD`].
fn ahead(blob: &Blob<'_>, plan: &ParallelPlan<'_>, advice: &Advice, position: Vec2) -> Vec2 {
    let one_step = schemas::follow_plan(advice.direction);
    let parameters = blob.parameters();
    let layer = advice.layer.and_then(|index| plan.layer(usize::from(index)));
    let (Some(start), Some(layer), Kind::Move | Kind::Escape, Blend::Route) =
        (edge::cell(blob, position), layer, advice.kind, parameters.blend)
    else {
        return one_step;
    };
    let grid = blob.grid();
    let resolution_m = grid.resolution_m as f32;
    let cells = parameters.schemas.look_ahead_m / resolution_m;
    let is_coarse = cells < FEWEST_CELLS_AHEAD as f32;
    let count = scalar::clamp(cells, FEWEST_CELLS_AHEAD as f32, MOST_CELLS_AHEAD) as u32;
    let (mut cell, mut near, mut next) = (start, start, advice.direction);
    for step in 1..=count {
        let target = next.and_then(|step| cell.neighbour(step, grid.columns, grid.rows));
        let Some(target) = target else { break };
        cell = target;
        if step <= SAFE_CELLS_AHEAD {
            near = cell;
        }
        next = match layer.step(cell) {
            Step::Move(direction) => Some(direction),
            // A robot that leaves an obstacle looks past the free cell where its route begins.
            Step::Blocked { escape } => escape,
            _ => None,
        };
    }
    // In cells from the centre of the robot's own, so that single precision is enough.
    let centre = Vec2::from(grid.centre(start).map(|metres| metres as f32));
    let here = (position - centre) / resolution_m;
    let to = |cell: Cell| {
        let cells = |to: u32, from: u32| (i64::from(to) - i64::from(from)) as f32;
        Vec2::new(cells(cell.column, start.column), cells(cell.row, start.row)) - here
    };
    let line = to(cell);
    let is_free = |quarter: u32| {
        let point = here + line * (quarter as f32 * 0.25);
        let along = |start: u32, cells: f32| {
            u32::try_from(i64::from(start) + i64::from(scalar::floor(cells + 0.5) as i32))
        };
        let (column, row) = (along(start.column, point.x), along(start.row, point.y));
        let (Ok(column), Ok(row)) = (column, row) else { return false };
        matches!(layer.step(Cell::new(column, row)), Step::Move(_) | Step::Goal)
    };
    let is_safe = !is_coarse || (1..4).all(is_free);
    vector::unit(if is_safe { line } else { to(near) })
}

/// A cost in metres.
fn cost_metres(blob: &Blob<'_>, cost: u32) -> f32 {
    cost as f32 * (blob.grid().resolution_m as f32 / STRAIGHT_STEP as f32)
}

/// Most steps from the goal of a robot that has arrived by a route with tolls: each costs a look-up.
const MOST_STEPS_TO_GOAL: u32 = 32;

/// Whether a robot close to the goal has arrived. With tolls, the cost of its route says little about
/// the length, so the steps to the goal are counted.
pub(crate) fn is_there(
    blob: &Blob<'_>,
    layer: Option<Layer<'_>>,
    cost: Option<u32>,
    position: Vec2,
    distance_m: f32,
) -> bool {
    match (layer, edge::cell(blob, position)) {
        (Some(layer), Some(cell)) if layer.has_tolls() => {
            has_free_path(blob, length(blob, &layer, cell), distance_m)
        }
        _ => has_free_path(blob, cost, distance_m),
    }
}

/// The length of the route from a cell in units of a cost; `None` if it is too long to count.
fn length(blob: &Blob<'_>, layer: &Layer<'_>, from: Cell) -> Option<u32> {
    let grid = blob.grid();
    let (mut cell, mut length) = (from, 0);
    for _ in 0..MOST_STEPS_TO_GOAL {
        match layer.step(cell) {
            Step::Move(direction) => {
                length += direction.step_cost();
                cell = cell.neighbour(direction, grid.columns, grid.rows)?;
            }
            Step::Goal => return Some(length),
            _ => return None,
        }
    }
    None
}

/// The speed limit where the robot is, m/s: that of the layer that it follows, or without advice of
/// the least constrained one. Infinite without a limit.
pub fn speed_limit(blob: &Blob<'_>, progress: &Progress, layer: Option<u8>, position: Vec2) -> f32 {
    let plan = blob.parallel_plan(usize::from(progress.plan));
    let layer = plan.and_then(|plan| plan.layer(usize::from(layer.unwrap_or(0))));
    let limit =
        layer.zip(edge::cell(blob, position)).and_then(|(layer, cell)| layer.speed_limit(cell));
    limit.unwrap_or(f32::INFINITY)
}

/// Whether the path to the goal can be free of obstacles: the route is no longer than a free
/// path could be. A robot near the goal but behind a wall has not arrived.
fn has_free_path(blob: &Blob<'_>, cost: Option<u32>, distance_m: f32) -> bool {
    let resolution_m = blob.grid().resolution_m as f32;
    // Costs are from centre to centre; both ends are up to half a cell's diagonal off.
    let free_m = OCTILE_EXCESS * (distance_m + core::f32::consts::SQRT_2 * resolution_m);
    cost_metres(blob, cost.unwrap_or(u32::MAX)) <= free_m
}
