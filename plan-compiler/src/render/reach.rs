//! A picture of where radio reaches: bands of the margin in dB, lines between them, the threshold,
//! obstacles and places.

use super::cells::{Bands, indexed, under};
use super::isolines;
use super::legend::{Entry, Ramp, Symbol};
use super::marks::{self, Mark, Names};
use super::palette::{self, ATTENUATING, BLOCKED, INK, OBSTACLE};
use super::scale::round_number_above;
use super::sheet::{self, Contents, Sheet};
use super::view::View;
use super::{assembled, frame, hatch_px, text};
use crate::comms::Margins;
use crate::field;
use maps::numbers::metres;
use maps::{Bitmap, Feature, Point, Role};
use math::scalar::wide;
use plan_format::Grid;
use svg::node::element::{Group, Image};

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Reach<'a> {
    /// Title of the picture.
    pub title: &'a str,
    /// The grid of the margins.
    pub grid: &'a Grid,
    /// The map's heading, radians clockwise from north, if it is known.
    pub heading_rad: Option<f64>,
    /// The margins.
    pub margins: &'a Margins,
    /// Cells below this are out of reach, dB.
    pub threshold_db: f64,
    /// Cells that a robot cannot enter.
    pub blocked: &'a Bitmap,
    /// The map's shapes.
    pub features: &'a [Feature],
    /// The places.
    pub places: &'a [(String, Point)],
}

/// The margins of a map as SVG; the longer side has at most `size_px` pixels.
pub fn reach(reach: &Reach<'_>, size_px: u32) -> String {
    let ramp = ramp(reach);
    let entries = entries(reach, ramp);
    let title_px = sheet::title_px(reach.title, size_px);
    let contents = Contents { grid: reach.grid, panels: 1, title_px, legend: &entries };
    let sheet = Sheet::new(&contents, size_px);
    let view = &sheet.view;
    let places: Vec<[f64; 2]> = reach.places.iter().map(|(_, at)| view.place(*at)).collect();
    let ground = isolines::Ground {
        grid: reach.grid,
        margins: reach.margins,
        blocked: reach.blocked,
        threshold_db: reach.threshold_db,
    };
    let isolines = isolines::draw(&ground, ramp, view, &places);
    let map = Group::new()
        .set("clip-path", "url(#map)")
        .add(cells(reach, ramp, view, hatch_px(&sheet)))
        .add(isolines.lines)
        .add(marks::shapes(reach.features, view));
    let mut over = isolines.labels;
    for at in &places {
        over = over.add(Mark::End.draw(*at, view.measure.unit));
    }
    let mut names = Names::new(&places, Vec::new(), view.measure.unit);
    isolines.boxes.into_iter().for_each(|label| names.keep_free(label));
    for ((name, _), at) in reach.places.iter().zip(&places) {
        if let Some(name) = names.place(name, *at, view) {
            over = over.add(name);
        }
    }
    let drawn = Group::new().add(map).add(over).add(frame(&sheet, reach.title));
    assembled(&sheet, reach.title, vec![drawn], &entries)
}

/// The characters in the names of places that the font lacks, which a PNG shows as boxes.
pub fn lacking_in(names: &[(String, Point)]) -> String {
    let names: String = names.iter().map(|(name, _)| name.as_str()).collect();
    text::lacking(&names).collect::<std::collections::BTreeSet<char>>().into_iter().collect()
}

/// Bands of a round width that cover the margins of all cells that are not blocked.
fn ramp(reach: &Reach<'_>) -> Ramp {
    let free = field::cells(reach.grid).filter(|cell| !reach.blocked.get(*cell));
    let margins = free.map(|cell| f64::from(reach.margins.at(cell)));
    let (low, high) = margins.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), margin| {
        (low.min(margin), high.max(margin))
    });
    // Without a free cell there is nothing to show but the threshold.
    let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
    let width = round_number_above((high - low).max(1.0) / (super::cells::MAX_BANDS - 1) as f64);
    let from = wide::floor(low / width) * width;
    let count = (wide::floor((high - from) / width) as usize + 1).max(1);
    Ramp {
        title: "margin of the link, dB",
        from,
        bands: Bands { width_m: width, count },
        is_falling: true,
    }
}

/// The entries of the legend.
fn entries(reach: &Reach<'_>, ramp: Ramp) -> Vec<Entry> {
    let mut entries = vec![Entry::Bands(ramp), Entry::Scale, Entry::North(reach.heading_rad)];
    let mut item = |symbol, text: String| entries.push(Entry::Item(symbol, text));
    let threshold = metres(reach.threshold_db);
    item(Symbol::Isoline, "equal margin, dB".into());
    item(Symbol::Contour, format!("threshold, {threshold} dB"));
    item(Symbol::Shaded, format!("out of reach, below {threshold} dB"));
    item(Symbol::Mark(Mark::End), "place".into());
    let has = |role: Role| reach.features.iter().any(|feature| feature.role == role);
    if has(Role::Obstacle) {
        item(Symbol::Fill(OBSTACLE, 1.0), "obstacle".into());
    }
    if has(Role::Attenuating) {
        item(Symbol::Fill(ATTENUATING, marks::ATTENUATING_OPACITY), "weakens radio".into());
    }
    if has(Role::Zone) {
        item(Symbol::Edge(palette::ZONE), "zone".into());
    }
    if reach.blocked.count() > 0 {
        let text = if has(Role::Obstacle) { "too close for the robot" } else { "blocked" };
        item(Symbol::Fill(BLOCKED, 1.0), text.into());
    }
    entries
}

/// The cells as an image: colours of the bands, hatched where radio does not reach.
fn cells(reach: &Reach<'_>, ramp: Ramp, view: &View, hatch_px: u32) -> Image {
    let count = ramp.bands.count;
    let mut colours: Vec<u8> = (0..count).flat_map(|index| ramp.colour(index)).collect();
    colours.extend([INK, BLOCKED].into_iter().flat_map(palette::rgb));
    indexed(view.map, colours, |x, y| {
        let cell = under(reach.grid, view.map, x, y);
        let margin = f64::from(reach.margins.at(cell));
        let is_line = margin < reach.threshold_db && (x + y) % hatch_px < hatch_px.div_ceil(6);
        match reach.blocked.get(cell) {
            true => count as u8 + 1,
            false if is_line => count as u8,
            false => ramp.index(margin) as u8,
        }
    })
}
