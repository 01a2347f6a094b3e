//! Definitions that are never used, and components that cannot run side by side.

use super::Lints;
use crate::toml::Text;
use plan_format::mission::effects::below;
use plan_format::mission::{FactKind, Source, Symbol};

impl Lints<'_> {
    /// Warns of definitions that no behaviour uses.
    pub(super) fn unused(&mut self) {
        let draft = self.draft;
        let mut used: Vec<Symbol> = Vec::new();
        for behaviour in &draft.behaviours {
            used.extend(behaviour.plan_frames().map(Symbol::PlanFrame));
        }
        let mut at = 0;
        while let Some(&symbol) = used.get(at) {
            if let Symbol::PlanFrame(index) = symbol {
                for inner in below(draft, index.into()) {
                    if !used.contains(&inner) {
                        used.push(inner);
                    }
                }
            }
            at += 1;
        }
        let syntax = self.syntax;
        let frames = syntax.frames.iter().enumerate().map(|(index, frame)| {
            ("frame", &frame.name, used.contains(&Symbol::PlanFrame(index as u16)))
        });
        let actions = syntax.actions.iter().enumerate().map(|(index, action)| {
            ("action", &action.name, used.contains(&Symbol::Action(index as u16)))
        });
        let facts = (syntax.facts.iter().enumerate())
            .map(|(index, fact)| ("fact", &fact.name, self.is_fact_used(index)));
        let inputs = (syntax.inputs.iter().enumerate())
            .map(|(index, input)| ("input", &input.name, self.is_input_used(index)));
        let all: Vec<(&str, &Text, bool)> =
            frames.chain(actions).chain(facts).chain(inputs).collect();
        for (what, name, is_used) in all {
            if !is_used {
                let message = format!("{what} `{}` is never used", name.as_str());
                self.report.warning(message, &name.span, "defined here", "use it, or remove it");
            }
        }
    }

    fn is_fact_used(&self, index: usize) -> bool {
        let draft = self.draft;
        let read = draft.descriptions.iter().map(|d| [d.initial, d.transient, d.goal]);
        let conditions = read
            .flatten()
            .chain(draft.actions.iter().map(|action| action.until))
            .chain(draft.frames.iter().map(|frame| frame.until))
            .chain(draft.intervals.iter().map(|interval| interval.condition));
        conditions.fold(0, |bits, c| bits | c.must | c.must_not) & 1 << index != 0
            || draft.inputs.iter().any(|input| input.source == Source::Fact(index as u8))
    }

    fn is_input_used(&self, index: usize) -> bool {
        let draft = self.draft;
        draft.rules.iter().any(|rule| usize::from(rule.input) == index)
            || draft.facts.iter().any(
                |fact| matches!(fact.kind, FactKind::Level { input, .. } if usize::from(input) == index),
            )
            || matches!(draft.inputs[index].source, Source::Rules(_)) && draft.rules.is_empty()
    }

    /// Reports components that run side by side and need the same resource.
    pub(super) fn side_by_side(&mut self) {
        let (syntax, draft) = (self.syntax, self.draft);
        let resources = |symbol: Symbol| match symbol {
            Symbol::PlanFrame(index) => draft.frames[usize::from(index)].resources,
            Symbol::Action(index) => draft.actions[usize::from(index)].resources,
        };
        let productions = syntax.frames.iter().flat_map(|frame| &frame.productions);
        for (production, record) in productions.zip(&draft.productions) {
            let graph = &production.graph;
            let symbol = |edge: usize| draft.edges[usize::from(record.first_edge) + edge].symbol;
            for (b, second) in graph.edges.iter().enumerate() {
                for (a, first) in graph.edges.iter().enumerate().take(b) {
                    let in_turn =
                        graph.leads(first.to, second.from) || graph.leads(second.to, first.from);
                    if !in_turn && resources(symbol(a)) & resources(symbol(b)) != 0 {
                        let message = format!(
                            "`{}` and `{}` run side by side and need the same resource",
                            self.symbol(symbol(a)),
                            self.symbol(symbol(b))
                        );
                        let help = "let one follow the other; every action that drives or holds needs \
                            `motion`";
                        self.report.error(
                            message,
                            &second.span,
                            "needs a resource that the other one needs",
                            help,
                        );
                    }
                }
            }
        }
    }
}
