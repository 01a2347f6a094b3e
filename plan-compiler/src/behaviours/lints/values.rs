//! Values that fit their types and still cannot be meant.

use super::Lints;
use crate::behaviours::syntax::{Doing, FactSyntax, Input, InputSource};

impl Lints<'_> {
    /// Warns of values outside an input's universe, and of weights that are not shares of a whole.
    pub(super) fn values(&mut self) {
        self.facts_outside();
        self.replacements_outside();
        self.mixes();
    }

    /// Facts about values that an input never has: channels, outputs and results of rules stay
    /// within their universe. A time or a distance may exceed it.
    fn facts_outside(&mut self) {
        let syntax = self.syntax;
        for fact in &syntax.facts {
            let FactSyntax::Level { input, low, high } = &fact.kind else { continue };
            let Some(input) = syntax.inputs.iter().find(|known| known.name.value == input.value)
            else {
                continue;
            };
            use InputSource::{Channel, Output, Rules};
            let [least, most] = ends(input);
            let is_bounded = matches!(input.source, Channel(_) | Output(_) | Rules(_));
            if is_bounded && (*low > most || *high < least) {
                let name = input.name.as_str();
                let message = format!("fact `{}` may never hold", fact.name.as_str());
                let label = format!("`{name}` has a universe from {least} to {most}");
                let help = "correct the bound, or the universe of the input";
                self.report.warning(message, &fact.name.span, &label, help);
            }
        }
    }

    fn replacements_outside(&mut self) {
        let syntax = self.syntax;
        for input in &syntax.inputs {
            let [least, most] = ends(input);
            if !(least..=most).contains(&input.missing) {
                let message = format!(
                    "input `{}` replaces a missing value by {}, outside its universe",
                    input.name.as_str(),
                    input.missing
                );
                let label = format!("the universe is from {least} to {most}");
                let help = "correct `then`, or the universe";
                self.report.warning(message, &input.name.span, &label, help);
            }
        }
    }

    fn mixes(&mut self) {
        let syntax = self.syntax;
        for action in &syntax.actions {
            let Doing::Follow { reactive, advice, .. } = action.kind else { continue };
            let percent = ((reactive + advice) * 1e3).round() / 10.0;
            if percent != 100.0 {
                let message = format!(
                    "the weights of `{}` add up to {percent} percent",
                    action.name.as_str()
                );
                let help = "write two shares of 100, for example 34:66";
                let label = "reactive schemas and advice";
                self.report.warning(message, &action.name.span, label, help);
            }
        }
    }
}

/// The lowest and the highest value of an input's universe.
fn ends(input: &Input) -> [f32; 2] {
    let [nb, pb] = input.universe;
    [nb.min(pb), nb.max(pb)]
}
