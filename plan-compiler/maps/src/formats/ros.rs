//! ROS map_server and Nav2 maps: a YAML file that names an image of the cells.
//!
//! Source: the map_server documentation of ROS 1 and of Nav2. With p = (255 - grey) / 255, or
//! grey / 255 where `negate` is set, a pixel is occupied if p >= occupied_thresh and free if
//! p <= free_thresh (Nav2's comparisons; ROS 1 leaves the thresholds themselves out), else
//! unknown. The lightness of a colour is the mean of red, green and blue. In every mode a
//! pixel that is not opaque is unknown: its colour is an artefact of the image editor. Mode `scale`
//! reads values between the thresholds as probabilities; a plan needs a decision, so they are
//! unknown here too. Mode `raw` takes the grey as a percentage of occupancy (above 100 unknown) and
//! compares it with the same thresholds.
//!
//! The image's last row is the southernmost. `origin` is the south-west corner of its south-west
//! pixel, and the image's angle of rotation about that corner.
//! [`shades`] reads such a file as numbers instead of kinds, for masks and costs.
//! Deliberately absent: keep-out masks, which are separate maps that a mission names.

mod image;
mod settings;
mod shades;
#[cfg(test)]
mod tests;

use super::turn::turned;
use crate::bitmap::Bitmap;
use crate::model::{CellMap, Map, Unknown};
use crate::problem::{Problem, Source};
use image::Grey;
pub(super) use image::refuse_alone;
use math::Cell;
use settings::{Mode, Settings};
pub use shades::{DARKEST, Numbers, Shades, read_shades};
use std::path::Path;
use std::sync::Arc;

/// This format in `--help`.
pub const CONVENTIONS: &str = "\
ROS      (map_server, Nav2: .yaml with .pgm, .png or .bmp) `image` is relative to the YAML
         file. p = (255 - grey) / 255, or grey / 255 with negate; p >= occupied_thresh is
         occupied, p <= free_thresh free; all other pixels and those that are not opaque are
         unknown. Mode scale: the same. Mode raw: grey is a percentage, above 100 unknown.
         Unknown cells block unless --unknown free. `origin` is the south-west corner and a
         yaw: quarter turns are exact; by other angles a cell is blocked if it overlaps a
         blocked pixel. No goals: give --goal.";

/// Whether a text looks like such a YAML file.
pub fn recognises(text: &str) -> bool {
    let has = |key: &str| {
        let mut lines = text.split(['\n', '\r']).filter_map(|line| line.strip_prefix(key));
        lines.any(|rest| rest.trim_start().starts_with(':'))
    };
    has("image") && (has("resolution") || has("origin") || has("occupied_thresh"))
}

/// Reads a map and its image: the cells if both could be read, and every mistake.
pub fn read(path: &Path, source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let mut problems = Vec::new();
    let settings = settings::parse(source, &mut problems);
    let grey = settings.image.as_ref().and_then(|name| {
        image::read(path, source, name).map_err(|problem| problems.push(problem)).ok()
    });
    // In the order of the file.
    problems
        .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |place| place.span.start));
    let (Some(grey), Some(resolution_m), Some(origin)) =
        (grey, settings.resolution_m, settings.origin)
    else {
        return (None, problems);
    };
    problems.extend(freed(&grey, &settings, source));
    let cells = cells(&grey, &settings, resolution_m, [origin[0], origin[1]]);
    let limit = math::grid::MAX_SIDE_CELLS;
    let Some((cells, boundary)) = turned(cells, origin[2], limit) else {
        problems.push(too_large_turned(&grey, limit));
        return (None, problems);
    };
    (Some(Map { boundary, files: vec![grey.path], ..Map::of_cells(cells) }), problems)
}

/// Occupancy that map savers write for unknown cells.
const UNKNOWN_PIXEL: (f64, bool) = (205.0 / 255.0, false);

/// A warning if cells that a saver marked unknown count as free. Its grey is just unknown by the
/// threshold of ROS 1, 0.196, and free by that of Nav2, 0.25.
fn freed(grey: &Grey, settings: &Settings, source: &Arc<Source>) -> Option<Problem> {
    let is_free = kind(settings, UNKNOWN_PIXEL) == Kind::Free;
    if !is_free || settings.mode != Mode::Trinary || settings.negate {
        return None;
    }
    let pixels = (0..grey.rows).flat_map(|row| (0..grey.columns).map(move |column| (column, row)));
    let is_unknown = |&(column, row): &(u32, u32)| grey.pixel(column, row) == UNKNOWN_PIXEL;
    let count = pixels.filter(is_unknown).count();
    let free = settings.free_thresh;
    let warning = Problem::warning(format!(
        "{count} cells of grey 205, which map savers write for unknown, are free because \
         free_thresh is {free}"
    ))
    .help("write `free_thresh: 0.196` if these cells are unknown");
    let place = settings.free_thresh_span.clone();
    let warning = match place {
        Some(span) => warning.at(source, span, "grey 205 has occupancy 0.196, which is below"),
        None => warning,
    };
    (count > 0).then_some(warning)
}

fn too_large_turned(grey: &Grey, limit: u32) -> Problem {
    let (columns, rows) = (grey.columns, grey.rows);
    Problem::error(format!(
        "rotated by its yaw, the image of {columns} x {rows} pixels has more than {limit} cells a side"
    ))
    .help("turn the image itself and write a yaw of 0, or crop it to the area that the robot uses")
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Free,
    Occupied,
    Unknown,
}

fn cells(grey: &Grey, settings: &Settings, resolution_m: f64, corner: [f64; 2]) -> CellMap {
    let (columns, rows) = (grey.columns, grey.rows);
    let mut occupied = Bitmap::new(columns, rows);
    let mut unknown = Bitmap::new(columns, rows);
    for row in 0..rows {
        for column in 0..columns {
            let cell = Cell::new(column, row);
            // The image's first row is the northernmost.
            match kind(settings, grey.pixel(column, rows - 1 - row)) {
                Kind::Free => {}
                Kind::Occupied => occupied.set(cell, true),
                Kind::Unknown => unknown.set(cell, true),
            }
        }
    }
    let unknown_as = Unknown::default();
    CellMap { resolution_m, corner, occupied, unknown, unknown_as, turned_from: None }
}

/// The grey of a lightness, 0 to 255.
fn grey_of(light: f64) -> f64 {
    (light * 255.0).round()
}

/// The share of occupancy of a lightness; above 1 in mode `raw` where it is unknown.
fn occupancy(settings: &Settings, light: f64) -> f64 {
    match settings.mode {
        Mode::Raw => grey_of(light) / 100.0,
        _ if settings.negate => light,
        _ => 1.0 - light,
    }
}

/// The kind of a pixel with this lightness, 0 to 1, and transparency.
fn kind(settings: &Settings, (light, is_transparent): (f64, bool)) -> Kind {
    let occupancy = occupancy(settings, light);
    if is_transparent || (settings.mode == Mode::Raw && occupancy > 1.0) {
        Kind::Unknown
    } else if occupancy >= settings.occupied_thresh {
        Kind::Occupied
    } else if occupancy <= settings.free_thresh {
        Kind::Free
    } else {
        Kind::Unknown
    }
}
