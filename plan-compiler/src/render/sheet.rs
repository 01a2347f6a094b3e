//! The layout: maps with their titles and edges, and the legend beside or below them.
//!
//! Nothing overlaps: the sizes of texts are known, and of all arrangements that fit into the
//! picture, the one with the largest maps is taken. Text and lines scale with the picture, not with
//! the map.

use super::legend::{Entry, Flow};
use super::scale::Ticks;
use super::text::width_px;
use super::view::{Measure, View, edge};
use plan_format::Grid;

/// The finished arrangement.
#[derive(Debug)]
pub(super) struct Sheet {
    pub(super) view: View,
    /// Width and height of the picture, pixels.
    pub(super) size: [f64; 2],
    /// The north-west corner of each panel's map.
    pub(super) maps: Vec<[f64; 2]>,
    /// Room for a panel's title, from the left end of its map.
    pub(super) title_px: f64,
    pub(super) ticks: [Ticks; 2],
    /// Where the legend's entries stand; none where there is no room for them.
    pub(super) legend: Option<Vec<[f64; 2]>>,
}

/// The parts to arrange.
#[derive(Clone, Copy)]
pub(super) struct Contents<'a> {
    pub(super) grid: &'a Grid,
    pub(super) panels: usize,
    /// Width of the longest title.
    pub(super) title_px: f64,
    pub(super) legend: &'a [Entry],
}

/// A map's shorter side has at least these units, and no cell has more than this part of the
/// picture.
const MIN_SIDE_UNITS: f64 = 28.0;
const MAX_CELL_PART: f64 = 1.0 / 8.0;
/// A legend that leaves the map less than this part of the picture is left out.
const MIN_MAP_PART: f64 = 0.33;
/// How much larger maps must be to be placed one below the other.
const SIDE_BY_SIDE: f64 = 1.3;
/// Widths that are tried for a legend below the maps.
const WIDTHS: u32 = 16;

/// Where a legend goes.
#[derive(Clone)]
enum Placement {
    Nowhere,
    Beside(Flow),
    Below(Flow),
}

/// Room around the maps that does not depend on their scale.
struct Around {
    size: f64,
    measure: Measure,
    /// Left, top, right and bottom of a map.
    frame: [f64; 4],
    /// Smallest width of a panel.
    least_width: f64,
}

/// One arrangement.
struct Trial {
    across: usize,
    place: Placement,
    map: [u32; 2],
    panel: [f64; 2],
    size: [f64; 2],
}

