//! The blob: what the compiler writes and the robot reads in place.
//!
//! See `FORMAT.md` beside this crate for the bytes. [`Blob::parse`] validates everything
//! once; after that no look-up can fail. A blob that is truncated, flipped, too big for
//! this build or from another version is refused with a [`BlobError`].
//!
//! Deliberately absent: allocation, `unsafe`, and (without the `std` feature) the writer.
#![cfg_attr(not(feature = "std"), no_std)]

pub mod grid;
pub mod limits;
pub mod parameters;

pub use grid::{Cell, Direction, Grid};
pub use parameters::Parameters;
