//! Protection intervals: those written in the mission, and those derived from a single producer and
//! a single consumer (H, "Plan Components").

use super::Lowering;
use crate::behaviours::graph_text::{Graph, tidy};
use crate::behaviours::language::literal;
use crate::behaviours::syntax::{self, Literal};
use crate::toml::{Spanned, Text};
use plan_format::mission::effects;
use plan_format::mission::{
    Condition, Description, Facts, Interval, MissionDraft, PlanFrame, Symbol,
};

impl Lowering<'_> {
    /// The intervals of every production, those written in the mission first.
    pub(super) fn intervals(&mut self) {
        let syntax = self.syntax;
        let needs = needs_of_frames(syntax, &self.draft);
        let productions = syntax.frames.iter().flat_map(|frame| &frame.productions);
        for (index, production) in productions.enumerate() {
            let first = self.draft.intervals.len();
            for text in &production.protect {
                if let Some(interval) = self.by_hand(production, text) {
                    self.draft.intervals.push(interval);
                }
            }
            let derived = derived(&self.draft, &needs, index, &production.graph, first);
            self.draft.intervals.extend(derived);
            let count = self.draft.intervals.len() - first;
            if let Some(record) = self.draft.productions.get_mut(index) {
                record.first_interval = first as u16;
                record.intervals = count.min(usize::from(u8::MAX)) as u8;
            }
        }
    }

    /// `on field and not stuck from forward to back`
    fn by_hand(&mut self, production: &syntax::Production, text: &Text) -> Option<Interval> {
        const HELP: &str = "write FACT from COMPONENT to COMPONENT; quote names that contain \
            `from` or `to`";
        let readings = self.readings(&production.graph, text);
        let (literals, from, to) = match readings.as_slice() {
            [reading] => reading.clone(),
            [] => {
                let label = self.why_unreadable(&production.graph, text);
                let message = format!("`{}` is not a protection interval", text.as_str());
                self.report.error(message, &text.span, &label, HELP);
                return None;
            }
            _ => {
                let message = format!("`{}` can be read in several ways", text.as_str());
                self.report.error(message, &text.span, "ambiguous", HELP);
                return None;
            }
        };
        if from >= to || !production.graph.leads(from, to) {
            let message = format!("`{}` protects nothing", text.as_str());
            let help = "let it begin at a component that comes before the one where it ends";
            self.report.error(message, &text.span, "ends before it begins", help);
            return None;
        }
        let condition = self.condition(&literals);
        Some(Interval { from, to, condition, is_derived: false })
    }

    /// Every way to split a text into facts, a begin and an end. Names may contain the words at
    /// which the text is split.
    fn readings(&self, graph: &Graph, text: &Text) -> Vec<(Vec<Literal>, u8, u8)> {
        let mut readings = Vec::new();
        let whole = text.as_str();
        for (at_from, _) in whole.match_indices(" from ") {
            for (at_to, _) in whole.match_indices(" to ").filter(|(at, _)| *at >= at_from + 5) {
                let Some(begins) = whole.get(at_from + 6..at_to) else { continue };
                let ends = &whole[at_to + 4..];
                let subject =
                    Spanned { value: whole[..at_from].to_owned(), span: text.span.clone() };
                if let (Some(literals), Some(from), Some(to)) =
                    (self.subject(&subject), begin(graph, begins), end(graph, ends))
                {
                    readings.push((literals, from, to));
                }
            }
        }
        readings
    }

    /// Known facts, joined by `and`.
    fn subject(&self, text: &Text) -> Option<Vec<Literal>> {
        let one = |part: &str| {
            let part = Spanned { value: part.trim().to_owned(), span: text.span.clone() };
            let literal = literal(part);
            let name = &literal.fact.value;
            let is_known = self.syntax.facts.iter().any(|fact| fact.name.value == *name)
                || self.syntax.is_broken(name);
            is_known.then_some(literal)
        };
        match one(text.as_str()) {
            Some(literal) => Some(vec![literal]),
            None => text.as_str().split(" and ").map(one).collect(),
        }
    }

    fn why_unreadable(&self, graph: &Graph, text: &Text) -> String {
        let Some((subject, rest)) = text.as_str().split_once(" from ") else {
            return "it lacks `from`".into();
        };
        let Some((begins, ends)) = rest.rsplit_once(" to ") else { return "it lacks `to`".into() };
        let subject = Spanned { value: subject.to_owned(), span: text.span.clone() };
        if self.subject(&subject).is_none() {
            format!("there is no fact `{}`", subject.as_str())
        } else if begin(graph, begins).is_none() {
            format!("`{begins}` is not part of this graph")
        } else {
            format!("`{ends}` is not part of this graph")
        }
    }
}

