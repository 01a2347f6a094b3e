//! Coverage: strips that a robot drives so that a tool of some width passes over an area (W,
//! section 2.3, names coverage as a constraint; H, figure 3, ploughs a field in strips).
//!
//! Boustrophedon cellular decomposition (Choset and Pignon 1997): parallel rows sweep the area; it
//! falls into parts where an obstacle splits or joins them; a part is driven strip by strip, back
//! and forth; then the nearest part follows.
//!
//! ```text
//! Ground (cells that the robot may enter) --rows--> spans --strips--> parts and strips
//!        --order--> a sequence of strips and the transitions between them
//! ```
//!
//! Invariants: no strip leaves the cells of its ground, and none is shorter than half a cell; where
//! there is room, none is shorter than half the width. Every point of the ground is within half the
//! width and half a cell of a strip, but for gaps that the caller leaves and corners that only a
//! shorter strip would reach. Equal input gives equal strips on every machine.
//!
//! Deliberately absent: curves between strips, which are the robot's business, and headlands: the
//! nearest strips already run along the edge where it is parallel to them.

mod area;
mod files;
mod mission;
mod order;
mod rows;
mod strips;

pub use area::{Area, Asked, Site, check_asked, check_settings, corners, site};
pub use files::{csv, geojson};
pub use mission::{Writing, mission, other_behaviours};
pub use order::Passable;

use maps::{Bitmap, Point};
use math::scalar::wide;
use plan_format::Grid;
use rayon::prelude::*;
use rows::Rows;
use strips::Layout;

/// Cells that a robot may enter.
#[derive(Clone, Debug)]
pub struct Ground {
    /// The grid of the cells.
    pub grid: Grid,
    /// The cells.
    pub cells: Bitmap,
}

/// How an area is covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Width of the tool, metres; at least a cell.
    pub width_m: f64,
    /// How far neighbouring strips overlap, metres; less than the width.
    pub overlap_m: f64,
    /// Direction of the strips, degrees counter-clockwise from east; `None` for the one that needs
    /// the fewest strips.
    pub angle_deg: Option<f64>,
    /// Gaps up to this size stay, m².
    pub leave_m2: f64,
    /// Where the robot starts.
    pub start: Point,
}

/// A line to drive with the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    /// Its first point.
    pub from: Point,
    /// Its last point.
    pub to: Point,
}

impl Strip {
    /// Its length, metres.
    pub fn length_m(&self) -> f64 {
        distance(self.from, self.to)
    }
}

/// The transition from the end of a strip to the start of the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    /// The points at which it turns, between the strips.
    pub via: Vec<Point>,
    /// Its length, metres.
    pub length_m: f64,
    /// Whether it leaves the area, because no route inside leads there.
    pub leaves: bool,
}

/// Strips in the order in which they are driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Cover {
    /// Direction of the strips, degrees counter-clockwise from east, 0 to 180.
    pub angle_deg: f64,
    /// The strips.
    pub strips: Vec<Strip>,
    /// The transitions between them: one less than strips.
    pub transitions: Vec<Transition>,
}

impl Cover {
    /// Sum of the strips' lengths, metres.
    pub fn strips_m(&self) -> f64 {
        // A plain sum of nothing is -0.
        self.strips.iter().fold(0.0, |sum, strip| sum + strip.length_m())
    }

    /// Sum of the transitions' lengths, metres.
    pub fn transitions_m(&self) -> f64 {
        self.transitions.iter().fold(0.0, |sum, transition| sum + transition.length_m)
    }

    /// Every point at which the robot may turn, from the start of the first strip to the end of the
    /// last.
    pub fn points(&self) -> Vec<Point> {
        let vias = [&[][..]]
            .into_iter()
            .chain(self.transitions.iter().map(|transition| &transition.via[..]));
        let legs = vias.zip(&self.strips);
        legs.flat_map(|(via, strip)| via.iter().copied().chain([strip.from, strip.to])).collect()
    }

    /// The transitions with both of their ends.
    pub fn transition_lines(&self) -> Vec<Vec<Point>> {
        let ends = self.strips.windows(2).map(|pair| (pair[0].to, pair[1].from));
        let line = |(transition, (from, to)): (&Transition, (Point, Point))| {
            [from].into_iter().chain(transition.via.iter().copied()).chain([to]).collect()
        };
        self.transitions.iter().zip(ends).map(line).collect()
    }

