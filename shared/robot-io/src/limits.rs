//! Capacities of the robot's interface.

/// Range readings in one tick's percepts.
pub const MAX_RANGES: usize = 16;
/// Input channels in one tick's percepts.
pub const MAX_CHANNELS: usize = 8;
/// Digital outputs in one tick's commands.
pub const MAX_OUTPUTS: usize = 16;
/// Bytes of the longest encoded percepts or commands.
pub const MAX_WIRE_BYTES: usize = 256;
/// Bytes from the GPS receiver in one record: 115,200 baud bring 576 per tick at 20 Hz.
pub const MAX_GPS_BYTES: usize = 576;
/// Bytes of a [`crate::SensorRecord`] on a pipe: the largest one, rounded up.
pub const SENSOR_RECORD_BYTES: usize = 832;
/// Bytes of a [`crate::CommandRecord`] on a pipe: the largest one, rounded up.
pub const COMMAND_RECORD_BYTES: usize = 64;
