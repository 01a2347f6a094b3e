//! Judges the range finder: absent, fresh, silent or faulty. Keeps the last sound scan.
//!
//! A range finder that has never reported is absent: many robots have none, and the plan alone
//! keeps them away from obstacles. One that has reported and falls silent is a fault, because an
//! old scan hides new obstacles. Until the robot stands, [`RangeTrack::carry`] moves the readings of
//! the last sound scan along with the robot, so that it stops before what it saw.
//!
//! A scan is not sound in these cases:
//! - one of its readings is garbled. Several garbled scans stop the robot until as many scans with
//!   readings were sound; an empty scan proves nothing.
//! - it is frozen: the same distances to the last bit, although the robot has moved. A robot that
//!   stands sees the same thing, and so does one that drives along a smooth wall without noise. If
//!   all scans before differed, a short way shows it. A new order to arm begins a new way.
//! - it has leapt: between two scans, most readings have grown by more than the robot moved, or most
//!   have shrunk, or many have changed by the same and few are as before. Obstacles do not do that
//!   together, so the zero of the range finder has moved. It is trusted again once it leaps back, or
//!   once the robot is disarmed.
//! - it is late: after a silence it shows what the robot saw before, see [`crate::late`]. It is
//!   trusted again once the robot is disarmed.
//!
//! An empty scan that is repeated cannot be distinguished from open ground, an offset from the start
//! not from other obstacles, and a delay that grows slowly not from obstacles that move.

use plan_format::parameters::RangePolicy;
use robot_io::limits::MAX_RANGES;
use robot_io::{Percepts, Reason};
use serde::{Deserialize, Serialize};

use crate::late::{Trial, Verdict};
use crate::leap::{self, Differences};
use crate::scan::{Moved, Scan};

/// How far the range readings can be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum RangeTrust {
    /// No range finder has ever reported, and the mission requires none.
    #[default]
    Absent,
    /// The last sound scan is this old, microseconds; at most the policy's limit. Obstacles may
    /// have come closer since.
    Fresh {
        /// Age of the last sound scan, microseconds.
        age_us: u32,
    },
    /// The last scan is too old, or there is none although the mission requires one.
    Silent,
    /// Scans arrive, but none of the last ones was sound.
    Faulty,
}

impl RangeTrust {
    /// Age of the readings, seconds; 0 where there are none to trust.
    pub const fn age_s(self) -> f32 {
        match self {
            Self::Fresh { age_us } => age_us as f32 * 1e-6,
            Self::Absent | Self::Silent | Self::Faulty => 0.0,
        }
    }

    /// The reason to stand still; `None` if the robot may drive.
    pub const fn reason(self) -> Option<Reason> {
        match self {
            Self::Absent | Self::Fresh { .. } => None,
            Self::Silent => Some(Reason::SilentRanges),
            Self::Faulty => Some(Reason::FaultyRanges),
        }
    }
}

/// Scans that stay the same while the robot drives this far are frozen, metres. A noise-free scan
/// beside a smooth wall may stay the same over a shorter way.
const FROZEN_M: f32 = 2.0;
/// Scans that stay the same while the robot turns this far are frozen, radians.
const FROZEN_RAD: f32 = 0.5;
/// Scans that differed before one of them is repeated: the range finder has noise.
const NOISY_COUNT: u8 = 10;
/// The share of both limits that is enough for a range finder with noise.
const NOISY_SHARE: f32 = 0.1;
/// A robot that moves and turns less than this stands, metres and radians.
const STANDS_M: f32 = 0.01;
const STANDS_RAD: f32 = 0.01;
/// Repetitions in a row that a range finder with noise does not show by chance.
const REPEATED_COUNT: u8 = 3;

/// Leaps are looked for between scans while the robot moves by less than this, metres.
const LEAP_WITHIN_M: f32 = 0.12;
/// It must turn by less than this, radians: then each reading still shows the same obstacle.
const LEAP_WITHIN_RAD: f32 = 0.15;
/// The range finder has leapt back once its leaps add up to less than this, metres.
const BACK_M: f32 = 0.2;

