//! Repulsion from obstacles.

use math::{Vec2, scalar, vector};
use robot_io::RangeReading;

/// Strength of an obstacle within the margin. The source has "infinite"; this value keeps sums
/// finite and still beats every other vector at any sensible gain: those of the presets sum to
/// at most 1.11.
pub const SATURATED: f32 = 1_000.0;

/// A reading repels only if no reading within this angle to either side is nearer, radians (50
/// degrees). Two neighbours in a ring of eight, 45 degrees apart, still count as one surface.
pub const SURFACE_ANGLE_RAD: f32 = 0.872_664_6;

/// Sum of the repulsions of all obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsion {
    /// The sum, in the axes of the bearings: x straight ahead, y to the left.
    pub vector: Vec2,
    /// Whether any obstacle is within the margin.
    pub is_saturated: bool,
}

/// Repulsion from the range readings around a body of `radius_m`.
///
/// With `gap = distance - radius`, the strength is [`SATURATED`] up to `margin_m`,
/// `(sphere - (gap - margin)) / sphere` up to `margin_m + sphere_m`, and 0 beyond. The direction
/// is opposite to the reading's bearing, so it is defined even at distance 0.
///
/// Only the nearest reading of each surface repels. The source sums over obstacles, but a range
/// finder does not report obstacles: all the rays on one wall together would repel several times
/// as hard as the wall and keep the robot out of every gap. So a reading counts only if it is the
/// nearest within [`SURFACE_ANGLE_RAD`] to either side. Along a straight wall the distances grow
/// to both sides of the nearest point, so exactly one reading remains; the two walls of a street
/// leave two. Of equally near readings the earlier one counts.
///
/// Source: Arkin 1989, avoid-static-obstacle. The rule for surfaces is an addition.
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
    let is_apart = |other: &RangeReading| angle_between(reading, other) > SURFACE_ANGLE_RAD;
    let (before, after) = readings.split_at(index.min(readings.len()));
    before.iter().all(|other| other.distance_m > reading.distance_m || is_apart(other))
        && after.iter().all(|other| other.distance_m >= reading.distance_m || is_apart(other))
}

