//! The situation grid: what a live plan assumes, and whether it still holds.
//!
//! The grid shows every component of every behaviour's plan. Through the mission it knows their
//! initial, transient and goal descriptions, the relation between each two of them, and the
//! protection intervals in force. From these it signals *evident* conflicts (violated now) and
//! *possible* ones (nothing provides a later need any more). It only reports; the behaviour control
//! system acts (Hasemann, "Situation Grid").
//!
//! ```
//! use monitor::{Assumptions, Signal, SituationGrid, Violation};
//! use parts::{Component, Event, Life, Pool};
//! use plan_format::mission::{Mission, Symbol};
//!
//! let text = "
//!     input time; of time
//!     fact on-field symbol
//!     action plough hold 0; keeps on-field
//!     frame work
//!     = plough
//!     behaviour all work; when always PS
//! ";
//! let bytes = fixtures::mission(text).write().unwrap();
//! let mission = Mission::parse(&bytes).unwrap();
//! let component = Component {
//!     symbol: Symbol::Action(0),
//!     owner: 0,
//!     parent: None,
//!     edge: 0,
//!     from: 0,
//!     to: 0,
//!     life: Life::Scheduled,
//!     depth: 0,
//!     production: None,
//!     finished: 0,
//! };
//! let (mut pool, mut assumptions) = (Pool::default(), Assumptions::default());
//! for event in [
//!     Event::Planned { id: 7, component },
//!     Event::Became { id: 7, life: Life::Started },
//! ] {
//!     pool.apply(&event);
//!     assumptions.apply(&mission, &pool, &event);
//! }
//! let grid = SituationGrid::new(&pool, &assumptions);
//! // The running action needs the fact of bit 0. It holds, and then it does not.
//! assert_eq!(grid.evident(0, 1).next(), None);
//! let conflict = Signal::Evident { id: 7, what: Violation::Transient, facts: 1 };
//! assert_eq!(grid.evident(0, 0).next(), Some(conflict));
//! ```
//!
//! The grid is a view of the pool that holds the plans, and of their [`Assumptions`]. Both change by
//! events only, so its content can be replayed from a log.
//!
//! Relations are decided at the lowest common ancestor of two components, because the paper does
//! not give its "small rule base". A component inside another is its descendant (DO); the other is
//! its ancestor (AO). In the graph of one production, an edge comes after (CA) another if a path
//! leads from the end of the other to its start; the other then comes before it (CB). Parts of
//! different productions of one frame are optional choices (OC). All others have no entry (NE), and
//! only they may run at the same time. So exactly one relation holds between two different
//! components; AO and DO, CB and CA are inverse, OC and NE are symmetric, CB is transitive, and a
//! new component does not change the relation of two old ones.
//!
//! There is one grid per behaviour, as in the paper: the components share one store, and each view
//! contains those of one owner. What a sleeping behaviour protects is recorded when it is put to
//! sleep, and is checked for all others as one foreign condition ([`Signal::foreign`]). This is the
//! paper's top-level component that is parallel to all.
//!
//! Invariant: events keep the assumptions up to date, namely the transient descriptions of running
//! components and the intervals in force of each frame; no tick derives them again.
//!
//! Deliberately absent: repair. The remedy for a conflict is to fall back and choose again.
#![no_std]

mod conflicts;
mod points;
mod relation;
mod situation_grid;

pub use conflicts::{Doubt, Signal, Violation, endangers};
pub use parts::{Component, Id, Life, Owner, Pool};
pub use points::Point;
pub use relation::{Node, Relation};
pub use situation_grid::{Assumptions, SituationGrid};

#[cfg(test)]
mod tests;
