//! Robots of a team that may wait for each other.
//!
//! The paper's serial plans are "deadlock prone" (W, section 5): a robot that stands until its mates
//! come may be the one for which they stand. Every action has a time-out, so such a wait ends; this
//! module finds it before the robots drive, and says when each moves again.
//!
//! The plans of all robots are explored together: a state is the running step and the last signal
//! of each robot, and any robot may go on at any time to any step that can follow in its grammar
//! ([`flow`]). So every wait that can occur is found, and some that cannot: where robots are, and which
//! links are up, is not known, so conditions about them may be open; nor is it known when another
//! behaviour or a longer branch signals. A wait ends by the action's own `until` or by that of a frame
//! above it. A signal that a mate never sends ([`unsent`]) is reported by itself.

mod flow;
mod robot;
mod unsent;

use crate::behaviours::{self, Plans};
use crate::mission;
use crate::team::Team;
use flow::Step;
use maps::problem::{Problem, Source, has_errors};
use robot::{Onwards, Robot};
use std::collections::{HashMap, HashSet, VecDeque};
use std::sync::Arc;

/// Most states that are explored: beyond it the result is incomplete, with a note.
const MAX_STATES: usize = 200_000;
/// Most different ways to wait: beyond it the result is incomplete too.
const MAX_WAITS: usize = 200;
/// Most waits that are listed.
const MAX_LISTED: usize = 3;
/// Actions of the way to a wait that a message names.
const MAX_WAY: usize = 6;

/// Explores the waits of a team whose missions are in one file. Robots whose part has mistakes, or
/// that have no behaviours, wait for no mate: building them reports the mistakes.
pub fn check(source: &Arc<Source>, team: &Team) -> Vec<Problem> {
    let robots: Vec<Robot> = team
        .robots
        .iter()
        .map(|name| {
            let (mission, mut mistakes) = mission::parse_for(source, Some(name.as_str()));
            let draft = behaviours::compile(&mission.behaviours, &Plans::Any, &mut mistakes);
            let draft = draft.filter(|_| !has_errors(&mistakes));
            Robot::of(name.as_str(), mission, draft)
        })
        .collect();
    let span = team.robots.first().map_or(0..0, |first| first.span.clone());
    let Explored { waits, is_complete } = if robots.iter().any(Robot::may_wait) {
        explore(&robots)
    } else {
        Explored { waits: Vec::new(), is_complete: true }
    };
    let mut problems = unsent::check(source, &robots);
    for wait in waits.iter().take(MAX_LISTED) {
        problems.push(wait.problem(&robots).at(source, span.clone(), "this team"));
    }
    if waits.len() > MAX_LISTED {
        let more = if is_complete { "" } else { "at least " };
        let message =
            format!("{more}{} more ways to wait for each other", waits.len() - MAX_LISTED);
        problems.push(Problem::warning(message));
    }
    if !is_complete {
        let message = format!(
            "the plans of the team have more than {MAX_STATES} states together, or more than \
             {MAX_WAITS} ways to wait: not all were searched for robots that wait for each other"
        );
        problems.push(Problem::note(message));
    }
    problems
}

/// What each robot does: its step, and its last signal.
type State = Vec<(Step, u16)>;

/// A robot without behaviours does nothing.
const NOTHING: Step = Step::MAX;

/// Robots that wait for each other.
struct MutualWait {
    /// Their numbers, the steps in which they stand, and what they do then.
    robots: Vec<(usize, Step, Onwards)>,
    /// The ways of all robots to that state.
    ways: Vec<Vec<Step>>,
}

