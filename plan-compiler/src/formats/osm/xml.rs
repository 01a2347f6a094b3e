//! OpenStreetMap's XML, as its editors, its servers and Overpass write it.

use super::{Extract, Member, Object, Relation, Way};
use crate::formats::globe::Bounds;
use crate::formats::tags::Tags;
use crate::problem::{Problem, Source};
use math::GeoPoint;
use roxmltree::{Document, Node, TextPos};
use std::ops::Range;
use std::str::FromStr;
use std::sync::Arc;

/// Most of an element that an excerpt shows, bytes.
const EXCERPT_BYTES: usize = 80;

/// What an extract holds; `None` where the text is no OSM XML at all.
pub(super) fn parse(source: &Arc<Source>, problems: &mut Vec<Problem>) -> Option<Extract> {
    let mut reader = Reader { source, problems };
    let document = match Document::parse(&source.text) {
        Ok(document) => document,
        Err(error) => {
            let at = match error {
                // For which the library names no place, or where it began.
                roxmltree::Error::UnexpectedEndOfStream | roxmltree::Error::UnclosedRootNode => {
                    source.text.trim_end().len()
                }
                _ => byte(&source.text, error.pos()),
            };
            // The library's words end with its own row and column.
            let reason = error.to_string();
            let reason = reason.rsplit_once(" at ").map_or(reason.as_str(), |(reason, _)| reason);
            let mend = "check whether the file was cut off, and save or fetch it again";
            reader.error(format!("this is not XML: {reason}"), at..at, "here", mend);
            return None;
        }
    };
    let root = document.root_element();
    if root.tag_name().name() != "osm" {
        let mend = "save the data as .osm; changes (.osc) and other files are no maps";
        let span = reader.start_of(root);
        reader.error("the file is no extract of OpenStreetMap".into(), span, "not <osm>", mend);
        return None;
    }
    let mut extract = Extract::default();
    for element in root.children().filter(Node::is_element).filter(|element| !is_deleted(*element))
    {
        match element.tag_name().name() {
            "bounds" => reader.bounds(element, &mut extract),
            "node" => reader.node(element, &mut extract),
            "way" => reader.way(element, &mut extract),
            "relation" => reader.relation(element, &mut extract),
            "remark" => reader.remark(element),
            _ => {}
        }
    }
    Some(extract)
}

/// Where the text has an element, of an id or the first of its kind.
pub(super) fn find(source: &Arc<Source>, kind: &str, id: Option<i64>) -> Option<Range<usize>> {
    let document = Document::parse(&source.text).ok()?;
    let is_it = |element: &Node<'_, '_>| {
        let has_id =
            |id: i64| element.attribute("id").and_then(|text| text.parse().ok()) == Some(id);
        element.has_tag_name(kind) && id.is_none_or(has_id)
    };
    let element = document.root_element().children().find(is_it)?;
    Some(start_of(source, element))
}

/// The first line of an element: enough of it for an excerpt.
fn start_of(source: &Source, element: Node<'_, '_>) -> Range<usize> {
    let range = element.range();
    let first = source.text[range.clone()].lines().next().unwrap_or_default();
    range.start..range.start + first.floor_char_boundary(EXCERPT_BYTES)
}

/// What an editor keeps until it is uploaded, and what a server says is gone.
fn is_deleted(element: Node<'_, '_>) -> bool {
    element.attribute("action") == Some("delete") || element.attribute("visible") == Some("false")
}

/// Rows and columns count from 1, columns in characters.
fn byte(text: &str, at: TextPos) -> usize {
    let rows = text.split_inclusive('\n').take((at.row as usize).saturating_sub(1));
    let start: usize = rows.map(str::len).sum();
    let mut characters = text[start..].char_indices();
    let offset = characters.nth((at.col as usize).saturating_sub(1)).map(|(offset, _)| offset);
    offset.map_or(text.len(), |offset| start + offset)
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    problems: &'a mut Vec<Problem>,
}

