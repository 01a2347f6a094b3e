//! Faults: decorators that corrupt the records of a source, and actuators that do not obey.
//!
//! The kinds follow PX4's failure injection: `Drop` with chance 1 is its "off" and with a lower
//! chance "intermittent"; `Freeze` is "stuck", `Garble` "garbage", `Jump` "wrong" and `Delay`
//! "delayed". Decorators nest, so faults combine.

mod actuators;

pub use actuators::Actuators;

use crate::{Mode, Random, Scene, Sensors, Stream};
use robot_io::SensorRecord;
use robot_io::percepts::channel;
use std::collections::VecDeque;
use std::ops::Range;

/// The input channel that reports the battery's level.
const BATTERY: usize = channel::BATTERY as usize;

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The data of a tick is lost.
    Drop {
        /// Probability in each tick, 0 to 1.
        chance: f64,
    },
    /// The first data within the fault's window is repeated. GPS bytes are repeated in the ticks
    /// that have some, so the receiver keeps its rate. If a message takes longer than a tick, only
    /// a piece of it is repeated, which is garbage.
    Freeze,
    /// Every reading is off by an offset.
    Jump {
        /// For GPS and poses, metres along the map's axes; for actuators, m/s and rad/s; for other
        /// channels, the first number in the unit of the reading.
        offset: [f64; 2],
    },
    /// Bytes or readings are replaced by random ones, which may be NaN.
    Garble {
        /// Probability for each byte or reading, 0 to 1.
        chance: f64,
    },
    /// The GPS receiver works in another mode.
    Mode(Mode),
    /// Data arrives later.
    Delay {
        /// Delay in ticks.
        ticks: usize,
    },
}

/// The part of the robot that fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The GPS receiver and its serial line.
    Gps,
    /// The compass.
    Heading,
    /// Speed and turn rate.
    Odometry,
    /// The range readings.
    Ranges,
    /// The poses from another source than the receiver.
    Pose,
    /// The radio link to the operator. Its packets have checksums, so a garbled one is lost.
    Link,
    /// The input that reports the battery's level.
    Battery,
    /// The robot's clock. A lost or frozen clock stands; one that loses a tick shows the time of
    /// the tick before.
    Clock,
    /// The motors. A lost command is a stop.
    Actuators,
}

impl Channel {
    /// All channels with their names in world files.
    pub const ALL: [(&'static str, Self); 9] = [
        ("gps", Self::Gps),
        ("compass", Self::Heading),
        ("odometry", Self::Odometry),
        ("ranges", Self::Ranges),
        ("pose", Self::Pose),
        ("link", Self::Link),
        ("battery", Self::Battery),
        ("clock", Self::Clock),
        ("actuators", Self::Actuators),
    ];

    /// Its name in world files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, channel)| *channel == self).map_or("", |(name, _)| name)
    }

    /// Whether an offset of its readings is two numbers, not one.
    pub fn has_two_numbers(self) -> bool {
        matches!(self, Self::Gps | Self::Pose | Self::Actuators)
    }
}

/// A fault of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedFault {
    /// What fails.
    pub channel: Channel,
    /// How it fails.
    pub fault: Fault,
    /// When it fails, seconds since the start; the end may be infinite.
    pub window_s: Range<f64>,
}

/// Sensors with a fault in one channel during a window of time.
#[derive(Debug)]
pub struct Faulty<S> {
    inner: S,
    fault: Fault,
    channel: Channel,
    window_us: Range<u64>,
    random: Random,
    /// The delayed data, the newest at the back; in each record only this channel is set.
    past: VecDeque<SensorRecord>,
    /// The data that a freeze repeats.
    frozen: Option<SensorRecord>,
    /// What a clock that stands shows, microseconds.
    stood_us: Option<u64>,
}

impl<S: Sensors> Faulty<S> {
    /// Sensors that fail within a window, in seconds since the start.
    pub fn new(inner: S, fault: Fault, channel: Channel, window_s: Range<f64>, seed: u64) -> Self {
        Self {
            inner,
            fault,
            channel,
            window_us: in_us(&window_s),
            random: Random::new(seed, Stream::Fault),
            past: VecDeque::new(),
            frozen: None,
            stood_us: None,
        }
    }

    /// What a failing clock shows in a tick; `shown_us` is what other faults make it show.
    fn clock(&mut self, scene: &Scene<'_>, shown_us: Option<u64>) -> u64 {
        let now_us = shown_us.unwrap_or(scene.time_us + scene.tick_us);
        let before_us = now_us.saturating_sub(scene.tick_us);
        let stands = match self.fault {
            Fault::Drop { chance } => self.random.chance(chance),
            Fault::Freeze => true,
            _ => false,
        };
        match self.fault {
            _ if stands => *self.stood_us.get_or_insert(before_us),
            Fault::Delay { ticks } => now_us.saturating_sub(ticks as u64 * scene.tick_us),
            Fault::Jump { offset } => now_us.saturating_add_signed((offset[0] * 1e6) as i64),
            // Any time within twelve days.
            Fault::Garble { chance } if self.random.chance(chance) => {
                (self.random.unit() * 1e12) as u64
            }
            _ => {
                // A clock that loses ticks shows the right time in the others.
                self.stood_us = Some(now_us);
                now_us
            }
        }
    }

