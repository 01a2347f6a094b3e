//! Areas and first moments of cut triangles, in closed form.
//!
//! The unit is the interval between two labels' centres: a label's number is its centre, the
//! universe is 0 ..= 6, and only the end needs a division.

use core::ops::{Add, Sub};
use plan_format::mission::Label;

/// What the centre of gravity needs of a shape over 0 ..= 1.
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
    /// The empty shape.
    pub(crate) const EMPTY: Self = Self { area: 0.0, moment: 0.0 };

    /// A shape of this area with its centre of gravity at `centre`, in intervals.
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

    /// The overlap of the clipped triangles of a label and its right neighbour; their degrees
    /// add up to 1. It is a trapezium with slopes 1 about the middle between the two.
    pub(crate) fn clipped_overlap(left: Label, left_degree: f32) -> Self {
        let height = left_degree.min(1.0 - left_degree);
        Self::about(height - height * height, f32::from(left as u8) + 0.5)
    }

    /// The overlap of the scaled triangles of a label and its right neighbour; their degrees add
    /// up to 1. It is a triangle with its base from centre to centre and its tip at
    /// `left_degree`; its height is the product of the degrees.
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
