//! The records of the mission's tables: what they mean, and their bytes.
//!
//! Every record has a fixed size, little-endian, unaligned, so that a table is read in place
//! by index. Decoding is total: [`super::Mission::parse`] has checked every tag and every
//! reference before a tick sees one.

use super::bytes::{Reader, Record};

/// A name in the mission's name table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Name {
    /// Where it starts, bytes.
    pub offset: u16,
    /// How long it is, bytes.
    pub length: u8,
}

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

    /// The label of a number; what is above 6 counts as PB.
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

/// Seven labels, NB's first, as the blob has them: three bits each. An inference looks at two of
/// them, so they stay packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row(u32);

impl Row {
    /// Bits that make up a row.
    const BITS: u32 = (1 << (3 * Label::ALL.len())) - 1;

    /// The label at a place 0 ..= 6; places beyond have the last.
    pub const fn get(self, place: usize) -> Label {
        let place = if place < Label::ALL.len() { place } else { Label::ALL.len() - 1 };
        Label::from_index((self.0 >> (3 * place) & 7) as u8)
    }

    /// All seven.
    pub fn labels(self) -> [Label; 7] {
        [0, 1, 2, 3, 4, 5, 6].map(|place| self.get(place))
    }

    /// A row as it stands in the blob; `None` where some three bits are no label.
    fn unpack(bits: u32) -> Option<Self> {
        let all_three = bits & bits >> 1 & bits >> 2;
        // The lowest bit of each three.
        let is_label = all_three & 0o1_111_111 == 0;
        (is_label && bits <= Self::BITS).then_some(Self(bits))
    }
}

impl From<[Label; 7]> for Row {
    fn from(labels: [Label; 7]) -> Self {
        Self(labels.into_iter().rev().fold(0, |bits, label| bits << 3 | label as u32))
    }
}

/// Where the value of an aspect of interest comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// An input channel of the percepts (battery, fuel, link, custom).
    Channel(u8),
    /// Distance from the robot to a place, metres.
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
    /// What a layer's constraint costs from here: its cost less that of layer 0, metres.
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
}

/// An aspect of interest: a number with a universe (H, "Applicability Control System").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Its name.
    pub name: Name,
    /// Where its value comes from.
    pub source: Source,
    /// The value that is wholly NB; may be above `high`.
    pub low: f32,
    /// The value that is wholly PB.
    pub high: f32,
    /// For how long the last value stands in for a missing one, milliseconds.
    pub hold_ms: u32,
    /// What a missing value counts as after that, in the universe's unit.
    pub missing: f32,
}

/// One row of a rule base: what each label of an input means for the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rule {
    /// Index of the input.
    pub input: u8,
    /// The result's label for each of the input's seven.
    pub labels: Row,
}

/// How a rule's consequence is cut to the degree of its premise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inference {
    /// Clipped at the degree.
    Min,
    /// Scaled by the degree.
    Product,
}

/// Some rules whose results are summed into one number (H, table 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuleBase {
    /// Index of the first rule.
    pub first: u16,
    /// Number of rules, at least 1.
    pub count: u8,
    /// How consequences are cut.
    pub inference: Inference,
}

/// A set of facts, one bit each.
pub type Facts = u64;

/// A conjunction over facts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Condition {
    /// All of these hold.
    pub must: Facts,
    /// None of these holds.
    pub must_not: Facts,
}

impl Condition {
    /// Whether it holds where exactly `facts` do.
    pub const fn holds(self, facts: Facts) -> bool {
        facts & self.must == self.must && facts & self.must_not == 0
    }

    /// The facts that are not as it wants them.
    pub const fn violated(self, facts: Facts) -> Facts {
        self.must & !facts | self.must_not & facts
    }

    /// Both at once.
    pub const fn and(self, other: Self) -> Self {
        Self { must: self.must | other.must, must_not: self.must_not | other.must_not }
    }

    /// Whether it says nothing.
    pub const fn is_empty(self) -> bool {
        self.must == 0 && self.must_not == 0
    }
}

/// What a fact says.
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
        /// Lowest.
        low: f32,
        /// Highest.
        high: f32,
    },
    /// The robot is within a distance of a place.
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
        /// West, metres.
        west_m: f32,
        /// South, metres.
        south_m: f32,
        /// East, metres.
        east_m: f32,
        /// North, metres.
        north_m: f32,
    },
    /// The robot has not come farther than a distance within a time.
    NoProgress {
        /// Distance, metres.
        distance_m: f32,
        /// Time, milliseconds.
        within_ms: u32,
    },
}

