//! Random missions and inputs for the whole tick, by the million, and the invariants of each tick.
//!
//! [`missions`] draws missions from a seed. They are sound by construction and use every kind of
//! record; those with odd seeds belong to a robot of a team. [`world`] draws the percepts: inputs that
//! are missing or not numbers, positions that jump, clocks that stand still, an operator who disarms.
//! After each tick the [`invariants`] are checked. Some ticks are repeated from a copy of their state
//! and must give the same result. A corrupted mission must be refused or run like any other.
//!
//! Invariants: equal seeds give equal runs on every machine. A failure reports the seed that draws
//! the failing mission first.
//!
//! Deliberately absent: whether the robot's actions are sensible. The tests of the crates and the
//! closed-loop missions check that.

pub mod fixtures;
pub mod invariants;
pub mod missions;
mod random;
pub mod world;

use behaviour::Decision;
use controller::{Explanation, State};
use invariants::Watch;
use monitor::{Doubt, Signal, Violation};
use plan_format::Blob;
use plan_format::mission::MissionDraft;
use random::Random;
use robot_io::TraceHash;
use std::collections::BTreeMap;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use world::World;

/// Most ticks of one mission.
const MAX_MISSION_TICKS: u64 = 2_000;

/// One tick in this number is repeated from a copy of its state.
const TICKS_PER_REPEAT: u32 = 16;

/// Statistics of a soak.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Ticks that were run.
    pub ticks: u64,
    /// Missions that were drawn.
    pub missions: u64,
    /// Corrupted missions that were refused.
    pub refused: u64,
    /// The most components that lived at once.
    pub components: usize,
    /// The most actions that ran at once.
    pub running: usize,
    /// Number of decisions and signals of each kind.
    pub decisions: BTreeMap<&'static str, u64>,
    /// Hash over all percepts and commands.
    pub hash: u64,
}

/// A violated invariant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The seed that draws the failing mission first.
    pub seed: u64,
    /// Tick of that mission.
    pub tick: u64,
    /// The violation.
    pub what: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "--seed {} fails in tick {}: {}", self.seed, self.tick, self.what)
    }
}

impl std::error::Error for Failure {}

/// Runs missions, the first from `seed`, until at least `ticks` ticks are done. Calls `progress`
/// with the number of ticks after each mission.
pub fn soak(seed: u64, ticks: u64, progress: &mut dyn FnMut(u64)) -> Result<Summary, Failure> {
    let mut summary = Summary::default();
    let mut hash = TraceHash::default();
    while summary.ticks < ticks {
        let seed = seed.wrapping_add(summary.missions);
        let mut tick = 0;
        let run = AssertUnwindSafe(|| mission(seed, &mut tick, &mut summary, &mut hash));
        let what = match catch_unwind(run) {
            Ok(Ok(())) => None,
            Ok(Err(what)) => Some(what),
            Err(_) => Some("a panic".into()),
        };
        if let Some(what) = what {
            return Err(Failure { seed, tick, what });
        }
        summary.missions += 1;
        progress(summary.ticks);
    }
    summary.hash = hash.get();
    Ok(summary)
}

/// Runs one mission; every fourth also in corrupted forms.
fn mission(
    seed: u64,
    tick: &mut u64,
    summary: &mut Summary,
    hash: &mut TraceHash,
) -> Result<(), String> {
    let mut random = Random::new(seed);
    let (draft, is_in_team) = drawn(seed, &mut random);
    if random.chance(0.25) {
        let (refused, run) = missions::corrupt(&draft, &mut random);
        summary.refused += refused;
        if let Some(blob) = run {
            run_ticks(&blob, &mut random, 50, tick, summary, hash)?;
        }
    }
    let blob = if is_in_team { fixtures::blob_of_team(draft) } else { fixtures::blob(draft) };
    let blob = blob.map_err(|error| format!("the mission is refused: {error}"))?;
    let ticks = 20 + random.below(MAX_MISSION_TICKS - 20);
    run_ticks(&blob, &mut random, ticks, tick, summary, hash)
}

/// The mission of a seed, and whether it is that of a robot of a team.
fn drawn(seed: u64, random: &mut Random) -> (MissionDraft, bool) {
    let mut draft = missions::draw(random);
    let is_in_team = seed % 2 == 1;
    if is_in_team {
        missions::join_team(&mut draft, random);
    }
    (draft, is_in_team)
}

