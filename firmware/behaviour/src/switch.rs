//! Engaging, interrupting and waking behaviours: carries out what [`crate::choose`] decides.

use crate::choose::{Claim, Effects};
use crate::report::Decision;
use crate::{ACTIVITY, Behaviours, Context, Phase, Status, behaviour_bit, behaviours_in};
use monitor::{Signal, Violation};
use parts::{Component, Life, Owner};
use plan_format::limits::MAX_DEPTH;
use plan_format::mission::{Behaviour, Condition, Mission, Symbol};

/// The result of a claim.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// It is engaged, or will be next.
    Holds,
    /// These behaviours protect facts that it may change, one bit each.
    Excluded(u16),
}

impl Behaviours {
    /// Engages the most critical behaviours that share no resource, each as soon as the behaviours
    /// that block it can be interrupted.
    pub(crate) fn engage(&mut self, context: &mut Context<'_>) {
        self.plans.awaited = 0;
        let mut taken = 0;
        // By reference: the drop of a `heapless::Vec` iterator has a panic path.
        for claim in &self.claims(context.mission) {
            if claim.is_engaged {
                taken |= claim.resources;
            } else if taken & claim.resources == 0 {
                self.claim_or_resume_sleeper(claim, &mut taken, context);
            }
        }
    }

    /// Lets a behaviour claim the robot. If sleeping behaviours exclude it, they resume in its
    /// place, at its priority, so that they finish what they protect.
    fn claim_or_resume_sleeper(
        &mut self,
        claim: &Claim,
        taken: &mut u16,
        context: &mut Context<'_>,
    ) {
        let by = match self.claim(claim, context) {
            Outcome::Holds => {
                *taken |= claim.resources;
                return;
            }
            Outcome::Excluded(by) => by,
        };
        for index in behaviours_in(by & self.holding()) {
            let in_its_place = Claim { index, resources: self.status(index).resources, ..*claim };
            if *taken & in_its_place.resources == 0
                && self.claim(&in_its_place, context) == Outcome::Holds
            {
                *taken |= in_its_place.resources;
            }
        }
    }

    /// Handles the claim of one behaviour that no higher-priority claim blocks.
    fn claim(&mut self, claim: &Claim, context: &mut Context<'_>) -> Outcome {
        let Some(behaviour) = context.mission.behaviours().get(claim.index) else {
            return Outcome::Excluded(0);
        };
        let blocking = self.blocking(claim);
        let effects = Effects::of(context.mission, &behaviour);
        let excluding = self.excluding(claim, effects, blocking, context);
        if excluding != 0 && !claim.is_urgent {
            return Outcome::Excluded(excluding);
        }
        if !claim.is_urgent {
            self.plans.awaited |= blocking;
        }
        let yielding = if claim.is_urgent {
            blocking
        } else {
            self.yielding(claim, effects, blocking, context)
        };
        let mut must_wait = yielding != blocking;
        for other in behaviours_in(yielding) {
            must_wait |= self.interrupt(other, claim, context);
        }
        if !must_wait {
            self.begin(claim.index, &behaviour, context);
        }
        Outcome::Holds
    }

    /// Puts an engaged behaviour to sleep for the claim `by`. Returns whether the claim has to wait
    /// for the shut-down activity.
    fn interrupt(&mut self, index: usize, by: &Claim, context: &mut Context<'_>) -> bool {
        let (owner, status) = (index as Owner, self.status(index));
        let lost_work = if by.is_urgent {
            self.work_under_way(context.mission, owner)
        } else {
            status.lost_work
        };
        let behaviour = context.mission.behaviours().get(index);
        self.plans.change(context.mission, |forest, tell| {
            forest.uproot(owner + ACTIVITY, tell);
            forest.suspend(owner, tell);
        });
        let shut_down = behaviour
            .and_then(|behaviour| behaviour.shut_down)
            .filter(|_| !by.is_urgent && status.phase == Phase::Active);
        let waits = shut_down.is_some_and(|frame| {
            self.plans
                .change(context.mission, |forest, tell| forest.plant(owner + ACTIVITY, frame, tell))
                .is_some()
        });
        let has_plan = self.plans.forest.root(owner).is_some();
        self.set_phase(
            index,
            match (waits, has_plan) {
                (true, _) => Phase::ShuttingDown,
                (false, true) => Phase::Sleeping,
                (false, false) => Phase::Idle,
            },
        );
        let held = if by.is_urgent { Condition::default() } else { self.held_by(owner) };
        if let Some(status) = self.statuses.get_mut(index) {
            status.held = held;
        }
        context.report.note(Decision::Interrupted {
            behaviour: index as u8,
            by: by.index as u8,
            is_unconditional: by.is_urgent,
            lost_work,
        });
        waits
    }

    /// The lost work of the actions that run now and of the frames above them.
    fn work_under_way(&self, mission: &Mission<'_>, owner: Owner) -> u16 {
        let forest = &self.plans.forest;
        let (mut sum, mut counted) = (0_u16, 0_u32);
        for action in forest.running() {
            let mut next = Some(action);
            while let Some(id) = next {
                let bit = 1_u32.wrapping_shl(u32::from(id));
                let component = forest.get(id).filter(|component| component.owner == owner);
                // Parallel actions share frames, which count once.
                let Some(component) = component.filter(|_| counted & bit == 0) else { break };
                counted |= bit;
                sum = sum.saturating_add(self.work_of(mission, component));
                next = component.parent;
            }
        }
        sum
    }

