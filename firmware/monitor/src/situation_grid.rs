//! The view of the plans, and what is derived from them whenever they change.

use parts::bits::{Slots, bit, bit16};
use parts::{Component, Event, Id, Life, Owner, Pool};
use plan_format::limits::MAX_COMPONENTS;
use plan_format::mission::{Condition, Mission, Production, Symbol};

/// The situation grids of all behaviours: their plans and what these assume. A view.
#[derive(Clone, Copy, Debug)]
pub struct SituationGrid<'a> {
    pool: &'a Pool,
    assumptions: &'a Assumptions,
}

/// What the plans in a pool assume now, so that no tick derives it again.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumptions {
    /// Transient description of the component in each slot; valid if the slot is in `watched`.
    transient: [Condition; MAX_COMPONENTS],
    /// Slots of running components with a transient description.
    watched: Slots,
    /// What the protection intervals in force of the frame in each slot protect together; valid if
    /// the slot is in `holding`.
    held: [Condition; MAX_COMPONENTS],
    /// Slots of frames with a protection interval in force.
    holding: Slots,
}

impl Default for Assumptions {
    fn default() -> Self {
        Self {
            transient: [Condition::default(); MAX_COMPONENTS],
            watched: Slots::NONE,
            held: [Condition::default(); MAX_COMPONENTS],
            holding: Slots::NONE,
        }
    }
}

impl Assumptions {
    /// Takes over a change in the plans; `pool` is the pool after it.
    pub fn apply(&mut self, mission: &Mission<'_>, pool: &Pool, event: &Event) {
        match *event {
            Event::Planned { .. } => {}
            Event::Decomposed { id, .. } => self.update_held(mission, pool, id),
            Event::Restarted { id } => self.holding.remove(id),
            Event::Became { id, life } => self.became(mission, pool, id, life),
            Event::Deleted { id } => {
                self.watched.remove(id);
                self.holding.remove(id);
            }
        }
    }

    fn became(&mut self, mission: &Mission<'_>, pool: &Pool, id: Id, life: Life) {
        let Some(component) = pool.get(id) else { return };
        self.watched.remove(id);
        match life {
            Life::Started => self.watch(mission, id, component.symbol),
            Life::Finished => {
                if let Some(parent) = component.parent {
                    self.reached(mission, pool, parent, component.to);
                }
            }
            // A frame that falls back has given up its production.
            Life::Scheduled => self.holding.remove(id),
            _ => {}
        }
    }

    /// Checks a component's transient description from now on, if it has one.
    fn watch(&mut self, mission: &Mission<'_>, id: Id, symbol: Symbol) {
        let transient = mission.description(symbol).map(|description| description.transient);
        if let (Some(transient), Some(kept)) = (transient, self.transient.get_mut(usize::from(id)))
            && !transient.is_empty()
        {
            *kept = transient;
            self.watched.insert(id);
        }
    }

    /// Updates a frame after an edge into a vertex of its production has finished: protection
    /// intervals may begin or end there.
    fn reached(&mut self, mission: &Mission<'_>, pool: &Pool, id: Id, vertex: u8) {
        let production = pool.get(id).and_then(|frame| production_of(mission, frame));
        let Some(production) = production else { return };
        let mut intervals = mission.intervals_of(&production);
        if intervals.any(|interval| interval.from == vertex || interval.to == vertex) {
            self.update_held(mission, pool, id);
        }
    }

    /// Derives what the protection intervals in force of a frame protect.
    fn update_held(&mut self, mission: &Mission<'_>, pool: &Pool, id: Id) {
        self.holding.remove(id);
        let Some(frame) = pool.get(id) else { return };
        let Some(production) = production_of(mission, frame) else { return };
        if production.intervals == 0 {
            return;
        }
        let ahead = ahead(mission, &production, frame.finished);
        let is_ahead = |vertex| ahead & bit(vertex) != 0;
        let in_force = mission
            .intervals_of(&production)
            .filter(|interval| !is_ahead(interval.from) && is_ahead(interval.to));
        let held = in_force.fold(Condition::default(), |held, each| held.and(each.condition));
        if let Some(kept) = self.held.get_mut(usize::from(id))
            && !held.is_empty()
        {
            *kept = held;
            self.holding.insert(id);
        }
    }
}

impl<'a> SituationGrid<'a> {
    /// The view of the plans in a pool. The assumptions must have heard each event of the pool.
    pub fn new(pool: &'a Pool, assumptions: &'a Assumptions) -> Self {
        Self { pool, assumptions }
    }

    /// The transient descriptions of an owner's running components.
    pub(crate) fn transients(self, owner: Owner) -> impl Iterator<Item = (Id, Condition)> {
        let watched = self.assumptions.watched & self.pool.owned(owner);
        watched
            .iter()
            .filter_map(move |id| Some((id, *self.assumptions.transient.get(usize::from(id))?)))
    }

    /// What each frame of an owner's plan protects now: its intervals in force together.
    pub fn held(self, owner: Owner) -> impl Iterator<Item = (Id, Condition)> {
        let holding = self.assumptions.holding & self.pool.owned(owner);
        holding
            .iter()
            .filter_map(move |id| Some((id, *self.assumptions.held.get(usize::from(id))?)))
    }

    /// The plans.
    pub fn pool(self) -> &'a Pool {
        self.pool
    }

    /// The component in a slot.
    pub fn get(self, id: Id) -> Option<&'a Component> {
        self.pool.get(id)
    }

    /// All components, in the order of their slots.
    pub fn iter(self) -> impl Iterator<Item = (Id, &'a Component)> {
        self.pool.iter()
    }

    /// The components of an owner's plan, in the order of their slots.
    pub fn of(self, owner: Owner) -> impl Iterator<Item = (Id, &'a Component)> {
        self.pool.owned(owner).iter().filter_map(move |id| Some((id, self.get(id)?)))
    }

    /// The components above one, from its parent to the root.
    pub fn above(self, id: Id) -> impl Iterator<Item = (Id, &'a Component)> {
        self.pool.above(id)
    }

    /// The strictest constraints on a component: its own and those inherited from every frame above
    /// (H: the transient description "is inherited during instantiation"). Maximum speed in m/s,
    /// infinite for none; minimum distance in metres, 0 for none.
    pub fn constraints(self, mission: &Mission<'_>, id: Id) -> (f32, f32) {
        let all = self.get(id).into_iter().chain(self.above(id).map(|(_, entry)| entry));
        all.filter_map(|entry| mission.description(entry.symbol)).fold(
            (f32::INFINITY, 0.0),
            |(speed, distance), description| {
                (speed.min(description.max_speed_mps), distance.max(description.min_distance_m))
            },
        )
    }
}

/// The production that replaced a frame.
pub(crate) fn production_of(mission: &Mission<'_>, frame: &Component) -> Option<Production> {
    mission.productions().get(usize::from(frame.production?))
}

/// The vertices that are not reached, one bit each: an edge into each is not finished.
pub(crate) fn ahead(mission: &Mission<'_>, production: &Production, finished: u16) -> u32 {
    let edges = (0..).zip(mission.edges_of(production));
    edges
        .filter(|&(number, _)| finished & bit16(number) == 0)
        .fold(0, |ahead, (_, edge)| ahead | bit(edge.to))
}
