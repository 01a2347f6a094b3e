//! Robots and moving discs in one true world, tick by tick.
//!
//! A tick has three phases: all robots sense, then all exchange records with their pilots, then
//! all move. Each phase reads only the results of the phase before, so the order of the robots
//! does not matter. Robots see each other and the discs by their range sensors, and bodies and discs
//! never overlap.
//!
//! [`crate::sighting`] says when a robot is to blame that touches a disc.

mod movers;

use crate::body::LOOK_M;
use crate::geometry::Circle;
use crate::sighting::Sighting;
use crate::{
    Body, Disc, Links, Outcome, Pilot, PilotError, Point, Radio, Robot, Sensors, StepResult,
    TICK_US, World, world,
};
use movers::{Contact, Mover, keep_apart};
use robot_io::{CommandRecord, RangeReading, SensorRecord};

/// A simulation under way.
#[derive(Debug)]
pub struct Simulation<'w, S, P> {
    /// The true obstacles; the robots' maps may differ.
    truth: &'w World,
    robots: Vec<Robot<S, P>>,
    discs: Vec<Moving>,
    /// For each robot, what its sensors reported of each disc.
    sightings: Vec<Vec<Sighting>>,
    radio: Option<Radio<'w>>,
    ticks: u64,
}

impl<'w, S: Sensors, P: Pilot> Simulation<'w, S, P> {
    /// A simulation before its first tick. The bodies start clear of the world and of each other.
    pub fn new(truth: &'w World, robots: impl IntoIterator<Item = Robot<S, P>>) -> Self {
        let robots: Vec<Robot<S, P>> = robots.into_iter().collect();
        let sightings = vec![Vec::new(); robots.len()];
        Self { truth, robots, discs: Vec::new(), sightings, radio: None, ticks: 0 }
    }

    /// Adds moving discs, each at the start of its path.
    pub fn with_discs(mut self, discs: &[Disc]) -> Self {
        self.discs.extend(discs.iter().map(|disc| Moving { disc: disc.clone(), moved_m: 0.0 }));
        for seen in &mut self.sightings {
            seen.resize(self.discs.len(), Sighting::default());
        }
        self
    }

    /// Lets the robots hear of each other over radio.
    pub fn with_radio(mut self, radio: Radio<'w>) -> Self {
        self.radio = Some(radio);
        self
    }

    /// Which robots reach each other now; without a radio, none of them.
    pub fn links(&self) -> Links {
        let at = self.positions();
        match &self.radio {
            Some(radio) => radio.links(&at),
            None => Links::new(at.len(), |_, _| false),
        }
    }

    /// The true positions of the robots, metres.
    pub fn positions(&self) -> Vec<Point> {
        self.robots.iter().map(|robot| robot.body().position).collect()
    }

    /// The positions of the discs now, in the order given to [`Simulation::with_discs`], metres.
    pub fn discs(&self) -> Vec<Point> {
        self.discs.iter().map(|moving| moving.circle().centre).collect()
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
        let mut records = self.sense();
        self.look(&records);
        if let Some(radio) = &mut self.radio {
            for (robot, record) in records.iter_mut().enumerate() {
                record.heard = radio.deliver(self.ticks, robot);
            }
        }
        let answers = self.exchange(&records)?;
        let at = self.positions();
        if let Some(radio) = &mut self.radio {
            let news: Vec<_> = answers.iter().map(|answer| answer.news).collect();
            radio.send(self.ticks, &at, &news);
        }
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
        let circles: Vec<Circle> = self.robots.iter().map(|robot| circle(robot.body())).collect();
        let discs = self.discs.clone();
        let discs = discs.iter().map(|moving| moving.circle());
        let time_us = self.ticks * TICK_US;
        let robots = self.robots.iter_mut().enumerate();
        robots
            .map(|(index, robot)| {
                let before = circles[..index].iter();
                let others = before.chain(&circles[index + 1..]).copied();
                let seen: Vec<Circle> = others.chain(discs.clone()).collect();
                robot.sense(self.truth, &seen, time_us)
            })
            .collect()
    }

