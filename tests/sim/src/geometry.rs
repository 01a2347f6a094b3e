//! Points and angles of the plane, for bodies and obstacles alike.

use math::scalar::wide;
use std::f64::consts::{PI, TAU};

/// A point or displacement of the map, metres, x east, y north.
pub type Point = [f64; 2];

/// Distance between two points, metres.
pub fn distance(a: Point, b: Point) -> f64 {
    wide::hypot(a[0] - b[0], a[1] - b[1])
}

/// The same angle in [-pi, pi).
pub fn wrapped(radians: f64) -> f64 {
    radians - TAU * wide::floor((radians + PI) / TAU)
}
