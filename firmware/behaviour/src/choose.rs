//! Which behaviours should have the robot. Decides and reports; changes nothing.

use crate::report::{Decision, Refusal};
use crate::{ACTIVITY, Behaviours, Context, Phase, behaviour_bit, behaviours_in};
use heapless::Vec;
use parts::Owner;
use plan_format::limits::MAX_BEHAVIOURS;
use plan_format::mission::{Behaviour, Condition, Description, Facts, Mission, SwitchPoint};

/// The facts that an engaged behaviour may change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Effects {
    may_add: Facts,
    may_delete: Facts,
}

impl Effects {
    /// The effects of a behaviour's plan and activities.
    pub(crate) fn of(mission: &Mission<'_>, behaviour: &Behaviour) -> Self {
        let frames = [Some(behaviour.root), behaviour.start_up, behaviour.shut_down];
        let none = Self::default();
        frames.into_iter().fold(none, |all, frame| all.and(Self::of_frame(mission, frame)))
    }

    /// The effects of a frame, if there is one.
    fn of_frame(mission: &Mission<'_>, frame: Option<u16>) -> Self {
        let frame = frame.and_then(|index| mission.plan_frames().get(usize::from(index)));
        frame.map_or(Self::default(), |frame| Self {
            may_add: frame.may_add,
            may_delete: frame.may_delete,
        })
    }

    /// Whether an effect may violate a protected condition.
    fn endanger(self, held: Condition) -> bool {
        held.must & self.may_delete != 0 || held.must_not & self.may_add != 0
    }

    /// The effects at the end of one component.
    pub(crate) fn at_end(description: Description) -> Self {
        Self {
            may_add: description.add | description.goal.must,
            may_delete: description.delete | description.goal.must_not,
        }
    }

    /// Both effects together.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            may_add: self.may_add | other.may_add,
            may_delete: self.may_delete | other.may_delete,
        }
    }

    /// What is left of them for facts that a shut-down gives up in an orderly way.
    fn without(self, freed: Self) -> Self {
        Self {
            may_add: self.may_add & !freed.may_add,
            may_delete: self.may_delete & !freed.may_delete,
        }
    }

    /// The part of a protected condition that these effects may not violate.
    pub(crate) fn spared(self, held: Condition) -> Condition {
        Condition { must: held.must & !self.may_delete, must_not: held.must_not & !self.may_add }
    }

    /// Whether it may change no fact.
    fn is_empty(self) -> bool {
        self.may_add | self.may_delete == 0
    }
}

/// A behaviour's claim to the robot, engaged or not.
#[derive(Clone, Copy)]
pub(crate) struct Claim {
    pub(crate) index: usize,
    pub(crate) resources: u16,
    pub(crate) is_engaged: bool,
    pub(crate) is_urgent: bool,
    pub(crate) weight: f32,
}

impl Claim {
    /// Whether it outranks another claim, of a behaviour with a higher index. Urgency decides how a
    /// behaviour takes over, not from whom: from less critical ones only.
    fn outranks(&self, other: &Self) -> bool {
        // Of two equal claims, that of an engaged behaviour wins.
        self.weight > other.weight
            || self.weight == other.weight && (self.is_engaged || !other.is_engaged)
    }
}

