//! A GPS receiver: turns the true position into bytes on a serial line.
//!
//! It models noise, rate, delay and baud rate. The messages are real UBX NAV-PVT messages or NMEA
//! 0183 sentences, so a simulation tests the robot's own drivers.

use crate::{Point, Random, Stream};
use maps::Reference;
use math::scalar::wide;
use math::{GeoPoint, MapFrame, Vec2};
use std::collections::VecDeque;

mod encode;

pub use encode::{Dialect, Mode, Solution, sentence, ubx};

/// Rate, delay and errors of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverSettings {
    /// The protocol of its messages.
    pub dialect: Dialect,
    /// Solutions per second; 0 for a silent receiver.
    pub rate_hz: f64,
    /// Delay from the time of a solution to the first byte of its message, seconds.
    pub delay_s: f64,
    /// Speed of the serial line, bits per second; a byte takes ten bits.
    pub baud: u32,
    /// Standard deviation of the position along each axis, metres.
    pub sigma_m: f64,
    /// Correlation time of the position error, seconds; 0 for white noise.
    pub correlation_s: f64,
    /// Standard deviation of the additional error along each axis at a wall, metres. It falls to 0
    /// at 10 m from the nearest obstacle and wanders slowly. The receiver does not report it.
    pub multipath_m: f64,
    /// Standard deviation of the velocity along each axis, m/s.
    pub velocity_sigma_mps: f64,
}

impl ReceiverSettings {
    /// A receiver without error and delay.
    pub const PERFECT: Self = Self {
        dialect: Dialect::Ubx,
        rate_hz: 5.0,
        delay_s: 0.0,
        baud: 115_200,
        sigma_m: 0.0,
        correlation_s: 0.0,
        multipath_m: 0.0,
        velocity_sigma_mps: 0.0,
    };

    /// A good receiver under an open sky: 1 m, white noise, a tenth of a second late.
    pub const ONE_METRE: Self = Self {
        dialect: Dialect::Ubx,
        rate_hz: 5.0,
        delay_s: 0.1,
        baud: 38_400,
        sigma_m: 1.0,
        correlation_s: 0.0,
        multipath_m: 0.0,
        velocity_sigma_mps: 0.05,
    };

    /// A receiver for surveying, with corrections: 2 cm, a tenth of a second late.
    pub const TWO_CENTIMETRES: Self = Self { sigma_m: 0.02, ..Self::ONE_METRE };
}

/// Correlation time of the error beside walls, seconds: reflections change as the satellites and
/// the robot move.
const MULTIPATH_CORRELATION_S: f64 = 20.0;

/// A receiver on the robot.
#[derive(Clone, Debug)]
pub struct Receiver {
    settings: ReceiverSettings,
    frame: MapFrame,
    /// Heading of the map's y axis, clockwise from true north.
    heading_rad: f64,
    random: Random,
    error_m: Point,
    multipath: Random,
    /// The additional error at a wall.
    at_wall_m: Point,
    /// Share of it that acts now.
    wall_share: f64,
    mode: Mode,
    /// Number of solutions due so far.
    solved: u64,
    /// Messages not yet on the line, each with the time when it gets there, microseconds.
    waiting: VecDeque<(u64, Vec<u8>)>,
    /// Bytes on the line.
    line: VecDeque<u8>,
    /// Capacity of the line that is left, bytes; a fraction is kept for the next tick.
    room: f64,
}

impl Receiver {
    /// A receiver on a map with a reference to the globe.
    pub fn new(settings: ReceiverSettings, reference: &Reference, seed: u64) -> Self {
        let mut random = Random::new(seed, Stream::Gps);
        let error_m = [0, 1].map(|_| settings.sigma_m * random.normal());
        let mut multipath = Random::new(seed, Stream::Multipath);
        let at_wall_m = [0, 1].map(|_| settings.multipath_m * multipath.normal());
        Self {
            settings,
            frame: MapFrame::new(reference.place, reference.at, reference.heading_rad),
            heading_rad: reference.heading_rad,
            random,
            error_m,
            multipath,
            at_wall_m,
            wall_share: 0.0,
            mode: Mode::Autonomous,
            solved: 0,
            waiting: VecDeque::new(),
            line: VecDeque::new(),
            room: 0.0,
        }
    }