/// A proposition about the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fact {
    /// Its name.
    pub name: Name,
    /// What it says.
    pub kind: FactKind,
}

/// What a component needs, keeps and brings about (H, "Plan Component Representation").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Holds when it starts.
    pub initial: Condition,
    /// Holds as long as it runs.
    pub transient: Condition,
    /// Holds when it ends.
    pub goal: Condition,
    /// Symbols that become true at its end.
    pub add: Facts,
    /// Symbols that become false at its end, and sensed facts that it may make false.
    pub delete: Facts,
    /// Never faster while it runs, m/s; infinite for no constraint. Inherited downwards.
    pub max_speed_mps: f32,
    /// Never nearer to an obstacle while it runs, metres; 0 for no constraint. Inherited downwards.
    pub min_distance_m: f32,
}

/// What an atomic action does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ActionKind {
    /// Drive by a parallel plan until its goal.
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
    /// Drive straight to a place by the reactive schemas.
    GoTo {
        /// East, metres.
        x_m: f32,
        /// North, metres.
        y_m: f32,
    },
    /// Stand still for a time.
    Hold {
        /// Milliseconds.
        for_ms: u32,
    },
    /// Drive by the noise schema for a time.
    Wander {
        /// Milliseconds.
        for_ms: u32,
    },
    /// Report a code once.
    Signal {
        /// The code.
        code: u16,
    },
    /// Set a digital output.
    SetOutput {
        /// Which.
        output: u8,
        /// On or off.
        is_on: bool,
    },
}

/// A terminal symbol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Action {
    /// Its name.
    pub name: Name,
    /// What it does.
    pub kind: ActionKind,
    /// Index of its description.
    pub description: u16,
    /// It is over as soon as this holds, if it says anything.
    pub until: Condition,
    /// It has failed after this time, milliseconds; never 0.
    pub timeout_ms: u32,
    /// What it occupies, one bit each.
    pub resources: u16,
}

/// A non-terminal symbol: a conceptual activity that is decomposed.
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
    /// Productions below this applicability are not considered.
    pub threshold: f32,
    /// Facts that some action below it may make true.
    pub may_add: Facts,
    /// Facts that some action below it may make false.
    pub may_delete: Facts,
    /// What the actions below it occupy.
    pub resources: u16,
}

/// One way to decompose a frame: a double-pointed graph, entry vertex 0, exit the last one.
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

/// What an edge carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Symbol {
    /// A plan frame, by index.
    Frame(u16),
    /// An atomic action, by index.
    Action(u16),
}

/// A component between two partial states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Vertex it leaves.
    pub from: u8,
    /// Vertex it reaches; always above `from`.
    pub to: u8,
    /// What it carries.
    pub symbol: Symbol,
    /// What it costs to interrupt the behaviour right after it: the work that will have to be
    /// done again; any unit, the same for all edges.
    pub work: u16,
}

/// A protection interval: the condition holds from one vertex of a production to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// Vertex at which it begins.
    pub from: u8,
    /// Vertex at which it ends.
    pub to: u8,
    /// What it protects.
    pub condition: Condition,
    /// Derived by the compiler from a single producer and a single consumer.
    pub is_derived: bool,
}

/// Which of the possible switching points is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchPoint {
    /// The first without interfering protection intervals (H).
    Earliest,
    /// The one with the least lost work (H, future work).
    Best,
}

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

impl Record for Input {
    const SIZE: usize = 32;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            name: Name::decode(r)?,
            source: match (r.u8()?, r.u16()?, r.u16()?, r.f32()?, r.f32()?) {
                (0, channel, ..) => Source::Channel(channel as u8),
                (1, _, _, x_m, y_m) => Source::DistanceTo { x_m, y_m },
                (2, ..) => Source::Time,
                (3, plan, ..) => Source::CostToGoal { plan },
                (4, plan, layer, ..) => Source::PriceOfConstraint { plan, layer: layer as u8 },
                (5, output, ..) => Source::Output(output as u8),
                (6, rules, ..) => Source::Rules(rules),
                _ => return None,
            },
            low: r.f32()?,
            high: r.f32()?,
            hold_ms: r.u32()?,
            missing: r.f32()?,
        })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        self.name.encode(w);
        let (tag, a, b, x, y) = match self.source {
            Source::Channel(channel) => (0, u16::from(channel), 0, 0.0, 0.0),
            Source::DistanceTo { x_m, y_m } => (1, 0, 0, x_m, y_m),
            Source::Time => (2, 0, 0, 0.0, 0.0),
            Source::CostToGoal { plan } => (3, plan, 0, 0.0, 0.0),
            Source::PriceOfConstraint { plan, layer } => (4, plan, u16::from(layer), 0.0, 0.0),
            Source::Output(output) => (5, u16::from(output), 0, 0.0, 0.0),
            Source::Rules(rules) => (6, rules, 0, 0.0, 0.0),
        };
        w.u8(tag).u16(a).u16(b).f32(x).f32(y);
        w.f32(self.low).f32(self.high).u32(self.hold_ms).f32(self.missing);
    }
}

