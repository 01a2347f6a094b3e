//! Compares what odometry or commands say about the motion with what positions say.
//!
//! If the robot should have come far and its positions stay in one place, either the source of the
//! positions is frozen or the robot is stuck with turning wheels. A receiver whose own time
//! advances and which reports standing still is alive, so the robot is stuck; so it is if the
//! positions waver. Otherwise the source is frozen.
//!
//! Driving in a circle proves nothing, because the way from its start stays short. Drift that is
//! slower than this comparison notices is left to the limit on jumps.

use math::{Vec2, vector};
use serde::{Deserialize, Serialize};

use crate::source::Anchor;

/// The comparison counts once the way should be longer than this many times the accuracies of both
/// positions. With fewer, the noise of positions alone would now and then look like standing.
const WAY_DEVIATIONS: f32 = 4.0;
/// The comparison counts once the way should be longer than this, metres.
const SHORTEST_WAY_M: f32 = 1.5;
/// Positions that cover less than this share of the way do not follow it.
const LEAST_SHARE: f32 = 0.3;
/// A position that has not changed for this share of the way does not waver.
const UNCHANGED_SHARE: f32 = 0.5;
/// Below this reported speed the receiver says that the robot stands still, m/s.
const STANDING_MPS: f32 = 0.3;

/// What the comparison shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// The positions follow the motion, as far as can be judged yet.
    Follows,
    /// The source repeats a position.
    Frozen,
    /// The robot does not move although its wheels do, or should.
    Stuck,
}

/// What the comparison keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Slip {
    /// The position where the way begins.
    start: Option<Anchor>,
    /// The way since then, map axes, metres.
    way_m: [f32; 2],
    /// The last position.
    last_m: [f32; 2],
    /// Distance driven since the position last changed, metres.
    unchanged_m: f32,
}

impl Slip {
    /// Adds a step, map axes.
    pub(crate) fn carry(&mut self, step: Vec2, distance_m: f32) {
        self.way_m = (Vec2::from(self.way_m) + step).into();
        self.unchanged_m += distance_m.abs();
    }

    /// Begins anew: the heading was wrong, and so is the way.
    pub(crate) fn restart(&mut self) {
        *self = Self::default();
    }

    /// Compares the way with a new position. `speed_mps` is the speed that its source measured.
    pub(crate) fn judge(&mut self, next: &Anchor, speed_mps: Option<f32>) -> Verdict {
        let Some(start) = self.start else {
            self.begin(next);
            return Verdict::Follows;
        };
        if next.position_m != self.last_m {
            (self.last_m, self.unchanged_m) = (next.position_m, 0.0);
        }
        let way_m = vector::length(self.way_m.into());
        let least_m = WAY_DEVIATIONS * (start.accuracy_m + next.accuracy_m);
        if way_m < least_m.max(SHORTEST_WAY_M) {
            return Verdict::Follows;
        }
        let covered_m = vector::length(Vec2::from(next.position_m) - Vec2::from(start.position_m));
        let stands = speed_mps.is_some_and(|speed_mps| speed_mps < STANDING_MPS);
        let is_alive = next.source_ms.is_some() && next.source_ms != start.source_ms;
        let wavers = self.unchanged_m < UNCHANGED_SHARE * way_m;
        let verdict = match wavers {
            _ if covered_m >= LEAST_SHARE * way_m => Verdict::Follows,
            // The robot drives, but not where its heading points.
            true if speed_mps.is_some() && !stands => Verdict::Follows,
            true => Verdict::Stuck,
            false if is_alive && stands => Verdict::Stuck,
            false => Verdict::Frozen,
        };
        self.begin(next);
        verdict
    }

    fn begin(&mut self, start: &Anchor) {
        *self = Self { start: Some(*start), last_m: start.position_m, ..Self::default() };
    }
}
