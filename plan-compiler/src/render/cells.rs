//! Cells as few rectangles: sampled, sorted into bands of cost, joined.

use super::round_number_below;
use plan_format::grid::cost_metres;
use plan_format::{Answer, Cell, Grid, Layer};
use std::fmt::Write;
use svg::node::element::{Group, Path};

/// Bands of cost, at most: more cannot be told apart.
const MAX_BANDS: usize = 24;
/// Colours of cost, from the goal to the farthest cell, between which bands are mixed.
const RAMP: [[f64; 3]; 4] =
    [[255.0, 250.0, 220.0], [203.0, 232.0, 196.0], [134.0, 192.0, 206.0], [86.0, 130.0, 184.0]];

/// What a sample is drawn as: a band of cost from 0, or one of these.
type Class = u8;
const NO_ROUTE: Class = u8::MAX - 1;
const BLOCKED: Class = u8::MAX;

/// A layer at the picture's resolution.
pub(super) struct Sampled {
    columns: u32,
    rows: u32,
    cells_per_sample: u32,
    classes: Vec<Class>,
    bands: usize,
    band_m: f64,
}

impl Sampled {
    /// Samples squares of `step` cells. A square is blocked if any of its cells is, so that
    /// thin walls stay; otherwise it costs what the first of its cells with a route does.
    pub(super) fn new(grid: &Grid, layer: &Layer<'_>, step: u32) -> Self {
        let (columns, rows) = (grid.columns.div_ceil(step), grid.rows.div_ceil(step));
        let mut costs = Vec::with_capacity(columns as usize * rows as usize);
        for row in 0..rows {
            for column in 0..columns {
                costs.push(sample(layer, Cell::new(column * step, row * step), step));
            }
        }
        let farthest = costs.iter().filter_map(|cost| cost.ok()).max().unwrap_or(0);
        let farthest_m = cost_metres(farthest, grid.resolution_m).max(grid.resolution_m);
        // Round numbers are at most 2.5 times apart, so there are at least ten bands.
        let band_m = 2.5 * farthest_m / MAX_BANDS as f64;
        let band_m = round_number_below(band_m);
        let class = |cost: &Result<u32, Class>| match *cost {
            Ok(cost) => (cost_metres(cost, grid.resolution_m) / band_m) as Class,
            Err(class) => class,
        };
        let bands = (farthest_m / band_m) as usize + 1;
        let classes = costs.iter().map(class).collect();
        Self { columns, rows, cells_per_sample: step, classes, bands, band_m }
    }

    /// Width of a band, metres.
    pub(super) fn band_m(&self) -> f64 {
        self.band_m
    }

    /// One path a class.
    pub(super) fn draw(&self, no_route: &str, blocked: &str) -> Group {
        let mut paths = vec![String::new(); usize::from(Class::MAX) + 1];
        self.join(|class, [x, y, width, height]| {
            let path = &mut paths[usize::from(class)];
            let _ = write!(path, "M{x} {y}h{width}v{height}h-{width}z");
        });
        // Without smoothing there are no seams between neighbours.
        let mut group = Group::new().set("shape-rendering", "crispEdges");
        for (class, path) in paths.into_iter().enumerate().filter(|(_, path)| !path.is_empty()) {
            let colour = match class as Class {
                NO_ROUTE => no_route.to_owned(),
                BLOCKED => blocked.to_owned(),
                _ => mixed(class as f64 / self.bands.max(2) as f64, class % 2 == 1),
            };
            group = group.add(Path::new().set("d", path).set("fill", colour));
        }
        group
    }