impl Reader<'_> {
    fn error(&mut self, message: String, span: Range<usize>, label: &str, mend: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).mend(mend));
    }

    fn start_of(&self, element: Node<'_, '_>) -> Range<usize> {
        start_of(self.source, element)
    }

    /// A number that an element must have.
    fn number<T: FromStr>(&mut self, element: Node<'_, '_>, name: &str) -> Option<T> {
        let kind = element.tag_name().name();
        let Some(attribute) = element.attribute_node(name) else {
            let span = self.start_of(element);
            let label = format!("add {name}=\"...\"");
            let mend = "save or fetch the file again; editors and servers always write it";
            self.error(format!("<{kind}> has no {name}"), span, &label, mend);
            return None;
        };
        let number = attribute.value().trim().parse().ok();
        if number.is_none() {
            let message = format!("the {name} of <{kind}> is not a number");
            let mend = "numbers are written as 12 or 51.0123456";
            self.error(message, attribute.range_value(), "this", mend);
        }
        number
    }

    fn object(&mut self, element: Node<'_, '_>) -> Option<Object> {
        let id = self.number(element, "id")?;
        let tags = element.children().filter(|child| child.has_tag_name("tag"));
        let tags = tags.filter_map(|tag| {
            Some((tag.attribute("k")?.to_owned(), tag.attribute("v")?.to_owned()))
        });
        Some(Object { id, tags: Tags(tags.collect()), span: self.start_of(element) })
    }

    fn bounds(&mut self, element: Node<'_, '_>, extract: &mut Extract) {
        let mut side = |name: &str| self.number::<f64>(element, name);
        let sides = [side("minlat"), side("minlon"), side("maxlat"), side("maxlon")];
        let [Some(south), Some(west), Some(north), Some(east)] = sides else { return };
        let bounds = Bounds::between([south, west].map(to_e7), [north, east].map(to_e7));
        if bounds.is_none() {
            let span = self.start_of(element);
            let mend = "minlat and minlon are its south-west corner, in degrees";
            self.error("the bounds are no box on the globe".into(), span, "these", mend);
        }
        extract.bounds = extract.bounds.or(bounds);
    }

    fn node(&mut self, element: Node<'_, '_>, extract: &mut Extract) {
        let object = self.object(element);
        let (lat, lon) = (self.number(element, "lat"), self.number(element, "lon"));
        let (Some(object), Some(lat), Some(lon)) = (object, lat, lon) else { return };
        let Some(place) = GeoPoint::from_degrees(lat, lon) else {
            let span = self.start_of(element);
            let mend = "latitudes are -90 to 90 degrees, longitudes -180 to 180";
            self.error(format!("node {} is off the globe", object.id), span, "this node", mend);
            return;
        };
        extract.places.insert(object.id, place);
        if !object.tags.0.is_empty() {
            extract.nodes.push(object);
        }
    }

    fn way(&mut self, element: Node<'_, '_>, extract: &mut Extract) {
        let Some(object) = self.object(element) else { return };
        let nodes = element.children().filter(|child| child.has_tag_name("nd"));
        let refs = nodes.filter_map(|node| self.number(node, "ref")).collect();
        extract.ways.push(Way { object, refs });
    }

    fn relation(&mut self, element: Node<'_, '_>, extract: &mut Extract) {
        let Some(object) = self.object(element) else { return };
        let members = element.children().filter(|child| child.has_tag_name("member"));
        let members = members.filter(|member| member.attribute("type") == Some("way"));
        let members = members.filter_map(|member| {
            let is_inner = member.attribute("role") == Some("inner");
            Some(Member { way: self.number(member, "ref")?, is_inner })
        });
        let members = members.collect();
        extract.relations.push(Relation { object, members });
    }

    /// A server's own word on why its answer is not whole.
    fn remark(&mut self, element: Node<'_, '_>) {
        let (text, span) = (element.text().unwrap_or_default().trim(), self.start_of(element));
        self.problems.push(
            Problem::warning(format!("the server remarks: {text}"))
                .at(self.source, span, "the file may not be whole")
                .mend("fetch it again, or a smaller part"),
        );
    }
}

/// As exact as the binary encoding, degrees.
fn to_e7(degrees: f64) -> f64 {
    (degrees * 1e7).round() / 1e7
}
