//! The gain-weighted sum of all schemas.

use math::Vec2;
use plan_format::parameters::{Gains, SchemaParameters};

/// What the schemas say in one tick, in the map's axes, without units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vectors {
    /// Of move-to-goal.
    pub goal: Vec2,
    /// Of avoid-static-obstacle.
    pub avoid: Vec2,
    /// Of follow-plan.
    pub advice: Vec2,
    /// Of noise.
    pub noise: Vec2,
}

/// `r (goal gain x goal + avoid gain x avoid) + p advice + n noise`.
///
/// A weight of 0 silences its schemas to the bit. Source: W, section 4, where r and p are
/// 1:0, 0.66:0.34, 0.34:0.66 and 0:1 and n is 0.11.
pub fn blend(gains: &Gains, schemas: &SchemaParameters, vectors: &Vectors) -> Vec2 {
    let reactive = vectors.goal * schemas.goal_gain + vectors.avoid * schemas.avoid_gain;
    reactive * gains.reactive + vectors.advice * gains.plan + vectors.noise * gains.noise
}
