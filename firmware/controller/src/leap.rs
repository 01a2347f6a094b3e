//! Finds leaps of the range finder: readings that change together, as obstacles do not.
//!
//! Between two scans, most readings have grown by more than the robot moved, or most have shrunk, or many
//! have changed by the same and few are as before.

use robot_io::Percepts;
use robot_io::limits::MAX_RANGES;

use crate::scan::{Scan, sector};

/// A leap counts if this many readings leap in one direction, if they are half of all, and if
/// none stays as it is.
const LEAP_COUNT: u8 = 4;
/// It also counts if this many leap alike, if they are a third of all, and if a third of them at
/// most stay as they are.
const LEAP_SHARE: u8 = 3;
const LEAP_MAJORITY: u8 = 3;
/// Leaps are alike if they differ by less than this, metres: noise, and what the robot has moved.
const LEAP_ALIKE_M: f32 = 0.12;
/// A reading leaps if it changes by more than this, metres.
const LEAP_M: f32 = 0.25;
/// It may change by this much more for each metre that the robot has moved.
const LEAP_PER_M: f32 = 1.0;
/// It may change by this much more for each second: obstacles move, m/s.
const LEAP_MPS: f32 = 1.0;
/// Readings that differ by less than this are as before, metres.
const SAME_M: f32 = 0.12;

/// How the readings of a scan differ from those of the last one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Differences {
    pub(crate) count: u8,
    /// Readings that have grown by more than the limit, and by how much together, metres.
    grown: u8,
    grown_m: f32,
    shrunk: u8,
    shrunk_m: f32,
    /// Readings that show no difference.
    same: u8,
    pub(crate) is_repeated: bool,
    /// The leap that enough readings have in common, metres; 0 if there is none.
    common_m: f32,
}

/// A reading that changes by more than this has leapt, metres, if the robot has moved by `since_m` in
/// `elapsed_s`.
pub(crate) fn most_m(since_m: f32, elapsed_s: f32) -> f32 {
    LEAP_M + LEAP_PER_M * since_m + LEAP_MPS * elapsed_s
}

/// By how much the distance of each sector has changed, metres; 0 where that is unknown.
#[inline(never)]
fn changes_m(before_m: &[f32; MAX_RANGES], now_m: &[f32; MAX_RANGES]) -> [f32; MAX_RANGES] {
    let mut changes_m = [0.0; MAX_RANGES];
    for (change_m, (before_m, now_m)) in changes_m.iter_mut().zip(before_m.iter().zip(now_m)) {
        if *before_m > 0.0 && *now_m > 0.0 {
            *change_m = now_m - before_m;
        }
    }
    changes_m
}

impl Differences {
    /// Compares the readings of the percepts with the last scan, sector by sector. `by_sector_m` are the
    /// distances of that scan, metres, and then those of this one; 0 without a reading.
    pub(crate) fn between(
        last: &Scan,
        by_sector_m: &mut [f32; MAX_RANGES],
        percepts: &Percepts,
        most_m: f32,
    ) -> Self {
        let last_m = core::mem::take(by_sector_m);
        let is_repeated = percepts.ranges.len() == last.readings().len();
        let mut differences = Self { is_repeated, ..Self::default() };
        for now in &percepts.ranges {
            let sector = sector(now.bearing_rad);
            let (Some(kept_m), Some(&before_m)) = (by_sector_m.get_mut(sector), last_m.get(sector))
            else {
                continue;
            };
            *kept_m = now.distance_m;
            let by_m = now.distance_m - before_m;
            differences.is_repeated &= by_m == 0.0;
            if before_m > 0.0 {
                differences.add(by_m, most_m);
            }
        }
        if differences.may_be_alike() {
            let changes_m = changes_m(&last_m, by_sector_m);
            differences.common_m = differences.common_m(&changes_m, most_m);
        }
        differences
    }

    /// Adds a reading that has changed by `by_m`.
    fn add(&mut self, by_m: f32, most_m: f32) {
        self.count += 1;
        if by_m > most_m {
            self.grown += 1;
            self.grown_m += by_m;
        } else if by_m < -most_m {
            self.shrunk += 1;
            self.shrunk_m += by_m;
        } else if by_m.abs() < SAME_M {
            self.same += 1;
        }
    }

    /// Whether so few readings stay as they are that others may have leapt alike.
    const fn may_be_alike(&self) -> bool {
        let changed = if self.grown > self.shrunk { self.grown } else { self.shrunk };
        changed >= LEAP_COUNT && changed >= LEAP_MAJORITY * self.same
    }

    /// The leap of more than `most_m` that enough of these changes have in common, metres.
    fn common_m(&self, changes_m: &[f32; MAX_RANGES], most_m: f32) -> f32 {
        let alike = |middle_m: f32| {
            let is_alike = |change_m: &&f32| (**change_m - middle_m).abs() < LEAP_ALIKE_M;
            changes_m.iter().filter(is_alike).count() as u8
        };
        let leaps_m = changes_m.iter().filter(|change_m| change_m.abs() > most_m);
        let common = leaps_m.map(|change_m| (alike(*change_m), *change_m));
        let (count, common_m) = common.max_by_key(|(count, _)| *count).unwrap_or_default();
        let is_enough = count >= LEAP_COUNT && LEAP_SHARE * count >= self.count;
        if is_enough && count >= LEAP_MAJORITY * self.same { common_m } else { 0.0 }
    }

