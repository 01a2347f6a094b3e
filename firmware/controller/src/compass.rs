//! Judges the compass: against the course over ground, against the turn rate, against itself.
//!
//! Three signs raise doubt:
//! - the course over ground differs by more than [`WRONG_RAD`], while the robot drives fast enough
//!   and hardly turns. Not on a boat: it drifts, so its course is not its heading;
//! - the robot turns as commanded and the compass does not: it is frozen, or pulled by a magnet on the
//!   robot. One that repeats itself to the last bit shows that sooner;
//! - the robot turns as commanded and the compass turns the other way: it is late;
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
/// A compass that repeats itself to the last bit in a turn of this angle is frozen, radians.
const REPEATED_RAD: f32 = 0.25;
/// A compass that has moved this far against that turn is late, radians.
const BACK_RAD: f32 = 0.3;

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
    /// Turn rate of a robot that does what it is commanded, rad/s.
    pub(crate) modelled_radps: f32,
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
    /// The last reading, and the angle that the robot has turned while it was repeated.
    last_rad: f32,
    repeated_rad: f32,
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
        if core::mem::replace(&mut self.last_rad, reading_rad) != reading_rad {
            self.repeated_rad = 0.0;
        }
        let (measured_radps, modelled_radps) = (evidence.turn_rate_radps, evidence.modelled_radps);
        // A gyroscope that contradicts the commands may be wrong itself: what both say counts.
        let rate_radps = measured_radps.abs().min(modelled_radps.abs()).copysign(measured_radps);
        let is_commanded = measured_radps * modelled_radps > 0.0;
        if evidence.is_turn_measured && is_commanded && rate_radps.abs() > TURNING_RADPS {
            self.turned_rad += rate_radps * evidence.elapsed_s;
            self.repeated_rad += rate_radps * evidence.elapsed_s;
        }
        if self.repeated_rad.abs() > REPEATED_RAD {
            self.doubt(DOUBT_S);
        }
        if self.turned_rad.abs() > TURNED_RAD {
            let moved_rad = wrap_angle(reading_rad - start_rad);
            let turns_back = self.turned_rad * moved_rad < 0.0 && moved_rad.abs() > BACK_RAD;
            if moved_rad.abs() < FROZEN_RAD || turns_back {
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

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_S: f32 = 0.05;

    /// Judges these readings while the robot turns; returns the number of the tick that finds the
    /// compass wrong. The function gives the reading, radians, and the measured and the modelled
    /// turn rate, rad/s, at a time, seconds.
    fn found(ticks: u16, at: impl Fn(f32) -> (f32, f32, f32)) -> Option<u16> {
        let mut compass = Compass::default();
        (0..ticks).find(|tick| {
            let (reading_rad, turn_rate_radps, modelled_radps) = at(f32::from(*tick) * TICK_S);
            let evidence = Evidence {
                expected_rad: None,
                course: None,
                turn_rate_radps,
                is_turn_measured: true,
                modelled_radps,
                elapsed_s: TICK_S,
            };
            compass.judge(wrap_angle(reading_rad), &evidence);
            compass.is_wrong()
        })
    }

    /// At 1 rad/s, a quarter of a radian takes five ticks. A compass in steps of a tenth repeats
    /// itself for two.
    #[test]
    fn a_compass_that_repeats_itself_to_the_last_bit_in_a_turn_is_frozen() {
        assert_eq!(found(40, |_| (0.3, 1.0, 1.0)), Some(6));
        assert_eq!(found(40, |_| (0.3, -1.0, -1.0)), Some(6));
        let coarse = |time_s: f32| (((10.0 * time_s) as u8 as f32) / 10.0, 1.0, 1.0);
        assert_eq!(found(200, coarse), None);
        assert_eq!(found(200, |_| (0.3, 0.05, 0.05)), None, "the bias of a gyroscope");
    }

    /// The robot turns to the left for a second and to the right for another, at 1.5 rad/s.
    #[test]
    fn a_compass_that_turns_against_the_robot_is_late() {
        let turn = |time_s: f32| if (time_s as u8).is_multiple_of(2) { 1.5 } else { -1.5 };
        let heading = |time_s: f32| {
            let part_s = time_s - time_s as u8 as f32;
            if (time_s as u8).is_multiple_of(2) { 1.5 * part_s } else { 1.5 * (1.0 - part_s) }
        };
        let late = |time_s: f32| (heading(time_s + 1.0), turn(time_s), turn(time_s));
        assert!(found(60, late).is_some());
        let sound = |time_s: f32| (heading(time_s), turn(time_s), turn(time_s));
        assert_eq!(found(200, sound), None);
        // The compass and the commands agree: the gyroscope is late.
        let gyroscope = |time_s: f32| (heading(time_s), turn(time_s + 1.0), turn(time_s));
        assert_eq!(found(200, gyroscope), None);
        // A tenth of the turn, to the other side, is noise.
        let slight = |time_s: f32| (-0.1 * heading(time_s), turn(time_s), turn(time_s));
        assert_eq!(found(12, slight), None);
    }
}
