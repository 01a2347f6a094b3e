//! What was decided in a tick, and why: the raw material of every explanation.

use grammar::Choice;
use heapless::Vec;
use monitor::Signal;
use plan_format::limits::MAX_BEHAVIOURS;
use plan_format::mission::Facts;

/// Decisions of one tick that are kept; what exceeds them is counted.
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
    /// Decisions that found no room.
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
        /// Which.
        behaviour: u8,
    },
    /// A behaviour was engaged with a new plan.
    Engaged {
        /// Which.
        behaviour: u8,
    },
    /// A sleeping behaviour was woken.
    Resumed {
        /// Which.
        behaviour: u8,
    },
    /// A behaviour was put to sleep for another.
    Interrupted {
        /// Which.
        behaviour: u8,
        /// By whom.
        by: u8,
        /// At once, or at a switching point.
        is_unconditional: bool,
        /// What the mission says that this costs: at a point, the work of what leads to it; at
        /// once, that of the actions that ran (H38).
        lost_work: u16,
    },
    /// What a behaviour protects has to stand back behind another that is engaged
    /// unconditionally.
    Overruled {
        /// Which.
        behaviour: u8,
        /// By whom.
        by: u8,
    },
    /// A behaviour that is more critical, or conflicts with nobody, has to wait.
    Refused {
        /// Which.
        behaviour: u8,
        /// Because of whom.
        by: u8,
        /// Why.
        why: Refusal,
    },
    /// A frame was decomposed.
    Chose {
        /// The production.
        production: u16,
        /// Its applicability.
        applicability: f32,
    },
    /// A frame was not decomposed, and has failed.
    NotDecomposed {
        /// The frame.
        frame: u16,
        /// Why.
        why: Choice,
    },
    /// A behaviour has done its work.
    Finished {
        /// Which.
        behaviour: u8,
    },
    /// A behaviour cannot be carried out.
    Failed {
        /// Which.
        behaviour: u8,
    },
    /// An action has exceeded its time.
    TimedOut {
        /// The component.
        component: u8,
    },
    /// The situation grid signals a conflict.
    Conflict(Signal),
}

/// Why a behaviour has to wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The other has not run for its minimum dwell.
    Dwell,
    /// The other is at no point of its plan where nothing protected would suffer.
    NoPointYet,
    /// The other waits for a better point.
    BetterPointAhead,
    /// The other is not in the way, but holds a protection interval that this one may violate.
    Excluded,
    /// The other is shutting down.
    ShuttingDown,
}
