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

    /// The robot's clock was set: nothing tells how far the robot has moved meanwhile.
    pub(crate) fn clock_was_set(&mut self) {
        (self.reference, self.heading_rad) = (None, None);
        self.speed.begin();
        self.turn.begin();
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

#[cfg(test)]
mod tests {
    use super::*;
    use plan_format::Parameters;

    /// A binary fraction: sums of ticks are exact, and 16 ticks are a second.
    const TICK_S: f32 = 0.0625;

    /// The limits of the speed for a vehicle that brakes at 2 m/s^2: 0.125 m/s in a tick.
    const SPEED: Limits = Limits { margin: 0.3, rate: 2.0, off: 0.8, memory_s: 4.0 };

    fn is_close(value: f32, expected: f32) -> bool {
        (value - expected).abs() < 1e-4
    }

    /// Gives an axis the same reading and command for some ticks; returns the last motion.
    fn judge(axis: &mut Axis, ticks: u16, reading: Option<f32>, command: f32) -> f32 {
        (0..ticks).fold(0.0, |_, _| axis.judge(reading, command, TICK_S, &SPEED))
    }

    /// Gives an odometry the same readings and commands for a tick.
    fn tick(
        odometry: &mut Odometry,
        readings: (Option<f32>, Option<f32>),
        commanded: (f32, f32),
        heading_rad: Option<f32>,
    ) -> (f32, f32) {
        let vehicle = Parameters::default().vehicle;
        odometry.judge(readings, commanded, heading_rad, &vehicle, TICK_S)
    }

    /// The number of the tick that finds the motors dead, if one of the first 160 does.
    fn dead_after(
        odometry: &mut Odometry,
        readings: (f32, f32),
        commanded: (f32, f32),
    ) -> Option<u16> {
        let readings = (Some(readings.0), Some(readings.1));
        (1..=160).find(|_| {
            tick(odometry, readings, commanded, None);
            odometry.are_motors_dead()
        })
    }

    /// The model gains 0.125 m/s in a tick. After a second at 0.9 m/s the robot has measured 0.9 m;
    /// the model has gone 0.28125 m in eight ticks and 0.5 m in another eight.
    #[test]
    fn the_ways_are_those_of_the_readings_and_of_a_robot_that_gains_speed() {
        let mut axis = Axis::default();
        assert!(is_close(judge(&mut axis, 4, Some(0.9), 1.0), 0.9));
        assert!(is_close(axis.model, 0.5), "{axis:?}");
        judge(&mut axis, 12, Some(0.9), 1.0);
        assert!(is_close(axis.measured, 0.9) && is_close(axis.modelled, 0.78125), "{axis:?}");
        assert!(is_close(judge(&mut axis, 1, None, 0.7), 0.7), "without a reading");
    }

    /// A reading is possible between the last one and the command, and up to 0.3 m/s beside each.
    #[test]
    fn a_reading_leaps_if_it_is_far_from_the_last_one_and_the_command() {
        for (last, command, reading, is_possible) in [
            (0.0, 0.0, 0.2, true),
            (0.0, 1.0, -0.2, true),
            (0.0, 1.0, 1.2, true),
            (0.0, 1.0, 0.5, true),
            (1.0, 0.0, 0.5, true),
            (0.0, 2.0, 1.5, true),
            (0.0, 0.0, 0.5, false),
            (0.0, 1.0, 1.5, false),
            (0.0, 1.0, -0.5, false),
            (-0.4, -0.5, 0.5, false),
            (2.0, 3.0, 0.4, false),
        ] {
            let mut axis = Axis { believed: Some(last), ..Axis::default() };
            axis.judge(Some(reading), command, TICK_S, &SPEED);
            assert_eq!(axis.leapt.is_none(), is_possible, "{last} {command} {reading}");
        }
    }

    /// The model stands in for a reading that leaps. After a second the reading counts.
    #[test]
    fn a_reading_that_leaps_counts_after_it_has_stayed_for_a_second() {
        let mut axis = Axis::default();
        assert!(is_close(judge(&mut axis, 1, Some(0.0), 0.0), 0.0));
        assert!(is_close(judge(&mut axis, 1, Some(2.0), 0.0), 0.0), "a leap");
        assert!(is_close(judge(&mut axis, 15, Some(2.0), 0.0), 0.0), "{axis:?}");
        assert!(is_close(axis.leaps, 1.0), "{axis:?}");
        assert!(is_close(judge(&mut axis, 1, Some(2.0), 0.0), 2.0), "{axis:?}");
    }

    /// The eighth leap in a row shows that the measurement is wrong. With four sound readings after
    /// each leap it is the thirteenth, with eleven none.
    #[test]
    fn readings_that_leap_again_and_again_are_wrong_until_they_are_calm() {
        for (sound, expected) in [(0, Some(8)), (4, Some(13)), (11, None)] {
            let mut axis = Axis::default();
            judge(&mut axis, 1, Some(0.0), 0.0);
            let found = (1..=40_u16).find(|leap| {
                let reading = if leap.is_multiple_of(2) { 5.0 } else { 10.0 };
                judge(&mut axis, 1, Some(reading), 0.0);
                let is_wrong = axis.is_wrong;
                judge(&mut axis, sound, Some(0.0), 0.0);
                is_wrong
            });
            assert_eq!(found, expected, "{sound} {axis:?}");
        }
        let mut axis = Axis { is_wrong: true, leaps: 8.0, ..Axis::default() };
        assert!(is_close(judge(&mut axis, 79, Some(0.2), 0.0), 0.0), "the model stands in");
        assert!(axis.is_wrong, "{axis:?}");
        judge(&mut axis, 1, Some(0.2), 0.0);
        assert!(!axis.is_wrong, "five seconds of sound readings: {axis:?}");
    }

    /// The reference contradicts the measurement by more than 0.8 m, and the model by less than
    /// half of that. From 0.4 m on, the measurement is not calm either.
    #[test]
    fn a_measurement_that_alone_contradicts_the_reference_is_wrong() {
        for (measured, modelled, is_wrong, is_calm) in [
            (0.3, 0.0, false, true),
            (0.4, 0.0, false, true),
            (0.5, 0.0, false, false),
            (0.8, 0.0, false, false),
            (0.9, 0.0, true, false),
            (-0.9, 0.3, true, false),
            (0.9, 0.4, false, false),
            (0.9, 0.9, false, false),
        ] {
            let mut axis = Axis { measured, modelled, calm_s: 3.0, ..Axis::default() };
            axis.compare(0.0, 1.0, &SPEED);
            assert_eq!((axis.is_wrong, axis.calm_s > 0.0), (is_wrong, is_calm), "{axis:?}");
        }
        // A second later, three quarters of the difference remain.
        let mut axis = Axis::default();
        for off in [0.2, 0.35] {
            (axis.measured, axis.modelled) = (0.5, 0.9);
            axis.compare(0.7, 1.0, &SPEED);
            assert!(is_close(axis.measured_off, -off), "{axis:?}");
            assert!(is_close(axis.modelled_off, off), "{axis:?}");
        }
    }

    /// The compass turns at 0.75 rad/s, as commanded. A gyroscope that shows this agrees; one that
    /// shows 0 is wrong after 0.6 rad, and the command stands in.
    #[test]
    fn a_gyroscope_that_contradicts_compass_and_commands_is_wrong() {
        for (reading, is_sound) in [(0.75, true), (0.0, false)] {
            let mut odometry = Odometry::default();
            let mut motion = (0.0, 0.0);
            for step in 0..32_u8 {
                let heading_rad = scalar::wrap_angle(2.0 + 0.75 * TICK_S * f32::from(step));
                let readings = (Some(0.0), Some(reading));
                motion = tick(&mut odometry, readings, (0.0, 0.75), Some(heading_rad));
            }
            assert_eq!(odometry.is_turn_sound(), is_sound, "{odometry:?}");
            assert!(is_close(motion.1, 0.75), "{motion:?}");
            assert!(is_close(odometry.modelled_turn_radps(), 0.75), "{odometry:?}");
            assert_eq!(is_close(odometry.turn.measured_off, 0.0), is_sound, "{odometry:?}");
        }
    }

    /// The turn rate is not sound without a reading, after a leap and while it is wrong.
    #[test]
    fn a_turn_rate_is_sound_if_it_is_measured_and_possible() {
        for (believed, leapt, is_wrong, is_sound) in [
            (Some(0.0), None, false, true),
            (None, None, false, false),
            (Some(0.0), Some((3.0, 0.0)), false, false),
            (Some(0.0), None, true, false),
            (None, None, true, false),
        ] {
            let turn = Axis { believed, leapt, is_wrong, ..Axis::default() };
            let odometry = Odometry { turn, ..Odometry::default() };
            assert_eq!(odometry.is_turn_sound(), is_sound, "{odometry:?}");
        }
    }

    /// The receiver reports a speed without a sign: a robot whose command is to drive back drives
    /// back, and any other drives ahead. Fixes a second apart are not compared.
    #[test]
    fn a_fix_compares_the_way_since_the_last_one() {
        let vehicle = Parameters::default().vehicle;
        for (ticks, reading_mps, commanded_mps, fix_mps, off_m) in [
            (8, 1.0, 1.0, 1.0, 0.0),
            (8, -1.0, -1.0, 1.0, 0.0),
            (8, 0.5, 0.0, 0.5, 0.0),
            (8, 1.0, 1.0, 0.5, 0.25),
            (15, 1.0, 1.0, 0.0, 0.9375),
            (16, 1.0, 1.0, 0.0, 0.0),
        ] {
            let mut odometry = Odometry::default();
            odometry.hear(fix_mps, &vehicle);
            for _ in 0..ticks {
                tick(&mut odometry, (Some(reading_mps), None), (commanded_mps, 0.0), None);
            }
            odometry.hear(fix_mps, &vehicle);
            assert!(is_close(odometry.speed.measured_off, off_m), "{ticks} {odometry:?}");
        }
    }

    /// Motors that do less than a quarter of a command for three seconds are dead. Slow commands
    /// and a wrong measurement show nothing.
    #[test]
    fn motors_that_do_less_than_a_quarter_of_a_command_are_dead() {
        for (readings, commanded, expected) in [
            ((0.0, 0.0), (1.0, 0.0), Some(48)),
            ((-0.3, 0.0), (-2.0, 0.0), Some(48)),
            ((0.25, 0.0), (1.0, 0.0), None),
            ((0.0, 0.0), (0.0625, 0.0), None),
            ((0.0, 0.0), (0.0, 1.0), Some(48)),
            ((0.0, -0.3), (0.0, -2.0), Some(48)),
            ((0.0, 0.5), (0.0, 2.0), None),
            ((0.0, 0.0), (0.0, 0.25), None),
        ] {
            let found = dead_after(&mut Odometry::default(), readings, commanded);
            assert_eq!(found, expected, "{readings:?} {commanded:?}");
        }
        let wrong = Axis { is_wrong: true, ..Axis::default() };
        let mut odometry = Odometry { speed: wrong, turn: wrong, ..Odometry::default() };
        for commanded in [(1.0, 0.0), (0.0, 1.0)] {
            for _ in 0..32 {
                tick(&mut odometry, (Some(0.0), Some(0.0)), commanded, None);
            }
            assert!(is_close(odometry.dead_s, 0.0), "{odometry:?}");
        }
    }

    /// A fix shows for less than a second that the robot moves. Ticks in which it obeys count
    /// twice, and a new order to arm begins anew.
    #[test]
    fn motors_that_move_the_robot_are_not_dead() {
        for (fix_mps, expected) in [(0.0, Some(48)), (0.2, Some(48)), (0.25, Some(63))] {
            let reference = Some((fix_mps, 0.0));
            let mut odometry = Odometry { reference, ..Odometry::default() };
            let found = dead_after(&mut odometry, (0.0, 0.0), (1.0, 0.0));
            assert_eq!(found, expected, "{fix_mps}");
        }
        let mut odometry = Odometry { dead_s: 2.0, ..Odometry::default() };
        for _ in 0..8 {
            tick(&mut odometry, (Some(1.0), None), (1.0, 0.0), None);
        }
        assert_eq!(dead_after(&mut odometry, (0.0, 0.0), (1.0, 0.0)), Some(32));
        odometry.restart();
        assert!(!odometry.are_motors_dead());
        assert_eq!(dead_after(&mut odometry, (0.0, 0.0), (1.0, 0.0)), Some(48));
    }
}
