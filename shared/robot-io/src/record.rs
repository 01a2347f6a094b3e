//! Records: what a simulated or recorded world exchanges with a robot in lockstep, one
//! pair a tick. GPS arrives as the receiver's own bytes, so the drivers are part of the test.

use crate::limits::{MAX_GPS_BYTES, MAX_RANGES};
use crate::{Commands, Operator, RangeReading};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// What the world tells the robot before a tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SensorRecord {
    /// Bytes that arrived from the GPS receiver since the last tick, UBX or NMEA.
    pub gps: Vec<u8, MAX_GPS_BYTES>,
    /// As in [`crate::Percepts`].
    pub heading_rad: Option<f32>,
    /// As in [`crate::Percepts`].
    pub speed_mps: Option<f32>,
    /// As in [`crate::Percepts`].
    pub turn_rate_radps: Option<f32>,
    /// As in [`crate::Percepts`].
    pub ranges: Vec<RangeReading, MAX_RANGES>,
    /// As in [`crate::Percepts`].
    pub operator: Operator,
}

/// What the robot answers after a tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommandRecord {
    /// The robot's clock at the tick, microseconds.
    pub time_us: u64,
    /// The result of the tick.
    pub commands: Commands,
    /// The trace hash after this tick.
    pub trace_hash: u64,
    /// Instructions that the tick took, where that can be counted; else 0.
    pub instructions: u32,
}
