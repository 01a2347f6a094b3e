//! What the robot perceives at one tick.

use crate::limits::{MAX_CHANNELS, MAX_RANGES};
use crate::receiver::Receiver;
use heapless::Vec;
use math::{GeoPoint, scalar};
use serde::{Deserialize, Serialize};

/// Everything that one tick may use. Time is a percept like any other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percepts {
    /// Microseconds since start; never decrease.
    pub time_us: u64,
    /// The latest fix, new or not; `None` before the first.
    pub fix: Option<Fix>,
    /// Heading from a compass or IMU, radians counter-clockwise from true east.
    pub heading_rad: Option<f32>,
    /// Speed ahead from odometry, m/s; negative astern.
    pub speed_mps: Option<f32>,
    /// Turn rate from a gyroscope, rad/s counter-clockwise.
    pub turn_rate_radps: Option<f32>,
    /// Obstacles around the robot, in any order.
    pub ranges: Vec<RangeReading, MAX_RANGES>,
    /// Input channels of the mission's rules, each in the unit of its universe. The first are
    /// battery, fuel and link, see [`channel`].
    pub inputs: [Option<f32>; MAX_CHANNELS],
    /// The operator's orders.
    pub operator: Operator,
    /// State of the GPS receiver.
    pub receiver: Receiver,
}

/// Numbers of the input channels.
pub mod channel {
    /// Charge of the battery.
    pub const BATTERY: u8 = 0;
    /// Fuel left.
    pub const FUEL: u8 = 1;
    /// Strength of the radio link.
    pub const LINK: u8 = 2;
    /// First channel with a meaning that the mission defines.
    pub const CUSTOM: u8 = 3;
}

/// One solution of the GPS receiver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fix {
    /// Arrival of the fix's last byte, on the clock of [`Percepts::time_us`].
    pub time_us: u64,
    /// Whether the receiver reports the fix as measured: not estimated, entered by hand or
    /// simulated. NAV-PVT: gnssFixOK, fix type 2 to 4, position not invalid. NMEA: quality 1 to
    /// 5 or 9, and only valid RMC.
    pub is_valid: bool,
    /// Position on the globe.
    pub place: GeoPoint,
    /// Horizontal accuracy, millimetres (NMEA: estimated from the HDOP).
    pub accuracy_mm: u32,
    /// Velocity east and north, mm/s, if the receiver reports it.
    pub velocity_mmps: Option<[i32; 2]>,
}

/// The nearest obstacle in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RangeReading {
    /// Direction, radians counter-clockwise from straight ahead.
    pub bearing_rad: f32,
    /// Distance from the robot's centre to the obstacle's surface, metres.
    pub distance_m: f32,
}

/// The operator's orders; they outrank everything else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Operator {
    /// The robot may move.
    pub is_armed: bool,
    /// The robot must stand still, whatever else applies.
    pub is_emergency_stop: bool,
    /// Commands of manual driving; `None` for autonomous driving.
    pub manual: Option<Manual>,
}

/// A manual command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manual {
    /// Speed ahead, m/s.
    pub speed_mps: f32,
    /// Turn rate, rad/s counter-clockwise.
    pub turn_rate_radps: f32,
}

impl Percepts {
    /// A copy without values that are not finite: such a reading becomes `None`, such a range
    /// reading is removed, such a manual command becomes 0. Angles are wrapped.
    #[must_use]
    pub fn sanitised(&self) -> Self {
        let finite = |x: Option<f32>| x.filter(|x| x.is_finite());
        let mut ranges = Vec::new();
        for range in &self.ranges {
            if range.bearing_rad.is_finite() && range.distance_m.is_finite() {
                // Never full: both vectors have the same capacity.
                let _ = ranges.push(RangeReading {
                    bearing_rad: scalar::wrap_angle(range.bearing_rad),
                    distance_m: range.distance_m,
                });
            }
        }
        let or_zero = |x: f32| if x.is_finite() { x } else { 0.0 };
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
                    speed_mps: or_zero(manual.speed_mps),
                    turn_rate_radps: or_zero(manual.turn_rate_radps),
                }),
                ..self.operator
            },
            receiver: self.receiver,
        }
    }
}
