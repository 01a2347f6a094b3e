//! Capacities of the robot's interface.

/// Range readings in one tick's percepts.
pub const MAX_RANGES: usize = 16;
/// Longest distance of a range reading, metres; longer ones are garbled. The longest survey
/// scanners reach half of it.
pub const MOST_RANGE_M: f32 = 10_000.0;
/// Input channels in one tick's percepts.
pub const MAX_CHANNELS: usize = 8;
/// Mates that one robot can hear.
pub const MAX_MATES: usize = 4;
/// Robots of the largest team: a robot and its mates.
pub const MAX_ROBOTS: usize = MAX_MATES + 1;
/// Digital outputs in one tick's commands.
pub const MAX_OUTPUTS: usize = 16;
/// Bytes of the longest encoded percepts or commands.
pub const MAX_WIRE_BYTES: usize = 448;
/// Bytes from the GPS receiver in one record: 115,200 baud bring 576 per tick at 20 Hz.
pub const MAX_GPS_BYTES: usize = 576;
/// Bytes of a [`crate::SensorRecord`] on a pipe: the largest one, rounded up.
pub const SENSOR_RECORD_BYTES: usize = 928;
/// Bytes of a [`crate::CommandRecord`] on a pipe: the largest one, rounded up.
pub const COMMAND_RECORD_BYTES: usize = 64;
