//! OpenStreetMap XML, as editors, servers and Overpass write it.
//!
//! The text is read element by element in one pass, without building a tree. Elements of an extract
//! have few attributes and little nesting; a file with more is refused.

use super::extract::{
    BUDGET_BYTES, Builder, Extract, Member, Object, Relation, TooMuch, Version, Way,
};
use crate::formats::MAX_PROBLEMS;
use crate::formats::globe::Bounds;
use crate::formats::tags::Tags;
use crate::problem::{Problem, Source};
use math::GeoPoint;
use quick_xml::events::Event;
use quick_xml::events::attributes::{Attribute, Attributes};
use quick_xml::{Reader as Events, XmlVersion};
use std::borrow::Cow;
use std::ops::Range;
use std::str::FromStr;
use std::sync::Arc;

/// Most bytes of an element that an excerpt shows.
const EXCERPT_BYTES: usize = 80;
/// Most attributes of an element; a node with its history has a dozen.
const MAX_ATTRIBUTES: usize = 64;
/// Deepest nesting of elements; a relation with its members' outlines has four levels.
const MAX_DEPTH: usize = 64;

const FETCH_AGAIN: &str = "check whether the file was cut off, and save or fetch it again";

/// Reads an extract; `None` if the text is not OSM XML.
pub(super) fn parse(source: &Arc<Source>, problems: &mut Vec<Problem>) -> Option<Extract> {
    parse_within(source, problems, BUDGET_BYTES)
}

/// As [`parse`], with a memory budget in bytes.
pub(super) fn parse_within(
    source: &Arc<Source>,
    problems: &mut Vec<Problem>,
    budget: usize,
) -> Option<Extract> {
    let builder = Builder::new(budget);
    let mut reader = Reader { source, problems, builder, current: Current::Other, depth: 0 };
    reader.file().ok()?;
    Some(reader.builder.finish())
}

/// Bytes of the element with an id, or of the first of its kind.
pub(super) fn find(source: &Arc<Source>, kind: &str, id: Option<i64>) -> Option<Range<usize>> {
    let mut events = Events::from_str(&source.text);
    loop {
        let start = events.buffer_position() as usize;
        let is_empty = match events.read_event().ok()? {
            Event::Eof => return None,
            Event::Start(_) => false,
            Event::Empty(_) => true,
            _ => continue,
        };
        let element =
            Element::of(source, start..events.buffer_position() as usize, is_empty).ok()?;
        let is_it = |id: i64| element.get("id").and_then(|text| text.parse().ok()) == Some(id);
        if element.name == kind && id.is_none_or(is_it) {
            return Some(element.span);
        }
    }
}

/// The file is refused; the problems give the reason.
struct Refused;

/// The start tag of an element.
struct Element<'t> {
    name: &'t str,
    attributes: Vec<Attribute<'t>>,
    /// Its first line, cut for an excerpt.
    span: Range<usize>,
}

impl<'t> Element<'t> {
    /// The element whose tag lies in a range of the text.
    fn of(source: &'t Source, tag: Range<usize>, is_empty: bool) -> Result<Self, String> {
        let first = source.text[tag.clone()].lines().next().unwrap_or_default();
        let span = tag.start..tag.start + first.floor_char_boundary(EXCERPT_BYTES);
        // Between `<` and `>` or `/>`.
        let end = tag.end.saturating_sub(if is_empty { 2 } else { 1 });
        let inside = source.text.get(tag.start + 1..end).unwrap_or_default();
        let length = inside.find(|c: char| c.is_ascii_whitespace()).unwrap_or(inside.len());
        let name = &inside[..length];
        let mut all = Attributes::new(inside, length);
        let mut attributes: Vec<Attribute<'t>> = Vec::new();
        for attribute in all.with_checks(false) {
            let attribute = attribute.map_err(|error| error.to_string())?;
            if attributes.iter().any(|known| known.key == attribute.key) {
                return Err(format!("attribute '{}' is given twice", attribute.key.0));
            }
            if attributes.len() >= MAX_ATTRIBUTES {
                return Err(format!("an element has more than {MAX_ATTRIBUTES} attributes"));
            }
            attributes.push(attribute);
        }
        Ok(Self { name, attributes, span })
    }

