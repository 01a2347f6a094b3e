//! What tags mean to a planner: OpenStreetMap's, and the same words as properties in GeoJSON.
//!
//! Source: the wiki of OpenStreetMap, "Map features". What blocks unless somebody says otherwise
//! is in `known`: what would stop or wreck a small rover. A user's [`TagRules`] come before it.
//! Keys and values are compared without regard to case, and of a list such as `wall;fence` every
//! part counts.
//!
//! Deliberately absent: bridges, which open no water; roads, which are no better than other
//! ground.

mod known;
mod rules;
mod unused;

pub use rules::{TagRule, TagRules};
pub(super) use unused::Unused;

use crate::model::Role;
use crate::problem::Problem;
use known::Kind;
use std::cell::Cell;

/// What `--help` says of tags.
pub const CONVENTIONS: &str = concat!(
    "Tags     (of GeoJSON and OpenStreetMap) What would stop a small rover blocks:\n         ",
    include_str!("tags/blocking.txt"),
);

/// Height of a storey where only their number is known, metres.
const STOREY_M: f64 = 3.0;
/// Values of `layer` that say that an area weakens radio.
const ATTENUATING: [&str; 3] = ["foliage", "comms", "nocommzone"];
/// Width of the opening that a gate makes where its tags give none, metres.
pub(super) const GATE_WIDTH_M: f64 = 2.0;
/// No gate is wider, metres: what says so is a mistake.
const MAX_GATE_WIDTH_M: f64 = 50.0;
/// No post or tree is thicker, metres.
const MAX_RADIUS_M: f64 = 20_000.0;

/// Keys and values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Tags(pub(super) Vec<(String, String)>);

/// What an object is to a planner.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meaning {
    pub(super) role: Role,
    /// Whether only the line counts, not what it encloses.
    pub(super) is_line: bool,
    /// By which a mission names it; empty where it has none.
    pub(super) name: String,
    /// Metres that an object blocks which is drawn as a point.
    pub(super) radius_m: f64,
    /// Whether a point says too little: the object has an outline that the file lacks.
    pub(super) wants_outline: bool,
    /// Whether gates open it.
    pub(super) is_barrier: bool,
}

impl Tags {
    /// The value of a key, trimmed; nothing where it is empty.
    pub(super) fn get(&self, key: &str) -> Option<&str> {
        let exact = self.0.iter().find(|(known, _)| known == key);
        let alike = || self.0.iter().find(|(known, _)| known.trim().eq_ignore_ascii_case(key));
        let (_, value) = exact.or_else(alike)?;
        Some(value.trim()).filter(|value| !value.is_empty())
    }

    /// Whether a key is there and does not say no.
    pub(super) fn says(&self, key: &str) -> bool {
        self.get(key).is_some_and(|value| !says_no(value))
    }

    /// Every key with each of its values that does not say no.
    fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().flat_map(|(key, values)| {
            let values = values.split(';').map(str::trim);
            values.filter(|value| !says_no(value)).map(move |value| (key.trim(), value))
        })
    }

    /// Height above ground, metres, where it is given and makes sense.
    pub(super) fn height_m(&self) -> Option<f64> {
        let given = self.get("height").and_then(length_m);
        let storeys = || self.get("building:levels")?.parse::<f64>().ok();
        let height = given.or_else(|| storeys().map(|storeys| storeys * STOREY_M));
        height.filter(|height: &f64| height.is_finite() && *height >= 0.0)
    }

    /// Whether it lies where a robot passes above it.
    fn is_below_ground(&self) -> bool {
        self.get("location").is_some_and(|at| at.eq_ignore_ascii_case("underground"))
            || self.says("tunnel")
    }
}

/// A length as tags write it: metres, with or without their unit.
fn length_m(text: &str) -> Option<f64> {
    text.strip_suffix('m').unwrap_or(text).trim().parse().ok()
}

fn says_no(value: &str) -> bool {
    value.is_empty() || ["no", "false", "0", "none"].iter().any(|no| value.eq_ignore_ascii_case(no))
}

/// Judges the objects of one file, and remembers what it was asked for in vain.
#[derive(Debug)]
pub(super) struct Judge<'a> {
    rules: &'a TagRules,
    /// Whether each rule met an object, in the order of [`TagRules::all`].
    used: Vec<Cell<bool>>,
    gates: Cell<usize>,
}

impl<'a> Judge<'a> {
    pub(super) fn new(rules: &'a TagRules) -> Self {
        let used = rules.all().map(|_| Cell::new(false)).collect();
        Self { rules, used, gates: Cell::new(0) }
    }

