//! The components of plans: descriptions, atomic actions and plan frames.

use super::{Condition, Facts, Name};
use crate::record::{payload, record};

record! {
    /// What a component needs, keeps and brings about (H, "Plan Component Representation").
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Description {
        /// Must hold when it starts.
        pub initial: Condition,
        /// Must hold while it runs.
        pub transient: Condition,
        /// Must hold when it ends.
        pub goal: Condition,
        /// Symbols that become true at its end.
        pub add: Facts,
        /// Symbols that become false at its end, and sensed facts that it may make false.
        pub delete: Facts,
        /// Maximum speed while it runs, m/s; infinite for none. Components below inherit it.
        pub max_speed_mps: f32,
        /// Minimum distance from obstacles while it runs, metres; 0 for none. Components below
        /// inherit it.
        pub min_distance_m: f32,
    }
}

/// What an atomic action does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ActionKind {
    /// Follow a parallel plan to its goal.
    Follow {
        /// Index of the parallel plan.
        plan: u16,
        /// Weight of the reactive schemas.
        reactive: f32,
        /// Weight of the advice.
        advice: f32,
        /// Weight of the noise.
        noise: f32,
    },
    /// Drive straight to a point of the map by the reactive schemas.
    GoTo {
        /// East, metres.
        x_m: f32,
        /// North, metres.
        y_m: f32,
    },
    /// Stand still for a time.
    Hold {
        /// Duration, milliseconds.
        for_ms: u32,
    },
    /// Drive by the noise schema for a time.
    Wander {
        /// Duration, milliseconds.
        for_ms: u32,
    },
    /// Report a code once.
    Signal {
        /// The code.
        code: u16,
    },
    /// Set a digital output.
    SetOutput {
        /// Number of the output.
        output: u8,
        /// Whether to switch it on.
        is_on: bool,
    },
    /// Drive straight back to the place at which the behaviour was interrupted.
    Return,
    /// Drive in a fixed direction for a time, by the reactive schemas.
    MoveAhead {
        /// The direction on the globe, radians counter-clockwise from east.
        direction_rad: f32,
        /// Duration, milliseconds.
        for_ms: u32,
    },
    /// Drive into a dock, by the reactive schemas.
    Dock {
        /// East, metres.
        x_m: f32,
        /// North, metres.
        y_m: f32,
        /// Direction in which the robot stands in the dock, on the globe, radians counter-clockwise
        /// from east.
        direction_rad: f32,
        /// Within this distance the robot goes around to the dock's front, centimetres.
        radius_cm: u16,
    },
}

record! {
    /// The bytes that the variants of [`ActionKind`] share. The last three are bits of an `f32`.
    #[derive(Clone, Copy, PartialEq)]
    struct ActionBytes {
        tag: u8,
        number: u32,
        x: u32,
        y: u32,
        z: u32,
    }
}

impl ActionKind {
    #[inline]
    fn of_bytes(bytes: ActionBytes) -> Option<Self> {
        let ActionBytes { tag, number, .. } = bytes;
        let [x, y, z] = [bytes.x, bytes.y, bytes.z].map(f32::from_bits);
        Some(match tag {
            0 => Self::Follow { plan: number as u16, reactive: x, advice: y, noise: z },
            1 => Self::GoTo { x_m: x, y_m: y },
            2 => Self::Hold { for_ms: number },
            3 => Self::Wander { for_ms: number },
            4 => Self::Signal { code: number as u16 },
            5 => Self::SetOutput { output: number as u8, is_on: x > 0.0 },
            6 => Self::Return,
            7 => Self::MoveAhead { direction_rad: x, for_ms: number },
            8 => Self::Dock { x_m: x, y_m: y, direction_rad: z, radius_cm: number as u16 },
            _ => return None,
        })
    }

    fn to_bytes(self) -> ActionBytes {
        let (tag, number, [x, y, z]) = match self {
            Self::Follow { plan, reactive, advice, noise } => {
                (0, plan.into(), [reactive, advice, noise])
            }
            Self::GoTo { x_m, y_m } => (1, 0, [x_m, y_m, 0.0]),
            Self::Hold { for_ms } => (2, for_ms, [0.0; 3]),
            Self::Wander { for_ms } => (3, for_ms, [0.0; 3]),
            Self::Signal { code } => (4, code.into(), [0.0; 3]),
            Self::SetOutput { output, is_on } => {
                (5, output.into(), [u8::from(is_on).into(), 0.0, 0.0])
            }
            Self::Return => (6, 0, [0.0; 3]),
            Self::MoveAhead { direction_rad, for_ms } => (7, for_ms, [direction_rad, 0.0, 0.0]),
            Self::Dock { x_m, y_m, direction_rad, radius_cm } => {
                (8, radius_cm.into(), [x_m, y_m, direction_rad])
            }
        };
        ActionBytes { tag, number, x: x.to_bits(), y: y.to_bits(), z: z.to_bits() }
    }
}

payload!(ActionKind in ActionBytes);

record! {
    /// An atomic action: a terminal symbol of the grammar.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Action {
        /// Its name.
        pub name: Name,
        /// What it does.
        pub kind: ActionKind,
        /// Index of its description.
        pub description: u16,
        /// It ends as soon as this holds; if empty, only the kind ends it.
        pub until: Condition,
        /// It fails after this time, milliseconds; never 0.
        pub timeout_ms: u32,
        /// Resources that it occupies, one bit each.
        pub resources: u16,
    }
}

record! {
    /// A plan frame: a non-terminal symbol of the grammar, which is decomposed.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct PlanFrame {
        /// Its name.
        pub name: Name,
        /// Index of its first production.
        pub first: u16,
        /// Number of productions, at least 1.
        pub count: u8,
        /// Index of its description.
        pub description: u16,
        /// Minimum applicability of a production.
        pub threshold: f32,
        /// It ends as soon as this holds; if empty, only its production ends it.
        pub until: Condition,
        /// It fails after this time since its first decomposition, milliseconds; 0 for never. The
        /// time that its behaviour sleeps does not count.
        pub timeout_ms: u32,
        /// Facts that some action below it may make true.
        pub may_add: Facts,
        /// Facts that some action below it may make false.
        pub may_delete: Facts,
        /// Resources that the actions below it occupy, one bit each.
        pub resources: u16,
    }
}
