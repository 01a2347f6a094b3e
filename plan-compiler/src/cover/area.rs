//! The area to cover, and the cells of it that the robot may enter.

use super::order::{Passable, Roads};
use super::{Ground, Settings};
use crate::compile;
use crate::field::UNREACHED;
use crate::input::{Input, Options};
use crate::mission::PHYSICAL;
use geo::{Area as _, BooleanOps, BoundingRect, Contains, LineString, Polygon, Rect, Validation};
use maps::names::nearest;
use maps::numbers::{metres, pair};
use maps::problem::Problem;
use maps::raster::{RasterOptions, rasterise};
use maps::{Bitmap, Extent, Feature, Map, Point, Role, Shape};
use math::scalar::wide;
use plan_format::{Cell, Grid};
use std::f64::consts::TAU;

/// More cells than this are not swept.
const MAX_CELLS: usize = 4_000_000;
/// Corners of the polygon that stands for a circle.
const CIRCLE_CORNERS: u32 = 64;

/// An area to cover: polygons with holes.
#[derive(Clone, Debug)]
pub struct Area {
    /// Its name.
    pub name: String,
    polygons: Vec<Polygon>,
}

/// The area with these corners.
///
/// # Errors
/// Returns what is wrong with the polygon.
pub fn corners(points: &[Point]) -> Result<Area, Problem> {
    const HELP: &str = "give three or more corners in order around the area, each as --corner X,Y";
    if points.len() < 3 {
        let message = format!("an area has at least 3 corners, not {}", points.len());
        return Err(Problem::error(message).help(HELP));
    }
    let polygon = Polygon::new(ring(points), Vec::new());
    check(&polygon, "the area of the corners").map_err(|problem| problem.help(HELP))?;
    Ok(Area { name: "corners".to_owned(), polygons: vec![polygon] })
}

fn ring(points: &[Point]) -> LineString {
    LineString::from(points.iter().map(|[x, y]| (*x, *y)).collect::<Vec<_>>())
}

fn check(polygon: &Polygon, what: &str) -> Result<(), Problem> {
    if let Err(error) = polygon.check_validation() {
        return Err(Problem::error(format!("{what} is not a polygon: {error}")));
    }
    if polygon.unsigned_area() > 0.0 {
        return Ok(());
    }
    Err(Problem::error(format!("{what} encloses nothing")))
}

impl Area {
    /// The area of a map with a name.
    ///
    /// # Errors
    /// Returns that the map has no such area, or what is wrong with it.
    pub fn named(map: &Map, name: &str) -> Result<Self, Vec<Problem>> {
        let named: Vec<&Feature> = map.features.iter().filter(|f| f.name == name).collect();
        if named.is_empty() {
            return Err(vec![unknown(map, name)]);
        }
        let (mut polygons, mut problems) = (Vec::new(), Vec::new());
        for feature in named {
            let what = format!("area `{name}`");
            let polygon = match &feature.shape {
                _ if feature.role == Role::Obstacle => {
                    let message = format!("{what} is an obstacle: a robot cannot cover it");
                    let help = "name a zone of the map, or give corners: --corner X,Y";
                    problems.push(Problem::error(message).help(help));
                    continue;
                }
                Shape::Polygon(rings) => {
                    let Some((outer, holes)) = rings.split_first() else { continue };
                    let holes = holes.iter().map(|hole| ring(hole)).collect();
                    Polygon::new(ring(outer), holes)
                }
                Shape::Polyline(points) if points.len() > 3 && points.first() == points.last() => {
                    Polygon::new(ring(points), Vec::new())
                }
                Shape::Polyline(_) => {
                    let message = format!("{what} is an open line and encloses nothing");
                    let help = "close the line: its last point equals its first";
                    problems.push(Problem::error(message).help(help));
                    continue;
                }
                Shape::Circle { centre, radius } => Polygon::new(circle(*centre, *radius), vec![]),
            };
            match check(&polygon, &what) {
                Ok(()) => polygons.push(polygon),
                Err(problem) => problems.push(problem.help("draw the area anew in the map")),
            }
        }
        if problems.is_empty() {
            Ok(Self { name: name.to_owned(), polygons })
        } else {
            Err(problems)
        }
    }

