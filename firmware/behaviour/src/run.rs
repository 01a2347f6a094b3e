//! Advances the plans of engaged behaviours.

use crate::choose::Effects;
use crate::inputs::is_reached;
use crate::report::{Decision, Refusal};
use crate::{Behaviours, Context, behaviour_bit, behaviours_in};
use grammar::Choice;
use heapless::Vec;
use parts::{Component, Id, Life, Owner};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS, MAX_STEPS};
use plan_format::mission::{Action, ActionKind, Condition, Mission, PlanFrame, Production, Symbol};

/// Most atomic actions that run at once; further ones wait.
pub const MAX_RUNNING: usize = 8;

/// An atomic action that runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunningAction {
    /// The behaviour to which it belongs.
    pub behaviour: u8,
    /// Its slot in the pool of components.
    pub component: Id,
    /// Its index in the mission.
    pub action: u16,
    /// What it does.
    pub kind: ActionKind,
    /// Maximum speed, m/s; infinite for none.
    pub max_speed_mps: f32,
    /// Minimum distance from obstacles, metres; 0 for none.
    pub min_distance_m: f32,
}

/// The atomic actions that run in this tick, by behaviour.
pub type Running = Vec<RunningAction, MAX_RUNNING>;

impl Behaviours {
    /// Advances the plan of every engaged behaviour by at most `MAX_STEPS` steps.
    pub(crate) fn run(&mut self, context: &mut Context<'_>) -> Running {
        let mut running = Running::new();
        let mut is_busy = false;
        self.plans.reached = 0;
        self.signal = None;
        // Those that were refused go first, so that no other forestalls them again.
        let refused = core::mem::take(&mut self.refused);
        for index in behaviours_in(self.engaged & refused) {
            is_busy |= self.advance_behaviour(index, context);
        }
        for index in behaviours_in(self.engaged & !refused) {
            if self.held_back & behaviour_bit(index) == 0 || self.is_acting(index) {
                is_busy |= self.advance_behaviour(index, context);
            }
        }
        for index in behaviours_in(self.engaged) {
            if let Some(owner) = self.running_owner(index) {
                self.collect(context.mission, index as u8, owner, &mut running);
            }
        }
        self.is_driving = running.iter().any(|part| is_driving(part.kind));
        // A busy tick skips the doubts, to bound its time.
        if !is_busy {
            self.doubt(context);
        }
        running
    }

    fn advance_behaviour(&mut self, index: usize, context: &mut Context<'_>) -> bool {
        let Some(owner) = self.running_owner(index) else { return false };
        let is_busy = self.advance(owner, context);
        // If its start-up has ended at once, its own plan runs in this tick.
        match self.running_owner(index).filter(|&next| next != owner) {
            Some(next) => self.advance(next, context) || is_busy,
            None => is_busy,
        }
    }

    /// Whether a symbol is a signal and another one has begun in this tick.
    fn is_unheard(&self, mission: &Mission<'_>, symbol: Symbol) -> bool {
        let Symbol::Action(index) = symbol else { return false };
        self.signal.is_some()
            && mission
                .actions()
                .get(usize::from(index))
                .is_some_and(|action| is_reported(action.kind))
    }

    /// Whether an action may not start yet, because another engaged behaviour protects what its end
    /// may violate. Reported; the next tick decides who goes first.
    fn is_refused(&mut self, owner: Owner, symbol: Symbol, context: &mut Context<'_>) -> bool {
        let index = usize::from(owner);
        let is_bound = matches!(symbol, Symbol::Action(_))
            && index < MAX_BEHAVIOURS
            && !self.status(index).is_urgent
            && self.engaged != behaviour_bit(index);
        let Some(description) = context.mission.description(symbol).filter(|_| is_bound) else {
            return false;
        };
        let protecting = self.protecting(index, Effects::at_end(description));
        self.refuse(owner, protecting, context);
        if protecting != 0 {
            self.refused |= behaviour_bit(index);
        }
        protecting != 0
    }

    /// Reports that an engaged behaviour waits for others that protect something.
    pub(crate) fn refuse(&self, behaviour: Owner, protecting: u16, context: &mut Context<'_>) {
        for other in behaviours_in(protecting) {
            let (by, why) = (other as u8, Refusal::Excluded);
            context.report.note(Decision::Refused { behaviour, by, why });
        }
    }

