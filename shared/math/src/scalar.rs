//! Scalar functions, called by path: `math::scalar::sin(x)`.

use micromath::F32;

/// Half a turn, radians.
pub const PI: f32 = core::f32::consts::PI;
/// A whole turn, radians.
pub const TAU: f32 = core::f32::consts::TAU;

/// Sine of an angle in radians, to about 1e-3.
pub fn sin(radians: f32) -> f32 {
    F32(radians).sin().0
}

/// Cosine of an angle in radians, to about 1e-3.
pub fn cos(radians: f32) -> f32 {
    F32(radians).cos().0
}

/// Angle of the vector `(x, y)`, radians in [-pi, pi], to about 2e-3; 0 for the zero vector and
/// for arguments that are not finite.
pub fn atan2(y: f32, x: f32) -> f32 {
    let larger = if x.abs() > y.abs() { x.abs() } else { y.abs() };
    if !(x.is_finite() && y.is_finite() && larger > 0.0) {
        return 0.0;
    }
    // micromath multiplies its arguments; far from 1 the product overflows or underflows.
    F32(y / larger).atan2(F32(x / larger)).0
}

/// Square root; 0 for negative numbers and NaN, so the result is never NaN.
pub fn sqrt(x: f32) -> f32 {
    if x > 0.0 { libm::sqrtf(x) } else { 0.0 }
}

/// Largest whole number not above `x`.
pub fn floor(x: f32) -> f32 {
    libm::floorf(x)
}

/// The larger of two numbers. A comparison costs less than `f32::max`, which is a call on targets
/// without an instruction for it.
#[inline]
pub fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, as [`larger`].
#[inline]
pub fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `x` clamped to `[low, high]`; `low` if `x` is NaN.
pub fn clamp(x: f32, low: f32, high: f32) -> f32 {
    if x >= high {
        high
    } else if x > low {
        x
    } else {
        low
    }
}

/// The same angle in [-pi, pi). Exact for angles in that range; 0 for angles that are not
/// finite.
pub fn wrap_angle(radians: f32) -> f32 {
    if (-PI..PI).contains(&radians) {
        return radians;
    }
    if !radians.is_finite() {
        return 0.0;
    }
    let wrapped = radians - TAU * floor((radians + PI) / TAU);
    // Rounding can reach either end; both are half a turn.
    if (-PI..PI).contains(&wrapped) { wrapped } else { -PI }
}

/// Double-precision functions for the host's geometry; too slow for a robot's tick.
pub mod wide {
    /// Largest whole number not above `x`.
    pub fn floor(x: f64) -> f64 {
        libm::floor(x)
    }
    /// Smallest whole number not below `x`.
    pub fn ceil(x: f64) -> f64 {
        libm::ceil(x)
    }
    /// Square root.
    pub fn sqrt(x: f64) -> f64 {
        libm::sqrt(x)
    }
    /// Sine, radians.
    pub fn sin(x: f64) -> f64 {
        libm::sin(x)
    }
    /// Cosine, radians.
    pub fn cos(x: f64) -> f64 {
        libm::cos(x)
    }
    /// Sine and cosine, radians: those of [`sin`] and [`cos`] to the last bit.
    pub fn sin_cos(x: f64) -> (f64, f64) {
        libm::sincos(x)
    }
    /// Tangent, radians.
    pub fn tan(x: f64) -> f64 {
        libm::tan(x)
    }
    /// Angle of `(x, y)`, radians.
    pub fn atan2(y: f64, x: f64) -> f64 {
        libm::atan2(y, x)
    }
    /// Length of `(x, y)`.
    pub fn hypot(x: f64, y: f64) -> f64 {
        libm::hypot(x, y)
    }
    /// `x` to the power `y`.
    pub fn pow(x: f64, y: f64) -> f64 {
        libm::pow(x, y)
    }
    /// Natural logarithm.
    pub fn ln(x: f64) -> f64 {
        libm::log(x)
    }
    /// Decimal logarithm.
    pub fn log10(x: f64) -> f64 {
        libm::log10(x)
    }
    /// Exponential.
    pub fn exp(x: f64) -> f64 {
        libm::exp(x)
    }
    /// Hyperbolic sine.
    pub fn sinh(x: f64) -> f64 {
        libm::sinh(x)
    }
    /// Hyperbolic cosine.
    pub fn cosh(x: f64) -> f64 {
        libm::cosh(x)
    }
    /// Inverse hyperbolic sine.
    pub fn asinh(x: f64) -> f64 {
        libm::asinh(x)
    }
    /// Inverse hyperbolic tangent.
    pub fn atanh(x: f64) -> f64 {
        libm::atanh(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trigonometry_is_close_to_the_exact_values() {
        for i in -1000..1000 {
            let a = i as f32 * 0.01;
            assert!((f64::from(sin(a)) - libm::sin(f64::from(a))).abs() < 2e-3, "sin {a}");
            assert!((f64::from(cos(a)) - libm::cos(f64::from(a))).abs() < 2e-3, "cos {a}");
            let (y, x) = (libm::sin(f64::from(a)), libm::cos(f64::from(a)));
            let error = wrap_angle(atan2(y as f32, x as f32) - a);
            assert!(error.abs() < 5e-3, "atan2 of angle {a} is off by {error}");
        }
    }

    #[test]
    fn sine_and_cosine_together_are_those_alone() {
        for i in -10_000..10_000 {
            let a = f64::from(i) * 0.0137;
            assert_eq!(wide::sin_cos(a), (wide::sin(a), wide::cos(a)), "{a}");
        }
    }

    #[test]
    fn angles_wrap_into_half_open_turn() {
        for i in -10_000..10_000 {
            let a = i as f32 * 0.017;
            let w = wrap_angle(a);
            assert!((-PI..PI).contains(&w), "{a} -> {w}");
            assert!((libm::sin(f64::from(a)) - libm::sin(f64::from(w))).abs() < 1e-3);
        }
        assert_eq!(wrap_angle(PI), -PI);
        assert_eq!(wrap_angle(f32::NAN), 0.0);
        assert_eq!(wrap_angle(f32::INFINITY), 0.0);
    }

    #[test]
    fn nothing_turns_a_number_into_nan() {
        for x in [0.0, -0.0, -1.0, f32::MIN_POSITIVE, f32::MAX, f32::MIN] {
            assert!(!sqrt(x).is_nan());
            assert!(!atan2(x, 0.0).is_nan() && !atan2(0.0, x).is_nan() && !atan2(x, x).is_nan());
        }
        assert_eq!(clamp(f32::NAN, -1.0, 1.0), -1.0);
    }
}
