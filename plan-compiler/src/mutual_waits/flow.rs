//! Which steps of a robot can follow each other, by its grammar.
//!
//! A step is an action at one edge of a production: the same action may lead on to something else
//! elsewhere.
//!
//! After a success comes what leaves the component's end; at the exit, what follows its frame. After a
//! failure the frame falls back to another of its productions, and if none is left it fails in the
//! production above it; after the failure of a root its behaviour begins anew. A component may also
//! end before an action of it runs: a frame whose `until` holds already or whose loop is over
//! succeeds, and a component that cannot start fails.

use std::iter;
use std::ops::{BitOr, BitOrAssign};

use plan_format::mission::{
    ActionKind, Behaviour, Description, Edge, MissionDraft, Production, Symbol, effects,
};

/// An action at one edge, by the edge's index.
pub(super) type Step = u16;

/// A set of steps, one bit each.
#[derive(Clone, Copy, Default, PartialEq)]
pub(super) struct Steps([u64; WORDS]);

const WORDS: usize = plan_format::limits::MAX_EDGES / 64;

impl Steps {
    fn insert(&mut self, step: Step) {
        self.0[usize::from(step) / 64] |= 1 << (step % 64);
    }

    pub(super) fn contains(&self, step: Step) -> bool {
        self.0[usize::from(step) / 64] >> (step % 64) & 1 == 1
    }

    pub(super) fn iter(self) -> impl Iterator<Item = Step> {
        (0..plan_format::limits::MAX_EDGES as Step).filter(move |&step| self.contains(step))
    }

    /// Adds others, and returns whether the set has grown.
    fn grow(&mut self, more: Self) -> bool {
        let before = *self;
        *self |= more;
        *self != before
    }
}

impl BitOr for Steps {
    type Output = Self;

    fn bitor(mut self, other: Self) -> Self {
        self |= other;
        self
    }
}

impl BitOrAssign for Steps {
    fn bitor_assign(&mut self, other: Self) {
        for (own, more) in self.0.iter_mut().zip(other.0) {
            *own |= more;
        }
    }
}

/// What can begin a robot's plans, and what can follow each step.
pub(super) struct Flow {
    /// Steps that can begin the plans.
    pub(super) roots: Steps,
    /// By edge: what can run after the success of its action.
    pub(super) after_success: Vec<Steps>,
    /// By edge: what can run after its action has failed, or after a frame above has ended it.
    pub(super) after_failure: Vec<Steps>,
    frames: Vec<PlanFrameFlow>,
}

/// What is known of a plan frame.
#[derive(Clone, Copy, Default, PartialEq)]
struct PlanFrameFlow {
    /// Steps that can run first.
    first: Steps,
    /// Whether it may succeed, or fail, before an action of it runs.
    may_be_empty: bool,
    may_fail_at_once: bool,
    /// What can run after its success, after its failure, and after a frame above has ended it.
    succeeded: Steps,
    failed: Steps,
    ended: Steps,
}

/// What can happen next at a vertex of a production, before another action runs.
#[derive(Default)]
struct Ahead {
    steps: Steps,
    reaches_exit: bool,
    may_fail: bool,
}

impl Flow {
    pub(super) fn of(draft: &MissionDraft) -> Self {
        let (frames, edges) = (draft.frames.len(), draft.edges.len());
        let mut flow = Self {
            roots: Steps::default(),
            after_success: vec![Steps::default(); edges],
            after_failure: vec![Steps::default(); edges],
            frames: vec![PlanFrameFlow::default(); frames],
        };
        // Frames contain each other, so these are repeated until nothing changes: sets only grow.
        while flow.grow_first(draft) {}
        let roots = draft.behaviours.iter().flat_map(Behaviour::plan_frames);
        let roots: Vec<usize> = roots.map(usize::from).collect();
        flow.roots =
            roots.iter().fold(Steps::default(), |all, &frame| all | flow.frames[frame].first);
        for frame in roots {
            // A plan begins anew after its end, either way, and one plan leads to another.
            (flow.frames[frame].succeeded, flow.frames[frame].failed) = (flow.roots, flow.roots);
        }
        while flow.grow_after(draft) {}
        flow
    }

