//! What must hold after every tick, whatever the mission and the percepts.

use behaviour::{Behaviours, Decision, MAX_RUNNING, Phase, REST_US};
use controller::{Explanation, State};
use monitor::{Component, Id, Life, Node, Relation, Signal, SituationGrid, Violation};
use plan_format::Blob;
use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS};
use plan_format::mission::{Mission, Symbol};
use robot_io::Percepts;

/// What has to be remembered from tick to tick to judge the next.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// The clock that stands still while the robot may not move, as the behaviours have it.
    now_us: u64,
    seen_us: Option<u64>,
    failed_us: [Option<u64>; MAX_BEHAVIOURS],
    /// What the plans were.
    grid: SituationGrid,
}

impl Watch {
    /// Checks everything after a tick; an error says what does not hold.
    pub fn check(
        &mut self,
        blob: &Blob<'_>,
        state: &State,
        percepts: &Percepts,
        explanation: &Explanation,
    ) -> Result<(), String> {
        let mission = blob.mission();
        self.commands_are_possible(blob, explanation)?;
        places_are_used_by_plans_in_progress(&state.behaviours)?;
        only_what_may_run_together_does(&mission, &state.behaviours)?;
        resources_have_one_holder(&mission, &state.behaviours)?;
        let may_move = percepts.operator.is_armed && !percepts.operator.is_emergency_stop;
        let passed_us = percepts.time_us.saturating_sub(self.seen_us.unwrap_or(percepts.time_us));
        self.seen_us = Some(percepts.time_us);
        if may_move {
            self.now_us = self.now_us.saturating_add(passed_us);
            self.no_tick_is_dead(&mission, &state.behaviours, explanation)?;
        }
        self.grid.clone_from(state.behaviours.grid());
        Ok(())
    }

    fn commands_are_possible(
        &self,
        blob: &Blob<'_>,
        explanation: &Explanation,
    ) -> Result<(), String> {
        let commands = &explanation.commands;
        let vehicle = &blob.parameters().vehicle;
        // Comparisons with what is not a number are false.
        let is_possible = commands.speed_mps.abs() <= vehicle.max_speed_mps
            && commands.turn_rate_radps.abs() <= vehicle.max_turn_rate_radps;
        if is_possible { Ok(()) } else { Err(format!("impossible commands: {commands:?}")) }
    }

    /// If some behaviour is critical, does not rest and could run, then something runs, the plans
    /// have changed (actions that take no time may fill a tick), or the report says why not.
    fn no_tick_is_dead(
        &mut self,
        mission: &Mission<'_>,
        behaviours: &Behaviours,
        explanation: &Explanation,
    ) -> Result<(), String> {
        let report = &explanation.report;
        let tells = |decision: &&Decision| {
            !matches!(
                decision,
                Decision::Conflict(
                    Signal::Possible { .. } | Signal::Evident { what: Violation::Foreign, .. }
                )
            )
        };
        let is_told = report.decisions.iter().filter(tells).count() > 0 || report.omitted > 0;
        let has_changed = *behaviours.grid() != self.grid;
        if !is_told && !has_changed && running(behaviours).count() == 0 {
            for (index, behaviour) in mission.behaviours().iter().enumerate() {
                let is_engaged = is_engaged(behaviours.phase(index));
                let is_dormant = report.criticalities[index] <= behaviour.dormant;
                let rests = self.failed_us[index].is_some_and(|at| self.now_us < at + REST_US);
                if is_engaged || !is_dormant && !rests {
                    return Err(format!("nothing runs, and nothing says why {index} does not"));
                }
            }
        }
        for decision in &report.decisions {
            if let Decision::Failed { behaviour } = decision {
                self.failed_us[usize::from(*behaviour)] = Some(self.now_us);
            }
        }
        if report.omitted > 0 {
            // Some failure may be among what was not told.
            self.failed_us = [Some(self.now_us); MAX_BEHAVIOURS];
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

/// No component outlives the plan it belongs to.
fn places_are_used_by_plans_in_progress(behaviours: &Behaviours) -> Result<(), String> {
    let grid = behaviours.grid();
    if grid.iter().count() != behaviours.components() {
        return Err("the grid does not know what lives".into());
    }
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
            return Err(format!("component {id} of {} lives on: {phase:?}", entry.owner));
        }
        if entry.parent.is_some_and(|parent| grid.get(parent).is_none()) {
            return Err(format!("component {id} hangs in the air"));
        }
    }
    Ok(())
}

/// H18: within a plan only what is in the relation NE runs together, and never too much.
fn only_what_may_run_together_does(
    mission: &Mission<'_>,
    behaviours: &Behaviours,
) -> Result<(), String> {
    let grid = behaviours.grid();
    if running(behaviours).count() > MAX_RUNNING || behaviours.components() > MAX_COMPONENTS {
        return Err("more runs than there is room for".into());
    }
    for (x, first) in running(behaviours) {
        for (y, second) in running(behaviours).filter(|&(y, _)| y > x) {
            let relation = grid.relation(mission, Node::from(x), Node::from(y));
            if first.owner == second.owner && relation != Some(Relation::NE) {
                return Err(format!("{x} and {y} run together, though {relation:?}"));
            }
        }
        let index = usize::from(first.owner) % MAX_BEHAVIOURS;
        if !is_engaged(behaviours.phase(index)) {
            return Err(format!("{x} runs for a behaviour that is not engaged"));
        }
    }
    Ok(())
}

/// H30: no two engaged behaviours need the same.
fn resources_have_one_holder(mission: &Mission<'_>, behaviours: &Behaviours) -> Result<(), String> {
    let mut taken = 0;
    for (index, behaviour) in mission.behaviours().iter().enumerate() {
        if is_engaged(behaviours.phase(index)) {
            if taken & behaviour.resources != 0 {
                return Err(format!("behaviour {index} has what another has"));
            }
            taken |= behaviour.resources;
        }
    }
    Ok(())
}
