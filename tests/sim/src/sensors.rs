//! The robot's sensors: they turn the true state of the simulation into sensor records.

use crate::geometry::{Circle, wrapped};
use crate::world::View;
use crate::{Body, Mode, Point, Random, Receiver, ReceiverSettings, Stream, World};
use maps::Reference;
use robot_io::limits::{MAX_CHANNELS, MAX_GPS_BYTES, MAX_RANGES};
use robot_io::{Operator, Pose, RangeReading, SensorRecord};
use std::f64::consts::TAU;

/// Range readings as a record holds them.
type Ranges = heapless::Vec<RangeReading, MAX_RANGES>;

/// The true state that sensors measure in one tick.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'w> {
    /// The true obstacles.
    pub world: &'w World,
    /// The other robots and the moving discs.
    pub others: &'w [Circle],
    /// The robot's body.
    pub body: Body,
    /// Position of the antenna, metres: the body's centre, unless a fault moves it.
    pub antenna: Point,
    /// Mode of the GPS receiver: autonomous, unless a fault changes it.
    pub mode: Mode,
    /// Input channels as the robot's work sets them.
    pub inputs: [Option<f32>; MAX_CHANNELS],
    /// Time since the start of the simulation, microseconds.
    pub time_us: u64,
    /// Length of this tick, microseconds.
    pub tick_us: u64,
}

impl Scene<'_> {
    /// Obstacles, other robots and discs as seen from the body's centre.
    fn view(&self, most_m: f64) -> View {
        let obstacles = self.world.view(self.body.position, most_m);
        self.others.iter().fold(obstacles, |view, &other| view.with(other))
    }
}

/// A source of sensor records.
pub trait Sensors {
    /// The sensor data of the tick that ends at the scene's time. Called once a tick.
    fn sense(&mut self, scene: &Scene<'_>) -> SensorRecord;
}

impl<S: Sensors + ?Sized> Sensors for &mut S {
    fn sense(&mut self, scene: &Scene<'_>) -> SensorRecord {
        (**self).sense(scene)
    }
}

impl<S: Sensors + ?Sized> Sensors for Box<S> {
    fn sense(&mut self, scene: &Scene<'_>) -> SensorRecord {
        (**self).sense(scene)
    }
}

/// The errors of the sensors; `None` where the robot has no such sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorSettings {
    /// GPS receiver.
    pub gps: Option<ReceiverSettings>,
    /// Standard deviation of the compass, radians.
    pub compass_sigma_rad: Option<f64>,
    /// Constant error of the compass, radians counter-clockwise.
    pub compass_offset_rad: f64,
    /// Standard deviations of the speed, m/s, and of the turn rate, rad/s.
    pub odometry_sigma: Option<(f64, f64)>,
    /// Range readings around the body.
    pub ring: Option<RingSettings>,
    /// Poses from another source than the receiver.
    pub pose: Option<PoseSettings>,
    /// The operator's commands, the same in every tick.
    pub operator: Operator,
    /// Whether the commands also arrive over the radio link, five times a second.
    pub has_link: bool,
}

/// A source of poses in the map's own metres, such as beacons or motion capture. Its error is white
/// noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseSettings {
    /// Poses per second.
    pub rate_hz: f64,
    /// Standard deviation of the position along each axis, metres.
    pub sigma_m: f64,
    /// Standard deviation of the heading, radians; `None` if it is not measured.
    pub heading_sigma_rad: Option<f64>,
}

/// Packets per second on the radio link.
const LINK_HZ: f64 = 5.0;
/// Surfaces farther from the antenna than this cause no multipath, metres.
const MULTIPATH_REACH_M: f64 = 10.0;

/// A ring of range readings: a scanner with its beams grouped into sectors. Each sector reports its
/// nearest return, as sonars and reduced laser scans do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingSettings {
    /// Number of sectors, the first one centred ahead; at most [`MAX_RANGES`].
    pub sectors: usize,
    /// Number of beams in a sector.
    pub beams: usize,
    /// Range within which surfaces are seen, metres.
    pub range_m: f64,
    /// Standard deviation of a distance, metres.
    pub sigma_m: f64,
}

impl SensorSettings {
    /// Sensors without error.
    pub const PERFECT: Self = Self {
        gps: Some(ReceiverSettings::PERFECT),
        compass_sigma_rad: Some(0.0),
        compass_offset_rad: 0.0,
        odometry_sigma: Some((0.0, 0.0)),
        ring: Some(RingSettings { sectors: 16, beams: 4, range_m: 10.0, sigma_m: 0.0 }),
        pose: None,
        operator: Operator { is_armed: true, is_emergency_stop: false, manual: None },
        has_link: false,
    };

    /// Sensors of a small outdoor robot, with a GPS sigma of 1 m.
    pub const USUAL: Self = Self {
        gps: Some(ReceiverSettings::ONE_METRE),
        compass_sigma_rad: Some(0.02),
        odometry_sigma: Some((0.02, 0.01)),
        ring: Some(RingSettings { sectors: 16, beams: 4, range_m: 10.0, sigma_m: 0.02 }),
        ..Self::PERFECT
    };

