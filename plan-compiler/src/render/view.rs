//! Sizes of text and lines, and the position of a point of the map in the picture.

use super::scale::Edge;
use maps::Point;
use plan_format::Grid;

/// Sizes of text and lines, pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// Size of the font.
    pub(super) font: f64,
    /// Unit of lengths: 1 pixel if the font size is 13 pixels.
    pub(super) unit: f64,
}

impl Measure {
    /// Sizes that are legible in small and in large pictures.
    pub(super) fn of(size_px: u32) -> Self {
        let font = 9.0 + f64::from(size_px) / 250.0;
        Self { font, unit: font / 13.0 }
    }

    /// Margin at the edges and between parts.
    pub(super) fn margin(&self) -> f64 {
        self.font
    }

    /// Height of a title above its map.
    pub(super) fn title(&self) -> f64 {
        1.9 * self.font
    }

    /// Length of a tick.
    pub(super) fn tick(&self) -> f64 {
        5.0 * self.unit
    }
}

/// The transform from the map's metres to pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) grid: Grid,
    /// Width and height of the map, pixels.
    pub(super) map: [u32; 2],
    pub(super) measure: Measure,
}

impl View {
    /// Width and height of a cell, pixels. They differ only if a map is so long that its other side
    /// would vanish.
    pub(super) fn cell(&self) -> [f64; 2] {
        let [width, height] = self.map.map(f64::from);
        [width / f64::from(self.grid.columns), height / f64::from(self.grid.rows)]
    }

    /// Columns and rows from one drawn cell to the next: cells smaller than a pixel are skipped.
    pub(super) fn step(&self) -> [u32; 2] {
        let Grid { columns, rows, .. } = self.grid;
        [columns.div_ceil(self.map[0]).max(1), rows.div_ceil(self.map[1]).max(1)]
    }

    /// A point of the map in pixels, from the map's north-west corner.
    pub(super) fn place(&self, at: Point) -> [f64; 2] {
        let [width, height] = self.cell().map(|cell| cell / self.grid.resolution_m);
        let [x, y] = [at[0] - self.grid.corner_m[0], at[1] - self.grid.corner_m[1]];
        [x * width, f64::from(self.map[1]) - y * height]
    }

    /// How much longer a metre is drawn to the north than to the east.
    pub(super) fn stretch(&self) -> f64 {
        let [width, height] = self.cell();
        height / width
    }

    pub(super) fn edge(&self, axis: usize) -> Edge {
        edge(&self.grid, axis, self.map[axis].into())
    }
}

/// An edge of a map, for its ticks.
pub(super) fn edge(grid: &Grid, axis: usize, length_px: f64) -> Edge {
    let cells = [grid.columns, grid.rows][axis];
    let from_m = grid.corner_m[axis];
    Edge { from_m, to_m: from_m + f64::from(cells) * grid.resolution_m, length_px }
}
