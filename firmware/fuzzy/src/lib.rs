//! Fuzzy inference over seven labels, exact and total.
//!
//! Decides how critical a behaviour or how applicable a production is, from aspects of interest
//! and a row of seven labels for each.
//!
//! ```
//! use plan_format::mission::Label::{NB, PB, PM};
//! use plan_format::mission::{Inference, Row};
//! // How critical is refuelling with 8 of 40 litres left? The less fuel, the more critical.
//! let refuel = Row::from([PB, PB, PM, PM, NB, NB, NB]);
//! let fuel = fuzzy::position(8.0, 0.0, 40.0);
//! let criticality = fuzzy::infer([(refuel, fuel)].into_iter(), Inference::Min);
//! assert!((criticality - 0.891).abs() < 1e-3);
//! ```
//!
//! The seven labels NB NM NS ZO PS PM PB are triangles over 0 ..= 1, centred at k/6 with
//! half-width 1/6 and cut at the ends, for premises and consequences alike. Within an input, each
//! rule's consequence is cut to the degree of its premise, and the maximum joins the rules. The
//! inputs are summed and divided by the sum's maximum. The result is the centre of gravity. The
//! division cancels, because it changes area and moment alike, so it is left out. The centre of
//! gravity of a sum needs only sums of areas and moments, so each input is integrated separately,
//! in closed form, without sampling.
//!
//! Invariants: the degrees of neighbouring labels add up to 1, so at every position one label has
//! a degree of at least 1/2. The area is therefore never 0, and the result is always in
//! 1/18 ..= 17/18. The caller replaces missing input; a NaN counts as the low end.
//!
//! Source: H (Hasemann, "Fuzzy Reasoning"), tables 3 to 6.
//!
//! Deliberately absent: other shapes, norms and defuzzifiers. The compiler can check one
//! well-understood inference.
#![no_std]

mod shape;

use math::scalar;
use plan_format::mission::{Inference, Label, Row};
use shape::Shape;

/// Number of intervals between the seven labels' centres.
const INTERVALS: f32 = 6.0;

/// Position of a value in its universe: 0 at `low`, 1 at `high`, cut at both ends. `low` may be
/// above `high`. All three have one unit, any.
pub fn position(value: f32, low: f32, high: f32) -> f32 {
    scalar::clamp((value - low) / (high - low), 0.0, 1.0)
}

/// The two neighbouring labels at a position: the index of the lower one, 0 ..= 5, and the degree
/// of the upper one. The degree of the lower one is the rest to 1.
pub fn fuzzify(position: f32) -> (usize, f32) {
    let scaled = scalar::clamp(position, 0.0, 1.0) * INTERVALS;
    // Truncation is the floor of a non-negative number; the top end is in the last interval.
    let lower = (scaled as usize).min(5);
    (lower, scaled - lower as f32)
}

/// The centre of gravity of the joined consequences, 1/18 ..= 17/18.
///
/// An item is an input's row of consequences and its position in 0 ..= 1. Without any input the
/// result is 1/2, neither for nor against.
///
/// ```
/// use plan_format::mission::{Inference, Label, Row};
/// // An input whose consequence is PS, centred at 4/6, at every position.
/// let row = Row::from([Label::PS; 7]);
/// let result = fuzzy::infer([(row, 0.3)].into_iter(), Inference::Min);
/// assert!((result - 4.0 / 6.0).abs() < 1e-6);
/// ```
pub fn infer(rules: impl Iterator<Item = (Row, f32)>, inference: Inference) -> f32 {
    let mut total = Shape::EMPTY;
    for (consequences, position) in rules {
        total = total + consequence(consequences, position, inference);
    }
    if total.area > 0.0 { total.moment / total.area } else { 0.5 }
}

/// The joined consequences of one input's rules.
fn consequence(labels: Row, position: f32, inference: Inference) -> Shape {
    let (lower, upper_degree) = fuzzify(position);
    let lower_degree = 1.0 - upper_degree;
    let (first, second) = (labels.get(lower), labels.get(lower + 1));
    let cut = |label: Label, degree: f32| match inference {
        Inference::Min => Shape::clipped(label, degree),
        Inference::Product => Shape::scaled(label, degree),
    };
    if first == second {
        return cut(first, lower_degree.max(upper_degree));
    }
    // The area under a maximum is the sum minus the area under the minimum.
    let both = cut(first, lower_degree) + cut(second, upper_degree);
    let (left, right, left_degree) =
        if first < second { (first, second, lower_degree) } else { (second, first, upper_degree) };
    if right as usize - left as usize > 1 {
        return both;
    }
    both - match inference {
        Inference::Min => Shape::clipped_overlap(left, left_degree),
        Inference::Product => Shape::scaled_overlap(left, left_degree),
    }
}

#[cfg(test)]
mod tests;
