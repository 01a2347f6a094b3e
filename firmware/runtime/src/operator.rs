//! The operator's latest orders, and when they arrived.

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

    #[test]
    fn each_press_arms_or_disarms_once() {
        let mut button = ArmButton::default();
        let presses = [false, true, true, false, true, false];
        let armed = presses.map(|is_pressed| button.read(is_pressed).is_armed);
        assert_eq!(armed, [false, true, true, true, false, false]);
    }
}
