//! The pool of components and what can be done with it.

use parts::bits::{bit, bit16, members};
use parts::{Component, Event, Id, Life, Owner};
use plan_format::limits::{MAX_COMPONENTS, MAX_DEPTH};
use plan_format::mission::{Description, Mission, PlanFrame, Production, Symbol};

/// A component, and what only its growth needs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slot {
    component: Component,
    /// Productions tried since it was planned, one bit each.
    tried: u16,
    /// Edges of its production that are finished, one bit each.
    finished: u16,
    /// Places of its parts, one bit each.
    parts: u32,
    /// Whether tail recursion has restarted it.
    has_restarted: bool,
    /// Its life-cycle state before it was suspended.
    was: Life,
}

impl From<Component> for Slot {
    fn from(component: Component) -> Self {
        Self {
            component,
            tried: 0,
            finished: 0,
            parts: 0,
            has_restarted: false,
            was: Life::Planned,
        }
    }
}

/// What came of an attempt to decompose a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// It was replaced by this production, an index into the mission.
    Production(u16),
    /// No production reached the threshold, and the frame has restarted before: the loop is over.
    LoopEnded,
    /// No production that was not tried yet reached the threshold.
    NothingApplicable,
    /// The pool has no room for the production's components.
    NoRoom,
    /// The frame lies too deep.
    TooDeep,
    /// There is no such frame waiting.
    NotScheduled,
}

