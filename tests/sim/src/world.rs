//! The true obstacles: exact shapes that answer for rays, nearest points and contact.

mod cells;
mod index;
mod view;

use crate::geometry::{distance, nearest_of_segment};
use crate::{Placement, Point};
use cells::{cell_at, outline};
use index::Index;
use maps::{CellMap, Map, Role, Shape};
use math::scalar::wide;

pub use view::View;

/// Most pushes of a disc out of obstacles; two walls of a corner need two or three.
const MAX_PUSHES: usize = 8;

/// Obstacles as exact shapes, neither rasterised nor inflated.
#[derive(Clone, Debug)]
pub struct World {
    /// Segments of all outlines, and discs.
    parts: Vec<Part>,
    /// Rings of each filled polygon, to test whether a point is inside.
    filled: Vec<Vec<Vec<Point>>>,
    /// Cells that a map gives, and where they lie; the occupied ones are filled.
    cells: Option<(CellMap, Placement)>,
    index: Index,
}

/// A piece of an obstacle's surface.
#[derive(Clone, Copy, Debug)]
enum Part {
    Segment { from: Point, to: Point },
    Disc { centre: Point, radius: f64 },
}

/// The nearest point of any obstacle's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Its distance, metres; negative within a disc.
    pub distance_m: f64,
    /// Its position, metres.
    pub at: Point,
}

impl World {
    /// A world of these obstacles.
    pub fn new<'s>(obstacles: impl IntoIterator<Item = &'s Shape>) -> Self {
        Self::placed(obstacles, None, Placement::HERE)
    }

    /// A world of these obstacles and the occupied cells, which are placed; the obstacles are where
    /// they are. Cells that a map marks unknown are free.
    pub fn placed<'s>(
        obstacles: impl IntoIterator<Item = &'s Shape>,
        cells: Option<&CellMap>,
        placement: Placement,
    ) -> Self {
        let mut parts = Vec::new();
        let mut filled = Vec::new();
        for shape in obstacles {
            match shape {
                Shape::Circle { centre, radius } => {
                    parts.push(Part::Disc { centre: *centre, radius: *radius });
                }
                Shape::Polyline(points) => parts.extend(segments(points, false)),
                Shape::Polygon(rings) => {
                    parts.extend(rings.iter().flat_map(|ring| segments(ring, true)));
                    filled.push(rings.clone());
                }
            }
        }
        let outlines = cells.into_iter().flat_map(outline);
        parts.extend(outlines.map(|[from, to]| Part::Segment {
            from: placement.apply(from),
            to: placement.apply(to),
        }));
        let index = Index::new(&parts);
        Self { parts, filled, cells: cells.map(|cells| (cells.clone(), placement)), index }
    }

    /// The obstacles of a map, shapes and cells. Attenuating areas, zones and the map's boundary
    /// are rules, not walls, so they are left out.
    pub fn of_map(map: &Map) -> Self {
        let features = map.features.iter().filter(|feature| feature.role == Role::Obstacle);
        let shapes = features.map(|feature| &feature.shape);
        Self::placed(shapes, map.cells.as_ref(), Placement::HERE)
    }

    /// South-west and north-east corners of the box around all obstacles, metres.
    pub fn bounds(&self) -> Option<[Point; 2]> {
        bounds(&self.parts)
    }

    /// Distance along a ray to the first surface, metres; `None` if none is nearer than
    /// `most_m`. From within a disc: 0.
    pub fn range(&self, from: Point, heading_rad: f64, most_m: f64) -> Option<f64> {
        let along = [wide::cos(heading_rad), wide::sin(heading_rad)];
        let mut best = most_m;
        self.index.walk(from, along, most_m, &mut |cell, left_at| {
            for &part in cell {
                if let Some(hit) = self.parts[part as usize].hit(from, along) {
                    best = best.min(hit);
                }
            }
            // Every hit in a later cell is farther away than the end of this one.
            best > left_at
        });
        (best < most_m).then_some(best)
    }

    /// The surfaces that rays from a point meet within `most_m`.
    pub fn view(&self, from: Point, most_m: f64) -> View {
        View::new(self, from, most_m)
    }

    /// The nearest point of any surface; `None` if none is within `within_m`.
    pub fn nearest(&self, point: Point, within_m: f64) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        self.within(around(point, within_m), &mut |part| {
            let found = self.parts[part as usize].nearest(point);
            let limit = best.map_or(within_m, |best| best.distance_m);
            if found.distance_m < limit {
                best = Some(found);
            }
        });
        best
    }

    /// Smallest distance from the straight way between two points to any surface, metres, negative
    /// within a disc and 0 where the way crosses an outline; `None` if none is within `within_m`.
    pub fn nearest_along(&self, from: Point, to: Point, within_m: f64) -> Option<f64> {
        let mut best = within_m;
        let low = [0, 1].map(|axis| from[axis].min(to[axis]) - within_m);
        let high = [0, 1].map(|axis| from[axis].max(to[axis]) + within_m);
        self.within([low, high], &mut |part| {
            best = best.min(self.parts[part as usize].distance_of_way(from, to));
        });
        (best < within_m).then_some(best)
    }

    /// Calls `seen` for every part whose box overlaps a box, for some parts twice.
    fn within(&self, [low, high]: [Point; 2], seen: &mut dyn FnMut(u32)) {
        self.index.within([low, high], &mut |part| {
            let [from, to] = self.parts[part as usize].bounds();
            if [0, 1].into_iter().all(|axis| from[axis] <= high[axis] && low[axis] <= to[axis]) {
                seen(part);
            }
        });
    }

    /// Whether a disc touches no obstacle and its centre is not inside a filled one.
    pub fn is_clear(&self, centre: Point, radius: f64) -> bool {
        self.nearest(centre, radius).is_none() && !self.is_inside(centre)
    }

    /// Whether a point is inside a filled polygon (even-odd rule), a disc or an occupied cell.
    pub fn is_inside(&self, point: Point) -> bool {
        let within = |rings: &Vec<Vec<Point>>| {
            let crossed = rings.iter().flat_map(|ring| segments(ring, true));
            crossed.filter(|part| part.crosses_ray_east_of(point)).count() % 2 == 1
        };
        let is_occupied = |(cells, placement): &(CellMap, Placement)| {
            let cell = cell_at(cells, placement.undo(point));
            cell.is_some_and(|cell| cells.occupied.get(cell))
        };
        self.nearest(point, 0.0).is_some()
            || self.filled.iter().any(within)
            || self.cells.as_ref().is_some_and(is_occupied)
    }

    /// Pushes a disc that overlaps an obstacle out along the surface's normal. `None`: the disc
    /// overlaps nothing. `Some(Some(point))`: its centre after the push. `Some(None)`: no clear
    /// position was found nearby.
    pub fn pushed_clear(&self, centre: Point, radius: f64) -> Option<Option<Point>> {
        let mut at = centre;
        for push in 0..MAX_PUSHES {
            let Some(nearest) = self.nearest(at, radius) else {
                return (push > 0).then_some(Some(at));
            };
            let away = [at[0] - nearest.at[0], at[1] - nearest.at[1]];
            let length = wide::hypot(away[0], away[1]);
            if length <= 0.0 {
                return Some(None);
            }
            // From inside a disc, `away` points inwards.
            let outward = if nearest.distance_m < 0.0 { -1.0 } else { 1.0 };
            // Slightly more than the radius, so that the next query finds no overlap.
            let scale = (radius + 1e-9) / length * outward;
            at = [nearest.at[0] + away[0] * scale, nearest.at[1] + away[1] * scale];
        }
        Some(None)
    }
}

