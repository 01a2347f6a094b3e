//! OpenStreetMap: extracts of nodes, ways and relations, as XML, Overpass JSON or PBF.
//!
//! Source: the wiki of OpenStreetMap, "OSM XML", "PBF Format", "Relation:multipolygon", "Map
//! features". Every encoding is read into an [`Extract`], which is then drawn on the map; `tags`
//! defines the meaning of tags. Areas are closed ways and multipolygon relations; a relation's ways
//! are joined to rings. An area's inner rings are its courtyards and clearings. A barrier or a
//! coastline goes around an area: of such a multipolygon the rings are drawn as lines.
//!
//! An extract is cut out of a larger map, so parts of its objects may be missing. That is not a
//! mistake: the rest is drawn, and a warning counts the missing parts.
//!
//! A named node is a goal only if it has the tag `goal`: most named nodes are shops and stops,
//! often within buildings, and a blob holds few plans. The tag is Wayfield's own; to have goals in
//! the map, set it in a copy of the extract.
//!
//! Deliberately absent: changes (.osc), relations within relations, preference for roads and paths.

mod extract;
mod flaws;
mod json;
mod pbf;
mod rings;
mod wire;
mod xml;

use super::ReadOptions;
use super::globe::{self, Passed, Plane, Stray};
use super::tags::{Judge, Meaning, Tags};
use super::{holes, openings};
use crate::model::{Feature, Map, NamedPoint, Point, Role, Shape};
use crate::problem::has_errors;
use crate::problem::{Problem, Source};
use extract::{Extract, Member, Object, Relation, Way};
use flaws::{Missing, Outside};
use math::GeoPoint;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// This format in `--help`.
pub const CONVENTIONS: &str = "\
OSM      (OpenStreetMap, .osm, .osm.pbf or Overpass JSON; also .osm.gz) For the meaning of tags
         see Tags; a multipolygon is an area with courtyards, or, if it is a barrier or a
         coastline, lines along its rings. Nodes with a `name` and a tag `goal` are goals.
         The newest version of an object counts. The extent is the file's bounds, or its
         nodes and 10 m around them. 0,0 is the origin (--origin), or the centre of the
         extent. A warning counts the parts that an extract lacks.";

/// How to fetch outlines.
const WITH_OUTLINES: &str = "fetch it with outlines: in Overpass end the query with `out geom;`, or \
                             with `(._;>;); out body;`";

/// Whether a text looks like OpenStreetMap XML or Overpass JSON.
pub fn recognises(text: &str) -> bool {
    // Only a declaration and comments may precede it.
    let is_xml = text.trim_start().starts_with('<') && text.contains("<osm");
    is_xml || json::recognises(text)
}

/// Reads an extract in text form: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>, options: &ReadOptions) -> (Option<Map>, Vec<Problem>) {
    let mut problems = Vec::new();
    let is_json = source.text.trim_start().starts_with('{');
    let parse = if is_json { json::parse } else { xml::parse };
    let extract = parse(source, &mut problems);
    let map = extract.and_then(|extract| draw(&extract, Some(source), options, &mut problems));
    (map, problems)
}

/// Whether bytes are the binary encoding, by content or else by extension.
pub(super) fn is_binary(path: &Path, bytes: &[u8]) -> bool {
    let is_named = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pbf"));
    pbf::recognises(bytes) || (is_named && bytes.contains(&0))
}

/// Reads an extract in the binary encoding; its problems have no excerpts.
pub(super) fn read_binary(
    path: &Path,
    bytes: &[u8],
    options: &ReadOptions,
) -> (Option<Map>, Vec<Problem>) {
    match pbf::parse(path, bytes) {
        Ok((extract, mut problems)) => (draw(&extract, None, options, &mut problems), problems),
        Err(problem) => (None, vec![problem]),
    }
}

