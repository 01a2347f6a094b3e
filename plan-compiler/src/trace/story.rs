//! What the behaviours decided in a recorded run, in words.

use behaviour::{Choice, Decision, Phase, Refusal};
use controller::State;
use monitor::{Doubt, Signal, Violation};
use plan_format::Blob;
use plan_format::mission::{Facts, Mission, Symbol};
use robot_io::Percepts;

/// How the behaviours took turns in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Story {
    /// Every change of the engaged behaviours.
    pub turns: Vec<Turn>,
    /// The engaged behaviours after each tick, one bit per behaviour.
    pub engaged: Vec<u16>,
}

/// A change of the engaged behaviours.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Tick, from 0.
    pub tick: usize,
    /// Seconds since the robot's start.
    pub time_s: f64,
    /// `Some` if a behaviour was interrupted: whether that was unconditional.
    pub interrupted_at_once: Option<bool>,
    /// In words.
    pub text: String,
}

/// Repeats a run and records its turns.
pub fn of(blob: &Blob<'_>, percepts: &[Percepts]) -> Story {
    let mission = blob.mission();
    let mut state = State::new(blob);
    let mut story = Story { turns: Vec::new(), engaged: Vec::new() };
    for (tick, percepts) in percepts.iter().enumerate() {
        let explanation = controller::explain(blob, &mut state, percepts);
        let time_s = percepts.time_us as f64 / 1e6;
        for decision in explanation.report.decisions.iter().filter(|decision| is_turn(decision)) {
            let interrupted_at_once = match decision {
                Decision::Interrupted { is_unconditional, .. } => Some(*is_unconditional),
                _ => None,
            };
            let text = decided(&mission, decision);
            story.turns.push(Turn { tick, time_s, interrupted_at_once, text });
        }
        let has_robot = |&index: &usize| {
            let phase = state.behaviours.phase(index);
            matches!(phase, Phase::StartingUp | Phase::Active | Phase::ShuttingDown)
        };
        let engaged = (0..mission.behaviours().len()).filter(has_robot);
        story.engaged.push(engaged.fold(0, |set, index| set | 1 << index));
    }
    story
}

/// Whether a decision changes the engaged behaviours.
fn is_turn(decision: &Decision) -> bool {
    matches!(
        decision,
        Decision::Engaged { .. }
            | Decision::Resumed { .. }
            | Decision::Prepared { .. }
            | Decision::Interrupted { .. }
            | Decision::Overruled { .. }
            | Decision::Finished { .. }
            | Decision::Failed { .. }
            | Decision::TimedOut { .. }
    )
}

/// A decision in words.
pub fn decided(mission: &Mission<'_>, decision: &Decision) -> String {
    let behaviour = |index: u8| {
        mission.behaviours().get(index.into()).map_or("?", |b| mission.name(b.name)).to_owned()
    };
    match *decision {
        Decision::Engaged { behaviour: who } => format!("{} is engaged", behaviour(who)),
        Decision::Resumed { behaviour: who } => format!("{} is resumed", behaviour(who)),
        Decision::Prepared { behaviour: who } => format!("{} starts up", behaviour(who)),
        Decision::Interrupted { behaviour: who, by, is_unconditional, lost_work } => {
            let how = if is_unconditional { "at once" } else { "at a switching point" };
            let (who, by) = (behaviour(who), behaviour(by));
            format!("{who} is interrupted by {by} {how}, at the cost of {lost_work}")
        }
        Decision::Overruled { behaviour: who, by } => {
            format!(
                "{} protects what {} may violate, and is overruled",
                behaviour(who),
                behaviour(by)
            )
        }
        Decision::Refused { behaviour: who, by, why } => {
            let why = match why {
                Refusal::Dwell => "which has not run for its minimum dwell",
                Refusal::NoPointYet => "which is not at a point where it may be interrupted",
                Refusal::BetterPointAhead => "which has a point with less lost work ahead",
                Refusal::Excluded => "which protects what it may violate",
                Refusal::ShuttingDown => "which is shutting down",
            };
            format!("{} waits for {}, {why}", behaviour(who), behaviour(by))
        }
        Decision::Chose { production, applicability } => {
            let record = mission.productions().get(production.into());
            let name = record.map_or("?", |record| mission.name(record.name));
            format!("production {production} `{name}` is chosen, applicability {applicability:.4}")
        }
        Decision::NotDecomposed { frame, why } => {
            let why = match why {
                Choice::NoRoom => "there is no room for its components",
                Choice::TooDeep => "it is nested too deeply",
                _ => "no untried production is applicable",
            };
            let record = mission.plan_frames().get(frame.into());
            let name = record.map_or("?", |record| mission.name(record.name));
            format!("frame {frame} `{name}` fails: {why}")
        }
        Decision::Finished { behaviour: who } => format!("{} is finished", behaviour(who)),
        Decision::Failed { behaviour: who } => format!("{} has failed", behaviour(who)),
        Decision::TimedOut { symbol } => format!("`{}` has timed out", name_of(mission, symbol)),
        Decision::Conflict(signal) => conflict(mission, signal),
    }
}

fn conflict(mission: &Mission<'_>, signal: Signal) -> String {
    match signal {
        Signal::Evident { id, what, facts: about } => {
            let what = match what {
                Violation::Initial => "its initial description does not hold",
                Violation::Transient => "its transient description does not hold",
                Violation::Goal => "its goal description does not hold",
                Violation::Interval => "its protection interval is violated",
                Violation::Foreign => "a sleeping behaviour's protection interval is violated",
            };
            format!("evident conflict at component {id}: {what}: {}", facts(mission, about))
        }
        Signal::Possible { id, why, facts: about } => {
            let why = match why {
                Doubt::NoProducer => "no earlier component makes true".to_owned(),
                Doubt::Clobberer(other) => format!("component {other} may make false before"),
                Doubt::Choice(production) => {
                    format!("choosing production {production} may violate")
                }
            };
            format!("possible conflict at component {id}: {why}: {}", facts(mission, about))
        }
    }
}

/// The names of some facts.
pub fn facts(mission: &Mission<'_>, set: Facts) -> String {
    let names: Vec<&str> = mission
        .facts()
        .iter()
        .enumerate()
        .filter(|&(bit, _)| set >> bit & 1 == 1)
        .map(|(_, fact)| mission.name(fact.name))
        .collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// The name of a frame or an action.
fn name_of<'m>(mission: &Mission<'m>, symbol: Symbol) -> &'m str {
    let name = match symbol {
        Symbol::PlanFrame(index) => mission.plan_frames().get(index.into()).map(|frame| frame.name),
        Symbol::Action(index) => mission.actions().get(index.into()).map(|action| action.name),
    };
    name.map_or("?", |name| mission.name(name))
}
