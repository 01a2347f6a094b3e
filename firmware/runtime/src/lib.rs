//! The shell: everything between the pure controller and the hardware.
//!
//! The controller decides how to drive. This crate decides which blob to load, which fix, which
//! operator's orders and which telemetry are the newest, and when to feed the watchdog. Every
//! robot runs its tasks: a board, the QEMU guest, or a test on a host.
//!
//! | task | what it does |
//! |---|---|
//! | [`control_task`] | at each tick: wait, sense, decide, act |
//! | [`gps_task`] | decodes the receiver's bytes, UBX and NMEA mixed, into the [`FixSlot`] |
//! | [`operator_task`], [`telemetry_task`] | receive and send the packets of the link |
//!
//! A board implements [`Robot`] and spawns these tasks, which share [`Slots`]. [`link`] has the
//! protocol of the link, [`operator`] the operator's latest orders, [`silence`] what link loss does
//! to them, [`pose`] the latest pose that arrived over it, and [`mates`] the latest news of each
//! mate. [`lockstep`] is a robot that runs on records instead of hardware, so a simulation runs
//! exactly this code. An [`Observer`] watches the ticks.
//!
//! ```
//! use plan_format::{Blob, Parameters};
//! use robot_io::{Reason, SensorRecord};
//! use runtime::lockstep::{Mailbox, run};
//! // One tick of a robot without a blob and without sensors.
//! let blob = Blob::without_map(Parameters::default(), None, None);
//! let mailbox = Mailbox::default();
//! let mut robot = core::pin::pin!(run(blob, &mailbox, &mailbox));
//! let answer = mailbox.step(robot.as_mut(), SensorRecord::default()).unwrap();
//! assert_eq!(answer.commands.reason, Reason::Disarmed);
//! ```
//!
//! Invariants: a tick never waits for a receiver or a radio; the newest value replaces older ones
//! and nothing queues; bytes from outside never cause a panic; the robot never drives by a blob
//! that does not validate. `unsafe` occurs once, to read the plan region.
//!
//! Source: the u-blox protocol specification for UBX; NMEA 0183, versions 2.1 to 4.11.
//!
//! Deliberately absent: drivers of chips (see `boards/`), decisions about driving (see
//! `controller`), allocation.
#![no_std]

#[macro_use]
mod log;

pub mod blob;
pub mod control;
pub mod gps;
pub mod link;
pub mod lockstep;
pub mod mates;
pub mod mixer;
pub mod operator;
pub mod pose;
pub mod silence;
pub mod slots;
#[cfg(target_os = "none")]
pub mod time;

#[cfg(target_os = "none")]
pub use blob::plan_region;
pub use blob::{Fallback, Loaded, load, load_paced};
pub use control::{Observer, Robot, TICK_PERIOD_US, control_task};
pub use gps::{FixSlot, gps_task};
pub use link::{operator_task, telemetry_task};
pub use operator::{ArmButton, Authority, OperatorSlot, RadioOrders};
pub use pose::PoseSlot;
pub use slots::{Slots, Telemetry};
