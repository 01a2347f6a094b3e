//! SVG in a layout of our own.
//!
//! A production's vertices stand in a row in their order, so all edges lead to the right. An edge
//! that would overlap another has its own lane; protection intervals are below.

use super::{Drawn, LABELS};
use crate::render::document;
use crate::render::palette::{FAINT, INK, INTERVAL, PANEL, SHADES};
use crate::render::text::{self, Anchor, CAPITALS_EM};
use plan_format::mission::{Label, Production, Symbol};
use svg::node::element::{Circle, Group, Path, Rectangle, Title};

const RIM: &str = "#c9c5ba";
const ACTION: &str = "#d9e6f2";
const FRAME: &str = "#f5dfae";
/// Size of all letters.
const FONT_PX: f64 = 15.0;
const MARGIN_PX: f64 = 20.0;
const LINE_PX: f64 = 22.0;
/// From one lane to the next.
const LANE_PX: f64 = 40.0;
const BOX_PX: f64 = 28.0;
/// Space on either side of a box, for the arrows.
const AROUND_PX: f64 = 34.0;
const RADIUS_PX: f64 = 7.0;
const CELL_PX: f64 = 38.0;

/// The mission as an SVG text.
pub fn picture(drawn: &Drawn<'_>) -> String {
    let mission = &drawn.mission;
    let mut page = Page { group: Group::new(), right: 0.0, bottom: MARGIN_PX };
    for behaviour in mission.behaviours().iter() {
        page.panel(|panel| {
            panel.heading(&format!("behaviour {}", mission.name(behaviour.name)));
            for line in drawn.policy(&behaviour) {
                panel.line(&line);
            }
            panel.table(&drawn.rows(behaviour.rules));
        });
    }
    for (name, rules) in drawn.derived_inputs() {
        page.panel(|panel| {
            panel.heading(&format!("input {name}"));
            panel.table(&drawn.rows(rules));
        });
    }
    for frame in mission.plan_frames().iter() {
        page.panel(|panel| {
            panel.heading(&drawn.frame_title(&frame));
            for production in mission.productions_of(&frame) {
                let title = drawn.production_title(&frame, &production);
                if !title.is_empty() {
                    panel.line(title);
                }
                if let Some(rules) = production.rules {
                    panel.table(&drawn.rows(rules));
                }
                panel.graph(drawn, &production);
            }
        });
    }
    let (width, height) = (page.right + MARGIN_PX, page.bottom);
    document([width.ceil(), height.ceil()], "").add(page.group).to_string()
}

/// Panels one below the other.
struct Page {
    group: Group,
    right: f64,
    bottom: f64,
}

impl Page {
    fn panel(&mut self, fill: impl FnOnce(&mut Panel)) {
        let mut panel = Panel {
            group: Group::new(),
            top: self.bottom + 12.0,
            right: 0.0,
            y: self.bottom + 12.0,
        };
        fill(&mut panel);
        let width = panel.right + 12.0 - MARGIN_PX;
        let ground = Rectangle::new()
            .set("x", MARGIN_PX)
            .set("y", panel.top - 12.0)
            .set("width", width)
            .set("height", panel.y - panel.top + 18.0)
            .set("rx", 6)
            .set("fill", PANEL)
            .set("stroke", RIM);
        self.group = std::mem::replace(&mut self.group, Group::new()).add(ground).add(panel.group);
        self.right = self.right.max(MARGIN_PX + width);
        self.bottom = panel.y + 6.0 + MARGIN_PX;
    }
}

/// Lines, tables and graphs one below the other.
struct Panel {
    group: Group,
    top: f64,
    right: f64,
    /// Where the next part begins.
    y: f64,
}

impl Panel {
    const LEFT: f64 = MARGIN_PX + 14.0;

    fn add(&mut self, node: impl Into<Box<dyn svg::node::Node>>) {
        self.group = std::mem::replace(&mut self.group, Group::new()).add(node);
    }

