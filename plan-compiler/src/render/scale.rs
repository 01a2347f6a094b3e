//! Round numbers for scale bars, cost bands and the ticks on the edges.

use super::text::width_px;
use math::scalar::wide;

/// The largest of 1, 2, 5, 10, 20, ... that is at most `x`.
pub(super) fn round_number_below(x: f64) -> f64 {
    let unit = unit_of(x);
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * unit).find(|&r| r <= x * LEEWAY).unwrap_or(unit)
}

/// The smallest of 1, 2, 5, 10, 20, ... that is at least `x`.
pub(super) fn round_number_above(x: f64) -> f64 {
    let unit = unit_of(x);
    let numbers = [1.0, 2.0, 5.0].into_iter().map(|digit| digit * unit);
    numbers.into_iter().find(|&r| r * LEEWAY >= x).unwrap_or(10.0 * unit)
}

/// Tolerance for rounding errors of binary fractions.
const LEEWAY: f64 = 1.0 + 1e-9;

/// 1, 10, 100, ... or 0.1, 0.01, ...: the largest that is at most `x`.
fn unit_of(x: f64) -> f64 {
    let exponent = wide::floor(wide::log10(x.max(f64::MIN_POSITIVE)) + 1e-9);
    // Dividing whole numbers gives the number nearest to 0.1, 0.01 and so on.
    if exponent < 0.0 { 1.0 / wide::pow(10.0, -exponent) } else { wide::pow(10.0, exponent) }
}

/// Marks on an edge of the map with their labels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// Position in metres and label of each tick.
    pub(super) at: Vec<(f64, String)>,
}

/// An edge of the map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) from_m: f64,
    pub(super) to_m: f64,
    pub(super) length_px: f64,
}

/// Most ticks of one edge.
const MOST_TICKS: usize = 200;

impl Ticks {
    /// Ticks at round numbers, as close as labels beside each other allow.
    pub(super) fn beside(edge: Edge, font_px: f64) -> Self {
        let mut step = edge.step(2.0 * font_px);
        loop {
            let ticks = Self::every(step, edge);
            let widest = ticks.widest_px(font_px) + 1.2 * font_px;
            let apart = step / (edge.to_m - edge.from_m) * edge.length_px;
            if apart >= widest || ticks.at.len() < 2 {
                return ticks;
            }
            step = round_number_above(step * 1.5);
        }
    }

    /// Ticks at round numbers, as close as labels below each other allow.
    pub(super) fn stacked(edge: Edge, font_px: f64) -> Self {
        Self::every(edge.step(3.2 * font_px), edge)
    }

    fn every(step: f64, edge: Edge) -> Self {
        let decimals = wide::floor(-wide::log10(step) + 1.0 - 1e-9).clamp(0.0, 6.0) as usize;
        let first = wide::ceil(edge.from_m / step - 1e-6);
        let places = (0..MOST_TICKS).map(|index| (first + index as f64) * step);
        let places = places.take_while(|&at| at <= edge.to_m + 1e-6 * step);
        // `+ 0.0` removes the sign of a negative zero.
        let mut at: Vec<(f64, String)> =
            places.map(|at| (at, format!("{:.decimals$}", at + 0.0))).collect();
        if let Some((_, label)) = at.last_mut() {
            label.push_str(" m");
        }
        Self { at }
    }

    pub(super) fn widest_px(&self, font_px: f64) -> f64 {
        self.at.iter().map(|(_, label)| width_px(label, font_px)).fold(0.0, f64::max)
    }
}

impl Edge {
    /// The smallest round step that takes at least `least_px` pixels.
    fn step(&self, least_px: f64) -> f64 {
        round_number_above((self.to_m - self.from_m) * least_px / self.length_px.max(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round() {
        for (room, below, above) in [
            (1.0, 1.0, 1.0),
            (1.9, 1.0, 2.0),
            (4.9, 2.0, 5.0),
            (62.5, 50.0, 100.0),
            (0.3, 0.2, 0.5),
            (20.0, 20.0, 20.0),
            (0.1, 0.1, 0.1),
            (1000.0, 1000.0, 1000.0),
        ] {
            assert!((round_number_below(room) - below).abs() < 1e-12, "{room}");
            assert!((round_number_above(room) - above).abs() < 1e-12, "{room}");
        }
    }

    fn labels(from_m: f64, to_m: f64, length_px: f64) -> Vec<String> {
        let ticks = Ticks::beside(Edge { from_m, to_m, length_px }, 12.0);
        ticks.at.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_stand_at_round_numbers_and_apart() {
        assert_eq!(labels(0.0, 250.0, 300.0), ["0", "50", "100", "150", "200", "250 m"]);
        assert_eq!(labels(-5.0, 5.0, 300.0), ["-4", "-2", "0", "2", "4 m"]);
        assert_eq!(labels(0.0, 0.5, 300.0), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5 m"]);
        assert_eq!(labels(441_231.5, 441_331.5, 300.0), ["441250", "441300 m"]);
        assert_eq!(labels(0.0, 1.0, 5.0), ["0 m"], "where there is no room for more");
        assert!(labels(1e15, 1e15 + 1.0, 300.0).len() <= MOST_TICKS);
    }
}
