//! The command line, as `--help` documents it.

mod cover;
mod help;
mod radio;
mod reading;
mod words;

pub(crate) use cover::Cover;
pub(crate) use radio::Comms;
pub(crate) use reading::{Compiling, CornersRule, MapOptions, Reading};
pub(crate) use words::{LayerName, PointAt, TickAt};

use clap::{Args, Parser, Subcommand, ValueEnum};
use help::{CONVERSIONS, COVERAGE, EXAMPLES, RADIO, assumptions};
use plan_compiler::mission::words::pair;
use plan_compiler::render::Style;
use std::path::PathBuf;
use words::{point, size};

/// Compiles maps into internalized plans for small robots.
///
/// A plan contains, for every cell of a map, the cost to a goal and the best of eight
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
    /// Show what a blob contains
    Inspect(Inspect),
    /// Look up a layer's advice at points: one line of JSON per point
    Query(Query),
    /// Write a layer as an array [row, column], row 0 in the south
    Export(Export),
    /// Draw a layer as SVG or PNG
    #[command(mut_args = |option: clap::Arg| reading::only_with(option, "map"))]
    Render(Render),
    /// Compute where a radio reaches given places, and draw it as SVG or PNG or write it as an array
    #[command(after_help = RADIO)]
    Comms(Comms),
    /// Lay strips that cover an area: a mission that drives them, a table, or a picture
    #[command(after_help = COVERAGE)]
    Cover(Cover),
    /// Draw behaviours and their plans as graphs: DOT, SVG or PNG
    Graph(Graph),
    /// Re-prove every cell of every layer
    ///
    /// No cell is trusted: costs, directions and escapes are compared with those of every
    /// neighbour, and the escapes from blocked cells are searched again. On a PC this takes 0.1
    /// to 0.5 microseconds per cell and layer, and 10 bytes of memory per cell of the map.
    #[command(mut_args = |option: clap::Arg| reading::only_with(option, "input"))]
    Verify(Verify),
    /// Convert plans or a map to a MissionLab Iplan.dat, or an Iplan.dat to a blob
    #[command(after_help = CONVERSIONS)]
    Convert(Convert),
    /// Print a completion script for a shell
    Completions(Completions),
    /// Print the manual page of the program or of one command
    Man(Man),
    /// Explain how the behaviours took turns in a recorded run, or how one tick was decided
    Explain(Explain),
}

#[derive(Debug, Args)]
pub(crate) struct Explain {
    /// The trace, written by `cargo mission --trace FILE`
    pub(crate) trace: PathBuf,
    /// Explain one tick in full instead of listing all turns: a number from 0, `first` or `last`
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) tick: Option<TickAt>,
}

#[derive(Debug, Args)]
pub(crate) struct Build {
    /// The map, or a mission file that names it
    #[arg(value_name = "MAP|MISSION")]
    pub(crate) input: PathBuf,
    /// The file to write: the blob; or, with extension .hex (Intel HEX) or .uf2, a file for
    /// flashing only, which contains the board's flash address
    #[arg(long, short, default_value = "plans.bin", value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Print the summary as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) compiling: Compiling,
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
    /// The layer, as `inspect` names it; optional if there is only one
    #[arg(long, value_name = "PLAN/LAYER")]
    pub(crate) layer: Option<LayerName>,
    /// A point in the map's metres, x east, y north
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) at: Option<[f64; 2]>,
    /// A place on the globe, WGS-84 degrees
    #[arg(long, value_name = "LAT,LON", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) geo: Option<[f64; 2]>,
    /// Print the route to the goal of a robot that follows the advice only, from a point in the
    /// map's metres or on the globe as geo:LAT,LON
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub(crate) route: Option<PointAt>,
    /// Format of the route
    #[arg(long, value_name = "FORMAT", default_value = "json", conflicts_with_all = ["at", "geo", "stdin"])]
    pub(crate) format: RouteFormat,
    /// Read points from standard input, one per line: `X Y`, `X,Y`, or a pose `X Y HEADING` or
    /// `{x: X, y: Y, ...}`; only the position of a pose is used
    #[arg(value_name = "-", value_parser = ["-"])]
    pub(crate) stdin: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Export {
    /// The blob
    #[arg(value_name = "PLANS")]
    pub(crate) plans: PathBuf,
    /// The layer, as `inspect` names it; optional if there is only one
    #[arg(long, value_name = "PLAN/LAYER")]
    pub(crate) layer: Option<LayerName>,
    /// What to export
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
    /// The layer, as `inspect` names it; optional if there is only one
    #[arg(long, value_name = "PLAN/LAYER")]
    pub(crate) layer: Option<LayerName>,
    /// Draw all layers of one plan in one picture: the plan that --layer names, else the plan that
    /// the robot follows
    #[arg(long)]
    pub(crate) layers: bool,
    /// Draw the route to the goal of a robot that follows the advice only, from this point in the
    /// map's metres, x east, y north
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) route: Option<[f64; 2]>,
    /// Draw that route as the robot drives it if it may choose its layer, with a colour for each layer
    #[arg(long, requires = "route")]
    pub(crate) chosen: bool,
    /// The file to write: .svg or .png
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Most pixels of the picture's longer side, 200 to 8000; text, lines and arrows scale with it
    #[arg(long, value_name = "PIXELS", default_value_t = Style::default().size_px, value_parser = size(), allow_negative_numbers = true)]
    pub(crate) size: u32,
    /// Do not draw the arrows of the advice
    #[arg(long)]
    pub(crate) no_arrows: bool,
    /// Draw the exact shapes of this map over the cells; the plans must be built from it
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
    /// The robot of the mission's team
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Verify {
    /// The blob
    #[arg(value_name = "PLANS")]
    pub(crate) plans: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Also compare the grid, the place on the globe and the blocked cells with this map, or with
    /// the map that this mission names. Options that are not given are those of the build
    #[arg(long = "map", value_name = "MAP|MISSION")]
    pub(crate) input: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) map: MapOptions,
}

