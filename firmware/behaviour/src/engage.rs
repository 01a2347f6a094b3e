//! Who has the robot: dormant, sleeping, active, and the ways from one to the other.

use crate::report::{Decision, Refusal, Report};
use crate::{ACTIVITY, Behaviours, Phase, Status, behaviour_bit, behaviours_in};
use heapless::Vec;
use monitor::{Signal, Violation};
use parts::{Component, Life, Owner};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_DEPTH};
use plan_format::mission::{Behaviour, Condition, Facts, Mission, SwitchPoint, Symbol};

/// What engaging a behaviour may do to the facts that others protect.
#[derive(Clone, Copy)]
struct Effects {
    may_add: Facts,
    may_delete: Facts,
}

impl Effects {
    /// Of everything that a behaviour may do.
    fn of(mission: &Mission<'_>, behaviour: &Behaviour) -> Self {
        let frames = [Some(behaviour.root), behaviour.start_up, behaviour.shut_down];
        let all = frames
            .into_iter()
            .flatten()
            .filter_map(|index| mission.frames().get(usize::from(index)));
        all.fold(Self { may_add: 0, may_delete: 0 }, |effects, frame| Self {
            may_add: effects.may_add | frame.may_add,
            may_delete: effects.may_delete | frame.may_delete,
        })
    }

    fn endanger(self, held: Condition) -> bool {
        held.must & self.may_delete != 0 || held.must_not & self.may_add != 0
    }

    /// Whether there are none.
    fn is_empty(self) -> bool {
        self.may_add | self.may_delete == 0
    }
}

/// A behaviour that wants the robot, or has it.
#[derive(Clone, Copy)]
struct Claim {
    index: usize,
    resources: u16,
    is_engaged: bool,
    is_urgent: bool,
    weight: f32,
}

impl Claim {
    /// Whether it goes before another that comes later in the mission.
    fn outranks(&self, other: &Self) -> bool {
        if self.is_urgent != other.is_urgent {
            return self.is_urgent;
        }
        // Among equals, whoever has the robot keeps it.
        self.weight > other.weight
            || self.weight == other.weight && (self.is_engaged || !other.is_engaged)
    }
}

/// What came of a claim.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// It is engaged, or the next to be.
    Holds,
    /// Others protect what it may violate: these, one bit each.
    Excluded(u16),
}

impl Behaviours {
    /// Engages the most critical behaviours whose resources do not conflict, each as soon as those
    /// in its way can be interrupted.
    pub(crate) fn engage(&mut self, mission: &Mission<'_>, report: &mut Report) {
        self.plans.awaited = 0;
        let mut taken = 0;
        // By reference: the loop over a `heapless::Vec` itself may panic where it is dropped.
        for claim in &self.claims(mission) {
            if claim.is_engaged {
                taken |= claim.resources;
            } else if taken & claim.resources == 0 {
                self.claim_or_stand_back(mission, claim, &mut taken, report);
            }
        }
    }

    /// Lets a behaviour claim the robot. If sleeping ones exclude it they go on in its place, so that
    /// they come to give up what they protect, however little critical they are themselves.
    fn claim_or_stand_back(
        &mut self,
        mission: &Mission<'_>,
        claim: &Claim,
        taken: &mut u16,
        report: &mut Report,
    ) {
        let by = match self.claim(mission, claim, report) {
            Outcome::Holds => {
                *taken |= claim.resources;
                return;
            }
            Outcome::Excluded(by) => by,
        };
        for index in behaviours_in(by & self.holding()) {
            let in_its_place = Claim { index, resources: self.status(index).resources, ..*claim };
            if *taken & in_its_place.resources == 0
                && self.claim(mission, &in_its_place, report) == Outcome::Holds
            {
                *taken |= in_its_place.resources;
            }
        }
    }

