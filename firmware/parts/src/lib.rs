//! The vocabulary of live plans: ids, owner, life cycle, events, bit sets.
//!
//! A live plan is a tree of [`Component`]s. `grammar` grows and prunes the trees and reports each
//! change as an [`Event`]; `monitor` keeps what it needs of them from the events alone. Both speak
//! in the words of this crate and do not know each other.
//!
//! Deliberately absent: any decision.
#![no_std]

pub mod bits;
mod component;
mod life;

pub use component::{Component, Event, Id, Owner};
pub use life::Life;
