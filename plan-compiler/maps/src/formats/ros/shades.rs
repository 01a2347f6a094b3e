//! The shades of an image as numbers from 0 to 100, as the occupancy of a ROS map: masks and costs.
//!
//! With a YAML file, the image lies on the map by the file's resolution, origin and yaw, and its
//! mode decides as in Nav2: `trinary` gives 0 and 100, `scale` also whole numbers between the
//! thresholds, `raw` the grey itself. What is unknown has no number. An image alone has no place: it
//! fits a grid with as many columns and rows, and its darkness in percent is the number.

use super::image::{self, Grey};
use super::settings::{self, Mode, Settings};
use super::{Kind, grey_of, kind, occupancy};
use crate::formats::turn::quarters;
use crate::model::Point;
use crate::problem::{Problem, Source};
use crate::raster::NOISE;
use crate::source;
use math::scalar::wide;
use math::{Cell, Grid};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The number of a white pixel of an image, 0, to that of a black one.
pub const DARKEST: u8 = 100;
/// Stands for a pixel without a number.
const UNKNOWN: u8 = u8::MAX;

/// An image whose shades are numbers from 0 to [`DARKEST`].
#[derive(Clone, Debug)]
pub struct Shades {
    /// The file of the image.
    pub image: PathBuf,
    /// Pixels from west to east.
    pub columns: u32,
    /// Pixels from south to north.
    pub rows: u32,
    /// Row by row from the south.
    numbers: Vec<u8>,
    placement: Option<Placement>,
}

/// Where an image lies on the plane.
#[derive(Clone, Copy, Debug)]
struct Placement {
    resolution_m: f64,
    /// South-west corner, about which the image is rotated.
    corner: Point,
    /// Sine and cosine of the rotation, counter-clockwise.
    sin_cos: [f64; 2],
}

/// A set of numbers from 0 to [`DARKEST`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Numbers(u128);

impl Numbers {
    fn add(&mut self, number: u8) {
        if number <= DARKEST {
            self.0 |= 1 << number;
        }
    }

    /// The numbers, the lowest first.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (0..=DARKEST).filter(move |number| self.0 >> number & 1 == 1)
    }
}

impl Shades {
    /// Whether it says something about the cells of a grid: an image without a place needs as many
    /// pixels.
    pub fn fits(&self, grid: &Grid) -> bool {
        self.placement.is_some() || (self.columns, self.rows) == (grid.columns, grid.rows)
    }

    /// The numbers of all pixels that a cell of a grid overlaps.
    pub fn over(&self, grid: &Grid, cell: Cell) -> Numbers {
        let mut numbers = Numbers::default();
        let Some(Placement { resolution_m, corner, sin_cos: [sin, cos] }) = self.placement else {
            numbers.add(self.number(cell.column.into(), cell.row.into()));
            return numbers;
        };
        // In pixels: half a side of the cell, and its centre.
        let half = 0.5 * grid.resolution_m / resolution_m;
        let [x, y] = grid.centre(cell);
        let [x, y] = [(x - corner[0]) / resolution_m, (y - corner[1]) / resolution_m];
        let centre = [cos * x + sin * y, cos * y - sin * x];
        // Two squares overlap if the distance of their centres is below the sum of their half widths
        // along the axes of both (separating axes).
        let wide_by = sin.abs() + cos.abs();
        let along_pixels = 0.5 + half * wide_by - NOISE;
        let along_cells = half + 0.5 * wide_by - NOISE;
        let near = |at: f64, count: u32| {
            let limit = f64::from(count);
            let first = wide::floor(at - along_pixels - 0.5).clamp(0.0, limit) as u32;
            first..wide::ceil(at + along_pixels + 0.5).clamp(0.0, limit) as u32
        };
        for row in near(centre[1], self.rows) {
            for column in near(centre[0], self.columns) {
                let apart = [column, row].map(|at| f64::from(at) + 0.5);
                let [dx, dy] = [apart[0] - centre[0], apart[1] - centre[1]];
                let turned = [cos * dx - sin * dy, sin * dx + cos * dy];
                let is_near = |[x, y]: Point, reach: f64| x.abs() < reach && y.abs() < reach;
                if is_near([dx, dy], along_pixels) && is_near(turned, along_cells) {
                    numbers.add(self.number(column.into(), row.into()));
                }
            }
        }
        numbers
    }

