//! Motor schemas: each turns percepts into a vector; their blend steers the robot.
//!
//! | schema | its vector |
//! |---|---|
//! | [`move_to_goal()`] | unit vector to the goal; zero within the tolerance |
//! | [`avoid_static_obstacle()`] | away from the nearest point of each surface |
//! | [`avoid_robot()`] | away from each mate |
//! | [`tether()`] | towards a mate that is too far away |
//! | [`move_ahead()`] | unit vector in a fixed direction |
//! | [`docking()`] | around a dock to its front, then into it |
//! | [`Past`] | away from places where the robot has just been |
//! | [`Noise`] | unit vector of random heading, constant for some ticks |
//! | [`follow_plan()`] | unit vector of the plan's advice |
//!
//! [`blend()`] is the paper's sum: `r (goal + avoid) + p advice + 0.11 noise`.
//!
//! ```
//! use math::Vec2;
//! use plan_format::parameters::Gains;
//! use plan_format::{Direction, Parameters};
//! use schemas::{Vectors, blend, follow_plan, move_to_goal};
//! // The goal is in the east, the plan advises north, nothing is near.
//! let vectors = Vectors {
//!     goal: move_to_goal(Vec2::zeros(), Vec2::new(9.0, 0.0), 1.0),
//!     avoid: Vec2::zeros(),
//!     robots: Vec2::zeros(),
//!     past: Vec2::zeros(),
//!     advice: follow_plan(Some(Direction::N)),
//!     noise: Vec2::zeros(),
//! };
//! let sum = blend(&Gains::MOSTLY_PLAN, &Parameters::default().schemas, &vectors);
//! assert_eq!(sum, Vec2::new(0.34, 0.66));
//! ```
//!
//! Invariants: pure; total; finite arguments give finite vectors; no schema knows another.
//!
//! Sources: Arkin 1989, "Motor schema-based mobile robot navigation", for the formulas; W
//! (Wagner and Arkin, "Internalized Plans ..."), section 4, for the weights.
//!
//! Deliberately absent: speeds, headings and bodies (the controller's `drive` module turns the
//! blended vector into speed and turn rate).
#![no_std]

pub mod avoid_static_obstacle;
pub mod blend;
pub mod docking;
pub mod follow_plan;
pub mod move_ahead;
pub mod move_to_goal;
pub mod noise;
pub mod past;
pub mod robots;

pub use avoid_static_obstacle::{Repulsion, avoid_static_obstacle};
pub use blend::{Vectors, blend};
pub use docking::{Dock, docking, is_docked};
pub use follow_plan::follow_plan;
pub use move_ahead::move_ahead;
pub use move_to_goal::move_to_goal;
pub use noise::Noise;
pub use past::Past;
pub use robots::{avoid_robot, tether};
