//! Reads properties as tags, in the forms that converters from OpenStreetMap write.
//!
//! osmtogeojson nests an object `tags`; GDAL writes a text `other_tags` in PostgreSQL's hstore
//! syntax, `"height"=>"3","roof"=>"flat"`, or in JSON. Nested tags come after the others.

use crate::formats::json::Pairs;
use crate::formats::tags::Tags;
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

/// Reads properties as tags. Values other than text, numbers and booleans are ignored.
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
            Some(b'"') => {
                let Ok(text) = serde_json::from_str::<String>(value) else { continue };
                if holds_tags {
                    unfold(&text, depth, nested);
                } else {
                    tags.push((key.to_string(), text));
                }
            }
            Some(b'{') if holds_tags => unfold(value, depth, nested),
            Some(b't') => tags.push((key.to_string(), "yes".into())),
            Some(b'f') => tags.push((key.to_string(), "no".into())),
            Some(b'-' | b'0'..=b'9') => tags.push((key.to_string(), value.to_owned())),
            _ => {}
        }
    }
}

/// Adds the tags of a text that is an object or an hstore.
fn unfold(text: &str, depth: usize, tags: &mut Vec<(String, String)>) {
    if !text.trim_start().starts_with('{') {
        hstore(text, tags);
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
            "building=yes, height=7.5, flat=yes",
        );
        check("null", "");
        check(r#"{"building": "\u00e9"}"#, "building=\u{e9}");
        assert!(tags("[]").is_err());
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