    /// Delays the channel's data while the fault lasts. When the fault ends, all delayed data
    /// arrives at once, before the fresh data: nothing is lost, as on a congested line.
    fn delayed(&mut self, record: &mut SensorRecord, fails: bool, ticks: usize) {
        self.past.push_back(self.channel.taken(record));
        let kept = if fails { ticks } else { 0 };
        let mut arrived = SensorRecord::default();
        while self.past.len() > kept {
            let Some(late) = self.past.front() else { break };
            let mut gps = arrived.gps.clone();
            if gps.extend_from_slice(&late.gps).is_err() {
                // The record is full; the rest follows in the next tick.
                break;
            }
            arrived = SensorRecord { gps, ..late.clone() };
            self.past.pop_front();
        }
        self.channel.put(record, arrived);
    }
}

/// A window in microseconds; an infinite end becomes the last microsecond.
fn in_us(window_s: &Range<f64>) -> Range<u64> {
    let us = |seconds: f64| (seconds * 1e6) as u64;
    us(window_s.start)..us(window_s.end)
}

impl<S: Sensors> Sensors for Faulty<S> {
    fn sense(&mut self, scene: &Scene<'_>) -> SensorRecord {
        let fails = self.window_us.contains(&scene.time_us);
        let mut scene = *scene;
        if let (true, Channel::Gps, Fault::Jump { offset }) = (fails, self.channel, self.fault) {
            scene.antenna = [scene.antenna[0] + offset[0], scene.antenna[1] + offset[1]];
        }
        if let (true, Channel::Gps, Fault::Mode(mode)) = (fails, self.channel, self.fault) {
            scene.mode = mode;
        }
        let mut record = self.inner.sense(&scene);
        if self.channel == Channel::Clock {
            if fails {
                record.clock_us = Some(self.clock(&scene, record.clock_us));
            }
            return record;
        }
        match self.fault {
            Fault::Delay { ticks } => self.delayed(&mut record, fails, ticks),
            Fault::Freeze if !fails => self.frozen = None,
            // Already set in the scene above.
            Fault::Mode(_) => {}
            _ if !fails => {}
            Fault::Drop { chance } => {
                if self.random.chance(chance) {
                    self.channel.taken(&mut record);
                }
            }
            Fault::Freeze => self.channel.freeze(&mut self.frozen, &mut record),
            Fault::Jump { offset } => self.channel.shift(&mut record, offset.map(|x| x as f32)),
            Fault::Garble { chance } => self.channel.garble(&mut record, chance, &mut self.random),
        }
        record
    }
}

impl Channel {
    /// Takes this channel's data out of a record.
    fn taken(self, record: &mut SensorRecord) -> SensorRecord {
        let mut out = SensorRecord::default();
        self.exchange(record, &mut out);
        out
    }

    /// Puts this channel's data into a record.
    fn put(self, record: &mut SensorRecord, mut data: SensorRecord) {
        self.exchange(record, &mut data);
    }

    fn exchange(self, a: &mut SensorRecord, b: &mut SensorRecord) {
        match self {
            Self::Gps => std::mem::swap(&mut a.gps, &mut b.gps),
            Self::Heading => std::mem::swap(&mut a.heading_rad, &mut b.heading_rad),
            Self::Odometry => {
                std::mem::swap(&mut a.speed_mps, &mut b.speed_mps);
                std::mem::swap(&mut a.turn_rate_radps, &mut b.turn_rate_radps);
            }
            Self::Ranges => std::mem::swap(&mut a.ranges, &mut b.ranges),
            Self::Pose => std::mem::swap(&mut a.pose, &mut b.pose),
            Self::Link => std::mem::swap(&mut a.radio, &mut b.radio),
            Self::Battery => {
                std::mem::swap(&mut a.inputs[BATTERY], &mut b.inputs[BATTERY]);
            }
            Self::Clock => std::mem::swap(&mut a.clock_us, &mut b.clock_us),
            Self::Actuators => {}
        }
    }

    /// Keeps the first data of the fault and repeats it.
    fn freeze(self, frozen: &mut Option<SensorRecord>, record: &mut SensorRecord) {
        let is_quiet = match self {
            Self::Gps => record.gps.is_empty(),
            Self::Pose => record.pose.is_none(),
            Self::Link => record.radio.is_none(),
            _ => false,
        };
        if is_quiet {
            return;
        }
        let fresh = self.taken(record);
        let kept = frozen.get_or_insert(fresh).clone();
        self.put(record, kept);
    }

