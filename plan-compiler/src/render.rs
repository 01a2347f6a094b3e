//! A picture of a layer: obstacles, cost bands and the advice (W, figure 2), with a legend, a
//! scale, north, coordinates on the edges and the names of goals.
//!
//! One SVG text serves both formats: a PNG is that text rasterised with a font that ships with the
//! program. The size of neither file depends on the map: cells are an image with the picture's own
//! pixels, one arrow stands for a block of cells, and text and lines scale with the picture.
//!
//! Deliberately absent: background maps and user-defined colours.

mod borders;
mod cells;
mod isolines;
mod legend;
mod marks;
pub(crate) mod palette;
mod reach;
mod scale;
mod sheet;
mod strips;
mod stroke;
pub(crate) mod text;
mod texture;
mod view;

pub use marks::Mark;
pub use reach::{Reach, lacking_in, reach};
pub use strips::{Strips, strips};

use crate::goals;
use cells::{Bands, Sampled};
use legend::{Entry, Ramp, Symbol};
use maps::{Feature, Point, Role, Shape};
use marks::Names;
use palette::{ATTENUATING, BLOCKED, INK, OBSTACLE, PAPER, UNMAPPED, ZONE};
use plan_format::{Blob, Grid, Layer, ParallelPlan, Step};
use sheet::{Contents, Sheet, TITLE_EM};
use stroke::stroke;
use svg::Document;
use svg::node::element::{ClipPath, Definitions, Group, Rectangle, Title};
use text::Anchor;
use view::View;

/// What is drawn over the cells. Positions are in the map's metres.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overlay<'a> {
    /// Exact shapes; the other blocked cells are then those that the robot's radius adds.
    pub features: &'a [Feature],
    /// Shapes of obstacles that are there and not on the map.
    pub unmapped: &'a [Shape],
    /// Shapes of obstacles that are on the map and not there.
    pub absent: &'a [Shape],
    /// Routes, in pieces.
    pub routes: &'a [Piece<'a>],
    /// Marks with their positions and names in the legend.
    pub marks: &'a [(Mark, Point, &'a str)],
    /// Title of the panel; the layer's name if this is empty.
    pub caption: &'a str,
}

/// A piece of a route.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// Number that selects colour and dashes: the behaviour that drove it, or [`NO_BEHAVIOUR`].
    pub style: usize,
    /// The line, metres.
    pub points: &'a [Point],
}

/// The style of a route that no behaviour drove.
pub const NO_BEHAVIOUR: usize = usize::MAX;

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

/// Options of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Largest length of the longer side, pixels.
    pub size_px: u32,
    /// Whether the advice is drawn.
    pub has_arrows: bool,
}

impl Default for Style {
    fn default() -> Self {
        Self { size_px: 1200, has_arrows: true }
    }
}

/// Range of `Style::size_px`: smaller pictures are illegible, larger ones need gigabytes.
pub const SIZES_PX: std::ops::RangeInclusive<u32> = 200..=8000;

/// The layer as SVG.
pub fn picture(
    blob: &Blob<'_>,
    parallel: &ParallelPlan<'_>,
    layer: &Layer<'_>,
    overlay: &Overlay<'_>,
    style: Style,
) -> String {
    let panel = Panel { parallel: *parallel, layer: *layer, overlay: *overlay };
    side_by_side(blob, &[panel], style)
}

/// Several layers as one SVG with one legend: a colour means the same cost in all of them.
pub fn side_by_side(blob: &Blob<'_>, panels: &[Panel<'_>], style: Style) -> String {
    let size_px = style.size_px.clamp(*SIZES_PX.start(), *SIZES_PX.end());
    let sampled = |panel: &Panel<'_>| Sampled::new(blob.grid(), &panel.layer, [size_px; 2]);
    let drawn: Vec<Sampled> = panels.iter().map(sampled).collect();
    let farthest_m = drawn.iter().filter_map(Sampled::farthest_m).fold(0.0, f64::max);
    let bands = Bands::to(farthest_m.max(blob.grid().resolution_m));
    let entries = entries(blob, panels, &drawn, Some(bands).filter(|_| farthest_m > 0.0), style);
    let titles: Vec<String> = panels.iter().map(title).collect();
    let title_px = titles.iter().map(|title| sheet::title_px(title, size_px)).fold(0.0, f64::max);
    let contents = Contents { grid: blob.grid(), panels: panels.len(), title_px, legend: &entries };
    let sheet = Sheet::new(&contents, size_px);
    let maps = panels.iter().zip(&drawn).zip(&titles).map(|((panel, sampled), title)| {
        let image = sampled.draw(bands, sheet.view.map, hatch_px(&sheet));
        Group::new().add(draw(blob, panel, image, &sheet, style)).add(frame(&sheet, title))
    });
    assembled(&sheet, &titles.join(", "), maps.collect(), &entries)
}

