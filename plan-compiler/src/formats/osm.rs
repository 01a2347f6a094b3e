//! OpenStreetMap: an extract of its nodes, ways and relations, as XML or as PBF.
//!
//! Source: the wiki of OpenStreetMap, "OSM XML", "PBF Format", "Relation:multipolygon", "Map
//! features". Both encodings are read into an [`Extract`], and that into the map; what tags
//! mean is in `tags`. Areas are closed ways and multipolygon relations, whose ways are joined
//! to rings; an area's inner rings are its courtyards and clearings.
//!
//! An extract is cut out of the whole, so parts of what it holds lie outside it. That is no
//! mistake: what is left is drawn, and a warning counts what is missing.
//!
//! A named node is a goal only if it has the tag `goal`: nodes with names are shops and stops
//! by the hundred, mostly within buildings, and a blob holds few plans. The tag is ours; who
//! wants goals in the map itself sets it in a copy of the extract.
//!
//! Deliberately absent: history files, changes (.osc), compressed XML, the ground that roads
//! and paths prefer, gates, which may be shut.

mod pbf;
mod rings;
mod xml;

use super::globe::{Bounds, Plane, Stray};
use super::tags::{Meaning, Tags};
use crate::compile::has_errors;
use crate::map::{Feature, Map, NamedPoint, Point, Role, Shape};
use crate::problem::{Problem, Source};
use math::GeoPoint;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// What `--help` says of this format.
pub const CONVENTIONS: &str = "\
OSM      (OpenStreetMap, .osm or .osm.pbf) building=* (not no) and barrier=wall, fence, hedge
         block; multipolygons keep their courtyards. natural=wood and landuse=forest weaken
         radio. Nodes with a `name` and a tag `goal` are goals. Gates open nothing, and water
         blocks nothing. 0,0 is the centre of the file's bounds, which are the extent;
         without bounds, of its nodes, and the extent reaches 10 m farther. What an extract
         leaves out is counted in a warning.";

/// Whether a text reads like OpenStreetMap's XML.
pub fn recognises(text: &str) -> bool {
    // Before it stand at most a declaration and comments.
    text.trim_start().starts_with('<') && text.contains("<osm")
}

/// Reads an extract in XML: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let mut problems = Vec::new();
    let extract = xml::parse(source, &mut problems);
    let map = extract.and_then(|extract| draw(&extract, Some(source), &mut problems));
    (map, problems)
}

/// Whether bytes are the binary encoding; the extension helps where the content does not tell.
pub(super) fn is_binary(path: &Path, bytes: &[u8]) -> bool {
    let is_named = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pbf"));
    pbf::recognises(bytes) || (is_named && bytes.contains(&0))
}

/// Reads an extract in the binary encoding, which has no places for an excerpt to show.
pub(super) fn read_binary(path: &Path, bytes: &[u8]) -> (Option<Map>, Vec<Problem>) {
    match pbf::parse(path, bytes) {
        Ok((extract, mut problems)) => (draw(&extract, None, &mut problems), problems),
        Err(problem) => (None, vec![problem]),
    }
}

/// What a file holds, in its order, whatever its encoding.
#[derive(Debug, Default, PartialEq)]
struct Extract {
    bounds: Option<Bounds>,
    places: HashMap<i64, GeoPoint>,
    /// Nodes with tags.
    nodes: Vec<Object>,
    ways: Vec<Way>,
    relations: Vec<Relation>,
}

#[derive(Clone, Debug, PartialEq)]
struct Object {
    id: i64,
    tags: Tags,
    /// Where it stands in a text; empty in a binary file.
    span: Range<usize>,
}

#[derive(Debug, PartialEq)]
struct Way {
    object: Object,
    /// Nodes.
    refs: Vec<i64>,
}

#[derive(Debug, PartialEq)]
struct Relation {
    object: Object,
    /// Of its members those that are ways.
    members: Vec<Member>,
}

#[derive(Debug, PartialEq)]
struct Member {
    way: i64,
    is_inner: bool,
}

/// What an extract leaves out, counted.
#[derive(Debug, Default)]
struct Missing {
    ways_cut: usize,
    nodes: usize,
    relations_cut: usize,
    members: usize,
    open: usize,
}

