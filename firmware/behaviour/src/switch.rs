//! Engaging, interrupting and waking behaviours: carries out what [`crate::choose`] decides.

use crate::choose::{Claim, Effects};
use crate::report::Decision;
use crate::{ACTIVITY, Behaviours, Context, Phase, Status, behaviour_bit, behaviours_in};
use monitor::{Signal, Violation};
use parts::bits::Slots;
use parts::{Component, Life, Owner};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_DEPTH};
use plan_format::mission::{Behaviour, Condition, Mission, Symbol};

impl Behaviours {
    /// Engages the most critical behaviours that share no resource, each as soon as the behaviours
    /// that block it can be interrupted.
    ///
    /// While a behaviour waits, others that have got out of its way begin nothing. Otherwise it would
    /// wait for them again and again.
    pub(crate) fn engage(&mut self, context: &mut Context<'_>) {
        let awaited_before = core::mem::take(&mut self.plans.awaited);
        let (mut taken, mut aside, mut held_back) = (0, 0, 0);
        // By reference: the drop of a `heapless::Vec` iterator has a panic path.
        for claim in &self.claims(context.mission) {
            let bit = behaviour_bit(claim.index);
            let is_aside = aside & bit != 0 && !claim.is_urgent;
            let waits = if claim.is_engaged {
                taken |= claim.resources;
                held_back |= if is_aside { bit } else { 0 };
                // One that has become urgent since waits no more.
                let waits = (self.refused | self.deferring) & bit != 0 && !claim.is_urgent;
                if waits {
                    taken |= self.wait_for_protecting(claim, context);
                }
                waits
            } else if taken & claim.resources == 0 && !is_aside {
                self.claim_or_stand_in(claim, &mut taken, context);
                self.engaged & bit == 0
            } else {
                false
            };
            if waits {
                aside |= awaited_before & !self.plans.awaited;
            }
        }
        // A behaviour that is still in somebody's way goes on, to get out of it.
        self.held_back = held_back & !self.plans.awaited;
        self.plans.awaited |= aside;
    }

    /// An engaged behaviour waits for others that protect what it is about to change: at a vertex
    /// it is put to sleep until then. Returns the resources that those others need meanwhile, at
    /// its priority.
    fn wait_for_protecting(&mut self, claim: &Claim, context: &mut Context<'_>) -> u16 {
        let bit = behaviour_bit(claim.index);
        let Some(behaviour) = context.mission.behaviours().get(claim.index) else { return 0 };
        let protecting = self.protecting(claim.index, Effects::of(context.mission, &behaviour));
        self.plans.awaited |= protecting;
        let is_active = self.status(claim.index).phase == Phase::Active;
        let by = behaviours_in(protecting).next();
        if let Some(by) =
            by.filter(|_| self.refused & bit != 0 && is_active && !self.is_acting(claim.index))
        {
            let by = Claim { index: by, ..*claim };
            self.interrupt(claim.index, &by, context);
        }
        self.resources_of(protecting)
    }

    /// Lets a behaviour claim the robot. If others that share no resource with it protect what it
    /// may change, they go first, at its priority: engaged ones go on, sleeping ones resume in its
    /// place. If sleeping ones exclude each other in a circle, the claim overrules them.
    fn claim_or_stand_in(&mut self, claim: &Claim, taken: &mut u16, context: &mut Context<'_>) {
        let Some(behaviour) = context.mission.behaviours().get(claim.index) else { return };
        let effects = Effects::of(context.mission, &behaviour);
        let Some(by) = self.claim_for(claim, effects, taken, context) else { return };
        *taken |= self.resources_of(by & self.engaged);
        let mut goes_on = by & self.engaged != 0;
        let mut all_effects = effects;
        let (mut waiting, mut asked) = (by, behaviour_bit(claim.index));
        // Each round asks another behaviour.
        for _ in 0..MAX_BEHAVIOURS {
            let Some(index) = behaviours_in(waiting & self.holding() & !asked).next() else {
                break;
            };
            asked |= behaviour_bit(index);
            let in_its_place = Claim { index, resources: self.status(index).resources, ..*claim };
            if *taken & in_its_place.resources != 0 {
                // Another one with at least this priority runs first.
                goes_on = true;
                continue;
            }
            if let Some(behaviour) = context.mission.behaviours().get(index) {
                all_effects = all_effects.and(Effects::of(context.mission, &behaviour));
            }
            match self.claim_for(&in_its_place, all_effects, taken, context) {
                None => goes_on = true,
                Some(more) => {
                    *taken |= self.resources_of(more & self.engaged);
                    goes_on |= more & self.engaged != 0;
                    waiting |= more;
                }
            }
        }
        if goes_on {
            // No other one takes what it needs meanwhile.
            *taken |= claim.resources;
        } else {
            for index in behaviours_in(by) {
                let (behaviour, by) = (index as u8, claim.index as u8);
                context.report.note(Decision::Overruled { behaviour, by });
            }
            self.drop_held(by, effects);
            self.claim_for(claim, effects, taken, context);
        }
    }