    /// The usual sensors with a receiver for surveying: a GPS sigma of 2 cm.
    pub const SURVEYOR: Self = Self { gps: Some(ReceiverSettings::TWO_CENTIMETRES), ..Self::USUAL };

    /// The same sensors without error and delay. Rates, sectors, beams and reach stay.
    pub fn without_error(self) -> Self {
        Self {
            gps: self.gps.map(|gps| ReceiverSettings {
                rate_hz: gps.rate_hz,
                dialect: gps.dialect,
                ..ReceiverSettings::PERFECT
            }),
            compass_sigma_rad: self.compass_sigma_rad.map(|_| 0.0),
            compass_offset_rad: 0.0,
            odometry_sigma: self.odometry_sigma.map(|_| (0.0, 0.0)),
            ring: self.ring.map(|ring| RingSettings { sigma_m: 0.0, ..ring }),
            pose: self.pose.map(|pose| PoseSettings {
                sigma_m: 0.0,
                heading_sigma_rad: pose.heading_sigma_rad.map(|_| 0.0),
                ..pose
            }),
            ..self
        }
    }
}

/// Whether one of `hz` events a second falls into the tick that ends at `time_us`.
fn is_due(hz: f64, time_us: u64, tick_us: u64) -> bool {
    let count = |us: u64| (us as f64 * 1e-6 * hz) as u64;
    hz > 0.0 && (time_us == 0 || count(time_us) > count(time_us.saturating_sub(tick_us)))
}

/// The sensors of one robot.
#[derive(Clone, Debug)]
pub struct SensorSuite {
    settings: SensorSettings,
    receiver: Option<Receiver>,
    /// Heading of the map's y axis, clockwise from true north.
    map_heading_rad: f64,
    compass: Random,
    odometry: Random,
    ranges: Random,
    poses: Random,
}

impl SensorSuite {
    /// Sensors of a robot on a map with this reference to the globe.
    pub fn new(settings: SensorSettings, reference: &Reference, seed: u64) -> Self {
        Self {
            settings,
            receiver: settings.gps.map(|gps| Receiver::new(gps, reference, seed)),
            map_heading_rad: reference.heading_rad,
            compass: Random::new(seed, Stream::Compass),
            odometry: Random::new(seed, Stream::Odometry),
            ranges: Random::new(seed, Stream::Ranges),
            poses: Random::new(seed, Stream::Poses),
        }
    }

    fn ring(&mut self, ring: RingSettings, scene: &Scene<'_>) -> Ranges {
        let mut readings = Ranges::new();
        let sectors = ring.sectors.clamp(1, MAX_RANGES);
        let beams = ring.beams.max(1);
        let step_rad = TAU / (sectors * beams) as f64;
        let view = scene.view(ring.range_m);
        for sector in 0..sectors {
            let beams = (0..beams).map(|beam| {
                let offset = beam as f64 - (beams - 1) as f64 / 2.0;
                let bearing_rad = ((sector * beams) as f64 + offset) * step_rad;
                let heading_rad = scene.body.heading_rad + bearing_rad;
                (bearing_rad, view.range(heading_rad))
            });
            let seen = beams.filter_map(|(bearing, range)| Some((bearing, range?)));
            if let Some((bearing_rad, range)) = seen.reduce(|a, b| if b.1 < a.1 { b } else { a }) {
                let distance = (range + ring.sigma_m * self.ranges.normal()).max(0.0);
                // Never full: there are at most `MAX_RANGES` sectors.
                let _ = readings.push(RangeReading {
                    bearing_rad: wrapped(bearing_rad) as f32,
                    distance_m: distance as f32,
                });
            }
        }
        readings
    }

    /// The operator's orders, if a packet arrives in this tick. The first packet does not arm: orders to
    /// arm count only after one that does not. The orders follow in the next tick.
    fn radio(&self, scene: &Scene<'_>) -> Option<Operator> {
        let SensorSettings { has_link, operator, .. } = self.settings;
        let (is_first, is_second) = (scene.time_us == 0, scene.time_us == scene.tick_us);
        let is_due = is_second || is_due(LINK_HZ, scene.time_us, scene.tick_us);
        (has_link && is_due).then_some(if is_first { Operator::default() } else { operator })
    }

    /// The pose that arrives in this tick, if one does.
    fn pose(&mut self, scene: &Scene<'_>) -> Option<Pose> {
        let settings = self.settings.pose?;
        if !is_due(settings.rate_hz, scene.time_us, scene.tick_us) {
            return None;
        }
        let at = scene.body.position.map(|x| x + settings.sigma_m * self.poses.normal());
        let heading = settings
            .heading_sigma_rad
            .map(|sigma| wrapped(scene.body.heading_rad + sigma * self.poses.normal()) as f32);
        Some(Pose {
            time_us: scene.time_us,
            position_m: at.map(|x| x as f32),
            heading_rad: heading,
            // A source without error still reports some.
            accuracy_mm: (settings.sigma_m * 1e3).max(10.0) as u32,
        })
    }
}

