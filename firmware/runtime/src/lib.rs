//! The shell: everything between the pure controller and the hardware.
//!
//! The controller decides; this crate brings it percepts and carries its commands away. It
//! holds the tasks that every robot runs, be it a board, the QEMU guest or a test on a host:
//!
//! | task | does |
//! |---|---|
//! | [`control_task`] | at each tick: wait, sense, decide, act |
//! | [`gps_task`] | receiver bytes, UBX and NMEA mixed, into the [`FixSlot`] |
//! | [`operator_task`], [`telemetry_task`] | frames of the radio link |
//!
//! A board implements [`Robot`] and spawns these tasks, which share [`Slots`]. What the operator
//! asked for ([`operator`]), the protocol that carries it ([`link`]) and what silence means
//! ([`silence`]) are apart. [`lockstep`] is a robot that lives on records instead of hardware, so
//! that a simulated world drives exactly this code. An [`Observer`] watches the ticks.
//!
//! Invariants: a tick never waits for a receiver or a radio; the newest value wins
//! everywhere and nothing queues; bytes from outside never cause a panic; a blob that does
//! not validate is never driven by. `unsafe` is used once, to read the plan region.
//!
//! Deliberately absent: drivers of any chip (see `boards/`), decisions about motion (see
//! `controller`), allocation.
#![no_std]

#[macro_use]
mod log;

pub mod blob;
pub mod control;
pub mod drive;
pub mod gps;
pub mod link;
pub mod lockstep;
pub mod operator;
pub mod silence;
#[cfg(target_os = "none")]
pub mod time;

#[cfg(target_os = "none")]
pub use blob::plan_region;
pub use blob::{Fallback, Loaded, load, load_paced};
pub use control::{Observer, Robot, Slots, TICK_PERIOD_US, control_task};
pub use gps::{FixSlot, gps_task};
pub use link::{Telemetry, operator_task, telemetry_task};
pub use operator::OperatorSlot;
