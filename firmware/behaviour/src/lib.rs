//! The behaviour control system: which behaviour has the robot, and what it does.
//!
//! A behaviour is a task with a plan and a criticality. Every tick infers the criticalities. The
//! most critical behaviours that share no resource are engaged; the others sleep or are dormant. A
//! more critical behaviour takes over at the next point where this violates no protection interval,
//! or at once if it is critical enough (Hasemann, "Behaviour Control System"). The plans of engaged
//! behaviours are decomposed and monitored, and their atomic actions are handed to the tick.
//!
//! Order of a step: inputs, facts and criticalities -> conflicts and finished actions -> engagement
//! -> decomposition and new actions. One module each: `inputs`, `watch`, `choose` (which decides)
//! with `switch` (which acts), and `run`.
//!
//! ```
//! use behaviour::{Behaviours, Observations, Report, World};
//! use math::Vec2;
//! use plan_format::mission::Mission;
//!
//! struct NoMap;
//! impl World for NoMap {
//!     fn cost_to_goal(&self, _: u16) -> Option<f32> { None }
//!     fn price(&self, _: u16, _: u8) -> Option<f32> { None }
//!     fn is_at_goal(&self, _: u16) -> bool { false }
//!     fn is_at(&self, _: Vec2) -> bool { false }
//!     fn is_docked(&self, _: Vec2, _: f32) -> bool { false }
//! }
//!
//! let text = "
//!     input fuel
//!     action drive hold 60000
//!     action refuel hold 60000
//!     frame work
//!     = drive
//!     frame fill
//!     = refuel
//!     behaviour working work; when always ZO
//!     behaviour filling fill; when fuel PB PM PS ZO NS NM NB
//! ";
//! let bytes = fixtures::mission(text).write().unwrap();
//! let mission = Mission::parse(&bytes).unwrap();
//! let mut behaviours = Behaviours::new(&mission);
//! let mut action_at = |time_us, fuel| {
//!     let mut channels = [None; 8];
//!     channels[0] = Some(fuel);
//!     let seen = Observations {
//!         time_us, position: None, channels: &channels, mates: &[], team: 0, world: &NoMap,
//!     };
//!     let running = behaviours.step(&mission, &seen, &mut Report::default());
//!     mission.name(mission.actions().get(running[0].action.into()).unwrap().name)
//! };
//! assert_eq!(action_at(0, 1.0), "drive");
//! // An empty tank is above the unconditional threshold, so the switch is immediate.
//! assert_eq!(action_at(50_000, 0.0), "refuel");
//! ```
//!
//! Decisions where the paper is silent:
//! - A missing input counts as its last value for the time that the mission sets, then as the value
//!   that the mission sets (H46).
//! - A behaviour above its unconditional threshold is urgent and outranks all that are not.
//!   Otherwise the higher criticality wins; an engaged behaviour adds its hysteresis to it. So
//!   neither two calm nor two urgent behaviours chatter (H32). A behaviour yields conditionally
//!   only after its minimum dwell; an unconditional switch ignores the dwell.
//! - A dormant behaviour cannot be engaged, yields to every other and protects nothing while it
//!   sleeps. An active one that becomes dormant still completes its plan: a robot that has just
//!   refuelled still drives back.
//! - A conditional interruption happens when none of the behaviour's actions runs: at a vertex of
//!   its plan; with parallel branches, where they join or happen to be at vertices at once. With
//!   `best`, the point is the one with the least lost work among those without interference. It may
//!   be as late as the end of the plan (H37).
//! - If several behaviours block one, each yields at its own point and sleeps until the last has
//!   yielded. A common point might never come.
//! - The intervals of sleeping behaviours are respected too. If they exclude a behaviour, the
//!   report names the one that excludes it. That one resumes instead, with the criticality of the
//!   one that waits, until it no longer protects the facts. An unconditional switch overrules the
//!   intervals and reports whose they are (H35).
//! - Behaviours that share no resource run together (H31). Start-up activities run before a
//!   behaviour is engaged or resumed, shut-down activities before it sleeps after a conditional
//!   switch (H34). If a start-up fails, its behaviour fails; after a failed shut-down, the other
//!   behaviour proceeds.
//! - When a behaviour wakes, the assumptions of its plan are checked. A frame that deviates starts
//!   again and may try every production, since the world changed and its choice was not wrong
//!   (H28).
//! - A component's effects occur when it ends and its goal holds; if the goal does not hold, none
//!   occurs.
//! - An output is part of the world: it keeps its state when its action, plan or behaviour ends,
//!   fails or is interrupted. A behaviour that needs a lifted tool lifts it in its start-up.
//! - Progress is measured separately for each action that drives, so that waiting does not count as
//!   stuck.
//! - At most one signal begins in a tick, so that each is heard; a signal that waits for `until` is
//!   silent in a tick in which another one begins.
//! - A frame ends as soon as its `until` holds, like an action, and fails after its timeout; the
//!   time that its behaviour sleeps does not count.
//! - A frame takes a production that may violate what its own plan or a sleeping behaviour protects
//!   only if no other one is applicable.
//! - A behaviour that is interrupted leaves a place, to which `Return` drives back.
//! - While motion is not allowed ([`Behaviours::pause`]), time does not advance for actions, dwell
//!   and rest.
//! - A behaviour that has failed rests for [`REST_US`] before it is considered again.
//!
//! Invariants: constant memory; at most `MAX_STEPS` plan steps per behaviour and tick; no call
//! panics.
//!
//! Deliberately absent: plan merging (H33).
#![no_std]