/// The vertex where the first component with a name begins, or the vertex with that name.
fn begin(graph: &Graph, name: &str) -> Option<u8> {
    let name = &*tidy(name.trim().trim_matches(['\'', '"']));
    let all = graph.edges.iter().filter(|edge| edge.component == name);
    all.map(|edge| edge.from).min().or_else(|| graph.vertex(name))
}

/// The vertex where the last component with a name ends, or the vertex with that name.
fn end(graph: &Graph, name: &str) -> Option<u8> {
    let name = &*tidy(name.trim().trim_matches(['\'', '"']));
    let all = graph.edges.iter().filter(|edge| edge.component == name);
    all.map(|edge| edge.to).max().or_else(|| graph.vertex(name))
}

/// What each frame needs from outside: its own initial and transient conditions, and those of the
/// components below it that no component before them in their production certainly provides.
/// Frames may contain each other, so this is repeated until nothing changes.
fn needs_of_frames(syntax: &syntax::Syntax, draft: &MissionDraft) -> Vec<Condition> {
    let mut needs = vec![Condition::default(); draft.frames.len()];
    loop {
        let before = needs.clone();
        for (index, frame) in syntax.frames.iter().enumerate() {
            let mut all = own_needs(draft, Symbol::PlanFrame(index as u16));
            let first = usize::from(draft.frames[index].first);
            for (written, production) in frame.productions.iter().zip(&draft.productions[first..]) {
                let edges = draft.edges_of(production);
                for edge in edges {
                    let earlier = edges.iter().filter(|e| written.graph.leads(e.to, edge.from));
                    let (adds, deletes) = earlier
                        .map(|earlier| effects::sure(draft, earlier.symbol))
                        .fold((0, 0), |all, one| (all.0 | one.0, all.1 | one.1));
                    let own = needs_of(draft, &before, edge.symbol);
                    let (must, must_not) = (own.must & !adds, own.must_not & !deletes);
                    all = all.and(Condition { must, must_not });
                }
            }
            needs[index] = all;
        }
        if needs == before {
            return needs;
        }
    }
}

/// What a component needs from outside.
fn needs_of(draft: &MissionDraft, needs: &[Condition], symbol: Symbol) -> Condition {
    match symbol {
        Symbol::PlanFrame(index) => needs.get(usize::from(index)).copied().unwrap_or_default(),
        Symbol::Action(_) => own_needs(draft, symbol),
    }
}

/// The initial and the transient condition of a component.
fn own_needs(draft: &MissionDraft, symbol: Symbol) -> Condition {
    let own = description(draft, symbol);
    own.map_or(Condition::default(), |description| description.initial.and(description.transient))
}

fn description(draft: &MissionDraft, symbol: Symbol) -> Option<&Description> {
    let index = match symbol {
        Symbol::PlanFrame(index) => draft.frames.get(usize::from(index))?.description,
        Symbol::Action(index) => draft.actions.get(usize::from(index))?.description,
    };
    draft.descriptions.get(usize::from(index))
}

