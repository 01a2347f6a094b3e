//! The situation grid: what a live plan assumes, and whether it still holds.
//!
//! For every component of every behaviour's plan the grid keeps its place, its state and, through
//! the mission, its initial, transient and goal descriptions; it knows the relation of each
//! component to each other, which protection intervals are in force, and from that it signals
//! *evident* conflicts (violated now) and *possible* ones (a later need is no longer provided
//! for). It only reports; the behaviour control system acts (Hasemann, "Situation SituationGrid").
//!
//! The grid lives on messages about the plan: it never looks at the plan itself, so that what it
//! believes can be replayed from a log.
//!
//! Relations are decided at the lowest common ancestor of two components, the paper's "small rule
//! base" being silent: what lies inside is descendant of (DO) what holds it, its ancestor (AO); in
//! one production's graph, what can be reached from the end of the other comes after it (CA), the
//! other comes before (CB); parts of different productions of one frame are optional choices (OC);
//! everything else is NE, and only such components may ever run at once. So exactly one relation
//! holds between two different components, AO and DO, CB and CA are inverse, OC and NE symmetric,
//! CB is transitive, and a new component never changes the relation of two old ones.
//!
//! One grid per behaviour, as in the paper: the components share one store, each view contains
//! one owner's. What a sleeping behaviour still protects was handed over when it was put to sleep,
//! and is held against all others as one foreign condition ([`Signal::foreign`]): the paper's
//! top-level component parallel to all.
//!
//! What every tick asks for is kept up to date by the messages, not worked out again: the transient
//! descriptions of what runs and the intervals in force of each frame.
//!
//! Deliberately absent: repair. A conflict's remedy is to fall back and choose anew.
#![no_std]

mod conflicts;
mod grid;
mod points;
mod relation;

pub use conflicts::{Doubt, Signal, Violation};
pub use grid::SituationGrid;
pub use parts::{Component, Id, Life, Owner};
pub use points::Point;
pub use relation::{Node, Relation};

#[cfg(test)]
mod tests;
