//! Who has the robot: dormant, sleeping, active, and the ways from one to the other.

use crate::report::{Decision, Refusal, Report};
use crate::{ACTIVITY, Behaviours, Phase, behaviour_bit};
use grammar::Owner;
use heapless::Vec;
use monitor::{Held, Signal, Violation};
use plan_format::limits::{MAX_BEHAVIOURS, MAX_DEPTH};
use plan_format::mission::{Behaviour, Condition, Facts, Life, Mission, SwitchPoint, Symbol};

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
}

/// A behaviour in the order of the tick, and how much it weighs.
#[derive(Clone, Copy)]
struct Claim {
    index: usize,
    behaviour: Behaviour,
    weight: f32,
}

impl Behaviours {
    /// Engages the most critical behaviours whose resources do not conflict, each as soon as those
    /// in its way can be interrupted.
    pub(crate) fn engage(
        &mut self,
        mission: &Mission<'_>,
        now_us: u64,
        facts: Facts,
        report: &mut Report,
    ) {
        self.plans.pending = 0;
        let mut taken = 0;
        for claim in self.claims(mission, now_us) {
            let is_engaged = self.status(claim.index).is_engaged();
            if !is_engaged && taken & claim.behaviour.resources == 0 {
                self.claim(mission, &claim, now_us, facts, report);
            }
            // Engaged or waiting for its turn: what weighs less does not get in between.
            taken |= claim.behaviour.resources;
        }
    }

    /// Everyone who wants the robot, the weightiest first, among equals by index.
    fn claims(&self, mission: &Mission<'_>, now_us: u64) -> Vec<Claim, MAX_BEHAVIOURS> {
        let mut claims: Vec<Claim, MAX_BEHAVIOURS> = Vec::new();
        for (index, behaviour) in mission.behaviours().iter().enumerate() {
            let status = self.status(index);
            let is_dormant = status.criticality <= behaviour.dormant;
            let weight = match (status.is_engaged(), is_dormant) {
                (true, false) => status.criticality + behaviour.hysteresis,
                (true, true) => 0.0,
                (false, false) if now_us >= status.rests_until_us => status.criticality,
                (false, _) => continue,
            };
            let at = claims.iter().position(|other| other.weight < weight).unwrap_or(claims.len());
            // There are as many places as behaviours.
            let _ = claims.insert(at, Claim { index, behaviour, weight });
        }
        claims
    }

    /// One behaviour wants the robot and nobody weightier is in its way.
    fn claim(
        &mut self,
        mission: &Mission<'_>,
        claim: &Claim,
        now_us: u64,
        facts: Facts,
        report: &mut Report,
    ) {
        let in_the_way: Vec<usize, MAX_BEHAVIOURS> = mission
            .behaviours()
            .iter()
            .enumerate()
            .filter(|&(other, ref behaviour)| {
                other != claim.index
                    && self.status(other).is_engaged()
                    && behaviour.resources & claim.behaviour.resources != 0
            })
            .map(|(other, _)| other)
            .collect();
        let is_unconditional =
            self.status(claim.index).criticality >= claim.behaviour.unconditional;
        if !is_unconditional && !self.may_be_engaged(mission, claim, &in_the_way, now_us, report) {
            return;
        }
        let mut must_wait = false;
        for &other in &in_the_way {
            must_wait |= self.interrupt(mission, other, claim.index, is_unconditional, report);
        }
        if !must_wait {
            self.begin(mission, claim.index, &claim.behaviour, now_us, facts, report);
        }
    }

