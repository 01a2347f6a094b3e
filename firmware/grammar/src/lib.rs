//! Live plans: plan frames decomposed by edge-replacement grammars, one step at a time.
//!
//! A behaviour's plan is a tree of components. A plan frame is replaced by one of its
//! productions, a graph from one entry to one exit whose edges are components again; an atomic
//! action is carried out. This crate keeps the trees of all behaviours in one pool of fixed size
//! and decides what is reached, what is done and what is given up (Hasemann, "Plans").
//!
//! Rules, and what was decided where the paper is silent:
//! - All edges of a chosen production become components at once, *planned*; a component whose
//!   vertex is reached is *scheduled*. A vertex is reached when every edge into it is finished:
//!   parallel edges join.
//! - Decomposition is lazy: only a scheduled frame is decomposed, one frame a call, so that the
//!   caller bounds the steps of a tick.
//! - Of a frame's productions the most applicable one at or above the frame's threshold is taken,
//!   among equals the first. Applicability is asked of the caller.
//! - A finished component leaves the pool. A failed one takes all that hangs below its parent
//!   frame with it; the parent, one level of abstraction higher, chooses anew among the
//!   productions that it has not tried since it was planned. With none left it fails in turn, and
//!   at the root the plan has failed.
//! - Loops are tail recursion: a frame that is the last thing an equal frame above it waits for
//!   takes that one's place, unless a frame in between still has something to keep or bring about
//!   or a protection interval spans it. So a loop runs in constant memory, for ever if need be.
//! - A loop ends when no production is applicable any more: a frame that has restarted counts as
//!   finished then, where one that begins for the first time fails.
//!
//! Invariants: the components of one tree are always reachable from its root; no call panics or
//! loops longer than the pool is large.
//!
//! Deliberately absent: what conditions hold (see `monitor`), which behaviour runs (see
//! `behaviour`), and any search: the planner is opportunistic, neither complete nor sound in
//! general, as the paper says.
#![no_std]

mod forest;

pub use forest::{Choice, Ended, Forest};
pub use parts::{Component, Event, Id, Life, Owner};

#[cfg(test)]
mod tests;
