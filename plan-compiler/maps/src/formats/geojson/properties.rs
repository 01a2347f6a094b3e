//! Reads properties as tags, in the forms that converters from OpenStreetMap write.
//!
//! osmtogeojson nests an object `tags`; GDAL writes a text `other_tags` in PostgreSQL's hstore
//! syntax, `"height"=>"3","roof"=>"flat"`, or in JSON; osmnx writes lists and objects as Python
//! does, `['footway', 'steps']`. Nested tags come after the others. A list becomes `footway;steps`,
//! as OpenStreetMap itself writes several values.

use crate::formats::json::Pairs;
use crate::formats::tags::Tags;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;

/// Most properties of a feature.
const MAX_PROPERTIES: usize = 10_000;
/// Deepest nesting of tags.
const MAX_DEPTH: usize = 2;
/// Properties that hold tags.
const NESTED: [&str; 3] = ["tags", "other_tags", "all_tags"];

/// The properties of a feature, unread.
type Properties<'a> = Pairs<Cow<'a, str>, &'a RawValue, MAX_PROPERTIES>;

/// A tag as an object of its own.
#[derive(Deserialize)]
struct Pair<'a> {
    #[serde(borrow, alias = "k")]
    key: Cow<'a, str>,
    #[serde(borrow, alias = "v")]
    value: &'a RawValue,
}

/// Reads properties as tags. Values other than text, numbers, booleans and lists of them are ignored.
pub(super) fn tags(text: &str) -> serde_json::Result<Tags> {
    let properties: Option<Properties<'_>> = serde_json::from_str(text)?;
    let mut tags = Vec::new();
    let mut nested = Vec::new();
    add(&properties.unwrap_or_default(), 0, &mut tags, &mut nested);
    tags.append(&mut nested);
    Ok(Tags(tags))
}

fn add(
    properties: &Properties<'_>,
    depth: usize,
    tags: &mut Vec<(String, String)>,
    nested: &mut Vec<(String, String)>,
) {
    for (key, value) in &properties.0 {
        let holds_tags = NESTED.iter().any(|name| key.eq_ignore_ascii_case(name));
        let value = value.get();
        match value.as_bytes().first() {
            Some(b'"') if holds_tags => {
                let text = serde_json::from_str::<String>(value).unwrap_or_default();
                unfold(&text, depth, nested);
            }
            Some(b'{' | b'[') if holds_tags => unfold(value, depth, nested),
            Some(b'[') => {
                let members = serde_json::from_str::<Vec<&RawValue>>(value).unwrap_or_default();
                let members = members.into_iter().filter_map(|member| text_of(member.get()));
                let members: Vec<String> = members.collect();
                if !members.is_empty() {
                    tags.push((key.to_string(), members.join(";")));
                }
            }
            _ => tags.extend(text_of(value).map(|text| (key.to_string(), text))),
        }
    }
}

/// The text of a value that is neither a list nor an object nor null.
fn text_of(value: &str) -> Option<String> {
    match value.as_bytes().first()? {
        b'"' => {
            let text = serde_json::from_str::<String>(value).ok()?;
            let is_list = text.starts_with("['") || text.starts_with("[\"");
            let members =
                if is_list { python(&text).filter(|_| text.ends_with(']')) } else { None };
            Some(members.map_or(text, |members| members.join(";")))
        }
        b't' => Some("yes".into()),
        b'f' => Some("no".into()),
        b'-' | b'0'..=b'9' => Some(value.to_owned()),
        _ => None,
    }
}

/// Adds the tags of a text that is an object, a list of pairs or an hstore.
fn unfold(text: &str, depth: usize, tags: &mut Vec<(String, String)>) {
    let text = text.trim();
    if text.starts_with('[') {
        let pairs = serde_json::from_str::<Vec<Pair<'_>>>(text).unwrap_or_default();
        let pair = |pair: Pair<'_>| Some((pair.key.into_owned(), text_of(pair.value.get())?));
        tags.extend(pairs.into_iter().filter_map(pair));
    } else if !text.starts_with('{') {
        hstore(text, tags);
    } else if text.starts_with("{'") {
        let words = python(text).unwrap_or_default();
        let pairs = words.chunks_exact(2).map(|pair| (pair[0].clone(), pair[1].clone()));
        tags.extend(pairs);
    } else if let Ok(inner) = serde_json::from_str::<Properties<'_>>(text)
        && depth < MAX_DEPTH
    {
        let mut nested = Vec::new();
        add(&inner, depth + 1, tags, &mut nested);
        tags.append(&mut nested);
    }
}