    /// Whether a behaviour may be engaged conditionally now: all that are in its way are at a
    /// suitable point, and nothing that anybody protects would suffer.
    fn may_be_engaged(
        &mut self,
        mission: &Mission<'_>,
        claim: &Claim,
        in_the_way: &[usize],
        now_us: u64,
        report: &mut Report,
    ) -> bool {
        let effects = Effects::of(mission, &claim.behaviour);
        let mut may = true;
        for (other, behaviour) in mission.behaviours().iter().enumerate() {
            let refusal = if in_the_way.contains(&other) {
                self.plans.pending |= behaviour_bit(other);
                self.keeps_the_robot(mission, other, &behaviour, effects, now_us)
            } else if other == claim.index {
                None
            } else {
                self.is_endangered(mission, other, effects)
            };
            if let Some(why) = refusal {
                report.note(Decision::Refused {
                    behaviour: claim.index as u8,
                    by: other as u8,
                    why,
                });
                may = false;
            }
        }
        may
    }

    /// Why an engaged behaviour does not yield to another now.
    fn keeps_the_robot(
        &self,
        mission: &Mission<'_>,
        index: usize,
        behaviour: &Behaviour,
        effects: Effects,
        now_us: u64,
    ) -> Option<Refusal> {
        let status = self.status(index);
        let ran_us = now_us.saturating_sub(status.engaged_us);
        match status.phase {
            Phase::ShuttingDown => return Some(Refusal::ShuttingDown),
            Phase::StartingUp => return Some(Refusal::NoPointYet),
            _ if ran_us < u64::from(behaviour.dwell_ms) * 1_000 => return Some(Refusal::Dwell),
            _ => {}
        }
        if !self.is_at_point(index) || self.endangers_held(mission, index, effects) {
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

    /// Whether a behaviour that is not in the way holds something that would suffer.
    fn is_endangered(
        &self,
        mission: &Mission<'_>,
        index: usize,
        effects: Effects,
    ) -> Option<Refusal> {
        let status = self.status(index);
        let is_holding =
            status.is_engaged() || status.phase == Phase::Sleeping && status.is_holding;
        (is_holding && self.endangers_held(mission, index, effects)).then_some(Refusal::Excluded)
    }

    fn endangers_held(&self, mission: &Mission<'_>, index: usize, effects: Effects) -> bool {
        let mut is_endangered = false;
        self.plans.grid.held(mission, index as Owner, 0, &mut |held: Held| {
            is_endangered |= effects.endanger(held.condition);
        });
        is_endangered
    }

    /// A vertex of its plan was just reached, or none of its actions runs.
    fn is_at_point(&self, index: usize) -> bool {
        let is_running = self.plans.forest.iter().any(|(_, component)| {
            usize::from(component.owner) == index
                && component.life == Life::Started
                && matches!(component.symbol, Symbol::Action(_))
        });
        self.plans.reached & behaviour_bit(index) != 0 || !is_running
    }

    /// Puts an engaged behaviour to sleep for another. Returns whether that one has to wait for its
    /// shut-down activity.
    fn interrupt(
        &mut self,
        mission: &Mission<'_>,
        index: usize,
        by: usize,
        is_unconditional: bool,
        report: &mut Report,
    ) -> bool {
        let (owner, phase) = (index as Owner, self.status(index).phase);
        let shut_down = mission.behaviours().get(index).and_then(|behaviour| behaviour.shut_down);
        self.plans.change(|forest, tell| {
            forest.uproot(owner + ACTIVITY, tell);
            forest.suspend(owner, tell);
        });
        let shut_down = shut_down.filter(|_| !is_unconditional && phase == Phase::Active);
        let waits = shut_down.is_some_and(|frame| {
            self.plans.change(|forest, tell| forest.plant(owner + ACTIVITY, frame, tell)).is_some()
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
        if let Some(status) = self.statuses.get_mut(index) {
            status.is_holding = !is_unconditional;
        }
        let (behaviour, by) = (index as u8, by as u8);
        report.note(Decision::Interrupted { behaviour, by, is_unconditional });
        waits
    }

    /// Engages a behaviour: its start-up activity first, if it has one.
    fn begin(
        &mut self,
        mission: &Mission<'_>,
        index: usize,
        behaviour: &Behaviour,
        now_us: u64,
        facts: Facts,
        report: &mut Report,
    ) {
        if let Some(status) = self.statuses.get_mut(index) {
            status.engaged_us = now_us;
            status.is_holding = false;
        }
        let owner = index as Owner + ACTIVITY;
        if let Some(frame) = behaviour.start_up
            && self.plans.change(|forest, tell| forest.plant(owner, frame, tell)).is_some()
        {
            self.set_phase(index, Phase::StartingUp);
            report.note(Decision::Engaged { behaviour: index as u8 });
            return;
        }
        self.begin_work(mission, index, now_us, facts, report);
    }

    /// Takes up a behaviour's own plan: the one that sleeps, or a new one.
    pub(crate) fn begin_work(
        &mut self,
        mission: &Mission<'_>,
        index: usize,
        now_us: u64,
        facts: Facts,
        report: &mut Report,
    ) {
        let (owner, behaviour) = (index as Owner, index as u8);
        if self.plans.forest.root(owner).is_some() {
            self.plans.change(|forest, tell| forest.resume(owner, tell));
            self.set_phase(index, Phase::Active);
            report.note(Decision::Resumed { behaviour });
            self.mend_deviations(mission, owner, facts, report);
            return;
        }
        let root = mission.behaviours().get(index).map_or(0, |behaviour| behaviour.root);
        if self.plans.change(|forest, tell| forest.plant(owner, root, tell)).is_some() {
            self.set_phase(index, Phase::Active);
            report.note(Decision::Engaged { behaviour });
        } else {
            self.fail_behaviour(index, now_us, report);
        }
    }

    /// A plan that has just woken is compared with the world; where they differ, the outermost frame
    /// concerned begins anew.
    fn mend_deviations(
        &mut self,
        mission: &Mission<'_>,
        owner: Owner,
        facts: Facts,
        report: &mut Report,
    ) {
        // Each round gives up at least one level.
        for _ in 0..MAX_DEPTH {
            let Some((signal, frame)) = self.outermost_deviation(mission, owner, facts) else {
                return;
            };
            report.note(Decision::Conflict(signal));
            self.plans.change(|forest, tell| forest.begin_anew(frame, tell));
        }
    }

    /// The deviation nearest to the root, and the frame that has to begin anew for it.
    fn outermost_deviation(
        &self,
        mission: &Mission<'_>,
        owner: Owner,
        facts: Facts,
    ) -> Option<(Signal, u8)> {
        let grid = &self.plans.grid;
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
        grid.evident(mission, owner, 0, facts, &mut consider);
        for (id, entry) in grid.iter() {
            let is_action = matches!(entry.symbol, Symbol::Action(_));
            if entry.owner == owner && entry.life == Life::Scheduled && is_action {
                grid.initial(mission, id, facts).into_iter().for_each(&mut consider);
            }
        }
        found.map(|(_, signal, frame)| (signal, frame))
    }

    /// A behaviour has given up: its plans are gone, and it rests.
    pub(crate) fn fail_behaviour(&mut self, index: usize, now_us: u64, report: &mut Report) {
        let owner = index as Owner;
        self.plans.change(|forest, tell| {
            forest.uproot(owner, tell);
            forest.uproot(owner + ACTIVITY, tell);
        });
        self.set_phase(index, Phase::Idle);
        if let Some(status) = self.statuses.get_mut(index) {
            status.rests_until_us = now_us.saturating_add(crate::REST_US);
            status.is_holding = false;
        }
        report.note(Decision::Failed { behaviour: index as u8 });
    }

    pub(crate) fn set_phase(&mut self, index: usize, phase: Phase) {
        if let Some(status) = self.statuses.get_mut(index) {
            status.phase = phase;
        }
    }

    pub(crate) fn status(&self, index: usize) -> crate::Status {
        self.statuses.get(index).copied().unwrap_or_default()
    }
}
