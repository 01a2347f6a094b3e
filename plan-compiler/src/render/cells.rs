//! Cells as an image: sampled, sorted into cost bands, and drawn in few colours.
//!
//! The picture bounds the size of the image, however large the map is.

use super::palette::{self, BLOCKED, HATCH, PAPER, TOLL};
use super::scale::round_number_above;
use super::texture::{self, Density};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use plan_format::grid::cost_metres;
use plan_format::{Answer, Cell, Grid, Layer};
use rayon::prelude::*;
use std::io::Write;
use std::ops::Range;
use svg::node::element::Image;

/// Most cost bands; more colours are hard to distinguish.
pub(super) const MAX_BANDS: usize = 12;

/// A blocked sample.
const IS_BLOCKED: u32 = u32::MAX;
/// A sample without a route.
const NO_ROUTE: u32 = u32::MAX - 1;

/// A layer at the picture's resolution.
pub(super) struct Sampled {
    columns: u32,
    rows: u32,
    /// Costs, or [`IS_BLOCKED`] or [`NO_ROUTE`]; row 0 in the south.
    costs: Vec<u32>,
    /// The tolls of the samples; empty without tolls.
    tolls: Vec<Density>,
    resolution_m: f64,
}

/// Width and number of bands, of costs in metres or of another quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bands {
    pub(super) width_m: f64,
    pub(super) count: usize,
}

impl Bands {
    /// Few bands of a round width that reach up to a cost.
    pub(super) fn to(farthest_m: f64) -> Self {
        let width_m = round_number_above(farthest_m / MAX_BANDS as f64);
        let count = ((farthest_m / width_m) as usize + 1).min(MAX_BANDS);
        Self { width_m, count }
    }

    /// The band of a cost.
    pub(super) fn of(&self, cost_m: f64) -> usize {
        ((cost_m / self.width_m) as usize).min(self.count - 1)
    }
}

impl Sampled {
    /// Samples a layer with at most `most` columns and rows, each sample from a block of cells.
    pub(super) fn new(grid: &Grid, layer: &Layer<'_>, most: [u32; 2]) -> Self {
        let (columns, rows) = (grid.columns.min(most[0]), grid.rows.min(most[1]));
        let row_of_samples = |row: u32| {
            let rows = block(row, rows, grid.rows);
            let cost = |column, row| match layer.look_up(Cell::new(column, row)) {
                Answer::Blocked { .. } => IS_BLOCKED,
                Answer::Move { cost, .. } => cost.min(NO_ROUTE - 1),
                Answer::Goal => 0,
                Answer::NoRoute | Answer::OffMap => NO_ROUTE,
            };
            (0..columns)
                .map(move |column| merged(block(column, columns, grid.columns), rows.clone(), cost))
        };
        let costs = (0..rows).into_par_iter().flat_map_iter(row_of_samples).collect();
        let level = |row: u32| {
            let row = middle(row, rows, grid.rows);
            let cell = move |column| Cell::new(middle(column, columns, grid.columns), row);
            (0..columns).map(move |column| texture::level(grid, layer, cell(column)))
        };
        let toll_rows = if layer.has_tolls() { rows } else { 0 };
        let tolls = (0..toll_rows).into_par_iter().flat_map_iter(level).collect();
        Self { columns, rows, costs, tolls, resolution_m: grid.resolution_m }
    }

    /// The same samples reduced to at most `most` columns and rows.
    fn coarser(&self, most: [u32; 2]) -> Self {
        let (columns, rows) = (self.columns.min(most[0]), self.rows.min(most[1]));
        let cost = |column: u32, row: u32| {
            self.costs[row as usize * self.columns as usize + column as usize]
        };
        let row_of_samples = |row: u32| {
            let rows = block(row, rows, self.rows);
            (0..columns)
                .map(move |column| merged(block(column, columns, self.columns), rows.clone(), cost))
        };
        let costs = (0..rows).flat_map(row_of_samples).collect();
        let level = |row: u32| {
            let start = middle(row, rows, self.rows) as usize * self.columns as usize;
            let column = |column: u32| middle(column, columns, self.columns) as usize;
            (0..columns).map(move |at| self.tolls.get(start + column(at)).copied().unwrap_or(0))
        };
        let toll_rows = if self.tolls.is_empty() { 0 } else { rows };
        let tolls = (0..toll_rows).flat_map(level).collect();
        Self { columns, rows, costs, tolls, resolution_m: self.resolution_m }
    }

    /// The highest cost, metres; `None` if no cell has a route.
    pub(super) fn farthest_m(&self) -> Option<f64> {
        let costs = self.costs.iter().filter(|&&cost| cost < NO_ROUTE);
        costs.max().map(|&cost| cost_metres(cost, self.resolution_m))
    }

    /// Whether there are blocked cells.
    pub(super) fn has_blocked(&self) -> bool {
        self.costs.contains(&IS_BLOCKED)
    }

    pub(super) fn has_cells_without_route(&self) -> bool {
        self.costs.contains(&NO_ROUTE)
    }

    /// The levels of tolls that occur, from the lowest, without level 0.
    pub(super) fn levels(&self) -> impl Iterator<Item = Density> {
        (1..=Density::MAX).take(4).filter(|level| self.tolls.contains(level))
    }

    /// The image in whole pixels; the hatching repeats after `hatch_px` pixels.
    pub(super) fn draw(&self, bands: Bands, size: [u32; 2], hatch_px: u32) -> Image {
        image(size, &self.coarser(size).png(bands, size, hatch_px).unwrap_or_default())
    }