mod choose;
mod inputs;
mod mates;
mod report;
mod run;
mod switch;
mod watch;

pub use grammar::Choice;
pub use inputs::{Observations, World};
pub use mates::Mate;
pub use report::{Decision, MAX_DECISIONS, Refusal, Report};
pub use run::{MAX_RUNNING, Running, RunningAction};

use grammar::{Forest, Tell};
use inputs::Senses;
use math::Vec2;
use monitor::{Assumptions, Signal, SituationGrid};
use parts::bits::{Slots, bit16, members};
use parts::{Id, Owner};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS};
use plan_format::mission::{Condition, FactKind, Facts, Mission};

/// Time for which a failed behaviour is not considered, microseconds.
pub const REST_US: u64 = 1_000_000;

/// Start-up and shut-down activities are plans of their own; those of behaviour `i` have owner
/// `i + ACTIVITY`.
const ACTIVITY: Owner = MAX_BEHAVIOURS as Owner;

/// Life-cycle state of a behaviour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// Has no plan; its criticality decides whether it is dormant.
    #[default]
    Idle,
    /// Its start-up activity runs.
    StartingUp,
    /// Its plan runs.
    Active,
    /// Its shut-down activity runs; it will sleep.
    ShuttingDown,
    /// Interrupted; its plan is suspended.
    Sleeping,
}

/// The state of one behaviour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Status {
    pub(crate) phase: Phase,
    /// Its criticality in this tick, plus its hysteresis if it is engaged.
    pub(crate) weight: f32,
    /// Whether its criticality is too low to be considered.
    pub(crate) is_dormant: bool,
    /// Whether its weight reaches its unconditional threshold.
    pub(crate) is_urgent: bool,
    /// Resources that it needs, one bit each.
    pub(crate) resources: u16,
    /// When it was engaged, microseconds.
    pub(crate) engaged_us: u64,
    /// When its rest after a failure ends, microseconds.
    pub(crate) rests_until_us: u64,
    /// What it protects while it sleeps; nothing after an unconditional switch, which may have
    /// interrupted it anywhere.
    pub(crate) held: Condition,
    /// Work lost by an interruption at the vertex that it reached last.
    pub(crate) lost_work: u16,
    /// Where it was interrupted last, map metres.
    pub(crate) left: Option<Vec2>,
}

impl Status {
    /// Whether it occupies its resources.
    pub(crate) fn is_engaged(&self) -> bool {
        matches!(self.phase, Phase::StartingUp | Phase::Active | Phase::ShuttingDown)
    }

    /// Whether it sleeps and protects something from others.
    pub(crate) fn is_holding(&self) -> bool {
        self.phase == Phase::Sleeping && !self.is_dormant && !self.held.is_empty()
    }
}

/// The state of the behaviour control system. Plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviours {
    /// Time without pauses, microseconds: the clock for everything except inputs.
    pub(crate) now_us: u64,
    /// Time of the last step or pause, on the clock of the observations.
    pub(crate) seen_us: Option<u64>,
    pub(crate) plans: Plans,
    pub(crate) statuses: [Status; MAX_BEHAVIOURS],
    /// Engaged behaviours, one bit each, so that a tick visits only these.
    pub(crate) engaged: u16,
    /// Sleeping behaviours, one bit each.
    pub(crate) asleep: u16,
    /// Engaged behaviours whose next action waits, because its end may violate what another
    /// engaged one protects, one bit each.
    pub(crate) refused: u16,
    /// Engaged behaviours with an action that is done and waits for the same reason, one bit each.
    pub(crate) deferring: u16,
    /// Engaged behaviours that begin nothing, since a more critical one waits, one bit each.
    pub(crate) held_back: u16,
    pub(crate) senses: Senses,
    /// Symbols that hold, one bit each.
    pub(crate) symbols: Facts,
    /// Digital outputs, one bit each.
    pub(crate) outputs: u16,
    /// Whether an action that drives ran after the last step.
    pub(crate) is_driving: bool,
    /// The signal that has begun in this tick, by its slot.
    pub(crate) signal: Option<Id>,
    /// When each running action was started, and each frame that is timed; of a frame whose
    /// behaviour sleeps, how long it had lasted. Microseconds.
    pub(crate) started_us: [u64; MAX_COMPONENTS],
    /// Slots of decomposed frames that end by a condition or by a time.
    pub(crate) timed: Slots,
    /// The component whose doubts were reported last.
    pub(crate) last_doubt: u8,
}