/// How far an end reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The plan goes on.
    GoesOn,
    /// This frame waits for nothing any more.
    Completes(Id),
    /// This frame will choose anew.
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
    /// Places that are taken, those whose component is scheduled, and those of actions that run, one
    /// bit each: every tick asks for them often.
    taken: u32,
    scheduled: u32,
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

    /// All components with their places, in the order of the places.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &Component)> {
        self.ids().filter_map(|id| Some((id, self.get(id)?)))
    }

    /// The places of all components, in order, as they are now.
    pub fn ids(&self) -> impl Iterator<Item = Id> + use<> {
        members(self.taken)
    }

    /// How many components live.
    pub fn len(&self) -> usize {
        self.taken.count_ones() as usize
    }

    /// Whether nothing lives.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The root of a behaviour's plan.
    pub fn root(&self, owner: Owner) -> Option<Id> {
        let mut all = self.iter();
        all.find(|(_, component)| component.owner == owner && component.parent.is_none())
            .map(|(id, _)| id)
    }

    /// The next scheduled component of a behaviour, frames and actions alike.
    pub fn scheduled(&self, owner: Owner) -> Option<Id> {
        members(self.scheduled).find(|&id| self.get(id).is_some_and(|part| part.owner == owner))
    }

    /// The places of all atomic actions that run, in order.
    pub fn running(&self) -> impl Iterator<Item = Id> + use<> {
        members(self.running)
    }

    /// A scheduled atomic action begins.
    pub fn start(&mut self, id: Id, tell: &mut dyn FnMut(Event)) {
        let is_action =
            self.get(id).is_some_and(|component| matches!(component.symbol, Symbol::Action(_)));
        if is_action {
            self.set_life(id, Life::Started, tell);
        }
    }

    /// Decomposes a scheduled frame: one production is chosen by `applicability`, asked with the
    /// production's index and record, 0 ..= 1; its edges enter the plan and those that leave the
    /// entry are scheduled. Unless a production is chosen the frame waits on, and the caller
    /// decides (see [`Forest::finish`], [`Forest::fail`]). Tail recursion may have moved the frame:
    /// the place where it stands now comes back too.
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
            let Some(place) = self.free_slot() else { break };
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
            self.add(place, part, tell);
        }
        self.schedule_at(id, 0, tell);
        (id, Choice::Production(chosen))
    }

    /// A component has done what it is for, and leaves the plan. What it was in the way of is
    /// scheduled; a frame that waits for nothing else is for the caller to finish next.
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

    /// The frame that would be finished next if this component finished now, and so on upwards:
    /// the parent, if it waits for nothing else.
    pub fn completes(&self, mission: &Mission<'_>, id: Id) -> Option<Id> {
        let component = self.get(id)?;
        let parent = component.parent?;
        let production = self.production_of(mission, parent)?;
        let all = all_edges(&production);
        let finished = self.slot(parent)?.finished | bit16(component.edge);
        (finished & all == all).then_some(parent)
    }

    /// A component cannot be carried out. Its parent's production is given up, and the parent
    /// chooses anew; a root that fails takes its plan with it.
    pub fn fail(&mut self, id: Id, tell: &mut dyn FnMut(Event)) -> Ended {
        let Some(component) = self.get(id).copied() else { return Ended::GoesOn };
        self.abandon_below(id, tell);
        self.set_life(id, Life::Failed, tell);
        self.delete(id, tell);
        let Some(parent) = component.parent else { return Ended::RootFailed };
        self.fall_back(parent, tell);
        Ended::FallsBack(parent)
    }

    /// Gives up what hangs below a frame, which will choose anew among what it has not tried.
    pub fn fall_back(&mut self, frame: Id, tell: &mut dyn FnMut(Event)) {
        self.abandon_below(frame, tell);
        if let Some(slot) = self.slot_mut(frame) {
            slot.component.production = None;
            slot.finished = 0;
        }
        self.set_life(frame, Life::Scheduled, tell);
    }

    /// As [`Forest::fall_back`], when the world has changed behind the frame's back, by which it is
    /// not to blame: what it has tried may be tried again.
    pub fn begin_anew(&mut self, frame: Id, tell: &mut dyn FnMut(Event)) {
        self.fall_back(frame, tell);
        if let Some(slot) = self.slot_mut(frame) {
            slot.tried = 0;
        }
    }

    /// Puts a behaviour's plan to sleep as it is.
    pub fn suspend(&mut self, owner: Owner, tell: &mut dyn FnMut(Event)) {
        for id in self.ids() {
            let Some(slot) = self.slot_mut(id).filter(|slot| slot.component.owner == owner) else {
                continue;
            };
            if matches!(slot.component.life, Life::Scheduled | Life::Started) {
                slot.was = slot.component.life;
                self.set_life(id, Life::Suspended, tell);
            }
        }
    }

    /// Wakes a behaviour's plan as it was. Frames go on; an interrupted action is scheduled, so
    /// that its initial description is checked again.
    pub fn resume(&mut self, owner: Owner, tell: &mut dyn FnMut(Event)) {
        for id in self.ids() {
            let Some(slot) = self.slot(id).filter(|slot| slot.component.owner == owner) else {
                continue;
            };
            if slot.component.life == Life::Suspended {
                let is_action = matches!(slot.component.symbol, Symbol::Action(_));
                let life = if is_action { Life::Scheduled } else { slot.was };
                self.set_life(id, life, tell);
            }
        }
    }

    /// Gives up a behaviour's whole plan.
    pub fn uproot(&mut self, owner: Owner, tell: &mut dyn FnMut(Event)) {
        for id in self.ids() {
            if self.get(id).is_some_and(|component| component.owner == owner) {
                self.set_life(id, Life::Abandoned, tell);
                self.delete(id, tell);
            }
        }
    }

    /// The production that a frame was replaced by.
    pub fn production_of(&self, mission: &Mission<'_>, frame: Id) -> Option<Production> {
        mission.productions().get(usize::from(self.get(frame)?.production?))
    }

    fn waiting_frame(&self, mission: &Mission<'_>, id: Id) -> Option<PlanFrame> {
        let component = self.get(id).filter(|component| component.life == Life::Scheduled)?;
        let Symbol::PlanFrame(index) = component.symbol else { return None };
        mission.frames().get(usize::from(index))
    }

    /// Tail recursion: where a frame is the last thing that an equal frame above it waits for, it
    /// takes that one's place. Returns the place where the frame stands then.
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

    /// The nearest frame above with the same symbol, if nothing else is left to do on the way up
    /// to it and no frame or protection interval in between has anything to say any more.
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
            if !mission.description(above_symbol).is_some_and(is_silent) {
                return None;
            }
            below = above;
        }
        None
    }

    /// Whether a protection interval of the frame's production reaches over one of its edges.
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

    /// A vertex of a frame's production may be reached: if no part leads there any more, those that
    /// leave it are scheduled.
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
        // A tree is no deeper than this, so nothing is left out.
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
            let place = bit(id);
            self.scheduled &= !place;
            self.running &= !place;
            if life == Life::Scheduled {
                self.scheduled |= place;
            } else if is_running {
                self.running |= place;
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

/// The most applicable production that was not tried, with its number within the frame.
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

/// Whether a frame keeps nothing and brings nothing about.
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
