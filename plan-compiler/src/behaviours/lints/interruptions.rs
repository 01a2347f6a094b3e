//! Behaviours that interrupt each other in turn (H32).

use super::Lints;

impl Lints<'_> {
    /// Warns of pairs that take over from each other within one step of one input. Hysteresis and a
    /// minimum dwell damp this; if either is 0, the pair may chatter.
    pub(super) fn interruptions(&mut self) {
        let count = self.draft.behaviours.len();
        for a in 0..count {
            for b in 0..a {
                if !self.conflict(a, b) || self.is_damped(a) && self.is_damped(b) {
                    continue;
                }
                let Some((up, down)) = self.flip(a, b) else { continue };
                let message = format!(
                    "`{}` and `{}` interrupt each other alternately",
                    self.name(b),
                    self.name(a)
                );
                let label = format!(
                    "`{}` takes over at {}, and the other takes over again at {}",
                    self.name(a),
                    self.describe(up),
                    self.describe(down)
                );
                let help = "give both a hysteresis and a dwell_s above 0";
                let span = &self.syntax.behaviours[a].rules.span;
                self.report.warning(message, span, &label, help);
            }
        }
    }

    fn is_damped(&self, behaviour: usize) -> bool {
        let behaviour = &self.draft.behaviours[behaviour];
        behaviour.hysteresis > 0.0 && behaviour.dwell_ms > 0
    }

    /// Two neighbouring situations: `a` takes over from `b` in the first, and `b` from `a` in the
    /// second.
    fn flip(&self, a: usize, b: usize) -> Option<(usize, usize)> {
        let situations = self.situations.as_ref()?;
        let takes_over = |by: usize, from: usize, situation: usize| {
            let (new, old) = (&self.draft.behaviours[by], &self.draft.behaviours[from]);
            let value = situations.result(situation, new.rules);
            let other = situations.result(situation, old.rules);
            // A dormant behaviour does not take part: it has nothing to do.
            value > new.dormant && other > old.dormant && value > other + old.hysteresis
        };
        (0..situations.count()).find_map(|here| {
            let mut near = situations.neighbours(here);
            near.find_map(|there| {
                if takes_over(a, b, here) && takes_over(b, a, there) {
                    Some((here, there))
                } else if takes_over(a, b, there) && takes_over(b, a, here) {
                    Some((there, here))
                } else {
                    None
                }
            })
        })
    }
}
