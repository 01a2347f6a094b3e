//! To the east, independent of the map.

use math::Vec2;

/// The unit vector to the east.
pub fn head_east() -> Vec2 {
    Vec2::new(1.0, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_vectors() {
        assert_eq!(head_east(), Vec2::new(1.0, 0.0));
    }
}
