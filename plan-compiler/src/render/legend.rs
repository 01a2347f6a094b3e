//! The legend: the meaning of colours, lines and marks, the scale, and north.

use super::borders;
use super::cells::{Bands, MAX_BANDS};
use super::marks::{self, Mark};
use super::palette::{self, ADVICE, HATCH, INK, PAPER, TOLL};
use super::scale::round_number_below;
use super::stroke::{dashes, stroke};
use super::text::{self, Anchor, CAPITALS_EM, width_px};
use super::texture::{self, Density};
use super::view::{Measure, View};
use maps::numbers::metres;
use math::scalar::wide;
use svg::node::element::{Group, Rectangle};

/// An entry of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Entry {
    /// Coloured bands of a quantity.
    Bands(Ramp),
    /// The scale bar.
    Scale,
    /// The north arrow: the map's heading, radians clockwise from north, if known.
    North(Option<f64>),
    /// A symbol and what it means.
    Item(Symbol, String),
}

/// Coloured bands of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp {
    /// The quantity and its unit.
    pub(super) title: &'static str,
    /// Where the first band begins.
    pub(super) from: f64,
    pub(super) bands: Bands,
    /// Whether the dark end of the colours is at the low end.
    pub(super) is_falling: bool,
}

impl Ramp {
    /// Costs to the goal.
    pub(super) fn of_costs(bands: Bands) -> Self {
        Self { title: "cost to the goal, m", from: 0.0, bands, is_falling: false }
    }

    /// The band of a value.
    pub(super) fn index(&self, value: f64) -> usize {
        self.bands.of((value - self.from).max(0.0))
    }

    /// The colour of a band.
    pub(super) fn colour(&self, index: usize) -> [u8; 3] {
        let count = self.bands.count;
        palette::band(if self.is_falling { count - 1 - index } else { index }, count)
    }
}

