//! The coordinate reference system that a file names, as files did before RFC 7946.

use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;

#[derive(Deserialize)]
struct Crs<'a> {
    #[serde(borrow)]
    properties: Option<Properties<'a>>,
}

#[derive(Deserialize)]
struct Properties<'a> {
    #[serde(borrow)]
    name: Option<Cow<'a, str>>,
    #[serde(borrow)]
    code: Option<&'a RawValue>,
}

/// The name of a system that is not degrees of WGS-84; `None` where it is, or none is named.
pub(super) fn foreign(text: &str) -> Option<String> {
    let name = match serde_json::from_str::<Option<Crs<'_>>>(text) {
        Ok(None) => return None,
        Ok(Some(Crs { properties: Some(Properties { name: Some(name), .. }) })) => {
            name.into_owned()
        }
        Ok(Some(Crs { properties: Some(Properties { code: Some(code), .. }) })) => {
            format!("EPSG:{}", code.get().trim_matches('"'))
        }
        _ => serde_json::from_str::<String>(text).unwrap_or_else(|_| "an unnamed system".into()),
    };
    let shown: String = name.chars().filter(|c| !c.is_control()).take(80).collect();
    (!is_degrees(&name)).then_some(shown)
}

/// WGS-84, with or without heights, and ETRS89, which differs from it by a metre at most.
fn is_degrees(name: &str) -> bool {
    if let Some(name) = well_known(name) {
        let is_word = |c: &char| c.is_ascii_alphanumeric();
        let name = name.chars().filter(is_word).collect::<String>().to_ascii_uppercase();
        return ["WGS84", "WGS1984", "GCSWGS1984", "ETRS89", "GCSETRS1989"]
            .contains(&name.as_str());
    }
    let code = name.rsplit([':', '/', '#']).next().unwrap_or_default();
    let code: String = code.chars().filter(|c| !c.is_whitespace()).collect();
    ["CRS84", "CRS84h", "4326", "4979", "4258", "WGS84"]
        .iter()
        .any(|known| code.eq_ignore_ascii_case(known))
}

/// The name of a geographic system in well-known text, `GEOGCS["WGS 84", ...]`.
fn well_known(text: &str) -> Option<&str> {
    let (kind, rest) = text.split_once('[')?;
    let is_it = |known: &str| kind.trim().eq_ignore_ascii_case(known);
    if !["GEOGCS", "GEOGCRS", "GEODCRS"].into_iter().any(is_it) {
        return None;
    }
    rest.trim_start().strip_prefix('"')?.split('"').next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_of_wgs_84_have_many_names() {
        for text in [
            "null",
            r#"{"type": "EPSG", "properties": {"code": 4326}}"#,
            r#"{"type": "EPSG", "properties": {"code": "4326"}}"#,
            r#"{"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}"#,
            r#"{"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::4326"}}"#,
            r#"{"type": "name", "properties": {"name": "EPSG:4326"}}"#,
            r#"{"type": "name", "properties": {"name": "http://www.opengis.net/def/crs/OGC/1.3/CRS84"}}"#,
            r#""WGS 84""#,
        ] {
            assert_eq!(foreign(text), None, "{text}");
        }
        for (text, name) in [
            (r#"{"type": "EPSG", "properties": {"code": 3857}}"#, "EPSG:3857"),
            (
                r#"{"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}"#,
                "urn:ogc:def:crs:EPSG::25832",
            ),
            (r#""EPSG:14326""#, "EPSG:14326"),
            (r#"{"type": "link", "properties": {"href": "x"}}"#, "an unnamed system"),
            ("{}", "an unnamed system"),
        ] {
            assert_eq!(foreign(text).as_deref(), Some(name), "{text}");
        }
    }
}
