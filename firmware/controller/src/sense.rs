//! Estimates position and heading: judges their sources and dead-reckons in between.
//!
//! Position: a good pose or fix, unchanged; between them, speed and heading carry it on. While good
//! poses arrive they win over the fixes: a robot has a source of poses because fixes are not good
//! enough where it drives, and a mixture of both would leap by their offset. The position is
//! unknown once neither has arrived for the stale time. [`crate::source`] judges each of the two,
//! [`crate::slip`] whether positions follow the motion.
//!
//! Heading: from a good pose; else from compass or IMU, as long as [`crate::compass`] trusts it;
//! else the course over ground of a good fix above [`COURSE_SPEED_MPS`]; else the last heading,
//! carried on by the turn rate. A known heading may drift but never expires: as soon as the robot
//! drives by it, the course corrects it.
//!
//! Without odometry or gyroscope, the last commands stand in for speed or turn rate; so they do
//! for readings that the vehicle cannot reach or that [`crate::odometry`] doubts.

use math::{MapFrame, Vec2, scalar, vector};
use plan_format::Blob;
use plan_format::parameters::{FixPolicy, Parameters, Steering, Vehicle};
use robot_io::{Commands, Fix, Percepts, Pose, Reason, Receiver};
use serde::{Deserialize, Serialize};

use crate::clock::{Clock, LONGEST_STEP_US, Step};
use crate::compass::{Compass, Evidence};
use crate::odometry::Odometry;
use crate::ranges::{RangeTrack, RangeTrust};
use crate::slip::{Slip, Verdict};
use crate::source::{Anchor, Source};

/// Below this speed the course over ground does not show the heading, m/s.
pub const COURSE_SPEED_MPS: f32 = 0.5;

/// Measured speeds and turn rates count up to this many times the vehicle's limits, which slopes
/// and braking exceed.
const LIMIT_SHARE: f32 = 1.5;
/// They also count up to this much beyond that, m/s and rad/s: a vehicle with a limit of 0 is
/// pushed.
const LIMIT_MARGIN: f32 = 1.0;

/// A course counts while an antenna at the robot's rim moves sideways, in a turn, by less than this share
/// of the speed: it is wrong by half a radian at most.
const MOST_ASIDE_SHARE: f32 = 0.5;

/// A heading that changes by more than this at once was wrong before, radians.
const LEAP_RAD: f32 = 0.5;

/// The robot stops to creep after this time without a heading, seconds. At the speed of creeping a
/// receiver gives a course after one or two.
const LONGEST_CREEP_S: f32 = 15.0;

/// A heading is lost when the robot has driven by it for this time, seconds, and nothing has shown how
/// it turned: commands alone do not keep a heading.
const LONGEST_UNSEEN_S: f32 = 5.0;

/// Position and heading, or why the position is unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensed {
    /// Position in map metres. The error is why it is unknown.
    pub position: Result<Vec2, Reason>,
    /// Accuracy of the last good position, one standard deviation, metres.
    pub accuracy_m: f32,
    /// Heading in radians counter-clockwise from the map's x axis; `None` while unknown.
    pub heading_rad: Option<f32>,
    /// The compass is wrong, so its readings do not count.
    pub is_compass_wrong: bool,
    /// The compass is wrong and nothing else shows the heading.
    pub is_heading_wrong: bool,
    /// The robot may creep to find its heading.
    pub may_creep: bool,
    /// How far the range readings can be trusted.
    pub ranges: RangeTrust,
    /// The clock stands still, or leaps again and again.
    pub is_clock_stopped: bool,
    /// Wheels turn, or should, and the robot does not move.
    pub is_stuck: bool,
    /// Time since the last tick, seconds; at most one.
    pub elapsed_s: f32,
    /// Sum of these times, microseconds. It never goes back, as the clock may.
    pub passed_us: u64,
}

