//! The robot's body: a disc that drives and turns within limits.

use crate::geometry::{distance, wrapped};
use crate::{Point, World};
use math::scalar::wide;
use robot_io::Commands;

/// Size and limits of a body. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chassis {
    /// Radius of the disc, metres.
    pub radius_m: f64,
    /// Highest speed ahead or astern, m/s.
    pub max_speed_mps: f64,
    /// Acceleration while the speed grows, m/s^2.
    pub acceleration_mps2: f64,
    /// Deceleration while the speed falls, m/s^2.
    pub braking_mps2: f64,
    /// Highest turn rate in either direction, rad/s.
    pub max_turn_rate_radps: f64,
    /// Change of the turn rate, rad/s^2.
    pub turn_acceleration_radps2: f64,
    /// Turn rate that unequal wheels add while they roll, rad/s counter-clockwise. The odometry
    /// does not measure it.
    pub drift_radps: f64,
}

impl Default for Chassis {
    fn default() -> Self {
        Self {
            radius_m: 0.3,
            max_speed_mps: 2.0,
            acceleration_mps2: 1.5,
            braking_mps2: 3.0,
            max_turn_rate_radps: 1.5,
            turn_acceleration_radps2: 6.0,
            drift_radps: 0.0,
        }
    }
}

/// A body in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Its size and limits.
    pub chassis: Chassis,
    /// Centre of the disc, metres.
    pub position: Point,
    /// Heading, radians counter-clockwise from east, in [-pi, pi).
    pub heading_rad: f64,
    /// Speed of the wheels, m/s ahead.
    pub speed_mps: f64,
    /// Turn rate of the wheels, rad/s counter-clockwise.
    pub turn_rate_radps: f64,
    /// True velocity of the centre in the last step, m/s.
    pub velocity_mps: Point,
}

/// What happened during one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepResult {
    /// Distance driven, metres.
    pub distance_m: f64,
    /// Whether the body touched an obstacle or another body.
    pub touched: bool,
}

impl Body {
    /// A body at rest.
    pub fn new(chassis: Chassis, position: Point, heading_rad: f64) -> Self {
        Self {
            chassis,
            position,
            heading_rad,
            speed_mps: 0.0,
            turn_rate_radps: 0.0,
            velocity_mps: [0.0; 2],
        }
    }

    /// Follows the commands for `seconds`, as far as limits and obstacles allow. Contact is
    /// inelastic and without friction: the part of the motion that points into an obstacle is
    /// removed, and the body slides along its surface.
    pub fn step(&mut self, commands: &Commands, world: &World, seconds: f64) -> StepResult {
        self.obey(commands, seconds);
        let mut result = StepResult::default();
        let start = self.position;
        // Pieces shorter than half the radius cannot tunnel through a wall.
        let reach = self.speed_mps.abs() * seconds;
        let pieces = (2.0 * reach / self.chassis.radius_m.max(0.05)).ceil().clamp(1.0, 64.0);
        let piece_s = seconds / pieces;
        for _ in 0..pieces as usize {
            let before = self.position;
            self.coast(piece_s);
            if let Some(position) = world.pushed_clear(self.position, self.chassis.radius_m) {
                result.touched = true;
                self.position = position.unwrap_or(before);
            }
            result.distance_m += distance(before, self.position);
        }
        self.velocity_mps = [0, 1].map(|axis| (self.position[axis] - start[axis]) / seconds);
        result
    }

    /// Brings speed and turn rate towards the commands, within the limits.
    fn obey(&mut self, commands: &Commands, seconds: f64) {
        let chassis = &self.chassis;
        let wanted = f64::from(commands.speed_mps);
        let wanted = wanted.clamp(-chassis.max_speed_mps, chassis.max_speed_mps);
        let slows = wanted * self.speed_mps < 0.0 || wanted.abs() < self.speed_mps.abs();
        let rate = if slows { chassis.braking_mps2 } else { chassis.acceleration_mps2 };
        self.speed_mps = approach(self.speed_mps, wanted, rate * seconds);

        let wanted = f64::from(commands.turn_rate_radps);
        let wanted = wanted.clamp(-chassis.max_turn_rate_radps, chassis.max_turn_rate_radps);
        let change = chassis.turn_acceleration_radps2 * seconds;
        self.turn_rate_radps = approach(self.turn_rate_radps, wanted, change);
    }

