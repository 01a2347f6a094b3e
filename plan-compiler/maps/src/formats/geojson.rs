//! GeoJSON: features on the globe, described by properties.
//!
//! Source: RFC 7946; RFC 8142 and newline-delimited GeoJSON for sequences of features.
//! Coordinates are WGS-84, longitude before latitude; an altitude after them is ignored.
//! Properties have the meaning of OpenStreetMap's tags, see `tags`. In addition a point may have a
//! `radius` in metres, and a point with a `name` is a goal unless it has `goal=no`. The
//! collection's member `origin`, a position, gives the place of 0,0.
//!
//! The raw text of each part is kept (`RawValue`), so that every mistake can be located.
//! Deliberately absent: other coordinate systems, TopoJSON.

mod coordinates;
mod drawing;
mod feature;
mod properties;
mod system;

use super::globe::{Bounds, Passed, Plane, Stray};
use super::json::{self, List};
use super::tags::{Judge, Tags};
use super::{MAX_PROBLEMS, ReadOptions};
use crate::model::Map;
use crate::problem::has_errors;
use crate::problem::{Problem, Source};
use coordinates::{Piece, Position};
use drawing::{Drawing, Flaws};
use math::GeoPoint;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// This format in `--help`.
pub const CONVENTIONS: &str = "\
GeoJSON  (RFC 7946, .geojson; also features one a line, and .geojson.gz) For the meaning of
         properties see Tags; lines are walls without width, points are circles of their property
         `radius` in metres. In a list each member counts. layer=foliage or comms weakens radio;
         any other `layer` is an area that a mission can name. Points with a `name` are goals. The
         extent is the file's bbox, or its coordinates and 10 m around them. 0,0 is the origin
         (--origin, or a member `origin` of the collection: [longitude, latitude]), or the centre
         of the extent.";

/// Most bytes of a part that an excerpt shows.
const EXCERPT_BYTES: usize = 80;
/// Most features of a file: more than the buildings of a large city.
const MAX_FEATURES: usize = 1 << 21;
/// Most lists in a file, nearly all of them positions: about 500 MB of memory.
const MAX_LISTS: usize = 1 << 23;
const TO_DEGREES: &str = "convert them: ogr2ogr -t_srs EPSG:4326 new.geojson old.geojson";
const WITH_OUTLINES: &str = "write it with outlines: in Overpass end the query with `out geom;`";

/// Whether a text looks like GeoJSON, or like formats that are mistaken for it.
pub fn recognises(text: &str) -> bool {
    let kinds = ["\"FeatureCollection\"", "\"Feature\"", "\"Topology\""];
    text.trim_start_matches(is_between).starts_with('{')
        && kinds.iter().any(|kind| text.contains(kind))
}

/// Separators between the features of a sequence.
fn is_between(c: char) -> bool {
    c.is_whitespace() || c == '\u{1e}'
}

/// Reads GeoJSON: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>, options: &ReadOptions) -> (Option<Map>, Vec<Problem>) {
    let judge = Judge::new(&options.tags);
    let mut reader =
        Reader { source, judge: &judge, problems: Vec::new(), drawn: Vec::new(), is_degrees: true };
    let map = reader.file().and_then(|file| reader.map(&file, options.origin));
    // In the order of the file.
    reader
        .problems
        .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |p| p.span.start));
    (map, reader.problems)
}

/// A FeatureCollection, or a single Feature.
#[derive(Default, Deserialize)]
struct File<'a> {
    #[serde(borrow, rename = "type")]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow)]
    name: Option<&'a RawValue>,
    #[serde(borrow)]
    features: Option<List<&'a RawValue, MAX_FEATURES>>,
    #[serde(borrow)]
    bbox: Option<&'a RawValue>,
    #[serde(borrow)]
    crs: Option<&'a RawValue>,
    #[serde(borrow)]
    origin: Option<&'a RawValue>,
    /// Marks ArcGIS JSON, which has its own features.
    #[serde(borrow, rename = "geometryType")]
    geometry_type: Option<&'a RawValue>,
}

/// The features of a file in any of its forms.
struct Collection<'a> {
    head: File<'a>,
    /// Text of each feature.
    features: Vec<&'a str>,
    /// Name of the list, for messages; empty for a single feature.
    called: &'static str,
}

/// A feature whose coordinates are on the globe.
struct Drawn<'a> {
    tags: Tags,
    pieces: Vec<Piece>,
    /// The coordinates of the pieces as the file writes them, in their order.
    texts: Vec<&'a str>,
    span: Range<usize>,
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    judge: &'a Judge<'a>,
    problems: Vec<Problem>,
    drawn: Vec<Drawn<'a>>,
    /// Whether the coordinates are in degrees: the file names no other system.
    is_degrees: bool,
}

