//! GeoJSON: features on the globe, with properties that say what they are.
//!
//! Source: RFC 7946; RFC 8142 and newline-delimited GeoJSON for features one after the other.
//! Coordinates are WGS-84, longitude before latitude; an altitude after them is ignored.
//! Properties have the meaning of OpenStreetMap's tags, see `tags`; besides, a point may have a
//! `radius` in metres, and any point with a `name` is a goal unless its property `goal` says no. A
//! member `origin` of the collection, written as a position, says where 0,0 is.
//!
//! The text of each part is kept beside what it says (`RawValue`), so that every mistake has
//! its place. Deliberately absent: other coordinate systems, TopoJSON.

mod coordinates;
mod drawing;
mod properties;
mod system;

use super::globe::{Bounds, Passed, Plane, Stray};
use super::json::{self, List};
use super::tags::{Judge, Tags};
use super::{FARTHEST_M, MAX_PROBLEMS, ReadOptions};
use crate::model::Map;
use crate::problem::has_errors;
use crate::problem::{Problem, Source};
use coordinates::{Piece, Position};
use drawing::Drawing;
use math::GeoPoint;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// What `--help` says of this format.
pub const CONVENTIONS: &str = "\
GeoJSON  (RFC 7946, .geojson; also features one a line, and .geojson.gz) Properties mean what
         stands under Tags; lines are walls without width, points circles of their property
         `radius` in metres. layer=foliage or comms weakens radio; any other `layer` is an area
         for a mission to name. Points with a `name` are goals. 0,0 is the origin (--origin, or a
         member `origin` of the collection: [longitude, latitude]), else the centre of the file's
         bbox, which is the extent; without one, of its coordinates, and the extent reaches 10 m
         farther.";

/// A number beyond this is no angle that went astray but metres.
const ANGLE_LIMIT: f64 = 360.0;
/// Most of a part that an excerpt shows, bytes.
const EXCERPT_BYTES: usize = 80;
/// Features of a file: every building of a large city is fewer.
const MAX_FEATURES: usize = 1 << 21;
/// Lists in a file, nearly all of them positions: some 500 MB of memory.
const MAX_LISTS: usize = 1 << 23;
/// Rings of one geometry whose mistakes are told.
const MAX_BAD_RINGS: usize = 10;
const TO_DEGREES: &str = "convert them: ogr2ogr -t_srs EPSG:4326 new.geojson old.geojson";
const WITH_OUTLINES: &str = "write it with outlines: in Overpass end the query with `out geom;`";

/// Whether a text reads like GeoJSON, or like what is taken for it.
pub fn recognises(text: &str) -> bool {
    let kinds = ["\"FeatureCollection\"", "\"Feature\"", "\"Topology\""];
    text.trim_start_matches(is_between).starts_with('{')
        && kinds.iter().any(|kind| text.contains(kind))
}

/// What stands between the features of a sequence.
fn is_between(c: char) -> bool {
    c.is_whitespace() || c == '\u{1e}'
}

/// Reads GeoJSON: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>, options: &ReadOptions) -> (Option<Map>, Vec<Problem>) {
    let judge = Judge::new(&options.tags);
    let mut reader =
        Reader { source, judge: &judge, problems: Vec::new(), drawn: Vec::new(), is_degrees: true };
    let map = reader.file().and_then(|file| reader.map(&file, options.origin));
    // In the order of the file, whichever check found them.
    reader
        .problems
        .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |p| p.span.start));
    (map, reader.problems)
}

/// A FeatureCollection, or a Feature that stands alone.
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
    /// ArcGIS has features of its own.
    #[serde(borrow, rename = "geometryType")]
    geometry_type: Option<&'a RawValue>,
}

/// What a file has, however it is written.
struct Collection<'a> {
    head: File<'a>,
    /// Each feature's text and what to call it.
    features: Vec<&'a str>,
    /// What a feature is called besides its number; empty where it stands alone.
    called: &'static str,
}

#[derive(Deserialize)]
struct RawFeature<'a> {
    #[serde(borrow, rename = "type")]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow)]
    geometry: Option<&'a RawValue>,
    #[serde(borrow)]
    properties: Option<&'a RawValue>,
}

