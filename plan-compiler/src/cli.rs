//! The command line, as `--help` teaches it.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use maps::Unknown;
use maps::formats::opar::{DeltaOrder, DeltaUnit, ObstructionType};
use maps::formats::{
    Format, OparOptions, ReadOptions, TagRule, TagRules, geojson, iplan, movingai, osm, pcf, ros,
    tags,
};
use maps::names::Word;
use math::GeoPoint;
use plan_compiler::boards::{BOARDS, Board};
use plan_compiler::mission::words::{goal, number, pair};
use plan_compiler::mission::{self, Goal};
use plan_compiler::render::{SIZES_PX, Style};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  plan-compiler build tests/maps/campus.opar -o campus.bin
      Compiles a map. Its named points become goals; campus.mission.toml beside it is
      found by itself. The maps here are those of the project's folder.
  plan-compiler build tests/maps/yard.osm --goal gate=-17.5,17.5 --goal shed=14,14 --resolution 0.5
      Compiles for two goals of your own, in cells of half a metre.
  plan-compiler build tests/maps/yard.osm --goal gate=geo:51.00036,7.00018 -o gate.bin
      The same for a goal by latitude and longitude.
  plan-compiler build tests/maps/campus.opar --board nrf52840-dk -o plans.hex
      Refuses plans that do not fit the board, and writes them with their address for
      flashing: .hex, or .uf2 for pico2.
  plan-compiler inspect plans.bin
      Says what a blob holds.
  plan-compiler query plans.bin --layer gate/physical --at -26,-18
      Asks for the advice at one point, as the robot would.
  plan-compiler query plans.bin --layer gate/physical --route -26,-18 --format csv
      The whole route from a point; --format geojson for a map viewer.
  plan-compiler export plans.bin --layer gate/physical --what cost -o cost.npy
      Writes the cost to the goal of every cell as a NumPy array.
  plan-compiler render plans.bin --layer gate/physical -o field.png
      Draws obstacles, bands of cost and the advice.
  plan-compiler render plans.bin --layer gate/physical --layers --route -26,-18 -o ways.png
      Draws all layers of plan gate in one picture, in each the way from a point.
  plan-compiler graph tests/maps/plough.mission.toml -o plough.svg
      Draws behaviours and their plans as graphs.
  plan-compiler verify plans.bin --map tests/maps/yard.osm
      Proves every cell of every layer anew, and compares it with the map.
  plan-compiler convert plans.bin -o Iplan.dat
      Writes the plans as MissionLab reads them.

Exit status: 0 done, 1 the input is wrong, 2 the command line is wrong.";

const ASSUMPTIONS: &str = "\
What is assumed of maps:
  All      Metres, x east, y north. A cell is blocked if the exact shape, grown by the
           robot's radius, touches it: --robot-radius, else the mission's, else its
           vehicle's, 0.3 m; none in MovingAI maps and Iplan.dat, worlds of a point. A
           diagonal step needs both cells beside it free unless --corners allow.
  Overlay  (MissionLab .ovl) ORIGIN is added to coordinates and subtracted from UTM ones.
           UTM LAT/LON is converted by WGS-84, not by the historic Clarke 1866. HEADING is
           where the map's y axis points, degrees clockwise from true north; only positions
           on the globe depend on it. OBSTACLE gives a radius, OBJECT a diameter; OBJECTs
           block only if FIXED. Walls are lines: their insides are unreachable, and blocked
           only with --fill-walls. BOUNDARYs whose names hold NoCommZone block in layer
           `comms`; NoFlyZones and WeatherZones only where a mission says so. A comment
           `--RESOLUTION 1.0` sets the cells.
  OPAR     WGS-84 decimal degrees. Deltas are metres (--opar-units deg for degrees), each
           an offset from its record's position, east before north (--opar-order ne for
           the reverse). The points form a closed polygon. Type 1 is a building, an
           obstacle; type 2 foliage, which weakens radio and blocks in layer `comms` only
           (--opar-type N=building|foliage for others). Outside the area's polygon
           everything is blocked.";

const MISSIONS: &str = "\
A mission file NAME.mission.toml beside the map NAME sets goals, layers, the robot's radius,
speeds and gains; MISSION.md lists its keys.";

const CONVERSIONS: &str = "\
A map is compiled as by `build`; the options that say how are not for blobs.

An Iplan.dat has a contingency map: the first layer of plan `contingency`, otherwise of the plan
that the robot follows. Each other layer is an element MOVETO of its own. Costs are metres,
9998 an obstacle, 9999 a cell without a route; positions count from the centre of the
south-west cell. With --corners allow the costs are those of the historic program.

