//! Finds scans that come late, after a silence of the range finder.
//!
//! A driver that hangs and goes on often delivers what it has queued: every scan from then on shows
//! the past. The first scans show it, because the robot has moved since the last one before the
//! silence: what it saw then is elsewhere now. A scan that shows free space there, and distances as
//! before, is late; and so is one that shows most sectors as before although the robot has turned. A
//! scan that shows the obstacles where they must be now is in time. Walls that the robot passes look
//! the same from both places and say nothing, and neither does a turn in a round room.
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
/// A robot that has turned this far sees most things elsewhere, radians: also walls that it passes.
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
    let is_most = |count: usize| whole * count >= part * before.len();
    let has_turned = moved.turned_rad.abs() >= TURNED_RAD;
    let (mut gone, mut there, mut in_place) = (0_u8, 0_u8, 0);
    for reading in before {
        let carried = moved.carried(reading);
        let direction = vector::from_angle(carried.bearing_rad);
        let nearest_m = in_direction(&now_m, direction);
        let distance_m = carried.distance_m;
        gone += u8::from(nearest_m > 0.0 && distance_m + GONE_M < free_m(nearest_m));
        let has_changed = !is_same(distance_m, reading.distance_m);
        let of = |by_sector: &[f32], sector: usize| by_sector.get(sector).copied().unwrap_or(0.0);
        let shows = |sector: usize| is_same(of(&now_m, sector), distance_m);
        // A sector that is as before says nothing.
        let speaks =
            |sector: usize| shows(sector) && !is_same(of(&now_m, sector), of(&before_m, sector));
        let (one, other) = covering(direction);
        there += u8::from(has_changed && (speaks(one) || speaks(other)));
        in_place += usize::from(shows(one) || shows(other));
    }
    let least = if is_most(as_before) { FEW_VOTES } else { LATE_VOTES };
    let have_gone = gone >= least && gone > LATE_MAJORITY * there;
    let is_turned_back = has_turned && is_most(as_before) && !is_most(in_place);
    if as_before >= usize::from(LATE_VOTES) && (have_gone || is_turned_back) {
        Verdict::Late
    } else if there >= IN_TIME_VOTES && there > gone {
        Verdict::InTime
    } else {
        Verdict::Open
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::scan::SECTOR_RAD;
    use math::scalar;
    use std::vec::Vec;

    /// A sector without a reading.
    const NONE: f32 = 0.0;
    /// The robot drives 0.3 m. All obstacles were at 2 m: those ahead are at 1.7 m then, those
    /// astern at 2.3 m, and those beside the robot where they were. In the sectors next to straight
    /// ahead and astern it is 1.73 and 2.28 m, which is the same.
    const DRIVEN: Moved = Moved { by_m: [0.3, 0.0], turned_rad: 0.0 };
    const AHEAD: [u8; 3] = [15, 0, 1];
    const ASTERN: [u8; 3] = [7, 8, 9];
    const BESIDE: [u8; 4] = [3, 4, 12, 13];

    /// Readings in the middle of their sectors.
    fn scan(readings: impl IntoIterator<Item = (u8, f32)>) -> Vec<RangeReading> {
        let readings = readings.into_iter().filter(|(_, distance_m)| *distance_m != NONE);
        let reading = |(sector, distance_m)| RangeReading {
            bearing_rad: scalar::wrap_angle(f32::from(sector) * SECTOR_RAD),
            distance_m,
        };
        readings.map(reading).collect()
    }

    /// A scan with these distances ahead, astern and beside the robot.
    fn around(ahead_m: [f32; 3], astern_m: [f32; 3], beside_m: [f32; 4]) -> Vec<RangeReading> {
        let sectors = AHEAD.into_iter().chain(ASTERN).chain(BESIDE);
        scan(sectors.zip(ahead_m.into_iter().chain(astern_m).chain(beside_m)))
    }

    /// The scan before the drive.
    fn before() -> Vec<RangeReading> {
        around([2.0; 3], [2.0; 3], [2.0; 4])
    }

    /// The trial of a robot that has moved since that scan.
    fn trial(moved: Moved) -> Trial {
        let mut kept = Scan::default();
        kept.take(&before());
        let mut trial = Trial::default();
        trial.begin(&kept, moved);
        trial
    }

    /// What is still 2 m ahead has gone from 1.7 m, and so has what is at 4 m.
    #[test]
    fn obstacles_that_have_gone_show_late_scans_and_those_in_place_scans_in_time() {
        for (ahead_m, astern_m, beside_m, expected) in [
            ([NONE; 3], [NONE; 3], [NONE; 4], Verdict::Open),
            // Two have gone: enough if 6 of 10 are as before, not if 5 are.
            ([2.0, 2.0, NONE], [NONE; 3], [2.0; 4], Verdict::Late),
            ([2.0, 2.0, NONE], [NONE; 3], [2.0, 2.0, 2.0, NONE], Verdict::Open),
            // Three have gone: enough if three are as before, wherever these are.
            ([2.0; 3], [NONE; 3], [NONE; 4], Verdict::Late),
            ([4.0; 3], [NONE; 3], [2.0, 2.0, 2.0, NONE], Verdict::Late),
            ([4.0; 3], [NONE; 3], [2.0, 2.0, NONE, NONE], Verdict::Open),
            // More than twice as many must have gone as are in place.
            ([2.0; 3], [2.3, NONE, NONE], [NONE; 4], Verdict::Late),
            ([2.0, 2.0, NONE], [2.3, NONE, NONE], [2.0; 4], Verdict::Open),
            ([2.0; 3], [2.3, 2.3, NONE], [NONE; 4], Verdict::Open),
            // Three in place are enough, if fewer have gone.
            ([1.7; 3], [NONE; 3], [NONE; 4], Verdict::InTime),
            ([1.7, 1.7, NONE], [NONE; 3], [NONE; 4], Verdict::Open),
            ([4.0, 4.0, NONE], [2.3; 3], [NONE; 4], Verdict::InTime),
            ([4.0; 3], [2.3; 3], [NONE; 4], Verdict::Open),
            // What the robot passes looks the same from both places.
            ([NONE; 3], [NONE; 3], [2.0; 4], Verdict::Open),
        ] {
            let now = around(ahead_m, astern_m, beside_m);
            let verdict = compare(&now, &before(), &DRIVEN);
            assert_eq!(verdict, expected, "{ahead_m:?} {astern_m:?} {beside_m:?}");
        }
    }

    /// Three obstacles at 1.7 m now, each at the edge of two sectors. The scan shows it in one.
    /// Their old places are 0.3 m farther ahead.
    #[test]
    fn an_obstacle_at_the_edge_of_two_sectors_is_in_place_if_one_of_them_shows_it() {
        let before = [(0.167, 1.995), (-0.167, 1.995), (2.903, 1.406)]
            .map(|(bearing_rad, distance_m)| RangeReading { bearing_rad, distance_m });
        let now = scan([(1, 1.7), (15, 1.7), (7, 1.7)]);
        assert_eq!(compare(&now, &before, &DRIVEN), Verdict::InTime);
    }

    /// Distances differ from sector to sector, but by too little to show that something has gone. A
    /// robot that turns by less than 0.35 rad may see a wall as before.
    #[test]
    fn a_scan_as_before_is_late_if_the_robot_has_turned() {
        let uneven = scan((0..16).map(|sector| (sector, 1.0 + 0.15 * f32::from(sector % 2))));
        for (turned_rad, expected) in
            [(0.3, Verdict::Open), (0.4, Verdict::Late), (-0.4, Verdict::Late)]
        {
            let turned = Moved { by_m: [0.0, 0.0], turned_rad };
            assert_eq!(compare(&uneven, &uneven, &turned), expected, "{turned_rad}");
        }
    }

    /// In the middle of a round room, everything looks the same after a turn, and likewise among posts
    /// at the same distances. Between them, it does not.
    #[test]
    fn a_turn_among_the_same_all_around_says_nothing() {
        let round = scan((0..16).map(|sector| (sector, 2.0)));
        let posts = scan((0..16).map(|sector| (sector, if sector % 2 == 0 { 1.0 } else { 2.0 })));
        for (room, turned_rad, expected) in [
            (&round, 0.4, Verdict::Open),
            (&round, -0.7, Verdict::Open),
            (&posts, 2.0 * SECTOR_RAD, Verdict::Open),
            (&posts, SECTOR_RAD, Verdict::Late),
        ] {
            let turned = Moved { by_m: [0.0, 0.0], turned_rad };
            assert_eq!(compare(room, room, &turned), expected, "{turned_rad}");
        }
    }

    /// Without a reading, a sector holds 0, which is nearer than 12 cm to 0.1 m.
    #[test]
    fn a_sector_without_a_reading_is_not_as_before() {
        let turned = Moved { by_m: [0.0, 0.0], turned_rad: 2.0 * SECTOR_RAD };
        let close = scan(AHEAD.map(|sector| (sector, 0.1)));
        for (now, before, expected) in [
            (close.as_slice(), close.as_slice(), Verdict::Late),
            (&close, &[], Verdict::Open),
            (&[], &close, Verdict::Open),
            (&[], &[], Verdict::Open),
        ] {
            assert_eq!(compare(now, before, &turned), expected, "{now:?} {before:?}");
        }
    }

    /// At first the robot stands, and a scan as before says nothing.
    #[test]
    fn a_trial_goes_on_until_the_motion_of_the_robot_shows_a_late_scan() {
        let mut trial = trial(Moved::default());
        assert_eq!(trial.hear(&before()), Verdict::Open);
        for _ in 0..3 {
            trial.advance(0.1, 0.0);
        }
        assert_eq!(trial.hear(&before()), Verdict::Late);
        // The verdict is given once.
        assert_eq!(trial.hear(&before()), Verdict::Open);
    }

    #[test]
    fn a_trial_that_was_ended_gives_no_verdict() {
        let mut trial = trial(DRIVEN);
        trial.end();
        assert_eq!(trial.hear(&before()), Verdict::Open);
    }

    /// Up to 0.6 m and 0.8 rad, distances are comparable.
    #[test]
    fn a_trial_without_a_verdict_ends_once_the_robot_has_moved_far() {
        for (by_m, turned_rad, goes_on) in [
            ([0.0, 0.0], 0.0, true),
            ([0.59, 0.0], 0.79, true),
            ([-0.41, 0.41], -0.79, true),
            ([0.61, 0.0], 0.0, false),
            ([-0.43, 0.43], 0.0, false),
            ([0.0, 0.0], 0.81, false),
            ([0.0, 0.0], -0.81, false),
        ] {
            let mut trial = trial(Moved { by_m, turned_rad });
            assert_eq!(trial.hear(&[]), Verdict::Open);
            assert_eq!(trial.is_open, goes_on, "{by_m:?} {turned_rad}");
        }
    }
}