    /// Sleeping behaviours no longer protect what these effects may violate. When they wake, their
    /// plans are compared with the world.
    fn drop_held(&mut self, victims: u16, effects: Effects) {
        for index in behaviours_in(victims) {
            if let Some(status) = self.statuses.get_mut(index) {
                status.held = effects.spared(status.held);
            }
        }
    }

    /// Handles the claim of one behaviour that no higher-priority claim blocks. Those that block it
    /// yield where `all_effects` violate nothing that they protect: its own, and those of the
    /// behaviours in whose place it resumes. Returns the behaviours that exclude it, one bit each;
    /// `None` if it is engaged, or will be next.
    fn claim_for(
        &mut self,
        claim: &Claim,
        all_effects: Effects,
        taken: &mut u16,
        context: &mut Context<'_>,
    ) -> Option<u16> {
        let behaviour = context.mission.behaviours().get(claim.index)?;
        let blocking = self.blocking(claim);
        let effects = Effects::of(context.mission, &behaviour);
        let excluding = self.excluding(claim, effects, blocking, context);
        if claim.is_urgent {
            self.drop_held(excluding & self.asleep, effects);
        } else {
            // Those that run are asked at each of their vertices.
            self.plans.awaited |= blocking | excluding & self.engaged;
            if excluding != 0 {
                return Some(excluding);
            }
        }
        let yielding = if claim.is_urgent {
            blocking
        } else {
            self.yielding(claim, all_effects, blocking, context)
        };
        let mut must_wait = yielding != blocking;
        for other in behaviours_in(yielding) {
            must_wait |= self.interrupt(other, claim, context);
        }
        // A claim of lower priority must not interrupt those that have to finish something first.
        let protecting = self.protecting(claim.index, all_effects) & blocking;
        *taken |= claim.resources | self.resources_of(protecting);
        if !must_wait {
            self.begin(claim.index, &behaviour, context);
        }
        None
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
        if status.phase == Phase::Active {
            self.turn_clocks(owner);
            if let Some(status) = self.statuses.get_mut(index) {
                status.left = context.seen.position;
            }
        }
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

    /// Turns the start times of an owner's timed frames into how long they have lasted, or back.
    fn turn_clocks(&mut self, owner: Owner) {
        for id in self.timed.iter() {
            let is_own = self.plans.forest.get(id).is_some_and(|frame| frame.owner == owner);
            if let Some(started_us) = self.started_us.get_mut(usize::from(id)).filter(|_| is_own) {
                *started_us = self.now_us.saturating_sub(*started_us);
            }
        }
    }

    /// The lost work of the actions that run now and of the frames above them.
    fn work_under_way(&self, mission: &Mission<'_>, owner: Owner) -> u16 {
        let forest = &self.plans.forest;
        let (mut sum, mut counted) = (0_u16, Slots::NONE);
        for action in forest.running_of(owner) {
            let mut next = Some(action);
            while let Some(id) = next {
                let component = forest.get(id).filter(|component| component.owner == owner);
                // Parallel actions share frames, which count once.
                let Some(component) = component.filter(|_| !counted.contains(id)) else { break };
                counted.insert(id);
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
            self.turn_clocks(owner);
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
            context.report.note(self.plans.conflict(signal));
            self.plans.change(context.mission, |forest, tell| forest.begin_anew(frame, tell));
        }
    }

    /// The deviation closest to the root, and the frame that has to start again.
    fn outermost_deviation(&self, mission: &Mission<'_>, owner: Owner) -> Option<(Signal, u8)> {
        let grid = self.plans.grid();
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
        for (id, entry) in grid.of(owner) {
            let is_action = matches!(entry.symbol, Symbol::Action(_));
            if entry.life == Life::Scheduled && is_action {
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
