//! GeoJSON: features on the globe, with properties that say what they are.
//!
//! Source: RFC 7946. Coordinates are WGS-84, longitude before latitude; an altitude after them
//! is ignored. Properties have the meaning of OpenStreetMap's tags, see `tags`; besides, a
//! point may have a `radius` in metres, and any point with a `name` is a goal unless its
//! property `goal` says no.
//!
//! The text of each part is kept beside what it says (`RawValue`), so that every mistake has
//! its place. Deliberately absent: other coordinate systems, TopoJSON, lines of GeoJSON.

use super::globe::{Bounds, Plane, Stray};
use super::tags::Tags;
use crate::map::{Feature, Map, NamedPoint, Point, Role, Shape};
use crate::problem::{Problem, Source};
use geojson::{Geometry, GeometryValue, JsonObject, JsonValue, Position};
use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// What `--help` says of this format.
pub const CONVENTIONS: &str = "\
GeoJSON  (RFC 7946, .geojson) Features with a property `building` or `obstacle` block, and so
         does barrier=wall, fence or hedge; lines are walls without width, points circles of
         their property `radius` in metres. natural=wood, landuse=forest and layer=foliage
         or comms weaken radio; any other `layer` is an area for a mission to name. Points
         with a `name` are goals. 0,0 is the centre of the file's bbox, which is the extent;
         without one, of its coordinates, and the extent reaches 10 m farther.";

/// A number beyond this is no angle that went astray but metres.
const ANGLE_LIMIT: f64 = 360.0;

/// Most of a part that an excerpt shows, bytes.
const EXCERPT_BYTES: usize = 80;

/// Whether a text reads like GeoJSON.
pub fn recognises(text: &str) -> bool {
    text.trim_start().starts_with('{')
        && ["\"FeatureCollection\"", "\"Feature\""].iter().any(|kind| text.contains(kind))
}

/// Reads GeoJSON: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let mut reader = Reader { source, problems: Vec::new(), drawn: Vec::new(), is_degrees: true };
    let map = reader.file().and_then(|file| reader.map(&file));
    // In the order of the file, whichever check found them.
    reader
        .problems
        .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |p| p.span.start));
    (map, reader.problems)
}

/// A FeatureCollection, or a Feature that stands alone.
#[derive(Deserialize)]
struct File<'a> {
    #[serde(borrow, rename = "type")]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow)]
    name: Option<&'a RawValue>,
    #[serde(borrow)]
    features: Option<Vec<&'a RawValue>>,
    #[serde(borrow)]
    bbox: Option<&'a RawValue>,
    #[serde(borrow)]
    crs: Option<&'a RawValue>,
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
    #[serde(borrow)]
    coordinates: Option<&'a RawValue>,
    #[serde(borrow)]
    geometries: Option<Vec<&'a RawValue>>,
}

/// A part of a geometry; places are latitude and longitude, degrees.
enum Piece {
    Point([f64; 2]),
    Line(Vec<[f64; 2]>),
    Polygon(Vec<Vec<[f64; 2]>>),
}

/// A feature whose coordinates are on the globe.
struct Drawn<'a> {
    tags: Tags,
    pieces: Vec<Piece>,
    /// The coordinates of the pieces as the file writes them, in their order.
    texts: Vec<&'a str>,
    /// Metres.
    radius: f64,
    span: Range<usize>,
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    problems: Vec<Problem>,
    drawn: Vec<Drawn<'a>>,
    /// Whether the file does not say itself that its coordinates are something else.
    is_degrees: bool,
}