/// The symbol beside an explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Symbol {
    /// An area of a colour with an opacity.
    Fill(&'static str, f64),
    /// An area with a dashed edge.
    Edge(&'static str),
    /// Cells without a route.
    Hatch,
    /// Cells with a toll, by its level.
    Dots(Density),
    /// Cells out of a radio's reach.
    Shaded,
    /// The line at a threshold.
    Contour,
    /// A line of equal values.
    Isoline,
    /// The border between the areas of several goals.
    Border,
    /// An arrow of the advice.
    Arrow,
    /// A route.
    Line(usize),
    /// A mark.
    Mark(Mark),
}

/// Width of the line at a threshold, units.
pub(super) const CONTOUR_UNITS: f64 = 2.0;
/// Width of a line of equal values, units, and its opacity.
pub(super) const THIN_UNITS: f64 = 0.9;
pub(super) const THIN_OPACITY: f64 = 0.6;

// Sizes in multiples of the font size.
const BANDS_EM: [f64; 2] = [15.0, 3.9];
const SCALE_EM: [f64; 2] = [10.0, 3.0];
const NORTH_EM: [f64; 2] = [3.0, 3.0];
const ITEM_EM: f64 = 1.65;
const SYMBOL_EM: f64 = 2.5;
/// Largest width of an explanation.
const TEXT_EM: f64 = 18.0;
/// Gaps between columns and between rows.
const GAP_EM: [f64; 2] = [1.2, 0.4];

/// Entries placed from left to right and from top to bottom.
#[derive(Clone, Debug)]
pub(super) struct Flow {
    pub(super) places: Vec<[f64; 2]>,
    pub(super) size: [f64; 2],
}

impl Entry {
    /// Width and height; all items have the same width, so that they form columns.
    fn size(&self, item_px: f64, font: f64) -> [f64; 2] {
        match self {
            Self::Bands(_) => BANDS_EM.map(|em| em * font),
            Self::Scale => SCALE_EM.map(|em| em * font),
            Self::North(_) => NORTH_EM.map(|em| em * font),
            Self::Item(..) => [item_px, ITEM_EM * font],
        }
    }

    /// Width of an item.
    fn item_px(&self, font: f64) -> f64 {
        match self {
            Self::Item(_, text) => {
                SYMBOL_EM * font + width_px(&text::clean(text), font).min(TEXT_EM * font)
            }
            _ => 0.0,
        }
    }
}

impl Flow {
    /// Places entries within a width; a single entry may exceed it.
    pub(super) fn new(entries: &[Entry], width: f64, measure: Measure) -> Self {
        let font = measure.font;
        let gap = GAP_EM.map(|em| em * font);
        let item_px = entries.iter().map(|entry| entry.item_px(font)).fold(0.0, f64::max);
        let (mut x, mut y, mut row_height) = (0.0, 0.0, 0.0_f64);
        let mut flow = Self { places: Vec::new(), size: [0.0, 0.0] };
        let mut was_item = false;
        for entry in entries {
            let [entry_width, height] = entry.size(item_px, font);
            let is_item = matches!(entry, Entry::Item(..));
            // Items begin a row, so that their columns are straight.
            if x > 0.0 && (x + entry_width > width || is_item != was_item) {
                (x, y, row_height) =
                    (0.0, y + row_height + if is_item && was_item { 0.0 } else { gap[1] }, 0.0);
            }
            was_item = is_item;
            flow.places.push([x, y]);
            row_height = row_height.max(height);
            flow.size = [flow.size[0].max(x + entry_width), y + row_height];
            x += entry_width + gap[0];
        }
        flow
    }
}

/// An entry at its place.
pub(super) fn draw(entry: &Entry, at: [f64; 2], view: &View) -> Group {
    let group = match entry {
        Entry::Bands(ramp) => draw_bands(*ramp, view.measure),
        Entry::Scale => draw_scale(view),
        Entry::North(heading_rad) => draw_north(*heading_rad, view.measure),
        Entry::Item(symbol, text) => draw_item(*symbol, text, view.measure),
    };
    group.set("transform", format!("translate({} {})", text::round(at[0]), text::round(at[1])))
}

fn draw_bands(ramp: Ramp, measure: Measure) -> Group {
    let bands = ramp.bands;
    let (font, width) = (measure.font, BANDS_EM[0] * measure.font);
    // Half a label extends beyond either end.
    let label = |index: usize| metres(ramp.from + index as f64 * bands.width_m);
    let widest = width_px(&label(0), font).max(width_px(&label(bands.count), font));
    let side = widest / 2.0;
    let each = (width - 2.0 * side) / bands.count as f64;
    let top = 1.5 * font;
    let mut group =
        Group::new().add(text::line([0.0, CAPITALS_EM * font], ramp.title, font, Anchor::Start));
    for index in 0..bands.count {
        let colour = palette::hex(ramp.colour(index));
        let x = side + index as f64 * each;
        group = group.add(area(x, top, each, font).set("fill", colour));
    }
    let frame = area(side, top, each * bands.count as f64, font).set("fill", "none");
    group = group.add(frame.set("stroke", INK).set("stroke-width", text::round(measure.unit)));
    let every = ((2.0 * side + 0.7 * font) / each).ceil().max(1.0) as usize;
    for index in (0..=bands.count).step_by(every) {
        let x = side + index as f64 * each;
        let at = [x, top + 1.4 * font + CAPITALS_EM * font];
        let tick =
            format!("M{} {}v{}", text::round(x), text::round(top + font), text::round(0.25 * font));
        group = group.add(stroke(tick, INK, measure.unit)).add(text::line(
            at,
            &label(index),
            font,
            Anchor::Middle,
        ));
    }
    group
}

fn draw_scale(view: &View) -> Group {
    let (font, unit) = (view.measure.font, view.measure.unit);
    let px_per_m = view.cell()[0] / view.grid.resolution_m;
    let bar_m = round_number_below(0.7 * SCALE_EM[0] * font / px_per_m);
    let (bar_px, baseline) = (bar_m * px_per_m, 1.2 * font);
    let (y, half) = (text::round(baseline), text::round(0.3 * font));
    let bar = format!("M{unit} {}v{half}h{}v-{half}", y - half, text::round(bar_px));
    let stretch = view.stretch();
    let is_stretched = !(0.9..1.1).contains(&stretch);
    let note = match stretch {
        _ if !is_stretched => String::new(),
        more if more > 1.0 => format!(", y × {}", metres((more * 10.0).round() / 10.0)),
        less => format!(", x × {}", metres((10.0 / less).round() / 10.0)),
    };
    // The bar always shows the scale of x.
    let label = format!("{} m{note}", metres(bar_m));
    let at = [unit, baseline + 0.6 * font + CAPITALS_EM * font];
    Group::new().add(stroke(bar, INK, 2.0 * unit)).add(text::line(at, &label, font, Anchor::Start))
}

/// An arrow to the north, or along y if the map has no place on the globe.
fn draw_north(heading_rad: Option<f64>, measure: Measure) -> Group {
    let font = measure.font;
    let centre = NORTH_EM.map(|em| em * font / 2.0);
    // The y axis is turned clockwise from north by the heading, so north is turned the other way.
    let angle = -heading_rad.unwrap_or(0.0);
    let (sine, cosine) = (wide::sin(angle), wide::cos(angle));
    let at = |along: f64, aside: f64| {
        let (x, y) = (along * sine + aside * cosine, along * cosine - aside * sine);
        format!("{} {}", text::round(centre[0] + x * font), text::round(centre[1] - y * font))
    };
    let needle =
        |side: f64| format!("M{}L{}L{}z", at(0.55, 0.0), at(-1.25, side * 0.5), at(-0.9, 0.0));
    let label = if heading_rad.is_some() { "N" } else { "y" };
    let place = [
        centre[0] + 1.05 * font * sine,
        centre[1] - 1.05 * font * cosine + CAPITALS_EM * font / 2.0,
    ];
    let outline = |side: f64, fill: &str| {
        stroke(needle(side), INK, measure.unit).set("fill", fill).set("stroke-linejoin", "round")
    };
    Group::new().add(outline(1.0, INK)).add(outline(-1.0, PAPER)).add(text::line(
        place,
        label,
        font,
        Anchor::Middle,
    ))
}

fn draw_item(symbol: Symbol, meaning: &str, measure: Measure) -> Group {
    let (font, unit) = (measure.font, measure.unit);
    let (width, height, middle) = (1.7 * font, 1.0 * font, ITEM_EM * font / 2.0);
    let top = middle - height / 2.0;
    let frame = |colour: &str| {
        area(0.0, top, width, height).set("stroke", colour).set("stroke-width", text::round(unit))
    };
    let drawn = match symbol {
        Symbol::Fill(colour, opacity) => {
            Group::new().add(frame(colour).set("fill", colour).set("fill-opacity", opacity))
        }
        Symbol::Edge(colour) => Group::new().add(
            frame(colour)
                .set("fill", "none")
                .set("stroke-width", text::round(2.0 * unit))
                .set("stroke-dasharray", dashes(&[2.0, 1.5], 2.0 * unit)),
        ),
        Symbol::Hatch => {
            let lines = hatching([0.0, top, width, height], 6.0 * unit);
            Group::new().add(frame(HATCH).set("fill", PAPER)).add(stroke(lines, HATCH, 1.2 * unit))
        }
        Symbol::Dots(level) => {
            let ground = palette::hex(palette::band(1, MAX_BANDS));
            let dots =
                dots([0.0, top, width, height], texture::apart(level, 6.0 * unit), 1.5 * unit);
            let sample = frame(INK).set("fill", ground);
            Group::new().add(sample).add(stroke(dots, TOLL, 1.5 * unit))
        }
        Symbol::Shaded => {
            let lines = hatching([0.0, top, width, height], 6.0 * unit);
            let ground = palette::hex(palette::band(MAX_BANDS - 2, MAX_BANDS));
            Group::new().add(frame(INK).set("fill", ground)).add(stroke(lines, INK, unit))
        }
        Symbol::Isoline => {
            let path = format!("M0 {0}H{1}", text::round(middle), text::round(width));
            let line = stroke(path, INK, THIN_UNITS * unit);
            Group::new().add(line.set("stroke-opacity", THIN_OPACITY))
        }
        Symbol::Border => {
            let path = format!("M0 {0}H{1}", text::round(middle), text::round(width));
            borders::line(path, unit)
        }
        Symbol::Contour => {
            let path = format!("M0 {0}H{1}", text::round(middle), text::round(width));
            Group::new().add(stroke(path, INK, CONTOUR_UNITS * unit))
        }
        Symbol::Arrow => {
            let path = marks::arrow([width / 2.0, middle], [1.0, 0.0], 1.2 * font);
            Group::new().add(stroke(path, ADVICE, 1.3 * unit).set("stroke-linecap", "round"))
        }
        Symbol::Line(style) => {
            let path = format!("M0 {0}H{1}", text::round(middle), text::round(width));
            marks::route(&path, style, unit)
        }
        Symbol::Mark(mark) => mark.draw([width / 2.0, middle], unit),
    };
    let at = [SYMBOL_EM * font - 0.3 * font, middle + CAPITALS_EM * font / 2.0];
    let meaning = text::fit(meaning, font, TEXT_EM * font);
    drawn.add(text::line(at, &meaning, font, Anchor::Start))
}

/// Short strokes, as long as they are wide, in shifted rows within a rectangle.
fn dots([x, y, width, height]: [f64; 4], apart: f64, size: f64) -> String {
    let (across, down) = ((width / apart) as usize, (height / apart) as usize);
    let dot = |row: usize, column: usize| {
        let shift = if row.is_multiple_of(2) { 0.25 } else { 0.75 };
        let [left, middle] =
            [x + (column as f64 + shift) * apart, y + (row as f64 + 0.5) * apart].map(text::round);
        format!("M{left} {middle}h{}", text::round(size))
    };
    (0..down.max(1)).flat_map(|row| (0..across.max(1)).map(move |c| dot(row, c))).collect()
}

/// Lines from the lower left to the upper right across a rectangle.
fn hatching([x, y, width, height]: [f64; 4], apart: f64) -> String {
    let count = ((width + height) / apart) as usize;
    let line = |index: usize| {
        let along = (index as f64 + 0.5) * apart;
        let (x1, y1) = (x + (along - height).max(0.0), y + along.min(height));
        let (x2, y2) = (x + along.min(width), y + (along - width).max(0.0));
        let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(text::round);
        format!("M{x1} {y1}L{x2} {y2}")
    };
    (0..count).map(line).collect()
}

/// A rectangle with rounded coordinates.
fn area(x: f64, y: f64, width: f64, height: f64) -> Rectangle {
    let [x, y, width, height] = [x, y, width, height].map(text::round);
    Rectangle::new().set("x", x).set("y", y).set("width", width).set("height", height)
}
