//! Numbers formatted for people.

/// A length in metres, rounded to the millimetre; in powers of ten below a millimetre and from
/// 10^12 on.
pub fn metres(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e12).contains(&value.abs()) {
        return format!("{value:e}");
    }
    format!("{}", (value * 1e3).round() / 1e3)
}

/// A point in metres: `(12.5, -40)`.
pub fn pair(at: [f64; 2]) -> String {
    format!("({}, {})", metres(at[0]), metres(at[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_short() {
        assert_eq!(metres(1e9), "1000000000");
        assert_eq!(metres(0.1 + 0.2), "0.3");
        assert_eq!(metres(1e300), "1e300");
        assert_eq!(metres(f64::NAN), "NaN");
        assert_eq!(metres(-0.0), "-0");
    }
}