impl<'a> Reader<'a> {
    fn error(&mut self, message: impl Into<String>, span: Range<usize>, label: &str, mend: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).mend(mend));
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
    fn parse<T: Deserialize<'a>>(&mut self, part: &'a str, what: &str, mend: &str) -> Option<T> {
        serde_json::from_str(part).map_err(|error| self.refuse(part, what, &error, mend)).ok()
    }

    /// What an object says: a list of its members in their order would pass otherwise.
    fn object<T: Deserialize<'a>>(&mut self, part: &'a str, what: &str, mend: &str) -> Option<T> {
        if !part.starts_with('{') {
            self.error(what, self.first_line(part), "this is no object", mend);
            return None;
        }
        self.parse(part, what, mend)
    }

    fn refuse(&mut self, part: &str, what: &str, error: &serde_json::Error, mend: &str) {
        // serde_json counts lines and bytes from 1, within the part.
        let before = part.split_inclusive('\n').take(error.line().saturating_sub(1));
        let at = before.map(str::len).sum::<usize>() + error.column().saturating_sub(1);
        let at = self.span(part).start + at.min(part.len());
        let reason = error.to_string();
        let reason = reason.rsplit_once(" at line ").map_or(reason.as_str(), |(reason, _)| reason);
        self.error(format!("{what}: {reason}"), at..at, "here", mend);
    }

    fn file(&mut self) -> Option<File<'a>> {
        let text = self.source.text.trim();
        let mend =
            "a GeoJSON map is an object of type FeatureCollection; check where it was cut off";
        let mut file: File<'a> = self.object(text, "this is not GeoJSON", mend)?;
        match file.kind.as_deref() {
            Some("FeatureCollection") if file.features.is_some() => {}
            Some("Feature") => file.features = Some(vec![self.parse(text, "", mend)?]),
            _ => {
                let label = "neither a Feature nor a FeatureCollection with features";
                let mend = "wrap geometries in features: their properties say what they are";
                self.error("the file holds no features", self.first_line(text), label, mend);
                return None;
            }
        }
        Some(file)
    }

    fn map(&mut self, file: &File<'a>) -> Option<Map> {
        self.check_system(file.crs);
        let bounds = file.bbox.and_then(|bbox| self.bounds(bbox));
        let features = file.features.as_deref().unwrap_or_default();
        let is_alone = file.kind.as_deref() == Some("Feature");
        for (index, feature) in features.iter().enumerate() {
            let name = if is_alone { "the feature".into() } else { format!("features[{index}]") };
            self.feature(feature.get(), &name);
        }
        let places =
            self.drawn.iter().flat_map(|drawn| drawn.pieces.iter().flat_map(Piece::places));
        let plane = match Plane::new(bounds, places) {
            Ok(plane) => plane,
            // Where coordinates were refused there is nothing left to draw.
            Err(_) if !self.problems.is_empty() && self.drawn.iter().all(Drawn::is_nowhere) => {
                return None;
            }
            Err(problem) => {
                let found = match file.bbox.filter(|_| bounds.is_some()) {
                    Some(bbox) => Some((self.first_line(bbox.get()), "this bbox".into())),
                    None => self.stray(),
                };
                self.problems.push(match found {
                    Some((span, label)) => problem.at(self.source, span, label),
                    None => problem,
                });
                return None;
            }
        };
        let mut map = plane.map();
        map.title = file.name.and_then(|name| serde_json::from_str(name.get()).ok());
        for drawn in &self.drawn {
            draw(drawn, &plane, &mut map);
        }
        let count = |drawn: &&Drawn<'_>| drawn.tags.meaning().is_some() || drawn.goal().is_some();
        let ignored = features.len() - self.drawn.iter().filter(count).count();
        if self.problems.is_empty() {
            self.problems.push(plane.note(&map, ignored));
        }
        Some(map)
    }

    /// Where the position stands that makes the extent absurd, and what to say of it.
    fn stray(&self) -> Option<(Range<usize>, String)> {
        let places = |drawn: &Drawn<'_>| -> Vec<[f64; 2]> {
            drawn.pieces.iter().flat_map(Piece::places).collect()
        };
        let stray = Stray::among(&self.drawn.iter().flat_map(places).collect::<Vec<_>>())?;
        let mut texts = Vec::new();
        self.drawn
            .iter()
            .flat_map(|drawn| &drawn.texts)
            .for_each(|text| positions(text, &mut texts));
        Some((self.first_line(texts.get(stray.index)?), stray.label()))
    }

    /// Coordinates in another system are refused: RFC 7946 has but one.
    fn check_system(&mut self, crs: Option<&'a RawValue>) {
        let Some(crs) = crs else { return };
        let system: JsonValue = serde_json::from_str(crs.get()).unwrap_or_default();
        let name = system["properties"]["name"].as_str().unwrap_or("an unnamed system");
        if !system.is_null() && !name.ends_with("CRS84") && !name.ends_with(":4326") {
            self.is_degrees = false;
            let message = format!("the coordinates are in {name}, not in degrees of WGS-84");
            let mend =
                "convert them: ogr2ogr -t_srs EPSG:4326 -lco RFC7946=YES new.geojson old.geojson";
            self.error(message, self.first_line(crs.get()), "said here", mend);
        }
    }

    fn bounds(&mut self, raw: &'a RawValue) -> Option<Bounds> {
        let mend = "write west, south, east, north in degrees, or leave it out";
        let sides: Vec<f64> = self.parse(raw.get(), "the bbox is no list of numbers", mend)?;
        let corners = match sides[..] {
            [west, south, east, north] => Some(([south, west], [north, east])),
            // With altitudes.
            [west, south, _, east, north, _] => Some(([south, west], [north, east])),
            _ => None,
        };
        let bounds = corners.and_then(|(low, high)| Bounds::between(low, high));
        if bounds.is_none() && self.is_degrees {
            let span = self.first_line(raw.get());
            self.error("the bbox is no box on the globe", span, "this one", mend);
        }
        bounds
    }

    fn feature(&mut self, text: &'a str, name: &str) {
        let mend = "a feature has type, geometry and properties";
        let what = format!("{name} is no feature");
        let Some(raw): Option<RawFeature<'a>> = self.object(text, &what, mend) else { return };
        if raw.kind.as_deref() != Some("Feature") {
            self.error(what, self.first_line(text), "its type is not Feature", mend);
            return;
        }
        let properties = raw.properties.map_or("null", RawValue::get);
        let what = format!("the properties of {name} are no object");
        let mend = "write \"properties\": {\"building\": \"yes\"}, or null";
        let tags = match serde_json::from_str::<Option<JsonObject>>(properties) {
            Ok(properties) => tags(&properties.unwrap_or_default()),
            Err(error) => {
                self.refuse(properties, &what, &error, mend);
                return;
            }
        };
        let radius = tags.get("radius").map_or(Some(0.0), |radius| radius.parse().ok());
        let radius = radius.filter(|radius| (0.0..=super::FARTHEST_M).contains(radius));
        if radius.is_none() {
            let span = self.first_line(properties);
            self.error(
                format!("the radius of {name} is no length"),
                span,
                "",
                "write it in metres",
            );
        }
        let (radius, span) = (radius.unwrap_or(0.0), self.first_line(text));
        let mut drawn = Drawn { tags, pieces: Vec::new(), texts: Vec::new(), radius, span };
        // Without a geometry a feature is nowhere, which RFC 7946 allows.
        if let Some(geometry) = raw.geometry.filter(|geometry| geometry.get() != "null") {
            self.geometry(geometry.get(), name, true, &mut drawn);
        }
        self.drawn.push(drawn);
    }

    fn geometry(&mut self, text: &'a str, name: &str, may_nest: bool, drawn: &mut Drawn<'a>) {
        let mend = "a geometry has a type and coordinates that are nested as deep as it asks for";
        let what = format!("the geometry of {name} cannot be read");
        let Some(raw): Option<RawGeometry<'a>> = self.object(text, &what, mend) else { return };
        if let Some(parts) = raw.geometries.filter(|_| may_nest) {
            for part in parts {
                self.geometry(part.get(), name, false, drawn);
            }
            return;
        }
        let Some(geometry): Option<Geometry> = self.object(text, &what, mend) else { return };
        let coordinates = raw.coordinates.map_or("", RawValue::get);
        let mut found = Vec::new();
        match geometry.value {
            GeometryValue::Point { coordinates } => {
                found.extend(place(&coordinates).map(Piece::Point))
            }
            GeometryValue::MultiPoint { coordinates } => {
                found.extend(places(&coordinates).into_iter().map(Piece::Point));
            }
            GeometryValue::LineString { coordinates } => {
                found.push(Piece::Line(places(&coordinates)))
            }
            GeometryValue::MultiLineString { coordinates } => {
                found.extend(coordinates.iter().map(|line| Piece::Line(places(line))));
            }
            GeometryValue::Polygon { coordinates } => found.push(polygon(&coordinates)),
            GeometryValue::MultiPolygon { coordinates } => {
                found.extend(coordinates.iter().map(|rings| polygon(rings)));
            }
            GeometryValue::GeometryCollection { .. } => {
                let mend = "take the inner collection apart";
                let span = self.first_line(text);
                self.error(what, span, "a collection within a collection", mend);
                return;
            }
        }
        if self.check(&found, coordinates, name) {
            drawn.pieces.append(&mut found);
            drawn.texts.push(coordinates);
        }
    }

    /// Whether a geometry's coordinates are on the globe and its rings closed.
    fn check(&mut self, pieces: &[Piece], text: &'a str, name: &str) -> bool {
        let before = self.problems.len();
        let all: Vec<[f64; 2]> = pieces.iter().flat_map(Piece::places).collect();
        let is_off = |[lat, lon]: &[f64; 2]| lat.abs() > 90.0 || lon.abs() > 180.0;
        if let Some(index) = all.iter().position(is_off) {
            let [lat, lon] = all[index];
            let (what, mend) = if lat.abs().max(lon.abs()) > ANGLE_LIMIT {
                (
                    "are metres of some projection, not degrees",
                    "convert them: ogr2ogr -t_srs EPSG:4326 new.geojson old.geojson",
                )
            } else if lat.abs() <= 180.0 && lon.abs() <= 90.0 {
                ("are off the globe", "longitude comes first; these look the other way round")
            } else {
                ("are off the globe", "write longitude, then latitude, in degrees of WGS-84")
            };
            if self.is_degrees {
                let span = self.position(text, index);
                self.error(format!("coordinates of {name} {what}"), span, "these", mend);
            }
            return false;
        }
        let mut end = 0;
        for piece in pieces {
            let lines: &[Vec<[f64; 2]>] = match piece {
                Piece::Point(_) => &[],
                Piece::Line(line) => std::slice::from_ref(line),
                Piece::Polygon(rings) => rings,
            };
            for line in lines {
                end += line.len();
                self.check_line(line, matches!(piece, Piece::Polygon(_)), name, (text, end));
            }
        }
        self.problems.len() == before
    }

    /// `text` is the geometry's coordinates, `end` how many of them end with this line.
    fn check_line(
        &mut self,
        line: &[[f64; 2]],
        is_ring: bool,
        name: &str,
        (text, end): (&'a str, usize),
    ) {
        let (message, label, mend) = if is_ring && line.first() != line.last() {
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
        self.error(message, span, label, mend);
    }

    /// Where a position stands, counted through all of a geometry's coordinates.
    fn position(&self, text: &'a str, index: usize) -> Range<usize> {
        let mut found = Vec::new();
        positions(text, &mut found);
        self.first_line(found.get(index).copied().unwrap_or(text))
    }
}

/// The texts of the innermost lists. Nested no deeper than any geometry: checked before.
fn positions<'a>(text: &'a str, found: &mut Vec<&'a str>) {
    let parts: Vec<&'a RawValue> = serde_json::from_str(text).unwrap_or_default();
    if parts.first().is_some_and(|part| part.get().starts_with('[')) {
        parts.iter().for_each(|part| positions(part.get(), found));
    } else if !parts.is_empty() {
        found.push(text);
    }
}

