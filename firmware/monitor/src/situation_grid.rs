//! The store of the situation grid, and the events that update it.

use parts::bits::{bit, bit16, members};
use parts::{Component, Event, Id, Life, Owner};
use plan_format::limits::{MAX_COMPONENTS, MAX_DEPTH};
use plan_format::mission::{Condition, Mission, Production, Symbol};

/// A component, and which edges of its production are finished, one bit each.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    component: Component,
    finished: u16,
}

/// The situation grids of all behaviours.
#[derive(Clone, Debug, PartialEq)]
pub struct SituationGrid {
    entries: [Option<Entry>; MAX_COMPONENTS],
    /// Slots in use, one bit each: most are free, and every tick visits all of them often.
    taken: u32,
    /// Transient description of the component in each slot; valid if its bit in `watched` is set.
    transient: [Condition; MAX_COMPONENTS],
    /// Slots of running components with a transient description, one bit each.
    watched: u32,
    /// What the protection intervals in force of the frame in each slot protect together; valid if
    /// its bit in `holding` is set.
    held: [Condition; MAX_COMPONENTS],
    /// Slots of frames with a protection interval in force, one bit each.
    holding: u32,
}

impl Default for SituationGrid {
    fn default() -> Self {
        Self {
            entries: [None; MAX_COMPONENTS],
            taken: 0,
            transient: [Condition::default(); MAX_COMPONENTS],
            watched: 0,
            held: [Condition::default(); MAX_COMPONENTS],
            holding: 0,
        }
    }
}

impl SituationGrid {
    /// Applies a change in a plan.
    pub fn apply(&mut self, mission: &Mission<'_>, event: &Event) {
        match *event {
            Event::Planned { id, component } => self.planned(id, component),
            Event::Decomposed { id, production } => self.decomposed(mission, id, production),
            Event::Restarted { id } => self.restarted(id),
            Event::Became { id, life } => self.became(mission, id, life),
            Event::Deleted { id } => self.deleted(id),
        }
    }

    fn planned(&mut self, id: Id, component: Component) {
        if let Some(slot) = self.entries.get_mut(usize::from(id)) {
            *slot = Some(Entry { component, finished: 0 });
            self.taken |= bit(id);
        }
    }

    fn decomposed(&mut self, mission: &Mission<'_>, id: Id, production: u16) {
        if let Some(entry) = self.get_mut(id) {
            entry.component.production = Some(production);
            entry.finished = 0;
            self.update_held(mission, id);
        }
    }

    /// The frame is as new.
    fn restarted(&mut self, id: Id) {
        if let Some(entry) = self.get_mut(id) {
            entry.component.production = None;
            entry.finished = 0;
            self.holding &= !bit(id);
        }
    }

    fn became(&mut self, mission: &Mission<'_>, id: Id, life: Life) {
        let Some(entry) = self.get_mut(id) else { return };
        entry.component.life = life;
        let Component { symbol, parent, edge, to, .. } = entry.component;
        self.watched &= !bit(id);
        match life {
            Life::Started => self.watch(mission, id, symbol),
            Life::Finished => {
                let Some(parent) = parent else { return };
                if let Some(entry) = self.get_mut(parent) {
                    entry.finished |= bit16(edge);
                    self.reached(mission, parent, to);
                }
            }
            // A frame that falls back has given up its production.
            Life::Scheduled => self.restarted(id),
            _ => {}
        }
    }

    fn deleted(&mut self, id: Id) {
        if let Some(slot) = self.entries.get_mut(usize::from(id)) {
            *slot = None;
            let others = !bit(id);
            self.taken &= others;
            self.watched &= others;
            self.holding &= others;
        }
    }

    /// Checks a component's transient description from now on, if it has one.
    fn watch(&mut self, mission: &Mission<'_>, id: Id, symbol: Symbol) {
        let transient = mission.description(symbol).map(|description| description.transient);
        if let (Some(transient), Some(slot)) = (transient, self.transient.get_mut(usize::from(id)))
            && !transient.is_empty()
        {
            *slot = transient;
            self.watched |= bit(id);
        }
    }

    /// Updates a frame after an edge into a vertex of its production has finished: protection
    /// intervals may begin or end there.
    fn reached(&mut self, mission: &Mission<'_>, id: Id, vertex: u8) {
        let production = self.get(id).and_then(|entry| self.production_of(mission, entry));
        let Some(production) = production else { return };
        let mut intervals = mission.intervals_of(&production);
        if intervals.any(|interval| interval.from == vertex || interval.to == vertex) {
            self.update_held(mission, id);
        }
    }