    /// Its size without its holes, m².
    pub fn size_m2(&self) -> f64 {
        self.polygons.iter().map(Polygon::unsigned_area).sum()
    }

    /// How much of it lies off a grid, or outside the map's boundary, m².
    pub fn off_map_m2(&self, grid: &Grid, boundary: Option<&[Point]>) -> f64 {
        let [west, south] = grid.corner_m;
        let [width, height] =
            [grid.columns, grid.rows].map(|cells| f64::from(cells) * grid.resolution_m);
        let whole = Rect::new((west, south), (west + width, south + height)).to_polygon();
        let boundary = boundary.map(|points| Polygon::new(ring(points), Vec::new()));
        let on_map = |polygon: &Polygon| {
            let inside = polygon.intersection(&whole);
            let inside = match &boundary {
                Some(boundary) => inside.intersection(boundary),
                None => inside,
            };
            inside.unsigned_area()
        };
        let off: f64 = self.polygons.iter().map(|one| one.unsigned_area() - on_map(one)).sum();
        off.max(0.0)
    }

    /// The longer side of the box around it, metres.
    pub fn longest_m(&self) -> f64 {
        let boxes = self.polygons.iter().filter_map(BoundingRect::bounding_rect);
        boxes.map(|rect| rect.width().max(rect.height())).fold(0.0, f64::max)
    }

    /// The directions of its edges, degrees counter-clockwise from east, the longest edge first.
    pub fn edges_deg(&self) -> Vec<f64> {
        let rings =
            self.polygons.iter().flat_map(|p| [p.exterior()].into_iter().chain(p.interiors()));
        let mut edges: Vec<(f64, f64)> = rings
            .flat_map(LineString::lines)
            .map(|line| {
                let (dx, dy) = (line.dx(), line.dy());
                (wide::hypot(dx, dy), wide::atan2(dy, dx).to_degrees())
            })
            .collect();
        edges.sort_by(|a, b| b.0.total_cmp(&a.0));
        edges.into_iter().map(|(_, angle)| angle).collect()
    }

    /// The outlines of its polygons and holes.
    pub fn outlines(&self) -> Vec<Vec<Point>> {
        let rings =
            self.polygons.iter().flat_map(|p| [p.exterior()].into_iter().chain(p.interiors()));
        rings.map(|ring| ring.coords().map(|at| [at.x, at.y]).collect()).collect()
    }

    /// The cells that lie in the area with all of them, and farther than this from its edge.
    fn inner(&self, grid: &Grid, edge_m: f64) -> Bitmap {
        let mut inner = Bitmap::new(grid.columns, grid.rows);
        for polygon in &self.polygons {
            let holes = polygon.interiors().iter().map(|hole| Shape::Polygon(vec![line(hole)]));
            let shapes = holes.chain([Shape::Polyline(line(polygon.exterior()))]);
            let map = Map { boundary: Some(line(polygon.exterior())), ..map_of(grid, shapes) };
            let outside = raster(&map, grid, edge_m);
            inner.add_all(&Bitmap::from_fn(grid.columns, grid.rows, |cell| !outside.get(cell)));
        }
        inner
    }

    /// The cells that the area touches.
    fn touched(&self, grid: &Grid) -> Bitmap {
        let shapes = self.polygons.iter().map(|polygon| {
            let rings = [polygon.exterior()].into_iter().chain(polygon.interiors());
            Shape::Polygon(rings.map(line).collect())
        });
        raster(&map_of(grid, shapes), grid, 0.0)
    }

    fn contains(&self, [x, y]: Point) -> bool {
        self.polygons.iter().any(|polygon| polygon.contains(&geo::Point::new(x, y)))
    }
}

