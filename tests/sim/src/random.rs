//! Random numbers from one seed, the same on every machine.

use math::scalar::wide;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The purpose of a random stream. The streams of one seed are independent: a sensor that draws
/// more often does not change the readings of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Stream {
    /// Start positions.
    Start,
    /// Noise of the GPS position and velocity.
    Gps,
    /// Noise of the compass.
    Compass,
    /// Noise of the odometry.
    Odometry,
    /// Noise of the range readings.
    Ranges,
    /// Faults; several faults of one run get different seeds.
    Fault,
    /// Faults of the actuators.
    Actuators,
    /// Noise of the poses.
    Poses,
    /// GPS errors beside walls.
    Multipath,
    /// Obstacles that the map or the world lacks.
    Obstacles,
    /// Packets that are lost between two robots.
    Radio,
}

/// A random number generator.
#[derive(Clone, Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64, stream: Stream) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream as u64);
        Self(generator)
    }

    /// Uniform in `[0, 1)`, 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Uniform in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A random byte.
    pub fn byte(&mut self) -> u8 {
        self.0.next_u32() as u8
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        // 1 - unit is in (0, 1], so the logarithm is finite.
        let radius = wide::sqrt(-2.0 * wide::ln(1.0 - self.unit()));
        radius * wide::cos(std::f64::consts::TAU * self.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_the_same_numbers_everywhere() {
        let mut random = Random::new(7, Stream::Gps);
        let drawn: Vec<u64> = (0..3).map(|_| random.normal().to_bits()).collect();
        assert_eq!(
            drawn,
            [4_614_178_496_556_278_653, 13_833_141_053_720_574_929, 13_822_197_569_310_427_654]
        );
    }

    #[test]
    fn streams_are_independent_and_the_normal_is_normal() {
        let mut one = Random::new(7, Stream::Gps);
        let mut other = Random::new(7, Stream::Compass);
        assert_ne!(one.unit().to_bits(), other.unit().to_bits());
        let drawn: Vec<f64> = (0..20_000).map(|_| one.normal()).collect();
        let mean = drawn.iter().sum::<f64>() / 20_000.0;
        let variance = drawn.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
    }
}