/// Distance along a ray to a disc's surface, metres; `None` if the ray misses it. From within: 0.
pub fn range_of_disc(from: Point, heading_rad: f64, centre: Point, radius: f64) -> Option<f64> {
    Part::Disc { centre, radius }.hit(from, [wide::cos(heading_rad), wide::sin(heading_rad)])
}

impl Part {
    /// Distance to this part along a ray of unit length `along`.
    fn hit(&self, from: Point, along: Point) -> Option<f64> {
        match *self {
            Self::Segment { from: a, to: b } => {
                let edge = [b[0] - a[0], b[1] - a[1]];
                let gap = [a[0] - from[0], a[1] - from[1]];
                let across = along[0] * edge[1] - along[1] * edge[0];
                if across == 0.0 {
                    return None;
                }
                let t = (gap[0] * edge[1] - gap[1] * edge[0]) / across;
                let u = (gap[0] * along[1] - gap[1] * along[0]) / across;
                (t >= 0.0 && (0.0..=1.0).contains(&u)).then_some(t)
            }
            Self::Disc { centre, radius } => {
                let gap = [centre[0] - from[0], centre[1] - from[1]];
                let ahead = gap[0] * along[0] + gap[1] * along[1];
                let beside = gap[0] * along[1] - gap[1] * along[0];
                let half = radius * radius - beside * beside;
                if half < 0.0 {
                    return None;
                }
                let half = wide::sqrt(half);
                (ahead + half >= 0.0).then_some((ahead - half).max(0.0))
            }
        }
    }