#[derive(Debug, Args)]
pub(crate) struct Convert {
    /// A blob, a map in any supported format, or a mission that names a map
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
    /// Print the page of this command only
    #[arg(value_name = "COMMAND")]
    pub(crate) command: Option<String>,
}

/// What to export of a layer.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum WhatToExport {
    /// float32 metres to the goal; inf where blocked or without a route
    Cost,
    /// int8: 0 to 7 for E NE N NW W SW S SE, -1 the goal, -2 blocked or without a route
    Direction,
    /// uint8: 1 blocked, 0 free
    Blocked,
    /// float32 factor of steps out of the cell; 0 where blocked, without a route, or the goal
    Toll,
    /// float32 m/s, the speed limit; inf where there is none
    Limit,
    /// int8: which of several goals the advice leads to, from 0; -2 blocked or without a route
    Goal,
}

/// How a route is written.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum RouteFormat {
    /// One object: layer, length, and poses of x, y (metres) and yaw (radians), as in ROS
    Json,
    /// One line per pose, `x,y,yaw`; with `lat,lon` if the plans have a place on the globe
    Csv,
    /// A LineString of longitudes and latitudes, for a map viewer
    Geojson,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    /// Options about a map are refused without one: they would have no effect.
    #[test]
    fn options_without_effect_are_refused() {
        let parse = |line: &str| Cli::try_parse_from(line.split(' '));
        for line in [
            "p verify a.bin",
            "p verify a.bin --map m.ovl --robot-radius 0.5 --unknown free",
            "p render a.bin -o a.png",
            "p render a.bin -o a.png --map m.ovl --open-gates",
            "p comms m.ovl --place a=1,2 -o a.png --size 400",
        ] {
            assert!(parse(line).is_ok(), "{line}: {}", parse(line).unwrap_err());
        }
        for line in [
            "p verify a.bin --robot-radius 0.5",
            "p verify a.bin --open-gates --origin 3,4",
            "p verify a.bin --unknown free",
            "p render a.bin -o a.png --open-gates",
            "p comms m.ovl --place a=1,2 --size 400",
            "p cover m.ovl --area a --width 2 --size 400",
            "p cover m.ovl --area a --width 2 --plan-each",
        ] {
            let error = parse(line).expect_err(line);
            let missing = clap::error::ErrorKind::MissingRequiredArgument;
            assert_eq!(error.kind(), missing, "{line}: {error}");
        }
        let command = Cli::command();
        let verify = command.find_subcommand("verify").expect("it is a command");
        let about_maps = verify.get_arguments().map(|option| option.get_id().as_str());
        let about_maps = about_maps.filter(|id| !["plans", "json", "input"].contains(id));
        assert_eq!(about_maps.collect::<Vec<_>>(), reading::ABOUT_MAPS);
    }

    /// `--width -1` gets this program's own message on its range, not one on an unknown option `-1`.
    #[test]
    fn every_number_may_be_negative() {
        let mut command = Cli::command();
        command.build();
        let mut tried = 0;
        for sub in command.get_subcommands() {
            for option in sub.get_arguments().filter_map(|argument| {
                let names = argument.get_value_names().unwrap_or_default();
                let takes_number = |name: &clap::builder::Str| {
                    ["METRES", "DEGREES", "M2", "DB", "DBM", "GHZ", "GIB", "PIXELS", "N"]
                        .contains(&name.as_str())
                };
                argument.get_long().filter(|_| names.iter().any(takes_number))
            }) {
                let line = ["p", sub.get_name(), &format!("--{option}"), "-1"];
                let error = Cli::try_parse_from(line).expect_err("an input is missing");
                let unknown = clap::error::ErrorKind::UnknownArgument;
                assert_ne!(error.kind(), unknown, "{line:?}: {error}");
                tried += 1;
            }
        }
        assert!(tried > 20, "{tried}");
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
            "p build m.ovl --goal fuel=-1,2;geo:1,2;u=5;3,4",
            "p build m.ovl --resolution -1",
            "p comms m.ovl --place a=-1,2 --threshold -3 --sensitivity -105 --need any",
            "p comms m.ovl -o a.npy --json",
            "p cover m.ovl --area Field --width 2 --angle -30 --start -1,2 -o a.toml",
            "p cover m.ovl --corner -1,2 --corner 3,4 --corner 5,-6 --width .5 --json",
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
            "p build m.ovl --goal a=1,2;",
            "p build m.ovl --goal a=1,2;b=3,4",
            "p build m.ovl --goal a/b=1,2",
            "p build m.ovl --corners maybe",
            "p comms m.ovl --place 1,2",
            "p comms m.ovl --place a=1,2 --frequency 2400",
            "p comms m.ovl --place a=1,2 --need some",
            "p cover m.ovl --width 2",
            "p cover m.ovl --area a --corner 1,2 --width 2",
            "p cover m.ovl --area a",
            "p cover m.ovl --area a --width 0",
            "p cover m.ovl --area a --width 2 --angle inf",
            "p cover m.ovl --corner 1,nan --width 2",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
    }
}
