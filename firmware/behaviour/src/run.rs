//! Carrying the engaged behaviours' plans on.

use crate::inputs::{Observations, is_over};
use crate::report::{Decision, Report};
use crate::{ACTIVITY, Behaviours, Phase, behaviour_bit};
use grammar::{Choice, Ended, Id, Owner};
use heapless::Vec;
use math::Vec2;
use monitor::{Signal, Violation};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS, MAX_DEPTH, MAX_STEPS};
use plan_format::mission::{Action, ActionKind, Facts, Life, Mission, Symbol};

/// Atomic actions that are handed to the tick at once; further ones wait.
pub const MAX_RUNNING: usize = 8;

/// An atomic action that runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunningAction {
    /// The behaviour it belongs to.
    pub behaviour: u8,
    /// Its place in the plans.
    pub component: Id,
    /// What it is.
    pub action: Action,
    /// Never faster, m/s; infinite for no constraint.
    pub max_speed_mps: f32,
    /// Never nearer to an obstacle, metres; 0 for no constraint.
    pub min_distance_m: f32,
}

/// The atomic actions that run in this tick, by behaviour.
pub type Running = Vec<RunningAction, MAX_RUNNING>;

impl Behaviours {
    /// Carries every engaged behaviour's plan on by at most `MAX_STEPS` steps.
    pub(crate) fn run(
        &mut self,
        mission: &Mission<'_>,
        seen: &Observations<'_>,
        report: &mut Report,
    ) -> Running {
        self.plans.reached = 0;
        let mut running = Running::new();
        let count = mission.behaviours().len().min(MAX_BEHAVIOURS);
        for index in 0..count {
            let Some(owner) = self.running_owner(index) else { continue };
            let facts = self.facts(mission, seen);
            self.heed_conflicts(mission, owner, facts, seen, report);
            self.end_actions(mission, owner, seen, report);
            self.advance(mission, owner, seen, report);
            self.doubt(mission, owner, facts, report);
            // Its activity may have ended, and its own plan taken over.
            if let Some(owner) = self.running_owner(index) {
                self.collect(mission, index as u8, owner, &mut running);
            }
        }
        running
    }

    /// Whose plan carries a behaviour at the moment: its own, or its activity's.
    fn running_owner(&self, index: usize) -> Option<Owner> {
        match self.status(index).phase {
            Phase::Active => Some(index as Owner),
            Phase::StartingUp | Phase::ShuttingDown => Some(index as Owner + ACTIVITY),
            Phase::Idle | Phase::Sleeping => None,
        }
    }

    /// What is violated now: a component whose transient description does not hold fails; a frame
    /// whose protection interval does not hold chooses anew; a sleeping behaviour's is reported.
    fn heed_conflicts(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        facts: Facts,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        let holding = (0..).zip(&self.statuses).fold(0, |set, (index, status)| {
            if status.phase == Phase::Sleeping && status.is_holding {
                set | behaviour_bit(index)
            } else {
                set
            }
        });
        let mut signals: Vec<Signal, MAX_DEPTH> = Vec::new();
        self.plans.grid.evident(mission, owner, holding, facts, &mut |signal| {
            // What finds no room is still violated in the next tick.
            let _ = signals.push(signal);
        });
        for signal in signals {
            report.note(Decision::Conflict(signal));
            match signal {
                Signal::Evident { id, what: Violation::Interval, .. } => {
                    self.plans.change(|forest, tell| forest.fall_back(id, tell));
                }
                Signal::Evident { id, what: Violation::Transient, .. } => {
                    self.fail(mission, owner, id, seen, report);
                }
                _ => {}
            }
        }
    }

    /// Actions that have done what they are for, and those that have run out of time.
    fn end_actions(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        for id in 0..MAX_COMPONENTS as Id {
            let Some(action) = self.running_action(mission, owner, id) else { continue };
            let started_us = self.started_us.get(usize::from(id)).copied().unwrap_or(0);
            if self.is_done(mission, &action, started_us, seen) {
                self.complete(mission, owner, id, seen, report);
            } else if is_over(started_us, action.timeout_ms, seen.time_us) {
                report.note(Decision::TimedOut { component: id });
                self.fail(mission, owner, id, seen, report);
            }
        }
    }

