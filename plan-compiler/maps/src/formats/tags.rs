//! The meaning of tags to a planner: OpenStreetMap's tags, and the same words as GeoJSON
//! properties.
//!
//! Source: the wiki of OpenStreetMap, "Map features". `known` lists what blocks by
//! default: objects that would stop or wreck a small rover. A user's [`TagRules`] take precedence.
//! Keys and values are compared without regard to case; in a list such as `wall;fence` each part
//! counts.
//!
//! Deliberately absent: bridges do not open water; roads are not preferred to other ground.

mod known;
mod rules;
mod unused;

pub use rules::{TagRule, TagRules};
pub(super) use unused::Unused;

use crate::model::Role;
use crate::problem::Problem;
use known::Kind;
use std::cell::Cell;

/// Tags in `--help`.
pub const CONVENTIONS: &str = concat!(
    "Tags     (of GeoJSON and OpenStreetMap) Objects that would stop a small rover block:\n         ",
    include_str!("tags/blocking.txt"),
);

/// Height of a storey if only the number of storeys is known, metres.
const STOREY_M: f64 = 3.0;
/// Values of `layer` that mark an area that weakens radio.
const ATTENUATING: [&str; 3] = ["foliage", "comms", "nocommzone"];
/// Width of a gate's opening if its tags do not give it, metres.
pub(super) const GATE_WIDTH_M: f64 = 2.0;
/// Largest credible width of a gate, metres.
const MAX_GATE_WIDTH_M: f64 = 50.0;
/// Largest credible `radius`, metres.
const MAX_RADIUS_M: f64 = 20_000.0;

/// Keys and values of an object.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Tags(pub(super) Vec<(String, String)>);

/// The meaning of an object to a planner.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meaning {
    pub(super) role: Role,
    /// Whether only the line counts, not the enclosed area.
    pub(super) is_line: bool,
    /// Name for missions; may be empty.
    pub(super) name: String,
    /// Radius that the object blocks if it is drawn as a point, metres.
    pub(super) radius_m: f64,
    /// Whether a point is not enough: the object has an outline that the file lacks.
    pub(super) wants_outline: bool,
    /// Whether gates open it.
    pub(super) is_barrier: bool,
    /// Height above ground, metres, if it is given or the object is flat.
    pub(super) height_m: Option<f64>,
}

impl Tags {
    /// The value of a key, trimmed; `None` if it is missing or empty.
    pub(super) fn get(&self, key: &str) -> Option<&str> {
        let exact = self.0.iter().find(|(known, _)| known == key);
        let alike = || self.0.iter().find(|(known, _)| known.trim().eq_ignore_ascii_case(key));
        let (_, value) = exact.or_else(alike)?;
        Some(value.trim()).filter(|value| !value.is_empty())
    }

    /// Whether a key is present and its value does not mean no.
    pub(super) fn is_set(&self, key: &str) -> bool {
        self.get(key).is_some_and(|value| !is_no(value))
    }

    /// Every key with each of its values that does not mean no.
    fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().flat_map(|(key, values)| {
            let values = values.split(';').map(str::trim);
            values.filter(|value| !is_no(value)).map(move |value| (key.trim(), value))
        })
    }

    /// Height above ground, metres, if a credible one is given.
    fn height_m(&self) -> Option<f64> {
        let given = self.get("height").and_then(length_m);
        let storeys = || self.get("building:levels")?.parse::<f64>().ok();
        let height = given.or_else(|| storeys().map(|storeys| storeys * STOREY_M));
        height.filter(|height: &f64| height.is_finite() && *height >= 0.0)
    }

    /// The `radius`, metres; `None` if it is missing or not a credible length.
    fn radius_m(&self) -> Option<f64> {
        let radius = self.get("radius").and_then(length_m);
        radius.filter(|radius| (0.0..=MAX_RADIUS_M).contains(radius))
    }

    /// An error if there is a `radius` that is not a credible length.
    pub(super) fn check_radius(&self, name: &str) -> Option<Problem> {
        let text = self.get("radius").filter(|_| self.radius_m().is_none())?;
        let message =
            format!("the radius of {name} is not a length from 0 to {MAX_RADIUS_M} m: {text}");
        Some(Problem::error(message).help("write it in metres, with a decimal point"))
    }

    /// Whether it lies underground, so that a robot passes above it.
    fn is_below_ground(&self) -> bool {
        self.get("location").is_some_and(|at| at.eq_ignore_ascii_case("underground"))
            || self.is_set("tunnel")
    }
}

