//! Reads one feature: its properties, and its geometry with checked coordinates.

use super::coordinates::{self, Piece, Position};
use super::{Drawn, MAX_FEATURES, Reader, TO_DEGREES, properties};
use crate::formats::json::{self, List};
use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::ops::Range;

/// Numbers beyond this are metres, not wrong angles.
const ANGLE_LIMIT: f64 = 360.0;
/// Most rings of one geometry that are reported.
const MAX_BAD_RINGS: usize = 10;

#[derive(Deserialize)]
struct RawFeature<'a> {
    #[serde(borrow, rename = "type")]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow)]
    geometry: Option<&'a RawValue>,
    #[serde(borrow)]
    properties: Option<&'a RawValue>,
}

/// The raw parts of a geometry.
#[derive(Deserialize)]
struct RawGeometry<'a> {
    #[serde(borrow, rename = "type")]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow)]
    coordinates: Option<&'a RawValue>,
    #[serde(borrow)]
    geometries: Option<List<&'a RawValue, MAX_FEATURES>>,
}

impl<'a> Reader<'a> {
    pub(super) fn feature(&mut self, text: &'a str, name: &str) {
        let help = "a feature has type, geometry and properties";
        let what = format!("{name} is not a feature");
        let Some(raw): Option<RawFeature<'a>> = self.object(text, &what, help) else { return };
        if raw.kind.as_deref() != Some("Feature") {
            self.error(what, self.first_line(text), "its type is not Feature", help);
            return;
        }
        let properties = raw.properties.map_or("null", RawValue::get);
        let what = format!("the properties of {name} are not an object");
        let help = "write \"properties\": {\"building\": \"yes\"}, or null";
        let tags = match properties::tags(properties) {
            Ok(tags) => tags,
            Err(error) => {
                self.refuse(properties, &what, &error, help);
                return;
            }
        };
        if let Some(problem) = tags.check_radius(name) {
            self.problems.push(problem.at(self.source, self.first_line(properties), ""));
        }
        let span = self.first_line(text);
        let mut drawn = Drawn { tags, pieces: Vec::new(), texts: Vec::new(), span };
        // RFC 7946 allows features without a geometry.
        if let Some(geometry) = raw.geometry.filter(|geometry| geometry.get() != "null") {
            self.geometry(geometry.get(), name, true, &mut drawn);
        }
        self.drawn.push(drawn);
    }

    fn geometry(&mut self, text: &'a str, name: &str, may_nest: bool, drawn: &mut Drawn<'a>) {
        let help = "a geometry has a type and coordinates that are nested as deep as it asks for";
        let what = format!("the geometry of {name} cannot be read");
        let Some(raw): Option<RawGeometry<'a>> = self.object(text, &what, help) else { return };
        let kind = raw.kind.as_deref().unwrap_or_default();
        if kind == "GeometryCollection" {
            if !may_nest {
                let help = "take the inner collection apart";
                let span = self.first_line(text);
                self.error(what, span, "a collection within a collection", help);
                return;
            }
            for part in raw.geometries.unwrap_or_default().0 {
                self.geometry(part.get(), name, false, drawn);
            }
            return;
        }
        let coordinates = raw.coordinates.map_or("null", RawValue::get);
        match coordinates::pieces(kind, coordinates) {
            Ok(mut found) => {
                if self.check(&found, coordinates, name) {
                    drawn.pieces.append(&mut found);
                    drawn.texts.push(coordinates);
                }
            }
            Err(error) if error.line() == 0 => {
                self.error(format!("{what}: {error}"), self.first_line(text), "this one", help);
            }
            Err(error) => {
                let reason = json::reason_of(&error);
                let begins = |start: &str| reason.starts_with(start);
                let help = if begins("the text") {
                    "write coordinates as numbers, without quotes".into()
                } else if begins("null") {
                    "remove the position, or write its numbers".into()
                } else if begins("a list") {
                    format!(
                        "a {kind} has fewer levels of brackets: remove one, or correct its type"
                    )
                } else if begins("the number") {
                    format!("a {kind} has more levels of brackets: add one, or correct its type")
                } else {
                    help.into()
                };
                self.refuse(coordinates, &what, &error, &help);
            }
        }
    }

    /// Checks that a geometry's coordinates are on the globe and its rings closed.
    fn check(&mut self, pieces: &[Piece], text: &'a str, name: &str) -> bool {
        let before = self.problems.len();
        let mut all = pieces.iter().flat_map(Piece::positions).enumerate();
        let is_off = |[lat, lon]: [f64; 2]| lat.abs() > 90.0 || lon.abs() > 180.0;
        if let Some((index, [lat, lon])) = all.find(|(_, at)| is_off(*at)) {
            let (what, help) = if lat.abs().max(lon.abs()) > ANGLE_LIMIT {
                ("are projected metres, not degrees", TO_DEGREES)
            } else if lat.abs() <= 180.0 && lon.abs() <= 90.0 {
                ("are off the globe", "longitude comes first; these look swapped")
            } else {
                ("are off the globe", "write longitude, then latitude, in degrees of WGS-84")
            };
            if self.is_degrees {
                let span = self.position(text, index);
                self.error(format!("coordinates of {name} {what}"), span, "these", help);
            }
            return false;
        }
        let mut end = 0;
        for piece in pieces {
            let lines: &[Vec<Position>] = match piece {
                Piece::Point(_) => &[],
                Piece::Line(line) => std::slice::from_ref(line),
                Piece::Polygon(rings) => rings,
            };
            for line in lines {
                end += line.len();
                if self.problems.len() >= before + MAX_BAD_RINGS {
                    return false;
                }
                self.check_line(line, matches!(piece, Piece::Polygon(_)), name, (text, end));
            }
        }
        self.problems.len() == before
    }

    /// `text` is the geometry's coordinates; `end` counts the positions up to the end of this line.
    fn check_line(
        &mut self,
        line: &[Position],
        is_ring: bool,
        name: &str,
        (text, end): (&'a str, usize),
    ) {
        let (message, label, help) = if is_ring && line.first() != line.last() {
            (
                format!("a ring of {name} is not closed"),
                "its last position differs from its first",
                "repeat the ring's first position at its end",
            )
        } else if line.len() < if is_ring { 4 } else { 2 } {
            let (what, least) = if is_ring { ("ring", "four") } else { ("line", "two") };
            (
                format!("a {what} of {name} has fewer than {least} positions"),
                "it ends here",
                "add what is missing, or leave the feature out",
            )
        } else {
            return;
        };
        let span = self.position(text, end.saturating_sub(1));
        self.error(message, span, label, help);
    }

    /// Bytes of a position, by its index in all of a geometry's coordinates.
    fn position(&self, text: &'a str, index: usize) -> Range<usize> {
        let mut found = Vec::new();
        coordinates::texts(text, &mut found);
        self.first_line(found.get(index).copied().unwrap_or(text))
    }
}