fn unknown(map: &Map, name: &str) -> Problem {
    /// Listing more names than this does not help.
    const LISTED: usize = 12;
    let areas = map.features.iter().filter(|feature| feature.role != Role::Obstacle);
    let mut known: Vec<&str> = areas.map(|feature| feature.name.as_str()).collect();
    known.retain(|name| !name.is_empty());
    known.sort_unstable();
    known.dedup();
    let help = match nearest(name, known.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None if known.is_empty() => {
            "the map gives no area a name: give the corners of one, --corner X,Y".to_owned()
        }
        None => format!(
            "the map has: {}{}; or give corners: --corner X,Y",
            known[..known.len().min(LISTED)].join(", "),
            if known.len() > LISTED { ", ..." } else { "" }
        ),
    };
    Problem::error(format!("the map has no area named `{name}`")).help(help)
}

fn circle([x, y]: Point, radius: f64) -> LineString {
    let corner = |index: u32| {
        let angle = TAU * f64::from(index) / f64::from(CIRCLE_CORNERS);
        (x + radius * wide::cos(angle), y + radius * wide::sin(angle))
    };
    LineString::from((0..CIRCLE_CORNERS).map(corner).collect::<Vec<_>>())
}

fn line(ring: &LineString) -> Vec<Point> {
    ring.coords().map(|at| [at.x, at.y]).collect()
}

/// A map of these shapes only.
fn map_of(grid: &Grid, shapes: impl Iterator<Item = Shape>) -> Map {
    let size = [grid.columns, grid.rows].map(|cells| f64::from(cells) * grid.resolution_m);
    let feature = |shape| Feature {
        shape,
        role: Role::Zone,
        name: String::new(),
        height_m: None,
        span: 0..0,
    };
    let extent = Extent { corner: grid.corner_m, size };
    Map { features: shapes.map(feature).collect(), ..Map::empty(extent) }
}

fn raster(map: &Map, grid: &Grid, radius_m: f64) -> Bitmap {
    let options = RasterOptions { robot_radius_m: radius_m, fill_walls: false };
    rasterise(map, grid, &|_| true, &options)
}

/// An area on a map, as a robot meets it.
#[derive(Clone, Debug)]
pub struct Site {
    /// The area.
    pub area: Area,
    /// Cells of the area without an obstacle: what there is to cover.
    pub wanted: Bitmap,
    /// Where strips may be: farther than the robot's radius from obstacles, than the edge's distance
    /// from the edge, and within reach of the start.
    pub ground: Ground,
    /// As `ground`, but out of reach of the start.
    pub cut_off: Bitmap,
    /// Where the robot may drive inside the area.
    pub inside: Ground,
    /// Where the robot may drive.
    pub anywhere: Ground,
    /// Where the robot starts.
    pub start: Point,
    /// The robot's radius, metres.
    pub radius_m: f64,
    /// Distance of strips from the area's edge, metres.
    pub edge_m: f64,
    /// How much of the area lies off the map, m².
    pub off_map_m2: f64,
}

impl Site {
    /// Where transitions between strips may lead.
    pub fn passable(&self) -> Passable<'_> {
        Passable { inside: &self.inside, anywhere: &self.anywhere }
    }
}

/// What is asked of a site.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked<'a> {
    /// The layer whose obstacles count; `None` for `physical`.
    pub layer: Option<&'a str>,
    /// Distance of strips from the area's edge, metres; `None` for the robot's radius.
    pub edge_m: Option<f64>,
    /// Where the robot starts; `None` for the map's start, or else the largest part of the area.
    pub start: Option<Point>,
}

