//! Conditions that can never be met, and components that contradict what their production protects.

use super::Lints;
use super::recursion::leads;
use plan_format::mission::effects::{possible, sure};
use plan_format::mission::{Condition, Description, FactKind, Interval, Production, Symbol};

impl Lints<'_> {
    /// Warns of conditions on symbols that keep their initial value, and reports components that
    /// contradict an interval that spans them.
    pub(super) fn contradictions(&mut self) {
        self.symbols_that_stay();
        for frame in 0..self.draft.frames.len() {
            let first = usize::from(self.draft.frames[frame].first);
            for number in 0..usize::from(self.draft.frames[frame].count) {
                let production = self.draft.productions[first + number];
                for edge in 0..usize::from(production.edges) {
                    self.within_intervals(frame, number, &production, edge);
                }
            }
        }
    }

    /// A symbol that nothing adds never holds if it does not hold at the start.
    fn symbols_that_stay(&mut self) {
        let (syntax, draft) = (self.syntax, self.draft);
        let changed =
            |of: fn(&Description) -> u64| draft.descriptions.iter().fold(0, |all, d| all | of(d));
        let (added, deleted) = (changed(|d| d.add), changed(|d| d.delete));
        let conditions = draft
            .descriptions
            .iter()
            .flat_map(|d| [d.initial, d.transient, d.goal])
            .chain(draft.actions.iter().map(|action| action.until))
            .chain(draft.frames.iter().map(|frame| frame.until))
            .chain(draft.intervals.iter().map(|interval| interval.condition));
        let read = conditions.fold(Condition::default(), Condition::and);
        for (index, (fact, named)) in draft.facts.iter().zip(&syntax.facts).enumerate() {
            let FactKind::Symbol { is_set } = fact.kind else { continue };
            let bit = 1 << index;
            let (is_wanted, is_changed, stays, verb) = match is_set {
                false => (read.must & bit != 0, added & bit != 0, "never holds", "adds"),
                true => (read.must_not & bit != 0, deleted & bit != 0, "always holds", "deletes"),
            };
            if is_wanted && !is_changed {
                let name = named.name.as_str();
                let message = format!("`{name}` {stays}, and a condition needs the opposite");
                let label = format!("no component {verb} it");
                let key = if is_set { "delete" } else { "add" };
                let help = format!("add {key} = [\"{name}\"] to the component that changes it");
                self.report.warning(message, &named.name.span, &label, &help);
            }
        }
    }

    /// Compares one component with the intervals of its production that span it.
    fn within_intervals(
        &mut self,
        frame: usize,
        number: usize,
        production: &Production,
        edge: usize,
    ) {
        let (syntax, draft) = (self.syntax, self.draft);
        let part = draft.edges[usize::from(production.first_edge) + edge];
        let description = match part.symbol {
            Symbol::Action(index) => draft.actions[usize::from(index)].description,
            Symbol::PlanFrame(index) => draft.frames[usize::from(index)].description,
        };
        let description = draft.descriptions[usize::from(description)];
        let first = usize::from(production.first_interval);
        let intervals = &draft.intervals[first..first + usize::from(production.intervals)];
        let spans = |interval: &&Interval| {
            leads(draft, production, interval.from, part.from)
                && leads(draft, production, part.to, interval.to)
        };
        let written = &syntax.frames[frame].productions[number];
        let Some(place) = written.graph.edges.get(edge) else { return };
        for interval in intervals.iter().filter(spans) {
            let held = interval.condition;
            let needs = description.transient;
            let denied = held.must & needs.must_not | held.must_not & needs.must;
            if denied != 0 {
                let message = format!(
                    "`{}` may only run while `{}` is violated, which its production protects",
                    self.symbol(part.symbol),
                    self.fact_names(denied)
                );
                let help = "change its transient condition, or end the interval before it";
                self.report.error(message, &place.span, "it can never run here", help);
            }
            // At the last vertex of the interval the protection ends as well.
            if part.to == interval.to {
                continue;
            }
            let violated = |(adds, deletes): (u64, u64)| held.must & deletes | held.must_not & adds;
            let surely = violated(sure(draft, part.symbol));
            let perhaps = violated(possible(draft, part.symbol)) & !surely;
            let help = "end the interval before this component, or at its end";
            if surely != 0 {
                let message = format!(
                    "`{}` ends with a violation of `{}`, which its production protects",
                    self.symbol(part.symbol),
                    self.fact_names(surely)
                );
                self.report.error(message, &place.span, "inside the protection interval", help);
            } else if perhaps != 0 {
                let message = format!(
                    "`{}` may violate `{}`, which its production protects",
                    self.symbol(part.symbol),
                    self.fact_names(perhaps)
                );
                self.report.warning(message, &place.span, "inside the protection interval", help);
            }
        }
    }

    /// The names of a set of facts.
    fn fact_names(&self, bits: u64) -> String {
        let all = self.syntax.facts.iter().enumerate();
        let names = all.filter(|(bit, _)| bits & 1 << bit != 0).map(|(_, fact)| fact.name.as_str());
        names.collect::<Vec<&str>>().join("`, `")
    }
}
