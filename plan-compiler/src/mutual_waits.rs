//! Robots of a team that may wait for each other.
//!
//! The paper's serial plans are "deadlock prone" (W, section 5): a robot that stands until its mates
//! come may be the one for which they stand. Every action has a time-out, so such a wait ends; this
//! module finds it before the robots drive, and gives the time after which each moves again.
//!
//! The plans of all robots are explored together: a state is the running action and the last signal
//! of each robot, and any robot may go on at any time to any action that can follow in its grammar,
//! after a success or after a failure. So every wait that can occur is found, and some that cannot:
//! where robots are, and which links are up, is not known, so conditions about them may be open. A wait
//! ends by the action's own `until` or by that of a frame above it.

use crate::behaviours::{self, Plans};
use crate::mission;
use crate::team::Team;
use maps::problem::{Problem, Source};
use plan_format::mission::{
    ActionKind, Behaviour, Condition, FactKind, Mates, MissionDraft, PlanFrame, Symbol, effects,
};
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// Most states that are explored: beyond it the result is incomplete, with a note.
const MAX_STATES: usize = 200_000;
/// Most waits that are listed.
const MAX_LISTED: usize = 3;
/// Actions of the way to a wait that a message names.
const MAX_WAY: usize = 6;

/// A set of actions, one bit each.
type Actions = u64;
const _: () = assert!(plan_format::limits::MAX_ACTIONS <= Actions::BITS as usize);

/// Explores the waits of a team whose missions are in one file. Robots whose part has mistakes, or
/// that have no behaviours, wait for no mate: building them reports the mistakes.
pub fn check(source: &Arc<Source>, team: &Team) -> Vec<Problem> {
    let robots: Vec<Robot> = team
        .robots
        .iter()
        .map(|name| {
            let (mission, _) = mission::parse_for(source, Some(name.as_str()));
            let draft = behaviours::compile(&mission.behaviours, &Plans::Any, &mut Vec::new());
            Robot::of(name.as_str(), &mission, draft.unwrap_or_default())
        })
        .collect();
    let span = team.robots.first().map_or(0..0, |first| first.span.clone());
    let Explored { waits, is_complete } = explore(&robots);
    let mut problems = Vec::new();
    for wait in waits.iter().take(MAX_LISTED) {
        problems.push(wait.problem(&robots).at(source, span.clone(), "this team"));
    }
    if waits.len() > MAX_LISTED {
        let message = format!("{} more ways to wait for each other", waits.len() - MAX_LISTED);
        problems.push(Problem::warning(message));
    }
    if !is_complete {
        let message = format!(
            "the plans of the team have more than {MAX_STATES} states together: not all were \
             searched for robots that wait for each other"
        );
        problems.push(Problem::note(message));
    }
    problems
}

/// One robot: its actions, and which of them can follow which.
struct Robot {
    name: String,
    draft: MissionDraft,
    names: Vec<String>,
    /// Actions that can run first.
    first: Actions,
    /// By action, those that can follow it.
    next: Vec<Actions>,
    /// By action, the frames above it that end early.
    above: Vec<Vec<PlanFrame>>,
}

impl Robot {
    fn of(name: &str, mission: &mission::Mission, draft: MissionDraft) -> Self {
        let names = mission.behaviours.actions.iter().map(|action| action.name.value.clone());
        let flow = Flow::of(&draft);
        let next = (0..draft.actions.len()).map(|action| flow.next(&draft, action)).collect();
        let (first, above) = (flow.roots(&draft), above(&draft));
        Self { name: name.into(), names: names.collect(), first, next, above, draft }
    }

    /// The conditions that end an action, each by itself: its own, and those of the frames above it.
    fn ends(&self, action: usize) -> Vec<Condition> {
        let own = self.draft.actions.get(action).map(|action| action.until);
        let above = self.above.get(action).into_iter().flatten().map(|frame| frame.until);
        own.into_iter().chain(above).filter(|until| !until.is_empty()).collect()
    }

    /// How long the robot stands in an action, milliseconds, if it stands there for a mate.
    fn wait_ms(&self, action: usize) -> Option<u32> {
        let ends = self.ends(action);
        let facts = ends.iter().fold(0, |facts, until| facts | until.must | until.must_not);
        let is_for_mate = (0_u32..)
            .zip(&self.draft.facts)
            .any(|(index, fact)| facts >> index & 1 == 1 && mates_of(fact.kind).is_some());
        let above = self.above.get(action).into_iter().flatten();
        let above_ms = above.map(|frame| frame.timeout_ms).filter(|&time_ms| time_ms != 0).min();
        let action = self.draft.actions.get(action)?;
        let ActionKind::Hold { for_ms } = action.kind else { return None };
        is_for_mate.then(|| for_ms.min(action.timeout_ms).min(above_ms.unwrap_or(u32::MAX)))
    }

