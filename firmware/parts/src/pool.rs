//! The store of all live plans.

use crate::bits::{Slots, bit16};
use crate::{Component, Event, Id, Life, OWNERS, Owner, ProductionIndex};
use plan_format::limits::{MAX_COMPONENTS, MAX_DEPTH};

/// The components of all live plans, by slot. `grammar` owns it and changes it by events only;
/// `monitor` reads it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pool {
    components: [Option<Component>; MAX_COMPONENTS],
    /// Slots in use: most are free, and every tick visits all that are used often.
    taken: Slots,
    /// Slots of each owner's plan.
    owned: [Slots; OWNERS],
}

impl Default for Pool {
    fn default() -> Self {
        Self {
            components: [None; MAX_COMPONENTS],
            taken: Slots::NONE,
            owned: [Slots::NONE; OWNERS],
        }
    }
}

impl Pool {
    /// The component in a slot.
    pub fn get(&self, id: Id) -> Option<&Component> {
        self.components.get(usize::from(id))?.as_ref()
    }

    /// All components, in the order of their slots.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &Component)> {
        self.ids().filter_map(|id| Some((id, self.get(id)?)))
    }

    /// The slots in use, in order; later changes to the pool do not affect the iterator.
    pub fn ids(&self) -> impl Iterator<Item = Id> + use<> {
        self.taken.iter()
    }

    /// The slots of an owner's plan.
    pub fn owned(&self, owner: Owner) -> Slots {
        self.owned.get(usize::from(owner)).copied().unwrap_or_default()
    }

    /// The slots of the components that a frame contains directly.
    pub fn parts(&self, frame: Id) -> impl Iterator<Item = Id> {
        let owned = self.get(frame).map_or(Slots::NONE, |component| self.owned(component.owner));
        owned.iter().filter(move |&id| self.get(id).is_some_and(|part| part.parent == Some(frame)))
    }

    /// Number of components.
    pub fn len(&self) -> usize {
        self.taken.len()
    }

    /// Whether it has no component.
    pub fn is_empty(&self) -> bool {
        self.taken.is_empty()
    }

    /// The first slot that is free.
    pub fn free_slot(&self) -> Option<Id> {
        let id = self.taken.first_missing();
        (usize::from(id) < MAX_COMPONENTS).then_some(id)
    }

    /// The components above one, from its parent to the root.
    pub fn above(&self, id: Id) -> impl Iterator<Item = (Id, &Component)> {
        let parent = |id: Id| self.get(id).and_then(|component| component.parent);
        core::iter::successors(parent(id), move |&id| parent(id))
            .take(MAX_DEPTH)
            .filter_map(|id| Some((id, self.get(id)?)))
    }

    /// Takes over a change.
    // Each caller knows the kind of change, so most of this falls away.
    #[inline(always)]
    pub fn apply(&mut self, event: &Event) {
        match *event {
            Event::Planned { id, component } => {
                let owned = self.owned.get_mut(usize::from(component.owner));
                if let (Some(place), Some(owned)) =
                    (self.components.get_mut(usize::from(id)), owned)
                {
                    *place = Some(component);
                    self.taken.insert(id);
                    owned.insert(id);
                }
            }
            Event::Decomposed { id, production } => self.choose(id, Some(production)),
            Event::Restarted { id } => self.choose(id, None),
            Event::Became { id, life } => self.set_life(id, life),
            Event::Deleted { id } => {
                let place = self.components.get_mut(usize::from(id)).and_then(Option::take);
                if let Some(component) = place {
                    self.taken.remove(id);
                    if let Some(owned) = self.owned.get_mut(usize::from(component.owner)) {
                        owned.remove(id);
                    }
                }
            }
        }
    }

    /// A frame has this production now, and none of its edges is finished.
    fn choose(&mut self, id: Id, production: Option<ProductionIndex>) {
        if let Some(frame) = self.get_mut(id) {
            frame.production = production;
            frame.finished = 0;
        }
    }

    fn set_life(&mut self, id: Id, life: Life) {
        let Some(component) = self.get_mut(id) else { return };
        component.life = life;
        let Component { parent, edge, .. } = *component;
        match life {
            // A frame that falls back has given up its production.
            Life::Scheduled => self.choose(id, None),
            Life::Finished => {
                if let Some(frame) = parent.and_then(|parent| self.get_mut(parent)) {
                    frame.finished |= bit16(edge);
                }
            }
            _ => {}
        }
    }

    fn get_mut(&mut self, id: Id) -> Option<&mut Component> {
        self.components.get_mut(usize::from(id))?.as_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plan_format::mission::Symbol;

    fn planned(id: Id, owner: Owner, parent: Option<Id>, edge: u8) -> Event {
        let component = Component {
            symbol: Symbol::PlanFrame(0),
            owner,
            parent,
            edge,
            from: 0,
            to: 1,
            life: Life::Planned,
            depth: u8::from(parent.is_some()),
            production: None,
            finished: 0,
        };
        Event::Planned { id, component }
    }

    /// Two plans: 0 above 1 and 40, and 2.
    fn two_plans() -> Pool {
        let mut pool = Pool::default();
        assert!(pool.is_empty() && pool.free_slot() == Some(0));
        for event in [
            planned(0, 3, None, 0),
            planned(1, 3, Some(0), 0),
            planned(2, 4, None, 0),
            planned(40, 3, Some(0), 5),
        ] {
            pool.apply(&event);
        }
        pool
    }

    #[test]
    fn each_plan_knows_its_slots() {
        let mut pool = two_plans();
        assert!(pool.ids().eq([0, 1, 2, 40]) && pool.len() == 4 && !pool.is_empty());
        assert!(pool.owned(3).iter().eq([0, 1, 40]) && pool.owned(4).iter().eq([2]));
        assert!(pool.parts(0).eq([1, 40]) && pool.parts(2).next().is_none());
        assert!(pool.above(40).map(|(id, _)| id).eq([0]));
        assert_eq!(pool.get(40).map(|component| component.edge), Some(5));
        assert!(pool.get(3).is_none() && pool.owned(0).is_empty() && pool.owned(200).is_empty());
        pool.apply(&Event::Deleted { id: 1 });
        assert!(pool.ids().eq([0, 2, 40]) && pool.get(1).is_none());
        assert!(pool.owned(3).iter().eq([0, 40]) && pool.parts(0).eq([40]));
        assert_eq!(pool.free_slot(), Some(1));
        // Neither a slot nor an owner beyond the last one exists.
        pool.apply(&planned(MAX_COMPONENTS as Id, 3, None, 0));
        pool.apply(&planned(1, OWNERS as Owner, None, 0));
        pool.apply(&Event::Deleted { id: 1 });
        assert_eq!(pool.len(), 3);
    }

    #[test]
    fn a_full_pool_has_no_free_slot() {
        let mut pool = Pool::default();
        for id in 0..MAX_COMPONENTS as Id {
            assert_eq!(pool.free_slot(), Some(id));
            pool.apply(&planned(id, id % 16, None, 0));
        }
        assert_eq!((pool.free_slot(), pool.len()), (None, MAX_COMPONENTS));
    }

    /// A frame's production, and which of its edges are finished, follow from the events.
    #[test]
    fn a_frame_chooses_and_its_parts_finish() {
        let mut pool = two_plans();
        let frame = |pool: &Pool| {
            let frame = pool.get(0).expect("it is there");
            (frame.life, frame.production, frame.finished)
        };
        let became = |id, life| Event::Became { id, life };
        pool.apply(&became(0, Life::Started));
        pool.apply(&Event::Decomposed { id: 0, production: 7 });
        assert_eq!(frame(&pool), (Life::Started, Some(7), 0));
        pool.apply(&became(40, Life::Finished));
        pool.apply(&became(1, Life::Failed));
        assert_eq!(frame(&pool), (Life::Started, Some(7), 0b10_0000));
        pool.apply(&became(1, Life::Finished));
        assert_eq!(frame(&pool), (Life::Started, Some(7), 0b10_0001));
        pool.apply(&Event::Restarted { id: 0 });
        assert_eq!(frame(&pool), (Life::Started, None, 0));
        pool.apply(&Event::Decomposed { id: 0, production: 8 });
        pool.apply(&became(40, Life::Finished));
        // A frame that falls back gives up its production.
        pool.apply(&became(0, Life::Scheduled));
        assert_eq!(frame(&pool), (Life::Scheduled, None, 0));
        // A root has no frame above it.
        pool.apply(&became(2, Life::Finished));
        assert_eq!(pool.get(2).map(|root| root.life), Some(Life::Finished));
    }
}
