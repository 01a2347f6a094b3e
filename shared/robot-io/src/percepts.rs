//! What the robot perceives at one tick.

use crate::limits::{MAX_CHANNELS, MAX_MATES, MAX_RANGES, MOST_RANGE_M};
use crate::mates::Mate;
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
    /// Obstacles of the range finder's last complete scan, in any order. A direction without a
    /// reading is clear.
    pub ranges: Vec<RangeReading, MAX_RANGES>,
    /// Input channels of the mission's rules, each in the unit of its universe. The first are
    /// battery, fuel and link, see [`channel`].
    pub inputs: [Option<f32>; MAX_CHANNELS],
    /// The operator's orders.
    pub operator: Operator,
    /// State of the GPS receiver.
    pub receiver: Receiver,
    /// When the range finder last reported a complete scan. An empty scan is a report too: all is
    /// clear. `None` before the first scan, and on a robot without a range finder.
    pub scan_us: Option<u64>,
    /// Readings of the last scan that were impossible and are not in `ranges`, see
    /// [`Percepts::sanitised`].
    pub garbled_ranges: u8,
    /// The latest pose from another source than the GPS receiver, new or not; `None` before the
    /// first.
    pub pose: Option<Pose>,
    /// The link is silent, and that disarmed the robot.
    pub is_link_lost: bool,
    /// The latest news of each mate that was ever heard, one for each, in any order.
    pub mates: Vec<Mate, MAX_MATES>,
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
    /// The receiver's own time of the solution, milliseconds. Only its changes count, because its
    /// start differs: NAV-PVT counts from the start of the week, NMEA from midnight. A receiver
    /// that repeats one solution repeats this too.
    pub receiver_ms: Option<u32>,
}

/// Position and heading from another source than the GPS receiver: ultra-wideband beacons, motion
/// capture, visual odometry. In the map's own metres, so it needs no place on the globe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Arrival of the pose, on the clock of [`Percepts::time_us`].
    pub time_us: u64,
    /// Position, map metres.
    pub position_m: [f32; 2],
    /// Heading, radians counter-clockwise from the map's x axis; `None` if it is not measured.
    pub heading_rad: Option<f32>,
    /// Accuracy of the position, one standard deviation, millimetres.
    pub accuracy_mm: u32,
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
    /// A copy without values that are not finite: such a reading becomes `None`, such a manual
    /// command becomes 0. Angles are wrapped.
    ///
    /// Impossible range readings are removed and counted as garbled: a bearing or distance that is
    /// not finite, a negative distance, one beyond [`MOST_RANGE_M`]. Only positive infinity is not
    /// garbled: many drivers report it where nothing is within range.
    #[must_use]
    pub fn sanitised(&self) -> Self {
        let finite = |x: Option<f32>| x.filter(|x| x.is_finite());
        let mut ranges = Vec::new();
        let mut garbled_ranges = self.garbled_ranges;
        for range in &self.ranges {
            let is_clear = range.distance_m == f32::INFINITY;
            if range.bearing_rad.is_finite() && (0.0..=MOST_RANGE_M).contains(&range.distance_m) {
                // Never full: both vectors have the same capacity.
                let _ = ranges.push(RangeReading {
                    bearing_rad: scalar::wrap_angle(range.bearing_rad),
                    distance_m: range.distance_m,
                });
            } else if !(range.bearing_rad.is_finite() && is_clear) {
                garbled_ranges = garbled_ranges.saturating_add(1);
            }
        }
        let mut mates = Vec::new();
        for mate in self.mates.iter().filter_map(|mate| mate.sanitised()) {
            // Never full: both vectors have the same capacity.
            let _ = mates.push(mate);
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
            scan_us: self.scan_us,
            garbled_ranges,
            pose: self.pose.and_then(Pose::sanitised),
            is_link_lost: self.is_link_lost,
            mates,
        }
    }
}

impl Pose {
    /// The pose without a heading that is not finite; `None` if the position is not finite.
    fn sanitised(self) -> Option<Self> {
        let heading = self.heading_rad.filter(|heading| heading.is_finite());
        let is_somewhere = self.position_m.iter().all(|metres| metres.is_finite());
        is_somewhere.then_some(Self { heading_rad: heading.map(scalar::wrap_angle), ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_readings_are_removed_and_counted_once() {
        let table = [
            // bearing, distance, kept, garbled
            (0.0, 1.0, 1, 0),
            (0.0, 0.0, 1, 0),
            (0.0, f32::INFINITY, 0, 0),
            (0.0, f32::NEG_INFINITY, 0, 1),
            (0.0, f32::NAN, 0, 1),
            (0.0, -0.01, 0, 1),
            (0.0, 1e30, 0, 1),
            (f32::NAN, 1.0, 0, 1),
            (f32::INFINITY, f32::INFINITY, 0, 1),
        ];
        for (bearing_rad, distance_m, kept, garbled) in table {
            let reading = RangeReading { bearing_rad, distance_m };
            let percepts =
                Percepts { ranges: [reading].into_iter().collect(), ..Percepts::default() };
            let clean = percepts.sanitised();
            let case = (bearing_rad, distance_m);
            assert_eq!((clean.ranges.len(), clean.garbled_ranges), (kept, garbled), "{case:?}");
            assert_eq!(clean.sanitised(), clean, "{case:?}");
        }
    }

    #[test]
    fn a_pose_needs_a_finite_position_and_not_a_heading() {
        let pose = |x, heading| Percepts {
            pose: Some(Pose {
                time_us: 1,
                position_m: [x, 2.0],
                heading_rad: Some(heading),
                accuracy_mm: 10,
            }),
            ..Percepts::default()
        };
        assert_eq!(pose(f32::NAN, 0.0).sanitised().pose, None);
        let without = pose(1.0, f32::NAN).sanitised().pose.unwrap();
        assert_eq!((without.position_m, without.heading_rad), ([1.0, 2.0], None));
    }
}
