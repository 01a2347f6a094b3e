//! Areas and first moments of cut triangles, in closed form.
//!
//! All are worked out in units of the interval between two labels' centres, so that a label's
//! number is its centre, the universe is 0 ..= 6 and no division is needed before the end.

use core::ops::{Add, Sub};
use plan_format::mission::Label;

/// What the centre of gravity needs to know of a shape over 0 ..= 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Area, in interval widths.
    pub(crate) area: f32,
    /// First moment about 0.
    pub(crate) moment: f32,
}

/// Width of an interval.
const WIDTH: f32 = 1.0 / 6.0;

impl Shape {
    /// Nothing.
    pub(crate) const EMPTY: Self = Self { area: 0.0, moment: 0.0 };

    /// An area with its centre, the latter in intervals.
    fn about(area: f32, centre: f32) -> Self {
        Self { area, moment: area * centre * WIDTH }
    }

    /// A label's triangle, clipped at a degree in 0 ..= 1.
    pub(crate) fn clipped(label: Label, degree: f32) -> Self {
        let slope_area = degree - 0.5 * degree * degree;
        match label {
            Label::NB => Self::about(slope_area, 0.0) + Self::clipped_slope_moment(degree),
            Label::PB => Self::about(slope_area, 6.0) - Self::clipped_slope_moment(degree),
            inner => Self::about(2.0 * slope_area, f32::from(inner as u8)),
        }
    }

    /// A label's triangle, scaled by a degree in 0 ..= 1.
    pub(crate) fn scaled(label: Label, degree: f32) -> Self {
        // The slope of a half triangle has its centre a third of the way out.
        match label {
            Label::NB => Self::about(0.5 * degree, 1.0 / 3.0),
            Label::PB => Self::about(0.5 * degree, 6.0 - 1.0 / 3.0),
            inner => Self::about(degree, f32::from(inner as u8)),
        }
    }

    /// Where the clipped triangles of a label and its right neighbour overlap; their degrees add
    /// up to 1. It is a trapezium with slopes 1 about the middle between the two.
    pub(crate) fn clipped_overlap(left: Label, left_degree: f32) -> Self {
        let height = left_degree.min(1.0 - left_degree);
        Self::about(height - height * height, f32::from(left as u8) + 0.5)
    }

    /// Where the scaled triangles of a label and its right neighbour overlap; their degrees add
    /// up to 1. It is a triangle with its base from centre to centre and its tip at
    /// `left_degree`, of the height of the degrees' product.
    pub(crate) fn scaled_overlap(left: Label, left_degree: f32) -> Self {
        let height = left_degree * (1.0 - left_degree);
        Self::about(0.5 * height, f32::from(left as u8) + (1.0 + left_degree) / 3.0)
    }

    /// The moment of one slope, clipped at a degree, about the triangle's centre: the integral of
    /// `y min(degree, 1 - y)` over 0 ..= 1.
    fn clipped_slope_moment(degree: f32) -> Self {
        let flat = 1.0 - degree;
        let under_flat = 0.5 * degree * flat * flat;
        let under_slope = 1.0 / 6.0 - flat * flat * (0.5 - flat / 3.0);
        Self { area: 0.0, moment: (under_flat + under_slope) * WIDTH }
    }
}

impl Add for Shape {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { area: self.area + other.area, moment: self.moment + other.moment }
    }
}

impl Sub for Shape {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { area: self.area - other.area, moment: self.moment - other.moment }
    }
}
