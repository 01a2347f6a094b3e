//! Judges the range finder: absent, fresh, silent or faulty.
//!
//! A range finder that has never reported is absent: many robots have none, and the plan alone
//! keeps them away from obstacles. One that has reported and falls silent is a fault, because an
//! old scan hides new obstacles.

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
    /// The reason to stand still; `None` if the robot may drive.
    pub const fn reason(self) -> Option<Reason> {
        match self {
            Self::Absent | Self::Fresh { .. } => None,
            Self::Silent => Some(Reason::SilentRanges),
            Self::Faulty => Some(Reason::FaultyRanges),
        }
    }
}

/// What the judgement keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RangeTrack {
    /// Time of the last scan, sound or not.
    heard_us: Option<u64>,
    /// Time of the last sound scan.
    sound_us: Option<u64>,
}

impl RangeTrack {
    /// Judges the scan of this tick's percepts. A scan is sound if none of its readings is garbled.
    pub fn judge(&mut self, percepts: &Percepts, policy: &RangePolicy) -> RangeTrust {
        // A time stamp from the future would never become stale.
        let scan_us = percepts.scan_us.map(|scan_us| scan_us.min(percepts.time_us));
        if scan_us != self.heard_us {
            self.heard_us = scan_us;
            if percepts.garbled_ranges == 0 {
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
}
