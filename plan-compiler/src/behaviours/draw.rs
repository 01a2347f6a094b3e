//! Behaviours and their plans as graphs: DOT for other tools, and a picture of our own (H41).
//!
//! The blob's tables are drawn, so a mission file and its blob give the same picture. Layout and
//! font are our own: neither Graphviz nor a system font is needed.

mod dot;
mod picture;

pub use dot::dot;
pub use picture::picture;

use plan_format::mission::{
    Action, ActionKind, Behaviour, Condition, Facts, Label, Mission, PlanFrame, Production, Source,
    Symbol,
};

/// A mission to draw.
#[derive(Clone, Copy)]
pub struct Drawn<'d> {
    /// The mission.
    pub mission: Mission<'d>,
    /// The names of the parallel plans that actions follow; empty if they are not known.
    pub plans: &'d [String],
}

/// The seven columns of every table.
const LABELS: [&str; 7] = ["NB", "NM", "NS", "ZO", "PS", "PM", "PB"];

impl<'d> Drawn<'d> {
    /// The name of the component on an edge.
    fn symbol(&self, symbol: Symbol) -> &'d str {
        let name = match symbol {
            Symbol::PlanFrame(index) => {
                self.mission.plan_frames().get(usize::from(index)).map(|frame| frame.name)
            }
            Symbol::Action(index) => {
                self.mission.actions().get(usize::from(index)).map(|action| action.name)
            }
        };
        name.map_or("", |name| self.mission.name(name))
    }

    fn frame(&self, index: u16) -> &'d str {
        self.symbol(Symbol::PlanFrame(index))
    }

    /// The rows of a rule base: each input with its seven labels.
    fn rows(&self, rules: u16) -> Vec<(&'d str, [Label; 7])> {
        let Some(base) = self.mission.rule_bases().get(usize::from(rules)) else {
            return Vec::new();
        };
        let rules = self.mission.rules_of(&base);
        let input = |index: u8| self.mission.inputs().get(usize::from(index));
        rules
            .map(|rule| {
                (
                    input(rule.input).map_or("", |input| self.mission.name(input.name)),
                    rule.labels.labels(),
                )
            })
            .collect()
    }

    /// Inputs that are results of rules, with their rules.
    fn derived_inputs(&self) -> impl Iterator<Item = (&'d str, u16)> + '_ {
        self.mission.inputs().iter().filter_map(|input| match input.source {
            Source::Rules(rules) => Some((self.mission.name(input.name), rules)),
            _ => None,
        })
    }

    /// `on field, not stuck`
    fn condition(&self, condition: Condition) -> String {
        let names = |facts: Facts, prefix: &'static str| {
            self.mission
                .facts()
                .iter()
                .enumerate()
                .filter(move |(bit, _)| facts & 1 << bit != 0)
                .map(move |(_, fact)| format!("{prefix}{}", self.mission.name(fact.name)))
        };
        let all: Vec<String> =
            names(condition.must, "").chain(names(condition.must_not, "not ")).collect();
        all.join(", ")
    }

    /// What an action does, as the mission file writes it.
    fn doing(&self, action: &Action) -> String {
        match action.kind {
            ActionKind::Follow { plan, reactive, advice, .. } => {
                let number = plan.to_string();
                let plan = self.plans.get(usize::from(plan)).unwrap_or(&number);
                format!("follow {plan} at {:.0}:{:.0}", reactive * 100.0, advice * 100.0)
            }
            ActionKind::GoTo { x_m, y_m } => format!("go-to {x_m}, {y_m}"),
            ActionKind::Hold { for_ms } => format!("hold {} s", f64::from(for_ms) / 1e3),
            ActionKind::Wander { for_ms } => format!("wander {} s", f64::from(for_ms) / 1e3),
            ActionKind::Signal { code } => format!("signal {code}"),
            ActionKind::SetOutput { output, is_on } => {
                format!("set-output {output} {}", if is_on { "on" } else { "off" })
            }
            ActionKind::Return => "return".to_owned(),
            ActionKind::MoveAhead { direction_rad, for_ms } => {
                format!("move-ahead {} for {} s", compass(direction_rad), f64::from(for_ms) / 1e3)
            }
            ActionKind::Dock { x_m, y_m, direction_rad, radius_cm } => {
                let (facing, radius_m) = (compass(direction_rad), f64::from(radius_cm) / 1e2);
                format!("dock {x_m}, {y_m} facing {facing} from {radius_m} m")
            }
        }
    }

    /// A component's action and description, one line per part.
    fn details(&self, symbol: Symbol) -> String {
        let mut lines = Vec::new();
        if let Symbol::Action(index) = symbol
            && let Some(action) = self.mission.actions().get(usize::from(index))
        {
            lines.push(self.doing(&action));
            if !action.until.is_empty() {
                lines.push(format!("until {}", self.condition(action.until)));
            }
        }
        if let Symbol::PlanFrame(index) = symbol
            && let Some(frame) = self.mission.plan_frames().get(usize::from(index))
        {
            if !frame.until.is_empty() {
                lines.push(format!("until {}", self.condition(frame.until)));
            }
            if frame.timeout_ms != 0 {
                lines.push(format!("timeout {} s", f64::from(frame.timeout_ms) / 1e3));
            }
        }
        if let Some(description) = self.mission.description(symbol) {
            let change = |must| Condition { must, must_not: 0 };
            for (what, condition) in [
                ("initial", description.initial),
                ("transient", description.transient),
                ("goal", description.goal),
                ("add", change(description.add)),
                ("delete", change(description.delete)),
            ] {
                if !condition.is_empty() {
                    lines.push(format!("{what} {}", self.condition(condition)));
                }
            }
        }
        lines.join("\n")
    }

    /// When a behaviour is engaged and left, in words.
    fn policy(&self, behaviour: &Behaviour) -> Vec<String> {
        let mut lines = vec![format!("plan {}", self.frame(behaviour.root))];
        if let Some(frame) = behaviour.start_up {
            lines.push(format!("start-up {}", self.frame(frame)));
        }
        if let Some(frame) = behaviour.shut_down {
            lines.push(format!("shut-down {}", self.frame(frame)));
        }
        lines.push(format!(
            "dormant to {:.3}, at once from {:.3}",
            behaviour.dormant, behaviour.unconditional
        ));
        let (dwell_s, hysteresis) = (f64::from(behaviour.dwell_ms) / 1e3, behaviour.hysteresis);
        lines.push(format!("hysteresis {hysteresis}, dwell {dwell_s} s"));
        if behaviour.once {
            lines.push("once".to_owned());
        }
        lines
    }

    /// A frame's name with its threshold, if a production has rules.
    fn frame_title(&self, frame: &PlanFrame) -> String {
        let name = self.mission.name(frame.name);
        let has_rules = self.mission.productions_of(frame).any(|p| p.rules.is_some());
        if has_rules { format!("{name}, from {:.3}", frame.threshold) } else { name.to_owned() }
    }

    /// A production's name; empty if it is the frame's.
    fn production_title(&self, frame: &PlanFrame, production: &Production) -> &'d str {
        let name = self.mission.name(production.name);
        if name == self.mission.name(frame.name) { "" } else { name }
    }
}

/// A direction, radians counter-clockwise from east, as a compass heading, to a tenth of a degree.
fn compass(direction_rad: f32) -> f64 {
    let tenths = (900.0 - f64::from(direction_rad).to_degrees() * 10.0).round();
    // Never -0.
    tenths.rem_euclid(3600.0).abs() / 10.0
}

#[cfg(test)]
mod tests;