    /// Whether robots of a set, one bit each, keep a wait from ending: each of its ends is open
    /// because of one of them.
    fn is_kept(&self, action: usize, signals: &[u16], robots: u8) -> bool {
        self.ends(action).into_iter().all(|until| self.waits_for(until, signals) & robots != 0)
    }

    /// The mates that keep a condition from holding, one bit each: what they signalled last is known,
    /// where they are is not.
    fn waits_for(&self, until: Condition, signals: &[u16]) -> u8 {
        let open = |kind: FactKind, wanted: bool| -> u8 {
            let Some(mates) = mates_of(kind) else { return 0 };
            let FactKind::MateSignals { code, .. } = kind else { return mates.robots };
            let holds = |robot: u8| signals.get(usize::from(robot)).map(|signal| *signal == code);
            if mates.hold(holds) == wanted {
                return 0;
            }
            let differs = |robot: &u8| holds(*robot).is_some_and(|holds| holds != wanted);
            let robots = (0..8).filter(|robot| mates.robots >> robot & 1 == 1).filter(differs);
            robots.fold(0, |bits, robot| bits | 1 << robot)
        };
        (0_u32..).zip(&self.draft.facts).fold(0, |bits, (index, fact)| {
            let is_in = |facts: u64| facts >> index & 1 == 1;
            let must = if is_in(until.must) { open(fact.kind, true) } else { 0 };
            let must_not = if is_in(until.must_not) { open(fact.kind, false) } else { 0 };
            bits | must | must_not
        })
    }

    fn action(&self, action: u8) -> &str {
        self.names.get(usize::from(action)).map_or("nothing", String::as_str)
    }
}

/// By action, the frames above it that end by a condition or after a time.
fn above(draft: &MissionDraft) -> Vec<Vec<PlanFrame>> {
    let mut above = vec![Vec::new(); draft.actions.len()];
    for (index, frame) in draft.frames.iter().enumerate() {
        if frame.until.is_empty() && frame.timeout_ms == 0 {
            continue;
        }
        for symbol in effects::all_below(draft, index) {
            if let Symbol::Action(action) = symbol {
                above[usize::from(action)].push(*frame);
            }
        }
    }
    above
}

/// The mates that a fact is about.
const fn mates_of(kind: FactKind) -> Option<Mates> {
    match kind {
        FactKind::Linked(mates)
        | FactKind::MateNear { mates, .. }
        | FactKind::MateAt { mates, .. }
        | FactKind::MateSignals { mates, .. } => Some(mates),
        FactKind::Symbol { .. }
        | FactKind::Level { .. }
        | FactKind::Near { .. }
        | FactKind::Inside { .. }
        | FactKind::NoProgress { .. } => None,
    }
}

/// What can begin a frame, and what can follow a component.
struct Flow {
    /// By frame: actions that can run first.
    first: Vec<Actions>,
    /// By frame, then by action: what can run after it.
    after_frame: Vec<Actions>,
    after_action: Vec<Actions>,
}

impl Flow {
    fn of(draft: &MissionDraft) -> Self {
        let mut flow = Self {
            first: vec![0; draft.frames.len()],
            after_frame: vec![0; draft.frames.len()],
            after_action: vec![0; draft.actions.len()],
        };
        // Frames contain each other, so this is repeated until nothing changes: sets only grow.
        while flow.grow_first(draft) {}
        let roots = flow.roots(draft);
        for behaviour in &draft.behaviours {
            for frame in frames_of(behaviour) {
                flow.after_frame[frame] |= roots;
            }
        }
        while flow.grow_after(draft) {}
        flow
    }

    /// Actions that can begin a component.
    fn begin(&self, symbol: Symbol) -> Actions {
        match symbol {
            Symbol::Action(index) => 1 << index,
            Symbol::PlanFrame(index) => self.first.get(usize::from(index)).copied().unwrap_or(0),
        }
    }

    /// Actions that can begin the robot's plans.
    fn roots(&self, draft: &MissionDraft) -> Actions {
        let frames = draft.behaviours.iter().flat_map(frames_of);
        frames.fold(0, |actions, frame| actions | self.first.get(frame).copied().unwrap_or(0))
    }