impl Sensed {
    /// The reason to stand still for want of a heading; `None` if it is known, or if creeping may
    /// find it.
    pub fn heading_reason(&self) -> Option<Reason> {
        if self.is_heading_wrong {
            Some(Reason::WrongHeading)
        } else if self.heading_rad.is_none() && !self.may_creep {
            Some(Reason::NoHeading)
        } else {
            None
        }
    }
}

/// What the estimate keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Track {
    clock: Clock,
    fixes: Source,
    poses: Source,
    slip: Slip,
    odometry: Odometry,
    /// Speed and turn rate that count in this tick, m/s and rad/s.
    twist: (f32, f32),
    compass: Compass,
    ranges: RangeTrack,
    /// Time of the last course, for the time between two.
    course_us: u64,
    /// Position dead-reckoned from the last good one, map metres.
    position_m: [f32; 2],
    /// Accuracy of the last good position.
    accuracy_m: f32,
    heading_rad: Option<f32>,
    /// The last fix has a velocity.
    has_velocity: bool,
    /// The last good pose has a heading.
    has_pose_heading: bool,
    /// Speed of the last commands.
    speed_mps: f32,
    /// Turn rate of the last commands.
    turn_rate_radps: f32,
    /// Time for which the robot has driven and nothing has shown its heading, seconds. Without a
    /// heading, time for which it has crept to find it.
    unseen_s: f32,
    is_creeping: bool,
}

/// How the robot moves in one tick.
#[derive(Clone, Copy)]
struct Twist {
    speed_mps: f32,
    turn_rate_radps: f32,
    is_turn_measured: bool,
    elapsed_s: f32,
}

impl Track {
    /// Remembers the commands that leave a tick.
    pub fn commanded(&mut self, commands: &Commands) {
        self.speed_mps = commands.speed_mps;
        self.turn_rate_radps = commands.turn_rate_radps;
        self.is_creeping = commands.reason == Reason::NoHeading && commands.speed_mps != 0.0;
    }

    /// Puts what counts in the place of readings that do not: the last sound scan, see
    /// [`RangeTrack::carry`], and the speed and turn rate that the robot believes.
    pub fn correct(&self, percepts: &mut Percepts) {
        self.ranges.carry(percepts);
        let (speed_mps, turn_rate_radps) = self.twist;
        percepts.speed_mps = percepts.speed_mps.map(|_| speed_mps);
        percepts.turn_rate_radps = percepts.turn_rate_radps.map(|_| turn_rate_radps);
    }

    /// Sets the clock. Returns the time since the last tick, seconds.
    fn advance(&mut self, now_us: u64) -> f32 {
        let before_us = self.clock.now_us();
        match self.clock.advance(now_us) {
            Step::Passed(elapsed_s) => elapsed_s,
            // Only the next position shows where the robot is.
            Step::Ahead => {
                self.fixes.clock_was_set();
                self.poses.clock_was_set();
                self.odometry.clock_was_set();
                0.0
            }
            // Positions of before belong to another history. What was found out about the sensors holds.
            Step::Back => {
                (self.fixes, self.poses) = (self.fixes.restarted(), self.poses.restarted());
                self.slip.restart();
                self.odometry.clock_was_set();
                self.ranges.clock_was_set(before_us, now_us);
                self.course_us = now_us;
                0.0
            }
        }
    }

    /// Speed and turn rate: measured ones if [`crate::odometry`] trusts them and the vehicle can
    /// reach them, else by the last commands.
    fn twist(&mut self, percepts: &Percepts, vehicle: &Vehicle, elapsed_s: f32) -> Twist {
        let within = |most: f32| move |x: &f32| x.abs() <= LIMIT_SHARE * most + LIMIT_MARGIN;
        let turn_rate = percepts.turn_rate_radps.filter(within(vehicle.max_turn_rate_radps));
        let speed = percepts.speed_mps.filter(within(vehicle.max_speed_mps));
        let commanded = (self.speed_mps, self.turn_rate_radps);
        let compass_rad = percepts.heading_rad.filter(|_| !self.compass.is_wrong());
        let readings = (speed, turn_rate);
        self.twist = self.odometry.judge(readings, commanded, compass_rad, vehicle, elapsed_s);
        let (speed_mps, turn_rate_radps) = self.twist;
        let is_turn_measured = turn_rate.is_some() && self.odometry.is_turn_sound();
        Twist { speed_mps, turn_rate_radps, is_turn_measured, elapsed_s }
    }