impl<'a> Reader<'a> {
    fn error(&mut self, message: impl Into<String>, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    /// Bytes of a part of the text.
    fn span(&self, part: &str) -> Range<usize> {
        let start = part.as_ptr() as usize - self.source.text.as_ptr() as usize;
        start..start + part.len()
    }

    /// The first line of a part, cut for an excerpt.
    fn first_line(&self, part: &str) -> Range<usize> {
        let line = part.lines().next().unwrap_or(part);
        self.span(&line[..line.floor_char_boundary(EXCERPT_BYTES)])
    }

    /// Parses a part; reports a failure.
    fn parse<T: Deserialize<'a>>(&mut self, part: &'a str, what: &str, help: &str) -> Option<T> {
        serde_json::from_str(part).map_err(|error| self.refuse(part, what, &error, help)).ok()
    }

    /// Parses an object. Serde alone would also accept a list of its members.
    fn object<T: Deserialize<'a>>(&mut self, part: &'a str, what: &str, help: &str) -> Option<T> {
        if !part.starts_with('{') {
            self.error(what, self.first_line(part), "this is not an object", help);
            return None;
        }
        self.parse(part, what, help)
    }

    fn refuse(&mut self, part: &str, what: &str, error: &serde_json::Error, help: &str) {
        let start = self.span(part).start;
        let place = json::place_of(part, error);
        if let Some((span, reason, help)) =
            json::unlike_json(part, place).filter(|_| error.is_syntax())
        {
            let span = start + span.start..start + span.end;
            self.error(format!("{what}: {reason}"), span, "here", help);
            return;
        }
        let at = start + place;
        let reason = json::reason_of(error);
        self.error(format!("{what}: {reason}"), at..at, "here", help);
    }

    fn file(&mut self) -> Option<Collection<'a>> {
        let source: &'a Source = self.source;
        let text = source.text.trim_matches(is_between);
        let lists = text.bytes().filter(|byte| *byte == b'[').count();
        if lists > MAX_LISTS {
            let message =
                format!("the file has {lists} lists and positions, more than {MAX_LISTS}");
            let help = "crop the map to the area that the robot uses: ogr2ogr -clipsrc";
            self.error(message, self.first_line(text), "this file", help);
            return None;
        }
        let records = records(text);
        if records.len() > 1 {
            return self.sequence(records);
        }
        let help =
            "a GeoJSON map is an object of type FeatureCollection; check where it was cut off";
        let mut head: File<'a> = self.object(text, "this is not GeoJSON", help)?;
        let features = match (head.kind.as_deref(), head.features.take()) {
            (Some("FeatureCollection"), Some(features)) => features.0,
            (Some("Feature"), _) => {
                return Some(Collection { head, features: vec![text], called: "" });
            }
            _ => {
                self.no_features(text, &head);
                return None;
            }
        };
        let features = features.into_iter().map(RawValue::get).collect();
        Some(Collection { head, features, called: "features" })
    }

    fn no_features(&mut self, text: &'a str, head: &File<'a>) {
        let (message, label, help) = match (head.kind.as_deref(), head.geometry_type) {
            (Some("Topology"), _) => (
                "the file is TopoJSON, not GeoJSON",
                "of type Topology",
                "convert it: mapshaper old.json -o format=geojson new.geojson",
            ),
            (_, Some(_)) => (
                "the file is ArcGIS's JSON, not GeoJSON",
                "it has a geometryType",
                "convert it: ogr2ogr new.geojson old.json",
            ),
            _ => (
                "the file holds no features",
                "neither a Feature nor a FeatureCollection with features",
                "wrap geometries in features: their properties give their meaning",
            ),
        };
        self.error(message, self.first_line(text), label, help);
    }

    /// Reads a sequence of features, and perhaps of collections.
    fn sequence(&mut self, records: Vec<&'a str>) -> Option<Collection<'a>> {
        let mut features = Vec::new();
        for (index, text) in records.into_iter().enumerate() {
            let what = format!("record {} of the sequence is not a feature", index + 1);
            let help = "each record is a Feature; check where the file was cut off";
            let Some(record): Option<File<'a>> = self.object(text, &what, help) else { continue };
            match (record.kind.as_deref(), record.features) {
                (Some("FeatureCollection"), Some(inner)) => {
                    features.extend(inner.0.into_iter().map(RawValue::get));
                }
                _ => features.push(text),
            }
            if self.problems.len() > MAX_PROBLEMS {
                break;
            }
        }
        Some(Collection { head: File::default(), features, called: "records" })
    }

    fn map(&mut self, file: &Collection<'a>, origin: Option<GeoPoint>) -> Option<Map> {
        let head = &file.head;
        self.check_system(head.crs);
        let bounds = head.bbox.and_then(|bbox| self.bounds(bbox));
        let origin = origin.or_else(|| self.origin(head.origin?));
        for (index, feature) in file.features.iter().enumerate() {
            let name = match file.called {
                "" => "the feature".into(),
                called => format!("{called}[{index}]"),
            };
            self.feature(feature, &name);
            if self.problems.len() > MAX_PROBLEMS {
                return None;
            }
        }
        let plane = self.plane(head, bounds, origin)?;
        let mut map = plane.map();
        map.title = head.name.and_then(|name| serde_json::from_str(name.get()).ok());
        let (mut passed, mut flaws) = (Passed::default(), Flaws::default());
        let drawing = Drawing::new(&plane, self.judge, &self.drawn);
        for drawn in &self.drawn {
            drawing.feature(drawn, &mut map, &mut passed, &mut flaws);
        }
        if !has_errors(&self.problems) {
            flaws.report(&passed, self.source, &mut self.problems);
            passed.report_points(WITH_OUTLINES, &mut self.problems);
            self.judge.report(&mut self.problems);
            let places = self.drawn.iter().flat_map(Drawn::positions);
            self.problems.extend(Bounds::around(places).and_then(|around| around.suspect()));
            plane.note(&map, &passed.unused, self.judge.rules, &mut self.problems);
        }
        Some(map)
    }

    fn plane(
        &mut self,
        head: &File<'a>,
        bounds: Option<Bounds>,
        origin: Option<GeoPoint>,
    ) -> Option<Plane> {
        let places = self.drawn.iter().flat_map(Drawn::positions);
        let problem = match Plane::new(bounds, places, origin) {
            Ok(plane) => return Some(plane),
            Err(problem) => problem,
        };
        // If all coordinates were refused, those errors suffice.
        if has_errors(&self.problems) && self.drawn.iter().all(|one| one.pieces.is_empty()) {
            return None;
        }
        let found = match head.bbox.filter(|_| bounds.is_some()) {
            Some(bbox) => Some((self.first_line(bbox.get()), "this bbox".into())),
            None => self.stray(),
        };
        self.problems.push(match found {
            Some((span, label)) => problem.at(self.source, span, label),
            None => problem,
        });
        None
    }

    /// The place of 0,0 that the file gives.
    fn origin(&mut self, raw: &'a RawValue) -> Option<GeoPoint> {
        let help = "write \"origin\": [longitude, latitude], in degrees, or leave it out";
        let Position([lat, lon]) = self.parse(raw.get(), "the origin is not a position", help)?;
        let origin = GeoPoint::from_degrees(lat, lon);
        if origin.is_none() {
            let span = self.first_line(raw.get());
            self.error("the origin is off the globe", span, "this one", help);
        }
        origin
    }

    /// Bytes and label of the position that makes the extent absurd.
    fn stray(&self) -> Option<(Range<usize>, String)> {
        let places: Vec<[f64; 2]> = self.drawn.iter().flat_map(Drawn::positions).collect();
        let stray = Stray::among(&places)?;
        let mut texts = Vec::new();
        let all = self.drawn.iter().flat_map(|drawn| &drawn.texts);
        all.for_each(|text| coordinates::texts(text, &mut texts));
        Some((self.first_line(texts.get(stray.index)?), stray.label()))
    }

    /// Refuses coordinates in another system: RFC 7946 allows only one.
    fn check_system(&mut self, crs: Option<&'a RawValue>) {
        let Some(crs) = crs else { return };
        if let Some(name) = system::foreign(crs.get()) {
            self.is_degrees = false;
            let message = format!("the coordinates are in {name}, not in degrees of WGS-84");
            self.error(message, self.first_line(crs.get()), "stated here", TO_DEGREES);
        }
    }

    fn bounds(&mut self, raw: &'a RawValue) -> Option<Bounds> {
        let help = "write west, south, east, north in degrees, or leave it out";
        let sides: List<f64, 6> =
            self.parse(raw.get(), "the bbox is not a list of numbers", help)?;
        let corners = match sides.0[..] {
            [west, south, east, north] => Some(([south, west], [north, east])),
            // With altitudes.
            [west, south, _, east, north, _] => Some(([south, west], [north, east])),
            _ => None,
        };
        let bounds = corners.and_then(|(low, high)| Bounds::between(low, high));
        if bounds.is_none() && self.is_degrees {
            let span = self.first_line(raw.get());
            self.error("the bbox is not a box on the globe", span, "this one", help);
        }
        bounds
    }
}

/// The records of a text: one, or several that are each preceded by a record separator or on their
/// own line. The last record is the unreadable rest, if any.
fn records(text: &str) -> Vec<&str> {
    let mut records = Vec::new();
    for part in text.split('\u{1e}').map(str::trim).filter(|part| !part.is_empty()) {
        let mut stream = serde_json::Deserializer::from_str(part).into_iter::<&RawValue>();
        loop {
            let at = stream.byte_offset();
            match stream.next() {
                Some(Ok(record)) => records.push(record.get()),
                Some(Err(_)) => {
                    records.push(part[at..].trim());
                    break;
                }
                None => break,
            }
            if records.len() > MAX_FEATURES {
                return records;
            }
        }
    }
    records
}

impl Drawn<'_> {
    fn positions(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.pieces.iter().flat_map(Piece::positions)
    }
}

#[cfg(test)]
mod tests;