/// A scan after this time without one may be late, microseconds.
const GAP_US: u64 = 400_000;
/// After a longer time the clock was set, microseconds.
const LONGEST_GAP_US: u64 = 5_000_000;
/// Doubt for a garbled scan; a sound scan with readings takes 1 away.
const GARBLED_DOUBT: u8 = 2;
/// With this doubt the range finder is faulty, until the doubt is 0.
const MOST_DOUBT: u8 = 16;

/// What the judgement keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RangeTrack {
    /// Time of the last tick.
    now_us: u64,
    /// Time stamp of the last scan, as it came: none is judged twice.
    judged_us: Option<u64>,
    /// Time of the last scan, sound or not.
    heard_us: Option<u64>,
    /// Time of the last sound scan.
    sound_us: Option<u64>,
    /// The last scan, sound or not, and its distances by sector, metres; 0 without a reading.
    heard: Scan,
    by_sector_m: [f32; MAX_RANGES],
    /// The last sound scan, while others arrive.
    kept: Scan,
    is_kept: bool,
    /// How the robot has moved since the last sound scan.
    moved: Moved,
    /// Distance driven and angle turned since the last scan, metres and radians.
    since_m: f32,
    since_rad: f32,
    /// The same since the scans last changed.
    unchanged_m: f32,
    unchanged_rad: f32,
    /// Scans in a row that repeated the last one, and before that, scans that did not.
    repeated: u8,
    varied: u8,
    /// Sum of the leaps, metres.
    leapt_m: f32,
    trial: Trial,
    is_late: bool,
    doubt: u8,
    is_doubted: bool,
}

impl RangeTrack {
    /// Judges the scan of this tick's percepts. The robot has moved by `moved_m` and `turned_rad`
    /// since the last tick.
    pub fn judge(
        &mut self,
        percepts: &Percepts,
        policy: &RangePolicy,
        moved_m: f32,
        turned_rad: f32,
    ) -> RangeTrust {
        self.since_m += moved_m.abs();
        self.since_rad += turned_rad;
        if percepts.time_us == self.now_us {
            // While the clock stands, nothing tells how the robot moves.
            self.by_sector_m = Default::default();
        }
        if !percepts.operator.is_armed {
            // A new order to arm is a new attempt.
            (self.leapt_m, self.is_late, self.doubt, self.is_doubted) = (0.0, false, 0, false);
            (self.unchanged_m, self.unchanged_rad) = (0.0, 0.0);
            self.trial.end();
        }
        self.trial.advance(moved_m, turned_rad);
        let is_new = percepts.scan_us.is_some() && percepts.scan_us != self.judged_us;
        self.judged_us = percepts.scan_us.or(self.judged_us);
        // A time stamp from the future would never become stale.
        let scan_us = percepts.scan_us.map(|scan_us| scan_us.min(percepts.time_us));
        let step = (moved_m, turned_rad);
        let is_sound = is_new && self.hear(percepts, scan_us, step);
        if is_sound {
            self.sound_us = scan_us;
            (self.moved, self.is_kept) = (Moved::default(), false);
        } else {
            self.moved.advance(moved_m, turned_rad);
        }
        self.now_us = percepts.time_us;
        let age = |then_us: u64| percepts.time_us.saturating_sub(then_us);
        let is_fresh = |age_us: u64| age_us <= u64::from(policy.stale_after_us);
        match (self.heard_us, self.sound_us) {
            (None, _) if policy.is_required => RangeTrust::Silent,
            (None, _) => RangeTrust::Absent,
            (Some(heard_us), _) if !is_fresh(age(heard_us)) => RangeTrust::Silent,
            _ if self.is_faulty() => RangeTrust::Faulty,
            (_, Some(sound_us)) if is_fresh(age(sound_us)) => {
                RangeTrust::Fresh { age_us: age(sound_us) as u32 }
            }
            _ => RangeTrust::Faulty,
        }
    }

    /// The robot's clock was set back: scans keep their age.
    pub(crate) fn clock_was_set(&mut self, before_us: u64, now_us: u64) {
        let set = |then_us: u64| now_us.saturating_sub(before_us.saturating_sub(then_us));
        (self.heard_us, self.sound_us) = (self.heard_us.map(set), self.sound_us.map(set));
        self.now_us = now_us;
    }

