//! A fixed direction.

use math::{Vec2, vector};

/// The unit vector in a direction, radians counter-clockwise from the map's x axis.
///
/// Source: Arkin 1989, move-ahead.
///
/// ```
/// # use math::Vec2;
/// assert_eq!(schemas::move_ahead(0.0), Vec2::new(1.0, 0.0));
/// ```
pub fn move_ahead(direction_rad: f32) -> Vec2 {
    vector::from_angle(direction_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn golden_vectors() {
        for (direction_rad, expected) in [
            (0.0, Vec2::new(1.0, 0.0)),
            (FRAC_PI_2, Vec2::new(0.0, 1.0)),
            (PI, Vec2::new(-1.0, 0.0)),
            (-FRAC_PI_2, Vec2::new(0.0, -1.0)),
        ] {
            assert!((move_ahead(direction_rad) - expected).amax() < 2e-3, "{direction_rad}");
        }
    }
}
