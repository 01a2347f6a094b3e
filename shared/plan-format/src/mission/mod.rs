//! The mission: behaviours, their plans as graph grammars, and the fuzzy rules that choose.
//!
//! Source: Hasemann, "Planning, Behaviours, Decomposition, and Monitoring Using Graph Grammars
//! and Fuzzy Logic" (H). The section holds one table for each kind of record. [`Mission::parse`]
//! checks every record and every reference; after that, the tables are read in place and no look-up
//! fails.
//!
//! Invariants after parsing: each rule base has rules and uses the results of earlier rule bases
//! only; each production is a directed acyclic graph, and each of its edges lies on a path from the
//! entry (vertex 0) to the exit (the last vertex); each number is finite or means "no constraint".

mod behaviours;
mod check;
mod components;
#[cfg(feature = "std")]
mod draft;
#[cfg(feature = "std")]
pub mod effects;
mod facts;
mod productions;
mod rules;

pub use crate::names::Name;
pub use crate::record::Table;
pub use behaviours::{Behaviour, SwitchPoint};
pub use check::MissionError;
pub use components::{Action, ActionKind, Description, PlanFrame};
#[cfg(feature = "std")]
pub use draft::MissionDraft;
pub use facts::{Condition, Fact, FactKind, Facts, Mates};
pub use productions::{Edge, Interval, Production, Symbol};
pub use rules::{Inference, Input, Label, Row, Rule, RuleBase, Source};

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The tables as they are stored.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, Schema)]
pub(crate) struct Sections<'a> {
    pub(crate) inputs: &'a [u8],
    pub(crate) rules: &'a [u8],
    pub(crate) rule_bases: &'a [u8],
    pub(crate) facts: &'a [u8],
    pub(crate) descriptions: &'a [u8],
    pub(crate) actions: &'a [u8],
    pub(crate) frames: &'a [u8],
    pub(crate) productions: &'a [u8],
    pub(crate) edges: &'a [u8],
    pub(crate) intervals: &'a [u8],
    pub(crate) behaviours: &'a [u8],
    pub(crate) names: &'a [u8],
}

/// A view of the mission's tables. Without behaviours all of them are empty.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mission<'a>(Sections<'a>);

impl<'a> Mission<'a> {
    /// Reads the mission section of a blob and checks all of it. An empty section is a mission
    /// without behaviours.
    pub fn parse(section: &'a [u8]) -> Result<Self, MissionError> {
        if section.is_empty() {
            return Ok(Self::default());
        }
        let (sections, rest) =
            postcard::take_from_bytes(section).map_err(|_| MissionError::Tables)?;
        let mission = Self(sections);
        if rest.is_empty() {
            check::check(&mission).map(|()| mission)
        } else {
            Err(MissionError::Tables)
        }
    }

