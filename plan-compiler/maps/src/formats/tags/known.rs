//! Tags that block or weaken radio by default.

use crate::model::Role;

/// The effect of a tag on its object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind {
    pub(super) role: Role,
    pub(super) is_line: bool,
    pub(super) radius_m: f64,
    pub(super) wants_outline: bool,
    pub(super) is_barrier: bool,
    pub(super) is_gate: bool,
    /// Whether it lies on the ground, so that radio passes over it.
    pub(super) is_flat: bool,
}

/// Gates that a vehicle can pass when they are open.
const GATES: &[&str] = &[
    "gate",
    "lift_gate",
    "swing_gate",
    "sliding_gate",
    "sliding_beam",
    "hampshire_gate",
    "wicket_gate",
    "bump_gate",
];
/// Values of `barrier` that do not block.
const PASSABLE: &[&str] = &[
    "kerb",
    "cattle_grid",
    "entrance",
    "toll_booth",
    "border_control",
    "checkpoint",
    "height_restrictor",
];
/// Keys whose objects are lines even if closed, unless tagged as areas.
const LINES: &[&str] = &["barrier", "highway", "railway", "waterway", "power", "aerialway"];

/// Radius of a lamp post or pole with its foot, metres.
const POST_M: f64 = 0.3;
/// Radius of a trunk with its roots, a boulder, or a barrier of unknown kind, metres.
const TREE_M: f64 = 0.5;
/// Radius of a pylon's feet or a tank, metres.
const TOWER_M: f64 = 2.0;

/// Key, values (empty for any), whether it is a line, radius of a point in metres.
type Row = (&'static str, &'static [&'static str], bool, f64);

const ROWS: &[Row] = &[
    ("obstacle", &[], false, 0.0),
    ("natural", &["water", "wetland", "mud", "sinkhole"], false, 0.0),
    ("natural", &["tree", "rock", "stone"], false, TREE_M),
    ("natural", &["tree_row", "cliff", "coastline"], true, TREE_M),
    (
        "waterway",
        &["river", "stream", "tidal_channel", "canal", "drain", "ditch", "dam", "weir"],
        true,
        TREE_M,
    ),
    ("waterway", &["waterfall"], true, TREE_M),
    ("waterway", &["riverbank", "dock"], false, 0.0),
    ("leisure", &["swimming_pool"], false, 0.0),
    ("amenity", &["fountain"], false, TOWER_M),
    ("landuse", &["basin", "reservoir", "salt_pond"], false, 0.0),
    ("golf", &["water_hazard", "lateral_water_hazard"], false, 0.0),
    (
        "man_made",
        &["tower", "water_tower", "silo", "storage_tank", "chimney", "gasometer"],
        false,
        TOWER_M,
    ),
    ("man_made", &["mast", "street_cabinet"], false, TREE_M),
    ("man_made", &["breakwater"], false, TOWER_M),
    ("man_made", &["groyne", "embankment"], true, TOWER_M),
    ("power", &["tower", "portal"], false, TOWER_M),
    ("power", &["pole", "catenary_mast"], false, POST_M),
    ("power", &["transformer", "generator"], false, TREE_M),
    ("power", &["substation"], false, 0.0),
    (
        "railway",
        &["rail", "light_rail", "narrow_gauge", "preserved", "funicular", "miniature"],
        true,
        0.0,
    ),
    ("highway", &["steps"], true, 0.0),
    ("highway", &["street_lamp"], false, POST_M),
];
/// Tags of obstacles that lie on the ground; no values for any.
const FLAT: &[(&str, &[&str])] = &[
    ("natural", &["water", "wetland", "mud", "sinkhole", "coastline"]),
    (
        "waterway",
        &["river", "stream", "tidal_channel", "canal", "drain", "ditch", "riverbank", "dock"],
    ),
    ("leisure", &["swimming_pool"]),
    ("landuse", &["basin", "reservoir", "salt_pond"]),
    ("golf", &["water_hazard", "lateral_water_hazard"]),
    ("railway", &[]),
    ("highway", &["steps"]),
];
/// Tags of areas that weaken radio.
const WOODS: [(&str, &str); 2] = [("natural", "wood"), ("landuse", "forest")];

impl Kind {
    /// An obstacle that fills its outline.
    pub(super) const AREA: Self = Self {
        role: Role::Obstacle,
        is_line: false,
        radius_m: 0.0,
        wants_outline: false,
        is_barrier: false,
        is_gate: false,
        is_flat: false,
    };

    /// The default effect of a tag.
    pub(super) fn known(key: &str, value: &str) -> Option<Self> {
        if key.eq_ignore_ascii_case("building") || key.eq_ignore_ascii_case("building:part") {
            return Some(Self { wants_outline: true, ..Self::AREA });
        }
        if key.eq_ignore_ascii_case("barrier") {
            return (!is_among(value, PASSABLE)).then(|| Self::of(key, value));
        }
        if WOODS.iter().any(|(wood, kind)| is(key, wood) && is(value, kind)) {
            return Some(Self { role: Role::Attenuating, ..Self::AREA });
        }
        let is_it = |(known, values, ..): &&Row| {
            is(key, known) && (values.is_empty() || is_among(value, values))
        };
        let (known, _, is_line, radius_m) = *ROWS.iter().find(is_it)?;
        let wants_outline = radius_m == 0.0 && !is_line && known != "obstacle";
        let is_flat = FLAT
            .iter()
            .any(|(flat, values)| is(key, flat) && (values.is_empty() || is_among(value, values)));
        Some(Self { is_line, radius_m, wants_outline, is_flat, ..Self::AREA })
    }

    /// The effect of a tag that the user blocks.
    pub(super) fn of(key: &str, value: &str) -> Self {
        if is(key, "barrier") {
            let radius_m = if is(value, "bollard") { POST_M } else { TREE_M };
            let is_gate = Self::is_gate(key, value);
            return Self { is_line: true, radius_m, is_barrier: true, is_gate, ..Self::AREA };
        }
        // What users block besides is mostly land: fields, roads, pitches.
        let other = || Self {
            is_line: is_among(key, LINES),
            radius_m: TREE_M,
            is_flat: true,
            ..Self::AREA
        };
        Self::known(key, value).unwrap_or_else(other)
    }

    /// Whether a tag marks a gate that a vehicle can pass when it is open.
    pub(super) fn is_gate(key: &str, value: &str) -> bool {
        is(key, "barrier") && is_among(value, GATES)
    }

    /// Whether a tag marks a gap without a gate.
    pub(super) fn is_entrance(key: &str, value: &str) -> bool {
        is(key, "barrier") && is(value, "entrance")
    }
}

fn is(one: &str, other: &str) -> bool {
    one.eq_ignore_ascii_case(other)
}

fn is_among(value: &str, known: &[&str]) -> bool {
    known.iter().any(|known| is(value, known))
}