/// A length in tags: metres, with or without the unit, or feet and inches: `12 ft`, `7'`, `7'4"`.
fn length_m(text: &str) -> Option<f64> {
    const FOOT_M: f64 = 0.3048;
    let number = |text: &str| text.trim().parse::<f64>().ok();
    if let Some(feet) = text.strip_suffix("ft") {
        return Some(number(feet)? * FOOT_M);
    }
    if let Some((feet, inches)) = text.split_once('\'') {
        let inches = inches.trim().trim_end_matches('"');
        let inches = if inches.is_empty() { 0.0 } else { number(inches)? };
        return Some((number(feet)? + inches / 12.0) * FOOT_M);
    }
    number(text.strip_suffix('m').unwrap_or(text))
}

fn is_no(value: &str) -> bool {
    value.is_empty() || ["no", "false", "0", "none"].iter().any(|no| value.eq_ignore_ascii_case(no))
}

/// Judges the objects of one file and tracks which rules matched.
#[derive(Debug)]
pub(super) struct Judge<'a> {
    pub(super) rules: &'a TagRules,
    /// Whether each rule matched an object, in the order of [`TagRules::all`].
    used: Vec<Cell<bool>>,
    gates: Cell<usize>,
}

impl<'a> Judge<'a> {
    pub(super) fn new(rules: &'a TagRules) -> Self {
        let used = rules.all().map(|_| Cell::new(false)).collect();
        Self { rules, used, gates: Cell::new(0) }
    }

    /// Whether a rule blocks (true) or frees a tag; `None` if no rule matches. A rule with a value
    /// outranks one without; between equals `block` wins.
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

    /// The meaning of an object; `None` if it has none. A gate that is a point blocks nothing: its
    /// fence does.
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
            None => {
                let drawn =
                    layer(tags).filter(|(_, name)| self.ruled("layer", name) != Some(false));
                match drawn {
                    Some(drawn) => drawn,
                    None => return self.kept(tags),
                }
            }
        };
        let own = if kind.role == Role::Obstacle { "" } else { value };
        let given = tags.radius_m();
        Some(Meaning {
            role: kind.role,
            is_line: kind.is_line && !tags.is_set("area"),
            name: tags.get("name").unwrap_or(own).to_owned(),
            radius_m: given.unwrap_or(kind.radius_m),
            wants_outline: kind.wants_outline && given.is_none(),
            is_barrier: kind.is_barrier,
            height_m: tags.height_m().or(kind.is_flat.then_some(0.0)),
        })
    }

    /// The zone of an object that a mission names by one of its tags.
    fn kept(&self, tags: &Tags) -> Option<Meaning> {
        let mut rules = self.rules.keep.iter();
        let (rule, kind) = rules.find_map(|rule| {
            let (key, value) = tags.pairs().find(|(key, value)| rule.matches(key, value))?;
            Some((rule, Kind { role: Role::Zone, ..Kind::of(key, value) }))
        })?;
        Some(Meaning {
            role: kind.role,
            is_line: kind.is_line && !tags.is_set("area"),
            name: rule.to_string(),
            radius_m: 0.0,
            wants_outline: false,
            is_barrier: false,
            height_m: None,
        })
    }

    /// Whether a tag marks an open gate.
    fn is_open(&self, tags: &Tags, key: &str, value: &str) -> bool {
        let is_locked = tags.is_set("locked");
        Kind::is_gate(key, value) && self.rules.open_gates && !is_locked
    }

    /// Width of the opening that an object makes in its barrier, metres; `None` if it makes none.
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

    /// Adds a warning for each rule that matched nothing.
    pub(super) fn report(&self, problems: &mut Vec<Problem>) {
        for ((blocks, rule), used) in self.rules.all().zip(&self.used) {
            if !used.get() {
                let word = if blocks { "block" } else { "free" };
                let message = format!("`{word}` {rule} matches nothing on the map");
                let help = "check key and value: the note on the map lists its objects";
                problems.push(rule.point_at(Problem::warning(message).help(help)));
            }
        }
        if self.rules.open_gates && self.gates.get() == 0 {
            problems.push(
                Problem::warning("`open_gates` has no effect: the map has no gates")
                    .help("draw points with barrier=gate on the line of the fence"),
            );
        }
    }
}

/// The kind that the property `layer` gives an object. In OpenStreetMap `layer` is the number of a
/// level, which is ignored here.
fn layer(tags: &Tags) -> Option<(Kind, &str)> {
    let layer = tags.get("layer").filter(|layer| layer.parse::<f64>().is_err())?;
    let weakens = ATTENUATING.iter().any(|known| layer.eq_ignore_ascii_case(known));
    let role = if weakens { Role::Attenuating } else { Role::Zone };
    Some((Kind { role, ..Kind::AREA }, layer))
}

#[cfg(test)]
mod tests;
