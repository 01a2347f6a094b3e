//! The controller in a firmware of your own: implement [`Robot`] and run [`control_task`] by any
//! executor. Here the robot is simulated on a host; `boards/` has robots with motors.
//!
//! `cargo run -p wayfield-runtime --example own_robot -- target/yard.bin -26 -18`

use embassy_futures::block_on;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use math::{MapFrame, Vec2, scalar};
use plan_format::Blob;
use robot_io::{CommandRecord, Commands, Fix, Operator, Percepts, Reason};
use runtime::{Fallback, Robot, Slots, TICK_PERIOD_US, control_task, load};

/// Longer than any way across the maps that ship with the project.
const TIME_LIMIT_US: u64 = 600_000_000;

/// A robot that moves exactly as commanded.
struct Ideal<'b> {
    /// Turns map metres into the latitude and longitude that a receiver would report.
    frame: &'b MapFrame,
    /// Map metres.
    position: Vec2,
    /// Counter-clockwise from east, radians.
    heading_rad: f32,
    time_us: u64,
    commands: Commands,
}

impl Robot for Ideal<'_> {
    /// On a robot this waits for a timer: `ticker.next().await`.
    async fn wait(&mut self) -> Option<u64> {
        self.time_us += TICK_PERIOD_US;
        let has_ended = self.commands.reason == Reason::AtGoal || self.time_us > TIME_LIMIT_US;
        (!has_ended).then_some(self.time_us)
    }

    /// Reads the sensors. With a receiver on a UART, `gps_task` fills in the fix instead.
    async fn sense(&mut self, percepts: &mut Percepts) {
        percepts.fix = Some(Fix {
            time_us: self.time_us,
            is_valid: true,
            place: self.frame.to_geodetic(self.position),
            accuracy_mm: 500,
            velocity_mmps: None,
            receiver_ms: Some((self.time_us / 1_000) as u32),
        });
        percepts.heading_rad = Some(self.heading_rad);
        percepts.operator = Operator { is_armed: true, ..Operator::default() };
    }

    /// Drives the motors; `runtime::mixer` turns the commands into the speeds of two wheels.
    async fn act(&mut self, record: &CommandRecord) {
        self.commands = record.commands;
        let seconds = TICK_PERIOD_US as f32 * 1e-6;
        self.heading_rad += self.commands.turn_rate_radps * seconds;
        let ahead = Vec2::new(scalar::cos(self.heading_rad), scalar::sin(self.heading_rad));
        self.position += ahead * (self.commands.speed_mps * seconds);
    }

    /// A simulation has no watchdog to feed.
    fn feed_watchdog(&mut self) {}
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, file, x, y] = &arguments[..] else { return Err("usage: own_robot BLOB X Y".into()) };

    let region = std::fs::read(file)?;
    let loaded = load(&region, &Fallback::default());
    if let Some(refusal) = loaded.refusal {
        return Err(format!("{file} is refused: {refusal}").into());
    }
    let blob: Blob<'_> = loaded.blob;
    let mut robot = Ideal {
        frame: blob.map_frame().ok_or("the map does not lie on the globe")?,
        position: Vec2::new(x.parse()?, y.parse()?),
        heading_rad: 0.0,
        time_us: 0,
        commands: Commands::stop(Reason::NoFix),
    };
    let slots = Slots::<NoopRawMutex>::new();
    block_on(control_task(blob, &mut robot, &slots, ()));

    let Ideal { position, time_us, commands, .. } = robot;
    println!(
        "{:?} at {:.1}, {:.1} after {} s",
        commands.reason,
        position.x,
        position.y,
        time_us / 1_000_000
    );
    if commands.reason == Reason::AtGoal { Ok(()) } else { Err("the goal was not reached".into()) }
}
