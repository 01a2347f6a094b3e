//! Compiles maps and missions into the blob of internalized plans.
//!
//! A map is read into one model ([`map::Map`]), rasterised, searched from every goal under
//! every set of constraints, packed and written. Readers never stop at the first mistake:
//! they return what they understood and every [`problem::Problem`] they found.

pub mod behaviours;
pub mod bitmap;
pub mod boards;
pub mod compile;
mod escape;
pub mod formats;
pub mod image;
pub mod map;
pub mod mission;
pub mod output;
pub mod pack;
pub mod problem;
pub mod raster;
pub mod recipe;
pub mod render;
pub mod route;
pub mod search;
pub mod source;
pub mod terminal;
pub mod trace;
pub mod verify;
