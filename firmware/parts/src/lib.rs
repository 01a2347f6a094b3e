//! The vocabulary of live plans: components, the pool that stores them, life cycle, events, bit sets.
//!
//! A live plan is a tree of [`Component`]s in the slots of a [`Pool`]; an [`Id`] is the number of a
//! slot. `grammar` owns the pool. It grows and prunes the trees, and each change is an [`Event`].
//! `monitor` reads the pool and hears each event. Neither crate depends on the other; both use the
//! types of this one.
//!
//! ```
//! use parts::Life;
//! assert!(Life::Planned.may_become(Life::Scheduled));
//! assert!(!Life::Finished.may_become(Life::Started));
//! ```
//!
//! Invariants: [`Life::may_become`] lists every transition of the life cycle; a plan's events, in
//! order, describe the plan completely.
//!
//! Source: Hasemann, "Plan Component Representation".
//!
//! Deliberately absent: any decision.
#![no_std]

pub mod bits;
mod component;
mod life;
mod pool;

pub use component::{Component, Event, Id, OWNERS, Owner, ProductionIndex};
pub use life::Life;
pub use pool::Pool;
