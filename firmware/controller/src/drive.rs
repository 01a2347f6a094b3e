//! Turns the blended vector into speed and turn rate.
//!
//! The speed is the vector's length times the base speed, up to the maximum. The robot turns
//! towards the vector's direction and slows down by the cosine of the heading error. The three
//! kinds of steering differ while that error is large:
//! - differential: stops and turns on the spot;
//! - Ackermann: keeps some speed, because it cannot turn without;
//! - boat: keeps at least the cautious speed, because its rudder needs flow.
//!
//! The last two reverse, while turning, from an obstacle close ahead, if they may drive astern.
//!
//! [`crate::limit`] applies the limits.

use math::{Vec2, scalar, vector};
use plan_format::parameters::{Steering, Vehicle};
use robot_io::{Commands, Percepts, Reason};

use crate::sense::{COURSE_SPEED_MPS, gives_course};

/// Turn rate per radian of heading error, 1/s. The error halves in about a third of a second:
/// several ticks, and slower than any vehicle's own steering.
const TURN_GAIN_PER_S: f32 = 2.0;

/// Smallest share of its speed that an Ackermann vehicle keeps while it turns.
const MIN_SPEED_SHARE: f32 = 0.3;

/// Speed while searching for the heading, m/s: a little above what gives a course.
const CREEP_SPEED_MPS: f32 = 0.6;
const _: () = assert!(CREEP_SPEED_MPS > COURSE_SPEED_MPS);

/// A speed and a turn rate, without the reason that commands have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    /// Speed ahead, m/s.
    pub speed_mps: f32,
    /// Turn rate, rad/s counter-clockwise.
    pub turn_rate_radps: f32,
}

impl Twist {
    /// The commands for this twist.
    pub fn because(self, reason: Reason) -> Commands {
        let Self { speed_mps, turn_rate_radps } = self;
        Commands { speed_mps, turn_rate_radps, reason, ..Commands::stop(reason) }
    }
}

/// The twist along `blended` (the robot's axes, length 1 = base speed). `is_repelled`: the sum contains
/// an obstacle within the margin. `may_go_astern`: see [`crate::back_out`].
///
/// ```
/// use controller::drive::drive;
/// use math::vector;
/// let vehicle = plan_format::Parameters::default().vehicle;
/// // Half a radian to the left of the heading: a turn rate of twice the error, and the base
/// // speed of 1.6 m/s times the cosine.
/// let twist = drive(&vehicle, vector::from_angle(0.5), false, true);
/// assert!((twist.turn_rate_radps - 1.0).abs() < 0.01);
/// assert!((twist.speed_mps - 1.6 * 0.8776).abs() < 0.005);
/// ```
pub fn drive(vehicle: &Vehicle, blended: Vec2, is_repelled: bool, may_go_astern: bool) -> Twist {
    let length = vector::length(blended);
    if length == 0.0 {
        return Twist { speed_mps: 0.0, turn_rate_radps: 0.0 };
    }
    let top_mps = if is_repelled { vehicle.cautious_speed_mps } else { vehicle.max_speed_mps };
    let speed_mps = (length * vehicle.base_speed_mps).min(top_mps);
    let turn_rate_radps = TURN_GAIN_PER_S * vector::angle(blended);
    let cosine = blended.x / length;
    let speed_mps = match vehicle.steering {
        Steering::Differential => speed_mps * scalar::clamp(cosine, 0.0, 1.0),
        _ if cosine < 0.0 && is_repelled && may_go_astern => -speed_mps,
        Steering::Ackermann => speed_mps * scalar::clamp(cosine, MIN_SPEED_SHARE, 1.0),
        Steering::Boat => (speed_mps * cosine).max(speed_mps.min(vehicle.cautious_speed_mps)),
    };
    Twist { speed_mps, turn_rate_radps }
}

/// Radius of the tightest circle that the vehicle can drive, metres; 0 if it turns on the spot. A
/// boat's is at least that of its hull.
pub fn circle_m(vehicle: &Vehicle) -> f32 {
    match vehicle.steering {
        Steering::Differential => 0.0,
        Steering::Ackermann => vehicle.min_turn_radius_m,
        Steering::Boat => vehicle.radius_m,
    }
}

