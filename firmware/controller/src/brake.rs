//! Brakes: limits the speed so that the robot can stop before it touches anything that it sees.
//!
//! The way that the robot needs to stop from a speed is `v t + v^2 / 2a + stop distance`, with the
//! latency `t` and the brakes `a` of the vehicle. A speed is safe if the body touches nothing on
//! that way, neither along the arc that the robot drives now nor along the one that the tick
//! commands: the vehicle turns from one to the other within a few ticks. Points beside the body do
//! not count, so the robot may drive along a wall at any distance.
//!
//! - The speed is the highest safe one, up to the wanted speed.
//! - A robot that is too fast for the wanted arc brakes as hard as it can, and stays on the arc that
//!   the last tick found safe.
//!
//! - An obstacle that moves by itself ([`crate::closing`]) counts wherever it may be until the robot
//!   stands: on its own way, and straight towards the robot at its speed.
//!
//! Invariant: if the robot obeys, and obstacles stand still and appear no nearer than its stopping
//! distance, it touches nothing, whatever the gains. Turning on the spot moves nothing outside the
//! body's circle and stays allowed. The velocity of a moving obstacle and a boat's drift are
//! estimates, so the invariant covers neither.

use math::scalar;
use plan_format::parameters::{Steering, Vehicle};

use crate::arc::{Arc, Body};
use crate::closing::FASTEST_MPS;
use crate::drive::{Twist, circle_m};
use crate::obstacles::{Kind, Obstacles};

/// Speeds tried in one tick. Each try halves the interval that holds the highest safe speed.
const TRIES: usize = 4;

/// Least distance from what the body passes, metres.
const ASIDE_M: f32 = 0.015;
/// What this distance grows by for each m/s: a fast robot follows its arc less exactly.
const ASIDE_PER_SPEED_S: f32 = 0.03;

/// Time constant of the drag that ends a boat's drift, seconds.
const DRIFT_S: f32 = 0.5;

/// The robot counts on braking for this time at least, seconds: its clock may stand.
const SHORTEST_TICK_S: f32 = 0.05;

/// Below this speed the robot turns on the spot, m/s.
const SPOT_MPS: f32 = 1e-3;

/// Turn rates that differ by less than this describe one arc, rad/s.
const STEADY_RADPS: f32 = 0.1;

/// What the brakes need to know about the present motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Present speed and turn rate.
    pub twist: Twist,
    /// Estimate of the speed at which a boat drifts to the outside of its turns, m/s.
    pub drift_mps: f32,
    /// Time since the last tick, seconds.
    pub elapsed_s: f32,
    /// Age of the range readings, seconds. It adds to the vehicle's latency.
    pub age_s: f32,
}

/// A robot that rests, in a tick of 50 ms.
#[cfg(test)]
pub(crate) const RESTING: Moving = Moving {
    twist: Twist { speed_mps: 0.0, turn_rate_radps: 0.0 },
    drift_mps: 0.0,
    elapsed_s: 0.05,
    age_s: 0.0,
};

/// Speed at which a boat drifts to the outside of a steady turn, m/s; 0 for other vehicles.
pub fn steady_drift_mps(vehicle: &Vehicle, twist: &Twist) -> f32 {
    match vehicle.steering {
        Steering::Boat => DRIFT_S * (twist.speed_mps * twist.turn_rate_radps).abs(),
        Steering::Differential | Steering::Ackermann => 0.0,
    }
}

/// The drift after `elapsed_s` in a turn, m/s: drag brings it towards the steady drift.
pub fn next_drift_mps(drift_mps: f32, steady_mps: f32, elapsed_s: f32) -> f32 {
    drift_mps + (steady_mps - drift_mps) * (elapsed_s / (DRIFT_S + elapsed_s))
}

/// How far a boat drifts aside while it stops from a speed and until drag has ended the drift,
/// metres. It drifts at `drift_mps` now and makes a `turn`.
pub fn drift_m(vehicle: &Vehicle, drift_mps: f32, turn: &Twist, speed_mps: f32) -> f32 {
    let drift_mps = steady_drift_mps(vehicle, turn).max(drift_mps);
    let stopping_s = vehicle.latency_us as f32 * 1e-6 + speed_mps / vehicle.braking_mps2;
    drift_mps * (DRIFT_S + 0.5 * stopping_s)
}

/// The fastest that the robot may be, m/s: its limit, or on a slope or after a faster action its present
/// speed.
fn top_mps(vehicle: &Vehicle, moving: &Moving) -> f32 {
    vehicle.max_speed_mps.max(moving.twist.speed_mps.abs())
}

/// Readings farther away than this do not limit the speed, metres.
pub fn within_m(vehicle: &Vehicle, moving: &Moving) -> f32 {
    let (top_mps, age_s) = (top_mps(vehicle, moving), moving.age_s);
    let stopping_m = vehicle.stopping_distance_m(top_mps) + top_mps * age_s;
    let fastest = Twist { speed_mps: top_mps, turn_rate_radps: vehicle.max_turn_rate_radps };
    let drift_m = drift_m(vehicle, 0.0, &fastest, top_mps);
    let aside_m = ASIDE_M + ASIDE_PER_SPEED_S * top_mps + drift_m;
    vehicle.radius_m.max(vehicle.stop_distance_m) + aside_m + vehicle.stop_distance_m + stopping_m
}

