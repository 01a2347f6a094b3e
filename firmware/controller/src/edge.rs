//! Keeps the robot from driving off its map.
//!
//! The plan ends at the edge of the map, and a robot beyond it stops ([`Reason::OffMap`]). Where a
//! route lies along the edge, obstacles beside it repel the robot towards the edge, and a turn, a
//! boat's drift or speed may carry it over. So a robot close to the edge drives along it. Its speed
//! is limited as before an obstacle: it can stop before the edge, on the arc that it drives.
//!
//! Only where `trouble.off_map` says that a robot off its map stops. The position is believed as it
//! is, so a robot may still leave the map by the error of its position.
//!
//! [`Reason::OffMap`]: robot_io::Reason::OffMap

use math::{Vec2, scalar, vector};
use plan_format::Blob;
use plan_format::parameters::{OnTrouble, Vehicle};

use crate::brake::{self, Moving};
use crate::drive::{Twist, circle_m};

/// Speeds that are tried, each half of the one before.
const TRIES: usize = 4;
/// A way that turns by less than this is straight, radians.
const STRAIGHT_RAD: f32 = 0.01;

/// The wanted twist at the highest of a few speeds from which the robot stops on the map; at speed 0
/// if it would leave the map at each of them. Position and heading are in the map's axes.
pub fn stay(
    blob: &Blob<'_>,
    vehicle: &Vehicle,
    position: Vec2,
    heading_rad: f32,
    now: &Moving,
    wanted: Twist,
) -> Twist {
    let fastest_mps = wanted.speed_mps.abs().min(vehicle.max_speed_mps);
    if fastest_mps == 0.0 || !must_stay(blob, position) {
        return wanted;
    }
    let fastest = Twist { speed_mps: fastest_mps, ..wanted };
    let drift_m = brake::drift_m(vehicle, now.drift_mps, &fastest, fastest_mps);
    if is_far_from_edge(blob, position, vehicle.stopping_distance_m(fastest_mps) + drift_m) {
        return wanted;
    }
    let sign = if wanted.speed_mps < 0.0 { -1.0 } else { 1.0 };
    let turn_radps = scalar::clamp(
        wanted.turn_rate_radps,
        -vehicle.max_turn_rate_radps,
        vehicle.max_turn_rate_radps,
    );
    let tightest_per_m = 1.0 / circle_m(vehicle);
    let stays = |speed_mps: f32| {
        let curvature = scalar::clamp(turn_radps / speed_mps, -tightest_per_m, tightest_per_m);
        let length_m = vehicle.stopping_distance_m(speed_mps);
        let turn = Twist { speed_mps, turn_rate_radps: curvature * speed_mps };
        let drift_m = brake::drift_m(vehicle, now.drift_mps, &turn, speed_mps);
        // On the way, at its end, and beside that, where a boat may have drifted.
        [(0.5, 0.0), (1.0, drift_m), (1.0, -drift_m)].into_iter().all(|(share, aside_m)| {
            let way = along_arc(share * length_m, curvature) + Vec2::new(0.0, aside_m);
            // Astern, the axes of the motion are turned by half a turn.
            let way = vector::rotated(way * sign, heading_rad);
            blob.cell_at(position + way).is_some()
        })
    };
    let mut speed_mps = fastest_mps;
    for _ in 0..TRIES {
        if stays(speed_mps) {
            return Twist { speed_mps: sign * speed_mps, ..wanted };
        }
        speed_mps *= 0.5;
    }
    Twist { speed_mps: 0.0, ..wanted }
}

/// The blended vector without its part that leads off the map from close to the edge, map axes: the
/// robot drives along the edge instead.
pub fn along(blob: &Blob<'_>, vehicle: &Vehicle, position: Vec2, sum: Vec2) -> Vec2 {
    if !must_stay(blob, position) || is_far_from_edge(blob, position, vehicle.radius_m) {
        return sum;
    }
    let leads_off = |step: Vec2| blob.cell_at(position + step * vehicle.radius_m).is_none();
    let part = |part: f32, step: Vec2| {
        let is_off = part != 0.0 && leads_off(if part < 0.0 { -step } else { step });
        if is_off { 0.0 } else { part }
    };
    Vec2::new(part(sum.x, Vec2::new(1.0, 0.0)), part(sum.y, Vec2::new(0.0, 1.0)))
}