    /// Takes note of the discs that each robot's sensors report.
    fn look(&mut self, records: &[SensorRecord]) {
        let watches = self.robots.iter().zip(records).zip(&mut self.sightings);
        for ((robot, record), sightings) in watches {
            let body = robot.body();
            for (disc, sighting) in self.discs.iter().zip(sightings) {
                let circle = disc.circle();
                let next = disc.mover(TICK_US as f64 * 1e-6).after;
                sighting.moved([0, 1].map(|axis| next[axis] - circle.centre[axis]));
                let mut readings = record.ranges.iter().flatten();
                if readings.any(|reading| is_of(reading, body, self.truth, &circle)) {
                    sighting.reported(self.ticks, body);
                }
            }
        }
    }

    fn exchange(&mut self, records: &[SensorRecord]) -> Result<Vec<CommandRecord>, PilotError> {
        let robots = self.robots.iter_mut().zip(records);
        robots.map(|(robot, record)| robot.exchange(record)).collect()
    }

    fn advance(&mut self, answers: &[CommandRecord]) {
        let seconds = TICK_US as f64 * 1e-6;
        let mut after: Vec<(Body, StepResult)> = Vec::new();
        let mut movers: Vec<Mover> = Vec::new();
        for (robot, answer) in self.robots.iter_mut().zip(answers) {
            let before = *robot.body();
            let driven = robot.driven(&answer.commands);
            let mut body = before;
            let result = body.step(&driven, self.truth, seconds);
            let (before, radius_m) = (before.position, body.chassis.radius_m);
            movers.push(Mover { before, after: body.position, radius_m, is_disc: false });
            after.push((body, result));
        }
        movers.extend(self.discs.iter().map(|moving| moving.mover(seconds)));
        let robots = self.robots.len();
        let wanted = movers.clone();
        // Robots are expected to see each other.
        let is_at_fault = |robot: usize, other: usize| {
            let Some(disc) = other.checked_sub(robots) else { return true };
            let touches_alone = wanted[robot].clashes(&wanted[other].standing());
            let body = self.robots[robot].body();
            self.sightings[robot][disc].blames(self.ticks, body, touches_alone)
        };
        let contacts = keep_apart(&mut movers, &is_at_fault);
        let is_struck = |robot: usize, other: usize| {
            let approaches = wanted[robot].approaches(&wanted[other]);
            wanted[robot].clashes(&wanted[other]) && !(approaches && is_at_fault(robot, other))
        };
        let struck: Vec<Vec<bool>> = (0..robots)
            .map(|robot| (robots..movers.len()).map(|other| is_struck(robot, other)).collect())
            .collect();
        for (robot, sightings) in self.sightings.iter_mut().enumerate() {
            for (disc, sighting) in sightings.iter_mut().enumerate() {
                let gap_m = movers[robot].gap_m(&movers[robots + disc]);
                let body = self.robots[robot].body();
                sighting.ended(self.ticks, body, struck[robot][disc], gap_m);
            }
        }
        for (index, (robot, (body, result))) in self.robots.iter_mut().zip(after).enumerate() {
            let mover = movers[index];
            let gaps = (0..movers.len()).filter(|&other| other != index);
            let closest_m = gaps.map(|other| mover.gap_m(&movers[other]).max(0.0));
            let closest_m = closest_m.filter(|&gap_m| gap_m < LOOK_M);
            let mut result = result;
            result.closest_m = closest_m.fold(result.closest_m, f64::min);
            let mut body = body;
            let Contact { has_touched, was_struck } = contacts[index];
            result.touched |= has_touched;
            // A robot that moves towards one and is struck by another has touched.
            result.struck = was_struck && !has_touched;
            if has_touched || was_struck {
                result.closest_m = 0.0;
            }
            if mover.after != body.position {
                body.position = mover.after;
                body.velocity_mps = [0.0; 2];
                result.distance_m = 0.0;
            }
            robot.arrive(&answers[index], (body, result));
        }
        for (moving, mover) in self.discs.iter_mut().zip(&movers[self.robots.len()..]) {
            if mover.after != mover.before {
                moving.moved_m += moving.disc.speed_mps * seconds;
            }
        }
    }
}

/// A reading of a disc errs by this at most: noise, metres.
const SIGHTING_TOLERANCE_M: f64 = 0.1;

