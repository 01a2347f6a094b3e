//! The robot's body: a disc that drives and turns within limits.
//!
//! A step moves the body along short chords of its arc. Contact is tested along the whole chord,
//! so that no speed is too high and no body too small for the test.

use crate::geometry::{distance, wrapped};
use crate::{Point, World};
use math::scalar::wide;
use plan_format::parameters::{Steering, Vehicle};
use robot_io::Commands;

/// Obstacles farther from the body than this do not count for the closest approach, metres.
pub(crate) const LOOK_M: f64 = 10.0;
/// Smallest radius of a body in contact, metres. A body without a radius touches too.
const POINT_M: f64 = 0.001;
/// Time constant of a boat's sideways drift, seconds: the drag of its hull.
const DRIFT_S: f64 = 0.5;

/// Size and limits of a body. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chassis {
    /// Radius of the disc, metres.
    pub radius_m: f64,
    /// How it turns. An Ackermann vehicle never turns tighter than `min_turn_radius_m`. A boat
    /// turns on a circle of at least its own radius, and drifts outwards.
    pub steering: Steering,
    /// Smallest turning radius, metres; not for differential steering.
    pub min_turn_radius_m: f64,
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
    /// Share of the wheels' motion that is lost to slip, 0 to 1. The odometry measures the wheels.
    pub slip: f64,
}

impl Default for Chassis {
    fn default() -> Self {
        Self {
            radius_m: 0.3,
            steering: Steering::Differential,
            min_turn_radius_m: 0.0,
            max_speed_mps: 2.0,
            acceleration_mps2: 1.5,
            braking_mps2: 3.0,
            max_turn_rate_radps: 1.5,
            turn_acceleration_radps2: 6.0,
            drift_radps: 0.0,
            slip: 0.0,
        }
    }
}

impl Chassis {
    /// The body of a mission's vehicle: its size, its steering, its limits and its brakes. What it
    /// gains in speed and turn rate is the default.
    pub fn of(vehicle: &Vehicle) -> Self {
        Self {
            radius_m: vehicle.radius_m.into(),
            steering: vehicle.steering,
            min_turn_radius_m: vehicle.min_turn_radius_m.into(),
            max_speed_mps: vehicle.max_speed_mps.into(),
            braking_mps2: vehicle.braking_mps2.into(),
            max_turn_rate_radps: vehicle.max_turn_rate_radps.into(),
            ..Self::default()
        }
    }

    /// The highest turn rate at a speed, rad/s.
    fn most_turn_radps(&self, speed_mps: f64) -> f64 {
        let circle_m = match self.steering {
            Steering::Differential => 0.0,
            Steering::Ackermann => self.min_turn_radius_m,
            Steering::Boat => self.min_turn_radius_m.max(self.radius_m),
        };
        let most = self.max_turn_rate_radps;
        if circle_m > 0.0 { most.min(speed_mps.abs() / circle_m) } else { most }
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
    /// Speed to the left at which a boat drifts, m/s.
    pub sideways_mps: f64,
    /// True velocity of the centre in the last step, m/s.
    pub velocity_mps: Point,
}

/// What happened during one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepResult {
    /// Distance driven, metres.
    pub distance_m: f64,
    /// Whether the body touched an obstacle, another body or a disc by its own motion.
    pub touched: bool,
    /// Whether another body or a disc ran into it, which it did not move towards or could not have
    /// seen in time to stop.
    pub struck: bool,
    /// Smallest gap to anything on the way, metres; infinite if none was near.
    pub closest_m: f64,
}