    /// Whether walls cause an additional error.
    pub fn has_multipath(&self) -> bool {
        self.settings.multipath_m > 0.0
    }

    /// Sets the share of the additional error that acts: 1 at a wall, 0 in the open.
    pub fn near_walls(&mut self, share: f64) {
        self.wall_share = share;
    }

    /// Sets the mode.
    pub fn in_mode(&mut self, mode: Mode) -> &mut Self {
        self.mode = mode;
        self
    }

    /// The bytes that arrive in the tick of `tick_us` microseconds that ends at `time_us`, at most
    /// `most`. `antenna` is a point of the map, and `velocity` is along the map's axes, m/s. Call
    /// it with increasing times.
    pub fn bytes(
        &mut self,
        time_us: u64,
        tick_us: u64,
        antenna: Point,
        velocity: Point,
        most: usize,
    ) -> Vec<u8> {
        if self.is_due(time_us) {
            let solution = self.solve(time_us, antenna, velocity);
            let at = time_us + (self.settings.delay_s * 1e6) as u64;
            self.waiting.push_back((at, self.settings.dialect.message(&solution)));
        }
        while self.waiting.front().is_some_and(|&(at, _)| at <= time_us) {
            self.line.extend(self.waiting.pop_front().into_iter().flat_map(|(_, bytes)| bytes));
        }
        self.room += f64::from(self.settings.baud) / 10.0 * tick_us as f64 * 1e-6;
        let count = self.line.len().min(self.room as usize).min(most);
        // An idle line saves no capacity for later.
        self.room = if self.line.len() == count { 0.0 } else { self.room - count as f64 };
        self.line.drain(..count).collect()
    }

    /// Whether a solution is due in the tick that ends now; at most one is.
    fn is_due(&mut self, time_us: u64) -> bool {
        let due = (time_us as f64 * 1e-6 * self.settings.rate_hz) as u64 + 1;
        let is_due = due > self.solved && self.settings.rate_hz > 0.0;
        self.solved = due;
        is_due
    }

    fn solve(&mut self, time_us: u64, antenna: Point, velocity: Point) -> Solution {
        self.wander();
        let share = self.mode.share_of_error();
        let mut at = [0, 1].map(|axis| antenna[axis] + share * self.error_m[axis]);
        if self.has_multipath() {
            self.wander_at_wall();
            at = [0, 1].map(|axis| at[axis] + self.wall_share * self.at_wall_m[axis]);
        }
        let (c, s) = (wide::cos(self.heading_rad), wide::sin(self.heading_rad));
        let true_velocity = [c * velocity[0] + s * velocity[1], c * velocity[1] - s * velocity[0]];
        Solution {
            time_us,
            place: self.place(at),
            velocity_mps: true_velocity
                .map(|v| v + self.settings.velocity_sigma_mps * self.random.normal()),
            accuracy_m: (share * self.settings.sigma_m * std::f64::consts::SQRT_2).max(0.02),
            mode: self.mode,
        }
    }

    /// Draws the next error at a wall, in the same way as [`Receiver::wander`].
    fn wander_at_wall(&mut self) {
        let kept = self.kept(MULTIPATH_CORRELATION_S);
        let fresh = self.settings.multipath_m * wide::sqrt(1.0 - kept * kept);
        for axis in 0..2 {
            self.at_wall_m[axis] = kept * self.at_wall_m[axis] + fresh * self.multipath.normal();
        }
    }

    /// The share of an error that the next solution keeps.
    fn kept(&self, correlation_s: f64) -> f64 {
        if correlation_s > 0.0 {
            wide::exp(-1.0 / (self.settings.rate_hz * correlation_s))
        } else {
            0.0
        }
    }

