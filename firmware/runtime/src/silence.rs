//! What link loss does to the operator's orders.
//!
//! | last orders | after [`LinkPolicy::timeout_us`] |
//! |---|---|
//! | none yet | disarmed, unless the robot's own button arms it |
//! | emergency stop | stays pressed until the operator releases it |
//! | manual driving | stands still, disarmed: it must not change to autonomous driving by itself |
//! | armed | by [`LinkPolicy::on_loss`]: disarmed, or the mission continues |
//!
//! The mission file sets both values, and the blob carries them.

use plan_format::parameters::{LinkPolicy, OnLinkLoss};
use robot_io::Operator;

/// What remains of the orders `heard`, `age_us` microseconds after they arrived.
pub fn after(heard: Operator, age_us: u64, policy: &LinkPolicy) -> Operator {
    if age_us <= u64::from(policy.timeout_us) {
        return heard;
    }
    let continues = policy.on_loss == OnLinkLoss::Continue && heard.manual.is_none();
    Operator {
        is_armed: heard.is_armed && continues,
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

    /// `heard` counts up to the timeout, `later` just after it.
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