    /// What can run after a step, however it ends; with several behaviours also what another one
    /// begins with.
    pub(super) fn next(&self, draft: &MissionDraft, step: usize) -> Steps {
        let own = self.after_success[step] | self.after_failure[step];
        if draft.behaviours.len() > 1 { own | self.roots } else { own }
    }

    fn grow_first(&mut self, draft: &MissionDraft) -> bool {
        let before = self.frames.clone();
        let is_alone = draft.behaviours.len() < 2 && draft.intervals.is_empty();
        for (index, frame) in draft.frames.iter().enumerate() {
            let (mut may_be_empty, mut may_fail) = (!frame.until.is_empty(), true);
            for (_, production) in productions(draft).filter(|&(of, _)| of == index) {
                let production = &draft.productions[production];
                let ahead = self.ahead(draft, production, 0);
                self.frames[index].first |= ahead.steps;
                may_be_empty |= ahead.reaches_exit;
                // One that is always applicable and can start keeps the frame from failing.
                let may_be_left = ahead.may_fail || production.rules.is_some();
                may_fail &= may_be_left;
                // Of equal ones the first is chosen, unless another spares what is protected.
                if !may_be_left && is_alone {
                    break;
                }
            }
            may_fail |= described(draft, Symbol::PlanFrame(index as u16))
                .is_some_and(|description| !description.initial.is_empty());
            self.frames[index].may_be_empty |= may_be_empty || may_end_loop(draft, index);
            self.frames[index].may_fail_at_once |= may_fail;
        }
        self.frames != before
    }

    fn ahead(&self, draft: &MissionDraft, production: &Production, vertex: u8) -> Ahead {
        let all = draft.edges_of(production);
        let exit = production.vertices.saturating_sub(1);
        let (mut ahead, mut reached, mut next) = (Ahead::default(), vec![vertex], 0);
        while let Some(&vertex) = reached.get(next) {
            next += 1;
            ahead.reaches_exit |= vertex == exit;
            let numbered = (production.first_edge..).zip(all);
            for (at, edge) in numbered.filter(|(_, edge)| edge.from == vertex) {
                let is_bound = described(draft, edge.symbol)
                    .is_some_and(|description| !description.initial.is_empty());
                ahead.may_fail |= is_bound;
                match edge.symbol {
                    Symbol::Action(_) => ahead.steps.insert(at),
                    Symbol::PlanFrame(index) => {
                        let frame = self.frames[usize::from(index)];
                        ahead.steps |= frame.first;
                        ahead.may_fail |= frame.may_fail_at_once;
                        if frame.may_be_empty && !reached.contains(&edge.to) {
                            reached.push(edge.to);
                        }
                    }
                }
            }
        }
        ahead
    }

    fn grow_after(&mut self, draft: &MissionDraft) -> bool {
        let mut has_grown = false;
        for (frame, production) in productions(draft) {
            let fallen = self.fallen(draft, frame, production);
            let own = self.frames[frame];
            let mut left = own.succeeded;
            let symbol = Symbol::PlanFrame(frame as u16);
            let is_checked = |description: Description| !description.goal.is_empty();
            if described(draft, symbol).is_some_and(is_checked) {
                left |= own.failed;
            }
            // What ends the frame ends everything in it, and a violated interval the production.
            let mut ended = own.ended;
            if may_fail(draft, symbol) {
                ended |= own.failed;
            }
            if !draft.frames[frame].until.is_empty() {
                ended |= left;
            }
            let production = &draft.productions[production];
            if production.intervals > 0 {
                ended |= fallen;
            }
            for (at, edge) in (usize::from(production.first_edge)..).zip(draft.edges_of(production))
            {
                let ahead = self.ahead(draft, production, edge.to);
                let mut succeeded = ahead.steps;
                if ahead.reaches_exit {
                    succeeded |= left;
                }
                if ahead.may_fail {
                    succeeded |= fallen;
                }
                match edge.symbol {
                    Symbol::Action(_) => {
                        let may_fail = may_fail(draft, edge.symbol);
                        let failed = if may_fail { fallen | ended } else { ended };
                        has_grown |= self.after_success[at].grow(succeeded)
                            | self.after_failure[at].grow(failed);
                    }
                    Symbol::PlanFrame(index) => {
                        let below = &mut self.frames[usize::from(index)];
                        has_grown |= below.succeeded.grow(succeeded)
                            | below.failed.grow(fallen)
                            | below.ended.grow(ended);
                    }
                }
            }
        }
        has_grown
    }