/// How much of a receiver's multipath acts at an antenna, 0 in the open to 1 at a wall.
fn multipath_share(scene: &Scene<'_>) -> f64 {
    let nearest = scene.world.nearest(scene.antenna, MULTIPATH_REACH_M);
    nearest.map_or(0.0, |nearest| 1.0 - nearest.distance_m.max(0.0) / MULTIPATH_REACH_M)
}

impl Sensors for SensorSuite {
    fn sense(&mut self, scene: &Scene<'_>) -> SensorRecord {
        let body = &scene.body;
        let gps = self.receiver.as_mut().map(|receiver| {
            if receiver.has_multipath() {
                receiver.near_walls(multipath_share(scene));
            }
            receiver.in_mode(scene.mode).bytes(
                scene.time_us,
                scene.tick_us,
                scene.antenna,
                body.velocity_mps,
                MAX_GPS_BYTES,
            )
        });
        let odometry = self.settings.odometry_sigma.map(|(speed, turn)| {
            (
                body.speed_mps + speed * self.odometry.normal(),
                body.turn_rate_radps + turn * self.odometry.normal(),
            )
        });
        let heading_rad = self.settings.compass_sigma_rad.map(|sigma| {
            let error = sigma * self.compass.normal() + self.settings.compass_offset_rad;
            let heading = body.heading_rad - self.map_heading_rad + error;
            wrapped(heading) as f32
        });
        SensorRecord {
            gps: gps.unwrap_or_default().into_iter().collect(),
            heading_rad,
            speed_mps: odometry.map(|(speed, _)| speed as f32),
            turn_rate_radps: odometry.map(|(_, turn)| turn as f32),
            ranges: self.settings.ring.map(|ring| self.ring(ring, scene)),
            inputs: scene.inputs,
            operator: self.settings.operator,
            radio: self.radio(scene),
            pose: self.pose(scene),
            clock_us: None,
            // The simulated radio adds what mates have sent.
            heard: Default::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Chassis;
    use maps::Shape;
    use math::GeoPoint;

    /// The records of ten seconds at a distance from a long wall.
    fn records(settings: SensorSettings, distance_m: f64) -> Vec<SensorRecord> {
        let wall = Shape::Polyline(vec![[-500.0, 0.0], [500.0, 0.0]]);
        let world = World::new([&wall]);
        let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
        let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
        let mut suite = SensorSuite::new(settings, &reference, 1);
        let body = Body::new(Chassis::default(), [0.0, distance_m], 1.0);
        let ticks = 0..200_u64;
        ticks
            .map(|tick| {
                suite.sense(&Scene {
                    world: &world,
                    others: &[],
                    body,
                    antenna: body.position,
                    mode: Mode::Autonomous,
                    inputs: [None; MAX_CHANNELS],
                    time_us: tick * 50_000,
                    tick_us: 50_000,
                })
            })
            .collect()
    }

    #[test]
    fn walls_disturb_a_receiver_with_multipath_only() {
        let gps = ReceiverSettings { multipath_m: 3.0, ..ReceiverSettings::PERFECT };
        let disturbed = SensorSettings { gps: Some(gps), ..SensorSettings::PERFECT };
        let far = 20.0;
        assert_eq!(records(disturbed, far), records(SensorSettings::PERFECT, far));
        assert_ne!(records(disturbed, 1.0), records(SensorSettings::PERFECT, 1.0));
    }

    #[test]
    fn packets_and_poses_come_at_their_rates() {
        let quiet = records(SensorSettings::PERFECT, 3.0);
        assert!(quiet.iter().all(|record| record.radio.is_none() && record.pose.is_none()));
        let pose = PoseSettings { rate_hz: 2.0, sigma_m: 0.1, heading_sigma_rad: Some(0.0) };
        let settings =
            SensorSettings { pose: Some(pose), has_link: true, ..SensorSettings::PERFECT };
        let records = records(settings, 3.0);
        let packets = records.iter().filter(|record| record.radio.is_some()).count();
        assert_eq!(packets, 51);
        let poses: Vec<Pose> = records.iter().filter_map(|record| record.pose).collect();
        assert_eq!(poses.len(), 20);
        for pose in poses {
            let [x, y] = pose.position_m;
            assert!(x.abs() < 0.5 && (y - 3.0).abs() < 0.5, "{pose:?}");
            assert_eq!((pose.heading_rad, pose.accuracy_mm), (Some(1.0), 100));
        }
    }

    #[test]
    fn a_compass_with_an_offset_is_wrong_by_it() {
        let settings = SensorSettings { compass_offset_rad: 0.25, ..SensorSettings::PERFECT };
        assert!(records(settings, 3.0).iter().all(|record| record.heading_rad == Some(1.25)));
    }
}
