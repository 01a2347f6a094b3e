//! Every situation that the rules distinguish: all combinations of the inputs' labels.
//!
//! The robot's own crate evaluates the rules at every combination of labels of the inputs that
//! rules use; with few inputs, also halfway between labels. A fact holds or does not hold.

use plan_format::mission::{Label, MissionDraft, Source};

/// Most combinations that are evaluated.
const MAX_SITUATIONS: usize = 120_000;

/// The values of all rule bases at all combinations.
pub(crate) struct Situations {
    /// Indices of the inputs that are varied.
    inputs: Vec<usize>,
    /// Number of positions along each of them: 7, or 13 with those halfway; 2 of a fact.
    steps: Vec<usize>,
    /// Results of the rule bases, combination by combination.
    results: Vec<f32>,
    bases: usize,
}

impl Situations {
    /// Evaluates all combinations; `None` if there are too many.
    pub(crate) fn explore(draft: &MissionDraft) -> Option<Self> {
        let used = |index: usize| draft.rules.iter().any(|rule| usize::from(rule.input) == index);
        let is_primary = |index: &usize| {
            !matches!(draft.inputs[*index].source, Source::Rules(_)) && used(*index)
        };
        let inputs: Vec<usize> = (0..draft.inputs.len()).filter(is_primary).collect();
        let is_fact = |index: usize| matches!(draft.inputs[index].source, Source::Fact(_));
        let fit = |most: usize| {
            let steps = inputs.iter().map(|&input| if is_fact(input) { 2 } else { most });
            let steps: Vec<usize> = steps.collect();
            let count = steps.iter().try_fold(1_usize, |count, steps| count.checked_mul(*steps));
            Some((steps, count.filter(|&count| count <= MAX_SITUATIONS)?))
        };
        let (steps, count) = fit(13).or_else(|| fit(7))?;
        let bases = draft.rule_bases.len();
        let mut results = Vec::with_capacity(count * bases);
        let mut positions = vec![0.0; draft.inputs.len()];
        for situation in 0..count {
            let mut rest = situation;
            for (&input, steps) in inputs.iter().zip(&steps) {
                positions[input] = (rest % steps) as f32 / (steps - 1) as f32;
                rest /= steps;
            }
            evaluate(draft, &mut positions, &mut results);
        }
        Some(Self { inputs, steps, results, bases })
    }

    /// How many combinations there are.
    pub(crate) fn count(&self) -> usize {
        self.results.len().checked_div(self.bases).unwrap_or(0)
    }

    /// The result of a rule base in a situation.
    pub(crate) fn result(&self, situation: usize, base: u16) -> f32 {
        self.results.get(situation * self.bases + usize::from(base)).copied().unwrap_or(0.5)
    }

    /// The lowest and the highest result of a rule base.
    pub(crate) fn range(&self, base: u16) -> (f32, f32) {
        let all = (0..self.count()).map(|situation| self.result(situation, base));
        all.fold((1.0, 0.0), |(low, high), result| (result.min(low), result.max(high)))
    }

    /// Situations that differ from one by a single step of a single input.
    pub(crate) fn neighbours(&self, situation: usize) -> impl Iterator<Item = usize> + '_ {
        let mut stride = 1;
        let strides = self.steps.iter().map(move |steps| {
            let this = stride;
            stride *= steps;
            (this, *steps)
        });
        strides.filter_map(move |(stride, steps)| {
            let at = situation / stride % steps;
            (at + 1 < steps).then_some(situation + stride)
        })
    }

    /// A situation in words: `fuel NB, load between ZO and PS`.
    pub(crate) fn describe(
        &self,
        situation: usize,
        draft: &MissionDraft,
        names: &[&str],
    ) -> String {
        let mut rest = situation;
        let mut parts = Vec::new();
        for (&input, &steps) in self.inputs.iter().zip(&self.steps) {
            let at = rest % steps;
            rest /= steps;
            let label = |index: usize| format!("{:?}", Label::from_index(index as u8));
            let place = match steps {
                2 if at == 0 => "does not hold".to_owned(),
                2 => "holds".to_owned(),
                13 if at % 2 == 1 => format!("between {} and {}", label(at / 2), label(at / 2 + 1)),
                13 => label(at / 2),
                _ => label(at),
            };
            let is_used = input < draft.inputs.len();
            if let Some(name) = names.get(input).filter(|_| is_used) {
                parts.push(format!("{name} {place}"));
            }
        }
        parts.join(", ")
    }
}

/// Adds the results of all rule bases at some positions of the inputs. A rule base depends on
/// earlier ones only.
fn evaluate(draft: &MissionDraft, positions: &mut [f32], results: &mut Vec<f32>) {
    let first = results.len();
    for base in &draft.rule_bases {
        let from = usize::from(base.first);
        let rules = &draft.rules[from..from + usize::from(base.count)];
        for rule in rules {
            let index = usize::from(rule.input);
            let input = &draft.inputs[index];
            if let Source::Rules(earlier) = input.source {
                let value = results[first + usize::from(earlier)];
                positions[index] = fuzzy::position(value, input.low, input.high);
            }
        }
        let rules = rules.iter().map(|rule| (rule.labels, positions[usize::from(rule.input)]));
        results.push(fuzzy::infer(rules, base.inference));
    }
}