    fn text(&mut self, x: f64, y: f64, text: &str, colour: &str) {
        let baseline = y + CAPITALS_EM * FONT_PX;
        self.add(text::line([x, baseline], text, FONT_PX, Anchor::Start).set("fill", colour));
        self.right = self.right.max(x + width_px(text));
    }

    fn heading(&mut self, text: &str) {
        self.text(Self::LEFT, self.y, text, INK);
        let underline = format!("M{} {}h{:.1}", Self::LEFT, self.y + 16.0, width_px(text));
        self.add(stroke(underline, INK, 2.0));
        self.y += LINE_PX + 6.0;
    }

    fn line(&mut self, text: &str) {
        self.text(Self::LEFT, self.y, text, FAINT);
        self.y += LINE_PX;
    }

    /// A rule base in the paper's layout, each label in its shade.
    fn table(&mut self, rows: &[(&str, [Label; 7])]) {
        let names = rows.iter().map(|(name, _)| width_px(name)).fold(0.0, f64::max);
        let left = Self::LEFT + names + 12.0;
        for (column, text) in LABELS.iter().enumerate() {
            self.text(left + column as f64 * CELL_PX + 7.0, self.y, text, FAINT);
        }
        self.right = self.right.max(left + LABELS.len() as f64 * CELL_PX);
        self.y += LINE_PX - 4.0;
        for (name, labels) in rows {
            self.text(Self::LEFT, self.y + 5.0, name, INK);
            for (column, &label) in labels.iter().enumerate() {
                let x = left + column as f64 * CELL_PX;
                let cell = Rectangle::new()
                    .set("x", x)
                    .set("y", self.y)
                    .set("width", CELL_PX)
                    .set("height", LINE_PX)
                    .set("fill", SHADES[label as usize])
                    .set("stroke", RIM);
                self.add(cell);
                self.text(x + 7.0, self.y + 5.0, LABELS[label as usize], INK);
            }
            self.y += LINE_PX;
        }
        self.y += 10.0;
    }

    fn graph(&mut self, drawn: &Drawn<'_>, production: &Production) {
        let edges: Vec<_> = drawn.mission.edges_of(production).collect();
        let texts: Vec<String> = edges
            .iter()
            .map(|edge| match edge.work {
                0 => drawn.symbol(edge.symbol).to_owned(),
                work => format!("{} ({work})", drawn.symbol(edge.symbol)),
            })
            .collect();
        let spans: Vec<(u8, u8)> = edges.iter().map(|edge| (edge.from, edge.to)).collect();
        let columns = columns(production.vertices, &spans, &texts);
        let lanes = lanes(&spans);
        let axis = self.y + BOX_PX / 2.0 + 4.0;
        let bottom = lanes.iter().copied().max().unwrap_or(0);
        for ((edge, text), &lane) in edges.iter().zip(&texts).zip(&lanes) {
            let (from, to) = (columns[usize::from(edge.from)], columns[usize::from(edge.to)]);
            let y = axis + f64::from(lane) * LANE_PX;
            self.edge(from, to, axis, y);
            let is_frame = matches!(edge.symbol, Symbol::PlanFrame(_));
            self.component((from + to) / 2.0, y, text, is_frame, &drawn.details(edge.symbol));
        }
        for (vertex, &x) in columns.iter().enumerate() {
            let is_end = vertex == 0 || vertex + 1 == columns.len();
            self.add(disc(x, axis, RADIUS_PX, INK));
            self.add(disc(x, axis, RADIUS_PX - 2.0, if is_end { INK } else { "#ffffff" }));
            self.right = self.right.max(x + RADIUS_PX);
        }
        self.y = axis + f64::from(bottom) * LANE_PX + BOX_PX / 2.0 + 10.0;
        for interval in drawn.mission.intervals_of(production) {
            let (from, to) =
                (columns[usize::from(interval.from)], columns[usize::from(interval.to)]);
            let colour = if interval.is_derived { FAINT } else { INTERVAL };
            let bracket = format!("M{from} {}v8H{to}v-8", self.y);
            self.add(stroke(bracket, colour, 1.5).set("stroke-dasharray", "5 3"));
            let text = drawn.condition(interval.condition);
            let x = ((from + to - width_px(&text)) / 2.0).max(Self::LEFT);
            self.text(x, self.y + 13.0, &text, colour);
            self.y += LINE_PX + 10.0;
        }
        self.y += 6.0;
    }