    /// Moves along the arc that speed and turn rate describe.
    fn coast(&mut self, seconds: f64) {
        let drift_radps = if self.speed_mps == 0.0 { 0.0 } else { self.chassis.drift_radps };
        let turn = (self.turn_rate_radps + drift_radps) * seconds;
        // The chord of the arc has the mean heading; its length differs from the arc's by
        // turn^2 / 24, less than a thousandth at these turn rates.
        let heading = self.heading_rad + turn / 2.0;
        let distance_m = self.speed_mps * seconds;
        self.position[0] += distance_m * wide::cos(heading);
        self.position[1] += distance_m * wide::sin(heading);
        self.heading_rad = wrapped(self.heading_rad + turn);
    }
}

fn approach(from: f64, to: f64, most: f64) -> f64 {
    from + (to - from).clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::Shape;
    use robot_io::Reason;

    fn ahead(speed_mps: f32, turn_rate_radps: f32) -> Commands {
        Commands { speed_mps, turn_rate_radps, ..Commands::stop(Reason::Driving) }
    }

    #[test]
    fn speed_and_turn_rate_stay_within_the_limits() {
        let world = World::new([]);
        let mut body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
        for _ in 0..100 {
            let before = body;
            body.step(&ahead(99.0, -99.0), &world, 0.05);
            assert!(body.speed_mps - before.speed_mps <= 1.5 * 0.05 + 1e-12);
            assert!(body.speed_mps <= 2.0 && body.turn_rate_radps >= -1.5);
        }
        let stop = Commands::stop(Reason::EmergencyStop);
        let braked_m: f64 = (0..100).map(|_| body.step(&stop, &world, 0.05).distance_m).sum();
        assert!((braked_m - 0.62).abs() < 0.06, "2 m/s at 3 m/s^2: stopped after {braked_m} m");
        assert_eq!(body.speed_mps, 0.0);
    }

    #[test]
    fn unequal_wheels_turn_a_body_that_rolls_and_not_one_that_stands() {
        let world = World::new([]);
        let chassis = Chassis { drift_radps: 0.03, ..Chassis::default() };
        let mut body = Body::new(chassis, [0.0, 0.0], 0.0);
        for _ in 0..200 {
            body.step(&ahead(0.0, 0.0), &world, 0.05);
        }
        assert_eq!(body.heading_rad, 0.0);
        for _ in 0..200 {
            body.step(&ahead(1.0, 0.0), &world, 0.05);
        }
        assert!((body.heading_rad - 0.3).abs() < 1e-9, "{body:?}");
        assert_eq!(body.turn_rate_radps, 0.0);
    }

    #[test]
    fn a_body_slides_along_a_wall_and_never_enters_it() {
        let wall = Shape::Polyline(vec![[2.0, -5.0], [2.0, 5.0]]);
        let world = World::new([&wall]);
        let mut body = Body::new(Chassis::default(), [0.0, 0.0], 0.6);
        let mut touched = false;
        for _ in 0..80 {
            touched |= body.step(&ahead(1.0, 0.0), &world, 0.05).touched;
            assert!(body.position[0] <= 2.0 - 0.3 + 1e-9, "{body:?}");
        }
        assert!(touched);
        assert!(body.position[1] > 1.5, "it slid along: {body:?}");
    }

    #[test]
    fn a_corner_stops_a_body() {
        let corner = Shape::Polyline(vec![[2.0, -5.0], [2.0, 1.0], [-5.0, 1.0]]);
        let world = World::new([&corner]);
        let mut body = Body::new(Chassis::default(), [0.0, 0.0], 0.5);
        for _ in 0..200 {
            body.step(&ahead(2.0, 0.0), &world, 0.05);
        }
        let clearance = world.nearest(body.position, 10.0).expect("a wall is near").distance_m;
        assert!((0.3 - 1e-9..0.31).contains(&clearance), "{clearance} {body:?}");
    }
}
