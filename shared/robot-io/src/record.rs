//! Records: what a simulated or recorded world exchanges with a robot in lockstep, one pair
//! per tick. GPS arrives as the receiver's own bytes, so a simulation tests the drivers too.
//!
//! On a pipe a record is its postcard bytes, padded with zeros to a fixed size: one read and one
//! write per tick, and no state that could lose synchronisation.

use crate::limits::{
    COMMAND_RECORD_BYTES, MAX_CHANNELS, MAX_GPS_BYTES, MAX_MATES, MAX_RANGES, SENSOR_RECORD_BYTES,
};
use crate::{Checks, Commands, Heard, News, Operator, Pose, RangeReading, Receiver};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// What the world sends to the robot before a tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SensorRecord {
    /// Bytes from the GPS receiver since the last tick, UBX or NMEA.
    pub gps: Vec<u8, MAX_GPS_BYTES>,
    /// As in [`crate::Percepts`].
    pub heading_rad: Option<f32>,
    /// As in [`crate::Percepts`].
    pub speed_mps: Option<f32>,
    /// As in [`crate::Percepts`].
    pub turn_rate_radps: Option<f32>,
    /// The range finder's scan of this tick, empty if all is clear; `None` if no scan arrived. The
    /// robot keeps the last one with its time.
    pub ranges: Option<Vec<RangeReading, MAX_RANGES>>,
    /// As in [`crate::Percepts`].
    pub inputs: [Option<f32>; MAX_CHANNELS],
    /// Orders of the robot's own buttons.
    pub operator: Operator,
    /// Orders that arrived over the link since the last tick; `None` if none did. A robot that has
    /// never heard any obeys its buttons.
    pub radio: Option<Operator>,
    /// A pose that arrived since the last tick; its arrival counts, not its `time_us`.
    pub pose: Option<Pose>,
    /// What the robot's clock shows at this tick, microseconds, if it has a fault; `None` for a
    /// sound clock.
    pub clock_us: Option<u64>,
    /// News of mates that arrived since the last tick, at most one for each mate.
    pub heard: Vec<Heard, MAX_MATES>,
}

/// What the robot sends to the world after a tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommandRecord {
    /// The robot's clock at the tick, microseconds.
    pub time_us: u64,
    /// The result of the tick.
    pub commands: Commands,
    /// The trace hash after this tick.
    pub trace_hash: u64,
    /// Instructions of the tick; 0 if they are not counted.
    pub instructions: u32,
    /// State of the GPS receiver.
    pub receiver: Receiver,
    /// The checks before arming that fail in this tick.
    pub checks: Checks,
    /// What the robot tells its mates; `None` without a team.
    pub news: Option<News>,
    /// Of a plan with several goals, the number of the one that the robot approaches or has reached;
    /// `None` if it follows no such plan.
    pub goal: Option<u8>,
}

impl SensorRecord {
    /// The record's bytes on a pipe; never `None` for a record within its limits.
    pub fn to_bytes(&self) -> Option<[u8; SENSOR_RECORD_BYTES]> {
        padded(self)
    }

    /// The record from its bytes on a pipe; `None` if they are invalid.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        postcard::from_bytes(bytes).ok()
    }
}

impl CommandRecord {
    /// The record's bytes on a pipe; never `None` for a record within its limits.
    pub fn to_bytes(&self) -> Option<[u8; COMMAND_RECORD_BYTES]> {
        padded(self)
    }

    /// The record from its bytes on a pipe; `None` if they are invalid.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        postcard::from_bytes(bytes).ok()
    }
}

fn padded<T: Serialize, const N: usize>(value: &T) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    postcard::to_slice(value, &mut bytes).ok()?;
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Manual, Reason};
    use core::iter::repeat_n;

    #[test]
    fn the_largest_records_fit_and_come_back() {
        let reading = RangeReading { bearing_rad: -3.0, distance_m: 1e9 };
        let operator = Operator {
            is_armed: true,
            is_emergency_stop: true,
            manual: Some(Manual { speed_mps: 1.0, turn_rate_radps: 1.0 }),
        };
        let news = News { robot: u8::MAX, position_m: Some([1.0; 2]), signal: u16::MAX };
        let sensors = SensorRecord {
            gps: repeat_n(0xb5, MAX_GPS_BYTES).collect(),
            heading_rad: Some(1.0),
            speed_mps: Some(1.0),
            turn_rate_radps: Some(1.0),
            ranges: Some(repeat_n(reading, MAX_RANGES).collect()),
            inputs: [Some(1.0); MAX_CHANNELS],
            operator,
            radio: Some(operator),
            pose: Some(Pose {
                time_us: u64::MAX,
                position_m: [1.0; 2],
                heading_rad: Some(1.0),
                accuracy_mm: u32::MAX,
            }),
            clock_us: Some(u64::MAX),
            heard: repeat_n(Heard { news, quality: 1.0 }, MAX_MATES).collect(),
        };
        let bytes = sensors.to_bytes().unwrap();
        assert_eq!(SensorRecord::from_bytes(&bytes), Some(sensors));

        let commands = Commands {
            speed_mps: 1.0,
            turn_rate_radps: 1.0,
            outputs: u16::MAX,
            signal: u16::MAX,
            reason: Reason::Manual,
        };
        let record = CommandRecord {
            time_us: u64::MAX,
            commands,
            trace_hash: u64::MAX,
            instructions: u32::MAX,
            receiver: Receiver::Sound,
            checks: Checks::all(),
            news: Some(news),
            goal: Some(u8::MAX),
        };
        assert_eq!(CommandRecord::from_bytes(&record.to_bytes().unwrap()), Some(record));
        assert_eq!(CommandRecord::from_bytes(&[0xff; COMMAND_RECORD_BYTES]), None);
    }
}