    /// Whether any cell of a grid overlaps any pixel.
    pub fn overlaps(&self, grid: &Grid) -> bool {
        let Some(Placement { resolution_m, corner, sin_cos: [sin, cos] }) = self.placement else {
            return true;
        };
        let [width, height] = [self.columns, self.rows].map(|n| f64::from(n) * resolution_m);
        let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        let corners =
            corners.map(|[x, y]| [corner[0] + cos * x - sin * y, corner[1] + sin * x + cos * y]);
        (0..2).all(|axis| {
            let side = f64::from([grid.columns, grid.rows][axis]) * grid.resolution_m;
            let all = corners.iter().map(|at| at[axis]);
            let (low, high) = (all.clone().reduce(f64::min), all.reduce(f64::max));
            let low = low.is_some_and(|low| low < grid.corner_m[axis] + side);
            low && high.is_some_and(|high| high > grid.corner_m[axis])
        })
    }

    /// The number of grey pixels: those between 0 and [`DARKEST`].
    pub fn greys(&self) -> usize {
        self.numbers.iter().filter(|&&number| 0 < number && number < DARKEST).count()
    }

    fn number(&self, column: u64, row: u64) -> u8 {
        let index = row * u64::from(self.columns) + column;
        self.numbers.get(index as usize).copied().unwrap_or(UNKNOWN)
    }
}

/// Reads a ROS map's YAML file with its image, or an image alone; and every mistake.
pub fn read_shades(path: &Path) -> (Option<Shades>, Vec<Problem>) {
    let bytes = match source::read_bytes(path) {
        Ok(bytes) => bytes,
        Err(problem) => return (None, vec![problem]),
    };
    if image::is_image(&bytes) {
        return match image::decode(path, &bytes) {
            Ok(grey) => (Some(of_image(&grey)), Vec::new()),
            Err(reason) => {
                let message = format!("{} cannot be read as an image: {reason}", path.display());
                (None, vec![Problem::error(message).help(image::HELP)])
            }
        };
    }
    match source::decode(path, bytes) {
        Ok((text, mut problems)) => {
            let (shades, more) = of_yaml(path, &text);
            problems.extend(more);
            (shades, problems)
        }
        Err(problem) => (None, vec![problem.help("name a ROS map, a YAML file, or its image")]),
    }
}

fn of_image(grey: &Grey) -> Shades {
    let number = |pixel: (f64, bool)| {
        let (light, is_transparent) = pixel;
        if is_transparent { UNKNOWN } else { percent(1.0 - light) }
    };
    shades(grey, None, number)
}

fn of_yaml(path: &Path, source: &Arc<Source>) -> (Option<Shades>, Vec<Problem>) {
    let mut problems = Vec::new();
    let settings = settings::parse(source, &mut problems);
    let grey = settings.image.as_ref().and_then(|name| {
        image::read(path, source, name).map_err(|problem| problems.push(problem)).ok()
    });
    let (Some(grey), Some(resolution_m), Some([x, y, yaw])) =
        (grey, settings.resolution_m, settings.origin)
    else {
        return (None, problems);
    };
    problems.extend(between(&grey, &settings));
    let farthest = f64::from(grey.columns) + f64::from(grey.rows);
    let sin_cos = match quarters(yaw, farthest) {
        Some(quarters) => [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]][quarters],
        None => [wide::sin(yaw), wide::cos(yaw)],
    };
    let placement = Placement { resolution_m, corner: [x, y], sin_cos };
    (Some(shades(&grey, Some(placement), |pixel| number(&settings, pixel))), problems)
}

