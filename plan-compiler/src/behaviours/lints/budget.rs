//! Whether the robot has room for the plans: live components, depth, memory.

use super::Lints;
use super::recursion::reaches;
use crate::problem::Problem;
use plan_format::limits;
use plan_format::mission::{MissionDraft, Production, Symbol};
use std::collections::{HashMap, HashSet};

/// What a behaviour's plans may need at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Need {
    /// Live components, of its plan and the larger of its activities.
    pub components: usize,
    /// Frames within frames, and an action within.
    pub depth: usize,
}

/// What every behaviour's plans may need at once, by index.
pub(super) fn needs(draft: &MissionDraft) -> Vec<Need> {
    let mut known = HashMap::new();
    let need = |frame: u16, known: &mut HashMap<usize, Need>| of_frame(draft, frame.into(), known);
    draft
        .behaviours
        .iter()
        .map(|behaviour| {
            let root = need(behaviour.root, &mut known);
            let activities = [behaviour.start_up, behaviour.shut_down].into_iter().flatten();
            activities.fold(root, |all, frame| {
                let activity = need(frame, &mut known);
                Need {
                    components: all.components.max(root.components + activity.components),
                    depth: all.depth.max(activity.depth),
                }
            })
        })
        .collect()
}

/// A frame that contains itself does so as the last thing and takes its own place, so the inner one
/// counts as a single component.
fn of_frame(draft: &MissionDraft, frame: usize, known: &mut HashMap<usize, Need>) -> Need {
    if let Some(need) = known.get(&frame) {
        return *need;
    }
    // Where a loop leads back here, this is what is found.
    known.insert(frame, Need { components: 1, depth: 1 });
    let record = draft.frames[frame];
    let first = usize::from(record.first);
    let mut need = Need { components: 1, depth: 1 };
    for production in &draft.productions[first..first + usize::from(record.count)] {
        let edges = usize::from(production.first_edge);
        let edges = &draft.edges[edges..edges + usize::from(production.edges)];
        let parts: Vec<Need> = edges
            .iter()
            .map(|edge| match edge.symbol {
                Symbol::Frame(inner) if !reaches(draft, inner.into(), frame) => {
                    of_frame(draft, inner.into(), known)
                }
                _ => Need { components: 1, depth: 1 },
            })
            .collect();
        let deepest = parts.iter().map(|part| part.depth).max().unwrap_or(0);
        need.depth = need.depth.max(1 + deepest);
        need.components = need.components.max(1 + most_at_once(draft, production, &parts));
    }
    known.insert(frame, need);
    need
}

/// The most components of a production that live at once: those that wait, and those that are
/// carried out with all that is below them.
fn most_at_once(draft: &MissionDraft, production: &Production, parts: &[Need]) -> usize {
    /// More states of one production than this are not told apart.
    const MAX_STATES: usize = 5_000;
    let first = usize::from(production.first_edge);
    let edges = &draft.edges[first..first + parts.len()];
    let is_ready = |finished: u32, edge: usize| {
        let is_before = |other: usize| edges[other].to == edges[edge].from;
        (0..parts.len()).all(|other| !is_before(other) || finished & 1 << other != 0)
    };
    let (mut seen, mut waiting, mut most) = (HashSet::from([0_u32]), vec![0_u32], 0);
    while let Some(finished) = waiting.pop() {
        let left = (0..parts.len()).filter(|&edge| finished & 1 << edge == 0);
        let mut live = 0;
        for edge in left {
            let is_ready = is_ready(finished, edge);
            live += if is_ready { parts[edge].components } else { 1 };
            let next = finished | 1 << edge;
            if is_ready && seen.insert(next) {
                waiting.push(next);
            }
        }
        most = most.max(live);
        if seen.len() > MAX_STATES {
            return parts.iter().map(|part| part.components).sum();
        }
    }
    most
}

impl Lints<'_> {
    /// Refuses what the robot has no room for.
    pub(super) fn budget(&mut self) {
        let needs = needs(self.draft);
        for (behaviour, need) in self.syntax.behaviours.iter().zip(&needs) {
            if need.depth > limits::MAX_DEPTH {
                let message = format!(
                    "the plan of `{}` is {} levels deep, the robot has room for {}",
                    behaviour.name.as_str(),
                    need.depth,
                    limits::MAX_DEPTH
                );
                let mend = "put some of the innermost components straight into the frames above";
                self.report.error(message, &behaviour.name.span, "this behaviour", mend);
            }
        }
        let all: usize = needs.iter().map(|need| need.components).sum();
        if all > limits::MAX_COMPONENTS {
            let each: Vec<String> = self
                .syntax
                .behaviours
                .iter()
                .zip(&needs)
                .map(|(behaviour, need)| format!("{} {}", behaviour.name.as_str(), need.components))
                .collect();
            let message = format!(
                "the plans may need {all} live components at once, the robot has room for {}",
                limits::MAX_COMPONENTS
            );
            let mend = format!(
                "shorten productions, or move parts into frames of their own, which are decomposed \
                 when their turn comes; now: {}",
                each.join(", ")
            );
            self.report.problems.push(Problem::error(message).mend(mend));
        }
    }
}