    /// The lost work of a component's edge.
    fn work_of(&self, mission: &Mission<'_>, component: &Component) -> u16 {
        let production =
            component.parent.and_then(|id| self.plans.forest.production_of(mission, id));
        let edge = production.and_then(|production| {
            let first = usize::from(production.first_edge);
            mission.edges().get(first + usize::from(component.edge))
        });
        edge.map_or(0, |edge| edge.work)
    }

    /// Engages a behaviour: its start-up activity first, if it has one.
    fn begin(&mut self, index: usize, behaviour: &Behaviour, context: &mut Context<'_>) {
        let now_us = self.now_us;
        if let Some(status) = self.statuses.get_mut(index) {
            status.engaged_us = now_us;
            status.held = Condition::default();
        }
        let Some(frame) = behaviour.start_up else {
            return self.begin_work(index, context);
        };
        let owner = index as Owner + ACTIVITY;
        if self
            .plans
            .change(context.mission, |forest, tell| forest.plant(owner, frame, tell))
            .is_some()
        {
            self.set_phase(index, Phase::StartingUp);
            context.report.note(Decision::Prepared { behaviour: index as u8 });
        } else {
            self.fail_behaviour(index, context);
        }
    }

    /// Resumes a behaviour's own plan if it sleeps; otherwise plants a new one.
    pub(crate) fn begin_work(&mut self, index: usize, context: &mut Context<'_>) {
        let (owner, behaviour) = (index as Owner, index as u8);
        if self.plans.forest.root(owner).is_some() {
            self.plans.change(context.mission, |forest, tell| forest.resume(owner, tell));
            self.set_phase(index, Phase::Active);
            context.report.note(Decision::Resumed { behaviour });
            self.restart_deviating(owner, context);
            return;
        }
        let root = context.mission.behaviours().get(index).map_or(0, |behaviour| behaviour.root);
        if self
            .plans
            .change(context.mission, |forest, tell| forest.plant(owner, root, tell))
            .is_some()
        {
            self.set_phase(index, Phase::Active);
            if let Some(status) = self.statuses.get_mut(index) {
                status.lost_work = 0;
            }
            context.report.note(Decision::Engaged { behaviour });
        } else {
            self.fail_behaviour(index, context);
        }
    }

    /// Compares a plan that has just woken with the world. If they differ, the outermost frame
    /// concerned starts again.
    fn restart_deviating(&mut self, owner: Owner, context: &mut Context<'_>) {
        // Each round abandons at least one level.
        for _ in 0..MAX_DEPTH {
            let Some((signal, frame)) = self.outermost_deviation(context.mission, owner) else {
                return;
            };
            context.report.note(Decision::Conflict(signal));
            self.plans.change(context.mission, |forest, tell| forest.begin_anew(frame, tell));
        }
    }

    /// The deviation closest to the root, and the frame that has to start again.
    fn outermost_deviation(&self, mission: &Mission<'_>, owner: Owner) -> Option<(Signal, u8)> {
        let grid = &self.plans.grid;
        let facts = self.facts();
        let mut found: Option<(usize, Signal, u8)> = None;
        let mut consider = |signal: Signal| {
            let Signal::Evident { id, what, .. } = signal else { return };
            let parent = grid.get(id).and_then(|entry| entry.parent);
            let frame = if what == Violation::Interval { id } else { parent.unwrap_or(id) };
            // A frame that waits for its decomposition has started again already.
            let is_decomposed = grid.get(frame).is_some_and(|entry| entry.production.is_some());
            let depth = grid.above(frame).count();
            if is_decomposed && found.is_none_or(|(shallowest, ..)| depth < shallowest) {
                found = Some((depth, signal, frame));
            }
        };
        grid.evident(owner, facts).for_each(&mut consider);
        for (id, entry) in grid.iter() {
            let is_action = matches!(entry.symbol, Symbol::Action(_));
            if entry.owner == owner && entry.life == Life::Scheduled && is_action {
                grid.initial(mission, id, facts).into_iter().for_each(&mut consider);
            }
        }
        found.map(|(_, signal, frame)| (signal, frame))
    }

    /// Fails a behaviour: abandons its plans and starts its rest.
    pub(crate) fn fail_behaviour(&mut self, index: usize, context: &mut Context<'_>) {
        let owner = index as Owner;
        let now_us = self.now_us;
        self.plans.change(context.mission, |forest, tell| {
            forest.uproot(owner, tell);
            forest.uproot(owner + ACTIVITY, tell);
        });
        self.set_phase(index, Phase::Idle);
        if let Some(status) = self.statuses.get_mut(index) {
            status.rests_until_us = now_us.saturating_add(crate::REST_US);
        }
        context.report.note(Decision::Failed { behaviour: index as u8 });
    }

    pub(crate) fn set_phase(&mut self, index: usize, phase: Phase) {
        if let Some(status) = self.statuses.get_mut(index) {
            status.phase = phase;
            let (bit, is_engaged) = (behaviour_bit(index), status.is_engaged());
            self.engaged = if is_engaged { self.engaged | bit } else { self.engaged & !bit };
            let is_asleep = phase == Phase::Sleeping;
            self.asleep = if is_asleep { self.asleep | bit } else { self.asleep & !bit };
        }
    }

    pub(crate) fn status(&self, index: usize) -> Status {
        self.statuses.get(index).copied().unwrap_or_default()
    }
}
