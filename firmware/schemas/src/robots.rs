//! Repulsion from mates, and a tether to one of them.

use math::{Vec2, vector};

/// Away from each mate: full strength while the bodies are within `margin_m`, less and less up to
/// `sphere_m` beyond it, as [`crate::avoid_static_obstacle()`]. Mates have the robot's own radius.
///
/// A mate's position is as old as its news and as wrong as its fix, so the strength stays at most
/// 1: the robot yields, and its range sensors still keep it off a body that is really there.
///
/// Source: MissionLab's AvoidRobot.
pub fn avoid_robot(
    position: Vec2,
    mates: impl Iterator<Item = Vec2>,
    radius_m: f32,
    margin_m: f32,
    sphere_m: f32,
) -> Vec2 {
    mates.fold(Vec2::zeros(), |sum, mate| {
        let away = position - mate;
        let beyond_m = vector::length(away) - 2.0 * radius_m - margin_m;
        let strength = if beyond_m <= 0.0 {
            1.0
        } else if beyond_m < sphere_m {
            (sphere_m - beyond_m) / sphere_m
        } else {
            0.0
        };
        sum + vector::unit(away) * strength
    })
}

/// Towards a mate that is farther away than `length_m`: the strength grows from 0 there to 1 at
/// one and a half lengths.
///
/// Source: MissionLab's tethered robots, "MaintainDistance".
pub fn tether(position: Vec2, mate: Vec2, length_m: f32) -> Vec2 {
    let towards = mate - position;
    let beyond_m = vector::length(towards) - length_m;
    if beyond_m <= 0.0 {
        return Vec2::zeros();
    }
    vector::unit(towards) * (2.0 * beyond_m / length_m).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: Vec2, x: f32, y: f32) -> bool {
        (found - Vec2::new(x, y)).amax() < 1e-5
    }

    #[test]
    fn mates_repel_by_their_distance_and_add_up() {
        let push = |mates: &[(f32, f32)]| {
            let mates = mates.iter().map(|&(x, y)| Vec2::new(x, y));
            avoid_robot(Vec2::zeros(), mates, 0.5, 0.5, 4.0)
        };
        assert!(near(push(&[(1.0, 0.0)]), -1.0, 0.0), "within the margin");
        assert!(near(push(&[(3.5, 0.0)]), -0.5, 0.0), "half a sphere beyond it");
        assert!(near(push(&[(5.5, 0.0)]), 0.0, 0.0), "a sphere beyond it");
        assert!(near(push(&[(3.5, 0.0), (0.0, 3.5)]), -0.5, -0.5));
        assert!(near(push(&[(0.0, 0.0)]), 0.0, 0.0), "in one place there is no direction");
        assert!(near(push(&[]), 0.0, 0.0));
    }

    #[test]
    fn a_tether_pulls_only_beyond_its_length() {
        let pull = |x: f32| tether(Vec2::zeros(), Vec2::new(x, 0.0), 10.0).x;
        let table = [(0.0, 0.0), (10.0, 0.0), (12.5, 0.5), (15.0, 1.0), (90.0, 1.0), (-12.5, -0.5)];
        for (x, expected) in table {
            assert!((pull(x) - expected).abs() < 1e-5, "{x}: {}", pull(x));
        }
    }
}
