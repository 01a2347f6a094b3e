//! Backs a car or a boat out of places where it cannot turn.
//!
//! Advice and detours name a direction, as if the robot could turn on the spot. A differential
//! vehicle can. A car or a boat needs a circle, and where an obstacle or the edge of the map lies on
//! that circle it stops. The vehicle then drives astern, and turns towards the wanted direction
//! meanwhile: the second leg of a three-point turn.
//!
//! - It begins when the robot has almost come to rest and cannot begin its circle ahead.
//! - It ends when the circle is free up to the wanted direction, when no way astern is free and on
//!   the map, or after the way of a quarter of a turn, unless the robot wants to go astern. The next
//!   leg goes ahead again.
//! - [`BackOut`] decides who may: a robot whose sensors look ahead only must not drive where it does
//!   not see.
//!
//! The brakes limit this motion like any other.
//!
//! Source: Reeds and Shepp 1990, "Optimal paths for a car that goes both forwards and backwards";
//! only the idea that a car needs both.

use math::{Vec2, scalar, vector};
use plan_format::parameters::{BackOut, Steering, Vehicle};
use robot_io::{Commands, Reason};
use serde::{Deserialize, Serialize};

use crate::arc::{Arc, Body};
use crate::brake::{Moving, drift_m};
use crate::drive::{Twist, circle_m};
use crate::edge::Edge;
use crate::obstacles::{Kind, Obstacles};
use crate::scan::Points;

/// Least distance from what the body passes, metres. A little more than the brakes keep.
const ASIDE_M: f32 = 0.02;
/// A way that is shorter than the stop distance and this is not worth beginning, metres.
const BEGINNING_M: f32 = 0.08;
/// A leg is at least this long, metres: shorter ones change too little.
const SHORTEST_M: f32 = 0.15;
/// A robot that is faster than this has not come to rest yet, m/s.
const RESTING_MPS: f32 = 0.15;

/// What a robot does astern. Part of the controller's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BackingOut {
    /// The leg under way.
    leg: Option<Leg>,
    /// Whether the sensors have seen something astern.
    sees_astern: bool,
    /// Whether obstacles left no motion in the last tick.
    is_blocked: bool,
}

/// A leg astern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Leg {
    /// Whether the robot turns to the left on it.
    is_to_the_left: bool,
    driven_m: f32,
}

/// What the choice of a tick depends on.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'s> {
    /// The vehicle.
    pub vehicle: &'s Vehicle,
    /// What is near.
    pub near: &'s Obstacles,
    /// The edge of the map.
    pub edge: &'s Edge<'s>,
    /// Present motion.
    pub now: &'s Moving,
}

/// Radius of the tightest circle at the cautious speed, metres; `None` for a vehicle that turns on
/// the spot.
fn slow_circle_m(vehicle: &Vehicle) -> Option<f32> {
    let slow_m = vehicle.cautious_speed_mps / vehicle.max_turn_rate_radps;
    (vehicle.steering != Steering::Differential).then(|| circle_m(vehicle).max(slow_m))
}

impl BackingOut {
    /// The motion astern, if the robot has to back out instead of driving towards `wanted`, a vector
    /// in the robot's axes.
    pub fn choose(&mut self, situation: &Situation<'_>, wanted: Vec2) -> Option<Twist> {
        let circle_m = slow_circle_m(situation.vehicle)?;
        if wanted == Vec2::zeros() || !self.may_go_astern(situation.vehicle) {
            self.leg = None;
            return None;
        }
        let turn_rad = vector::angle(wanted);
        self.leg = match self.leg {
            None => self.begun(situation, turn_rad, circle_m),
            Some(leg) => leg.continued(situation, turn_rad, circle_m),
        };
        let open = self.leg.and_then(|leg| leg.open_curvature(situation, circle_m));
        let Some(curvature_per_m) = open else {
            self.leg = None;
            return None;
        };
        let speed_mps = situation.vehicle.cautious_speed_mps;
        Some(Twist { speed_mps: -speed_mps, turn_rate_radps: curvature_per_m * speed_mps })
    }

    /// Takes note of whether the sensors see something astern. `seen` are all readings as points in the
    /// robot's axes.
    pub fn look(&mut self, seen: &Points) {
        self.sees_astern |= seen.iter().any(|point| point.x < -point.y.abs());
    }

