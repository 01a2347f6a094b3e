//! The way into a dock.

use math::{Vec2, vector};

/// A dock: a place that the robot enters in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dock {
    /// Where the robot stands when it has docked, map metres.
    pub at: Vec2,
    /// Direction in which it then faces, radians counter-clockwise from the map's x axis.
    pub direction_rad: f32,
    /// Within this distance the schema leads the robot around to the dock's front, metres.
    pub radius_m: f32,
}

/// Sine and cosine of 45 degrees: beyond this angle to the way in, the robot only circles.
const SIDEWAYS: f32 = core::f32::consts::FRAC_1_SQRT_2;
/// Where the way in begins, as a share of the radius: inside, so that the robot passes the radius.
const BEGIN: f32 = 0.9;
/// Least length of the vector, so that the robot arrives.
const SLOWEST: f32 = 0.25;

/// The vector that leads into a dock.
///
/// Outside the radius: a unit vector to where the way in begins, in front of the dock.
/// Inside, a radial part leads to the dock, and a tangential one leads around it to the way in. On
/// the way in there is only the radial part; 45 degrees aside or more, only the tangential one. The
/// vector becomes shorter towards the dock, from 1 to a quarter. Zero at the dock itself.
///
/// Source: Arkin and Murphy 1990, "Autonomous navigation in a manufacturing environment", docking:
/// ballistic and controlled motion.
pub fn docking(position: Vec2, dock: &Dock) -> Vec2 {
    let inwards = vector::from_angle(dock.direction_rad);
    let offset = position - dock.at;
    let distance_m = vector::length(offset);
    if distance_m > dock.radius_m {
        return vector::unit(dock.at - inwards * (BEGIN * dock.radius_m) - position);
    }
    if distance_m == 0.0 {
        return Vec2::zeros();
    }
    let outwards = offset / distance_m;
    // The angle from the way in to the robot, seen from the dock.
    let sine = -inwards.perp(&outwards);
    let is_behind = inwards.dot(&outwards) > 0.0;
    let aside = if is_behind { 1.0 } else { (sine.abs() / SIDEWAYS).min(1.0) };
    let around = if sine > 0.0 { clockwise(outwards) } else { -clockwise(outwards) };
    let length = (distance_m / dock.radius_m).max(SLOWEST);
    (around * aside - outwards * (1.0 - aside)) * length
}

/// Whether a robot has entered a dock from the front: it is within `tolerance_m` of the dock and at most
/// 45 degrees off the way in, and its heading is at most 45 degrees off the dock's direction.
pub fn is_docked(position: Vec2, heading_rad: f32, dock: &Dock, tolerance_m: f32) -> bool {
    let inwards = vector::from_angle(dock.direction_rad);
    let offset = position - dock.at;
    let distance_m = vector::length(offset);
    distance_m <= tolerance_m
        && -inwards.dot(&offset) >= SIDEWAYS * distance_m
        && inwards.dot(&vector::from_angle(heading_rad)) >= SIDEWAYS
}

fn clockwise(v: Vec2) -> Vec2 {
    Vec2::new(v.y, -v.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use math::scalar;
    use proptest::prelude::*;

    /// Entered towards the north.
    const DOCK: Dock = Dock {
        at: Vec2::new(0.0, 0.0),
        direction_rad: core::f32::consts::FRAC_PI_2,
        radius_m: 4.0,
    };

    #[test]
    fn golden_vectors() {
        let table = [
            // To where the way in begins, from the south and from behind.
            ((0.0, -9.0), (0.0, 1.0)),
            ((0.0, 6.0), (0.0, -1.0)),
            ((3.3, -8.0), (-0.6, 0.8)),
            // On the way in, slower and slower.
            ((0.0, -4.0), (0.0, 1.0)),
            ((0.0, -2.0), (0.0, 0.5)),
            ((0.0, -0.4), (0.0, 0.25)),
            // Beside the dock and behind it, around it.
            ((4.0, 0.0), (0.0, -1.0)),
            ((-4.0, 0.0), (0.0, -1.0)),
            ((0.0, 4.0), (-1.0, 0.0)),
            ((0.0, 0.0), (0.0, 0.0)),
        ];
        for ((x, y), expected) in table {
            let vector = docking(Vec2::new(x, y), &DOCK);
            assert!(
                (vector - Vec2::new(expected.0, expected.1)).amax() < 5e-3,
                "{x} {y}: {vector:?}"
            );
        }
    }

    #[test]
    fn a_docked_robot_is_in_front_of_the_dock_and_faces_it() {
        use core::f32::consts::PI;
        let table = [
            ((0.0, -0.5), PI / 2.0, true),
            ((0.0, 0.0), PI / 2.0, true),
            ((0.3, -0.5), 2.3, true),
            // Too far, beside, behind, turned away.
            ((0.0, -1.1), PI / 2.0, false),
            ((0.6, -0.5), PI / 2.0, false),
            ((0.0, 0.1), PI / 2.0, false),
            ((0.0, -0.5), 2.4, false),
            ((0.0, 0.0), -PI / 2.0, false),
        ];
        for ((x, y), heading_rad, expected) in table {
            let docked = is_docked(Vec2::new(x, y), heading_rad, &DOCK, 1.0);
            assert_eq!(docked, expected, "({x}, {y}) {heading_rad}");
        }
    }

    proptest! {
        /// A point that follows the vectors arrives from the front, wherever it begins.
        #[test]
        fn every_way_enters_from_the_front(
            x in -12.0_f32..12.0, y in -12.0_f32..12.0, direction_rad in -scalar::PI..scalar::PI,
        ) {
            let dock = Dock { at: Vec2::new(1.0, -2.0), direction_rad, radius_m: 3.0 };
            let mut position = Vec2::new(x, y);
            // From closer to the dock, a way around it would touch the 0.1 m where ways end.
            prop_assume!(vector::length(position - dock.at) > 0.5);
            let mut steps = 0;
            while vector::length(position - dock.at) > 0.1 {
                position += docking(position, &dock) * 0.02;
                steps += 1;
                prop_assert!(steps < 8_000, "{position:?}");
            }
            let faces = vector::unit(docking(position, &dock));
            prop_assert!(faces.dot(&vector::from_angle(direction_rad)) > 0.95, "{faces:?}");
        }
    }
}
