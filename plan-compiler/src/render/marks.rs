//! Drawings over the cells: exact shapes, arrows, routes, marks and the names of goals.
//!
//! Marks differ in shape, so that nothing depends on colour alone; each has a light rim that
//! separates it from its background.

use super::palette::{self, ADVICE, ATTENUATING, GOAL, INK, OBSTACLE, PAPER, UNMAPPED, ZONE};
use super::stroke::{dashes, stroke};
use super::text::{self, Anchor, CAPITALS_EM, width_px};
use super::view::View;
use maps::{Feature, Point, Role, Shape};
use math::scalar::wide;
use plan_format::{Answer, Cell, Layer};
use std::fmt::Write;
use svg::node::element::{Group, Path, Rectangle};

/// The kind of a marked position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Where the robot started: a ring.
    Start,
    /// The goal of the layer: a star.
    Goal,
    /// The goal of another plan: a small diamond.
    OtherGoal,
    /// Where a route ends at its goal or the mission is done: a square.
    End,
    /// Where the robot stopped before the end: a cross.
    Stop,
    /// Where a behaviour yielded at a point of its plan: a triangle.
    GaveWay,
    /// Where a behaviour was interrupted at once: a triangle on its tip.
    Interrupted,
    /// Where a fault began or ended: a light star of six points.
    Fault,
    /// A narrow passage: a light hourglass.
    Narrow,
    /// A passage narrower than the robot needs: a dark hourglass.
    TooNarrow,
}

impl Mark {
    /// The corners of the shape, in units from its middle, y down.
    fn corners(self) -> Vec<[f64; 2]> {
        let around = |count: usize, radii: &[f64], turned: f64| {
            let corner = |index: usize| {
                let angle = std::f64::consts::TAU * (index as f64 / count as f64 + turned);
                let radius = radii[index % radii.len()];
                [radius * wide::sin(angle), -radius * wide::cos(angle)]
            };
            (0..count).map(corner).collect()
        };
        match self {
            Self::Start => around(24, &[6.5], 0.0),
            Self::Goal => around(10, &[11.0, 4.8], 0.0),
            Self::OtherGoal => around(4, &[6.0], 0.0),
            Self::Fault => around(12, &[9.0, 4.5], 0.0),
            Self::End => around(4, &[5.5], 0.125),
            Self::GaveWay => around(3, &[8.5], 0.0),
            Self::Interrupted => around(3, &[8.5], 0.5),
            Self::Narrow | Self::TooNarrow => {
                let (half, waist, tall) = (5.5, 1.2, 8.0);
                vec![
                    [-half, -tall],
                    [half, -tall],
                    [waist, 0.0],
                    [half, tall],
                    [-half, tall],
                    [-waist, 0.0],
                ]
            }
            Self::Stop => {
                // The arms of a cross, clockwise.
                let (arm, half) = (8.0, 2.6);
                let quarter = [[0.0, -half], [arm - half, -arm], [arm, half - arm]];
                let turned = |[x, y]: [f64; 2], turns: usize| match turns {
                    0 => [x, y],
                    1 => [-y, x],
                    2 => [-x, -y],
                    _ => [y, -x],
                };
                let corner = |turns: usize| quarter.map(|corner| turned(corner, turns));
                (0..4).flat_map(corner).collect()
            }
        }
    }

    fn fill(self) -> &'static str {
        match self {
            Self::Start | Self::OtherGoal | Self::Narrow | Self::Fault => PAPER,
            Self::Goal => GOAL,
            Self::End | Self::Stop | Self::GaveWay | Self::Interrupted | Self::TooNarrow => INK,
        }
    }

    /// The mark at a point, pixels.
    pub(super) fn draw(self, at: [f64; 2], unit: f64) -> Group {
        let mut path = String::new();
        for (index, [x, y]) in self.corners().into_iter().enumerate() {
            let letter = if index == 0 { 'M' } else { 'L' };
            let [x, y] = [at[0] + x * unit, at[1] + y * unit].map(text::round);
            let _ = write!(path, "{letter}{x} {y}");
        }
        path.push('z');
        let rim = stroke(path.clone(), PAPER, 5.0 * unit).set("stroke-linejoin", "round");
        let edge = stroke(path, INK, 2.0 * unit).set("stroke-linejoin", "round");
        Group::new().add(rim).add(edge.set("fill", self.fill()))
    }
}

