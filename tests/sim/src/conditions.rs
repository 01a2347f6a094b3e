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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fault;

    #[test]
    fn conditions_change_what_they_name_and_nothing_else() {
        let usual = (SensorSettings::USUAL, Chassis::default());
        let none = Conditions::default();
        assert_eq!((none.sensors(usual.0), none.chassis(usual.1)), usual);

        let pose = PoseSettings { rate_hz: 5.0, sigma_m: 0.1, heading_sigma_rad: None };
        let lost =
            PlannedFault { channel: Channel::Link, fault: Fault::Freeze, window_s: 1.0..2.0 };
        let all = Conditions {
            gps: GpsChanges {
                sigma_m: Some(0.5),
                rate_hz: Some(2.0),
                delay_s: Some(0.3),
                correlation_s: Some(9.0),
                multipath_m: Some(4.0),
            },
            compass: CompassChanges { sigma_rad: Some(0.1), offset_rad: Some(-0.2) },
            ranges: RangeChanges {
                sectors: Some(8),
                beams: Some(3),
                reach_m: Some(4.0),
                sigma_m: Some(0.1),
            },
            pose: Some(pose),
            unequal_radps: 0.03,
            slip: 0.1,
            acceleration_mps2: Some(0.5),
            turn_acceleration_radps2: Some(2.0),
            discs: Vec::new(),
            faults: vec![lost],
        };
        let gps = ReceiverSettings {
            sigma_m: 0.5,
            rate_hz: 2.0,
            delay_s: 0.3,
            correlation_s: 9.0,
            multipath_m: 4.0,
            ..ReceiverSettings::ONE_METRE
        };
        let ring = RingSettings { sectors: 8, beams: 3, range_m: 4.0, sigma_m: 0.1 };
        let sensors = SensorSettings {
            gps: Some(gps),
            compass_sigma_rad: Some(0.1),
            compass_offset_rad: -0.2,
            ring: Some(ring),
            pose: Some(pose),
            has_link: true,
            ..usual.0
        };
        assert_eq!(all.sensors(usual.0), sensors);
        let chassis = Chassis {
            drift_radps: 0.03,
            slip: 0.1,
            acceleration_mps2: 0.5,
            turn_acceleration_radps2: 2.0,
            ..usual.1
        };
        assert_eq!(all.chassis(usual.1), chassis);

        let gps = ReceiverSettings { rate_hz: 2.0, ..ReceiverSettings::PERFECT };
        let exact = SensorSettings {
            gps: Some(gps),
            ring: Some(RingSettings { sigma_m: 0.0, ..ring }),
            pose: Some(PoseSettings { sigma_m: 0.0, ..pose }),
            has_link: true,
            ..SensorSettings::PERFECT
        };
        assert_eq!(sensors.without_error(), exact);
        let blind = RangeChanges { sectors: Some(0), ..RangeChanges::default() };
        let blind = Conditions { ranges: blind, ..Conditions::default() };
        assert_eq!(blind.sensors(usual.0).ring, None);
    }
}
