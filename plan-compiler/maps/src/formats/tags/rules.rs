//! A user's rules for tags, by key and value.

use crate::problem::{Place, Problem};
use std::fmt;
use std::str::FromStr;

/// A tag in a rule: `natural=water`, or `waterway` for every value of a key.
#[derive(Clone, Debug)]
pub struct TagRule {
    /// The key; compared without regard to case.
    pub key: String,
    /// The value; `None` for any.
    pub value: Option<String>,
    /// Its place in a mission file; `None` if it came from the command line.
    pub place: Option<Place>,
}

/// Rules that override the default meaning of tags.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TagRules {
    /// Tags of obstacles.
    pub block: Vec<TagRule>,
    /// Tags of free ground.
    pub free: Vec<TagRule>,
    /// Tags of objects that have no effect of their own but are kept as zones, which are named like
    /// the rule: `landuse=grass`.
    pub keep: Vec<TagRule>,
    /// Zones that the caller uses itself, by name: they are not without effect.
    pub used: Vec<String>,
    /// Whether gates without `locked` open their barrier.
    pub open_gates: bool,
}

impl TagRules {
    /// Whether the rules are the default.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Every rule, and whether it blocks.
    pub(super) fn all(&self) -> impl Iterator<Item = (bool, &TagRule)> {
        let block = self.block.iter().map(|rule| (true, rule));
        block.chain(self.free.iter().map(|rule| (false, rule)))
    }
}

impl TagRule {
    pub(super) fn matches(&self, key: &str, value: &str) -> bool {
        let is_value = |wanted: &String| wanted.eq_ignore_ascii_case(value);
        self.key.eq_ignore_ascii_case(key) && self.value.as_ref().is_none_or(is_value)
    }

    pub(super) fn point_at(&self, problem: Problem) -> Problem {
        match &self.place {
            Some(place) => problem.at(&place.source, place.span.clone(), "asked for here"),
            None => problem,
        }
    }
}

/// Compares key and value, not the place.
impl PartialEq for TagRule {
    fn eq(&self, other: &Self) -> bool {
        (&self.key, &self.value) == (&other.key, &other.value)
    }
}

impl FromStr for TagRule {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, value) = match text.split_once('=') {
            Some((key, value)) => (key.trim(), Some(value.trim())),
            None => (text.trim(), None),
        };
        if key.is_empty() || value == Some("") || key.contains('*') {
            return Err("write KEY=VALUE or KEY, for example natural=water or waterway".into());
        }
        let value = value.filter(|value| *value != "*").map(str::to_owned);
        Ok(Self { key: key.to_owned(), value, place: None })
    }
}

impl fmt::Display for TagRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.value.as_deref().unwrap_or("*"))
    }
}
