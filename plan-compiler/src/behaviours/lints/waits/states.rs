//! All states that a plan can reach, found with the robot's own crates.

use super::Bound;
use grammar::{Choice, Ended, Event, Forest, Id, Life, Tell};
use monitor::{Assumptions, SituationGrid};
use plan_format::limits::MAX_DEPTH;
use plan_format::mission::{
    ActionKind, Condition, Mission, MissionDraft, PlanFrame, Production, Symbol,
};
use std::collections::HashMap;
use std::fmt::{self, Write};

/// Most states of one plan that are explored.
const MAX_STATES: usize = 3_000;
/// Most plan steps that are tried for one mission, so that time and memory have a bound: about two
/// seconds.
const MAX_WORK: usize = 60_000;
/// Extra time for each end of an action, milliseconds: the robot needs some ticks for the plan
/// steps.
const EVENT_MS: u64 = 500;
/// The only plan in the forest belongs to this behaviour.
const OWNER: u8 = 0;

/// The states of one plan in which actions run, and the transitions from each.
pub(super) struct States {
    states: Vec<State>,
    is_complete: bool,
}

/// One of them.
#[derive(Default)]
struct State {
    /// The decomposed frames with a timeout, each with its timeout, milliseconds.
    timed: Vec<(Id, u64)>,
    transitions: Vec<Transition>,
}

/// The end of one action, or of a frame that ends by a condition or by its timeout.
struct Transition {
    /// Longest time until the end, milliseconds.
    time_ms: u64,
    /// The point that is reached, if no other action runs there.
    stop: Option<Stop>,
    /// The states that may come next; empty if the plan has ended.
    next: Vec<Next>,
}

/// A state that comes next.
struct Next {
    state: usize,
    /// The timed frames that go on from the state before.
    lasting: Vec<Id>,
}

/// A point at which a plan may be interrupted.
pub(super) struct Stop {
    /// What is protected there.
    pub(super) held: Condition,
    /// The work lost by an interruption there; `None` after a failure, when it is not known.
    pub(super) lost_work: Option<u16>,
    /// The next points, each with its lost work and what it protects.
    pub(super) ahead: Vec<(u16, Condition)>,
}

/// How much may still be tried for the mission.
pub(super) struct Work {
    left: usize,
}

impl Default for Work {
    fn default() -> Self {
        Self { left: MAX_WORK }
    }
}

impl Work {
    /// Whether there is room for one step more.
    fn step(&mut self) -> bool {
        let is_left = self.left > 0;
        self.left = self.left.saturating_sub(1);
        is_left
    }
}

/// The state of one plan while it is carried out.
#[derive(Clone, Default)]
struct PlanState {
    forest: Forest,
    assumptions: Assumptions,
    /// The timed frames that have gone on since the last state.
    lasting: Vec<Id>,
}

/// FNV-1a over 128 bits.
struct Fingerprint(u128);

impl Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x100_0000_0000_0000_0000_013b);
        }
        Ok(())
    }
}

impl States {
    /// Carries out a frame in every way.
    pub(super) fn explore(draft: &MissionDraft, frame: u16, work: &mut Work) -> Self {
        let mut states = Self { states: Vec::new(), is_complete: true };
        let Ok(bytes) = draft.write() else { return Self { is_complete: false, ..states } };
        let Ok(mission) = Mission::parse(&bytes) else {
            return Self { is_complete: false, ..states };
        };
        let mut plan = PlanState::default();
        plan.change(&mission, |forest, tell| forest.plant(OWNER, frame, tell));
        let mut known = HashMap::new();
        let mut waiting: Vec<(usize, PlanState)> = Vec::new();
        states.add(&mission, plan, &mut known, &mut waiting, work);
        while let Some((index, plan)) = waiting.pop() {
            let running = plan.running(&mission);
            let timed = plan.timed(&mission);
            let times_ms = running.iter().chain(&timed).map(|&(_, time_ms)| time_ms);
            let time_ms = times_ms.min().unwrap_or(0) + EVENT_MS;
            let mut ends = plan.ends_of_frames(&mission);
            let mut transitions = Vec::new();
            for (id, _) in running {
                ends.extend([(id, false), (id, true)]);
            }
            for (id, has_failed) in ends {
                let mut after = plan.clone();
                after.lasting = timed.iter().map(|&(id, _)| id).collect();
                let stop = after.end(&mission, id, has_failed);
                let next = states.add(&mission, after, &mut known, &mut waiting, work);
                transitions.push(Transition { time_ms, stop, next });
            }
            states.states[index] = State { timed, transitions };
            if !states.is_complete {
                // Nothing is read of an incomplete search.
                states.states = Vec::new();
                break;
            }
        }
        states
    }

