//! One shape: where a ray enters and leaves it.

use super::{Kind, Stretch};
use crate::model::{Feature, Point, Shape};
use math::scalar::wide;

/// A straight line from one antenna to another, in plan view.
#[derive(Clone, Copy, Debug)]
pub(in crate::radio) struct Ray {
    from: Point,
    along: Point,
    length_squared: f64,
}

impl Ray {
    /// Always from the western (else the southern) end, so that both directions give the same bits.
    /// Reports whether the ends were exchanged.
    pub(in crate::radio) fn between(a: Point, b: Point) -> (Self, bool) {
        let is_exchanged = [b[0], b[1]] < [a[0], a[1]];
        let (from, to) = if is_exchanged { (b, a) } else { (a, b) };
        let along = [to[0] - from[0], to[1] - from[1]];
        let length_squared = along[0] * along[0] + along[1] * along[1];
        (Self { from, along, length_squared }, is_exchanged)
    }

    /// Length, metres.
    pub(in crate::radio) fn length(&self) -> f64 {
        wide::sqrt(self.length_squared)
    }

    /// The point at a part of the ray.
    pub(super) fn at(&self, part: f64) -> Point {
        [0, 1].map(|axis| self.from[axis] + self.along[axis] * part)
    }

    pub(super) fn along(&self) -> Point {
        self.along
    }

    /// Positive to the left of the line, negative to the right of it, and 0 on it.
    fn side(&self, point: Point) -> f64 {
        self.along[0] * (point[1] - self.from[1]) - self.along[1] * (point[0] - self.from[0])
    }

    /// The part of the ray that is nearest to a point; beyond the ends it is below 0 or above 1.
    fn part(&self, point: Point) -> f64 {
        let gap = [point[0] - self.from[0], point[1] - self.from[1]];
        (gap[0] * self.along[0] + gap[1] * self.along[1]) / self.length_squared
    }

    /// Where the ray's line crosses an edge, and 1 if the edge goes to the left there, else -1.
    /// A point on the line counts as left of it, so that two edges that meet there cross it once.
    fn crossing(&self, [a, b]: [Point; 2]) -> Option<(f64, i32)> {
        let sides = [self.side(a), self.side(b)];
        if (sides[0] >= 0.0) == (sides[1] >= 0.0) {
            return None;
        }
        let share = sides[0] / (sides[0] - sides[1]);
        let at = [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share];
        Some((self.part(at), if sides[1] >= 0.0 { 1 } else { -1 }))
    }

    /// Whether the ray meets a rectangle.
    pub(super) fn meets_box(&self, low: Point, high: Point) -> bool {
        let is_beside = (0..2).any(|axis| {
            let (start, end) = (self.from[axis], self.from[axis] + self.along[axis]);
            start.min(end) > high[axis] || start.max(end) < low[axis]
        });
        let corners = [low, [low[0], high[1]], high, [high[0], low[1]]];
        let sides = corners.map(|corner| self.side(corner));
        !is_beside && sides.iter().any(|side| *side >= 0.0) && sides.iter().any(|side| *side <= 0.0)
    }
}

/// Something on the map that weakens radio.
#[derive(Clone, Debug)]
pub(in crate::radio) struct Body {
    outline: Outline,
    kind: Kind,
    height_m: Option<f64>,
    /// South-west and north-east corners of the rectangle around it.
    corners: [Point; 2],
}

#[derive(Clone, Debug)]
enum Outline {
    Circle {
        centre: Point,
        radius: f64,
    },
    Line(Vec<Point>),
    /// Each ring is closed: the last point equals the first. Holes run counter-clockwise.
    Polygon {
        outer: Vec<Point>,
        holes: Vec<Vec<Point>>,
    },
}

/// Where the line of a ray crosses an outline.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    part: f64,
    /// How often the outer ring winds around the points beyond it more than around those before it.
    outer: i32,
    /// The same for all holes.
    holes: i32,
}

impl Body {
    /// `None` if radio ignores the feature: it is small, flat or has no points.
    pub(super) fn of(feature: &Feature, small_m: f64) -> Option<Self> {
        let outline = match &feature.shape {
            Shape::Circle { centre, radius } => {
                Outline::Circle { centre: *centre, radius: *radius }
            }
            Shape::Polyline(points) => Outline::Line(points.clone()),
            Shape::Polygon(rings) => {
                let mut rings = rings.iter().map(|ring| closed(ring));
                let outer = rings.next()?;
                Outline::Polygon { outer, holes: rings.map(counter_clockwise).collect() }
            }
        };
        let corners = outline.corners()?;
        let kind = Kind::from(feature.role);
        let sides = [0, 1].map(|axis| corners[1][axis] - corners[0][axis]);
        let is_small = kind == Kind::Obstacle && sides[0].max(sides[1]) <= small_m;
        let is_flat = feature.height_m.is_some_and(|height| height <= 0.0);
        let body = Self { outline, kind, height_m: feature.height_m, corners };
        (!is_small && !is_flat).then_some(body)
    }

