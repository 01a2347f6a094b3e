//! Finds scans that come late, after a silence of the range finder.
//!
//! A driver that hangs and goes on often delivers what it has queued: every scan from then on shows
//! the past. The first scans show it, because the robot has moved since the last one before the
//! silence: what it saw then is elsewhere now. A scan that shows free space there, and distances as
//! before, is late; and so is one that shows most sectors as before although the robot has turned. A
//! scan that shows the obstacles where they must be now is in time. Walls that the robot passes look
//! the same from both places and say nothing.
//!
//! The robot may have stood meanwhile. So the trial goes on until sectors enough have spoken, or
//! until the robot has moved too far for a comparison.

use math::Vec2;
use math::vector;
use robot_io::RangeReading;
use serde::{Deserialize, Serialize};

use crate::scan::{Moved, Scan, by_sector, covering, free_m, in_direction};

/// Distances that differ by less than this are the same, metres.
const SAME_M: f32 = 0.12;
/// An obstacle has gone if free space reaches farther beyond it than this, metres.
const GONE_M: f32 = 0.1;
/// Obstacles that must have gone for late scans, and distances that must be as before. One wrong
/// verdict stops the robot for good.
const LATE_VOTES: u8 = 3;
/// This many obstacles are enough where most sectors are as before.
const FEW_VOTES: u8 = 2;
/// This many times as many as are where they must be.
const LATE_MAJORITY: u8 = 2;
/// Obstacles that must be where they must be for scans in time.
const IN_TIME_VOTES: u8 = 3;
/// A robot that has turned this far sees nothing as before, radians: not even walls that it passes.
const TURNED_RAD: f32 = 0.35;
/// Most sectors are as before if this share of them is at its old distance: three of five.
const SAME_SHARE: (usize, usize) = (3, 5);
/// A trial ends after the robot has moved this far, metres, or turned this far, radians: farther
/// away, distances are the same by chance.
const FARTHEST_M: f32 = 0.6;
const FARTHEST_RAD: f32 = 0.8;

/// What a scan says about the trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Late,
    InTime,
    Open,
}

/// The last sound scan before a silence, until it is clear whether later ones are late.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Trial {
    before: Scan,
    moved: Moved,
    is_open: bool,
}

impl Trial {
    /// Begins a trial against the last sound scan, since which the robot has moved like this.
    pub(crate) fn begin(&mut self, before: &Scan, moved: Moved) {
        *self = Self { before: *before, moved, is_open: true };
    }

    pub(crate) fn end(&mut self) {
        self.is_open = false;
    }

    /// The robot has moved by this since the last tick.
    pub(crate) fn advance(&mut self, moved_m: f32, turned_rad: f32) {
        if self.is_open {
            self.moved.advance(moved_m, turned_rad);
        }
    }

    /// Hears a scan after the silence.
    pub(crate) fn hear(&mut self, now: &[RangeReading]) -> Verdict {
        if !self.is_open {
            return Verdict::Open;
        }
        let verdict = compare(now, self.before.readings(), &self.moved);
        let is_far = vector::length(Vec2::from(self.moved.by_m)) > FARTHEST_M
            || self.moved.turned_rad.abs() > FARTHEST_RAD;
        self.is_open = verdict == Verdict::Open && !is_far;
        verdict
    }
}

/// Compares a scan with one from before a motion of the robot.
fn compare(now: &[RangeReading], before: &[RangeReading], moved: &Moved) -> Verdict {
    let now_m = by_sector(now.iter().copied());
    let before_m = by_sector(before.iter().copied());
    let is_same = |a: f32, b: f32| a > 0.0 && b > 0.0 && (a - b).abs() < SAME_M;
    let as_before = now_m.iter().zip(&before_m).filter(|(now, before)| is_same(**now, **before));
    let as_before = as_before.count();
    let (part, whole) = SAME_SHARE;
    let is_most_as_before = whole * as_before >= part * before.len();
    let has_turned = moved.turned_rad.abs() >= TURNED_RAD;
    let (mut gone, mut there) = (0_u8, 0_u8);
    for reading in before {
        let carried = moved.carried(reading);
        let direction = vector::from_angle(carried.bearing_rad);
        let nearest_m = in_direction(&now_m, direction);
        let distance_m = carried.distance_m;
        gone += u8::from(nearest_m > 0.0 && distance_m + GONE_M < free_m(nearest_m));
        let has_changed = !is_same(distance_m, reading.distance_m);
        // A sector that is as before says nothing.
        let speaks = |sector: usize| {
            let (now, before) = (now_m.get(sector), before_m.get(sector));
            let (Some(now_m), Some(before_m)) = (now, before) else { return false };
            is_same(*now_m, distance_m) && !is_same(*now_m, *before_m)
        };
        let (one, other) = covering(direction);
        there += u8::from(has_changed && (speaks(one) || speaks(other)));
    }
    let least = if is_most_as_before { FEW_VOTES } else { LATE_VOTES };
    let have_gone = gone >= least && gone > LATE_MAJORITY * there;
    if as_before >= usize::from(LATE_VOTES) && (have_gone || has_turned && is_most_as_before) {
        Verdict::Late
    } else if there >= IN_TIME_VOTES && there > gone {
        Verdict::InTime
    } else {
        Verdict::Open
    }
}
