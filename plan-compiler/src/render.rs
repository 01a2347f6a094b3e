//! A picture of a layer: obstacles, bands of cost and the advice (W, figure 2).
//!
//! One SVG text serves both files: a PNG is that text rasterised. Its size does not grow
//! with the map: a large map is sampled, equal cells are joined to rectangles, and arrows
//! keep a distance at which they can be told apart. Letters are drawn as shapes, so that no
//! font needs to be found.
//!
//! Deliberately absent: maps in the background, colours of the user's own.

mod cells;
pub(crate) mod label;

use crate::map::{Feature, Point, Role, Shape};
use cells::Sampled;
use label::label;
use math::scalar::wide;
use plan_format::{Answer, Cell, Grid, Layer, ParallelPlan, Plan};
use std::fmt::Write;
use svg::Document;
use svg::node::element::{Circle, Group, Path, Rectangle, Title};

/// What is drawn over the cells. Positions in the map's metres.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overlay<'a> {
    /// Exact shapes; blocked cells are then drawn lighter, as what the robot's radius adds.
    pub features: &'a [Feature],
    /// Where the robot started.
    pub start: Option<Point>,
    /// Where it drove.
    pub route: &'a [Point],
    /// The same in pieces of different colours, by their CSS names, instead.
    pub pieces: &'a [(&'a str, Vec<Point>)],
    /// Where something happened: discs of these colours.
    pub marks: &'a [(&'a str, Point)],
    /// What the picture shows; the layer's name if this is empty.
    pub caption: &'a str,
}

/// One of several layers that are drawn side by side.
#[derive(Clone, Copy, Debug)]
pub struct Panel<'a> {
    /// The plan that the layer belongs to.
    pub parallel: ParallelPlan<'a>,
    /// The layer.
    pub layer: Layer<'a>,
    /// What is drawn over its cells.
    pub overlay: Overlay<'a>,
}

/// The longer side of the map in the picture, at most, pixels.
const SIDE_PX: u32 = 1200;
/// The same where layers are drawn side by side.
const SIDE_OF_PANEL_PX: u32 = 800;
/// Panels in a row.
const ACROSS: usize = 4;
/// A cell is never drawn larger, pixels.
const MAX_CELL_PX: u32 = 32;
/// White space around the map, pixels.
const MARGIN_PX: f64 = 16.0;
/// Room for the scale and the caption below the map, pixels.
const FOOTER_PX: f64 = 64.0;
/// Arrows stand at least this far apart, pixels.
const ARROW_PX: u32 = 20;

const OBSTACLE: &str = "#2f333a";
const BLOCKED: &str = "#4a4f58";
const GROWN: &str = "#9aa0a9";
const NO_ROUTE: &str = "#e3e0da";
const ATTENUATING: &str = "#2e7d4f";
const ZONE: &str = "#8a5fb0";
const ADVICE: &str = "#23405f";
const GOAL: &str = "#c22f2f";
const ROUTE: &str = "#d9480f";
const INK: &str = "#1d1f23";

/// The layer as SVG.
pub fn picture(
    plan: &Plan<'_>,
    parallel: &ParallelPlan<'_>,
    layer: &Layer<'_>,
    overlay: &Overlay<'_>,
) -> String {
    side_by_side(plan, &[Panel { parallel: *parallel, layer: *layer, overlay: *overlay }])
}

/// Several layers as one SVG, in rows of at most four.
pub fn side_by_side(plan: &Plan<'_>, panels: &[Panel<'_>]) -> String {
    let view = View::new(plan.grid(), if panels.len() > 1 { SIDE_OF_PANEL_PX } else { SIDE_PX });
    let (width, height) = view.size_px();
    let names: Vec<String> = panels.iter().map(name).collect();
    let (across, down) = (panels.len().min(ACROSS), panels.len().div_ceil(ACROSS));
    let (total_width, total_height) = (width * across as f64, height * down as f64);
    let white = Rectangle::new().set("width", total_width).set("height", total_height);
    let mut document = Document::new()
        .set("viewBox", (0, 0, total_width, total_height))
        .set("width", total_width)
        .set("height", total_height)
        .add(Title::new(names.join(", ")))
        .add(white.set("fill", "#ffffff"));
    for (index, panel) in panels.iter().enumerate() {
        let (x, y) = ((index % ACROSS) as f64 * width, (index / ACROSS) as f64 * height);
        let drawn = draw(panel, &view).set("transform", format!("translate({x} {y})"));
        document = document.add(drawn);
    }
    document.to_string()
}

