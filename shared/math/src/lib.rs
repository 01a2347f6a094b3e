//! Mathematics that gives the same bits on a PC, a Cortex-M3 and a Cortex-M4F.
//!
//! Defines scalar functions ([`scalar`]), plane vectors ([`vector`]), the cell grid with its
//! directions and costs ([`grid`]), and the map frame that turns latitude and longitude into map
//! metres ([`geodetic`]).
//!
//! ```
//! use math::{Cell, Direction, Grid, scalar, vector};
//! let grid = Grid { columns: 20, rows: 10, resolution_m: 0.5, corner_m: [0.0, 0.0] };
//! let cell = grid.cell_at(1.2, 0.3).unwrap();
//! assert_eq!(cell, Cell::new(2, 0));
//! let east = cell.neighbour(Direction::E, grid.columns, grid.rows).unwrap();
//! assert_eq!(grid.centre(east), [1.75, 0.25]);
//! let error_rad = vector::angle(Direction::NE.unit()) - scalar::PI / 4.0;
//! assert!(error_rad.abs() < 5e-3);
//! ```
//!
//! This crate is the only caller of floating-point functions in Wayfield. Clippy refuses
//! `x.sin()` everywhere else: on a host that name is the platform's own function, and tests on
//! the host would check other arithmetic than the robot runs. Trigonometry comes from
//! `micromath`, square roots and everything in `f64` from `libm`; both are plain Rust, compiled
//! from the same source for every target.
//!
//! Invariants: no function panics; the result is NaN only if an argument is.
//!
//! Source: WGS-84 for the globe; W (Wagner and Arkin, "Internalized Plans for
//! Communication-Sensitive Robot Team Behaviors"), section 2, for the eight directions.
//!
//! Deliberately absent: trait extensions (`x.sin()` must never compile by accident), matrices,
//! allocation.
#![no_std]

pub mod geodetic;
pub mod grid;
pub mod scalar;
pub mod vector;

pub use geodetic::{GeoPoint, MapFrame};
pub use grid::{Cell, Direction, Grid};
pub use vector::Vec2;