/// Time for which the brakes count with the motion of an obstacle beyond the time to stop, seconds:
/// its nearest point is seen, and its flanks reach farther.
const BEYOND_S: f32 = 0.3;

/// Time until the robot stands from a speed, and a little more, seconds.
fn stopping_s(vehicle: &Vehicle, speed_mps: f32) -> f32 {
    vehicle.latency_us as f32 * 1e-6 + speed_mps / vehicle.braking_mps2 + BEYOND_S
}

/// Obstacles that move and are farther away than this do not limit the speed, metres.
pub fn coming_m(vehicle: &Vehicle, moving: &Moving) -> f32 {
    let time_s = stopping_s(vehicle, top_mps(vehicle, moving)) + moving.age_s;
    within_m(vehicle, moving) + FASTEST_MPS * time_s
}

/// Limits `wanted`. `ahead` are the readings nearer than [`within_m`]. `None` if obstacles leave
/// only turning on the spot.
pub fn brake(
    vehicle: &Vehicle,
    ahead: &Obstacles,
    moving: &Moving,
    wanted: Twist,
) -> Option<Twist> {
    let now = moving.twist;
    let leading = if wanted.speed_mps == 0.0 { now.speed_mps } else { wanted.speed_mps };
    if leading == 0.0 {
        return Some(wanted);
    }
    let is_astern = leading < 0.0;
    let sign = if is_astern { -1.0 } else { 1.0 };
    let want_mps = wanted.speed_mps * sign;
    // Against the present motion, a robot stops first.
    let present_mps = (now.speed_mps * sign).max(0.0);
    let least_mps =
        (present_mps - vehicle.braking_mps2 * moving.elapsed_s.max(SHORTEST_TICK_S)).max(0.0);
    let top_mps = want_mps.max(least_mps);

    let stopping_m =
        |speed_mps: f32| vehicle.stopping_distance_m(speed_mps) + speed_mps * moving.age_s;
    let aside_m = |speed_mps: f32| ASIDE_M + ASIDE_PER_SPEED_S * speed_mps;
    // A body without a radius must stop too.
    let radius_m = vehicle.radius_m.max(0.5 * vehicle.stop_distance_m);
    let astern;
    let near = if is_astern {
        astern = ahead.astern();
        &astern
    } else {
        ahead
    };
    if near.is_empty() {
        return Some(wanted);
    }
    let bare = Body { radius_m, aside_m: 0.0 };
    // A slower vehicle turns no tighter than its circle; infinite for one that turns on the spot.
    let tightest_per_m = 1.0 / circle_m(vehicle);
    let is_clear = |speed_mps: f32, turn_rate_radps: f32| {
        let curvature = turn_rate_radps / speed_mps.max(SPOT_MPS);
        let curvature = scalar::clamp(curvature, -tightest_per_m, tightest_per_m);
        let length_m = stopping_m(speed_mps);
        // The present drift goes on into the next turn.
        let turn = Twist { speed_mps: speed_mps.max(least_mps), turn_rate_radps };
        let drift_m = drift_m(vehicle, moving.drift_mps, &turn, speed_mps);
        let body = Body { aside_m: aside_m(speed_mps) + drift_m, ..bare };
        let arc = Arc::new(length_m + vehicle.stop_distance_m, curvature);
        near.leave_free(Kind::Seen, &body, &arc)
            && near.leave_free(Kind::Hidden, &bare, &Arc::new(length_m, curvature))
            && near.let_pass(&body, &arc, stopping_s(vehicle, speed_mps) + moving.age_s)
    };
    let is_steady = (now.turn_rate_radps - wanted.turn_rate_radps).abs() < STEADY_RADPS;
    let is_safe = |speed_mps: f32| {
        is_clear(speed_mps, wanted.turn_rate_radps)
            && (is_steady || is_clear(speed_mps, now.turn_rate_radps))
    };
    if is_safe(top_mps) {
        return Some(wanted);
    }
    let (mut safe_mps, mut unsafe_mps) = (0.0, top_mps);
    for _ in 1..TRIES {
        let middle_mps = 0.5 * (safe_mps + unsafe_mps);
        if is_safe(middle_mps) {
            safe_mps = middle_mps;
        } else {
            unsafe_mps = middle_mps;
        }
    }
    if safe_mps >= least_mps {
        let speed_mps = sign * safe_mps.min(want_mps.max(0.0));
        return (safe_mps > 0.0 || want_mps <= 0.0).then_some(Twist { speed_mps, ..wanted });
    }
    // `present_mps` is above `least_mps`, which is above 0.
    let turn_rate_radps = now.turn_rate_radps * (least_mps / present_mps);
    Some(Twist { speed_mps: sign * safe_mps, turn_rate_radps })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In a steady turn the drift is speed x turn rate x 0.5 s; afterwards drag ends it.
    #[test]
    fn drift_follows_a_turn_and_fades_after_it() {
        let boat =
            Vehicle { steering: Steering::Boat, ..plan_format::Parameters::default().vehicle };
        let turn = Twist { speed_mps: -1.0, turn_rate_radps: 0.5 };
        let steady_mps = steady_drift_mps(&boat, &turn);
        assert_eq!(steady_mps, 0.25);
        let after = |mut drift_mps: f32, steady_mps: f32, ticks: u32| {
            for _ in 0..ticks {
                drift_mps = next_drift_mps(drift_mps, steady_mps, 0.05);
            }
            drift_mps
        };
        assert!((after(0.0, steady_mps, 100) - 0.25).abs() < 1e-3);
        // One time constant: a share of 1/e is left.
        assert!((after(0.25, 0.0, 10) / 0.25 - 0.37).abs() < 0.03);
        let rover = Vehicle { steering: Steering::Differential, ..boat };
        assert_eq!(steady_drift_mps(&rover, &turn), 0.0);
    }

    fn rover() -> Vehicle {
        plan_format::Parameters::default().vehicle
    }

    /// With readings that are half a second old.
    const LATE: Moving = Moving { age_s: 0.5, ..RESTING };

    fn assert_close(found: f32, expected: f32) {
        assert!((found - expected).abs() < 1e-3, "{found} instead of {expected}");
    }

    /// The default rover has a radius of 0.3 m. From 1.6 m/s it stops within 0.8 m, 2 cm before an
    /// obstacle, and keeps 6.3 cm from what it passes. In the age of its readings it drives on.
    #[test]
    fn readings_count_as_far_as_the_robot_needs_to_stop() {
        assert_close(within_m(&rover(), &RESTING), 0.3 + 0.8 + 0.02 + 0.063);
        assert_close(within_m(&rover(), &LATE), 1.183 + 0.5 * 1.6);
        // A steady turn at 1.6 m/s and 2 rad/s drifts at 1.6 m/s. The boat stops after 0.9 s, and its
        // drift ends after as long as 0.95 s at that speed.
        let boat = Vehicle { steering: Steering::Boat, max_turn_rate_radps: 2.0, ..rover() };
        assert_close(within_m(&boat, &RESTING), 1.183 + 0.95 * 1.6);
        // The body is smaller than the distance at which it stops.
        let small = Vehicle { radius_m: 0.1, stop_distance_m: 0.2, ..rover() };
        assert_close(within_m(&small, &RESTING), 0.2 + 0.8 + 0.2 + 0.063);
    }

    /// A robot that is faster than it may be, on a slope or after a faster action, needs longer to stop.
    #[test]
    fn readings_count_as_far_as_the_present_speed_needs() {
        let slow = Vehicle { max_speed_mps: 0.3, ..rover() };
        assert_close(within_m(&slow, &RESTING), 0.3 + 0.0525 + 0.02 + 0.024);
        for speed_mps in [1.6, -1.6] {
            let fast = Moving { twist: Twist { speed_mps, ..RESTING.twist }, ..RESTING };
            assert_close(within_m(&slow, &fast), within_m(&rover(), &RESTING));
            assert_close(coming_m(&slow, &fast), coming_m(&rover(), &RESTING));
        }
    }

    /// The rover stands after 0.9 s; 0.3 s more count. In that time an obstacle comes 2 m/s x 1.2 s
    /// closer.
    #[test]
    fn what_moves_counts_as_far_as_it_comes_meanwhile() {
        assert_close(stopping_s(&rover(), 1.6), 1.2);
        assert_close(coming_m(&rover(), &RESTING), 1.183 + 2.4);
        assert_close(coming_m(&rover(), &LATE), 1.983 + 3.4);
    }

    /// At 1.6 m/s, with brakes of 2 m/s^2, the robot has 1.5 m/s a tick later, whatever it does.
    #[test]
    fn a_robot_that_is_too_fast_brakes_and_stays_on_its_arc() {
        let reading = robot_io::RangeReading { bearing_rad: 0.0, distance_m: 0.6 };
        let seen = crate::scan::points(&[reading]);
        let ahead = Obstacles::near(&[reading], &seen, 5.0, &[], 0.0);
        let twist = Twist { speed_mps: 1.6, turn_rate_radps: 0.8 };
        let moving = Moving { twist, drift_mps: 0.0, elapsed_s: 0.05, age_s: 0.0 };
        let wanted = Twist { speed_mps: 1.6, turn_rate_radps: 0.0 };
        let braked = brake(&rover(), &ahead, &moving, wanted).expect("it is driving");
        assert!((0.4..1.0).contains(&braked.speed_mps), "{braked:?}");
        assert_close(braked.turn_rate_radps, 0.8 * 1.5 / 1.6);
        // After a longer tick it can have less.
        let moving = Moving { elapsed_s: 0.2, ..moving };
        let braked = brake(&rover(), &ahead, &moving, wanted).expect("it is driving");
        assert_close(braked.turn_rate_radps, 0.8 * 1.2 / 1.6);
    }
}