    /// An arrow from vertex to vertex along a lane.
    fn edge(&mut self, from: f64, to: f64, axis: f64, y: f64) {
        const SLOPE_PX: f64 = 22.0;
        let tip = to - RADIUS_PX - 1.0;
        let mut path = format!("M{from} {axis}L{} {y}H{}", from + SLOPE_PX, to - SLOPE_PX);
        path += &format!("L{tip} {axis}");
        self.add(stroke(path, INK, 1.5));
        let head = format!("M{tip} {axis}l-9 -4.5v9z");
        let turned = if (axis - y).abs() > 1.0 { "rotate(-35)" } else { "rotate(0)" };
        let place = format!("translate({tip} {axis}) {turned} translate({} {})", -tip, -axis);
        self.add(Path::new().set("d", head).set("fill", INK).set("transform", place));
    }

    fn component(&mut self, x: f64, y: f64, text: &str, is_frame: bool, details: &str) {
        let width = width_px(text) + 16.0;
        let ground = Rectangle::new()
            .set("x", x - width / 2.0)
            .set("y", y - BOX_PX / 2.0)
            .set("width", width)
            .set("height", BOX_PX)
            .set("rx", if is_frame { 0 } else { 8 })
            .set("fill", if is_frame { FRAME } else { ACTION })
            .set("stroke", INK)
            .set("stroke-width", if is_frame { 2 } else { 1 })
            .add(Title::new(text::clean(details)));
        self.add(ground);
        self.text(x - width / 2.0 + 8.0, y - 6.0, text, INK);
    }
}

/// Positions of the vertices, pixels, far enough apart for the boxes between them.
fn columns(vertices: u8, spans: &[(u8, u8)], texts: &[String]) -> Vec<f64> {
    let mut columns = vec![Panel::LEFT + RADIUS_PX];
    for vertex in 1..vertices {
        let room = |(&(from, to), text): (&(u8, u8), &String)| {
            let needed = width_px(text) + 16.0 + 2.0 * AROUND_PX;
            (to == vertex).then(|| columns[usize::from(from)] + needed)
        };
        let least = columns.last().copied().unwrap_or(0.0) + 2.0 * AROUND_PX;
        columns.push(spans.iter().zip(texts).filter_map(room).fold(least, f64::max));
    }
    columns
}

/// A lane for each edge, so that edges in one lane do not overlap and no edge passes through a
/// vertex. Lane 0 is the line of the vertices.
fn lanes(spans: &[(u8, u8)]) -> Vec<u8> {
    let mut order: Vec<usize> = (0..spans.len()).collect();
    order.sort_by_key(|&edge| spans[edge].1 - spans[edge].0);
    let mut lanes: Vec<Option<u8>> = vec![None; spans.len()];
    for edge in order {
        let (from, to) = spans[edge];
        let is_taken = |lane: u8| {
            let overlaps = |other: &(u8, u8)| other.0 < to && from < other.1;
            spans.iter().zip(&lanes).any(|(other, &taken)| taken == Some(lane) && overlaps(other))
        };
        let first = u8::from(to - from > 1);
        lanes[edge] = (first..=u8::MAX).find(|&lane| !is_taken(lane));
    }
    lanes.into_iter().map(|lane| lane.unwrap_or(0)).collect()
}

fn width_px(text: &str) -> f64 {
    text::width_px(&text::clean(text), FONT_PX)
}

fn stroke(path: String, colour: &str, width: f64) -> Path {
    Path::new()
        .set("d", path)
        .set("fill", "none")
        .set("stroke", colour)
        .set("stroke-width", width)
        .set("stroke-linejoin", "round")
}

fn disc(x: f64, y: f64, radius: f64, colour: &str) -> Circle {
    Circle::new().set("cx", x).set("cy", y).set("r", radius).set("fill", colour)
}
