//! Judges positions of one source: the GPS receiver, or whatever sends poses.
//!
//! A position counts if it is accurate, fresh, not repeated and no jump. The anchor is the last
//! one that counted. A position jumps if it is farther from the anchor than driving explains.
//!
//! A jump may be the truth: the first positions may have been wrong, or somebody carried the robot.
//! So positions that jump to one place become a rival of the anchor. The rival wins once it has been
//! consistent for [`BELIEF_US`], but never against an anchor that [`PROVED_COUNT`] positions have
//! confirmed: one source alone cannot show which of the two is wrong, and a robot that follows the
//! wrong one drives into mapped obstacles. It stands until the positions come back or until it is
//! disarmed, which makes the anchor unproved again: then somebody is there.
//!
//! A source with a time of its own also shows how late its positions are: they are late by what they
//! have taken longer than the fastest one. Late positions are refused, because they show where the
//! robot was.

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
/// This many good positions in a row prove the anchor.
const PROVED_COUNT: u8 = 5;
/// While positions contradict each other, driving explains a distance from the estimate for this
/// time at most, microseconds: the estimate knows how the robot has moved.
const RETURN_US: u64 = 500_000;

/// A position that is late by more than this is refused, microseconds. Serial lines and drivers
/// delay by less.
const LATE_US: u64 = 300_000;
/// A position that seems to be later than this shows that one of the clocks was set, microseconds.
const LATEST_US: u64 = 10_000_000;
/// The fastest position counts as slower by one microsecond for this many, because clocks drift.
const DRIFT_US: u64 = 4_096;

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
    /// Good positions in a row, up to [`PROVED_COUNT`].
    confirmed: u8,
    delay: Delay,
}

/// How late the positions of a source are, by its own time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Delay {
    /// Arrival of the last position, and the source's time in it.
    last: Option<(u64, u32)>,
    /// By how much it was later than the fastest one, microseconds.
    late_us: u64,
}

impl Delay {
    /// Takes note of a position; returns by how much it is late, microseconds.
    fn hear(&mut self, next: &Anchor) -> u64 {
        let Some(source_ms) = next.source_ms else { return 0 };
        let Some((last_us, last_ms)) = self.last.replace((next.time_us, source_ms)) else {
            return 0;
        };
        let took_us = next.time_us.saturating_sub(last_us);
        let advanced_us = u64::from(source_ms.saturating_sub(last_ms)) * 1_000;
        let late_us =
            (self.late_us + took_us).saturating_sub(advanced_us).saturating_sub(took_us / DRIFT_US);
        // A time that does not advance was set back, or has only whole seconds.
        let is_set = advanced_us == 0 || late_us > LATEST_US;
        self.late_us = if is_set { 0 } else { late_us };
        self.late_us
    }
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

    /// The anchor is not confirmed: a jump may be believed.
    pub(crate) fn unprove(&mut self) {
        self.confirmed = 0;
        self.delay = Delay::default();
    }

    /// The robot's clock was set: how late positions are is measured anew.
    pub(crate) fn clock_was_set(&mut self) {
        self.delay = Delay::default();
    }

    /// The reason for which the last position was refused.
    pub(crate) fn refusal(&self) -> Option<Reason> {
        self.refusal
    }

    /// Whether any position has been judged since the start.
    pub(crate) fn was_heard(&self) -> bool {
        self.anchor.is_some() || self.refusal.is_some()
    }

    /// Whether a position was ever good.
    pub(crate) fn has_anchor(&self) -> bool {
        self.anchor.is_some()
    }

    /// Whether this is the last good position once more.
    pub(crate) fn repeats(&self, next: &Anchor) -> bool {
        self.anchor.is_some_and(|anchor| next.repeats(&anchor))
    }

    /// Whether a position, good or not, was judged within the stale time before `now_us`.
    pub(crate) fn is_heard(&self, now_us: u64, policy: &FixPolicy) -> bool {
        self.judged_us.is_some_and(|judged_us| !is_stale(now_us, judged_us, policy))
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
            let is_late = self.delay.hear(&next) > LATE_US;
            if is_late || is_stale(now_us, next.time_us, policy) {
                return Err(Reason::StaleFix);
            }
            self.believe(next, estimate, policy)
        });
        self.refusal = judged.err();
        self.anchor = judged.ok().or(self.anchor);
        if judged.is_ok() {
            self.confirmed = self.confirmed.saturating_add(1).min(PROVED_COUNT);
        } else if self.refusal == Some(Reason::JumpedFix) && self.confirmed < PROVED_COUNT {
            self.confirmed = 0;
        }
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
        let is_explained = if self.rival.is_some() {
            let expected = Anchor { position_m: estimate.into(), ..anchor };
            !next.jumps(&expected, policy, RETURN_US)
        } else {
            !next.jumps(&anchor, policy, u64::from(u32::MAX))
        };
        if supported.is_none() && is_explained {
            self.rival = None;
            return Ok(next);
        }
        let rival =
            supported.map_or(Rival { since_us: next.time_us, last: next, count: 1 }, |rival| {
                Rival { last: next, count: rival.count.saturating_add(1), ..rival }
            });
        let age_us = next.time_us.saturating_sub(rival.since_us);
        let is_proved = self.confirmed >= PROVED_COUNT;
        if !is_proved && age_us >= BELIEF_US && rival.count >= BELIEF_COUNT {
            self.rival = None;
            self.confirmed = 0;
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