impl Record for Name {
    const SIZE: usize = 3;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self { offset: r.u16()?, length: r.u8()? })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        w.u16(self.offset).u8(self.length);
    }
}

impl Record for Rule {
    const SIZE: usize = 5;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self { input: r.u8()?, labels: Row::unpack(r.u32()?)? })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        w.u8(self.input).u32(self.labels.0);
    }
}

impl Record for RuleBase {
    const SIZE: usize = 4;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        let (first, count) = (r.u16()?, r.u8()?);
        let inference = match r.u8()? {
            0 => Inference::Min,
            1 => Inference::Product,
            _ => return None,
        };
        Some(Self { first, count, inference })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        w.u16(self.first).u8(self.count).u8(u8::from(self.inference == Inference::Product));
    }
}

impl Record for Condition {
    const SIZE: usize = 16;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self { must: r.u64()?, must_not: r.u64()? })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        w.u64(self.must).u64(self.must_not);
    }
}

impl Record for Fact {
    const SIZE: usize = 20;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        let name = Name::decode(r)?;
        let (tag, a, b, c, d) = (r.u8()?, r.u32()?, r.f32()?, r.f32()?, r.f32()?);
        let kind = match tag {
            0 => FactKind::Symbol { is_set: a != 0 },
            1 => FactKind::Level { input: a as u8, low: b, high: c },
            2 => FactKind::Near { x_m: f32::from_bits(a), y_m: b, radius_m: c },
            3 => FactKind::Inside { west_m: f32::from_bits(a), south_m: b, east_m: c, north_m: d },
            4 => FactKind::NoProgress { within_ms: a, distance_m: b },
            _ => return None,
        };
        Some(Self { name, kind })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        self.name.encode(w);
        let (tag, a, b, c, d) = match self.kind {
            FactKind::Symbol { is_set } => (0, u32::from(is_set), 0.0, 0.0, 0.0),
            FactKind::Level { input, low, high } => (1, u32::from(input), low, high, 0.0),
            FactKind::Near { x_m, y_m, radius_m } => (2, x_m.to_bits(), y_m, radius_m, 0.0),
            FactKind::Inside { west_m, south_m, east_m, north_m } => {
                (3, west_m.to_bits(), south_m, east_m, north_m)
            }
            FactKind::NoProgress { distance_m, within_ms } => (4, within_ms, distance_m, 0.0, 0.0),
        };
        w.u8(tag).u32(a).f32(b).f32(c).f32(d);
    }
}

impl Record for Description {
    const SIZE: usize = 72;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            initial: Condition::decode(r)?,
            transient: Condition::decode(r)?,
            goal: Condition::decode(r)?,
            add: r.u64()?,
            delete: r.u64()?,
            max_speed_mps: r.f32()?,
            min_distance_m: r.f32()?,
        })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        self.initial.encode(w);
        self.transient.encode(w);
        self.goal.encode(w);
        w.u64(self.add).u64(self.delete).f32(self.max_speed_mps).f32(self.min_distance_m);
    }
}

