//! What of the surroundings changes by the robot's work: tanks that it drains and fills, fields that
//! it works strip by strip. The robot hears of them as inputs of its percepts.
//!
//! They are described in a TOML file beside the map, `yard.world.toml` for `yard.ovl`:
//!
//! ```toml
//! start = [12, 10]            # where a mission begins, metres
//! heading = 0                 # radians counter-clockwise from east
//! time_limit = 3600           # seconds
//! gps_sigma = 0.02            # standard deviation of a fix, metres; the usual metre if not given
//! # signal = 7                # done is only what the robot has signalled by this number
//!
//! [tanks.fuel]
//! channel = 1                 # input of the percepts that says how full it is, 0 to 1
//! level = 1                   # at the start
//! use_per_m = 0.0025          # of the whole tank, for a metre driven
//! fill_per_s = 0.05           # of the whole tank ...
//! at = [90.25, 28.25]         # ... within so many metres of this place ...
//! within = 2
//! output = 1                  # ... while this output is on; always if not given
//! # leak = { after_m = 180, to = 0.1 }    # once, after so many metres, it falls to this level
//!
//! [fields.ready]
//! channel = 3                 # the share of strips that are done, 0 to 1
//! within = 1.5                # how far from a strip's line the robot may be, metres
//! strips = [[[10, 12], [10, 68]], [[20, 68], [20, 12]]]   # each from its start to its end
//! # output = 2                # only what is driven while this output is on counts
//! ```
//!
//! A strip is done when the robot has followed it from its start to its end without leaving it. A
//! mission ends when all strips are done and the robot has given the signal, or where none is asked
//! for has nothing left to do.

use crate::Point;
use crate::body::distance;
use robot_io::limits::MAX_CHANNELS;
use robot_io::{Commands, Reason};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// What a file beside the map says.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// Where a mission begins, metres.
    pub start: Point,
    /// Radians counter-clockwise from east.
    #[serde(default)]
    pub heading: f64,
    /// Longer missions are given up, seconds.
    #[serde(default = "an_hour")]
    pub time_limit: f64,
    /// Standard deviation of a fix east and north, metres; `None` for the usual one.
    pub gps_sigma: Option<f64>,
    /// What the robot signals when it has done its work.
    pub signal: Option<u16>,
    #[serde(skip)]
    is_signalled: bool,
    /// By their names.
    #[serde(default)]
    pub tanks: BTreeMap<String, Tank>,
    /// By their names.
    #[serde(default)]
    pub fields: BTreeMap<String, Field>,
}

fn an_hour() -> f64 {
    3_600.0
}

/// Something that the robot uses up.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tank {
    channel: usize,
    /// How full it is, 0 to 1.
    pub level: f64,
    use_per_m: f64,
    fill_per_s: f64,
    at: Point,
    within: f64,
    output: Option<u16>,
    leak: Option<Leak>,
    /// How often filling began.
    #[serde(skip)]
    pub fills: u32,
    /// The way so far, metres.
    #[serde(skip)]
    way_m: f64,
    #[serde(skip)]
    is_filling: bool,
}

/// A mishap: once, after a way, a tank falls to a level.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Leak {
    after_m: f64,
    to: f64,
}

/// Land that the robot works in strips.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    channel: usize,
    within: f64,
    output: Option<u16>,
    strips: Vec<[Point; 2]>,
    /// What was done to each strip.
    #[serde(skip)]
    pub work: Vec<Work>,
}

/// What was done to a strip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// How often the robot drove into it from its start.
    pub begun: u32,
    /// How often it came to the end.
    pub done: u32,
    at: Along,
}

/// Where on a strip the robot is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Along {
    /// Not on it, or not from its start.
    #[default]
    Off,
    /// Within reach of its start.
    Start,
    /// On it.
    Under,
}

impl Surroundings {
    /// Reads the file beside a map; none if there is none. The error names file, line, column and
    /// what is wrong.
    pub fn beside(map: &Path) -> Result<Option<Self>, String> {
        let plain = map.with_extension("");
        // A mission file has two extensions.
        let plain = if plain.extension().is_some_and(|e| e == "mission") {
            plain.with_extension("")
        } else {
            plain
        };
        let path = plain.with_extension("world.toml");
        if !path.exists() {
            return Ok(None);
        }
        let wrong = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let text = std::fs::read_to_string(&path).map_err(|error| wrong(&error))?;
        text.parse().map(Some).map_err(|error: String| wrong(&error))
    }

    /// What the percepts' inputs are.
    pub fn inputs(&self) -> [Option<f32>; MAX_CHANNELS] {
        let mut inputs = [None; MAX_CHANNELS];
        let tanks = self.tanks.values().map(|tank| (tank.channel, tank.level));
        let fields = self.fields.values().map(|field| (field.channel, field.share()));
        for (channel, value) in tanks.chain(fields) {
            inputs[channel] = Some(value as f32);
        }
        inputs
    }