/// The derived intervals of a production. If exactly one component certainly makes a fact true and
/// exactly one needs it, itself or somewhere below it, the fact is protected from the end of the
/// producer to the start of the consumer, or to its end if it needs the fact throughout or later. No interval is derived if a component
/// that may run in between may make the fact false, or if the mission already protects the fact
/// there.
fn derived(
    draft: &MissionDraft,
    needs: &[Condition],
    index: usize,
    graph: &Graph,
    first: usize,
) -> Vec<Interval> {
    let by_hand = draft.intervals.get(first..).unwrap_or(&[]);
    let mut intervals: Vec<Interval> = Vec::new();
    for bit in 0..draft.facts.len() {
        for is_negated in [false, true] {
            let fact: Facts = 1 << bit;
            let Some((from, to)) = causal_link(draft, needs, index, graph, fact, is_negated) else {
                continue;
            };
            let covers = |interval: &Interval| {
                let kept =
                    if is_negated { interval.condition.must_not } else { interval.condition.must };
                kept & fact != 0 && interval.from <= from && interval.to >= to
            };
            if by_hand.iter().any(covers) {
                continue;
            }
            let same = intervals.iter_mut().find(|known| known.from == from && known.to == to);
            let condition = match same {
                Some(known) => &mut known.condition,
                None => {
                    let condition = Condition::default();
                    intervals.push(Interval { from, to, condition, is_derived: true });
                    match intervals.last_mut() {
                        Some(last) => &mut last.condition,
                        None => continue,
                    }
                }
            };
            if is_negated {
                condition.must_not |= fact;
            } else {
                condition.must |= fact;
            }
        }
    }
    intervals
}

/// The vertices between which a fact must be kept for its only consumer.
fn causal_link(
    draft: &MissionDraft,
    needs: &[Condition],
    index: usize,
    graph: &Graph,
    fact: Facts,
    is_negated: bool,
) -> Option<(u8, u8)> {
    let production = draft.productions.get(index)?;
    let edges = draft.edges_of(production);
    // What makes the fact true and what makes it false; the reverse for the absence of a fact.
    let turned = |(adds, deletes): (Facts, Facts)| {
        let (for_it, against) = if is_negated { (deletes, adds) } else { (adds, deletes) };
        (for_it & fact != 0, against & fact != 0)
    };
    let may = |symbol: Symbol| turned(effects::possible(draft, symbol));
    let is_in = |condition: Condition| {
        fact & if is_negated { condition.must_not } else { condition.must } != 0
    };
    let needed = |symbol: Symbol| is_in(needs_of(draft, needs, symbol));
    let mut producers = edges.iter().enumerate().filter(|(_, edge)| may(edge.symbol).0);
    let mut consumers = edges.iter().enumerate().filter(|(_, edge)| needed(edge.symbol));
    let ((p, producer), (c, consumer)) = (producers.next()?, consumers.next()?);
    let is_single = producers.next().is_none() && consumers.next().is_none() && p != c;
    let is_sure = turned(effects::sure(draft, producer.symbol)).0;
    if !is_single || !is_sure || !graph.leads(producer.to, consumer.from) {
        return None;
    }
    if is_own_frame_below(draft, index, consumer.symbol) {
        // The interval would span the loop.
        return None;
    }
    let own = description(draft, consumer.symbol)?;
    let is_below = !is_in(own.initial) && !is_in(own.transient) && !may(consumer.symbol).1;
    let lasts = is_in(own.transient) || is_below;
    let (from, to) = (producer.to, if lasts { consumer.to } else { consumer.from });
    let comes_between = |at: usize| {
        let edge = &edges[at];
        at != p
            && at != c
            && !graph.leads(edge.to, producer.from)
            && !graph.leads(consumer.to, edge.from)
    };
    let is_kept = (0..edges.len()).all(|at| !comes_between(at) || !may(edges[at].symbol).1);
    (from < to && is_kept).then_some((from, to))
}

/// Whether the frame of a production can occur below a component of it, or is that component.
fn is_own_frame_below(draft: &MissionDraft, production: usize, symbol: Symbol) -> bool {
    let Symbol::PlanFrame(below) = symbol else { return false };
    let has = |frame: &PlanFrame| {
        let first = usize::from(frame.first);
        (first..first + usize::from(frame.count)).contains(&production)
    };
    let own = draft.frames.iter().position(has);
    own.is_some_and(|own| {
        own == usize::from(below) || effects::reaches(draft, usize::from(below), own)
    })
}
