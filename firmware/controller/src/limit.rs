//! The last word: operator, obstacles, and the vehicle's limits.

use math::scalar;
use plan_format::parameters::{Steering, Vehicle};
use robot_io::{Commands, Percepts, RangeReading, Reason};

/// What the robot does of what it wants.
///
/// Emergency stop, disarm and manual override outrank everything, in this order. A manual
/// command is bounded by what the vehicle can do and by nothing else: the human who steers
/// may have to leave a place that the sensors take for an obstacle.
///
/// Without them, motion towards any range reading inside the stop distance is stopped,
/// whatever the gains. A vehicle that can turn on the spot still turns.
pub fn limit(vehicle: &Vehicle, percepts: &Percepts, wanted: Commands) -> Commands {
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
    let is_stopped = wanted.speed_mps != 0.0
        && percepts.ranges.iter().any(|reading| is_in_the_way(vehicle, wanted.speed_mps, reading));
    if is_stopped {
        return bounded(
            vehicle,
            Commands { speed_mps: 0.0, reason: Reason::ObstacleStop, ..wanted },
        );
    }
    bounded(vehicle, wanted)
}

/// Whether the body would touch the reading's point if it moved on straight, and the point is
/// inside the stop distance. What is beside the body does not count: along a wall the robot
/// may go however near it is.
fn is_in_the_way(vehicle: &Vehicle, speed_mps: f32, reading: &RangeReading) -> bool {
    let gap_m = reading.distance_m - vehicle.radius_m;
    // The comparison comes first because most readings are far away and cost no more than it.
    if gap_m >= vehicle.stop_distance_m {
        return false;
    }
    let ahead = scalar::cos(reading.bearing_rad) * speed_mps;
    // A body without a radius must be stopped, too; so the swept path has a least width.
    let half_width_m = vehicle.radius_m.max(0.5 * vehicle.stop_distance_m);
    let aside_m = scalar::sin(reading.bearing_rad) * reading.distance_m;
    ahead > 0.0 && aside_m.abs() <= half_width_m
}

/// Within the vehicle's limits; whatever is not a number stands still.
fn bounded(vehicle: &Vehicle, commands: Commands) -> Commands {
    let within = |value: f32, most: f32| {
        if value.is_finite() { scalar::clamp(value, -most, most) } else { 0.0 }
    };
    let speed_mps = within(commands.speed_mps, vehicle.max_speed_mps);
    let turns_on_circles =
        vehicle.steering == Steering::Ackermann && vehicle.min_turn_radius_m > 0.0;
    let most_radps = if turns_on_circles {
        vehicle.max_turn_rate_radps.min(speed_mps.abs() / vehicle.min_turn_radius_m)
    } else {
        vehicle.max_turn_rate_radps
    };
    let turn_rate_radps = within(commands.turn_rate_radps, most_radps);
    Commands { speed_mps, turn_rate_radps, ..commands }
}