    /// Derives what the protection intervals in force of a frame protect.
    fn update_held(&mut self, mission: &Mission<'_>, id: Id) {
        self.holding &= !bit(id);
        let Some((production, finished)) = self.entry(id).and_then(|entry| {
            Some((self.production_of(mission, &entry.component)?, entry.finished))
        }) else {
            return;
        };
        if production.intervals == 0 {
            return;
        }
        let ahead = ahead(mission, &production, finished);
        let is_ahead = |vertex| ahead & bit(vertex) != 0;
        let in_force = mission
            .intervals_of(&production)
            .filter(|interval| !is_ahead(interval.from) && is_ahead(interval.to));
        let held = in_force.fold(Condition::default(), |held, each| held.and(each.condition));
        if let Some(slot) = self.held.get_mut(usize::from(id))
            && !held.is_empty()
        {
            *slot = held;
            self.holding |= bit(id);
        }
    }

    /// The transient descriptions of an owner's running components.
    pub(crate) fn transients(&self, owner: Owner) -> impl Iterator<Item = (Id, Condition)> {
        members(self.watched)
            .filter(move |&id| self.owner(id) == Some(owner))
            .filter_map(|id| Some((id, *self.transient.get(usize::from(id))?)))
    }

    /// What each frame of an owner's plan protects now: its intervals in force together.
    pub fn held(&self, owner: Owner) -> impl Iterator<Item = (Id, Condition)> {
        members(self.holding)
            .filter(move |&id| self.owner(id) == Some(owner))
            .filter_map(|id| Some((id, *self.held.get(usize::from(id))?)))
    }

    fn owner(&self, id: Id) -> Option<Owner> {
        self.get(id).map(|entry| entry.owner)
    }

    /// The component in a slot.
    pub fn get(&self, id: Id) -> Option<&Component> {
        Some(&self.entry(id)?.component)
    }

    fn entry(&self, id: Id) -> Option<&Entry> {
        self.entries.get(usize::from(id))?.as_ref()
    }

    /// The finished edges of a frame's production, one bit each.
    pub(crate) fn finished(&self, id: Id) -> u16 {
        self.entry(id).map_or(0, |entry| entry.finished)
    }

    /// All components, in the order of their slots.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &Component)> {
        members(self.taken).filter_map(|id| Some((id, self.get(id)?)))
    }

    /// The components above one, from its parent to the root.
    pub fn above(&self, id: Id) -> impl Iterator<Item = (Id, &Component)> {
        let parent = |id: Id| self.get(id).and_then(|entry| entry.parent);
        core::iter::successors(parent(id), move |&id| parent(id))
            .take(MAX_DEPTH)
            .filter_map(|id| Some((id, self.get(id)?)))
    }

    /// The strictest constraints on a component: its own and those inherited from every frame above
    /// (H: the transient description "is inherited during instantiation"). Maximum speed in m/s,
    /// infinite for none; minimum distance in metres, 0 for none.
    pub fn constraints(&self, mission: &Mission<'_>, id: Id) -> (f32, f32) {
        let all = self.get(id).into_iter().chain(self.above(id).map(|(_, entry)| entry));
        all.filter_map(|entry| mission.description(entry.symbol)).fold(
            (f32::INFINITY, 0.0),
            |(speed, distance), description| {
                (speed.min(description.max_speed_mps), distance.max(description.min_distance_m))
            },
        )
    }

    /// The production that replaced a frame.
    pub(crate) fn production_of(
        &self,
        mission: &Mission<'_>,
        frame: &Component,
    ) -> Option<Production> {
        mission.productions().get(usize::from(frame.production?))
    }

    fn get_mut(&mut self, id: Id) -> Option<&mut Entry> {
        self.entries.get_mut(usize::from(id))?.as_mut()
    }
}

/// The vertices that are not reached, one bit each: an edge into each is not finished.
pub(crate) fn ahead(mission: &Mission<'_>, production: &Production, finished: u16) -> u32 {
    let edges = (0..).zip(mission.edges_of(production));
    edges
        .filter(|&(number, _)| finished & bit16(number) == 0)
        .fold(0, |ahead, (_, edge)| ahead | bit(edge.to))
}
