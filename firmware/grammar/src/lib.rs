//! Live plans: plan frames decomposed by edge-replacement grammars, one step at a time.
//!
//! A behaviour's plan is a tree of components. A plan frame is replaced by one of its productions:
//! a graph from one entry to one exit, with a component on each edge. An atomic action runs. This
//! crate keeps the trees of all behaviours in one pool, the [`Forest`], and decides which
//! components are due, finished or given up.
//!
//! ```
//! use grammar::{Choice, Ended, Forest};
//! use plan_format::mission::Mission;
//!
//! let text = "
//!     input time; of time
//!     action drive hold 0
//!     frame patrol
//!     = drive
//!     behaviour all patrol; when always PS
//! ";
//! let bytes = fixtures::mission(text).write().unwrap();
//! let mission = Mission::parse(&bytes).unwrap();
//! let (mut forest, mut events) = (Forest::default(), 0);
//! let mut tell = |_: &_, _: &_| events += 1;
//! // Behaviour 0 starts with plan frame 0, which is decomposed into its only production.
//! let root = forest.plant(0, 0, &mut tell).unwrap();
//! let (root, choice) = forest.decompose(&mission, root, &mut |_, _| 1.0, &mut tell);
//! assert_eq!(choice, Choice::Production(0));
//! // The action runs and finishes, which completes the plan frame.
//! let action = forest.scheduled(0).unwrap();
//! forest.start(action, &mut tell);
//! assert_eq!(forest.finish(&mission, action, &mut tell), Ended::Completes(root));
//! assert_eq!(forest.finish(&mission, root, &mut tell), Ended::RootFinished);
//! assert!(forest.is_empty() && events > 0);
//! ```
//!
//! Rules, some decided here because the paper leaves them open:
//! - All edges of a chosen production become *planned* components at once. A component is
//!   *scheduled* when its start vertex is reached. A vertex is reached when every edge into it is
//!   finished, so parallel edges join there.
//! - Decomposition is lazy: only scheduled frames are decomposed, one per call, so the caller
//!   bounds the steps of a tick.
//! - A frame takes its most applicable production, if that reaches the frame's threshold; of equal
//!   ones, the first. The caller supplies the applicabilities.
//! - A finished component leaves the pool. When a component fails, everything below its parent
//!   frame is abandoned, and the parent chooses again among the productions that it has not tried
//!   since it was planned. If none is left, the parent fails in turn; when the root fails, the plan
//!   has failed.
//! - Loops are tail recursion. If a frame is the last component that an equal frame above waits
//!   for, the upper frame restarts in its place, unless a protection interval spans the edge. So a
//!   loop can run indefinitely in constant memory.
//! - A frame in between that has something to check, or effects, stays in the plan: the inner frame
//!   restarts only if it is below an equal one already. So in a loop `a`, `b`, `a`, `b` in which `b`
//!   limits the speed, the plan grows to `a`, `b`, `a` and stays at that.
//! - A loop ends when no production is applicable in a further round: its frame is then finished,
//!   whereas a frame in its first round fails.
//!
//! Invariants: every component is reachable from the root of its tree. No call panics, and the
//! pool's size bounds every loop.
//!
//! Source: Hasemann, "Plans".
//!
//! Deliberately absent: the conditions of components (see `monitor`), the choice of a behaviour
//! (see `behaviour`), and search: the planner is opportunistic, neither complete nor sound in
//! general, as in the paper.
#![no_std]

mod forest;

pub use forest::{Choice, Ended, Forest, Tell};
pub use parts::{Component, Event, Id, Life, Owner, Pool};

#[cfg(test)]
mod tests;