fn shades(grey: &Grey, placement: Option<Placement>, number: impl Fn((f64, bool)) -> u8) -> Shades {
    let (columns, rows) = (grey.columns, grey.rows);
    // The image's first row is the northernmost.
    let all = (0..rows).rev().flat_map(|row| (0..columns).map(move |column| (column, row)));
    let numbers = all.map(|(column, row)| number(grey.pixel(column, row))).collect();
    Shades { image: grey.path.clone(), columns, rows, numbers, placement }
}

fn percent(share: f64) -> u8 {
    (share.clamp(0.0, 1.0) * f64::from(DARKEST)).round() as u8
}

/// The number of a pixel by the file's mode.
fn number(settings: &Settings, pixel: (f64, bool)) -> u8 {
    let (light, is_transparent) = pixel;
    if settings.mode == Mode::Raw {
        let grey = grey_of(light);
        return if grey > f64::from(DARKEST) { UNKNOWN } else { grey as u8 };
    }
    match kind(settings, pixel) {
        Kind::Free => 0,
        Kind::Occupied => DARKEST,
        Kind::Unknown if settings.mode == Mode::Scale && !is_transparent => {
            let width = settings.occupied_thresh - settings.free_thresh;
            percent((occupancy(settings, light) - settings.free_thresh) / width)
        }
        Kind::Unknown => UNKNOWN,
    }
}