    /// Turns of more than 45 degrees from the first strip to the end of the last.
    pub fn turns(&self) -> usize {
        let mut points = self.points();
        points.dedup_by(|a, b| distance(*a, *b) < SHORT_M);
        let is_sharp = |corner: &&[Point]| {
            let [a, b, c] = [corner[0], corner[1], corner[2]];
            let (before, after) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
            let along = before[0] * after[0] + before[1] * after[1];
            let across = before[0] * after[1] - before[1] * after[0];
            along < across.abs()
        };
        points.windows(3).filter(is_sharp).count()
    }
}

/// Points closer than this are one, metres.
const SHORT_M: f64 = 1e-3;
/// Most directions that are tried where none is given.
const MAX_ANGLES: usize = 24;

/// Covers a ground. `edges` are the directions of the area's edges, degrees, among which the
/// direction of the strips is chosen.
pub fn cover(ground: &Ground, passable: Passable<'_>, edges: &[f64], settings: &Settings) -> Cover {
    let angles = match settings.angle_deg {
        Some(angle) => vec![angle],
        None => candidates(edges),
    };
    let layouts: Vec<(f64, Layout)> = angles
        .into_par_iter()
        .map(|angle| (angle, strips::lay(Rows::of(ground, angle, settings.width_m), settings)))
        .collect();
    let worth = |layout: &Layout| (layout.count(), layout.length_m());
    let best = layouts.into_iter().reduce(|best, next| {
        let (a, b) = (worth(&best.1), worth(&next.1));
        // A hair longer is not longer: then the first direction stays, on every machine.
        if b.0 < a.0 || b.0 == a.0 && b.1 < a.1 - 1e-6 { next } else { best }
    });
    let Some((angle, layout)) = best else {
        return Cover { angle_deg: 0.0, strips: Vec::new(), transitions: Vec::new() };
    };
    let (strips, transitions) = order::order(&layout, passable, settings.start);
    Cover { angle_deg: half_turn(angle), strips, transitions }
}

/// The directions of the edges, of the map's axes, and between them if there are few.
fn candidates(edges: &[f64]) -> Vec<f64> {
    let steps = (0..6).map(|step| f64::from(step) * 30.0);
    let mut angles: Vec<f64> = Vec::new();
    for angle in [0.0, 90.0].into_iter().chain(edges.iter().copied()).chain(steps) {
        let angle = half_turn(angle);
        let is_new = angles.iter().all(|other| {
            let apart = (other - angle).abs();
            apart.min(180.0 - apart) > 0.5
        });
        if is_new && angles.len() < MAX_ANGLES {
            angles.push(angle);
        }
    }
    angles
}

/// A direction as an angle from 0 to 180 degrees.
fn half_turn(degrees: f64) -> f64 {
    let turned = degrees - 180.0 * wide::floor(degrees / 180.0);
    if turned < 180.0 { turned } else { 0.0 }
}

/// The cells of a grid whose centres are within a distance of a strip.
pub fn covered(grid: &Grid, strips: &[Strip], within_m: f64) -> Bitmap {
    let mut covered = Bitmap::new(grid.columns, grid.rows);
    for strip in strips {
        let index = |axis: usize, metres: f64, cells: u32| {
            let at = wide::floor((metres - grid.corner_m[axis]) / grid.resolution_m);
            at.clamp(0.0, f64::from(cells - 1)) as u32
        };
        let [columns, rows] = [(0, grid.columns), (1, grid.rows)].map(|(axis, cells)| {
            let (a, b) = (strip.from[axis], strip.to[axis]);
            index(axis, a.min(b) - within_m, cells)..=index(axis, a.max(b) + within_m, cells)
        });
        for row in rows {
            for column in columns.clone() {
                let cell = plan_format::Cell::new(column, row);
                if distance_to(strip, grid.centre(cell)) <= within_m {
                    covered.set(cell, true);
                }
            }
        }
    }
    covered
}

/// Distance of a point from a strip, metres.
pub fn distance_to(strip: &Strip, point: Point) -> f64 {
    let along = [strip.to[0] - strip.from[0], strip.to[1] - strip.from[1]];
    let from = [point[0] - strip.from[0], point[1] - strip.from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let share = if square > 0.0 {
        ((along[0] * from[0] + along[1] * from[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    wide::hypot(from[0] - share * along[0], from[1] - share * along[1])
}

fn distance(a: Point, b: Point) -> f64 {
    wide::hypot(b[0] - a[0], b[1] - a[1])
}

#[cfg(test)]
mod tests;
