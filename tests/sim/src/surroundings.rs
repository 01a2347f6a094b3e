//! The surroundings that the robot's work changes: tanks that it drains and fills, and fields that
//! it works strip by strip. Each is an input of the robot's percepts.
//!
//! A world file describes them, see `world_file`.
//!
//! A strip is done when the robot has followed it from its start to its end without leaving it. A
//! run with work ends when all strips are done and the robot has given the signal, or, if the file
//! asks for no signal, has nothing left to do.

use crate::Point;
use crate::geometry::distance;
use robot_io::limits::MAX_CHANNELS;
use robot_io::{Commands, Reason};
use std::collections::BTreeMap;

/// The start of a world file, and its work as the robot changes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// Start position of the robot, metres.
    pub start: Point,
    /// Heading at the start, radians counter-clockwise from east.
    pub heading: f64,
    /// Time limit of a run, seconds.
    pub time_limit: f64,
    /// Standard deviation of a fix east and north, metres; `None` for the usual one.
    pub gps_sigma: Option<f64>,
    /// The signal that the robot gives when its work is done.
    pub signal: Option<u16>,
    pub(crate) is_signalled: bool,
    /// The tanks by name.
    pub tanks: BTreeMap<String, Tank>,
    /// The fields by name.
    pub fields: BTreeMap<String, Field>,
}

/// A supply that the robot uses up as it drives, such as fuel.
#[derive(Clone, Debug, PartialEq)]
pub struct Tank {
    pub(crate) channel: usize,
    /// Level, 0 (empty) to 1 (full).
    pub level: f64,
    pub(crate) use_per_m: f64,
    pub(crate) fill_per_s: f64,
    pub(crate) at: Point,
    pub(crate) within: f64,
    pub(crate) output: Option<u16>,
    pub(crate) leak: Option<Leak>,
    /// How often filling began.
    pub fills: u32,
    /// Distance driven so far, metres.
    pub(crate) driven_m: f64,
    pub(crate) is_filling: bool,
}

/// A leak: once, after `after_m` metres, the level falls to `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leak {
    pub(crate) after_m: f64,
    pub(crate) to: f64,
}

/// Land that the robot works in strips.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub(crate) channel: usize,
    pub(crate) within: f64,
    pub(crate) output: Option<u16>,
    pub(crate) strips: Vec<[Point; 2]>,
    /// The work done on each strip.
    pub work: Vec<Work>,
}

/// The work done on a strip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// How often the robot began it at its start.
    pub begun: u32,
    /// How often the robot finished it.
    pub done: u32,
    at: Along,
}

/// The robot's position relative to a strip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Along {
    /// Beside the strip, or on it without having begun at its start.
    #[default]
    Off,
    /// At its start.
    Start,
    /// On the strip, begun at its start.
    Under,
}

impl Surroundings {
    /// The inputs of the percepts, by channel.
    pub fn inputs(&self) -> [Option<f32>; MAX_CHANNELS] {
        let mut inputs = [None; MAX_CHANNELS];
        let tanks = self.tanks.values().map(|tank| (tank.channel, tank.level));
        let fields = self.fields.values().map(|field| (field.channel, field.share()));
        for (channel, value) in tanks.chain(fields) {
            inputs[channel] = Some(value as f32);
        }
        inputs
    }

    /// Accounts for a step in which the robot drove `driven_m` metres to `at` by these commands.
    pub fn step(&mut self, at: Point, driven_m: f64, commands: &Commands, seconds: f64) {
        let outputs = commands.outputs;
        self.is_signalled |= self.signal == Some(commands.signal);
        for tank in self.tanks.values_mut() {
            tank.step(at, driven_m, outputs, seconds);
        }
        for field in self.fields.values_mut() {
            if is_on(outputs, field.output) {
                field.step(at);
            }
        }
    }

    /// Whether there is work; if so, its end is the end of the run.
    pub fn has_work(&self) -> bool {
        self.signal.is_some() || !self.fields.is_empty()
    }

    /// Whether all work is done; `reason` is that of the robot's commands in this tick.
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
}

impl Tank {
    fn step(&mut self, at: Point, driven_m: f64, outputs: u16, seconds: f64) {
        self.level -= driven_m * self.use_per_m;
        self.driven_m += driven_m;
        if let Some(leak) = self.leak.take_if(|leak| leak.after_m <= self.driven_m) {
            self.level = self.level.min(leak.to);
        }
        let is_filling = is_on(outputs, self.output) && distance(at, self.at) <= self.within;
        if is_filling {
            self.level += self.fill_per_s * seconds;
            self.fills += u32::from(!self.is_filling && self.fill_per_s > 0.0);
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

/// Whether an output is on; `None` counts as on.
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
    fn a_tank_drains_with_the_distance_and_fills_at_its_station_only() {
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
    fn a_tank_that_takes_nothing_in_is_never_filled() {
        let text = YARD.replace("fill_per_s = 0.1", "fill_per_s = 0");
        let mut yard: Surroundings = text.parse().expect("it is sound");
        yard.step([0.0; 2], 0.0, &with(0b1000), 1.0);
        assert_eq!(yard.tanks["fuel"].fills, 0);
    }

    #[test]
    fn a_leak_happens_once() {
        let text = YARD.replace("output = 3", "output = 3\nleak = { after_m = 3, to = 0.2 }");
        let mut yard: Surroundings = text.parse().expect("it is sound");
        let levels = [2.0, 2.0, 0.0, 5.0].map(|driven_m| {
            let outputs = if driven_m == 0.0 { 0b1000 } else { 0 };
            yard.step([0.0; 2], driven_m, &with(outputs), 3.0);
            (yard.tanks["fuel"].level * 100.0).round()
        });
        assert_eq!(levels, [48.0, 20.0, 50.0, 45.0]);
    }

    /// Follows a route in steps of half a metre.
    fn follow(yard: &mut Surroundings, route: &[Point]) -> Vec<(u32, u32)> {
        for pair in route.windows(2) {
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
        for (route, expected) in [
            // From start to end, a little beside it.
            (&[[0.0, 0.0], [10.0, 0.5]][..], (1, 1)),
            // Backwards.
            (&[[10.0, 0.0], [0.0, 0.0]], (0, 0)),
            // From the middle to the end.
            (&[[5.0, 3.0], [5.0, 0.0], [10.0, 0.0]], (0, 0)),
            // Left in the middle, and from there to the end.
            (&[[0.0, 0.0], [5.0, 0.0], [5.0, 2.0], [5.0, 0.0], [10.0, 0.0]], (1, 0)),
            // Left, begun again.
            (&[[0.0, 0.0], [5.0, 0.0], [5.0, 2.0], [0.0, 2.0], [0.0, 0.0], [10.0, 0.0]], (2, 1)),
        ] {
            let mut yard = yard();
            assert_eq!(follow(&mut yard, route), [expected, (0, 0)], "{route:?}");
            assert!(!yard.is_done(Reason::Idle));
        }
        let mut yard = yard();
        follow(&mut yard, &[[0.0, 0.0], [10.0, 0.0], [0.0, 5.0], [0.0, 9.0]]);
        assert!(yard.is_done(Reason::Idle) && !yard.is_done(Reason::Driving));
        yard.signal = Some(7);
        assert!(!yard.is_done(Reason::Idle));
        yard.step([0.0; 2], 0.0, &Commands { signal: 7, ..with(0) }, 1.0);
        assert!(yard.is_done(Reason::Driving));
        assert_eq!(yard.summary()[1], "ready: 2 of 2 strips done, 0 begun again, 0 done twice");
    }
}
