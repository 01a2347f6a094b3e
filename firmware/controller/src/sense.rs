//! Estimates position and heading: judges fixes and dead-reckons between them.
//!
//! Position: a good fix, unchanged; between fixes, speed and heading carry it on. The position
//! is unknown once no good fix has arrived for the stale time.
//!
//! Heading: from compass or IMU; else the course over ground of a good fix above
//! [`COURSE_SPEED_MPS`]; else the last heading, carried on by the turn rate. A known heading may
//! drift but never expires: as soon as the robot drives by it, the course corrects it.
//!
//! Without odometry or gyroscope, the last commands stand in for speed or turn rate.

use math::{MapFrame, Vec2, scalar, vector};
use plan_format::Blob;
use plan_format::parameters::FixPolicy;
use robot_io::{Commands, Fix, Percepts, Reason, Receiver};
use serde::{Deserialize, Serialize};

use crate::ranges::{RangeTrack, RangeTrust};

/// Below this speed the course over ground does not show the heading, m/s.
pub const COURSE_SPEED_MPS: f32 = 0.5;

/// Longest time of one dead-reckoning step, microseconds. After a longer pause only the next fix
/// shows where the robot is.
const LONGEST_STEP_US: u64 = 1_000_000;

/// A fix jumps if it is farther away than the speed limit explains, plus this many times the
/// accuracies of both fixes. An accuracy is one standard deviation.
const JUMP_DEVIATIONS: f32 = 3.0;

/// Bound on sensor readings of speed and turn rate, m/s and rad/s.
const FASTEST: f32 = 100.0;

/// Position and heading, or why the position is unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensed {
    /// Position in map metres. The error is why it is unknown.
    pub position: Result<Vec2, Reason>,
    /// Heading in radians counter-clockwise from the map's x axis; `None` while unknown.
    pub heading_rad: Option<f32>,
    /// How far the range readings can be trusted.
    pub ranges: RangeTrust,
}

/// What the estimate keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Time of the last tick.
    now_us: u64,
    /// Time stamp of the last judged fix: no fix is judged twice.
    judged_fix_us: Option<u64>,
    /// Why the last judged fix was refused; `None` if it was good.
    refusal: Option<Reason>,
    /// The last good fix.
    anchor: Option<Anchor>,
    /// Position dead-reckoned from the anchor, map metres.
    position_m: [f32; 2],
    heading_rad: Option<f32>,
    /// Speed of the last commands.
    speed_mps: f32,
    /// Turn rate of the last commands.
    turn_rate_radps: f32,
    ranges: RangeTrack,
}

/// A good fix, in map metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Anchor {
    time_us: u64,
    position_m: [f32; 2],
    accuracy_m: f32,
}

impl Track {
    /// Remembers the commands that leave a tick.
    pub fn commanded(&mut self, commands: &Commands) {
        self.speed_mps = commands.speed_mps;
        self.turn_rate_radps = commands.turn_rate_radps;
    }

    /// Sets the clock. Returns the time since the last tick, seconds.
    fn advance(&mut self, now_us: u64) -> f32 {
        if now_us < self.now_us {
            // The clock ran backwards: earlier percepts belong to another history.
            *self = Self { judged_fix_us: self.judged_fix_us, ..Self::default() };
        }
        let step_us = now_us.saturating_sub(self.now_us).min(LONGEST_STEP_US);
        self.now_us = now_us;
        step_us as u32 as f32 * 1e-6
    }

    fn is_stale(&self, time_us: u64, policy: &FixPolicy) -> bool {
        self.now_us.saturating_sub(time_us) > u64::from(policy.stale_after_us)
    }

    /// Judges a fix. The error is the reason for refusing it.
    fn judge(&self, fix: &Fix, frame: &MapFrame, policy: &FixPolicy) -> Result<Anchor, Reason> {
        if !fix.is_valid || fix.accuracy_mm > policy.max_accuracy_mm {
            return Err(Reason::PoorFix);
        }
        // A time stamp from the future would never become stale.
        let time_us = fix.time_us.min(self.now_us);
        if self.is_stale(time_us, policy) {
            return Err(Reason::StaleFix);
        }
        let position = frame.to_local(fix.place).ok_or(Reason::DistantFix)?;
        let next = Anchor {
            time_us,
            position_m: position.into(),
            accuracy_m: fix.accuracy_mm as f32 * 1e-3,
        };
        match &self.anchor {
            Some(last) if next.jumps(last, policy) => Err(Reason::JumpedFix),
            _ => Ok(next),
        }
    }
}

