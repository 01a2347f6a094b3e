//! What the robot does when the operator falls silent.
//!
//! | last heard | after [`LinkPolicy::timeout_us`] |
//! |---|---|
//! | nothing yet | not armed, unless by the robot's own button |
//! | emergency stop | stays pressed until the operator releases it |
//! | driven by hand | stands still, not armed: autonomy must not surprise anybody |
//! | armed | by [`LinkPolicy::on_loss`]: not armed, or the mission goes on |
//!
//! The mission file sets both, and the blob carries them.

use plan_format::parameters::{LinkPolicy, OnLinkLoss};
use robot_io::Operator;

/// What counts of `heard`, which the operator sent `age_us` microseconds ago.
pub fn after(heard: Operator, age_us: u64, policy: &LinkPolicy) -> Operator {
    if age_us <= u64::from(policy.timeout_us) {
        return heard;
    }
    let goes_on = policy.on_loss == OnLinkLoss::Continue && heard.manual.is_none();
    Operator {
        is_armed: heard.is_armed && goes_on,
        is_emergency_stop: heard.is_emergency_stop,
        manual: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robot_io::Manual;

    const ARMED: Operator = Operator { is_armed: true, is_emergency_stop: false, manual: None };
    const BY_HAND: Operator =
        Operator { manual: Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.0 }), ..ARMED };
    const NOT_ARMED: Operator =
        Operator { is_armed: false, is_emergency_stop: false, manual: None };

    /// At the timeout `heard` still counts as it is; just after it, `later` does.
    fn check(on_loss: OnLinkLoss, heard: Operator, later: Operator) {
        for timeout_us in [100_000, 1_000_000, u32::MAX] {
            let policy = LinkPolicy { timeout_us, on_loss };
            let timeout_us = u64::from(timeout_us);
            assert_eq!(after(heard, 0, &policy), heard);
            assert_eq!(after(heard, timeout_us, &policy), heard);
            assert_eq!(after(heard, timeout_us + 1, &policy), later);
        }
    }

    #[test]
    fn silence_has_a_meaning_for_each_state() {
        check(OnLinkLoss::Disarm, ARMED, NOT_ARMED);
        check(OnLinkLoss::Continue, ARMED, ARMED);
        for on_loss in [OnLinkLoss::Disarm, OnLinkLoss::Continue] {
            check(on_loss, BY_HAND, NOT_ARMED);
            let stopped = Operator { is_emergency_stop: true, ..BY_HAND };
            check(on_loss, stopped, Operator { is_emergency_stop: true, ..NOT_ARMED });
        }
    }
}
