//! Options for reading and compiling a map, which several commands share.

use super::words::{board, gib, length, place, words};
use clap::{Arg, Args, ValueEnum};
use maps::Unknown;
use maps::formats::opar::{DeltaOrder, DeltaUnit, ObstructionType};
use maps::formats::{Format, OparOptions, ReadOptions, TagRule, TagRules};
use math::GeoPoint;
use plan_compiler::boards::Board;
use plan_compiler::mission::Goal;
use plan_compiler::mission::words::goal;
use std::path::PathBuf;

/// Options for compiling a map.
#[derive(Debug, Args)]
pub(crate) struct Compiling {
    /// Refuse plans that do not fit this board's plan region
    #[arg(long, value_name = "NAME", value_parser = board())]
    pub(crate) board: Option<&'static Board>,
    /// Refuse maps whose search needs more memory than this; 4 if not given
    #[arg(long, value_name = "GIB", value_parser = gib, allow_negative_numbers = true)]
    pub(crate) max_memory: Option<u64>,
    /// A goal in the map's metres, x east, y north, or on the globe as NAME=geo:LAT,LON;
    /// repeatable. With several positions, "NAME=X,Y;X,Y", the plan leads to the cheapest.
    /// Replaces the goals of the map and the mission
    #[arg(long = "goal", value_name = "NAME=X,Y", value_parser = goal, allow_hyphen_values = true)]
    pub(crate) goals: Vec<Goal>,
    #[command(flatten)]
    pub(crate) map: MapOptions,
}

/// Options for reading a map and drawing it into cells.
#[derive(Debug, Args)]
pub(crate) struct MapOptions {
    /// The mission file; if not given, NAME.mission.toml beside the map, if it exists
    #[arg(long, value_name = "FILE")]
    pub(crate) mission: Option<PathBuf>,
    /// The robot of the mission's team to build for; each has a blob of its own
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// Side of a cell; if not given, the mission's, else the map's, else 1
    #[arg(long, value_name = "METRES", value_parser = length, allow_hyphen_values = true)]
    pub(crate) resolution: Option<f64>,
    /// Grow obstacles by this radius, so that a robot of this size does not touch them; if not
    /// given, the mission's radius, else its vehicle's, else 0.3; 0 in MovingAI maps and Iplan.dat
    #[arg(long, value_name = "METRES", value_parser = length, allow_hyphen_values = true)]
    pub(crate) robot_radius: Option<f64>,
    /// Whether a diagonal step may pass a blocked cell beside it
    #[arg(long, value_name = "RULE")]
    pub(crate) corners: Option<CornersRule>,
    /// Block the inside of closed walls too
    #[arg(long)]
    pub(crate) fill_walls: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// Whether diagonal steps may cut corners.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum CornersRule {
    /// Both cells beside a diagonal step must be free
    Forbid,
    /// Diagonal steps may cut corners, as in the papers
    Allow,
}

/// The options of [`MapOptions`].
pub(super) const ABOUT_MAPS: [&str; 15] = [
    "mission",
    "robot",
    "resolution",
    "robot_radius",
    "corners",
    "fill_walls",
    "format",
    "unknown",
    "opar_units",
    "opar_order",
    "opar_types",
    "block",
    "free",
    "open_gates",
    "origin",
];

/// An option about a map, which has an effect only beside the option that gives one.
pub(super) fn only_with(option: Arg, map: &'static str) -> Arg {
    if ABOUT_MAPS.contains(&option.get_id().as_str()) { option.requires(map) } else { option }
}

/// How to read what a map file leaves open.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// The map's format; if not given, recognised by the content
    #[arg(long, value_name = "FORMAT", value_parser = words::<Format>())]
    pub(crate) format: Option<Format>,
    /// How cells that the map marks unknown are treated
    #[arg(long, value_name = "CELLS", default_value = "obstacle", value_parser = words::<Unknown>())]
    pub(crate) unknown: Unknown,
    /// Unit of OPAR's deltas
    #[arg(long, value_name = "UNIT", default_value = "m", value_parser = words::<DeltaUnit>())]
    pub(crate) opar_units: DeltaUnit,
    /// Order of a pair of OPAR's deltas: east first or north first
    #[arg(long, value_name = "ORDER", default_value = "en", value_parser = words::<DeltaOrder>())]
    pub(crate) opar_order: DeltaOrder,
    /// Meaning of a type of OPAR's obstructions, besides 1=building and 2=foliage; repeatable
    #[arg(long = "opar-type", value_name = "N=building|foliage")]
    pub(crate) opar_types: Vec<ObstructionType>,
    /// Treat objects with this tag as obstacles, in GeoJSON and OpenStreetMap; repeatable
    #[arg(long, value_name = "KEY[=VALUE]")]
    pub(crate) block: Vec<TagRule>,
    /// Treat objects with this tag as free ground, in GeoJSON and OpenStreetMap; repeatable
    #[arg(long, value_name = "KEY[=VALUE]")]
    pub(crate) free: Vec<TagRule>,
    /// Treat gates that are not locked as openings in their fence
    #[arg(long)]
    pub(crate) open_gates: bool,
    /// Position of 0,0 in a GeoJSON or OpenStreetMap map, WGS-84 degrees; if not given, the centre
    /// of the file's contents
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    pub(crate) origin: Option<GeoPoint>,
}

impl Reading {
    /// The options in the form that the readers take.
    pub(crate) fn options(&self) -> ReadOptions {
        let opar = OparOptions {
            units: self.opar_units,
            order: self.opar_order,
            types: self.opar_types.clone(),
        };
        let (block, free) = (self.block.clone(), self.free.clone());
        ReadOptions {
            format: self.format,
            unknown: self.unknown,
            opar,
            tags: TagRules { block, free, open_gates: self.open_gates, ..TagRules::default() },
            origin: self.origin,
        }
    }
}
