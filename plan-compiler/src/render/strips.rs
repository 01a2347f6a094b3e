//! A picture of strips: what they cover, what stays, the strips and the transitions between them.

use super::legend::{Entry, Symbol};
use super::marks::{self, Mark};
use super::palette::{self, ATTENUATING, BLOCKED, INK, OBSTACLE, PAPER, UNMAPPED};
use super::sheet::{self, Contents, Sheet};
use super::view::View;
use super::{assembled, cells, frame};
use maps::{Bitmap, Feature, Point, Role};
use math::scalar::wide;
use plan_format::Grid;
use std::fmt::Write;
use svg::node::element::{Group, Image};

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Strips<'a> {
    /// Title of the picture.
    pub title: &'a str,
    /// The grid of the cells.
    pub grid: &'a Grid,
    /// The map's heading, radians clockwise from north, if it is known.
    pub heading_rad: Option<f64>,
    /// Cells that a robot cannot enter.
    pub blocked: &'a Bitmap,
    /// Cells that are to be covered.
    pub wanted: &'a Bitmap,
    /// Cells that are covered.
    pub covered: &'a Bitmap,
    /// The map's shapes.
    pub features: &'a [Feature],
    /// Outlines of the area.
    pub outlines: &'a [Vec<Point>],
    /// The strips, from point to point.
    pub strips: &'a [[Point; 2]],
    /// The transitions between them.
    pub transitions: &'a [Vec<Point>],
}

/// Styles of the lines.
const STRIP: usize = 1;
const TRANSITION: usize = 0;
/// Length of the arrow in the middle of a strip, units.
const ARROW_UNITS: f64 = 13.0;

/// The strips as SVG; the longer side has at most `size_px` pixels.
pub fn strips(strips: &Strips<'_>, size_px: u32) -> String {
    let entries = entries(strips);
    let title_px = sheet::title_px(strips.title, size_px);
    let contents = Contents { grid: strips.grid, panels: 1, title_px, legend: &entries };
    let sheet = Sheet::new(&contents, size_px);
    let view = &sheet.view;
    let unit = view.measure.unit;
    let mut map = Group::new()
        .set("clip-path", "url(#map)")
        .add(ground(strips, view))
        .add(marks::shapes(strips.features, view));
    let mut outline = String::new();
    strips.outlines.iter().for_each(|ring| marks::line(ring, view, &mut outline));
    map = map.add(super::stroke(outline, palette::ZONE, 2.0 * unit));
    let mut transitions = String::new();
    strips
        .transitions
        .iter()
        .for_each(|transition| marks::line(transition, view, &mut transitions));
    let (mut lines, mut arrows) = (String::new(), String::new());
    for [from, to] in strips.strips {
        marks::line(&[*from, *to], view, &mut lines);
        arrows += &arrow(*from, *to, view);
    }
    map = map
        .add(marks::route(&transitions, TRANSITION, unit))
        .add(marks::route(&lines, STRIP, unit));
    map = map.add(super::stroke(arrows, INK, 1.6 * unit).set("stroke-linecap", "round"));
    let mut over = Group::new();
    if let (Some([first, _]), Some([_, last])) = (strips.strips.first(), strips.strips.last()) {
        over = over.add(Mark::Start.draw(view.place(*first), unit));
        over = over.add(Mark::End.draw(view.place(*last), unit));
    }
    let drawn = Group::new().add(map).add(over).add(frame(&sheet, strips.title));
    assembled(&sheet, strips.title, vec![drawn], &entries)
}

/// The arrow in the middle of a strip that has room for it.
fn arrow(from: Point, to: Point, view: &View) -> String {
    let [a, b] = [view.place(from), view.place(to)];
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (length, room) = (wide::hypot(dx, dy), ARROW_UNITS * view.measure.unit);
    let mut path = String::new();
    if length > 1.5 * room {
        let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
        // Pictures have y down, arrows y up.
        let _ = write!(path, "{}", marks::arrow(middle, [dx / length, -dy / length], room));
    }
    path
}

/// The entries of the legend.
fn entries(strips: &Strips<'_>) -> Vec<Entry> {
    let mut entries = vec![Entry::Scale, Entry::North(strips.heading_rad)];
    let mut item = |symbol, text: &str| entries.push(Entry::Item(symbol, text.into()));
    item(Symbol::Line(STRIP), "strip");
    if !strips.transitions.is_empty() {
        item(Symbol::Line(TRANSITION), "transition to the next strip");
    }
    item(Symbol::Mark(Mark::Start), "start of the first strip");
    item(Symbol::Mark(Mark::End), "end of the last strip");
    item(Symbol::Fill(COVERED, 1.0), "covered");
    if strips.wanted.iter().any(|cell| !strips.covered.get(cell)) {
        item(Symbol::Fill(UNMAPPED, 1.0), "not covered");
    }
    let has = |role: Role| strips.features.iter().any(|feature| feature.role == role);
    if has(Role::Obstacle) {
        item(Symbol::Fill(OBSTACLE, 1.0), "obstacle");
    }
    if has(Role::Attenuating) {
        item(Symbol::Fill(ATTENUATING, marks::ATTENUATING_OPACITY), "weakens radio");
    }
    item(Symbol::Edge(palette::ZONE), "area, zone");
    if strips.blocked.count() > 0 {
        let text = if has(Role::Obstacle) { "too close for the robot" } else { "blocked" };
        item(Symbol::Fill(BLOCKED, 1.0), text);
    }
    entries
}

/// Covered cells, a light band of the ramp of costs.
const COVERED: &str = "#cbe38f";

/// The cells as an image.
fn ground(strips: &Strips<'_>, view: &View) -> Image {
    let colours = [PAPER, BLOCKED, COVERED, UNMAPPED].into_iter().flat_map(palette::rgb).collect();
    cells::indexed(view.map, colours, |x, y| {
        let cell = cells::under(strips.grid, view.map, x, y);
        match (strips.wanted.get(cell), strips.covered.get(cell)) {
            (true, true) => 2,
            (true, false) => 3,
            _ if strips.blocked.get(cell) => 1,
            _ => 0,
        }
    })
}