fn name(panel: &Panel<'_>) -> String {
    format!("{}/{}", panel.parallel.name(), panel.layer.name())
}

/// One layer with its footer, from the upper left corner.
fn draw(panel: &Panel<'_>, view: &View) -> Group {
    let Panel { parallel, layer, overlay } = panel;
    let sampled = Sampled::new(&view.grid, layer, view.cells_per_sample);
    let blocked = if overlay.features.is_empty() { BLOCKED } else { GROWN };
    let map = Group::new()
        .set("transform", view.transform())
        .add(sampled.draw(NO_ROUTE, blocked))
        .add(shapes(overlay.features, view))
        .add(arrows(layer, view))
        .add(track(overlay, view))
        .add(goal(parallel.goal_m(), view));
    let caption = match overlay.caption {
        "" => name(panel),
        caption => caption.to_owned(),
    };
    Group::new().add(map).add(footer(&caption, sampled.band_m(), view))
}

/// A picture as PNG; the message of the rasteriser where that fails.
pub fn png(svg: &str) -> Result<Vec<u8>, String> {
    use resvg::{tiny_skia, usvg};
    let tree = usvg::Tree::from_str(svg, &usvg::Options::default());
    let tree = tree.map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size();
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height())
        .ok_or_else(|| "the picture has no area".to_owned())?;
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| error.to_string())
}

/// From cells to pixels.
struct View {
    grid: Grid,
    /// Cells along the side of a sample; more than one only on large maps.
    cells_per_sample: u32,
    /// Pixels along the side of a cell.
    cell_px: f64,
}

impl View {
    /// The longer side of the map takes at most `side_px`.
    fn new(grid: &Grid, side_px: u32) -> Self {
        let side = grid.columns.max(grid.rows).max(1);
        let cells_per_sample = side.div_ceil(side_px);
        // Whole pixels, so that cells of one size are drawn alike.
        let sample_px = (side_px / side.div_ceil(cells_per_sample)).clamp(1, MAX_CELL_PX);
        let cell_px = f64::from(sample_px) / f64::from(cells_per_sample);
        Self { grid: *grid, cells_per_sample, cell_px }
    }

    /// Draws in cells, y upwards, from the map's south-west corner.
    fn transform(&self) -> String {
        let (x, y, s) = (MARGIN_PX, MARGIN_PX + self.map_px(self.grid.rows), self.cell_px);
        format!("translate({x} {y}) scale({s} -{s})")
    }

    fn map_px(&self, cells: u32) -> f64 {
        f64::from(cells) * self.cell_px
    }

    /// Width and height of the whole picture.
    fn size_px(&self) -> (f64, f64) {
        let width = self.map_px(self.grid.columns).max(MIN_WIDTH_PX) + 2.0 * MARGIN_PX;
        let height = self.map_px(self.grid.rows) + 2.0 * MARGIN_PX + FOOTER_PX;
        (wide::ceil(width), wide::ceil(height))
    }

    /// A length in pixels, in cells.
    fn px(&self, pixels: f64) -> f64 {
        pixels / self.cell_px
    }

    /// A point of the map, in cells.
    fn place(&self, at: Point) -> Point {
        let along = |axis: usize| (at[axis] - self.grid.corner_m[axis]) / self.grid.resolution_m;
        [along(0), along(1)]
    }
}

/// The caption needs some room, however narrow the map.
const MIN_WIDTH_PX: f64 = 320.0;

/// The exact shapes.
fn shapes(features: &[Feature], view: &View) -> Group {
    let mut group = Group::new().set("stroke-linejoin", "round").set("stroke-linecap", "round");
    for feature in features {
        let mut path = String::new();
        let filled = outline(&feature.shape, view, &mut path);
        let (colour, opacity, dashes) = match feature.role {
            Role::Obstacle => (OBSTACLE, 1.0, String::new()),
            Role::Attenuating => (ATTENUATING, 0.35, String::new()),
            Role::Zone => (ZONE, 0.0, format!("{0} {0}", view.px(6.0))),
        };
        let shape = Path::new()
            .set("d", path)
            .set("stroke", colour)
            .set("stroke-width", view.px(2.0))
            .set("stroke-dasharray", if dashes.is_empty() { "none".into() } else { dashes })
            .set("fill", if filled { colour } else { "none" })
            .set("fill-opacity", opacity)
            .set("fill-rule", "evenodd");
        group = group.add(shape);
    }
    group
}

