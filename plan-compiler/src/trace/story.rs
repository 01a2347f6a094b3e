//! What a recorded mission's behaviours decided, in words.

use behaviour::{Choice, Decision, Phase, Refusal};
use controller::State;
use monitor::{Doubt, Signal, Violation};
use plan_format::Blob;
use plan_format::mission::{Facts, Mission};
use robot_io::Percepts;

/// A mission as its behaviours took turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Story {
    /// Every change of who has the robot.
    pub turns: Vec<Turn>,
    /// For each tick the behaviours that had the robot after it, one bit each.
    pub engaged: Vec<u16>,
}

/// A change of who has the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Tick, from 0.
    pub tick: usize,
    /// Seconds since the robot's start.
    pub time_s: f64,
    /// Whether a behaviour was interrupted, and if so whether at once.
    pub interrupted_at_once: Option<bool>,
    /// In words.
    pub text: String,
}

/// Drives a mission again and listens.
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

/// Whether it changes who has the robot.
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

/// What was decided, in words.
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
                Refusal::NoPointYet => "which is at no point where nothing protected would suffer",
                Refusal::BetterPointAhead => "which has a point of less lost work ahead",
                Refusal::Excluded => "which holds a protection interval that it may violate",
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
                Choice::TooDeep => "it lies too deep",
                _ => "no production that was not tried is applicable",
            };
            let record = mission.frames().get(frame.into());
            let name = record.map_or("?", |record| mission.name(record.name));
            format!("frame {frame} `{name}` fails: {why}")
        }
        Decision::Finished { behaviour: who } => format!("{} is finished", behaviour(who)),
        Decision::Failed { behaviour: who } => format!("{} has failed", behaviour(who)),
        Decision::TimedOut { component } => format!("component {component} has run out of time"),
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
                Doubt::NoProducer => "nothing before it brings about".to_owned(),
                Doubt::Clobberer(other) => format!("component {other} may destroy before"),
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
