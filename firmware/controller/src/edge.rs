//! Keeps the robot from driving off its map.
//!
//! The plan ends at the edge of the map, and a robot beyond it stops ([`Reason::OffMap`]). Where a
//! route lies along the edge, obstacles beside it repel the robot towards the edge, and a turn, a
//! boat's drift or speed may carry it over. So a robot close to the edge drives along it, and a little
//! away from it. Its speed is limited as before an obstacle: it can stop before the edge, on the arc
//! that it drives. A vehicle that needs a circle keeps some room beside the edge, since it could not
//! turn away without.
//!
//! The position is believed as it is, so the error of a position, wind or a push may carry the robot
//! over. As long as its body still reaches over the map, it follows the advice of the nearest cell and
//! drives back; farther off, it stands.
//!
//! Only where `trouble.off_map` says that a robot off its map stops.
//!
//! [`Reason::OffMap`]: robot_io::Reason::OffMap

use math::{Vec2, scalar, vector};
use plan_format::parameters::{OnTrouble, Vehicle};
use plan_format::{Blob, Cell};

use crate::arc;
use crate::brake::{self, Moving};
use crate::drive::{Twist, circle_m};

/// Speeds that are tried, each half of the one before.
const TRIES: usize = 7;
/// Share of a vector that leads inward at the very edge.
const INWARD: f32 = 0.5;
/// Off the map, distances to it that differ by less than this count as equal, metres.
const ROUNDING_M: f32 = 1e-3;

/// The map around the robot. Where the robot may leave its map, every way counts as on it.
#[derive(Clone, Copy, Debug)]
pub struct Edge<'b> {
    blob: &'b Blob<'b>,
    /// Position and heading in the map's axes.
    position: Vec2,
    heading_rad: f32,
    /// The distance from the robot to the nearest edge, metres; negative off the map.
    room_m: f32,
    /// Whether the robot would stand off its map, and is on it or so close that it drives back.
    must_stay: bool,
}

impl<'b> Edge<'b> {
    /// The map around a robot at this position, map metres.
    pub fn around(blob: &'b Blob<'b>, position: Vec2, heading_rad: f32) -> Self {
        let room_m = room_m(blob, position);
        let must_stay = must_stay(blob, room_m);
        Self { blob, position, heading_rad, room_m, must_stay }
    }

    /// Whether the robot is off the map.
    pub fn is_beyond(&self) -> bool {
        self.room_m < 0.0
    }

    /// The blended vector without its part that leads off the map from close to the edge, map axes: the
    /// robot drives along the edge instead, and a little away from it.
    pub fn along(&self, vehicle: &Vehicle, sum: Vec2) -> Vec2 {
        if !self.must_stay || self.room_m > vehicle.radius_m {
            return sum;
        }
        let inward = INWARD * vector::length(sum);
        let closeness = |room_m: f32| 1.0 - room_m / vehicle.radius_m;
        let part = |part: f32, (low_m, high_m): (f32, f32)| {
            let (low, high) = (closeness(low_m), closeness(high_m));
            match (low > 0.0, high > 0.0) {
                // A map that is narrower than the body: to its middle.
                (true, true) => inward * (low - high),
                (true, false) => part.max(inward * low),
                (false, true) => part.min(-inward * high),
                (false, false) => part,
            }
        };
        let [east, north] = rooms_m(self.blob, self.position);
        Vec2::new(part(sum.x, east), part(sum.y, north))
    }

    /// The wanted twist at the highest of a few speeds from which the robot stops on the map; at
    /// speed 0 if it would leave the map at each of them.
    pub fn stay(&self, vehicle: &Vehicle, now: &Moving, wanted: Twist) -> Twist {
        let fastest_mps = wanted.speed_mps.abs().min(vehicle.max_speed_mps);
        if fastest_mps == 0.0 || !self.must_stay {
            return wanted;
        }
        let fastest = Twist { speed_mps: fastest_mps, ..wanted };
        let drift_m = brake::drift_m(vehicle, now.drift_mps, &fastest, fastest_mps);
        let reach_m = vehicle.stopping_distance_m(fastest_mps) + drift_m + most_room_m(vehicle);
        if self.room_m > reach_m {
            return wanted;
        }
        let sign = if wanted.speed_mps < 0.0 { -1.0 } else { 1.0 };
        let mut speed_mps = fastest_mps;
        for _ in 0..TRIES {
            let slower = Twist { speed_mps: sign * speed_mps, ..wanted };
            if self.holds_stop(vehicle, now.drift_mps, slower) {
                return slower;
            }
            speed_mps *= 0.5;
        }
        Twist { speed_mps: 0.0, ..wanted }
    }

