//! The behaviour control system: which behaviour has the robot, and what it does.
//!
//! A behaviour is a task with a plan and a criticality. Every tick the criticalities are inferred
//! anew; the most critical behaviours whose resources do not conflict are engaged, the others sleep
//! or are dormant. A more critical behaviour takes over at the next point where nothing that is
//! protected would suffer, or at once if it is critical enough (Hasemann, "Behaviour Control
//! System"). What runs is decomposed and watched, and its atomic actions are handed to the tick.
//!
//! Order of a step: inputs and facts -> criticalities -> who is engaged -> plans (check, decompose,
//! start, finish). One file each: [`inputs`], [`engage`], [`run`].
//!
//! Decisions where the paper is silent:
//! - A missing input counts as its last value for the time that the mission gives it, then as the
//!   value that the mission names (H46).
//! - A dormant behaviour cannot be engaged and yields to every other, but one that is active is not
//!   cut off in the middle of its plan: a robot that has just refuelled still drives back.
//! - Another behaviour is engaged conditionally only if it is more critical by the active one's
//!   hysteresis and the active one has run for its minimum dwell; so two behaviours cannot chatter
//!   (H32). Unconditional switching knows neither.
//! - A behaviour is interrupted conditionally at a vertex of its plan. With `best`, the point is the
//!   one of least lost work among those without interference; it may never be later than the
//!   plan's end (H37).
//! - The intervals that sleeping behaviours hold are respected too. If they alone keep a behaviour
//!   out, the report names the behaviour that excludes it; only unconditional switching resolves it
//!   (H35).
//! - Behaviours that share no resource run together (H31). Start-up activities run before a
//!   behaviour is engaged or resumed, shut-down activities before it sleeps after a conditional
//!   switch (H34); a failed shut-down does not keep the other behaviour waiting.
//! - On waking, what a plan assumes is checked: the deviating frame begins anew at its level, since
//!   not its choice but the world was to blame (H28).
//! - A behaviour that has failed rests for [`REST_US`] before it is considered again.
//!
//! Invariants: constant memory; at most `MAX_STEPS` plan steps for each behaviour and tick; no call
//! panics. Deliberately absent: plan merging (H33).
#![no_std]

mod engage;
mod inputs;
mod report;
mod run;

pub use inputs::{MAX_PROGRESS_FACTS, Observations, World};
pub use report::{Decision, MAX_DECISIONS, Refusal, Report};
pub use run::{MAX_RUNNING, Running, RunningAction};

use grammar::{Event, Forest, Owner};
use inputs::Senses;
use monitor::{Entry, Grid};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS};
use plan_format::mission::{FactKind, Facts, Mission};

/// For how long a behaviour that has failed is left alone, microseconds.
pub const REST_US: u64 = 1_000_000;

/// Start-up and shut-down activities are plans of their own: behaviour `i` owns them as `i` plus
/// this.
const ACTIVITY: Owner = MAX_BEHAVIOURS as Owner;

/// What a behaviour is doing.
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
    /// Interrupted: its plan waits as it was.
    Sleeping,
}

/// What is kept of a behaviour from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Status {
    pub(crate) phase: Phase,
    pub(crate) criticality: f32,
    /// When it was engaged, microseconds.
    pub(crate) engaged_us: u64,
    /// Not considered before, microseconds.
    pub(crate) rests_until_us: u64,
    /// Whether its protection intervals are held against others while it sleeps.
    pub(crate) is_holding: bool,
    /// What it costs to interrupt it at the vertex that it reached last.
    pub(crate) lost_work: u16,
}

impl Status {
    /// Whether it occupies its resources.
    pub(crate) fn is_engaged(&self) -> bool {
        matches!(self.phase, Phase::StartingUp | Phase::Active | Phase::ShuttingDown)
    }
}