Examples:
  plan-compiler convert tests/maps/shop.ovl -o Iplan.dat
  plan-compiler convert Iplan.dat --corners allow -o plans.bin
  plan-compiler convert plans.bin -o Iplan.dat";

/// What is assumed of every format: the first two are as old as the program, the others are
/// said where they are read.
fn assumptions() -> String {
    let formats = [
        ros::CONVENTIONS,
        movingai::CONVENTIONS,
        geojson::CONVENTIONS,
        osm::CONVENTIONS,
        tags::CONVENTIONS,
        iplan::CONVENTIONS,
        pcf::CONVENTIONS,
    ];
    let formats = formats.map(|text| format!("\n  {}", text.replace('\n', "\n  "))).concat();
    format!("{ASSUMPTIONS}{formats}\n\n{MISSIONS}")
}

/// Compiles maps into internalized plans for small robots.
///
/// A plan holds, for every cell of a map, the cost to a goal and the best of eight
/// directions; the robot's firmware reads it in place.
#[derive(Debug, Parser)]
#[command(name = "plan-compiler", version, after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", assumptions()))]
pub(crate) struct Cli {
    /// Print warnings and errors only
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Compile a map, or a mission that names one, into a blob of plans
    #[command(after_long_help = assumptions())]
    Build(Build),
    /// Say what a blob holds
    Inspect(Inspect),
    /// Ask a layer for the advice at points: a line of JSON for each
    Query(Query),
    /// Write a layer as an array [row, column], row 0 in the south
    Export(Export),
    /// Draw a layer as SVG or PNG
    Render(Render),
    /// Draw behaviours and their plans as graphs: DOT, SVG or PNG
    Graph(Graph),
    /// Prove every cell of every layer anew
    ///
    /// No cell is trusted: costs, directions and escapes are compared with those of every
    /// neighbour, and ways out of blocked cells are searched anew. On a PC that takes 0.1 to
    /// 0.5 microseconds a cell of a layer, and 10 bytes of memory a cell of the map.
    Verify(Verify),
    /// Make a MissionLab Iplan.dat of plans or of a map, or a blob of an Iplan.dat
    #[command(after_help = CONVERSIONS)]
    Convert(Convert),
    /// Print what a shell needs to complete the command line
    Completions(Completions),
    /// Print the manual page, of the program or of one of its commands
    Man(Man),
    /// Say how the behaviours of a recorded mission took turns, or why one tick went as it did
    Explain(Explain),
}

#[derive(Debug, Args)]
pub(crate) struct Explain {
    /// The trace, as `cargo mission --trace FILE` writes it
    pub(crate) trace: PathBuf,
    /// Everything about one tick, counted from 0, or `first` or `last`, instead of all turns
    #[arg(long, value_name = "N")]
    pub(crate) tick: Option<TickAt>,
}

/// A tick of a trace.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TickAt {
    /// Counted from 0.
    Number(usize),
    /// The last one.
    Last,
}

impl TickAt {
    /// Its number in a trace of so many ticks.
    pub(crate) fn index(self, ticks: usize) -> usize {
        match self {
            Self::Number(number) => number,
            Self::Last => ticks.saturating_sub(1),
        }
    }
}