    fn is_done(
        &self,
        mission: &Mission<'_>,
        action: &Action,
        started_us: u64,
        seen: &Observations<'_>,
    ) -> bool {
        if !action.until.is_empty() && action.until.holds(self.facts(mission, seen)) {
            return true;
        }
        let has_lasted =
            |time_ms: u32| seen.time_us.saturating_sub(started_us) >= u64::from(time_ms) * 1_000;
        match action.kind {
            ActionKind::Follow { plan, .. } => seen.world.is_at_goal(plan),
            ActionKind::GoTo { x_m, y_m } => seen.world.is_at(Vec2::new(x_m, y_m)),
            ActionKind::Hold { for_ms } | ActionKind::Wander { for_ms } => has_lasted(for_ms),
            // Done at once, unless it waits for something.
            ActionKind::Signal { .. } | ActionKind::SetOutput { .. } => action.until.is_empty(),
        }
    }

    /// Decomposes what is scheduled and starts actions, a bounded number of steps.
    fn advance(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        for _ in 0..MAX_STEPS {
            // Somebody waits for a vertex, and here is one: nothing new before that is decided.
            if self.plans.pending & self.plans.reached & behaviour_bit(usize::from(owner)) != 0 {
                return;
            }
            let Some(id) = self.plans.forest.scheduled(owner) else { return };
            let facts = self.facts(mission, seen);
            if let Some(signal) = self.plans.grid.initial(mission, id, facts) {
                report.note(Decision::Conflict(signal));
                self.fail(mission, owner, id, seen, report);
                continue;
            }
            match self.plans.forest.get(id).map(|component| component.symbol) {
                Some(Symbol::Frame(_)) => self.decompose(mission, owner, id, seen, report),
                Some(Symbol::Action(_)) => self.start(mission, owner, id, seen, report),
                None => return,
            }
        }
    }

    fn decompose(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        id: Id,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        let senses = &self.senses;
        let plans = &mut self.plans;
        let mut best = 0.0;
        let mut applicability = |_: u16, production: &plan_format::mission::Production| {
            let value = production.rules.map_or(1.0, |rules| senses.result(rules));
            best = value.max(best);
            value
        };
        let (id, choice) =
            plans.change(|forest, tell| forest.decompose(mission, id, &mut applicability, tell));
        match choice {
            Choice::Production(production) => {
                report.note(Decision::Chose { production, applicability: best });
            }
            Choice::LoopEnded => self.complete(mission, owner, id, seen, report),
            Choice::NothingApplicable | Choice::NoRoom | Choice::TooDeep => {
                self.fail(mission, owner, id, seen, report);
            }
            Choice::NotScheduled => {}
        }
    }

    fn start(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        id: Id,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        self.plans.change(|forest, tell| forest.start(id, tell));
        if let Some(started_us) = self.started_us.get_mut(usize::from(id)) {
            *started_us = seen.time_us;
        }
        let Some(action) = self.running_action(mission, owner, id) else { return };
        if let ActionKind::SetOutput { output, is_on } = action.kind {
            let bit = 1_u16.checked_shl(u32::from(output)).unwrap_or(0);
            self.outputs = if is_on { self.outputs | bit } else { self.outputs & !bit };
        }
        if self.is_done(mission, &action, seen.time_us, seen) && !is_reported(action.kind) {
            self.complete(mission, owner, id, seen, report);
        }
    }

    /// A component has done what it is for: its effects take place, its goal is checked, and so on
    /// upwards for every frame that it completes.
    fn complete(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        id: Id,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        let mut id = id;
        for _ in 0..=MAX_DEPTH {
            let Some(component) = self.plans.forest.get(id).copied() else { return };
            if let Some(description) = mission.description(component.symbol) {
                self.symbols = self.symbols & !description.delete | description.add;
            }
            if let Some(signal) = self.plans.grid.goal(mission, id, self.facts(mission, seen)) {
                report.note(Decision::Conflict(signal));
                return self.fail(mission, owner, id, seen, report);
            }
            self.reach(mission, owner, &component);
            match self.plans.change(|forest, tell| forest.finish(mission, id, tell)) {
                Ended::Completes(frame) => id = frame,
                Ended::RootFinished => return self.end_plan(mission, owner, seen, report),
                Ended::GoesOn | Ended::FallsBack(_) | Ended::RootFailed => return,
            }
        }
    }