    /// The indices of the states with running actions that a plan reaches at once; adds new states
    /// to `waiting`.
    fn add(
        &mut self,
        mission: &Mission<'_>,
        plan: PlanState,
        known: &mut HashMap<u128, usize>,
        waiting: &mut Vec<(usize, PlanState)>,
        work: &mut Work,
    ) -> Vec<Next> {
        let mut next = Vec::new();
        for mut settled in plan.settle(mission, &mut self.is_complete, work) {
            let lasting = core::mem::take(&mut settled.lasting);
            let key = settled.key();
            let state = *known.entry(key).or_insert_with(|| {
                self.states.push(State::default());
                waiting.push((self.states.len() - 1, settled));
                self.states.len() - 1
            });
            next.push(Next { state, lasting });
        }
        self.is_complete &= self.states.len() <= MAX_STATES;
        next
    }

    /// The longest time from any state to the end of the plan, or to a point that `is_free`.
    pub(super) fn longest(&self, is_free: impl Fn(&Stop) -> bool) -> Bound {
        if !self.is_complete {
            return Bound::Unknown;
        }
        let is_end =
            |end: &Transition| end.next.is_empty() || end.stop.as_ref().is_some_and(&is_free);
        // The longest path in a graph without cycles: a state is known when all after it are.
        let mut longest: Vec<Option<u64>> = vec![None; self.states.len()];
        let mut left = self.states.len();
        while left > 0 {
            let before = left;
            for (index, state) in self.states.iter().enumerate().rev() {
                if longest[index].is_some() {
                    continue;
                }
                let time = |end: &Transition| {
                    if is_end(end) {
                        return Some(end.time_ms);
                    }
                    let mut next = end.next.iter();
                    let after = next.try_fold(0, |most, next| Some(longest[next.state]?.max(most)));
                    after.map(|after: u64| after.saturating_add(end.time_ms))
                };
                let mut ends = state.transitions.iter();
                let most = ends.try_fold(0, |most, end| Some(time(end)?.max(most)));
                if most.is_some() {
                    longest[index] = most;
                    left -= 1;
                }
            }
            if left == before {
                // What is left goes round in cycles. A frame with a timeout ends some.
                let Some((ended, time_ms)) = self.ended_by_timeout(&longest, is_end) else {
                    return Bound::None;
                };
                left -= ended.iter().filter(|&&state| longest[state].is_none()).count();
                for state in ended {
                    longest[state].get_or_insert(time_ms);
                }
            }
        }
        Bound::Within(longest.into_iter().flatten().max().unwrap_or(0))
    }

    /// States within one timed frame whose longest time is not known, while those of all states that
    /// follow the frame are; and their longest time: that of the frame and of what follows it.
    fn ended_by_timeout(
        &self,
        longest: &[Option<u64>],
        is_end: impl Fn(&Transition) -> bool,
    ) -> Option<(Vec<usize>, u64)> {
        let unknown = (0..self.states.len()).filter(|&state| longest[state].is_none());
        let mut frames = unknown
            .flat_map(|state| self.states[state].timed.iter().map(move |frame| (state, frame)));
        frames.find_map(|(start, &(frame, timeout_ms))| {
            let (mut within, mut after_ms) = (vec![start], 0);
            let mut is_within = vec![false; self.states.len()];
            is_within[start] = true;
            let mut visited = 0;
            while let Some(&state) = within.get(visited) {
                visited += 1;
                let transitions = self.states[state].transitions.iter();
                for next in transitions.filter(|end| !is_end(end)).flat_map(|end| &end.next) {
                    if !next.lasting.contains(&frame) {
                        after_ms = longest[next.state]?.max(after_ms);
                    } else if !is_within[next.state] {
                        is_within[next.state] = true;
                        within.push(next.state);
                    }
                }
            }
            Some((within, after_ms.saturating_add(timeout_ms + EVENT_MS)))
        })
    }
}