impl std::str::FromStr for TickAt {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "first" => Ok(Self::Number(0)),
            "last" => Ok(Self::Last),
            _ => text
                .parse()
                .map(Self::Number)
                .map_err(|_| "write a number from 0, `first` or `last`".into()),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct Build {
    /// The map, or a mission file that names it
    #[arg(value_name = "MAP|MISSION")]
    pub(crate) input: PathBuf,
    /// The file to write: the blob itself, or by its name .hex (Intel HEX) or .uf2, which hold
    /// the board's address and are for flashing only
    #[arg(long, short, default_value = "plans.bin", value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Print the summary as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) compiling: Compiling,
}

/// What a map becomes when it is compiled.
#[derive(Debug, Args)]
pub(crate) struct Compiling {
    /// Refuse plans that do not fit this board's plan region
    #[arg(long, value_name = "NAME", value_parser = board())]
    pub(crate) board: Option<&'static Board>,
    /// Refuse maps whose search takes more memory than this; 4 if not given
    #[arg(long, value_name = "GIB", value_parser = gib)]
    pub(crate) max_memory: Option<u64>,
    /// A goal in the map's metres, x east, y north, or on the globe as NAME=geo:LAT,LON;
    /// repeatable. Replaces all other goals
    #[arg(long = "goal", value_name = "NAME=X,Y", value_parser = goal, allow_hyphen_values = true)]
    pub(crate) goals: Vec<Goal>,
    #[command(flatten)]
    pub(crate) map: MapOptions,
}

/// How a map is read and made into cells.
#[derive(Debug, Args)]
pub(crate) struct MapOptions {
    /// The mission file; otherwise NAME.mission.toml beside the map, if it is there
    #[arg(long, value_name = "FILE")]
    pub(crate) mission: Option<PathBuf>,
    /// Side of a cell; otherwise the mission's, the map's, or 1
    #[arg(long, value_name = "METRES", value_parser = length, allow_hyphen_values = true)]
    pub(crate) resolution: Option<f64>,
    /// Grow obstacles by this, so that the robot's centre keeps clear of them; otherwise the
    /// mission's radius, its vehicle's, or 0.3; in MovingAI maps and Iplan.dat 0
    #[arg(long, value_name = "METRES", value_parser = length, allow_hyphen_values = true)]
    pub(crate) robot_radius: Option<f64>,
    /// Whether a diagonal step may pass a blocked cell beside it
    #[arg(long, value_name = "RULE")]
    pub(crate) corners: Option<CornersRule>,
    /// Block the insides of closed walls too
    #[arg(long)]
    pub(crate) fill_walls: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

#[derive(Debug, Args)]
pub(crate) struct Inspect {
    /// The blob
    #[arg(value_name = "PLANS")]
    pub(crate) plans: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("points").required(true).args(["at", "geo", "route", "stdin"]))]
pub(crate) struct Query {
    /// The blob
    #[arg(value_name = "PLANS")]
    pub(crate) plans: PathBuf,
    /// The layer, as `inspect` names it; not needed where there is only one
    #[arg(long, value_name = "PLAN/LAYER")]
    pub(crate) layer: Option<LayerName>,
    /// A point in the map's metres, x east, y north
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) at: Option<[f64; 2]>,
    /// A place on the globe, WGS-84 degrees
    #[arg(long, value_name = "LAT,LON", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) geo: Option<[f64; 2]>,
    /// The whole route from a point in the map's metres, or on the globe as geo:LAT,LON, to the
    /// goal: what a robot drives that follows the advice only
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub(crate) route: Option<PointAt>,
    /// How the route is written
    #[arg(long, value_name = "FORMAT", default_value = "json", conflicts_with_all = ["at", "geo", "stdin"])]
    pub(crate) format: RouteFormat,
    /// Points from standard input, one a line: `X Y`, `X,Y`, or a pose `X Y HEADING` or
    /// `{x: X, y: Y, ...}`, of which only the position counts
    #[arg(value_name = "-", value_parser = ["-"])]
    pub(crate) stdin: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Export {
    /// The blob
    #[arg(value_name = "PLANS")]
    pub(crate) plans: PathBuf,
    /// The layer, as `inspect` names it; not needed where there is only one
    #[arg(long, value_name = "PLAN/LAYER")]
    pub(crate) layer: Option<LayerName>,
    /// What of it
    #[arg(long)]
    pub(crate) what: WhatToExport,
    /// The file to write: .npy or .csv
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Render {
    /// The blob
    #[arg(value_name = "PLANS")]
    pub(crate) plans: PathBuf,
    /// The layer, as `inspect` names it; not needed where there is only one
    #[arg(long, value_name = "PLAN/LAYER")]
    pub(crate) layer: Option<LayerName>,
    /// Draw all layers of a plan in one picture: of the plan that --layer names, otherwise of the
    /// one that the robot follows
    #[arg(long)]
    pub(crate) layers: bool,
    /// Draw the way from this point to the goal that a robot takes which follows the advice
    /// alone; in the map's metres, x east, y north
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) route: Option<[f64; 2]>,
    /// The file to write: .svg or .png
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// The longer side of the picture, 200 to 8000; letters, lines and arrows follow it
    #[arg(long, value_name = "PIXELS", default_value_t = Style::default().size_px, value_parser = size())]
    pub(crate) size: u32,
    /// Leave the arrows of the advice out
    #[arg(long)]
    pub(crate) no_arrows: bool,
    /// Draw the exact shapes of this map, which the plans were built from, over the cells
    #[arg(long, value_name = "MAP|MISSION")]
    pub(crate) map: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

#[derive(Debug, Args)]
pub(crate) struct Graph {
    /// A mission file, or a blob
    #[arg(value_name = "MISSION|PLANS")]
    pub(crate) input: PathBuf,
    /// The file to write: .dot, .svg or .png
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Verify {
    /// The blob
    #[arg(value_name = "PLANS")]
    pub(crate) plans: PathBuf,
    /// Print what was proved as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Also compare grid, place on the globe and blocked cells with those of this map, or of a
    /// mission that names it. Options that are not given are those of the build
    #[arg(long = "map", value_name = "MAP|MISSION")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) map: MapOptions,
}

#[derive(Debug, Args)]
pub(crate) struct Convert {
    /// A blob, a map in any format that is read, or a mission that names one
    #[arg(value_name = "PLANS|MAP|MISSION")]
    pub(crate) input: PathBuf,
    /// The file to write: .dat for an Iplan.dat; .bin, .hex or .uf2 for a blob
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) compiling: Compiling,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  plan-compiler completions bash > ~/.local/share/bash-completion/completions/plan-compiler
  plan-compiler completions zsh > ~/.zfunc/_plan-compiler
  plan-compiler completions fish > ~/.config/fish/completions/plan-compiler.fish")]
pub(crate) struct Completions {
    /// The shell
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  plan-compiler man > ~/.local/share/man/man1/plan-compiler.1
  plan-compiler man build | man -l -")]
pub(crate) struct Man {
    /// Of this command only
    #[arg(value_name = "COMMAND")]
    pub(crate) command: Option<String>,
}

/// What a map file itself leaves open.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// The map's format; otherwise by its content
    #[arg(long, value_name = "FORMAT", value_parser = words::<Format>())]
    pub(crate) format: Option<Format>,
    /// How cells that the map marks unknown are treated
    #[arg(long, value_name = "CELLS", default_value = "obstacle", value_parser = words::<Unknown>())]
    pub(crate) unknown: Unknown,
    /// What OPAR's deltas are measured in
    #[arg(long, value_name = "UNIT", default_value = "m", value_parser = words::<DeltaUnit>())]
    pub(crate) opar_units: DeltaUnit,
    /// Which of a pair of OPAR's deltas comes first: east or north
    #[arg(long, value_name = "ORDER", default_value = "en", value_parser = words::<DeltaOrder>())]
    pub(crate) opar_order: DeltaOrder,
    /// What a type of OPAR's obstructions is, besides 1=building and 2=foliage; repeatable
    #[arg(long = "opar-type", value_name = "N=building|foliage")]
    pub(crate) opar_types: Vec<ObstructionType>,
    /// Make obstacles of what has this tag, in GeoJSON and OpenStreetMap; repeatable
    #[arg(long, value_name = "KEY[=VALUE]")]
    pub(crate) block: Vec<TagRule>,
    /// Make free ground of what has this tag, in GeoJSON and OpenStreetMap; repeatable
    #[arg(long, value_name = "KEY[=VALUE]")]
    pub(crate) free: Vec<TagRule>,
    /// Let gates that are not locked open the fence that they stand in
    #[arg(long)]
    pub(crate) open_gates: bool,
    /// Where 0,0 of a GeoJSON or OpenStreetMap map is, WGS-84 degrees; otherwise the centre of
    /// what the file holds
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    pub(crate) origin: Option<GeoPoint>,
}

impl Reading {
    /// As the readers take it.
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
            tags: TagRules { block, free, open_gates: self.open_gates },
            origin: self.origin,
        }
    }
}

/// Reads one of the words of a choice.
fn words<T: Word + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let values = T::WORDS.iter().map(|(word, meaning, _)| PossibleValue::new(word).help(*meaning));
    PossibleValuesParser::new(values)
        .try_map(|word| T::of_word(&word).ok_or_else(|| format!("`{word}` is not one of them")))
}