    /// Whether the robot may drive astern by itself.
    pub fn may_go_astern(&self, vehicle: &Vehicle) -> bool {
        match vehicle.back_out {
            BackOut::Never => false,
            BackOut::Seen => self.sees_astern,
            BackOut::Always => true,
        }
    }

    /// A new leg, if the robot cannot begin its way ahead.
    fn begun(&self, situation: &Situation<'_>, turn_rad: f32, circle_m: f32) -> Option<Leg> {
        let leg = Leg { is_to_the_left: turn_rad >= 0.0, driven_m: 0.0 };
        let is_held = situation.now.twist.speed_mps.abs() < RESTING_MPS
            && (self.is_blocked
                || !situation.can_begin_ahead(towards(turn_rad, circle_m, BEGINNING_M)));
        is_held.then_some(leg)
    }

    /// Takes over the commands that leave a tick. Whatever else stops the robot ends the leg.
    pub fn commanded(&mut self, commands: &Commands) {
        self.is_blocked = commands.reason == Reason::ObstacleStop;
        if commands.speed_mps >= 0.0 {
            self.leg = None;
        }
    }
}

impl Leg {
    /// The same leg, farther; `None` if it is over.
    fn continued(self, situation: &Situation<'_>, turn_rad: f32, circle_m: f32) -> Option<Self> {
        let &Situation { vehicle, near, edge, now, .. } = situation;
        let driven_m = self.driven_m + scalar::larger(-now.twist.speed_mps, 0.0) * now.elapsed_s;
        // Up to the wanted direction, and as far again as the body is wide.
        let length_m = circle_m * turn_rad.abs() + 2.0 * vehicle.radius_m;
        let curvature = towards(turn_rad, circle_m, length_m);
        let is_open = driven_m >= SHORTEST_M
            && situation.can_begin_ahead(towards(turn_rad, circle_m, BEGINNING_M))
            && is_free(vehicle, near, length_m, curvature)
            && edge.holds(vehicle, length_m, curvature, 0.0);
        // While the wanted direction lies astern, the way there is not wasted.
        let is_long = turn_rad.abs() < 0.5 * scalar::PI
            && driven_m > circle_m * (0.5 * scalar::PI) + vehicle.radius_m;
        (!is_open && !is_long).then_some(Self { driven_m, ..self })
    }

    /// Curvature of the first way astern that is free and on the map: towards the side to which the
    /// robot turns, straight, or to the other side.
    fn open_curvature(self, situation: &Situation<'_>, circle_m: f32) -> Option<f32> {
        let &Situation { vehicle, near, edge, now, .. } = situation;
        let tightest = if self.is_to_the_left { 1.0 / circle_m } else { -1.0 / circle_m };
        let astern = near.astern();
        let drift_m = drift_m(vehicle, now.drift_mps, &now.twist, 0.0);
        [tightest, 0.0, -tightest].into_iter().find(|&curvature| {
            can_begin(vehicle, &astern, curvature)
                && edge.holds(vehicle, -SHORTEST_M, curvature, drift_m)
        })
    }
}

impl Situation<'_> {
    /// Whether obstacles and the edge of the map let the vehicle begin a way ahead.
    fn can_begin_ahead(&self, curvature_per_m: f32) -> bool {
        can_begin(self.vehicle, self.near, curvature_per_m)
            && self.edge.holds(self.vehicle, BEGINNING_M, curvature_per_m, 0.0)
    }
}

/// Curvature of the way ahead that turns by `turn_rad` within `length_m`, 1/m, as far as the circle
/// allows.
fn towards(turn_rad: f32, circle_m: f32, length_m: f32) -> f32 {
    let most = 1.0 / circle_m;
    scalar::clamp(turn_rad / length_m.max(ASIDE_M), -most, most)
}

/// Whether what was read leaves a way free at the cautious speed, as the brakes judge it.
fn is_free(vehicle: &Vehicle, near: &Obstacles, length_m: f32, curvature_per_m: f32) -> bool {
    let speed_mps = vehicle.cautious_speed_mps;
    let turn = Twist { speed_mps, turn_rate_radps: curvature_per_m * speed_mps };
    let drift_m = drift_m(vehicle, 0.0, &turn, speed_mps);
    let body = Body { radius_m: vehicle.radius_m, aside_m: ASIDE_M + drift_m };
    near.leave_free(Kind::Seen, &body, &Arc::new(length_m, curvature_per_m))
}