/// Draws the map of an extract; `None` if it has no valid extent.
fn draw(
    extract: &Extract,
    source: Option<&Arc<Source>>,
    options: &ReadOptions,
    problems: &mut Vec<Problem>,
) -> Option<Map> {
    let places = extract.places.values().map(degrees);
    let plane = match Plane::new(extract.bounds, places, options.origin) {
        Ok(plane) => plane,
        Err(problem) => {
            problems.push(blame(problem, extract, source));
            return None;
        }
    };
    let judge = Judge::new(&options.tags);
    let mut drawing = Drawing::new(extract, plane, &judge);
    drawing.draw();
    let Drawing { missing, outside, wrong, passed, plane, map, .. } = drawing;
    problems.extend(
        wrong.into_iter().map(|(problem, span)| globe::at(problem, source, &span, "this node")),
    );
    missing.report(problems);
    outside.report(source, problems);
    if !has_errors(problems) {
        passed.report(WITH_OUTLINES, problems);
        judge.report(problems);
        plane.note(&map, &passed.unused, &options.tags, problems);
    }
    Some(map)
}

/// Adds the cause of an invalid extent to its problem: the bounds, or the farthest node.
fn blame(mut problem: Problem, extract: &Extract, source: Option<&Arc<Source>>) -> Problem {
    let objects = extract.ways.len() + extract.relations.len();
    if extract.places.is_empty() && extract.bounds.is_none() && objects > 0 {
        let message =
            format!("the file has {objects} ways and relations, but no positions of nodes");
        return Problem::error(message).help(WITH_OUTLINES);
    }
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
        let cause = format!("node {id} at latitude {lat}, longitude {lon}: {label}");
        problem.help = Some(problem.help.map_or(cause.clone(), |help| format!("{help}; {cause}")));
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

/// Outer and inner rings of a relation, as lines of nodes.
struct Outlines {
    outer: rings::Joined,
    inner: rings::Joined,
    /// Whether the file has all ways of the relation.
    is_whole: bool,
}

struct Drawing<'a> {
    extract: &'a Extract,
    plane: Plane,
    judge: &'a Judge<'a>,
    ways: HashMap<i64, &'a Way>,
    /// Widths of the openings that nodes make in their barriers, metres, by [`Drawing::by_place`].
    openings: HashMap<i64, f64>,
    map: Map,
    missing: Missing,
    outside: Outside,
    /// Errors, each with the bytes of its node.
    wrong: Vec<(Problem, Range<usize>)>,
    passed: Passed,
}

impl<'a> Drawing<'a> {
    fn new(extract: &'a Extract, plane: Plane, judge: &'a Judge<'a>) -> Self {
        let ways = extract.ways.iter().map(|way| (way.object.id, way)).collect();
        let map = plane.map();
        let (missing, outside, wrong, passed) = Default::default();
        let openings = HashMap::new();
        let mut new =
            Self { extract, plane, judge, ways, openings, map, missing, outside, wrong, passed };
        let nodes = extract.nodes.iter();
        let openings =
            nodes.filter_map(|node| Some((new.by_place(node.id), judge.opening_m(&node.tags)?)));
        new.openings = openings.collect();
        new
    }

    /// Draws everything and counts the tagged objects without a meaning.
    fn draw(&mut self) {
        let extract = self.extract;
        for node in &extract.nodes {
            self.node(node);
        }
        let mut relations = Vec::new();
        // The outer ways of an area are not areas of the same kind themselves.
        let mut parts = HashSet::new();
        for relation in &extract.relations {
            match self.meaning(relation) {
                Some(meaning) => {
                    let is_part = |member: &&Member| !meaning.is_line && !member.is_inner;
                    let outer = relation.members.iter().filter(is_part);
                    parts.extend(outer.map(|member| (member.way, meaning.role == Role::Obstacle)));
                    relations.push((relation, meaning));
                }
                None => self.pass_over(&relation.object.tags),
            }
        }
        for way in &extract.ways {
            match self.judge.meaning(&way.object.tags, false) {
                Some(meaning) => {
                    let part = (way.object.id, meaning.role == Role::Obstacle);
                    if meaning.is_line || !parts.contains(&part) {
                        self.way(way, &meaning);
                    }
                }
                None => self.pass_over(&way.object.tags),
            }
        }
        for (relation, meaning) in relations {
            self.relation(relation, &meaning);
        }
    }