    fn shift(self, record: &mut SensorRecord, [by, north]: [f32; 2]) {
        let shifted = |x: Option<f32>| x.map(|x| x + by);
        match self {
            // The antenna has already been moved in the scene; a motor is not a sensor, and a
            // packet has no offset.
            Self::Gps | Self::Actuators | Self::Link | Self::Clock => {}
            Self::Heading => record.heading_rad = shifted(record.heading_rad),
            Self::Odometry => record.speed_mps = shifted(record.speed_mps),
            Self::Ranges => {
                record.ranges.iter_mut().flatten().for_each(|range| range.distance_m += by);
            }
            Self::Pose => {
                if let Some(pose) = &mut record.pose {
                    pose.position_m[0] += by;
                    pose.position_m[1] += north;
                }
            }
            Self::Battery => {
                record.inputs[BATTERY] = shifted(record.inputs[BATTERY]);
            }
        }
    }

    fn garble(self, record: &mut SensorRecord, chance: f64, random: &mut Random) {
        if self == Self::Link {
            if random.chance(chance) {
                record.radio = None;
            }
            return;
        }
        // Any 32 bits are an f32, perhaps infinite or NaN.
        let mut number = |x: &mut f32| {
            if random.chance(chance) {
                *x = f32::from_le_bytes([0; 4].map(|_: u8| random.byte()));
            }
        };
        match self {
            Self::Heading => record.heading_rad.iter_mut().for_each(number),
            Self::Odometry => {
                let both = record.speed_mps.iter_mut().chain(&mut record.turn_rate_radps);
                both.for_each(number);
            }
            Self::Ranges => {
                for range in record.ranges.iter_mut().flatten() {
                    number(&mut range.bearing_rad);
                    number(&mut range.distance_m);
                }
            }
            Self::Pose => {
                record.pose.iter_mut().flat_map(|pose| &mut pose.position_m).for_each(number);
            }
            Self::Battery => record.inputs[BATTERY].iter_mut().for_each(number),
            Self::Link | Self::Actuators | Self::Clock => {}
            Self::Gps => {
                for byte in &mut record.gps {
                    if random.chance(chance) {
                        *byte = random.byte();
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Chassis, World};
    use robot_io::{Operator, Pose};

    /// Reports the number of the tick on every channel, and as a GPS byte every second tick.
    struct Counter(u8);

    impl Sensors for Counter {
        fn sense(&mut self, scene: &Scene<'_>) -> SensorRecord {
            self.0 += 1;
            let gps = if self.0.is_multiple_of(2) { &[self.0][..] } else { &[] };
            SensorRecord {
                gps: gps.iter().copied().collect(),
                heading_rad: Some(f32::from(self.0)),
                speed_mps: Some(scene.antenna[0] as f32),
                inputs: scene.inputs,
                radio: self.0.is_multiple_of(2).then(Operator::default),
                pose: self.0.is_multiple_of(2).then(|| Pose {
                    time_us: 0,
                    position_m: [f32::from(self.0), 0.0],
                    heading_rad: None,
                    accuracy_mm: 10,
                }),
                ..SensorRecord::default()
            }
        }
    }

    /// Runs twelve ticks of one second each; the fourth to the eighth fail.
    fn check(fault: Fault, channel: Channel, wanted: &str) {
        let world = World::new([]);
        let body = Body::new(Chassis::default(), [0.0; 2], 0.0);
        let mut sensors = Faulty::new(Counter(0), fault, channel, 3.0..8.0, 1);
        let seen: Vec<String> = (0..12)
            .map(|i| {
                let (time_us, tick_us) = (i * 1_000_000, 1_000_000);
                let antenna = body.position;
                let mode = Mode::Autonomous;
                let record = sensors.sense(&Scene {
                    world: &world,
                    others: &[],
                    body,
                    antenna,
                    mode,
                    inputs: [Some(time_us as f32 * 1e-6 + 1.0); 8],
                    time_us,
                    tick_us,
                });
                let numbers: Vec<String> = match channel {
                    Channel::Gps => record.gps.iter().map(u8::to_string).collect(),
                    Channel::Battery => record.inputs[0].iter().map(f32::to_string).collect(),
                    Channel::Clock => {
                        record.clock_us.iter().map(|us| (us / 1_000_000).to_string()).collect()
                    }
                    Channel::Link => record.radio.iter().map(|_| "*".to_owned()).collect(),
                    Channel::Pose => {
                        record.pose.iter().map(|pose| pose.position_m[0].to_string()).collect()
                    }
                    _ => record.heading_rad.iter().map(f32::to_string).collect(),
                };
                if numbers.is_empty() { "-".to_owned() } else { numbers.join(",") }
            })
            .collect();
        assert_eq!(seen.join(" "), wanted, "{fault:?} of {channel:?}");
    }

    #[test]
    fn each_fault_does_what_its_name_says_within_its_window() {
        let drop = Fault::Drop { chance: 1.0 };
        check(drop, Channel::Heading, "1 2 3 - - - - - 9 10 11 12");
        check(drop, Channel::Gps, "- 2 - - - - - - - 10 - 12");
        check(Fault::Freeze, Channel::Heading, "1 2 3 4 4 4 4 4 9 10 11 12");
        check(Fault::Freeze, Channel::Gps, "- 2 - 4 - 4 - 4 - 10 - 12");
        let jump = Fault::Jump { offset: [50.0, 0.0] };
        check(jump, Channel::Heading, "1 2 3 54 55 56 57 58 9 10 11 12");
        let delay = Fault::Delay { ticks: 2 };
        check(delay, Channel::Heading, "1 2 3 - - 4 5 6 9 10 11 12");
        check(delay, Channel::Gps, "- 2 - - - 4 - 6 8 10 - 12");
        check(drop, Channel::Battery, "1 2 3 - - - - - 9 10 11 12");
        check(Fault::Freeze, Channel::Battery, "1 2 3 4 4 4 4 4 9 10 11 12");
        check(jump, Channel::Battery, "1 2 3 54 55 56 57 58 9 10 11 12");
        check(drop, Channel::Pose, "- 2 - - - - - - - 10 - 12");
        check(Fault::Freeze, Channel::Pose, "- 2 - 4 - 4 - 4 - 10 - 12");
        check(jump, Channel::Pose, "- 2 - 54 - 56 - 58 - 10 - 12");
        // The clock of the first tick shows 1 s.
        for stands in [drop, Fault::Freeze] {
            check(stands, Channel::Clock, "- - - 3 3 3 3 3 - - - -");
        }
        check(jump, Channel::Clock, "- - - 54 55 56 57 58 - - - -");
        check(delay, Channel::Clock, "- - - 2 3 4 5 6 - - - -");
        let garble = Fault::Garble { chance: 1.0 };
        for lost in [drop, garble] {
            check(lost, Channel::Link, "- * - - - - - - - * - *");
        }
    }

    /// In each tick the clock shows the right time, or what it showed the tick before.
    #[test]
    fn a_clock_that_loses_ticks_catches_up() {
        let world = World::new([]);
        let body = Body::new(Chassis::default(), [0.0; 2], 0.0);
        let drop = Fault::Drop { chance: 0.5 };
        let mut sensors = Faulty::new(Counter(0), drop, Channel::Clock, 0.0..9e9, 1);
        let mut shown = Vec::new();
        for tick in 0..100_u64 {
            let record = sensors.sense(&Scene {
                world: &world,
                others: &[],
                body,
                antenna: [0.0; 2],
                mode: Mode::Autonomous,
                inputs: [None; 8],
                time_us: tick * 50_000,
                tick_us: 50_000,
            });
            let clock_us = record.clock_us.expect("it fails");
            let is_right = clock_us == (tick + 1) * 50_000;
            assert!(is_right || shown.last().is_none_or(|&(last, _)| last == clock_us), "{tick}");
            shown.push((clock_us, is_right));
        }
        let right = shown.iter().filter(|(_, is_right)| *is_right).count();
        assert!((30..70).contains(&right), "{right}");
    }

    #[test]
    fn a_jump_moves_the_antenna_and_not_the_body() {
        let world = World::new([]);
        let body = Body::new(Chassis::default(), [1.0, 0.0], 0.0);
        let (antenna, mode) = (body.position, Mode::Autonomous);
        let scene = Scene {
            world: &world,
            others: &[],
            body,
            antenna,
            mode,
            inputs: [None; 8],
            time_us: 0,
            tick_us: 50_000,
        };
        let jump = Fault::Jump { offset: [50.0, 0.0] };
        let mut sensors = Faulty::new(Counter(0), jump, Channel::Gps, 0.0..1.0, 1);
        assert_eq!(sensors.sense(&scene).speed_mps, Some(51.0));
    }

    #[test]
    fn garbage_is_the_same_for_the_same_seed() {
        let garbled = |seed| {
            let mut random = Random::new(seed, Stream::Fault);
            let mut record = SensorRecord { gps: (0..100).collect(), ..Default::default() };
            Channel::Gps.garble(&mut record, 0.1, &mut random);
            record.gps
        };
        assert_eq!(garbled(1), garbled(1));
        assert_ne!(garbled(1), garbled(2));
        let changed = garbled(1).iter().zip(0_u8..).filter(|(a, b)| **a != *b).count();
        assert!((3..=20).contains(&changed), "{changed} of 100 at a chance of 0.1");
    }
}
