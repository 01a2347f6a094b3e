//! What must hold after every tick, for any mission and any percepts.

use behaviour::{Behaviours, Decision, MAX_RUNNING, Phase, REST_US};
use controller::{Explanation, State};
use monitor::{Component, Id, Life, Node, Pool, Relation, Signal, Violation};
use plan_format::Blob;
use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS};
use plan_format::mission::{Mission, Symbol};
use robot_io::Percepts;

/// The state from earlier ticks that the checks of the next tick need.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// The behaviours' clock, which stops while the robot may not move, microseconds.
    now_us: u64,
    seen_us: Option<u64>,
    failed_us: [Option<u64>; MAX_BEHAVIOURS],
    /// Behaviours that run once and have finished.
    is_over: [bool; MAX_BEHAVIOURS],
    /// The plans after the last tick.
    plans: Pool,
}

impl Watch {
    /// Checks every invariant after a tick; the error names the violated one.
    pub fn check(
        &mut self,
        blob: &Blob<'_>,
        state: &State,
        percepts: &Percepts,
        explanation: &Explanation,
    ) -> Result<(), String> {
        let mission = blob.mission();
        self.commands_are_possible(blob, explanation)?;
        components_belong_to_live_plans(&state.behaviours)?;
        only_what_may_run_together_does(&mission, &state.behaviours)?;
        resources_have_one_holder(&mission, &state.behaviours)?;
        let may_move = state.arming.is_armed() && !percepts.operator.is_emergency_stop;
        let passed_us = percepts.time_us.saturating_sub(self.seen_us.unwrap_or(percepts.time_us));
        self.seen_us = Some(percepts.time_us);
        if may_move {
            self.now_us = self.now_us.saturating_add(passed_us);
            self.no_tick_is_dead(&mission, &state.behaviours, explanation)?;
        }
        self.plans.clone_from(state.behaviours.grid().pool());
        Ok(())
    }

    fn commands_are_possible(
        &self,
        blob: &Blob<'_>,
        explanation: &Explanation,
    ) -> Result<(), String> {
        let commands = &explanation.commands;
        let vehicle = &blob.parameters().vehicle;
        // Comparisons with NaN are false.
        let is_possible = commands.speed_mps.abs() <= vehicle.max_speed_mps
            && commands.turn_rate_radps.abs() <= vehicle.max_turn_rate_radps;
        if is_possible { Ok(()) } else { Err(format!("impossible commands: {commands:?}")) }
    }

    /// If a behaviour is critical and does not rest, then an action runs, the plans have changed
    /// (actions that take no time may fill a tick), or the report gives a reason.
    fn no_tick_is_dead(
        &mut self,
        mission: &Mission<'_>,
        behaviours: &Behaviours,
        explanation: &Explanation,
    ) -> Result<(), String> {
        let report = &explanation.report;
        let is_anyone_engaged =
            (0..mission.behaviours().len()).any(|index| is_engaged(behaviours.phase(index)));
        let is_reason = |decision: &&Decision| {
            // To wait for another behaviour is a reason only while one has the robot.
            let waits_for_nobody =
                matches!(decision, Decision::Refused { .. }) && !is_anyone_engaged;
            !waits_for_nobody
                && !matches!(
                    decision,
                    Decision::Conflict {
                        signal: Signal::Possible { .. }
                            | Signal::Evident { what: Violation::Foreign, .. },
                        ..
                    }
                )
        };
        let is_explained =
            report.decisions.iter().filter(is_reason).count() > 0 || report.omitted > 0;
        let has_changed = *behaviours.grid().pool() != self.plans;
        if !is_explained && !has_changed && running(behaviours).count() == 0 {
            for (index, behaviour) in mission.behaviours().iter().enumerate() {
                let is_engaged = is_engaged(behaviours.phase(index));
                let is_dormant = report.criticalities[index] <= behaviour.dormant;
                let rests = self.failed_us[index].is_some_and(|at| self.now_us < at + REST_US);
                if is_engaged || !is_dormant && !rests && !self.is_over[index] {
                    return Err(format!(
                        "no action runs, and no decision explains why {index} waits"
                    ));
                }
            }
        }
        for decision in &report.decisions {
            match decision {
                Decision::Failed { behaviour } => {
                    self.failed_us[usize::from(*behaviour)] = Some(self.now_us);
                }
                Decision::Finished { behaviour } => self.is_over[usize::from(*behaviour)] = true,
                _ => {}
            }
        }
        if report.omitted > 0 {
            // A failure or an end may be among the omitted decisions.
            self.failed_us = [Some(self.now_us); MAX_BEHAVIOURS];
            self.is_over = [true; MAX_BEHAVIOURS];
        }
        for (is_over, behaviour) in self.is_over.iter_mut().zip(mission.behaviours().iter()) {
            *is_over &= behaviour.once;
        }
        Ok(())
    }
}

/// The atomic actions that run.
pub fn running(behaviours: &Behaviours) -> impl Iterator<Item = (Id, &Component)> {
    behaviours.grid().iter().filter(|(_, entry)| {
        entry.life == Life::Started && matches!(entry.symbol, Symbol::Action(_))
    })
}

fn is_engaged(phase: Phase) -> bool {
    matches!(phase, Phase::StartingUp | Phase::Active | Phase::ShuttingDown)
}

/// No component outlives its plan.
fn components_belong_to_live_plans(behaviours: &Behaviours) -> Result<(), String> {
    let grid = behaviours.grid();
    for (id, entry) in grid.iter() {
        let index = usize::from(entry.owner) % MAX_BEHAVIOURS;
        let phase = behaviours.phase(index);
        let is_activity = usize::from(entry.owner) >= MAX_BEHAVIOURS;
        let may_live = if is_activity {
            matches!(phase, Phase::StartingUp | Phase::ShuttingDown)
        } else {
            phase != Phase::Idle
        };
        if !may_live {
            return Err(format!("component {id} of {} outlives its plan: {phase:?}", entry.owner));
        }
        if entry.parent.is_some_and(|parent| grid.get(parent).is_none()) {
            return Err(format!("component {id} has lost its parent"));
        }
    }
    Ok(())
}

/// H18: only components in the relation NE run together within a plan, and the bounds hold.
fn only_what_may_run_together_does(
    mission: &Mission<'_>,
    behaviours: &Behaviours,
) -> Result<(), String> {
    let grid = behaviours.grid();
    if running(behaviours).count() > MAX_RUNNING || behaviours.components() > MAX_COMPONENTS {
        return Err("more components or actions than the limits allow".into());
    }
    for (x, first) in running(behaviours) {
        for (y, second) in running(behaviours).filter(|&(y, _)| y > x) {
            let relation = grid.relation(mission, Node::from(x), Node::from(y));
            if first.owner == second.owner && relation != Some(Relation::NE) {
                return Err(format!(
                    "{x} and {y} run together, but their relation is {relation:?}"
                ));
            }
        }
        let index = usize::from(first.owner) % MAX_BEHAVIOURS;
        if !is_engaged(behaviours.phase(index)) {
            return Err(format!("{x} runs for a behaviour that is not engaged"));
        }
    }
    Ok(())
}

/// H30: no two engaged behaviours share a resource.
fn resources_have_one_holder(mission: &Mission<'_>, behaviours: &Behaviours) -> Result<(), String> {
    let mut taken = 0;
    for (index, behaviour) in mission.behaviours().iter().enumerate() {
        if is_engaged(behaviours.phase(index)) {
            if taken & behaviour.resources != 0 {
                return Err(format!("behaviour {index} shares a resource with another"));
            }
            taken |= behaviour.resources;
        }
    }
    Ok(())
}
