//! The pool of components, and the operations on the plans in it.

use parts::bits::{bit, bit16, members};
use parts::{Component, Event, Id, Life, Owner};
use plan_format::limits::{MAX_COMPONENTS, MAX_DEPTH};
use plan_format::mission::{Description, Mission, PlanFrame, Production, Symbol};

/// A component, and the state that only this crate needs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slot {
    component: Component,
    /// Productions that it has tried since it was planned, one bit each.
    tried: u16,
    /// Edges of its production that are finished, one bit each.
    finished: u16,
    /// Slots of its parts, one bit each.
    parts: u32,
    /// Whether tail recursion has restarted it.
    has_restarted: bool,
    /// Its life-cycle state before it was suspended.
    life_before: Life,
}

impl From<Component> for Slot {
    fn from(component: Component) -> Self {
        Self {
            component,
            tried: 0,
            finished: 0,
            parts: 0,
            has_restarted: false,
            life_before: Life::Planned,
        }
    }
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
    slots: [Option<Slot>; MAX_COMPONENTS],
    /// Slots in use, one bit each. These sets spare the tick many searches.
    taken: u32,
    /// Slots of scheduled components, one bit each.
    scheduled: u32,
    /// Slots of actions that run, one bit each.
    running: u32,
}

impl Default for Forest {
    fn default() -> Self {
        Self { slots: [None; MAX_COMPONENTS], taken: 0, scheduled: 0, running: 0 }
    }
}

