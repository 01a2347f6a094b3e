//! What was decided in a recorded run, and where, in words.

use crate::goals;
use behaviour::{Choice, Decision, Phase, Refusal};
use controller::State;
use math::Vec2;
use monitor::{Doubt, Signal, Violation};
use plan_format::Blob;
use plan_format::limits::MAX_BEHAVIOURS;
use plan_format::mission::{Facts, Mission, PlanFrame, Symbol};
use robot_io::Percepts;

/// What happened in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Story {
    /// Every change of the engaged behaviours.
    pub turns: Vec<Turn>,
    /// What their plans did meanwhile: choices, actions that begin and failures; and every change of
    /// the reason for the commands.
    pub steps: Vec<Turn>,
    /// The engaged behaviours after each tick, one bit per behaviour.
    pub engaged: Vec<u16>,
}

/// A change in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Tick, from 0.
    pub tick: usize,
    /// Seconds since the robot's start.
    pub time_s: f64,
    /// Where the robot was, map metres, if it knew.
    pub at: Option<Vec2>,
    /// `Some` if a behaviour was interrupted: whether that was unconditional.
    pub interrupted_at_once: Option<bool>,
    /// In words.
    pub text: String,
}

/// Repeats a run and records its turns.
pub fn of(blob: &Blob<'_>, percepts: &[Percepts]) -> Story {
    let mission = blob.mission();
    let mut state = State::new(blob);
    let mut story = Story { turns: Vec::new(), steps: Vec::new(), engaged: Vec::new() };
    let (mut running, mut purpose) = (Vec::new(), None);
    for (tick, percepts) in percepts.iter().enumerate() {
        let explanation = controller::explain(blob, &mut state, percepts);
        let turn = |interrupted_at_once, text| Turn {
            tick,
            time_s: percepts.time_us as f64 / 1e6,
            at: explanation.sensed.position.ok(),
            interrupted_at_once,
            text,
        };
        for decision in &explanation.report.decisions {
            let interrupted_at_once = match decision {
                Decision::Interrupted { is_unconditional, .. } => Some(*is_unconditional),
                _ => None,
            };
            let text = || decided(&mission, decision);
            if is_turn(decision) {
                story.turns.push(turn(interrupted_at_once, text()));
            } else if is_step(decision) {
                story.steps.push(turn(None, text()));
            }
        }
        let now_running = actions(&mission, &state);
        for action in now_running.iter().filter(|action| !running.contains(*action)) {
            story.steps.push(turn(None, format!("{} runs `{}`", action.behaviour, action.name)));
        }
        running = now_running;
        let now_purpose = (explanation.commands.reason, goal(blob, &state));
        if purpose.as_ref() != Some(&now_purpose) {
            let (reason, goal) = &now_purpose;
            let goal = goal.as_ref().map_or(String::new(), |goal| format!(" ({goal})"));
            story.steps.push(turn(None, format!("because: {reason:?}{goal}")));
        }
        purpose = Some(now_purpose);
        let has_robot = |&index: &usize| {
            let phase = state.behaviours.phase(index);
            matches!(phase, Phase::StartingUp | Phase::Active | Phase::ShuttingDown)
        };
        let engaged = (0..mission.behaviours().len()).filter(has_robot);
        story.engaged.push(engaged.fold(0, |set, index| set | 1 << index));
    }
    story
}

/// The goal that the robot approaches or has reached, if its plan has several.
pub fn goal(blob: &Blob<'_>, state: &State) -> Option<String> {
    let plan = blob.parallel_plan(state.progress.plan.into())?;
    state.goal().map(|number| goals::numbered(&plan, number))
}

/// An action that runs.
#[derive(Clone, Debug, PartialEq)]
struct Action {
    /// Its slot in the pool.
    slot: u8,
    /// Its name.
    name: String,
    /// The behaviour to which it belongs.
    behaviour: String,
}

/// The actions that run after a tick.
fn actions(mission: &Mission<'_>, state: &State) -> Vec<Action> {
    let running = state.behaviours.grid().iter().filter(|(_, part)| part.is_running());
    let action = running.map(|(slot, part)| {
        // Activities have the numbers after those of the behaviours.
        let behaviour = mission.behaviours().get(usize::from(part.owner) % MAX_BEHAVIOURS);
        Action {
            slot,
            name: name_of(mission, part.symbol).to_owned(),
            behaviour: behaviour.map_or("?", |record| mission.name(record.name)).to_owned(),
        }
    });
    action.collect()
}

/// Whether a decision is about the steps of a plan: a choice or a failure.
fn is_step(decision: &Decision) -> bool {
    matches!(
        decision,
        Decision::Chose { .. }
            | Decision::NotDecomposed { .. }
            | Decision::Conflict { signal: Signal::Evident { .. }, .. }
    )
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
            let has = |frame: &PlanFrame| {
                (frame.first..frame.first + u16::from(frame.count)).contains(&production)
            };
            let frame = mission.plan_frames().iter().find(has);
            let (number, frame) = frame
                .map_or((0, "?"), |frame| (production - frame.first + 1, mission.name(frame.name)));
            format!(
                "`{frame}` chooses its production {number}, `{name}`, {applicability:.4} applicable"
            )
        }
        Decision::NotDecomposed { frame, why } => {
            let why = match why {
                Choice::NoRoom => "there is no room for its components",
                Choice::TooDeep => "it is nested too deeply",
                _ => "no untried production is applicable",
            };
            let record = mission.plan_frames().get(frame.into());
            let name = record.map_or("?", |record| mission.name(record.name));
            format!("`{name}` fails: {why}")
        }
        Decision::Finished { behaviour: who } => format!("{} is finished", behaviour(who)),
        Decision::Failed { behaviour: who } => format!("{} has failed", behaviour(who)),
        Decision::TimedOut { symbol } => format!("`{}` has timed out", name_of(mission, symbol)),
        Decision::Conflict { signal, symbol } => conflict(mission, signal, symbol),
    }
}

fn conflict(mission: &Mission<'_>, signal: Signal, symbol: Option<Symbol>) -> String {
    let name = symbol.map_or("?", |symbol| name_of(mission, symbol));
    match signal {
        Signal::Evident { what, facts: about, .. } => {
            let what = match what {
                Violation::Initial => "its initial description does not hold",
                Violation::Transient => "its transient description does not hold",
                Violation::Goal => "its goal description does not hold",
                Violation::Interval => "its protection interval is violated",
                Violation::Foreign => "a sleeping behaviour's protection interval is violated",
            };
            format!("evident conflict at `{name}`: {what}: {}", facts(mission, about))
        }
        Signal::Possible { why, facts: about, .. } => {
            let why = match why {
                Doubt::NoProducer => "no earlier component makes true".to_owned(),
                Doubt::Clobberer(_) => "another component may change before".to_owned(),
                Doubt::Choice(production) => {
                    let record = mission.productions().get(production.into());
                    let name = record.map_or("?", |record| mission.name(record.name));
                    format!("choosing production `{name}` may violate")
                }
            };
            format!("possible conflict at `{name}`: {why}: {}", facts(mission, about))
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