    /// The robot has driven `way_m` metres to a place in some time, by these commands.
    pub fn step(&mut self, at: Point, way_m: f64, commands: &Commands, seconds: f64) {
        let outputs = commands.outputs;
        self.is_signalled |= self.signal == Some(commands.signal);
        for tank in self.tanks.values_mut() {
            tank.step(at, way_m, outputs, seconds);
        }
        for field in self.fields.values_mut() {
            if is_on(outputs, field.output) {
                field.step(at);
            }
        }
    }

    /// Whether all work is done, for a robot that gives this reason for what it does.
    pub fn is_done(&self, reason: Reason) -> bool {
        let is_over =
            if self.signal.is_some() { self.is_signalled } else { reason == Reason::Idle };
        is_over && self.fields.values().all(|field| field.share() >= 1.0)
    }

    /// A line for each tank and field.
    pub fn summary(&self) -> Vec<String> {
        let tanks = self.tanks.iter().map(|(name, tank)| {
            format!("{name}: {:.2} left, filled {} times", tank.level, tank.fills)
        });
        let fields = self.fields.iter().map(|(name, field)| {
            let count = |matches: fn(&&Work) -> bool| field.work.iter().filter(matches).count();
            format!(
                "{name}: {} of {} strips done, {} begun again, {} done twice",
                count(|work| work.done > 0),
                field.work.len(),
                field.work.iter().map(|work| work.begun.saturating_sub(1)).sum::<u32>(),
                count(|work| work.done > 1),
            )
        });
        tanks.chain(fields).collect()
    }

    fn check(&self) -> Result<(), String> {
        let tanks = self.tanks.iter().map(|(name, tank)| (name, tank.channel));
        let fields = self.fields.iter().map(|(name, field)| (name, field.channel));
        let mut taken = [false; MAX_CHANNELS];
        for (name, channel) in tanks.chain(fields) {
            let Some(taken) = taken.get_mut(channel) else {
                return Err(format!("`{name}`: channels are 0 to {}", MAX_CHANNELS - 1));
            };
            if std::mem::replace(taken, true) {
                return Err(format!("`{name}`: channel {channel} is given twice"));
            }
        }
        match self.fields.iter().find(|(_, field)| field.strips.is_empty()) {
            Some((name, _)) => Err(format!("`{name}` has no strips")),
            None => Ok(()),
        }
    }
}

impl std::str::FromStr for Surroundings {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut read: Self = toml_edit::de::from_str(text).map_err(|error| error.to_string())?;
        read.check()?;
        for field in read.fields.values_mut() {
            field.work = vec![Work::default(); field.strips.len()];
        }
        Ok(read)
    }
}

impl Tank {
    fn step(&mut self, at: Point, way_m: f64, outputs: u16, seconds: f64) {
        self.level -= way_m * self.use_per_m;
        self.way_m += way_m;
        if let Some(leak) = self.leak.take_if(|leak| leak.after_m <= self.way_m) {
            self.level = self.level.min(leak.to);
        }
        let is_filling = is_on(outputs, self.output) && distance(at, self.at) <= self.within;
        if is_filling {
            self.level += self.fill_per_s * seconds;
            self.fills += u32::from(!self.is_filling);
        }
        self.is_filling = is_filling;
        self.level = self.level.clamp(0.0, 1.0);
    }
}

impl Field {
    /// The share of its strips that are done, 0 to 1.
    fn share(&self) -> f64 {
        self.work.iter().filter(|work| work.done > 0).count() as f64 / self.strips.len() as f64
    }

    fn step(&mut self, at: Point) {
        for (&[start, end], work) in self.strips.iter().zip(&mut self.work) {
            let length_m = distance(start, end);
            let unit = [0, 1].map(|axis| (end[axis] - start[axis]) / length_m);
            let from = [0, 1].map(|axis| at[axis] - start[axis]);
            let along_m = from[0] * unit[0] + from[1] * unit[1];
            let aside_m = (from[0] * unit[1] - from[1] * unit[0]).abs();
            work.at = match work.at {
                _ if aside_m > self.within => Along::Off,
                _ if distance(at, start) <= self.within => Along::Start,
                Along::Start => {
                    work.begun += 1;
                    Along::Under
                }
                Along::Under if along_m >= length_m - self.within => {
                    work.done += 1;
                    Along::Off
                }
                before => before,
            };
        }
    }
}

