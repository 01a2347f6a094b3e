//! Compiles maps and missions into the blob of internalized plans.
//!
//! A map is read into one model ([`maps::Map`]), rasterised, searched from every goal under
//! every set of constraints, packed and written. Readers never stop at the first mistake:
//! they return what they understood and every [`maps::Problem`] they found.

pub mod behaviours;
pub mod boards;
pub mod comms;
pub mod compile;
pub mod cover;
pub mod field;
pub mod goals;

pub mod image;
pub mod input;
pub mod iplan;
pub mod layers;
pub mod mission;
pub mod mutual_waits;
pub mod output;
pub mod pack;
pub mod project;
pub mod recipe;
pub mod render;
pub mod route;
pub mod search;
pub mod team;
pub mod terrain;
pub mod tolls;
pub mod toml;
pub mod trace;
pub mod verify;
pub mod width;