    /// Replaces the readings by those of the last sound scan, as they are from where the robot is
    /// now. Leaves those of a sound scan of this tick as they are.
    pub fn carry(&self, percepts: &mut Percepts) {
        if self.sound_us.is_none() || self.moved == Moved::default() {
            return;
        }
        percepts.ranges.clear();
        for reading in self.sound().readings() {
            // Never full: both have the same capacity.
            let _ = percepts.ranges.push(self.moved.carried(reading));
        }
    }

    /// The last sound scan.
    fn sound(&self) -> &Scan {
        if self.is_kept { &self.kept } else { &self.heard }
    }

    fn is_frozen(&self) -> bool {
        let is_noisy = self.varied >= NOISY_COUNT && self.repeated >= REPEATED_COUNT;
        let share = if is_noisy { NOISY_SHARE } else { 1.0 };
        self.unchanged_m > share * FROZEN_M || self.unchanged_rad.abs() > share * FROZEN_RAD
    }

    fn is_faulty(&self) -> bool {
        self.is_frozen() || self.is_late || self.is_doubted || self.leapt_m.abs() > BACK_M
    }

    /// Takes over a new scan. Returns whether it is sound. `step` is how far the robot has moved and
    /// turned since the last tick.
    fn hear(&mut self, percepts: &Percepts, scan_us: Option<u64>, step: (f32, f32)) -> bool {
        let is_garbled = percepts.garbled_ranges > 0;
        let elapsed_us = scan_us.zip(self.heard_us).map_or(0, |(us, last)| us.saturating_sub(last));
        // A clock that stands and leaps is not the range finder's fault.
        let has_leapt = percepts.time_us.saturating_sub(self.now_us) >= GAP_US;
        let is_after_gap = (GAP_US..LONGEST_GAP_US).contains(&elapsed_us) && !has_leapt;
        let elapsed_s = elapsed_us.min(GAP_US) as u32 as f32 * 1e-6;
        let most_m = leap::most_m(self.since_m, elapsed_s);
        let differences =
            Differences::between(&self.heard, &mut self.by_sector_m, percepts, most_m);
        self.watch_repetitions(&differences);
        if !is_garbled && self.since_m < LEAP_WITHIN_M && self.since_rad.abs() < LEAP_WITHIN_RAD {
            self.leapt_m += differences.leap_m();
        }
        if is_after_gap && self.sound_us.is_some() {
            let (before, mut moved) = (*self.sound(), self.moved);
            moved.advance(step.0, step.1);
            self.trial.begin(&before, moved);
        }
        self.is_late |= !is_garbled && self.trial.hear(&percepts.ranges) == Verdict::Late;
        if is_garbled {
            self.doubt = (self.doubt + GARBLED_DOUBT).min(MOST_DOUBT);
        } else if !percepts.ranges.is_empty() {
            self.doubt = self.doubt.saturating_sub(1);
        }
        self.is_doubted = self.doubt >= MOST_DOUBT || self.is_doubted && self.doubt > 0;
        // A noisy range finder does not repeat itself on the way: such a scan is as old as the first
        // of them. What stands still may see the same thing, and would not get going again.
        let has_moved = self.unchanged_m > STANDS_M || self.unchanged_rad.abs() > STANDS_RAD;
        let is_repeated = self.repeated > 0 && self.varied >= NOISY_COUNT && has_moved;
        let is_sound = !is_garbled && !is_repeated && !self.is_faulty();
        if !is_sound && !self.is_kept {
            (self.kept, self.is_kept) = (self.heard, true);
        }
        self.heard.take(&percepts.ranges);
        (self.heard_us, self.since_m, self.since_rad) = (scan_us, 0.0, 0.0);
        is_sound
    }