/// The path of a shape; whether it has an inside.
fn outline(shape: &Shape, view: &View, path: &mut String) -> bool {
    match shape {
        Shape::Circle { centre, radius } => {
            let ([x, y], r) = (view.place(*centre), radius / view.grid.resolution_m);
            let west = x - r;
            let _ = write!(path, "M{west:.3} {y:.3}a{r:.3} {r:.3} 0 1 0 {:.3} 0", 2.0 * r);
            let _ = write!(path, "a{r:.3} {r:.3} 0 1 0 {:.3} 0z", -2.0 * r);
            true
        }
        Shape::Polyline(points) => {
            line(points, view, path);
            false
        }
        Shape::Polygon(rings) => {
            for ring in rings {
                line(ring, view, path);
                path.push('z');
            }
            true
        }
    }
}

fn line(points: &[Point], view: &View, path: &mut String) {
    for (index, point) in points.iter().enumerate() {
        let [x, y] = view.place(*point);
        let letter = if index == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{letter}{x:.3} {y:.3}");
    }
}

/// The advice of every cell that the thinning keeps.
fn arrows(layer: &Layer<'_>, view: &View) -> Path {
    let grid = &view.grid;
    let every = (f64::from(ARROW_PX) / view.cell_px).ceil().max(1.0) as u32;
    // Shaft and head relative to the shaft's length.
    let length = 0.72 * f64::from(every);
    let (head, side) = (0.42 * length, 0.26 * length);
    let mut path = String::new();
    for row in (every / 2..grid.rows).step_by(every as usize) {
        for column in (every / 2..grid.columns).step_by(every as usize) {
            let cell = Cell::new(column, row);
            let Answer::Move { direction, .. } = layer.look_up(cell) else { continue };
            let unit = direction.unit();
            let (ux, uy) = (f64::from(unit.x), f64::from(unit.y));
            let (x, y) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
            let (tip_x, tip_y) = (x + ux * length / 2.0, y + uy * length / 2.0);
            let _ = write!(path, "M{:.2} {:.2}", x - ux * length / 2.0, y - uy * length / 2.0);
            let _ = write!(path, "L{tip_x:.2} {tip_y:.2}");
            for side in [side, -side] {
                let back = (tip_x - ux * head - uy * side, tip_y - uy * head + ux * side);
                let _ = write!(path, "M{tip_x:.2} {tip_y:.2}L{:.2} {:.2}", back.0, back.1);
            }
        }
    }
    Path::new()
        .set("d", path)
        .set("fill", "none")
        .set("stroke", ADVICE)
        .set("stroke-width", view.px(1.2))
        .set("stroke-linecap", "round")
}

/// Where the robot started and drove.
fn track(overlay: &Overlay<'_>, view: &View) -> Group {
    let mut group = Group::new();
    let route = (!overlay.route.is_empty()).then_some((ROUTE, overlay.route));
    let pieces = overlay.pieces.iter().map(|(colour, points)| (*colour, points.as_slice()));
    for (colour, points) in route.into_iter().chain(pieces) {
        let mut path = String::new();
        line(points, view, &mut path);
        // A light rim keeps the line apart from arrows and dark obstacles.
        for (colour, width) in [("#ffffff", 6.0), (colour, 3.5)] {
            let stroke = Path::new()
                .set("d", path.clone())
                .set("fill", "none")
                .set("stroke", colour)
                .set("stroke-width", view.px(width))
                .set("stroke-linejoin", "round")
                .set("stroke-linecap", "round");
            group = group.add(stroke);
        }
    }
    for &(colour, at) in overlay.marks {
        group = group.add(disc(at, 9.0, "#ffffff", view)).add(disc(at, 7.0, colour, view));
    }
    if let Some(start) = overlay.start {
        group = group.add(disc(start, 7.0, "#ffffff", view)).add(disc(start, 5.0, ROUTE, view));
    }
    group
}

fn goal(at: Point, view: &View) -> Group {
    Group::new()
        .add(disc(at, 10.0, "#ffffff", view))
        .add(disc(at, 8.0, GOAL, view))
        .add(disc(at, 5.0, "#ffffff", view))
        .add(disc(at, 2.5, GOAL, view))
}

fn disc(at: Point, radius_px: f64, colour: &str, view: &View) -> Circle {
    let [x, y] = view.place(at);
    Circle::new().set("cx", x).set("cy", y).set("r", view.px(radius_px)).set("fill", colour)
}