/// A warning if greys have no number because of the mode.
fn between(grey: &Grey, settings: &Settings) -> Option<Problem> {
    if settings.mode != Mode::Trinary {
        return None;
    }
    let pixels = (0..grey.rows).flat_map(|row| (0..grey.columns).map(move |column| (column, row)));
    let pixels = pixels.map(|(column, row)| grey.pixel(column, row));
    let is_lost = |pixel: &(f64, bool)| {
        !pixel.1 && *pixel != super::UNKNOWN_PIXEL && kind(settings, *pixel) == Kind::Unknown
    };
    let count = pixels.filter(is_lost).count();
    let message = format!("{count} grey pixels have no effect: in mode trinary they are unknown");
    (count > 0).then(|| {
        Problem::warning(message).help(
            "write `mode: scale` in the YAML file, with free_thresh: 0 and occupied_thresh: 1",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 0, 40, 70 and 100 percent of grey from west to east, north of white, transparent or not.
    const GREYS: &[u8] = b"P2 4 2 255 255 153 77 0 255 255 255 205";

    fn yaml(mode: &str, origin: &str) -> String {
        format!(
            "image: a.pgm\nresolution: 1\norigin: [{origin}]\nnegate: 0\noccupied_thresh: 1.0\n\
             free_thresh: 0.0\nmode: {mode}\n"
        )
    }

    fn read(files: &[(&str, &[u8])], name: &str) -> (Option<Shades>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let (shades, problems) = read_shades(&folder.path().join(name));
        let folder = format!("{}/", folder.path().display());
        (shades, problems.iter().map(|p| p.to_string().replace(&folder, "")).collect())
    }

    fn placed(mode: &str, origin: &str) -> Shades {
        let text = yaml(mode, origin);
        read(&[("a.pgm", GREYS), ("a.yaml", text.as_bytes())], "a.yaml").0.unwrap()
    }

    fn grid(columns: u32, rows: u32, resolution_m: f64) -> Grid {
        Grid { columns, rows, resolution_m, corner_m: [0.0; 2] }
    }

    /// The numbers over each cell, row by row from the north.
    fn numbers(shades: &Shades, grid: &Grid) -> Vec<Vec<u8>> {
        let cells =
            (0..grid.rows).rev().flat_map(|row| (0..grid.columns).map(move |c| Cell::new(c, row)));
        cells.map(|cell| shades.over(grid, cell).iter().collect()).collect()
    }

    #[test]
    fn shades_are_occupancies_as_in_nav2() {
        let all = |mode| numbers(&placed(mode, "0, 0, 0"), &grid(4, 2, 1.0)).concat();
        assert_eq!(all("scale"), [0, 40, 70, 100, 0, 0, 0, 20]);
        assert_eq!(all("trinary"), [0, 100, 0, 0, 0]);
        // Of the greys, only 77 and 0 are at most 100.
        assert_eq!(all("raw"), [77, 0]);
    }

    #[test]
    fn an_image_alone_fits_as_many_cells() {
        let (shades, problems) = read(&[("a.pgm", GREYS)], "a.pgm");
        assert_eq!(problems, [""; 0]);
        let shades = shades.unwrap();
        assert!(shades.fits(&grid(4, 2, 0.3)) && !shades.fits(&grid(2, 4, 0.3)));
        assert_eq!(numbers(&shades, &grid(4, 2, 0.3)).concat(), [0, 40, 70, 100, 0, 0, 0, 20]);
    }

    #[test]
    fn a_cell_has_the_numbers_of_all_pixels_that_it_overlaps() {
        let shades = placed("scale", "0, 0, 0");
        assert_eq!(numbers(&shades, &grid(2, 1, 2.0)), [vec![0, 40], vec![0, 20, 70, 100]]);
        assert_eq!(
            numbers(&shades, &grid(5, 1, 0.5)),
            [vec![0], vec![0], vec![0], vec![0], vec![0]]
        );
        // Turned by a quarter about 2, 0: the image's east is in the north.
        let turned = placed("scale", "2, 0, 1.5708");
        let expected = [100, 20, 70, 0, 40, 0, 0, 0];
        assert_eq!(numbers(&turned, &grid(2, 4, 1.0)).concat(), expected);
        let beside = placed("scale", "2.5, 0, 0");
        assert!(beside.overlaps(&grid(3, 2, 1.0)) && !beside.overlaps(&grid(2, 2, 1.0)));
        assert_eq!(numbers(&beside, &grid(3, 1, 1.0)), [vec![], vec![], vec![0]]);
    }

    #[test]
    fn mistakes_are_named() {
        let check = |files: &[(&str, &[u8])], name: &str, expected: &str| {
            let (shades, problems) = read(files, name);
            assert!(problems.iter().any(|p| p.contains(expected)), "{problems:?}");
            shades.is_some()
        };
        assert!(!check(&[], "a.pgm", "there is no file a.pgm"));
        assert!(!check(&[("a.pgm", b"P5 3 2 255 x")], "a.pgm", "cannot be read as an image"));
        assert!(!check(&[("a.txt", b"Dear reader,\n")], "a.txt", "no `key: value` lines"));
        assert!(!check(&[("a.bin", b"\0\0\0")], "a.bin", "not a text file"));
        let text = yaml("trinary", "0, 0, 0");
        let files: [(&str, &[u8]); 2] = [("a.pgm", GREYS), ("a.yaml", text.as_bytes())];
        assert!(check(&files, "a.yaml", "2 grey pixels have no effect"));
    }

    proptest! {
        /// Against points: a point inside a cell is inside one of the pixels that the cell overlaps.
        #[test]
        fn no_pixel_below_a_point_of_a_cell_is_missed(
            yaw in -7.0f64..7.0, x in -3.0f64..3.0, side in 0.2f64..3.0, along in (0.01f64..0.99, 0.01f64..0.99),
            column in 0u32..6, row in 0u32..6,
        ) {
            let origin = format!("{x}, 0.25, {yaw}");
            let shades = placed("scale", &origin);
            let grid = grid(6, 6, side);
            let cell = Cell::new(column, row);
            let point = [
                (f64::from(column) + along.0) * side - x,
                (f64::from(row) + along.1) * side - 0.25,
            ];
            let (sin, cos) = (wide::sin(yaw), wide::cos(yaw));
            let [u, v] = [cos * point[0] + sin * point[1], cos * point[1] - sin * point[0]];
            if (0.0..4.0).contains(&u) && (0.0..2.0).contains(&v) {
                let number = shades.number(u as u64, v as u64);
                prop_assert!(shades.over(&grid, cell).iter().any(|n| n == number));
            }
        }
    }
}
