//! The behaviour control system: which behaviour has the robot, and what it does.
//!
//! A behaviour is a task with a plan and a criticality. Every tick the criticalities are inferred
//! anew; the most critical behaviours whose resources do not conflict are engaged, the others sleep
//! or are dormant. A more critical behaviour takes over at the next point where nothing that is
//! protected would suffer, or at once if it is critical enough (Hasemann, "Behaviour Control
//! System"). What runs is decomposed and watched, and its atomic actions are handed to the tick.
//!
//! Order of a step: inputs, facts and criticalities -> what is violated and what has ended -> who is
//! engaged -> plans are decomposed and actions started. One file each: [`inputs`], [`watch`],
//! [`choose`], which decides, with [`switch`], which carries the decision out, and [`run`].
//!
//! Decisions where the paper is silent:
//! - A missing input counts as its last value for the time that the mission gives it, then as the
//!   value that the mission names (H46).
//! - A behaviour from its unconditional threshold on outranks all that are below theirs; among
//!   equals in that the criticality decides, to which an engaged behaviour may add its hysteresis.
//!   So neither two calm behaviours nor two urgent ones chatter (H32). A behaviour yields
//!   conditionally only after its minimum dwell; unconditional switching knows no dwell.
//! - A dormant behaviour cannot be engaged, yields to every other and protects nothing while it
//!   sleeps; but one that is active is not cut off in the middle of its plan: a robot that has just
//!   refuelled still drives back.
//! - A behaviour is interrupted conditionally where none of its actions runs: at a vertex of its
//!   plan, with parallel branches where they join or happen to stand at vertices together. With
//!   `best`, the point is the one of least lost work among those without interference; it may never
//!   be later than the plan's end (H37).
//! - Where several behaviours are in the way of one, each yields at its own point and sleeps until
//!   the last has yielded; waiting for a common point could last for ever.
//! - The intervals that sleeping behaviours hold are respected too. If they keep a behaviour out,
//!   the report names the one that excludes it, and that one goes on in its place, as critical as
//!   the one that waits, until it has given up what it protects. Unconditional switching overrules
//!   it, and names the victim (H35).
//! - Behaviours that share no resource run together (H31). Start-up activities run before a
//!   behaviour is engaged or resumed, shut-down activities before it sleeps after a conditional
//!   switch (H34). A failed start-up fails the behaviour; a failed shut-down does not keep the other
//!   one waiting.
//! - On waking, what a plan assumes is checked: the deviating frame begins anew at its level, since
//!   not its choice but the world was to blame (H28).
//! - Effects take place when a component ends and its goal holds, both or neither.
//! - An output is part of the world: it stays as it was set when its action, plan or behaviour ends,
//!   fails or is interrupted. A behaviour that must find a tool lifted lifts it in its start-up.
//! - Progress is counted anew for every action that drives: waiting is not being stuck.
//! - While nothing may move ([`Behaviours::pause`]) no time passes for actions, dwell and rest.
//! - A behaviour that has failed rests for [`REST_US`] before it is considered again.
//!
//! Invariants: constant memory; at most `MAX_STEPS` plan steps for each behaviour and tick; no call
//! panics. Deliberately absent: plan merging (H33).
#![no_std]

mod choose;
mod inputs;
mod report;
mod run;
mod switch;
mod watch;

pub use grammar::Choice;
pub use inputs::{MAX_PROGRESS_FACTS, Observations, World};
pub use report::{Decision, MAX_DECISIONS, Refusal, Report};
pub use run::{MAX_RUNNING, Running, RunningAction};

use grammar::Forest;
use inputs::Senses;
use monitor::SituationGrid;
use parts::bits::{bit16, members};
use parts::{Event, Owner};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS};
use plan_format::mission::{Condition, FactKind, Facts, Mission};

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
    /// Its criticality in this tick, and its hysteresis while it has the robot.
    pub(crate) weight: f32,
    /// Whether its criticality is too little to be considered.
    pub(crate) is_dormant: bool,
    /// Whether its weight is above its unconditional threshold.
    pub(crate) is_urgent: bool,
    /// What it needs, one bit each.
    pub(crate) resources: u16,
    /// When it was engaged.
    pub(crate) engaged_us: u64,
    /// Not considered before.
    pub(crate) rests_until_us: u64,
    /// What it protects while it sleeps; nothing after an unconditional switch, which may have left
    /// anything.
    pub(crate) held: Condition,
    /// What it costs to interrupt it at the vertex that it reached last.
    pub(crate) lost_work: u16,
}