    /// Dead-reckons one step.
    fn carry_on(&mut self, twist: &Twist) {
        let Some(heading_rad) = self.heading_rad else { return };
        let turned_rad = twist.turn_rate_radps * twist.elapsed_s;
        // The mean heading of the step is closer to the arc than either end.
        let step = vector::from_angle(heading_rad + 0.5 * turned_rad)
            * (twist.speed_mps * twist.elapsed_s);
        self.position_m = (Vec2::from(self.position_m) + step).into();
        // A robot that is commanded to stand is not expected to move, even with frozen odometry.
        if self.speed_mps != 0.0 {
            self.slip.carry(step, twist.speed_mps * twist.elapsed_s);
        }
        self.heading_rad = Some(scalar::wrap_angle(heading_rad + turned_rad));
    }

    /// Takes over a good position of the source that leads. Returns whether the robot is stuck.
    fn arrive(&mut self, anchor: &Anchor, speed_mps: Option<f32>, leads: Leads) -> bool {
        let verdict = self.slip.judge(anchor, speed_mps);
        if verdict == Verdict::Frozen {
            match leads {
                Leads::Fixes => self.fixes.freeze(),
                Leads::Poses => self.poses.freeze(),
            }
        } else {
            self.position_m = anchor.position_m;
            self.accuracy_m = anchor.accuracy_m;
        }
        verdict == Verdict::Stuck
    }

    /// Judges the latest pose. Returns whether the robot is stuck.
    fn hear_pose(&mut self, pose: &Pose, policy: &FixPolicy) -> bool {
        if !self.poses.is_new(pose.time_us) {
            return false;
        }
        let next = if pose.accuracy_mm > policy.max_accuracy_mm {
            Err(Reason::PoorFix)
        } else {
            Ok(Anchor {
                time_us: pose.time_us,
                position_m: pose.position_m,
                accuracy_m: pose.accuracy_mm as f32 * 1e-3,
                source_ms: None,
            })
        };
        let estimate = self.position_m.into();
        let Some(anchor) = self.poses.judge(next, self.clock.now_us(), estimate, policy) else {
            return false;
        };
        self.has_pose_heading = pose.heading_rad.is_some();
        self.heading_rad = pose.heading_rad.or(self.heading_rad);
        self.arrive(&anchor, None, Leads::Poses)
    }

