//! The conditions of a simulated run: sensors, wheels and body that differ from the usual ones,
//! moving discs and faults.
//!
//! A world file sets them (`plan-compiler/WORLD.md`), or a program that builds a scenario.

use crate::sensors::PoseSettings;
use crate::{Channel, Chassis, Disc, PlannedFault, ReceiverSettings, RingSettings, SensorSettings};

/// What differs from the usual conditions; by default nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conditions {
    /// The GPS receiver.
    pub gps: GpsChanges,
    /// The compass.
    pub compass: CompassChanges,
    /// The range finder.
    pub ranges: RangeChanges,
    /// A source of poses beside the receiver, if the robot has one.
    pub pose: Option<PoseSettings>,
    /// Turn rate that unequal wheels add while they roll, rad/s counter-clockwise.
    pub unequal_radps: f64,
    /// Share of the wheels' motion that is lost to slip, 0 to 1.
    pub slip: f64,
    /// Acceleration of the body, m/s^2.
    pub acceleration_mps2: Option<f64>,
    /// Change of the body's turn rate, rad/s^2.
    pub turn_acceleration_radps2: Option<f64>,
    /// Moving discs.
    pub discs: Vec<Disc>,
    /// Faults of sensors, link, battery, clock and actuators.
    pub faults: Vec<PlannedFault>,
}

/// Changes of the GPS receiver, in the units of [`ReceiverSettings`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GpsChanges {
    /// Standard deviation of a fix, metres.
    pub sigma_m: Option<f64>,
    /// Solutions per second.
    pub rate_hz: Option<f64>,
    /// Delay of a message, seconds.
    pub delay_s: Option<f64>,
    /// Correlation time of the error, seconds.
    pub correlation_s: Option<f64>,
    /// Error beside a wall, metres.
    pub multipath_m: Option<f64>,
}

/// Changes of the compass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompassChanges {
    /// Standard deviation, radians.
    pub sigma_rad: Option<f64>,
    /// Constant error, radians counter-clockwise.
    pub offset_rad: Option<f64>,
}

/// Changes of the range finder, in the units of [`RingSettings`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeChanges {
    /// Number of sectors; 0 for a robot without a range finder.
    pub sectors: Option<usize>,
    /// Number of beams in a sector.
    pub beams: Option<usize>,
    /// Range within which surfaces are seen, metres.
    pub reach_m: Option<f64>,
    /// Standard deviation of a distance, metres.
    pub sigma_m: Option<f64>,
}

impl Conditions {
    /// The sensors under these conditions; `base` gives what they do not change.
    pub fn sensors(&self, base: SensorSettings) -> SensorSettings {
        let Self { gps, compass, ranges, pose, .. } = self;
        let ring = base.ring.map(|ring| RingSettings {
            sectors: ranges.sectors.unwrap_or(ring.sectors),
            beams: ranges.beams.unwrap_or(ring.beams),
            range_m: ranges.reach_m.unwrap_or(ring.range_m),
            sigma_m: ranges.sigma_m.unwrap_or(ring.sigma_m),
        });
        SensorSettings {
            gps: base.gps.map(|base| ReceiverSettings {
                sigma_m: gps.sigma_m.unwrap_or(base.sigma_m),
                rate_hz: gps.rate_hz.unwrap_or(base.rate_hz),
                delay_s: gps.delay_s.unwrap_or(base.delay_s),
                correlation_s: gps.correlation_s.unwrap_or(base.correlation_s),
                multipath_m: gps.multipath_m.unwrap_or(base.multipath_m),
                ..base
            }),
            compass_sigma_rad: compass.sigma_rad.or(base.compass_sigma_rad),
            compass_offset_rad: compass.offset_rad.unwrap_or(base.compass_offset_rad),
            ring: ring.filter(|ring| ring.sectors > 0),
            pose: pose.or(base.pose),
            // Faults of the link need a link to fail.
            has_link: base.has_link || self.faults.iter().any(|f| f.channel == Channel::Link),
            ..base
        }
    }

    /// The body under these conditions; `base` gives what they do not change.
    pub fn chassis(&self, base: Chassis) -> Chassis {
        Chassis {
            drift_radps: base.drift_radps + self.unequal_radps,
            slip: self.slip,
            acceleration_mps2: self.acceleration_mps2.unwrap_or(base.acceleration_mps2),
            turn_acceleration_radps2: self
                .turn_acceleration_radps2
                .unwrap_or(base.turn_acceleration_radps2),
            ..base
        }
    }
}
