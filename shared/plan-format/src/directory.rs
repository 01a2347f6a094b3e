//! The directory: one postcard message whose byte slices are the sections, read in place;
//! and the fixed records in the sections.

use crate::bytes::{f64_at, u16_at, u32_at};
use crate::parameters::Parameters;
use crate::{Grid, limits};
use math::GeoPoint;
use postcard_schema::{Schema, key::Key};
use serde::{Deserialize, Serialize};

/// Where a map lies on the globe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// The place ...
    pub place: GeoPoint,
    /// ... of this point of the map, metres.
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
    /// The bytes that names point into, UTF-8.
    pub(crate) names: &'a [u8],
    /// [`crate::mission::Mission`]; empty without behaviours.
    pub(crate) mission: &'a [u8],
    /// How the map was made into cells, for tools: UTF-8, which the robot never looks at.
    pub(crate) recipe: &'a [u8],
    /// The bytes that layers point into.
    pub(crate) cells: &'a [u8],
}

/// Changes with every name and type in the directory, so that two builds which forgot to
/// raise the version still refuse each other's blobs.
pub(crate) const SCHEMA_HASH: [u8; 8] = Key::for_path::<Directory<'static>>("plans").to_bytes();

/// A name: where it stands in section `names`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NameAt {
    pub(crate) offset: u16,
    pub(crate) length: u8,
}

impl NameAt {
    /// The text; `None` where it is out of range or not UTF-8.
    pub(crate) fn get(self, names: &[u8]) -> Option<&str> {
        let offset = usize::from(self.offset);
        let bytes = names.get(offset..)?.get(..usize::from(self.length))?;
        core::str::from_utf8(bytes).ok()
    }
}

/// One parallel plan in section `plans`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanRecord {
    pub(crate) name: NameAt,
    pub(crate) layer_count: u8,
    pub(crate) first_layer: u16,
    pub(crate) goal_m: [f64; 2],
}

impl PlanRecord {
    pub(crate) const BYTES: usize = 22;

    pub(crate) fn get(section: &[u8], index: usize) -> Option<Self> {
        let at = index.checked_mul(Self::BYTES)?;
        let record = section.get(at..)?.get(..Self::BYTES)?;
        Some(Self {
            name: NameAt { offset: u16_at(record, 0)?, length: *record.get(2)? },
            layer_count: *record.get(3)?,
            first_layer: u16_at(record, 4)?,
            goal_m: [f64_at(record, 6)?, f64_at(record, 14)?],
        })
    }

    #[cfg(feature = "std")]
    pub(crate) fn put(&self, section: &mut Vec<u8>) {
        section.extend_from_slice(&self.name.offset.to_le_bytes());
        section.extend_from_slice(&[self.name.length, self.layer_count]);
        section.extend_from_slice(&self.first_layer.to_le_bytes());
        for metres in self.goal_m {
            section.extend_from_slice(&metres.to_le_bytes());
        }
    }
}

/// One layer in section `layers`. Offsets are words of section `cells`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayerRecord {
    pub(crate) name: NameAt,
    /// Where the table of plane `terrain` begins.
    pub(crate) terrain: u32,
    /// Where the table of plane `routes` begins.
    pub(crate) routes: u32,
    /// Where the roots begin.
    pub(crate) roots: u32,
    pub(crate) root_count: u16,
    /// Bytes that this layer added.
    pub(crate) bytes: u32,
    pub(crate) counts: Counts,
}

/// How many cells of a layer are of each kind; together all cells of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Free cells with a route, goals included.
    pub free: u32,
    /// Blocked cells.
    pub blocked: u32,
    /// Free cells without a route.
    pub unreachable: u32,
}

impl LayerRecord {
    pub(crate) const BYTES: usize = 33;

    pub(crate) fn get(section: &[u8], index: usize) -> Option<Self> {
        let at = index.checked_mul(Self::BYTES)?;
        let record = section.get(at..)?.get(..Self::BYTES)?;
        Some(Self {
            name: NameAt { offset: u16_at(record, 0)?, length: *record.get(2)? },
            terrain: u32_at(record, 3)?,
            routes: u32_at(record, 7)?,
            roots: u32_at(record, 11)?,
            root_count: u16_at(record, 15)?,
            bytes: u32_at(record, 17)?,
            counts: Counts {
                free: u32_at(record, 21)?,
                blocked: u32_at(record, 25)?,
                unreachable: u32_at(record, 29)?,
            },
        })
    }

    #[cfg(feature = "std")]
    pub(crate) fn put(&self, section: &mut Vec<u8>) {
        section.extend_from_slice(&self.name.offset.to_le_bytes());
        section.push(self.name.length);
        for offset in [self.terrain, self.routes, self.roots] {
            section.extend_from_slice(&offset.to_le_bytes());
        }
        section.extend_from_slice(&self.root_count.to_le_bytes());
        let Counts { free, blocked, unreachable } = self.counts;
        for number in [self.bytes, free, blocked, unreachable] {
            section.extend_from_slice(&number.to_le_bytes());
        }
    }
}

/// Whether a text may name a plan or a layer: trimmed, not empty, short enough, without `/`
/// (which joins the two) and without control characters.
pub fn is_name(name: &str) -> bool {
    !name.is_empty()
        && name.len() <= limits::MAX_NAME_BYTES
        && name.trim().len() == name.len()
        && !name.chars().any(|character| character == '/' || character.is_control())
}
