//! Judges odometry and gyroscope: against the commands, against the receiver and the compass.
//!
//! Three witnesses know how the robot moves: what it commanded, what it measured, and a reference
//! that does not depend on wheels: the receiver's velocity for the speed, the compass for the turn
//! rate. Of three, the one that contradicts both others is wrong:
//! - the measurement contradicts reference and commands: it is wrong, and the commands stand in;
//! - measurement and reference agree that the robot does not do what it is commanded: the motors do
//!   not answer. Without a reference, the measurement alone counts;
//! - the reference contradicts both: that is judged elsewhere, see [`crate::slip`] and
//!   [`crate::compass`].
//!
//! A reading also has to be possible: between the last one and what is commanded, or close to that.
//! One that leaps does not count before it has stayed for [`LEAP_S`]; readings that leap again and
//! again are wrong.

use math::scalar;
use plan_format::parameters::Vehicle;
use serde::{Deserialize, Serialize};

/// A reading that leaps counts after it has stayed for this time, seconds.
const LEAP_S: f32 = 1.0;
/// Leaps in a row, without as many sound readings for each, after which the measurement is wrong.
const MOST_LEAPS: f32 = 8.0;
/// A sound reading makes up for this many leaps.
const SOUND: f32 = 0.1;
/// A measurement counts again after it has agreed with the other witnesses for this time, seconds.
const CALM_S: f32 = 5.0;

/// The motors do not answer once the robot has done less than this share of what it was commanded.
const DEAD_SHARE: f32 = 0.25;
/// It must have done so for this time, seconds: a heavy vehicle needs some time to gain speed.
const DEAD_S: f32 = 3.0;
/// Slower commands show nothing, m/s and rad/s.
const LEAST_MPS: f32 = 0.1;
const LEAST_RADPS: f32 = 0.3;
/// A reference speed is used for this time, seconds.
const REFERENCE_S: f32 = 1.0;

/// How an axis is judged.
struct Limits {
    /// A possible reading is at most this far from the last one and the command, m/s or rad/s.
    margin: f32,
    /// Change of the motion in a second, m/s^2 or rad/s^2.
    rate: f32,
    /// Witnesses contradict each other if they differ by this way, metres or radians.
    off: f32,
    /// Time constant of the comparison, seconds.
    memory_s: f32,
}

/// Speed or turn rate, as the robot believes it to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Axis {
    /// The last reading that counts; `None` before the first.
    believed: Option<f32>,
    /// What a robot that obeys its commands does.
    model: f32,
    /// The reading after a leap, and for how long it has stayed there, seconds.
    leapt: Option<(f32, f32)>,
    /// Leaps, less what sound readings made up for.
    leaps: f32,
    /// Ways by measurement and by model since the last comparison, metres or radians.
    measured: f32,
    modelled: f32,
    /// By how much those have exceeded the way of the reference.
    measured_off: f32,
    modelled_off: f32,
    is_wrong: bool,
    calm_s: f32,
}

impl Axis {
    /// Judges a reading; returns the motion to count with.
    fn judge(&mut self, reading: Option<f32>, command: f32, elapsed_s: f32, by: &Limits) -> f32 {
        let most = by.rate * elapsed_s;
        self.model += scalar::clamp(command - self.model, -most, most);
        let Some(reading) = reading else {
            self.believed = None;
            return command;
        };
        self.measured += reading * elapsed_s;
        self.modelled += self.model * elapsed_s;
        let last = self.believed.unwrap_or(reading);
        let is_near = |value: f32| (reading - value).abs() <= by.margin;
        let is_between = (reading - last) * (reading - command) <= 0.0;
        if is_near(last) || is_near(command) || is_between {
            self.leapt = None;
            self.leaps = (self.leaps - SOUND).max(0.0);
            self.calm_s += elapsed_s;
            self.believed = Some(reading);
        } else {
            let stays = |(before, _): &(f32, f32)| (reading - before).abs() <= by.margin;
            let stayed_s = self.leapt.filter(stays).map(|(_, stayed_s)| stayed_s + elapsed_s);
            if stayed_s.is_none() {
                self.leaps += 1.0;
                self.calm_s = 0.0;
            }
            let stayed_s = stayed_s.unwrap_or(0.0);
            self.leapt = Some((reading, stayed_s));
            self.believed = Some(if stayed_s >= LEAP_S { reading } else { self.model });
        }
        self.is_wrong |= self.leaps >= MOST_LEAPS;
        if self.is_wrong {
            // The next reading is compared with the model.
            self.believed = Some(self.model);
        }
        if self.is_wrong && self.calm_s >= CALM_S {
            (self.is_wrong, self.leaps) = (false, 0.0);
        }
        self.believed.unwrap_or(reading)
    }

    /// Begins the ways of the next comparison.
    fn begin(&mut self) {
        (self.measured, self.modelled) = (0.0, 0.0);
    }

