//! Backs a car or a boat out of places where it cannot turn.
//!
//! Advice and detours name a direction, as if the robot could turn on the spot. A differential
//! vehicle can. A car or a boat needs a circle, and where an obstacle lies on that circle the brakes
//! stop it for ever. It then drives astern, and turns towards the wanted direction while it does:
//! the second leg of a three-point turn.
//!
//! - It begins when the robot has come almost to rest and its circle is closed ahead.
//! - It ends when the circle is free up to the wanted direction, when nothing is free astern, or
//!   after the way of a quarter of a turn. The next leg goes ahead again.
//! - [`BackOut`] decides who may: a robot whose sensors look ahead only must not drive where it does
//!   not see.
//!
//! The brakes limit this motion as any other.
//!
//! Source: none; three-point turns are what a driver does. Reeds and Shepp 1990 show that the
//! shortest ways of a car need them.

use math::{Vec2, scalar, vector};
use plan_format::parameters::{BackOut, Steering, Vehicle};
use serde::{Deserialize, Serialize};

use crate::brake::{Moving, drift_m, steady_drift_mps};
use crate::drive::{Twist, circle_m};
use crate::obstacles::{Arc, Body, Kind, Obstacles};
use crate::scan::Points;

/// Least distance from what the body passes, metres. A little more than the brakes keep.
const ASIDE_M: f32 = 0.02;
/// A way ahead that is shorter than the stop distance and this counts as closed, metres.
const CLOSED_M: f32 = 0.08;
/// A robot that is faster than this has not come to rest yet, m/s.
const RESTING_MPS: f32 = 0.15;

/// What a robot does astern. Part of the controller's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BackingOut {
    /// The leg under way.
    leg: Option<Leg>,
    /// Whether the sensors have seen something astern.
    sees_astern: bool,
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
    /// All readings as points in the robot's axes.
    pub seen: &'s Points,
    /// Present motion.
    pub now: &'s Moving,
}

/// Radius of the tightest circle at the cautious speed, metres; `None` for a vehicle that turns on
/// the spot.
fn slow_circle_m(vehicle: &Vehicle) -> Option<f32> {
    let slow_m = vehicle.cautious_speed_mps / vehicle.max_turn_rate_radps;
    (vehicle.steering != Steering::Differential).then(|| circle_m(vehicle).max(slow_m))
}

impl Situation<'_> {
    /// Whether the vehicle cannot even begin to turn ahead by `turn_rad`.
    fn is_closed(&self, turn_rad: f32, circle_m: f32) -> bool {
        let length_m = self.vehicle.stop_distance_m + CLOSED_M;
        !is_free(self.vehicle, self.near, length_m, towards(turn_rad, circle_m, length_m))
    }
}

impl BackingOut {
    /// The motion astern, if the robot has to back out instead of driving towards `wanted`, a vector
    /// in the robot's axes.
    pub fn choose(&mut self, situation: &Situation<'_>, wanted: Vec2) -> Option<Twist> {
        let circle_m = slow_circle_m(situation.vehicle)?;
        self.sees_astern |= situation.seen.iter().any(|point| point.x < -point.y.abs());
        let may_back_out = match situation.vehicle.back_out {
            BackOut::Never => false,
            BackOut::Seen => self.sees_astern,
            BackOut::Always => true,
        };
        if wanted == Vec2::zeros() || !may_back_out {
            self.leg = None;
            return None;
        }
        let turn_rad = vector::angle(wanted);
        self.leg = match self.leg {
            None => self.begun(situation, turn_rad, circle_m),
            Some(leg) => leg.continued(situation, turn_rad, circle_m),
        };
        let leg = self.leg?;
        let curvature_per_m = leg.open_curvature(situation, circle_m)?;
        let speed_mps = situation.vehicle.cautious_speed_mps;
        Some(Twist { speed_mps: -speed_mps, turn_rate_radps: curvature_per_m * speed_mps })
    }

    /// A new leg, if the robot rests before a circle that is closed.
    fn begun(&self, situation: &Situation<'_>, turn_rad: f32, circle_m: f32) -> Option<Leg> {
        if situation.now.twist.speed_mps.abs() > RESTING_MPS {
            return None;
        }
        let leg = Leg { is_to_the_left: turn_rad >= 0.0, driven_m: 0.0 };
        (situation.is_closed(turn_rad, circle_m) && leg.open_curvature(situation, circle_m).is_some()).then_some(leg)
    }
}

impl Leg {
    /// The same leg, farther; `None` if it is over.
    fn continued(self, situation: &Situation<'_>, turn_rad: f32, circle_m: f32) -> Option<Self> {
        let Situation { vehicle, near, now, .. } = situation;
        let driven_m = self.driven_m + scalar::larger(-now.twist.speed_mps, 0.0) * now.elapsed_s;
        // Up to the wanted direction, and as far again as the body is wide.
        let length_m = circle_m * turn_rad.abs() + 2.0 * vehicle.radius_m;
        let is_open = is_free(vehicle, near, length_m, towards(turn_rad, circle_m, length_m))
            && !situation.is_closed(turn_rad, circle_m);
        let is_long = driven_m > circle_m * (0.5 * scalar::PI) + vehicle.radius_m;
        (!is_open && !is_long).then_some(Self { driven_m, ..self })
    }

    /// Curvature of the first way astern that is free: towards the side to which the robot turns,
    /// straight, or to the other side.
    fn open_curvature(self, situation: &Situation<'_>, circle_m: f32) -> Option<f32> {
        let Situation { vehicle, near, .. } = situation;
        let length_m = vehicle.stop_distance_m + CLOSED_M;
        let tightest = if self.is_to_the_left { 1.0 / circle_m } else { -1.0 / circle_m };
        let astern = near.astern();
        [tightest, 0.0, -tightest]
            .into_iter()
            .find(|&curvature| is_free(vehicle, &astern, length_m, curvature))
    }
}

/// Curvature of the way ahead that turns by `turn_rad` within `length_m`, 1/m, as far as the circle
/// allows.
fn towards(turn_rad: f32, circle_m: f32, length_m: f32) -> f32 {
    let most = 1.0 / circle_m;
    scalar::clamp(turn_rad / length_m.max(ASIDE_M), -most, most)
}

/// Whether obstacles leave a way free.
fn is_free(vehicle: &Vehicle, near: &Obstacles, length_m: f32, curvature_per_m: f32) -> bool {
    let speed_mps = vehicle.cautious_speed_mps;
    let turn = Twist { speed_mps, turn_rate_radps: curvature_per_m * speed_mps };
    let drift_m = drift_m(vehicle, steady_drift_mps(vehicle, &turn), speed_mps);
    let body = Body { radius_m: vehicle.radius_m, aside_m: ASIDE_M + drift_m };
    near.leave_free(Kind::Seen, &body, &Arc::new(length_m, curvature_per_m))
}
