//! Several goals of one plan: resources, each as good as another (after Payton). Each is a *member*.
//!
//! A member that no route can lead to is left out with a warning, as long as another one is left. Its
//! number stays its own, so that reports count as the mission does.

use super::area::reach;
use super::candidate::{Candidate, PlacedLayer, left_out, with_place};
use super::nearest_free::nearest_free;
use super::{MAX_SUGGESTIONS, globe};
use crate::goals::name_of;
use crate::input::Input;
use crate::layers::Layer;
use crate::pack::Numbered;
use maps::numbers::pair;
use maps::{Bitmap, Point, Problem};
use plan_format::{Cell, Grid};

/// The verb of a sentence about all goals of a candidate.
pub(super) fn is_of(goal: &Candidate<'_>) -> &'static str {
    if goal.at.len() == 1 { "is" } else { "is everywhere" }
}

/// The cells of a goal's members that obstacles leave free; `None` if there is none, after an error if
/// a person asked for the goal.
pub(super) fn free(
    input: &Input<'_>,
    goal: &Candidate<'_>,
    grid: &Grid,
    blocked: &Bitmap,
    problems: &mut Vec<Problem>,
) -> Option<Vec<Numbered>> {
    let mut free: Vec<Numbered> = Vec::new();
    let mut wrong = Vec::new();
    for (number, &at) in (0..).zip(&goal.at) {
        let name = name_of(&goal.name, number.into(), goal.at.len());
        let is_advised = problems.len() + wrong.len() < MAX_SUGGESTIONS;
        match cell(input, goal, (&name, at), grid, blocked, is_advised) {
            Ok(cell) => {
                if let Some(&(first, _)) = free.iter().find(|&&(_, other)| other == cell) {
                    let first = name_of(&goal.name, first.into(), goal.at.len());
                    let message = format!("goals `{first}` and `{name}` are in one cell");
                    let help = format!("reports name `{first}`; leave `{name}` out");
                    let problem = Problem::warning(message).help(help);
                    problems.push(with_place(problem, goal.place.as_ref(), "these goals"));
                }
                free.push((number, cell));
            }
            Err(reason) => wrong.push(reason),
        }
    }
    for Wrong { message, help } in wrong {
        let problem = match free.is_empty() {
            true => goal.problem(message, "this goal"),
            false => with_place(left_out(message), goal.place.as_ref(), "this goal"),
        };
        problems.push(match help {
            Some(help) => problem.help(help),
            None => problem,
        });
    }
    (!free.is_empty()).then_some(free)
}

/// What is wrong with a goal's position.
struct Wrong {
    message: String,
    help: Option<String>,
}

/// The cell of a goal, which must be on the map and free.
fn cell(
    input: &Input<'_>,
    goal: &Candidate<'_>,
    (name, at): (&str, Point),
    grid: &Grid,
    blocked: &Bitmap,
    is_advised: bool,
) -> Result<Cell, Wrong> {
    let Some(cell) = grid.cell_at(at[0], at[1]) else {
        let message = format!("goal `{name}` at {} is outside the map", pair(at));
        let degrees = globe::meant_as_degrees(input, at).filter(|_| goal.asked);
        let help = match degrees {
            Some(uri) => {
                let write = if goal.at.len() == 1 { format!("{name}={uri}") } else { uri };
                format!(
                    "a goal X,Y is in the map's metres; for latitude and longitude write {write}"
                )
            }
            None => reach(grid),
        };
        return Err(Wrong { message, help: Some(help) });
    };
    if !blocked.get(cell) {
        return Ok(cell);
    }
    let message = format!("goal `{name}` at {} is inside an obstacle", pair(at));
    let free = if is_advised { nearest_free(grid, blocked, at) } else { None };
    let help = free.map(|free| format!("the nearest free cell is at {}", pair(grid.centre(free))));
    Err(Wrong { message, help })
}

/// Warnings that layers lead to fewer than the free members of a goal.
pub(super) fn left_out_of_layers(
    goal: &Candidate<'_>,
    free: &[Numbered],
    own: &[PlacedLayer],
    layers: &[Layer],
) -> Vec<Problem> {
    let warning = |layer: &PlacedLayer| {
        let outside = free.iter().filter(|member| !layer.goals.contains(member));
        let names: Vec<String> =
            outside.map(|&(number, _)| name_of(&goal.name, number.into(), goal.at.len())).collect();
        if names.is_empty() {
            return None;
        }
        let is = if names.len() == 1 { "is" } else { "are" };
        let message = format!(
            "`{}` {is} inside an area that layer `{}` avoids; that layer leads to the other goals of \
             `{}`",
            names.join("`, `"),
            layers.get(usize::from(layer.rank))?.name,
            goal.name
        );
        Some(with_place(Problem::warning(message), goal.place.as_ref(), "this goal"))
    };
    own.iter().filter_map(warning).collect()
}
