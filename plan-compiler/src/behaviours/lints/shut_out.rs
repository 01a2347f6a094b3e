//! Protection intervals that accumulate until a critical behaviour cannot be engaged (H35).

use super::Lints;
use super::recursion::leads;
use plan_format::limits::MAX_DEPTH;
use plan_format::mission::effects::below;
use plan_format::mission::{Condition, Interval, MissionDraft, Symbol};
use std::collections::HashSet;

/// What a behaviour protects while it sleeps, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Held {
    frame: usize,
    /// Index of the production.
    production: usize,
    vertex: u8,
    must: u64,
    must_not: u64,
}

impl Lints<'_> {
    /// Warns of behaviours that are shut out. A sleeping behaviour still protects its facts. If a
    /// second behaviour can interrupt it there and a third would violate the protection, the third
    /// is shut out: the robot resumes the sleeping one first, unless the third becomes critical
    /// enough to overrule it. The warning names all three and the place.
    pub(super) fn shut_out(&mut self) {
        let count = self.draft.behaviours.len();
        for sleeper in 0..count {
            let held = points(self.draft, sleeper);
            for victim in (0..count).filter(|&victim| victim != sleeper) {
                if let Some((by, held)) = self.witness(sleeper, victim, &held) {
                    self.report_shut_out(sleeper, by, victim, held);
                }
            }
        }
    }

    fn witness(&self, sleeper: usize, victim: usize, held: &[Held]) -> Option<(usize, Held)> {
        let violates = |behaviour: usize, held: &Held| {
            let (adds, deletes) = effects(self.draft, behaviour);
            held.must & deletes != 0 || held.must_not & adds != 0
        };
        let held = held.iter().find_map(|held| {
            let interrupts = |&by: &usize| {
                by != victim
                    && self.conflict(sleeper, by)
                    && !violates(by, held)
                    && self.takes_over(sleeper, by).is_some()
            };
            let by = (0..self.draft.behaviours.len()).find(interrupts)?;
            violates(victim, held).then_some((by, *held))
        })?;
        // A behaviour that never takes over is not shut out.
        self.takes_over(held.0, victim).map(|_| held)
    }

    fn report_shut_out(&mut self, sleeper: usize, by: usize, victim: usize, held: Held) {
        let facts = self.facts_of(held, victim);
        let edges = self.draft.edges_of(&self.draft.productions[held.production]);
        let after: Vec<&str> = edges
            .iter()
            .filter(|edge| edge.to == held.vertex)
            .map(|edge| self.symbol(edge.symbol))
            .collect();
        let record = &self.draft.behaviours[victim];
        let highest = self.situations.as_ref().map(|situations| situations.range(record.rules).1);
        let never = match highest {
            Some(highest) if highest < record.unconditional => format!(
                "; `{}` never becomes critical enough to overrule it, {highest:.3} of {:.3}",
                self.name(victim),
                record.unconditional
            ),
            _ => String::new(),
        };
        let (victim_name, sleeper_name) = (self.name(victim), self.name(sleeper));
        let message =
            format!("behaviour `{victim_name}` can be shut out by the sleeping `{sleeper_name}`");
        let label = format!(
            "when `{}` interrupts `{sleeper_name}` after `{}`, `{sleeper_name}` still protects \
             `{facts}` and resumes first{never}",
            self.name(by),
            after.join("` and `")
        );
        let help = "end the protection interval before that point, or give the facts up in a \
            shut_down frame and restore them in a start_up frame";
        let span = self.syntax.behaviours[victim].name.span.clone();
        self.report.warning(message, &span, &label, help);
    }

    /// The names of the protected facts that `victim` may violate.
    fn facts_of(&self, held: Held, victim: usize) -> String {
        let (adds, deletes) = effects(self.draft, victim);
        let bits = held.must & deletes | held.must_not & adds;
        let names = self.syntax.facts.iter().enumerate();
        let names =
            names.filter(|(bit, _)| bits & 1 << bit != 0).map(|(_, fact)| fact.name.as_str());
        names.collect::<Vec<&str>>().join("`, `")
    }
}

