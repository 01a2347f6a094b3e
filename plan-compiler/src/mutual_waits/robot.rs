//! One robot of a team: its steps, its waits, and what follows them.

use super::flow::{self, Flow, Step, Steps};
use crate::mission;
use plan_format::mission::{
    ActionKind, Condition, FactKind, MissionDraft, PlanFrame, Source as InputSource, Symbol,
    effects,
};

/// Most inputs in a row through which a fact is about a mate.
const MAX_DEPTH: usize = 8;

/// One robot: its actions, and which of them can follow which.
pub(super) struct Robot {
    pub(super) name: String,
    pub(super) mission: mission::Mission,
    pub(super) draft: MissionDraft,
    /// Whether its part has no mistakes.
    pub(super) is_sound: bool,
    names: Vec<String>,
    pub(super) flow: Flow,
    /// By edge, the steps that can follow.
    pub(super) next: Vec<Steps>,
    /// By action, the frames above it that end early.
    above: Vec<Vec<PlanFrame>>,
    /// By edge, the codes that may be signalled beside its component, and the one that is as it begins.
    pub(super) beside: Vec<Vec<u16>>,
    with: Vec<Option<u16>>,
    /// By edge, what the robot does after a wait there.
    pub(super) onwards: Vec<Onwards>,
}

impl Robot {
    pub(super) fn of(name: &str, mission: mission::Mission, draft: Option<MissionDraft>) -> Self {
        let is_sound = draft.is_some();
        let draft = draft.unwrap_or_default();
        let names = mission.behaviours.actions.iter().map(|action| action.name.value.clone());
        let names = names.collect();
        let flow = Flow::of(&draft);
        let next = (0..draft.edges.len()).map(|step| flow.next(&draft, step)).collect();
        let (beside, with) = (flow::signals_beside(&draft), flow::signals_with(&draft));
        let above = above(&draft);
        let mut robot = Self {
            name: name.into(),
            mission,
            is_sound,
            names,
            flow,
            next,
            above,
            beside,
            with,
            draft,
            onwards: Vec::new(),
        };
        let edges = 0..robot.draft.edges.len() as Step;
        robot.onwards = edges.map(|step| robot.onwards(step)).collect();
        robot
    }

    /// The robot's last signal once a step has begun, if that changes it.
    pub(super) fn signal(&self, step: Step) -> Option<u16> {
        let step = usize::from(step);
        let with = || self.with.get(step).copied().flatten();
        flow::signal(&self.draft, step).or_else(with)
    }

    /// The action of a step; `None` for a robot without behaviours.
    pub(super) fn action_at(&self, step: Step) -> Option<usize> {
        match self.draft.edges.get(usize::from(step))?.symbol {
            Symbol::Action(action) => Some(action.into()),
            Symbol::PlanFrame(_) => None,
        }
    }

    /// The conditions that end an action, each by itself: its own, and those of the frames above it.
    fn ends(&self, action: usize) -> Vec<Condition> {
        let own = self.draft.actions.get(action).map(|action| action.until);
        let above = self.above.get(action).into_iter().flatten().map(|frame| frame.until);
        own.into_iter().chain(above).filter(|until| !until.is_empty()).collect()
    }

    /// How long the robot stands in an action, milliseconds, if it stands there for a mate.
    pub(super) fn wait_ms(&self, action: usize) -> Option<u32> {
        let ends = self.ends(action);
        let facts = ends.iter().fold(0, |facts, until| facts | until.must | until.must_not);
        let is_for_mate = (0_u32..)
            .zip(&self.draft.facts)
            .any(|(index, fact)| facts >> index & 1 == 1 && self.mates_of(fact.kind, 0) != 0);
        let ms = self.own_ms(action)?.min(self.above_ms(action));
        is_for_mate.then_some(ms)
    }

    /// Whether any of its actions stands for a mate.
    pub(super) fn may_wait(&self) -> bool {
        (0..self.draft.actions.len()).any(|action| self.wait_ms(action).is_some())
    }

    /// How long the robot stands in an action by that action alone, milliseconds; `None` if it drives,
    /// or goes on at once.
    fn own_ms(&self, action: usize) -> Option<u32> {
        let action = self.draft.actions.get(action)?;
        match action.kind {
            ActionKind::Hold { for_ms } => Some(for_ms.min(action.timeout_ms)),
            ActionKind::Signal { .. } | ActionKind::SetOutput { .. } => {
                (!action.until.is_empty()).then_some(action.timeout_ms)
            }
            // All others drive, see `drives`.
            _ => None,
        }
    }

    /// The shortest timeout of the frames above an action, milliseconds.
    fn above_ms(&self, action: usize) -> u32 {
        let above = self.above.get(action).into_iter().flatten().map(|frame| frame.timeout_ms);
        above.filter(|&time_ms| time_ms != 0).min().unwrap_or(u32::MAX)
    }

