//! Thresholds that no criticality can reach, behaviours that never run or never end, and
//! productions that are never applicable.

use super::Lints;
use super::recursion::is_last;
use crate::behaviours::language::{REACH, unreachable};
use plan_format::mission::Symbol;

/// Above this, min clipping between NB and NM dips below what NB alone gives.
const UNEVEN: f32 = 0.935;

impl Lints<'_> {
    /// Reports thresholds outside the range of results of rules.
    pub(super) fn thresholds(&mut self) {
        let syntax = self.syntax;
        for behaviour in &syntax.behaviours {
            for (what, threshold) in
                [("dormant", &behaviour.dormant), ("unconditional", &behaviour.unconditional)]
            {
                self.threshold(what, threshold.value, &threshold.span);
            }
            if behaviour.dormant.value >= behaviour.unconditional.value {
                let message = format!(
                    "behaviour `{}` is never active without being unconditional",
                    behaviour.name.as_str()
                );
                let help = "make `dormant` lower than `unconditional`";
                self.report.error(
                    message,
                    &behaviour.dormant.span,
                    "not below `unconditional`",
                    help,
                );
            }
        }
        for frame in &syntax.frames {
            // A production without rules is fully applicable, whatever the threshold.
            if frame.productions.iter().any(|production| production.rules.is_some()) {
                self.threshold("threshold", frame.threshold.value, &frame.threshold.span);
            }
        }
    }

    fn threshold(&mut self, what: &str, value: f32, span: &crate::toml::Span) {
        let [low, high] = REACH;
        if value < low || value > high {
            unreachable(&mut self.report, what, value, span);
        } else if value > UNEVEN {
            let message = format!("`{what}` is in the range where results are uneven");
            let help = "with min clipping PB next to PM results in 0.936; choose 0.935 or less";
            self.report.warning(message, span, "above 0.935", help);
        }
    }

    /// Reports what never runs, never ends or is never applicable, if the situations are known.
    pub(super) fn reach(&mut self) {
        self.never_applicable();
        for behaviour in 0..self.syntax.behaviours.len() {
            self.never_runs(behaviour);
            self.never_ends(behaviour);
        }
    }

    fn never_applicable(&mut self) {
        let syntax = self.syntax;
        let Some(situations) = &self.situations else { return };
        let mut found = Vec::new();
        for (frame, record) in syntax.frames.iter().zip(&self.draft.frames) {
            for (number, production) in frame.productions.iter().enumerate() {
                let index = usize::from(record.first) + number;
                let Some(rules) = self.draft.productions[index].rules else { continue };
                let (_, highest) = situations.range(rules);
                if highest < record.threshold {
                    found.push((frame, production, highest));
                }
            }
        }
        for (frame, production, highest) in found {
            let message = format!(
                "production `{}` of `{}` is never applicable: {highest:.3} at most",
                production.name.as_str(),
                frame.name.as_str()
            );
            let label = format!("below the threshold {} everywhere", frame.threshold.value);
            let span = production.rules.as_ref().map_or(&production.name.span, |rules| &rules.span);
            self.report.warning(message, span, &label, "lower the threshold, or change the table");
        }
    }

    fn never_runs(&mut self, index: usize) {
        let syntax = self.syntax;
        let behaviour = &syntax.behaviours[index];
        let record = &self.draft.behaviours[index];
        let Some(situations) = &self.situations else { return };
        let (_, highest) = situations.range(record.rules);
        if highest <= record.dormant {
            let message = format!("behaviour `{}` can never run", behaviour.name.as_str());
            let label = format!("always dormant: its criticality is {highest:.3} at most");
            let help =
                format!("lower `dormant`, which is {:.3}, or change the table", record.dormant);
            self.report.error(message, &behaviour.rules.span, &label, &help);
            return;
        }
        let is_first = |situation: usize| {
            let value = situations.result(situation, record.rules);
            let is_beaten = |other: usize| {
                let rival = &self.draft.behaviours[other];
                let rival_value = situations.result(situation, rival.rules);
                // Among equals the first one in the file wins.
                let is_above =
                    rival_value > value || rival_value.total_cmp(&value).is_eq() && other < index;
                self.conflict(index, other) && rival_value > rival.dormant && is_above
            };
            value > record.dormant && !(0..self.draft.behaviours.len()).any(is_beaten)
        };
        if !(0..situations.count()).any(is_first) {
            let message = format!(
                "behaviour `{}` never comes first: another that needs the same resource is always more critical",
                behaviour.name.as_str()
            );
            let label = "another behaviour is always more critical";
            let help = "change the table, or let the other become dormant";
            self.report.warning(message, &behaviour.rules.span, label, help);
        }
    }

    /// Warns of a plan that cannot end. A plan ends if one path through it ends, or if it is a loop
    /// that can become inapplicable.
    fn never_ends(&mut self, index: usize) {
        let draft = self.draft;
        let mut ends = vec![false; draft.frames.len()];
        loop {
            let before = ends.clone();
            for (frame, ends) in ends.iter_mut().enumerate() {
                *ends = *ends || self.may_end(frame, &before);
            }
            if ends == before {
                break;
            }
        }
        let root = usize::from(draft.behaviours[index].root);
        if !ends[root] {
            let behaviour = &self.syntax.behaviours[index];
            let message = format!(
                "behaviour `{}` never ends by itself, only by interruption or failure",
                behaviour.name.as_str()
            );
            let help = "give the loop's productions an `applicable` table that ends the loop, its \
                frame an `until`, or add a production that leaves it";
            let label = "its loop is always applicable";
            self.report.warning(message, &behaviour.root.span, label, help);
        }
    }

    fn may_end(&self, frame: usize, ends: &[bool]) -> bool {
        let draft = self.draft;
        let record = &draft.frames[frame];
        if !record.until.is_empty() {
            return true;
        }
        let first = usize::from(record.first);
        let mut is_loop = false;
        let mut always = false;
        for production in &draft.productions[first..first + usize::from(record.count)] {
            let symbols = draft.edges_of(production).iter();
            let all_end = symbols.clone().all(|edge| match edge.symbol {
                Symbol::PlanFrame(inner) => ends[usize::from(inner)],
                Symbol::Action(_) => true,
            });
            if all_end {
                return true;
            }
            is_loop |= symbols.enumerate().any(|(number, edge)| {
                matches!(edge.symbol, Symbol::PlanFrame(inner)
                    if super::recursion::reaches(draft, inner.into(), frame) || usize::from(inner) == frame)
                    && is_last(draft, production, number)
            });
            let lowest = match (production.rules, &self.situations) {
                (Some(rules), Some(situations)) => situations.range(rules).0,
                // If situations are not known, one of them may end it.
                (Some(_), None) => 0.0,
                (None, _) => 1.0,
            };
            always |= lowest >= record.threshold;
        }
        is_loop && !always
    }
}
