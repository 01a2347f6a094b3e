//! Facts about the world, and conditions over them.

use super::Name;
use crate::record::{payload, record};

/// A set of facts, one bit each.
pub type Facts = u64;

record! {
    /// A conjunction over facts.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Condition {
        /// All of these hold.
        pub must: Facts,
        /// None of these holds.
        pub must_not: Facts,
    }
}

impl Condition {
    /// Whether it holds if exactly `facts` hold.
    pub const fn holds(self, facts: Facts) -> bool {
        facts & self.must == self.must && facts & self.must_not == 0
    }

    /// The facts that violate it.
    pub const fn violated(self, facts: Facts) -> Facts {
        self.must & !facts | self.must_not & facts
    }

    /// Both conditions together.
    pub const fn and(self, other: Self) -> Self {
        Self { must: self.must | other.must, must_not: self.must_not | other.must_not }
    }

    /// Whether it constrains no fact.
    pub const fn is_empty(self) -> bool {
        self.must == 0 && self.must_not == 0
    }
}

/// Mates that a fact is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mates {
    /// Their numbers in the team, one bit each; never 0.
    pub robots: u8,
    /// Whether the fact must hold for all of them; otherwise for any.
    pub all: bool,
    /// What counts for a mate without news over a link that is up.
    pub missing: bool,
}

impl Mates {
    fn bits(self) -> u32 {
        u32::from(self.robots) | u32::from(self.all) << 8 | u32::from(self.missing) << 9
    }

    const fn of_bits(bits: u32) -> Self {
        Self { robots: bits as u8, all: bits >> 8 & 1 == 1, missing: bits >> 9 & 1 == 1 }
    }

    /// Whether the fact holds, if `holds` is what is known of each mate by its number.
    pub fn hold(self, holds: impl Fn(u8) -> Option<bool>) -> bool {
        let robots = (0..u8::BITS as u8).filter(|robot| self.robots >> robot & 1 == 1);
        let mut each = robots.map(|robot| holds(robot).unwrap_or(self.missing));
        if self.all { each.all(|holds| holds) } else { each.any(|holds| holds) }
    }
}

/// When a fact holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FactKind {
    /// Set and cleared by the add and delete lists of components.
    Symbol {
        /// Whether it holds at the start.
        is_set: bool,
    },
    /// An input lies between two values of its unit, both included.
    Level {
        /// Index of the input.
        input: u8,
        /// Lowest value.
        low: f32,
        /// Highest value.
        high: f32,
    },
    /// The robot is within a distance of a point.
    Near {
        /// East, metres.
        x_m: f32,
        /// North, metres.
        y_m: f32,
        /// Distance, metres.
        radius_m: f32,
    },
    /// The robot is in a rectangle.
    Inside {
        /// Western border, metres.
        west_m: f32,
        /// Southern border, metres.
        south_m: f32,
        /// Eastern border, metres.
        east_m: f32,
        /// Northern border, metres.
        north_m: f32,
    },
    /// The links to mates are up.
    Linked(Mates),
    /// Mates are within a distance of the robot.
    MateNear {
        /// Which mates.
        mates: Mates,
        /// Distance, metres.
        radius_m: f32,
    },
    /// Mates are within a distance of a point.
    MateAt {
        /// Which mates.
        mates: Mates,
        /// East, metres.
        x_m: f32,
        /// North, metres.
        y_m: f32,
        /// Distance, metres.
        radius_m: f32,
    },
    /// The last signal of mates has a code.
    MateSignals {
        /// Which mates.
        mates: Mates,
        /// The code.
        code: u16,
    },
    /// The robot has not moved a distance for longer than a time.
    NoProgress {
        /// Distance, metres.
        distance_m: f32,
        /// Time, milliseconds.
        within_ms: u32,
    },
}

record! {
    /// The bytes that the variants of [`FactKind`] share: integers, or bits of an `f32`.
    #[derive(Clone, Copy, PartialEq)]
    struct FactBytes {
        tag: u8,
        a: u32,
        b: u32,
        c: u32,
        d: u32,
    }
}

impl FactKind {
    #[inline]
    fn of_bytes(bytes: FactBytes) -> Option<Self> {
        let FactBytes { tag, a, .. } = bytes;
        let [x, b, c, d] = [a, bytes.b, bytes.c, bytes.d].map(f32::from_bits);
        Some(match tag {
            0 => Self::Symbol { is_set: a != 0 },
            1 => Self::Level { input: a as u8, low: b, high: c },
            2 => Self::Near { x_m: x, y_m: b, radius_m: c },
            3 => Self::Inside { west_m: x, south_m: b, east_m: c, north_m: d },
            4 => Self::NoProgress { within_ms: a, distance_m: b },
            5 => Self::Linked(Mates::of_bits(a)),
            6 => Self::MateNear { mates: Mates::of_bits(a), radius_m: b },
            7 => Self::MateAt { mates: Mates::of_bits(a), x_m: b, y_m: c, radius_m: d },
            8 => Self::MateSignals { mates: Mates::of_bits(a), code: (a >> 16) as u16 },
            _ => return None,
        })
    }

    fn to_bytes(self) -> FactBytes {
        let (tag, a, [b, c, d]) = match self {
            Self::Symbol { is_set } => (0, is_set.into(), [0.0; 3]),
            Self::Level { input, low, high } => (1, input.into(), [low, high, 0.0]),
            Self::Near { x_m, y_m, radius_m } => (2, x_m.to_bits(), [y_m, radius_m, 0.0]),
            Self::Inside { west_m, south_m, east_m, north_m } => {
                (3, west_m.to_bits(), [south_m, east_m, north_m])
            }
            Self::NoProgress { distance_m, within_ms } => (4, within_ms, [distance_m, 0.0, 0.0]),
            Self::Linked(mates) => (5, mates.bits(), [0.0; 3]),
            Self::MateNear { mates, radius_m } => (6, mates.bits(), [radius_m, 0.0, 0.0]),
            Self::MateAt { mates, x_m, y_m, radius_m } => (7, mates.bits(), [x_m, y_m, radius_m]),
            Self::MateSignals { mates, code } => {
                (8, mates.bits() | u32::from(code) << 16, [0.0; 3])
            }
        };
        FactBytes { tag, a, b: b.to_bits(), c: c.to_bits(), d: d.to_bits() }
    }
}

payload!(FactKind in FactBytes);

record! {
    /// A proposition about the world.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Fact {
        /// Its name.
        pub name: Name,
        /// When it holds.
        pub kind: FactKind,
    }
}