    /// What the robot does once a wait has ended by its time.
    fn onwards(&self, step: Step) -> Onwards {
        let Some(action) = self.action_at(step) else { return Onwards::Stands };
        let at = usize::from(step);
        let has_goal = flow::described(&self.draft, Symbol::Action(action as u16))
            .is_some_and(|description| !description.goal.is_empty());
        let own_ms = self.own_ms(action).unwrap_or(u32::MAX);
        let is_hold = matches!(self.draft.actions[action].kind, ActionKind::Hold { .. });
        let mut next = self.flow.after_success[at];
        if !is_hold || own_ms > self.above_ms(action) || has_goal {
            next |= self.flow.after_failure[at];
        }
        if self.draft.behaviours.len() > 1 {
            next |= self.flow.roots;
        }
        // Signals and outputs take no time: what comes after them comes next.
        let is_instant = |action| self.own_ms(action).is_none() && !self.drives(action);
        let soon = self.reach(next, is_instant);
        let all = self.reach(next, |_| true);
        let stands = soon.iter().any(|&action| self.own_ms(action).is_some());
        match (stands, all.iter().any(|&action| self.drives(action))) {
            (_, false) => Onwards::Stands,
            (false, true) => Onwards::Moves,
            (true, true) => Onwards::MayStand,
        }
    }

    /// The actions of the next steps, and of those after steps that are passed.
    fn reach(&self, next: Steps, is_passed: impl Fn(usize) -> bool) -> Vec<usize> {
        let (mut open, mut seen): (Vec<Step>, Vec<Step>) = (next.iter().collect(), Vec::new());
        let mut actions = Vec::new();
        while let Some(step) = open.pop() {
            if seen.contains(&step) {
                continue;
            }
            seen.push(step);
            let Some(action) = self.action_at(step) else { continue };
            actions.push(action);
            if is_passed(action) {
                open.extend(self.next[usize::from(step)].iter());
            }
        }
        actions
    }

    fn drives(&self, action: usize) -> bool {
        match self.draft.actions[action].kind {
            ActionKind::Hold { .. } | ActionKind::Signal { .. } | ActionKind::SetOutput { .. } => {
                false
            }
            ActionKind::Follow { .. }
            | ActionKind::GoTo { .. }
            | ActionKind::Wander { .. }
            | ActionKind::Return
            | ActionKind::MoveAhead { .. }
            | ActionKind::Dock { .. } => true,
        }
    }

    /// Whether robots of a set, one bit each, keep a wait from ending: each of its ends is open
    /// because of one of them.
    pub(super) fn is_kept(&self, action: usize, signals: &[u16], robots: u8) -> bool {
        self.ends(action).into_iter().all(|until| self.waits_for(until, signals) & robots != 0)
    }

    /// The mates that keep a condition from holding, one bit each: what they signalled last is known,
    /// where they are is not.
    fn waits_for(&self, until: Condition, signals: &[u16]) -> u8 {
        let open = |kind: FactKind, wanted: bool| -> u8 {
            let FactKind::MateSignals { mates, code } = kind else {
                return self.mates_of(kind, 0);
            };
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

    /// The mates that a fact is about, one bit each, by itself or through an input.
    fn mates_of(&self, kind: FactKind, depth: usize) -> u8 {
        match kind {
            FactKind::Linked(mates)
            | FactKind::MateNear { mates, .. }
            | FactKind::MateAt { mates, .. }
            | FactKind::MateSignals { mates, .. } => mates.robots,
            FactKind::Level { input, .. } => self.mates_of_input(input, depth + 1),
            FactKind::Symbol { .. }
            | FactKind::Near { .. }
            | FactKind::Inside { .. }
            | FactKind::NoProgress { .. } => 0,
        }
    }

    fn mates_of_input(&self, input: u8, depth: usize) -> u8 {
        // Inputs refer to facts and rule bases, and these to inputs.
        let input = self.draft.inputs.get(usize::from(input));
        let Some(input) = input.filter(|_| depth < MAX_DEPTH) else { return 0 };
        match input.source {
            InputSource::MatesLinked | InputSource::OldestNews => self.mission.team.mate_bits(),
            InputSource::DistanceToMate(mates) => mates,
            InputSource::LinkToMate(mate) => 1_u8.checked_shl(mate.into()).unwrap_or(0),
            InputSource::Fact(fact) => {
                let fact = self.draft.facts.get(usize::from(fact));
                fact.map_or(0, |fact| self.mates_of(fact.kind, depth))
            }
            InputSource::Rules(base) => {
                let Some(base) = self.draft.rule_bases.get(usize::from(base)) else { return 0 };
                let (first, count) = (usize::from(base.first), usize::from(base.count));
                let rules = self.draft.rules.iter().skip(first).take(count);
                rules.fold(0, |all, rule| all | self.mates_of_input(rule.input, depth + 1))
            }
            InputSource::Channel(_)
            | InputSource::DistanceTo { .. }
            | InputSource::Time
            | InputSource::CostToGoal { .. }
            | InputSource::PriceOfConstraint { .. }
            | InputSource::Output(_)
            | InputSource::RangeLeft { .. } => 0,
        }
    }

    pub(super) fn name_at(&self, step: Step) -> &str {
        let name = self.action_at(step).and_then(|action| self.names.get(action));
        name.map_or("nothing", String::as_str)
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

/// What a robot does after a wait that only its time has ended.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Onwards {
    /// It drives.
    Moves,
    /// It may stand again, for a mate or for a time, before it drives.
    MayStand,
    /// None of the actions that can follow drives.
    Stands,
}