    /// Whether the robot stops on the map from a twist, a boat that drifts at `drift_mps` too. The
    /// speed is not 0.
    pub fn holds_stop(&self, vehicle: &Vehicle, drift_mps: f32, twist: Twist) -> bool {
        let speed_mps = twist.speed_mps.abs();
        let most_radps = vehicle.max_turn_rate_radps;
        let turn_radps = scalar::clamp(twist.turn_rate_radps, -most_radps, most_radps);
        let tightest_per_m = 1.0 / circle_m(vehicle);
        let curvature = scalar::clamp(turn_radps / speed_mps, -tightest_per_m, tightest_per_m);
        let turn = Twist { speed_mps, turn_rate_radps: curvature * speed_mps };
        let drift_m = brake::drift_m(vehicle, drift_mps, &turn, speed_mps);
        let way_m = vehicle.stopping_distance_m(speed_mps);
        self.holds(vehicle, if twist.speed_mps < 0.0 { -way_m } else { way_m }, curvature, drift_m)
    }

    /// Whether an arc is on the map: its middle and its end, and what lies `aside_m` beside that,
    /// where a boat may have drifted. Its length is negative astern, where the axes of the motion are
    /// turned by half a turn. A vehicle that needs a circle to turn away keeps some room for that. A
    /// robot just beyond the edge must not get farther from it.
    pub fn holds(
        &self,
        vehicle: &Vehicle,
        length_m: f32,
        curvature_per_m: f32,
        aside_m: f32,
    ) -> bool {
        if !self.must_stay {
            return true;
        }
        let sign = if length_m < 0.0 { -1.0 } else { 1.0 };
        // Half of the room that is left, so that some always is.
        let kept_m = most_room_m(vehicle).min(0.5 * self.room_m);
        let is_allowed = |point: Vec2| {
            if self.is_beyond() {
                beyond_m(self.blob, point) <= beyond_m(self.blob, self.position) + ROUNDING_M
            } else {
                room_m(self.blob, point) >= kept_m
            }
        };
        [(0.5, 0.0), (1.0, aside_m), (1.0, -aside_m)].into_iter().all(|(share, aside_m)| {
            let way =
                arc::end_of(share * length_m.abs(), curvature_per_m) + Vec2::new(0.0, aside_m);
            let way = vector::rotated(way * sign, self.heading_rad);
            is_allowed(self.position + way)
        })
    }
}

/// The cell of a robot at this position. A robot just beyond the edge of its map counts as in the
/// nearest cell.
pub fn cell(blob: &Blob<'_>, position: Vec2) -> Option<Cell> {
    blob.cell_at(position).or_else(|| {
        if !must_stay(blob, room_m(blob, position)) {
            return None;
        }
        let half_m = 0.5 * blob.grid().resolution_m as f32;
        let inside = |at_m: f32, (low_m, high_m): (f32, f32)| {
            at_m + (half_m - low_m).max(0.0) - (half_m - high_m).max(0.0)
        };
        let [east, north] = rooms_m(blob, position);
        blob.cell_at(Vec2::new(inside(position.x, east), inside(position.y, north)))
    })
}

/// Whether a robot at this position is off its map and must stand.
pub fn is_lost(blob: &Blob<'_>, position: Vec2) -> bool {
    let parameters = blob.parameters();
    parameters.trouble.off_map == OnTrouble::Stop && cell(blob, position).is_none()
}

/// The distances from a point to the western and to the eastern edge, and to the southern and to the
/// northern one, metres; negative beyond an edge.
fn rooms_m(blob: &Blob<'_>, point: Vec2) -> [(f32, f32); 2] {
    let grid = blob.grid();
    // Single precision, like that of the position, is good to a millimetre.
    let resolution_m = grid.resolution_m as f32;
    let rooms_m = |at_m: f32, corner_m: f64, cells: u32| {
        let low_m = at_m - corner_m as f32;
        (low_m, cells as f32 * resolution_m - low_m)
    };
    [
        rooms_m(point.x, grid.corner_m[0], grid.columns),
        rooms_m(point.y, grid.corner_m[1], grid.rows),
    ]
}

/// The room that a vehicle keeps beside the edge where it can, metres: 0 if it turns on the spot.
fn most_room_m(vehicle: &Vehicle) -> f32 {
    if circle_m(vehicle) > 0.0 { 0.5 * vehicle.radius_m } else { 0.0 }
}

/// The distance from a point to the nearest edge, metres; negative off the map.
fn room_m(blob: &Blob<'_>, point: Vec2) -> f32 {
    let [(west_m, east_m), (south_m, north_m)] = rooms_m(blob, point);
    west_m.min(east_m).min(south_m.min(north_m))
}

/// The distance from a point off the map to the map, metres; 0 on the map.
fn beyond_m(blob: &Blob<'_>, point: Vec2) -> f32 {
    let beyond = |(low_m, high_m): (f32, f32)| (-low_m).max(-high_m).max(0.0);
    let [east, north] = rooms_m(blob, point);
    vector::length(Vec2::new(beyond(east), beyond(north)))
}