    /// Draws the next error: a first-order Gauss-Markov process with the same standard deviation at
    /// any correlation.
    fn wander(&mut self) {
        let kept = self.kept(self.settings.correlation_s);
        let fresh = self.settings.sigma_m * wide::sqrt(1.0 - kept * kept);
        for axis in 0..2 {
            self.error_m[axis] = kept * self.error_m[axis] + fresh * self.random.normal();
        }
    }

    fn place(&self, at: Point) -> GeoPoint {
        self.frame.to_geodetic(Vec2::new(at[0] as f32, at[1] as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> Reference {
        let place = GeoPoint::from_degrees(33.77, -84.4).expect("on the globe");
        Reference { place, at: [0.0, 0.0], heading_rad: 0.0 }
    }

    /// The bytes of ten seconds at 20 ticks a second, tick by tick.
    fn ten_seconds(settings: ReceiverSettings, seed: u64) -> Vec<Vec<u8>> {
        let mut receiver = Receiver::new(settings, &reference(), seed);
        (0..200).map(|i| receiver.bytes(i * 50_000, 50_000, [5.0, 6.0], [0.0; 2], 576)).collect()
    }

    #[test]
    fn messages_come_at_the_rate_and_after_the_delay() {
        let perfect = ten_seconds(ReceiverSettings::PERFECT, 1);
        assert_eq!(perfect.iter().filter(|bytes| !bytes.is_empty()).count(), 50);
        assert_eq!(perfect.iter().map(Vec::len).sum::<usize>(), 50 * 100);
        let late = ten_seconds(ReceiverSettings { delay_s: 0.3, ..ReceiverSettings::PERFECT }, 1);
        assert_eq!(late.iter().position(|bytes| !bytes.is_empty()), Some(6));
    }

    #[test]
    fn a_slow_line_spreads_a_message_over_ticks_and_loses_nothing() {
        let slow = ReceiverSettings { baud: 9_600, rate_hz: 1.0, ..ReceiverSettings::PERFECT };
        let ticks = ten_seconds(slow, 1);
        assert!(ticks.iter().all(|bytes| bytes.len() <= 48));
        assert_eq!(ticks.iter().map(Vec::len).sum::<usize>(), 10 * 100);
    }

    #[test]
    fn multipath_has_the_stated_spread_at_a_wall_and_none_in_the_open() {
        let settings = ReceiverSettings { multipath_m: 3.0, ..ReceiverSettings::PERFECT };
        let mut receiver = Receiver::new(settings, &reference(), 5);
        let exact = receiver.solve(0, [5.0, 6.0], [0.0; 2]).place;
        assert_eq!(receiver.solve(0, [5.0, 6.0], [0.0; 2]).place, exact);
        receiver.near_walls(0.5);
        let mut squares = 0.0;
        for _ in 0..20_000 {
            let place = receiver.solve(0, [5.0, 6.0], [0.0; 2]).place;
            // A ten-millionth of a degree of latitude is 11.1 mm.
            let north_m = f64::from(place.lat_e7 - exact.lat_e7) * 0.01109;
            squares += north_m * north_m;
        }
        let sigma = wide::sqrt(squares / 20_000.0);
        // The error is correlated over 100 solutions, so the sample is a small one.
        assert!((sigma - 1.5).abs() < 0.3, "{sigma}");
    }

    #[test]
    fn errors_have_the_stated_spread_and_the_same_seed_the_same_bytes() {
        for correlation_s in [0.0, 2.0] {
            let settings = ReceiverSettings { correlation_s, ..ReceiverSettings::ONE_METRE };
            assert_eq!(ten_seconds(settings, 3), ten_seconds(settings, 3));
            assert_ne!(ten_seconds(settings, 3), ten_seconds(settings, 4));
            let mut receiver = Receiver::new(settings, &reference(), 5);
            let mut squares = 0.0;
            for _ in 0..20_000 {
                receiver.wander();
                squares += receiver.error_m.iter().map(|e| e * e).sum::<f64>();
            }
            let sigma = wide::sqrt(squares / 40_000.0);
            assert!((sigma - 1.0).abs() < 0.06, "{correlation_s}: {sigma}");
        }
    }
}