/// The map of an extract; `None` where it has no place.
fn draw(
    extract: &Extract,
    source: Option<&Arc<Source>>,
    problems: &mut Vec<Problem>,
) -> Option<Map> {
    let plane = match Plane::new(extract.bounds, extract.places.values().map(degrees)) {
        Ok(plane) => plane,
        Err(problem) => {
            problems.push(blame(problem, extract, source));
            return None;
        }
    };
    let ways = extract.ways.iter().map(|way| (way.object.id, way)).collect();
    let map = plane.map();
    let mut drawing = Drawing { extract, plane, ways, map, missing: Missing::default() };
    let ignored = drawing.draw();
    drawing.missing.tell(problems);
    if !has_errors(problems) {
        problems.push(drawing.plane.note(&drawing.map, ignored));
    }
    Some(drawing.map)
}

/// Says of the problem with an extent what makes it one: the bounds, else the node that lies
/// farthest away.
fn blame(mut problem: Problem, extract: &Extract, source: Option<&Arc<Source>>) -> Problem {
    let (element, id) = if extract.bounds.is_some() {
        ("bounds", None)
    } else {
        let mut nodes: Vec<(i64, GeoPoint)> =
            extract.places.iter().map(|(id, place)| (*id, *place)).collect();
        nodes.sort_unstable_by_key(|(id, _)| *id);
        let places: Vec<[f64; 2]> = nodes.iter().map(|(_, place)| degrees(place)).collect();
        let Some(stray) = Stray::among(&places) else { return problem };
        let Some((id, place)) = nodes.get(stray.index) else { return problem };
        let (lat, lon, label) = (place.lat_deg(), place.lon_deg(), stray.label());
        let said = format!("node {id} at latitude {lat}, longitude {lon}: {label}");
        problem.mend = Some(problem.mend.map_or(said.clone(), |mend| format!("{mend}; {said}")));
        ("node", Some(*id))
    };
    match source.and_then(|source| Some((source, xml::find(source, element, id)?))) {
        Some((source, span)) => problem.at(source, span, "this"),
        None => problem,
    }
}

fn degrees(place: &GeoPoint) -> [f64; 2] {
    [place.lat_deg(), place.lon_deg()]
}

struct Drawing<'a> {
    extract: &'a Extract,
    plane: Plane,
    ways: HashMap<i64, &'a Way>,
    map: Map,
    missing: Missing,
}

impl<'a> Drawing<'a> {
    /// Draws everything, and counts the tagged objects that mean nothing to a planner.
    fn draw(&mut self) -> usize {
        let extract = self.extract;
        let mut ignored = 0;
        for node in &extract.nodes {
            ignored += usize::from(!self.node(node));
        }
        let mut relations = Vec::new();
        // Ways that an area of the same kind is made of are not areas themselves.
        let mut parts = HashSet::new();
        for relation in &extract.relations {
            match self.meaning(relation) {
                Some(meaning) => {
                    let outer = relation.members.iter().filter(|member| !member.is_inner);
                    parts.extend(outer.map(|member| (member.way, meaning.role == Role::Obstacle)));
                    relations.push((relation, meaning));
                }
                None => ignored += 1,
            }
        }
        for way in &extract.ways {
            match way.object.tags.meaning() {
                Some(meaning) => {
                    let part = (way.object.id, meaning.role == Role::Obstacle);
                    if meaning.is_line || !parts.contains(&part) {
                        self.way(way, &meaning);
                    }
                }
                None => ignored += usize::from(!way.object.tags.0.is_empty()),
            }
        }
        for (relation, meaning) in relations {
            self.relation(relation, &meaning);
        }
        ignored
    }

    /// Whether a node means something.
    fn node(&mut self, node: &Object) -> bool {
        let Some(at) = self.place(node.id) else { return false };
        if let Some(meaning) = node.tags.meaning().filter(|meaning| meaning.role == Role::Obstacle)
        {
            self.push(Shape::Circle { centre: at, radius: 0.0 }, &meaning, node);
            return true;
        }
        let Some(name) = node.tags.get("name").filter(|_| node.tags.says("goal")) else {
            return false;
        };
        self.map.points.push(NamedPoint { name: name.into(), at, span: node.span.clone() });
        true
    }

    fn way(&mut self, way: &Way, meaning: &Meaning) {
        let points = self.points(&way.refs);
        if points.is_empty() {
            return;
        }
        let is_closed = way.refs.len() > 3 && way.refs.first() == way.refs.last();
        if is_closed && !meaning.is_line {
            self.push(Shape::Polygon(vec![open(points)]), meaning, &way.object);
        } else {
            self.missing.open += usize::from(!meaning.is_line);
            self.push(Shape::Polyline(points), meaning, &way.object);
        }
    }

