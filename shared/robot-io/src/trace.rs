//! The trace hash: one number that is equal for two runs only if all their ticks are equal.

use crate::limits::MAX_WIRE_BYTES;
use crate::{Commands, Percepts};
use serde::Serialize;

/// FNV-1a, 64 bits, over the wire bytes of all percepts and commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceHash(u64);

impl Default for TraceHash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl TraceHash {
    /// Adds one tick.
    pub fn record(&mut self, percepts: &Percepts, commands: &Commands) {
        self.value(percepts);
        self.value(commands);
    }

    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash so far.
    pub fn get(self) -> u64 {
        self.0
    }

    fn value<T: Serialize>(&mut self, value: &T) {
        let mut buffer = [0; MAX_WIRE_BYTES];
        // The largest percepts fit; the test below proves it.
        if let Ok(bytes) = postcard::to_slice(value, &mut buffer) {
            self.bytes(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fix, Heard, Manual, Mate, News, Operator, Pose, RangeReading, Receiver};
    use math::GeoPoint;

    #[test]
    fn the_largest_percepts_fit_the_wire_buffer() {
        let reading = RangeReading { bearing_rad: -3.0, distance_m: 1e9 };
        let news = News { robot: u8::MAX, position_m: Some([1.0; 2]), signal: u16::MAX };
        let mate = Mate { time_us: u64::MAX, heard: Heard { news, quality: 1.0 } };
        let percepts = Percepts {
            time_us: u64::MAX,
            fix: Some(Fix {
                time_us: u64::MAX,
                is_valid: true,
                place: GeoPoint { lat_e7: i32::MIN, lon_e7: i32::MIN },
                accuracy_mm: u32::MAX,
                velocity_mmps: Some([i32::MIN; 2]),
                receiver_ms: Some(u32::MAX),
            }),
            receiver: Receiver::Sound,
            scan_us: Some(u64::MAX),
            garbled_ranges: u8::MAX,
            pose: Some(Pose {
                time_us: u64::MAX,
                position_m: [1.0; 2],
                heading_rad: Some(1.0),
                accuracy_mm: u32::MAX,
            }),
            is_link_lost: true,
            mates: core::iter::repeat_n(mate, crate::limits::MAX_MATES).collect(),
            heading_rad: Some(1.0),
            speed_mps: Some(1.0),
            turn_rate_radps: Some(1.0),
            ranges: core::iter::repeat_n(reading, crate::limits::MAX_RANGES).collect(),
            inputs: [Some(1.0); crate::limits::MAX_CHANNELS],
            operator: Operator {
                is_armed: true,
                is_emergency_stop: true,
                manual: Some(Manual { speed_mps: 1.0, turn_rate_radps: 1.0 }),
            },
        };
        let mut buffer = [0; MAX_WIRE_BYTES];
        assert!(postcard::to_slice(&percepts, &mut buffer).is_ok());
    }

    #[test]
    fn the_hash_is_fnv_1a() {
        let mut hash = TraceHash::default();
        hash.bytes(b"foobar");
        assert_eq!(hash.get(), 0x8594_4171_f739_67e8);
    }
}