    /// By how much the readings have leapt in one direction, metres; 0 if they have not.
    pub(crate) fn leap_m(&self) -> f32 {
        let are_most = |count: u8| count >= LEAP_COUNT && 2 * count >= self.count && self.same == 0;
        if are_most(self.grown) {
            self.grown_m / f32::from(self.grown)
        } else if are_most(self.shrunk) {
            self.shrunk_m / f32::from(self.shrunk)
        } else {
            self.common_m
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::SECTOR_RAD;
    use heapless::Vec;
    use robot_io::RangeReading;

    /// The leap between two scans with one reading in each sector from the first on: at 5 m, and changed
    /// by this much, metres. A reading may change by 0.25 m.
    fn leap_m(changes_m: &[f32]) -> f32 {
        let bearings = (0..MAX_RANGES).map(|sector| sector as f32 * SECTOR_RAD);
        let readings: Vec<_, MAX_RANGES> = bearings
            .zip(changes_m)
            .map(|(bearing_rad, change_m)| {
                let bearing_rad = math::scalar::wrap_angle(bearing_rad);
                RangeReading { bearing_rad, distance_m: 5.0 + change_m }
            })
            .collect();
        let before = readings.iter().map(|reading| RangeReading { distance_m: 5.0, ..*reading });
        let mut last = Scan::default();
        last.take(&before.collect::<Vec<_, MAX_RANGES>>());
        let mut by_sector_m = [0.0; MAX_RANGES];
        for reading in last.readings() {
            by_sector_m[sector(reading.bearing_rad)] = reading.distance_m;
        }
        let percepts = Percepts { ranges: readings, ..Percepts::default() };
        let most_m = most_m(0.0, 0.0);
        Differences::between(&last, &mut by_sector_m, &percepts, most_m).leap_m()
    }

    /// Metres that the robot has moved, and a second in which obstacles may move.
    #[test]
    fn what_moves_changes_readings() {
        for (since_m, elapsed_s, expected_m) in
            [(0.0, 0.0, 0.25), (1.0, 0.0, 1.25), (0.0, 0.5, 0.75), (1.0, 0.5, 1.75)]
        {
            assert_eq!(most_m(since_m, elapsed_s), expected_m, "{since_m} {elapsed_s}");
        }
    }

    #[test]
    fn readings_leap_together() {
        // Changes that are neither as before nor a leap.
        let wavering = [0.15, -0.15, 0.18, -0.18, 0.21, -0.21, 0.24, -0.24];
        let with = |leaps: &[f32], others: &[f32]| {
            let all: Vec<f32, MAX_RANGES> = leaps.iter().chain(others).copied().collect();
            leap_m(&all)
        };
        for (leaps, others, expected_m) in [
            // Half of all in one direction, and none stays: their mean.
            (&[0.5, 0.8, 1.1, 1.4][..], &wavering[..4], 0.95),
            (&[-0.5, -0.8, -1.1, -1.4], &wavering[..4], -0.95),
            (&[0.5, 0.8, 1.1, 1.4], &wavering[..5], 0.0),
            (&[0.5, 0.8, 1.1], &[], 0.0),
            (&[0.5, 0.8, 1.1, 1.4], &[0.0], 0.0),
            // A third of all by the same, and a third of them at most stay.
            (&[0.5; 4], &wavering, 0.5),
            (&[-0.5; 4], &wavering, -0.5),
            (&[0.5; 4], &[0.0, 0.15, 0.18, 0.21, 0.24], 0.5),
            (&[0.5; 4], &[0.0, 0.0], 0.0),
            (&[0.5, 0.5, 0.5, 0.5, 0.5, 0.9], &[0.0, 0.0], 0.0),
            (&[0.5; 3], &[0.15, 0.18, 0.21, 0.24], 0.0),
            (&[0.5; 5], &[0.0, -0.5, 0.15], 0.5),
        ] {
            let found_m = with(leaps, others);
            assert!((found_m - expected_m).abs() < 1e-5, "{leaps:?} {others:?}: {found_m}");
        }
    }

    /// A sector without a reading in one of the scans shows nothing.
    #[test]
    fn only_sectors_with_two_readings_have_changed() {
        let (mut before_m, mut now_m) = ([0.0; MAX_RANGES], [0.0; MAX_RANGES]);
        (before_m[0], now_m[0]) = (2.0, 3.0);
        (before_m[1], now_m[2]) = (2.0, 3.0);
        let changes_m = changes_m(&before_m, &now_m);
        assert_eq!((changes_m[0], changes_m[1], changes_m[2]), (1.0, 0.0, 0.0));
    }
}
