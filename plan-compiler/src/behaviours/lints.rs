//! What would go wrong on the robot, found before it drives.
//!
//! The robot's own crates evaluate the rule bases in every situation that labels distinguish
//! ([`situations`]), and carry out the plans in every way that actions can end ([`waits`]). If
//! there is too much to check, a note reports that.
//!
//! What certainly goes wrong is an error; what is probably unintended is a warning.

mod budget;
mod contradictions;
mod interruptions;
mod recursion;
mod shut_out;
mod situations;
mod thresholds;
mod unused;
mod values;
mod waits;

pub use budget::Need;
pub use waits::Wait;

use super::syntax::Syntax;
use crate::toml::Report;
use maps::problem::{Problem, has_errors};
use plan_format::mission::{MissionDraft, Source, Symbol};
use situations::Situations;

/// What the lints find out about a mission.
#[derive(Clone, Debug, Default)]
pub struct Analysis {
    /// What each behaviour's plans may need at once, by index.
    pub needs: Vec<Need>,
    /// The longest wait of each behaviour for its turn, by index; `None` if no other behaviour can
    /// make it wait.
    pub waits: Vec<Option<Wait>>,
}

/// Checks a mission that was lowered without an error.
pub fn check(syntax: &Syntax, draft: &MissionDraft, problems: &mut Vec<Problem>) -> Analysis {
    let Some(source) = &syntax.source else { return Analysis::default() };
    let before = problems.len();
    let report = Report { source, problems };
    let mut lints = Lints { syntax, draft, report, situations: Situations::explore(draft) };
    lints.thresholds();
    lints.recursion();
    lints.side_by_side();
    lints.contradictions();
    lints.values();
    if has_errors(&lints.report.problems[before..]) {
        return Analysis::default();
    }
    let Some(needs) = lints.budget() else { return Analysis::default() };
    lints.unused();
    if lints.situations.is_none() {
        let message = "too many inputs: not all combinations of their labels can be checked";
        let help = "behaviours that never run or that interrupt each other are not found; \
            derive inputs from others by rules to reduce their number";
        lints.report.problems.push(Problem::note(message).help(help));
    }
    lints.reach();
    lints.interruptions();
    lints.shut_out();
    let waits = lints.waits();
    if !needs.is_empty() {
        lints.report.problems.push(Problem::note(budget::in_words(&needs)));
    }
    Analysis { needs, waits }
}

struct Lints<'l> {
    syntax: &'l Syntax,
    draft: &'l MissionDraft,
    report: Report<'l>,
    /// `None` if there are too many.
    situations: Option<Situations>,
}

impl Lints<'_> {
    /// A situation in words, for messages.
    fn describe(&self, situation: usize) -> String {
        let syntax = self.syntax;
        let own = syntax.inputs.iter().map(|input| input.name.as_str());
        // Facts with rows are inputs after those of the mission.
        let facts = self.draft.inputs.iter().filter_map(|input| match input.source {
            Source::Fact(fact) => Some(syntax.facts[usize::from(fact)].name.as_str()),
            _ => None,
        });
        let names: Vec<&str> = own.chain(facts).collect();
        let situations = self.situations.as_ref();
        situations.map_or(String::new(), |all| all.describe(situation, self.draft, &names))
    }

    /// The name of a behaviour.
    fn name(&self, behaviour: usize) -> &str {
        self.syntax.behaviours.get(behaviour).map_or("", |behaviour| behaviour.name.as_str())
    }

    /// The name of the component on an edge.
    fn symbol(&self, symbol: Symbol) -> &str {
        match symbol {
            Symbol::PlanFrame(index) => self.syntax.frames.get(usize::from(index)).map(|f| &f.name),
            Symbol::Action(index) => self.syntax.actions.get(usize::from(index)).map(|a| &a.name),
        }
        .map_or("", |name| name.as_str())
    }

    /// Whether two behaviours cannot run together.
    fn conflict(&self, a: usize, b: usize) -> bool {
        let resources = |index: usize| self.draft.behaviours[index].resources;
        a != b && resources(a) & resources(b) != 0
    }

    /// A situation in which behaviour `by` conditionally takes over from `from`: `None` if there is
    /// none, `Some(None)` if the situations are not known.
    fn takes_over(&self, from: usize, by: usize) -> Option<Option<usize>> {
        let Some(situations) = &self.situations else { return Some(None) };
        let (old, new) = (&self.draft.behaviours[from], &self.draft.behaviours[by]);
        (0..situations.count())
            .find(|&situation| {
                let of = |rules| situations.result(situation, rules);
                let (old_value, new_value) = (of(old.rules), of(new.rules));
                let is_dormant = old_value <= old.dormant;
                let weight = if is_dormant { 0.0 } else { old_value + old.hysteresis };
                new_value > new.dormant && new_value > weight
            })
            .map(Some)
    }
}
