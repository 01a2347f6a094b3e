//! Noise: a small random push that frees the robot from balanced forces.

use math::{Vec2, scalar, vector};
use serde::{Deserialize, Serialize};

/// The noise schema and its state: a random heading, fixed in the world, held for some ticks.
///
/// The generator is the xorshift of Marsaglia 2003 (shifts 13, 17, 5), in integers alone, so
/// that every target draws the same headings. Its state is the whole state: the heading is
/// computed from it. Source: Arkin 1989, noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Noise {
    generator: u32,
    held_ticks: u16,
}

impl Noise {
    /// Starts from a seed. Every seed is good, 0 too.
    pub fn new(seed: u32) -> Self {
        // The generator would stay at 0 for ever. The multiplication, which is one to one,
        // tells neighbouring seeds apart from the first draw on.
        let mixed = seed.wrapping_mul(0x9e37_79b9);
        Self { generator: if mixed == 0 { 0x9e37_79b8 } else { mixed }, held_ticks: 0 }
    }

    /// The unit vector for this tick; a new heading every `persistence_ticks` (0 counts as 1).
    pub fn next(&mut self, persistence_ticks: u16) -> Vec2 {
        if self.held_ticks == 0 {
            self.generator = xorshift(self.generator);
            self.held_ticks = persistence_ticks.max(1);
        }
        self.held_ticks -= 1;
        vector::from_angle(self.heading_rad())
    }

    /// The heading that is held, radians in [-pi, pi).
    fn heading_rad(self) -> f32 {
        // The upper half has the better bits, and 16 of them are exact in single precision.
        let sixteenth_bits = (self.generator >> 16) as f32;
        sixteenth_bits * (scalar::TAU / 65_536.0) - scalar::PI
    }
}

const fn xorshift(x: u32) -> u32 {
    let x = x ^ (x << 13);
    let x = x ^ (x >> 17);
    x ^ (x << 5)
}