    /// Decomposes scheduled frames and starts scheduled actions, in at most `MAX_STEPS` steps.
    /// Returns whether there was a step.
    fn advance(&mut self, owner: Owner, context: &mut Context<'_>) -> bool {
        for step in 0..MAX_STEPS {
            let Some(id) = self.plans.forest.scheduled(owner) else { return step > 0 };
            let symbol = self.plans.forest.get(id).map(|component| component.symbol);
            if matches!(symbol, Some(Symbol::Action(_)))
                && self.plans.forest.running().count() >= MAX_RUNNING
            {
                return step > 0;
            }
            if let Some(signal) = self.plans.grid().initial(context.mission, id, self.facts()) {
                context.report.note(self.plans.conflict(signal));
                self.fail(owner, id, context);
                continue;
            }
            if symbol.is_some_and(|symbol| {
                self.is_unheard(context.mission, symbol) || self.is_refused(owner, symbol, context)
            }) {
                return step > 0;
            }
            match symbol {
                Some(Symbol::PlanFrame(frame)) => self.decompose(owner, id, frame, context),
                Some(Symbol::Action(_)) => self.start(owner, id, context),
                None => return true,
            }
            // Another behaviour waits for this vertex: start nothing before it is decided.
            let bit = behaviour_bit(usize::from(owner));
            if self.plans.awaited & self.plans.reached & bit != 0 {
                return true;
            }
        }
        true
    }

    fn decompose(&mut self, owner: Owner, id: Id, frame: u16, context: &mut Context<'_>) {
        let Some(record) = context.mission.plan_frames().get(usize::from(frame)) else { return };
        if is_reached(record.until, self.facts()) {
            return self.complete(owner, id, context);
        }
        if (record.timeout_ms != 0 || !record.until.is_empty()) && self.plans.forest.is_new(id) {
            self.timed.insert(id);
            if let Some(started_us) = self.started_us.get_mut(usize::from(id)) {
                *started_us = self.now_us;
            }
        }
        let (id, choice) = self.choose_production(owner, id, &record, context);
        match choice {
            Choice::Production(_) => {}
            Choice::LoopEnded => self.complete(owner, id, context),
            Choice::NothingApplicable | Choice::NoRoom | Choice::TooDeep => {
                context.report.note(Decision::NotDecomposed { frame, why: choice });
                self.fail(owner, id, context);
            }
            Choice::NotScheduled => {}
        }
    }

    /// Lets a frame choose a production: preferably one without a part that may violate what its
    /// own plan or a sleeping behaviour protects now.
    fn choose_production(
        &mut self,
        owner: Owner,
        id: Id,
        frame: &PlanFrame,
        context: &mut Context<'_>,
    ) -> (Id, Choice) {
        let held = if frame.count > 1 {
            self.foreign().and(self.held_by(owner))
        } else {
            // There is nothing to prefer.
            Condition::default()
        };
        let (id, choice, is_last) = self.choose_sparing(id, held, context);
        if is_last {
            return (id, choice);
        }
        // Only doubtful productions are left.
        let (id, choice, _) = self.choose_sparing(id, Condition::default(), context);
        (id, choice)
    }

    /// Lets a frame choose among the productions that spare what is held. Also returns whether the
    /// choice is final: it would be the same among all productions, or one was taken.
    fn choose_sparing(
        &mut self,
        id: Id,
        held: Condition,
        context: &mut Context<'_>,
    ) -> (Id, Choice, bool) {
        let (senses, mission) = (&self.senses, context.mission);
        let (mut best, mut is_final) = (0.0, true);
        let mut applicability = |_: u16, production: &Production| {
            if !held.is_empty() && monitor::endangers(mission, production, held) != 0 {
                is_final = false;
                return f32::NEG_INFINITY;
            }
            let value = production.rules.map_or(1.0, |rules| senses.infer(mission, rules));
            best = value.max(best);
            value
        };
        let plans = &mut self.plans;
        let (id, choice) = plans.change(mission, |forest, tell| {
            forest.decompose(mission, id, &mut applicability, tell)
        });
        if let Choice::Production(production) = choice {
            context.report.note(Decision::Chose { production, applicability: best });
            is_final = true;
        }
        (id, choice, is_final)
    }

