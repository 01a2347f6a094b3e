//! Simulated robots in a simulated world.
//!
//! The crate models the truth: where the obstacles are ([`World`]), how a body moves and what it
//! touches ([`Body`]), what moves ([`Disc`]), what its work changes ([`Surroundings`]), what the
//! sensors report ([`Sensors`]) and which faults corrupt the reports ([`Faulty`]) or the motion
//! ([`Actuators`]). It never decides what a robot does: its [`Pilot`] does. A pilot gets one record
//! of sensor bytes and answers with one record of commands, so the same code simulates a robot in
//! this process and a robot in QEMU.
//!
//! A [`Scenario`] holds what a robot knows (map and plans), the true world and the [`Conditions`]; a
//! [`Difference`] makes a true world that differs from the map, and a [`WorldFile`] describes all
//! of that as text. A [`Simulation`] runs [`Robot`]s in a true world. An [`Outcome`] is the result
//! of one robot's run. A mission is what a robot is to do, as a file or in the blob.
//!
//! Invariants: everything random is drawn from one seed, and the same seed gives the same bytes on
//! every machine (all functions come from `math`, all random numbers from ChaCha8); time is counted
//! in whole ticks and never read from a clock; the order of the robots does not matter; a body that
//! is clear of obstacles and other bodies never ends a step inside one.
//!
//! Deliberately absent: clocks, threads, drawing (except one small text picture), dynamics of
//! wheels and slopes, obstacles that react, waves: what the air carries is a rule over the map.

pub mod body;
pub mod conditions;
pub mod coverage;
pub mod difference;
pub mod disc;
pub mod faults;
pub mod geometry;
pub mod network;
pub mod outcome;
pub mod picture;
pub mod pilot;
pub mod placement;
pub mod radio;
pub mod random;
pub mod receiver;
pub mod robot;
pub mod scenario;
pub mod sensors;
pub mod sighting;
pub mod simulation;
pub mod surroundings;
pub mod world;
pub mod world_file;

pub use body::{Body, Chassis, StepResult};
pub use conditions::Conditions;
pub use coverage::{Coverage, Ground};
pub use difference::{Difference, Missing, Worlds};
pub use disc::{Disc, Repeat};
pub use faults::{Actuators, Channel, Fault, Faulty, PlannedFault};
pub use geometry::{Circle, Point};
pub use network::{Connection, Links};
pub use outcome::{Ending, Limits, Outcome};
pub use pilot::{HostPilot, Pilot, PilotError, Recorder};
pub use placement::Placement;
pub use radio::{Air, Radio, RadioSettings};
pub use random::{Random, Stream};
pub use receiver::{Dialect, Mode, Receiver, ReceiverSettings};
pub use robot::Robot;
pub use scenario::{Scenario, Start};
pub use sensors::{PoseSettings, RingSettings, Scene, SensorSettings, SensorSuite, Sensors};
pub use simulation::Simulation;
pub use surroundings::Surroundings;
pub use world::{Nearest, World};
pub use world_file::WorldFile;

/// Length of a tick, microseconds.
pub const TICK_US: u64 = 50_000;