    /// Aspects of interest.
    pub fn inputs(&self) -> Table<'a, Input> {
        Table::new(self.0.inputs)
    }

    /// Rows of the rule bases.
    pub fn rules(&self) -> Table<'a, Rule> {
        Table::new(self.0.rules)
    }

    /// Rule bases of criticalities, applicabilities and inputs.
    pub fn rule_bases(&self) -> Table<'a, RuleBase> {
        Table::new(self.0.rule_bases)
    }

    /// Propositions; the index is the bit in [`Facts`].
    pub fn facts(&self) -> Table<'a, Fact> {
        Table::new(self.0.facts)
    }

    /// Descriptions of plan frames and actions.
    pub fn descriptions(&self) -> Table<'a, Description> {
        Table::new(self.0.descriptions)
    }

    /// Atomic actions.
    pub fn actions(&self) -> Table<'a, Action> {
        Table::new(self.0.actions)
    }

    /// Plan frames.
    pub fn plan_frames(&self) -> Table<'a, PlanFrame> {
        Table::new(self.0.frames)
    }

    /// Productions, grouped by plan frame.
    pub fn productions(&self) -> Table<'a, Production> {
        Table::new(self.0.productions)
    }

    /// Edges, grouped by production.
    pub fn edges(&self) -> Table<'a, Edge> {
        Table::new(self.0.edges)
    }

    /// Protection intervals, grouped by production.
    pub fn intervals(&self) -> Table<'a, Interval> {
        Table::new(self.0.intervals)
    }

    /// Behaviours.
    pub fn behaviours(&self) -> Table<'a, Behaviour> {
        Table::new(self.0.behaviours)
    }

    /// The rules of a rule base.
    pub fn rules_of(&self, base: &RuleBase) -> impl Iterator<Item = Rule> + use<'a> {
        self.rules().range(base.first, base.count)
    }

    /// The productions of a plan frame, in the order of their numbers.
    pub fn productions_of(&self, frame: &PlanFrame) -> impl Iterator<Item = Production> + use<'a> {
        self.productions().range(frame.first, frame.count)
    }

    /// The edges of a production, in the order of their numbers.
    pub fn edges_of(&self, production: &Production) -> impl Iterator<Item = Edge> + use<'a> {
        self.edges().range(production.first_edge, production.edges)
    }

    /// The protection intervals of a production.
    pub fn intervals_of(
        &self,
        production: &Production,
    ) -> impl Iterator<Item = Interval> + use<'a> {
        self.intervals().range(production.first_interval, production.intervals)
    }

    /// The text of a name; empty if it is out of range.
    pub fn name(&self, name: Name) -> &'a str {
        name.text(self.0.names).unwrap_or("")
    }

    /// The description of a plan frame or an action.
    #[inline]
    pub fn description(&self, symbol: Symbol) -> Option<Description> {
        let index = match symbol {
            Symbol::PlanFrame(index) => self.plan_frames().get(usize::from(index))?.description,
            Symbol::Action(index) => self.actions().get(usize::from(index))?.description,
        };
        self.descriptions().get(usize::from(index))
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::record::Record;

    /// One behaviour. Its plan frame `work` has two productions: two parallel `step`s and then
    /// `work` again, or one `step`.
    fn draft() -> MissionDraft {
        let mut draft = MissionDraft::default();
        let name = draft.name("fuel");
        draft.inputs.push(Input {
            name,
            source: Source::DistanceTo { x_m: 1.5, y_m: -2.0 },
            low: 0.0,
            high: 1.0,
            hold_ms: 500,
            missing: 0.25,
        });
        use Label::{NB, NM, NS, PB, PM, PS, ZO};
        draft.rules.push(Rule { input: 0, labels: [NB, NM, NS, ZO, PS, PM, PB].into() });
        draft.rule_bases.push(RuleBase { first: 0, count: 1, inference: Inference::Product });
        let name = draft.name("on field");
        let kind = FactKind::Inside { west_m: -1.0, south_m: 0.0, east_m: 9.0, north_m: 5.0 };
        draft.facts.push(Fact { name, kind });
        draft.descriptions.push(Description {
            initial: Condition { must: 1, must_not: 0 },
            transient: Condition::default(),
            goal: Condition { must: 0, must_not: 2 },
            add: 4,
            delete: 8,
            max_speed_mps: f32::INFINITY,
            min_distance_m: 0.5,
        });
        let name = draft.name("step");
        draft.actions.push(Action {
            name,
            kind: ActionKind::Follow { plan: 3, reactive: 0.34, advice: 0.66, noise: 0.11 },
            description: 0,
            until: Condition { must: 1 << 63, must_not: 0 },
            timeout_ms: 60_000,
            resources: 1,
        });
        let name = draft.name("work");
        draft.frames.push(PlanFrame {
            name,
            first: 0,
            count: 2,
            description: 0,
            threshold: 0.2,
            until: Condition { must: 0, must_not: 1 << 62 },
            timeout_ms: 70_000,
            may_add: 4,
            may_delete: 8,
            resources: 1,
        });
        let mut production = Production {
            name,
            rules: Some(0),
            first_edge: 0,
            edges: 3,
            vertices: 3,
            first_interval: 0,
            intervals: 1,
        };
        draft.productions.push(production);
        (production.rules, production.first_edge, production.edges) = (None, 3, 1);
        (production.vertices, production.intervals) = (2, 0);
        draft.productions.push(production);
        for (from, to, symbol) in [
            (0, 1, Symbol::Action(0)),
            (0, 1, Symbol::Action(0)),
            (1, 2, Symbol::PlanFrame(0)),
            (0, 1, Symbol::Action(0)),
        ] {
            draft.edges.push(Edge { from, to, symbol, work: 7 });
        }
        let condition = Condition { must: 1, must_not: 0 };
        draft.intervals.push(Interval { from: 0, to: 1, condition, is_derived: true });
        let name = draft.name("working");
        draft.behaviours.push(Behaviour {
            name,
            root: 0,
            start_up: None,
            shut_down: Some(0),
            rules: 0,
            dormant: 1.0 / 12.0,
            unconditional: 0.9,
            hysteresis: 0.05,
            dwell_ms: 1_000,
            switch_point: SwitchPoint::Best,
            once: true,
            resources: 1,
        });
        draft
    }

    #[test]
    fn every_record_comes_back_as_it_was() {
        let draft = draft();
        let bytes = draft.write().unwrap();
        let mission = Mission::parse(&bytes).unwrap();
        assert!(mission.inputs().iter().eq(draft.inputs));
        assert!(mission.rules().iter().eq(draft.rules));
        assert!(mission.rule_bases().iter().eq(draft.rule_bases));
        assert!(mission.facts().iter().eq(draft.facts));
        assert!(mission.descriptions().iter().eq(draft.descriptions));
        assert!(mission.actions().iter().eq(draft.actions));
        assert!(mission.plan_frames().iter().eq(draft.frames));
        assert!(mission.productions().iter().eq(draft.productions));
        assert!(mission.edges().iter().eq(draft.edges));
        assert!(mission.intervals().iter().eq(draft.intervals));
        assert!(mission.behaviours().iter().eq(draft.behaviours));
        assert_eq!(mission.name(mission.plan_frames().get(0).unwrap().name), "work");
    }

    /// The bytes of every kind of record, as the first writer of the format wrote them.
    #[test]
    fn every_record_has_the_bytes_of_the_format() {
        let mut draft = draft();
        let name = draft.inputs[0].name;
        let input = draft.inputs[0];
        let sources = [
            Source::Channel(7),
            Source::Time,
            Source::CostToGoal { plan: 300 },
            Source::PriceOfConstraint { plan: 301, layer: 2 },
            Source::RangeLeft { plan: 302, channel: 1, full_m: 400.5 },
            Source::Output(15),
            Source::Rules(0),
            Source::Fact(0),
        ];
        draft.inputs.extend(sources.map(|source| Input { source, ..input }));
        let facts = [
            FactKind::Symbol { is_set: true },
            FactKind::Level { input: 1, low: 0.5, high: 2.5 },
            FactKind::Near { x_m: 3.0, y_m: 4.0, radius_m: 5.0 },
            FactKind::NoProgress { distance_m: 6.0, within_ms: 70_000 },
        ];
        draft.facts.extend(facts.map(|kind| Fact { name, kind }));
        let action = draft.actions[0];
        let actions = [
            ActionKind::GoTo { x_m: -8.0, y_m: 9.0 },
            ActionKind::Hold { for_ms: 100_000 },
            ActionKind::Wander { for_ms: 110_000 },
            ActionKind::Signal { code: 1_200 },
            ActionKind::SetOutput { output: 13, is_on: true },
            ActionKind::Return,
            ActionKind::MoveAhead { direction_rad: 1.5, for_ms: 120_000 },
            ActionKind::Dock { x_m: 10.0, y_m: -11.0, direction_rad: -2.5, radius_cm: 1_300 },
        ];
        draft.actions.extend(actions.map(|kind| Action { kind, ..action }));
        assert_eq!(crate::seal::crc32(&[&draft.write().unwrap()], || ()), 2_692_678_425);
    }

    #[test]
    fn bytes_that_no_writer_writes_are_refused() {
        let input = Input { source: Source::Channel(7), ..draft().inputs[0] };
        let mut bytes = Vec::new();
        input.encode(&mut bytes);
        assert!(Table::<Input>::new(&bytes).is_sound());
        // After the name: tag, low and high byte of the channel, then unused bytes.
        for unused in 5..16 {
            let mut bytes = bytes.clone();
            bytes[unused] = 1;
            let table = Table::<Input>::new(&bytes);
            assert_eq!(table.get(0), Some(input), "reading is lenient");
            assert!(!table.is_sound(), "byte {unused}");
        }
        let mut derived = Vec::new();
        draft().intervals[0].encode(&mut derived);
        derived[2] = 2;
        assert!(!Table::<Interval>::new(&derived).is_sound());
        assert!(!Table::<Input>::new(&bytes[..31]).is_sound(), "a partial record");
    }

    #[test]
    fn what_cannot_be_run_is_refused() {
        let refused = |change: &dyn Fn(&mut MissionDraft)| {
            let mut draft = draft();
            change(&mut draft);
            draft.write().unwrap_err()
        };
        assert_eq!(refused(&|d| d.edges[0].to = 0), MissionError::Graph);
        assert_eq!(refused(&|d| d.edges[2].to = 3), MissionError::Graph);
        assert_eq!(refused(&|d| d.edges[2].from = 0), MissionError::Graph);
        assert_eq!(refused(&|d| d.edges[0].symbol = Symbol::Action(1)), MissionError::Reference);
        assert_eq!(refused(&|d| d.inputs[0].high = f32::NAN), MissionError::Number);
        assert_eq!(refused(&|d| d.inputs[0].high = 0.0), MissionError::Number);
        assert_eq!(refused(&|d| d.actions[0].timeout_ms = 0), MissionError::Number);
        assert_eq!(refused(&|d| d.behaviours[0].root = 1), MissionError::Reference);
        assert_eq!(refused(&|d| d.frames[0].count = 3), MissionError::Reference);
        assert_eq!(refused(&|d| d.inputs[0].source = Source::Rules(0)), MissionError::Reference);
        assert_eq!(refused(&|d| d.inputs[0].source = Source::Channel(8)), MissionError::Number);
        assert_eq!(refused(&|d| d.inputs[0].source = Source::Output(16)), MissionError::Number);
        assert_eq!(refused(&|d| d.inputs[0].source = Source::Fact(1)), MissionError::Reference);
        let name = Name { offset: 500, length: 2 };
        assert_eq!(refused(&|d| d.actions[0].name = name), MissionError::Name);
        // Three rows that 64 rule bases share are 192 evaluations.
        let shared = |d: &mut MissionDraft| {
            d.rules = vec![d.rules[0]; 3];
            d.rule_bases = vec![RuleBase { count: 3, ..d.rule_bases[0] }; 64];
        };
        assert_eq!(refused(&shared), MissionError::TooLarge);
        let many = |d: &mut MissionDraft| d.behaviours = vec![d.behaviours[0]; 17];
        assert_eq!(refused(&many), MissionError::TooLarge);
    }

    #[test]
    fn more_facts_about_progress_than_the_robot_can_track_are_refused() {
        let with = |count: usize| {
            let mut draft = draft();
            let kind = FactKind::NoProgress { distance_m: 1.0, within_ms: 1_000 };
            draft.facts.extend(vec![Fact { kind, ..draft.facts[0] }; count]);
            draft.write().map(|_| ())
        };
        assert_eq!(with(4), Ok(()));
        assert_eq!(with(5), Err(MissionError::TooLarge));
    }

    #[test]
    fn names_beyond_the_limits_are_an_error() {
        use crate::limits::{MAX_MISSION_NAMES_BYTES, MAX_NAME_BYTES};
        let named = |name: &dyn Fn(&mut MissionDraft) -> Name| {
            let mut draft = draft();
            draft.actions[0].name = name(&mut draft);
            draft.write().map(|_| ())
        };
        assert_eq!(named(&|d| d.name(&"n".repeat(MAX_NAME_BYTES))), Ok(()));
        assert_eq!(named(&|d| d.name(&"n".repeat(MAX_NAME_BYTES + 1))), Err(MissionError::Name));
        let after = |names: usize| {
            move |d: &mut MissionDraft| {
                (0..names).for_each(|number| _ = d.name(&format!("{number:0MAX_NAME_BYTES$}")));
                d.name("one more")
            }
        };
        let most = MAX_MISSION_NAMES_BYTES / MAX_NAME_BYTES;
        assert_eq!(named(&after(most - 2)), Ok(()));
        // More bytes than an offset can count.
        assert_eq!(named(&after(3_000)), Err(MissionError::Name));
    }

    #[test]
    fn no_bytes_make_the_reader_panic() {
        let bytes = draft().write().unwrap();
        for length in 1..bytes.len() {
            assert!(Mission::parse(&bytes[..length]).is_err(), "cut to {length}");
        }
        for bit in 0..bytes.len() * 8 {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            // The blob's checksum catches flips; this test is only about panics.
            if let Ok(mission) = Mission::parse(&flipped) {
                assert_eq!(mission.behaviours().len(), 1);
            }
        }
    }
}
