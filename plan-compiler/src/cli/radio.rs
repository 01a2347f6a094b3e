//! Options of a radio and its places.

use super::reading::MapOptions;
use super::words::size;
use clap::{Args, ValueEnum};
use plan_compiler::comms::Need;
use plan_compiler::mission::words::{number, place};
use plan_compiler::mission::{Goal, RadioKey};
use plan_compiler::render::Style;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Comms {
    /// The map, or a mission file that names it
    #[arg(value_name = "MAP|MISSION")]
    pub(crate) input: PathBuf,
    /// A place to reach, in the map's metres, x east, y north, or on the globe as
    /// NAME=geo:LAT,LON; repeatable. Replaces the places of the mission
    #[arg(long = "place", value_name = "NAME=X,Y", value_parser = place, allow_hyphen_values = true)]
    pub(crate) places: Vec<Goal>,
    /// The file to write: .svg or .png for a picture, .npy for an array of margins
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Which of several places must be reached; if not given, the mission's choice, else all
    #[arg(long, value_name = "PLACES")]
    pub(crate) need: Option<Needed>,
    /// Most pixels of the picture's longer side, 200 to 8000
    #[arg(long, value_name = "PIXELS", requires = "output", default_value_t = Style::default().size_px, value_parser = size(), allow_negative_numbers = true)]
    pub(crate) size: u32,
    #[command(flatten)]
    pub(crate) radio: RadioOptions,
    #[command(flatten)]
    pub(crate) map: MapOptions,
}

/// Which of several places must be reached.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Needed {
    /// Every place: the worst link counts
    All,
    /// Any place: the best link counts
    Any,
}

impl From<Needed> for Need {
    fn from(needed: Needed) -> Self {
        match needed {
            Needed::All => Self::All,
            Needed::Any => Self::Any,
        }
    }
}

/// The radio, and heights that the map does not give.
#[derive(Debug, Args)]
pub(crate) struct RadioOptions {
    /// Least margin of a usable link; 10 if neither given nor in the mission
    #[arg(long, value_name = "DB", value_parser = within("threshold"), allow_hyphen_values = true)]
    threshold: Option<f64>,
    /// Frequency; otherwise 2.4
    #[arg(long, value_name = "GHZ", value_parser = within("frequency"), allow_negative_numbers = true)]
    frequency: Option<f64>,
    /// Power of the transmitter, plus the gains of both antennas; otherwise 24
    #[arg(long, value_name = "DBM", value_parser = within("power"), allow_hyphen_values = true)]
    power: Option<f64>,
    /// Least power that the receiver understands; otherwise -105
    #[arg(long, value_name = "DBM", value_parser = within("sensitivity"), allow_hyphen_values = true)]
    sensitivity: Option<f64>,
    /// Height of the robot's antenna above ground; otherwise 1
    #[arg(long, value_name = "METRES", value_parser = within("antenna"), allow_negative_numbers = true)]
    antenna: Option<f64>,
    /// Height of the antennas at the places; otherwise 1
    #[arg(long, value_name = "METRES", value_parser = within("place_antenna"), allow_negative_numbers = true)]
    place_antenna: Option<f64>,
    /// Height of obstacles for which the map gives no height; otherwise 6
    #[arg(long, value_name = "METRES", value_parser = within("obstacle_height"), allow_negative_numbers = true)]
    obstacle_height: Option<f64>,
    /// Height of foliage for which the map gives no height; otherwise 10
    #[arg(long, value_name = "METRES", value_parser = within("foliage_height"), allow_negative_numbers = true)]
    foliage_height: Option<f64>,
    /// Loss of each wall on the straight line; otherwise walls are opaque and only the way over
    /// them counts
    #[arg(long, value_name = "DB", value_parser = within("wall_loss"), allow_negative_numbers = true)]
    wall_loss: Option<f64>,
    /// Obstacles whose longest side is at most this do not weaken radio; otherwise 3
    #[arg(long, value_name = "METRES", value_parser = within("small"), allow_negative_numbers = true)]
    small: Option<f64>,
}

impl RadioOptions {
    /// The numbers by their names in a mission.
    pub(crate) fn given(&self) -> [(&'static str, Option<f64>); 10] {
        [
            ("threshold", self.threshold),
            ("frequency", self.frequency),
            ("power", self.power),
            ("sensitivity", self.sensitivity),
            ("antenna", self.antenna),
            ("place_antenna", self.place_antenna),
            ("obstacle_height", self.obstacle_height),
            ("foliage_height", self.foliage_height),
            ("wall_loss", self.wall_loss),
            ("small", self.small),
        ]
    }
}

/// A parser for a number with the range that it has in a mission.
fn within(name: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        let value = number(text)?;
        match RadioKey::find(name) {
            Some(key) if !key.accepts(value) => Err(format!("write {}", key.expected())),
            _ => Ok(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::cli::{Cli, Command};
    use clap::{CommandFactory, Parser};
    use plan_compiler::mission::{RADIO_KEYS, RadioRule};

    /// Every number of a mission's radio is an option, and its help names the default.
    #[test]
    fn options_and_keys_of_the_mission_are_the_same() {
        let command = Cli::command();
        let comms = command.find_subcommand("comms").unwrap();
        for key in RADIO_KEYS {
            let option = key.name.replace('_', "-");
            let argument = comms.get_arguments().find(|arg| arg.get_long() == Some(&option));
            let help = argument.unwrap_or_else(|| panic!("--{option}")).get_help().unwrap();
            if let Some(default) = (key.get)(&RadioRule::default()) {
                let help = help.to_string();
                assert!(
                    help.split(' ').any(|word| word == default.to_string()),
                    "{option}: {help}"
                );
            }
            let (low, _) = key.range;
            let line = format!("p comms m.ovl --{option}={low}");
            let Command::Comms(args) = Cli::parse_from(line.split(' ')).command else { panic!() };
            let set: Vec<_> = args.radio.given().into_iter().filter(|(_, v)| v.is_some()).collect();
            assert_eq!(set, [(key.name, Some(low))]);
        }
    }
}