    /// What can run after a component of a production has failed.
    fn fallen(&self, draft: &MissionDraft, frame: usize, production: usize) -> Steps {
        // After a plan was interrupted, its frame may begin anew with the same production.
        let is_open = |other: usize| other != production || draft.behaviours.len() > 1;
        let others = productions(draft).filter(|&(of, other)| of == frame && is_open(other));
        let own = self.frames[frame];
        others.fold(own.failed, |steps, (_, other)| {
            let ahead = self.ahead(draft, &draft.productions[other], 0);
            let passed = if ahead.reaches_exit { own.succeeded } else { Steps::default() };
            steps | ahead.steps | passed
        })
    }
}

pub(super) fn described(draft: &MissionDraft, symbol: Symbol) -> Option<Description> {
    let index = match symbol {
        Symbol::Action(index) => draft.actions.get(usize::from(index))?.description,
        Symbol::PlanFrame(index) => draft.frames.get(usize::from(index))?.description,
    };
    draft.descriptions.get(usize::from(index)).copied()
}

/// Whether a component may fail by itself after an action of it has begun.
fn may_fail(draft: &MissionDraft, symbol: Symbol) -> bool {
    let is_bound = described(draft, symbol).is_some_and(|description| {
        !description.transient.is_empty() || !description.goal.is_empty()
    });
    let may_time_out = match symbol {
        Symbol::PlanFrame(index) => draft.frames[usize::from(index)].timeout_ms != 0,
        Symbol::Action(index) => {
            let action = &draft.actions[usize::from(index)];
            // Beside another behaviour an end may be put off.
            draft.behaviours.len() > 1
                || match action.kind {
                    ActionKind::Hold { for_ms }
                    | ActionKind::Wander { for_ms }
                    | ActionKind::MoveAhead { for_ms, .. } => action.timeout_ms <= for_ms,
                    ActionKind::Signal { .. } | ActionKind::SetOutput { .. } => {
                        !action.until.is_empty()
                    }
                    ActionKind::Follow { .. }
                    | ActionKind::GoTo { .. }
                    | ActionKind::Return
                    | ActionKind::Dock { .. } => true,
                }
        }
    };
    is_bound || may_time_out
}

/// Whether a frame is a loop that ends when a round finds nothing applicable.
fn may_end_loop(draft: &MissionDraft, frame: usize) -> bool {
    let mut own = productions(draft).filter(|&(of, _)| of == frame);
    own.all(|(_, production)| draft.productions[production].rules.is_some())
        && effects::all_below(draft, frame).contains(&Symbol::PlanFrame(frame as u16))
}

/// Each frame with each of its productions.
fn productions(draft: &MissionDraft) -> impl Iterator<Item = (usize, usize)> + '_ {
    draft.frames.iter().enumerate().flat_map(|(index, frame)| {
        let first = usize::from(frame.first);
        (first..first + usize::from(frame.count)).map(move |production| (index, production))
    })
}

/// By edge: the codes that the robot may signal while its component runs, beside it.
pub(super) fn signals_beside(draft: &MissionDraft) -> Vec<Vec<u16>> {
    let mut beside = vec![Vec::new(); draft.edges.len()];
    let mut add = |below: Vec<usize>, other: Vec<usize>| {
        let codes: Vec<u16> = other.iter().filter_map(|&step| signal(draft, step)).collect();
        for step in below {
            let known: &mut Vec<u16> = &mut beside[step];
            known.extend(&codes);
            known.sort_unstable();
            known.dedup();
        }
    };
    for production in &draft.productions {
        let edges = draft.edges_of(production);
        let at = |index: usize| usize::from(production.first_edge) + index;
        for (index, edge) in edges.iter().enumerate() {
            for (other_index, other) in edges.iter().enumerate() {
                let is_aside = !is_before(edges, edge, other) && !is_before(edges, other, edge);
                if index != other_index && is_aside {
                    add(edges_below(draft, at(index)), edges_below(draft, at(other_index)));
                }
            }
        }
    }
    for (index, behaviour) in draft.behaviours.iter().enumerate() {
        for (other_index, other) in draft.behaviours.iter().enumerate() {
            if index != other_index {
                let below = |behaviour: &Behaviour| {
                    behaviour
                        .plan_frames()
                        .flat_map(|frame| edges_of_frame(draft, frame.into()))
                        .collect()
                };
                add(below(behaviour), below(other));
            }
        }
    }
    beside
}

