//! The behaviour tables of a mission file, with names that are not looked up yet.
//!
//! Each list has the order of the file, which is also the order of the blob's records.

use super::graph_text::{Graph, tidy};
use crate::toml::{Span, Spanned, Text};
use maps::problem::{Problem, Source};
use plan_format::mission::{Inference, Label, Mates, SwitchPoint};
use plan_format::parameters::Gains;
use std::sync::Arc;

/// The behaviour tables of a mission file; all lists are empty if it has none.
#[derive(Clone, Debug, Default)]
pub struct Syntax {
    /// The file; `None` if it has none of these tables.
    pub source: Option<Arc<Source>>,
    /// Aspects of interest.
    pub inputs: Vec<Input>,
    /// Propositions.
    pub facts: Vec<Fact>,
    /// Atomic actions.
    pub actions: Vec<Action>,
    /// Plan frames.
    pub frames: Vec<PlanFrame>,
    /// Behaviours.
    pub behaviours: Vec<Behaviour>,
    /// Names of definitions that could not be understood; references to them are not reported.
    pub broken: Vec<String>,
    /// The same for definitions with parameters, without their brackets.
    pub broken_templates: Vec<String>,
    /// The names in `[goals]` and `[layers]`, wrong or not. After a mistake there, references to
    /// them are not reported.
    pub of_map: Vec<String>,
    /// Warnings of parametrised definitions that are never used. They count only in a mission
    /// without errors: a mistake may hide a use.
    pub unused: Vec<Problem>,
}

impl Syntax {
    /// Whether the definition of a name could not be understood.
    pub fn is_broken(&self, name: &str) -> bool {
        let template = name.split_once('(').map(|(template, _)| template.trim());
        let is_template = |known: &String| Some(known.as_str()) == template;
        self.broken.iter().any(|known| known == name)
            || self.broken_templates.iter().any(is_template)
    }

    /// Keeps the name of a definition that could not be understood.
    pub fn keep_broken(&mut self, name: &str) {
        self.broken.push(tidy(name.trim()).into_owned());
        let template = name.split_once('(').map(|(template, _)| template.trim().to_owned());
        self.broken_templates.extend(template);
    }

    /// The places to which actions drive without a plan: the name of each action, and the place,
    /// map metres.
    pub fn places(&self) -> impl Iterator<Item = (&Text, [f32; 2])> {
        self.actions.iter().filter_map(|action| match action.kind {
            Doing::GoTo(place) | Doing::Dock { at: place, .. } => Some((&action.name, place)),
            _ => None,
        })
    }

    /// Gives every action that follows a plan other weights of reactive schemas and advice, as
    /// experiments do that compare them.
    pub fn weigh(&mut self, gains: &Gains) {
        for action in &mut self.actions {
            if let Doing::Follow { reactive, advice, .. } = &mut action.kind {
                (*reactive, *advice) = (gains.reactive, gains.plan);
            }
        }
    }
}

/// An aspect of interest.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its name.
    pub name: Text,
    /// Where its value comes from.
    pub source: InputSource,
    /// The values that are fully NB and fully PB.
    pub universe: [f32; 2],
    /// How long the last value replaces a missing one, milliseconds.
    pub hold_ms: u32,
    /// The value used after that.
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
    /// What a tank still gives, less the cost to the goal of a plan, metres.
    RangeLeft {
        /// The plan.
        plan: Text,
        /// The channel of the tank.
        channel: u8,
        /// What a full tank gives, metres.
        full_m: f32,
    },
    /// Price of a layer's constraint: plan and layer.
    Price(Text, Text),
    /// A digital output.
    Output(u8),
    /// The result of rules over other inputs.
    Rules(Rules),
    /// Number of mates to which the link is up.
    MatesLinked,
    /// Age of the oldest news of all mates, seconds.
    OldestNews,
    /// Distance to the nearest of these mates, one bit each, metres.
    MateDistance(u8),
    /// Quality of the link to a mate, by its number.
    MateLink(u8),
}

