//! What a mission file says about behaviours, names not yet looked up.
//!
//! The order of each list is the order of the file, and the order of the records later.

use super::graph_text::Graph;
use crate::toml::{Span, Spanned, Text};
use maps::problem::Source;
use plan_format::mission::{Inference, Label, SwitchPoint};
use std::sync::Arc;

/// The behaviours of a mission file; without any, all lists are empty.
#[derive(Clone, Debug, Default)]
pub struct Syntax {
    /// The file; `None` where it says nothing about behaviours.
    pub source: Option<Arc<Source>>,
    /// Aspects of interest.
    pub inputs: Vec<Input>,
    /// Propositions.
    pub facts: Vec<Fact>,
    /// Atomic actions.
    pub actions: Vec<Action>,
    /// Plan frames.
    pub frames: Vec<Frame>,
    /// Behaviours.
    pub behaviours: Vec<Behaviour>,
    /// Names of definitions that could not be understood: what refers to them is not to blame.
    pub broken: Vec<String>,
}

/// An aspect of interest.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its name.
    pub name: Text,
    /// Where its value comes from.
    pub source: InputSource,
    /// The values that are wholly NB and wholly PB.
    pub universe: [f32; 2],
    /// For how long the last value stands in for a missing one, milliseconds.
    pub hold_ms: u32,
    /// What a missing value counts as after that.
    pub missing: f32,
}

/// Where the value of an input comes from.
#[derive(Clone, Debug)]
pub enum InputSource {
    /// A channel of the percepts.
    Channel(u8),
    /// Distance to a place, metres.
    DistanceTo([f32; 2]),
    /// Seconds since start.
    Time,
    /// Cost to the goal of a parallel plan.
    CostToGoal(Text),
    /// Price of a layer's constraint: plan and layer.
    Price(Text, Text),
    /// A digital output.
    Output(u8),
    /// The result of rules about other inputs.
    Rules(Rules),
}

/// A rule base: a row of seven labels for each input.
#[derive(Clone, Debug)]
pub struct Rules {
    /// Each input with its row.
    pub rows: Vec<(Text, [Label; 7])>,
    /// How consequences are cut.
    pub inference: Inference,
    /// Where it is written.
    pub span: Span,
}

/// A proposition.
#[derive(Clone, Debug)]
pub struct Fact {
    /// Its name.
    pub name: Text,
    /// What it says.
    pub kind: FactSyntax,
}

/// What a fact says.
#[derive(Clone, Debug)]
pub enum FactSyntax {
    /// Set and cleared by components.
    Symbol {
        /// Whether it holds at the start.
        is_set: bool,
    },
    /// An input lies between two values.
    Level {
        /// The input.
        input: Text,
        /// Lowest.
        low: f32,
        /// Highest.
        high: f32,
    },
    /// The robot is near a place.
    Near {
        /// The place, metres.
        at: [f32; 2],
        /// Distance, metres.
        radius_m: f32,
    },
    /// The robot is in a rectangle: west, south, east, north, metres.
    Inside([f32; 4]),
    /// The robot has not come farther within a time.
    NoProgress {
        /// Distance, metres.
        distance_m: f32,
        /// Time, milliseconds.
        within_ms: u32,
    },
}

/// A fact that shall hold, or shall not.
#[derive(Clone, Debug, PartialEq)]
pub struct Literal {
    /// The fact.
    pub fact: Text,
    /// Whether it shall not hold.
    pub is_negated: bool,
}

/// What a component needs, keeps and brings about.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs, reason = "as in `plan_format::mission::Description`")]
pub struct Description {
    pub initial: Vec<Literal>,
    pub transient: Vec<Literal>,
    pub goal: Vec<Literal>,
    pub add: Vec<Text>,
    pub delete: Vec<Text>,
    pub max_speed_mps: Option<f32>,
    pub min_distance_m: f32,
}

/// An atomic action.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "as in `plan_format::mission::Action`")]
pub struct Action {
    pub name: Text,
    pub kind: Doing,
    pub description: Description,
    pub until: Vec<Literal>,
    pub timeout_ms: u32,
    pub resources: Vec<Text>,
}

/// What an action does.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "as in `plan_format::mission::ActionKind`")]
pub enum Doing {
    Follow { plan: Text, reactive: f32, advice: f32 },
    GoTo([f32; 2]),
    Hold { for_ms: u32 },
    Wander { for_ms: u32 },
    Signal { code: u16 },
    SetOutput { output: u8, is_on: bool },
}

/// A plan frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its name.
    pub name: Text,
    /// What it needs, keeps and brings about.
    pub description: Description,
    /// Productions below this applicability are not considered.
    pub threshold: Spanned<f32>,
    /// The ways to carry it out.
    pub productions: Vec<Production>,
}

/// One way to carry out a frame.
#[derive(Clone, Debug)]
pub struct Production {
    /// Its name.
    pub name: Text,
    /// How applicable it is; `None` for always.
    pub rules: Option<Rules>,
    /// Its components.
    pub graph: Graph,
    /// The text of the graph.
    pub text: Text,
    /// Protection intervals by hand.
    pub protect: Vec<Text>,
    /// What it costs to interrupt right after a component.
    pub work: Vec<(Text, u16)>,
}

/// A behaviour.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// Its name.
    pub name: Text,
    /// Its plan: a frame.
    pub root: Text,
    /// The frame that is run before it is engaged or resumed.
    pub start_up: Option<Text>,
    /// The frame that is run before it is put to sleep conditionally.
    pub shut_down: Option<Text>,
    /// Its criticality.
    pub rules: Rules,
    /// Dormant up to this criticality.
    pub dormant: Spanned<f32>,
    /// Engaged at once from this criticality.
    pub unconditional: Spanned<f32>,
    /// How much more critical another must be to take over.
    pub hysteresis: f32,
    /// Not interrupted conditionally within this time, milliseconds.
    pub dwell_ms: u32,
    /// Which switching point it yields at.
    pub switch_point: SwitchPoint,
    /// What it occupies besides what its actions do.
    pub resources: Vec<Text>,
}