impl PlanState {
    fn change<T>(
        &mut self,
        mission: &Mission<'_>,
        act: impl FnOnce(&mut Forest, &mut Tell<'_>) -> T,
    ) -> T {
        let Self { forest, assumptions, lasting } = self;
        act(forest, &mut |pool, event| {
            assumptions.apply(mission, pool, event);
            if let Event::Deleted { id } = event {
                lasting.retain(|frame| frame != id);
            }
        })
    }

    fn grid(&self) -> SituationGrid<'_> {
        SituationGrid::new(self.forest.pool(), &self.assumptions)
    }

    /// A fingerprint of the plan: equal plans have equal ones, and two of the few thousand different
    /// ones of a mission hardly ever do.
    fn key(&self) -> u128 {
        let mut print = Fingerprint(0xcbf2_9ce4_8422_2325_cbf2_9ce4_8422_2325);
        // Writing into a number cannot fail.
        let _ = write!(print, "{:?}", self.forest);
        print.0
    }

    /// The running actions, and the longest time of each, milliseconds.
    fn running(&self, mission: &Mission<'_>) -> Vec<(Id, u64)> {
        let running = self.forest.iter().filter_map(|(id, component)| match component.symbol {
            Symbol::Action(index) if component.life == Life::Started => {
                let action = mission.actions().get(usize::from(index))?;
                let own_ms = match action.kind {
                    ActionKind::Hold { for_ms }
                    | ActionKind::Wander { for_ms }
                    | ActionKind::MoveAhead { for_ms, .. } => for_ms,
                    ActionKind::Signal { .. } | ActionKind::SetOutput { .. }
                        if action.until.is_empty() =>
                    {
                        0
                    }
                    _ => action.timeout_ms,
                };
                Some((id, u64::from(own_ms.min(action.timeout_ms))))
            }
            _ => None,
        });
        running.collect()
    }

    /// The decomposed frames.
    fn decomposed(&self, mission: &Mission<'_>) -> impl Iterator<Item = (Id, PlanFrame)> {
        self.forest.iter().filter_map(|(id, component)| match component.symbol {
            Symbol::PlanFrame(index) if component.life == Life::Started => {
                Some((id, mission.plan_frames().get(usize::from(index))?))
            }
            _ => None,
        })
    }

    /// The decomposed frames with a timeout, each with its timeout, milliseconds.
    fn timed(&self, mission: &Mission<'_>) -> Vec<(Id, u64)> {
        let timed = self.decomposed(mission).filter(|(_, frame)| frame.timeout_ms != 0);
        timed.map(|(id, frame)| (id, frame.timeout_ms.into())).collect()
    }

    /// The decomposed frames that may end at any time, each with whether that is a failure.
    fn ends_of_frames(&self, mission: &Mission<'_>) -> Vec<(Id, bool)> {
        let mut ends = Vec::new();
        for (id, frame) in self.decomposed(mission) {
            if !frame.until.is_empty() {
                ends.push((id, false));
            }
            if frame.timeout_ms != 0 {
                ends.push((id, true));
            }
        }
        ends
    }

    /// Ends a component. Returns the point that is then reached, unless another action still runs.
    fn end(&mut self, mission: &Mission<'_>, id: Id, has_failed: bool) -> Option<Stop> {
        let work = self.work_after(mission, id);
        if has_failed {
            self.change(mission, |forest, tell| forest.fail(id, tell));
        } else {
            self.complete(mission, id);
        }
        if !self.running(mission).is_empty() {
            return None;
        }
        let held =
            self.grid().held(OWNER).fold(Condition::default(), |all, (_, held)| all.and(held));
        let mut ahead = Vec::new();
        self.grid().points(mission, OWNER, &mut |point| ahead.push((point.lost_work, point.held)));
        Some(Stop { held, lost_work: work.filter(|_| !has_failed), ahead })
    }