    /// Judges the latest fix. Returns its course, and whether the robot is stuck.
    fn hear_fix(
        &mut self,
        fix: &Fix,
        frame: &MapFrame,
        twist: &Twist,
        parameters: &Parameters,
    ) -> (Option<f32>, bool) {
        let (policy, vehicle) = (&parameters.fixes, &parameters.vehicle);
        if !self.fixes.is_new(fix.time_us) {
            return (None, false);
        }
        let next = if !fix.is_valid || fix.accuracy_mm > policy.max_accuracy_mm {
            Err(Reason::PoorFix)
        } else {
            let position = frame.to_local(fix.place).ok_or(Reason::DistantFix);
            position.map(|position| Anchor {
                time_us: fix.time_us,
                position_m: position.into(),
                accuracy_m: fix.accuracy_mm as f32 * 1e-3,
                source_ms: fix.receiver_ms,
            })
        };
        let velocity = fix.velocity_mmps.map(|velocity| {
            let [east, north] = velocity.map(|mmps| mmps as f32 * 1e-3);
            frame.turned(east, north)
        });
        let speed_mps = velocity.map(vector::length);
        // A receiver may send the velocity of a position after the position.
        let had_velocity = core::mem::replace(&mut self.has_velocity, velocity.is_some());
        let is_completed =
            velocity.is_some() && !had_velocity && next.is_ok_and(|next| self.fixes.repeats(&next));
        let estimate = self.position_m.into();
        let mut is_stuck = false;
        if !is_completed {
            let Some(anchor) = self.fixes.judge(next, self.clock.now_us(), estimate, policy) else {
                return (None, false);
            };
            is_stuck = !self.poses.is_fresh(self.clock.now_us(), policy)
                && self.arrive(&anchor, speed_mps, Leads::Fixes);
        }
        if let Some(speed_mps) = speed_mps {
            self.odometry.hear(speed_mps, vehicle);
        }
        // An antenna beside the middle of a robot that turns moves sideways.
        let aside_mps = vehicle.radius_m * twist.turn_rate_radps.abs();
        let shows_course =
            |mps: &f32| *mps > COURSE_SPEED_MPS && aside_mps < MOST_ASIDE_SHARE * *mps;
        let course_rad = velocity.filter(|_| speed_mps.as_ref().is_some_and(shows_course));
        let course_rad = course_rad.map(|velocity| {
            vector::angle(if twist.speed_mps < 0.0 { -velocity } else { velocity })
        });
        (course_rad, is_stuck)
    }

    /// Counts for how long the robot has driven while nothing showed its heading or its turns. After
    /// [`LONGEST_UNSEEN_S`] the heading is lost.
    fn doubt_heading(&mut self, is_seen: bool, percepts: &Percepts, elapsed_s: f32) {
        let drives = self.speed_mps != 0.0 || self.turn_rate_radps != 0.0;
        let had_heading = self.heading_rad.is_some();
        if had_heading && is_seen || !percepts.operator.is_armed {
            self.unseen_s = 0.0;
        } else if had_heading && drives || self.is_creeping {
            self.unseen_s += elapsed_s;
        }
        if had_heading && self.unseen_s > LONGEST_UNSEEN_S {
            (self.heading_rad, self.unseen_s) = (None, 0.0);
        }
    }

    /// Whether no fix was ever good, and the last one came long ago: the receiver's state says more.
    fn has_only_heard_poor_fixes(&self, policy: &FixPolicy) -> bool {
        self.fixes.refusal() == Some(Reason::PoorFix)
            && !self.fixes.has_anchor()
            && !self.poses.was_heard()
            && !self.fixes.is_heard(self.clock.now_us(), policy)
    }

    fn position_was_heard(&self) -> bool {
        self.fixes.was_heard() || self.poses.was_heard()
    }

    /// Where the robot is, or why that is unknown.
    fn position(&self, blob: &Blob<'_>, receiver: Receiver) -> Result<Vec2, Reason> {
        let policy = &blob.parameters().fixes;
        let has_frame = blob.map_frame().is_some();
        let source = if has_frame && (self.fixes.was_heard() || !self.poses.was_heard()) {
            &self.fixes
        } else {
            &self.poses
        };
        if self.fixes.is_fresh(self.clock.now_us(), policy)
            || self.poses.is_fresh(self.clock.now_us(), policy)
        {
            Ok(self.position_m.into())
        } else if self.has_only_heard_poor_fixes(policy) {
            Err(no_fix(receiver))
        } else if source.was_heard() {
            Err(source.refusal().unwrap_or(Reason::StaleFix))
        } else if has_frame {
            Err(no_fix(receiver))
        } else {
            Err(Reason::NoOrigin)
        }
    }
}

/// Which source the position comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Leads {
    Fixes,
    Poses,
}