    /// Everyone who wants the robot, the weightiest first, among equals by index.
    fn claims(&self, mission: &Mission<'_>) -> Vec<Claim, MAX_BEHAVIOURS> {
        let mut claims: Vec<Claim, MAX_BEHAVIOURS> = Vec::new();
        let statuses = self.statuses.iter().take(mission.behaviours().len());
        for (index, status) in statuses.enumerate() {
            let is_engaged = status.is_engaged();
            if !is_engaged && (status.is_dormant || self.now_us < status.rests_until_us) {
                continue;
            }
            let claim = Claim {
                index,
                resources: status.resources,
                is_engaged,
                is_urgent: status.is_urgent,
                weight: if status.is_dormant { 0.0 } else { status.weight },
            };
            let at = claims.iter().position(|other| !other.outranks(&claim));
            // There are as many places as behaviours.
            let _ = claims.insert(at.unwrap_or(claims.len()), claim);
        }
        claims
    }

    /// One behaviour wants the robot and nobody weightier is in its way.
    fn claim(&mut self, mission: &Mission<'_>, claim: &Claim, report: &mut Report) -> Outcome {
        let Some(behaviour) = mission.behaviours().get(claim.index) else {
            return Outcome::Excluded(0);
        };
        let in_the_way = self.in_the_way(claim);
        let effects = Effects::of(mission, &behaviour);
        let excluding = self.excluding(claim, effects, in_the_way, report);
        if excluding != 0 && !claim.is_urgent {
            return Outcome::Excluded(excluding);
        }
        if !claim.is_urgent {
            self.plans.awaited |= in_the_way;
        }
        let yielding = if claim.is_urgent {
            in_the_way
        } else {
            self.yielding(mission, claim, effects, in_the_way, report)
        };
        let mut must_wait = yielding != in_the_way;
        for other in behaviours_in(yielding) {
            must_wait |= self.interrupt(mission, other, claim, report);
        }
        if !must_wait {
            self.begin(mission, claim.index, &behaviour, report);
        }
        Outcome::Holds
    }

    /// The engaged behaviours that need what a claim needs, one bit each.
    fn in_the_way(&self, claim: &Claim) -> u16 {
        let others = self.engaged & !behaviour_bit(claim.index);
        behaviours_in(others)
            .filter(|&index| self.status(index).resources & claim.resources != 0)
            .fold(0, |set, index| set | behaviour_bit(index))
    }

    /// Those who are not in the way but protect what would suffer, one bit each. That they do is
    /// noted of what is urgent, too, though it does not keep it out.
    fn excluding(
        &self,
        claim: &Claim,
        effects: Effects,
        in_the_way: u16,
        report: &mut Report,
    ) -> u16 {
        let mut excluding = 0;
        if effects.is_empty() {
            return excluding;
        }
        let aside = in_the_way | behaviour_bit(claim.index);
        for index in behaviours_in((self.engaged | self.holding()) & !aside) {
            if !self.endangers_held(index, effects) {
                continue;
            }
            excluding |= behaviour_bit(index);
            let (behaviour, by) = (claim.index as u8, index as u8);
            report.note(if claim.is_urgent {
                Decision::Overruled { behaviour: by, by: behaviour }
            } else {
                Decision::Refused { behaviour, by, why: Refusal::Excluded }
            });
        }
        excluding
    }

    /// Those in the way that can be interrupted now, one bit each; the others' reasons are noted.
    fn yielding(
        &self,
        mission: &Mission<'_>,
        claim: &Claim,
        effects: Effects,
        in_the_way: u16,
        report: &mut Report,
    ) -> u16 {
        let mut yielding = in_the_way;
        let mut is_soon = true;
        for other in behaviours_in(in_the_way) {
            let Some(why) = self.keeps_the_robot(mission, other, effects) else { continue };
            let (behaviour, by) = (claim.index as u8, other as u8);
            report.note(Decision::Refused { behaviour, by, why });
            yielding &= !behaviour_bit(other);
            is_soon &= matches!(why, Refusal::NoPointYet | Refusal::ShuttingDown);
        }
        // Nobody sleeps in vain while another takes its time.
        if is_soon { yielding } else { 0 }
    }

