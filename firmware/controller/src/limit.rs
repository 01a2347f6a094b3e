//! The last step of a tick: operator, obstacles and the vehicle's limits.

use math::scalar;
use plan_format::parameters::Vehicle;
use robot_io::{Commands, Percepts, Reason};
use serde::{Deserialize, Serialize};

use crate::brake::{Moving, brake, next_drift_mps, steady_drift_mps};
use crate::drive::{Twist, circle_m};
use crate::obstacles::Obstacles;

/// Braking counts for at most this time between two ticks, microseconds.
const LONGEST_STEP_US: u64 = 200_000;

/// Speed and turn rate that the last tick commanded. Part of the controller's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Commanded {
    time_us: u64,
    speed_mps: f32,
    turn_rate_radps: f32,
    /// The speed that the robot had in that tick, m/s.
    had_mps: f32,
    /// Estimate of the speed at which a boat drifted then, m/s.
    drift_mps: f32,
}

impl Commanded {
    /// Present speed and turn rate: measured, or else those of a robot that obeys and whose speed
    /// changes by at most its brakes allow. `age_s` is the age of the range readings, seconds.
    pub fn now(&self, percepts: &Percepts, age_s: f32, vehicle: &Vehicle) -> Moving {
        let elapsed_us = percepts.time_us.saturating_sub(self.time_us).min(LONGEST_STEP_US);
        let elapsed_s = elapsed_us as u32 as f32 * 1e-6;
        let most_mps = vehicle.braking_mps2 * elapsed_s;
        let obeyed_mps =
            self.had_mps + scalar::clamp(self.speed_mps - self.had_mps, -most_mps, most_mps);
        let twist = Twist {
            speed_mps: percepts.speed_mps.unwrap_or(obeyed_mps),
            turn_rate_radps: percepts.turn_rate_radps.unwrap_or(self.turn_rate_radps),
        };
        let steady_mps = steady_drift_mps(vehicle, &twist);
        let drift_mps = next_drift_mps(self.drift_mps, steady_mps, elapsed_s);
        Moving { twist, drift_mps, elapsed_s, age_s }
    }

    /// Remembers the commands that leave a tick, and the motion in that tick.
    pub fn commanded(&mut self, time_us: u64, commands: &Commands, now: &Moving) {
        let Commands { speed_mps, turn_rate_radps, .. } = *commands;
        let (had_mps, drift_mps) = (now.twist.speed_mps, now.drift_mps);
        *self = Self { time_us, speed_mps, turn_rate_radps, had_mps, drift_mps };
    }
}

/// Clamps the wanted commands by operator, obstacles and vehicle limits.
///
/// Emergency stop, disarm and manual override outrank everything, in this order. Only the
/// vehicle's limits bound a manual command: the driver may have to leave a position that the
/// sensors mistake for an obstacle.
///
/// Otherwise [`brake()`] limits the speed so that the robot can stop before anything that it sees,
/// whatever the gains. A vehicle that can turn on the spot still turns.
///
/// ```
/// use controller::limit::{Commanded, limit};
/// use controller::obstacles::Obstacles;
/// use controller::scan::points;
/// use robot_io::{Commands, Operator, Percepts, RangeReading, Reason};
/// let vehicle = plan_format::Parameters::default().vehicle;
/// let wanted = Commands { speed_mps: 1.0, ..Commands::stop(Reason::Driving) };
/// let operator = Operator { is_armed: true, ..Operator::default() };
/// let percepts = Percepts { operator, ..Percepts::default() };
/// let now = Commanded::default().now(&percepts, 0.0, &vehicle);
/// // The body has a radius of 0.3 m, brakes with 2 m/s^2 and stops 2 cm before an obstacle.
/// for (distance_m, low, high) in [(0.8, 1.0, 1.0), (0.5, 0.4, 0.8), (0.32, 0.0, 0.0)] {
///     let obstacle = RangeReading { bearing_rad: 0.0, distance_m };
///     let seen = points(&[obstacle]);
///     let near = Obstacles::near(&[obstacle], &seen, 5.0, &[], 0.0);
///     let speed_mps = limit(&vehicle, &percepts, &near, &now, wanted).speed_mps;
///     assert!((low..=high).contains(&speed_mps), "{distance_m}: {speed_mps}");
/// }
/// ```
pub fn limit(
    vehicle: &Vehicle,
    percepts: &Percepts,
    near: &Obstacles,
    now: &Moving,
    wanted: Commands,
) -> Commands {
    let operator = &percepts.operator;
    if operator.is_emergency_stop {
        return Commands::stop(Reason::EmergencyStop);
    }
    if !operator.is_armed {
        return Commands::stop(Reason::Disarmed);
    }
    if let Some(manual) = operator.manual {
        let by_hand = Commands {
            speed_mps: manual.speed_mps,
            turn_rate_radps: manual.turn_rate_radps,
            reason: Reason::Manual,
            ..wanted
        };
        return bounded(vehicle, by_hand);
    }
    let wanted = bounded(vehicle, wanted);
    let Commands { speed_mps, turn_rate_radps, .. } = wanted;
    let twist = Twist { speed_mps, turn_rate_radps };
    let braked = brake(vehicle, near, now, twist);
    let limited = match braked {
        Some(Twist { speed_mps, turn_rate_radps }) => {
            Commands { speed_mps, turn_rate_radps, ..wanted }
        }
        None => Commands { speed_mps: 0.0, reason: Reason::ObstacleStop, ..wanted },
    };
    bounded(vehicle, limited)
}