/// Advances the track to the time of the percepts.
///
/// ```
/// use controller::sense::{Track, sense};
/// use math::GeoPoint;
/// use plan_format::{Blob, Origin, Parameters};
/// use robot_io::{Fix, Percepts};
/// let place = GeoPoint::from_degrees(45.0, 8.0).unwrap();
/// let origin = Origin { place, at_m: [10.0, 20.0], heading_rad: 0.0 };
/// let blob = Blob::without_map(Parameters::default(), Some(origin), None);
/// let mut track = Track::default();
/// let (time_us, accuracy_mm) = (50_000, 500);
/// let fix = Fix {
///     time_us, is_valid: true, place, accuracy_mm, velocity_mmps: None, receiver_ms: None,
/// };
/// let heading_rad = Some(0.0);
/// let mut percepts = Percepts { time_us, fix: Some(fix), heading_rad, ..Percepts::default() };
/// let start = sense(&blob, &mut track, &percepts).position.unwrap();
/// assert_eq!((start.x, start.y), (10.0, 20.0));
/// // Half a second later, without another fix, at 2 m/s to the east.
/// percepts = Percepts { time_us: 550_000, fix: None, speed_mps: Some(2.0), ..percepts };
/// let later = sense(&blob, &mut track, &percepts).position.unwrap();
/// assert!((later.x - 11.0).abs() < 1e-4 && (later.y - 20.0).abs() < 1e-4);
/// ```
pub fn sense(blob: &Blob<'_>, track: &mut Track, percepts: &Percepts) -> Sensed {
    let elapsed_s = track.advance(percepts.time_us);
    let parameters = blob.parameters();
    let vehicle = &parameters.vehicle;
    let twist = track.twist(percepts, vehicle, elapsed_s);
    let (moved_m, turned_rad) = (twist.speed_mps * elapsed_s, twist.turn_rate_radps * elapsed_s);
    let ranges = track.ranges.judge(percepts, &parameters.ranges, moved_m, turned_rad);
    track.carry_on(&twist);
    // Without time, nothing explains how positions change.
    let is_timeless = track.clock.stands() && track.position_was_heard();
    let pose = percepts.pose.filter(|_| !is_timeless);
    let mut is_stuck = pose.is_some_and(|pose| track.hear_pose(&pose, &parameters.fixes));
    let mut course_rad = None;
    let fix = percepts.fix.as_ref().filter(|_| !is_timeless);
    if let (Some(fix), Some(frame)) = (fix, blob.map_frame()) {
        let (course, sticks) = track.hear_fix(fix, frame, &twist, parameters);
        (course_rad, is_stuck) = (course, is_stuck | sticks);
    }
    let map_heading_rad = blob.origin().map(|origin| origin.heading_rad as f32);
    let is_seen = find_heading(
        track,
        percepts,
        &twist,
        vehicle,
        map_heading_rad,
        course_rad,
        &parameters.fixes,
    );
    track.doubt_heading(is_seen || twist.is_turn_measured, percepts, elapsed_s);
    if !percepts.operator.is_armed {
        // A new order to arm is a new attempt.
        track.compass.restart();
        track.odometry.restart();
        track.fixes.unprove();
        track.poses.unprove();
    }
    Sensed {
        position: track.position(blob, percepts.receiver),
        accuracy_m: track.accuracy_m,
        heading_rad: track.heading_rad,
        is_compass_wrong: track.compass.is_wrong(),
        is_heading_wrong: track.compass.is_wrong() && !gives_course(percepts),
        may_creep: track.heading_rad.is_some() || track.unseen_s < LONGEST_CREEP_S,
        ranges,
        is_clock_stopped: track.clock.is_wrong(),
        is_stuck: is_stuck || track.odometry.are_motors_dead(),
        elapsed_s,
        passed_us: track.clock.passed_us(),
    }
}

