//! The store, and the messages that keep it.

use plan_format::limits::{MAX_COMPONENTS, MAX_DEPTH};
use plan_format::mission::{Condition, Life, Mission, Production, Symbol};

/// A component's place.
pub type Id = u8;
/// A behaviour, by its index in the mission.
pub type Owner = u8;

/// What the grid knows of a component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// What it is.
    pub symbol: Symbol,
    /// Whose plan it belongs to.
    pub owner: Owner,
    /// The frame it is part of; `None` for a root.
    pub parent: Option<Id>,
    /// Which edge of the parent's production it is, counted within the production.
    pub edge: u8,
    /// Vertices of the parent's production between which it stands.
    pub from: u8,
    /// See `from`.
    pub to: u8,
    /// Where it is in its life.
    pub life: Life,
    /// The production a frame was replaced by: index into the mission.
    pub production: Option<u16>,
    /// Edges of its production that are finished, one bit each.
    pub finished: u16,
}

/// The situation grids of all behaviours.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    entries: [Option<Entry>; MAX_COMPONENTS],
    /// Places that are taken, one bit each: most are free, and every tick looks at all often.
    taken: u32,
    /// What every tick checks is worked out when a message changes it, not in every tick: the
    /// transient descriptions of the components that run, and what the protection intervals in
    /// force of each frame protect, all together. Valid where the bit of the place is set.
    transient: [Condition; MAX_COMPONENTS],
    watched: u32,
    held: [Condition; MAX_COMPONENTS],
    holding: u32,
}

impl Default for Grid {
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

impl Grid {
    /// Message: a component entered the plan.
    pub fn planned(&mut self, id: Id, entry: Entry) {
        if let Some(slot) = self.entries.get_mut(usize::from(id)) {
            *slot = Some(entry);
            self.taken |= place_bit(id);
        }
    }

    /// Message: a frame chose a production.
    pub fn decomposed(&mut self, mission: &Mission<'_>, id: Id, production: u16) {
        if let Some(entry) = self.get_mut(id) {
            entry.production = Some(production);
            entry.finished = 0;
            self.take_hold(mission, id);
        }
    }

    /// Message: end recursion; the frame stands there as if new.
    pub fn came_round(&mut self, id: Id) {
        if let Some(entry) = self.get_mut(id) {
            entry.production = None;
            entry.finished = 0;
            self.holding &= !place_bit(id);
        }
    }

    /// Message: a component's life went on.
    pub fn became(&mut self, mission: &Mission<'_>, id: Id, life: Life) {
        let Some(entry) = self.get_mut(id) else { return };
        entry.life = life;
        let Entry { symbol, parent, edge, to, .. } = *entry;
        self.watched &= !place_bit(id);
        match life {
            Life::Started => self.watch(mission, id, symbol),
            Life::Finished => {
                let Some(parent) = parent else { return };
                if let Some(entry) = self.get_mut(parent) {
                    entry.finished |= bit(edge);
                    self.reached(mission, parent, to);
                }
            }
            // A frame that falls back has given its production up.
            Life::Scheduled => self.came_round(id),
            _ => {}
        }
    }

    /// Message: a component left the plan.
    pub fn deleted(&mut self, id: Id) {
        if let Some(slot) = self.entries.get_mut(usize::from(id)) {
            *slot = None;
            let others = !place_bit(id);
            self.taken &= others;
            self.watched &= others;
            self.holding &= others;
        }
    }

    /// From now on its transient description is checked, if there is one.
    fn watch(&mut self, mission: &Mission<'_>, id: Id, symbol: Symbol) {
        let transient = mission.description(symbol).map(|description| description.transient);
        if let (Some(transient), Some(slot)) = (transient, self.transient.get_mut(usize::from(id)))
            && !transient.is_empty()
        {
            *slot = transient;
            self.watched |= place_bit(id);
        }
    }

    /// An edge into a vertex of a frame's production is finished: protection intervals may begin or
    /// end there.
    fn reached(&mut self, mission: &Mission<'_>, id: Id, vertex: u8) {
        let production = self.get(id).and_then(|entry| self.production_of(mission, entry));
        let Some(production) = production else { return };
        let mut intervals = mission.intervals_of(&production);
        if intervals.any(|interval| interval.from == vertex || interval.to == vertex) {
            self.take_hold(mission, id);
        }
    }

