//! Whether the robot has room for the plans: live components, depth, memory.

use super::Lints;
use super::recursion::{is_silent, reaches};
use maps::problem::Problem;
use plan_format::limits;
use plan_format::mission::{MissionDraft, Production, Symbol};
use std::collections::{HashMap, HashSet};

/// What a behaviour's plans may need at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Need {
    /// Live components of the plan and of the larger of its two activities.
    pub components: usize,
    /// Levels of nested frames, including the action inside.
    pub depth: usize,
    /// Plan steps (decompositions and starts) from a vertex until actions run.
    pub steps: usize,
}

/// What the robot needs for all behaviours, in words.
pub(super) fn in_words(needs: &[Need]) -> String {
    let components: usize = needs.iter().map(|need| need.components).sum();
    let most = |of: fn(&Need) -> usize| needs.iter().map(of).max().unwrap_or(0);
    let steps = most(|need| need.steps);
    format!(
        "the plans need at most {components} of {} live components, {} of {} levels, {steps} steps \
         in a row ({} per tick) and, like every mission, {} bytes of state",
        limits::MAX_COMPONENTS,
        most(|need| need.depth),
        limits::MAX_DEPTH,
        limits::MAX_STEPS,
        size_of::<behaviour::Behaviours>()
    )
}

/// What each behaviour's plans may need at once, by index; `None` if frames contain each other in
/// too many ways to be checked.
pub(super) fn needs(draft: &MissionDraft) -> Option<Vec<Need>> {
    let mut search =
        Search { draft, known: HashMap::new(), above: Vec::new(), steps_left: 200_000 };
    let behaviours = draft.behaviours.iter().map(|behaviour| {
        let root = search.of_frame(behaviour.root.into())?;
        let mut all = root;
        for frame in [behaviour.start_up, behaviour.shut_down].into_iter().flatten() {
            let activity = search.of_frame(frame.into())?;
            // An activity runs while the behaviour's own plan sleeps.
            all.components = all.components.max(root.components + activity.components);
            all.depth = all.depth.max(activity.depth);
            all.steps = all.steps.max(activity.steps);
        }
        Some(all)
    });
    behaviours.collect()
}

struct Search<'s> {
    draft: &'s MissionDraft,
    /// Needs of frames that are not part of a loop, by frame.
    known: HashMap<usize, Need>,
    /// The frames that contain the current one.
    above: Vec<usize>,
    steps_left: usize,
}

impl Search<'_> {
    /// What a frame needs. A frame that contains itself does so as its last component. Where the
    /// outer one restarts in its place, it counts as a single component. Levels beyond the robot's
    /// limit are not counted.
    fn of_frame(&mut self, frame: usize) -> Option<Need> {
        const SINGLE: Need = Need { components: 1, depth: 1, steps: 1 };
        if self.restarts(frame) || self.above.len() > limits::MAX_DEPTH {
            return Some(SINGLE);
        }
        if let Some(need) = self.known.get(&frame) {
            return Some(*need);
        }
        self.steps_left = self.steps_left.checked_sub(1)?;
        let draft = self.draft;
        let record = draft.frames[frame];
        let first = usize::from(record.first);
        let mut need = SINGLE;
        self.above.push(frame);
        for production in &draft.productions[first..first + usize::from(record.count)] {
            let edges = draft.edges_of(production);
            let parts = edges.iter().map(|edge| match edge.symbol {
                Symbol::PlanFrame(inner) => self.of_frame(inner.into()),
                Symbol::Action(_) => Some(SINGLE),
            });
            let parts: Vec<Need> = parts.collect::<Option<_>>()?;
            let deepest = parts.iter().map(|part| part.depth).max().unwrap_or(0);
            need.depth = need.depth.max(1 + deepest);
            need.components = need.components.max(1 + most_at_once(draft, production, &parts));
            for vertex in 0..production.vertices {
                let begun = edges.iter().zip(&parts).filter(|(edge, _)| edge.from == vertex);
                let steps: usize = begun.map(|(_, part)| part.steps).sum();
                need.steps = need.steps.max(steps + usize::from(vertex == 0));
            }
        }
        self.above.pop();
        if !reaches(draft, frame, frame) && !self.is_in_loop(frame) {
            self.known.insert(frame, need);
        }
        Some(need)
    }

    /// Whether an equal frame above restarts in place of this one, as the robot's own crate decides.
    fn restarts(&self, frame: usize) -> bool {
        let Some(head) = self.above.iter().rposition(|&above| above == frame) else {
            return false;
        };
        let (outer, between) = (&self.above[..head], &self.above[head + 1..]);
        between.iter().all(|&frame| {
            is_silent(self.draft, &self.draft.frames[frame]) || outer.contains(&frame)
        })
    }

    /// Whether the need of a frame depends on the frames above it.
    fn is_in_loop(&self, frame: usize) -> bool {
        self.above.iter().any(|&above| reaches(self.draft, frame, above))
    }
}

/// The largest number of components of a production that are live at once: waiting ones, and
/// running ones with everything below them.
fn most_at_once(draft: &MissionDraft, production: &Production, parts: &[Need]) -> usize {
    /// With more states of one production than this, the sum of all parts is taken.
    const MAX_STATES: usize = 5_000;
    let edges = draft.edges_of(production);
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
    /// What each behaviour's plans need; `None` after an error, if the robot has no room for them.
    pub(super) fn budget(&mut self) -> Option<Vec<Need>> {
        let Some(needs) = needs(self.draft) else {
            let message = "the frames contain each other in too many ways to be checked";
            self.report
                .problems
                .push(Problem::error(message).help("let fewer frames contain each other"));
            return None;
        };
        let help = if self.has_passed_frames() {
            "let fewer frames that a loop passes through have constraints of their own: each of them \
             stays in the plan"
        } else {
            "move some of the innermost components into the frames above"
        };
        for (behaviour, need) in self.syntax.behaviours.iter().zip(&needs) {
            if need.depth > limits::MAX_DEPTH {
                let message = format!(
                    "the plan of `{}` is {} levels deep; the robot has room for {}",
                    behaviour.name.as_str(),
                    need.depth,
                    limits::MAX_DEPTH
                );
                self.report.error(message, &behaviour.name.span, "this behaviour", help);
            }
        }
        let all: usize = needs.iter().map(|need| need.components).sum();
        if needs.iter().any(|need| need.depth > limits::MAX_DEPTH) {
            return None;
        }
        if all > limits::MAX_COMPONENTS {
            let each: Vec<String> = self
                .syntax
                .behaviours
                .iter()
                .zip(&needs)
                .map(|(behaviour, need)| format!("{} {}", behaviour.name.as_str(), need.components))
                .collect();
            let message = format!(
                "the plans may need {all} live components at once; the robot has room for {}",
                limits::MAX_COMPONENTS
            );
            let help = format!(
                "shorten productions, or move parts into separate frames, which are decomposed only \
                 when their turn comes; needed now: {}",
                each.join(", ")
            );
            self.report.problems.push(Problem::error(message).help(help));
            return None;
        }
        Some(needs)
    }
}
