//! The gain-weighted sum of all schemas.

use math::Vec2;
use plan_format::parameters::{Gains, SchemaParameters};

/// The vectors of the schemas in one tick, in the map's axes, without units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vectors {
    /// Vector of move-to-goal.
    pub goal: Vec2,
    /// Vector of avoid-static-obstacle.
    pub avoid: Vec2,
    /// Vectors of avoid-robot and tether together, with their gains.
    pub robots: Vec2,
    /// Vector of avoid-past.
    pub past: Vec2,
    /// Vector of follow-plan.
    pub advice: Vec2,
    /// Vector of noise.
    pub noise: Vec2,
}

/// `r (goal gain x goal + avoid gain x avoid + robots + past gain x past) + p advice + n noise`.
///
/// With a gain of 0 a schema has no effect, to the bit. Source: W, section 4, where r and p are
/// 1:0, 0.66:0.34, 0.34:0.66 and 0:1 and n is 0.11.
pub fn blend(gains: &Gains, schemas: &SchemaParameters, vectors: &Vectors) -> Vec2 {
    let reactive = vectors.goal * schemas.goal_gain + vectors.avoid * schemas.avoid_gain;
    let reactive = reactive + vectors.robots + vectors.past * schemas.past_gain;
    reactive * gains.reactive + vectors.advice * gains.plan + vectors.noise * gains.noise
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avoid_static_obstacle::SATURATED;
    use plan_format::Parameters;
    use proptest::prelude::*;

    const VECTORS: Vectors = Vectors {
        goal: Vec2::new(0.0, 1.0),
        avoid: Vec2::new(-0.5, 0.0),
        robots: Vec2::new(0.0, 0.0),
        past: Vec2::new(0.0, 0.0),
        advice: Vec2::new(1.0, 0.0),
        noise: Vec2::new(0.0, -1.0),
    };

    fn of_the_preset(gains: &Gains) -> Vec2 {
        blend(gains, &Parameters::default().schemas, &VECTORS)
    }

    /// W18: the four mixes of the paper.
    #[test]
    fn w16_golden_blends_of_the_presets() {
        let table = [
            (Gains::REACTIVE_ONLY, (-0.5, 0.89)),
            (Gains::MOSTLY_REACTIVE, (0.01, 0.55)),
            (Gains::MOSTLY_PLAN, (0.49, 0.23)),
            (Gains::PLAN_ONLY, (1.0, -0.11)),
        ];
        for (gains, (x, y)) in table {
            let blended = of_the_preset(&gains);
            assert!((blended - Vec2::new(x, y)).amax() < 1e-6, "{gains:?}: {blended:?}");
        }
    }

    /// W15: an obstacle within the margin outweighs advice, goal and noise together, in every
    /// mix with a reactive part and at the lowest gains in use (0.01).
    #[test]
    fn w15_repulsion_within_the_margin_beats_the_advice() {
        for gains in [Gains::REACTIVE_ONLY, Gains::MOSTLY_REACTIVE, Gains::MOSTLY_PLAN] {
            for avoid_gain in [1.0, 0.5, 0.03, 0.01] {
                let schemas = SchemaParameters { avoid_gain, ..Parameters::default().schemas };
                let east = Vec2::new(1.0, 0.0);
                let vectors = Vectors {
                    goal: east,
                    avoid: -east * SATURATED,
                    advice: east,
                    noise: east,
                    ..VECTORS
                };
                let blended = blend(&gains, &schemas, &vectors);
                assert!(blended.x < 0.0, "{gains:?} {avoid_gain}: {blended:?}");
            }
        }
    }

    #[test]
    fn a_gain_of_zero_silences_to_the_bit() {
        let without = Vectors { advice: Vec2::zeros(), ..VECTORS };
        let silent = blend(&Gains::REACTIVE_ONLY, &Parameters::default().schemas, &without);
        assert_eq!(of_the_preset(&Gains::REACTIVE_ONLY), silent);
    }

    prop_compose! {
        fn vector()(x in -1.0_f32..1.0, y in -1.0_f32..1.0) -> Vec2 { Vec2::new(x, y) }
    }
    prop_compose! {
        fn vectors()(
            goal in vector(), avoid in vector(), robots in vector(), advice in vector(),
            noise in vector(), past in vector(),
        ) -> Vectors { Vectors { goal, avoid, robots, past, advice, noise } }
    }
    prop_compose! {
        fn gains()(reactive in 0.0_f32..1.0, plan in 0.0_f32..1.0, noise in 0.0_f32..1.0)
            -> Gains { Gains { reactive, plan, noise } }
    }

    proptest! {
        /// W16: the blend of a sum of gains is the sum of the blends.
        #[test]
        fn w16_the_blend_is_linear_in_its_gains(
            v in vectors(), a in gains(), b in gains(), k in 0.0_f32..4.0,
        ) {
            let schemas = Parameters::default().schemas;
            let sum = Gains {
                reactive: a.reactive + k * b.reactive,
                plan: a.plan + k * b.plan,
                noise: a.noise + k * b.noise,
            };
            let apart = blend(&a, &schemas, &v) + blend(&b, &schemas, &v) * k;
            prop_assert!((blend(&sum, &schemas, &v) - apart).amax() < 1e-5);
        }
    }
}
