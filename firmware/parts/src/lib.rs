//! The vocabulary of live plans: ids, owner, life cycle, events, bit sets.
//!
//! A live plan is a tree of [`Component`]s in a pool of slots; an [`Id`] is the number of a slot.
//! `grammar` grows and prunes the trees and reports each change as an [`Event`]. `monitor` follows
//! the plans by these events alone. Neither crate depends on the other; both use the types of this
//! one.
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

pub use component::{Component, Event, Id, Owner};
pub use life::Life;