    fn start(&mut self, owner: Owner, id: Id, context: &mut Context<'_>) {
        self.plans.change(context.mission, |forest, tell| forest.start(id, tell));
        if let Some(started_us) = self.started_us.get_mut(usize::from(id)) {
            *started_us = self.now_us;
        }
        let Some((_, action)) = self.running_action(context.mission, owner, id) else { return };
        match action.kind {
            ActionKind::SetOutput { output, is_on } => {
                let bit = 1_u16.checked_shl(u32::from(output)).unwrap_or(0);
                self.outputs = if is_on { self.outputs | bit } else { self.outputs & !bit };
            }
            ActionKind::Signal { .. } => self.signal = Some(id),
            kind if is_driving(kind) => self.senses.forget_progress(),
            _ => {}
        }
        if !is_reported(action.kind) && self.is_done(owner, &action, self.now_us, context.seen) {
            self.complete(owner, id, context);
        }
    }

    /// Reports the doubts about one component of a running plan, in turn. Doubts are early
    /// warnings: bounded work per tick matters more than promptness, and a component is checked
    /// anyway when it starts.
    fn doubt(&mut self, context: &mut Context<'_>) {
        let after = usize::from(self.last_doubt) + 1;
        let turn = (after..after + MAX_COMPONENTS).map(|id| (id % MAX_COMPONENTS) as Id);
        let is_ahead = |entry: &Component| {
            let index = usize::from(entry.owner) % MAX_BEHAVIOURS;
            matches!(entry.life, Life::Planned | Life::Scheduled)
                && self.running_owner(index) == Some(entry.owner)
        };
        let mut ahead = turn.filter(|&id| self.plans.grid().get(id).is_some_and(is_ahead));
        let Some(id) = ahead.next() else { return };
        self.last_doubt = id;
        let (plans, grid) = (&self.plans, self.plans.grid());
        let mut note = |signal| context.report.note(plans.conflict(signal));
        grid.possible(context.mission, id, self.facts(), &mut note);
        grid.choices(context.mission, id, self.foreign(), &mut note);
    }

    /// What all sleeping behaviours protect together.
    fn foreign(&self) -> Condition {
        behaviours_in(self.holding())
            .fold(Condition::default(), |all, index| all.and(self.status(index).held))
    }

    fn collect(&self, mission: &Mission<'_>, behaviour: u8, owner: Owner, running: &mut Running) {
        for component in self.plans.forest.running_of(owner) {
            let Some((index, action)) = self.running_action(mission, owner, component) else {
                continue;
            };
            // A new signal drowns one that waits.
            let is_drowned = self.signal.is_some_and(|newest| newest != component);
            if is_reported(action.kind) && is_drowned {
                continue;
            }
            let (max_speed_mps, min_distance_m) = self.plans.grid().constraints(mission, component);
            // At most `MAX_RUNNING` actions run.
            let _ = running.push(RunningAction {
                behaviour,
                component,
                action: index,
                kind: self.resolved(owner, action.kind),
                max_speed_mps,
                min_distance_m,
            });
        }
    }

    /// What an action does now: a return is a drive to the place that the behaviour has left.
    fn resolved(&self, owner: Owner, kind: ActionKind) -> ActionKind {
        match (kind, self.left_by(owner)) {
            (ActionKind::Return, Some(place)) => ActionKind::GoTo { x_m: place.x, y_m: place.y },
            _ => kind,
        }
    }

    /// The action in a slot, with its index in the mission, if it runs for this owner.
    pub(crate) fn running_action(
        &self,
        mission: &Mission<'_>,
        owner: Owner,
        id: Id,
    ) -> Option<(u16, Action)> {
        let component = self.plans.forest.get(id)?;
        match component.symbol {
            Symbol::Action(index) if component.owner == owner && component.is_running() => {
                Some((index, mission.actions().get(usize::from(index))?))
            }
            _ => None,
        }
    }
}

/// Whether an action drives the robot.
fn is_driving(kind: ActionKind) -> bool {
    matches!(
        kind,
        ActionKind::Follow { .. }
            | ActionKind::GoTo { .. }
            | ActionKind::Wander { .. }
            | ActionKind::Return
            | ActionKind::MoveAhead { .. }
            | ActionKind::Dock { .. }
    )
}

/// Whether the tick must receive an action at least once, even if it ends at once.
fn is_reported(kind: ActionKind) -> bool {
    matches!(kind, ActionKind::Signal { .. })
}
