//! Maps: read from many formats into one model, and made into cells.
//!
//! ```text
//! file --formats--> Map (exact shapes, metres) --raster--> Bitmap (cells)
//! ```
//!
//! [`formats::load`] finds out which format a file is in and reads it. Readers never stop at the
//! first mistake: they return what they understood and every [`Problem`] they found, each with its
//! place in the file, what is wrong, and help. [`raster`] decides exactly which cells a shape
//! touches once it is grown by a robot's radius.
//!
//! Deliberately absent: goals, layers and searches, which are the compiler's, and a command line.

pub mod bitmap;
pub mod formats;
pub mod model;
pub mod names;
pub mod numbers;
pub mod problem;
pub mod raster;
pub mod source;
pub mod terminal;

pub use bitmap::Bitmap;
pub use model::{
    CellMap, Counts, Extent, Feature, FoliageLoss, LossTerm, Map, NamedPoint, Point, Radio,
    Reference, Role, Shape, Unknown,
};
pub use problem::{Problem, Severity, Source};