/// A route in its colour and dashes, on a light casing that separates it from arrows and obstacles.
pub(super) fn route(path: &str, style: usize, unit: f64) -> Group {
    let (colour, gaps) = palette::route(style);
    let width = 3.4 * unit;
    let line = |colour, width| {
        stroke(path.to_owned(), colour, width)
            .set("stroke-linejoin", "round")
            .set("stroke-linecap", "butt")
    };
    Group::new()
        .add(line(PAPER, width + 3.0 * unit))
        .add(line(colour, width).set("stroke-dasharray", dashes(gaps, width)))
}

/// The path through points of the map.
pub(super) fn line(points: &[Point], view: &View, path: &mut String) {
    let mut last = None;
    for (index, point) in points.iter().enumerate() {
        let at = view.place(*point).map(text::round);
        // Steps of less than a hundredth of a pixel are invisible.
        if last != Some(at) || index + 1 == points.len() {
            let _ = write!(path, "{}{} {}", if index == 0 { 'M' } else { 'L' }, at[0], at[1]);
        }
        last = Some(at);
    }
}

/// The exact shapes.
pub(super) fn shapes(features: &[Feature], view: &View) -> Group {
    let mut group = Group::new().set("stroke-linejoin", "round").set("stroke-linecap", "round");
    let width = 2.0 * view.measure.unit;
    for feature in features {
        let mut path = String::new();
        let is_filled = outline(&feature.shape, view, &mut path);
        let (colour, opacity, gaps) = match feature.role {
            Role::Obstacle => (OBSTACLE, 1.0, &[][..]),
            Role::Attenuating => (ATTENUATING, ATTENUATING_OPACITY, &[][..]),
            Role::Zone => (ZONE, 0.0, &[2.0, 2.5][..]),
        };
        let shape = stroke(path, colour, width)
            .set("stroke-dasharray", dashes(gaps, width))
            .set("fill", if is_filled { colour } else { "none" })
            .set("fill-opacity", opacity)
            .set("fill-rule", "evenodd");
        group = group.add(shape);
    }
    group
}

/// Obstacles that the map does not show: filled, with a dark edge.
pub(super) fn unmapped(shapes: &[Shape], view: &View) -> Group {
    outlined(shapes, view, UNMAPPED, &[])
}

/// Obstacles that only the map shows: hollow, with a dashed edge.
pub(super) fn absent(shapes: &[Shape], view: &View) -> Group {
    outlined(shapes, view, PAPER, &[2.0, 2.5])
}

/// Shapes in a colour with an edge; a line without an inside is a line of that colour on the edge.
fn outlined(shapes: &[Shape], view: &View, colour: &str, gaps: &[f64]) -> Group {
    let mut group = Group::new().set("stroke-linejoin", "round");
    let width = 1.5 * view.measure.unit;
    for shape in shapes {
        let mut path = String::new();
        if outline(shape, view, &mut path) {
            let edge = stroke(path, INK, width).set("stroke-dasharray", dashes(gaps, width));
            group = group.add(edge.set("fill", colour).set("fill-rule", "evenodd"));
        } else {
            let edge = stroke(path.clone(), INK, 3.0 * width).set("fill", "none");
            group = group.add(edge.set("stroke-dasharray", dashes(gaps, width)));
            group = group.add(stroke(path, colour, 1.5 * width).set("fill", "none"));
        }
    }
    group
}

/// Opacity of areas that weaken radio, so that cells below them stay visible.
pub(super) const ATTENUATING_OPACITY: f64 = 0.4;