/// The facts that a behaviour's plans may add, and those that they may delete.
pub(super) fn effects(draft: &MissionDraft, behaviour: usize) -> (u64, u64) {
    let behaviour = &draft.behaviours[behaviour];
    behaviour.plan_frames().fold((0, 0), |(adds, deletes), frame| {
        let frame = &draft.frames[usize::from(frame)];
        (adds | frame.may_add, deletes | frame.may_delete)
    })
}

/// What a behaviour protects while it sleeps at any of its points.
pub(super) fn held_at_points(draft: &MissionDraft, behaviour: usize) -> Condition {
    let conditions = points(draft, behaviour).into_iter();
    let conditions = conditions.map(|Held { must, must_not, .. }| Condition { must, must_not });
    conditions.fold(Condition::default(), Condition::and)
}

/// What the intervals of a plan protect anywhere, below a root frame.
pub(super) fn protected_anywhere(draft: &MissionDraft, root: usize) -> Condition {
    let (mut seen, mut waiting) = (HashSet::new(), vec![root]);
    let mut all = Condition::default();
    while let Some(frame) = waiting.pop() {
        if !seen.insert(frame) {
            continue;
        }
        let first = usize::from(draft.frames[frame].first);
        for record in draft.productions.iter().skip(first).take(draft.frames[frame].count.into()) {
            let intervals = draft.intervals.iter().skip(record.first_interval.into());
            for interval in intervals.take(record.intervals.into()) {
                all = all.and(interval.condition);
            }
        }
        waiting.extend(below(draft, frame).into_iter().filter_map(|symbol| match symbol {
            Symbol::PlanFrame(inner) => Some(usize::from(inner)),
            Symbol::Action(_) => None,
        }));
    }
    all
}

/// Everything that a behaviour may protect at any point of its plan, without what its shut-down
/// gives up.
fn points(draft: &MissionDraft, behaviour: usize) -> Vec<Held> {
    let record = &draft.behaviours[behaviour];
    let freed = record.shut_down.map_or((0, 0), |frame| {
        let frame = &draft.frames[usize::from(frame)];
        (frame.may_add, frame.may_delete)
    });
    let kept = points_of_plan(draft, record.root.into()).into_iter().map(|held| Held {
        must: held.must & !freed.1,
        must_not: held.must_not & !freed.0,
        ..held
    });
    kept.filter(|held| held.must | held.must_not != 0).collect()
}

/// Everything that may be protected at any point of a plan, below a root frame.
fn points_of_plan(draft: &MissionDraft, root: usize) -> Vec<Held> {
    let mut found = Vec::new();
    let mut seen = HashSet::new();
    let mut waiting = vec![(root, Condition::default(), 0)];
    while let Some((frame, outer, depth)) = waiting.pop() {
        if depth > MAX_DEPTH || !seen.insert((frame, outer.must, outer.must_not)) {
            continue;
        }
        let first = usize::from(draft.frames[frame].first);
        for production in first..first + usize::from(draft.frames[frame].count) {
            for vertex in 1..draft.productions[production].vertices.saturating_sub(1) {
                let held = protected(draft, production, vertex, vertex, outer);
                if !held.is_empty() {
                    let (must, must_not) = (held.must, held.must_not);
                    found.push(Held { frame, production, vertex, must, must_not });
                }
            }
            for edge in draft.edges_of(&draft.productions[production]) {
                if let Symbol::PlanFrame(inner) = edge.symbol {
                    let held = protected(draft, production, edge.from, edge.to, outer);
                    waiting.push((inner.into(), held, depth + 1));
                }
            }
        }
    }
    found
}

/// What may be protected along an edge, or at a vertex if both ends are the same: what frames above
/// protect, and every interval that has not certainly ended before and does not certainly begin
/// after.
fn protected(
    draft: &MissionDraft,
    production: usize,
    from: u8,
    to: u8,
    outer: Condition,
) -> Condition {
    let record = &draft.productions[production];
    let first = usize::from(record.first_interval);
    let all = &draft.intervals[first..first + usize::from(record.intervals)];
    let may_hold = |interval: &&Interval| {
        let begins_here = from == to && from == interval.from;
        let begins_later = leads(draft, record, to, interval.from) && !begins_here;
        !begins_later && !leads(draft, record, interval.to, from)
    };
    let held = all.iter().filter(may_hold).map(|interval| interval.condition);
    held.fold(outer, Condition::and)
}
