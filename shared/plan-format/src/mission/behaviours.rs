//! Behaviours, and where they may be interrupted.

use super::Name;
use crate::record::{record, tags};

/// Which of the possible switching points is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchPoint {
    /// The first without interfering protection intervals (H).
    Earliest,
    /// The one with the least lost work (H, future work).
    Best,
}

tags!(SwitchPoint { Earliest = 0, Best = 1, });

record! {
    /// A behaviour: a task as a plan, with a criticality.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Behaviour {
        /// Its name.
        pub name: Name,
        /// Index of its root frame.
        pub root: u16,
        /// Index of the frame that is run before it is engaged or resumed.
        pub start_up: Option<u16>,
        /// Index of the frame that is run before it is put to sleep conditionally.
        pub shut_down: Option<u16>,
        /// Index of the rule base of its criticality.
        pub rules: u16,
        /// Dormant up to this criticality.
        pub dormant: f32,
        /// Engaged at once from this criticality.
        pub unconditional: f32,
        /// How much more critical another must be to take over.
        pub hysteresis: f32,
        /// Not interrupted conditionally within this time, milliseconds.
        pub dwell_ms: u32,
        /// Which switching point it yields at.
        pub switch_point: SwitchPoint,
        /// What it occupies; behaviours that share nothing run together.
        pub resources: u16,
    }
}