/// Latitude and longitude; the library has checked that there are two numbers.
fn place(position: &Position) -> Option<[f64; 2]> {
    match position.as_slice() {
        [lon, lat, ..] => Some([*lat, *lon]),
        _ => None,
    }
}

fn places(positions: &[Position]) -> Vec<[f64; 2]> {
    positions.iter().filter_map(place).collect()
}

fn polygon(rings: &[Vec<Position>]) -> Piece {
    Piece::Polygon(rings.iter().map(|ring| places(ring)).collect())
}

/// Properties as tags: what is neither text, number nor truth means nothing here.
fn tags(properties: &JsonObject) -> Tags {
    let text = |value: &JsonValue| match value {
        JsonValue::String(text) => Some(text.clone()),
        JsonValue::Number(number) => Some(number.to_string()),
        JsonValue::Bool(truth) => Some(if *truth { "yes" } else { "no" }.into()),
        _ => None,
    };
    let tags = properties.iter().filter_map(|(key, value)| Some((key.clone(), text(value)?)));
    Tags(tags.collect())
}

impl Piece {
    fn places(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Point(place) => vec![*place],
            Self::Line(line) => line.clone(),
            Self::Polygon(rings) => rings.concat(),
        }
    }
}

impl Drawn<'_> {
    fn is_nowhere(&self) -> bool {
        self.pieces.is_empty()
    }

    /// The name of a goal and its place, if the feature is one.
    fn goal(&self) -> Option<(&str, [f64; 2])> {
        match (&self.pieces[..], self.tags.get("name")) {
            (&[Piece::Point(place)], Some(name)) => {
                let may_be = self.tags.get("goal").is_none() || self.tags.says("goal");
                (may_be && self.tags.meaning().is_none()).then_some((name, place))
            }
            _ => None,
        }
    }
}