    /// Compares the ways since the last comparison with the one of the reference.
    fn compare(&mut self, way: f32, elapsed_s: f32, by: &Limits) {
        let kept = (1.0 - elapsed_s / by.memory_s).max(0.0);
        self.measured_off = self.measured_off * kept + self.measured - way;
        self.modelled_off = self.modelled_off * kept + self.modelled - way;
        self.begin();
        if self.measured_off.abs() > 0.5 * by.off {
            self.calm_s = 0.0;
        }
        let is_alone = self.modelled_off.abs() < 0.5 * by.off;
        self.is_wrong |= is_alone && self.measured_off.abs() > by.off;
    }
}

/// What the judgement keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Odometry {
    speed: Axis,
    turn: Axis,
    /// The speed of the last fix with a velocity, m/s, and its age, seconds.
    reference: Option<(f32, f32)>,
    /// The last heading of the compass.
    heading_rad: Option<f32>,
    /// Time for which the motors have not answered, seconds.
    dead_s: f32,
}

impl Odometry {
    /// Judges the readings of a tick. Returns the speed and turn rate to count with. `commanded` are
    /// those of the last tick, `heading_rad` is a heading that does not come from the turn rate.
    pub(crate) fn judge(
        &mut self,
        readings: (Option<f32>, Option<f32>),
        commanded: (f32, f32),
        heading_rad: Option<f32>,
        vehicle: &Vehicle,
        elapsed_s: f32,
    ) -> (f32, f32) {
        let speed_mps =
            self.speed.judge(readings.0, commanded.0, elapsed_s, &speed_limits(vehicle));
        let turn_rate_radps = self.turn.judge(readings.1, commanded.1, elapsed_s, &TURN);
        let before_rad = core::mem::replace(&mut self.heading_rad, heading_rad);
        if let (Some(before_rad), Some(heading_rad)) = (before_rad, heading_rad) {
            self.turn.compare(scalar::wrap_angle(heading_rad - before_rad), elapsed_s, &TURN);
        } else {
            self.turn.begin();
        }
        if let Some((_, age_s)) = &mut self.reference {
            *age_s += elapsed_s;
        }
        self.watch_motors(readings, commanded, elapsed_s);
        (speed_mps, turn_rate_radps)
    }

    /// Takes over the speed that a new fix reports.
    pub(crate) fn hear(&mut self, speed_mps: f32, vehicle: &Vehicle) {
        if let Some((_, elapsed_s)) = self.reference {
            // The receiver does not know which way the robot faces.
            let ahead_mps = if self.speed.modelled < 0.0 { -speed_mps } else { speed_mps };
            let way_m = ahead_mps * elapsed_s;
            if elapsed_s < REFERENCE_S {
                self.speed.compare(way_m, elapsed_s, &speed_limits(vehicle));
            }
        }
        self.speed.begin();
        self.reference = Some((speed_mps, 0.0));
    }

    /// Turn rate of a robot that does what it is commanded, rad/s.
    pub(crate) const fn modelled_turn_radps(&self) -> f32 {
        self.turn.model
    }

    /// Whether the turn rate is measured, and nothing shows that it is wrong.
    pub(crate) fn is_turn_sound(&self) -> bool {
        self.turn.believed.is_some() && self.turn.leapt.is_none() && !self.turn.is_wrong
    }

    /// Whether the motors do not do what they are commanded.
    pub(crate) fn are_motors_dead(&self) -> bool {
        self.dead_s >= DEAD_S
    }

    fn watch_motors(
        &mut self,
        (speed, turn): (Option<f32>, Option<f32>),
        (commanded_mps, commanded_radps): (f32, f32),
        elapsed_s: f32,
    ) {
        let speed = speed.filter(|_| !self.speed.is_wrong);
        let turn = turn.filter(|_| !self.turn.is_wrong);
        let fresh = self.reference.filter(|(_, age_s)| *age_s < REFERENCE_S);
        let by_fix = fresh.map_or(0.0, |(speed_mps, _)| speed_mps);
        let is_dead = if commanded_mps.abs() >= LEAST_MPS {
            let least_mps = DEAD_SHARE * commanded_mps.abs();
            speed.map(|mps| mps.abs() < least_mps && by_fix < least_mps.max(LEAST_MPS))
        } else if commanded_radps.abs() >= LEAST_RADPS {
            turn.map(|radps| radps.abs() < DEAD_SHARE * commanded_radps.abs())
        } else {
            None
        };
        match is_dead {
            Some(true) => self.dead_s += elapsed_s,
            Some(false) => self.dead_s = (self.dead_s - 2.0 * elapsed_s).max(0.0),
            None => {}
        }
    }

    /// A new order to arm is a new attempt.
    pub(crate) fn restart(&mut self) {
        self.dead_s = 0.0;
    }
}

fn speed_limits(vehicle: &Vehicle) -> Limits {
    Limits { margin: 0.3, rate: vehicle.braking_mps2, off: 0.8, memory_s: 4.0 }
}

const TURN: Limits = Limits { margin: 0.6, rate: 6.0, off: 0.6, memory_s: 2.0 };
