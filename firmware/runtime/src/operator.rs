//! The operator's latest orders, when they arrived, and who may stop the robot.

use core::cell::Cell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use plan_format::parameters::LinkPolicy;
use robot_io::Operator;

use crate::silence;

/// The operator's latest orders over the link, shared between tasks.
pub struct OperatorSlot<M: RawMutex> {
    heard: Mutex<M, Cell<Option<(u64, Operator)>>>,
}

impl<M: RawMutex> Default for OperatorSlot<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> OperatorSlot<M> {
    /// An empty slot.
    pub const fn new() -> Self {
        Self { heard: Mutex::new(Cell::new(None)) }
    }

    /// Stores the orders that arrived at `time_us`.
    pub fn hear(&self, time_us: u64, operator: Operator) {
        self.heard.lock(|cell| cell.set(Some((time_us, operator))));
    }

    /// The orders that count at `now_us`, after [`silence`]; `None` before the first packet, so
    /// that a robot without a radio obeys its own buttons.
    pub fn at(&self, now_us: u64, policy: &LinkPolicy) -> Option<RadioOrders> {
        let (time_us, heard) = self.heard.lock(Cell::get)?;
        let operator = silence::after(heard, now_us.saturating_sub(time_us), policy);
        Some(RadioOrders { operator, is_link_lost: heard.is_armed && !operator.is_armed })
    }
}

/// The orders that arrived over the link, after [`silence`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadioOrders {
    /// The orders.
    pub operator: Operator,
    /// The link's last order is to arm, and silence has ended it.
    pub is_link_lost: bool,
}

/// Decides who may arm and who may stop the robot: its own buttons, or the operator over the link.
///
/// Both may stop it: an emergency stop counts from either side. The link outranks the buttons in
/// arming and in manual driving, from its first packet on. But a change at the arm button, or any
/// other change of the buttons' order to arm, disarms an armed robot at once, whatever the link
/// says. It stays disarmed until the link has taken back its own order to arm: a person beside
/// the robot must not be overruled by the next packet. Silence takes back nothing. A robot that
/// silence has disarmed would be armed by the next packet, so it counts as armed here.
///
/// A robot that has just started does not know who disarmed it before: an order to arm that stands
/// already does not count either. Otherwise a robot whose battery gives way would start to drive again
/// after every reset.
#[derive(Clone, Copy, Debug)]
pub struct Authority {
    was_armed_here: bool,
    is_armed: bool,
    /// A button has disarmed the robot, or the robot has just started, and the link has not taken back
    /// its order since.
    is_held: bool,
}

impl Default for Authority {
    fn default() -> Self {
        Self { was_armed_here: false, is_armed: false, is_held: true }
    }
}

impl Authority {
    /// The orders that count in this tick: `buttons` are the robot's own.
    pub fn decide(&mut self, buttons: Operator, radio: Option<RadioOrders>) -> Operator {
        let is_pressed = buttons.is_armed != self.was_armed_here;
        self.was_armed_here = buttons.is_armed;
        let Some(radio) = radio else {
            self.is_armed = buttons.is_armed;
            // A link that agrees with the button does not end what goes on.
            self.is_held = !buttons.is_armed;
            return buttons;
        };
        self.is_held |= is_pressed && (self.is_armed || radio.is_link_lost);
        self.is_held &= radio.operator.is_armed || radio.is_link_lost;
        let is_armed = radio.operator.is_armed && !self.is_held;
        self.is_armed = is_armed;
        Operator {
            is_armed,
            is_emergency_stop: buttons.is_emergency_stop || radio.operator.is_emergency_stop,
            manual: radio.operator.manual,
        }
    }
}

/// A button on the robot: each press arms or disarms. Read it once a tick. Contacts bounce for less
/// than that, and a press counts from its second tick on: motors disturb the wires of a button. What
/// is closed from the start, by a hand or by wires that touch, does not count.
#[derive(Clone, Copy, Debug)]
pub struct ArmButton {
    was_closed: bool,
    is_pressed: bool,
    is_armed: bool,
}

impl Default for ArmButton {
    fn default() -> Self {
        Self { was_closed: true, is_pressed: true, is_armed: false }
    }
}