impl Default for StepResult {
    fn default() -> Self {
        Self { distance_m: 0.0, touched: false, struck: false, closest_m: f64::INFINITY }
    }
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
            sideways_mps: 0.0,
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
        let radius_m = self.chassis.radius_m.max(POINT_M);
        // Pieces shorter than half the radius follow the arc closely.
        let reach = self.speed_mps.abs() * seconds;
        let pieces = (2.0 * reach / self.chassis.radius_m.max(0.05)).ceil().clamp(1.0, 64.0);
        let piece_s = seconds / pieces;
        for _ in 0..pieces as usize {
            let before = self.position;
            self.coast(piece_s);
            let nearest = world.nearest_along(before, self.position, LOOK_M.max(radius_m));
            if let Some(distance_m) = nearest {
                result.closest_m = result.closest_m.min((distance_m - radius_m).max(0.0));
                if distance_m < radius_m {
                    result.touched = true;
                    self.slide(before, radius_m, world);
                }
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

        let most = chassis.most_turn_radps(self.speed_mps);
        let wanted = f64::from(commands.turn_rate_radps).clamp(-most, most);
        let change = chassis.turn_acceleration_radps2 * seconds;
        let turn_rate_radps = approach(self.turn_rate_radps, wanted, change);
        // A vehicle that brakes turns less at once: its wheels stay on their circle.
        self.turn_rate_radps = turn_rate_radps.clamp(-most, most);
    }

    /// Moves along the arc that speed and turn rate describe. A boat also drifts sideways: its
    /// hull keeps the direction of its motion while it turns, and loses the sideways part to drag.
    fn coast(&mut self, seconds: f64) {
        let drift_radps = if self.speed_mps == 0.0 { 0.0 } else { self.chassis.drift_radps };
        let turn = (self.turn_rate_radps + drift_radps) * seconds;
        // The chord of the arc has the mean heading; its length differs from the arc's by
        // turn^2 / 24, less than a thousandth at these turn rates.
        let heading = self.heading_rad + turn / 2.0;
        let distance_m = self.speed_mps * (1.0 - self.chassis.slip) * seconds;
        self.position[0] += distance_m * wide::cos(heading);
        self.position[1] += distance_m * wide::sin(heading);
        if self.chassis.steering == Steering::Boat {
            let kept = wide::exp(-seconds / DRIFT_S);
            // The exact step towards the steady drift of this turn.
            let steady_mps = -self.speed_mps * turn / seconds * DRIFT_S;
            self.sideways_mps = steady_mps + kept * (self.sideways_mps - steady_mps);
            self.position[0] -= self.sideways_mps * seconds * wide::sin(heading);
            self.position[1] += self.sideways_mps * seconds * wide::cos(heading);
        }
        self.heading_rad = wrapped(self.heading_rad + turn);
    }

    /// Moves from `before`, where the body is clear, towards its present position, along the
    /// surfaces that it touches.
    fn slide(&mut self, before: Point, radius_m: f64, world: &World) {
        let way = [0, 1].map(|axis| self.position[axis] - before[axis]);
        self.sideways_mps = 0.0;
        self.position = before;
        // So short that a step never carries the centre through a surface.
        let steps = (8.0 * wide::hypot(way[0], way[1]) / radius_m).ceil().max(1.0);
        for _ in 0..steps as usize {
            let to = [0, 1].map(|axis| self.position[axis] + way[axis] / steps);
            match world.pushed_clear(to, radius_m) {
                None => self.position = to,
                Some(Some(position)) => self.position = position,
                // A corner: nothing beyond it is clear.
                Some(None) => return,
            }
        }
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
    fn wheels_that_slip_measure_more_than_the_way() {
        let world = World::new([]);
        let chassis = Chassis { slip: 0.25, ..Chassis::default() };
        let mut body = Body::new(chassis, [0.0, 0.0], 0.0);
        body.speed_mps = 1.0;
        for _ in 0..200 {
            body.step(&ahead(1.0, 0.0), &world, 0.05);
        }
        assert!((body.position[0] - 7.5).abs() < 1e-9 && body.speed_mps == 1.0, "{body:?}");
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

    /// A thin wall across the way, at 2 m. Small bodies and those without a radius touch it too.
    #[test]
    fn speed_carries_no_body_through_a_wall() {
        let wall = Shape::Polyline(vec![[2.0, -5.0], [2.0, 5.0]]);
        let world = World::new([&wall]);
        for (radius_m, speed_mps) in [(0.3, 8.0), (0.05, 8.0), (0.01, 50.0), (0.0, 50.0)] {
            let chassis = Chassis { radius_m, max_speed_mps: 50.0, ..Chassis::default() };
            let mut body = Body::new(chassis, [0.0, 0.0], 0.0);
            body.speed_mps = speed_mps;
            let results: Vec<StepResult> =
                (0..40).map(|_| body.step(&ahead(speed_mps as f32, 0.0), &world, 0.05)).collect();
            assert!(results.iter().any(|result| result.touched), "{radius_m} {speed_mps}");
            assert!(body.position[0] <= 2.0 - radius_m + 1e-6, "{radius_m} {speed_mps} {body:?}");
        }
    }

    /// A post of 5 mm beside the way: the body's edge passes it at any tick's end.
    #[test]
    fn a_graze_between_two_ticks_counts() {
        for (aside_m, touches) in [(0.304, true), (0.306, false)] {
            let post = Shape::Circle { centre: [5.0, aside_m], radius: 0.005 };
            let world = World::new([&post]);
            let chassis = Chassis { max_speed_mps: 8.0, ..Chassis::default() };
            let mut body = Body::new(chassis, [0.03, 0.0], 0.0);
            body.speed_mps = 8.0;
            let results: Vec<StepResult> =
                (0..20).map(|_| body.step(&ahead(8.0, 0.0), &world, 0.05)).collect();
            assert_eq!(results.iter().any(|result| result.touched), touches, "{aside_m}");
            let closest_m = results.iter().map(|result| result.closest_m).fold(9.0, f64::min);
            assert!((closest_m - (aside_m - 0.305).max(0.0)).abs() < 1e-9, "{closest_m}");
        }
    }

    /// Half a turn at full lock: across is twice the radius.
    #[test]
    fn a_car_turns_on_its_circle_and_not_on_the_spot() {
        let world = World::new([]);
        let chassis =
            Chassis { steering: Steering::Ackermann, min_turn_radius_m: 2.0, ..Chassis::default() };
        let mut body = Body::new(chassis, [0.0, 0.0], 0.0);
        for _ in 0..100 {
            body.step(&ahead(0.0, 1.5), &world, 0.05);
        }
        assert_eq!((body.heading_rad, body.position), (0.0, [0.0, 0.0]));
        let mut north_m: f64 = 0.0;
        for _ in 0..300 {
            body.step(&ahead(1.0, 1.5), &world, 0.05);
            assert!(body.turn_rate_radps <= body.speed_mps / 2.0 + 1e-12, "{body:?}");
            north_m = north_m.max(body.position[1]);
        }
        assert!((north_m - 4.0).abs() < 0.1, "{north_m}");
        body.step(&Commands::stop(Reason::EmergencyStop), &world, 0.05);
        assert!(body.turn_rate_radps <= body.speed_mps / 2.0 + 1e-12, "{body:?}");
    }

    /// The wheels stay on their circle, so the turn rate falls with the speed at once.
    #[test]
    fn a_car_that_brakes_hard_stays_on_its_circle() {
        let world = World::new([]);
        let chassis = Chassis {
            steering: Steering::Ackermann,
            min_turn_radius_m: 0.3,
            braking_mps2: 10.0,
            max_turn_rate_radps: 3.0,
            ..Chassis::default()
        };
        let mut body = Body::new(chassis, [0.0, 0.0], 0.0);
        (body.speed_mps, body.turn_rate_radps) = (0.9, 3.0);
        body.step(&ahead(0.0, 3.0), &world, 0.05);
        assert!((body.speed_mps - 0.4).abs() < 1e-9, "{body:?}");
        assert!((body.turn_rate_radps - 0.4 / 0.3).abs() < 1e-9, "{body:?}");
    }

    #[test]
    fn a_boat_drifts_outwards_while_it_turns_and_not_afterwards() {
        let world = World::new([]);
        let path = |steering| {
            let chassis = Chassis { steering, ..Chassis::default() };
            let mut body = Body::new(chassis, [0.0, 0.0], 0.0);
            for _ in 0..60 {
                body.step(&ahead(1.0, 0.5), &world, 0.05);
            }
            body
        };
        let (rover, boat) = (path(Steering::Differential), path(Steering::Boat));
        assert_eq!(rover.sideways_mps, 0.0);
        // In a steady turn the drift is speed x turn rate x the time constant, to the outside.
        assert!((boat.sideways_mps + 0.25).abs() < 0.002, "{boat:?}");
        assert!(boat.position[0] > rover.position[0] + 0.2, "{boat:?} {rover:?}");
        let mut boat = boat;
        for _ in 0..100 {
            boat.step(&ahead(1.0, 0.0), &world, 0.05);
        }
        assert!(boat.sideways_mps.abs() < 1e-3, "{boat:?}");
        let mut standing = Body::new(boat.chassis, [0.0, 0.0], 0.0);
        standing.step(&ahead(0.0, 1.0), &world, 0.05);
        assert_eq!(standing.heading_rad, 0.0);
    }

    #[test]
    fn a_body_has_the_numbers_of_its_vehicle() {
        let vehicle = Vehicle {
            steering: Steering::Ackermann,
            radius_m: 0.5,
            max_speed_mps: 8.0,
            max_turn_rate_radps: 4.0,
            min_turn_radius_m: 2.5,
            braking_mps2: 4.0,
            ..plan_format::Parameters::default().vehicle
        };
        let chassis = Chassis::of(&vehicle);
        let expected = Chassis {
            radius_m: 0.5,
            steering: Steering::Ackermann,
            min_turn_radius_m: 2.5,
            max_speed_mps: 8.0,
            braking_mps2: 4.0,
            max_turn_rate_radps: 4.0,
            ..Chassis::default()
        };
        assert_eq!(chassis, expected);
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
