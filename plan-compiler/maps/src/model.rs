//! The one model that every map format is read into.
//!
//! Coordinates are the map's own metres, x east, y north. A map has exact shapes, cells (from an
//! image or a grid), or both.

use crate::bitmap::Bitmap;
use crate::names::Word;
use math::GeoPoint;
use std::ops::Range;
use std::path::PathBuf;

/// A point, metres.
pub type Point = [f64; 2];

/// A map as its author drew it: exact shapes, and cells only where the file itself has them.
#[derive(Clone, Debug)]
pub struct Map {
    /// The area that plans cover.
    pub extent: Extent,
    /// Everything outside this polygon is blocked.
    pub boundary: Option<Vec<Point>>,
    /// Cell side that the file asks for, metres.
    pub resolution_m: Option<f64>,
    /// Where the map lies on the globe, if the file states it.
    pub reference: Option<Reference>,
    /// Obstacles, attenuating areas and zones.
    pub features: Vec<Feature>,
    /// Cells that the file gives, obstacles in every layer.
    pub cells: Option<CellMap>,
    /// Further files that were read, such as the image of the cells.
    pub files: Vec<PathBuf>,
    /// Named points, the default goals.
    pub points: Vec<NamedPoint>,
    /// Where robots start (an overlay's StartPlace, OPAR's reference point).
    pub start: Option<NamedPoint>,
    /// The file's own title.
    pub title: Option<String>,
    /// How radio is attenuated, if the file gives the coefficients.
    pub radio: Option<Radio>,
    /// Other facts that the file states and the compiler does not use, as `name value`.
    pub remarks: Vec<String>,
    /// Whether the format's robots are points, so that obstacles are not grown by default.
    pub is_for_points: bool,
}

/// A rectangle of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// South-west corner, metres.
    pub corner: Point,
    /// Width and height, metres.
    pub size: Point,
}

/// Where a map lies on the globe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// WGS-84 position of `at`.
    pub place: GeoPoint,
    /// Point of the map that lies at `place`, metres.
    pub at: Point,
    /// Direction of the map's y axis, radians clockwise from true north.
    pub heading_rad: f64,
}

/// Coefficients of radio attenuation, as an OPAR scenario states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radio {
    /// OPAR's `K1`, not used. Its meaning and unit are not known: no specification could be found.
    pub k1: f64,
    /// OPAR's `K2`, as unknown as `k1`.
    pub k2: f64,
    /// How foliage attenuates.
    pub foliage: FoliageLoss,
}

/// Loss of radio in foliage by Weissberger's model (M. A. Weissberger, ESD-TR-81-101, 1982).
///
/// That OPAR's section 4 holds this model is inferred from its field names. Weissberger's own
/// values are a cutoff of 14 m, `near` 0.45, 0.284, 1 and `far` 1.33, 0.284, 0.588; they hold for
/// 230 MHz to 95 GHz and up to 400 m of foliage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoliageLoss {
    /// Depth of foliage up to which `near` applies, metres; `far` applies beyond it.
    pub cutoff_m: f64,
    /// Loss up to the cutoff.
    pub near: LossTerm,
    /// Loss beyond the cutoff.
    pub far: LossTerm,
}

/// Loss in decibels: `a * f^b * d^c`, frequency f in GHz, depth of foliage d in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LossTerm {
    /// Decibels at 1 GHz and 1 m.
    pub a: f64,
    /// Exponent of the frequency.
    pub b: f64,
    /// Exponent of the depth.
    pub c: f64,
}

/// Cells that a file gives. Row 0 is in the south.
#[derive(Clone, Debug, PartialEq)]
pub struct CellMap {
    /// Side of a cell, metres.
    pub resolution_m: f64,
    /// South-west corner of the cell in column 0 and row 0, metres.
    pub corner: Point,
    /// Cells that hold an obstacle.
    pub occupied: Bitmap,
    /// Cells that the file marks unknown; disjoint from `occupied`.
    pub unknown: Bitmap,
    /// How unknown cells are treated.
    pub unknown_as: Unknown,
    /// Counts of the file's own cells, if these were rotated.
    pub turned_from: Option<Counts>,
}

