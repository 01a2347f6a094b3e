//! `cargo mission MAP`: one simulated mission, its outcome, its picture and its trace hash.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use harness::mission::{Changes, PRESETS, Scenario, Start};
use harness::{Build, Machine, QemuPilot, Report, picture};
use plan_compiler::output;
use plan_compiler::trace::Trace;
use plan_compiler::trace::story;
use plan_format::parameters::Gains;
use robot_io::{CommandRecord, Percepts, SensorRecord};
use sim::{HostPilot, Outcome, Pilot, PilotError, Point, SensorSettings};

/// Drives one simulated mission and prints its outcome and trace hash.
#[derive(Parser)]
#[command(name = "cargo mission")]
struct Arguments {
    /// A map (its mission file is found beside it) or a mission file that names its map
    map: PathBuf,
    /// Where the robot's software runs
    #[arg(long, value_enum, default_value = "host")]
    pilot: PilotName,
    /// Seed of the start, the sensors' noise and everything else that is drawn by chance
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where to start, metres; else where the world's file says, else drawn by chance
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    start: Option<Point>,
    /// The parallel plan to follow instead of the mission's
    #[arg(long)]
    plan: Option<String>,
    /// Weights of reactive schemas and plan: 100:0, 66:34, 34:66 or 0:100
    #[arg(long, value_name = "PRESET", value_parser = gains)]
    gains: Option<Gains>,
    /// Write what every tick saw to a file that `plan-compiler explain` reads; on the host only
    #[arg(long, value_name = "FILE", conflicts_with = "pilot")]
    trace: Option<PathBuf>,
    /// Draw map and way to a file, .svg or .png; on the host only
    #[arg(long, value_name = "FILE", conflicts_with = "pilot")]
    picture: Option<PathBuf>,
    /// Sensors without error instead of the usual ones (a GPS sigma of 1 m)
    #[arg(long)]
    perfect: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum PilotName {
    /// In this process
    Host,
    /// In QEMU on a Cortex-M4F
    Qemu,
    /// In QEMU on a Cortex-M3
    QemuM3,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(is_reached) => ExitCode::from(u8::from(!is_reached)),
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<bool, String> {
    let changes = Changes { plan: arguments.plan.clone(), gains: arguments.gains };
    let scenario = Scenario::compile(&arguments.map, &changes)?;
    let world = scenario.world();
    let given = scenario.surroundings.as_ref().map(|surroundings| surroundings.start);
    let drawn = || scenario.draw_start(&world, arguments.seed);
    let position = arguments.start.or(given).or_else(drawn).ok_or("no place to start from")?;
    let heading_rad = scenario.surroundings.as_ref().map_or(0.0, |world| world.heading);
    let sensors = if arguments.perfect { SensorSettings::PERFECT } else { scenario.sensors() };
    let start = Start { position, heading_rad, seed: arguments.seed, sensors };
    let machine = match arguments.pilot {
        PilotName::Host => None,
        PilotName::Qemu => Some(Machine::CortexM4F),
        PilotName::QemuM3 => Some(Machine::CortexM3),
    };
    let (outcome, report) = match machine {
        None => (on_the_host(&scenario, &start, arguments)?, None),
        Some(machine) => {
            let pilot = QemuPilot::boot(machine, Build::Release, &scenario.blob);
            let mut pilot = pilot.map_err(|error| error.to_string())?;
            let run = scenario.run(&world, &start, &mut pilot)?;
            let outcome = run.finish().map_err(|error| error.to_string())?;
            (outcome, Some(pilot.finish().map_err(|error| error.to_string())?))
        }
    };
    print(&start, &outcome, report.as_ref());
    Ok(outcome.reached())
}

/// Drives in this process, and keeps what was asked for.
fn on_the_host(
    scenario: &Scenario,
    start: &Start,
    arguments: &Arguments,
) -> Result<Outcome, String> {
    let world = scenario.world();
    let mut recorder = Recorder::new(HostPilot::new(scenario.plan()));
    let mut run = scenario.run(&world, start, &mut recorder)?;
    let mut way = Vec::new();
    while run.outcome().ending.is_none() {
        way.push(run.body().position);
        run.step().map_err(|error| error.to_string())?;
    }
    let outcome = run.finish().map_err(|error| error.to_string())?;
    let percepts = recorder.percepts;
    let story = story::of(&scenario.plan(), &percepts);
    for turn in &story.turns {
        println!("{:>8.2} s  {}", turn.time_s, turn.text);
    }
    if let Some(path) = &arguments.picture {
        picture::draw(scenario, start, &way, &story, &outcome, path)?;
    }
    if let Some(path) = &arguments.trace {
        let trace = Trace { blob: scenario.blob.clone(), percepts, hash: outcome.trace_hash };
        write(path, &trace.to_bytes())?;
    }
    Ok(outcome)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    output::write_file(path, |out| out.write_all(bytes)).map_err(|problem| problem.message)
}

/// Keeps what every tick of a robot in this process saw.
struct Recorder<'p> {
    pilot: HostPilot<'p>,
    percepts: Vec<Percepts>,
}

impl<'p> Recorder<'p> {
    fn new(pilot: HostPilot<'p>) -> Self {
        Self { pilot, percepts: Vec::new() }
    }
}

impl Pilot for Recorder<'_> {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        let answer = self.pilot.exchange(sensors)?;
        self.percepts.extend(self.pilot.take_percepts());
        Ok(answer)
    }
}

fn print(start: &Start, outcome: &Outcome, report: Option<&Report>) {
    let ending = outcome.ending.map_or_else(|| "unfinished".to_owned(), |e| format!("{e:?}"));
    println!("outcome     {ending}");
    println!(
        "start       {:.2},{:.2} m, seed {}",
        start.position[0], start.position[1], start.seed
    );
    println!("time        {:.1} s, {} ticks", outcome.time_s, outcome.ticks);
    println!("distance    {:.1} m", outcome.distance_m);
    println!("closest     {:.2} m, {} contacts", outcome.closest_m, outcome.touches);
    for line in outcome.surroundings.iter().flat_map(|surroundings| surroundings.summary()) {
        println!("work        {line}");
    }
    let reasons: Vec<_> =
        outcome.reasons.iter().map(|(reason, ticks)| format!("{reason:?} {ticks}")).collect();
    println!("reasons     {}", reasons.join(", "));
    if let Some(report) = report {
        println!("worst tick  {} instructions", outcome.most_instructions);
        for (name, number) in report.numbers() {
            println!("{name}  {number}");
        }
    }
    println!("trace hash  {:016x}", outcome.trace_hash);
}

fn point(text: &str) -> Result<Point, String> {
    let wrong = || format!("`{text}` is not a point like 12.5,40");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    match (x.trim().parse::<f64>(), y.trim().parse::<f64>()) {
        (Ok(x), Ok(y)) if x.is_finite() && y.is_finite() => Ok([x, y]),
        _ => Err(wrong()),
    }
}

fn gains(text: &str) -> Result<Gains, String> {
    let names = || PRESETS.map(|(name, _)| name).join(", ");
    let known = PRESETS.iter().find(|(name, _)| *name == text);
    known.map(|&(_, gains)| gains).ok_or_else(|| format!("known are {}", names()))
}