    /// The raw value of an attribute.
    fn get(&self, name: &str) -> Option<&str> {
        let attribute = self.attributes.iter().find(|attribute| attribute.key.0 == name)?;
        Some(attribute.value.as_ref())
    }

    /// The value of an attribute, with references resolved.
    fn text(&self, name: &str) -> Option<Cow<'t, str>> {
        let attribute = self.attributes.iter().find(|attribute| attribute.key.0 == name)?;
        // Invalid references stay as written.
        let read = attribute.normalized_value(XmlVersion::Explicit1_0);
        Some(read.unwrap_or_else(|_| attribute.value.clone()))
    }

    fn version(&self) -> Version {
        let number = self.get("version").and_then(|text| text.parse().ok()).unwrap_or_default();
        // An editor's pending deletion, or a server's record of one.
        let is_deleted =
            self.get("action") == Some("delete") || self.get("visible") == Some("false");
        Version { number, is_deleted }
    }
}

/// The object that is being read.
enum Current {
    Node(Version, Object, Option<GeoPoint>),
    Way(Version, Way),
    /// A relation, and the outline of the current member.
    Relation(Version, Relation, Option<Way>),
    Remark(String, Range<usize>),
    Other,
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    problems: &'a mut Vec<Problem>,
    builder: Builder,
    current: Current,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn error(&mut self, message: String, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    fn file(&mut self) -> Result<(), Refused> {
        let mut events = Events::from_str(&self.source.text);
        loop {
            let start = events.buffer_position() as usize;
            let event = events.read_event();
            let tag = start..events.buffer_position() as usize;
            match event {
                Ok(Event::Start(_)) => self.open(tag, false)?,
                Ok(Event::Empty(_)) => {
                    self.open(tag, true)?;
                    self.close()?;
                }
                Ok(Event::End(_)) => self.close()?,
                Ok(Event::Text(_)) => {
                    if let Current::Remark(text, _) = &mut self.current {
                        *text = self.source.text[tag].trim().to_owned();
                    }
                }
                Ok(Event::Eof) if self.depth > 0 => {
                    let end = self.source.text.trim_end().len();
                    let message = "this is not XML: unexpected end of the file".into();
                    self.error(message, end..end, "here", FETCH_AGAIN);
                    return Err(Refused);
                }
                Ok(Event::Eof) => return Ok(()),
                Ok(_) => {}
                Err(error) => {
                    let at = (events.error_position() as usize).min(self.source.text.len());
                    let at = self.source.text.floor_char_boundary(at);
                    self.error(format!("this is not XML: {error}"), at..at, "here", FETCH_AGAIN);
                    return Err(Refused);
                }
            }
        }
    }

    fn open(&mut self, tag: Range<usize>, is_empty: bool) -> Result<(), Refused> {
        let source: &'a Source = self.source;
        let at = tag.start;
        let element = Element::of(source, tag, is_empty).map_err(|reason| {
            self.error(format!("this is not XML: {reason}"), at..at, "here", FETCH_AGAIN);
            Refused
        })?;
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let message = format!("elements are nested deeper than {MAX_DEPTH}");
            let help = "extracts never are; check that this is the file you mean";
            self.error(message, element.span, "here", help);
            return Err(Refused);
        }
        if self.problems.len() > MAX_PROBLEMS {
            return Err(Refused);
        }
        match self.depth {
            1 => self.root(&element),
            2 => self.begin(&element),
            _ => self.part(&element).or_else(|TooMuch| self.too_much(element.span)),
        }
    }

    fn too_much(&mut self, span: Range<usize>) -> Result<(), Refused> {
        self.error(TooMuch::MESSAGE.into(), span, "up to here", TooMuch::HELP);
        Err(Refused)
    }

