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
