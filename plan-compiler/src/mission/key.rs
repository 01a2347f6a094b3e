//! What a key of a mission file is: its place, its meaning, and what it may be.

use super::Mission;
use maps::formats::TagRule;
use math::GeoPoint;

/// A key with one value. `[goals]`, `[layers]` and `[masks]` have names of the user's instead.
#[derive(Debug)]
pub struct Key {
    /// Its table; empty at the top of the file.
    pub section: &'static str,
    /// Its name.
    pub name: &'static str,
    /// What it sets.
    pub meaning: &'static str,
    /// Its value if the file does not have it, as it would be written; empty where that
    /// depends.
    pub default: &'static str,
    /// What it may be.
    pub kind: Kind,
}

/// Sets one thing of a mission.
type Set<T> = fn(&mut Mission, T);

/// Words, each with what it does.
type Words = &'static [(&'static str, fn(&mut Mission))];

/// What a key may be, and what it does.
#[derive(Debug)]
pub enum Kind {
    /// A number in a unit, within the range that the robot's parameters or `own` allow.
    Number {
        /// The unit, or empty.
        unit: &'static str,
        /// Whether it has no fraction.
        whole: bool,
        /// The range where the parameters do not check it.
        own: Option<(f64, f64)>,
        /// What it does.
        set: Set<f64>,
    },
    /// One of several words.
    Word {
        /// Each with what it does.
        words: Words,
    },
    /// `true` or `false`.
    Flag {
        /// What it does.
        set: Set<bool>,
    },
    /// Any text.
    Text,
    /// A list of tags.
    Tags {
        /// What it does.
        set: Set<Vec<TagRule>>,
    },
    /// A latitude and a longitude.
    Place {
        /// What it does.
        set: Set<Option<GeoPoint>>,
    },
}

impl Key {
    /// Whether this is the key of that name in that table.
    pub fn is(&self, section: &str, name: &str) -> bool {
        self.section == section && self.name == name
    }

    /// `section.name`.
    pub fn path(&self) -> String {
        match self.section {
            "" => self.name.to_owned(),
            section => format!("{section}.{}", self.name),
        }
    }

    /// Whether a number is in range.
    pub fn accepts(&self, number: f64) -> bool {
        let (low, high) = self.range();
        let whole = matches!(self.kind, Kind::Number { whole: true, .. });
        (low..=high).contains(&number) && (!whole || number.fract() == 0.0)
    }

    /// Lowest and highest number.
    fn range(&self) -> (f64, f64) {
        let Kind::Number { own, set, .. } = self.kind else { return (0.0, 0.0) };
        own.unwrap_or_else(|| {
            // No range holds what is not a number, so the check names the range of the one
            // parameter that is none.
            let mut mission = Mission::default();
            set(&mut mission, f64::NAN);
            let widest = (f64::NEG_INFINITY, f64::INFINITY);
            let exact = |bound: f32| bound.to_string().parse().unwrap_or(f64::from(bound));
            mission.parameters.check().map_or(widest, |(_, low, high)| (exact(low), exact(high)))
        })
    }

    /// What it may be, for a sentence: `a number from 0 to 50 m/s`.
    pub fn expected(&self) -> String {
        match &self.kind {
            Kind::Number { unit, whole, .. } => {
                let (low, high) = self.range();
                let kind = if *whole { "a whole number" } else { "a number" };
                format!("{kind} from {low} to {high} {unit}").trim_end().to_owned()
            }
            Kind::Word { .. } => {
                let words: Vec<String> = self.words().map(|word| format!("\"{word}\"")).collect();
                words.join(" or ")
            }
            Kind::Flag { .. } => "true or false".into(),
            Kind::Text => "a text".into(),
            Kind::Tags { .. } => "a list of texts KEY=VALUE or KEY".into(),
            Kind::Place { .. } => "[latitude, longitude] in degrees".into(),
        }
    }

    /// Its words, if it has any.
    pub fn words(&self) -> impl Iterator<Item = &'static str> + Clone {
        let words: Words = if let Kind::Word { words } = self.kind { words } else { &[] };
        words.iter().map(|(word, _)| *word)
    }

    /// A right line for it, without its table.
    pub fn example(&self) -> String {
        let value = match (&self.kind, self.default) {
            (Kind::Text, _) => "\"NAME\"",
            (Kind::Tags { .. }, _) => "[\"natural=water\", \"waterway\"]",
            (Kind::Place { .. }, _) => "[51.4779, -0.0015]",
            (Kind::Number { .. }, _) if self.default.is_empty() || self.follows() => "1.0",
            (_, default) => default,
        };
        format!("{} = {value}", self.name)
    }

    /// A mission file that holds nothing else.
    pub fn example_with(&self, value: &str) -> String {
        match self.section {
            "" => format!("{} = {value}\n", self.name),
            section => format!("[{section}]\n{} = {value}\n", self.name),
        }
    }

    /// Whether its default follows from other keys; it is then a formula instead of a value.
    pub fn follows(&self) -> bool {
        self.default.starts_with("follows: ")
    }

    /// Its row in the documentation's table.
    pub fn row(&self) -> String {
        let default = match self.default {
            "" => String::new(),
            formula if self.follows() => formula.to_owned(),
            default => format!("`{default}`"),
        };
        let expected = self.expected();
        format!("| `{}` | {expected} | {default} | {} |", self.path(), self.meaning)
    }
}

/// A number that `Parameters::check` holds to its range.
pub(super) const fn number(
    section: &'static str,
    name: &'static str,
    unit: &'static str,
    default: &'static str,
    meaning: &'static str,
    set: Set<f64>,
) -> Key {
    Key {
        section,
        name,
        meaning,
        default,
        kind: Kind::Number { unit, whole: false, own: None, set },
    }
}

/// A number with a range of its own.
pub(super) const fn ranged(key: Key, low: f64, high: f64) -> Key {
    let Kind::Number { unit, whole, set, .. } = key.kind else { return key };
    Key { kind: Kind::Number { unit, whole, own: Some((low, high)), set }, ..key }
}

/// A number without a fraction, in a range of its own.
pub(super) const fn counted(key: Key, low: f64, high: f64) -> Key {
    let Kind::Number { unit, set, .. } = key.kind else { return key };
    Key { kind: Kind::Number { unit, whole: true, own: Some((low, high)), set }, ..key }
}

/// One of several words.
pub(super) const fn word(
    section: &'static str,
    name: &'static str,
    default: &'static str,
    meaning: &'static str,
    words: Words,
) -> Key {
    Key { section, name, meaning, default, kind: Kind::Word { words } }
}

/// A text.
pub(super) const fn text(name: &'static str, meaning: &'static str) -> Key {
    Key { section: "", name, meaning, default: "", kind: Kind::Text }
}

pub(super) const fn flag(
    section: &'static str,
    name: &'static str,
    default: &'static str,
    meaning: &'static str,
    set: Set<bool>,
) -> Key {
    Key { section, name, meaning, default, kind: Kind::Flag { set } }
}