    pub(super) fn corners(&self) -> [Point; 2] {
        self.corners
    }

    /// Whether the ray passes the body. Allocates nothing.
    pub(super) fn is_met_by(&self, ray: &Ray) -> bool {
        match &self.outline {
            Outline::Circle { centre, radius } => circle(ray, *centre, *radius).is_some(),
            Outline::Line(points) => edges(points).any(|edge| {
                ray.crossing(edge).is_some_and(|(part, _)| (0.0..=1.0).contains(&part))
            }),
            Outline::Polygon { outer, holes } => {
                let (mut outside, mut hole, mut is_crossed) = (0, 0, false);
                for_each_crossing(ray, outer, holes, |crossing| {
                    is_crossed |= 0.0 < crossing.part && crossing.part < 1.0;
                    if crossing.part <= 0.0 {
                        outside += crossing.outer;
                        hole += crossing.holes;
                    }
                });
                is_crossed || (outside != 0 && hole == 0)
            }
        }
    }

    /// Appends the stretches of the ray in the body.
    pub(super) fn stretches(&self, ray: &Ray, found: &mut Vec<Stretch>) {
        let (kind, height_m) = (self.kind, self.height_m);
        let mut push = |span| found.push(Stretch { span, kind, height_m });
        match &self.outline {
            Outline::Circle { centre, radius } => {
                circle(ray, *centre, *radius).into_iter().for_each(push);
            }
            Outline::Line(points) => {
                let crossings = edges(points).filter_map(|edge| ray.crossing(edge));
                let parts = crossings.map(|(part, _)| part);
                parts.filter(|part| (0.0..=1.0).contains(part)).for_each(|part| push([part; 2]));
            }
            Outline::Polygon { outer, holes } => {
                let mut crossings = Vec::with_capacity(8);
                for_each_crossing(ray, outer, holes, |crossing| crossings.push(crossing));
                crossings.sort_unstable_by(|a, b| a.part.total_cmp(&b.part));
                let (mut outside, mut hole) = (0, 0);
                for pair in crossings.windows(2) {
                    outside += pair[0].outer;
                    hole += pair[0].holes;
                    let span = [pair[0].part.max(0.0), pair[1].part.min(1.0)];
                    if outside != 0 && hole == 0 && span[0] < span[1] {
                        push(span);
                    }
                }
            }
        }
    }
}

impl Outline {
    /// Corners of the rectangle around it; `None` without points.
    fn corners(&self) -> Option<[Point; 2]> {
        let points = match self {
            Self::Circle { centre, radius } => {
                let corner = |sign: f64| centre.map(|middle| middle + sign * radius);
                return Some([corner(-1.0), corner(1.0)]);
            }
            Self::Line(points) | Self::Polygon { outer: points, .. } => points,
        };
        let first = *points.first()?;
        Some(points.iter().fold([first; 2], |[low, high], point| {
            [
                [low[0].min(point[0]), low[1].min(point[1])],
                [high[0].max(point[0]), high[1].max(point[1])],
            ]
        }))
    }
}

/// Crossings on the whole line of the ray, also beyond its ends: their sum up to a point tells
/// whether the point is inside.
fn for_each_crossing(
    ray: &Ray,
    outer: &[Point],
    holes: &[Vec<Point>],
    mut each: impl FnMut(Crossing),
) {
    for (part, turn) in edges(outer).filter_map(|edge| ray.crossing(edge)) {
        each(Crossing { part, outer: turn, holes: 0 });
    }
    for edge in holes.iter().flat_map(|hole| edges(hole)) {
        if let Some((part, turn)) = ray.crossing(edge) {
            each(Crossing { part, outer: 0, holes: turn });
        }
    }
}

fn edges(points: &[Point]) -> impl Iterator<Item = [Point; 2]> {
    points.windows(2).map(|ends| [ends[0], ends[1]])
}

/// The stretch of a ray inside a circle.
fn circle(ray: &Ray, centre: Point, radius: f64) -> Option<[f64; 2]> {
    if ray.length_squared == 0.0 {
        return None;
    }
    let middle = ray.part(centre);
    let side = ray.side(centre);
    let half_squared = (radius * radius - side * side / ray.length_squared) / ray.length_squared;
    if half_squared <= 0.0 {
        return None;
    }
    let half = wide::sqrt(half_squared);
    let span = [(middle - half).max(0.0), (middle + half).min(1.0)];
    (span[0] < span[1]).then_some(span)
}

fn closed(ring: &[Point]) -> Vec<Point> {
    let mut closed = ring.to_vec();
    if ring.first() != ring.last() {
        closed.extend(ring.first());
    }
    closed
}

fn counter_clockwise(mut ring: Vec<Point>) -> Vec<Point> {
    let doubled: f64 = edges(&ring).map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum();
    if doubled < 0.0 {
        ring.reverse();
    }
    ring
}