/// A vehicle that drives at most at the limit of a speed zone, m/s.
pub fn in_speed_zone(vehicle: &Vehicle, limit_mps: f32) -> Vehicle {
    Vehicle {
        max_speed_mps: vehicle.max_speed_mps.min(limit_mps),
        base_speed_mps: vehicle.base_speed_mps.min(limit_mps),
        cautious_speed_mps: vehicle.cautious_speed_mps.min(limit_mps),
        ..*vehicle
    }
}

/// Clamps to the vehicle's limits; a value that is not finite becomes 0.
fn bounded(vehicle: &Vehicle, commands: Commands) -> Commands {
    let within = |value: f32, most: f32| {
        // Adding 0 turns -0 into 0: targets disagree on its sign after a minimum or maximum.
        if value.is_finite() { scalar::clamp(value, -most, most) + 0.0 } else { 0.0 }
    };
    let speed_mps = within(commands.speed_mps, vehicle.max_speed_mps);
    let circle_m = circle_m(vehicle);
    let most_radps = if circle_m > 0.0 {
        vehicle.max_turn_rate_radps.min(speed_mps.abs() / circle_m)
    } else {
        vehicle.max_turn_rate_radps
    };
    let turn_rate_radps = within(commands.turn_rate_radps, most_radps);
    Commands { speed_mps, turn_rate_radps, ..commands }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::brake::within_m;
    use crate::scan::points;
    use plan_format::Parameters;
    use plan_format::parameters::Steering;
    use robot_io::{Manual, Operator, RangeReading};
    use std::format;

    fn facing(readings: &[(f32, f32)], operator: Operator) -> Percepts {
        let reading = |&(bearing_rad, distance_m)| RangeReading { bearing_rad, distance_m };
        Percepts { ranges: readings.iter().map(reading).collect(), operator, ..Percepts::default() }
    }

    fn armed() -> Operator {
        Operator { is_armed: true, ..Operator::default() }
    }

    fn wanted(speed_mps: f32, turn_rate_radps: f32) -> Commands {
        Commands { speed_mps, turn_rate_radps, ..Commands::stop(Reason::Driving) }
    }

    /// Limits the commands of a robot that has just begun to drive them.
    fn limit(vehicle: &Vehicle, percepts: &Percepts, wanted: Commands) -> Commands {
        let seen = points(&percepts.ranges);
        let now = Commanded::default().now(percepts, 0.0, vehicle);
        let near = Obstacles::near(&percepts.ranges, &seen, within_m(vehicle, &now), &[], 0.0);
        super::limit(vehicle, percepts, &near, &now, wanted)
    }

    /// The body has a radius of 0.3 m, the stop distance is 0.3 m.
    #[test]
    fn motion_towards_what_is_inside_the_stop_distance_is_stopped() {
        let vehicle = Parameters::paper().vehicle;
        let table = [
            // speed, bearing, distance, whether it is stopped
            (1.0, 0.0, 0.59, true),
            (1.0, 0.0, 0.75, false),
            (1.0, 0.0, 0.0, true),
            (1.0, 0.0, -1.0, true),
            (1.0, 0.4, 0.55, true),
            (1.0, -0.4, 0.55, true),
            (1.0, 1.2, 0.31, true),
            (1.0, 1.2, 0.40, false),
            (1.0, 1.6, 0.31, false),
            (1.0, 3.1, 0.4, false),
            (-1.0, 3.1, 0.4, true),
            (-1.0, 0.0, 0.4, false),
            (0.0, 0.0, 0.4, false),
        ];
        for (speed_mps, bearing_rad, distance_m, is_stopped) in table {
            let percepts = facing(&[(0.0, 9.0), (bearing_rad, distance_m)], armed());
            let commands = limit(&vehicle, &percepts, wanted(speed_mps, 0.1));
            let case = format!("{speed_mps} m/s, {bearing_rad} rad, {distance_m} m: {commands:?}");
            assert_eq!(commands.turn_rate_radps, 0.1, "{case}");
            assert_eq!(commands.reason == Reason::ObstacleStop, is_stopped, "{case}");
            assert_eq!(commands.speed_mps == 0.0, is_stopped || speed_mps == 0.0, "{case}");
            assert!(commands.speed_mps * speed_mps >= 0.0, "{case}");
        }
    }

    #[test]
    fn a_body_without_a_radius_is_stopped_too() {
        let vehicle = Vehicle { radius_m: 0.0, ..Parameters::paper().vehicle };
        let stopped = limit(&vehicle, &facing(&[(0.1, 0.25)], armed()), wanted(1.0, 0.0));
        assert_eq!(stopped, Commands::stop(Reason::ObstacleStop));
    }

    #[test]
    fn the_human_at_the_controls_is_bounded_by_the_vehicle_alone() {
        let vehicle = Parameters::paper().vehicle;
        let manual = Some(Manual { speed_mps: 9.0, turn_rate_radps: -9.0 });
        let percepts = facing(&[(0.0, 0.4)], Operator { manual, ..armed() });
        let commands = limit(&vehicle, &percepts, Commands::stop(Reason::NoFix));
        assert_eq!(commands, Commands { reason: Reason::Manual, ..wanted(1.6, -1.0) });
    }

    #[test]
    fn an_ackermann_vehicle_never_turns_tighter_than_its_circle() {
        let vehicle = Vehicle {
            steering: Steering::Ackermann,
            min_turn_radius_m: 2.0,
            ..Parameters::paper().vehicle
        };
        for (speed_mps, turn, expected) in [
            (1.0, 1.0, 0.5),
            (1.0, -1.0, -0.5),
            (-0.5, 1.0, 0.25),
            (0.0, 1.0, 0.0),
            (1.0, 0.1, 0.1),
        ] {
            let commands = limit(&vehicle, &facing(&[], armed()), wanted(speed_mps, turn));
            assert_eq!(commands, wanted(speed_mps, expected));
        }
        let stopped = limit(&vehicle, &facing(&[(0.0, 0.4)], armed()), wanted(1.0, 1.0));
        assert_eq!(stopped, Commands::stop(Reason::ObstacleStop));
    }

    #[test]
    fn zero_has_one_sign() {
        let vehicle = Parameters::default().vehicle;
        let commands = limit(&vehicle, &facing(&[], armed()), wanted(-0.0, -0.0));
        assert_eq!((commands.speed_mps.to_bits(), commands.turn_rate_radps.to_bits()), (0, 0));
    }

    /// Without odometry, the robot counts with the speed that it had, and with what its brakes of
    /// 2 m/s^2 have changed since, in at most 0.2 s.
    #[test]
    fn without_odometry_the_speed_changes_as_the_brakes_allow() {
        let vehicle = Parameters::default().vehicle;
        let resting = Commanded::default().now(&Percepts::default(), 0.0, &vehicle);
        for (elapsed_us, commanded_mps, expected_mps) in
            [(50_000, 0.0, 0.9), (100_000, 2.0, 1.2), (3_000_000, 0.0, 0.6), (100_000, 0.9, 0.9)]
        {
            let had = Moving { twist: Twist { speed_mps: 1.0, turn_rate_radps: 0.3 }, ..resting };
            let mut last = Commanded::default();
            last.commanded(1_000_000, &wanted(commanded_mps, 0.4), &had);
            let percepts = Percepts { time_us: 1_000_000 + elapsed_us, ..Percepts::default() };
            let Twist { speed_mps, turn_rate_radps } = last.now(&percepts, 0.0, &vehicle).twist;
            assert!((speed_mps - expected_mps).abs() < 1e-5, "{elapsed_us} us: {speed_mps}");
            assert_eq!(turn_rate_radps, 0.4);
        }
    }

    /// At 1.6 m/s the robot is too fast for the arc that it wants, and stays on its own.
    #[test]
    fn a_robot_that_brakes_hard_turns_as_the_brakes_say() {
        let vehicle = Parameters::default().vehicle;
        let percepts = Percepts {
            speed_mps: Some(1.6),
            turn_rate_radps: Some(0.8),
            ..facing(&[(0.0, 0.6)], armed())
        };
        let seen = points(&percepts.ranges);
        let near = Obstacles::near(&percepts.ranges, &seen, 5.0, &[], 0.0);
        let now = Commanded::default().now(&percepts, 0.0, &vehicle);
        let limited = super::limit(&vehicle, &percepts, &near, &now, wanted(1.6, 0.0));
        assert!(limited.turn_rate_radps > 0.4 && limited.reason == Reason::Driving, "{limited:?}");
    }

    #[test]
    fn a_speed_zone_limits_every_speed_of_the_vehicle() {
        let vehicle = Vehicle { cautious_speed_mps: 0.7, ..Parameters::default().vehicle };
        let speeds = |vehicle: Vehicle| {
            [vehicle.max_speed_mps, vehicle.base_speed_mps, vehicle.cautious_speed_mps]
        };
        assert_eq!(speeds(in_speed_zone(&vehicle, 0.5)), [0.5; 3]);
        assert_eq!(in_speed_zone(&vehicle, f32::INFINITY), vehicle);
        let limited = in_speed_zone(&vehicle, 0.5);
        assert_eq!((limited.radius_m, limited.braking_mps2), (0.3, 2.0));
    }
}
