//! The robot's interface: percepts in, commands out, and their bytes on a wire.
//!
//! Decides what a tick may use ([`Percepts`]), what it returns ([`Commands`]), how both cross the
//! link ([`packet`]) and lockstep's transport ([`record`]), and how to compare two runs
//! ([`TraceHash`]).
//!
//! ```
//! use robot_io::packet::{Decoder, Uplink, encode};
//! use robot_io::Operator;
//! let arm = Uplink::Operator(Operator { is_armed: true, ..Operator::default() });
//! let packet = encode(&arm).unwrap();
//! let mut decoder = Decoder::default();
//! let received: Option<Uplink> = packet.iter().find_map(|&byte| decoder.push(byte));
//! assert_eq!(received, Some(arm));
//! ```
//!
//! Invariants: every value is plain data to record, hash and replay. The tick never sees NaN or
//! infinity: [`Percepts::sanitised`] removes both. Codes in the wire format never change; new
//! ones are appended.
//!
//! Source: the packets' stuffing is COBS (Cheshire and Baker 1999), the hash FNV-1a.
//!
//! Deliberately absent: clocks, drivers, allocation.
#![no_std]

pub mod checks;
pub mod commands;
pub mod limits;
pub mod mates;
pub mod packet;
pub mod percepts;
pub mod receiver;
pub mod record;
pub mod trace;

pub use checks::Checks;
pub use commands::{Commands, Reason};
pub use mates::{Heard, Mate, News};
pub use percepts::{Fix, Manual, Operator, Percepts, Pose, RangeReading};
pub use receiver::Receiver;
pub use record::{CommandRecord, SensorRecord};
pub use trace::TraceHash;
