//! Plane vectors (metres or unit-free, x east, y north).

use crate::scalar;

/// A vector in the map's axes.
pub type Vec2 = nalgebra::Vector2<f32>;

/// Euclidean length.
pub fn length(v: Vec2) -> f32 {
    scalar::sqrt(v.x * v.x + v.y * v.y)
}

/// The vector of length 1 with the direction of `v`; zero for the zero vector.
pub fn unit(v: Vec2) -> Vec2 {
    let length = length(v);
    if length > 0.0 { Vec2::new(v.x / length, v.y / length) } else { Vec2::zeros() }
}

/// Direction of `v`, radians counter-clockwise from east; 0 for the zero vector.
pub fn angle(v: Vec2) -> f32 {
    scalar::wrap_angle(scalar::atan2(v.y, v.x))
}

/// The vector of length 1 at `radians` counter-clockwise from east.
pub fn from_angle(radians: f32) -> Vec2 {
    Vec2::new(scalar::cos(radians), scalar::sin(radians))
}

/// `v` turned counter-clockwise by `radians`.
pub fn rotated(v: Vec2, radians: f32) -> Vec2 {
    let (c, s) = (scalar::cos(radians), scalar::sin(radians));
    Vec2::new(c * v.x - s * v.y, s * v.x + c * v.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_vectors_have_length_one_or_zero() {
        for i in 0..64 {
            let v = from_angle(i as f32 * 0.1) * (i as f32);
            let expected = if i == 0 { 0.0 } else { 1.0 };
            assert!((length(unit(v)) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn rotating_adds_angles() {
        let v = rotated(Vec2::new(2.0, 0.0), 1.0);
        assert!((angle(v) - 1.0).abs() < 5e-3);
    }
}
