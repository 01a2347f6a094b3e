//! Options of strips that cover an area.

use super::reading::MapOptions;
use super::words::size;
use clap::{ArgGroup, Args};
use plan_compiler::mission::words::{number, pair};
use plan_compiler::render::Style;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("where").required(true).args(["area", "polygon"]))]
pub(crate) struct Cover {
    /// The map, or a mission file that names it
    #[arg(value_name = "MAP|MISSION")]
    pub(crate) input: PathBuf,
    /// The area of the map to cover, by its name
    #[arg(long, value_name = "NAME")]
    pub(crate) area: Option<String>,
    /// A corner of the area to cover, in the map's metres, x east, y north; give all of them in
    /// order
    #[arg(long = "corner", value_name = "X,Y", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) polygon: Vec<[f64; 2]>,
    /// Width of the tool
    #[arg(long, value_name = "METRES", value_parser = above_zero, allow_negative_numbers = true)]
    pub(crate) width: f64,
    /// How far neighbouring strips overlap
    #[arg(long, value_name = "METRES", default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) overlap: f64,
    /// Direction of the strips, counter-clockwise from east; if not given, the one that needs the
    /// fewest strips
    #[arg(long, value_name = "DEGREES", value_parser = number, allow_hyphen_values = true)]
    pub(crate) angle: Option<f64>,
    /// Distance of the strips from the edge of the area; if not given, the robot's radius
    #[arg(long, value_name = "METRES", value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) edge: Option<f64>,
    /// Leave gaps up to this size uncovered instead of filling them with short strips
    #[arg(long, value_name = "M2", default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub(crate) leave: f64,
    /// The layer whose obstacles count, `physical` if not given; `comms` stays in radio contact
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
    /// In a mission, lead to every strip by a plan of its own, so that the work goes on from anywhere:
    /// after refuelling, for example
    #[arg(long, requires = "output")]
    pub(crate) plan_each: bool,
    /// Where the robot starts, in the map's metres; if not given, the map's start
    #[arg(long, value_name = "X,Y", value_parser = pair, allow_hyphen_values = true)]
    pub(crate) start: Option<[f64; 2]>,
    /// The file to write: .toml for a mission that drives the strips, .csv or .geojson for the
    /// strips, .svg or .png for a picture
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Most pixels of the picture's longer side, 200 to 8000
    #[arg(long, value_name = "PIXELS", requires = "output", default_value_t = Style::default().size_px, value_parser = size(), allow_negative_numbers = true)]
    pub(crate) size: u32,
    #[command(flatten)]
    pub(crate) map: MapOptions,
}

fn above_zero(text: &str) -> Result<f64, String> {
    match number(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err("write a number of metres above 0".into()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match number(text)? {
        value if value >= 0.0 => Ok(value),
        _ => Err("write a number of at least 0".into()),
    }
}