/// Whether the robot is on its map, and would stop beyond the edge.
fn must_stay(blob: &Blob<'_>, position: Vec2) -> bool {
    blob.parameters().trouble.off_map == OnTrouble::Stop && blob.cell_at(position).is_some()
}

/// Whether the edge of the map is farther than `reach_m` in each direction.
fn is_far_from_edge(blob: &Blob<'_>, position: Vec2, reach_m: f32) -> bool {
    let reach = Vec2::new(reach_m, reach_m);
    blob.cell_at(position - reach).is_some() && blob.cell_at(position + reach).is_some()
}

/// The end of an arc that begins at 0 towards +x, metres. Of more than half a turn, only half.
fn along_arc(length_m: f32, curvature_per_m: f32) -> Vec2 {
    let turned_rad = scalar::clamp(length_m * curvature_per_m, -scalar::PI, scalar::PI);
    if turned_rad.abs() < STRAIGHT_RAD {
        return Vec2::new(length_m, 0.0);
    }
    let end = vector::from_angle(turned_rad);
    Vec2::new(end.y / curvature_per_m, (1.0 - end.x) / curvature_per_m)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use plan_format::parameters::Steering;
    use plan_format::{Draft, Grid, Parameters, write};
    use proptest::prelude::*;
    use std::vec::Vec;

    /// A map of 10 m by 10 m without plans.
    fn square() -> Vec<u8> {
        let grid = Grid { columns: 10, rows: 10, resolution_m: 1.0, corner_m: [0.0, 0.0] };
        write(&Draft {
            grid,
            origin: None,
            parameters: Parameters::default(),
            plans: Vec::new(),
            mission: Default::default(),
        })
        .expect("the draft is sound")
    }

    const RESTING: Moving = Moving {
        twist: Twist { speed_mps: 0.0, turn_rate_radps: 0.0 },
        drift_mps: 0.0,
        elapsed_s: 0.05,
        age_s: 0.0,
    };

    #[test]
    fn close_to_the_edge_the_robot_drives_along_it() {
        let bytes = square();
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let vehicle = Parameters::default().vehicle;
        for (position, sum, expected) in [
            ((5.0, 5.0), (1.0, -1.0), (1.0, -1.0)),
            ((9.9, 5.0), (1.0, -1.0), (0.0, -1.0)),
            ((9.6, 5.0), (1.0, -1.0), (1.0, -1.0)),
            ((9.9, 5.0), (-1.0, 0.5), (-1.0, 0.5)),
            ((0.1, 0.1), (-0.3, -0.4), (0.0, 0.0)),
            // Off the map, any direction may lead back.
            ((10.5, 5.0), (1.0, 0.0), (1.0, 0.0)),
        ] {
            let along =
                along(&blob, &vehicle, Vec2::new(position.0, position.1), Vec2::new(sum.0, sum.1));
            assert_eq!(along, Vec2::new(expected.0, expected.1), "{position:?} {sum:?}");
        }
    }

    #[test]
    fn arcs_end_where_geometry_says() {
        let quarter_m = 0.25 * scalar::PI;
        for (length_m, curvature_per_m, x, y) in [
            (1.0, 0.0, 1.0, 0.0),
            (1.0, 0.005, 1.0, 0.0),
            (quarter_m, 2.0, 0.5, 0.5),
            (quarter_m, -2.0, 0.5, -0.5),
            (10.0, 2.0, 0.0, 1.0),
        ] {
            let end = along_arc(length_m, curvature_per_m);
            assert!((end - Vec2::new(x, y)).norm() < 3e-3, "{length_m} {curvature_per_m}: {end:?}");
        }
    }

    /// The default vehicle stops from 1.6 m/s within 0.8 m, from half of it within 0.24 m, then 0.08
    /// and 0.03 m. At 1.6 m/s and 2 rad/s its arc has a radius of 0.8 m.
    #[test]
    fn the_speed_is_the_first_half_that_stops_on_the_map() {
        use core::f32::consts::FRAC_PI_2;
        let bytes = square();
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let rover = Parameters::default().vehicle;
        let car = Vehicle { steering: Steering::Ackermann, min_turn_radius_m: 0.5, ..rover };
        let boat = Vehicle { steering: Steering::Boat, ..rover };
        let drifting = Moving { drift_mps: 0.4, ..RESTING };
        let north = FRAC_PI_2;
        for (vehicle, now, (x, y), heading_rad, (speed, turn), expected) in [
            (&rover, RESTING, (9.0, 5.0), 0.0, (1.6, 0.0), 1.6),
            (&rover, RESTING, (9.3, 5.0), 0.0, (1.6, 0.0), 0.8),
            (&rover, RESTING, (9.8, 5.0), 0.0, (1.6, 0.0), 0.4),
            (&rover, RESTING, (9.95, 5.0), 0.0, (1.6, 0.0), 0.2),
            (&rover, RESTING, (9.99, 5.0), 0.0, (1.6, 0.0), 0.0),
            (&rover, RESTING, (0.7, 5.0), 0.0, (-1.6, 0.0), -0.8),
            (&rover, RESTING, (10.5, 5.0), 0.0, (1.6, 0.0), 1.6),
            (&rover, RESTING, (9.5, 5.0), north, (1.6, -2.0), 1.6),
            (&rover, RESTING, (9.7, 5.0), north, (1.6, -2.0), 0.8),
            (&rover, RESTING, (9.935, 5.0), north, (1.6, -2.0), 0.4),
            // A car's arc has at least the radius of its circle.
            (&car, RESTING, (9.935, 5.0), north, (1.6, -2.0), 0.8),
            // Southward and astern, a clockwise turn leads to the east.
            (&rover, RESTING, (0.3, 5.0), -north, (-1.6, -2.0), -1.6),
            (&rover, RESTING, (9.7, 5.0), -north, (-1.6, -2.0), -0.8),
            (&boat, drifting, (5.0, 9.7), 0.0, (0.5, 0.0), 0.5),
            (&boat, drifting, (5.0, 9.75), 0.0, (0.5, 0.0), 0.25),
            (&boat, drifting, (5.0, 0.25), 0.0, (0.5, 0.0), 0.25),
            (&boat, drifting, (5.0, 9.8), 0.0, (0.5, 0.0), 0.0),
        ] {
            let wanted = Twist { speed_mps: speed, turn_rate_radps: turn };
            let kept = stay(&blob, vehicle, Vec2::new(x, y), heading_rad, &now, wanted);
            let case = std::format!("{:?} {x},{y} {speed} {turn}", vehicle.steering);
            assert_eq!(kept, Twist { speed_mps: expected, ..wanted }, "{case}");
        }
    }

    proptest! {
        /// Driven with brakes as the vehicle has them, the robot stays on the map.
        #[test]
        fn from_the_speed_that_is_left_the_robot_stops_on_the_map(
            x in 0.5_f32..9.5, y in 0.5_f32..9.5, heading in -3.1_f32..3.1,
            speed in -1.6_f32..1.6, turn in -2.0_f32..2.0, is_car in any::<bool>(),
        ) {
            let bytes = square();
            let blob = Blob::parse(&bytes).expect("the blob is valid");
            let mut vehicle = Parameters::default().vehicle;
            if is_car {
                (vehicle.steering, vehicle.min_turn_radius_m) = (Steering::Ackermann, 0.5);
            }
            let wanted = Twist { speed_mps: speed, turn_rate_radps: turn };
            let kept = stay(&blob, &vehicle, Vec2::new(x, y), heading, &RESTING, wanted);
            prop_assert!(kept.speed_mps * speed >= 0.0 && kept.speed_mps.abs() <= speed.abs());
            prop_assert_eq!(kept.turn_rate_radps, turn);
            // The way until it stands, along the arc that the vehicle can drive.
            let (mut at, mut angle) = (Vec2::new(x, y), heading);
            let most_radps = if is_car { kept.speed_mps.abs() / 0.5 } else { 9.0 };
            let turn = turn.clamp(-most_radps, most_radps);
            let left_m = vehicle.stopping_distance_m(kept.speed_mps.abs());
            let steps = 40.0;
            if kept.speed_mps != 0.0 {
                let time_s = left_m / kept.speed_mps.abs();
                for _ in 0..40 {
                    angle += turn * time_s / steps;
                    at += vector::from_angle(angle) * (kept.speed_mps * time_s / steps);
                }
                let inside = Vec2::new(at.x.clamp(0.0, 9.999), at.y.clamp(0.0, 9.999));
                prop_assert!((at - inside).norm() < 0.05, "{} {}", at.x, at.y);
            }
        }
    }
}