/// Sets the heading from the best source. Returns whether one shows it.
fn find_heading(
    track: &mut Track,
    percepts: &Percepts,
    twist: &Twist,
    vehicle: &Vehicle,
    map_heading_rad: Option<f32>,
    course_rad: Option<f32>,
    policy: &FixPolicy,
) -> bool {
    if track.has_pose_heading && track.poses.is_fresh(track.clock.now_us(), policy) {
        return true;
    }
    let expected_rad = track.heading_rad;
    let since_us = track.clock.now_us().saturating_sub(track.course_us).min(LONGEST_STEP_US);
    if let Some(course_rad) = course_rad {
        track.course_us = track.clock.now_us();
        track.heading_rad = Some(course_rad);
        if expected_rad.is_some_and(|rad| scalar::wrap_angle(course_rad - rad).abs() > LEAP_RAD) {
            track.slip.restart();
        }
    }
    let (Some(heading_rad), Some(map_heading_rad)) = (percepts.heading_rad, map_heading_rad) else {
        track.compass.miss(twist.elapsed_s);
        return course_rad.is_some();
    };
    let reading_rad = scalar::wrap_angle(heading_rad + map_heading_rad);
    // A boat drifts, and a vehicle that shall stand may be carried.
    let shows_heading = vehicle.steering != Steering::Boat && twist.speed_mps.abs() > 0.2;
    let evidence = Evidence {
        expected_rad: track.heading_rad.filter(|_| track.compass.is_wrong()).or(expected_rad),
        course: course_rad
            .filter(|_| shows_heading)
            .map(|course_rad| (course_rad, since_us as u32 as f32 * 1e-6)),
        turn_rate_radps: twist.turn_rate_radps,
        is_turn_measured: twist.is_turn_measured,
        modelled_radps: track.odometry.modelled_turn_radps(),
        elapsed_s: twist.elapsed_s,
    };
    let compass_rad = track.compass.judge(reading_rad, &evidence);
    track.heading_rad = compass_rad.or(track.heading_rad);
    compass_rad.or(course_rad).is_some()
}

/// Whether the receiver reports velocities, so that driving shows the heading. Many receivers omit
/// the course while they stand still.
pub(crate) fn gives_course(percepts: &Percepts) -> bool {
    percepts.receiver == Receiver::Sound
        || percepts.fix.is_some_and(|fix| fix.velocity_mmps.is_some())
}

