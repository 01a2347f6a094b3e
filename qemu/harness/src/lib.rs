//! Boots the QEMU guest and feeds it in lockstep.
//!
//! It decides how to get what a machine lacks ([`setup`]), how QEMU is started ([`machine`])
//! and how a simulated world talks to the robot inside ([`QemuPilot`]). The commands `demo`,
//! `mission` and `instructions` stand on it, and so do the QEMU tests.
//!
//! Invariants: a guest never outlives its owner; whatever goes wrong in it (a panic, a fault,
//! a hang) is an error with what the guest said last, within [`machine::PATIENCE`]; nothing
//! is downloaded or installed but by [`setup`].
//!
//! Deliberately absent: what a mission is (see `sim`), and Windows: the guest's pipes are
//! those of Unix.

pub mod counts;
pub mod machine;
pub mod mission;
pub mod picture;
pub mod pilot;
pub mod setup;

pub use machine::{Build, Machine};
pub use pilot::{QemuPilot, Report};
