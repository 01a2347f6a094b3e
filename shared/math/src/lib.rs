//! Mathematics that gives the same bits on a PC, a Cortex-M3 and a Cortex-M4F.
//!
//! This crate is the only caller of floating-point functions in Wayfield: elsewhere
//! clippy refuses `x.sin()`, because on a host that name silently becomes the
//! platform's own, and the host would then test other arithmetic than the robot
//! runs. Trigonometry comes from `micromath`, square roots and everything in `f64`
//! from `libm`; both are plain Rust, compiled from the same source for every target.
//!
//! Invariants: no function panics; a NaN comes out only where one went in.
//! Deliberately absent: trait extensions (`x.sin()` must never compile here by
//! accident), matrices, anything with an allocator.
#![no_std]

pub mod geodetic;
pub mod grid;
pub mod scalar;
pub mod vector;

pub use geodetic::{GeoPoint, MapFrame};
pub use grid::{Cell, Direction, Grid};
pub use vector::{Pose, Vec2};