impl MutualWait {
    fn problem(&self, robots: &[Robot]) -> Problem {
        let list = |parts: Vec<String>, last: &str| match parts.split_last() {
            Some((end, rest)) if !rest.is_empty() => format!("{} {last} {end}", rest.join(", ")),
            _ => parts.join(""),
        };
        let each = |words: &dyn Fn(usize, Step, Onwards) -> String| -> Vec<String> {
            self.robots.iter().map(|&(robot, step, then)| words(robot, step, then)).collect()
        };
        let names = list(each(&|robot, _, _| format!("`{}`", robots[robot].name)), "and");
        let places = list(
            each(&|robot, step, _| {
                format!("{} in `{}`", robots[robot].name, robots[robot].name_at(step))
            }),
            "and",
        );
        let after = |robot: usize, step: Step, _| {
            let action = robots[robot].action_at(step);
            let ms = action.and_then(|action| robots[robot].wait_ms(action)).unwrap_or(0);
            format!("{} after {} s", robots[robot].name, f64::from(ms) / 1e3)
        };
        let times = if self.robots.iter().all(|(.., then)| *then == Onwards::Moves) {
            format!("each moves again at the latest: {}", list(each(&after), "and"))
        } else {
            let times = each(&|robot, step, then| {
                let words = match then {
                    Onwards::Moves => "and it moves again",
                    Onwards::MayStand => "and it may stand again before it moves",
                    Onwards::Stands => "but it never moves again by itself",
                };
                format!("{}, {words}", after(robot, step, then))
            });
            format!("these waits end at the latest: {}", times.join("; "))
        };
        let ways = each(&|robot, _, _| {
            let way = self.ways[robot].iter().map(|&step| robots[robot].name_at(step));
            let way: Vec<&str> = way.collect();
            format!("{}: {}", robots[robot].name, way.join(", "))
        });
        Problem::warning(format!("{names} may wait for each other: {places}")).help(format!(
            "{times}; it comes to this by {}; a shorter hold, or a production that wanders when the \
             wait fails, ends it earlier",
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
    let mut known = HashSet::new();
    let mut is_complete = queue.len() < MAX_STATES;
    while let Some(state) = queue.pop_front() {
        let stuck = waiting(robots, &state);
        if !stuck.is_empty() && known.insert(looks(robots, &stuck)) {
            if waits.len() == MAX_WAITS {
                is_complete = false;
                break;
            }
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
            && looks(robots, &wait.robots)
                .iter()
                .all(|robot| looks(robots, &other.robots).contains(robot))
    };
    let is_largest: Vec<bool> =
        waits.iter().map(|wait| !waits.iter().any(|other| is_within(wait, other))).collect();
    let mut is_largest = is_largest.into_iter();
    waits.retain(|_| is_largest.next().unwrap_or(true));
    Explored { waits, is_complete }
}

/// What a message tells of the robots of a wait: two steps of one action may look the same.
fn looks(
    robots: &[Robot],
    wait: &[(usize, Step, Onwards)],
) -> Vec<(usize, Option<usize>, Onwards)> {
    let look = |&(robot, step, then): &(usize, Step, Onwards)| {
        (robot, robots[robot].action_at(step), then)
    };
    wait.iter().map(look).collect()
}

/// Every combination of first steps, as far as [`MAX_STATES`] goes.
fn starts(robots: &[Robot]) -> Vec<State> {
    robots.iter().fold(vec![State::new()], |states, robot| {
        let mut firsts: Vec<Step> = robot.flow.roots.iter().collect();
        if firsts.is_empty() {
            firsts.push(NOTHING);
        }
        let with = |state: &State| -> Vec<State> {
            let enter = |&step: &Step| {
                let mut longer = state.clone();
                longer.push((step, robot.signal(step).unwrap_or(0)));
                longer
            };
            firsts.iter().map(enter).collect()
        };
        states.iter().flat_map(with).take(MAX_STATES).collect()
    })
}

/// The states after one robot has gone on.
fn successors(robots: &[Robot], state: &State) -> Vec<State> {
    let mut all = Vec::new();
    for (index, robot) in robots.iter().enumerate() {
        let (step, last) = state[index];
        let mut go_on = |step: Step, signal: u16| {
            let mut state = state.clone();
            state[index] = (step, signal);
            all.push(state);
        };
        let next = robot.next.get(usize::from(step)).copied().unwrap_or_default();
        for step in next.iter() {
            go_on(step, robot.signal(step).unwrap_or(last));
        }
        for &code in robot.beside.get(usize::from(step)).into_iter().flatten() {
            go_on(step, code);
        }
    }
    all
}

/// The robots of a state that wait for each other, with their steps: a robot whose wait is open
/// only because of mates that go on is taken away, until none is left or only such that wait for
/// each other.
fn waiting(robots: &[Robot], state: &State) -> Vec<(usize, Step, Onwards)> {
    let signals: Vec<u16> = state.iter().map(|(_, signal)| *signal).collect();
    let stands = |index: usize| {
        let action = robots[index].action_at(state[index].0)?;
        robots[index].wait_ms(action).map(|_| (index, action))
    };
    let mut left: Vec<(usize, usize)> = (0..robots.len()).filter_map(stands).collect();
    loop {
        let bits = left.iter().fold(0_u8, |bits, (robot, _)| bits | 1 << robot);
        let before = left.len();
        left.retain(|&(robot, action)| robots[robot].is_kept(action, &signals, bits));
        if left.len() == before {
            let of = |&(robot, _): &(usize, usize)| {
                let step = state[robot].0;
                (robot, step, robots[robot].onwards[usize::from(step)])
            };
            return left.iter().map(of).collect();
        }
    }
}

/// The steps of each robot on the way to a state, the last ones only.
fn ways(came_from: &HashMap<State, Option<State>>, state: &State) -> Vec<Vec<Step>> {
    let mut ways: Vec<Vec<Step>> = state.iter().map(|(step, _)| vec![*step]).collect();
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
