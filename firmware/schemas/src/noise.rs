//! Noise: a small random push out of balanced vectors.

use math::{Vec2, scalar, vector};
use serde::{Deserialize, Serialize};

/// The noise schema and its state: a random heading in the map's axes, constant for some ticks.
///
/// The generator is the xorshift of Marsaglia 2003 (shifts 13, 17, 5), in integers only, so every
/// target draws the same headings. The heading is computed from the generator's state. Source:
/// Arkin 1989, noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Noise {
    generator: u32,
    left_ticks: u16,
}

impl Noise {
    /// Starts from a seed; any seed is valid, 0 too.
    pub fn new(seed: u32) -> Self {
        // A generator at 0 would stay there. The multiplication is one to one, and neighbouring
        // seeds differ from the first draw on.
        let mixed = seed.wrapping_mul(0x9e37_79b9);
        Self { generator: if mixed == 0 { 0x9e37_79b8 } else { mixed }, left_ticks: 0 }
    }

    /// The unit vector for this tick. The heading changes every `persistence_ticks`, at least 1.
    pub fn next(&mut self, persistence_ticks: u16) -> Vec2 {
        if self.left_ticks == 0 {
            self.generator = xorshift(self.generator);
            self.left_ticks = persistence_ticks.max(1);
        }
        self.left_ticks -= 1;
        vector::from_angle(self.heading_rad())
    }

    /// The current heading, radians in [-pi, pi).
    fn heading_rad(self) -> f32 {
        // The upper half is more random, and 16 bits are exact in single precision.
        let upper_bits = (self.generator >> 16) as f32;
        upper_bits * (scalar::TAU / 65_536.0) - scalar::PI
    }
}

const fn xorshift(x: u32) -> u32 {
    let x = x ^ (x << 13);
    let x = x ^ (x >> 17);
    x ^ (x << 5)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_heading_lasts_for_its_ticks() {
        let mut noise = Noise::new(7);
        let drawn: Vec<Vec2> = (0..40).map(|_| noise.next(10)).collect();
        for same in drawn.chunks(10) {
            assert!(same.iter().all(|v| *v == same[0]), "{same:?}");
        }
        assert!(drawn[0] != drawn[10] && drawn[10] != drawn[20] && drawn[20] != drawn[30]);
    }

    #[test]
    fn a_persistence_of_zero_draws_every_tick() {
        let mut noise = Noise::new(7);
        let drawn: Vec<Vec2> = (0..10).map(|_| noise.next(0)).collect();
        assert!(drawn.windows(2).all(|pair| pair[0] != pair[1]), "{drawn:?}");
    }

    /// The first numbers of the generator from its state 1, as published with it.
    #[test]
    fn the_generator_is_xorshift_13_17_5() {
        assert_eq!([1, 270_369, 67_634_689].map(xorshift), [270_369, 67_634_689, 2_647_435_461]);
    }

    #[test]
    fn headings_are_unit_vectors_all_around() {
        for seed in [0, 1, 2, u32::MAX] {
            let mut noise = Noise::new(seed);
            let drawn: Vec<Vec2> = (0..4_000).map(|_| noise.next(1)).collect();
            assert!(drawn.iter().all(|v| (vector::length(*v) - 1.0).abs() < 2e-3), "seed {seed}");
            let mean = drawn.iter().sum::<Vec2>() / drawn.len() as f32;
            assert!(vector::length(mean) < 0.05, "seed {seed}: {mean:?}");
            for quadrant in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                let is_in = |v: &&Vec2| v.x * quadrant.0 > 0.0 && v.y * quadrant.1 > 0.0;
                let share = drawn.iter().filter(is_in).count();
                assert!((900..1_100).contains(&share), "seed {seed}: {share} in {quadrant:?}");
            }
        }
    }

    #[test]
    fn seeds_differ_and_repeat() {
        let first = |seed| Noise::new(seed).next(1);
        assert_eq!(first(3), first(3));
        assert!(first(3) != first(4) && first(0) != first(1));
    }
}