/// Whether diagonal steps may cut corners.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum CornersRule {
    /// Both cells beside a diagonal step must be free
    Forbid,
    /// As in the papers
    Allow,
}

/// How a route is written.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum RouteFormat {
    /// One object: layer, length, and poses of x, y (metres) and yaw (radians), as ROS has them
    Json,
    /// A line for each pose, `x,y,yaw`; also `lat,lon` where the plans have a place on the globe
    Csv,
    /// A line of longitudes and latitudes, for a map viewer
    Geojson,
}

/// A point as it is written on the command line.
#[derive(Clone, Copy, Debug)]
pub(crate) enum PointAt {
    /// The map's metres.
    Map([f64; 2]),
    /// WGS-84.
    Globe(GeoPoint),
}

/// What of a layer to export.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum WhatToExport {
    /// float32 metres to the goal; inf where blocked or without a route
    Cost,
    /// int8: 0 to 7 for E NE N NW W SW S SE, -1 the goal, -2 blocked or without a route
    Direction,
    /// uint8: 1 blocked, 0 free
    Blocked,
}

/// `PLAN/LAYER`.
#[derive(Clone, Debug)]
pub(crate) struct LayerName {
    pub(crate) plan: String,
    pub(crate) layer: String,
}

impl std::str::FromStr for LayerName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('/') {
            Some((plan, layer)) if !plan.is_empty() && !layer.is_empty() => {
                Ok(Self { plan: plan.into(), layer: layer.into() })
            }
            _ => Err("write PLAN/LAYER, for example gate/physical; `inspect` lists them".into()),
        }
    }
}