    fn pass_over(&mut self, tags: &Tags) {
        if !tags.0.is_empty() {
            self.passed.unused.add(tags);
        }
    }

    fn node(&mut self, node: &Object) {
        let Some(at) = self.place(node.id) else { return };
        let meaning = self.judge.meaning(&node.tags, true);
        if let Some(meaning) = meaning.filter(|meaning| meaning.role == Role::Obstacle) {
            let wrong = node.tags.check_radius(&format!("node {}", node.id));
            self.wrong.extend(wrong.map(|problem| (problem, node.span.clone())));
            if meaning.wants_outline {
                self.passed.pointlike.add(&node.tags);
            }
            self.push(Shape::Circle { centre: at, radius: meaning.radius_m }, &meaning, node);
            return;
        }
        match node.tags.get("name").filter(|_| node.tags.is_set("goal")) {
            Some(name) => {
                let span = node.span.clone();
                self.map.points.push(NamedPoint { name: name.into(), at, span });
            }
            // An open gate is used: it is the opening in its fence.
            None if self.openings.contains_key(&self.by_place(node.id)) => {}
            None => self.passed.unused.add(&node.tags),
        }
    }

    fn way(&mut self, way: &Way, meaning: &Meaning) {
        let points = self.points(&way.refs);
        if points.is_empty() {
            self.passed.nowhere.add(&way.object.tags);
            return;
        }
        let is_closed = way.refs.len() > 3 && way.refs.first() == way.refs.last();
        if is_closed && !meaning.is_line {
            self.push(Shape::Polygon(vec![open(points)]), meaning, &way.object);
            return;
        }
        self.missing.open += usize::from(!meaning.is_line);
        self.line(&way.refs, points, meaning, &way.object);
    }

    /// Draws a line; a barrier is cut where nodes open it. `points` are the places of the nodes, as
    /// far as they are known.
    fn line(&mut self, refs: &[i64], points: Vec<Point>, meaning: &Meaning, object: &Object) {
        if !meaning.is_barrier {
            self.push(Shape::Polyline(points), meaning, object);
            return;
        }
        let known = refs.iter().filter(|node| self.place(**node).is_some());
        let widths: Vec<Option<f64>> =
            known.map(|node| self.openings.get(&self.by_place(*node)).copied()).collect();
        let width = |index: usize| widths.get(index).copied().flatten();
        for piece in openings::cut(&points, width) {
            self.push(Shape::Polyline(piece), meaning, object);
        }
    }

    /// The meaning of a relation: by its own tags, or (as before 2017) by those of its outer ways.
    fn meaning(&self, relation: &Relation) -> Option<Meaning> {
        let tags = &relation.object.tags;
        if tags.get("type") != Some("multipolygon") {
            return None;
        }
        let outer = relation.members.iter().filter(|member| !member.is_inner);
        let meaning = if is_untyped(tags) {
            let mut ways = outer.filter_map(|member| self.ways.get(&member.way));
            let meaning = ways.find_map(|way| self.judge.meaning(&way.object.tags, false));
            // The ways are drawn as lines themselves.
            return meaning.filter(|meaning| !meaning.is_line);
        } else {
            self.judge.meaning(tags, false)
        };
        meaning.map(|meaning| {
            let is_coast = tags.get("natural") == Some("coastline");
            Meaning { is_line: meaning.is_line && (meaning.is_barrier || is_coast), ..meaning }
        })
    }

