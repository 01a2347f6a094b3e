//! Actions, frames and their productions.

use super::Lowering;
use crate::behaviours::syntax::{self, Doing, FactSyntax};
use crate::toml::{Span, Text};
use plan_format::limits;
use plan_format::mission::{
    Action, ActionKind, Description, Edge, Facts, PlanFrame, Production, Symbol,
};
use plan_format::parameters::Gains;

/// The resource that every action that drives or holds occupies.
const MOTION: &str = "motion";

impl Lowering<'_> {
    /// Everything except protection intervals and the effects of frames.
    pub(super) fn components(&mut self) {
        let syntax = self.syntax;
        for action in &syntax.actions {
            let action = self.action(action);
            self.draft.actions.push(action);
        }
        for frame in &syntax.frames {
            let description = self.description(&frame.description);
            let name = self.draft.name(frame.name.as_str());
            let first = self.draft.productions.len() as u16;
            if frame.productions.len() > limits::MAX_ALTERNATIVES {
                let (limit, count) = (limits::MAX_ALTERNATIVES, frame.productions.len());
                let message =
                    format!("a frame has at most {limit} productions; this one has {count}");
                let help = "move some of them into a separate frame";
                self.report.error(message, &frame.name.span, "this frame", help);
            }
            for production in &frame.productions {
                self.production(production);
            }
            let until = self.condition(&frame.until);
            self.draft.frames.push(PlanFrame {
                name,
                first,
                count: frame.productions.len().min(usize::from(u8::MAX)) as u8,
                description,
                threshold: frame.threshold.value,
                until,
                timeout_ms: frame.timeout_ms,
                may_add: 0,
                may_delete: 0,
                resources: 0,
            });
        }
    }

    fn action(&mut self, action: &syntax::Action) -> Action {
        let span = &action.name.span;
        let motion = |lowering: &mut Self| lowering.resource(MOTION, span);
        let (kind, occupied) = match &action.kind {
            Doing::Follow { plan, reactive, advice } => {
                let plan = self.plan(plan);
                let noise = Gains::NOISE;
                let kind = ActionKind::Follow { plan, reactive: *reactive, advice: *advice, noise };
                (kind, motion(self))
            }
            &Doing::GoTo([x_m, y_m]) => (ActionKind::GoTo { x_m, y_m }, motion(self)),
            &Doing::Hold { for_ms } => (ActionKind::Hold { for_ms }, motion(self)),
            &Doing::Wait { for_ms } => (ActionKind::Hold { for_ms }, 0),
            Doing::Return => (ActionKind::Return, motion(self)),
            &Doing::MoveAhead { direction_rad, for_ms } => {
                (ActionKind::MoveAhead { direction_rad, for_ms }, motion(self))
            }
            &Doing::Dock { at: [x_m, y_m], direction_rad, radius_cm } => {
                (ActionKind::Dock { x_m, y_m, direction_rad, radius_cm }, motion(self))
            }
            &Doing::Wander { for_ms } => (ActionKind::Wander { for_ms }, motion(self)),
            &Doing::Signal { code } => (ActionKind::Signal { code }, 0),
            &Doing::SetOutput { output, is_on } => {
                let occupied = self.resource(&format!("output {output}"), span);
                (ActionKind::SetOutput { output, is_on }, occupied)
            }
        };
        let resources = occupied | self.resources(&action.resources);
        Action {
            name: self.draft.name(action.name.as_str()),
            kind,
            description: self.description(&action.description),
            until: self.condition(&action.until),
            timeout_ms: action.timeout_ms,
            resources,
        }
    }

    /// The index of a description; equal ones are stored once.
    fn description(&mut self, description: &syntax::Description) -> u16 {
        let record = Description {
            initial: self.condition(&description.initial),
            transient: self.condition(&description.transient),
            goal: self.condition(&description.goal),
            add: self.symbols(&description.add),
            delete: description.delete.iter().fold(0, |bits, name| bits | self.fact(name)),
            max_speed_mps: description.max_speed_mps.unwrap_or(f32::INFINITY),
            min_distance_m: description.min_distance_m,
        };
        for name in &description.delete {
            if record.add & self.fact(name) != 0 {
                let message = format!("`{}` is both added and deleted", name.as_str());
                self.report.error(message, &name.span, "deleted here", "remove one of the two");
            }
        }
        let known = self.draft.descriptions.iter().position(|known| *known == record);
        known.unwrap_or_else(|| {
            self.draft.descriptions.push(record);
            self.draft.descriptions.len() - 1
        }) as u16
    }

    /// The bits of symbols that a component adds at its end.
    fn symbols(&mut self, names: &[Text]) -> Facts {
        let mut bits = 0;
        for name in names {
            let bit = self.fact(name);
            let fact = self.syntax.facts.iter().find(|fact| fact.name.value == name.value);
            if fact.is_some_and(|fact| !matches!(fact.kind, FactSyntax::Symbol { .. })) {
                let message = format!("`{}` is sensed and cannot be added", name.as_str());
                let help = "put it into `goal`: it must hold at the end";
                self.report.error(message, &name.span, "only symbols can be added", help);
            }
            bits |= bit;
        }
        bits
    }

    fn production(&mut self, production: &syntax::Production) {
        let rules = production.rules.as_ref().map(|rules| self.rule_base(rules));
        let name = self.draft.name(production.name.as_str());
        let first_edge = self.draft.edges.len() as u16;
        for edge in &production.graph.edges {
            let symbol = self.symbol(&edge.component, &edge.span);
            let work = production.work.iter().find(|(name, _)| name.value == edge.component);
            let work = work.map_or(0, |&(_, work)| work);
            self.draft.edges.push(Edge { from: edge.from, to: edge.to, symbol, work });
        }
        for (name, _) in &production.work {
            let names = production.graph.edges.iter().map(|edge| edge.component.as_str());
            if !names.clone().any(|known| known == name.as_str()) {
                self.unknown("component", name, names, "it is not part of this graph");
            }
        }
        self.draft.productions.push(Production {
            name,
            rules,
            first_edge,
            edges: production.graph.edges.len() as u8,
            vertices: production.graph.vertices,
            first_interval: 0,
            intervals: 0,
        });
    }

    fn symbol(&mut self, name: &str, span: &Span) -> Symbol {
        let syntax = self.syntax;
        if let Some(index) = syntax.frames.iter().position(|frame| frame.name.value == name) {
            return Symbol::PlanFrame(index as u16);
        }
        if let Some(index) = syntax.actions.iter().position(|action| action.name.value == name) {
            return Symbol::Action(index as u16);
        }
        let frames = syntax.frames.iter().map(|frame| frame.name.as_str());
        let known = frames.chain(syntax.actions.iter().map(|action| action.name.as_str()));
        let text = Text { value: name.to_owned(), span: span.clone() };
        let how = format!("define it as [actions.\"{name}\"] or [frames.\"{name}\"]");
        self.unknown("frame or action", &text, known, &how);
        Symbol::Action(0)
    }
}