/// By edge: the code that the robot signals as its component begins, if it is one only: that of an
/// action beside it which begins with it and needs nothing.
pub(super) fn signals_with(draft: &MissionDraft) -> Vec<Option<u16>> {
    let mut with = vec![None; draft.edges.len()];
    for production in &draft.productions {
        let edges = draft.edges_of(production);
        for (index, edge) in edges.iter().enumerate() {
            let beside = edges
                .iter()
                .enumerate()
                .filter(|&(other_index, other)| other_index != index && other.from == edge.from);
            let codes: Vec<u16> =
                beside.filter_map(|(_, other)| free_signal(draft, other.symbol)).collect();
            if let [code] = codes[..] {
                with[usize::from(production.first_edge) + index] = Some(code);
            }
        }
    }
    with
}

/// The code of a signal that neither needs anything nor changes what another behaviour may protect.
fn free_signal(draft: &MissionDraft, symbol: Symbol) -> Option<u16> {
    let Symbol::Action(action) = symbol else { return None };
    let description = described(draft, symbol)?;
    let is_free = description.initial.is_empty()
        && description.goal.is_empty()
        && description.add | description.delete == 0;
    signal_of(draft, action).filter(|_| is_free)
}

/// The code that a step signals.
pub(super) fn signal(draft: &MissionDraft, step: usize) -> Option<u16> {
    match draft.edges.get(step)?.symbol {
        Symbol::Action(action) => signal_of(draft, action),
        Symbol::PlanFrame(_) => None,
    }
}

pub(super) fn signal_of(draft: &MissionDraft, action: u16) -> Option<u16> {
    match draft.actions.get(usize::from(action))?.kind {
        ActionKind::Signal { code } => Some(code),
        _ => None,
    }
}

/// Whether one edge can begin only after another has ended.
fn is_before(edges: &[Edge], edge: &Edge, other: &Edge) -> bool {
    let (mut reached, mut next) = (vec![edge.to], 0);
    while let Some(&vertex) = reached.get(next) {
        next += 1;
        if vertex == other.from {
            return true;
        }
        let leaving = edges.iter().filter(|edge| edge.from == vertex).map(|edge| edge.to);
        let new: Vec<u8> = leaving.filter(|to| !reached.contains(to)).collect();
        reached.extend(new);
    }
    false
}

/// The edges of a component: its own, and all below it.
fn edges_below(draft: &MissionDraft, edge: usize) -> Vec<usize> {
    let below = match draft.edges[edge].symbol {
        Symbol::Action(_) => Vec::new(),
        Symbol::PlanFrame(frame) => edges_of_frame(draft, frame.into()),
    };
    iter::once(edge).chain(below).collect()
}

/// The edges of a frame, and of all frames below it.
fn edges_of_frame(draft: &MissionDraft, frame: usize) -> Vec<usize> {
    let below = effects::all_below(draft, frame).into_iter().filter_map(|symbol| match symbol {
        Symbol::Action(_) => None,
        Symbol::PlanFrame(index) => Some(usize::from(index)),
    });
    let frames: Vec<usize> = iter::once(frame).chain(below).collect();
    let own = productions(draft).filter(|(frame, _)| frames.contains(frame));
    own.flat_map(|(_, production)| {
        let production = &draft.productions[production];
        let first = usize::from(production.first_edge);
        first..first + usize::from(production.edges)
    })
    .collect()
}
