//! The life cycle of a component.

/// The life cycle of a component (H, "Plan Component Representation").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Life {
    /// In the plan; its turn has not come.
    Planned,
    /// Its turn has come.
    Scheduled,
    /// Being carried out, or decomposed.
    Started,
    /// Interrupted with its behaviour.
    Suspended,
    /// Carried out; about to leave the pool.
    Finished,
    /// Gave an error; about to leave the pool.
    Failed,
    /// Given up with a component above or beside it; about to leave the pool.
    Abandoned,
}

impl Life {
    /// Whether a component may go from this state to another.
    pub const fn may_become(self, next: Self) -> bool {
        use Life::{Abandoned, Failed, Finished, Planned, Scheduled, Started, Suspended};
        match self {
            Planned => matches!(next, Scheduled | Abandoned),
            // A frame that falls back is scheduled again.
            Scheduled => matches!(next, Started | Finished | Failed | Suspended | Abandoned),
            Started => matches!(next, Scheduled | Finished | Failed | Suspended | Abandoned),
            Suspended => matches!(next, Started | Scheduled | Failed | Abandoned),
            Finished | Failed | Abandoned => false,
        }
    }
}