    /// Why an engaged behaviour does not yield to another now.
    fn keeps_the_robot(
        &self,
        mission: &Mission<'_>,
        index: usize,
        effects: Effects,
    ) -> Option<Refusal> {
        let behaviour = mission.behaviours().get(index)?;
        let status = self.status(index);
        let ran_us = self.now_us.saturating_sub(status.engaged_us);
        match status.phase {
            Phase::ShuttingDown => return Some(Refusal::ShuttingDown),
            Phase::StartingUp => return Some(Refusal::NoPointYet),
            _ if ran_us < u64::from(behaviour.dwell_ms) * 1_000 => return Some(Refusal::Dwell),
            _ => {}
        }
        if self.is_acting(index) || self.endangers_held(index, effects) {
            return Some(Refusal::NoPointYet);
        }
        let is_better_ahead = behaviour.switch_point == SwitchPoint::Best && {
            let mut is_better = false;
            self.plans.grid.points(mission, index as Owner, &mut |point| {
                is_better |= point.lost_work < status.lost_work && !effects.endanger(point.held);
            });
            is_better
        };
        is_better_ahead.then_some(Refusal::BetterPointAhead)
    }

    /// Whether a behaviour's plan, or the activity that prepares it, protects what would suffer.
    fn endangers_held(&self, index: usize, effects: Effects) -> bool {
        if effects.is_empty() {
            return false;
        }
        let status = self.status(index);
        if status.phase == Phase::Sleeping {
            return effects.endanger(status.held);
        }
        let owner = index as Owner;
        effects.endanger(self.held_by(owner))
            || status.phase != Phase::Active && effects.endanger(self.held_by(owner + ACTIVITY))
    }

    /// What the protection intervals in force in a plan protect, all together.
    fn held_by(&self, owner: Owner) -> Condition {
        self.plans.grid.held(owner).fold(Condition::default(), |all, (_, held)| all.and(held))
    }

    /// Whether some action of a behaviour's plan runs: it is between vertices.
    fn is_acting(&self, index: usize) -> bool {
        let forest = &self.plans.forest;
        let owner = |id| forest.get(id).map(|component| usize::from(component.owner));
        forest.running().any(|id| owner(id) == Some(index))
    }

