//! A part of a live plan, and what happens to it.

use crate::Life;
use plan_format::mission::Symbol;

/// A component's place in the pool; used again after the component is deleted.
pub type Id = u8;
/// A behaviour, by its index in the mission; its start-up and shut-down activities have owners of
/// their own.
pub type Owner = u8;

/// A part of a live plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// The plan frame or atomic action that it stands for.
    pub symbol: Symbol,
    /// The behaviour whose plan it belongs to.
    pub owner: Owner,
    /// The frame that it is part of; `None` for a root.
    pub parent: Option<Id>,
    /// Its edge in the parent's production, counted within the production.
    pub edge: u8,
    /// Vertex of the parent's production at which it begins.
    pub from: u8,
    /// Vertex of the parent's production at which it ends.
    pub to: u8,
    /// Life-cycle state.
    pub life: Life,
    /// Number of frames above it.
    pub depth: u8,
    /// The production that replaced it, for a decomposed frame: index into the mission.
    pub production: Option<u16>,
}

impl Component {
    /// Whether it is an atomic action that is being carried out.
    pub fn is_running(&self) -> bool {
        self.life == Life::Started && matches!(self.symbol, Symbol::Action(_))
    }
}

/// A change in a live plan. A plan's events, in order, tell everything about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A component entered the plan.
    Planned {
        /// Its place.
        id: Id,
        /// The component.
        component: Component,
    },
    /// A frame chose a production.
    Decomposed {
        /// The frame.
        id: Id,
        /// Index of the production in the mission.
        production: u16,
    },
    /// Tail recursion: an equal frame below took this one's place, and begins as if new.
    Restarted {
        /// The place.
        id: Id,
    },
    /// A component's life-cycle state changed.
    Became {
        /// Its place.
        id: Id,
        /// The new state.
        life: Life,
    },
    /// A component left the plan.
    Deleted {
        /// The place that is free now.
        id: Id,
    },
}
