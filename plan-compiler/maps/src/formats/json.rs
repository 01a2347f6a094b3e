//! Helpers for JSON readers: positions of mistakes, and bounded lists.

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;

/// Byte at which the parser stopped, moved to a character boundary: it counts bytes and may stop
/// inside a character.
pub(super) fn place_of(text: &str, error: &serde_json::Error) -> usize {
    // Lines and columns count from 1.
    let before = text.split_inclusive('\n').take(error.line().saturating_sub(1));
    let at = before.map(str::len).sum::<usize>() + error.column().saturating_sub(1);
    text.floor_char_boundary(at.min(text.len()))
}

/// The parser's message without its line and column, and without words of this program's language.
pub(super) fn reason_of(error: &serde_json::Error) -> String {
    let reason = error.to_string();
    let reason = reason.rsplit_once(" at line ").map_or(reason.as_str(), |(reason, _)| reason);
    let types =
        reason.strip_prefix("invalid type: ").and_then(|types| types.rsplit_once(", expected "));
    let Some((found, wanted)) = types else { return reason.to_owned() };
    let wanted = if wanted == "f64" { "a number" } else { wanted };
    let (kind, value) = found.split_once(' ').unwrap_or((found, ""));
    let found = match kind {
        "sequence" => "a list".into(),
        "map" => "an object".into(),
        "string" => format!("the text {value}"),
        "integer" => format!("the number {}", value.trim_matches('`')),
        "floating" => {
            format!("the number {}", value.trim_start_matches("point ").trim_matches('`'))
        }
        "boolean" => value.trim_matches('`').to_owned(),
        _ => found.to_owned(),
    };
    format!("{found} is where {wanted} must be")
}

/// What a text has that JSON does not allow, though other programs write it: its bytes, the message
/// and how to fix it. `at` is where the parser stopped.
pub(super) fn unlike_json(text: &str, at: usize) -> Option<(Range<usize>, String, &'static str)> {
    let (before, after) = (text.get(..at)?, text.get(at..)?);
    let start = before.trim_end_matches(|c: char| c == '-' || c.is_ascii_alphabetic()).len();
    for word in ["NaN", "Infinity", "-Infinity"] {
        if text.get(start..)?.starts_with(word) {
            let help = "write null for a property that is not known, and leave out a position or a bbox \
                        without numbers";
            let message = format!("{word} is not allowed in JSON");
            return Some((start..start + word.len(), message, help));
        }
    }
    let comma = before.trim_end().len().checked_sub(1)?;
    let is_comma = text.get(comma..)?.starts_with(',');
    (is_comma && after.trim_start().starts_with([']', '}'])).then(|| {
        let message = "a comma before a closing bracket is not allowed in JSON".into();
        (comma..comma + 1, message, "remove the comma")
    })
}

/// A list of at most `MAX` members.
#[derive(Debug)]
pub(super) struct List<T, const MAX: usize>(pub(super) Vec<T>);

/// An object of at most `MAX` members, in the order of the text.
#[derive(Debug)]
pub(super) struct Pairs<K, V, const MAX: usize>(pub(super) Vec<(K, V)>);

impl<T, const MAX: usize> Default for List<T, MAX> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<K, V, const MAX: usize> Default for Pairs<K, V, MAX> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>, const MAX: usize> Deserialize<'de> for List<T, MAX> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(ListOf::<T, MAX>(PhantomData)).map(Self)
    }
}

impl<'de, K: Deserialize<'de>, V: Deserialize<'de>, const MAX: usize> Deserialize<'de>
    for Pairs<K, V, MAX>
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(PairsOf::<K, V, MAX>(PhantomData)).map(Self)
    }
}

struct ListOf<T, const MAX: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const MAX: usize> Visitor<'de> for ListOf<T, MAX> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut all = Vec::new();
        while let Some(one) = list.next_element()? {
            if all.len() >= MAX {
                return Err(A::Error::custom(format!("a list has more than {MAX} members")));
            }
            all.push(one);
        }
        Ok(all)
    }
}

struct PairsOf<K, V, const MAX: usize>(PhantomData<(K, V)>);

impl<'de, K: Deserialize<'de>, V: Deserialize<'de>, const MAX: usize> Visitor<'de>
    for PairsOf<K, V, MAX>
{
    type Value = Vec<(K, V)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Vec<(K, V)>, A::Error> {
        let mut all = Vec::new();
        while let Some(pair) = map.next_entry()? {
            if all.len() >= MAX {
                return Err(A::Error::custom(format!("an object has more than {MAX} members")));
            }
            all.push(pair);
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_is_never_inside_a_character() {
        for text in [
            "\u{e9}",
            "{\"\u{e9}\u{fc}",
            "[1,\n\u{1f333}",
            "{\"a\u{e9}\": \u{e9}}",
            "[\"\u{e9}\" 1]",
        ] {
            for end in text.char_indices().map(|(at, _)| at).chain([text.len()]) {
                let part = &text[..end];
                let read = serde_json::from_str::<serde_json::Value>(part);
                let at = place_of(part, &read.expect_err("not JSON"));
                assert!(part.is_char_boundary(at), "{part:?} {at}");
            }
        }
    }

    #[test]
    fn lists_are_bounded() {
        let list = |text| serde_json::from_str::<List<u8, 3>>(text).map(|list| list.0);
        assert_eq!(list("[1, 2, 3]").ok(), Some(vec![1, 2, 3]));
        let error = list("[1, 2, 3, 4]").expect_err("too many");
        assert_eq!(reason_of(&error), "a list has more than 3 members");
        let pairs = |text| serde_json::from_str::<Pairs<String, u8, 1>>(text).map(|pairs| pairs.0);
        assert_eq!(pairs("{\"a\": 1}").ok(), Some(vec![("a".into(), 1)]));
        assert!(pairs("{\"a\": 1, \"b\": 2}").is_err());
    }
}