/// Whether a range reading is of this disc, not of an obstacle before it.
fn is_of(reading: &RangeReading, body: &Body, truth: &World, disc: &Circle) -> bool {
    let (from, heading_rad) = (body.position, body.heading_rad + f64::from(reading.bearing_rad));
    world::range_of_disc(from, heading_rad, disc.centre, disc.radius_m).is_some_and(|range_m| {
        let error_m = (f64::from(reading.distance_m) - range_m).abs();
        error_m <= SIGHTING_TOLERANCE_M && truth.range(from, heading_rad, range_m).is_none()
    })
}

/// A disc on its path.
#[derive(Clone, Debug)]
struct Moving {
    disc: Disc,
    moved_m: f64,
}

impl Moving {
    fn circle(&self) -> Circle {
        Circle { centre: self.disc.at(self.moved_m), radius_m: self.disc.radius_m }
    }

    fn mover(&self, seconds: f64) -> Mover {
        let after = self.disc.at(self.moved_m + self.disc.speed_mps * seconds);
        let Circle { centre, radius_m } = self.circle();
        Mover { before: centre, after, radius_m, is_disc: true }
    }
}

fn circle(body: &Body) -> Circle {
    Circle { centre: body.position, radius_m: body.chassis.radius_m }
}

impl<S: Sensors, P: Pilot> Robot<S, P> {
    /// Runs this robot to the end, alone in a world.
    pub fn run(self, truth: &World) -> Result<Outcome, PilotError> {
        let outcomes = Simulation::new(truth, [self]).finish()?;
        Ok(outcomes.into_iter().next().expect("one robot has one outcome"))
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
                news: None,
                goal: None,
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
        let robot = |before: f64, after: f64| Mover {
            before: [before, 0.0],
            after: [after, 0.0],
            radius_m: 0.3,
            is_disc: false,
        };
        let mut movers = [robot(0.0, 0.0), robot(0.7, 0.5), robot(1.4, 1.2), robot(2.5, 2.4)];
        let touched = Contact { has_touched: true, was_struck: false };
        let struck = Contact { has_touched: false, was_struck: true };
        let contacts = keep_apart(&mut movers, &|_, _| true);
        assert_eq!((contacts[0], contacts[3]), (struck, Contact::default()));
        assert!(contacts[1].has_touched && contacts[2] == touched, "{contacts:?}");
        assert_eq!(movers.map(|mover| mover.after[0]), [0.0, 0.7, 1.4, 2.4]);
    }

    /// Two bodies that would change places within one tick.
    #[test]
    fn speed_carries_no_body_through_another() {
        let robot = |before: f64, after: f64| Mover {
            before: [before, 0.0],
            after: [after, 0.0],
            radius_m: 0.05,
            is_disc: false,
        };
        let mut movers = [robot(0.0, 0.4), robot(0.4, 0.0)];
        assert!(keep_apart(&mut movers, &|_, _| true).iter().all(|contact| contact.has_touched));
        assert_eq!(movers.map(|mover| mover.after[0]), [0.0, 0.4]);
    }

    /// Drives at a constant speed, or stands.
    struct Steady(f32);

    impl Pilot for Steady {
        fn exchange(&mut self, _: &SensorRecord) -> Result<CommandRecord, PilotError> {
            let commands = Commands { speed_mps: self.0, ..Commands::stop(Reason::Driving) };
            Ok(CommandRecord {
                time_us: 0,
                commands,
                trace_hash: 0,
                instructions: 0,
                receiver: Receiver::Sound,
                checks: robot_io::Checks::default(),
                news: None,
                goal: None,
            })
        }
    }

    /// A robot at the origin that heads east, and a disc that passes `aside_m` beside it from the
    /// east; 20 seconds. Returns the outcome and where the disc ended.
    fn meeting(robot_mps: f32, disc_mps: f64, aside_m: f64) -> (Outcome, Point) {
        let world = World::new([]);
        let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
        let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
        let sensors = SensorSuite::new(SensorSettings::PERFECT, &reference, 1);
        let limits = Limits { time_s: 20.0, ..Limits::to_goal([99.0, 99.0]) };
        let body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
        let robot = Robot::new(body, sensors, Steady(robot_mps), limits);
        let disc = Disc {
            radius_m: 0.2,
            path: vec![[10.0, aside_m], [-10.0, aside_m]],
            speed_mps: disc_mps,
            repeat: crate::Repeat::Once,
            start_m: 0.0,
        };
        let mut simulation = Simulation::new(&world, [robot]).with_discs(&[disc]);
        while !simulation.is_over() {
            simulation.step().expect("these pilots always answer");
            let (at, disc) = (simulation.robots()[0].body().position, simulation.discs()[0]);
            assert!(crate::geometry::distance(at, disc) >= 0.5 - 1e-9, "{at:?} {disc:?}");
        }
        (simulation.robots()[0].outcome().clone(), simulation.discs()[0])
    }

