//! A simulated world: what a robot drives through, with and in, when there is no robot.
//!
//! It decides what is true: where the obstacles are ([`World`]), how the body moves and what
//! it touches ([`Body`]), what its work changes ([`Surroundings`]), what the sensors report of
//! that ([`Sensors`]) and what goes wrong on the way ([`Faulty`]). It never decides what the robot does: that is asked of a
//! [`Pilot`], one record of sensor bytes against one record of commands, so that the robot
//! in this process and the robot in QEMU are driven by the same code.
//!
//! Invariants: everything is drawn from one seed, and the same seed gives the same bytes on
//! every machine (all functions come from `math`, all chances from ChaCha8); time is counted
//! in whole ticks and never read from a clock; a body that is clear of obstacles never ends a
//! step inside one.
//!
//! Deliberately absent: clocks, threads, drawing (but for one small text picture), dynamics
//! of wheels and slopes, moving obstacles.

pub mod body;
pub mod faults;
pub mod mission;
pub mod picture;
pub mod pilot;
pub mod random;
pub mod receiver;
pub mod sensors;
pub mod surroundings;
pub mod world;

pub use body::{Body, Chassis, Motion};
pub use faults::{Channel, Fault, Faulty};
pub use mission::{Ending, Limits, Outcome, Run};
pub use pilot::{HostPilot, Pilot, PilotError};
pub use random::{Random, Stream};
pub use receiver::{Dialect, Mode, Receiver, ReceiverSettings};
pub use sensors::{RingSettings, Scene, SensorSettings, SensorSuite, Sensors};
pub use surroundings::Surroundings;
pub use world::{Nearest, World};

/// A point or displacement of the map, metres, x east, y north.
pub type Point = [f64; 2];