/// Whether the vehicle can begin a way: the brakes also count with what the readings may hide.
fn can_begin(vehicle: &Vehicle, near: &Obstacles, curvature_per_m: f32) -> bool {
    let body = Body { radius_m: vehicle.radius_m, aside_m: 0.0 };
    is_free(vehicle, near, vehicle.stop_distance_m + BEGINNING_M, curvature_per_m)
        && near.leave_free(Kind::Hidden, &body, &Arc::new(BEGINNING_M, curvature_per_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brake::RESTING;
    use crate::scan::points;
    use plan_format::{Blob, Parameters};
    use robot_io::RangeReading;

    /// A wall 4 cm before a body of 0.3 m.
    const WALL: &[(f32, f32)] = &[(-0.5, 0.39), (0.0, 0.34), (0.5, 0.39)];

    fn car() -> Vehicle {
        Vehicle {
            steering: Steering::Ackermann,
            min_turn_radius_m: 0.5,
            back_out: BackOut::Always,
            ..Parameters::default().vehicle
        }
    }

    /// The answer to bearings and distances of readings.
    fn choose_at(
        edge: &Edge<'_>,
        backing: &mut BackingOut,
        vehicle: &Vehicle,
        readings: &[(f32, f32)],
        now: Moving,
        wanted: Vec2,
    ) -> Option<Twist> {
        let reading = |&(bearing_rad, distance_m)| RangeReading { bearing_rad, distance_m };
        let readings: heapless::Vec<RangeReading, 16> = readings.iter().map(reading).collect();
        let seen = points(&readings);
        let near = Obstacles::near(&readings, &seen, 5.0, &[], 0.0);
        backing.look(&seen);
        backing.choose(&Situation { vehicle, near: &near, edge, now: &now }, wanted)
    }

    /// The same without a map.
    fn choose(
        backing: &mut BackingOut,
        vehicle: &Vehicle,
        readings: &[(f32, f32)],
        now: Moving,
        wanted: Vec2,
    ) -> Option<Twist> {
        let blob = Blob::without_map(Parameters::default(), None, None);
        let edge = Edge::around(&blob, Vec2::zeros(), 0.0);
        choose_at(&edge, backing, vehicle, readings, now, wanted)
    }

    fn first(
        vehicle: &Vehicle,
        readings: &[(f32, f32)],
        now: Moving,
        wanted: Vec2,
    ) -> Option<Twist> {
        choose(&mut BackingOut::default(), vehicle, readings, now, wanted)
    }

    fn left() -> Vec2 {
        vector::from_angle(1.5)
    }

    #[test]
    fn before_a_wall_a_car_backs_out_and_turns_towards_the_wanted_side() {
        let vehicle = car();
        let turn_radps = vehicle.cautious_speed_mps / 0.5;
        for (side, wanted) in [(1.0, left()), (-1.0, Vec2::new(left().x, -left().y))] {
            let twist = first(&vehicle, WALL, RESTING, wanted).expect("it backs out");
            assert_eq!(twist.speed_mps, -vehicle.cautious_speed_mps);
            assert!((twist.turn_rate_radps - side * turn_radps).abs() < 1e-6, "{twist:?}");
        }
    }

    #[test]
    fn a_slow_turn_rate_widens_the_circle() {
        let vehicle = Vehicle { min_turn_radius_m: 0.1, max_turn_rate_radps: 0.5, ..car() };
        let twist = first(&vehicle, WALL, RESTING, left()).expect("it backs out");
        assert!((twist.turn_rate_radps - 0.5).abs() < 1e-6, "{twist:?}");
    }

    #[test]
    fn only_a_vehicle_that_may_and_must_backs_out() {
        let vehicle = car();
        let boat = Vehicle { steering: Steering::Boat, ..vehicle };
        assert!(first(&boat, WALL, RESTING, left()).is_some());
        let rover = Vehicle { steering: Steering::Differential, ..vehicle };
        let rolling = Moving { twist: Twist { speed_mps: 0.5, turn_rate_radps: 0.0 }, ..RESTING };
        let never = Vehicle { back_out: BackOut::Never, ..vehicle };
        let beside = [(1.6, 0.6), (-1.6, 0.6)];
        for (vehicle, readings, now, wanted) in [
            (&rover, WALL, RESTING, left()),
            (&never, WALL, RESTING, left()),
            (&vehicle, WALL, rolling, left()),
            (&vehicle, WALL, RESTING, Vec2::zeros()),
            (&vehicle, &beside, RESTING, Vec2::new(1.0, 0.0)),
        ] {
            assert_eq!(first(vehicle, readings, now, wanted), None, "{vehicle:?} {readings:?}");
        }
    }

    /// Once the sensors have seen something astern, the robot knows that they look there.
    #[test]
    fn sensors_that_have_seen_astern_are_trusted_from_then_on() {
        let vehicle = Vehicle { back_out: BackOut::Seen, ..car() };
        let mut backing = BackingOut::default();
        assert_eq!(choose(&mut backing, &vehicle, WALL, RESTING, left()), None);
        // Abeam does not count.
        assert_eq!(choose(&mut backing, &vehicle, &[(2.2, 2.0)], RESTING, left()), None);
        assert_eq!(choose(&mut backing, &vehicle, WALL, RESTING, left()), None);
        assert_eq!(choose(&mut backing, &vehicle, &[(2.6, 2.0)], RESTING, left()), None);
        assert!(choose(&mut backing, &vehicle, WALL, RESTING, left()).is_some());
    }

    /// The wanted direction wavers; the side stays. Free again, the leg ends, but not at once.
    #[test]
    fn a_leg_keeps_its_side_and_a_least_length() {
        let vehicle = car();
        let mut backing = BackingOut::default();
        let astern = Moving { twist: Twist { speed_mps: -0.3, turn_rate_radps: 0.0 }, ..RESTING };
        assert!(choose(&mut backing, &vehicle, WALL, RESTING, left()).is_some());
        let right = Vec2::new(left().x, -left().y);
        let twist = choose(&mut backing, &vehicle, WALL, astern, right).expect("it goes on");
        assert!(twist.turn_rate_radps > 0.0, "{twist:?}");
        let mut driven_m = 0.3 * 0.05;
        while choose(&mut backing, &vehicle, &[], astern, left()).is_some() {
            driven_m += 0.3 * 0.05;
            assert!(driven_m < 1.0);
        }
        assert!((0.13..0.17).contains(&driven_m), "{driven_m}");
    }

    /// The way that a leg takes before a wall that stays where it is in the robot's axes, up to 3 m.
    fn leg_m(wanted: Vec2) -> f32 {
        let vehicle = car();
        let mut backing = BackingOut::default();
        let astern = Moving { twist: Twist { speed_mps: -0.3, turn_rate_radps: 0.0 }, ..RESTING };
        assert!(choose(&mut backing, &vehicle, WALL, RESTING, wanted).is_some());
        let mut driven_m = 0.0;
        while driven_m < 3.0 && choose(&mut backing, &vehicle, WALL, astern, wanted).is_some() {
            driven_m += 0.3 * 0.05;
        }
        driven_m
    }

    /// A quarter of the circle of 0.5 m, and the radius of the body: 1.085 m.
    #[test]
    fn a_leg_ends_after_a_quarter_of_a_turn_unless_the_way_lies_astern() {
        let ahead_m = leg_m(left());
        assert!((1.06..1.11).contains(&ahead_m), "{ahead_m}");
        let astern_m = leg_m(vector::from_angle(2.0));
        assert!(astern_m >= 3.0, "{astern_m}");
    }

    /// Free up to the wanted direction, and the body's width farther: an arc of 0.5 m x 1.4 rad and
    /// 0.6 m. The obstacle lies straight beyond its end.
    #[test]
    fn a_leg_ends_once_the_turn_ahead_is_free() {
        let vehicle = car();
        let wanted = vector::from_angle(1.4);
        let (length_m, along) = (0.5 * 1.4 + 0.6, wanted);
        let arc_m = length_m / 1.4;
        let end = Vec2::new(along.y * arc_m, (1.0 - along.x) * arc_m);
        let astern = Moving { twist: Twist { speed_mps: -0.3, turn_rate_radps: 0.0 }, ..RESTING };
        for (beyond_m, is_over) in [(0.30, false), (0.34, true)] {
            let mut backing = BackingOut::default();
            assert!(choose(&mut backing, &vehicle, WALL, RESTING, wanted).is_some());
            let obstacle = end + along * beyond_m;
            let seen = [(vector::angle(obstacle), vector::length(obstacle))];
            let goes_on = |_| choose(&mut backing, &vehicle, &seen, astern, wanted).is_some();
            assert_eq!((0..20).all(goes_on), !is_over, "{beyond_m}");
        }
    }

    /// With something close on one side astern, it turns the other way or not at all.
    #[test]
    fn the_way_astern_has_to_be_free_too() {
        let vehicle = car();
        let with = |more: &[(f32, f32)]| {
            let all: heapless::Vec<(f32, f32), 16> = WALL.iter().chain(more).copied().collect();
            first(&vehicle, &all, RESTING, left())
        };
        let behind = [(3.1, 0.34), (2.6, 0.39), (-2.6, 0.39)];
        assert_eq!(with(&behind), None);
        // On a leg that turns to the left, the body moves to the right side.
        let twist = with(&[(-1.913, 0.345)]).expect("straight or to the right is free");
        assert!(twist.turn_rate_radps <= 0.0, "{twist:?}");
    }

    /// With 6 cm on either side astern, a car turns; a boat would drift by 9 cm and backs out straight.
    #[test]
    fn a_boat_backs_out_straight_where_it_would_drift_against_something() {
        let beside = [(-1.9, 0.38), (1.9, 0.38)];
        let all: heapless::Vec<(f32, f32), 16> = WALL.iter().chain(&beside).copied().collect();
        let turn_radps = |vehicle: &Vehicle| {
            first(vehicle, &all, RESTING, left()).expect("a way is free").turn_rate_radps
        };
        assert!(turn_radps(&car()) > 0.0);
        assert_eq!(turn_radps(&Vehicle { steering: Steering::Boat, ..car() }), 0.0);
    }

    #[test]
    fn a_stop_of_another_kind_ends_a_leg() {
        let vehicle = car();
        let mut backing = BackingOut::default();
        assert!(choose(&mut backing, &vehicle, WALL, RESTING, left()).is_some());
        backing.commanded(&Commands::stop(Reason::EmergencyStop));
        assert_eq!(backing, BackingOut::default());
    }

    /// The answer of a car on a map of 10 m by 10 m, at these metres and this heading.
    fn on_map(
        (x_m, y_m, heading_rad): (f32, f32, f32),
        readings: &[(f32, f32)],
        wanted: Vec2,
    ) -> Option<Twist> {
        let bytes = crate::edge::tests::square();
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let edge = Edge::around(&blob, Vec2::new(x_m, y_m), heading_rad);
        choose_at(&edge, &mut BackingOut::default(), &car(), readings, RESTING, wanted)
    }

    #[test]
    fn before_the_edge_of_its_map_a_car_backs_out() {
        let straight = Vec2::new(1.0, 0.0);
        for (x_m, backs_out) in [(9.98, true), (9.9, true), (9.7, false), (5.0, false)] {
            let twist = on_map((x_m, 5.0, 0.0), &[], straight);
            assert_eq!(twist.is_some(), backs_out, "{x_m}: {twist:?}");
        }
        // Along the edge and away from it, it can begin ahead.
        for heading_rad in [1.6, 3.1, -1.6] {
            assert_eq!(on_map((9.98, 5.0, heading_rad), &[], straight), None, "{heading_rad}");
        }
    }

    /// Before a wall and beside the eastern edge: a turn to the left on the way astern brings the tail
    /// to the right, off the map.
    #[test]
    fn a_leg_astern_keeps_off_the_edge() {
        let (north, south) = (0.5 * scalar::PI, -0.5 * scalar::PI);
        for (x_m, heading_rad, sign) in [(9.9, south, 1.0), (5.0, north, 1.0), (9.99, north, 0.0)] {
            let twist = on_map((x_m, 5.0, heading_rad), WALL, left()).expect("it backs out");
            assert!(twist.speed_mps < 0.0);
            assert_eq!(
                twist.turn_rate_radps.signum() * f32::from(twist.turn_rate_radps != 0.0),
                sign,
                "{x_m}"
            );
        }
    }
}