impl Record for Action {
    const SIZE: usize = 44;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        let name = Name::decode(r)?;
        let (tag, a, x, y, z) = (r.u8()?, r.u32()?, r.f32()?, r.f32()?, r.f32()?);
        let kind = match tag {
            0 => ActionKind::Follow { plan: a as u16, reactive: x, advice: y, noise: z },
            1 => ActionKind::GoTo { x_m: x, y_m: y },
            2 => ActionKind::Hold { for_ms: a },
            3 => ActionKind::Wander { for_ms: a },
            4 => ActionKind::Signal { code: a as u16 },
            5 => ActionKind::SetOutput { output: a as u8, is_on: x > 0.0 },
            _ => return None,
        };
        Some(Self {
            name,
            kind,
            description: r.u16()?,
            until: Condition::decode(r)?,
            timeout_ms: r.u32()?,
            resources: r.u16()?,
        })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        self.name.encode(w);
        let (tag, a, x, y, z) = match self.kind {
            ActionKind::Follow { plan, reactive, advice, noise } => {
                (0, u32::from(plan), reactive, advice, noise)
            }
            ActionKind::GoTo { x_m, y_m } => (1, 0, x_m, y_m, 0.0),
            ActionKind::Hold { for_ms } => (2, for_ms, 0.0, 0.0, 0.0),
            ActionKind::Wander { for_ms } => (3, for_ms, 0.0, 0.0, 0.0),
            ActionKind::Signal { code } => (4, u32::from(code), 0.0, 0.0, 0.0),
            ActionKind::SetOutput { output, is_on } => {
                (5, u32::from(output), f32::from(u8::from(is_on)), 0.0, 0.0)
            }
        };
        w.u8(tag).u32(a).f32(x).f32(y).f32(z).u16(self.description);
        self.until.encode(w);
        w.u32(self.timeout_ms).u16(self.resources);
    }
}

impl Record for PlanFrame {
    const SIZE: usize = 30;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            name: Name::decode(r)?,
            first: r.u16()?,
            count: r.u8()?,
            description: r.u16()?,
            threshold: r.f32()?,
            may_add: r.u64()?,
            may_delete: r.u64()?,
            resources: r.u16()?,
        })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        self.name.encode(w);
        w.u16(self.first).u8(self.count).u16(self.description).f32(self.threshold);
        w.u64(self.may_add).u64(self.may_delete).u16(self.resources);
    }
}

impl Record for Production {
    const SIZE: usize = 12;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            name: Name::decode(r)?,
            rules: r.optional_u16()?,
            first_edge: r.u16()?,
            edges: r.u8()?,
            vertices: r.u8()?,
            first_interval: r.u16()?,
            intervals: r.u8()?,
        })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        self.name.encode(w);
        w.optional_u16(self.rules).u16(self.first_edge).u8(self.edges).u8(self.vertices);
        w.u16(self.first_interval).u8(self.intervals);
    }
}

impl Record for Edge {
    const SIZE: usize = 7;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        let (from, to, tag, index, work) = (r.u8()?, r.u8()?, r.u8()?, r.u16()?, r.u16()?);
        let symbol = match tag {
            0 => Symbol::Frame(index),
            1 => Symbol::Action(index),
            _ => return None,
        };
        Some(Self { from, to, symbol, work })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        let (tag, index) = match self.symbol {
            Symbol::Frame(index) => (0, index),
            Symbol::Action(index) => (1, index),
        };
        w.u8(self.from).u8(self.to).u8(tag).u16(index).u16(self.work);
    }
}

impl Record for Interval {
    const SIZE: usize = 19;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            from: r.u8()?,
            to: r.u8()?,
            is_derived: r.u8()? != 0,
            condition: Condition::decode(r)?,
        })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        w.u8(self.from).u8(self.to).u8(u8::from(self.is_derived));
        self.condition.encode(w);
    }
}

impl Record for Behaviour {
    const SIZE: usize = 30;

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            name: Name::decode(r)?,
            root: r.u16()?,
            start_up: r.optional_u16()?,
            shut_down: r.optional_u16()?,
            rules: r.u16()?,
            dormant: r.f32()?,
            unconditional: r.f32()?,
            hysteresis: r.f32()?,
            dwell_ms: r.u32()?,
            switch_point: match r.u8()? {
                0 => SwitchPoint::Earliest,
                1 => SwitchPoint::Best,
                _ => return None,
            },
            resources: r.u16()?,
        })
    }

    #[cfg(feature = "std")]
    fn encode(&self, w: &mut super::bytes::Writer) {
        self.name.encode(w);
        w.u16(self.root).optional_u16(self.start_up).optional_u16(self.shut_down).u16(self.rules);
        w.f32(self.dormant).f32(self.unconditional).f32(self.hysteresis).u32(self.dwell_ms);
        w.u8(u8::from(self.switch_point == SwitchPoint::Best)).u16(self.resources);
    }
}