/// A picture of maps, each at its place on the sheet, and a legend.
fn assembled(sheet: &Sheet, title: &str, maps: Vec<Group>, entries: &[Entry]) -> String {
    let mut document = document(sheet.size, title).add(clip(&sheet.view));
    for (map, corner) in maps.into_iter().zip(&sheet.maps) {
        let place = format!("translate({} {})", corner[0], corner[1]);
        document = document.add(map.set("transform", place));
    }
    for (entry, place) in entries.iter().zip(sheet.legend.iter().flatten()) {
        document = document.add(legend::draw(entry, *place, &sheet.view));
    }
    document.to_string()
}

/// An empty picture with a size, the font of all texts and a title.
pub(crate) fn document([width, height]: [f64; 2], title: &str) -> Document {
    let ground = Rectangle::new().set("width", width).set("height", height).set("fill", PAPER);
    let document = Document::new()
        .set("viewBox", (0, 0, width, height))
        .set("width", width)
        .set("height", height)
        .set("font-family", text::FAMILIES);
    let document = match title {
        "" => document,
        title => document.add(Title::new(text::clean(title))),
    };
    document.add(ground)
}

fn title(panel: &Panel<'_>) -> String {
    match panel.overlay.caption {
        "" => format!("{}/{}", panel.parallel.name(), panel.layer.name()),
        caption => caption.to_owned(),
    }
}

/// Whole pixels between the lines of a hatching.
fn hatch_px(sheet: &Sheet) -> u32 {
    (6.0 * sheet.view.measure.unit).round().max(4.0) as u32
}

/// The clip path that keeps drawings inside the map.
fn clip(view: &View) -> Definitions {
    let [width, height] = view.map;
    let map = Rectangle::new().set("width", width).set("height", height);
    Definitions::new().add(ClipPath::new().set("id", "map").add(map))
}