fn run_ticks(
    blob: &[u8],
    random: &mut Random,
    ticks: u64,
    tick: &mut u64,
    summary: &mut Summary,
    hash: &mut TraceHash,
) -> Result<(), String> {
    let blob = Blob::parse(blob).map_err(|error| format!("the mission is refused: {error}"))?;
    let mut world = World::new(&blob, random);
    let mut state = State::new(&blob);
    let mut watch = Watch::default();
    for _ in 0..ticks {
        *tick += 1;
        summary.ticks += 1;
        let percepts = world.percepts(random);
        let copy = random.one_in(TICKS_PER_REPEAT).then(|| state.clone());
        let explanation = controller::explain(&blob, &mut state, &percepts);
        if let Some(mut copy) = copy {
            let again = controller::explain(&blob, &mut copy, &percepts);
            if again != explanation || copy != state {
                return Err("a repeated tick gives another result".into());
            }
        }
        watch.check(&blob, &state, &percepts, &explanation)?;
        count(summary, &state, &explanation);
        hash.record(&percepts, &explanation.commands);
        world.go(&explanation.commands, random);
    }
    Ok(())
}

fn count(summary: &mut Summary, state: &State, explanation: &Explanation) {
    summary.components = summary.components.max(state.behaviours.components());
    summary.running = summary.running.max(invariants::running(&state.behaviours).count());
    for decision in &explanation.report.decisions {
        *summary.decisions.entry(kind(decision)).or_default() += 1;
    }
}

/// Every kind of decision, by the names that `kind` gives.
pub const KINDS: &[&str] = &[
    "prepared",
    "engaged",
    "resumed",
    "interrupted",
    "interrupted at once",
    "overruled",
    "refused: dwell",
    "refused: no point yet",
    "refused: better point ahead",
    "refused: excluded",
    "refused: shutting down",
    "chose",
    "not decomposed: nothing applicable",
    "not decomposed: no room",
    "not decomposed: too deep",
    "finished",
    "failed",
    "timed out",
    "evident: initial",
    "evident: transient",
    "evident: goal",
    "evident: interval",
    "evident: foreign",
    "possible: no producer",
    "possible: clobberer",
    "possible: choice",
];

/// The kind of a decision.
fn kind(decision: &Decision) -> &'static str {
    use behaviour::{Choice, Refusal};
    match decision {
        Decision::Prepared { .. } => "prepared",
        Decision::Engaged { .. } => "engaged",
        Decision::Resumed { .. } => "resumed",
        Decision::Interrupted { is_unconditional: false, .. } => "interrupted",
        Decision::Interrupted { is_unconditional: true, .. } => "interrupted at once",
        Decision::Overruled { .. } => "overruled",
        Decision::Refused { why, .. } => match why {
            Refusal::Dwell => "refused: dwell",
            Refusal::NoPointYet => "refused: no point yet",
            Refusal::BetterPointAhead => "refused: better point ahead",
            Refusal::Excluded => "refused: excluded",
            Refusal::ShuttingDown => "refused: shutting down",
        },
        Decision::Chose { .. } => "chose",
        Decision::NotDecomposed { why: Choice::NoRoom, .. } => "not decomposed: no room",
        Decision::NotDecomposed { why: Choice::TooDeep, .. } => "not decomposed: too deep",
        Decision::NotDecomposed { .. } => "not decomposed: nothing applicable",
        Decision::Finished { .. } => "finished",
        Decision::Failed { .. } => "failed",
        Decision::TimedOut { .. } => "timed out",
        Decision::Conflict { signal: Signal::Evident { what, .. }, .. } => match what {
            Violation::Initial => "evident: initial",
            Violation::Transient => "evident: transient",
            Violation::Goal => "evident: goal",
            Violation::Interval => "evident: interval",
            Violation::Foreign => "evident: foreign",
        },
        Decision::Conflict { signal: Signal::Possible { why, .. }, .. } => match why {
            Doubt::NoProducer => "possible: no producer",
            Doubt::Clobberer(_) => "possible: clobberer",
            Doubt::Choice(_) => "possible: choice",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Every source of an input, and every kind of fact and of action.
    #[test]
    fn the_missions_use_everything() {
        let word = |value: &dyn fmt::Debug| {
            let text = format!("{value:?}");
            text.split([' ', '(']).next().expect("a name").to_owned()
        };
        let mut found = BTreeSet::new();
        for seed in 0..400 {
            let (draft, _) = drawn(seed, &mut Random::new(seed));
            found.extend(draft.inputs.iter().map(|input| word(&input.source)));
            found.extend(draft.facts.iter().map(|fact| word(&fact.kind)));
            found.extend(draft.actions.iter().map(|action| word(&action.kind)));
        }
        let expected = "Channel CostToGoal DistanceTo DistanceToMate Dock Fact Follow GoTo Hold Inside \
            Level LinkToMate Linked MateAt MateNear MateSignals MatesLinked MoveAhead Near NoProgress \
            OldestNews Output PriceOfConstraint RangeLeft Return Rules SetOutput Signal Symbol Time \
            Wander";
        assert_eq!(found.into_iter().collect::<Vec<_>>().join(" "), expected);
    }
}
