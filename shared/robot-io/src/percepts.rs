//! What the robot knows at one tick.

use crate::limits::{MAX_CHANNELS, MAX_RANGES};
use crate::receiver::Receiver;
use heapless::Vec;
use math::{GeoPoint, scalar};
use serde::{Deserialize, Serialize};

/// Everything that one tick may use. Time is a percept like any other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percepts {
    /// Microseconds since start; never decreases.
    pub time_us: u64,
    /// The latest solution of the GPS receiver, new or not; `None` before the first.
    pub fix: Option<Fix>,
    /// Heading from a compass or IMU, radians counter-clockwise from true east.
    pub heading_rad: Option<f32>,
    /// Speed ahead from odometry, m/s; negative astern.
    pub speed_mps: Option<f32>,
    /// Turn rate from a gyroscope, rad/s counter-clockwise.
    pub turn_rate_radps: Option<f32>,
    /// Obstacles around the robot, in any order.
    pub ranges: Vec<RangeReading, MAX_RANGES>,
    /// Input channels of the mission's rules: battery, fuel and link first, see [`channel`], each
    /// in the unit of its universe.
    pub inputs: [Option<f32>; MAX_CHANNELS],
    /// What the human in charge says.
    pub operator: Operator,
    /// What the bytes of the GPS receiver add up to.
    pub receiver: Receiver,
}

/// Which input channel carries what.
pub mod channel {
    /// Charge of the battery.
    pub const BATTERY: u8 = 0;
    /// Fuel left.
    pub const FUEL: u8 = 1;
    /// Strength of the radio link.
    pub const LINK: u8 = 2;
    /// The first of those that a mission gives its own meaning.
    pub const CUSTOM: u8 = 3;
}

/// One solution of the GPS receiver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fix {
    /// When its last byte arrived, on the clock of [`Percepts::time_us`].
    pub time_us: u64,
    /// Whether the receiver vouches for it as measured: not estimated, set by hand or simulated
    /// (NAV-PVT: gnssFixOK, fix type 2 to 4, position not invalid; NMEA: quality 1 to 5 or 9,
    /// and no RMC that says anything but valid).
    pub is_valid: bool,
    /// Where.
    pub place: GeoPoint,
    /// Horizontal accuracy, millimetres (NMEA: estimated from the HDOP).
    pub accuracy_mm: u32,
    /// Velocity east and north, mm/s, if the receiver reports it.
    pub velocity_mmps: Option<[i32; 2]>,
}

/// The nearest obstacle in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RangeReading {
    /// Radians counter-clockwise from straight ahead.
    pub bearing_rad: f32,
    /// From the robot's centre to the obstacle's surface, metres.
    pub distance_m: f32,
}

/// What the human in charge says; outranks everything else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Operator {
    /// The robot may move at all.
    pub is_armed: bool,
    /// Stand still, whatever else is said.
    pub is_emergency_stop: bool,
    /// Drive by hand.
    pub manual: Option<Manual>,
}

/// A manual command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manual {
    /// m/s ahead.
    pub speed_mps: f32,
    /// rad/s counter-clockwise.
    pub turn_rate_radps: f32,
}

impl Percepts {
    /// The same without anything that is not finite: such a reading is no reading, such a
    /// range reading is dropped, such a manual command means stand still. Angles are wrapped.
    #[must_use]
    pub fn sanitised(&self) -> Self {
        let finite = |x: Option<f32>| x.filter(|x| x.is_finite());
        let mut ranges = Vec::new();
        for range in &self.ranges {
            if range.bearing_rad.is_finite() && range.distance_m.is_finite() {
                // Cannot be full: both vectors have the same capacity.
                let _ = ranges.push(RangeReading {
                    bearing_rad: scalar::wrap_angle(range.bearing_rad),
                    distance_m: range.distance_m,
                });
            }
        }
        let or_still = |x: f32| if x.is_finite() { x } else { 0.0 };
        Self {
            time_us: self.time_us,
            fix: self.fix,
            heading_rad: finite(self.heading_rad).map(scalar::wrap_angle),
            speed_mps: finite(self.speed_mps),
            turn_rate_radps: finite(self.turn_rate_radps),
            ranges,
            inputs: self.inputs.map(finite),
            operator: Operator {
                manual: self.operator.manual.map(|manual| Manual {
                    speed_mps: or_still(manual.speed_mps),
                    turn_rate_radps: or_still(manual.turn_rate_radps),
                }),
                ..self.operator
            },
            receiver: self.receiver,
        }
    }
}