    /// What a relation is: by its own tags, or as before 2017 by those of its outer ways.
    fn meaning(&self, relation: &Relation) -> Option<Meaning> {
        let tags = &relation.object.tags;
        if tags.get("type") != Some("multipolygon") {
            return None;
        }
        let mut outer = relation.members.iter().filter(|member| !member.is_inner);
        let mut of_outer = || self.ways.get(&outer.next()?.way)?.object.tags.meaning();
        let meaning = if tags.0.len() == 1 { of_outer() } else { tags.meaning() };
        meaning.filter(|meaning| !meaning.is_line)
    }

    fn relation(&mut self, relation: &Relation, meaning: &Meaning) {
        let absent = relation.members.iter().filter(|part| !self.ways.contains_key(&part.way));
        let absent = absent.count();
        self.missing.members += absent;
        self.missing.relations_cut += usize::from(absent > 0);
        let rings = |is_inner: bool| {
            let members = relation.members.iter().filter(|member| member.is_inner == is_inner);
            let ways = members.filter_map(|member| self.ways.get(&member.way));
            rings::join(&ways.map(|way| way.refs.as_slice()).collect::<Vec<_>>())
        };
        let (outer, inner) = (rings(false), rings(true));
        for line in &outer.open {
            let points = self.points(line);
            self.missing.open += 1;
            if !points.is_empty() {
                self.push(Shape::Polyline(points), meaning, &relation.object);
            }
        }
        // A hole that does not close is none: that blocks more, not less.
        self.missing.open += inner.open.len();
        let closed = |ring: &Vec<i64>| self.points_of(ring).0;
        let holes: Vec<Vec<Point>> = inner.closed.iter().map(closed).collect();
        for ring in &outer.closed {
            let ring = self.points(ring);
            if ring.is_empty() {
                continue;
            }
            let within = holes.iter().filter(|hole| rings::holds(&ring, hole));
            let holes: Vec<Vec<Point>> = within.map(|hole| open(hole.clone())).collect();
            let shape = Shape::Polygon(std::iter::once(open(ring)).chain(holes).collect());
            self.push(shape, meaning, &relation.object);
        }
    }

    fn place(&self, node: i64) -> Option<Point> {
        let place = self.extract.places.get(&node)?;
        Some(self.plane.metres([place.lat_deg(), place.lon_deg()]))
    }

    /// The places of those nodes that the file holds; the others are counted.
    fn points(&mut self, refs: &[i64]) -> Vec<Point> {
        let (points, absent) = self.points_of(refs);
        self.missing.nodes += absent;
        self.missing.ways_cut += usize::from(absent > 0);
        points
    }

    fn points_of(&self, refs: &[i64]) -> (Vec<Point>, usize) {
        let points: Vec<Point> = refs.iter().filter_map(|node| self.place(*node)).collect();
        let absent = refs.len() - points.len();
        (points, absent)
    }

    fn push(&mut self, shape: Shape, meaning: &Meaning, object: &Object) {
        self.map.features.push(Feature {
            shape,
            role: meaning.role,
            name: meaning.name.clone(),
            height_m: object.tags.height_m(),
            span: object.span.clone(),
        });
    }
}

/// A ring without the repetition of its first point: rings close themselves in the model.
fn open(mut ring: Vec<Point>) -> Vec<Point> {
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

impl Missing {
    fn tell(&self, problems: &mut Vec<Problem>) {
        let Self { ways_cut, nodes, relations_cut, members, open } = self;
        let mend = "cut the extract out with whole objects: `osmium extract --strategy smart`";
        let mut tell = |count: usize, message: String| {
            if count > 0 {
                problems.push(Problem::warning(message).mend(mend));
            }
        };
        tell(
            *nodes,
            format!(
                "outlines that lack nodes: {ways_cut}, nodes missing: {nodes}; drawn without them"
            ),
        );
        tell(
            *members,
            format!(
                "areas that lack ways: {relations_cut}, ways missing: {members}; drawn without them"
            ),
        );
        tell(
            *open,
            format!("outlines that do not close: {open}; drawn as walls with free ground behind"),
        );
    }
}

#[cfg(test)]
mod tests;