    fn grow_first(&mut self, draft: &MissionDraft) -> bool {
        let mut has_grown = false;
        for (frame, production) in productions(draft) {
            let at_entry =
                draft.edges_of(&draft.productions[production]).iter().filter(|edge| edge.from == 0);
            let begun = at_entry.fold(0, |actions, edge| actions | self.begin(edge.symbol));
            has_grown |= self.first[frame] | begun != self.first[frame];
            self.first[frame] |= begun;
        }
        has_grown
    }

    fn grow_after(&mut self, draft: &MissionDraft) -> bool {
        let mut has_grown = false;
        for (frame, production) in productions(draft) {
            let exit = draft.productions[production].vertices.saturating_sub(1);
            let all = draft.edges_of(&draft.productions[production]);
            for edge in all {
                let next = all.iter().filter(|other| other.from == edge.to);
                let mut after = next.fold(0, |actions, other| actions | self.begin(other.symbol));
                if edge.to == exit {
                    after |= self.after_frame[frame];
                }
                // A failure falls back to the frame, which chooses another production, or fails too.
                after |= self.first[frame] | self.after_frame[frame];
                let slot = match edge.symbol {
                    Symbol::Action(index) => &mut self.after_action[usize::from(index)],
                    Symbol::PlanFrame(index) => &mut self.after_frame[usize::from(index)],
                };
                has_grown |= *slot | after != *slot;
                *slot |= after;
            }
        }
        has_grown
    }

    /// What can run after an action; with several behaviours also what another one begins with.
    fn next(&self, draft: &MissionDraft, action: usize) -> Actions {
        let own = self.after_action.get(action).copied().unwrap_or(0);
        if draft.behaviours.len() > 1 { own | self.roots(draft) } else { own }
    }
}

fn frames_of(behaviour: &Behaviour) -> impl Iterator<Item = usize> + use<> {
    let frames = [Some(behaviour.root), behaviour.start_up, behaviour.shut_down];
    frames.into_iter().flatten().map(usize::from)
}

/// Each frame with each of its productions.
fn productions(draft: &MissionDraft) -> impl Iterator<Item = (usize, usize)> + '_ {
    draft.frames.iter().enumerate().flat_map(|(index, frame)| {
        let first = usize::from(frame.first);
        (first..first + usize::from(frame.count)).map(move |production| (index, production))
    })
}

/// What each robot does: its action, and its last signal.
type State = Vec<(u8, u16)>;

/// A robot without behaviours does nothing.
const NOTHING: u8 = u8::MAX;

/// Robots that wait for each other.
struct MutualWait {
    /// Their numbers, and the actions in which they stand.
    robots: Vec<(usize, u8)>,
    /// The ways of all robots to that state.
    ways: Vec<Vec<u8>>,
}

impl MutualWait {
    fn problem(&self, robots: &[Robot]) -> Problem {
        let list = |parts: Vec<String>, last: &str| match parts.split_last() {
            Some((end, rest)) if !rest.is_empty() => format!("{} {last} {end}", rest.join(", ")),
            _ => parts.join(""),
        };
        let each = |words: &dyn Fn(usize, u8) -> String| -> Vec<String> {
            self.robots.iter().map(|&(robot, action)| words(robot, action)).collect()
        };
        let names = list(each(&|robot, _| format!("`{}`", robots[robot].name)), "and");
        let places = list(
            each(&|robot, action| {
                format!("{} in `{}`", robots[robot].name, robots[robot].action(action))
            }),
            "and",
        );
        let times = list(
            each(&|robot, action| {
                let ms = robots[robot].wait_ms(usize::from(action)).unwrap_or(0);
                format!("{} after {} s", robots[robot].name, f64::from(ms) / 1e3)
            }),
            "and",
        );
        let ways = each(&|robot, _| {
            let way = self.ways[robot].iter().map(|&action| robots[robot].action(action));
            let way: Vec<&str> = way.collect();
            format!("{}: {}", robots[robot].name, way.join(", "))
        });
        Problem::warning(format!("{names} may wait for each other: {places}")).help(format!(
            "each moves again at the latest: {times}; it comes to this by {}; a shorter hold, or a \
             production that wanders when the wait fails, ends it earlier",
            ways.join("; ")
        ))
    }
}

struct Explored {
    waits: Vec<MutualWait>,
    is_complete: bool,
}