    fn nearest(&self, point: Point) -> Nearest {
        match *self {
            Self::Segment { from, to } => {
                let at = nearest_of_segment(point, from, to);
                Nearest { distance_m: distance(point, at), at }
            }
            Self::Disc { centre, radius } => {
                let gap = [point[0] - centre[0], point[1] - centre[1]];
                let length = wide::hypot(gap[0], gap[1]);
                // At the centre all directions are equal; east is the convention.
                let out =
                    if length > 0.0 { [gap[0] / length, gap[1] / length] } else { [1.0, 0.0] };
                let at = [centre[0] + out[0] * radius, centre[1] + out[1] * radius];
                Nearest { distance_m: length - radius, at }
            }
        }
    }

    /// Smallest distance from the straight way between two points to this part.
    fn distance_of_way(&self, from: Point, to: Point) -> f64 {
        let way = Self::Segment { from, to };
        match *self {
            Self::Disc { centre, radius } => way.nearest(centre).distance_m - radius,
            Self::Segment { from: a, to: b } => {
                if are_apart(from, to, a, b) || are_apart(a, b, from, to) {
                    let of_ends = [self.nearest(from), self.nearest(to)];
                    let of_way = [way.nearest(a), way.nearest(b)];
                    let all = of_ends.iter().chain(&of_way).map(|nearest| nearest.distance_m);
                    all.fold(f64::INFINITY, f64::min)
                } else {
                    0.0
                }
            }
        }
    }

    /// Whether a ray due east from a point crosses this segment; half-open, so that a vertex
    /// counts once.
    fn crosses_ray_east_of(&self, point: Point) -> bool {
        let Self::Segment { from, to } = *self else { return false };
        if (from[1] > point[1]) == (to[1] > point[1]) {
            return false;
        }
        let t = (point[1] - from[1]) / (to[1] - from[1]);
        from[0] + t * (to[0] - from[0]) > point[0]
    }

    /// South-west and north-east corners of its box.
    fn bounds(&self) -> [Point; 2] {
        match *self {
            Self::Segment { from: a, to: b } => {
                [[a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]]
            }
            Self::Disc { centre, radius } => around(centre, radius),
        }
    }
}

/// The box around a disc.
fn around(centre: Point, radius: f64) -> [Point; 2] {
    [-radius, radius].map(|by| [centre[0] + by, centre[1] + by])
}

/// Whether two points lie on the same side of the line through `a` and `b`, or on it.
fn are_apart(a: Point, b: Point, one: Point, other: Point) -> bool {
    let side = |p: Point| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    side(one) * side(other) >= 0.0
}

/// The segments between successive points, and back to the first if `closed`.
fn segments(points: &[Point], closed: bool) -> impl Iterator<Item = Part> + '_ {
    let back = if closed { points.last().zip(points.first()) } else { None };
    let open = points.windows(2).map(|pair| Part::Segment { from: pair[0], to: pair[1] });
    open.chain(back.map(|(&from, &to)| Part::Segment { from, to }))
}

