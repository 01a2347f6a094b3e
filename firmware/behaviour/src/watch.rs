//! Reacts to conflicts, and ends actions.

use crate::choose::Effects;
use crate::inputs::{Observations, is_over, is_reached};
use crate::report::Decision;
use crate::{ACTIVITY, Behaviours, Context, Phase, behaviour_bit, behaviours_in};
use grammar::Ended;
use heapless::Vec;
use math::Vec2;
use monitor::{Signal, Violation};
use parts::{Component, Id, Life, Owner};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_DEPTH};
use plan_format::mission::{Action, ActionKind, Mission, Symbol};

impl Behaviours {
    /// Handles the conflicts and the finished actions of engaged behaviours, before the tick
    /// decides on them.
    pub(crate) fn watch(&mut self, context: &mut Context<'_>) {
        self.deferring = 0;
        for index in behaviours_in(self.engaged) {
            let Some(owner) = self.running_owner(index) else { continue };
            self.handle_conflicts(owner, context);
            self.end_frames(owner, context);
            self.end_actions(owner, context);
        }
        self.report_foreign_conflicts(context);
    }

    /// Reports violations of what sleeping behaviours protect; they react when they wake. What is
    /// violated is protected no more, also where the behaviour is dormant.
    fn report_foreign_conflicts(&mut self, context: &mut Context<'_>) {
        for index in behaviours_in(self.asleep) {
            let status = self.status(index);
            let root = self.plans.forest.root(index as Owner);
            let signal = root.and_then(|id| Signal::foreign(id, status.held, self.facts()));
            let Some(signal) = signal else { continue };
            if status.is_holding() {
                context.report.note(self.plans.conflict(signal));
            }
            self.drop_violated(index);
        }
    }

    /// A sleeping behaviour no longer protects what is violated.
    fn drop_violated(&mut self, index: usize) {
        let facts = self.facts();
        if let Some(status) = self.statuses.get_mut(index) {
            let violated = status.held.violated(facts);
            status.held.must &= !violated;
            status.held.must_not &= !violated;
        }
    }

    /// The sleeping behaviours that protect something from others, one bit each.
    pub(crate) fn holding(&self) -> u16 {
        behaviours_in(self.asleep)
            .filter(|&index| self.status(index).is_holding())
            .fold(0, |set, index| set | behaviour_bit(index))
    }

    /// The owner of the plan that runs for a behaviour: the behaviour or its activity.
    pub(crate) fn running_owner(&self, index: usize) -> Option<Owner> {
        match self.status(index).phase {
            Phase::Active => Some(index as Owner),
            Phase::StartingUp | Phase::ShuttingDown => Some(index as Owner + ACTIVITY),
            Phase::Idle | Phase::Sleeping => None,
        }
    }