/// Whether an output is on; what asks for none counts as on.
fn is_on(outputs: u16, output: Option<u16>) -> bool {
    output.is_none_or(|output| outputs.checked_shr(output.into()).is_some_and(|rest| rest & 1 == 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const YARD: &str = "start = [0, 0]\n\
        [tanks.fuel]\nchannel = 1\nlevel = 0.5\nuse_per_m = 0.01\nfill_per_s = 0.1\nat = [0, 0]\nwithin = 2\noutput = 3\n\
        [fields.ready]\nchannel = 4\nwithin = 1\nstrips = [[[0, 0], [10, 0]], [[0, 5], [0, 9]]]\n";

    fn with(outputs: u16) -> Commands {
        Commands { outputs, ..Commands::stop(Reason::Driving) }
    }

    fn yard() -> Surroundings {
        YARD.parse().expect("it is sound")
    }

    #[test]
    fn a_tank_drains_with_the_way_and_fills_in_its_place_only() {
        let mut yard = yard();
        yard.step([5.0, 0.0], 10.0, &with(0), 1.0);
        assert!((yard.tanks["fuel"].level - 0.4).abs() < 1e-9);
        for (at, outputs, level) in [
            ([1.0, 0.0], 0, 0.4),
            ([5.0, 0.0], 0b1000, 0.4),
            ([1.0, 0.0], 0b0100, 0.4),
            ([1.0, 0.0], 0b1000, 0.5),
        ] {
            yard.step(at, 0.0, &with(outputs), 1.0);
            assert!((yard.tanks["fuel"].level - level).abs() < 1e-9, "{at:?} {outputs}");
        }
        yard.step([0.0; 2], 0.0, &with(0b1000), 99.0);
        assert_eq!((yard.tanks["fuel"].level, yard.tanks["fuel"].fills), (1.0, 1));
        assert_eq!(yard.inputs(), [None, Some(1.0), None, None, Some(0.0), None, None, None]);
    }

    #[test]
    fn a_leak_happens_once() {
        let text = YARD.replace("output = 3", "output = 3\nleak = { after_m = 3, to = 0.2 }");
        let mut yard: Surroundings = text.parse().expect("it is sound");
        let levels = [2.0, 2.0, 0.0, 5.0].map(|way_m| {
            let outputs = if way_m == 0.0 { 0b1000 } else { 0 };
            yard.step([0.0; 2], way_m, &with(outputs), 3.0);
            (yard.tanks["fuel"].level * 100.0).round()
        });
        assert_eq!(levels, [48.0, 20.0, 50.0, 45.0]);
    }

    /// Drives along a way in steps of half a metre.
    fn drive(yard: &mut Surroundings, way: &[Point]) -> Vec<(u32, u32)> {
        for pair in way.windows(2) {
            let steps = (distance(pair[0], pair[1]) * 2.0).ceil();
            for step in 0..=steps as u32 {
                let t = f64::from(step) / steps;
                let at = [0, 1].map(|i| pair[0][i] + t * (pair[1][i] - pair[0][i]));
                yard.step(at, 0.5, &with(0), 0.5);
            }
        }
        yard.fields["ready"].work.iter().map(|work| (work.begun, work.done)).collect()
    }

    #[test]
    fn a_strip_is_done_from_its_start_to_its_end_or_not_at_all() {
        for (way, expected) in [
            // From start to end, a little beside it.
            (&[[0.0, 0.0], [10.0, 0.5]][..], (1, 1)),
            // Backwards.
            (&[[10.0, 0.0], [0.0, 0.0]], (0, 0)),
            // From the middle on.
            (&[[5.0, 3.0], [5.0, 0.0], [10.0, 0.0]], (0, 0)),
            // Left in the middle, and from there to the end.
            (&[[0.0, 0.0], [5.0, 0.0], [5.0, 2.0], [5.0, 0.0], [10.0, 0.0]], (1, 0)),
            // Left, begun again.
            (&[[0.0, 0.0], [5.0, 0.0], [5.0, 2.0], [0.0, 2.0], [0.0, 0.0], [10.0, 0.0]], (2, 1)),
        ] {
            let mut yard = yard();
            assert_eq!(drive(&mut yard, way), [expected, (0, 0)], "{way:?}");
            assert!(!yard.is_done(Reason::Idle));
        }
        let mut yard = yard();
        drive(&mut yard, &[[0.0, 0.0], [10.0, 0.0], [0.0, 5.0], [0.0, 9.0]]);
        assert!(yard.is_done(Reason::Idle) && !yard.is_done(Reason::Driving));
        yard.signal = Some(7);
        assert!(!yard.is_done(Reason::Idle));
        yard.step([0.0; 2], 0.0, &Commands { signal: 7, ..with(0) }, 1.0);
        assert!(yard.is_done(Reason::Driving));
        assert_eq!(yard.summary()[1], "ready: 2 of 2 strips done, 0 begun again, 0 done twice");
    }

    #[test]
    fn mistakes_are_named() {
        for (from, to, expected) in [
            ("channel = 4", "channel = 8", "`ready`: channels are 0 to 7"),
            ("channel = 4", "channel = 1", "`ready`: channel 1 is given twice"),
            ("[[[0, 0], [10, 0]], [[0, 5], [0, 9]]]", "[]", "`ready` has no strips"),
            ("within = 2", "with_in = 2", "unknown field `with_in`"),
            ("level = 0.5", "level = 'full'", "line 4, column 9"),
        ] {
            let text = YARD.replace(from, to);
            let said = text.parse::<Surroundings>().expect_err(to);
            assert!(said.contains(expected), "{said}");
        }
    }
}