/// The site of an area; `None` after an error.
pub fn site(
    input: &Input<'_>,
    area: Area,
    asked: Asked<'_>,
    problems: &mut Vec<Problem>,
) -> Option<Site> {
    let grid = compile::grid(input, problems)?;
    let radius_m = compile::robot_radius(input, problems)?;
    let edge_m = asked.edge_m.unwrap_or(radius_m);
    let Some(anywhere) = free(input, &grid, asked.layer, &mut Vec::new()) else {
        check_asked(input, &grid, asked, problems);
        return None;
    };
    let bare = Options { robot_radius_m: Some(0.0), ..input.options.clone() };
    // Its problems are those of the layer above.
    let bare = free(&Input { options: &bare, ..*input }, &grid, asked.layer, &mut Vec::new())?;
    let (inner, touched) = (area.inner(&grid, 0.0), area.touched(&grid));
    let is_in = |cell: Cell| inner.get(cell) || area.contains(grid.centre(cell));
    let all = |holds: &dyn Fn(Cell) -> bool| {
        Bitmap::from_fn(grid.columns, grid.rows, |cell| touched.get(cell) && holds(cell))
    };
    let wanted = all(&|cell| bare.get(cell) && is_in(cell));
    let strict = area.inner(&grid, edge_m);
    let ground = all(&|cell| anywhere.get(cell) && strict.get(cell));
    if touched.count() == 0 {
        problems.push(
            Problem::error(format!("area `{}` lies off the map", area.name))
                .help(compile::reach(&grid)),
        );
        return None;
    }
    if ground.count() == 0 {
        problems.push(blocked(&area, radius_m, edge_m));
        return None;
    }
    if ground.count() > MAX_CELLS {
        let message = format!(
            "area `{}` has {} cells, but at most {MAX_CELLS} are swept",
            area.name,
            ground.count()
        );
        problems.push(Problem::error(message).help("use a coarser --resolution, or cover parts"));
        return None;
    }
    let inside = Ground { grid, cells: all(&|cell| anywhere.get(cell)) };
    let anywhere = Ground { grid, cells: anywhere };
    let (reached, start) = reached(input, &anywhere, &ground, asked.start, problems)?;
    let part = |is_reached: bool| {
        Bitmap::from_fn(grid.columns, grid.rows, |cell| {
            ground.get(cell) && reached.get(cell) == is_reached
        })
    };
    let (within, cut_off) = (part(true), part(false));
    if within.count() == 0 {
        let message =
            format!("no part of area `{}` can be reached from {}", area.name, pair(start));
        problems.push(Problem::error(message).help("choose another --start"));
        return None;
    }
    let ground = Ground { grid, cells: within };
    let off_map_m2 = area.off_map_m2(&grid, input.map.boundary.as_deref());
    Some(Site {
        area,
        wanted,
        ground,
        cut_off,
        inside,
        anywhere,
        start,
        radius_m,
        edge_m,
        off_map_m2,
    })
}

fn blocked(area: &Area, radius_m: f64, edge_m: f64) -> Problem {
    let message = format!(
        "area `{}` has no cell that the robot may enter: its radius is {} m, and strips keep {} m \
         from the edge",
        area.name,
        metres(radius_m),
        metres(edge_m)
    );
    let smaller = [("--edge", edge_m), ("--robot-radius", radius_m)];
    let smaller = smaller.iter().filter(|(_, metres)| *metres > 0.0).map(|(name, _)| *name);
    let options: Vec<&str> = smaller.chain(["--resolution"]).collect();
    Problem::error(message).help(format!("make {} smaller", options.join(" or ")))
}

/// What is wrong with the layer and the start that are asked for, whatever the area.
pub fn check_asked(input: &Input<'_>, grid: &Grid, asked: Asked<'_>, problems: &mut Vec<Problem>) {
    let cells = free(input, grid, asked.layer, problems);
    let cells = cells.or_else(|| free(input, grid, None, &mut Vec::new()));
    if let (Some(cells), Some(start)) = (cells, asked.start) {
        problems.extend(check_start(&Ground { grid: *grid, cells }, start).err());
    }
}

