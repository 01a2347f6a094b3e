//! Inputs and the fuzzy rules over them (H, "Applicability Control System").

use super::Name;
use crate::record::{Reader, Record, payload, record, tags};

/// The seven fuzzy labels, from negative big to positive big (H, table 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Label {
    /// Negative big.
    NB = 0,
    /// Negative medium.
    NM = 1,
    /// Negative small.
    NS = 2,
    /// Zero.
    ZO = 3,
    /// Positive small.
    PS = 4,
    /// Positive medium.
    PM = 5,
    /// Positive big.
    PB = 6,
}

impl Label {
    /// All seven, in order.
    pub const ALL: [Self; 7] =
        [Self::NB, Self::NM, Self::NS, Self::ZO, Self::PS, Self::PM, Self::PB];

    /// The label of a number; numbers above 6 give PB.
    pub const fn from_index(index: u8) -> Self {
        match index {
            0 => Self::NB,
            1 => Self::NM,
            2 => Self::NS,
            3 => Self::ZO,
            4 => Self::PS,
            5 => Self::PM,
            _ => Self::PB,
        }
    }
}

/// Seven labels, that for NB first, packed as in the blob: three bits each. An inference reads only
/// two of them, so they stay packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row(u32);

impl Row {
    /// Bits that make up a row.
    const BITS: u32 = (1 << (3 * Label::ALL.len())) - 1;

    /// The label at an index, 0 ..= 6; larger indices give the last.
    pub const fn get(self, index: usize) -> Label {
        let index = if index < Label::ALL.len() { index } else { Label::ALL.len() - 1 };
        Label::from_index((self.0 >> (3 * index) & 7) as u8)
    }

    /// All seven labels.
    pub fn labels(self) -> [Label; 7] {
        [0, 1, 2, 3, 4, 5, 6].map(|index| self.get(index))
    }

    /// A row from its bits in the blob; `None` if three of the bits are not a label.
    fn unpack(bits: u32) -> Option<Self> {
        let all_three = bits & bits >> 1 & bits >> 2;
        // The lowest bit of each group of three.
        let is_label = all_three & 0o1_111_111 == 0;
        (is_label && bits <= Self::BITS).then_some(Self(bits))
    }
}

impl From<[Label; 7]> for Row {
    fn from(labels: [Label; 7]) -> Self {
        Self(labels.into_iter().rev().fold(0, |bits, label| bits << 3 | label as u32))
    }
}

impl Record for Row {
    const SIZE: usize = u32::SIZE;

    #[inline]
    fn decode<const STRICT: bool>(reader: &mut Reader<'_>) -> Option<Self> {
        Self::unpack(u32::decode::<STRICT>(reader)?)
    }

    #[cfg(feature = "std")]
    fn encode(&self, bytes: &mut Vec<u8>) {
        self.0.encode(bytes);
    }
}

/// Where the value of an aspect of interest comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// An input channel of the percepts (battery, fuel, link, custom).
    Channel(u8),
    /// Distance from the robot to a point, metres.
    DistanceTo {
        /// East, metres.
        x_m: f32,
        /// North, metres.
        y_m: f32,
    },
    /// Seconds since start.
    Time,
    /// Cost from the robot's cell to the goal, metres, by the most constrained layer of a
    /// parallel plan that has a route.
    CostToGoal {
        /// Index of the parallel plan.
        plan: u16,
    },
    /// Price of a layer's constraint at the robot's cell: the cost of the layer minus that of layer
    /// 0, metres.
    PriceOfConstraint {
        /// Index of the parallel plan.
        plan: u16,
        /// Index of the layer.
        layer: u8,
    },
    /// A digital output: 0 or 1.
    Output(u8),
    /// The result of another rule base, 0 ..= 1; rule bases refer to earlier ones only.
    Rules(u16),
    /// Number of mates to which the link is up.
    MatesLinked,
    /// Age of the oldest news of all mates, seconds; missing until each was heard.
    OldestNews,
    /// Distance to the nearest of these mates, one bit each, metres; missing without news over a
    /// link that is up.
    DistanceToMate(u8),
    /// Quality of the link to a mate, by number: 0 while it is lost.
    LinkToMate(u8),
    /// A fact, by its bit: 1 while it holds, otherwise 0.
    Fact(u8),
    /// The distance that a tank still gives, less the cost to the goal of a parallel plan, metres:
    /// negative once the goal is out of reach.
    RangeLeft {
        /// Index of the parallel plan.
        plan: u16,
        /// The channel that reports how full the tank is, 0 ..= 1.
        channel: u8,
        /// The distance that a full tank gives, metres, above 0.
        full_m: f32,
    },
}

