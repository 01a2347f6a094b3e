//! Lines of equal margin in a picture of a radio's reach, with their decibels.
//!
//! A label stands on its line where the margins around it change least, so that the line is clear
//! there, and away from other labels, places and obstacles.

use super::legend::{CONTOUR_UNITS, Ramp, THIN_OPACITY, THIN_UNITS};
use super::palette::{self, INK};
use super::stroke::stroke;
use super::text::{self, Anchor, CAPITALS_EM, width_px};
use super::view::View;
use crate::comms::Margins;
use maps::Bitmap;
use maps::numbers::metres;
use math::scalar::wide;
use plan_format::{Cell, Grid};
use std::fmt::Write;
use svg::node::element::Group;

/// The margins of a grid.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub(super) grid: &'a Grid,
    pub(super) margins: &'a Margins,
    /// Cells that a robot cannot enter.
    pub(super) blocked: &'a Bitmap,
    /// The margin of the strong line, dB.
    pub(super) threshold_db: f64,
}

/// Lines and labels of a picture.
pub(super) struct Isolines {
    pub(super) lines: Group,
    pub(super) labels: Group,
    /// Left, top, right and bottom of each label, pixels.
    pub(super) boxes: Vec<[f64; 4]>,
}

/// Size of labels, in multiples of the font size.
const LABEL_EM: f64 = 0.8;
/// Smallest distance between labels of different lines and of one line, in multiples of the font size.
const APART_EM: [f64; 2] = [3.0, 22.0];
/// Squares around a label over which margins are compared.
const AROUND: i64 = 3;

/// Lines between all bands, and a strong one at the threshold.
pub(super) fn draw(ground: &Ground<'_>, ramp: Ramp, view: &View, places: &[[f64; 2]]) -> Isolines {
    let unit = view.measure.unit;
    let width = ramp.bands.width_m;
    let mut labels =
        Labels { view, places, placed: Vec::new(), boxes: Vec::new(), drawn: Group::new() };
    let mut strong = String::new();
    let threshold_db = ground.threshold_db;
    let all = isoline(ground, threshold_db, f64::INFINITY, view, &mut strong);
    labels.place(ground, threshold_db, all);
    let mut thin = String::new();
    for index in 1..ramp.bands.count {
        let level = ramp.from + index as f64 * width;
        // At the edge of a shadow many lines would lie on each other.
        let all = isoline(ground, level, 2.0 * width, view, &mut thin);
        if level != threshold_db {
            labels.place(ground, level, all);
        }
    }
    let threshold = stroke(strong.clone(), palette::PAPER, 4.0 * unit);
    let lines = Group::new()
        .add(stroke(thin, INK, THIN_UNITS * unit).set("stroke-opacity", THIN_OPACITY))
        .add(threshold)
        .add(stroke(strong, INK, CONTOUR_UNITS * unit));
    Isolines { lines, labels: labels.drawn, boxes: labels.boxes }
}

/// A short piece of a line.
struct Piece {
    /// Its middle, pixels.
    at: [f64; 2],
    /// The cell beside it.
    cell: Cell,
}

/// Adds the line of one margin to a path: marching squares between the centres of cells, where a
/// square's margins differ by at most `steepest_db`. Returns its pieces.
fn isoline(
    ground: &Ground<'_>,
    level_db: f64,
    steepest_db: f64,
    view: &View,
    path: &mut String,
) -> Vec<Piece> {
    let grid = ground.grid;
    let step = view.step();
    let mut pieces = Vec::new();
    for row in (0..grid.rows.saturating_sub(step[1])).step_by(step[1] as usize) {
        for column in (0..grid.columns.saturating_sub(step[0])).step_by(step[0] as usize) {
            // Around the square, from its south-west corner.
            let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[right, up]: [u32; 2]| {
                Cell::new(column + right * step[0], row + up * step[1])
            });
            let margins = corners.map(|cell| f64::from(ground.margins.at(cell)));
            let highest = margins.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let lowest = margins.iter().copied().fold(f64::INFINITY, f64::min);
            let is_hidden = corners.iter().all(|cell| ground.blocked.get(*cell));
            if is_hidden || !(lowest < level_db && level_db <= highest) {
                continue;
            }
            if highest - lowest > steepest_db {
                continue;
            }
            let crossing = |side: usize| {
                let (a, b) = (margins[side], margins[(side + 1) % 4]);
                let [from, to] = [corners[side], corners[(side + 1) % 4]].map(|c| grid.centre(c));
                let share = (level_db - a) / (b - a);
                let at = [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * share);
                ((a < level_db) != (b < level_db)).then(|| view.place(at).map(text::round))
            };
            let crossings: Vec<[f64; 2]> = (0..4).filter_map(crossing).collect();
            for ends in crossings.chunks_exact(2) {
                let [[x1, y1], [x2, y2]] = [ends[0], ends[1]];
                // Writing to a string does not fail.
                let _ = write!(path, "M{x1} {y1}L{x2} {y2}");
                let at = [(x1 + x2) / 2.0, (y1 + y2) / 2.0];
                pieces.push(Piece { at, cell: corners[0] });
            }
        }
    }
    pieces
}

