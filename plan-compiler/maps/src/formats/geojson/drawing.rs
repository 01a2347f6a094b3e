//! Converts features on the globe to shapes on a plane.

use super::Drawn;
use super::coordinates::{Piece, Position};
use crate::formats::globe::{Flaw, Passed, Plane, open_outlines};
use crate::formats::tags::Judge;
use crate::formats::{holes, openings};
use crate::model::{Feature, Map, NamedPoint, Point, Role, Shape};
use crate::problem::{Problem, Source};
use std::collections::HashMap;
use std::sync::Arc;

/// Objects that the file has only in part.
#[derive(Debug, Default)]
pub(super) struct Flaws {
    /// Lines with the tags of an area whose ends do not meet.
    open: Flaw,
    /// Objects that overpass turbo marks as lacking parts.
    tainted: Flaw,
    /// Objects without coordinates.
    nowhere: Flaw,
}

impl Flaws {
    pub(super) fn report(
        &self,
        passed: &Passed,
        source: &Arc<Source>,
        problems: &mut Vec<Problem>,
    ) {
        let nowhere = passed.nowhere_text();
        self.nowhere.report(nowhere, "give it coordinates, or remove it", Some(source), problems);
        let help = "fetch them with all their parts: in Overpass end the query with `out geom;`, or \
                    with `(._;>;); out body;`";
        let message = open_outlines(self.open.count);
        self.open.report(message, help, Some(source), problems);
        let tainted = self.tainted.count;
        let message =
            format!("objects that lack parts, marked `@tainted`: {tainted}; drawn without them");
        self.tainted.report(message, help, Some(source), problems);
    }
}

/// Adds features to a map.
pub(super) struct Drawing<'a> {
    plane: &'a Plane,
    judge: &'a Judge<'a>,
    /// Widths of the openings that points make in their barriers, metres.
    openings: HashMap<[i64; 2], f64>,
}

impl<'a> Drawing<'a> {
    pub(super) fn new(plane: &'a Plane, judge: &'a Judge<'a>, all: &[Drawn<'_>]) -> Self {
        let widths = all.iter().filter_map(|drawn| Some((drawn, judge.opening_m(&drawn.tags)?)));
        let openings = widths.flat_map(|(drawn, width)| {
            drawn.pieces.iter().filter_map(move |piece| match piece {
                Piece::Point(at) => Some((to_e7(at), width)),
                _ => None,
            })
        });
        Self { plane, judge, openings: openings.collect() }
    }

    pub(super) fn feature(
        &self,
        drawn: &Drawn<'_>,
        map: &mut Map,
        passed: &mut Passed,
        flaws: &mut Flaws,
    ) {
        let is_point = drawn.pieces.iter().all(|piece| matches!(piece, Piece::Point(_)));
        let tags = &drawn.tags;
        let meaning = self.judge.meaning(tags, is_point && !drawn.pieces.is_empty());
        if drawn.pieces.is_empty() && (meaning.is_some() || tags.get("name").is_some()) {
            passed.nowhere.add(tags);
            flaws.nowhere.add(&drawn.span);
            return;
        }
        let Some(meaning) = meaning else {
            match self.goal(drawn) {
                Some(goal) => map.points.push(goal),
                None if self.judge.opening_m(tags).is_some() => {}
                None => passed.unused.add(tags),
            }
            return;
        };
        if is_point && meaning.wants_outline && meaning.role == Role::Obstacle {
            passed.pointlike.add(tags);
        }
        if tags.is_set("@tainted") {
            flaws.tainted.add(&drawn.span);
        }
        // `obstacle` and `layer` are this program's own, for lines as well.
        let is_area = !meaning.is_line && !tags.is_set("obstacle") && tags.get("layer").is_none();
        for piece in &drawn.pieces {
            if is_area && matches!(piece, Piece::Line(line) if is_open(line)) {
                flaws.open.add(&drawn.span);
            }
            let shapes = match piece {
                Piece::Point(at) => {
                    let centre = self.plane.metres(at.0);
                    vec![Shape::Circle { centre, radius: meaning.radius_m }]
                }
                Piece::Line(line) => self.line(line, meaning.is_barrier),
                Piece::Polygon(rings) if meaning.is_line => {
                    rings.iter().flat_map(|ring| self.line(ring, meaning.is_barrier)).collect()
                }
                Piece::Polygon(rings) => self.polygon(rings),
            };
            map.features.extend(shapes.into_iter().map(|shape| Feature {
                shape,
                role: meaning.role,
                name: meaning.name.clone(),
                height_m: meaning.height_m.filter(|_| meaning.role != Role::Zone),
                span: drawn.span.clone(),
            }));
        }
    }

    /// The goal that a feature is, if it is one.
    fn goal(&self, drawn: &Drawn<'_>) -> Option<NamedPoint> {
        let (&[Piece::Point(at)], Some(name)) = (&drawn.pieces[..], drawn.tags.get("name")) else {
            return None;
        };
        let may_be = drawn.tags.get("goal").is_none() || drawn.tags.is_set("goal");
        let (at, span) = (self.plane.metres(at.0), drawn.span.clone());
        may_be.then(|| NamedPoint { name: name.to_owned(), at, span })
    }

    fn metres(&self, line: &[Position]) -> Vec<Point> {
        line.iter().map(|position| self.plane.metres(position.0)).collect()
    }

    fn line(&self, line: &[Position], is_barrier: bool) -> Vec<Shape> {
        let points = self.metres(line);
        if !is_barrier || self.openings.is_empty() {
            return vec![Shape::Polyline(points)];
        }
        let width = |index: usize| self.openings.get(&to_e7(line.get(index)?)).copied();
        openings::cut(&points, width).into_iter().map(Shape::Polyline).collect()
    }

    fn polygon(&self, rings: &[Vec<Position>]) -> Vec<Shape> {
        // The model closes rings implicitly.
        let open = |ring: &Vec<Position>| self.metres(ring.get(1..).unwrap_or_default());
        let mut rings = rings.iter().map(open).filter(|ring| !ring.is_empty());
        let Some(outer) = rings.next() else { return Vec::new() };
        let holes = holes::merged(rings.collect());
        vec![Shape::Polygon(std::iter::once(outer).chain(holes).collect())]
    }
}

/// Whether a line encloses nothing, although it has as many corners as an area.
fn is_open(line: &[Position]) -> bool {
    line.len() > 2 && line.first() != line.last()
}

/// A position as a key, in units of 1e-7 degrees.
fn to_e7(position: &Position) -> [i64; 2] {
    position.0.map(|degrees| (degrees * 1e7).round() as i64)
}