    /// Works out which protection intervals of a frame are in force.
    fn take_hold(&mut self, mission: &Mission<'_>, id: Id) {
        self.holding &= !place_bit(id);
        let Some((production, finished)) = self
            .get(id)
            .and_then(|entry| Some((self.production_of(mission, entry)?, entry.finished)))
        else {
            return;
        };
        if production.intervals == 0 {
            return;
        }
        let ahead = ahead(mission, &production, finished);
        let is_ahead = |vertex| ahead & vertex_bit(vertex) != 0;
        let in_force = mission
            .intervals_of(&production)
            .filter(|interval| !is_ahead(interval.from) && is_ahead(interval.to));
        let held = in_force.fold(Condition::default(), |held, each| held.and(each.condition));
        if let Some(slot) = self.held.get_mut(usize::from(id))
            && !held.is_empty()
        {
            *slot = held;
            self.holding |= place_bit(id);
        }
    }

    /// The transient descriptions of a behaviour's components that run.
    pub(crate) fn transients(&self, owner: Owner) -> impl Iterator<Item = (Id, Condition)> {
        places(self.watched)
            .filter(move |&id| self.owner(id) == Some(owner))
            .filter_map(|id| Some((id, *self.transient.get(usize::from(id))?)))
    }

    /// What the frames of a behaviour's plan protect now, each all together.
    pub fn held(&self, owner: Owner) -> impl Iterator<Item = (Id, Condition)> {
        places(self.holding)
            .filter(move |&id| self.owner(id) == Some(owner))
            .filter_map(|id| Some((id, *self.held.get(usize::from(id))?)))
    }

    fn owner(&self, id: Id) -> Option<Owner> {
        self.get(id).map(|entry| entry.owner)
    }

    /// What the grid knows of a component.
    pub fn get(&self, id: Id) -> Option<&Entry> {
        self.entries.get(usize::from(id))?.as_ref()
    }

    /// Everything that the grid knows, in the order of the places.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &Entry)> {
        places(self.taken).filter_map(|id| Some((id, self.get(id)?)))
    }

    /// The components above one, from its parent to the root.
    pub fn above(&self, id: Id) -> impl Iterator<Item = (Id, &Entry)> {
        let parent = |id: Id| self.get(id).and_then(|entry| entry.parent);
        core::iter::successors(parent(id), move |&id| parent(id))
            .take(MAX_DEPTH)
            .filter_map(|id| Some((id, self.get(id)?)))
    }

    /// The strictest constraints on a component: its own and, inherited, those of every frame
    /// above it (H: the transient description "is inherited during instantiation"). Maximum speed
    /// in m/s, infinite for none; minimum distance in metres, 0 for none.
    pub fn constraints(&self, mission: &Mission<'_>, id: Id) -> (f32, f32) {
        let all = self.get(id).into_iter().chain(self.above(id).map(|(_, entry)| entry));
        all.filter_map(|entry| mission.description(entry.symbol)).fold(
            (f32::INFINITY, 0.0),
            |(speed, distance), description| {
                (speed.min(description.max_speed_mps), distance.max(description.min_distance_m))
            },
        )
    }

    /// The production that a frame was replaced by.
    pub(crate) fn production_of(&self, mission: &Mission<'_>, frame: &Entry) -> Option<Production> {
        mission.productions().get(usize::from(frame.production?))
    }

    fn get_mut(&mut self, id: Id) -> Option<&mut Entry> {
        self.entries.get_mut(usize::from(id))?.as_mut()
    }
}

/// The vertices, one bit each, into which some edge is not finished.
pub(crate) fn ahead(mission: &Mission<'_>, production: &Production, finished: u16) -> u32 {
    let edges = (0..).zip(mission.edges_of(production));
    edges
        .filter(|&(number, _)| finished & bit(number) == 0)
        .fold(0, |ahead, (_, edge)| ahead | vertex_bit(edge.to))
}

/// The places in a set, in order.
fn places(mut set: u32) -> impl Iterator<Item = Id> {
    core::iter::from_fn(move || {
        let id = set.trailing_zeros();
        set &= set.wrapping_sub(1);
        (id < u32::BITS).then_some(id as Id)
    })
}

/// The bit of a place.
fn place_bit(id: Id) -> u32 {
    1_u32.wrapping_shl(u32::from(id))
}

/// The bit of a vertex.
pub(crate) fn vertex_bit(vertex: u8) -> u32 {
    1_u32.wrapping_shl(u32::from(vertex))
}

/// The bit of an edge of a production, of which there are no more than bits.
pub(crate) fn bit(edge: u8) -> u16 {
    1_u16.wrapping_shl(u32::from(edge))
}
