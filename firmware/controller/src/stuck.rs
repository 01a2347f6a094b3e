//! Notices that the robot does not get on.
//!
//! The robot makes no progress if it drives for some time without leaving a circle. Only time in
//! which it is commanded to move counts: waiting before an obstacle does not. The circle begins
//! where the robot last left one, and anew when it holds, arrives, is driven by hand or disarmed.
//!
//! A robot that roams along an obstacle leaves every circle. It makes no progress either once detours to
//! both sides have not helped.

use math::{Vec2, vector};
use plan_format::parameters::{OnNoProgress, Parameters, ProgressPolicy};
use robot_io::{Commands, Reason};
use serde::{Deserialize, Serialize};

use crate::detour::Detours;
use crate::sense::Sensed;

/// How many accuracies of the position enlarge the circle, so that noise does not leave it.
const DEVIATIONS: f32 = 3.0;

/// What the detection keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Centre of the circle, map metres.
    centre_m: Option<[f32; 2]>,
    /// Time for which the robot has driven within it, seconds.
    driven_s: f32,
    is_none: bool,
}

impl Progress {
    /// Whether the robot makes no progress.
    pub const fn is_none(&self) -> bool {
        self.is_none
    }

    /// Takes over the commands of one tick, and what led to them. A robot whose wheels turn in
    /// place is stuck at once, whatever its circle.
    ///
    /// A robot that stops without progress stays so until it begins anew; otherwise leaving the
    /// circle is progress.
    pub fn update(
        &mut self,
        sensed: &Sensed,
        commands: &Commands,
        parameters: &Parameters,
        detours: &mut Detours,
    ) {
        use Reason::{Driving, Escaping, NoPlan, NoProgress, NoRoute, ObstacleStop, OffMap};
        let policy = &parameters.progress;
        self.is_none |= sensed.is_stuck;
        if detours.are_exhausted() && policy.on_none == OnNoProgress::Stop {
            self.is_none = true;
            // A robot that is armed anew tries again.
            *detours = Detours::default();
        }
        let moves = commands.speed_mps != 0.0 || commands.turn_rate_radps != 0.0;
        match commands.reason {
            Driving | Escaping | NoPlan | NoRoute | OffMap | ObstacleStop if moves => {
                self.driven_s += sensed.elapsed_s;
            }
            NoProgress => return,
            // Noise carries a robot that stands to its goal and back.
            Reason::AtGoal if self.is_none => return,
            Reason::AtGoal
            | Reason::Holding
            | Reason::Idle
            | Reason::Manual
            | Reason::Disarmed
            | Reason::LinkLost
            | Reason::EmergencyStop => {
                // What the robot tried on its last way says little about the next.
                (*self, *detours) = (Self::default(), Detours::default());
                return;
            }
            _ => {}
        }
        let Ok(position) = sensed.position else { return };
        let radius_m = policy.within_m + DEVIATIONS * sensed.accuracy_m;
        let centre_m = *self.centre_m.get_or_insert(position.into());
        let has_left = vector::length(position - Vec2::from(centre_m)) > radius_m;
        if has_left {
            *self = Self { centre_m: Some(position.into()), ..Self::default() };
        }
        // A slow robot needs longer to cross the circle.
        let is_long = self.driven_s * 1e6 >= policy.after_us as f32
            && self.driven_s * parameters.vehicle.max_speed_mps >= 2.0 * radius_m;
        self.is_none |= is_long;
    }

    /// The reason to stand still for want of progress.
    pub fn reason(&self, policy: &ProgressPolicy) -> Option<Reason> {
        let stops = self.is_none && policy.on_none == OnNoProgress::Stop;
        stops.then_some(Reason::NoProgress)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranges::RangeTrust;

    /// A robot at one point whose position is known to 1 cm.
    const RESTING: Sensed = Sensed {
        position: Ok(Vec2::new(1.0, 2.0)),
        accuracy_m: 0.01,
        heading_rad: Some(0.0),
        is_compass_wrong: false,
        is_heading_wrong: false,
        may_creep: false,
        ranges: RangeTrust::Fresh { age_us: 0 },
        is_clock_stopped: false,
        is_stuck: false,
        elapsed_s: 0.1,
        passed_us: 0,
    };

    /// Turning and driving both count as attempts to get on, waiting does not.
    #[test]
    fn a_robot_that_moves_and_does_not_get_on_makes_no_progress() {
        let parameters = Parameters::default();
        let after = (parameters.progress.after_us as f32 * 1e-6 / RESTING.elapsed_s) as usize;
        let driving = Commands::stop(Reason::Driving);
        for (commands, expected) in [
            (Commands { speed_mps: 0.5, ..driving }, true),
            (Commands { turn_rate_radps: -1.0, ..driving }, true),
            (driving, false),
        ] {
            let mut progress = Progress::default();
            let mut detours = Detours::default();
            for tick in 0..2 * after {
                progress.update(&RESTING, &commands, &parameters, &mut detours);
                let is_early = tick + 2 < after;
                assert!(!is_early || !progress.is_none(), "{tick} {commands:?}");
            }
            assert_eq!(progress.is_none(), expected, "{commands:?}");
            assert_eq!(progress.reason(&parameters.progress).is_some(), expected);
        }
    }

    /// A robot that stands without progress near its goal seems to be there now and then. Disarmed, it
    /// begins anew.
    #[test]
    fn a_robot_that_stands_without_progress_does_not_begin_anew_at_its_goal() {
        let parameters = Parameters::default();
        let mut progress = Progress::default();
        let mut detours = Detours::default();
        let stuck = Sensed { is_stuck: true, ..RESTING };
        let mut update = |sensed: &Sensed, reason| {
            progress.update(sensed, &Commands::stop(reason), &parameters, &mut detours);
            progress.is_none()
        };
        assert!(update(&stuck, Reason::Driving));
        assert!(update(&RESTING, Reason::AtGoal));
        assert!(update(&RESTING, Reason::NoProgress));
        assert!(!update(&RESTING, Reason::Disarmed));
    }
}
