//! A fixed heading, independent of the map.

use math::{Vec2, scalar};

/// The unit vector of `heading_rad`, counter-clockwise from east.
///
/// Source: Arkin 1989, move-ahead.
pub fn move_ahead(heading_rad: f32) -> Vec2 {
    Vec2::new(scalar::cos(heading_rad), scalar::sin(heading_rad))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_vectors() {
        let north = core::f32::consts::FRAC_PI_2;
        assert!((move_ahead(0.0) - Vec2::new(1.0, 0.0)).amax() < 1e-3);
        assert!((move_ahead(north) - Vec2::new(0.0, 1.0)).amax() < 1e-3);
    }
}