/// Why no fix has ever arrived.
fn no_fix(receiver: Receiver) -> Reason {
    match receiver {
        Receiver::Unreadable => Reason::UnreadableReceiver,
        Receiver::Unchecked => Reason::UncheckedReceiver,
        Receiver::NoPosition => Reason::NoPositionMessage,
        Receiver::NoFix => Reason::PoorFix,
        Receiver::Silent | Receiver::Heard | Receiver::NoVelocity | Receiver::Sound => {
            Reason::NoFix
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use math::GeoPoint;
    use plan_format::{Origin, Parameters};
    use robot_io::Operator;

    /// A robot without a map, 10 m east and 20 m north of where the axes begin, ten ticks a second.
    struct Robot<'b> {
        blob: Blob<'b>,
        track: Track,
        time_us: u64,
    }

    impl Robot<'_> {
        /// `has_place` tells whether fixes have a meaning.
        fn new(has_place: bool) -> Self {
            let place = GeoPoint::from_degrees(45.0, 8.0).expect("a place on the globe");
            let origin = Origin { place, at_m: [10.0, 20.0], heading_rad: 0.0 };
            let origin = Some(origin).filter(|_| has_place);
            let blob = Blob::without_map(Parameters::default(), origin, None);
            Self { blob, track: Track::default(), time_us: 1_000_000 }
        }

        /// What an armed robot senses 0.1 s later.
        fn sense(&mut self, percepts: Percepts) -> Sensed {
            self.time_us += 100_000;
            let operator = Operator { is_armed: true, ..percepts.operator };
            let percepts = Percepts { time_us: self.time_us, operator, ..percepts };
            sense(&self.blob, &mut self.track, &percepts)
        }

        /// The next fix, where the robot began.
        fn fix(&self, accuracy_mm: u32) -> Option<Fix> {
            let frame = self.blob.map_frame()?;
            Some(Fix {
                time_us: self.time_us + 100_000,
                is_valid: true,
                place: frame.to_geodetic(Vec2::new(10.0, 20.0)),
                accuracy_mm,
                velocity_mmps: None,
                receiver_ms: None,
            })
        }

        fn pose(&self, accuracy_mm: u32, heading_rad: Option<f32>) -> Option<Pose> {
            let (time_us, position_m) = (self.time_us + 100_000, [3.0, 4.0]);
            Some(Pose { time_us, position_m, heading_rad, accuracy_mm })
        }

        fn begin_at_a_fix(&mut self) {
            let fix = self.fix(500);
            self.sense(Percepts { fix, heading_rad: Some(0.0), ..Percepts::default() });
        }
    }

    /// The default limit is 5 m. Accuracies are in metres.
    #[test]
    fn positions_up_to_the_worst_accuracy_count() {
        for (accuracy_mm, expected) in [(5_000, Ok(5.0)), (5_001, Err(Reason::PoorFix))] {
            let mut robot = Robot::new(true);
            let fix = robot.fix(accuracy_mm);
            let by_fix = robot.sense(Percepts { fix, ..Percepts::default() });
            assert_eq!(by_fix.position.map(|_| by_fix.accuracy_m), expected);
            let mut robot = Robot::new(false);
            let pose = robot.pose(accuracy_mm, None);
            let by_pose = robot.sense(Percepts { pose, ..Percepts::default() });
            assert_eq!(by_pose.position.map(|_| by_pose.accuracy_m), expected);
        }
    }

    /// A vehicle for 1.6 m/s may be pushed to 1.5 x 1.6 + 1 = 3.4 m/s. A faster reading is wrong, and
    /// the commands, which are 0, stand in.
    #[test]
    fn a_speed_that_the_vehicle_cannot_reach_does_not_count() {
        for (speed_mps, moved_m) in [(3.3, 3.3), (3.5, 0.0)] {
            let mut robot = Robot::new(true);
            robot.begin_at_a_fix();
            let driving = Percepts { speed_mps: Some(speed_mps), ..Percepts::default() };
            let last = (0..10).map(|_| robot.sense(driving.clone()).position).last();
            let x = last.and_then(Result::ok).expect("the fix is fresh").x;
            assert!((x - 10.0 - moved_m).abs() < 0.05, "{speed_mps}: {x}");
        }
    }

    /// The gyroscope shows 0.5 rad/s, compass and commands show none.
    #[test]
    fn a_gyroscope_that_contradicts_a_sound_compass_does_not_count() {
        let mut robot = Robot::new(true);
        for tick in 0..50_u8 {
            let heading_rad = Some(0.01 * f32::from(tick % 3));
            let turn_rate_radps = Some(0.5);
            robot.sense(Percepts { heading_rad, turn_rate_radps, ..Percepts::default() });
        }
        assert_eq!(robot.track.twist.1, 0.0);
    }

    /// A robot may creep for 15 s. It does so only if it is commanded to, and disarming it begins
    /// anew.
    #[test]
    fn only_creeping_without_a_heading_uses_up_its_time() {
        let creep = Commands { speed_mps: 0.3, ..Commands::stop(Reason::NoHeading) };
        for (commands, disarms, may_creep) in [
            (creep, false, false),
            (creep, true, true),
            (Commands::stop(Reason::NoHeading), false, true),
            (Commands { reason: Reason::Driving, ..creep }, false, true),
        ] {
            let mut robot = Robot::new(true);
            let mut last = None;
            for tick in 0..200 {
                if disarms && tick == 100 {
                    robot.time_us += 100_000;
                    let percepts = Percepts { time_us: robot.time_us, ..Percepts::default() };
                    sense(&robot.blob, &mut robot.track, &percepts);
                }
                last = Some(robot.sense(Percepts::default()).may_creep);
                robot.track.commanded(&commands);
            }
            assert_eq!(last, Some(may_creep), "{commands:?} {disarms}");
        }
    }

    /// A course shows the heading once. At 0.3 m/s, or on the spot, no other one follows, and commands
    /// alone keep a heading for 5 s.
    #[test]
    fn a_heading_that_nothing_shows_is_lost_while_the_robot_drives() {
        let standing = Commands::stop(Reason::Driving);
        let slow = Commands { speed_mps: 0.3, ..standing };
        let turning = Commands { turn_rate_radps: 0.5, ..standing };
        let nothing = Percepts::default();
        let compass = Percepts { heading_rad: Some(0.0), ..Percepts::default() };
        let gyroscope = Percepts { turn_rate_radps: Some(0.0), ..Percepts::default() };
        for (commands, percepts, ticks, has_heading) in [
            (slow, &nothing, 49, true),
            (slow, &nothing, 53, false),
            (turning, &nothing, 53, false),
            (standing, &nothing, 200, true),
            (slow, &compass, 200, true),
            (slow, &gyroscope, 200, true),
        ] {
            let mut robot = Robot::new(true);
            let velocity_mmps = Some([1_000, 0]);
            let fix = robot.fix(500).map(|fix| Fix { velocity_mmps, ..fix });
            robot.sense(Percepts { fix, ..percepts.clone() });
            assert!(robot.track.heading_rad.is_some(), "the course shows it");
            for _ in 0..ticks {
                robot.track.commanded(&commands);
                robot.sense(percepts.clone());
            }
            let case = (commands, percepts, ticks);
            assert_eq!(robot.track.heading_rad.is_some(), has_heading, "{case:?}");
        }
    }

    /// The reason is that of the source that the robot has heard; fixes come first.
    #[test]
    fn a_lost_position_names_the_source_that_was_heard() {
        for (has_place, hears_fix, hears_pose, expected) in [
            (true, false, false, Reason::NoFix),
            (true, true, false, Reason::PoorFix),
            (true, true, true, Reason::PoorFix),
            (true, false, true, Reason::StaleFix),
            (false, false, true, Reason::StaleFix),
            (false, false, false, Reason::NoOrigin),
        ] {
            let mut robot = Robot::new(has_place);
            for accuracy_mm in [500, 6_000] {
                let fix = robot.fix(accuracy_mm).filter(|_| hears_fix);
                let pose = robot.pose(500, None).filter(|_| hears_pose && accuracy_mm == 500);
                robot.sense(Percepts { fix, pose, ..Percepts::default() });
            }
            let lost = (0..30).map(|_| robot.sense(Percepts::default()).position).last();
            assert_eq!(lost, Some(Err(expected)), "{has_place} {hears_fix} {hears_pose}");
        }
    }

    /// A pose with a heading outranks the compass while it is fresh. One without leaves it alone.
    #[test]
    fn the_compass_counts_unless_a_fresh_pose_has_a_heading() {
        for (pose_rad, at_once, later) in [(Some(1.0), 1.0, 0.5), (None, 0.5, 0.5)] {
            let mut robot = Robot::new(true);
            let pose = robot.pose(500, pose_rad);
            let compass = Percepts { heading_rad: Some(0.5), ..Percepts::default() };
            let sensed = robot.sense(Percepts { pose, ..compass.clone() });
            assert_eq!(sensed.heading_rad, Some(at_once));
            let last = (0..80).filter_map(|_| robot.sense(compass.clone()).heading_rad).last();
            assert_eq!(last, Some(later), "{pose_rad:?}");
        }
    }

    /// The clock goes back by 3 s. The pose from before is not a new one, and the next tick is 0.1 s
    /// long.
    #[test]
    fn a_clock_that_goes_back_does_not_make_an_old_pose_new() {
        let mut robot = Robot::new(false);
        robot.time_us = 8_000_000;
        let pose = robot.pose(500, None);
        let held = Percepts { pose, ..Percepts::default() };
        assert!(robot.sense(held.clone()).position.is_ok());
        robot.time_us = 5_000_000;
        let back = robot.sense(held.clone());
        assert!(back.position.is_err() && back.elapsed_s == 0.0, "{back:?}");
        assert_eq!(robot.sense(held).elapsed_s, 0.1);
    }
}