    /// A component is about to end at a vertex; what interrupting there would cost is remembered.
    fn reach(&mut self, mission: &Mission<'_>, owner: Owner, component: &grammar::Component) {
        let index = usize::from(owner);
        self.plans.reached |= behaviour_bit(index);
        let production =
            component.parent.and_then(|frame| self.plans.forest.production_of(mission, frame));
        let edge = production.and_then(|production| {
            mission.edges().get(usize::from(production.first_edge) + usize::from(component.edge))
        });
        if let (Some(status), Some(edge)) = (self.statuses.get_mut(index), edge) {
            status.lost_work = edge.work;
        }
    }

    fn fail(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        id: Id,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        if self.plans.change(|forest, tell| forest.fail(id, tell)) != Ended::RootFailed {
            return;
        }
        match owner.checked_sub(ACTIVITY).map(usize::from) {
            None => self.fail_behaviour(usize::from(owner), seen.time_us, report),
            // A shut-down that fails has done what it could.
            Some(index) if self.status(index).phase == Phase::ShuttingDown => {
                self.end_plan(mission, owner, seen, report);
            }
            Some(index) => self.fail_behaviour(index, seen.time_us, report),
        }
    }

    /// A whole plan has ended: a behaviour's own, or one of its activities.
    fn end_plan(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        seen: &Observations<'_>,
        report: &mut Report,
    ) {
        let Some(index) = owner.checked_sub(ACTIVITY).map(usize::from) else {
            let index = usize::from(owner);
            self.set_phase(index, Phase::Idle);
            report.note(Decision::Finished { behaviour: owner });
            return;
        };
        match self.status(index).phase {
            Phase::StartingUp => {
                let facts = self.facts(mission, seen);
                self.begin_work(mission, index, seen.time_us, facts, report);
            }
            _ => self.set_phase(index, Phase::Sleeping),
        }
    }

    /// Looks at one component's future each tick, in turn: doubts are early warnings, and bounded
    /// work a tick matters more than their promptness. What is due to start is checked anyway.
    fn doubt(&mut self, mission: &Mission<'_>, owner: Owner, facts: Facts, report: &mut Report) {
        let id = self.next_doubt;
        self.next_doubt = if usize::from(id) + 1 < MAX_COMPONENTS { id + 1 } else { 0 };
        if self.plans.grid.get(id).is_some_and(|entry| entry.owner == owner) {
            let grid = &self.plans.grid;
            let mut note = |signal| report.note(Decision::Conflict(signal));
            grid.possible(mission, id, facts, &mut note);
            grid.choices(mission, id, 0, &mut note);
        }
    }

    fn collect(&self, mission: &Mission<'_>, behaviour: u8, owner: Owner, running: &mut Running) {
        for component in 0..MAX_COMPONENTS as Id {
            if let Some(action) = self.running_action(mission, owner, component) {
                let (max_speed_mps, min_distance_m) =
                    self.plans.grid.constraints(mission, component);
                // What finds no room waits for a tick with fewer actions.
                let _ = running.push(RunningAction {
                    behaviour,
                    component,
                    action,
                    max_speed_mps,
                    min_distance_m,
                });
            }
        }
    }

    fn running_action(&self, mission: &Mission<'_>, owner: Owner, id: Id) -> Option<Action> {
        let component = self.plans.forest.get(id)?;
        match component.symbol {
            Symbol::Action(index)
                if component.owner == owner && component.life == Life::Started =>
            {
                mission.actions().get(usize::from(index))
            }
            _ => None,
        }
    }
}

/// Whether an action has to be handed to the tick at least once, even if it is done at once.
fn is_reported(kind: ActionKind) -> bool {
    matches!(kind, ActionKind::Signal { .. })
}