/// Scale bar and caption.
fn footer(name: &str, band_m: f64, view: &View) -> Group {
    let top = MARGIN_PX + view.map_px(view.grid.rows) + 20.0;
    let room_m = view.px(view.size_px().0 / 4.0) * view.grid.resolution_m;
    let bar_m = round_number_below(room_m);
    let bar_px = bar_m / view.grid.resolution_m * view.cell_px;
    let bar = format!("M{MARGIN_PX} {}v10h{bar_px:.2}v-10", top - 4.0);
    let metres = crate::compile::metres;
    Group::new()
        .add(
            Path::new().set("d", bar).set("fill", "none").set("stroke", INK).set("stroke-width", 2),
        )
        .add(label(MARGIN_PX + bar_px + 10.0, top - 6.0, &format!("{} m", metres(bar_m)), INK))
        .add(label(
            MARGIN_PX,
            top + 22.0,
            &format!("{name}: cost in bands of {} m", metres(band_m)),
            INK,
        ))
}

/// The largest of 1, 2, 5, 10, 20, ... that is at most `x`.
fn round_number_below(x: f64) -> f64 {
    let unit = wide::pow(10.0, wide::floor(wide::log10(x)));
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * unit).find(|&r| r <= x).unwrap_or(unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::{Input, Options, compile};
    use crate::map::{Extent, Map, NamedPoint};
    use crate::mission::Mission;

    fn sampled_sides(columns: u32, rows: u32) -> (u32, f64) {
        let grid = Grid { columns, rows, resolution_m: 0.5, corner_m: [-5.0, 7.0] };
        let view = View::new(&grid, SIDE_PX);
        (view.cells_per_sample, view.cell_px)
    }

    #[test]
    fn cells_are_whole_pixels_and_large_maps_are_sampled() {
        assert_eq!(sampled_sides(10, 5), (1, 32.0));
        assert_eq!(sampled_sides(250, 250), (1, 4.0));
        assert_eq!(sampled_sides(1200, 3), (1, 1.0));
        assert_eq!(sampled_sides(1201, 3), (2, 0.5));
        assert_eq!(sampled_sides(16_384, 16_384), (14, 1.0 / 14.0));
    }

    #[test]
    fn scales_are_round() {
        for (room, bar) in [(1.0, 1.0), (1.9, 1.0), (4.9, 2.0), (62.5, 50.0), (0.3, 0.2)] {
            assert!((round_number_below(room) - bar).abs() < 1e-12, "{room}");
        }
    }

    /// The colour of the picture of an empty map of 20 by 10 cells, at a point of the map.
    fn colour_at(overlay: &Overlay<'_>, at: Point) -> [u8; 3] {
        let map = Map {
            extent: Extent { corner: [-10.0, 5.0], size: [40.0, 20.0] },
            boundary: None,
            resolution_m: Some(2.0),
            reference: None,
            features: Vec::new(),
            cells: None,
            points: vec![NamedPoint { name: "a".into(), at: [27.0, 22.0], span: 0..0 }],
            start: None,
            title: None,
            remarks: Vec::new(),
            is_for_points: false,
        };
        let (mission, options) = (Mission::default(), Options::default());
        let input = Input { map: &map, source: None, mission: &mission, options: &options };
        let blob = compile(&input, &|_, _| {}, &mut Vec::new()).unwrap();
        let plan = Plan::parse(&blob).unwrap();
        let parallel = plan.parallel_plan(0).unwrap();
        let svg = picture(&plan, &parallel, &parallel.layer(0).unwrap(), overlay);
        let png = png(&svg).unwrap();
        let pixels = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
        let view = View::new(plan.grid(), SIDE_PX);
        let [x, y] = view.place(at).map(|cells| cells * view.cell_px);
        let y = view.map_px(view.grid.rows) - y;
        let pixel = pixels.pixel((MARGIN_PX + x) as u32, (MARGIN_PX + y) as u32).unwrap();
        [pixel.red(), pixel.green(), pixel.blue()]
    }

    #[test]
    fn what_was_driven_lies_over_the_cells_in_the_maps_own_metres() {
        let route = [[-8.0, 7.0], [6.0, 7.0], [6.0, 20.0]];
        let overlay = Overlay { start: Some(route[0]), route: &route, ..Overlay::default() };
        let driven = [0xd9, 0x48, 0x0f];
        for at in [route[0], [0.0, 7.0], [6.0, 15.0]] {
            assert_eq!(colour_at(&overlay, at), driven, "{at:?}");
            assert_ne!(colour_at(&Overlay::default(), at), driven, "{at:?}");
        }
    }
}
