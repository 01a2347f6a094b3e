//! All integration tests in one binary: they test the built programs and the crates' boundaries.

mod behaviours;
mod blob;
mod boards;
mod circles;
mod clearance;
mod cli;
mod convert;
mod cover;
mod driving;
mod fields;
mod formats;
mod glossary;
mod goals;
mod how_to_add;
mod layering;
mod missions;
mod opar;
mod overlays;
mod qemu;
mod runs;
mod team;
mod team_plans;
mod team_qemu;
mod wording;
mod work;
mod worlds;