/// Labels that are placed one after the other.
struct Labels<'v> {
    view: &'v View,
    places: &'v [[f64; 2]],
    /// Middles and decibels.
    placed: Vec<([f64; 2], f64)>,
    boxes: Vec<[f64; 4]>,
    drawn: Group,
}

impl Labels<'_> {
    /// Labels a line along its pieces.
    fn place(&mut self, ground: &Ground<'_>, level_db: f64, pieces: Vec<Piece>) {
        let font = LABEL_EM * self.view.measure.font;
        let name = format!("{} dB", metres(level_db));
        let half = [width_px(&name, font) / 2.0 + 0.2 * font, (CAPITALS_EM / 2.0 + 0.25) * font];
        let step = self.view.step();
        let mut clear: Vec<(f64, [f64; 2])> = pieces
            .into_iter()
            .filter(|piece| {
                let map = self.view.map.map(f64::from);
                (0..2).all(|axis| {
                    piece.at[axis] > half[axis] && piece.at[axis] < map[axis] - half[axis]
                })
            })
            .filter_map(|piece| Some((unevenness(ground, piece.cell, step)?, piece.at)))
            .collect();
        clear.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])));
        for (_, at) in clear {
            let [apart, along] = APART_EM.map(|em| em * self.view.measure.font);
            let distance = |other: &[f64; 2]| wide::hypot(at[0] - other[0], at[1] - other[1]);
            let is_near = |(other, db): &([f64; 2], f64)| {
                distance(other) < if *db == level_db { along } else { apart }
            };
            let is_on_place = self.places.iter().any(|place| distance(place) < apart);
            if is_on_place || self.placed.iter().any(is_near) {
                continue;
            }
            self.placed.push((at, level_db));
            let base = [at[0], at[1] + CAPITALS_EM * font / 2.0];
            // The rim lies below the letters.
            let label = text::line(base, &name, font, Anchor::Middle)
                .set("stroke", palette::PAPER)
                .set("stroke-width", text::round(0.35 * font))
                .set("stroke-linejoin", "round")
                .set("paint-order", "stroke");
            self.drawn = std::mem::take(&mut self.drawn).add(label);
            let [x, y] = at;
            self.boxes.push([x - half[0], y - half[1], x + half[0], y + half[1]]);
        }
    }
}

/// How much the margins around a cell differ, dB, more where obstacles are near; `None` in an obstacle
/// and at the map's edge.
fn unevenness(ground: &Ground<'_>, cell: Cell, step: [u32; 2]) -> Option<f64> {
    /// As much as this for each blocked cell.
    const BLOCKED_DB: f64 = 10.0;
    let grid = ground.grid;
    if ground.blocked.get(cell) {
        return None;
    }
    let (mut low, mut high, mut blocked) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
    for up in -AROUND..=AROUND {
        for right in -AROUND..=AROUND {
            let column = i64::from(cell.column) + right * i64::from(step[0]);
            let row = i64::from(cell.row) + up * i64::from(step[1]);
            let cell = Cell::new(u32::try_from(column).ok()?, u32::try_from(row).ok()?);
            if cell.column >= grid.columns || cell.row >= grid.rows {
                return None;
            }
            if ground.blocked.get(cell) {
                blocked += BLOCKED_DB;
                continue;
            }
            let margin = f64::from(ground.margins.at(cell));
            (low, high) = (low.min(margin), high.max(margin));
        }
    }
    Some(high - low + blocked)
}