/// Size of a cell map and number of cells of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Cells from west to east.
    pub columns: u32,
    /// Cells from south to north.
    pub rows: u32,
    /// Cells that are neither occupied nor unknown.
    pub free: usize,
    /// Cells that hold an obstacle.
    pub occupied: usize,
    /// Cells that the file marks unknown.
    pub unknown: usize,
}

/// How cells that the map marks unknown are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unknown {
    /// Never entered.
    #[default]
    Obstacle,
    /// Driven on.
    Free,
}

impl Word for Unknown {
    const WORDS: &'static [(&'static str, &'static str, Self)] =
        &[("obstacle", "Never enter", Self::Obstacle), ("free", "Drive on", Self::Free)];
}

impl CellMap {
    /// Cells from west to east.
    pub fn columns(&self) -> u32 {
        self.occupied.columns()
    }

    /// Cells from south to north.
    pub fn rows(&self) -> u32 {
        self.occupied.rows()
    }

    /// Number of cells of each kind.
    pub fn counts(&self) -> Counts {
        let (columns, rows) = (self.columns(), self.rows());
        let (occupied, unknown) = (self.occupied.count(), self.unknown.count());
        let free = columns as usize * rows as usize - occupied - unknown;
        Counts { columns, rows, free, occupied, unknown }
    }

    /// The rectangle that the cells cover.
    pub fn extent(&self) -> Extent {
        let size = [self.columns(), self.rows()].map(|cells| f64::from(cells) * self.resolution_m);
        Extent { corner: self.corner, size }
    }

    /// The cells that must not be entered.
    pub fn blocked(&self) -> Bitmap {
        match self.unknown_as {
            Unknown::Free => self.occupied.clone(),
            Unknown::Obstacle => {
                let mut blocked = self.occupied.clone();
                blocked.add_all(&self.unknown);
                blocked
            }
        }
    }
}

/// A shape with a meaning.
#[derive(Clone, Debug)]
pub struct Feature {
    /// Its geometry.
    pub shape: Shape,
    /// What it means to a planner.
    pub role: Role,
    /// Its name in the file, or empty.
    pub name: String,
    /// Height above ground, metres, if the file gives it.
    pub height_m: Option<f64>,
    /// Bytes of the file that define it.
    pub span: Range<usize>,
}

/// What a feature means to a planner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Never enter.
    Obstacle,
    /// Weakens radio; an obstacle in layer `comms` only.
    Attenuating,
    /// Has no effect unless the mission names it.
    Zone,
}

/// The exact geometry of a feature.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A filled circle, metres.
    Circle {
        /// Centre.
        centre: Point,
        /// Radius.
        radius: f64,
    },
    /// A line without width through two or more points; closed if the first equals the last.
    Polyline(Vec<Point>),
    /// A filled polygon, rings closed implicitly: the first is the outer one, others are holes.
    Polygon(Vec<Vec<Point>>),
}

/// A point with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPoint {
    /// Its name, trimmed, without a trailing `*`.
    pub name: String,
    /// Position, metres.
    pub at: Point,
    /// Bytes of the file that define it.
    pub span: Range<usize>,
}

impl Map {
    /// A map with an extent and nothing in it.
    pub fn empty(extent: Extent) -> Self {
        Self {
            extent,
            boundary: None,
            resolution_m: None,
            reference: None,
            features: Vec::new(),
            cells: None,
            files: Vec::new(),
            points: Vec::new(),
            start: None,
            title: None,
            radio: None,
            remarks: Vec::new(),
            is_for_points: false,
        }
    }

    /// A map that consists of cells only and has their resolution.
    pub fn of_cells(cells: CellMap) -> Self {
        let map = Self::empty(cells.extent());
        Self { resolution_m: Some(cells.resolution_m), cells: Some(cells), ..map }
    }

    /// Whether the map has areas that weaken radio.
    pub fn has_attenuating_areas(&self) -> bool {
        self.features.iter().any(|feature| feature.role == Role::Attenuating)
    }
}
