//! The pool of components, and the operations on the plans in it.

use parts::bits::{Slots, bit16};
use parts::{Component, Event, Id, Life, OWNERS, Owner, Pool, ProductionIndex};
use plan_format::limits::{MAX_COMPONENTS, MAX_DEPTH};
use plan_format::mission::{Description, Mission, PlanFrame, Production, Symbol};

/// Hears each change, after it: the pool as it is then, and the change.
pub type Tell<'t> = dyn FnMut(&Pool, &Event) + 't;

/// The state of a component that only this crate needs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Growth {
    /// Productions that it has tried since it was planned, one bit each.
    tried: u16,
    /// Whether tail recursion has restarted it.
    has_restarted: bool,
    /// Its life-cycle state before it was suspended.
    life_before: Life,
}

impl Growth {
    const NONE: Self = Self { tried: 0, has_restarted: false, life_before: Life::Planned };
}

/// The result of decomposing a plan frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// This production replaced it: index in the mission.
    Production(u16),
    /// No production reached the threshold, and the frame has restarted: the loop is over.
    LoopEnded,
    /// No production that is still untried reached the threshold.
    NothingApplicable,
    /// The pool has too few free slots for the production's components.
    NoRoom,
    /// The components would exceed [`MAX_DEPTH`].
    TooDeep,
    /// The component is not a scheduled plan frame.
    NotScheduled,
}

/// The effect of a component's end on its plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The plan continues.
    GoesOn,
    /// This frame waits for no further component.
    Completes(Id),
    /// This frame will choose again.
    FallsBack(Id),
    /// The root is finished; the plan is gone.
    RootFinished,
    /// The root has failed; the plan is gone.
    RootFailed,
}

/// The live plans of all behaviours.
#[derive(Clone, Debug, PartialEq)]
pub struct Forest {
    pool: Pool,
    /// By slot; of a free slot, what its last component had.
    growths: [Growth; MAX_COMPONENTS],
    /// Slots of scheduled components. These sets spare the tick many searches.
    scheduled: Slots,
    /// Slots of actions that run.
    running: Slots,
}

impl Default for Forest {
    fn default() -> Self {
        let growths = [Growth::NONE; MAX_COMPONENTS];
        Self { pool: Pool::default(), growths, scheduled: Slots::NONE, running: Slots::NONE }
    }
}

impl Forest {
    /// Plants a plan with one component, its root frame; `None` if the pool is full, or the owner is
    /// not below [`OWNERS`].
    pub fn plant(&mut self, owner: Owner, root: u16, tell: &mut Tell<'_>) -> Option<Id> {
        let id = self.pool.free_slot().filter(|_| usize::from(owner) < OWNERS)?;
        let component = Component {
            symbol: Symbol::PlanFrame(root),
            owner,
            parent: None,
            edge: 0,
            from: 0,
            to: 0,
            life: Life::Planned,
            depth: 0,
            production: None,
            finished: 0,
        };
        self.change(Event::Planned { id, component }, tell);
        self.set_life(id, Life::Scheduled, tell);
        Some(id)
    }

    /// The store of the plans.
    pub fn pool(&self) -> &Pool {
        &self.pool
    }

    /// A component.
    pub fn get(&self, id: Id) -> Option<&Component> {
        self.pool.get(id)
    }

