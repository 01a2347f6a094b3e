//! What is violated, and what has ended.

use crate::inputs::{Observations, is_over};
use crate::report::Decision;
use crate::{ACTIVITY, Behaviours, Context, Phase, behaviour_bit, behaviours_in};
use grammar::Ended;
use heapless::Vec;
use math::Vec2;
use monitor::{Signal, Violation};
use parts::{Component, Id, Owner};
use plan_format::limits::MAX_DEPTH;
use plan_format::mission::{Action, ActionKind, Mission};

impl Behaviours {
    /// Takes note of everything that has happened to the engaged behaviours' plans since the last
    /// tick, before anybody decides on them.
    pub(crate) fn watch(&mut self, context: &mut Context<'_>) {
        for index in behaviours_in(self.engaged) {
            let Some(owner) = self.running_owner(index) else { continue };
            self.heed_conflicts(owner, context);
            self.end_actions(owner, context);
        }
        self.heed_sleepers(context);
    }

    /// What sleeping behaviours protect and is violated is reported; they look after it when they
    /// wake.
    fn heed_sleepers(&self, context: &mut Context<'_>) {
        for index in behaviours_in(self.holding()) {
            let (root, held) = (self.plans.forest.root(index as Owner), self.status(index).held);
            let signal = root.and_then(|id| Signal::foreign(id, held, self.facts()));
            signal.into_iter().for_each(|signal| context.report.note(Decision::Conflict(signal)));
        }
    }

    /// The sleeping behaviours whose protection intervals are held against others, one bit each.
    pub(crate) fn holding(&self) -> u16 {
        behaviours_in(self.asleep)
            .filter(|&index| self.status(index).is_holding())
            .fold(0, |set, index| set | behaviour_bit(index))
    }

    /// Whose plan carries a behaviour at the moment: its own, or its activity's.
    pub(crate) fn running_owner(&self, index: usize) -> Option<Owner> {
        match self.status(index).phase {
            Phase::Active => Some(index as Owner),
            Phase::StartingUp | Phase::ShuttingDown => Some(index as Owner + ACTIVITY),
            Phase::Idle | Phase::Sleeping => None,
        }
    }

    /// A component whose transient description does not hold fails; a frame whose protection
    /// interval does not hold chooses anew.
    fn heed_conflicts(&mut self, owner: Owner, context: &mut Context<'_>) {
        // What finds no room is still violated in the next tick.
        let evident = self.plans.grid.evident(owner, self.facts());
        let signals: Vec<Signal, MAX_DEPTH> = evident.take(MAX_DEPTH).collect();
        // By reference: the loop over a `heapless::Vec` itself may panic where it is dropped.
        for &signal in &signals {
            context.report.note(Decision::Conflict(signal));
            match signal {
                Signal::Evident { id, what: Violation::Interval, .. } => {
                    self.plans.change(context.mission, |forest, tell| forest.fall_back(id, tell));
                }
                Signal::Evident { id, what: Violation::Transient, .. } => {
                    self.fail(owner, id, context);
                }
                _ => {}
            }
        }
    }

    /// Actions that have done what they are for, and those that have run out of time.
    fn end_actions(&mut self, owner: Owner, context: &mut Context<'_>) {
        for id in self.plans.forest.running() {
            let Some((_, action)) = self.running_action(context.mission, owner, id) else {
                continue;
            };
            let started_us = self.started_us.get(usize::from(id)).copied().unwrap_or(0);
            if self.is_done(&action, started_us, context.seen) {
                self.complete(owner, id, context);
            } else if is_over(started_us, action.timeout_ms, self.now_us) {
                context.report.note(Decision::TimedOut { component: id });
                self.fail(owner, id, context);
            }
        }
    }

    pub(crate) fn is_done(
        &self,
        action: &Action,
        started_us: u64,
        seen: &Observations<'_>,
    ) -> bool {
        if !action.until.is_empty() && action.until.holds(self.facts()) {
            return true;
        }
        let has_lasted =
            |time_ms: u32| self.now_us.saturating_sub(started_us) >= u64::from(time_ms) * 1_000;
        match action.kind {
            ActionKind::Follow { plan, .. } => seen.world.is_at_goal(plan),
            ActionKind::GoTo { x_m, y_m } => seen.world.is_at(Vec2::new(x_m, y_m)),
            ActionKind::Hold { for_ms } | ActionKind::Wander { for_ms } => has_lasted(for_ms),
            // Done at once, unless it waits for something.
            ActionKind::Signal { .. } | ActionKind::SetOutput { .. } => action.until.is_empty(),
        }
    }

    /// A component has done what it is for: its effects take place, its goal is checked, and so on
    /// upwards for every frame that it completes.
    pub(crate) fn complete(&mut self, owner: Owner, id: Id, context: &mut Context<'_>) {
        let mut id = id;
        for _ in 0..=MAX_DEPTH {
            let Some(component) = self.plans.forest.get(id).copied() else { return };
            let before = self.symbols;
            let Some(description) = context.mission.description(component.symbol) else { return };
            self.symbols = self.symbols & !description.delete | description.add;
            if !description.goal.holds(self.facts()) {
                self.symbols = before;
                if let Some(signal) = self.plans.grid.goal(context.mission, id, self.facts()) {
                    context.report.note(Decision::Conflict(signal));
                }
                return self.fail(owner, id, context);
            }
            self.reach(context.mission, owner, &component);
            match self
                .plans
                .change(context.mission, |forest, tell| forest.finish(context.mission, id, tell))
            {
                Ended::Completes(frame) => id = frame,
                Ended::RootFinished => return self.end_plan(owner, context),
                Ended::GoesOn | Ended::FallsBack(_) | Ended::RootFailed => return,
            }
        }
    }

    /// A component is about to end at a vertex; what interrupting there would cost is remembered.
    fn reach(&mut self, mission: &Mission<'_>, owner: Owner, component: &Component) {
        let index = usize::from(owner);
        self.plans.reached |= behaviour_bit(index);
        let frame = component.parent;
        let production = frame.and_then(|frame| self.plans.forest.production_of(mission, frame));
        if let (Some(status), Some(production)) = (self.statuses.get_mut(index), production) {
            let into = mission.edges_of(&production).filter(|edge| edge.to == component.to);
            status.lost_work = into.fold(0, |sum: u16, edge| sum.saturating_add(edge.work));
        }
    }

    pub(crate) fn fail(&mut self, owner: Owner, id: Id, context: &mut Context<'_>) {
        if self.plans.change(context.mission, |forest, tell| forest.fail(id, tell))
            != Ended::RootFailed
        {
            return;
        }
        match owner.checked_sub(ACTIVITY).map(usize::from) {
            None => self.fail_behaviour(usize::from(owner), context),
            // A shut-down that fails has done what it could.
            Some(index) if self.status(index).phase == Phase::ShuttingDown => {
                self.end_plan(owner, context);
            }
            Some(index) => self.fail_behaviour(index, context),
        }
    }

    /// A whole plan has ended: a behaviour's own, or one of its activities.
    fn end_plan(&mut self, owner: Owner, context: &mut Context<'_>) {
        let Some(index) = owner.checked_sub(ACTIVITY).map(usize::from) else {
            self.set_phase(usize::from(owner), Phase::Idle);
            context.report.note(Decision::Finished { behaviour: owner });
            return;
        };
        match self.status(index).phase {
            Phase::StartingUp => self.begin_work(index, context),
            _ => self.set_phase(index, Phase::Sleeping),
        }
    }
}
