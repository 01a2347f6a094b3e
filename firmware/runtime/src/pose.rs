//! The latest pose from another source than the GPS receiver, and when it arrived.

use core::cell::Cell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use robot_io::Pose;

/// The latest pose, shared between tasks.
pub struct PoseSlot<M: RawMutex>(Mutex<M, Cell<Option<Pose>>>);

impl<M: RawMutex> Default for PoseSlot<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> PoseSlot<M> {
    /// An empty slot.
    pub const fn new() -> Self {
        Self(Mutex::new(Cell::new(None)))
    }

    /// Stores the pose that arrived at `time_us`. The sender's own clock does not count.
    pub fn hear(&self, time_us: u64, pose: Pose) {
        self.0.lock(|cell| cell.set(Some(Pose { time_us, ..pose })));
    }

    /// The latest pose; `None` before the first.
    pub fn latest(&self) -> Option<Pose> {
        self.0.lock(Cell::get)
    }
}
