//! What a robot needs to know of its team.

use crate::limits::MAX_ROBOTS;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The team of a robot, and when the radio link to a mate counts as up.
///
/// Both times damp a link that comes and goes: it is lost after a silence, and regained once news
/// have arrived for a while without such a silence. Source: W, section 3.2, "communication failure
/// recognized" as a trigger between serial plans.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TeamPolicy {
    /// This robot's number in the team, below `robots`.
    pub robot: u8,
    /// Robots of the team; 1 without a team.
    pub robots: u8,
    /// The link to a mate is lost after this time without news, microseconds.
    pub lost_after_us: u32,
    /// The link to a mate is regained after this time with news, microseconds.
    pub regained_after_us: u32,
    /// News over a link of a lower quality are not used, 0 ..= 1.
    pub min_quality: f32,
    /// Gain of avoid-robot within the reactive part.
    pub avoid_gain: f32,
    /// Mates repel up to this distance from the body's margin, metres.
    pub avoid_sphere_m: f32,
    /// The mate that the robot stays close to, by number; `None` for none.
    pub tether_to: Option<u8>,
    /// Length of the tether, metres: farther away, the mate attracts.
    pub tether_m: f32,
}

impl Default for TeamPolicy {
    /// A robot without a team. MissionLab's constants: 15 ticks of a bad link before the robot
    /// reacts.
    fn default() -> Self {
        Self {
            robot: 0,
            robots: 1,
            lost_after_us: 750_000,
            regained_after_us: 750_000,
            min_quality: 0.0,
            avoid_gain: 1.0,
            avoid_sphere_m: 2.0,
            tether_to: None,
            tether_m: 20.0,
        }
    }
}

impl TeamPolicy {
    /// The numbers of the mates, one bit each.
    pub const fn mates(&self) -> u8 {
        let all =
            if self.robots as usize >= MAX_ROBOTS { MAX_ROBOTS } else { self.robots as usize };
        ((1_u16 << all) - 1) as u8 & !1_u8.wrapping_shl(self.robot as u32)
    }

    /// The name and the range of the first value that is out of its range; `None` if all are within.
    pub fn check(&self) -> Option<(&'static str, f32, f32)> {
        let most = MAX_ROBOTS as f32;
        let last = f32::from(self.robots.max(1) - 1);
        let table = [
            ("team.robots", f32::from(self.robots), 1.0, most),
            ("team.robot", f32::from(self.robot), 0.0, last),
            ("team.tether_to", f32::from(self.tether_to.unwrap_or(0)), 0.0, last),
            ("team.lost_after", self.lost_after_us as f32 / 1e6, 0.05, 3_600.0),
            ("team.regained_after", self.regained_after_us as f32 / 1e6, 0.05, 3_600.0),
            ("team.min_quality", self.min_quality, 0.0, 1.0),
            ("team.avoid_gain", self.avoid_gain, 0.0, 100.0),
            ("team.avoid_sphere", self.avoid_sphere_m, 0.0, 1_000.0),
            ("team.tether_length", self.tether_m, 0.1, 100_000.0),
        ];
        table
            .into_iter()
            .find(|&(_, value, low, high)| !(low..=high).contains(&value))
            .map(|(name, _, low, high)| (name, low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_is_not_its_own_mate() {
        let mates = |robot, robots| TeamPolicy { robot, robots, ..TeamPolicy::default() }.mates();
        assert_eq!([mates(0, 1), mates(0, 3), mates(1, 3), mates(4, 5)], [0, 0b110, 0b101, 0b1111]);
    }

    #[test]
    fn a_number_outside_the_team_is_out_of_range() {
        let odd = TeamPolicy { robot: 3, robots: 3, ..TeamPolicy::default() };
        assert_eq!(odd.check(), Some(("team.robot", 0.0, 2.0)));
        assert_eq!(TeamPolicy::default().check(), None);
    }
}
