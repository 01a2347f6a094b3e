//! The formulas: each a loss in decibels.

use crate::model::{FoliageLoss, LossTerm};
use math::scalar::wide;
use std::f64::consts::PI;

/// Speed of light, metres per second.
const LIGHT_M_PER_S: f64 = 299_792_458.0;

/// Weissberger's own coefficients, for maps that give none.
pub const WEISSBERGER: FoliageLoss = FoliageLoss {
    cutoff_m: 14.0,
    near: LossTerm { a: 0.45, b: 0.284, c: 1.0 },
    far: LossTerm { a: 1.33, b: 0.284, c: 0.588 },
};

/// Wavelength, metres.
pub fn wavelength_m(frequency_ghz: f64) -> f64 {
    LIGHT_M_PER_S / (frequency_ghz * 1e9)
}

/// Loss in free space between isotropic antennas: 20 log10(4 pi d / wavelength)
/// (ITU-R P.525, equation 3). Never negative: closer than a twelfth of a wavelength, where the
/// formula does not hold, it is 0.
pub fn free_space_db(distance_m: f64, wavelength_m: f64) -> f64 {
    (20.0 * wide::log10(4.0 * PI * distance_m / wavelength_m)).max(0.0)
}

/// Loss J(v) over one knife edge (ITU-R P.526, equation 31); 0 where the edge is clearly below the
/// line (v at most -0.78). An edge that just touches the line costs 6 dB.
pub fn knife_edge_db(v: f64) -> f64 {
    if v <= -0.78 {
        return 0.0;
    }
    let w = v - 0.1;
    6.9 + 20.0 * wide::log10(wide::sqrt(w * w + 1.0) + w)
}

/// The parameter v of a knife edge `height_m` above the line, at distances from both ends, metres
/// (ITU-R P.526, equation 26).
pub fn edge_parameter(height_m: f64, distances_m: [f64; 2], wavelength_m: f64) -> f64 {
    let [near, far] = distances_m;
    height_m * wide::sqrt(2.0 / wavelength_m * (1.0 / near + 1.0 / far))
}

/// A point of the profile of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Distance along the path, metres.
    pub at_m: f64,
    /// Height above ground, metres.
    pub height_m: f64,
}

/// Loss over several knife edges, sorted by distance, between two antennas.
///
/// Deygout's construction, limited to three edges as in ITU-R P.526 for cascaded knife edges: the
/// edge with the greatest v, and on each side of it the greatest one seen from its top. The
/// empirical correction of that section (10 dB and more) is left out: it was fitted to terrain over
/// tens of kilometres. Deygout rather than Bullington, since the flat roof of a house is two edges,
/// and Bullington's one equivalent edge makes such a roof 20 dB too transparent; Deygout errs by a
/// few decibels, and to the safe side.
pub fn edges_db(edges: &[Edge], ends: [Edge; 2], wavelength_m: f64) -> f64 {
    let Some((main, v)) = greatest(edges, ends, wavelength_m) else { return 0.0 };
    let [before, after] = [&edges[..main], &edges[main + 1..]];
    let top = edges[main];
    let beside = [
        greatest(before, [ends[0], top], wavelength_m),
        greatest(after, [top, ends[1]], wavelength_m),
    ];
    let sides = beside.map(|found| found.map_or(0.0, |(_, v)| knife_edge_db(v)));
    knife_edge_db(v) + sides[0] + sides[1]
}

/// The edge with the greatest v between two ends, if it weakens radio.
fn greatest(edges: &[Edge], ends: [Edge; 2], wavelength_m: f64) -> Option<(usize, f64)> {
    let [from, to] = ends;
    let length = to.at_m - from.at_m;
    let mut best: Option<(usize, f64)> = None;
    for (index, edge) in edges.iter().enumerate() {
        // Within a wavelength of an antenna the formula does not hold.
        let distances = [edge.at_m - from.at_m, to.at_m - edge.at_m].map(|d| d.max(wavelength_m));
        let line = from.height_m + (to.height_m - from.height_m) * (edge.at_m - from.at_m) / length;
        let v = edge_parameter(edge.height_m - line, distances, wavelength_m);
        if v > -0.78 && best.is_none_or(|(_, greatest)| v > greatest) {
            best = Some((index, v));
        }
    }
    best
}

/// Loss in foliage of a depth in metres (Weissberger's modified exponential decay).
pub fn foliage_db(loss: &FoliageLoss, frequency_ghz: f64, depth_m: f64) -> f64 {
    if depth_m <= 0.0 {
        return 0.0;
    }
    let LossTerm { a, b, c } = if depth_m <= loss.cutoff_m { loss.near } else { loss.far };
    a * wide::pow(frequency_ghz, b) * wide::pow(depth_m, c)
}
