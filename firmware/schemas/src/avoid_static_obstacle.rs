//! Repulsion from obstacles.

use math::{Vec2, scalar, vector};
use robot_io::RangeReading;

/// Strength of an obstacle within the margin. The source says "infinite"; this is bounded, so
/// that sums stay finite, and still beats every other vector at any sensible gain: those of
/// the presets sum up to at most 1.11.
pub const SATURATED: f32 = 1_000.0;

/// A reading repels only if none within this angle to either side is nearer, radians (50
/// degrees). Two neighbours of a ring of eight, 45 degrees apart, still count as one surface.
pub const SURFACE_ANGLE_RAD: f32 = 0.872_664_6;

/// What the obstacles around the robot add up to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsion {
    /// Sum of the repulsions, in the axes of the bearings: x straight ahead, y to the left.
    pub vector: Vec2,
    /// Whether any obstacle is within the margin.
    pub is_saturated: bool,
}

/// Repulsion from the range readings around a body of `radius_m`.
///
/// With `gap = distance - radius`, a reading repels with [`SATURATED`] up to `margin_m`, with
/// `(sphere - (gap - margin)) / sphere` up to `margin_m + sphere_m`, and not at all beyond,
/// each straight away from it. Its bearing gives that direction even at distance 0.
///
/// Only the nearest reading of each surface repels. The source sums over obstacles, and a
/// range finder does not report obstacles: sixteen rays on one wall would repel up to eight
/// times as hard as the one wall, and hold the robot far from every gap. So a reading counts
/// only if it is the nearest within [`SURFACE_ANGLE_RAD`] to either side. Along one straight
/// wall distances grow to both sides of its nearest point, so exactly one reading is left;
/// the two walls of a street leave two. Of equally near readings the earlier one counts.
///
/// Source: Arkin 1989, avoid-static-obstacle. The rule for surfaces is ours.
pub fn avoid_static_obstacle(
    readings: &[RangeReading],
    radius_m: f32,
    margin_m: f32,
    sphere_m: f32,
) -> Repulsion {
    let mut sum = Repulsion { vector: Vec2::zeros(), is_saturated: false };
    for (index, reading) in readings.iter().enumerate() {
        let strength = strength(reading.distance_m - radius_m, margin_m, sphere_m);
        if strength > 0.0 && is_nearest_of_its_surface(readings, index, reading) {
            sum.vector -= vector::from_angle(reading.bearing_rad) * strength;
            sum.is_saturated |= strength >= SATURATED;
        }
    }
    sum
}

/// Strength of one obstacle, 0 to 1 or [`SATURATED`]; `gap_m` is from body to surface.
fn strength(gap_m: f32, margin_m: f32, sphere_m: f32) -> f32 {
    let beyond_m = gap_m - margin_m;
    if beyond_m <= 0.0 {
        SATURATED
    } else if beyond_m < sphere_m {
        (sphere_m - beyond_m) / sphere_m
    } else {
        0.0
    }
}

fn is_nearest_of_its_surface(
    readings: &[RangeReading],
    index: usize,
    reading: &RangeReading,
) -> bool {
    readings.iter().enumerate().all(|(other_index, other)| {
        let is_nearer = other.distance_m < reading.distance_m
            || other.distance_m == reading.distance_m && other_index < index;
        !is_nearer || angle_between(reading, other) > SURFACE_ANGLE_RAD
    })
}

/// Angle between two bearings that are wrapped to [-pi, pi), the short way round.
fn angle_between(a: &RangeReading, b: &RangeReading) -> f32 {
    let difference = (a.bearing_rad - b.bearing_rad).abs();
    if difference > scalar::PI { scalar::TAU - difference } else { difference }
}
