//! Judges positions of one source: the GPS receiver, or whatever sends poses.
//!
//! A position counts if it is accurate, fresh, not repeated and no jump. The anchor is the last
//! one that counted. A position jumps if it is farther from the anchor than driving explains.
//!
//! A jump may be the truth: the first fix may have been wrong, or somebody carried the robot. So
//! positions that jump to one place become a rival of the anchor, and the rival wins once it has
//! been consistent for [`BELIEF_US`]. Until then the robot stands, because a jump that ends
//! earlier, a reflection from a wall, would lead it into a mapped obstacle. A jump that lasts longer
//! is believed: one source alone cannot show that it is wrong.

use math::{Vec2, vector};
use plan_format::parameters::FixPolicy;
use robot_io::Reason;
use serde::{Deserialize, Serialize};

/// A position jumps if it is farther away than the speed limit explains, plus this many times the
/// accuracies of both. An accuracy is one standard deviation.
const JUMP_DEVIATIONS: f32 = 3.0;

/// A rival is believed after it has been consistent for this time, microseconds. Reflections of
/// GPS signals change within seconds once the robot or the satellites move.
const BELIEF_US: u64 = 10_000_000;
/// A rival is believed after this many positions: two that are far apart in time prove little.
const BELIEF_COUNT: u8 = 5;

/// A judged position, in map metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Anchor {
    pub(crate) time_us: u64,
    pub(crate) position_m: [f32; 2],
    pub(crate) accuracy_m: f32,
    /// The source's own time, milliseconds, if it has one.
    pub(crate) source_ms: Option<u32>,
}

/// Consistent positions that contradict the anchor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Rival {
    since_us: u64,
    last: Anchor,
    count: u8,
}

/// What the judgement of one source keeps from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Source {
    /// Time stamp of the last judged position: none is judged twice.
    judged_us: Option<u64>,
    /// Why the last judged position was refused; `None` if it was good.
    refusal: Option<Reason>,
    /// The last good position.
    anchor: Option<Anchor>,
    rival: Option<Rival>,
    /// Where the source froze: nothing counts until it reports another position.
    frozen_m: Option<[f32; 2]>,
}

impl Source {
    /// Whether a position with this time stamp has not been judged yet. It is from now on.
    pub(crate) fn is_new(&mut self, time_us: u64) -> bool {
        self.judged_us.replace(time_us) != Some(time_us)
    }

    /// Forgets everything except the time stamp of the last judged position.
    pub(crate) fn restarted(&self) -> Self {
        Self { judged_us: self.judged_us, ..Self::default() }
    }

    /// The reason for which the last position was refused.
    pub(crate) fn refusal(&self) -> Option<Reason> {
        self.refusal
    }

    /// Whether any position has been judged since the start.
    pub(crate) fn was_heard(&self) -> bool {
        self.anchor.is_some() || self.refusal.is_some()
    }

    /// Whether there is a good position that is not stale at `now_us`.
    pub(crate) fn is_fresh(&self, now_us: u64, policy: &FixPolicy) -> bool {
        self.anchor.is_some_and(|anchor| !is_stale(now_us, anchor.time_us, policy))
    }

    /// Judges a new position; `estimate` is where the robot believes to be. Returns it if it is
    /// good.
    pub(crate) fn judge(
        &mut self,
        next: Result<Anchor, Reason>,
        now_us: u64,
        estimate: Vec2,
        policy: &FixPolicy,
    ) -> Option<Anchor> {
        let judged = next.and_then(|next| {
            // A time stamp from the future would never become stale.
            let next = Anchor { time_us: next.time_us.min(now_us), ..next };
            if is_stale(now_us, next.time_us, policy) {
                return Err(Reason::StaleFix);
            }
            self.believe(next, estimate, policy)
        });
        self.refusal = judged.err();
        self.anchor = judged.ok().or(self.anchor);
        judged.ok()
    }

    /// The position if it neither is a repetition nor jumps.
    fn believe(
        &mut self,
        next: Anchor,
        estimate: Vec2,
        policy: &FixPolicy,
    ) -> Result<Anchor, Reason> {
        if self.frozen_m.is_some_and(|frozen_m| frozen_m == next.position_m) {
            return Err(Reason::FrozenFix);
        }
        self.frozen_m = None;
        let Some(anchor) = self.anchor else { return Ok(next) };
        let last = self.rival.map(|rival| rival.last);
        if next.repeats(&anchor) || last.is_some_and(|last| next.repeats(&last)) {
            return Err(Reason::FrozenFix);
        }
        let supported = self.rival.filter(|rival| {
            let to_estimate = next.distance_m(estimate);
            !next.jumps(&rival.last, policy, u64::from(u32::MAX))
                && next.distance_m(rival.last.position_m.into()) < to_estimate
        });
        // Among contradictions, time alone does not explain more and more distant positions.
        let most_us = self.rival.map_or(u32::MAX, |_| policy.stale_after_us);
        if supported.is_none() && !next.jumps(&anchor, policy, most_us.into()) {
            self.rival = None;
            return Ok(next);
        }
        let rival =
            supported.map_or(Rival { since_us: next.time_us, last: next, count: 1 }, |rival| {
                Rival { last: next, count: rival.count.saturating_add(1), ..rival }
            });
        let age_us = next.time_us.saturating_sub(rival.since_us);
        if age_us >= BELIEF_US && rival.count >= BELIEF_COUNT {
            self.rival = None;
            return Ok(next);
        }
        self.rival = Some(rival);
        Err(Reason::JumpedFix)
    }

    /// Refuses all positions from the last one on until the source reports another one.
    pub(crate) fn freeze(&mut self) {
        self.frozen_m = self.anchor.take().map(|anchor| anchor.position_m);
        self.refusal = Some(Reason::FrozenFix);
    }
}

impl Anchor {
    fn distance_m(&self, to: Vec2) -> f32 {
        vector::length(Vec2::from(self.position_m) - to)
    }

    /// Whether this is the last position once more. Receivers that print whole seconds have one
    /// time for several positions, so the time alone proves nothing.
    fn repeats(&self, last: &Self) -> bool {
        self.source_ms.is_some()
            && self.source_ms == last.source_ms
            && self.position_m == last.position_m
    }

    /// Whether this is farther from the last good position than driving for at most `most_us`
    /// explains.
    fn jumps(&self, last: &Self, policy: &FixPolicy, most_us: u64) -> bool {
        let elapsed_us = self.time_us.saturating_sub(last.time_us).min(most_us);
        let elapsed_s = elapsed_us as u32 as f32 * 1e-6;
        let reach_m =
            policy.max_jump_mps * elapsed_s + JUMP_DEVIATIONS * (self.accuracy_m + last.accuracy_m);
        self.distance_m(last.position_m.into()) > reach_m
    }
}

fn is_stale(now_us: u64, time_us: u64, policy: &FixPolicy) -> bool {
    now_us.saturating_sub(time_us) > u64::from(policy.stale_after_us)
}
