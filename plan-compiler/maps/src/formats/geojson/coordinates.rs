//! Coordinates: lists of positions, read without intermediate values.

use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, SeqAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;

/// Latitude and longitude, degrees; in the text the longitude comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Position(pub(super) [f64; 2]);

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(PositionVisitor)
    }
}

struct PositionVisitor;

impl<'de> Visitor<'de> for PositionVisitor {
    type Value = Position;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a position, [longitude, latitude],")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Position, A::Error> {
        let (lon, lat) = (list.next_element()?, list.next_element()?);
        let (Some(lon), Some(lat)) = (lon, lat) else {
            return Err(A::Error::custom("a position has two numbers, longitude and latitude"));
        };
        // Skip an altitude and further numbers.
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Position([lat, lon]))
    }
}

/// A part of a geometry.
#[derive(Debug, PartialEq)]
pub(super) enum Piece {
    Point(Position),
    Line(Vec<Position>),
    Polygon(Vec<Vec<Position>>),
}

impl Piece {
    pub(super) fn positions(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let (point, lines): (Option<&Position>, &[Vec<Position>]) = match self {
            Self::Point(point) => (Some(point), &[]),
            Self::Line(line) => (None, std::slice::from_ref(line)),
            Self::Polygon(rings) => (None, rings),
        };
        point.into_iter().chain(lines.iter().flatten()).map(|position| position.0)
    }
}

/// The pieces of a geometry of a type with these coordinates.
pub(super) fn pieces(kind: &str, text: &str) -> serde_json::Result<Vec<Piece>> {
    fn read<'t, T: Deserialize<'t>>(text: &'t str) -> serde_json::Result<T> {
        serde_json::from_str(text)
    }
    if is_empty(text) {
        return Ok(Vec::new());
    }
    Ok(match kind {
        "Point" => vec![Piece::Point(read(text)?)],
        "MultiPoint" => read::<Vec<_>>(text)?.into_iter().map(Piece::Point).collect(),
        "LineString" => vec![Piece::Line(read(text)?)],
        "MultiLineString" => read::<Vec<_>>(text)?.into_iter().map(Piece::Line).collect(),
        "Polygon" => vec![Piece::Polygon(read(text)?)],
        "MultiPolygon" => read::<Vec<_>>(text)?.into_iter().map(Piece::Polygon).collect(),
        other => {
            let other: String = other.chars().take(40).filter(|c| !c.is_control()).collect();
            return Err(serde_json::Error::custom(format!("`{other}` is not a type of geometry")));
        }
    })
}

/// Whether coordinates hold no position: programs write features without a place like this.
fn is_empty(text: &str) -> bool {
    text == "null"
        || text
            .bytes()
            .all(|byte| matches!(byte, b'[' | b']' | b',' | b' ' | b'\n' | b'\r' | b'\t'))
}

/// Texts of the innermost lists. The caller has checked that nesting is as deep as a geometry's.
pub(super) fn texts<'a>(text: &'a str, found: &mut Vec<&'a str>) {
    let parts: Vec<&'a RawValue> = serde_json::from_str(text).unwrap_or_default();
    if parts.first().is_some_and(|part| part.get().starts_with('[')) {
        parts.iter().for_each(|part| texts(part.get(), found));
    } else if !parts.is_empty() {
        found.push(text);
    }
}
