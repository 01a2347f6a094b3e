//! Judges the range finder: absent, fresh, silent or faulty.
//!
//! A range finder that has never reported is absent: many robots have none, and the plan alone
//! keeps them away from obstacles. One that has reported and falls silent is a fault, because an
//! old scan hides new obstacles.
//!
//! A scan is sound if none of its readings is garbled, and if it is not frozen: the same obstacles
//! to the last bit, although the robot has moved since. Only motion shows that: a robot that stands
//! sees the same thing, and so does one that drives along a smooth wall for a while. An empty scan
//! that is repeated cannot be distinguished from open ground.

use plan_format::parameters::RangePolicy;
use robot_io::{Percepts, Reason};
use serde::{Deserialize, Serialize};

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

/// What the judgement keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RangeTrack {
    /// Time of the last scan, sound or not.
    heard_us: Option<u64>,
    /// Time of the last sound scan.
    sound_us: Option<u64>,
    /// Fingerprint of the last scan.
    fingerprint: u32,
    /// Distance driven since the scans last changed, metres.
    moved_m: f32,
    /// Angle turned since then, radians.
    turned_rad: f32,
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
        self.moved_m += moved_m.abs();
        self.turned_rad += turned_rad;
        // A time stamp from the future would never become stale.
        let scan_us = percepts.scan_us.map(|scan_us| scan_us.min(percepts.time_us));
        if scan_us != self.heard_us {
            self.heard_us = scan_us;
            let is_frozen = self.is_frozen(percepts);
            if percepts.garbled_ranges == 0 && !is_frozen {
                self.sound_us = scan_us;
            }
        }
        let age = |then_us: u64| percepts.time_us.saturating_sub(then_us);
        let is_fresh = |age_us: u64| age_us <= u64::from(policy.stale_after_us);
        match (self.heard_us, self.sound_us) {
            (None, _) if policy.is_required => RangeTrust::Silent,
            (None, _) => RangeTrust::Absent,
            (Some(heard_us), _) if !is_fresh(age(heard_us)) => RangeTrust::Silent,
            (_, Some(sound_us)) if is_fresh(age(sound_us)) => {
                RangeTrust::Fresh { age_us: age(sound_us) as u32 }
            }
            _ => RangeTrust::Faulty,
        }
    }

    /// Whether a new scan repeats the obstacles of the last ones although the robot has moved.
    fn is_frozen(&mut self, percepts: &Percepts) -> bool {
        let mix = |sum: u32, value: f32| (sum.rotate_left(5) ^ value.to_bits()).wrapping_mul(PRIME);
        let readings = percepts.ranges.iter();
        let fingerprint =
            readings.fold(0, |sum, reading| mix(mix(sum, reading.bearing_rad), reading.distance_m));
        if fingerprint != self.fingerprint || percepts.ranges.is_empty() {
            (self.fingerprint, self.moved_m, self.turned_rad) = (fingerprint, 0.0, 0.0);
        }
        self.moved_m > FROZEN_M || self.turned_rad.abs() > FROZEN_RAD
    }
}

/// Odd and without a pattern, so that every bit of a reading changes the fingerprint.
const PRIME: u32 = 0x9e37_79b1;