/// Drives straight ahead until the course over ground gives the heading. An error if the
/// vehicle may not creep or if creeping cannot give a course.
pub fn creep(vehicle: &Vehicle, percepts: &Percepts) -> Result<Commands, Reason> {
    if vehicle.may_creep && gives_course(percepts) && vehicle.max_speed_mps > COURSE_SPEED_MPS {
        let speed_mps = CREEP_SPEED_MPS.min(vehicle.max_speed_mps);
        let twist = Twist { speed_mps, turn_rate_radps: 0.0 };
        Ok(twist.because(Reason::NoHeading))
    } else {
        Err(Reason::NoHeading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Steering::{Ackermann, Boat, Differential};
    use plan_format::Parameters;

    fn vehicle(steering: Steering) -> Vehicle {
        Vehicle { steering, ..Parameters::paper().vehicle }
    }

    /// Base 1.4, maximum 1.6, cautious 0.3 m/s; the vehicle heads east.
    #[test]
    fn speeds_and_turn_rates_by_steering() {
        const NO: bool = false;
        let table = [
            // steering, blended length and angle, repelled, speed, turn rate
            (Differential, 0.5, 0.0, NO, 0.7, 0.0),
            (Differential, 1.0, 0.0, NO, 1.4, 0.0),
            (Differential, 9.0, 0.0, NO, 1.6, 0.0),
            (Differential, 9.0, 0.0, true, 0.3, 0.0),
            (Differential, 1.0, 0.5, NO, 1.4 * 0.8776, 1.0),
            (Differential, 1.0, -0.5, NO, 1.4 * 0.8776, -1.0),
            (Differential, 1.0, 2.0, NO, 0.0, 4.0),
            (Differential, 900.0, 2.0, true, 0.0, 4.0),
            (Differential, 0.0, 0.0, NO, 0.0, 0.0),
            (Ackermann, 1.0, 0.5, NO, 1.4 * 0.8776, 1.0),
            (Ackermann, 1.0, 2.0, NO, 1.4 * 0.3, 4.0),
            (Ackermann, 900.0, 2.0, true, -0.3, 4.0),
            (Ackermann, 900.0, 1.0, true, 0.3 * 0.5403, 2.0),
            (Boat, 1.0, 0.5, NO, 1.4 * 0.8776, 1.0),
            (Boat, 1.0, 2.0, NO, 0.3, 4.0),
            (Boat, 0.1, 2.0, NO, 0.14, 4.0),
            (Boat, 900.0, -2.0, true, -0.3, -4.0),
            (Boat, 0.0, 0.0, NO, 0.0, 0.0),
        ];
        for (steering, length, angle_rad, is_repelled, speed_mps, turn_rate_radps) in table {
            let blended = vector::from_angle(angle_rad) * length;
            let twist = drive(&vehicle(steering), blended, is_repelled, true);
            let case = (steering, length, angle_rad);
            assert!((twist.speed_mps - speed_mps).abs() < 5e-3, "{case:?}: {twist:?}");
            assert!((twist.turn_rate_radps - turn_rate_radps).abs() < 1e-2, "{case:?}: {twist:?}");
        }
    }

    /// A car or a boat that must not drive astern turns away ahead instead, as far as the brakes let it.
    #[test]
    fn a_vehicle_that_must_not_drive_astern_does_not_reverse_from_an_obstacle() {
        for (steering, speed_mps) in [(Ackermann, 0.3 * 0.3), (Boat, 0.3)] {
            let away = vector::from_angle(2.0) * 900.0;
            let twist = drive(&vehicle(steering), away, true, false);
            assert!((twist.speed_mps - speed_mps).abs() < 5e-3, "{steering:?}: {twist:?}");
        }
    }

    #[test]
    fn creeping_needs_permission_and_a_prospect() {
        use math::GeoPoint;
        use robot_io::{Fix, Receiver};
        let fix = Fix {
            time_us: 0,
            is_valid: true,
            place: GeoPoint { lat_e7: 0, lon_e7: 0 },
            accuracy_mm: 0,
            velocity_mmps: Some([0, 0]),
            receiver_ms: None,
        };
        let moving = Percepts { fix: Some(fix), ..Percepts::default() };
        let silent = Fix { velocity_mmps: None, ..fix };
        let silent = Percepts { fix: Some(silent), ..Percepts::default() };
        let able = vehicle(Differential);
        let standing = Percepts { receiver: Receiver::Sound, ..silent.clone() };
        assert_eq!(creep(&able, &standing).map(|c| c.speed_mps), Ok(CREEP_SPEED_MPS));
        let forbidden = Vehicle { may_creep: false, ..able };
        let slow = Vehicle { max_speed_mps: 0.5, ..able };
        assert_eq!(creep(&able, &moving).map(|c| c.speed_mps), Ok(CREEP_SPEED_MPS));
        for (vehicle, percepts) in [(&forbidden, &moving), (&slow, &moving), (&able, &silent)] {
            assert_eq!(creep(vehicle, percepts), Err(Reason::NoHeading));
        }
    }
}