/// The arguments of one step.
pub(crate) struct Context<'a> {
    pub(crate) mission: &'a Mission<'a>,
    pub(crate) seen: &'a Observations<'a>,
    pub(crate) report: &'a mut Report,
    /// Behaviours whose plan has ended in this step, one bit each.
    pub(crate) finished: u16,
}

/// The live plans, and what they assume.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Plans {
    pub(crate) forest: Forest,
    pub(crate) assumptions: Assumptions,
    /// Behaviours that have reached a vertex since they last advanced, one bit each.
    pub(crate) reached: u16,
    /// Behaviours for whose next point another one waits, one bit each.
    pub(crate) awaited: u16,
}

impl Behaviours {
    /// The initial state: no behaviour is engaged, and symbols have the mission's initial values.
    pub fn new(mission: &Mission<'_>) -> Self {
        let symbols =
            (0..).zip(mission.facts().iter()).fold(0, |symbols, (bit, fact)| match fact.kind {
                FactKind::Symbol { is_set: true } => symbols | fact_bit(bit),
                _ => symbols,
            });
        Self {
            now_us: 0,
            seen_us: None,
            plans: Plans::default(),
            statuses: [Status::default(); MAX_BEHAVIOURS],
            engaged: 0,
            asleep: 0,
            refused: 0,
            deferring: 0,
            held_back: 0,
            senses: Senses::default(),
            symbols,
            outputs: 0,
            is_driving: false,
            signal: None,
            started_us: [0; MAX_COMPONENTS],
            timed: Slots::NONE,
            last_doubt: 0,
        }
    }

    /// One tick: decides which behaviours have the robot and advances their plans. Returns the
    /// atomic actions that run and adds the reasons to `report`, which must be new for each tick.
    pub fn step(
        &mut self,
        mission: &Mission<'_>,
        seen: &Observations<'_>,
        report: &mut Report,
    ) -> Running {
        let passed_us = seen.time_us.saturating_sub(self.seen_us.unwrap_or(seen.time_us));
        self.now_us = self.now_us.saturating_add(passed_us);
        self.seen_us = Some(seen.time_us);
        self.sense(mission, seen);
        let context = &mut Context { mission, seen, report, finished: 0 };
        self.infer_criticalities(u16::MAX, context);
        self.watch(context);
        if context.finished != 0 {
            // A behaviour that has made itself dormant by its last step does not begin again.
            self.sense_anew(context.mission);
            self.infer_criticalities(context.finished, context);
        }
        self.engage(context);
        let running = self.run(context);
        report.facts = self.facts();
        running
    }

    /// A tick in which motion is not allowed: plans stay as they are, and the time since the last
    /// step does not count. `time_us` is on the clock of the observations.
    pub fn pause(&mut self, time_us: u64) {
        self.seen_us = Some(time_us);
    }

    /// The life-cycle state of a behaviour.
    pub fn phase(&self, behaviour: usize) -> Phase {
        self.statuses.get(behaviour).map_or(Phase::Idle, |status| status.phase)
    }

    /// Digital outputs, one bit each.
    pub fn outputs(&self) -> u16 {
        self.outputs
    }

    /// The situation grid: the components of all plans, and the relations between them.
    pub fn grid(&self) -> SituationGrid<'_> {
        self.plans.grid()
    }

    /// Number of components in all plans.
    pub fn components(&self) -> usize {
        self.plans.forest.len()
    }
}

impl Plans {
    /// A conflict for the report, with what its component is.
    pub(crate) fn conflict(&self, signal: Signal) -> Decision {
        let (Signal::Evident { id, .. } | Signal::Possible { id, .. }) = signal;
        Decision::Conflict { signal, symbol: self.grid().get(id).map(|part| part.symbol) }
    }

    pub(crate) fn grid(&self) -> SituationGrid<'_> {
        SituationGrid::new(self.forest.pool(), &self.assumptions)
    }

    /// Changes the plans, and what they assume with them.
    pub(crate) fn change<T>(
        &mut self,
        mission: &Mission<'_>,
        act: impl FnOnce(&mut Forest, &mut Tell<'_>) -> T,
    ) -> T {
        let Self { forest, assumptions, .. } = self;
        act(forest, &mut |pool, event| assumptions.apply(mission, pool, event))
    }
}

/// The bit of a fact.
pub(crate) fn fact_bit(index: u32) -> Facts {
    1_u64.checked_shl(index).unwrap_or(0)
}

/// The indices of the behaviours in a set, in order.
pub(crate) fn behaviours_in(set: u16) -> impl Iterator<Item = usize> {
    members(set.into()).map(usize::from)
}

/// The bit of a behaviour in a set of behaviours; 0 for the owner of an activity.
pub(crate) fn behaviour_bit(index: usize) -> u16 {
    bit16(index as u8)
}