impl Forest {
    /// Plants a plan with one component, its root frame; `None` if the pool is full.
    pub fn plant(&mut self, owner: Owner, root: u16, tell: &mut dyn FnMut(Event)) -> Option<Id> {
        let id = self.free_slot()?;
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
        };
        self.add(id, component, tell);
        self.set_life(id, Life::Scheduled, tell);
        Some(id)
    }

    /// A component.
    pub fn get(&self, id: Id) -> Option<&Component> {
        Some(&self.slot(id)?.component)
    }

    /// All components, in the order of their slots.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &Component)> {
        self.ids().filter_map(|id| Some((id, self.get(id)?)))
    }

    /// The slots in use, in order; later changes to the pool do not affect the iterator.
    pub fn ids(&self) -> impl Iterator<Item = Id> + use<> {
        members(self.taken)
    }

    /// Number of components.
    pub fn len(&self) -> usize {
        self.taken.count_ones() as usize
    }

    /// Whether the pool has no component.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether a frame has not been decomposed since it was planned or began anew.
    pub fn is_new(&self, id: Id) -> bool {
        self.slot(id).is_some_and(|slot| slot.tried == 0 && !slot.has_restarted)
    }

    /// The root of an owner's plan.
    pub fn root(&self, owner: Owner) -> Option<Id> {
        let mut all = self.iter();
        all.find(|(_, component)| component.owner == owner && component.parent.is_none())
            .map(|(id, _)| id)
    }

    /// The next scheduled component of an owner's plan, a frame or an action.
    pub fn scheduled(&self, owner: Owner) -> Option<Id> {
        members(self.scheduled).find(|&id| self.get(id).is_some_and(|part| part.owner == owner))
    }

    /// The slots of all atomic actions that run, in order.
    pub fn running(&self) -> impl Iterator<Item = Id> + use<> {
        members(self.running)
    }

    /// Starts a scheduled atomic action.
    pub fn start(&mut self, id: Id, tell: &mut dyn FnMut(Event)) {
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
        tell: &mut dyn FnMut(Event),
    ) -> (Id, Choice) {
        let Some(frame) = self.waiting_frame(mission, id) else {
            return (id, Choice::NotScheduled);
        };
        let id = self.restart(mission, id, tell);
        let Some(slot) = self.slot(id) else { return (id, Choice::NotScheduled) };
        let (component, tried, has_restarted) = (slot.component, slot.tried, slot.has_restarted);
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
        if let Some(slot) = self.slot_mut(id) {
            slot.component.production = Some(chosen);
            slot.tried |= bit16(number);
            slot.finished = 0;
        }
        self.set_life(id, Life::Started, tell);
        tell(Event::Decomposed { id, production: chosen });
        let edges = mission.edges_of(&production);
        for (number, edge) in (0..).zip(edges) {
            let Some(slot) = self.free_slot() else { break };
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
            };
            self.add(slot, part, tell);
        }
        self.schedule_at(id, 0, tell);
        (id, Choice::Production(chosen))
    }

    /// Finishes a component, which leaves the plan. Components that waited only for it are
    /// scheduled; if its parent waits for nothing else, the caller has to finish the parent next.
    pub fn finish(&mut self, mission: &Mission<'_>, id: Id, tell: &mut dyn FnMut(Event)) -> Ended {
        let Some(component) = self.get(id).copied() else { return Ended::GoesOn };
        self.abandon_below(id, tell);
        self.set_life(id, Life::Finished, tell);
        self.delete(id, tell);
        let Some(parent) = component.parent else { return Ended::RootFinished };
        let Some(production) = self.finish_edge(mission, parent, component.edge) else {
            return Ended::GoesOn;
        };
        if self.slot(parent).is_some_and(|frame| frame.finished == all_edges(&production)) {
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
        let finished = self.slot(parent)?.finished | bit16(component.edge);
        (finished & all == all).then_some(parent)
    }

    /// Fails a component. Its parent's production is given up, and the parent chooses again; if a
    /// root fails, its plan is gone.
    pub fn fail(&mut self, id: Id, tell: &mut dyn FnMut(Event)) -> Ended {
        let Some(component) = self.get(id).copied() else { return Ended::GoesOn };
        self.abandon_below(id, tell);
        self.set_life(id, Life::Failed, tell);
        self.delete(id, tell);
        let Some(parent) = component.parent else { return Ended::RootFailed };
        self.fall_back(parent, tell);
        Ended::FallsBack(parent)
    }

    /// Abandons everything below a frame, which will choose again among its untried productions.
    pub fn fall_back(&mut self, frame: Id, tell: &mut dyn FnMut(Event)) {
        self.abandon_below(frame, tell);
        if let Some(slot) = self.slot_mut(frame) {
            slot.component.production = None;
            slot.finished = 0;
        }
        self.set_life(frame, Life::Scheduled, tell);
    }

    /// As [`Forest::fall_back`], but every production may be tried again: for a frame whose choice
    /// was right until the world changed.
    pub fn begin_anew(&mut self, frame: Id, tell: &mut dyn FnMut(Event)) {
        self.fall_back(frame, tell);
        if let Some(slot) = self.slot_mut(frame) {
            slot.tried = 0;
        }
    }

    /// Suspends an owner's plan in its present state.
    pub fn suspend(&mut self, owner: Owner, tell: &mut dyn FnMut(Event)) {
        for id in self.ids() {
            let Some(slot) = self.slot_mut(id).filter(|slot| slot.component.owner == owner) else {
                continue;
            };
            if matches!(slot.component.life, Life::Scheduled | Life::Started) {
                slot.life_before = slot.component.life;
                self.set_life(id, Life::Suspended, tell);
            }
        }
    }

    /// Resumes an owner's plan in the state that [`Forest::suspend`] left. Frames continue; an
    /// interrupted action is scheduled, so that its initial description is checked again.
    pub fn resume(&mut self, owner: Owner, tell: &mut dyn FnMut(Event)) {
        for id in self.ids() {
            let Some(slot) = self.slot(id).filter(|slot| slot.component.owner == owner) else {
                continue;
            };
            if slot.component.life == Life::Suspended {
                let is_action = matches!(slot.component.symbol, Symbol::Action(_));
                let life = if is_action { Life::Scheduled } else { slot.life_before };
                self.set_life(id, life, tell);
            }
        }
    }

    /// Abandons an owner's whole plan.
    pub fn uproot(&mut self, owner: Owner, tell: &mut dyn FnMut(Event)) {
        for id in self.ids() {
            if self.get(id).is_some_and(|component| component.owner == owner) {
                self.set_life(id, Life::Abandoned, tell);
                self.delete(id, tell);
            }
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

    /// Tail recursion: if a frame is the last component that an equal frame above it waits for, the
    /// upper frame restarts in its place. Returns the slot of the frame to decompose.
    fn restart(&mut self, mission: &Mission<'_>, id: Id, tell: &mut dyn FnMut(Event)) -> Id {
        let Some(head) = self.loop_head(mission, id) else { return id };
        self.abandon_below(head, tell);
        let Some(slot) = self.slot_mut(head) else { return id };
        slot.component.production = None;
        slot.tried = 0;
        slot.finished = 0;
        slot.has_restarted = true;
        tell(Event::Restarted { id: head });
        self.set_life(head, Life::Scheduled, tell);
        head
    }

    /// The nearest frame above with the same symbol, if no frame on the path to it waits for
    /// another component, and none in between has a description to check, effects, or a protection
    /// interval that spans the edge below it.
    fn loop_head(&self, mission: &Mission<'_>, id: Id) -> Option<Id> {
        let symbol = self.get(id)?.symbol;
        let mut below = id;
        for _ in 0..MAX_DEPTH {
            let above = self.completes(mission, below)?;
            if self.is_spanned(mission, above, self.get(below)?) {
                return None;
            }
            let above_symbol = self.get(above)?.symbol;
            if above_symbol == symbol {
                return Some(above);
            }
            if !self.is_silent(mission, above_symbol) {
                return None;
            }
            below = above;
        }
        None
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

    fn finish_edge(&mut self, mission: &Mission<'_>, frame: Id, edge: u8) -> Option<Production> {
        let production = self.production_of(mission, frame)?;
        self.slot_mut(frame)?.finished |= bit16(edge);
        Some(production)
    }

    /// Schedules the parts of a frame that leave a vertex, if no part still leads to the vertex.
    fn schedule_at(&mut self, frame: Id, vertex: u8, tell: &mut dyn FnMut(Event)) {
        let parts = self.slot(frame).map_or(0, |slot| slot.parts);
        if members(parts).any(|id| self.get(id).is_some_and(|part| part.to == vertex)) {
            return;
        }
        for id in members(parts) {
            if self.get(id).is_some_and(|part| part.from == vertex) {
                self.set_life(id, Life::Scheduled, tell);
            }
        }
    }

    fn abandon_below(&mut self, frame: Id, tell: &mut dyn FnMut(Event)) {
        let parts_of = |set| {
            let parts = members(set).filter_map(|id: Id| Some(self.slot(id)?.parts));
            parts.fold(0, |all, parts| all | parts)
        };
        let mut level = self.slot(frame).map_or(0, |slot| slot.parts);
        let mut doomed = level;
        // No tree is deeper than this.
        for _ in 0..MAX_DEPTH {
            if level == 0 {
                break;
            }
            level = parts_of(level);
            doomed |= level;
        }
        for id in members(doomed) {
            self.set_life(id, Life::Abandoned, tell);
            self.delete(id, tell);
        }
    }

    fn slot(&self, id: Id) -> Option<&Slot> {
        self.slots.get(usize::from(id))?.as_ref()
    }

    fn slot_mut(&mut self, id: Id) -> Option<&mut Slot> {
        self.slots.get_mut(usize::from(id))?.as_mut()
    }

    fn free_slot(&self) -> Option<Id> {
        let id = self.taken.trailing_ones();
        ((id as usize) < MAX_COMPONENTS).then_some(id as Id)
    }

    fn add(&mut self, id: Id, component: Component, tell: &mut dyn FnMut(Event)) {
        if let Some(slot) = self.slots.get_mut(usize::from(id)) {
            *slot = Some(component.into());
            if let Some(frame) = component.parent.and_then(|parent| self.slot_mut(parent)) {
                frame.parts |= bit(id);
            }
            self.taken |= bit(id);
            tell(Event::Planned { id, component });
        }
    }

    fn set_life(&mut self, id: Id, life: Life, tell: &mut dyn FnMut(Event)) {
        if let Some(Slot { component, .. }) = self.slot_mut(id)
            && component.life.may_become(life)
        {
            component.life = life;
            let is_running = component.is_running();
            let slot = bit(id);
            self.scheduled &= !slot;
            self.running &= !slot;
            if life == Life::Scheduled {
                self.scheduled |= slot;
            } else if is_running {
                self.running |= slot;
            }
            tell(Event::Became { id, life });
        }
    }

    fn delete(&mut self, id: Id, tell: &mut dyn FnMut(Event)) {
        if let Some(slot) = self.slots.get_mut(usize::from(id)).and_then(Option::take) {
            let others = !(bit(id));
            if let Some(frame) = slot.component.parent.and_then(|parent| self.slot_mut(parent)) {
                frame.parts &= others;
            }
            self.taken &= others;
            self.scheduled &= others;
            self.running &= others;
            tell(Event::Deleted { id });
        }
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
