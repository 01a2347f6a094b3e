//! The names of goals in texts.
//!
//! A plan may have several goals, each as good as another. Their names are that of the plan with a
//! number, from 0 in the order of the mission: `fuel[2]`.

use plan_format::ParallelPlan;

/// The name of one of `count` goals of a plan: that of the plan if it is the only one.
pub fn name_of(plan: &str, number: usize, count: usize) -> String {
    if count == 1 { plan.to_owned() } else { format!("{plan}[{number}]") }
}

/// The name of a goal of a parallel plan by its number.
pub fn numbered(parallel: &ParallelPlan<'_>, number: u8) -> String {
    name_of(parallel.name(), number.into(), parallel.goal_count())
}

/// The names and the positions of a plan's goals, map metres.
pub fn all<'b>(parallel: &ParallelPlan<'b>) -> impl Iterator<Item = (String, [f64; 2])> + use<'b> {
    let (plan, count) = (parallel.name(), parallel.goal_count());
    (0..).zip(parallel.goals_m()).map(move |(number, at)| (name_of(plan, number, count), at))
}