/// Adds a feature to the map.
fn draw(drawn: &Drawn<'_>, plane: &Plane, map: &mut Map) {
    let metres = |line: &Vec<[f64; 2]>| -> Vec<Point> {
        line.iter().map(|place| plane.metres(*place)).collect()
    };
    if let Some((name, place)) = drawn.goal() {
        let (name, at, span) = (name.to_owned(), plane.metres(place), drawn.span.clone());
        map.points.push(NamedPoint { name, at, span });
    }
    let Some(meaning) = drawn.tags.meaning() else { return };
    for piece in &drawn.pieces {
        let shapes = match piece {
            Piece::Point(place) => {
                vec![Shape::Circle { centre: plane.metres(*place), radius: drawn.radius }]
            }
            Piece::Line(line) => vec![Shape::Polyline(metres(line))],
            // RFC 7946 lets it be empty.
            Piece::Polygon(rings) if rings.is_empty() => Vec::new(),
            Piece::Polygon(rings) if meaning.is_line => {
                rings.iter().map(|ring| Shape::Polyline(metres(ring))).collect()
            }
            Piece::Polygon(rings) => {
                // Rings close themselves in the model.
                let open = |ring: &Vec<[f64; 2]>| metres(ring)[1..].to_vec();
                vec![Shape::Polygon(rings.iter().map(open).collect())]
            }
        };
        map.features.extend(shapes.into_iter().map(|shape| Feature {
            shape,
            role: meaning.role,
            name: meaning.name.clone(),
            height_m: drawn.tags.height_m().filter(|_| meaning.role != Role::Zone),
            span: drawn.span.clone(),
        }));
    }
}

#[cfg(test)]
mod tests;