    /// Puts an engaged behaviour to sleep for another. Returns whether that one has to wait for its
    /// shut-down activity.
    fn interrupt(
        &mut self,
        mission: &Mission<'_>,
        index: usize,
        by: &Claim,
        report: &mut Report,
    ) -> bool {
        let (owner, status) = (index as Owner, self.status(index));
        let lost_work =
            if by.is_urgent { self.work_under_way(mission, owner) } else { status.lost_work };
        let behaviour = mission.behaviours().get(index);
        self.plans.change(mission, |forest, tell| {
            forest.uproot(owner + ACTIVITY, tell);
            forest.suspend(owner, tell);
        });
        let shut_down = behaviour
            .and_then(|behaviour| behaviour.shut_down)
            .filter(|_| !by.is_urgent && status.phase == Phase::Active);
        let waits = shut_down.is_some_and(|frame| {
            self.plans
                .change(mission, |forest, tell| forest.plant(owner + ACTIVITY, frame, tell))
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
        report.note(Decision::Interrupted {
            behaviour: index as u8,
            by: by.index as u8,
            is_unconditional: by.is_urgent,
            lost_work,
        });
        waits
    }

    /// What the mission says that the actions which run now cost to do again, and the frames that
    /// they are part of.
    fn work_under_way(&self, mission: &Mission<'_>, owner: Owner) -> u16 {
        let forest = &self.plans.forest;
        let (mut sum, mut counted) = (0_u16, 0_u32);
        for action in forest.running() {
            let mut next = Some(action);
            while let Some(id) = next {
                let bit = 1_u32.wrapping_shl(u32::from(id));
                let component = forest.get(id).filter(|component| component.owner == owner);
                // What runs side by side shares its frames.
                let Some(component) = component.filter(|_| counted & bit == 0) else { break };
                counted |= bit;
                sum = sum.saturating_add(self.work_of(mission, component));
                next = component.parent;
            }
        }
        sum
    }

    /// What the edge costs to do again that a component stands for.
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
    fn begin(
        &mut self,
        mission: &Mission<'_>,
        index: usize,
        behaviour: &Behaviour,
        report: &mut Report,
    ) {
        let now_us = self.now_us;
        if let Some(status) = self.statuses.get_mut(index) {
            status.engaged_us = now_us;
            status.held = Condition::default();
        }
        let Some(frame) = behaviour.start_up else {
            return self.begin_work(mission, index, report);
        };
        let owner = index as Owner + ACTIVITY;
        if self.plans.change(mission, |forest, tell| forest.plant(owner, frame, tell)).is_some() {
            self.set_phase(index, Phase::StartingUp);
            report.note(Decision::Prepared { behaviour: index as u8 });
        } else {
            self.fail_behaviour(mission, index, report);
        }
    }

    /// Takes up a behaviour's own plan: the one that sleeps, or a new one.
    pub(crate) fn begin_work(&mut self, mission: &Mission<'_>, index: usize, report: &mut Report) {
        let (owner, behaviour) = (index as Owner, index as u8);
        if self.plans.forest.root(owner).is_some() {
            self.plans.change(mission, |forest, tell| forest.resume(owner, tell));
            self.set_phase(index, Phase::Active);
            report.note(Decision::Resumed { behaviour });
            self.mend_deviations(mission, owner, report);
            return;
        }
        let root = mission.behaviours().get(index).map_or(0, |behaviour| behaviour.root);
        if self.plans.change(mission, |forest, tell| forest.plant(owner, root, tell)).is_some() {
            self.set_phase(index, Phase::Active);
            if let Some(status) = self.statuses.get_mut(index) {
                status.lost_work = 0;
            }
            report.note(Decision::Engaged { behaviour });
        } else {
            self.fail_behaviour(mission, index, report);
        }
    }

    /// A plan that has just woken is compared with the world; where they differ, the outermost frame
    /// concerned begins anew.
    fn mend_deviations(&mut self, mission: &Mission<'_>, owner: Owner, report: &mut Report) {
        // Each round gives up at least one level.
        for _ in 0..MAX_DEPTH {
            let Some((signal, frame)) = self.outermost_deviation(mission, owner) else { return };
            report.note(Decision::Conflict(signal));
            self.plans.change(mission, |forest, tell| forest.begin_anew(frame, tell));
        }
    }

    /// The deviation nearest to the root, and the frame that has to begin anew for it.
    fn outermost_deviation(&self, mission: &Mission<'_>, owner: Owner) -> Option<(Signal, u8)> {
        let grid = &self.plans.grid;
        let facts = self.facts();
        let mut found: Option<(usize, Signal, u8)> = None;
        let mut consider = |signal: Signal| {
            let Signal::Evident { id, what, .. } = signal else { return };
            let parent = grid.get(id).and_then(|entry| entry.parent);
            let frame = if what == Violation::Interval { id } else { parent.unwrap_or(id) };
            // A frame that waits to be decomposed has begun anew already.
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

    /// A behaviour has given up: its plans are gone, and it rests.
    pub(crate) fn fail_behaviour(
        &mut self,
        mission: &Mission<'_>,
        index: usize,
        report: &mut Report,
    ) {
        let owner = index as Owner;
        let now_us = self.now_us;
        self.plans.change(mission, |forest, tell| {
            forest.uproot(owner, tell);
            forest.uproot(owner + ACTIVITY, tell);
        });
        self.set_phase(index, Phase::Idle);
        if let Some(status) = self.statuses.get_mut(index) {
            status.rests_until_us = now_us.saturating_add(crate::REST_US);
        }
        report.note(Decision::Failed { behaviour: index as u8 });
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