/// Adds a shape to a path. Returns whether the shape has an inside.
fn outline(shape: &Shape, view: &View, path: &mut String) -> bool {
    match shape {
        Shape::Circle { centre, radius } => {
            let [west, y] = view.place([centre[0] - radius, centre[1]]).map(text::round);
            let [rx, ry] =
                view.cell().map(|cell| text::round(radius / view.grid.resolution_m * cell));
            let _ = write!(path, "M{west} {y}a{rx} {ry} 0 1 0 {} 0", 2.0 * rx);
            let _ = write!(path, "a{rx} {ry} 0 1 0 {} 0z", -2.0 * rx);
            true
        }
        Shape::Polyline(points) => {
            line(points, view, path);
            false
        }
        Shape::Polygon(rings) => {
            for ring in rings {
                line(ring, view, path);
                path.push('z');
            }
            true
        }
    }
}

/// Distance between arrows, in units.
const ARROW_UNITS: f64 = 27.0;
/// Largest length of an arrow, in units, and its share of the distance.
const MAX_ARROW_UNITS: f64 = 26.0;
const ARROW_PART: f64 = 0.6;

/// Cells along the sides of a block that has one arrow.
pub(super) fn cells_per_arrow(view: &View) -> [u32; 2] {
    let room = ARROW_UNITS * view.measure.unit;
    view.cell().map(|cell| (room / cell).ceil().max(1.0) as u32)
}

/// One arrow per block: the advice of the cell nearest to the middle that has one.
pub(super) fn arrows(layer: &Layer<'_>, view: &View) -> Path {
    let [across, up] = cells_per_arrow(view);
    let [width, height] = view.cell();
    let room = (f64::from(across) * width).min(f64::from(up) * height);
    let length = (ARROW_PART * room).min(MAX_ARROW_UNITS * view.measure.unit);
    let mut path = String::new();
    for row in (0..view.grid.rows).step_by(up as usize) {
        for column in (0..view.grid.columns).step_by(across as usize) {
            let Some((cell, unit)) = advice_near(layer, [column, row], [across, up]) else {
                continue;
            };
            let at = [f64::from(cell.column) + 0.5, f64::from(cell.row) + 0.5];
            let at = [at[0] * width, f64::from(view.map[1]) - at[1] * height];
            path += &arrow(at, unit, length);
        }
    }
    stroke(path, ADVICE, 1.3 * view.measure.unit).set("stroke-linecap", "round")
}

/// The cell nearest to the middle of a block, within its inner half, that has advice; and its
/// advice.
fn advice_near(layer: &Layer<'_>, corner: [u32; 2], size: [u32; 2]) -> Option<(Cell, [f64; 2])> {
    let middle = [corner[0] + size[0] / 2, corner[1] + size[1] / 2];
    let reach = (size[0].min(size[1]) / 4).min(MOST_RINGS);
    let on_ring = |ring: u32| {
        let (ring, side) = (i64::from(ring), 2 * i64::from(ring));
        // Around the ring, or the middle itself.
        (0..(4 * side).max(1)).map(move |step| match (step / side.max(1), step % side.max(1)) {
            (0, along) => [along - ring, -ring],
            (1, along) => [ring, along - ring],
            (2, along) => [ring - along, ring],
            (_, along) => [-ring, ring - along],
        })
    };
    (0..=reach).flat_map(on_ring).find_map(|[dx, dy]| {
        let column = u32::try_from(i64::from(middle[0]) + dx).ok()?;
        let row = u32::try_from(i64::from(middle[1]) + dy).ok()?;
        match layer.look_up(Cell::new(column, row)) {
            Answer::Move { direction, .. } => {
                let unit = direction.unit();
                Some((Cell::new(column, row), [f64::from(unit.x), f64::from(unit.y)]))
            }
            _ => None,
        }
    })
}

/// Largest distance from the middle of a block, cells, at which advice is searched.
const MOST_RINGS: u32 = 16;

/// An arrow centred at a point, along a unit vector with y up.
pub(super) fn arrow(at: [f64; 2], [x, y]: [f64; 2], length: f64) -> String {
    let (head, side) = (0.42 * length, 0.26 * length);
    let end = |half: f64| [at[0] + x * half * length, at[1] - y * half * length];
    let (tail, tip) = (end(-0.5), end(0.5));
    let barb = |side: f64| [tip[0] - x * head - y * side, tip[1] + y * head - x * side];
    let point = |[x, y]: [f64; 2]| format!("{:.1} {:.1}", x, y);
    format!(
        "M{}L{}M{}L{}L{}",
        point(tail),
        point(tip),
        point(barb(side)),
        point(tip),
        point(barb(-side))
    )
}