impl Anchor {
    /// Whether this is farther from the last good fix than driving explains. The explained
    /// distance grows with time, so the robot recovers from a wrong first fix.
    fn jumps(&self, last: &Self, policy: &FixPolicy) -> bool {
        let elapsed_us = self.time_us.saturating_sub(last.time_us).min(u64::from(u32::MAX));
        let elapsed_s = elapsed_us as u32 as f32 * 1e-6;
        let reach_m =
            policy.max_jump_mps * elapsed_s + JUMP_DEVIATIONS * (self.accuracy_m + last.accuracy_m);
        vector::length(Vec2::from(self.position_m) - Vec2::from(last.position_m)) > reach_m
    }
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
    let ranges = track.ranges.judge(percepts, &blob.parameters().ranges);
    let (Some(frame), Some(origin)) = (blob.map_frame(), blob.origin()) else {
        return Sensed { position: Err(Reason::NoOrigin), heading_rad: None, ranges };
    };
    let speed_mps = percepts.speed_mps.unwrap_or(track.speed_mps).clamp(-FASTEST, FASTEST);
    let compass_rad =
        percepts.heading_rad.map(|heading| scalar::wrap_angle(heading + origin.heading_rad as f32));
    carry_on(track, percepts, elapsed_s, speed_mps);
    if let Some(fix) = percepts.fix.filter(|fix| track.judged_fix_us != Some(fix.time_us)) {
        track.judged_fix_us = Some(fix.time_us);
        let judged = track.judge(&fix, frame, &blob.parameters().fixes);
        track.refusal = judged.err();
        if let Ok(anchor) = judged {
            track.anchor = Some(anchor);
            track.position_m = anchor.position_m;
            track.heading_rad = course(&fix, frame, speed_mps < 0.0).or(track.heading_rad);
        }
    }
    track.heading_rad = compass_rad.or(track.heading_rad);
    let position = position(track, &blob.parameters().fixes, percepts);
    Sensed { position, heading_rad: track.heading_rad, ranges }
}

fn carry_on(track: &mut Track, percepts: &Percepts, elapsed_s: f32, speed_mps: f32) {
    let Some(heading_rad) = track.heading_rad else { return };
    let turn_rate = percepts.turn_rate_radps.unwrap_or(track.turn_rate_radps);
    let turned_rad = turn_rate.clamp(-FASTEST, FASTEST) * elapsed_s;
    // The mean heading of the step is closer to the arc than either end.
    let step = vector::from_angle(heading_rad + 0.5 * turned_rad) * (speed_mps * elapsed_s);
    track.position_m = (Vec2::from(track.position_m) + step).into();
    track.heading_rad = Some(scalar::wrap_angle(heading_rad + turned_rad));
}

/// The heading that the velocity of a fix implies, map axes.
fn course(fix: &Fix, frame: &MapFrame, is_astern: bool) -> Option<f32> {
    let [east, north] = fix.velocity_mmps?.map(|mmps| mmps as f32 * 1e-3);
    let velocity = frame.turned(east, north);
    let ahead = if is_astern { -velocity } else { velocity };
    (vector::length(velocity) > COURSE_SPEED_MPS).then(|| vector::angle(ahead))
}

fn position(track: &Track, policy: &FixPolicy, percepts: &Percepts) -> Result<Vec2, Reason> {
    match &track.anchor {
        Some(anchor) if !track.is_stale(anchor.time_us, policy) => Ok(track.position_m.into()),
        Some(_) => Err(track.refusal.unwrap_or(Reason::StaleFix)),
        None => Err(track.refusal.unwrap_or_else(|| no_fix(percepts.receiver))),
    }
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
