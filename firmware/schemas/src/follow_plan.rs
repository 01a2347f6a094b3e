//! The plan's advice as a vector.

use math::Vec2;
use plan_format::Direction;

/// The unit vector of the advised step; zero without advice: at the goal, without a route, off
/// the map.
///
/// Source: W, section 2.2, "a movement vector towards the minimal adjacent grid cell".
///
/// ```
/// # use plan_format::Direction;
/// assert_eq!(schemas::follow_plan(Some(Direction::S)), math::Vec2::new(0.0, -1.0));
/// assert_eq!(schemas::follow_plan(None), math::Vec2::zeros());
/// ```
pub fn follow_plan(step: Option<Direction>) -> Vec2 {
    step.map_or(Vec2::zeros(), Direction::unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn w12_eight_unit_vectors_or_none() {
        const D: f32 = core::f32::consts::FRAC_1_SQRT_2;
        let expected =
            [(1.0, 0.0), (D, D), (0.0, 1.0), (-D, D), (-1.0, 0.0), (-D, -D), (0.0, -1.0), (D, -D)];
        for (direction, (x, y)) in Direction::ALL.into_iter().zip(expected) {
            assert_eq!(follow_plan(Some(direction)), Vec2::new(x, y), "{}", direction.name());
        }
        assert_eq!(follow_plan(None), Vec2::zeros());
    }
}
