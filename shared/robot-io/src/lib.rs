//! What crosses the robot's skin: percepts in, commands out, and their bytes on a wire.
//!
//! Every value here is plain data that can be recorded, hashed and replayed. No NaN or
//! infinity is ever part of a percept or a command: [`Percepts::sanitised`] drops what is
//! not finite before a tick sees it.
//!
//! Deliberately absent: clocks, drivers, allocation.
#![no_std]

pub mod commands;
pub mod limits;
pub mod packet;
pub mod percepts;
pub mod receiver;
pub mod record;
pub mod trace;

pub use commands::{Commands, Reason};
pub use percepts::{Fix, Manual, Operator, Percepts, RangeReading};
pub use receiver::Receiver;
pub use record::{CommandRecord, SensorRecord};
pub use trace::TraceHash;