    fn root(&mut self, root: &Element<'_>) -> Result<(), Refused> {
        let (message, help) = match root.name {
            "osm" => return Ok(()),
            "osmChange" | "osmAugmentedDiff" => (
                "the file is a list of changes (.osc), not a map",
                "apply it to the extract that it changes: `osmium apply-changes old.osm changes.osc -o new.osm`",
            ),
            name if name.eq_ignore_ascii_case("html") => (
                "the file is a web page, not an OpenStreetMap extract",
                "a busy server may send this: open it in a browser to see why, and fetch it again",
            ),
            _ => (
                "the file is not an OpenStreetMap extract",
                "save the data as .osm; other files are not maps",
            ),
        };
        self.error(message.into(), root.span.clone(), "not <osm>", help);
        Err(Refused)
    }

    /// Begins a top-level element.
    fn begin(&mut self, element: &Element<'_>) -> Result<(), Refused> {
        let version = element.version();
        self.current = match element.name {
            "bounds" => {
                self.bounds(element);
                Current::Other
            }
            "bound" => {
                self.bound(element);
                Current::Other
            }
            "remark" => Current::Remark(String::new(), element.span.clone()),
            "node" => match self.object(element) {
                // A deleted node has no place.
                Some(object) if version.is_deleted => {
                    Current::Node(version, object, Some(GeoPoint { lat_e7: 0, lon_e7: 0 }))
                }
                object => {
                    let place = self.place(element);
                    object.map_or(Current::Other, |object| Current::Node(version, object, place))
                }
            },
            "way" => self.object(element).map_or(Current::Other, |object| {
                Current::Way(version, Way { object, refs: Vec::new() })
            }),
            "relation" => self.object(element).map_or(Current::Other, |object| {
                Current::Relation(version, Relation { object, members: Vec::new() }, None)
            }),
            _ => Current::Other,
        };
        Ok(())
    }

    /// Reads a part of the current object.
    fn part(&mut self, element: &Element<'_>) -> Result<(), TooMuch> {
        let mut current = std::mem::replace(&mut self.current, Current::Other);
        let object = match &mut current {
            Current::Node(_, object, _) => Some(object),
            Current::Way(_, way) => Some(&mut way.object),
            Current::Relation(_, relation, _) => Some(&mut relation.object),
            Current::Remark(..) | Current::Other => None,
        };
        if let Some(object) = object.filter(|_| self.depth == 3 && element.name == "tag")
            && let (Some(key), Some(value)) = (element.text("k"), element.text("v"))
        {
            self.builder.take_tag(&key, &value)?;
            object.tags.0.push((key.into_owned(), value.into_owned()));
        }
        match (&mut current, element.name, self.depth) {
            (Current::Way(_, way), "nd", 3) => {
                if let Some(node) = self.number(element, "ref") {
                    self.builder.take_ref()?;
                    way.refs.push(node);
                    if let Some(place) = place_beside(element) {
                        self.builder.place(node, place)?;
                    }
                }
            }
            (Current::Relation(_, relation, outline), "member", 3) => {
                *outline = None;
                if element.get("type") == Some("way")
                    && let Some(way) = self.number(element, "ref")
                {
                    self.builder.take_member()?;
                    let is_inner = element.get("role") == Some("inner");
                    relation.members.push(Member { way, is_inner });
                    let object = Object { id: way, tags: Tags::default(), span: 0..0 };
                    *outline = Some(Way { object, refs: Vec::new() });
                }
            }
            (Current::Relation(_, _, Some(outline)), "nd", 4) => {
                self.builder.take_ref()?;
                outline.refs.push(self.builder.unnamed(place_beside(element))?);
            }
            _ => {}
        }
        self.current = current;
        Ok(())
    }

    fn close(&mut self) -> Result<(), Refused> {
        self.depth = self.depth.saturating_sub(1);
        if let (2, Current::Relation(_, _, outline)) = (self.depth, &mut self.current)
            && let Some(way) = outline.take().filter(|way| !way.refs.is_empty())
        {
            let done = self.builder.way(Version::default(), way);
            return done.or_else(|TooMuch| self.too_much(0..0));
        }
        if self.depth != 1 {
            return Ok(());
        }
        let done = match std::mem::replace(&mut self.current, Current::Other) {
            Current::Node(version, object, Some(place)) => {
                self.builder.node(version, object, place)
            }
            Current::Way(version, way) => self.builder.way(version, way),
            Current::Relation(version, relation, _) => self.builder.relation(version, relation),
            Current::Remark(text, span) => {
                self.remark(&text, span);
                Ok(())
            }
            Current::Node(_, _, None) | Current::Other => Ok(()),
        };
        done.or_else(|TooMuch| self.too_much(0..0))
    }

