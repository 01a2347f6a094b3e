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
use super::shut_out::{effects, held_at_points, protected_anywhere};
use maps::problem::Problem;
use plan_format::mission::{Condition, MissionDraft, SwitchPoint};
use states::{States, Stop, Work};
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

/// What is known of each behaviour, for the bounds.
struct Known {
    /// The states of its plan.
    plan: States,
    /// The longest times of its start-up and its shut-down.
    activities: (Bound, Bound),
    /// The facts that it may add and delete.
    effects: (u64, u64),
    /// The facts that its shut-down may add and delete: it gives up what it protects of them.
    freed: (u64, u64),
    /// What its plan protects anywhere.
    protects: Condition,
    /// What it protects at the points where it may sleep.
    holds: Condition,
}

impl Known {
    fn of(draft: &MissionDraft, behaviour: usize, work: &mut Work) -> Self {
        let record = &draft.behaviours[behaviour];
        let plan = States::explore(draft, record.root, work);
        let mut whole = |frame: Option<u16>| {
            let never = |_: &Stop| false;
            let whole = |frame| States::explore(draft, frame, work).longest(never);
            frame.map_or(Bound::Within(0), whole)
        };
        let freed = record.shut_down.map_or((0, 0), |frame| {
            let frame = &draft.frames[usize::from(frame)];
            (frame.may_add, frame.may_delete)
        });
        Self {
            plan,
            activities: (whole(record.start_up), whole(record.shut_down)),
            effects: effects(draft, behaviour),
            freed,
            protects: protected_anywhere(draft, record.root.into()),
            holds: held_at_points(draft, behaviour),
        }
    }
}

/// Whether effects, added and deleted facts, may violate a condition.
fn endangers((adds, deletes): (u64, u64), held: Condition) -> bool {
    held.must & deletes != 0 || held.must_not & adds != 0
}

impl Lints<'_> {
    /// Finds the longest wait of each behaviour and reports the waits.
    pub(super) fn waits(&mut self) -> Vec<Option<Wait>> {
        let count = self.draft.behaviours.len();
        let mut work = Work::default();
        let known: Vec<Known> =
            (0..count).map(|index| Known::of(self.draft, index, &mut work)).collect();
        let waits: Vec<Option<Wait>> = (0..count)
            .map(|waiting| {
                (0..count)
                    .filter(|&other| other != waiting && self.may_wait_for(&known, waiting, other))
                    .map(|other| Wait { behind: other, bound: self.bound(&known, waiting, other) })
                    .max_by_key(|wait| wait.bound)
            })
            .collect();
        self.report_waits(&waits);
        waits
    }

    /// Whether a behaviour may have to wait for another: it takes over a resource, or the other
    /// protects what it may change.
    fn may_wait_for(&self, known: &[Known], waiting: usize, other: usize) -> bool {
        if self.conflict(waiting, other) {
            return self.takes_over(other, waiting).is_some();
        }
        endangers(known[waiting].effects, known[other].protects)
    }

    /// The longest wait of a behaviour while another one runs. Sleeping behaviours that exclude it,
    /// and those that exclude them, resume first, one after the other. Each goes on to a point
    /// where it protects nothing that those that wait may change.
    fn bound(&self, known: &[Known], waiting: usize, other: usize) -> Bound {
        let sleepers = self.sleepers_first(known, waiting, other);
        let dwell = |index: usize| Bound::Within(self.draft.behaviours[index].dwell_ms.into());
        // None of those that are in the way is interrupted while another may not be.
        let beside = (0..known.len()).filter(|&index| {
            self.conflict(waiting, index) && index != other && !self.conflict(index, other)
        });
        let dwell_beside = beside.map(dwell).max().unwrap_or(Bound::Within(0));
        let in_turn = core::iter::once(other).chain(sleepers.iter().copied());
        in_turn.fold(Bound::Within(0), |bound, index| {
            let those_that_wait = core::iter::once(waiting).chain(sleepers.iter().copied());
            let (adds, deletes) =
                those_that_wait.filter(|&one| one != index).fold((0, 0), |(adds, deletes), one| {
                    (adds | known[one].effects.0, deletes | known[one].effects.1)
                });
            let one = &known[index];
            let effects = (adds & !one.freed.0, deletes & !one.freed.1);
            let point = one.plan.longest(|stop| match self.draft.behaviours[index].switch_point {
                SwitchPoint::Earliest => !endangers(effects, stop.held),
                SwitchPoint::Best => {
                    let is_better = |&(work, held): &(u16, Condition)| {
                        stop.lost_work.is_none_or(|lost| work < lost) && !endangers(effects, held)
                    };
                    !endangers(effects, stop.held) && !stop.ahead.iter().any(is_better)
                }
            });
            let (start_up, shut_down) = one.activities;
            let dwell = dwell(index).max(dwell_beside);
            bound.and(dwell.max(start_up)).and(point).and(shut_down)
        })
    }

    /// The sleeping behaviours that may have to go first: those that protect what `waiting` may
    /// change, those that protect what these may change, and so on; and the running ones for which
    /// an action of `other` may wait.
    fn sleepers_first(&self, known: &[Known], waiting: usize, other: usize) -> Vec<usize> {
        let count = known.len();
        let may_sleep = |index: usize| {
            let makes_sleep = |&by: &usize| {
                by != waiting
                    && by != index
                    && (self.conflict(by, index)
                        || endangers(known[index].effects, known[by].protects))
            };
            (0..count).any(|by| makes_sleep(&by))
        };
        let mut first: Vec<usize> = (0..count)
            .filter(|&index| index != waiting && index != other && !self.conflict(index, other))
            .filter(|&index| endangers(known[other].effects, known[index].protects))
            .collect();
        let mut asked = vec![waiting];
        while let Some(victim) = asked.pop() {
            for index in 0..count {
                let is_new = index != waiting && index != other && !first.contains(&index);
                if is_new
                    && endangers(known[victim].effects, known[index].holds)
                    && may_sleep(index)
                {
                    first.push(index);
                    asked.push(index);
                }
            }
        }
        first
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