/// Whether a robot that is this far from the edge would stand off its map, and is on it or so close
/// that it drives back.
fn must_stay(blob: &Blob<'_>, room_m: f32) -> bool {
    let parameters = blob.parameters();
    let has_map = blob.grid().columns > 0;
    parameters.trouble.off_map == OnTrouble::Stop
        && has_map
        && room_m > -parameters.vehicle.radius_m
}

#[cfg(test)]
pub(crate) mod tests {
    extern crate std;

    use super::*;
    use crate::brake::RESTING;
    use plan_format::parameters::Steering;
    use plan_format::{Draft, Grid, Parameters, write};
    use proptest::prelude::*;
    use std::vec::Vec;

    /// A map of 10 m by 10 m without plans.
    pub(crate) fn square() -> Vec<u8> {
        map(Grid { columns: 10, rows: 10, resolution_m: 1.0, corner_m: [0.0, 0.0] })
    }

    /// A map without plans.
    fn map(grid: Grid) -> Vec<u8> {
        map_with(grid, Parameters::default())
    }

    fn map_with(grid: Grid, parameters: Parameters) -> Vec<u8> {
        write(&Draft {
            grid,
            origin: None,
            parameters,
            plans: Vec::new(),
            mission: Default::default(),
        })
        .expect("the draft is sound")
    }

    #[test]
    fn close_to_the_edge_the_robot_drives_along_it_and_away_from_it() {
        let bytes = square();
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let vehicle = Parameters::default().vehicle;
        for (position, sum, expected) in [
            ((5.0, 5.0), (1.0, -1.0), (1.0, -1.0)),
            // A third of the radius of 0.3 m from the edge: inward by a third of the length.
            ((9.9, 5.0), (0.8, -0.6), (-1.0 / 3.0, -0.6)),
            ((9.97, 5.0), (0.8, -0.6), (-0.45, -0.6)),
            ((9.6, 5.0), (1.0, -1.0), (1.0, -1.0)),
            ((9.9, 5.0), (-0.8, 0.6), (-0.8, 0.6)),
            ((9.9, 5.0), (-0.1, 0.6), (-0.2027588, 0.6)),
            ((0.1, 0.1), (-0.3, -0.4), (0.5 / 3.0, 0.5 / 3.0)),
            ((0.1, 9.9), (0.4, -0.3), (0.4, -0.3)),
            // Just beyond the edge it is led back, by up to the whole length.
            ((10.15, 5.0), (1.0, 0.0), (-0.75, 0.0)),
            ((10.29, 5.0), (0.6, 0.8), (-0.98333, 0.8)),
            ((5.0, -0.15), (0.0, 1.0), (0.0, 1.0)),
            // Farther off, where the plan does not count either, any direction may lead back.
            ((10.31, 5.0), (1.0, 0.0), (1.0, 0.0)),
        ] {
            let edge = Edge::around(&blob, Vec2::new(position.0, position.1), 0.0);
            let along = edge.along(&vehicle, Vec2::new(sum.0, sum.1));
            let off = along - Vec2::new(expected.0, expected.1);
            assert!(off.norm() < 1e-5, "{position:?} {sum:?}: {along:?}");
        }
    }

    /// The robot's radius is 0.3 m.
    #[test]
    fn just_beyond_the_edge_the_nearest_cell_counts() {
        let bytes = square();
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        for (x, y, expected) in [
            (9.5, 5.5, Some((9, 5))),
            (10.2, 5.5, Some((9, 5))),
            (-0.29, 5.5, Some((0, 5))),
            (3.5, -0.29, Some((3, 0))),
            (10.2, 10.2, Some((9, 9))),
            (10.31, 5.5, None),
            (5.5, -0.31, None),
            (10.2, 10.31, None),
        ] {
            let point = Vec2::new(x, y);
            let found = cell(&blob, point).map(|cell| (cell.column, cell.row));
            assert_eq!((found, is_lost(&blob, point)), (expected, expected.is_none()), "{x} {y}");
        }
        let mut reacts = Parameters::default();
        reacts.trouble.off_map = OnTrouble::Reactive;
        let grid = Grid { columns: 10, rows: 10, resolution_m: 1.0, corner_m: [0.0, 0.0] };
        let bytes = map_with(grid, reacts);
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let point = Vec2::new(10.2, 5.5);
        assert!(cell(&blob, point).is_none() && !is_lost(&blob, point));
        let without_map = Blob::without_map(Parameters::default(), None, None);
        assert!(is_lost(&without_map, Vec2::zeros()) && !must_stay(&without_map, 0.0));
    }

