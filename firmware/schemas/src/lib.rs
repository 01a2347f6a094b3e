//! Motor schemas: each turns what the robot perceives into a vector; their sum is the motion.
//!
//! | schema | its vector |
//! |---|---|
//! | [`move_to_goal()`] | unit vector to the goal; zero within the tolerance |
//! | [`avoid_static_obstacle()`] | away from the nearest point of each surface |
//! | [`Noise`] | unit vector of random heading, held for some ticks |
//! | [`follow_plan()`] | unit vector of the plan's advice |
//!
//! [`blend()`] is the paper's sum: `r (goal + avoid) + p advice + 0.11 noise`.
//!
//! Invariants: pure; total; finite arguments give finite vectors; no schema knows another.
//!
//! Sources: Arkin 1989, "Motor schema-based mobile robot navigation", for the formulas; W
//! (Wagner and Arkin, "Internalized Plans ..."), section 4, for the weights.
//!
//! Deliberately absent: speeds, headings and bodies (the controller's drive module turns the
//! blended vector into motion), memory of places.
#![no_std]

pub mod avoid_static_obstacle;
pub mod blend;
pub mod follow_plan;
pub mod move_to_goal;
pub mod noise;

pub use avoid_static_obstacle::{Repulsion, avoid_static_obstacle};
pub use blend::{Vectors, blend};
pub use follow_plan::follow_plan;
pub use move_to_goal::move_to_goal;
pub use noise::Noise;
