//! Judges the robot's clock, and counts time by its steps.
//!
//! Percepts bring the time of a clock that may stand, be set, or leap again and again:
//! - one time for several ticks: the clock stands. Nothing tells how the robot moves meanwhile;
//! - a step of more than a second: it was set, or the robot has paused. The step does not count;
//! - a step back: it was set. What has a time stamp of before is from another history.
//!
//! A clock may be set now and then. One that is set back again and again, or stands at every second
//! tick, is wrong until it has gone for a while.

use serde::{Deserialize, Serialize};

/// A longer step does not count, microseconds.
pub(crate) const LONGEST_STEP_US: u64 = 1_000_000;

/// The clock stands still if it has had one time for this many ticks.
const STANDING_TICKS: u8 = 10;
/// Doubt for a tick with the time of the last one; each tick takes 1 away. So a clock that stands at
/// every second tick is wrong within seconds.
const STANDING_DOUBT: u16 = 3;
/// With this doubt the clock is wrong.
const MOST_STANDING_DOUBT: u16 = 50;
/// Doubt for a step back; each tick takes 1 away.
const LEAP_DOUBT: u16 = 200;
/// With this doubt the clock is wrong: after three steps back within 150 ticks.
const MOST_LEAP_DOUBT: u16 = 450;
/// Doubt rises this much higher at most: a clock that goes again is trusted again after as many ticks.
const HIGHER: u16 = 100;

/// What a step of the clock means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// Time has passed, or none, seconds.
    Passed(f32),
    /// The clock was set ahead, or the robot has paused.
    Ahead,
    /// The clock was set back.
    Back,
}

/// What the judgement keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clock {
    /// Time of the last tick.
    now_us: u64,
    /// Sum of the steps that count.
    passed_us: u64,
    /// Ticks since the clock last advanced.
    standing_ticks: u8,
    standing_doubt: u16,
    leap_doubt: u16,
}

impl Clock {
    /// Time of the last tick, microseconds.
    pub(crate) const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Time by the steps that count, microseconds: it never goes back.
    pub(crate) const fn passed_us(&self) -> u64 {
        self.passed_us
    }

    /// Whether the last tick had the time of the one before.
    pub(crate) const fn stands(&self) -> bool {
        self.standing_ticks > 0
    }

    /// Whether the clock stands still, or cannot be trusted.
    pub(crate) const fn is_wrong(&self) -> bool {
        self.standing_ticks >= STANDING_TICKS
            || self.standing_doubt >= MOST_STANDING_DOUBT
            || self.leap_doubt >= MOST_LEAP_DOUBT
    }

    /// Sets the clock to the time of a tick.
    pub(crate) fn advance(&mut self, now_us: u64) -> Step {
        let last_us = core::mem::replace(&mut self.now_us, now_us);
        let stands = now_us == last_us;
        self.standing_ticks = if stands { self.standing_ticks.saturating_add(1) } else { 0 };
        let grown = |doubt: u16, is_more: bool, by: u16, most: u16| {
            (doubt + if is_more { by } else { 0 }).saturating_sub(1).min(most + HIGHER)
        };
        self.standing_doubt =
            grown(self.standing_doubt, stands, STANDING_DOUBT, MOST_STANDING_DOUBT);
        self.leap_doubt = grown(self.leap_doubt, now_us < last_us, LEAP_DOUBT, MOST_LEAP_DOUBT);
        let Some(step_us) = now_us.checked_sub(last_us) else { return Step::Back };
        if step_us > LONGEST_STEP_US {
            return Step::Ahead;
        }
        self.passed_us += step_us;
        Step::Passed(step_us as u32 as f32 * 1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of the first tick, of 20 in a second, that finds the clock wrong. Its time in tick
    /// `n` is that of the real one plus `off`, microseconds.
    fn found(ticks: u64, off_us: impl Fn(u64) -> i64) -> Option<u64> {
        let mut clock = Clock::default();
        (0..ticks).find(|&tick| {
            let time_us = 10_000_000_000 + tick * 50_000;
            clock.advance(time_us.saturating_add_signed(off_us(tick)));
            clock.is_wrong()
        })
    }

    #[test]
    fn a_clock_that_goes_back_again_and_again_is_wrong() {
        let back_every = |ticks: u64| move |tick: u64| -200_000 * (tick / ticks) as i64;
        assert_eq!(found(2_000, |_| 0), None);
        assert_eq!(found(200, back_every(1)), Some(3));
        assert_eq!(found(200, back_every(20)), Some(60), "once in a second");
        assert_eq!(found(400, back_every(70)), Some(210), "once in three and a half seconds");
        assert_eq!(found(4_000, back_every(200)), None, "once in ten seconds");
        // Set back twice.
        let twice =
            |tick: u64| -3_600_000_000 * i64::from(tick > 20) - 100_000 * i64::from(tick > 25);
        assert_eq!(found(200, twice), None);
    }

    /// However long it was wrong, a hundred ticks are enough, or one more.
    #[test]
    fn a_clock_that_goes_again_is_trusted_again() {
        for is_back in [false, true] {
            let mut clock = Clock::default();
            let mut time_us = 10_000_000_000;
            for tick in 0..2_000_u64 {
                time_us = if is_back { time_us - 50_000 } else { time_us + tick % 2 * 50_000 };
                clock.advance(time_us);
            }
            assert!(clock.is_wrong());
            let wrong = (0..300_u64).take_while(|_| {
                time_us += 50_000;
                clock.advance(time_us);
                clock.is_wrong()
            });
            assert!((99..=101).contains(&wrong.count()), "{is_back}");
        }
    }

    #[test]
    fn steps_that_count_add_up() {
        let mut clock = Clock::default();
        assert_eq!(clock.advance(5_000_000), Step::Ahead);
        assert_eq!(clock.advance(5_250_000), Step::Passed(0.25));
        assert_eq!(clock.advance(4_000_000), Step::Back);
        assert_eq!(clock.advance(5_000_000), Step::Passed(1.0));
        assert_eq!(clock.advance(6_000_001), Step::Ahead);
        assert_eq!((clock.passed_us(), clock.now_us()), (1_250_000, 6_000_001));
    }
}