    /// A mandatory number of an element; reports if it is missing or invalid.
    fn number<T: FromStr>(&mut self, element: &Element<'_>, name: &str) -> Option<T> {
        let kind = element.name;
        let Some(text) = element.get(name) else {
            let label = format!("add {name}=\"...\"");
            let help = "save or fetch the file again; editors and servers always write it";
            self.error(format!("<{kind}> has no {name}"), element.span.clone(), &label, help);
            return None;
        };
        let number = text.trim().parse().ok();
        if number.is_none() {
            let start = text.as_ptr() as usize - self.source.text.as_ptr() as usize;
            let span = start..start + text.floor_char_boundary(EXCERPT_BYTES);
            let message = format!("the {name} of <{kind}> is not a number");
            self.error(message, span, "this", "numbers are written as 12 or 51.0123456");
        }
        number
    }

    fn object(&mut self, element: &Element<'_>) -> Option<Object> {
        let id = self.number(element, "id")?;
        Some(Object { id, tags: Tags::default(), span: element.span.clone() })
    }

    fn place(&mut self, element: &Element<'_>) -> Option<GeoPoint> {
        let (lat, lon) = (self.number(element, "lat"), self.number(element, "lon"));
        let place = GeoPoint::from_degrees(lat?, lon?);
        if place.is_none() {
            let id = element.get("id").unwrap_or_default();
            let help = "latitudes are -90 to 90 degrees, longitudes -180 to 180";
            let message = format!("node {id} is off the globe");
            self.error(message, element.span.clone(), "this node", help);
        }
        place
    }

    fn bounds(&mut self, element: &Element<'_>) {
        let mut side = |name: &str| self.number::<f64>(element, name);
        let sides = [side("minlat"), side("minlon"), side("maxlat"), side("maxlon")];
        if let [Some(south), Some(west), Some(north), Some(east)] = sides {
            self.add_bounds([south, west, north, east], element);
        }
    }

    /// Bounds as osmosis writes them: `box="south,west,north,east"`.
    fn bound(&mut self, element: &Element<'_>) {
        let sides = element.get("box").unwrap_or_default().split(',');
        let sides: Vec<f64> = sides.filter_map(|side| side.trim().parse().ok()).collect();
        if let Ok(sides) = <[f64; 4]>::try_from(sides) {
            self.add_bounds(sides, element);
        }
    }

    fn add_bounds(&mut self, sides: [f64; 4], element: &Element<'_>) {
        let [south, west, north, east] = sides.map(to_e7);
        match Bounds::between([south, west], [north, east]) {
            Some(bounds) => self.builder.bounds(bounds),
            None => {
                let span = element.span.clone();
                let help = "minlat and minlon are its south-west corner, in degrees";
                self.error("the bounds are not a box on the globe".into(), span, "these", help);
            }
        }
    }

    /// Reports a server's remark on why its answer is incomplete.
    fn remark(&mut self, text: &str, span: Range<usize>) {
        self.problems.push(
            Problem::warning(format!("the server remarks: {text}"))
                .at(self.source, span, "the file may be incomplete")
                .help("fetch it again, or a smaller part"),
        );
    }
}

/// The place that a node reference carries.
fn place_beside(element: &Element<'_>) -> Option<GeoPoint> {
    let number = |name: &str| element.get(name)?.trim().parse().ok();
    GeoPoint::from_degrees(number("lat")?, number("lon")?)
}

/// Rounds degrees to the precision of the binary encoding.
fn to_e7(degrees: f64) -> f64 {
    (degrees * 1e7).round() / 1e7
}
