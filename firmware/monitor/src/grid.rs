//! The store, and the messages that keep it.

use plan_format::limits::{MAX_COMPONENTS, MAX_DEPTH};
use plan_format::mission::{Life, Mission, Production, Symbol};

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
}

impl Default for Grid {
    fn default() -> Self {
        Self { entries: [None; MAX_COMPONENTS] }
    }
}

impl Grid {
    /// Message: a component entered the plan.
    pub fn planned(&mut self, id: Id, entry: Entry) {
        if let Some(slot) = self.entries.get_mut(usize::from(id)) {
            *slot = Some(entry);
        }
    }

    /// Message: a frame chose a production.
    pub fn decomposed(&mut self, id: Id, production: u16) {
        if let Some(entry) = self.get_mut(id) {
            entry.production = Some(production);
            entry.finished = 0;
        }
    }

    /// Message: end recursion; the frame stands there as if new.
    pub fn came_round(&mut self, id: Id) {
        if let Some(entry) = self.get_mut(id) {
            entry.production = None;
            entry.finished = 0;
        }
    }

    /// Message: a component's life went on.
    pub fn became(&mut self, id: Id, life: Life) {
        let Some(entry) = self.get_mut(id) else { return };
        entry.life = life;
        let (parent, edge) = (entry.parent, entry.edge);
        match life {
            Life::Finished => {
                if let Some(parent) = parent.and_then(|parent| self.get_mut(parent)) {
                    parent.finished |= bit(edge);
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
        }
    }

    /// What the grid knows of a component.
    pub fn get(&self, id: Id) -> Option<&Entry> {
        self.entries.get(usize::from(id))?.as_ref()
    }

    /// Everything that the grid knows, in the order of the places.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &Entry)> {
        (0..).zip(&self.entries).filter_map(|(id, entry)| Some((id, entry.as_ref()?)))
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

/// Whether every edge into a vertex is finished.
pub(crate) fn is_reached(
    mission: &Mission<'_>,
    production: &Production,
    finished: u16,
    vertex: u8,
) -> bool {
    let edges = mission.edges_of(production);
    (0..).zip(edges).all(|(number, edge)| edge.to != vertex || finished & bit(number) != 0)
}

/// The bit of an edge.
pub(crate) fn bit(edge: u8) -> u16 {
    1_u16.checked_shl(u32::from(edge)).unwrap_or(0)
}
