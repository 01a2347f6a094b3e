//! Attraction to the goal.

use math::{Vec2, vector};

/// The unit vector from `position` to `goal`; zero within `tolerance_m` of it.
///
/// Positions are in map metres; the result has no unit. Source: Arkin 1989, move-to-goal.
///
/// ```
/// # use math::Vec2;
/// let here = Vec2::new(1.0, 1.0);
/// assert_eq!(schemas::move_to_goal(here, Vec2::new(1.0, 9.0), 1.0), Vec2::new(0.0, 1.0));
/// assert_eq!(schemas::move_to_goal(here, Vec2::new(1.0, 1.9), 1.0), Vec2::zeros());
/// ```
pub fn move_to_goal(position: Vec2, goal: Vec2, tolerance_m: f32) -> Vec2 {
    let offset_m = goal - position;
    let distance_m = vector::length(offset_m);
    // The second comparison prevents a division by 0 if the tolerance is 0.
    if distance_m > tolerance_m && distance_m > 0.0 { offset_m / distance_m } else { Vec2::zeros() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn w16_golden_vectors() {
        // position, goal, tolerance, expected
        let table = [
            ((0.0, 0.0), (10.0, 0.0), 1.0, (1.0, 0.0)),
            ((0.0, 0.0), (-3.0, 4.0), 1.0, (-0.6, 0.8)),
            ((5.0, 5.0), (5.0, -5.0), 1.0, (0.0, -1.0)),
            ((0.0, 0.0), (1.0, 0.0), 1.0, (0.0, 0.0)),
            ((0.0, 0.0), (1.25, 0.0), 1.0, (1.0, 0.0)),
            ((2.0, 2.0), (2.0, 2.0), 0.0, (0.0, 0.0)),
        ];
        for (position, goal, tolerance, expected) in table {
            let v = |(x, y)| Vec2::new(x, y);
            let result = move_to_goal(v(position), v(goal), tolerance);
            assert!((result - v(expected)).amax() < 1e-6, "{position:?} to {goal:?}: {result:?}");
        }
    }
}