/// Places names beside their marks, without overlaps.
pub(super) struct Names {
    /// Occupied boxes: left, top, right, bottom.
    taken: Vec<[f64; 4]>,
    /// Points of routes, which names should not cover.
    routes: Vec<[f64; 2]>,
}

impl Names {
    /// Names never cover marks, and cover routes only if necessary.
    pub(super) fn new(marks: &[[f64; 2]], routes: Vec<[f64; 2]>, unit: f64) -> Self {
        let around = |at: &[f64; 2]| {
            let reach = 9.0 * unit;
            [at[0] - reach, at[1] - reach, at[0] + reach, at[1] + reach]
        };
        Self { taken: marks.iter().map(around).collect(), routes }
    }

    /// Names never cover this box either: left, top, right, bottom.
    pub(super) fn keep_free(&mut self, area: [f64; 4]) {
        self.taken.push(area);
    }

    /// A name beside its mark, inside the map; `None` if there is no room.
    pub(super) fn place(&mut self, name: &str, at: [f64; 2], view: &View) -> Option<Group> {
        let (font, unit) = (view.measure.font, view.measure.unit);
        let map = view.map.map(f64::from);
        let pad = 0.25 * font;
        let name = text::fit(name, font, (map[0] - 4.0 * pad).min(20.0 * font));
        let size = [width_px(&name, font) + 2.0 * pad, CAPITALS_EM * font + 4.0 * pad];
        let away = 10.0 * unit;
        let along = |axis: usize, side: f64| match side {
            s if s < 0.0 => at[axis] - away - size[axis],
            s if s > 0.0 => at[axis] + away,
            _ => at[axis] - size[axis] / 2.0,
        };
        const SIDES: [[f64; 2]; 8] = [
            [1.0, 0.0],
            [-1.0, 0.0],
            [0.0, -1.0],
            [0.0, 1.0],
            [1.0, -1.0],
            [1.0, 1.0],
            [-1.0, -1.0],
            [-1.0, 1.0],
        ];
        let beside = SIDES.map(|[x, y]| [along(0, x), along(1, y)]);
        // Long names above or below a mark near the edge are moved inwards.
        let moved = [[0.0, -1.0], [0.0, 1.0]]
            .map(|[x, y]| [along(0, x).clamp(0.0, (map[0] - size[0]).max(0.0)), along(1, y)]);
        let boxed = |[x, y]: [f64; 2]| [x, y, x + size[0], y + size[1]];
        let is_free = |b: &[f64; 4]| {
            let inside = b[0] >= 0.0 && b[1] >= 0.0 && b[2] <= map[0] && b[3] <= map[1];
            inside
                && !self
                    .taken
                    .iter()
                    .any(|t| b[0] < t[2] && t[0] < b[2] && b[1] < t[3] && t[1] < b[3])
        };
        let covered = |b: &[f64; 4]| {
            let inside = |[x, y]: &&[f64; 2]| b[0] < *x && *x < b[2] && b[1] < *y && *y < b[3];
            self.routes.iter().filter(inside).count()
        };
        let places = beside.into_iter().chain(moved).map(boxed).filter(is_free);
        let found = places.min_by_key(covered).filter(|_| !name.is_empty())?;
        self.taken.push(found);
        let [x, y] = [found[0], found[1]].map(text::round);
        let ground = Rectangle::new()
            .set("x", x)
            .set("y", y)
            .set("width", text::round(size[0]))
            .set("height", text::round(size[1]))
            .set("rx", text::round(pad))
            .set("fill", PAPER)
            .set("fill-opacity", 0.88);
        let baseline = [x + pad, y + 2.0 * pad + CAPITALS_EM * font];
        Some(Group::new().add(ground).add(text::line(baseline, &name, font, Anchor::Start)))
    }
}
