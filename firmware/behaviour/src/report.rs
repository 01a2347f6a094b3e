//! What was decided in a tick, and why: the source of every explanation.

use grammar::Choice;
use heapless::Vec;
use monitor::Signal;
use plan_format::limits::MAX_BEHAVIOURS;
use plan_format::mission::{Facts, Symbol};

/// Most decisions in one report; further ones are only counted.
pub const MAX_DECISIONS: usize = 16;

/// Everything that was decided in one tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The criticality of each behaviour, 0 ..= 1, by its index.
    pub criticalities: [f32; MAX_BEHAVIOURS],
    /// The facts that hold at the end of the tick.
    pub facts: Facts,
    /// What was decided, in order.
    pub decisions: Vec<Decision, MAX_DECISIONS>,
    /// Number of decisions beyond [`MAX_DECISIONS`].
    pub omitted: u16,
}

impl Report {
    pub(crate) fn note(&mut self, decision: Decision) {
        if self.decisions.push(decision).is_err() {
            self.omitted = self.omitted.saturating_add(1);
        }
    }
}

/// One decision. Behaviours, frames and productions by their index in the mission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decision {
    /// A behaviour's start-up activity begins.
    Prepared {
        /// The behaviour.
        behaviour: u8,
    },
    /// A behaviour was engaged with a new plan.
    Engaged {
        /// The behaviour.
        behaviour: u8,
    },
    /// A sleeping behaviour was woken.
    Resumed {
        /// The behaviour.
        behaviour: u8,
    },
    /// A behaviour was put to sleep for another.
    Interrupted {
        /// The behaviour.
        behaviour: u8,
        /// The behaviour that takes over.
        by: u8,
        /// Whether it was at once, not at a switching point.
        is_unconditional: bool,
        /// Lost work: at a switching point, that of the edges into it; at once, that of the actions
        /// that ran (H38).
        lost_work: u16,
    },
    /// A behaviour is engaged unconditionally and may violate what another one protects.
    Overruled {
        /// The behaviour that protects.
        behaviour: u8,
        /// The behaviour that is engaged.
        by: u8,
    },
    /// A behaviour with a claim to the robot has to wait.
    Refused {
        /// The behaviour.
        behaviour: u8,
        /// The behaviour for which it waits.
        by: u8,
        /// Why.
        why: Refusal,
    },
    /// A plan frame was decomposed.
    Chose {
        /// The production.
        production: u16,
        /// Its applicability.
        applicability: f32,
    },
    /// A plan frame was not decomposed, and has failed.
    NotDecomposed {
        /// The plan frame.
        frame: u16,
        /// Why.
        why: Choice,
    },
    /// A behaviour has completed its plan.
    Finished {
        /// The behaviour.
        behaviour: u8,
    },
    /// A behaviour's plan has failed.
    Failed {
        /// The behaviour.
        behaviour: u8,
    },
    /// An action or a plan frame has exceeded its timeout.
    TimedOut {
        /// Which one.
        symbol: Symbol,
    },
    /// The situation grid signals a conflict.
    Conflict {
        /// What it signals.
        signal: Signal,
        /// The component that cannot go on, if it is still there.
        symbol: Option<Symbol>,
    },
}

/// Why a behaviour has to wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The other's minimum dwell is not over.
    Dwell,
    /// The other is not at a point of its plan where nothing protected would be violated.
    NoPointYet,
    /// The other waits for a better point.
    BetterPointAhead,
    /// The other shares no resource, but has a protection interval that this one may violate.
    Excluded,
    /// The other is shutting down.
    ShuttingDown,
}
