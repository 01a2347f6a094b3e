//! Radio between two antennas: whether they are linked, and the loss between them.
//!
//! Two models answer, both prepared once from a map's shapes and both pure functions after that:
//!
//! - [`Sight`] is the rule of the paper (W, section 3): two antennas are linked unless something
//!   large lies on the straight line between them. It looks at the plan view only.
//! - [`Model`] computes the loss in decibels: free space, diffraction over the edges of obstacles,
//!   and foliage.
//!
//! Both are symmetric to the last bit (from a to b as from b to a), and equal on every machine.
//!
//! What lies on the line. Obstacles are walls from the ground to their height. Cells that the file
//! marks occupied are obstacles of the default height; unknown cells let radio pass. An obstacle
//! whose longest side is at most [`Settings::small_m`] does not weaken radio, nor does one of
//! height 0, such as water. Areas that weaken radio are foliage. A line that only grazes an outline
//! may count either way, always the same way.
//!
//! Deliberately absent: the shape of the ground, the curvature of the earth (0.4 m at 5 km), and ways
//! around the sides of obstacles, which make the loss too large rather than too small; reflections
//! and fading, which can also make it too small: a threshold should leave room for them.

mod losses;
mod model;
mod scene;
mod sight;

pub use losses::{
    Edge, WEISSBERGER, edge_parameter, edges_db, foliage_db, free_space_db, knife_edge_db,
    wavelength_m,
};
pub use model::Model;
pub use sight::Sight;

/// The radio, and the heights that a map does not give.
///
/// The defaults are those of the paper's laboratory: 2.4 GHz, 24 dBm, isotropic antennas 1 m above
/// ground, and a receiver 8 dB above the noise floor of 1 Mb/s with a noise figure of 1 dB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Frequency, GHz. Weissberger's model holds from 0.23 to 95.
    pub frequency_ghz: f64,
    /// Power of the transmitter with the gains of both antennas, dBm.
    pub power_dbm: f64,
    /// Least power that the receiver understands, dBm.
    pub sensitivity_dbm: f64,
    /// Heights of the antennas over the first and the second point of a question, metres.
    pub antenna_heights_m: [f64; 2],
    /// Height of obstacles whose height the map does not give, metres: two storeys by default.
    pub obstacle_height_m: f64,
    /// Height of foliage whose height the map does not give, metres.
    pub foliage_height_m: f64,
    /// Loss of each wall that the straight line passes, dB: COST 231 gives 4 for wood, 7 for
    /// concrete with windows, 10 to 20 for concrete. With `None`, the default, only the way over an
    /// obstacle counts.
    pub wall_db: Option<f64>,
    /// Obstacles whose longest side is at most this do not weaken radio, metres. The default, 3 m,
    /// is about the radius of the first Fresnel zone in the middle of 250 m at 2.4 GHz.
    pub small_m: f64,
    /// Whether areas that weaken radio, such as foliage, break a line of [`Sight`].
    pub areas_block: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            frequency_ghz: 2.4,
            power_dbm: 24.0,
            sensitivity_dbm: -105.0,
            antenna_heights_m: [1.0; 2],
            obstacle_height_m: 6.0,
            foliage_height_m: 10.0,
            wall_db: None,
            small_m: 3.0,
            areas_block: false,
        }
    }
}

#[cfg(test)]
mod tests;