record! {
    /// The bytes that the variants of [`Source`] share. Coordinates are bits of an `f32`.
    #[derive(Clone, Copy, Default, PartialEq)]
    struct SourceBytes {
        tag: u8,
        index: u16,
        layer: u16,
        x: u32,
        y: u32,
    }
}

impl Source {
    #[inline]
    fn of_bytes(bytes: SourceBytes) -> Option<Self> {
        let SourceBytes { tag, index, layer, x, y } = bytes;
        Some(match tag {
            0 => Self::Channel(index as u8),
            1 => Self::DistanceTo { x_m: f32::from_bits(x), y_m: f32::from_bits(y) },
            2 => Self::Time,
            3 => Self::CostToGoal { plan: index },
            4 => Self::PriceOfConstraint { plan: index, layer: layer as u8 },
            5 => Self::Output(index as u8),
            6 => Self::Rules(index),
            7 => Self::MatesLinked,
            8 => Self::OldestNews,
            9 => Self::DistanceToMate(index as u8),
            10 => Self::LinkToMate(index as u8),
            11 => Self::Fact(index as u8),
            12 => Self::RangeLeft { plan: index, channel: layer as u8, full_m: f32::from_bits(x) },
            _ => return None,
        })
    }

    fn to_bytes(self) -> SourceBytes {
        let none = SourceBytes::default();
        match self {
            Self::Channel(channel) => SourceBytes { index: channel.into(), ..none },
            Self::DistanceTo { x_m, y_m } => {
                SourceBytes { tag: 1, x: x_m.to_bits(), y: y_m.to_bits(), ..none }
            }
            Self::Time => SourceBytes { tag: 2, ..none },
            Self::CostToGoal { plan } => SourceBytes { tag: 3, index: plan, ..none },
            Self::PriceOfConstraint { plan, layer } => {
                SourceBytes { tag: 4, index: plan, layer: layer.into(), ..none }
            }
            Self::Output(output) => SourceBytes { tag: 5, index: output.into(), ..none },
            Self::Rules(rules) => SourceBytes { tag: 6, index: rules, ..none },
            Self::MatesLinked => SourceBytes { tag: 7, ..none },
            Self::OldestNews => SourceBytes { tag: 8, ..none },
            Self::DistanceToMate(robots) => SourceBytes { tag: 9, index: robots.into(), ..none },
            Self::LinkToMate(robot) => SourceBytes { tag: 10, index: robot.into(), ..none },
            Self::Fact(fact) => SourceBytes { tag: 11, index: fact.into(), ..none },
            Self::RangeLeft { plan, channel, full_m } => SourceBytes {
                tag: 12,
                index: plan,
                layer: channel.into(),
                x: full_m.to_bits(),
                ..none
            },
        }
    }
}

payload!(Source in SourceBytes);

record! {
    /// An aspect of interest: a number with a universe (H, "Applicability Control System").
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Input {
        /// Its name.
        pub name: Name,
        /// Where its value comes from.
        pub source: Source,
        /// The value that is fully NB; may be above `high`.
        pub low: f32,
        /// The value that is fully PB.
        pub high: f32,
        /// Time for which the last value replaces a missing one, milliseconds.
        pub hold_ms: u32,
        /// The value that replaces a missing one after that, in the unit of the universe.
        pub missing: f32,
    }
}

record! {
    /// One row of a rule base: what each label of an input means for the result.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Rule {
        /// Index of the input.
        pub input: u8,
        /// The result's label for each label of the input.
        pub labels: Row,
    }
}

/// How the degree of a rule's premise limits its consequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inference {
    /// Clipped at the degree.
    Min,
    /// Scaled by the degree.
    Product,
}

tags!(Inference { Min = 0, Product = 1, });

record! {
    /// Rules whose results are combined into one number (H, table 3).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct RuleBase {
        /// Index of the first rule.
        pub first: u16,
        /// Number of rules, at least 1.
        pub count: u8,
        /// How premises limit consequences.
        pub inference: Inference,
    }
}