    fn relation(&mut self, relation: &Relation, meaning: &Meaning) {
        let Outlines { outer, inner, is_whole } = self.outlines(relation);
        if [&outer.closed, &outer.open, &inner.closed].iter().all(|lines| lines.is_empty()) {
            self.passed.nowhere.add(&relation.object.tags);
        }
        if meaning.is_line {
            for line in [outer.closed, outer.open, inner.closed, inner.open].concat() {
                let points = self.points(&line);
                if !points.is_empty() {
                    self.line(&line, points, meaning, &relation.object);
                }
            }
            return;
        }
        for line in &outer.open {
            let points = self.points(line);
            self.missing.open += 1;
            if !points.is_empty() {
                self.push(Shape::Polyline(points), meaning, &relation.object);
            }
        }
        // A hole that does not close is ignored: that blocks more, not less.
        self.missing.open += inner.open.len();
        let closed = |ring: &Vec<i64>| open(self.points_of(ring).0);
        let inner = holes::merged(inner.closed.iter().map(closed).collect());
        let mut fit = rings::Fit::new(&inner);
        let mut is_within = vec![false; inner.len()];
        let nodes_missing = self.missing.nodes;
        for ring in &outer.closed {
            let ring = open(self.points(ring));
            if ring.is_empty() {
                continue;
            }
            let within = fit.holes_of(&ring);
            within.iter().for_each(|hole| is_within[*hole] = true);
            let within = within.into_iter().map(|hole| inner[hole].clone());
            let shape = Shape::Polygon(std::iter::once(ring).chain(within).collect());
            self.push(shape, meaning, &relation.object);
        }
        self.missing.open += fit.undecided;
        // If a part of the outline is missing, it may be the one around them.
        let is_whole = is_whole && outer.open.is_empty() && self.missing.nodes == nodes_missing;
        if is_whole && fit.undecided == 0 {
            let outside = inner.into_iter().zip(is_within).filter(|(_, is_within)| !is_within);
            self.outside(outside.map(|(ring, _)| ring).collect(), relation, meaning);
        }
    }

    /// Draws inner rings outside every outer ring as areas: that blocks more, not less.
    fn outside(&mut self, rings: Vec<Vec<Point>>, relation: &Relation, meaning: &Meaning) {
        for ring in rings.into_iter().filter(|ring| !ring.is_empty()) {
            self.outside.rings += 1;
            let Object { id, span, .. } = &relation.object;
            self.outside.first.get_or_insert_with(|| (*id, span.clone()));
            self.push(Shape::Polygon(vec![ring]), meaning, &relation.object);
        }
    }

    /// The rings of a relation's members; each member counts once per role. Nodes in the same place
    /// count as one node, because members that carry their outline have no node numbers.
    fn outlines(&mut self, relation: &Relation) -> Outlines {
        let mut seen: HashSet<Member> = HashSet::new();
        let members = relation.members.iter().filter(|member| seen.insert(**member));
        let members: Vec<Member> = members.copied().collect();
        let absent = members.iter().filter(|part| !self.ways.contains_key(&part.way)).count();
        self.missing.members += absent;
        self.missing.relations_cut += usize::from(absent > 0);
        let rings = |is_inner: bool| {
            let members = members.iter().filter(|member| member.is_inner == is_inner);
            let ways = members.filter_map(|member| self.ways.get(&member.way));
            let lines: Vec<Vec<i64>> = ways
                .map(|way| way.refs.iter().map(|node| self.by_place(*node)).collect())
                .collect();
            rings::join(&lines.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        Outlines { outer: rings(false), inner: rings(true), is_whole: absent == 0 }
    }

    /// The number of a node's place, which all nodes in this place share; of a node without a place,
    /// its own.
    fn by_place(&self, node: i64) -> i64 {
        self.extract.places.get(&node).map_or(node, |at| extract::id_of(*at))
    }

    fn place(&self, node: i64) -> Option<Point> {
        let named = || self.extract.places.get(&node).copied();
        let place = extract::place_of(node).or_else(named)?;
        Some(self.plane.metres(degrees(&place)))
    }

    /// The places of the nodes in the file; counts the missing ones.
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
            height_m: meaning.height_m,
            span: object.span.clone(),
        });
    }
}

/// Whether a relation's own tags do not describe it, as before 2017.
fn is_untyped(tags: &Tags) -> bool {
    let is_bookkeeping = |key: &str| {
        ["type", "name", "created_by", "fixme", "FIXME"].contains(&key)
            || key.starts_with("source")
            || key.starts_with("note")
    };
    tags.0.iter().all(|(key, _)| is_bookkeeping(key))
}

/// Removes the repetition of a ring's first point: the model closes rings implicitly.
fn open(mut ring: Vec<Point>) -> Vec<Point> {
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

#[cfg(test)]
mod tests;
