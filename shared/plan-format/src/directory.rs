//! The directory, a postcard message whose byte slices are the sections, and the records of plans
//! and layers.

use crate::layout::{GOALS_WORDS, RANK_BITS, TOLL_WORDS, UNIT_BITS};
use crate::names::Name;
use crate::parameters::Parameters;
use crate::record::record;
use crate::{Grid, limits};
use math::GeoPoint;
use postcard_schema::{Schema, key::Key};
use serde::{Deserialize, Serialize};

/// Where a map lies on the globe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// WGS-84 position of `at_m`.
    pub place: GeoPoint,
    /// A point of the map, metres.
    pub at_m: [f64; 2],
    /// Direction of the map's y axis, radians clockwise from true north.
    pub heading_rad: f64,
}

impl Origin {
    /// Whether every number is within its limit.
    pub fn is_valid(&self) -> bool {
        self.place.is_valid()
            && self.at_m.iter().all(|metres| metres.abs() <= limits::MAX_ORIGIN_M)
            && self.heading_rad.abs() <= core::f64::consts::TAU
    }
}

/// An origin as it is stored.
#[derive(Clone, Copy, Serialize, Deserialize, Schema)]
pub(crate) struct StoredOrigin {
    lat_e7: i32,
    lon_e7: i32,
    at_m: [f64; 2],
    heading_rad: f64,
}

impl From<Origin> for StoredOrigin {
    fn from(origin: Origin) -> Self {
        Self {
            lat_e7: origin.place.lat_e7,
            lon_e7: origin.place.lon_e7,
            at_m: origin.at_m,
            heading_rad: origin.heading_rad,
        }
    }
}

impl From<StoredOrigin> for Origin {
    fn from(stored: StoredOrigin) -> Self {
        Self {
            place: GeoPoint { lat_e7: stored.lat_e7, lon_e7: stored.lon_e7 },
            at_m: stored.at_m,
            heading_rad: stored.heading_rad,
        }
    }
}

/// The sections by name. Field order is the order in the file.
#[derive(Clone, Copy, Serialize, Deserialize, Schema)]
pub(crate) struct Directory<'a> {
    pub(crate) grid: Grid,
    pub(crate) origin: Option<StoredOrigin>,
    pub(crate) parameters: Parameters,
    /// [`PlanRecord`]s.
    pub(crate) plans: &'a [u8],
    /// [`LayerRecord`]s.
    pub(crate) layers: &'a [u8],
    /// The text of all names, UTF-8.
    pub(crate) names: &'a [u8],
    /// [`crate::mission::Mission`]; empty without behaviours.
    pub(crate) mission: &'a [u8],
    /// The build's map options, for tools: UTF-8. The robot does not read it.
    pub(crate) recipe: &'a [u8],
    /// The words of all layers.
    pub(crate) cells: &'a [u8],
}

/// Changes with every name and type in the directory, so builds with different directories refuse
/// each other's blobs even if the version was not raised.
pub(crate) const SCHEMA_HASH: [u8; 8] = Key::for_path::<Directory<'static>>("plans").to_bytes();

record! {
    /// One parallel plan in section `plans`.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct PlanRecord {
        pub(crate) name: Name,
        /// The number of layers, and above its 7 bits the flag of several goals.
        pub(crate) layers_and_flag: u8,
        pub(crate) first_layer: u16,
        /// The goal; of several, the first one on the grid.
        pub(crate) goal_m: [f64; 2],
    }
}

const SEVERAL: u8 = 1 << 7;

impl PlanRecord {
    /// The byte of a number of layers and of whether there are several goals.
    #[cfg(feature = "std")]
    pub(crate) fn layers_byte(layers: u8, has_several_goals: bool) -> u8 {
        layers | if has_several_goals { SEVERAL } else { 0 }
    }

    /// Number of layers.
    #[inline(always)]
    pub(crate) fn layer_count(&self) -> u8 {
        self.layers_and_flag & !SEVERAL
    }

    /// Whether the plan has several goals. Then its layers have the flag too.
    #[inline(always)]
    pub(crate) fn has_several_goals(&self) -> bool {
        self.layers_and_flag & SEVERAL != 0
    }
}

record! {
    /// One layer in section `layers`. Offsets are words of section `cells`.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct LayerRecord {
        pub(crate) name: Name,
        /// Position of its constraints in the mission's order; equal in all plans that have them.
        /// Above its 3 bits, the unit of costs, the flag of tolls and the flag of several goals.
        pub(crate) rank_and_flags: u8,
        /// Where the table of plane `terrain` begins.
        pub(crate) terrain: u32,
        /// Where the table of plane `routes` begins.
        pub(crate) routes: u32,
        /// Where the roots begin, or the headers before them.
        pub(crate) roots: u32,
        pub(crate) root_count: u16,
        /// Bytes that this layer added to section `cells`.
        pub(crate) bytes: u32,
        pub(crate) counts: Counts,
    }
}

const TOLLS: u8 = 1 << (RANK_BITS + UNIT_BITS);
const SEVERAL_GOALS: u8 = TOLLS << 1;

impl LayerRecord {
    /// The byte of a rank below 8, of the unit of costs if the layer has tolls, and of whether its
    /// plan has several goals.
    pub(crate) fn rank_byte(rank: u8, toll_unit: Option<u8>, has_several_goals: bool) -> u8 {
        let goals = if has_several_goals { SEVERAL_GOALS } else { 0 };
        rank | goals | toll_unit.map_or(0, |unit| TOLLS | unit << RANK_BITS)
    }

    /// Position of its constraints in the mission's order.
    pub(crate) fn rank(&self) -> u8 {
        self.rank_and_flags & ((1 << RANK_BITS) - 1)
    }

    /// Whether the layer has tolls.
    pub(crate) fn has_tolls(&self) -> bool {
        self.rank_and_flags & TOLLS != 0
    }

    /// Whether the plan has several goals: then [`GOALS_WORDS`] words precede the roots and what else
    /// precedes them.
    #[inline(always)]
    pub(crate) fn has_several_goals(&self) -> bool {
        self.rank_and_flags & SEVERAL_GOALS != 0
    }

    /// Words before the roots.
    #[inline(always)]
    pub(crate) fn header_words(&self) -> u32 {
        let goals = if self.has_several_goals() { GOALS_WORDS } else { 0 };
        goals + if self.has_tolls() { TOLL_WORDS } else { 0 }
    }

    /// The unit of costs; see [`crate::Layer::unit`].
    pub(crate) fn unit(&self) -> u8 {
        self.rank_and_flags >> RANK_BITS & ((1 << UNIT_BITS) - 1)
    }

    /// Whether the byte is one that [`Self::rank_byte`] gives.
    pub(crate) fn is_valid(&self) -> bool {
        let unit = self.has_tolls().then(|| self.unit());
        self.rank_and_flags == Self::rank_byte(self.rank(), unit, self.has_several_goals())
    }
}

record! {
    /// The number of cells of each kind in a layer; they add up to the cells of the grid.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Counts {
        /// Free cells with a route, goals included.
        pub free: u32,
        /// Blocked cells.
        pub blocked: u32,
        /// Free cells without a route.
        pub unreachable: u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Record;

    #[test]
    fn records_have_the_sizes_of_the_format() {
        assert_eq!((PlanRecord::SIZE, LayerRecord::SIZE), (22, 34));
    }
}