    fn png(
        &self,
        bands: Bands,
        [width, height]: [u32; 2],
        hatch_px: u32,
    ) -> Result<Vec<u8>, png::EncodingError> {
        // Colours of the bands, then of paper, hatching, blocked cells and tolls.
        let mut colours: Vec<u8> =
            (0..bands.count).flat_map(|index| palette::band(index, bands.count)).collect();
        colours.extend([PAPER, HATCH, BLOCKED, TOLL].into_iter().flat_map(palette::rgb));
        let paper = bands.count as u8;
        let index_of = |cost: u32| match cost {
            IS_BLOCKED => paper + 2,
            NO_ROUTE => paper,
            cost => bands.of(cost_metres(cost, self.resolution_m)) as u8,
        };
        indexed_png([width, height], colours, |x, y| {
            let row = middle(height - 1 - y, height, self.rows) as usize;
            let column = middle(x, width, self.columns) as usize;
            let at = row * self.columns as usize + column;
            let level = self.tolls.get(at).copied().unwrap_or(0);
            match index_of(self.costs[at]) {
                index if index == paper && (x + y) % hatch_px < hatch_px.div_ceil(5) => paper + 1,
                index if index < paper && texture::is_dot(level, hatch_px, x, y) => paper + 3,
                index => index,
            }
        })
    }
}

/// An image in few colours: `colours` are red, green and blue of each, `index_of` the colour of a
/// pixel, counted from the north-west.
pub(super) fn indexed(
    size: [u32; 2],
    colours: Vec<u8>,
    index_of: impl FnMut(u32, u32) -> u8,
) -> Image {
    image(size, &indexed_png(size, colours, index_of).unwrap_or_default())
}

fn image(size: [u32; 2], png: &[u8]) -> Image {
    Image::new()
        .set("width", size[0])
        .set("height", size[1])
        // Cells keep sharp edges when enlarged; each viewer knows one of the two attributes.
        .set("image-rendering", "optimizeSpeed")
        .set("style", "image-rendering:pixelated")
        .set("href", format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png)))
}

fn indexed_png(
    [width, height]: [u32; 2],
    colours: Vec<u8>,
    mut index_of: impl FnMut(u32, u32) -> u8,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(colours);
    encoder.set_compression(png::Compression::Balanced);
    // Lines repeat, so their differences are mostly zeros. `set_compression` resets the filter.
    encoder.set_filter(png::Filter::Up);
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let mut line = vec![0; width as usize];
    for y in 0..height {
        for (x, pixel) in (0..).zip(&mut line) {
            *pixel = index_of(x, y);
        }
        stream.write_all(&line)?;
    }
    stream.finish()?;
    writer.finish()?;
    Ok(bytes)
}

/// The cells of one of `samples` samples along an axis.
fn block(index: u32, samples: u32, cells: u32) -> Range<u32> {
    let edge = |index: u32| (u64::from(index) * u64::from(cells) / u64::from(samples)) as u32;
    edge(index)..edge(index + 1)
}

/// The cell of a grid under a pixel of an image of it, whose rows come from the north.
pub(super) fn under(grid: &Grid, [width, height]: [u32; 2], x: u32, y: u32) -> Cell {
    Cell::new(middle(x, width, grid.columns), middle(height - 1 - y, height, grid.rows))
}

/// The sample under the middle of one of `pixels` pixels.
fn middle(pixel: u32, pixels: u32, samples: u32) -> u32 {
    ((2 * u64::from(pixel) + 1) * u64::from(samples) / (2 * u64::from(pixels))) as u32
}

/// The sample of a block: blocked if any cell is, so that thin walls stay visible; otherwise the
/// goal or the first cost.
fn merged(columns: Range<u32>, rows: Range<u32>, cost: impl Fn(u32, u32) -> u32) -> u32 {
    let mut found = NO_ROUTE;
    for row in rows {
        for column in columns.clone() {
            match cost(column, row) {
                IS_BLOCKED => return IS_BLOCKED,
                0 => found = 0,
                cost if found == NO_ROUTE => found = cost,
                _ => {}
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_every_cell_once() {
        for (samples, cells) in [(1, 1), (3, 10), (7, 7), (1000, 4096), (5, 6)] {
            let blocks: Vec<_> = (0..samples).map(|index| block(index, samples, cells)).collect();
            assert_eq!((blocks[0].start, blocks[samples as usize - 1].end), (0, cells));
            assert!(blocks.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert!(blocks.iter().all(|block| !block.is_empty()));
        }
    }

    #[test]
    fn an_image_has_its_cells_upright_and_hatches_what_has_no_route() {
        let costs = vec![0, 5741, 57410, NO_ROUTE, IS_BLOCKED, 5741];
        let sampled = Sampled { columns: 3, rows: 2, costs, tolls: vec![], resolution_m: 1.0 };
        let bands = Bands::to(10.0);
        assert_eq!(bands, Bands { width_m: 1.0, count: 11 });
        let bytes = sampled.png(bands, [30, 20], 5).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let at = |x: usize, y: usize| pixels[y * 30 + x];
        assert_eq!([at(0, 19), at(10, 10), at(29, 19)], [0, 1, 10], "the southern row");
        assert_eq!([at(15, 5), at(29, 0)], [13, 1], "the northern row");
        assert_eq!([at(0, 0), at(1, 0), at(4, 1), at(9, 9)], [12, 11, 12, 11], "hatched");
    }

    #[test]
    fn bands_are_round_and_few() {
        for (farthest, width, count) in [(1.0, 0.1, 11), (240.0, 20.0, 12), (241.0, 50.0, 5)] {
            assert_eq!(Bands::to(farthest), Bands { width_m: width, count }, "{farthest}");
        }
        assert_eq!(Bands::to(100.0).of(1e9), Bands::to(100.0).count - 1);
    }
}
