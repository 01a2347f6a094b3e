//! How plan frames are decomposed: productions, their edges and their protection intervals.

use super::{Condition, Name};
use crate::record::{payload, record};

record! {
    /// One way to decompose a plan frame: a double-pointed graph. Its entry is vertex 0, its exit
    /// the last vertex.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Production {
        /// Its name.
        pub name: Name,
        /// Index of the rule base of its applicability; `None` for always 1.
        pub rules: Option<u16>,
        /// Index of its first edge.
        pub first_edge: u16,
        /// Number of edges, at least 1.
        pub edges: u8,
        /// Number of vertices, at least 2.
        pub vertices: u8,
        /// Index of its first protection interval.
        pub first_interval: u16,
        /// Number of protection intervals.
        pub intervals: u8,
    }
}

/// The label of an edge: a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Symbol {
    /// A plan frame, by index.
    PlanFrame(u16),
    /// An atomic action, by index.
    Action(u16),
}

record! {
    #[derive(Clone, Copy, PartialEq)]
    struct SymbolBytes {
        tag: u8,
        index: u16,
    }
}

impl Symbol {
    #[inline]
    fn of_bytes(SymbolBytes { tag, index }: SymbolBytes) -> Option<Self> {
        match tag {
            0 => Some(Self::PlanFrame(index)),
            1 => Some(Self::Action(index)),
            _ => None,
        }
    }

    fn to_bytes(self) -> SymbolBytes {
        match self {
            Self::PlanFrame(index) => SymbolBytes { tag: 0, index },
            Self::Action(index) => SymbolBytes { tag: 1, index },
        }
    }
}

payload!(Symbol in SymbolBytes);

record! {
    /// A component between two partial states.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Edge {
        /// Vertex at which it begins.
        pub from: u8,
        /// Vertex at which it ends; always above `from`.
        pub to: u8,
        /// The component.
        pub symbol: Symbol,
        /// Work lost if the behaviour is interrupted right after it; any unit, the same for all
        /// edges.
        pub work: u16,
    }
}

record! {
    /// A protection interval: a condition must hold from one vertex of a production to another.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Interval {
        /// Vertex at which it begins.
        pub from: u8,
        /// Vertex at which it ends.
        pub to: u8,
        /// Whether the compiler derived it from a single producer and a single consumer.
        pub is_derived: bool,
        /// What must hold.
        pub condition: Condition,
    }
}
