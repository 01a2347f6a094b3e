//! Fuzzy inference over seven labels, exact and total.
//!
//! Decides how critical a behaviour or how applicable a production is, from aspects of interest
//! and a table of seven labels for each (Hasemann, "Fuzzy Reasoning", tables 3 to 6).
//!
//! The seven labels NB NM NS ZO PS PM PB are triangles over 0 ..= 1, centred at k/6 with
//! half-width 1/6 and cut at the ends, for premises and consequences alike. For each input the
//! rules' consequences are cut to the degree of their premises and joined by maximum; over the
//! inputs they are summed and divided by the sum's maximum; the centre of gravity is the result.
//! That last division changes area and moment alike and cancels, so it is not computed; and since
//! the centre of gravity of a sum needs only sums of areas and moments, each input is integrated
//! on its own, in closed form, without sampling.
//!
//! Invariants: the triangles of neighbouring labels add up to 1, so for every position one label
//! holds to at least 1/2: the area is never 0, and the result is always in 1/18 ..= 17/18. Missing
//! or senseless input has been replaced before it comes here; should a NaN come all the same, it
//! counts as the low end.
//!
//! Deliberately absent: other shapes, norms and defuzzifiers. One well-understood inference can be
//! checked when a mission is compiled.
#![no_std]

mod shape;

use math::scalar;
use plan_format::mission::{Inference, Label, Row};
use shape::Shape;

/// Number of intervals between the seven labels' centres.
const INTERVALS: f32 = 6.0;

/// Where a value lies in its universe: 0 at `low`, 1 at `high`, cut at both ends. `low` may be
/// above `high`. Any unit.
pub fn position(value: f32, low: f32, high: f32) -> f32 {
    scalar::clamp((value - low) / (high - low), 0.0, 1.0)
}

/// The two neighbouring labels that hold at a position, as the lower one's index 0 ..= 5 and the
/// degree of the upper one; the lower one's is the rest to 1.
pub fn fuzzify(position: f32) -> (usize, f32) {
    let scaled = scalar::clamp(position, 0.0, 1.0) * INTERVALS;
    // Truncation is the floor for what is not negative; the top end belongs to the last interval.
    let lower = (scaled as usize).min(5);
    (lower, scaled - lower as f32)
}

/// The centre of gravity of some rules' joined consequences, 1/18 ..= 17/18.
///
/// Each rule is its row of consequences and the position of its input in 0 ..= 1. Without any rule
/// the result is 1/2: nothing speaks for or against.
///
/// ```
/// use plan_format::mission::{Inference, Label, Row};
/// // An input that asks for PS, centred at 4/6, wherever it lies.
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
    // The area under a maximum is the sum less the area under the minimum.
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
