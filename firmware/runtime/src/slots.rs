//! What the tasks of one robot share.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use robot_io::CommandRecord;

use crate::gps::FixSlot;
use crate::mates::MateSlot;
use crate::operator::OperatorSlot;
use crate::pose::PoseSlot;

/// The newest unsent record.
pub type Telemetry<M> = Signal<M, CommandRecord>;

/// What the tasks of one robot share. In each slot the newest value replaces the last.
pub struct Slots<M: RawMutex> {
    /// Fixes, from the GPS task to the control task.
    pub fixes: FixSlot<M>,
    /// Orders, from the operator task to the control task.
    pub operator: OperatorSlot<M>,
    /// Poses, from the operator task to the control task.
    pub poses: PoseSlot<M>,
    /// News of mates, from the operator task to the control task.
    pub mates: MateSlot<M>,
    /// Records, from the control task to the telemetry task.
    pub telemetry: Telemetry<M>,
}

impl<M: RawMutex> Default for Slots<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> Slots<M> {
    /// Empty slots.
    pub const fn new() -> Self {
        Self {
            fixes: FixSlot::new(),
            operator: OperatorSlot::new(),
            poses: PoseSlot::new(),
            mates: MateSlot::new(),
            telemetry: Telemetry::new(),
        }
    }
}