/// Explores the states of all robots together, breadth first, and collects the waits.
fn explore(robots: &[Robot]) -> Explored {
    let mut came_from: HashMap<State, Option<State>> = HashMap::new();
    let mut queue = VecDeque::new();
    for state in starts(robots) {
        came_from.insert(state.clone(), None);
        queue.push_back(state);
    }
    let mut waits: Vec<MutualWait> = Vec::new();
    let mut is_complete = true;
    while let Some(state) = queue.pop_front() {
        let stuck = waiting(robots, &state);
        if !stuck.is_empty() && waits.iter().all(|wait| wait.robots != stuck) {
            let ways = ways(&came_from, &state);
            waits.push(MutualWait { robots: stuck, ways });
        }
        for next in successors(robots, &state) {
            if came_from.contains_key(&next) {
                continue;
            }
            if came_from.len() >= MAX_STATES {
                is_complete = false;
                continue;
            }
            came_from.insert(next.clone(), Some(state.clone()));
            queue.push_back(next);
        }
    }
    // Two of three robots that all wait for each other are not worth a line of their own.
    let is_within = |wait: &MutualWait, other: &MutualWait| {
        wait.robots.len() < other.robots.len()
            && wait.robots.iter().all(|robot| other.robots.contains(robot))
    };
    let is_largest: Vec<bool> =
        waits.iter().map(|wait| !waits.iter().any(|other| is_within(wait, other))).collect();
    let mut is_largest = is_largest.into_iter();
    waits.retain(|_| is_largest.next().unwrap_or(true));
    Explored { waits, is_complete }
}

/// Every combination of first actions.
fn starts(robots: &[Robot]) -> Vec<State> {
    robots.iter().fold(vec![State::new()], |states, robot| {
        let firsts: Vec<u8> = match robot.first {
            0 => vec![NOTHING],
            first => actions(first).collect(),
        };
        let with = |state: &State| -> Vec<State> {
            let enter = |&action: &u8| {
                let mut longer = state.clone();
                longer.push((action, signal(robot, action).unwrap_or(0)));
                longer
            };
            firsts.iter().map(enter).collect()
        };
        states.iter().flat_map(with).collect()
    })
}

/// The states after one robot has gone on.
fn successors(robots: &[Robot], state: &State) -> Vec<State> {
    let mut all = Vec::new();
    for (index, robot) in robots.iter().enumerate() {
        let (action, last) = state[index];
        let next = robot.next.get(usize::from(action)).copied().unwrap_or(0);
        for action in actions(next) {
            let mut state = state.clone();
            state[index] = (action, signal(robot, action).unwrap_or(last));
            all.push(state);
        }
    }
    all
}

fn actions(set: Actions) -> impl Iterator<Item = u8> {
    (0..Actions::BITS as u8).filter(move |action| set >> action & 1 == 1)
}

/// The code that an action signals.
fn signal(robot: &Robot, action: u8) -> Option<u16> {
    match robot.draft.actions.get(usize::from(action))?.kind {
        ActionKind::Signal { code } => Some(code),
        _ => None,
    }
}

/// The robots of a state that wait for each other, with their actions: a robot whose wait is open
/// only because of mates that go on is taken away, until none is left or only such that wait for
/// each other.
fn waiting(robots: &[Robot], state: &State) -> Vec<(usize, u8)> {
    let signals: Vec<u16> = state.iter().map(|(_, signal)| *signal).collect();
    let stands = |index: &usize| robots[*index].wait_ms(usize::from(state[*index].0)).is_some();
    let mut left: Vec<usize> = (0..robots.len()).filter(stands).collect();
    loop {
        let bits = left.iter().fold(0_u8, |bits, robot| bits | 1 << robot);
        let before = left.len();
        left.retain(|&robot| robots[robot].is_kept(usize::from(state[robot].0), &signals, bits));
        if left.len() == before {
            return left.into_iter().map(|robot| (robot, state[robot].0)).collect();
        }
    }
}

/// The actions of each robot on the way to a state, the last ones only.
fn ways(came_from: &HashMap<State, Option<State>>, state: &State) -> Vec<Vec<u8>> {
    let mut ways: Vec<Vec<u8>> = state.iter().map(|(action, _)| vec![*action]).collect();
    let mut here = state;
    while let Some(Some(before)) = came_from.get(here) {
        for (way, ((now, _), (was, _))) in ways.iter_mut().zip(here.iter().zip(before)) {
            if now != was {
                way.push(*was);
            }
        }
        here = before;
    }
    for way in &mut ways {
        way.truncate(MAX_WAY);
        way.reverse();
    }
    ways
}

#[cfg(test)]
mod tests;