/// The texts that a geometry is made of.
#[derive(Deserialize)]
struct RawGeometry<'a> {
    #[serde(borrow, rename = "type")]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow)]
    coordinates: Option<&'a RawValue>,
    #[serde(borrow)]
    geometries: Option<List<&'a RawValue, MAX_FEATURES>>,
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
    /// Whether the file does not say itself that its coordinates are something else.
    is_degrees: bool,
}

impl<'a> Reader<'a> {
    fn error(&mut self, message: impl Into<String>, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    /// Where a part of the text stands in it.
    fn span(&self, part: &str) -> Range<usize> {
        let start = part.as_ptr() as usize - self.source.text.as_ptr() as usize;
        start..start + part.len()
    }

    /// As much of a part as an excerpt can show: its first line, or the beginning of that.
    fn first_line(&self, part: &str) -> Range<usize> {
        let line = part.lines().next().unwrap_or(part);
        self.span(&line[..line.floor_char_boundary(EXCERPT_BYTES)])
    }

    /// What a part says, or why it does not.
    fn parse<T: Deserialize<'a>>(&mut self, part: &'a str, what: &str, help: &str) -> Option<T> {
        serde_json::from_str(part).map_err(|error| self.refuse(part, what, &error, help)).ok()
    }

    /// What an object says: a list of its members in their order would pass otherwise.
    fn object<T: Deserialize<'a>>(&mut self, part: &'a str, what: &str, help: &str) -> Option<T> {
        if !part.starts_with('{') {
            self.error(what, self.first_line(part), "this is no object", help);
            return None;
        }
        self.parse(part, what, help)
    }

    fn refuse(&mut self, part: &str, what: &str, error: &serde_json::Error, help: &str) {
        let at = self.span(part).start + json::place_of(part, error);
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
            let help = "cut the part out that the robot will drive in: ogr2ogr -clipsrc";
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
                "wrap geometries in features: their properties say what they are",
            ),
        };
        self.error(message, self.first_line(text), label, help);
    }

    /// Features one after the other, and perhaps collections of them.
    fn sequence(&mut self, records: Vec<&'a str>) -> Option<Collection<'a>> {
        let mut features = Vec::new();
        for (index, text) in records.into_iter().enumerate() {
            let what = format!("record {} of the sequence is no feature", index + 1);
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
        let mut passed = Passed::default();
        let drawing = Drawing::new(&plane, self.judge, &self.drawn);
        for drawn in &self.drawn {
            drawing.feature(drawn, &mut map, &mut passed);
        }
        if !has_errors(&self.problems) {
            passed.tell(WITH_OUTLINES, &mut self.problems);
            self.judge.tell(&mut self.problems);
            let places = self.drawn.iter().flat_map(Drawn::positions);
            self.problems.extend(Bounds::around(places).and_then(|around| around.suspect()));
            plane.note(&map, &passed.unused, &mut self.problems);
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
        // Where coordinates were refused there is nothing left to draw.
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

    /// Where 0,0 is, as the file says.
    fn origin(&mut self, raw: &'a RawValue) -> Option<GeoPoint> {
        let help = "write \"origin\": [longitude, latitude], in degrees, or leave it out";
        let Position([lat, lon]) = self.parse(raw.get(), "the origin is no position", help)?;
        let origin = GeoPoint::from_degrees(lat, lon);
        if origin.is_none() {
            let span = self.first_line(raw.get());
            self.error("the origin is off the globe", span, "this one", help);
        }
        origin
    }

    /// Where the position stands that makes the extent absurd, and what to say of it.
    fn stray(&self) -> Option<(Range<usize>, String)> {
        let places: Vec<[f64; 2]> = self.drawn.iter().flat_map(Drawn::positions).collect();
        let stray = Stray::among(&places)?;
        let mut texts = Vec::new();
        let all = self.drawn.iter().flat_map(|drawn| &drawn.texts);
        all.for_each(|text| coordinates::texts(text, &mut texts));
        Some((self.first_line(texts.get(stray.index)?), stray.label()))
    }

    /// Coordinates in another system are refused: RFC 7946 has but one.
    fn check_system(&mut self, crs: Option<&'a RawValue>) {
        let Some(crs) = crs else { return };
        if let Some(name) = system::foreign(crs.get()) {
            self.is_degrees = false;
            let message = format!("the coordinates are in {name}, not in degrees of WGS-84");
            self.error(message, self.first_line(crs.get()), "said here", TO_DEGREES);
        }
    }

    fn bounds(&mut self, raw: &'a RawValue) -> Option<Bounds> {
        let help = "write west, south, east, north in degrees, or leave it out";
        let sides: List<f64, 6> = self.parse(raw.get(), "the bbox is no list of numbers", help)?;
        let corners = match sides.0[..] {
            [west, south, east, north] => Some(([south, west], [north, east])),
            // With altitudes.
            [west, south, _, east, north, _] => Some(([south, west], [north, east])),
            _ => None,
        };
        let bounds = corners.and_then(|(low, high)| Bounds::between(low, high));
        if bounds.is_none() && self.is_degrees {
            let span = self.first_line(raw.get());
            self.error("the bbox is no box on the globe", span, "this one", help);
        }
        bounds
    }

    fn feature(&mut self, text: &'a str, name: &str) {
        let help = "a feature has type, geometry and properties";
        let what = format!("{name} is no feature");
        let Some(raw): Option<RawFeature<'a>> = self.object(text, &what, help) else { return };
        if raw.kind.as_deref() != Some("Feature") {
            self.error(what, self.first_line(text), "its type is not Feature", help);
            return;
        }
        let properties = raw.properties.map_or("null", RawValue::get);
        let what = format!("the properties of {name} are no object");
        let help = "write \"properties\": {\"building\": \"yes\"}, or null";
        let tags = match properties::tags(properties) {
            Ok(tags) => tags,
            Err(error) => {
                self.refuse(properties, &what, &error, help);
                return;
            }
        };
        let radius = tags.get("radius").map(|radius| radius.trim_end_matches('m').trim().parse());
        if radius.is_some_and(|radius| !radius.is_ok_and(|it| (0.0..=FARTHEST_M).contains(&it))) {
            let span = self.first_line(properties);
            let message = format!("the radius of {name} is no length");
            self.error(message, span, "", "write it in metres");
        }
        let span = self.first_line(text);
        let mut drawn = Drawn { tags, pieces: Vec::new(), texts: Vec::new(), span };
        // Without a geometry a feature is nowhere, which RFC 7946 allows.
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
                let help = match coordinates.contains('"') {
                    true => "write coordinates as numbers, without quotes",
                    false => help,
                };
                self.refuse(coordinates, &what, &error, help);
            }
        }
    }

    /// Whether a geometry's coordinates are on the globe and its rings closed.
    fn check(&mut self, pieces: &[Piece], text: &'a str, name: &str) -> bool {
        let before = self.problems.len();
        let mut all = pieces.iter().flat_map(Piece::positions).enumerate();
        let is_off = |[lat, lon]: [f64; 2]| lat.abs() > 90.0 || lon.abs() > 180.0;
        if let Some((index, [lat, lon])) = all.find(|(_, at)| is_off(*at)) {
            let (what, help) = if lat.abs().max(lon.abs()) > ANGLE_LIMIT {
                ("are metres of some projection, not degrees", TO_DEGREES)
            } else if lat.abs() <= 180.0 && lon.abs() <= 90.0 {
                ("are off the globe", "longitude comes first; these look the other way round")
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

    /// `text` is the geometry's coordinates, `end` how many of them end with this line.
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

    /// Where a position stands, counted through all of a geometry's coordinates.
    fn position(&self, text: &'a str, index: usize) -> Range<usize> {
        let mut found = Vec::new();
        coordinates::texts(text, &mut found);
        self.first_line(found.get(index).copied().unwrap_or(text))
    }
}

/// The records of a text: one, or features one after the other, each behind a record separator or
/// in a line of its own. The last is whatever cannot be read.
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
