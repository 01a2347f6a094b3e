//! Random numbers from a seed, the same on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A generator of random numbers.
#[derive(Clone, Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The generator for a seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in `[0, 1)`, 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * (1.0 / (1_u32 << 24) as f32)
    }

    /// Uniform in `[low, high)`.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    /// True in one of `cases` cases.
    pub fn one_in(&mut self, cases: u32) -> bool {
        self.below(cases.into()) == 0
    }

    /// Uniform in `0 .. limit`; 0 if the limit is 0.
    pub fn below(&mut self, limit: u64) -> u64 {
        // The slight bias towards small numbers does not matter here.
        self.0.next_u64() % limit.max(1)
    }

    /// An index into `length` elements.
    pub fn index(&mut self, length: usize) -> usize {
        self.below(length as u64) as usize
    }

    /// Uniform in `least ..= most`.
    pub fn count(&mut self, least: usize, most: usize) -> usize {
        least + self.index(most - least + 1)
    }
}