    /// Calls `emit` with the column, row, width and height in cells of rectangles that cover
    /// all samples, each of one class: runs of a row, grown over rows with the same run.
    fn join(&self, mut emit: impl FnMut(Class, [u32; 4])) {
        let mut open: Vec<Run> = Vec::new();
        for row in 0..=self.rows {
            let runs = self.runs(row);
            let mut grown = Vec::with_capacity(runs.len());
            let mut above = open.iter().peekable();
            for run in runs {
                while above.next_if(|old| old.start < run.start).is_some() {}
                let same = above.peek().filter(|old| {
                    (old.start, old.end, old.class) == (run.start, run.end, run.class)
                });
                grown.push(Run { first_row: same.map_or(row, |old| old.first_row), ..run });
            }
            for old in &open {
                if grown.binary_search_by_key(&old.start, |run| run.start).map_or(true, |at| {
                    (grown[at].first_row, grown[at].end) != (old.first_row, old.end)
                }) {
                    let step = self.cells_per_sample;
                    let (width, height) = (old.end - old.start, row - old.first_row);
                    emit(old.class, [old.start, old.first_row, width, height].map(|n| n * step));
                }
            }
            open = grown;
        }
    }

    /// The runs of equal samples of a row; none beyond the last row.
    fn runs(&self, row: u32) -> Vec<Run> {
        let columns = self.columns as usize;
        let row_start = row as usize * columns;
        let samples = self.classes.get(row_start..row_start + columns).unwrap_or_default();
        let mut start = 0;
        let runs = samples.chunk_by(|a, b| a == b).map(|run| {
            let from = start;
            start += run.len() as u32;
            Run { start: from, end: start, class: run[0], first_row: row }
        });
        runs.collect()
    }
}

/// Equal samples side by side, since a row.
#[derive(Clone, Copy)]
struct Run {
    start: u32,
    end: u32,
    class: Class,
    first_row: u32,
}

/// The cost of a square of cells, or how it is drawn without one.
fn sample(layer: &Layer<'_>, corner: Cell, step: u32) -> Result<u32, Class> {
    let mut found = Err(NO_ROUTE);
    for row in corner.row..corner.row + step {
        for column in corner.column..corner.column + step {
            match layer.look_up(Cell::new(column, row)) {
                Answer::Blocked { .. } => return Err(BLOCKED),
                Answer::Move { cost, .. } => found = found.or(Ok(cost)),
                Answer::Goal => found = Ok(0),
                Answer::NoRoute | Answer::OffMap => {}
            }
        }
    }
    found
}

/// The ramp's colour at 0 to 1. Every other band is a little darker, so that its edges show.
fn mixed(at: f64, darker: bool) -> String {
    let shade = if darker { 0.96 } else { 1.0 };
    let scaled = at.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let below = (scaled as usize).min(RAMP.len() - 2);
    let part = scaled - below as f64;
    let channel = |c: usize| {
        ((RAMP[below][c] + (RAMP[below + 1][c] - RAMP[below][c]) * part) * shade).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_cover_every_sample_once() {
        let columns = 13;
        // A pattern with blocks, stripes and noise.
        let classes: Vec<Class> = (0..columns * 11)
            .map(|i| {
                let (x, y) = (i % columns, i / columns);
                if x < 4 {
                    1
                } else if y % 3 == 0 {
                    2
                } else {
                    (x * 7 + y * 5) as Class % 3
                }
            })
            .collect();
        let sampled = Sampled {
            columns,
            rows: 11,
            cells_per_sample: 1,
            classes: classes.clone(),
            bands: 3,
            band_m: 1.0,
        };
        let mut covered = vec![0; classes.len()];
        let mut rectangles = 0;
        sampled.join(|class, [x, y, width, height]| {
            rectangles += 1;
            for row in y..y + height {
                for column in x..x + width {
                    let index = (row * columns + column) as usize;
                    assert_eq!(classes[index], class);
                    covered[index] += 1;
                }
            }
        });
        assert!(covered.iter().all(|&times| times == 1));
        assert!(rectangles < classes.len());
    }

    #[test]
    fn the_ramp_begins_and_ends_with_its_colours() {
        assert_eq!(mixed(0.0, false), "#fffadc");
        assert_eq!(mixed(1.0, false), "#5682b8");
        assert_eq!(mixed(7.0, true), "#537db1");
    }
}