/// Refuses a start at which the robot cannot be.
fn check_start(anywhere: &Ground, [x, y]: Point) -> Result<(), Problem> {
    let cell = anywhere.grid.cell_at(x, y);
    if cell.is_some_and(|cell| anywhere.cells.get(cell)) {
        return Ok(());
    }
    let message = format!("the start {} is blocked or off the map", pair([x, y]));
    Err(Problem::error(message).help("choose a free place: --start X,Y"))
}

/// The cells that are free in a layer.
fn free(
    input: &Input<'_>,
    grid: &Grid,
    layer: Option<&str>,
    problems: &mut Vec<Problem>,
) -> Option<Bitmap> {
    let stack = compile::layers(input, grid, problems)?;
    let name = layer.unwrap_or(PHYSICAL);
    let Some(layer) = stack.layers().iter().find(|layer| layer.name == name) else {
        let known = || stack.layers().iter().map(|layer| layer.name.as_str());
        let help = match nearest(name, known()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("the layers are: {}", known().collect::<Vec<_>>().join(", ")),
        };
        problems.push(Problem::error(format!("there is no layer `{name}`")).help(help));
        return None;
    };
    let blocked = &layer.terrain.blocked;
    Some(Bitmap::from_fn(grid.columns, grid.rows, |cell| !blocked.get(cell)))
}

/// The cells that a robot reaches, and where it starts. Without a start, the cells around the largest
/// connected part of the ground.
fn reached(
    input: &Input<'_>,
    anywhere: &Ground,
    ground: &Bitmap,
    start: Option<Point>,
    problems: &mut Vec<Problem>,
) -> Option<(Bitmap, Point)> {
    let grid = &anywhere.grid;
    if let Some(problem) = start.and_then(|start| check_start(anywhere, start).err()) {
        problems.push(problem);
        return None;
    }
    let of_map = input.map.start.as_ref().map(|start| start.at);
    let start = start.or(of_map.filter(|at| check_start(anywhere, *at).is_ok()));
    let mut roads = Roads::of(anywhere);
    let mut reach = |from: Point| {
        let field = roads.field(from);
        Bitmap::from_fn(grid.columns, grid.rows, |cell| field.cost[grid.index(cell)] != UNREACHED)
    };
    if let Some(start) = start {
        return Some((reach(start), start));
    }
    let (mut left, mut best): (Bitmap, Option<(usize, Bitmap, Point)>) = (ground.clone(), None);
    while let Some(cell) = { left.iter().next() } {
        let part = reach(grid.centre(cell));
        let count = ground.iter().filter(|cell| part.get(*cell)).count();
        if best.as_ref().is_none_or(|(most, ..)| count > *most) {
            best = Some((count, part.clone(), grid.centre(cell)));
        }
        left = Bitmap::from_fn(grid.columns, grid.rows, |at| left.get(at) && !part.get(at));
    }
    best.map(|(_, part, start)| (part, start))
}

/// What is wrong with a width, an overlap or an angle for an area on a grid.
pub fn check_settings(area: &Area, grid: &Grid, settings: &Settings) -> Vec<Problem> {
    let mut problems = Vec::new();
    let Settings { width_m, overlap_m, .. } = *settings;
    let mut wrong = |message: String, help: String| {
        problems.push(Problem::error(message).help(help));
    };
    if width_m > area.longest_m() {
        let longest = metres(area.longest_m());
        wrong(
            format!(
                "--width is {} m, but area `{}` is only {longest} m long",
                metres(width_m),
                area.name
            ),
            "give the width of the tool in metres, not that of the area".to_owned(),
        );
    }
    if width_m < grid.resolution_m {
        let side = metres(grid.resolution_m);
        wrong(
            format!("--width is {} m, less than a cell of {side} m", metres(width_m)),
            format!("make the cells smaller: --resolution {}", metres(width_m / 4.0)),
        );
    }
    if overlap_m > width_m / 2.0 {
        wrong(
            format!("--overlap is {} m of a width of {} m", metres(overlap_m), metres(width_m)),
            "give how far neighbouring strips overlap: at most half the width".to_owned(),
        );
    }
    problems
}
