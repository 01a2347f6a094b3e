//! Moving obstacles: discs that follow paths.
//!
//! A disc moves at a constant speed, whatever is in its way, except that it waits where it would
//! overlap a robot. Discs pass through each other and through walls.

use crate::Point;
use crate::geometry::distance;

/// A moving obstacle as a scenario describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Disc {
    /// Radius, metres.
    pub radius_m: f64,
    /// Corners of its path, metres; at least one.
    pub path: Vec<Point>,
    /// Speed along the path, m/s.
    pub speed_mps: f64,
    /// What it does at the end of its path.
    pub repeat: Repeat,
    /// Where on its path it starts, metres from the first corner.
    pub start_m: f64,
}

/// What a disc does at the end of its path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Repeat {
    /// Turns round and follows the path back.
    #[default]
    Back,
    /// Goes on from the last corner to the first, on a straight line.
    Around,
    /// Stays at the end.
    Once,
}

impl Disc {
    /// Its centre after it has moved this far along its path, metres.
    pub fn at(&self, moved_m: f64) -> Point {
        let first = self.path.first().copied().unwrap_or_default();
        let closing = (self.repeat == Repeat::Around).then_some(first);
        let corners: Vec<Point> = self.path.iter().copied().chain(closing).collect();
        let length_m: f64 = corners.windows(2).map(|side| distance(side[0], side[1])).sum();
        let along_m = self.start_m + moved_m;
        let mut left_m = match self.repeat {
            _ if length_m <= 0.0 => 0.0,
            Repeat::Once => along_m.min(length_m),
            Repeat::Around => along_m % length_m,
            Repeat::Back => {
                let lap_m = along_m % (2.0 * length_m);
                lap_m.min(2.0 * length_m - lap_m)
            }
        };
        for side in corners.windows(2) {
            let side_m = distance(side[0], side[1]);
            if left_m <= side_m && side_m > 0.0 {
                let t = left_m / side_m;
                return [0, 1].map(|axis| side[0][axis] + t * (side[1][axis] - side[0][axis]));
            }
            left_m -= side_m;
        }
        corners.last().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_follows_its_path_and_repeats_it() {
        let path = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]];
        for (repeat, start_m, expected) in [
            (Repeat::Once, 0.0, [[0.0, 0.0], [4.0, 1.0], [4.0, 3.0], [4.0, 3.0]]),
            // Back to the first corner are 5 m.
            (Repeat::Around, 0.0, [[0.0, 0.0], [4.0, 1.0], [1.6, 1.2], [3.0, 0.0]]),
            (Repeat::Back, 0.0, [[0.0, 0.0], [4.0, 1.0], [4.0, 0.0], [1.0, 0.0]]),
            (Repeat::Back, 2.0, [[2.0, 0.0], [4.0, 3.0], [2.0, 0.0], [3.0, 0.0]]),
        ] {
            let disc = Disc { radius_m: 0.3, path: path.clone(), speed_mps: 1.0, repeat, start_m };
            let moved = [0.0, 5.0, 10.0, 15.0];
            for (moved_m, at) in moved.into_iter().zip(expected) {
                assert!(distance(disc.at(moved_m), at) < 1e-9, "{repeat:?} {start_m} {moved_m}");
            }
        }
    }

    #[test]
    fn a_path_without_length_is_a_place() {
        for path in [vec![[1.0, 2.0]], vec![[1.0, 2.0], [1.0, 2.0]]] {
            for repeat in [Repeat::Back, Repeat::Around, Repeat::Once] {
                let path = path.clone();
                let disc = Disc { radius_m: 0.3, path, speed_mps: 1.0, repeat, start_m: 3.0 };
                assert_eq!(disc.at(7.0), [1.0, 2.0]);
            }
        }
    }
}
