//! How long a behaviour may have to wait for its turn: the bound on starvation.
//!
//! The robot's own crates carry out every plan in every way that its actions can end, until no new
//! state appears. The bound is the longest path through these states that meets no vertex where the
//! waiting behaviour could be engaged, with every action taking its longest time. Added to it are
//! the other behaviour's minimum dwell and activities, and the waits for sleeping behaviours that
//! must first finish what they protect. The bound holds for a behaviour while it is the most
//! critical one.

mod states;

use super::Lints;
use super::shut_out::effects;
use maps::problem::Problem;
use plan_format::mission::{Condition, SwitchPoint};
use states::{States, Stop};
use std::fmt;

/// The longest wait of a behaviour for its turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wait {
    /// The behaviour that it waits for, by index.
    pub behind: usize,
    /// How long.
    pub bound: Bound,
}

/// An upper bound on a time. Variants are ordered from the smallest to the largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bound {
    /// Milliseconds.
    Within(u64),
    /// Not known: there are too many states.
    Unknown,
    /// No bound: there is a loop without a point of interruption.
    None,
}

impl Bound {
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Within(a), Self::Within(b)) => Self::Within(a.saturating_add(b)),
            _ => self.max(other),
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within(ms) => write!(f, "{:.1} s", *ms as f64 / 1e3),
            Self::Unknown => f.write_str("an unknown time (too many states)"),
            Self::None => f.write_str("an unlimited time"),
        }
    }
}

impl Lints<'_> {
    /// Finds the longest wait of each behaviour and reports the waits.
    pub(super) fn waits(&mut self) -> Vec<Option<Wait>> {
        let draft = self.draft;
        let count = draft.behaviours.len();
        let of_frame = |frame: u16| States::explore(draft, frame);
        let plans: Vec<States> = draft.behaviours.iter().map(|b| of_frame(b.root)).collect();
        let whole = |frame: Option<u16>| {
            frame.map_or(Bound::Within(0), |frame| of_frame(frame).longest(|_: &Stop| false))
        };
        let activities: Vec<(Bound, Bound)> =
            draft.behaviours.iter().map(|b| (whole(b.start_up), whole(b.shut_down))).collect();
        let behind = |waiting: usize, other: usize| {
            let (adds, deletes) = effects(draft, waiting);
            let (start_up, shut_down) = activities[other];
            let dwell = Bound::Within(draft.behaviours[other].dwell_ms.into());
            let is_free = |held: Condition| held.must & deletes == 0 && held.must_not & adds == 0;
            let point = plans[other].longest(|stop| match draft.behaviours[other].switch_point {
                SwitchPoint::Earliest => is_free(stop.held),
                SwitchPoint::Best => {
                    let is_better = |&(work, held): &(u16, Condition)| {
                        stop.lost_work.is_none_or(|lost| work < lost) && is_free(held)
                    };
                    is_free(stop.held) && !stop.ahead.iter().any(is_better)
                }
            });
            dwell.max(start_up).and(point).and(shut_down)
        };
        let waits: Vec<Option<Wait>> = (0..count)
            .map(|waiting| {
                (0..count)
                    .filter(|&other| self.conflict(waiting, other))
                    .filter(|&other| self.takes_over(other, waiting).is_some())
                    .map(|other| {
                        // Sleeping behaviours that shut it out resume first, one after the other.
                        let excluding = self.excluding(waiting).into_iter().filter(|&s| s != other);
                        let bound = excluding.fold(behind(waiting, other), |bound, sleeper| {
                            bound.and(behind(waiting, sleeper))
                        });
                        Wait { behind: other, bound }
                    })
                    .max_by_key(|wait| wait.bound)
            })
            .collect();
        self.report_waits(&waits);
        waits
    }

    fn report_waits(&mut self, waits: &[Option<Wait>]) {
        let mut bounds = Vec::new();
        for (waiting, wait) in waits.iter().enumerate() {
            let Some(Wait { behind, bound }) = *wait else { continue };
            let (name, other) = (self.name(waiting), self.name(behind));
            if bound == Bound::None {
                let message = format!("behaviour `{name}` may wait for `{other}` indefinitely");
                let label =
                    format!("`{other}` reaches no point where this behaviour may take over");
                let help = "end a protection interval or a loop of the other behaviour earlier";
                let span = self.syntax.behaviours[waiting].name.span.clone();
                self.report.warning(message, &span, &label, help);
            } else {
                bounds.push(format!("`{name}` {bound} (behind `{other}`)"));
            }
        }
        if !bounds.is_empty() {
            let message = format!(
                "the longest waits of each behaviour while it is the most critical: {}",
                bounds.join(", ")
            );
            let help = "shorten them with smaller timeout_s and dwell_s, and with more points \
                outside protection intervals";
            self.report.problems.push(Problem::note(message).help(help));
        }
    }
}
