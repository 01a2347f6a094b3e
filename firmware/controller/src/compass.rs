//! Judges the compass: against the course over ground, against the turn rate, against itself.
//!
//! Three signs raise doubt:
//! - the course over ground differs by more than [`WRONG_RAD`], while the robot drives fast enough
//!   and hardly turns. Not on a boat: it drifts, so its course is not its heading;
//! - the robot turns and the compass does not: it is frozen, or pulled by a magnet on the robot;
//! - the reading leaps from tick to tick.
//!
//! Once the doubt has lasted [`DOUBT_S`], the compass is wrong: course and turn rate give the
//! heading instead. It counts again once it has agreed with them through a turn, or once the robot
//! is disarmed.
//!
//! A single leap is not followed at once. If the compass stays at the new value for [`LEAP_S`] and
//! no course contradicts it, it counts again: somebody may have turned the robot.

use math::scalar::wrap_angle;
use serde::{Deserialize, Serialize};

/// A compass that differs by more than this is wrong, radians.
const WRONG_RAD: f32 = 0.5;
/// The doubt must last this long, seconds.
const DOUBT_S: f32 = 3.0;
/// Doubt for one leap between two ticks, seconds.
const DOUBT_PER_LEAP_S: f32 = 0.25;
/// A wrong compass agrees within this angle, radians.
const AGREEMENT_RAD: f32 = 0.3;
/// A compass that has leapt counts again after it has stayed for this time, seconds. Longer than
/// the doubt, so that a course has the time to contradict it.
const LEAP_S: f32 = 4.0;
/// Faster turns are too fast to compare with the course, which is older, rad/s.
const STRAIGHT_RADPS: f32 = 0.5;
/// Slower turns do not count as turns: the bias of a gyroscope is slower, rad/s.
const TURNING_RADPS: f32 = 0.1;
/// The compass is compared with the turn rate once the robot has turned by this, radians.
const TURNED_RAD: f32 = 1.0;
/// A compass that has moved less than this in that turn is frozen, radians.
const FROZEN_RAD: f32 = 0.2;

/// After this time without a reading the next one does not count as a leap, seconds.
const LONGEST_SILENCE_S: f32 = 0.5;

/// What the compass is compared with in one tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence {
    /// The heading that was known before, carried on by the turn rate; map axes.
    pub(crate) expected_rad: Option<f32>,
    /// The course of a new fix, and the time since the last one, seconds; map axes.
    pub(crate) course: Option<(f32, f32)>,
    /// Turn rate, measured or commanded, rad/s.
    pub(crate) turn_rate_radps: f32,
    /// The turn rate is measured. Only then does it prove that the robot turns: one that is stuck
    /// does not do what it is commanded.
    pub(crate) is_turn_measured: bool,
    /// Time since the last tick, seconds.
    pub(crate) elapsed_s: f32,
}

/// What the judgement keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compass {
    is_wrong: bool,
    /// How long the doubt has lasted, seconds.
    doubt_s: f32,
    /// Whether it has agreed with the expected heading since the comparison with the turn rate
    /// began.
    has_agreed: bool,
    /// The reading where the comparison with the turn rate began.
    start_rad: Option<f32>,
    /// Angle that the robot has turned since then.
    turned_rad: f32,
    /// The reading after a leap, and for how long it has stayed there, seconds.
    leapt: Option<(f32, f32)>,
    /// Time without a reading, seconds.
    silent_s: f32,
}

impl Compass {
    /// Whether the compass has been found wrong.
    pub(crate) const fn is_wrong(&self) -> bool {
        self.is_wrong
    }

    /// Notes a tick without a reading. The heading drifts meanwhile, so the first reading after a
    /// longer silence does not count as a leap.
    pub(crate) fn miss(&mut self, elapsed_s: f32) {
        self.silent_s += elapsed_s;
    }

    /// Judges a reading, map axes. Returns it if it counts.
    pub(crate) fn judge(&mut self, reading_rad: f32, evidence: &Evidence) -> Option<f32> {
        let was_silent = core::mem::take(&mut self.silent_s) > LONGEST_SILENCE_S;
        let expected_rad = evidence.expected_rad.filter(|_| self.is_wrong || !was_silent);
        let off_rad = expected_rad.map_or(0.0, |rad| wrap_angle(reading_rad - rad).abs());
        self.has_agreed &= off_rad < AGREEMENT_RAD;
        self.compare_with_turns(reading_rad, evidence);
        if let Some((course_rad, elapsed_s)) = evidence.course {
            let rate_radps = evidence.turn_rate_radps;
            self.compare_with_course(reading_rad, course_rad, rate_radps, elapsed_s);
        }
        if self.is_wrong {
            return None;
        }
        if off_rad <= WRONG_RAD {
            self.leapt = None;
            return Some(reading_rad);
        }
        self.follow_leap(reading_rad, evidence.elapsed_s)
    }

    fn compare_with_turns(&mut self, reading_rad: f32, evidence: &Evidence) {
        let Some(start_rad) = self.start_rad else {
            // The turn before the first reading shows nothing.
            self.start_rad = Some(reading_rad);
            return;
        };
        if evidence.is_turn_measured && evidence.turn_rate_radps.abs() > TURNING_RADPS {
            self.turned_rad += evidence.turn_rate_radps * evidence.elapsed_s;
        }
        if self.turned_rad.abs() > TURNED_RAD {
            let is_frozen = wrap_angle(reading_rad - start_rad).abs() < FROZEN_RAD;
            if is_frozen {
                self.doubt(DOUBT_S);
            } else if self.is_wrong && self.has_agreed {
                self.restart();
            }
            (self.start_rad, self.turned_rad, self.has_agreed) = (Some(reading_rad), 0.0, true);
        }
    }

    /// Trusts the compass anew.
    pub(crate) fn restart(&mut self) {
        *self = Self::default();
    }

    fn compare_with_course(
        &mut self,
        reading_rad: f32,
        course_rad: f32,
        rate: f32,
        elapsed_s: f32,
    ) {
        if rate.abs() > STRAIGHT_RADPS {
            return;
        }
        if wrap_angle(reading_rad - course_rad).abs() > WRONG_RAD {
            self.doubt(elapsed_s);
        } else {
            self.doubt_s = (self.doubt_s - 2.0 * elapsed_s).max(0.0);
        }
    }

    fn doubt(&mut self, seconds: f32) {
        self.doubt_s += seconds;
        if self.doubt_s >= DOUBT_S {
            *self = Self { is_wrong: true, ..Self::default() };
        }
    }

    /// The reading if it has stayed where it leapt to for long enough.
    fn follow_leap(&mut self, reading_rad: f32, elapsed_s: f32) -> Option<f32> {
        let stays =
            |(last_rad, _): &(f32, f32)| wrap_angle(reading_rad - last_rad).abs() < WRONG_RAD;
        let stayed_s = match self.leapt.filter(stays) {
            Some((_, stayed_s)) => stayed_s + elapsed_s,
            None => {
                self.doubt(DOUBT_PER_LEAP_S);
                0.0
            }
        };
        self.leapt = Some((reading_rad, stayed_s));
        if stayed_s < LEAP_S {
            return None;
        }
        self.leapt = None;
        Some(reading_rad)
    }
}
