//! Random percepts: mostly sensible, sometimes arbitrary.

use crate::random::Random;
use math::{Vec2, scalar, vector};
use plan_format::Blob;
use robot_io::limits::{MAX_MATES, MAX_ROBOTS};
use robot_io::{Commands, Fix, Heard, Manual, Mate, News, Operator, Percepts, RangeReading};

/// The usual time between two ticks, microseconds.
const TICK_US: u64 = 50_000;

/// A body that follows its commands, and unreliable sensors.
#[derive(Clone, Debug)]
pub struct World<'a> {
    blob: Blob<'a>,
    time_us: u64,
    position: Vec2,
    heading_rad: f32,
    inputs: [Option<f32>; 8],
    operator: Operator,
    has_fix: bool,
    /// The latest news of each mate.
    mates: Vec<Mate>,
}

impl<'a> World<'a> {
    /// A world with the robot at a random position on the map.
    pub fn new(blob: &Blob<'a>, random: &mut Random) -> Self {
        Self {
            blob: *blob,
            time_us: random.below(1 << 40),
            position: Vec2::new(random.between(0.0, 20.0), random.between(0.0, 20.0)),
            heading_rad: random.between(-3.0, 3.0),
            inputs: [(); 8].map(|()| Some(random.unit())),
            operator: Operator { is_armed: true, ..Operator::default() },
            has_fix: true,
            mates: Vec::new(),
        }
    }

    /// The percepts of this tick.
    pub fn percepts(&mut self, random: &mut Random) -> Percepts {
        self.change(random);
        if self.blob.parameters().team.mates() != 0 {
            self.hear(random);
        }
        let wild = |random: &mut Random, value: f32| match random.index(400) {
            0 => None,
            1 => Some(f32::NAN),
            2 => Some(f32::INFINITY),
            3 => Some(f32::from_bits(random.below(1 << 32) as u32)),
            _ => Some(value),
        };
        let fix = self.blob.map_frame().filter(|_| self.has_fix).map(|frame| Fix {
            time_us: self.time_us,
            is_valid: !random.one_in(100),
            place: frame.to_geodetic(self.position),
            accuracy_mm: 500,
            velocity_mmps: None,
            receiver_ms: Some((self.time_us / 1_000) as u32),
        });
        let readings = if random.one_in(10) { random.index(9) } else { 0 };
        let ranges = (0..readings).map(|_| RangeReading {
            bearing_rad: random.between(-4.0, 4.0),
            distance_m: wild(random, 3.0).unwrap_or(0.0),
        });
        let ranges = ranges.collect();
        Percepts {
            time_us: self.time_us,
            fix,
            heading_rad: wild(random, self.heading_rad),
            speed_mps: wild(random, 0.5),
            turn_rate_radps: wild(random, 0.0),
            ranges,
            inputs: self.inputs,
            operator: self.operator,
            mates: self.mates.iter().copied().collect(),
            ..Percepts::default()
        }
    }

    /// News arrive a few times per second while the radio works. Some come from elsewhere, some are
    /// garbled.
    fn hear(&mut self, random: &mut Random) {
        if !random.one_in(4) {
            return;
        }
        let robot = random.index(MAX_ROBOTS + 1) as u8;
        let place = [(); 2].map(|()| random.between(0.0, 20.0));
        let position_m = match random.index(20) {
            0 => None,
            1 => Some([f32::NAN, 0.0]),
            _ => Some(place),
        };
        let news = News { robot, position_m, signal: random.index(3) as u16 };
        let heard = Heard { news, quality: random.between(-0.1, 1.1) };
        let late_us = if random.one_in(10) { random.below(3_000_000) } else { 0 };
        let mate = Mate { time_us: self.time_us.saturating_sub(late_us), heard };
        self.mates.retain(|known| known.heard.news.robot != robot);
        // Percepts hold at most `MAX_MATES` of them.
        self.mates.truncate(MAX_MATES - 1);
        self.mates.push(mate);
    }

    /// Advances to the next tick.
    pub fn go(&mut self, commands: &Commands, random: &mut Random) {
        let seconds = TICK_US as f32 * 1e-6;
        self.position += vector::from_angle(self.heading_rad) * (commands.speed_mps * seconds);
        let turned = commands.turn_rate_radps * seconds;
        self.heading_rad = scalar::wrap_angle(self.heading_rad + turned);
        self.time_us = match random.index(500) {
            0 => self.time_us,
            1 => self.time_us.saturating_sub(random.below(10_000_000)),
            2 => self.time_us.saturating_add(random.below(100_000_000)),
            3 => self.time_us.saturating_add(1),
            _ => self.time_us.saturating_add(TICK_US),
        };
    }

    /// Inputs vary; sometimes one jumps, is missing or is not a number. The operator interferes.
    fn change(&mut self, random: &mut Random) {
        for input in &mut self.inputs {
            let now = input.filter(|value| value.is_finite()).unwrap_or(0.5);
            *input = match random.index(200) {
                0 => None,
                1 => Some(f32::NAN),
                2 => Some(f32::NEG_INFINITY),
                3..=9 => Some(random.unit()),
                10..=59 => Some(scalar::clamp(now + random.between(-0.1, 0.1), 0.0, 1.0)),
                _ => *input,
            };
        }
        match random.index(1_000) {
            0 => self.position = Vec2::new(random.between(-5.0, 25.0), random.between(0.0, 20.0)),
            1 => self.has_fix = !self.has_fix,
            2 => self.operator.is_armed = !self.operator.is_armed,
            3 => self.operator.is_emergency_stop = true,
            4 => {
                let (speed_mps, turn_rate_radps) = (random.between(-9.0, 9.0), f32::NAN);
                self.operator.manual = Some(Manual { speed_mps, turn_rate_radps });
            }
            5..=30 => {
                self.operator = Operator { is_armed: true, ..Operator::default() };
                self.has_fix = true;
            }
            _ => {}
        }
    }
}
