//! Robots in one true world, tick by tick.
//!
//! A tick has three phases: all robots sense, then all exchange records with their pilots, then
//! all move. Each phase reads only the results of the phase before, so the order of the robots
//! does not matter. Robots see each other by their range sensors, and their bodies never overlap.

use crate::geometry::distance;
use crate::{Body, Outcome, Pilot, PilotError, Robot, Sensors, StepResult, TICK_US, World};
use robot_io::{CommandRecord, SensorRecord};

/// A simulation under way.
#[derive(Debug)]
pub struct Simulation<'w, S, P> {
    /// The true obstacles; the robots' maps may differ.
    truth: &'w World,
    robots: Vec<Robot<S, P>>,
    ticks: u64,
}

impl<'w, S: Sensors, P: Pilot> Simulation<'w, S, P> {
    /// A simulation before its first tick. The bodies start clear of the world and of each other.
    pub fn new(truth: &'w World, robots: impl IntoIterator<Item = Robot<S, P>>) -> Self {
        Self { truth, robots: robots.into_iter().collect(), ticks: 0 }
    }

    /// The robots in the order given to [`Simulation::new`].
    pub fn robots(&self) -> &[Robot<S, P>] {
        &self.robots
    }

    /// Whether the runs of all robots have ended.
    pub fn is_over(&self) -> bool {
        self.robots.iter().all(|robot| robot.outcome().ending.is_some())
    }

    /// Runs one tick of all robots. A robot whose run has ended stays in the world and drives on.
    pub fn step(&mut self) -> Result<(), PilotError> {
        let records = self.sense();
        let answers = self.exchange(&records)?;
        self.advance(&answers);
        self.ticks += 1;
        Ok(())
    }

    /// Runs until the runs of all robots have ended, and returns their outcomes in the order of
    /// the robots.
    pub fn finish(mut self) -> Result<Vec<Outcome>, PilotError> {
        while !self.is_over() {
            self.step()?;
        }
        Ok(self.robots.iter().map(|robot| robot.outcome().clone()).collect())
    }

    fn sense(&mut self) -> Vec<SensorRecord> {
        let bodies = self.bodies();
        let time_us = self.ticks * TICK_US;
        let robots = self.robots.iter_mut().enumerate();
        robots
            .map(|(index, robot)| robot.sense(self.truth, &others(&bodies, index), time_us))
            .collect()
    }

    fn exchange(&mut self, records: &[SensorRecord]) -> Result<Vec<CommandRecord>, PilotError> {
        let robots = self.robots.iter_mut().zip(records);
        robots.map(|(robot, record)| robot.exchange(record)).collect()
    }

    fn advance(&mut self, answers: &[CommandRecord]) {
        let seconds = TICK_US as f64 * 1e-6;
        let before = self.bodies();
        let mut after = before.clone();
        let mut results: Vec<StepResult> = after
            .iter_mut()
            .zip(answers)
            .map(|(body, answer)| body.step(&answer.commands, self.truth, seconds))
            .collect();
        keep_apart(&before, &mut after, &mut results);
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let moved = (after[index], results[index]);
            robot.arrive(&answers[index], moved, &others(&after, index));
        }
    }

    fn bodies(&self) -> Vec<Body> {
        self.robots.iter().map(|robot| *robot.body()).collect()
    }
}

impl<S: Sensors, P: Pilot> Robot<S, P> {
    /// Runs this robot to the end, alone in a world.
    pub fn run(self, truth: &World) -> Result<Outcome, PilotError> {
        let outcomes = Simulation::new(truth, [self]).finish()?;
        Ok(outcomes.into_iter().next().expect("one robot has one outcome"))
    }
}

/// All bodies but one.
fn others(bodies: &[Body], index: usize) -> Vec<Body> {
    let before = bodies[..index].iter();
    before.chain(&bodies[index + 1..]).copied().collect()
}