fn board() -> impl TypedValueParser<Value = &'static Board> {
    let names = BOARDS.iter().map(|board| {
        let (size, address) = (board.memory.plans.bytes >> 10, board.memory.plans.address);
        let firmware =
            if board.state.has_firmware() { "" } else { "; plans only, no firmware yet" };
        PossibleValue::new(board.name.as_str())
            .help(format!("{size} KiB at {address:#010x}{firmware}"))
    });
    PossibleValuesParser::new(names)
        .try_map(|name| Board::find(&name).ok_or("there is no such board"))
}

/// GiB as bytes.
fn gib(text: &str) -> Result<u64, String> {
    let gib = number(text)?;
    if gib > 0.0 { Ok((gib * f64::from(1 << 30)) as u64) } else { Err("write GiB, above 0".into()) }
}

fn point(text: &str) -> Result<PointAt, String> {
    if mission::is_geo_uri(text) {
        return mission::geo_uri(text).map(PointAt::Globe);
    }
    pair(text).map(PointAt::Map)
}

/// A number of metres. What is out of range is for the compiler to say.
fn length(text: &str) -> Result<f64, String> {
    const UNITS: [(&str, f64); 5] =
        [("mm", 1e-3), ("cm", 1e-2), ("ft", 0.3048), ("feet", 0.3048), ("m", 1.0)];
    let text = text.trim();
    if let Ok(number) = text.parse() {
        return Ok(number);
    }
    let with_unit = UNITS.iter().find_map(|(unit, metres)| {
        let number = text.strip_suffix(unit)?.trim().parse::<f64>().ok()?;
        Some((number * metres * 1e6).round() / 1e6)
    });
    Err(match with_unit {
        Some(metres) => format!("write metres, the number alone: {metres}"),
        None => "write a number of metres, for example 0.25".into(),
    })
}

/// The longer side of a picture.
fn size() -> impl TypedValueParser<Value = u32> {
    let (least, most) = (i64::from(*SIZES_PX.start()), i64::from(*SIZES_PX.end()));
    clap::value_parser!(u32).range(least..=most)
}

fn place(text: &str) -> Result<GeoPoint, String> {
    let [lat, lon] = pair(text)?;
    let off = "latitudes are -90 to 90 degrees, longitudes -180 to 180; the latitude comes first";
    GeoPoint::from_degrees(lat, lon).ok_or_else(|| off.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn negative_numbers_are_numbers() {
        let parse = |line: &str| Cli::try_parse_from(line.split(' '));
        for line in [
            "p query a.bin --layer a/b --at -3,4",
            "p query a.bin --layer a/b --geo -33.8,-151.2",
            "p query a.bin --layer a/b -",
            "p query a.bin --at 1,2",
            "p query a.bin --route -1,2 --format csv",
            "p query a.bin --route geo:-33.8,151.2",
            "p build m.ovl --goal a=geo:-33.8,151.2;u=5",
            "p explain a.trace --tick last",
            "p query - --layer a/b --at=-3,-4",
            "p build m.ovl --goal a=-1,2 --goal b=-1e1,-.5",
            "p build m.ovl --resolution -1",
        ] {
            assert!(parse(line).is_ok(), "{line}: {}", parse(line).unwrap_err());
        }
        for line in [
            "p query a.bin --layer a/b",
            "p query a.bin --layer a/b --at 1,2 -",
            "p query a.bin --layer ab --at 1,2",
            "p query a.bin --layer a/b --at 1",
            "p query a.bin --layer a/b --at nan,1",
            "p query a.bin --at 1,2 --format csv",
            "p explain a.trace --tick -1",
            "p build m.ovl --resolution 0.25m",
            "p build m.ovl --goal a",
            "p build m.ovl --goal =1,2",
            "p build m.ovl --goal a/b=1,2",
            "p build m.ovl --corners maybe",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
    }
}