/// The entries of the legend.
fn entries(
    blob: &Blob<'_>,
    panels: &[Panel<'_>],
    drawn: &[Sampled],
    bands: Option<Bands>,
    style: Style,
) -> Vec<Entry> {
    let mut entries: Vec<Entry> = bands.map(Ramp::of_costs).map(Entry::Bands).into_iter().collect();
    entries.extend([Entry::Scale, Entry::North(blob.origin().map(|origin| origin.heading_rad))]);
    let mut item = |symbol: Symbol, text: &str| {
        let entry = Entry::Item(symbol, text.to_owned());
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    };
    let features = || panels.iter().flat_map(|panel| panel.overlay.features);
    let has = |role: Role| features().any(|feature| feature.role == role);
    if has(Role::Obstacle) {
        item(Symbol::Fill(OBSTACLE, 1.0), "obstacle");
    }
    let overlays = || panels.iter().map(|panel| panel.overlay);
    if overlays().any(|overlay| !overlay.unmapped.is_empty()) {
        item(Symbol::Fill(UNMAPPED, 1.0), "there, not on the map");
    }
    if overlays().any(|overlay| !overlay.absent.is_empty()) {
        item(Symbol::Edge(INK), "on the map, not there");
    }
    if has(Role::Attenuating) {
        item(Symbol::Fill(ATTENUATING, marks::ATTENUATING_OPACITY), "weakens radio");
    }
    if has(Role::Zone) {
        item(Symbol::Edge(ZONE), "zone");
    }
    if drawn.iter().any(Sampled::has_blocked) {
        // With exact shapes drawn, visible blocked cells are those that the robot's radius adds.
        let text = if features().next().is_some() { "too close for the robot" } else { "blocked" };
        item(Symbol::Fill(BLOCKED, 1.0), text);
    }
    if drawn.iter().any(Sampled::has_cells_without_route) {
        item(Symbol::Hatch, "no route to the goal");
    }
    for level in drawn.iter().flat_map(Sampled::levels) {
        item(Symbol::Dots(level), &texture::meaning(level));
    }
    if style.has_arrows && bands.is_some() {
        item(Symbol::Arrow, "advice");
    }
    for piece in panels.iter().flat_map(|panel| panel.overlay.routes) {
        item(Symbol::Line(piece.style), piece.name);
    }
    for (mark, _, text) in panels.iter().flat_map(|panel| panel.overlay.marks) {
        item(Symbol::Mark(*mark), text);
    }
    if panels.iter().any(|panel| panel.parallel.goal_count() > 1) {
        item(Symbol::Border, "border between goals");
    }
    item(Symbol::Mark(Mark::Goal), "goal");
    if panels.iter().any(|panel| !other_goals(blob, &panel.parallel).is_empty()) {
        item(Symbol::Mark(Mark::OtherGoal), "goal of another plan");
    }
    entries
}

/// Names and positions of the goals of the other plans.
fn other_goals(blob: &Blob<'_>, parallel: &ParallelPlan<'_>) -> Vec<(String, Point)> {
    let others = blob.parallel_plans().filter(|other| other.name() != parallel.name());
    others.flat_map(|other| goals::all(&other)).collect()
}

/// Names and positions of the goals to which a layer leads.
fn own_goals(grid: &Grid, parallel: &ParallelPlan<'_>, layer: &Layer<'_>) -> Vec<(String, Point)> {
    let is_end = |(_, [x, y]): &(String, Point)| {
        let cell = grid.cell_at(*x, *y);
        parallel.goal_count() == 1 || cell.is_some_and(|cell| layer.step(cell) == Step::Goal)
    };
    goals::all(parallel).filter(is_end).collect()
}

/// One layer; the origin is the north-west corner of its map.
fn draw(
    blob: &Blob<'_>,
    panel: &Panel<'_>,
    cells: svg::node::element::Image,
    sheet: &Sheet,
    style: Style,
) -> Group {
    let Panel { parallel, layer, overlay } = panel;
    let (view, unit) = (&sheet.view, sheet.view.measure.unit);
    let mut map = Group::new()
        .set("clip-path", "url(#map)")
        .add(cells)
        .add(marks::shapes(overlay.features, view));
    if !(overlay.absent.is_empty() && overlay.unmapped.is_empty()) {
        map = map.add(marks::absent(overlay.absent, view));
        map = map.add(marks::unmapped(overlay.unmapped, view));
    }
    if style.has_arrows {
        map = map.add(marks::arrows(layer, view));
    }
    if parallel.goal_count() > 1 {
        map = map.add(borders::line(borders::path(layer, view), unit));
    }
    for piece in overlay.routes {
        let mut path = String::new();
        marks::line(piece.points, view, &mut path);
        map = map.add(marks::route(&path, piece.style, unit));
    }
    let others = other_goals(blob, parallel);
    let own = own_goals(blob.grid(), parallel, layer);
    let place = |at: Point| view.place(at);
    let marks: Vec<(Mark, [f64; 2])> = others
        .iter()
        .map(|(_, at)| (Mark::OtherGoal, place(*at)))
        .chain(own.iter().map(|(_, at)| (Mark::Goal, place(*at))))
        // Other marks are smaller than the goal's star, so they stay visible on it.
        .chain(overlay.marks.iter().map(|(mark, at, _)| (*mark, place(*at))))
        .collect();
    let places: Vec<[f64; 2]> = marks.iter().map(|(_, at)| *at).collect();
    // Half of a mark may be outside the map.
    let mut over = Group::new();
    for (mark, at) in marks {
        over = over.add(mark.draw(at, unit));
    }
    let routes = overlay.routes.iter().flat_map(|piece| piece.points);
    let mut names = Names::new(&places, routes.map(|at| view.place(*at)).collect(), unit);
    for (name, at) in own.into_iter().chain(others) {
        if let Some(name) = names.place(&name, place(at), view) {
            over = over.add(name);
        }
    }
    Group::new().add(map).add(over)
}

/// The map's edge with its coordinates, and its title.
fn frame(sheet: &Sheet, title: &str) -> Group {
    let (view, measure) = (&sheet.view, sheet.view.measure);
    let (font, tick) = (measure.font, measure.tick());
    let [width, height] = view.map.map(f64::from);
    let corner = view.grid.corner_m;
    let mut edge = format!("M0 0H{width}V{height}H0z");
    let mut group = Group::new();
    let capitals = text::CAPITALS_EM * font;
    for (x, label) in &sheet.ticks[0].at {
        let at = text::round(view.place([*x, corner[1]])[0]);
        edge += &format!("M{at} {height}v{}", text::round(tick));
        let place = [at, height + tick + 0.3 * font + capitals];
        group = group.add(text::line(place, label, font, Anchor::Middle));
    }
    for (y, label) in &sheet.ticks[1].at {
        let at = text::round(view.place([corner[0], *y])[1]);
        edge += &format!("M0 {at}h-{}", text::round(tick));
        let place = [-tick - 0.3 * font, at + capitals / 2.0];
        group = group.add(text::line(place, label, font, Anchor::End));
    }
    let size = TITLE_EM * font;
    let title = text::fit(title, size, sheet.title_px);
    let title = text::line([0.0, -0.6 * font], &title, size, Anchor::Start);
    group.add(stroke(edge, INK, measure.unit)).add(title)
}

/// The characters in the names of plans that the font lacks, which a PNG shows as boxes.
pub fn lacking(blob: &Blob<'_>) -> String {
    let names: String = blob.parallel_plans().map(|parallel| parallel.name()).collect();
    text::lacking(&names).collect::<std::collections::BTreeSet<char>>().into_iter().collect()
}

/// A picture as PNG.
///
/// # Errors
/// Returns the rasteriser's message if it fails.
pub fn png(svg: &str) -> Result<Vec<u8>, String> {
    use resvg::{tiny_skia, usvg};
    let mut options = usvg::Options { font_family: text::FAMILY.to_owned(), ..Default::default() };
    options.fontdb_mut().load_font_data(text::FONT.to_vec());
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size();
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height())
        .ok_or_else(|| "the picture has no area".to_owned())?;
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
    opaque(&pixels).map_err(|error| error.to_string())
}

/// A PNG without transparency, since the picture has an opaque background.
fn opaque(pixels: &resvg::tiny_skia::Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    // Even areas and thin lines are smaller without filters. `set_compression` resets the filter.
    encoder.set_filter(png::Filter::NoFilter);
    let colours: Vec<u8> =
        pixels.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&colours)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests;