/// Puts bodies that would overlap back to where they were before the tick, and counts that as a
/// touch. All of them go back, so that none has precedence. A body that goes back may block
/// another one, which then goes back too.
fn keep_apart(before: &[Body], after: &mut [Body], results: &mut [StepResult]) {
    let mut has_stayed = vec![false; after.len()];
    loop {
        let clash = |index: usize| {
            let body = after[index];
            others(after, index).iter().any(|other| {
                let least_m = body.chassis.radius_m + other.chassis.radius_m;
                distance(body.position, other.position) < least_m
            })
        };
        let staying: Vec<usize> =
            (0..after.len()).filter(|&index| !has_stayed[index] && clash(index)).collect();
        if staying.is_empty() {
            return;
        }
        for index in staying {
            has_stayed[index] = true;
            after[index].position = before[index].position;
            after[index].velocity_mps = [0.0; 2];
            results[index] = StepResult { distance_m: 0.0, touched: true, ..results[index] };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Chassis, Ending, Limits, Point, SensorSettings, SensorSuite};
    use maps::Reference;
    use math::GeoPoint;
    use robot_io::{Commands, Reason, Receiver};

    /// Drives ahead until a range reading ahead is nearer than `distance_m`, then turns away.
    /// Hashes every byte of its sensor records.
    struct TurnsAway {
        distance_m: f32,
        hash: u64,
    }

    impl Pilot for TurnsAway {
        fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
            for byte in sensors.to_bytes().expect("it fits").into_iter() {
                self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
            }
            let ahead = |reading: &&robot_io::RangeReading| reading.bearing_rad.abs() < 0.3;
            let nearest =
                sensors.ranges.iter().flatten().filter(ahead).map(|reading| reading.distance_m);
            let is_free = nearest.fold(f32::INFINITY, f32::min) >= self.distance_m;
            let (speed_mps, turn_rate_radps) = if is_free { (1.0, 0.0) } else { (0.3, 0.8) };
            let commands =
                Commands { speed_mps, turn_rate_radps, ..Commands::stop(Reason::Driving) };
            let receiver = Receiver::Sound;
            Ok(CommandRecord {
                time_us: 0,
                commands,
                trace_hash: self.hash,
                instructions: 0,
                receiver,
                checks: robot_io::Checks::default(),
            })
        }
    }

    /// Position, heading in radians and the distance of [`TurnsAway`] in metres.
    type Start = (Point, f64, f32);

    fn outcomes(starts: &[Start]) -> Vec<Outcome> {
        let world = World::new([]);
        let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
        let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
        let robots = starts.iter().map(|&(position, heading_rad, distance_m)| {
            // The seed depends on the robot, not on its index in the list.
            let seed = position[0].to_bits();
            let sensors = SensorSuite::new(SensorSettings::USUAL, &reference, seed);
            let body = Body::new(Chassis::default(), position, heading_rad);
            let limits = Limits { time_s: 20.0, ..Limits::to_goal([99.0, 99.0]) };
            Robot::new(body, sensors, TurnsAway { distance_m, hash: 0 }, limits)
        });
        Simulation::new(&world, robots).finish().expect("these pilots always answer")
    }

    /// Two robots that avoid each other, two that collide, and three with one hit while it turns.
    #[test]
    fn the_order_of_the_robots_does_not_matter() {
        use std::f64::consts::PI;
        let (west, east) = (([-6.0, 0.1], 0.0, 3.0), ([6.0, 0.0], PI, 2.0));
        let (blind, north) = (([7.0, -0.2], PI, 0.0), ([0.5, 6.0], -PI / 2.0, 0.5));
        for starts in [vec![west, east], vec![west, blind], vec![west, blind, north]] {
            let forwards = outcomes(&starts);
            let mut reversed: Vec<Start> = starts.clone();
            reversed.reverse();
            let mut backwards = outcomes(&reversed);
            backwards.reverse();
            assert_eq!(forwards, backwards, "{starts:?}");
            for (start, outcome) in starts.iter().zip(&forwards) {
                let alone = &outcomes(&[*start])[0];
                let has_met = outcome.closest_m < 10.0;
                assert!(has_met && alone.trace_hash != outcome.trace_hash, "{start:?}");
            }
        }
    }

    #[test]
    fn bodies_that_collide_touch_once_and_do_not_overlap() {
        use std::f64::consts::PI;
        let both = outcomes(&[([-4.0, 0.0], 0.0, 0.0), ([4.0, 0.0], PI, 0.0)]);
        for outcome in &both {
            assert_eq!(outcome.ending, Some(Ending::OutOfTime));
            assert_eq!(outcome.touches, 1);
            assert!((0.0..0.1).contains(&outcome.closest_m), "{outcome:?}");
        }
        assert!((both[0].distance_m - both[1].distance_m).abs() < 1e-9, "{both:?}");
    }

    /// In a row of three, the first body stops the second, and the second stops the third.
    #[test]
    fn a_body_that_goes_back_blocks_the_next() {
        let at = |x: f64| Body::new(Chassis::default(), [x, 0.0], 0.0);
        let before = [at(0.0), at(0.7), at(1.4)];
        let mut after = [at(0.0), at(0.5), at(1.2)];
        let moved = StepResult { distance_m: 0.2, ..StepResult::default() };
        let mut results = [StepResult::default(), moved, moved];
        keep_apart(&before, &mut after, &mut results);
        assert_eq!(after.map(|body| body.position), before.map(|body| body.position));
        assert!(results.iter().all(|result| result.touched && result.distance_m == 0.0));
    }
}