/// A rule base: a row of labels for each input and each fact.
#[derive(Clone, Debug)]
pub struct Rules {
    /// Each input or fact with its row.
    pub rows: Vec<(Text, Row)>,
    /// How the rules' consequences are limited.
    pub inference: Inference,
    /// Where it is written.
    pub span: Span,
}

/// The results of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Row {
    /// For each label of an input.
    OfInput([Label; 7]),
    /// For a fact that does not hold, and for one that holds.
    OfFact([Label; 2]),
}

/// A proposition.
#[derive(Clone, Debug)]
pub struct Fact {
    /// Its name.
    pub name: Text,
    /// Its condition.
    pub kind: FactSyntax,
}

/// The condition of a fact.
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
    /// The links to mates are up.
    Linked(Mates),
    /// Mates are near the robot.
    MateNear {
        /// Which mates.
        mates: Mates,
        /// Distance, metres.
        radius_m: f32,
    },
    /// Mates are near a place.
    MateAt {
        /// Which mates.
        mates: Mates,
        /// The place, metres.
        at: [f32; 2],
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
    /// The robot has not advanced a distance within a time.
    NoProgress {
        /// Distance, metres.
        distance_m: f32,
        /// Time, milliseconds.
        within_ms: u32,
    },
}

/// A fact that must hold, or must not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Literal {
    /// The fact.
    pub fact: Text,
    /// Whether it must not hold.
    pub is_negated: bool,
}

/// The description of a component: conditions, effects and limits.
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
    Follow {
        plan: Text,
        reactive: f32,
        advice: f32,
    },
    GoTo([f32; 2]),
    Hold {
        for_ms: u32,
    },
    /// As `Hold`, without the resource `motion`: it says nothing about how the robot moves.
    Wait {
        for_ms: u32,
    },
    Wander {
        for_ms: u32,
    },
    Signal {
        code: u16,
    },
    SetOutput {
        output: u8,
        is_on: bool,
    },
    Return,
    MoveAhead {
        direction_rad: f32,
        for_ms: u32,
    },
    Dock {
        at: [f32; 2],
        direction_rad: f32,
        radius_cm: u16,
    },
}

/// A plan frame.
#[derive(Clone, Debug)]
pub struct PlanFrame {
    /// Its name.
    pub name: Text,
    /// Its conditions, effects and limits.
    pub description: Description,
    /// Productions below this applicability are not considered.
    pub threshold: Spanned<f32>,
    /// It ends as soon as this holds.
    pub until: Vec<Literal>,
    /// It fails after this time, milliseconds; 0 for never.
    pub timeout_ms: u32,
    /// The alternative ways to carry it out.
    pub productions: Vec<Production>,
}

/// One way to carry out a frame.
#[derive(Clone, Debug)]
pub struct Production {
    /// Its name.
    pub name: Text,
    /// The rules of its applicability; `None` if it is always applicable.
    pub rules: Option<Rules>,
    /// Its components.
    pub graph: Graph,
    /// The text of the graph.
    pub text: Text,
    /// Protection intervals written in the mission.
    pub protect: Vec<Text>,
    /// Work lost by an interruption right after a component.
    pub work: Vec<(Text, u16)>,
}

/// A behaviour.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// Its name.
    pub name: Text,
    /// Its plan: a frame.
    pub root: Text,
    /// The frame that runs before it is engaged or resumed.
    pub start_up: Option<Text>,
    /// The frame that runs before it is conditionally put to sleep.
    pub shut_down: Option<Text>,
    /// Its criticality.
    pub rules: Rules,
    /// Dormant up to this criticality.
    pub dormant: Spanned<f32>,
    /// Engaged at once from this criticality.
    pub unconditional: Spanned<f32>,
    /// How much more critical another behaviour must be to take over.
    pub hysteresis: f32,
    /// Not interrupted conditionally within this time, milliseconds.
    pub dwell_ms: u32,
    /// The switching point at which it yields.
    pub switch_point: SwitchPoint,
    /// Whether it is never engaged again after its plan has finished.
    pub once: bool,
    /// Resources that it occupies in addition to those of its actions.
    pub resources: Vec<Text>,
}
