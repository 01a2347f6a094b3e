//! Boots the QEMU guest and exchanges records with it in lockstep.
//!
//! The crate installs missing tools ([`setup`]), starts QEMU ([`machine`]) and connects a simulation
//! to the robot in the guest ([`QemuPilot`]). The commands `demo`, `mission`, `instructions`,
//! `fault-table`, `drive-bench` and `experiment` use it, and so do the QEMU tests.
//!
//! Invariants: a guest never outlives its owner; a panic, a fault or a hang of the guest becomes an
//! error with the guest's console output within [`machine::PATIENCE`]; only [`setup`] downloads or
//! installs anything.
//!
//! Deliberately absent: the simulation itself (see `sim`), and Windows: the guest uses Unix pipes.

pub mod counts;
pub mod drive_bench;
pub mod experiment;
pub mod fault_table;
pub mod machine;
pub mod mission;
pub mod picture;
pub mod pilot;
pub mod setup;
pub mod shards;
pub mod shell;

pub use machine::{Build, Machine};
pub use pilot::{QemuPilot, Report};