    /// Fails each component whose transient description is violated. A frame whose protection
    /// interval is violated chooses again.
    fn handle_conflicts(&mut self, owner: Owner, context: &mut Context<'_>) {
        // Further conflicts are still there in the next tick.
        let evident = self.plans.grid().evident(owner, self.facts());
        let mut signals: Vec<Signal, MAX_DEPTH> = Vec::new();
        // Collecting has a panic path. Pushing the first that is too many fails and ends the loop.
        let _ = evident.map(|signal| signals.push(signal)).find(Result::is_err);
        // By reference: the drop of a `heapless::Vec` iterator has a panic path.
        for &signal in &signals {
            context.report.note(self.plans.conflict(signal));
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

    /// Completes the frames whose `until` holds, and fails those that exceed their timeout.
    fn end_frames(&mut self, owner: Owner, context: &mut Context<'_>) {
        for id in self.timed.iter() {
            let component = self.plans.forest.get(id).copied();
            let Some(Component { symbol: Symbol::PlanFrame(index), owner: own, life, .. }) =
                component
            else {
                self.timed.remove(id);
                continue;
            };
            let frame = context.mission.plan_frames().get(usize::from(index));
            let Some(frame) = frame.filter(|_| own == owner && life == Life::Started) else {
                continue;
            };
            let started_us = self.started_us.get(usize::from(id)).copied().unwrap_or(0);
            let is_done = is_reached(frame.until, self.facts());
            if is_done && !self.is_deferred(owner, id, context) {
                self.complete(owner, id, context);
            } else if frame.timeout_ms != 0 && is_over(started_us, frame.timeout_ms, self.now_us) {
                context.report.note(Decision::TimedOut { symbol: Symbol::PlanFrame(index) });
                self.fail(owner, id, context);
            }
        }
    }

    /// Completes the actions that are done, and fails those that exceed their timeout.
    fn end_actions(&mut self, owner: Owner, context: &mut Context<'_>) {
        for id in self.plans.forest.running_of(owner) {
            let Some((index, action)) = self.running_action(context.mission, owner, id) else {
                continue;
            };
            let started_us = self.started_us.get(usize::from(id)).copied().unwrap_or(0);
            let is_done = self.is_done(owner, &action, started_us, context.seen);
            if is_done && !self.is_deferred(owner, id, context) {
                self.complete(owner, id, context);
            } else if is_over(started_us, action.timeout_ms, self.now_us) {
                context.report.note(Decision::TimedOut { symbol: Symbol::Action(index) });
                self.fail(owner, id, context);
            }
        }
    }

    /// Where the behaviour to which an owner belongs was interrupted, if it has a plan to go on
    /// with.
    pub(crate) fn left_by(&self, owner: Owner) -> Option<Vec2> {
        let index = owner % ACTIVITY;
        self.plans.forest.root(index).and(self.status(usize::from(index)).left)
    }

    /// Whether an action or a frame that is done may not end yet, because its end would violate what another
    /// engaged behaviour protects, which does not wait for anybody itself. Reported.
    fn is_deferred(&mut self, owner: Owner, id: Id, context: &mut Context<'_>) -> bool {
        let index = usize::from(owner);
        let is_bound = index < MAX_BEHAVIOURS
            && !self.status(index).is_urgent
            && self.engaged != behaviour_bit(index);
        if !is_bound {
            return false;
        }
        let forest = &self.plans.forest;
        let ends = core::iter::successors(Some(id), |&id| forest.completes(context.mission, id));
        let effects = ends.take(MAX_DEPTH).fold(Effects::default(), |all, id| {
            let symbol = forest.get(id).map(|component| component.symbol);
            let description = symbol.and_then(|symbol| context.mission.description(symbol));
            description.map_or(all, |description| all.and(Effects::at_end(description)))
        });
        let protecting = self.protecting(index, effects) & !self.deferring;
        self.refuse(owner, protecting, context);
        if protecting != 0 {
            self.deferring |= behaviour_bit(index);
        }
        protecting != 0
    }

    /// Whether an action that started at `started_us` has achieved its purpose.
    pub(crate) fn is_done(
        &self,
        owner: Owner,
        action: &Action,
        started_us: u64,
        seen: &Observations<'_>,
    ) -> bool {
        if is_reached(action.until, self.facts()) {
            return true;
        }
        let has_lasted =
            |time_ms: u32| self.now_us.saturating_sub(started_us) >= u64::from(time_ms) * 1_000;
        match action.kind {
            ActionKind::Follow { plan, .. } => seen.world.is_at_goal(plan),
            ActionKind::GoTo { x_m, y_m } => seen.world.is_at(Vec2::new(x_m, y_m)),
            ActionKind::Dock { x_m, y_m, direction_rad, .. } => {
                seen.world.is_docked(Vec2::new(x_m, y_m), direction_rad)
            }
            ActionKind::Return => self.left_by(owner).is_none_or(|place| seen.world.is_at(place)),
            ActionKind::Hold { for_ms }
            | ActionKind::Wander { for_ms }
            | ActionKind::MoveAhead { for_ms, .. } => has_lasted(for_ms),
            // Done at once, unless they wait for `until`.
            ActionKind::Signal { .. } | ActionKind::SetOutput { .. } => action.until.is_empty(),
        }
    }

    /// Completes a component: applies its effects, checks its goal, and does the same upwards for
    /// each frame that this completes.
    pub(crate) fn complete(&mut self, owner: Owner, id: Id, context: &mut Context<'_>) {
        let mut id = id;
        for _ in 0..=MAX_DEPTH {
            let Some(component) = self.plans.forest.get(id).copied() else { return };
            let before = self.symbols;
            let Some(description) = context.mission.description(component.symbol) else { return };
            self.symbols = self.symbols & !description.delete | description.add;
            if !description.goal.holds(self.facts()) {
                self.symbols = before;
                if let Some(signal) = self.plans.grid().goal(context.mission, id, self.facts()) {
                    context.report.note(self.plans.conflict(signal));
                }
                return self.fail(owner, id, context);
            }
            if self.symbols != before {
                // The next choice already depends on them.
                self.sense_inputs_of_facts(context.mission);
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

    /// Records that a component is about to end at a vertex, and the work lost by an interruption
    /// there.
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

    /// Fails a component, and its behaviour with it if the whole plan fails.
    pub(crate) fn fail(&mut self, owner: Owner, id: Id, context: &mut Context<'_>) {
        if self.plans.change(context.mission, |forest, tell| forest.fail(id, tell))
            != Ended::RootFailed
        {
            return;
        }
        match owner.checked_sub(ACTIVITY).map(usize::from) {
            None => self.fail_behaviour(usize::from(owner), context),
            // A failed shut-down counts as ended.
            Some(index) if self.status(index).phase == Phase::ShuttingDown => {
                self.end_plan(owner, context);
            }
            Some(index) => self.fail_behaviour(index, context),
        }
    }

    /// Handles the end of a whole plan: a behaviour's own, or an activity's.
    fn end_plan(&mut self, owner: Owner, context: &mut Context<'_>) {
        let Some(index) = owner.checked_sub(ACTIVITY).map(usize::from) else {
            let index = usize::from(owner);
            self.set_phase(index, Phase::Idle);
            let behaviour = context.mission.behaviours().get(index);
            if let Some(status) = self.statuses.get_mut(index)
                && behaviour.is_some_and(|behaviour| behaviour.once)
            {
                status.rests_until_us = u64::MAX;
            }
            context.finished |= behaviour_bit(index);
            context.report.note(Decision::Finished { behaviour: owner });
            return;
        };
        match self.status(index).phase {
            Phase::StartingUp => self.begin_work(index, context),
            _ => {
                self.set_phase(index, Phase::Sleeping);
                // What its shut-down has given up.
                self.drop_violated(index);
            }
        }
    }
}
