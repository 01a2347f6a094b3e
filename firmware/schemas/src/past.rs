//! Avoid-past: places where the robot has just been repel it.

use math::{Vec2, vector};
use serde::{Deserialize, Serialize};

/// Places that are remembered.
const PLACES: usize = 24;
/// A place is remembered this often, microseconds.
const EVERY_US: u64 = 1_000_000;
/// Within this distance of a place, the robot is still there, metres.
const HERE_M: f32 = 0.2;
/// After this number of places, a robot that is still there is repelled in another direction.
const SAME_DIRECTION: u8 = 6;
/// From one such direction to the next, radians: the golden angle, which leaves no side out.
const NEXT_DIRECTION_RAD: f32 = 2.4;

/// The avoid-past schema and its memory: where the robot was in the last 24 seconds of driving.
///
/// A place where the robot stays is remembered again and again, so it repels the more, in a direction that
/// changes every few seconds. That drives the robot out of dead ends in which goal and obstacles hold
/// it. Source: Balch and Arkin 1993,
/// "Avoiding the past".
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Past {
    /// Map metres.
    places: [[f32; 2]; PLACES],
    /// How many are in use.
    count: u8,
    /// The one that is overwritten next.
    next: u8,
    /// Number of the direction in which the place repels where the robot is.
    direction: u8,
    /// When the last one was remembered, microseconds.
    last_us: u64,
}

impl Default for Past {
    fn default() -> Self {
        Self { places: [[0.0; 2]; PLACES], count: 0, next: 0, direction: 0, last_us: 0 }
    }
}

impl Past {
    /// The vector away from the remembered places, of length 1 at most, and remembers this one.
    /// A place repels up to `sphere_m`, linearly less with the distance.
    pub fn repel(&mut self, position: Vec2, time_us: u64, sphere_m: f32) -> Vec2 {
        let from_here = vector::from_angle(f32::from(self.direction) * NEXT_DIRECTION_RAD);
        let places = self.places.iter().take(usize::from(self.count));
        let sum = places.fold(Vec2::zeros(), |sum, &place| {
            let away = position - Vec2::from(place);
            let distance_m = vector::length(away);
            if distance_m < HERE_M {
                sum + from_here
            } else if distance_m < sphere_m {
                sum + away / distance_m * (1.0 - distance_m / sphere_m)
            } else {
                sum
            }
        });
        if self.count == 0 || time_us.saturating_sub(self.last_us) >= EVERY_US {
            self.remember(position, time_us);
        }
        let length = vector::length(sum);
        if length > 1.0 { sum / length } else { sum }
    }

    fn remember(&mut self, position: Vec2, time_us: u64) {
        if let Some(place) = self.places.get_mut(usize::from(self.next)) {
            *place = position.into();
        }
        self.last_us = time_us;
        self.next = if usize::from(self.next) + 1 < PLACES { self.next + 1 } else { 0 };
        self.count = (self.count + 1).min(PLACES as u8);
        if self.next.is_multiple_of(SAME_DIRECTION) {
            self.direction = self.direction.wrapping_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPHERE_M: f32 = 4.0;

    /// Drives along `track`, one place per second, and returns the last vector.
    fn after(track: &[(f32, f32)]) -> Vec2 {
        let mut past = Past::default();
        track.iter().zip(0..).fold(Vec2::zeros(), |_, (&(x, y), second)| {
            past.repel(Vec2::new(x, y), second * EVERY_US, SPHERE_M)
        })
    }

    #[test]
    fn golden_vectors() {
        let close = |a: Vec2, x: f32, y: f32| (a - Vec2::new(x, y)).amax() < 1e-6;
        // Nothing is remembered yet; a place where the robot still is repels to the east first.
        assert!(close(after(&[(1.0, 1.0)]), 0.0, 0.0));
        assert!(close(after(&[(1.0, 1.0), (1.0, 1.0)]), 1.0, 0.0));
        // Half the sphere away, twice there, and beyond the sphere.
        assert!(close(after(&[(0.0, 0.0), (2.0, 0.0)]), 0.5, 0.0));
        assert!(close(after(&[(0.0, 0.0), (0.0, 0.0), (0.0, 3.0)]), 0.0, 0.5));
        assert!(close(after(&[(0.0, 0.0), (4.0, 0.0)]), 0.0, 0.0));
        // At most 1.
        assert!(close(after(&[(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, -1.0)]), 0.0, -1.0));
    }

    #[test]
    fn places_are_forgotten_in_their_order() {
        // Far away for as long as the memory lasts.
        let mut track = [(50.0, 50.0); PLACES + 3];
        (track[0], track[1]) = ((0.0, 0.0), (3.0, 0.0));
        for (length, is_remembered) in [(PLACES, true), (PLACES + 1, true), (PLACES + 2, false)] {
            let mut track = track;
            track[length] = (2.0, 0.0);
            let vector = after(&track[..=length]);
            assert_eq!(vector != Vec2::zeros(), is_remembered, "{length}: {vector:?}");
        }
    }

    #[test]
    fn a_robot_that_stays_is_driven_to_every_side() {
        let mut past = Past::default();
        let mut quadrants = [false; 4];
        for second in 0..60 {
            let vector = past.repel(Vec2::zeros(), second * EVERY_US, SPHERE_M);
            assert!(second == 0 || vector::length(vector) > 0.9, "{second}: {vector:?}");
            quadrants[usize::from(vector.x < 0.0) + 2 * usize::from(vector.y < 0.0)] = true;
        }
        assert_eq!(quadrants, [true; 4]);
    }

    #[test]
    fn a_place_is_remembered_once_a_second() {
        let mut past = Past::default();
        for tick in 0..40 {
            past.repel(Vec2::zeros(), tick * 50_000, SPHERE_M);
        }
        assert_eq!(past.count, 2);
    }
}