    /// A disc from behind pushes nothing: the robot drives on, and the disc waits behind it.
    #[test]
    fn a_robot_drives_away_from_a_faster_disc() {
        let (world, sensors) = (World::new([]), Blind);
        let limits = Limits { time_s: 20.0, ..Limits::to_goal([99.0, 99.0]) };
        let body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
        let robot = Robot::new(body, sensors, Steady(1.0), limits);
        let disc = Disc {
            radius_m: 0.2,
            path: vec![[-3.0, 0.0], [90.0, 0.0]],
            speed_mps: 1.5,
            repeat: crate::Repeat::Once,
            start_m: 0.0,
        };
        let outcomes = Simulation::new(&world, [robot]).with_discs(&[disc]).finish();
        let outcome = &outcomes.expect("these pilots always answer")[0];
        assert_eq!((outcome.touches, outcome.strikes), (0, 1), "{outcome:?}");
        assert!((outcome.distance_m - 19.67).abs() < 0.05, "{outcome:?}");
    }

    /// Reports nothing.
    struct Blind;

    impl Sensors for Blind {
        fn sense(&mut self, _: &crate::Scene<'_>) -> SensorRecord {
            SensorRecord::default()
        }
    }

    #[test]
    fn range_sensors_see_discs() {
        let world = World::new([]);
        let place = GeoPoint::from_degrees(1.0, 2.0).expect("on the globe");
        let reference = Reference { place, at: [0.0, 0.0], heading_rad: 0.0 };
        let sensors = SensorSuite::new(SensorSettings::PERFECT, &reference, 1);
        let limits = Limits { time_s: 20.0, ..Limits::to_goal([99.0, 99.0]) };
        let body = Body::new(Chassis::default(), [0.0, 0.0], 0.0);
        let robot = Robot::new(body, sensors, TurnsAway { distance_m: 2.0, hash: 0 }, limits);
        let disc = Disc {
            radius_m: 0.2,
            path: vec![[6.0, 0.0]],
            speed_mps: 0.0,
            repeat: crate::Repeat::Once,
            start_m: 0.0,
        };
        let outcomes = Simulation::new(&world, [robot]).with_discs(&[disc]).finish();
        let outcome = &outcomes.expect("these pilots always answer")[0];
        assert!(outcome.touches == 0 && outcome.turn_rad > 0.3, "{outcome:?}");
        assert!((0.1..2.0).contains(&outcome.closest_m), "{outcome:?}");
    }

    #[test]
    fn who_moves_causes_the_contact() {
        for (robot_mps, disc_mps, aside_m, contacts) in [
            // The disc runs into a robot that stands.
            (0.0, 1.0, 0.0, (0, 1)),
            (0.0, 30.0, 0.3, (0, 1)),
            // The robot drives into a disc that stands, and into one that comes.
            (1.0, 0.0, 0.0, (1, 0)),
            (1.0, 0.4, 0.1, (1, 0)),
            // They pass each other.
            (0.0, 1.0, 0.6, (0, 0)),
            (1.0, 1.0, 0.6, (0, 0)),
        ] {
            let (outcome, at) = meeting(robot_mps, disc_mps, aside_m);
            let case = (robot_mps, disc_mps, aside_m);
            assert_eq!((outcome.touches, outcome.strikes), contacts, "{case:?}");
            let gap_m = if contacts == (0, 0) { 0.1 } else { 0.0 };
            assert!((outcome.closest_m - gap_m).abs() < 1e-9, "{case:?} {outcome:?}");
            assert_eq!(at == [-10.0, aside_m], contacts == (0, 0) && disc_mps > 0.0, "{case:?}");
        }
    }
}
