//! Points and angles of the plane, for bodies and obstacles alike.

use math::scalar::wide;
use std::f64::consts::{PI, TAU};

/// A point or displacement of the map, metres, x east, y north.
pub type Point = [f64; 2];

/// Distance between two points, metres.
pub fn distance(a: Point, b: Point) -> f64 {
    wide::hypot(a[0] - b[0], a[1] - b[1])
}

/// A disc of the plane, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Its centre.
    pub centre: Point,
    /// Its radius.
    pub radius_m: f64,
}

/// The point of a segment that is nearest to a point.
pub fn nearest_of_segment(point: Point, from: Point, to: Point) -> Point {
    let edge = [to[0] - from[0], to[1] - from[1]];
    let gap = [point[0] - from[0], point[1] - from[1]];
    let squared = edge[0] * edge[0] + edge[1] * edge[1];
    let t = (gap[0] * edge[0] + gap[1] * edge[1]) / squared;
    // A segment without length is its own nearest point.
    let t = if squared > 0.0 { t.clamp(0.0, 1.0) } else { 0.0 };
    [from[0] + edge[0] * t, from[1] + edge[1] * t]
}

/// Distance from a point to a segment, metres.
pub fn distance_from_segment(point: Point, from: Point, to: Point) -> f64 {
    distance(point, nearest_of_segment(point, from, to))
}

/// The same angle in [-pi, pi).
pub fn wrapped(radians: f64) -> f64 {
    radians - TAU * wide::floor((radians + PI) / TAU)
}
