//! The life cycle of a component.

/// Life-cycle state of a component (H, "Plan Component Representation").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Life {
    /// In the plan, but its start vertex is not reached.
    Planned,
    /// Due to start: its start vertex is reached.
    Scheduled,
    /// An action that runs, or a decomposed plan frame.
    Started,
    /// Interrupted with its behaviour.
    Suspended,
    /// Done; about to leave the pool.
    Finished,
    /// Could not be done; about to leave the pool.
    Failed,
    /// Given up because a component above or beside it was; about to leave the pool.
    Abandoned,
}

impl Life {
    /// Whether a component may go from this state to another.
    pub const fn may_become(self, next: Self) -> bool {
        use Life::{Abandoned, Failed, Finished, Planned, Scheduled, Started, Suspended};
        match self {
            Planned => matches!(next, Scheduled | Abandoned),
            // A plan frame that falls back is scheduled again.
            Scheduled => matches!(next, Started | Finished | Failed | Suspended | Abandoned),
            Started => matches!(next, Scheduled | Finished | Failed | Suspended | Abandoned),
            Suspended => matches!(next, Started | Scheduled | Failed | Abandoned),
            Finished | Failed | Abandoned => false,
        }
    }
}
