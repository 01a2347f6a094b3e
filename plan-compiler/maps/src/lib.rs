//! Reads maps of many formats into one model, and rasterises that model into cells.
//!
//! ```text
//! file --formats--> Map (exact shapes, metres) --raster--> Bitmap (blocked cells)
//! ```
//!
//! This library stands alone: it needs neither the compiler nor the firmware.
//!
//! - [`formats`] detects the format of a file and reads it. A reader does not stop at the first
//!   mistake: it returns the map as far as it understood the file, and every [`Problem`].
//! - [`model`] is the [`Map`]: shapes with a role, the file's own cells, named points, and the place
//!   on the globe.
//! - [`radio`] computes whether two antennas are linked, and the loss between them.
//! - [`raster`] decides exactly which cells a shape touches after it is grown by a robot's radius.
//! - [`problem`] describes a mistake with its place in the file and how to fix it, and draws it for
//!   a terminal.
//!
//! ```
//! use maps::formats::{ReadOptions, load_bytes};
//! use maps::raster::{RasterOptions, rasterise};
//! use maps::{Cell, Grid, Role, problem};
//! use std::path::Path;
//!
//! // MovingAI's format: rows from the north, `.` free, `@` and `T` blocked, cells of 1 m.
//! let text = "type octile\nheight 3\nwidth 4\nmap\n...T\n....\n@...\n";
//! let loaded = load_bytes(Path::new("yard.map"), text.into(), &ReadOptions::default());
//! assert!(!problem::has_errors(&loaded.problems), "{}", problem::draw(&loaded.problems, false));
//! let map = loaded.map.expect("a map, since there are no errors");
//!
//! // Rasterise for a robot of 0.4 m radius, on cells of half a metre.
//! let corner_m = map.extent.corner;
//! let grid = Grid { columns: 8, rows: 6, resolution_m: 0.5, corner_m };
//! let options = RasterOptions { robot_radius_m: 0.4, ..RasterOptions::default() };
//! let blocked = rasterise(&map, &grid, &|feature| feature.role == Role::Obstacle, &options);
//!
//! // Row 0 is in the south: the blocked cell `@` covers columns and rows 0 and 1.
//! assert!(blocked.get(Cell::new(1, 1)));
//! assert!(blocked.get(Cell::new(2, 1)), "within the robot's radius");
//! assert!(!blocked.get(Cell::new(3, 1)));
//! ```
//!
//! Deliberately absent: goals, layers and searches, which are the compiler's, and a command line.

pub mod bitmap;
pub mod formats;
pub mod model;
pub mod names;
pub mod numbers;
pub mod problem;
pub mod radio;
pub mod raster;
pub mod source;
pub mod terminal;

pub use bitmap::Bitmap;
pub use math::{Cell, GeoPoint, Grid};
pub use model::{
    CellMap, Counts, Extent, Feature, FoliageLoss, LossTerm, Map, NamedPoint, Point, Radio,
    Reference, Role, Shape, Unknown,
};
pub use problem::{Problem, Severity, Source};
