//! Capacities of the robot's skin.

/// Range readings in one percept.
pub const MAX_RANGES: usize = 16;
/// Input channels in one percept.
pub const MAX_CHANNELS: usize = 8;
/// Digital outputs in one command.
pub const MAX_OUTPUTS: usize = 16;
/// Bytes of the longest encoded percept or command.
pub const MAX_WIRE_BYTES: usize = 256;
/// Bytes from the GPS receiver in one record: at 20 ticks a second, 115,200 baud bring 576.
pub const MAX_GPS_BYTES: usize = 576;
/// Bytes of a [`crate::SensorRecord`] on a pipe: the largest one, rounded up.
pub const SENSOR_RECORD_BYTES: usize = 832;
/// Bytes of a [`crate::CommandRecord`] on a pipe: the largest one, rounded up.
pub const COMMAND_RECORD_BYTES: usize = 64;
