//! From syntax to the blob's tables: turns names into indices and checks limits.

mod components;
mod intervals;

use super::language::unusable;
use super::syntax::{FactSyntax, InputSource, Literal, Row, Rules, Syntax};
use crate::toml::{Report, Span, Text};
use maps::problem::{Problem, Severity, has_errors};
use plan_format::limits;
use plan_format::mission::effects;
use plan_format::mission::{
    Behaviour, Condition, Fact, FactKind, Facts, Input, Label, MissionDraft, Rule, RuleBase, Source,
};

/// The parallel plans that a mission may refer to by name.
#[derive(Clone, Debug)]
pub enum Plans {
    /// These, each with the names of its layers.
    Known(Vec<PlanNames>),
    /// All plans that the mission names. Their numbers are then valid for drawing only.
    Any,
}

/// The names of a parallel plan and its layers, in the order of the blob.
#[derive(Clone, Debug)]
pub struct PlanNames {
    /// The plan.
    pub name: String,
    /// Its layers.
    pub layers: Vec<String>,
}

/// Turns syntax into the blob's tables; `None` after an error.
pub fn lower(syntax: &Syntax, plans: &Plans, problems: &mut Vec<Problem>) -> Option<MissionDraft> {
    let Some(source) = &syntax.source else { return Some(MissionDraft::default()) };
    let before = problems.len();
    let is_map_wrong = has_errors(problems);
    let report = Report { source, problems };
    let mut lowering = Lowering {
        syntax,
        plans,
        is_map_wrong,
        report,
        draft: MissionDraft::default(),
        // `Any` numbers plans by the order in which they are named.
        plans_named: Vec::new(),
        resources: Vec::new(),
        facts_in_rules: Vec::new(),
    };
    if lowering.counts_fit() {
        lowering.facts();
        lowering.inputs();
        lowering.components();
        effects::spread(&mut lowering.draft);
        lowering.intervals();
        lowering.behaviours();
        lowering.inputs_of_facts();
        lowering.tables_fit();
    }
    let draft = lowering.draft;
    let has_error = problems[before..].iter().any(|problem| problem.severity == Severity::Error);
    (!has_error).then_some(draft)
}

struct Lowering<'l> {
    syntax: &'l Syntax,
    plans: &'l Plans,
    /// Whether goals or layers may be missing because of a mistake that has been reported.
    is_map_wrong: bool,
    report: Report<'l>,
    draft: MissionDraft,
    plans_named: Vec<String>,
    resources: Vec<String>,
    /// Facts with rows in rule bases, by index. Each becomes an input after those of the mission.
    facts_in_rules: Vec<usize>,
}