impl Behaviours {
    /// All claims to the robot, highest priority first; equal ones in the order of their indices.
    pub(crate) fn claims(&self, mission: &Mission<'_>) -> Vec<Claim, MAX_BEHAVIOURS> {
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
            // The capacity is the number of behaviours.
            let _ = claims.insert(at.unwrap_or(claims.len()), claim);
        }
        claims
    }

    /// The engaged behaviours that share a resource with a claim, one bit each.
    pub(crate) fn blocking(&self, claim: &Claim) -> u16 {
        let others = self.engaged & !behaviour_bit(claim.index);
        behaviours_in(others)
            .filter(|&index| self.status(index).resources & claim.resources != 0)
            .fold(0, |set, index| set | behaviour_bit(index))
    }

    /// The behaviours that share no resource with a claim, but protect facts that it may change,
    /// one bit each. Each is reported; for an urgent claim, as overruled.
    pub(crate) fn excluding(
        &self,
        claim: &Claim,
        effects: Effects,
        blocking: u16,
        context: &mut Context<'_>,
    ) -> u16 {
        let mut excluding = 0;
        if effects.is_empty() {
            return excluding;
        }
        let aside = blocking | behaviour_bit(claim.index);
        for index in behaviours_in((self.engaged | self.holding()) & !aside) {
            if !self.endangers_held(index, effects) {
                continue;
            }
            excluding |= behaviour_bit(index);
            let (behaviour, by) = (claim.index as u8, index as u8);
            context.report.note(if claim.is_urgent {
                Decision::Overruled { behaviour: by, by: behaviour }
            } else {
                Decision::Refused { behaviour, by, why: Refusal::Excluded }
            });
        }
        excluding
    }

    /// The other engaged behaviours that protect what effects may violate, one bit each.
    pub(crate) fn protecting(&self, index: usize, effects: Effects) -> u16 {
        behaviours_in(self.engaged & !behaviour_bit(index))
            .filter(|&other| self.endangers_held(other, effects))
            .fold(0, |set, other| set | behaviour_bit(other))
    }

    /// The resources of a set of behaviours.
    pub(crate) fn resources_of(&self, behaviours: u16) -> u16 {
        behaviours_in(behaviours).fold(0, |all, index| all | self.status(index).resources)
    }

    /// The blocking behaviours that can be interrupted now, one bit each. The refusals of the
    /// others are reported.
    pub(crate) fn yielding(
        &self,
        claim: &Claim,
        effects: Effects,
        blocking: u16,
        context: &mut Context<'_>,
    ) -> u16 {
        let mut yielding = blocking;
        let mut is_soon = true;
        for other in behaviours_in(blocking) {
            let Some(why) = self.refusal(context.mission, other, effects) else { continue };
            let (behaviour, by) = (claim.index as u8, other as u8);
            context.report.note(Decision::Refused { behaviour, by, why });
            yielding &= !behaviour_bit(other);
            is_soon &= matches!(why, Refusal::NoPointYet | Refusal::ShuttingDown);
        }
        // If one will not yield soon, none is put to sleep for it.
        if is_soon { yielding } else { 0 }
    }

    /// Why an engaged behaviour does not yield now; `None` if it does.
    fn refusal(&self, mission: &Mission<'_>, index: usize, effects: Effects) -> Option<Refusal> {
        let behaviour = mission.behaviours().get(index)?;
        let status = self.status(index);
        let ran_us = self.now_us.saturating_sub(status.engaged_us);
        match status.phase {
            Phase::ShuttingDown => return Some(Refusal::ShuttingDown),
            Phase::StartingUp => return Some(Refusal::NoPointYet),
            _ if ran_us < u64::from(behaviour.dwell_ms) * 1_000 => return Some(Refusal::Dwell),
            _ => {}
        }
        // What its shut-down gives up and its start-up restores need not be waited for.
        let effects = effects.without(Effects::of_frame(mission, behaviour.shut_down));
        if self.is_acting(index) || self.endangers_held(index, effects) {
            return Some(Refusal::NoPointYet);
        }
        let is_better_ahead = behaviour.switch_point == SwitchPoint::Best && {
            let mut is_better = false;
            self.plans.grid().points(mission, index as Owner, &mut |point| {
                is_better |= point.lost_work < status.lost_work && !effects.endanger(point.held);
            });
            is_better
        };
        is_better_ahead.then_some(Refusal::BetterPointAhead)
    }

    /// Whether effects may violate what a behaviour's plan, or its start-up or shut-down, protects.
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

    /// What the protection intervals in force in a plan protect together.
    pub(crate) fn held_by(&self, owner: Owner) -> Condition {
        self.plans.grid().held(owner).fold(Condition::default(), |all, (_, held)| all.and(held))
    }

    /// Whether an action of a behaviour's plan runs, so that the plan is between vertices.
    pub(crate) fn is_acting(&self, index: usize) -> bool {
        self.plans.forest.running_of(index as Owner).next().is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Facts 0 to 3, so that each set has members in common with the other and of its own.
    #[test]
    fn effects_are_sets() {
        let (a, b) = (
            Effects { may_add: 0b0011, may_delete: 0b0110 },
            Effects { may_add: 0b0110, may_delete: 0b1100 },
        );
        assert_eq!(a.and(b), Effects { may_add: 0b0111, may_delete: 0b1110 });
        assert_eq!(a.without(b), Effects { may_add: 0b0001, may_delete: 0b0010 });
        let held = Condition { must: 0b0011, must_not: 0b0101 };
        assert_eq!(a.spared(held), Condition { must: 0b0001, must_not: 0b0100 });
        let twice = Effects { may_add: 1, may_delete: 1 };
        assert!(Effects::default().is_empty() && !twice.is_empty());
        for (effects, is_danger) in [
            (Effects { may_add: 0, may_delete: 0b0001 }, true),
            (Effects { may_add: 0b0100, may_delete: 0 }, true),
            (Effects { may_add: 0b0010, may_delete: 0b0100 }, false),
        ] {
            assert_eq!(effects.endanger(held), is_danger);
        }
    }

    /// What a component adds and what its goal says hold after it, in part the same.
    #[test]
    fn a_component_changes_what_it_says_and_what_its_goal_says() {
        let description = Description {
            add: 0b0011,
            delete: 0b0100,
            goal: Condition { must: 0b0110, must_not: 0b1100 },
            initial: Condition::default(),
            transient: Condition::default(),
            max_speed_mps: f32::INFINITY,
            min_distance_m: 0.0,
        };
        let effects = Effects::at_end(description);
        assert_eq!(effects, Effects { may_add: 0b0111, may_delete: 0b1100 });
    }
}