/// South-west and north-east corners of the box around parts.
fn bounds(parts: &[Part]) -> Option<[Point; 2]> {
    parts.iter().map(Part::bounds).reduce(|[a, b], [c, d]| {
        [[a[0].min(c[0]), a[1].min(c[1])], [b[0].max(d[0]), b[1].max(d[1])]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Random, Stream};
    use maps::bitmap::Bitmap;

    /// A U that is open to the south, a disc and a slanted wall.
    fn shapes() -> Vec<Shape> {
        vec![
            Shape::Polygon(vec![vec![
                [10.0, 10.0],
                [14.0, 10.0],
                [14.0, 26.0],
                [26.0, 26.0],
                [26.0, 10.0],
                [30.0, 10.0],
                [30.0, 30.0],
                [10.0, 30.0],
            ]]),
            Shape::Circle { centre: [-20.0, 5.0], radius: 3.0 },
            Shape::Polyline(vec![[-30.0, -40.0], [35.0, -7.0]]),
        ]
    }

    #[test]
    fn rays_stop_at_the_first_surface() {
        let shapes = shapes();
        let world = World::new(&shapes);
        let north = std::f64::consts::FRAC_PI_2;
        let close = |found: Option<f64>, wanted: f64| {
            assert!((found.expect("a hit") - wanted).abs() < 1e-9, "{found:?} for {wanted}");
        };
        close(world.range([20.0, 0.0], north, 100.0), 26.0);
        close(world.range([12.0, 0.0], north, 100.0), 10.0);
        close(world.range([0.0, 5.0], std::f64::consts::PI, 100.0), 17.0);
        close(world.range([-20.0, 5.0], 1.0, 100.0), 0.0);
        assert_eq!(world.range([20.0, 0.0], north, 25.9), None);
        assert_eq!(world.range([0.0, 50.0], north, 1e3), None);
    }

    #[test]
    fn the_index_finds_what_a_scan_of_all_parts_finds() {
        let shapes = shapes();
        let world = World::new(&shapes);
        let mut random = Random::new(1, Stream::Start);
        for _ in 0..1_000 {
            let from = [random.between(-50.0, 50.0), random.between(-60.0, 50.0)];
            let heading = random.between(-4.0, 4.0);
            let along = [wide::cos(heading), wide::sin(heading)];
            let hits = world.parts.iter().filter_map(|part| part.hit(from, along));
            let slow = hits.filter(|&hit| hit < 40.0).reduce(f64::min);
            assert_eq!(world.range(from, heading, 40.0), slow, "{from:?} {heading}");
            assert_eq!(world.view(from, 40.0).range(heading), slow, "{from:?} {heading}");

            let to = [from[0] + random.between(-3.0, 3.0), from[1] + random.between(-3.0, 3.0)];
            let ways = world.parts.iter().map(|part| part.distance_of_way(from, to));
            let slow = ways.filter(|&distance| distance < 7.0).reduce(f64::min);
            assert_eq!(world.nearest_along(from, to, 7.0), slow, "{from:?} {to:?}");
            // No sampled point of the way is nearer, and one is almost as near.
            let sampled = (0..=3_000).filter_map(|step| {
                let t = f64::from(step) / 3_000.0;
                let at = [0, 1].map(|axis| from[axis] + t * (to[axis] - from[axis]));
                world.nearest(at, 7.0).map(|nearest| nearest.distance_m)
            });
            if let (Some(exact), Some(sampled)) = (slow, sampled.reduce(f64::min)) {
                assert!((0.0..2e-3).contains(&(sampled - exact)), "{from:?} {to:?}");
            }

            let distances = world.parts.iter().map(|part| part.nearest(from).distance_m);
            let slow = distances.filter(|&distance| distance < 7.0).reduce(f64::min);
            let fast = world.nearest(from, 7.0).map(|nearest| nearest.distance_m);
            assert_eq!(fast, slow, "{from:?}");
        }
    }

    #[test]
    fn only_filled_shapes_have_an_inside() {
        let shapes = shapes();
        let world = World::new(&shapes);
        assert!(world.is_inside([12.0, 20.0]) && world.is_inside([-20.0, 7.9]));
        assert!(!world.is_inside([20.0, 20.0]) && !world.is_inside([0.0, 0.0]));
        assert!(world.is_clear([20.0, 20.0], 5.9) && !world.is_clear([20.0, 20.0], 6.1));
    }

    /// The obstacle fills columns 1 and 2 of row 1, and column 1 of row 2; cells are 0.5 m.
    #[test]
    fn occupied_cells_are_walls_and_unknown_cells_are_not() {
        let occupied =
            Bitmap::from_fn(4, 4, |cell| matches!((cell.column, cell.row), (1 | 2, 1) | (1, 2)));
        let unknown = Bitmap::from_fn(4, 4, |cell| cell.row == 0);
        let cells = CellMap {
            resolution_m: 0.5,
            corner: [10.0, -1.0],
            occupied,
            unknown,
            unknown_as: maps::Unknown::Obstacle,
            turned_from: None,
        };
        let world = World::placed([], Some(&cells), Placement::HERE);
        assert_eq!(world.parts.len(), 6, "{:?}", world.parts);
        assert_eq!(world.bounds(), Some([[10.5, -0.5], [11.5, 0.5]]));
        assert!(world.is_inside([10.6, 0.4]) && world.is_inside([11.4, -0.4]));
        assert!(!world.is_inside([11.4, 0.1]) && !world.is_inside([10.6, -0.8]));
        assert_eq!(world.range([9.0, -0.25], 0.0, 9.0), Some(1.5));
        assert!(
            (world.range([11.25, 2.0], -std::f64::consts::FRAC_PI_2, 9.0).expect("a hit") - 2.0)
                .abs()
                < 1e-9
        );
        assert!(world.is_clear([11.4, 0.4], 0.39) && !world.is_clear([11.4, 0.4], 0.41));
    }

    #[test]
    fn an_empty_world_is_clear() {
        let world = World::new([]);
        assert!(world.is_clear([1.0, 2.0], 100.0));
        assert_eq!(world.range([0.0, 0.0], 0.3, 1e4), None);
    }
}