/// Reads `"key"=>"value","key"=>"value"` up to the first mistake.
fn hstore(text: &str, tags: &mut Vec<(String, String)>) {
    let mut rest = text.chars();
    while let Some(key) = quoted(&mut rest) {
        let after = rest.as_str().trim_start();
        let Some(after) = after.strip_prefix("=>") else { return };
        rest = after.trim_start().chars();
        // A value may be the word NULL.
        if rest.as_str().starts_with('"') {
            let Some(value) = quoted(&mut rest) else { return };
            tags.push((key, value));
        }
    }
}

/// Consumes the next quoted text.
fn quoted(rest: &mut std::str::Chars<'_>) -> Option<String> {
    rest.find(|c| *c == '"')?;
    let mut text = String::new();
    loop {
        match rest.next()? {
            '"' => return Some(text),
            '\\' => text.push(rest.next()?),
            other => text.push(other),
        }
    }
}

/// The words of a list or an object as Python writes it, keys and values in turn; `None` if it holds
/// further lists or objects.
fn python(text: &str) -> Option<Vec<String>> {
    let mut words = Vec::new();
    let mut rest = text.get(1..text.len().checked_sub(1)?)?.trim_start();
    while let Some(first) = rest.chars().next() {
        let mut word = String::new();
        if let quote @ ('\'' | '"') = first {
            let mut chars = rest.get(1..)?.chars();
            loop {
                match chars.next()? {
                    '\\' => word.push(chars.next()?),
                    end if end == quote => break,
                    other => word.push(other),
                }
            }
            rest = chars.as_str();
        } else {
            let end = rest.find([',', ':']).unwrap_or(rest.len());
            word.push_str(rest[..end].trim());
            rest = &rest[end..];
            if word.contains(['[', '{', '(', '\'', '"']) {
                return None;
            }
            word = match word.as_str() {
                "True" => "yes".into(),
                "False" | "None" | "nan" => "no".into(),
                _ => word,
            };
        }
        words.push(word);
        rest = rest.trim_start();
        rest = match rest.strip_prefix([',', ':']) {
            Some(rest) => rest.trim_start(),
            None if rest.is_empty() => rest,
            None => return None,
        };
    }
    Some(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: &str) {
        let tags = tags(text).expect("properties");
        let tags: Vec<String> =
            tags.0.iter().map(|(key, value)| format!("{key}={value}")).collect();
        assert_eq!(tags.join(", "), expected, "{text}");
    }

    #[test]
    fn properties_are_tags() {
        check(
            r#"{"building": "yes", "height": 7.5, "flat": true, "a": null, "b": [1]}"#,
            "building=yes, height=7.5, flat=yes, b=1",
        );
        check("null", "");
        check(r#"{"building": "\u00e9"}"#, "building=\u{e9}");
        assert!(tags("[]").is_err());
    }

    #[test]
    fn lists_are_several_values() {
        check(r#"{"a": ["b", 2, true, null, ["c"]], "d": [], "e": [{}]}"#, "a=b;2;yes");
        check(r#"{"a": "['b', 'c;d']", "e": "[\"f\", 3]"}"#, "a=b;c;d, e=f;3");
        check(r#"{"a": "['b\\'s', \"c's\"]"}"#, "a=b's;c's");
        check(r#"{"a": "[b]", "c": "['d'", "e": "['f'] g"}"#, "a=[b], c=['d', e=['f'] g");
        check(
            r#"{"tags": "{'a': 'b', 'c': 2.5, 'd': True, 'e': None}"}"#,
            "a=b, c=2.5, d=yes, e=no",
        );
        check(r#"{"tags": "{'a': {'b': 'c'}}"}"#, "");
        check(r#"{"tags": "{'\u00e9': 'y\u00e9s', 'a"}"#, "");
        check(r#"{"tags": [{"key": "a", "value": "b"}, {"k": "c", "v": 1}]}"#, "a=b, c=1");
        check(r#"{"tags": [1]}"#, "");
    }

    #[test]
    fn nested_tags_are_tags() {
        check(
            r#"{"tags": {"building": "yes", "levels": 2}, "id": 1}"#,
            "id=1, building=yes, levels=2",
        );
        check(r#"{"tags": {"tags": {"tags": {"building": "yes"}}}}"#, "");
        check(
            r#"{"other_tags": "\"height\"=>\"3\", \"a \\\"b\\\"\"=>NULL,\"x\"=>\"y,z\""}"#,
            "height=3, x=y,z",
        );
        check(r#"{"name": "a", "other_tags": "{\"barrier\": \"wall\"}"}"#, "name=a, barrier=wall");
        check(r#"{"other_tags": "no hstore"}"#, "");
        check(r#"{"other_tags": "\"cut"}"#, "");
        check(r#"{"relation": {"building": "yes"}}"#, "");
    }
}
