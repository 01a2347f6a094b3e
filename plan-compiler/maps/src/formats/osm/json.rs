//! OpenStreetMap's objects as Overpass writes them with `[out:json]`.
//!
//! Source: the wiki of OpenStreetMap, "OSM JSON", "Overpass API/Overpass QL". Elements
//! are read one by one, so that no list of them is held in memory.

use super::extract::{
    BUDGET_BYTES, Builder, Extract, Member, Object, Relation, TooMuch, Version, Way,
};
use crate::formats::json::{self, List, Pairs};
use crate::formats::tags::Tags;
use crate::problem::{Problem, Source};
use math::GeoPoint;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

/// Most nodes of a way or members of a relation; OpenStreetMap's limits are 2,000 and 32,000.
const MAX_PARTS: usize = 100_000;
/// Most tags of an object; OpenStreetMap's servers accept 5,000.
const MAX_TAGS: usize = 10_000;

/// Whether a text looks like an answer from Overpass.
pub(super) fn recognises(text: &str) -> bool {
    // A version and a copyright notice precede the elements.
    let head = &text[..text.floor_char_boundary(4096)];
    head.trim_start().starts_with('{') && head.contains("\"elements\"")
}

/// Reads an answer; `None` if it cannot be read.
pub(super) fn parse(source: &Arc<Source>, problems: &mut Vec<Problem>) -> Option<Extract> {
    let mut builder = Builder::new(BUDGET_BYTES);
    let mut answer = Answer { builder: &mut builder, remark: None, off_the_globe: 0 };
    let mut deserializer = serde_json::Deserializer::from_str(&source.text);
    let read = (&mut answer).deserialize(&mut deserializer).and_then(|()| deserializer.end());
    let (remark, off_the_globe) = (answer.remark, answer.off_the_globe);
    if let Err(error) = read {
        problems.push(refused(source, &error));
        return None;
    }
    if let Some(remark) = remark {
        let message = format!("the server remarks: {remark}");
        problems.push(Problem::warning(message).help("fetch it again, or a smaller part"));
    }
    if off_the_globe > 0 {
        let message = format!("{off_the_globe} nodes are off the globe; they are left out");
        problems.push(Problem::warning(message));
    }
    Some(builder.finish())
}

fn refused(source: &Arc<Source>, error: &serde_json::Error) -> Problem {
    let reason = json::reason_of(error);
    let help = match reason == TooMuch::MESSAGE {
        true => TooMuch::HELP,
        false => "check whether it was cut off, and fetch it again; `[out:xml]` is read as well",
    };
    let at = json::place_of(&source.text, error);
    let message = format!("this is not an answer from Overpass: {reason}");
    Problem::error(message).at(source, at..at, "here").help(help)
}

struct Answer<'b> {
    builder: &'b mut Builder,
    remark: Option<String>,
    off_the_globe: usize,
}

/// Reads the top-level object.
impl<'de> DeserializeSeed<'de> for &mut Answer<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for &mut Answer<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with elements")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            match &*key {
                "elements" => map.next_value_seed(Elements(self))?,
                "remark" => self.remark = map.next_value()?,
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        Ok(())
    }
}

/// Reads the list of elements.
struct Elements<'a, 'b>(&'a mut Answer<'b>);

impl<'de> DeserializeSeed<'de> for Elements<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Elements<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of elements")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<(), A::Error> {
        while let Some(element) = elements.next_element::<Element<'de>>()? {
            self.0.add(element).map_err(|TooMuch| A::Error::custom(TooMuch::MESSAGE))?;
        }
        Ok(())
    }
}

#[derive(Deserialize)]
struct Element<'t> {
    #[serde(borrow, rename = "type")]
    kind: Cow<'t, str>,
    id: i64,
    #[serde(default)]
    version: u32,
    visible: Option<bool>,
    lat: Option<f64>,
    lon: Option<f64>,
    #[serde(default, borrow)]
    tags: Pairs<Cow<'t, str>, Cow<'t, str>, MAX_TAGS>,
    #[serde(default)]
    nodes: List<i64, MAX_PARTS>,
    /// Places of the nodes; null for those outside the requested area.
    #[serde(default)]
    geometry: List<Option<Place>, MAX_PARTS>,
    #[serde(default, borrow)]
    members: List<RawMember<'t>, MAX_PARTS>,
}

#[derive(Deserialize)]
struct RawMember<'t> {
    #[serde(borrow, rename = "type")]
    kind: Cow<'t, str>,
    #[serde(rename = "ref")]
    id: i64,
    #[serde(default, borrow)]
    role: Cow<'t, str>,
    #[serde(default)]
    geometry: List<Option<Place>, MAX_PARTS>,
}

#[derive(Clone, Copy, Deserialize)]
struct Place {
    lat: f64,
    lon: f64,
}

impl Place {
    fn on_the_globe(self) -> Option<GeoPoint> {
        GeoPoint::from_degrees(self.lat, self.lon)
    }
}

impl Answer<'_> {
    fn add(&mut self, element: Element<'_>) -> Result<(), TooMuch> {
        let is_deleted = element.visible == Some(false);
        let version = Version { number: element.version, is_deleted };
        for (key, value) in &element.tags.0 {
            self.builder.take_tag(key, value)?;
        }
        let tags = element.tags.0.into_iter();
        let tags = tags.map(|(key, value)| (key.into_owned(), value.into_owned())).collect();
        let object = Object { id: element.id, tags: Tags(tags), span: 0..0 };
        match &*element.kind {
            "node" => {
                let place = element.lat.zip(element.lon);
                let place = place.and_then(|(lat, lon)| GeoPoint::from_degrees(lat, lon));
                match place.or(is_deleted.then_some(GeoPoint { lat_e7: 0, lon_e7: 0 })) {
                    Some(place) => self.builder.node(version, object, place)?,
                    None => self.off_the_globe += 1,
                }
            }
            "way" => {
                let refs = self.refs(element.nodes.0, &element.geometry.0)?;
                self.builder.way(version, Way { object, refs })?;
            }
            "relation" => {
                let members = self.members(element.members.0)?;
                self.builder.relation(version, Relation { object, members })?;
            }
            _ => {}
        }
        Ok(())
    }

    /// The nodes of a way; adds their places if given.
    fn refs(&mut self, nodes: Vec<i64>, places: &[Option<Place>]) -> Result<Vec<i64>, TooMuch> {
        let place = |place: &Option<Place>| place.and_then(Place::on_the_globe);
        let mut refs = Vec::new();
        if nodes.is_empty() {
            for at in places {
                self.builder.take_ref()?;
                refs.push(self.builder.unnamed(place(at))?);
            }
            return Ok(refs);
        }
        for (index, node) in nodes.into_iter().enumerate() {
            self.builder.take_ref()?;
            refs.push(node);
            if let Some(at) = places.get(index).and_then(place) {
                self.builder.place(node, at)?;
            }
        }
        Ok(refs)
    }

    fn members(&mut self, raw: Vec<RawMember<'_>>) -> Result<Vec<Member>, TooMuch> {
        let mut members = Vec::new();
        for member in raw.into_iter().filter(|member| member.kind == "way") {
            self.builder.take_member()?;
            members.push(Member { way: member.id, is_inner: member.role == "inner" });
            if !member.geometry.0.is_empty() {
                let refs = self.refs(Vec::new(), &member.geometry.0)?;
                let object = Object { id: member.id, tags: Tags::default(), span: 0..0 };
                self.builder.way(Version::default(), Way { object, refs })?;
            }
        }
        Ok(members)
    }
}