impl ArmButton {
    /// The orders of the button in this tick.
    pub fn read(&mut self, is_closed: bool) -> Operator {
        if is_closed == self.was_closed {
            self.is_armed ^= is_closed && !self.is_pressed;
            self.is_pressed = is_closed;
        }
        self.was_closed = is_closed;
        Operator { is_armed: self.is_armed, ..Operator::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use plan_format::Parameters;
    use plan_format::parameters::OnLinkLoss;

    #[test]
    fn the_newest_orders_count_and_age_from_their_arrival() {
        let policy = Parameters::default().link;
        let slot = OperatorSlot::<NoopRawMutex>::new();
        assert_eq!(slot.at(0, &policy), None);
        let stop = Operator { is_emergency_stop: true, ..Operator::default() };
        let armed = Operator { is_armed: true, ..Operator::default() };
        slot.hear(5, stop);
        slot.hear(6, armed);
        let fresh = Some(RadioOrders { operator: armed, is_link_lost: false });
        assert_eq!(slot.at(7, &policy), fresh);
        assert_eq!(slot.at(5, &policy), fresh, "a lagging clock does not age the orders");
    }

    const ARMED: Operator = Operator { is_armed: true, is_emergency_stop: false, manual: None };
    const DISARMED: Operator = Operator { is_armed: false, is_emergency_stop: false, manual: None };

    /// Each row is a tick: order of the buttons, order of the link, whether the robot is armed.
    fn check(table: &[(bool, Option<RadioOrders>, bool)]) {
        let mut authority = Authority::default();
        for (tick, &(button, radio, is_armed)) in table.iter().enumerate() {
            let buttons = if button { ARMED } else { DISARMED };
            let decided = authority.decide(buttons, radio);
            assert_eq!(decided.is_armed, is_armed, "tick {tick}");
        }
    }

    /// What the link orders; `LOST` is an order to arm that silence has ended.
    const ARM: Option<RadioOrders> = Some(RadioOrders { operator: ARMED, is_link_lost: false });
    const DISARM: Option<RadioOrders> =
        Some(RadioOrders { operator: DISARMED, is_link_lost: false });
    const LOST: Option<RadioOrders> = Some(RadioOrders { operator: DISARMED, is_link_lost: true });

    #[test]
    fn a_person_beside_the_robot_may_disarm_it() {
        check(&[
            (false, None, false),
            (true, None, true),
            (false, None, false),
            (false, DISARM, false),
            (false, ARM, true),
            (true, ARM, false),
            (true, ARM, false),
            (false, ARM, false),
            (false, DISARM, false),
            (false, ARM, true),
            (false, DISARM, false),
            (true, DISARM, false),
            (true, ARM, true),
            (false, ARM, false),
        ]);
    }

    #[test]
    fn silence_does_not_take_back_the_order_of_the_link() {
        check(&[
            (false, DISARM, false),
            (false, ARM, true),
            (true, ARM, false),
            (true, LOST, false),
            (true, ARM, false),
            (true, LOST, false),
            (true, DISARM, false),
            (true, ARM, true),
        ]);
    }

    #[test]
    fn packets_that_arrive_again_arm_a_robot_that_silence_alone_disarmed() {
        check(&[
            (false, DISARM, false),
            (false, ARM, true),
            (false, LOST, false),
            (false, ARM, true),
        ]);
    }

    #[test]
    fn a_button_pressed_during_silence_keeps_the_robot_disarmed() {
        check(&[
            (false, DISARM, false),
            (false, ARM, true),
            (false, LOST, false),
            (true, LOST, false),
            (true, ARM, false),
            (true, DISARM, false),
            (true, ARM, true),
        ]);
        check(&[
            (false, DISARM, false),
            (false, ARM, true),
            (true, LOST, false),
            (true, ARM, false),
        ]);
    }

    /// A robot that starts, for example after its battery gave way, while the link orders to arm. Where
    /// its button has armed it first, it goes on.
    #[test]
    fn an_order_that_stands_at_the_start_does_not_arm() {
        check(&[
            (false, None, false),
            (false, ARM, false),
            (false, LOST, false),
            (false, ARM, false),
            (false, DISARM, false),
            (false, ARM, true),
        ]);
        check(&[(false, ARM, false), (false, DISARM, false), (false, ARM, true)]);
        check(&[(true, None, true), (true, ARM, true), (true, DISARM, false)]);
    }

    /// The link orders to arm, ten times a second, from 1 s on; the button is pressed at 5 s, and the radio is
    /// silent from 10 s to 11.5 s. At 15 s the link takes back its order, at 16 s it gives it again.
    #[test]
    fn a_drop_out_of_the_radio_does_not_arm_a_robot_that_its_button_disarmed() {
        for on_loss in [OnLinkLoss::Disarm, OnLinkLoss::Continue] {
            let policy = LinkPolicy { timeout_us: 1_000_000, on_loss };
            let (slot, mut authority) = (OperatorSlot::<NoopRawMutex>::new(), Authority::default());
            for ms in (0..20_000_u64).step_by(50) {
                let is_silent = (10_000..11_500).contains(&ms);
                if ms % 100 == 0 && !is_silent {
                    let is_taken_back = (15_000..16_000).contains(&ms);
                    slot.hear(
                        ms * 1_000,
                        if is_taken_back || ms < 1_000 { DISARMED } else { ARMED },
                    );
                }
                let buttons = if ms < 5_000 { DISARMED } else { ARMED };
                let is_armed = authority.decide(buttons, slot.at(ms * 1_000, &policy)).is_armed;
                let expected = ms >= 1_000 && !(5_000..16_000).contains(&ms);
                assert_eq!(is_armed, expected, "{on_loss:?}, {ms} ms");
            }
        }
    }

    #[test]
    fn an_emergency_stop_counts_from_either_side() {
        for (here, there) in [(false, false), (true, false), (false, true), (true, true)] {
            let buttons = Operator { is_emergency_stop: here, ..DISARMED };
            let operator = Operator { is_emergency_stop: there, ..ARMED };
            let radio = Some(RadioOrders { operator, is_link_lost: false });
            let decided = Authority::default().decide(buttons, radio);
            assert_eq!(decided.is_emergency_stop, here || there, "{here} {there}");
        }
    }

    #[test]
    fn each_press_arms_or_disarms_once() {
        for (closed, armed) in [
            // Two presses.
            (&[0, 0, 1, 1, 1, 0, 0, 1, 1, 0, 0][..], &[0, 0, 0, 1, 1, 1, 1, 1, 0, 0, 0][..]),
            // A disturbance of one tick, while open and while closed.
            (&[0, 0, 1, 0, 0, 0], &[0, 0, 0, 0, 0, 0]),
            (&[0, 0, 1, 1, 0, 1, 1, 1], &[0, 0, 0, 1, 1, 1, 1, 1]),
            // Held or short-circuited from the start, and pressed later.
            (&[1, 1, 1, 1, 0, 0, 1, 1], &[0, 0, 0, 0, 0, 0, 0, 1]),
        ] {
            let mut button = ArmButton::default();
            let found = closed.iter().map(|closed| button.read(*closed == 1).is_armed);
            assert!(found.eq(armed.iter().map(|armed| *armed == 1)), "{closed:?}");
        }
    }
}
