//! The robot's body: a disc that drives forward and turns, within limits.

use crate::{Point, World};
use math::scalar::wide;
use robot_io::Commands;
use std::f64::consts::{PI, TAU};

/// What a body can do. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chassis {
    /// The body is a disc of this radius, metres.
    pub radius_m: f64,
    /// Never faster than this, ahead or astern, m/s.
    pub max_speed_mps: f64,
    /// Change of speed, m/s^2, when it grows ...
    pub acceleration_mps2: f64,
    /// ... and when it shrinks.
    pub braking_mps2: f64,
    /// Never turns faster than this, rad/s.
    pub max_turn_rate_radps: f64,
    /// Change of the turn rate, rad/s^2.
    pub turn_acceleration_radps2: f64,
    /// Turn rate that unequal wheels add while they roll, rad/s counter-clockwise. No sensor on
    /// the wheels notices it.
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

/// A body somewhere in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// What it can do.
    pub chassis: Chassis,
    /// Centre of the disc, metres.
    pub position: Point,
    /// Radians counter-clockwise from east, in [-pi, pi).
    pub heading_rad: f64,
    /// What the wheels do, m/s ahead.
    pub speed_mps: f64,
    /// rad/s counter-clockwise.
    pub turn_rate_radps: f64,
    /// How the centre truly moved in the last step, m/s.
    pub velocity_mps: Point,
}

/// What happened during one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Length of the way, metres.
    pub distance_m: f64,
    /// Something was in the way, and was touched.
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
    /// inelastic and without friction: what points into an obstacle is removed, the rest
    /// slides along it.
    pub fn step(&mut self, commands: &Commands, world: &World, seconds: f64) -> Motion {
        self.obey(commands, seconds);
        let mut motion = Motion::default();
        let start = self.position;
        // Pieces shorter than half the radius cannot tunnel through a wall.
        let reach = self.speed_mps.abs() * seconds;
        let pieces = (2.0 * reach / self.chassis.radius_m.max(0.05)).ceil().clamp(1.0, 64.0);
        let piece_s = seconds / pieces;
        for _ in 0..pieces as usize {
            let before = self.position;
            self.coast(piece_s);
            if let Some(position) = world.pushed_clear(self.position, self.chassis.radius_m) {
                motion.touched = true;
                self.position = position.unwrap_or(before);
            }
            motion.distance_m += distance(before, self.position);
        }
        self.velocity_mps = [0, 1].map(|axis| (self.position[axis] - start[axis]) / seconds);
        motion
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

    /// Moves along the arc that speed and turn rate make.
    fn coast(&mut self, seconds: f64) {
        let drift_radps = if self.speed_mps == 0.0 { 0.0 } else { self.chassis.drift_radps };
        let turn = (self.turn_rate_radps + drift_radps) * seconds;
        // The chord of the arc has the mean heading; its length differs from the arc's by
        // turn^2 / 24, less than a thousandth at these turn rates.
        let heading = self.heading_rad + turn / 2.0;
        let way = self.speed_mps * seconds;
        self.position[0] += way * wide::cos(heading);
        self.position[1] += way * wide::sin(heading);
        self.heading_rad = wrapped(self.heading_rad + turn);
    }
}

/// Distance between two points, metres.
pub fn distance(a: Point, b: Point) -> f64 {
    wide::hypot(a[0] - b[0], a[1] - b[1])
}

/// The same angle in [-pi, pi).
pub fn wrapped(radians: f64) -> f64 {
    radians - TAU * wide::floor((radians + PI) / TAU)
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
        let way: f64 = (0..100).map(|_| body.step(&stop, &world, 0.05).distance_m).sum();
        assert!((way - 0.62).abs() < 0.06, "braking from 2 m/s at 3 m/s^2 took {way} m");
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
    fn a_corner_holds_a_body_still() {
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