    /// Whether a rule blocks or frees a tag; nothing where none speaks of it. One with a value
    /// outranks one without; of two alike `block` wins.
    fn ruled(&self, key: &str, value: &str) -> Option<bool> {
        let mut best: Option<(bool, bool)> = None;
        for ((blocks, rule), used) in self.rules.all().zip(&self.used) {
            if rule.matches(key, value) {
                used.set(true);
                best = best.max(Some((rule.value.is_some(), blocks)));
            }
        }
        best.map(|(_, blocks)| blocks)
    }

    /// What an object is; `None` where it is nothing to a planner. A gate that is a point blocks
    /// nothing: what it stands in does.
    pub(super) fn meaning(&self, tags: &Tags, is_point: bool) -> Option<Meaning> {
        let mut found: Option<(Kind, &str)> = None;
        for (key, value) in tags.pairs() {
            let kind = match self.ruled(key, value) {
                Some(true) => Kind { role: Role::Obstacle, ..Kind::of(key, value) },
                Some(false) => continue,
                None if self.is_open(tags, key, value) => continue,
                None => match Kind::known(key, value) {
                    Some(kind) if kind.is_gate && is_point => continue,
                    Some(_) if tags.is_below_ground() => continue,
                    Some(kind) => kind,
                    None => continue,
                },
            };
            // An obstacle outranks an area that weakens radio, and an area a line.
            let rank = |kind: &Kind| (kind.role == Role::Obstacle, !kind.is_line);
            if found.as_ref().is_none_or(|(best, _)| rank(&kind) > rank(best)) {
                found = Some((kind, value));
            }
        }
        let (kind, value) = match found {
            Some(found) => found,
            None => layer(tags).filter(|(_, name)| self.ruled("layer", name) != Some(false))?,
        };
        let own = if kind.role == Role::Obstacle { "" } else { value };
        let given = tags.get("radius").and_then(length_m);
        let given = given.filter(|radius| (0.0..=MAX_RADIUS_M).contains(radius));
        Some(Meaning {
            role: kind.role,
            is_line: kind.is_line && !tags.says("area"),
            name: tags.get("name").unwrap_or(own).to_owned(),
            radius_m: given.unwrap_or(kind.radius_m),
            wants_outline: kind.wants_outline && given.is_none(),
            is_barrier: kind.is_barrier,
        })
    }

    /// Whether a tag is that of a gate which stands open.
    fn is_open(&self, tags: &Tags, key: &str, value: &str) -> bool {
        let is_locked = tags.says("locked");
        Kind::is_gate(key, value) && self.rules.open_gates && !is_locked
    }

    /// The width of the opening that an object makes in the barrier it stands in, metres.
    pub(super) fn opening_m(&self, tags: &Tags) -> Option<f64> {
        let mut opens = false;
        for (key, value) in tags.pairs() {
            let is_gate = Kind::is_gate(key, value);
            self.gates.set(self.gates.get() + usize::from(is_gate));
            opens |= match self.ruled(key, value) {
                Some(blocks) => !blocks && key.eq_ignore_ascii_case("barrier"),
                None => self.is_open(tags, key, value) || Kind::is_entrance(key, value),
            };
        }
        let widths = ["width", "maxwidth:physical", "maxwidth"];
        let given = widths.iter().find_map(|key| tags.get(key).and_then(length_m));
        let given = given.filter(|width| *width > 0.0 && *width <= MAX_GATE_WIDTH_M);
        opens.then(|| given.unwrap_or(GATE_WIDTH_M))
    }

    /// A warning for each rule that met nothing.
    pub(super) fn tell(&self, problems: &mut Vec<Problem>) {
        for ((blocks, rule), used) in self.rules.all().zip(&self.used) {
            if !used.get() {
                let word = if blocks { "block" } else { "free" };
                let message = format!("nothing on the map is {rule}, which `{word}` asks for");
                let help = "check key and value: the note on the map lists what it holds";
                problems.push(rule.point_at(Problem::warning(message).help(help)));
            }
        }
        if self.rules.open_gates && self.gates.get() == 0 {
            problems.push(
                Problem::warning("the map has no gates, which `open_gates` asks for")
                    .help("draw points with barrier=gate in the line of the fence"),
            );
        }
    }
}

/// What the property `layer` makes of an object. In OpenStreetMap it is the number of a level,
/// which means nothing here.
fn layer(tags: &Tags) -> Option<(Kind, &str)> {
    let layer = tags.get("layer").filter(|layer| layer.parse::<f64>().is_err())?;
    let weakens = ATTENUATING.iter().any(|known| layer.eq_ignore_ascii_case(known));
    let role = if weakens { Role::Attenuating } else { Role::Zone };
    Some((Kind { role, ..Kind::AREA }, layer))
}

#[cfg(test)]
mod tests;