/// The state of the behaviour control system. Plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviours {
    pub(crate) plans: Plans,
    pub(crate) statuses: [Status; MAX_BEHAVIOURS],
    pub(crate) senses: Senses,
    /// Symbols that hold, one bit each.
    pub(crate) symbols: Facts,
    /// Digital outputs, one bit each.
    pub(crate) outputs: u16,
    /// When each running action was started, microseconds.
    pub(crate) started_us: [u64; MAX_COMPONENTS],
    /// Whose doubts are looked at in the next tick.
    pub(crate) next_doubt: u8,
}

/// The live plans and the grid that hears of every change in them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Plans {
    pub(crate) forest: Forest,
    pub(crate) grid: Grid,
    /// Behaviours that reached a vertex in the last tick that they ran in, one bit each.
    pub(crate) reached: u16,
    /// Behaviours that somebody waits for, one bit each.
    pub(crate) pending: u16,
}

impl Behaviours {
    /// The state at the start: nothing is engaged, symbols are as the mission sets them.
    pub fn new(mission: &Mission<'_>) -> Self {
        let symbols =
            (0..).zip(mission.facts().iter()).fold(0, |symbols, (bit, fact)| match fact.kind {
                FactKind::Symbol { is_set: true } => symbols | fact_bit(bit),
                _ => symbols,
            });
        Self {
            plans: Plans::default(),
            statuses: [Status::default(); MAX_BEHAVIOURS],
            senses: Senses::default(),
            symbols,
            outputs: 0,
            started_us: [0; MAX_COMPONENTS],
            next_doubt: 0,
        }
    }

    /// One tick: decides which behaviours have the robot and carries their plans on. Returns the
    /// atomic actions that run, and why.
    pub fn step(&mut self, mission: &Mission<'_>, seen: &Observations<'_>) -> (Running, Report) {
        let mut report = Report::default();
        let facts = self.sense(mission, seen);
        self.infer_criticalities(mission, &mut report);
        self.engage(mission, seen.time_us, facts, &mut report);
        let running = self.run(mission, seen, &mut report);
        report.facts = self.facts(mission, seen);
        (running, report)
    }

    /// What a behaviour is doing.
    pub fn phase(&self, behaviour: usize) -> Phase {
        self.statuses.get(behaviour).map_or(Phase::Idle, |status| status.phase)
    }

    /// Digital outputs, one bit each.
    pub fn outputs(&self) -> u16 {
        self.outputs
    }

    /// How many components live in all plans.
    pub fn components(&self) -> usize {
        self.plans.forest.len()
    }
}

impl Plans {
    /// Changes the plans; the grid hears of it.
    pub(crate) fn change<T>(
        &mut self,
        act: impl FnOnce(&mut Forest, &mut dyn FnMut(Event)) -> T,
    ) -> T {
        let Self { forest, grid, .. } = self;
        act(forest, &mut |event| tell(grid, event))
    }
}

/// Passes a message on to the situation grid.
fn tell(grid: &mut Grid, event: Event) {
    match event {
        Event::Planned { id, component } => {
            let entry = Entry {
                symbol: component.symbol,
                owner: component.owner,
                parent: component.parent,
                edge: component.edge,
                from: component.from,
                to: component.to,
                life: component.life,
                production: component.production,
                finished: 0,
            };
            grid.planned(id, entry);
        }
        Event::Decomposed { id, production } => grid.decomposed(id, production),
        Event::CameRound { id } => grid.came_round(id),
        Event::Became { id, life } => grid.became(id, life),
        Event::Deleted { id } => grid.deleted(id),
    }
}

/// The bit of a fact.
pub(crate) fn fact_bit(index: u32) -> Facts {
    1_u64.checked_shl(index).unwrap_or(0)
}

/// The bit of a behaviour, in a set of behaviours or resources.
pub(crate) fn behaviour_bit(index: usize) -> u16 {
    u32::try_from(index).ok().and_then(|index| 1_u16.checked_shl(index)).unwrap_or(0)
}

