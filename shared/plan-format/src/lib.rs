//! The blob: what the compiler writes and the robot reads in place.
//!
//! See `FORMAT.md` beside this crate for the bytes. [`Blob::parse`] validates everything
//! once; after that no look-up can fail. A blob that is truncated, flipped, too big for
//! this build or from another version is refused with a [`BlobError`].
//!
//! Deliberately absent: allocation, `unsafe`, and (without the `std` feature) the writer.
#![cfg_attr(not(feature = "std"), no_std)]

mod blob;
mod blocks;
mod bytes;
mod directory;
mod error;
#[cfg(feature = "std")]
pub mod field;
pub mod grid;
mod header;
mod layer;
pub mod limits;
pub mod mission;
#[cfg(feature = "std")]
mod pack;
pub mod parameters;
mod work;
#[cfg(feature = "std")]
mod write;

pub use blob::{Blob, ParallelPlan};
pub use directory::{Counts, Origin, is_name};
pub use error::BlobError;
pub use grid::{Cell, Direction, Grid};
pub use header::{FORMAT_VERSION, MAGIC};
pub use layer::{Answer, Layer, Step};
pub use parameters::Parameters;

#[cfg(feature = "std")]
pub use field::Field;
#[cfg(feature = "std")]
pub use pack::{PackedLayer, pack};
#[cfg(feature = "std")]
pub use write::{Draft, LayerDraft, PlanDraft, WriteError, recipe, write, write_with_recipe};
