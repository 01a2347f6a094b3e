//! A component of a live plan, and the changes to it.

use crate::Life;
use plan_format::limits::{MAX_BEHAVIOURS, MAX_PRODUCTIONS};
use plan_format::mission::Symbol;

/// The number of a component's slot in the pool; reused after the component is deleted.
pub type Id = u8;
/// The owner of a plan, below [`OWNERS`]: a behaviour, by its index in the mission, or its start-up
/// or shut-down activity, which has a number of its own.
pub type Owner = u8;

/// Number of owners: each behaviour, and its activities.
pub const OWNERS: usize = 2 * MAX_BEHAVIOURS;

/// The index of a production in the mission.
pub type ProductionIndex = u8;

const _: () = assert!(MAX_PRODUCTIONS <= 1 << ProductionIndex::BITS);

/// A component of a live plan.
#[derive(Clone, Copy, Debug, PartialEq)]
// Whole words are copied faster, and components are copied often.
#[repr(align(4))]
pub struct Component {
    /// The plan frame or atomic action that it stands for.
    pub symbol: Symbol,
    /// The owner of its plan.
    pub owner: Owner,
    /// The plan frame that contains it; `None` for a root.
    pub parent: Option<Id>,
    /// Its edge in the parent's production, numbered within the production.
    pub edge: u8,
    /// Vertex of the parent's production at which it begins.
    pub from: u8,
    /// Vertex of the parent's production at which it ends.
    pub to: u8,
    /// Life-cycle state.
    pub life: Life,
    /// Number of plan frames above it.
    pub depth: u8,
    /// The production that replaced it, if it is a decomposed plan frame: index in the mission.
    pub production: Option<ProductionIndex>,
    /// Edges of that production that are finished, one bit each.
    pub finished: u16,
}

impl Component {
    /// Whether it is an atomic action that runs.
    ///
    /// ```
    /// use parts::{Component, Life};
    /// use plan_format::mission::Symbol;
    /// let component = |symbol, life| Component {
    ///     symbol, owner: 0, parent: None, edge: 0, from: 0, to: 1, life, depth: 1, production: None,
    ///     finished: 0,
    /// };
    /// assert!(component(Symbol::Action(0), Life::Started).is_running());
    /// assert!(!component(Symbol::Action(0), Life::Scheduled).is_running());
    /// assert!(!component(Symbol::PlanFrame(0), Life::Started).is_running());
    /// ```
    pub fn is_running(&self) -> bool {
        self.life == Life::Started && matches!(self.symbol, Symbol::Action(_))
    }
}

/// A change in a live plan. A plan's events, in order, describe it completely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A component entered the plan.
    Planned {
        /// Its slot.
        id: Id,
        /// The component.
        component: Component,
    },
    /// A plan frame chose a production.
    Decomposed {
        /// Slot of the plan frame.
        id: Id,
        /// Index of the production in the mission.
        production: ProductionIndex,
    },
    /// Tail recursion: the plan frame starts again, in place of an equal one below it.
    Restarted {
        /// Its slot.
        id: Id,
    },
    /// A component's life-cycle state changed.
    Became {
        /// Its slot.
        id: Id,
        /// The new state.
        life: Life,
    },
    /// A component left the plan.
    Deleted {
        /// The slot, which is free now.
        id: Id,
    },
}
