//! The blob: what the compiler writes and the robot reads in place.
//!
//! See `FORMAT.md` beside this crate for the bytes. [`Blob::parse`] validates everything
//! once; after that no look-up can fail. A blob that is truncated, flipped, too big for
//! this build or from another version is refused with a [`BlobError`].
//!
//! Deliberately absent: allocation, `unsafe`, and (without the `std` feature) the writer.
//! What a layer's words are is a packer's choice: the compiler has one. Here is only their
//! [`layout`].
#![cfg_attr(not(feature = "std"), no_std)]

mod blob;
mod directory;
mod error;
mod layer;
pub mod layout;
pub mod limits;
pub mod mission;
mod names;
#[cfg(feature = "std")]
mod packed;
pub mod parameters;
mod plane;
pub mod record;
mod seal;
mod words;
mod work;
#[cfg(feature = "std")]
mod write;

pub use blob::{Blob, ParallelPlan};
pub use directory::{Counts, Origin};
pub use error::BlobError;
pub use layer::{Answer, Layer, Step};
pub use math::grid::{self, Cell, Direction, Grid};
pub use names::is_name;
pub use parameters::Parameters;
pub use seal::{FORMAT_VERSION, MAGIC};

#[cfg(feature = "std")]
pub use packed::{PackedLayer, PackedPlane, Superblock};
#[cfg(feature = "std")]
pub use write::{Draft, LayerDraft, PlanDraft, WriteError, recipe, write, write_with_recipe};