    /// A map that is narrower than the body leads it along its middle.
    #[test]
    fn a_narrow_map_leads_to_its_middle() {
        let bytes = map(Grid { columns: 20, rows: 1, resolution_m: 0.5, corner_m: [0.0, 0.0] });
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let vehicle = Parameters::default().vehicle;
        // The map is 0.5 m wide, the body 0.6 m.
        for (y, across) in
            [(0.25, 0.0), (0.1, 0.33333), (0.22, 0.1), (0.28, -0.1), (-0.05, 0.58333)]
        {
            let edge = Edge::around(&blob, Vec2::new(5.0, y), 0.0);
            let along = edge.along(&vehicle, Vec2::new(1.0, 0.0));
            assert!((along - Vec2::new(1.0, across)).norm() < 1e-5, "{y}: {along:?}");
        }
    }

    /// The map reaches from -3 m to 7 m and from 2 m to 6 m.
    #[test]
    fn the_room_is_counted_from_the_corner_of_the_map() {
        let grid = Grid { columns: 40, rows: 16, resolution_m: 0.25, corner_m: [-3.0, 2.0] };
        let bytes = map(grid);
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        assert_eq!(rooms_m(&blob, Vec2::new(-2.0, 3.5)), [(1.0, 9.0), (1.5, 2.5)]);
        assert_eq!(rooms_m(&blob, Vec2::new(7.5, 1.0)), [(10.5, -0.5), (-1.0, 5.0)]);
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
            (&rover, RESTING, (9.99, 5.0), 0.0, (1.6, 0.0), 0.05),
            (&rover, RESTING, (9.999, 5.0), 0.0, (1.6, 0.0), 0.0),
            (&rover, RESTING, (0.7, 5.0), 0.0, (-1.6, 0.0), -0.8),
            (&rover, RESTING, (10.5, 5.0), 0.0, (1.6, 0.0), 1.6),
            // Just beyond the edge, it may drive back and along the edge, and no farther off.
            (&rover, RESTING, (10.1, 5.0), 0.0, (1.6, 0.0), 0.0),
            (&rover, RESTING, (10.1, 5.0), 0.0, (-1.6, 0.0), -1.6),
            (&rover, RESTING, (10.1, 5.0), north, (1.6, 0.0), 1.6),
            (&rover, RESTING, (10.1, 5.0), north, (1.6, -2.0), 0.05),
            (&rover, RESTING, (10.1, 5.0), north, (1.6, 2.0), 1.6),
            // Off a corner, the distance from the corner counts.
            (&rover, RESTING, (10.1, 10.1), 2.0, (0.2, 0.0), 0.025),
            (&rover, RESTING, (10.1, 10.1), 2.5, (0.2, 0.0), 0.2),
            (&rover, RESTING, (9.5, 5.0), north, (1.6, -2.0), 1.6),
            (&rover, RESTING, (9.7, 5.0), north, (1.6, -2.0), 0.8),
            (&rover, RESTING, (9.935, 5.0), north, (1.6, -2.0), 0.4),
            // A car's arc has at least the radius of its circle, and it keeps half of its room: 3 cm.
            (&car, RESTING, (9.935, 5.0), north, (1.6, -2.0), 0.4),
            (&car, RESTING, (9.9, 5.0), north, (1.6, -2.0), 0.4),
            (&car, RESTING, (9.88, 5.0), north, (1.6, -2.0), 0.8),
            // Southward and astern, a clockwise turn leads to the east.
            (&rover, RESTING, (0.3, 5.0), -north, (-1.6, -2.0), -1.6),
            (&rover, RESTING, (9.7, 5.0), -north, (-1.6, -2.0), -0.8),
            // A boat keeps half of its radius, 15 cm.
            (&boat, drifting, (5.0, 9.55), 0.0, (0.5, 0.0), 0.5),
            (&boat, drifting, (5.0, 9.6), 0.0, (0.5, 0.0), 0.25),
            (&boat, drifting, (5.0, 0.4), 0.0, (0.5, 0.0), 0.25),
            (&boat, drifting, (5.0, 9.7), 0.0, (0.5, 0.0), 0.0),
            // At 0.5 m/s and 1 rad/s it drifts by 17 cm, at half of that by 6 cm.
            (&boat, RESTING, (5.0, 0.34), 0.0, (0.5, 1.0), 0.5),
            (&boat, RESTING, (5.0, 0.29), 0.0, (0.5, 1.0), 0.25),
        ] {
            let wanted = Twist { speed_mps: speed, turn_rate_radps: turn };
            let edge = Edge::around(&blob, Vec2::new(x, y), heading_rad);
            let kept = edge.stay(vehicle, &now, wanted);
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
            let kept = Edge::around(&blob, Vec2::new(x, y), heading).stay(&vehicle, &RESTING, wanted);
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
