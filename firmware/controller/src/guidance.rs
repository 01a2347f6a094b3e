//! Puts the advice into context: decides whether to drive, where to and with which gains.

use advice::{Choice, Kind, advise};
use math::{Vec2, vector};
use plan_format::grid::STRAIGHT_STEP;
use plan_format::parameters::{Gains, OnTrouble};
use plan_format::{Blob, Direction};
use robot_io::Reason;

/// What the schemas need from plan and goal in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guidance {
    /// The advised step; `None` without advice.
    pub step: Option<Direction>,
    /// The goal, map metres.
    pub goal: Vec2,
    /// Weights of the blend.
    pub gains: Gains,
    /// What the robot is doing.
    pub reason: Reason,
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
}

/// A robot at its goal stands still until it is this many tolerances away from it: a position
/// that wavers by less than a tolerance must not start it again.
const LEAVING: f32 = 2.0;

/// Length of the longest obstacle-free path over cells, divided by the straight line: the
/// square root of 4 - 2 sqrt 2, at 22.5 degrees.
const OCTILE_EXCESS: f32 = 1.082_392_2;

/// Looks up the plan. The error is the reason to stand still.
///
/// Every choice is provisional until the operator arms the robot, because the mission starts at
/// that position. So disarming resets the static selection and the arrival.
pub fn guide(
    blob: &Blob<'_>,
    target: &Target,
    progress: &mut Progress,
    position: Vec2,
    is_armed: bool,
) -> Result<Guidance, Reason> {
    if !is_armed || progress.plan != target.plan {
        *progress = Progress { plan: target.plan, ..Progress::default() };
    }
    let parallel_plan = blob.parallel_plan(usize::from(target.plan));
    // Without a map, only the fallback can have a goal.
    let goal = parallel_plan.map(|plan| plan.goal()).or(blob.goal()).ok_or(Reason::NoPlan)?;
    let distance_m = vector::length(goal - position);
    let guided = weigh(blob, target, progress, position, goal, distance_m);
    progress.is_at_goal = guided == Err(Reason::AtGoal);
    guided
}

fn weigh(
    blob: &Blob<'_>,
    target: &Target,
    progress: &mut Progress,
    position: Vec2,
    goal: Vec2,
    distance_m: f32,
) -> Result<Guidance, Reason> {
    let parameters = blob.parameters();
    let tolerance_m = parameters.schemas.goal_tolerance_m;
    if progress.is_at_goal && distance_m <= LEAVING * tolerance_m {
        return Err(Reason::AtGoal);
    }
    let is_near = distance_m <= tolerance_m;
    let without_advice = |gains, reason| {
        if is_near { Err(Reason::AtGoal) } else { Ok(Guidance { step: None, goal, gains, reason }) }
    };
    // Without advice the reactive schemas must drive, even if their own gain is 0.
    let reactive_only = Gains { reactive: 1.0, plan: 0.0, noise: target.gains.noise };
    let Some(parallel_plan) = blob.parallel_plan(usize::from(target.plan)) else {
        return without_advice(reactive_only, Reason::NoPlan);
    };
    // With a gain of 0 the plan is not looked up, so its trouble has no effect either.
    if target.gains.plan == 0.0 {
        return without_advice(target.gains, Reason::Driving);
    }
    let cell = blob.cell_at(position);
    let advice = advise(&parallel_plan, cell, parameters.selection, &mut progress.choice);
    let in_trouble = |policy, reason| match policy {
        OnTrouble::Stop => Err(reason),
        OnTrouble::Reactive => without_advice(reactive_only, reason),
    };
    let with_advice =
        |reason| Ok(Guidance { step: advice.direction, goal, gains: target.gains, reason });
    match advice.kind {
        Kind::Goal => Err(Reason::AtGoal),
        Kind::Move if is_near && has_free_path(blob, advice.cost, distance_m) => {
            Err(Reason::AtGoal)
        }
        Kind::Move => with_advice(Reason::Driving),
        Kind::Escape => with_advice(Reason::Escaping),
        Kind::NoRoute => in_trouble(parameters.trouble.no_route, Reason::NoRoute),
        Kind::OffMap => in_trouble(parameters.trouble.off_map, Reason::OffMap),
    }
}

/// Whether the path to the goal can be free of obstacles: the route is no longer than a free
/// path could be. A robot near the goal but behind a wall has not arrived.
pub(crate) fn has_free_path(blob: &Blob<'_>, cost: Option<u32>, distance_m: f32) -> bool {
    let resolution_m = blob.grid().resolution_m as f32;
    // Costs are from centre to centre; both ends are up to half a cell's diagonal off.
    let free_m = OCTILE_EXCESS * (distance_m + core::f32::consts::SQRT_2 * resolution_m);
    let cost_m = cost.unwrap_or(u32::MAX) as f32 * (resolution_m / STRAIGHT_STEP as f32);
    cost_m <= free_m
}