impl Status {
    /// Whether it occupies its resources.
    pub(crate) fn is_engaged(&self) -> bool {
        matches!(self.phase, Phase::StartingUp | Phase::Active | Phase::ShuttingDown)
    }

    /// Whether it sleeps and what it protects is held against others.
    pub(crate) fn is_holding(&self) -> bool {
        self.phase == Phase::Sleeping && !self.is_dormant && !self.held.is_empty()
    }
}

/// The state of the behaviour control system. Plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviours {
    /// Time that has passed without pauses, microseconds: the clock of everything but inputs.
    pub(crate) now_us: u64,
    /// When the last step or pause was, on the clock of the observations.
    pub(crate) seen_us: Option<u64>,
    pub(crate) plans: Plans,
    pub(crate) statuses: [Status; MAX_BEHAVIOURS],
    /// Behaviours that have the robot and those that sleep, one bit each: few of many do.
    pub(crate) engaged: u16,
    pub(crate) asleep: u16,
    pub(crate) senses: Senses,
    /// Symbols that hold, one bit each.
    pub(crate) symbols: Facts,
    /// Digital outputs, one bit each.
    pub(crate) outputs: u16,
    /// When each running action was started.
    pub(crate) started_us: [u64; MAX_COMPONENTS],
    /// The component whose doubts were looked at last.
    pub(crate) last_doubt: u8,
}

/// What every part of one step works with.
pub(crate) struct Context<'a> {
    pub(crate) mission: &'a Mission<'a>,
    pub(crate) seen: &'a Observations<'a>,
    pub(crate) report: &'a mut Report,
}

/// The live plans and the grid that hears of every change in them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Plans {
    pub(crate) forest: Forest,
    pub(crate) grid: SituationGrid,
    /// Behaviours that have reached a vertex since they were last carried on, one bit each.
    pub(crate) reached: u16,
    /// Behaviours that somebody waits for, one bit each.
    pub(crate) awaited: u16,
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
            now_us: 0,
            seen_us: None,
            plans: Plans::default(),
            statuses: [Status::default(); MAX_BEHAVIOURS],
            engaged: 0,
            asleep: 0,
            senses: Senses::default(),
            symbols,
            outputs: 0,
            started_us: [0; MAX_COMPONENTS],
            last_doubt: 0,
        }
    }

    /// One tick: decides which behaviours have the robot and carries their plans on. Returns the
    /// atomic actions that run; why goes into the report, which is new for each tick.
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
        let context = &mut Context { mission, seen, report };
        self.infer_criticalities(context);
        self.watch(context);
        self.engage(context);
        let running = self.run(context);
        report.facts = self.facts();
        running
    }

    /// A tick in which nothing is done since nothing may move: plans wait as they are, and the time
    /// until the next step does not count. `time_us` on the clock of the observations.
    pub fn pause(&mut self, time_us: u64) {
        self.seen_us = Some(time_us);
    }

    /// What a behaviour is doing.
    pub fn phase(&self, behaviour: usize) -> Phase {
        self.statuses.get(behaviour).map_or(Phase::Idle, |status| status.phase)
    }

    /// Digital outputs, one bit each.
    pub fn outputs(&self) -> u16 {
        self.outputs
    }

    /// The situation grids: what the plans are and how their parts stand to each other.
    pub fn grid(&self) -> &SituationGrid {
        &self.plans.grid
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
        mission: &Mission<'_>,
        act: impl FnOnce(&mut Forest, &mut dyn FnMut(Event)) -> T,
    ) -> T {
        let Self { forest, grid, .. } = self;
        act(forest, &mut |event| grid.heed(mission, &event))
    }
}

/// The bit of a fact.
pub(crate) fn fact_bit(index: u32) -> Facts {
    1_u64.checked_shl(index).unwrap_or(0)
}

/// The behaviours in a set, in order.
pub(crate) fn behaviours_in(set: u16) -> impl Iterator<Item = usize> {
    members(set.into()).map(usize::from)
}

/// The bit of a behaviour, in a set of behaviours; none for the owner of an activity.
pub(crate) fn behaviour_bit(index: usize) -> u16 {
    bit16(index as u8)
}