    /// The work lost by an interruption at the vertex that a component leads to. If it completes
    /// the frames above it, the outermost vertex counts, as on the robot.
    fn work_after(&self, mission: &Mission<'_>, id: Id) -> Option<u16> {
        let outermost = core::iter::successors(Some(id), |&id| self.forest.completes(mission, id));
        let last = outermost.take(MAX_DEPTH + 1).filter(|&id| self.parent(id).is_some()).last()?;
        let component = self.forest.get(last)?;
        let production = self.forest.production_of(mission, component.parent?)?;
        let into = mission.edges_of(&production).filter(|edge| edge.to == component.to);
        Some(into.fold(0, |sum: u16, edge| sum.saturating_add(edge.work)))
    }

    fn parent(&self, id: Id) -> Option<Id> {
        self.forest.get(id)?.parent
    }

    fn complete(&mut self, mission: &Mission<'_>, id: Id) {
        let mut id = id;
        for _ in 0..=MAX_DEPTH {
            match self.change(mission, |forest, tell| forest.finish(mission, id, tell)) {
                Ended::Completes(frame) => id = frame,
                _ => return,
            }
        }
    }

    /// Every state that the plan reaches by decomposing scheduled frames and starting actions,
    /// whatever is applicable. A plan that has ended reaches none.
    fn settle(self, mission: &Mission<'_>, is_complete: &mut bool, work: &mut Work) -> Vec<Self> {
        /// Decompositions without an action in between are few; the limit stops a mission that
        /// fails endlessly without taking time.
        const MAX_TRIES: usize = 2_000;
        let (mut settled, mut open) = (Vec::new(), vec![self]);
        for _ in 0..MAX_TRIES {
            let Some(mut plan) = open.pop() else { return settled };
            if !work.step() {
                break;
            }
            let Some(id) = plan.forest.scheduled(OWNER) else {
                if !plan.forest.is_empty() {
                    settled.push(plan);
                }
                continue;
            };
            match plan.forest.get(id).map(|component| component.symbol) {
                Some(Symbol::PlanFrame(frame)) => plan.choices(mission, id, frame, &mut open),
                _ => {
                    plan.change(mission, |forest, tell| forest.start(id, tell));
                    open.push(plan);
                }
            }
        }
        *is_complete = false;
        settled
    }

    /// One plan for each production that a frame may choose, and one for the case that none is
    /// applicable.
    fn choices(&self, mission: &Mission<'_>, id: Id, frame: u16, open: &mut Vec<Self>) {
        let Some(frame) = mission.plan_frames().get(usize::from(frame)) else { return };
        if !frame.until.is_empty() {
            // It may hold already.
            let mut plan = self.clone();
            plan.complete(mission, id);
            open.push(plan);
        }
        let decompose = |plan: &mut Self, value: &mut dyn FnMut(u16, &Production) -> f32| {
            plan.change(mission, |forest, tell| forest.decompose(mission, id, value, tell))
        };
        for chosen in frame.first..frame.first.saturating_add(frame.count.into()) {
            let mut plan = self.clone();
            let wanted = &mut |index, _: &Production| if index == chosen { 1.0 } else { -1.0 };
            match decompose(&mut plan, wanted) {
                (_, Choice::Production(_)) => open.push(plan),
                (id, Choice::NoRoom | Choice::TooDeep) => {
                    plan.change(mission, |forest, tell| forest.fail(id, tell));
                    open.push(plan);
                }
                _ => {}
            }
        }
        let mut plan = self.clone();
        // A production without rules is always applicable.
        let none = &mut |_, production: &Production| production.rules.map_or(1.0, |_| -1.0);
        match decompose(&mut plan, none) {
            (id, Choice::LoopEnded) => plan.complete(mission, id),
            (id, Choice::NothingApplicable) => {
                plan.change(mission, |forest, tell| forest.fail(id, tell));
            }
            _ => return,
        }
        open.push(plan);
    }
}
