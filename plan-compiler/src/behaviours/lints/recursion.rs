//! Frames that contain themselves: allowed only as the last component, so that memory is bounded.

use super::Lints;
use plan_format::mission::effects::below;
pub(super) use plan_format::mission::effects::reaches;
use plan_format::mission::{Behaviour, MissionDraft, PlanFrame, Production, Symbol};

/// Whether an edge of a production is the last component that its frame waits for: it leads to the
/// exit and all other edges come before it.
pub(super) fn is_last(draft: &MissionDraft, production: &Production, edge: usize) -> bool {
    let edges = draft.edges_of(production);
    let last = edges[edge];
    last.to + 1 == production.vertices
        && edges
            .iter()
            .enumerate()
            .all(|(other, before)| other == edge || leads(draft, production, before.to, last.from))
}

/// Whether a path leads from one vertex of a production to another, or they are the same.
pub(super) fn leads(draft: &MissionDraft, production: &Production, from: u8, to: u8) -> bool {
    let edges = draft.edges_of(production);
    let mut reached = vec![false; usize::from(production.vertices)];
    reached[usize::from(from)] = true;
    // Edges lead to higher numbers, so all edges into a vertex are seen before it.
    for vertex in from..production.vertices {
        if reached[usize::from(vertex)] {
            let next = edges.iter().filter(|edge| edge.from == vertex);
            next.for_each(|edge| reached[usize::from(edge.to)] = true);
        }
    }
    reached[usize::from(to)]
}

/// Whether a frame may be left out between two rounds of a loop, as the robot's own crate decides.
pub(super) fn is_silent(draft: &MissionDraft, frame: &PlanFrame) -> bool {
    let description = &draft.descriptions[usize::from(frame.description)];
    frame.until.is_empty()
        && frame.timeout_ms == 0
        && description.transient.is_empty()
        && description.goal.is_empty()
        && description.add == 0
        && description.delete == 0
        && description.max_speed_mps.is_infinite()
        && description.min_distance_m <= 0.0
}

impl Lints<'_> {
    /// Reports frames that contain themselves and would need unbounded memory.
    pub(super) fn recursion(&mut self) {
        let syntax = self.syntax;
        for (frame, written) in syntax.frames.iter().enumerate() {
            let first = usize::from(self.draft.frames[frame].first);
            let mut is_told = false;
            for (number, production) in written.productions.iter().enumerate() {
                let record = self.draft.productions[first + number];
                for (index, edge) in production.graph.edges.iter().enumerate() {
                    let at = usize::from(record.first_edge) + index;
                    let Symbol::PlanFrame(inner) = self.draft.edges[at].symbol else { continue };
                    let inner = usize::from(inner);
                    if inner != frame && !reaches(self.draft, inner, frame) {
                        continue;
                    }
                    if let Some((message, label, help)) = self.why_it_grows(frame, &record, index) {
                        self.report.error(message, &edge.span, &label, help);
                    } else if !is_told && self.is_passed(frame, inner) {
                        is_told = true;
                        let name = written.name.as_str();
                        let message = format!("`{name}` lasts until the loop through it ends");
                        let label = "the loop goes on inside it";
                        let help = "what it demands holds in all later rounds; to demand it of the \
                            components before only, put these into a frame of their own";
                        self.report.warning(message, &edge.span, label, help);
                    }
                }
            }
        }
    }

    fn why_it_grows(
        &self,
        frame: usize,
        production: &Production,
        edge: usize,
    ) -> Option<(String, String, &'static str)> {
        let draft = self.draft;
        let name = |index: usize| self.syntax.frames[index].name.as_str();
        let message = format!("`{}` contains itself and would need unbounded memory", name(frame));
        if !is_last(draft, production, edge) {
            let label = "not the last component".to_owned();
            return Some((
                message,
                label,
                "make it the last component before `exit`, with nothing beside it",
            ));
        }
        let record = draft.edges[usize::from(production.first_edge) + edge];
        let first = usize::from(production.first_interval);
        let intervals = &draft.intervals[first..first + usize::from(production.intervals)];
        let spans = |from: u8, to: u8| from <= record.from && to >= record.to;
        if let Some(interval) = intervals.iter().find(|i| spans(i.from, i.to)) {
            let how = if interval.is_derived { "a derived" } else { "a" };
            let label = format!("{how} protection interval spans it");
            return Some((message, label, "end the interval before it"));
        }
        None
    }

    /// Whether a loop passes through some frame that has something to check.
    pub(super) fn has_passed_frames(&self) -> bool {
        let mut frames = 0..self.draft.frames.len();
        frames.any(|frame| {
            let inner = below(self.draft, frame).into_iter().filter_map(|symbol| match symbol {
                Symbol::PlanFrame(inner) => Some(usize::from(inner)),
                Symbol::Action(_) => None,
            });
            let mut again = inner.filter(|&inner| reaches(self.draft, inner, frame));
            again.any(|inner| self.is_passed(frame, inner))
        })
    }

    /// Whether a loop passes through a frame that has something to check, but does not begin there.
    fn is_passed(&self, frame: usize, inner: usize) -> bool {
        let is_silent = is_silent(self.draft, &self.draft.frames[frame]);
        inner != frame && !is_silent && !self.is_entered_from_outside(frame)
    }

    /// Whether a behaviour or a frame outside its loop refers to a frame.
    fn is_entered_from_outside(&self, frame: usize) -> bool {
        let roots = self.draft.behaviours.iter().flat_map(Behaviour::plan_frames);
        roots.map(usize::from).any(|root| root == frame)
            || (0..self.draft.frames.len()).any(|other| {
                below(self.draft, other).contains(&Symbol::PlanFrame(frame as u16))
                    && !reaches(self.draft, frame, other)
                    && other != frame
            })
    }
}
