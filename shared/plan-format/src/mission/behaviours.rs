//! Behaviours, and where they may be interrupted.

use super::Name;
use crate::record::{record, tags};

/// At which of its switching points a behaviour yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchPoint {
    /// The first point without an interfering protection interval (H).
    Earliest,
    /// The point with the least lost work (H, future work).
    Best,
}

tags!(SwitchPoint { Earliest = 0, Best = 1, });

record! {
    /// A behaviour: a task as a plan, with a criticality.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Behaviour {
        /// Its name.
        pub name: Name,
        /// Index of the plan frame at its root.
        pub root: u16,
        /// Index of the plan frame of its start-up activity, which runs before it is engaged or
        /// resumed.
        pub start_up: Option<u16>,
        /// Index of the plan frame of its shut-down activity, which runs before it sleeps after a
        /// conditional switch.
        pub shut_down: Option<u16>,
        /// Index of the rule base of its criticality.
        pub rules: u16,
        /// Dormant up to this criticality.
        pub dormant: f32,
        /// Engaged at once from this criticality.
        pub unconditional: f32,
        /// How much more critical another behaviour must be to take over.
        pub hysteresis: f32,
        /// Minimum dwell: no conditional interruption within this time, milliseconds.
        pub dwell_ms: u32,
        /// Where it yields.
        pub switch_point: SwitchPoint,
        /// Whether it is never engaged again after its plan has finished.
        pub once: bool,
        /// Resources that it occupies, one bit each; behaviours that share none run together.
        pub resources: u16,
    }
}

impl Behaviour {
    /// Indices of its plan frames: the root, then those of its activities.
    pub fn plan_frames(&self) -> impl Iterator<Item = u16> + use<> {
        [Some(self.root), self.start_up, self.shut_down].into_iter().flatten()
    }
}