    /// All components, in the order of their slots.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &Component)> {
        self.pool.iter()
    }

    /// Number of components.
    pub fn len(&self) -> usize {
        self.pool.len()
    }

    /// Whether there is no plan.
    pub fn is_empty(&self) -> bool {
        self.pool.is_empty()
    }

    /// Whether a frame has not been decomposed since it was planned or began anew.
    pub fn is_new(&self, id: Id) -> bool {
        self.growth(id).is_some_and(|growth| growth.tried == 0 && !growth.has_restarted)
    }

    /// The root of an owner's plan.
    pub fn root(&self, owner: Owner) -> Option<Id> {
        let is_root = |id: &Id| self.get(*id).is_some_and(|component| component.parent.is_none());
        self.pool.owned(owner).iter().find(is_root)
    }

    /// The next scheduled component of an owner's plan, a frame or an action.
    pub fn scheduled(&self, owner: Owner) -> Option<Id> {
        (self.scheduled & self.pool.owned(owner)).iter().next()
    }

    /// The slots of all atomic actions that run, in order.
    pub fn running(&self) -> impl Iterator<Item = Id> + use<> {
        self.running.iter()
    }

    /// The slots of the actions of an owner's plan that run, in order.
    pub fn running_of(&self, owner: Owner) -> impl Iterator<Item = Id> + use<> {
        (self.running & self.pool.owned(owner)).iter()
    }

    /// Starts a scheduled atomic action.
    pub fn start(&mut self, id: Id, tell: &mut Tell<'_>) {
        let is_action =
            self.get(id).is_some_and(|component| matches!(component.symbol, Symbol::Action(_)));
        if is_action {
            self.set_life(id, Life::Started, tell);
        }
    }

    /// Decomposes a scheduled frame. `applicability` rates a production, given its index and
    /// record, 0 ..= 1. The edges of the best one enter the plan, and those that leave the entry
    /// are scheduled. If no production is chosen, the frame stays scheduled and the caller decides
    /// (see [`Forest::finish`], [`Forest::fail`]). Also returns the frame's slot, which tail
    /// recursion may have changed.
    pub fn decompose(
        &mut self,
        mission: &Mission<'_>,
        id: Id,
        applicability: &mut dyn FnMut(u16, &Production) -> f32,
        tell: &mut Tell<'_>,
    ) -> (Id, Choice) {
        let Some(frame) = self.waiting_frame(mission, id) else {
            return (id, Choice::NotScheduled);
        };
        let id = self.restart(mission, id, tell);
        let (Some(&component), Some(&Growth { tried, has_restarted, .. })) =
            (self.get(id), self.growth(id))
        else {
            return (id, Choice::NotScheduled);
        };
        let Some((number, production)) = choose(mission, &frame, tried, applicability) else {
            let is_over = has_restarted && tried == 0;
            return (id, if is_over { Choice::LoopEnded } else { Choice::NothingApplicable });
        };
        if usize::from(component.depth) + 1 >= MAX_DEPTH {
            return (id, Choice::TooDeep);
        }
        if MAX_COMPONENTS - self.len() < usize::from(production.edges) {
            return (id, Choice::NoRoom);
        }
        let chosen = frame.first.saturating_add(u16::from(number));
        if let Some(growth) = self.growth_mut(id) {
            growth.tried |= bit16(number);
        }
        self.set_life(id, Life::Started, tell);
        // An index of a production fits: see its type.
        let production_index = chosen as ProductionIndex;
        self.change(Event::Decomposed { id, production: production_index }, tell);
        let edges = mission.edges_of(&production);
        for (number, edge) in (0..).zip(edges) {
            let Some(slot) = self.pool.free_slot() else { break };
            let part = Component {
                symbol: edge.symbol,
                owner: component.owner,
                parent: Some(id),
                edge: number,
                from: edge.from,
                to: edge.to,
                life: Life::Planned,
                depth: component.depth.saturating_add(1),
                production: None,
                finished: 0,
            };
            self.change(Event::Planned { id: slot, component: part }, tell);
        }
        self.schedule_at(id, 0, tell);
        (id, Choice::Production(chosen))
    }

    /// Finishes a component, which leaves the plan. Components that waited only for it are
    /// scheduled; if its parent waits for nothing else, the caller has to finish the parent next.
    pub fn finish(&mut self, mission: &Mission<'_>, id: Id, tell: &mut Tell<'_>) -> Ended {
        let Some(component) = self.get(id).copied() else { return Ended::GoesOn };
        self.abandon_below(id, tell);
        self.set_life(id, Life::Finished, tell);
        self.delete(id, tell);
        let Some(parent) = component.parent else { return Ended::RootFinished };
        let Some(production) = self.production_of(mission, parent) else { return Ended::GoesOn };
        if self.get(parent).is_some_and(|frame| frame.finished == all_edges(&production)) {
            return Ended::Completes(parent);
        }
        self.schedule_at(parent, component.to, tell);
        Ended::GoesOn
    }

    /// The parent, if it waits only for this component and would be finished with it.
    pub fn completes(&self, mission: &Mission<'_>, id: Id) -> Option<Id> {
        let component = self.get(id)?;
        let parent = component.parent?;
        let production = self.production_of(mission, parent)?;
        let all = all_edges(&production);
        let finished = self.get(parent)?.finished | bit16(component.edge);
        (finished & all == all).then_some(parent)
    }

    /// Fails a component. Its parent's production is given up, and the parent chooses again; if a
    /// root fails, its plan is gone.
    pub fn fail(&mut self, id: Id, tell: &mut Tell<'_>) -> Ended {
        let Some(component) = self.get(id).copied() else { return Ended::GoesOn };
        self.abandon_below(id, tell);
        self.set_life(id, Life::Failed, tell);
        self.delete(id, tell);
        let Some(parent) = component.parent else { return Ended::RootFailed };
        self.fall_back(parent, tell);
        Ended::FallsBack(parent)
    }

    /// Abandons everything below a frame, which will choose again among its untried productions.
    pub fn fall_back(&mut self, frame: Id, tell: &mut Tell<'_>) {
        self.abandon_below(frame, tell);
        self.set_life(frame, Life::Scheduled, tell);
    }

    /// As [`Forest::fall_back`], but every production may be tried again: for a frame whose choice
    /// was right until the world changed.
    pub fn begin_anew(&mut self, frame: Id, tell: &mut Tell<'_>) {
        self.fall_back(frame, tell);
        if let Some(growth) = self.growth_mut(frame) {
            growth.tried = 0;
        }
    }

    /// Suspends an owner's plan in its present state.
    pub fn suspend(&mut self, owner: Owner, tell: &mut Tell<'_>) {
        for id in self.pool.owned(owner).iter() {
            let life = self.get(id).map(|component| component.life);
            let Some(life @ (Life::Scheduled | Life::Started)) = life else { continue };
            if let Some(growth) = self.growth_mut(id) {
                growth.life_before = life;
            }
            self.set_life(id, Life::Suspended, tell);
        }
    }

    /// Resumes an owner's plan in the state that [`Forest::suspend`] left. Frames continue; an
    /// interrupted action is scheduled, so that its initial description is checked again.
    pub fn resume(&mut self, owner: Owner, tell: &mut Tell<'_>) {
        for id in self.pool.owned(owner).iter() {
            let (Some(component), Some(growth)) = (self.get(id), self.growth(id)) else {
                continue;
            };
            if component.life == Life::Suspended {
                let is_action = matches!(component.symbol, Symbol::Action(_));
                let life = if is_action { Life::Scheduled } else { growth.life_before };
                self.set_life(id, life, tell);
            }
        }
    }

    /// Abandons an owner's whole plan.
    pub fn uproot(&mut self, owner: Owner, tell: &mut Tell<'_>) {
        for id in self.pool.owned(owner).iter() {
            self.set_life(id, Life::Abandoned, tell);
            self.delete(id, tell);
        }
    }

    /// The production that replaced a frame.
    pub fn production_of(&self, mission: &Mission<'_>, frame: Id) -> Option<Production> {
        mission.productions().get(usize::from(self.get(frame)?.production?))
    }

    fn waiting_frame(&self, mission: &Mission<'_>, id: Id) -> Option<PlanFrame> {
        let component = self.get(id).filter(|component| component.life == Life::Scheduled)?;
        let Symbol::PlanFrame(index) = component.symbol else { return None };
        mission.plan_frames().get(usize::from(index))
    }

    /// Tail recursion: if a frame is the last component that an equal frame above it waits for, it is
    /// a further round of that loop. The upper frame restarts in its place, unless this would lose
    /// what a frame in between checks. Returns the slot of the frame to decompose.
    fn restart(&mut self, mission: &Mission<'_>, id: Id, tell: &mut Tell<'_>) -> Id {
        let Some(head) = self.loop_head(mission, id) else { return id };
        let next = if self.may_replace(mission, head, id) { head } else { id };
        if let Some(growth) = self.growth_mut(next) {
            growth.has_restarted = true;
        }
        if next == head {
            self.abandon_below(head, tell);
            if let Some(growth) = self.growth_mut(head) {
                growth.tried = 0;
            }
            self.change(Event::Restarted { id: head }, tell);
            self.set_life(head, Life::Scheduled, tell);
        }
        next
    }

    /// The nearest frame above with the same symbol, if no frame on the path to it waits for
    /// another component or has a protection interval that spans the edge below it.
    fn loop_head(&self, mission: &Mission<'_>, id: Id) -> Option<Id> {
        let symbol = self.get(id)?.symbol;
        let mut below = id;
        for _ in 0..MAX_DEPTH {
            let above = self.completes(mission, below)?;
            if self.is_spanned(mission, above, self.get(below)?) {
                return None;
            }
            if self.get(above)?.symbol == symbol {
                return Some(above);
            }
            below = above;
        }
        None
    }

    /// Whether a frame may restart in place of an equal one below: each frame in between is silent,
    /// or there is an equal frame above both, which checks the same and has the same effects.
    fn may_replace(&self, mission: &Mission<'_>, head: Id, id: Id) -> bool {
        let mut between = self.pool.above(id).take_while(|&(above, _)| above != head);
        between.all(|(_, frame)| {
            self.is_silent(mission, frame.symbol)
                || self.pool.above(head).any(|(_, above)| above.symbol == frame.symbol)
        })
    }

    /// Whether a frame has nothing to check while it runs or when it ends, and no effects.
    fn is_silent(&self, mission: &Mission<'_>, symbol: Symbol) -> bool {
        let Symbol::PlanFrame(index) = symbol else { return false };
        let frame = mission.plan_frames().get(usize::from(index));
        frame.is_some_and(|frame| frame.until.is_empty() && frame.timeout_ms == 0)
            && mission.description(symbol).is_some_and(is_silent)
    }

    /// Whether a protection interval of the frame's production spans one of its edges.
    fn is_spanned(&self, mission: &Mission<'_>, frame: Id, edge: &Component) -> bool {
        let Some(production) = self.production_of(mission, frame) else { return false };
        mission
            .intervals_of(&production)
            .any(|interval| interval.from <= edge.from && interval.to >= edge.to)
    }

    /// Schedules the parts of a frame that leave a vertex, if no part still leads to the vertex.
    fn schedule_at(&mut self, frame: Id, vertex: u8, tell: &mut Tell<'_>) {
        let mut due = Slots::NONE;
        for id in self.pool.parts(frame) {
            let Some(part) = self.get(id) else { continue };
            if part.to == vertex {
                return;
            }
            if part.from == vertex {
                due.insert(id);
            }
        }
        for id in due.iter() {
            self.set_life(id, Life::Scheduled, tell);
        }
    }

    fn abandon_below(&mut self, frame: Id, tell: &mut Tell<'_>) {
        // Only a decomposed frame has anything below it.
        let Some(&Component { owner, production: Some(_), .. }) = self.get(frame) else { return };
        let mut doomed = Slots::NONE;
        for id in self.pool.owned(owner).iter() {
            if self.pool.above(id).any(|(above, _)| above == frame) {
                doomed.insert(id);
            }
        }
        for id in doomed.iter() {
            self.set_life(id, Life::Abandoned, tell);
            self.delete(id, tell);
        }
    }

    fn growth(&self, id: Id) -> Option<&Growth> {
        self.growths.get(usize::from(id))
    }

    fn growth_mut(&mut self, id: Id) -> Option<&mut Growth> {
        self.growths.get_mut(usize::from(id))
    }

    /// Changes the pool, and tells it.
    fn change(&mut self, event: Event, tell: &mut Tell<'_>) {
        self.pool.apply(&event);
        tell(&self.pool, &event);
    }

    fn set_life(&mut self, id: Id, life: Life, tell: &mut Tell<'_>) {
        let Some(component) = self.get(id).filter(|component| component.life.may_become(life))
        else {
            return;
        };
        let is_action = matches!(component.symbol, Symbol::Action(_));
        self.scheduled.remove(id);
        self.running.remove(id);
        match life {
            Life::Scheduled => self.scheduled.insert(id),
            Life::Started if is_action => self.running.insert(id),
            _ => {}
        }
        self.change(Event::Became { id, life }, tell);
    }

    fn delete(&mut self, id: Id, tell: &mut Tell<'_>) {
        if let Some(growth) = self.growth_mut(id) {
            *growth = Growth::NONE;
        }
        self.scheduled.remove(id);
        self.running.remove(id);
        self.change(Event::Deleted { id }, tell);
    }
}

/// The most applicable untried production, with its number within the frame.
fn choose(
    mission: &Mission<'_>,
    frame: &PlanFrame,
    tried: u16,
    applicability: &mut dyn FnMut(u16, &Production) -> f32,
) -> Option<(u8, Production)> {
    let mut best: Option<(f32, u8, Production)> = None;
    let all = mission.productions_of(frame);
    for (number, production) in (0_u8..).zip(all) {
        if tried & bit16(number) != 0 {
            continue;
        }
        let value = applicability(frame.first.saturating_add(u16::from(number)), &production);
        if value >= frame.threshold && best.is_none_or(|(highest, ..)| value > highest) {
            best = Some((value, number, production));
        }
    }
    best.map(|(_, number, production)| (number, production))
}

/// Whether a description has nothing to check while its component runs or when it ends, and no
/// effects.
fn is_silent(description: Description) -> bool {
    description.transient.is_empty()
        && description.goal.is_empty()
        && description.add == 0
        && description.delete == 0
        && description.max_speed_mps.is_infinite()
        && description.min_distance_m <= 0.0
}

fn all_edges(production: &Production) -> u16 {
    match production.edges {
        edges @ 0..16 => (1 << edges) - 1,
        _ => u16::MAX,
    }
}