    fn watch_repetitions(&mut self, differences: &Differences) {
        // A robot that stands for it seems to turn to and fro, by the noise of its gyroscope.
        if !self.is_frozen() {
            self.unchanged_m += self.since_m;
            self.unchanged_rad += self.since_rad;
        }
        if differences.is_repeated && differences.count > 0 {
            self.repeated = self.repeated.saturating_add(1);
            return;
        }
        (self.unchanged_m, self.unchanged_rad) = (0.0, 0.0);
        self.varied = if self.repeated > 0 { 0 } else { self.varied.saturating_add(1) };
        self.repeated = 0;
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use plan_format::Parameters;
    use robot_io::Operator;
    use robot_io::RangeReading;
    use std::vec::Vec;

    /// What an armed robot perceives that has got a scan of these bearings and distances.
    fn heard(time_us: u64, scan_us: u64, scan: impl IntoIterator<Item = (f32, f32)>) -> Percepts {
        let reading = |(bearing_rad, distance_m)| RangeReading { bearing_rad, distance_m };
        Percepts {
            time_us,
            scan_us: Some(scan_us),
            ranges: scan.into_iter().map(reading).collect(),
            operator: Operator { is_armed: true, ..Operator::default() },
            ..Percepts::default()
        }
    }

    /// Judges a scan before a silence of a second and one after it. The robot has moved and turned
    /// in between.
    fn after_silence(
        before: &[(f32, f32)],
        after: &[(f32, f32)],
        moved_m: f32,
        turned_rad: f32,
    ) -> RangeTrust {
        let policy = Parameters::default().ranges;
        let mut track = RangeTrack::default();
        let mut judge = |time_us, scan_us, scan: &[(f32, f32)], moved_m, turned_rad| {
            let percepts = heard(time_us, scan_us, scan.iter().copied());
            track.judge(&percepts, &policy, moved_m, turned_rad)
        };
        let first = judge(1_000_000, 1_000_000, before, 0.0, 0.0);
        assert_eq!(first, RangeTrust::Fresh { age_us: 0 });
        // Ticks without a scan; a leap of the clock would prove nothing.
        judge(1_950_000, 1_000_000, before, moved_m, turned_rad);
        judge(2_000_000, 2_000_000, after, 0.0, 0.0)
    }

    /// What a range finder without noise sees of a robot that stops does not change, and neither does
    /// one in steps of a centimetre. The robot can drive on at any time.
    #[test]
    fn a_robot_that_stands_still_trusts_the_same_scan_again_and_again() {
        let policy = Parameters::default().ranges;
        let mut track = RangeTrack::default();
        let mut time_us = 0;
        let mut judge = |distance_m: f32, moved_m, is_armed| {
            time_us += 50_000;
            let scan = [(0.0, distance_m), (1.0, distance_m + 0.5)];
            let operator = Operator { is_armed, ..Operator::default() };
            let percepts = Percepts { operator, ..heard(time_us, time_us, scan) };
            track.judge(&percepts, &policy, moved_m, 0.0)
        };
        let fresh = RangeTrust::Fresh { age_us: 0 };
        assert!((0..40).all(|tick| judge(6.0 - 0.05 * tick as f32, 0.05, true) == fresh));
        assert!((0..400).all(|_| judge(4.0, 0.0, true) == fresh));
        let step = (1..40).find(|_| judge(4.0, 0.05, true) == RangeTrust::Faulty);
        assert!(step.is_some_and(|step| (2..=5).contains(&step)), "{step:?}");
        assert_eq!(judge(4.0, 0.0, false), fresh, "a new order to arm is a new attempt");
    }

    #[test]
    fn a_scan_after_a_silence_must_show_that_the_robot_has_moved() {
        let fresh = RangeTrust::Fresh { age_us: 0 };
        let hall = [(0.0, 2.0), (0.8, 3.0), (1.6, 1.5), (-0.8, 4.0), (-1.6, 2.5), (3.1, 6.0)];
        let noisy: Vec<_> = hall.iter().map(|&(b, d)| (b, d + 0.03)).collect();
        assert_eq!(after_silence(&hall, &noisy, 0.02, 0.0), fresh, "it stood");
        assert_eq!(after_silence(&hall, &noisy, 0.6, 0.0), RangeTrust::Faulty);
        assert_eq!(after_silence(&hall, &noisy, 0.0, 0.5), RangeTrust::Faulty);
        // 0.6 m farther.
        let moved = [(0.0, 1.4), (1.0, 2.6), (1.6, 1.5), (-0.9, 3.6), (-1.7, 2.5), (3.1, 6.6)];
        assert_eq!(after_silence(&hall, &moved, 0.6, 0.0), fresh);
        // In a corridor the walls are as before.
        let corridor = [(0.4, 2.5), (0.8, 1.4), (1.6, 1.0), (-0.4, 2.5), (-0.8, 1.4), (-1.6, 1.0)];
        assert_eq!(after_silence(&corridor, &corridor, 0.6, 0.0), fresh);
    }

    /// A range finder with two readings, and the robot that carries it.
    struct Rover {
        track: RangeTrack,
        time_us: u64,
    }

    impl Rover {
        fn new() -> Self {
            Self { track: RangeTrack::default(), time_us: 0 }
        }

        /// Judges a scan of an obstacle at this distance `after_us` the last one.
        fn hear(&mut self, distance_m: f32, after_us: u64, step: (f32, f32)) -> RangeTrust {
            self.judge(distance_m, after_us, step, 0)
        }

        fn judge(
            &mut self,
            distance_m: f32,
            after_us: u64,
            (moved_m, turned_rad): (f32, f32),
            garbled_ranges: u8,
        ) -> RangeTrust {
            self.time_us += after_us;
            let scan = [(0.0, distance_m), (1.0, distance_m + 0.5)];
            let percepts = Percepts { garbled_ranges, ..heard(self.time_us, self.time_us, scan) };
            self.track.judge(&percepts, &Parameters::default().ranges, moved_m, turned_rad)
        }
    }

    const FRESH: RangeTrust = RangeTrust::Fresh { age_us: 0 };

    /// Scans that stay the same on a turn of 0.5 rad to either side are frozen.
    #[test]
    fn scans_that_stay_the_same_on_a_turn_are_frozen() {
        for turned_rad in [0.049, -0.049] {
            let mut rover = Rover::new();
            assert_eq!(rover.hear(4.0, 50_000, (0.0, 0.0)), FRESH);
            for step in 1..=10 {
                assert_eq!(rover.hear(4.0, 50_000, (0.0, turned_rad)), FRESH, "{step}");
            }
            assert_eq!(rover.hear(4.0, 50_000, (0.0, turned_rad)), RangeTrust::Faulty);
        }
    }

    /// Without noise, 30 cm with the same scan prove nothing; with noise, a single repetition proves
    /// nothing, but its readings are as old as the first.
    #[test]
    fn only_repetitions_of_a_range_finder_with_noise_prove_much() {
        let mut smooth = Rover::new();
        for step in 0..6 {
            assert_eq!(smooth.hear(4.0, 50_000, (0.05, 0.0)), FRESH, "{step}");
        }
        let mut noisy = Rover::new();
        for step in 0..25 {
            let noise_m = if step % 2 == 0 { 0.01 } else { 0.02 };
            assert_eq!(noisy.hear(4.0 + noise_m, 50_000, (0.0, 0.0)), FRESH, "{step}");
        }
        let once = noisy.hear(4.01, 50_000, (0.25, 0.0));
        assert_eq!(once, RangeTrust::Fresh { age_us: 50_000 });
    }

    /// Ten different scans show that a range finder has noise: then a few decimetres are enough.
    #[test]
    fn a_range_finder_shows_its_noise_within_ten_scans() {
        for (scans, expected) in [(9, FRESH), (10, RangeTrust::Faulty)] {
            let mut rover = Rover::new();
            for step in 0..scans {
                let noise_m = if step % 2 == 0 { 0.01 } else { 0.02 };
                assert_eq!(rover.hear(4.0 + noise_m, 50_000, (0.05, 0.0)), FRESH, "{step}");
            }
            let last_m = 4.0 + if scans % 2 == 0 { 0.02 } else { 0.01 };
            let repeated = (0..5).map(|_| rover.hear(last_m, 50_000, (0.05, 0.0))).last();
            assert_eq!(repeated, Some(expected), "{scans}");
        }
    }

    /// A robot that stands for frozen scans stays standing, however its gyroscope wavers.
    #[test]
    fn what_a_standing_robot_seems_to_turn_does_not_make_up_for_frozen_scans() {
        let mut rover = Rover::new();
        let turned = (0..12).map(|_| rover.hear(4.0, 50_000, (0.0, 0.049))).last();
        assert_eq!(turned, Some(RangeTrust::Faulty));
        for step in 0..40 {
            let wavering = rover.hear(4.0, 50_000, (0.0, -0.02));
            assert_eq!(wavering, RangeTrust::Faulty, "{step}");
        }
        assert_eq!(rover.hear(4.1, 50_000, (0.0, 0.0)), FRESH, "it goes on");
    }

    /// Judges two scans; each pair is a distance before and after, metres. The first scan has `ticks`
    /// ticks, all with one time.
    fn after_change(changes: &[(f32, f32)], ticks: u64) -> RangeTrust {
        let policy = Parameters::default().ranges;
        let mut track = RangeTrack::default();
        let mut judge = |time_us, scan: &dyn Fn(&(f32, f32)) -> f32| {
            let by_sector = changes.iter().enumerate().map(|(sector, change)| {
                (math::scalar::wrap_angle(sector as f32 * crate::scan::SECTOR_RAD), scan(change))
            });
            track.judge(&heard(time_us, time_us, by_sector), &policy, 0.0, 0.0)
        };
        for _ in 0..ticks {
            judge(1_000_000, &|change| change.0);
        }
        judge(1_050_000, &|change| change.1)
    }

    /// In clutter, sectors change by chance. Offset readings change by the same, and few stay as they
    /// are. A robot that drives away from walls sees all of them grow, by a little.
    #[test]
    fn readings_that_leap_alike_show_an_offset_among_others_that_change_by_chance() {
        let judge = |changes: &[f32]| {
            let changes: Vec<_> = changes.iter().map(|by_m| (6.0, 6.0 + by_m)).collect();
            after_change(&changes, 1)
        };
        let chance = [-0.6, -1.9, -4.8, -1.2, 0.2, 0.2];
        let of = |leaps: &[f32]| judge(&[leaps, &chance].concat());
        assert_eq!(of(&[0.45, 0.44, 0.5, 0.53]), RangeTrust::Faulty);
        let shrunk = [-0.45, -0.44, -0.5, -0.53, 0.6, 1.9, 4.8, 1.2, -0.2, -0.2];
        assert_eq!(judge(&shrunk), RangeTrust::Faulty);
        assert_eq!(of(&[0.45, 0.44, 0.5, 0.53, 0.05]), RangeTrust::Faulty, "one stays");
        assert_eq!(of(&[0.45, 0.44, 0.5, 0.53, 0.05, 0.01]), FRESH, "two stay");
        assert_eq!(of(&[0.45, 0.44, 0.5]), FRESH, "three are too few");
        assert_eq!(of(&[0.45, 0.44, 0.9, 0.7]), FRESH, "they differ");
        assert_eq!(of(&[0.45, 0.44, 0.5, 0.53, 0.2, 0.2, 0.2, 0.2]), FRESH, "few of many");
        assert_eq!(judge(&[0.28, 0.16, 0.3, 0.27]), FRESH, "glancing walls");
    }

    /// While the clock stands, a robot may turn by any angle: this is not a leap.
    #[test]
    fn what_changes_while_the_clock_stands_is_no_leap() {
        let changes = [(6.0, 6.5); 6];
        assert_eq!(after_change(&changes, 1), RangeTrust::Faulty);
        assert_eq!(after_change(&changes, 2), FRESH);
    }

    /// The readings are those of the last sound scan, which is too old after half a second.
    #[test]
    fn garbled_scans_do_not_keep_a_sound_one_fresh() {
        let mut rover = Rover::new();
        assert_eq!(rover.hear(4.0, 400_000, (0.0, 0.0)), FRESH);
        let first = rover.judge(4.0, 300_000, (0.0, 0.0), 1);
        assert_eq!(first, RangeTrust::Fresh { age_us: 300_000 });
        assert_eq!(first.age_s(), 0.3);
        let second = rover.judge(4.0, 300_000, (0.0, 0.0), 1);
        assert_eq!((second, second.age_s()), (RangeTrust::Faulty, 0.0));
    }
}