/// Angle between two bearings that are wrapped to [-pi, pi), the short way round.
fn angle_between(a: &RangeReading, b: &RangeReading) -> f32 {
    let difference = (a.bearing_rad - b.bearing_rad).abs();
    if difference > scalar::PI { scalar::TAU - difference } else { difference }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;
    use std::vec::Vec;

    const RADIUS_M: f32 = 0.5;
    const MARGIN_M: f32 = 0.5;
    const SPHERE_M: f32 = 4.0;

    fn at(bearing_deg: f32, distance_m: f32) -> RangeReading {
        RangeReading { bearing_rad: scalar::wrap_angle(bearing_deg.to_radians()), distance_m }
    }

    fn repulsion(readings: &[RangeReading]) -> Repulsion {
        avoid_static_obstacle(readings, RADIUS_M, MARGIN_M, SPHERE_M)
    }

    #[test]
    fn w16_golden_strengths_by_distance() {
        // distance of the surface straight ahead, expected x of the repulsion
        let table = [
            (-1.0, -SATURATED),
            (0.0, -SATURATED),
            (0.5, -SATURATED),
            (1.0, -SATURATED),
            (1.5, -0.875),
            (2.0, -0.75),
            (3.0, -0.5),
            (4.5, -0.125),
            (5.0, 0.0),
            (9.0, 0.0),
        ];
        for (distance_m, expected) in table {
            let Repulsion { vector, is_saturated } = repulsion(&[at(0.0, distance_m)]);
            let error = (vector.x - expected).abs();
            assert!(error <= 2e-3 * expected.abs(), "{distance_m}: {vector:?}");
            assert!(vector.y.abs() <= 2e-3 * vector.x.abs(), "{distance_m}: {vector:?}");
            assert_eq!(is_saturated, distance_m <= 1.0, "{distance_m}");
        }
    }

    #[test]
    fn w16_golden_directions() {
        for (bearing_deg, x, y) in [
            (0.0, -0.5, 0.0),
            (90.0, 0.0, -0.5),
            (180.0, 0.5, 0.0),
            (-90.0, 0.0, 0.5),
            (45.0, -0.35355, -0.35355),
        ] {
            let vector = repulsion(&[at(bearing_deg, 3.0)]).vector;
            assert!((vector - Vec2::new(x, y)).amax() < 1e-3, "{bearing_deg}: {vector:?}");
        }
    }

    #[test]
    fn surfaces_far_apart_add_up_and_opposite_ones_cancel() {
        let both = repulsion(&[at(60.0, 3.0), at(-60.0, 3.0)]).vector;
        assert!((both - Vec2::new(-0.5, 0.0)).amax() < 2e-3, "{both:?}");
        let street = repulsion(&[at(90.0, 3.0), at(-90.0, 3.0)]).vector;
        assert!(street.amax() < 2e-3, "{street:?}");
    }

    /// A ring of `count` readings, turned by `turned_deg`, on the wall x = `ahead_m`.
    fn wall(count: usize, turned_deg: f32, ahead_m: f32) -> Vec<RangeReading> {
        let rays = (0..count).map(|i| turned_deg + 360.0 * i as f32 / count as f32);
        let hit = |bearing_deg: f32| {
            let cosine = cosine_of(bearing_deg);
            (cosine > 0.05).then(|| at(bearing_deg, ahead_m / cosine))
        };
        rays.filter_map(hit).collect()
    }

    fn cosine_of(degrees: f32) -> f32 {
        math::scalar::wide::cos(f64::from(degrees).to_radians()) as f32
    }

    /// A wall repels like one obstacle at its nearest reading, for any number and rotation of
    /// readings. A sum over sixteen readings would repel about three times as hard.
    #[test]
    fn one_wall_repels_once() {
        for count in 8..=16 {
            for turned in 0..45 {
                let readings = wall(count, turned as f32, 1.8);
                let nearest = readings.iter().map(|r| r.distance_m).fold(f32::MAX, f32::min);
                let expected = strength(nearest - RADIUS_M, MARGIN_M, SPHERE_M);
                let result = vector::length(repulsion(&readings).vector);
                let case = format!("{count} readings turned by {turned}: {result} not {expected}");
                assert!((result - expected).abs() < 2e-3, "{case}");
            }
        }
    }

    /// The dead end of an alley: three walls repel, and two of them cancel.
    #[test]
    fn the_walls_of_an_alley_are_three_surfaces() {
        let alley: Vec<_> = (0..16)
            .map(|i| 22.5 * i as f32 - 90.0)
            .filter(|bearing| bearing.abs() <= 90.0)
            .map(|bearing| {
                let aside = 1.5 / cosine_of(90.0 - bearing.abs()).abs().max(1e-3);
                let ahead = 1.4 / cosine_of(bearing).max(1e-3);
                at(bearing, aside.min(ahead))
            })
            .collect();
        let vector = repulsion(&alley).vector;
        let expected = -strength(1.4 - RADIUS_M, MARGIN_M, SPHERE_M);
        assert!((vector.x - expected).abs() < 5e-3 && vector.y.abs() < 5e-3, "{vector:?}");
    }

    #[test]
    fn equal_readings_never_silence_each_other() {
        let ring: Vec<_> = (0..16).map(|i| at(22.5 * i as f32, 1.0)).collect();
        assert!(repulsion(&ring).is_saturated);
        let pair = repulsion(&[at(10.0, 2.0), at(-10.0, 2.0)]).vector;
        assert!(vector::length(pair) > 0.7, "{pair:?}");
    }

    #[test]
    fn an_obstacle_exactly_at_the_robot_repels_in_a_defined_direction() {
        let vector = repulsion(&[at(0.0, 0.0)]).vector;
        assert_eq!(vector.x, -SATURATED * scalar::cos(0.0));
        let no_sphere = avoid_static_obstacle(&[at(0.0, 0.0), at(99.0, 3.0)], 0.0, 0.0, 0.0);
        assert!(vector::length(no_sphere.vector).is_finite());
    }

    proptest::proptest! {
        #[test]
        fn whatever_is_read_the_sum_is_finite(
            readings in proptest::collection::vec((-4.0_f32..4.0, proptest::num::f32::NORMAL), 0..16),
            radius in 0.0_f32..100.0, margin in 0.0_f32..1000.0, sphere in 0.0_f32..1000.0,
        ) {
            let readings: Vec<_> = readings
                .into_iter()
                .map(|(bearing_rad, distance_m)| RangeReading { bearing_rad, distance_m })
                .collect();
            let vector = avoid_static_obstacle(&readings, radius, margin, sphere).vector;
            proptest::prop_assert!(vector::length(vector) <= 7.1 * SATURATED);
        }
    }
}
