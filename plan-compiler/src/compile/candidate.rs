//! Goals on their way to the grid, and the words for what is wrong with them.

use crate::mission::Named;
use crate::pack::Numbered;
use maps::Point;
use maps::problem::{Place, Problem};

/// A goal not yet placed on the grid.
pub(super) struct Candidate<'a> {
    pub(super) name: String,
    pub(super) at: Vec<Point>,
    pub(super) layers: Option<&'a [Named]>,
    pub(super) place: Option<Place>,
    /// Whether a person asked for it; otherwise only the map names it.
    pub(super) asked: bool,
}

impl Candidate<'_> {
    /// An error if a person asked for it; otherwise a warning that it is left out.
    pub(super) fn problem(&self, message: String, label: &str) -> Problem {
        let problem = if self.asked { Problem::error(message) } else { left_out(message) };
        with_place(problem, self.place.as_ref(), label)
    }
}

/// A warning that what the message is about is left out.
pub(super) fn left_out(message: String) -> Problem {
    Problem::warning(format!("{message}; it is left out"))
}

/// A layer of a goal.
pub(super) struct PlacedLayer {
    /// Its index in the stack, which has at most `limits::MAX_LAYERS` layers.
    pub(super) rank: u8,
    /// The goals that are free in it.
    pub(super) goals: Vec<Numbered>,
}

/// A problem with its place in the mission or the map, if it is known.
pub(super) fn with_place(problem: Problem, place: Option<&Place>, label: &str) -> Problem {
    match place {
        Some(place) => problem.at(&place.source, place.span.clone(), label),
        None => problem,
    }
}