impl Lowering<'_> {
    /// Checks that all tables are small enough for their indices, before any name is looked up.
    fn counts_fit(&mut self) -> bool {
        let syntax = self.syntax;
        let spans = |texts: &mut dyn Iterator<Item = &Text>| -> Vec<Span> {
            texts.map(|text| text.span.clone()).collect()
        };
        let tables = [
            ("inputs", limits::MAX_INPUTS, spans(&mut syntax.inputs.iter().map(|i| &i.name))),
            ("facts", limits::MAX_FACTS, spans(&mut syntax.facts.iter().map(|f| &f.name))),
            ("actions", limits::MAX_ACTIONS, spans(&mut syntax.actions.iter().map(|a| &a.name))),
            ("frames", limits::MAX_FRAMES, spans(&mut syntax.frames.iter().map(|f| &f.name))),
            (
                "behaviours",
                limits::MAX_BEHAVIOURS,
                spans(&mut syntax.behaviours.iter().map(|b| &b.name)),
            ),
        ];
        let mut fit = true;
        for (what, limit, spans) in tables {
            if let Some(first) = spans.get(limit) {
                fit = false;
                let message = format!("the robot has room for {limit} {what}, not {}", spans.len());
                self.report.error(message, first, "one too many", "remove some");
            }
        }
        for action in &syntax.actions {
            if let Some(frame) =
                syntax.frames.iter().find(|frame| frame.name.value == action.name.value)
            {
                let message = format!("`{}` is both an action and a frame", frame.name.as_str());
                self.report.error(message, &frame.name.span, "this frame", "rename one of the two");
            }
        }
        fit
    }

    /// Checks the tables that grow with the contents, at the end.
    fn tables_fit(&mut self) {
        let draft = &self.draft;
        let tables = [
            ("inputs and facts in rules", draft.inputs.len(), limits::MAX_INPUTS),
            ("rules", draft.rules.len(), limits::MAX_RULES),
            ("rule bases", draft.rule_bases.len(), limits::MAX_RULE_BASES),
            ("different descriptions", draft.descriptions.len(), limits::MAX_DESCRIPTIONS),
            ("productions", draft.productions.len(), limits::MAX_PRODUCTIONS),
            ("components in all productions", draft.edges.len(), limits::MAX_EDGES),
            ("protection intervals", draft.intervals.len(), limits::MAX_INTERVALS),
        ];
        for (what, count, limit) in tables {
            if count > limit {
                let message = format!("the robot has room for {limit} {what}, not {count}");
                self.report
                    .problems
                    .push(Problem::error(message).help("remove what the mission does not need"));
            }
        }
    }

    fn facts(&mut self) {
        for fact in &self.syntax.facts {
            let kind = match &fact.kind {
                FactSyntax::Symbol { is_set } => FactKind::Symbol { is_set: *is_set },
                FactSyntax::Level { input, low, high } => FactKind::Level {
                    input: self.input(input).unwrap_or(0),
                    low: *low,
                    high: *high,
                },
                &FactSyntax::Near { at: [x_m, y_m], radius_m } => {
                    FactKind::Near { x_m, y_m, radius_m }
                }
                &FactSyntax::Inside([west_m, south_m, east_m, north_m]) => {
                    FactKind::Inside { west_m, south_m, east_m, north_m }
                }
                &FactSyntax::Linked(mates) => FactKind::Linked(mates),
                &FactSyntax::MateNear { mates, radius_m } => FactKind::MateNear { mates, radius_m },
                &FactSyntax::MateAt { mates, at: [x_m, y_m], radius_m } => {
                    FactKind::MateAt { mates, x_m, y_m, radius_m }
                }
                &FactSyntax::MateSignals { mates, code } => FactKind::MateSignals { mates, code },
                &FactSyntax::NoProgress { distance_m, within_ms } => {
                    FactKind::NoProgress { distance_m, within_ms }
                }
            };
            let name = self.draft.name(fact.name.as_str());
            self.draft.facts.push(Fact { name, kind });
        }
        let is_progress =
            |fact: &&super::syntax::Fact| matches!(fact.kind, FactSyntax::NoProgress { .. });
        let limit = limits::MAX_PROGRESS_FACTS;
        if let Some(fact) = self.syntax.facts.iter().filter(is_progress).nth(limit) {
            let message = format!("the robot supports at most {limit} facts with `no_progress`");
            self.report.error(message, &fact.name.span, "one too many", "remove some");
        }
    }

    /// Inputs, and the rule bases of inputs with rules: each rule base follows those that it
    /// depends on.
    fn inputs(&mut self) {
        let syntax = self.syntax;
        let mut bases: Vec<Option<u16>> = vec![None; syntax.inputs.len()];
        let mut is_derived: Vec<bool> = Vec::new();
        for input in &syntax.inputs {
            is_derived.push(matches!(input.source, InputSource::Rules(_)));
        }
        loop {
            let mut has_grown = false;
            for (index, input) in syntax.inputs.iter().enumerate() {
                let InputSource::Rules(rules) = &input.source else { continue };
                let waits = rules.rows.iter().any(|(name, _)| {
                    let on = syntax.inputs.iter().position(|input| input.name.value == name.value);
                    on.is_some_and(|on| is_derived[on] && bases[on].is_none())
                });
                if bases[index].is_none() && !waits {
                    bases[index] = Some(self.rule_base(rules));
                    has_grown = true;
                }
            }
            if !has_grown {
                break;
            }
        }
        for (index, input) in syntax.inputs.iter().enumerate() {
            let source = match &input.source {
                InputSource::Channel(channel) => Source::Channel(*channel),
                &InputSource::DistanceTo([x_m, y_m]) => Source::DistanceTo { x_m, y_m },
                InputSource::Time => Source::Time,
                InputSource::CostToGoal(plan) => Source::CostToGoal { plan: self.plan(plan) },
                InputSource::RangeLeft { plan, channel, full_m } => {
                    let (plan, channel, full_m) = (self.plan(plan), *channel, *full_m);
                    Source::RangeLeft { plan, channel, full_m }
                }
                InputSource::Price(plan, layer) => {
                    let (plan, layer) = self.layer(plan, layer);
                    Source::PriceOfConstraint { plan, layer }
                }
                InputSource::Output(output) => Source::Output(*output),
                InputSource::MatesLinked => Source::MatesLinked,
                InputSource::OldestNews => Source::OldestNews,
                InputSource::MateDistance(robots) => Source::DistanceToMate(*robots),
                InputSource::MateLink(robot) => Source::LinkToMate(*robot),
                InputSource::Rules(rules) => {
                    if bases[index].is_none() {
                        let message =
                            format!("the rules of `{}` depend on themselves", input.name.as_str());
                        let help = "let an input with rules depend on other inputs only";
                        self.report.error(message, &rules.span, "part of a cycle", help);
                    }
                    Source::Rules(bases[index].unwrap_or(0))
                }
            };
            let name = self.draft.name(input.name.as_str());
            let [low, high] = input.universe;
            let (hold_ms, missing) = (input.hold_ms, input.missing);
            self.draft.inputs.push(Input { name, source, low, high, hold_ms, missing });
        }
    }

    fn rule_base(&mut self, rules: &Rules) -> u16 {
        let first = self.draft.rules.len() as u16;
        for (name, row) in &rules.rows {
            let (input, labels) = match *row {
                Row::OfInput(labels) => (self.input(name).unwrap_or(0), labels),
                Row::OfFact([unless, holds]) => {
                    (self.fact_in_rules(name).unwrap_or(0), of_fact(unless, holds))
                }
            };
            self.draft.rules.push(Rule { input, labels: labels.into() });
        }
        // Rows belong to different inputs, so there are few.
        let count = rules.rows.len().min(usize::from(u8::MAX)) as u8;
        self.draft.rule_bases.push(RuleBase { first, count, inference: rules.inference });
        (self.draft.rule_bases.len() - 1) as u16
    }

    /// The index of the input for a fact with a row.
    fn fact_in_rules(&mut self, name: &Text) -> Option<u8> {
        let syntax = self.syntax;
        let Some(fact) = syntax.facts.iter().position(|fact| fact.name.value == name.value) else {
            if syntax.inputs.iter().any(|input| input.name.value == name.value) {
                let message = format!("the row of the input `{}` has two labels", name.as_str());
                let label = "an input has seven, a fact has two";
                let help = "write a label for each of NB NM NS ZO PS PM PB";
                self.report.error(message, &name.span, label, help);
            } else {
                let names = syntax.facts.iter().map(|fact| fact.name.as_str());
                self.unknown("fact", name, names, "define it in [facts]");
            }
            return None;
        };
        let known = self.facts_in_rules.iter().position(|&known| known == fact);
        let index = known.unwrap_or_else(|| {
            self.facts_in_rules.push(fact);
            self.facts_in_rules.len() - 1
        });
        u8::try_from(syntax.inputs.len() + index).ok()
    }

    /// The inputs for facts with rows: 1 while the fact holds, otherwise 0.
    fn inputs_of_facts(&mut self) {
        for &fact in &self.facts_in_rules {
            let name = self.draft.name(self.syntax.facts[fact].name.as_str());
            let source = Source::Fact(fact as u8);
            let input = Input { name, source, low: 0.0, high: 1.0, hold_ms: 0, missing: 0.0 };
            self.draft.inputs.push(input);
        }
    }

    fn behaviours(&mut self) {
        let syntax = self.syntax;
        if syntax.behaviours.is_empty() && self.report.problems.is_empty() {
            let message = "the mission has no behaviour: its other behaviour tables are never used";
            self.report
                .problems
                .push(Problem::warning(message).help("add a table [behaviours.NAME]"));
        }
        for behaviour in &syntax.behaviours {
            let root = self.frame(&behaviour.root);
            let start_up = behaviour.start_up.as_ref().map(|frame| self.frame(frame));
            let shut_down = behaviour.shut_down.as_ref().map(|frame| self.frame(frame));
            let frames = [Some(root), start_up, shut_down].into_iter().flatten();
            let used = frames.filter_map(|frame| self.draft.frames.get(usize::from(frame)));
            let used = used.fold(0, |used, frame| used | frame.resources);
            let resources = used | self.resources(&behaviour.resources);
            let rules = self.rule_base(&behaviour.rules);
            let name = self.draft.name(behaviour.name.as_str());
            self.draft.behaviours.push(Behaviour {
                name,
                root,
                start_up,
                shut_down,
                rules,
                dormant: behaviour.dormant.value,
                unconditional: behaviour.unconditional.value,
                hysteresis: behaviour.hysteresis,
                dwell_ms: behaviour.dwell_ms,
                switch_point: behaviour.switch_point,
                once: behaviour.once,
                resources,
            });
        }
    }

    fn input(&mut self, name: &Text) -> Option<u8> {
        let names = self.syntax.inputs.iter().map(|input| input.name.as_str());
        let found = names.clone().position(|known| known == name.as_str());
        let is_fact = || self.syntax.facts.iter().any(|fact| fact.name.value == name.value);
        if found.is_none() && is_fact() {
            let message = format!("`{}` is a fact, not an input", name.as_str());
            let help = "in rules write two labels for a fact: for `does not hold` and for `holds`";
            self.report.error(message, &name.span, "used as an input", help);
        } else if found.is_none() {
            self.unknown("input", name, names, "define it in [inputs]");
        }
        found.map(|index| index as u8)
    }

    fn frame(&mut self, name: &Text) -> u16 {
        let names = self.syntax.frames.iter().map(|frame| frame.name.as_str());
        let found = names.clone().position(|known| known == name.as_str());
        if found.is_none() {
            let how = format!("define it as [frames.\"{}\"]", name.as_str());
            self.unknown("frame", name, names, &how);
        }
        found.unwrap_or(0) as u16
    }

    /// Reports an unknown name, unless its definition could not be understood.
    fn unknown<'c>(
        &mut self,
        what: &str,
        name: &Text,
        known: impl Iterator<Item = &'c str> + Clone,
        how: &str,
    ) {
        if self.syntax.is_broken(&name.value) {
            return;
        }
        // To define a name that would be refused does not help.
        let reason = unusable(&name.value).filter(|_| how.starts_with("define"));
        let other = reason.map(|reason| format!("{reason}: choose another name"));
        self.report.unknown(what, name, known, other.as_deref().unwrap_or(how));
    }

    /// Whether a name stands in `[goals]` or `[layers]` and a mistake there explains why there is no
    /// such plan or layer.
    fn is_of_map(&self, name: &Text) -> bool {
        self.is_map_wrong && self.syntax.of_map.contains(&name.value)
    }

    fn plan(&mut self, name: &Text) -> u16 {
        match self.plans {
            Plans::Known(plans) => {
                let names = plans.iter().map(|plan| plan.name.as_str());
                let found = names.clone().position(|known| known == name.as_str());
                if found.is_none() && !self.is_of_map(name) {
                    self.unknown("parallel plan", name, names, "add it to [goals]");
                }
                found.unwrap_or(0) as u16
            }
            Plans::Any => {
                let found = self.plans_named.iter().position(|known| known == name.as_str());
                found.unwrap_or_else(|| {
                    self.plans_named.push(name.value.clone());
                    self.plans_named.len() - 1
                }) as u16
            }
        }
    }

    fn layer(&mut self, plan: &Text, layer: &Text) -> (u16, u8) {
        let index = self.plan(plan);
        let Plans::Known(plans) = self.plans else { return (index, 0) };
        let known = plans.iter().find(|known| known.name == plan.value);
        let Some(known) = known else { return (index, 0) };
        let names = known.layers.iter().map(String::as_str);
        let found = names.clone().position(|known| known == layer.as_str());
        if found.is_none() && !self.is_of_map(layer) {
            let what = format!("layer of plan `{}` named", plan.as_str());
            let how = format!("it has {}", known.layers.join(", "));
            self.unknown(&what, layer, names, &how);
        }
        (index, found.unwrap_or(0) as u8)
    }

    /// The bit of a fact.
    fn fact(&mut self, name: &Text) -> Facts {
        let names = self.syntax.facts.iter().map(|fact| fact.name.as_str());
        let found = names.clone().position(|known| known == name.as_str());
        if found.is_none() {
            self.unknown("fact", name, names, "define it in [facts]");
        }
        found.map_or(0, |index| 1 << index)
    }

    fn condition(&mut self, literals: &[Literal]) -> Condition {
        let mut condition = Condition::default();
        for literal in literals {
            let fact = self.fact(&literal.fact);
            let (wanted, unwanted) = match literal.is_negated {
                false => (&mut condition.must, condition.must_not),
                true => (&mut condition.must_not, condition.must),
            };
            *wanted |= fact;
            if fact & unwanted != 0 {
                let message = format!("`{}` must both hold and not hold", literal.fact.as_str());
                self.report.error(
                    message,
                    &literal.fact.span,
                    "the second time",
                    "remove one of the two",
                );
            }
        }
        condition
    }

    /// The bits of resources; names are numbered in the order of their first use.
    fn resources(&mut self, names: &[Text]) -> u16 {
        names.iter().fold(0, |bits, name| bits | self.resource(name.as_str(), &name.span))
    }

    fn resource(&mut self, name: &str, span: &Span) -> u16 {
        let found = self.resources.iter().position(|known| known == name);
        let index = found.unwrap_or_else(|| {
            self.resources.push(name.to_owned());
            self.resources.len() - 1
        });
        const BITS: usize = u16::BITS as usize;
        if index == BITS {
            let message = format!("the robot supports at most {BITS} resources");
            let help = "`motion` and each output count too; let some share a name";
            self.report.error(message, span, "one too many", help);
        }
        1_u16.checked_shl(index as u32).unwrap_or(0)
    }
}

/// The row of a fact's input, whose only values are 0 and 1.
fn of_fact(unless: Label, holds: Label) -> [Label; 7] {
    let middle = Label::ALL.len() / 2;
    core::array::from_fn(|label| if label <= middle { unless } else { holds })
}
