//! The robot's sensors: they turn the true state of the simulation into sensor records.

use crate::geometry::wrapped;
use crate::{Body, Mode, Point, Random, Receiver, ReceiverSettings, Stream, World, world};
use maps::Reference;
use robot_io::limits::{MAX_GPS_BYTES, MAX_RANGES};
use robot_io::{Operator, RangeReading, SensorRecord};
use std::f64::consts::TAU;

/// Range readings as a record holds them.
type Ranges = heapless::Vec<RangeReading, MAX_RANGES>;

/// The true state that sensors measure in one tick.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'w> {
    /// The true obstacles.
    pub world: &'w World,
    /// The bodies of the other robots.
    pub others: &'w [Body],
    /// The robot's body.
    pub body: Body,
    /// Position of the antenna, metres: the body's centre, unless a fault moves it.
    pub antenna: Point,
    /// Mode of the GPS receiver: autonomous, unless a fault changes it.
    pub mode: Mode,
    /// Time since the start of the simulation, microseconds.
    pub time_us: u64,
    /// Length of this tick, microseconds.
    pub tick_us: u64,
}

impl Scene<'_> {
    /// Distance from the body's centre to the first surface of an obstacle or another robot in a
    /// direction, metres; `None` if none is nearer than `most_m`.
    fn range(&self, heading_rad: f64, most_m: f64) -> Option<f64> {
        let from = self.body.position;
        let others = self.others.iter().filter_map(|other| {
            world::range_of_disc(from, heading_rad, other.position, other.chassis.radius_m)
        });
        let obstacle = self.world.range(from, heading_rad, most_m);
        others.filter(|&range| range < most_m).chain(obstacle).reduce(f64::min)
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
    /// Standard deviations of the speed, m/s, and of the turn rate, rad/s.
    pub odometry_sigma: Option<(f64, f64)>,
    /// Range readings around the body.
    pub ring: Option<RingSettings>,
    /// The operator's commands, the same in every tick.
    pub operator: Operator,
}

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
        odometry_sigma: Some((0.0, 0.0)),
        ring: Some(RingSettings { sectors: 16, beams: 4, range_m: 10.0, sigma_m: 0.0 }),
        operator: Operator { is_armed: true, is_emergency_stop: false, manual: None },
    };

    /// Sensors of a small outdoor robot, with a GPS sigma of 1 m.
    pub const USUAL: Self = Self {
        gps: Some(ReceiverSettings::ONE_METRE),
        compass_sigma_rad: Some(0.02),
        odometry_sigma: Some((0.02, 0.01)),
        ring: Some(RingSettings { sectors: 16, beams: 4, range_m: 10.0, sigma_m: 0.02 }),
        ..Self::PERFECT
    };
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
        }
    }

    fn ring(&mut self, ring: RingSettings, scene: &Scene<'_>) -> Ranges {
        let mut readings = Ranges::new();
        let sectors = ring.sectors.clamp(1, MAX_RANGES);
        let beams = ring.beams.max(1);
        let step_rad = TAU / (sectors * beams) as f64;
        for sector in 0..sectors {
            let beams = (0..beams).map(|beam| {
                let offset = beam as f64 - (beams - 1) as f64 / 2.0;
                let bearing_rad = ((sector * beams) as f64 + offset) * step_rad;
                let heading_rad = scene.body.heading_rad + bearing_rad;
                (bearing_rad, scene.range(heading_rad, ring.range_m))
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
}

impl Sensors for SensorSuite {
    fn sense(&mut self, scene: &Scene<'_>) -> SensorRecord {
        let body = &scene.body;
        let gps = self.receiver.as_mut().map(|receiver| {
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
            let heading = body.heading_rad - self.map_heading_rad + sigma * self.compass.normal();
            wrapped(heading) as f32
        });
        SensorRecord {
            gps: gps.unwrap_or_default().into_iter().collect(),
            heading_rad,
            speed_mps: odometry.map(|(speed, _)| speed as f32),
            turn_rate_radps: odometry.map(|(_, turn)| turn as f32),
            ranges: self.settings.ring.map(|ring| self.ring(ring, scene)),
            inputs: Default::default(),
            operator: self.settings.operator,
            radio: None,
            pose: None,
        }
    }
}
