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
    /// Silence disarmed the robot.
    pub is_link_lost: bool,
}

/// Decides who may arm and who may stop the robot: its own buttons, or the operator over the link.
///
/// Both may stop it: an emergency stop counts from either side. The link outranks the buttons in
/// arming and in manual driving, from its first packet on. But a change at the arm button, or any
/// other change of the buttons' order to arm, disarms an armed robot at once, whatever the link
/// says. It stays disarmed until the link has taken back its own order to arm: a person beside
/// the robot must not be overruled by the next packet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Authority {
    was_armed_here: bool,
    is_armed: bool,
    /// A button has disarmed the robot, and the link has not taken back its order since.
    is_held: bool,
}

impl Authority {
    /// The orders that count in this tick: `buttons` are the robot's own.
    pub fn decide(&mut self, buttons: Operator, radio: Option<RadioOrders>) -> Operator {
        let is_pressed = buttons.is_armed != self.was_armed_here;
        self.was_armed_here = buttons.is_armed;
        let Some(radio) = radio else {
            self.is_armed = buttons.is_armed;
            return buttons;
        };
        self.is_held |= is_pressed && self.is_armed;
        self.is_held &= radio.operator.is_armed;
        let is_armed = radio.operator.is_armed && !self.is_held;
        self.is_armed = is_armed;
        Operator {
            is_armed,
            is_emergency_stop: buttons.is_emergency_stop || radio.operator.is_emergency_stop,
            manual: radio.operator.manual,
        }
    }
}

/// A button on the robot: each press arms or disarms. Read it once a tick: its contacts bounce for
/// less than that.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArmButton {
    was_pressed: bool,
    is_armed: bool,
}

impl ArmButton {
    /// The orders of the button in this tick.
    pub fn read(&mut self, is_pressed: bool) -> Operator {
        self.is_armed ^= is_pressed && !self.was_pressed;
        self.was_pressed = is_pressed;
        Operator { is_armed: self.is_armed, ..Operator::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use plan_format::Parameters;

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
    #[test]
    fn a_person_beside_the_robot_may_disarm_it() {
        let table = [
            (false, None, false),
            (true, None, true),
            (false, None, false),
            (false, Some(true), true),
            (true, Some(true), false),
            (true, Some(true), false),
            (false, Some(true), false),
            (false, Some(false), false),
            (false, Some(true), true),
            (false, Some(false), false),
            (true, Some(false), false),
            (true, Some(true), true),
            (false, Some(true), false),
        ];
        let mut authority = Authority::default();
        for (tick, (button, link, is_armed)) in table.into_iter().enumerate() {
            let order = |is_armed| if is_armed { ARMED } else { DISARMED };
            let radio =
                link.map(|is_armed| RadioOrders { operator: order(is_armed), is_link_lost: false });
            assert_eq!(authority.decide(order(button), radio), order(is_armed), "tick {tick}");
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
        let mut button = ArmButton::default();
        let presses = [false, true, true, false, true, false];
        let armed = presses.map(|is_pressed| button.read(is_pressed).is_armed);
        assert_eq!(armed, [false, true, true, true, false, false]);
    }
}
