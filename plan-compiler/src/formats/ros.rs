//! ROS map_server and Nav2 maps: a YAML file that names an image of the cells.
//!
//! Source: the map_server documentation of ROS 1 and of Nav2. With p = (255 - grey) / 255, or
//! grey / 255 where `negate` is set, a pixel is occupied if p >= occupied_thresh and free if
//! p <= free_thresh (Nav2's comparisons; ROS 1 leaves the thresholds themselves out), else
//! unknown. Colours count as the mean of red, green and blue. Mode `scale` reads what lies
//! between as a probability; no plan can drive on that, so it is unknown here too, and so are
//! transparent pixels. Mode `raw` takes the grey as a percentage of occupancy, above 100
//! unknown, and compares it with the same thresholds.
//!
//! The image's last row is the southernmost. `origin` is the south-west corner of its
//! south-west pixel and the angle by which the whole image is turned about it.
//! Deliberately absent: speed and keep-out filters, which are maps of their own.

mod image;
mod settings;
#[cfg(test)]
mod tests;

use super::turn::turned;
use crate::bitmap::Bitmap;
use crate::map::{CellMap, Map, Unknown};
use crate::problem::{Problem, Source};
use image::Grey;
pub(super) use image::refuse_alone;
use plan_format::Cell;
use settings::{Mode, Settings};
use std::path::Path;
use std::sync::Arc;

/// What `--help` says of this format.
pub const CONVENTIONS: &str = "\
ROS      (map_server, Nav2: .yaml with .pgm or .png) `image` is relative to the YAML file.
         p = (255 - grey) / 255, or grey / 255 with negate; p >= occupied_thresh is
         occupied, p <= free_thresh free, the rest unknown. Mode scale: what lies between
         and what is transparent is unknown. Mode raw: grey is a percentage, above 100
         unknown. Unknown cells block unless --unknown free. `origin` is the south-west
         corner and a yaw: quarter turns are exact; by other angles a cell is blocked if it
         overlaps a blocked pixel. No goals: give --goal.";

/// Whether a text reads like such a YAML file.
pub fn recognises(text: &str) -> bool {
    let has = |key: &str| {
        let mut lines = text.lines().filter_map(|line| line.strip_prefix(key));
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
    // In the order of the file, whichever check found them.
    problems
        .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |place| place.span.start));
    let (Some(grey), Some(resolution_m), Some(origin)) =
        (grey, settings.resolution_m, settings.origin)
    else {
        return (None, problems);
    };
    let cells = cells(&grey, &settings, resolution_m, [origin[0], origin[1]]);
    let (cells, boundary) = turned(cells, origin[2]);
    (Some(Map { boundary, ..Map::of_cells(cells) }), problems)
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

/// What a pixel means: its lightness, 0 to 1, and whether any of what lies behind it shows.
fn kind(settings: &Settings, (light, is_transparent): (f64, bool)) -> Kind {
    let occupancy = match settings.mode {
        Mode::Raw => (light * 255.0).round() / 100.0,
        _ if settings.negate => light,
        _ => 1.0 - light,
    };
    let hides = settings.mode == Mode::Scale && is_transparent;
    if hides || (settings.mode == Mode::Raw && occupancy > 1.0) {
        Kind::Unknown
    } else if occupancy >= settings.occupied_thresh {
        Kind::Occupied
    } else if occupancy <= settings.free_thresh {
        Kind::Free
    } else {
        Kind::Unknown
    }
}