impl Sheet {
    /// The best arrangement in a picture whose longer side is at most `size_px`.
    pub(super) fn new(contents: &Contents<'_>, size_px: u32) -> Self {
        let around = Around::new(contents, size_px);
        let mut trials = around.trials(contents);
        let side = |trial: &Trial| trial.size[0].max(trial.size[1]);
        let smallest = trials.iter().map(side).fold(f64::INFINITY, f64::min);
        trials.retain(|trial| side(trial) <= around.size.max(smallest));
        let long = |trial: &Trial| f64::from(trial.map[0].max(trial.map[1]));
        let has_room = |trial: &&Trial| {
            !matches!(trial.place, Placement::Nowhere) && long(trial) >= MIN_MAP_PART * around.size
        };
        // The largest maps, preferably side by side; among equals the smallest picture.
        let worth = |trial: &&Trial| {
            let area = |[width, height]: [f64; 2]| width * height;
            let is_wide = trial.across >= contents.panels.div_ceil(trial.across);
            let preferred = if is_wide { SIDE_BY_SIDE } else { 1.0 };
            (area(trial.map.map(f64::from)) * preferred, -area(trial.size))
        };
        let largest = |a: &&Trial, b: &&Trial| {
            let (a, b) = (worth(a), worth(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        };
        // A map that is small anyway keeps its legend.
        let bare = trials.iter().filter(|trial| matches!(trial.place, Placement::Nowhere));
        let bare = bare.max_by(largest);
        let fits = |trial: &&Trial| has_room(trial) || bare.is_some_and(|b| trial.map == b.map);
        let legible = trials.iter().filter(|trial| !matches!(trial.place, Placement::Nowhere));
        let best = legible.filter(fits).max_by(largest).or(bare).unwrap_or(&trials[0]);
        around.finish(contents, best)
    }
}

impl Around {
    fn new(contents: &Contents<'_>, size_px: u32) -> Self {
        let (measure, size) = (Measure::of(size_px), f64::from(size_px));
        let font = measure.font;
        // Labels do not get much wider or narrower with the scale.
        let widest = |axis: usize| {
            let widths = [0.3, 0.6, 0.9].map(|part| {
                let edge = edge(contents.grid, axis, part * size);
                let ticks = [Ticks::beside, Ticks::stacked][axis](edge, font);
                ticks.widest_px(font)
            });
            widths.into_iter().fold(0.0, f64::max)
        };
        let label = 0.4 * font + measure.tick();
        let left = widest(1) + label;
        let frame = [left, measure.title(), 0.5 * widest(0), 1.1 * font + label];
        let most = size / contents.panels.min(3) as f64 - 2.0 * measure.margin();
        let least_width = (contents.title_px + left).min(30.0 * font).min(most);
        Self { size, measure, frame, least_width }
    }

    /// All arrangements to try; the first has no legend.
    fn trials(&self, contents: &Contents<'_>) -> Vec<Trial> {
        let room = self.size - 2.0 * self.measure.margin();
        let mut places = vec![Placement::Nowhere];
        let flow = |width| Flow::new(contents.legend, width, self.measure);
        if !contents.legend.is_empty() {
            let widths: Vec<f64> =
                (3..=WIDTHS).map(|part| room * f64::from(part) / f64::from(WIDTHS)).collect();
            let flows: Vec<Flow> = widths.into_iter().map(flow).collect();
            let fits = |flow: &&Flow| flow.size[0] <= room && flow.size[1] <= room;
            places.extend(flows.iter().filter(fits).cloned().map(Placement::Beside));
            places.extend(flows.iter().filter(fits).cloned().map(Placement::Below));
        }
        let across = 1..=contents.panels.max(1);
        let arrangements =
            across.flat_map(|across| places.iter().map(move |place| (across, place)));
        arrangements.map(|(across, place)| self.trial(contents, across, place)).collect()
    }

    /// The largest maps with `across` panels in a row and the legend in a place.
    fn trial(&self, contents: &Contents<'_>, across: usize, place: &Placement) -> Trial {
        let (margin, [left, top, right, bottom]) = (self.measure.margin(), self.frame);
        let down = contents.panels.div_ceil(across).max(1);
        let legend = match place {
            Placement::Nowhere => [0.0, 0.0],
            Placement::Beside(flow) => [flow.size[0] + margin, 0.0],
            Placement::Below(flow) => [0.0, flow.size[1] + margin],
        };
        let room = |axis: usize, panels: usize, frame: f64| {
            let gaps = margin * (panels + 1) as f64;
            ((self.size - gaps - legend[axis]) / panels as f64 - frame).max(1.0)
        };
        let room = [room(0, across, left + right), room(1, down, top + bottom)];
        let map = self.map_px(contents.grid, room);
        let least = [self.least_width, 0.0];
        let panel = [left + right + f64::from(map[0]), top + bottom + f64::from(map[1])];
        let panel = [panel[0].max(least[0]), panel[1]];
        let sum = |axis: usize, panels: usize| {
            panel[axis] * panels as f64 + margin * (panels + 1) as f64 + legend[axis]
        };
        let (mut width, mut height) = (sum(0, across), sum(1, down));
        match place {
            Placement::Nowhere => {}
            Placement::Beside(flow) => height = height.max(flow.size[1] + 2.0 * margin),
            Placement::Below(flow) => width = width.max(flow.size[0] + 2.0 * margin),
        }
        Trial {
            across,
            place: place.clone(),
            map,
            panel,
            size: [width, height].map(|side| (side - 1e-6).ceil()),
        }
    }

    /// The size of a map that has this room.
    fn map_px(&self, grid: &Grid, room: [f64; 2]) -> [u32; 2] {
        let cells = [grid.columns, grid.rows].map(f64::from);
        let largest = [room[0] / cells[0], room[1] / cells[1]];
        let cell = largest[0].min(largest[1]).min(MAX_CELL_PART * self.size);
        // Cells of whole pixels look equal; in small cells the difference is invisible.
        let cell = if cell >= 8.0 { cell.floor() } else { cell };
        [0, 1].map(|axis| {
            let least = (MIN_SIDE_UNITS * self.measure.unit).min(room[axis]);
            (cell * cells[axis] + 1e-6).max(least).floor().max(1.0) as u32
        })
    }

    fn finish(&self, contents: &Contents<'_>, trial: &Trial) -> Sheet {
        let Self { measure, frame: [left, top, ..], .. } = self;
        let margin = measure.margin();
        let view = View { grid: *contents.grid, map: trial.map, measure: *measure };
        let maps = (0..contents.panels).map(|index| {
            let (column, row) = ((index % trial.across) as f64, (index / trial.across) as f64);
            let x = margin + column * (trial.panel[0] + margin) + left;
            let y = margin + row * (trial.panel[1] + margin) + top;
            [x.round(), y.round()]
        });
        let down = contents.panels.div_ceil(trial.across).max(1) as f64;
        let corner = match &trial.place {
            Placement::Nowhere => None,
            Placement::Beside(flow) => {
                Some(([trial.size[0] - margin - flow.size[0], margin + top], flow))
            }
            Placement::Below(flow) => {
                Some(([margin, 2.0 * margin + down * (trial.panel[1] + margin) - margin], flow))
            }
        };
        let legend = corner.map(|([x, y], flow)| {
            // A high legend begins at the top.
            let y = y.min((trial.size[1] - margin - flow.size[1]).max(margin));
            flow.places.iter().map(|place| [x + place[0], y + place[1]]).collect()
        });
        let ticks =
            [Ticks::beside(view.edge(0), measure.font), Ticks::stacked(view.edge(1), measure.font)];
        let title_px = trial.panel[0] - left;
        Sheet { view, size: trial.size, maps: maps.collect(), title_px, ticks, legend }
    }
}

/// Room for a title.
pub(super) fn title_px(title: &str, size_px: u32) -> f64 {
    width_px(title, TITLE_EM * Measure::of(size_px).font)
}

/// Size of titles, in multiples of the font size.
pub(super) const TITLE_EM: f64 = 1.15;
