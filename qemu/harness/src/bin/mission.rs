//! `cargo mission MAP`: runs one simulated mission and prints its outcome and trace hash.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Parser, ValueEnum};
use harness::mission::{self, Changes, PRESETS};
use harness::{Build, Machine, QemuPilot, Report, picture, shell};
use plan_compiler::goals;
use plan_compiler::mission::Goal;
use plan_compiler::mission::words;
use plan_compiler::output;
use plan_compiler::trace::Trace;
use plan_compiler::trace::fold::{self, Line};
use plan_compiler::trace::story;
use plan_format::parameters::Gains;
use sim::{Ending, HostPilot, Outcome, PilotError, Point, Recorder, Scenario, Start};

/// Exit status: the run ended neither at the goal nor with its work done, or it failed.
const NOT_REACHED: u8 = 1;
/// Exit status: map, mission, world or start are wrong, or an output cannot be written.
const WRONG_FILE: u8 = 3;

const ENDINGS: &str = "\
Outcomes: reached (the goal), done (all work), trapped (a minute near one point), off-map and
no-route (stands still there), out-of-time. The file NAME.world.toml beside the map or the mission
defines the robot's start and its work, how the true world differs from the map, moving obstacles,
sensors and faults: see plan-compiler/WORLD.md.

Exit status: 0 reached or done, 1 another outcome, 2 the command line is wrong, 3 the input is
wrong or an output cannot be written.";

/// Runs one simulated mission and prints its outcome and trace hash.
#[derive(Parser)]
#[command(name = "cargo mission", after_help = ENDINGS)]
struct Arguments {
    /// A map, with its mission and world files beside it, or a mission that names its map
    #[arg(value_name = "MAP|MISSION")]
    map: PathBuf,
    /// Machine that runs the robot's software
    #[arg(long, value_enum, default_value = "host")]
    pilot: PilotName,
    /// Seed for every random draw: the start, the sensors' noise, obstacles left out by shares
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Start position, metres; by default that of the world file, else a random one
    #[arg(long, value_name = "X,Y", value_parser = words::pair, allow_hyphen_values = true)]
    start: Option<Point>,
    /// A goal in the map's metres, or on the globe as NAME=geo:LAT,LON; repeatable. Replaces the
    /// goals of map and mission; the robot drives to the first one, or to that of --plan
    #[arg(long = "goal", value_name = "NAME=X,Y", value_parser = words::goal, allow_hyphen_values = true)]
    goals: Vec<Goal>,
    /// The robot of the mission's team; it runs alone, and hears no mates
    #[arg(long, value_name = "NAME")]
    robot: Option<String>,
    /// The parallel plan to follow instead of the mission's
    #[arg(long)]
    plan: Option<String>,
    /// Gains of reactive schemas and plan: 100:0, 66:34, 34:66 or 0:100
    #[arg(long, value_name = "PRESET", value_parser = gains)]
    gains: Option<Gains>,
    /// Write the percepts of every tick to a file for `plan-compiler explain`; on the host only
    #[arg(long, value_name = "FILE", conflicts_with = "pilot")]
    trace: Option<PathBuf>,
    /// Draw map and route to a file, .svg or .png; on the host only
    #[arg(long, value_name = "FILE", conflicts_with = "pilot", value_parser = picture_path())]
    picture: Option<PathBuf>,
    /// Use sensors without error instead of the usual ones (a GPS sigma of 1 m)
    #[arg(long)]
    perfect: bool,
    /// Print the outcome as one JSON object, and nothing else
    #[arg(long)]
    json: bool,
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

/// Why the run has no outcome.
enum Failure {
    /// Map, mission, world or start are wrong, or an output cannot be written.
    File(String),
    /// The robot failed.
    Run(String),
}

fn main() -> ExitCode {
    let (message, status) = match run(&Arguments::parse()) {
        Ok(is_reached) => return if is_reached { 0 } else { NOT_REACHED }.into(),
        Err(Failure::File(message)) => (message, WRONG_FILE),
        Err(Failure::Run(message)) => (message, NOT_REACHED),
    };
    eprintln!("{}", message.trim_end());
    status.into()
}

fn run(arguments: &Arguments) -> Result<bool, Failure> {
    let changes = Changes {
        robot: arguments.robot.clone(),
        plan: arguments.plan.clone(),
        gains: arguments.gains,
        goals: arguments.goals.clone(),
        seed: arguments.seed,
    };
    let outputs: Vec<&Path> =
        arguments.trace.iter().chain(&arguments.picture).map(PathBuf::as_path).collect();
    if let [trace, picture] = outputs[..]
        && output::is_same(trace, picture)
    {
        let name = trace.display();
        return Err(Failure::File(format!("error: --trace and --picture both write {name}")));
    }
    let scenario = mission::scenario_for(&arguments.map, &changes, &outputs);
    let scenario = scenario.map_err(Failure::File)?;
    for note in &scenario.notes {
        eprintln!("note: {note}");
    }
    let given = scenario.surroundings.as_ref().map(|surroundings| surroundings.start);
    let drawn = || scenario.draw_start(arguments.seed);
    let position = arguments.start.or(given).or_else(drawn);
    let position = position.ok_or_else(|| {
        Failure::File("no start position is clear of obstacles and has a route".to_owned())
    })?;
    let heading_rad = scenario.surroundings.as_ref().map_or(0.0, |world| world.heading);
    let usual = scenario.sensors();
    let sensors = if arguments.perfect { usual.without_error() } else { usual };
    let start = Start { position, heading_rad, seed: arguments.seed, sensors };
    let machine = match arguments.pilot {
        PilotName::Host => None,
        PilotName::Qemu => Some(Machine::CortexM4F),
        PilotName::QemuM3 => Some(Machine::CortexM3),
    };
    let failed = |error: &dyn std::error::Error| Failure::Run(error.to_string());
    let mut text = String::new();
    let (outcome, report) = match machine {
        None => (on_the_host(&scenario, &start, arguments, &mut text)?, None),
        Some(machine) => {
            let pilot = QemuPilot::boot(machine, Build::Release, &scenario.blob);
            let mut pilot = pilot.map_err(|error| failed(&error))?;
            let robot = scenario.robot(&start, &mut pilot).map_err(Failure::File)?;
            let outcome = scenario.run(robot).map_err(|error| failed(&error))?;
            (outcome, Some(pilot.finish().map_err(|error| failed(&error))?))
        }
    };
    if arguments.json {
        text = json(&scenario, &outcome);
    } else {
        // Writing to a string does not fail.
        let _ = write_outcome(&mut text, &scenario, &start, &outcome, report.as_ref());
    }
    shell::print(&text).map_err(Failure::File)?;
    Ok(outcome.reached())
}

/// Runs the mission in this process, and writes the picture and the trace that the arguments ask
/// for.
fn on_the_host(
    scenario: &Scenario,
    start: &Start,
    arguments: &Arguments,
    text: &mut String,
) -> Result<Outcome, Failure> {
    let failed = |error: PilotError| Failure::Run(error.to_string());
    let mut recorder = Recorder::new(HostPilot::new(scenario.plan()));
    let robot = scenario.robot(start, &mut recorder).map_err(Failure::File)?;
    let mut simulation = scenario.simulation([robot]);
    let mut route = Vec::new();
    while !simulation.is_over() {
        route.push(simulation.robots()[0].body().position);
        simulation.step().map_err(failed)?;
    }
    let outcome = simulation.robots()[0].outcome().clone();
    // Ends the simulation's borrow of the recorder.
    drop(simulation);
    let percepts = recorder.finish();
    let story = story::of(&scenario.plan(), &percepts);
    for line in fold::folded(&story.turns) {
        let _ = match line {
            Line::Turn(turn) => writeln!(text, "{:>8.2} s  {}", turn.time_s, turn.text),
            Line::Again(again) => writeln!(text, "     ...  {again}"),
        };
    }
    if let Some(path) = &arguments.picture {
        picture::draw(scenario, start, &route, &story, &outcome, path).map_err(Failure::File)?;
    }
    if let Some(path) = &arguments.trace {
        let trace = Trace { blob: scenario.blob.clone(), percepts, hash: outcome.trace_hash };
        write(path, &trace.to_bytes()).map_err(Failure::File)?;
    }
    Ok(outcome)
}

/// The goal that the robot approached or reached last, of a plan with several: its name and position.
fn goal(scenario: &Scenario, outcome: &Outcome) -> Option<(String, [f64; 2])> {
    goals::all(&scenario.parallel_plan()).nth(outcome.goal?.into())
}

/// The object of `--json`. Programs rely on its names. `struck` is there if something moves, `goal` and
/// `goal_m` if the plan has several goals.
fn json(scenario: &Scenario, outcome: &Outcome) -> String {
    let reasons = outcome.reasons.iter();
    let reasons: serde_json::Map<String, serde_json::Value> =
        reasons.map(|(reason, ticks)| (format!("{reason:?}"), (*ticks).into())).collect();
    let mut object = serde_json::json!({
        "outcome": outcome.ending.map(Ending::name),
        "time_s": outcome.time_s,
        "distance_m": outcome.distance_m,
        // Infinite if nothing came near; JSON has no infinity.
        "closest_m": outcome.closest_m.is_finite().then_some(outcome.closest_m),
        "contacts": outcome.touches,
        "turn_rad": outcome.turn_rad,
        "reasons": reasons,
        "trace_hash": format!("{:016x}", outcome.trace_hash),
    });
    if let Some((name, at)) = goal(scenario, outcome) {
        object["goal"] = name.into();
        object["goal_m"] = at.to_vec().into();
    }
    if !scenario.conditions.discs.is_empty() {
        object["struck"] = outcome.strikes.into();
    }
    format!("{object}\n")
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    output::write_file(path, |out| out.write_all(bytes)).map_err(|problem| problem.message)
}

fn write_outcome(
    text: &mut String,
    scenario: &Scenario,
    start: &Start,
    outcome: &Outcome,
    report: Option<&Report>,
) -> std::fmt::Result {
    let ending = outcome.ending.map_or_else(|| "unfinished".to_owned(), |e| format!("{e:?}"));
    let [x, y] = start.position;
    match goal(scenario, outcome) {
        Some((name, [x, y])) => writeln!(text, "outcome     {ending} {name} at {x},{y}")?,
        None => writeln!(text, "outcome     {ending}")?,
    }
    writeln!(text, "start       {x:.2},{y:.2} m, seed {}", start.seed)?;
    writeln!(text, "time        {:.1} s, {} ticks", outcome.time_s, outcome.ticks)?;
    writeln!(text, "distance    {:.1} m", outcome.distance_m)?;
    match outcome.closest_m {
        closest_m if closest_m.is_finite() => write!(text, "closest     {closest_m:.2} m")?,
        _ => write!(text, "closest     nothing near")?,
    }
    writeln!(text, ", {} contacts", outcome.touches)?;
    if outcome.strikes > 0 {
        writeln!(text, "struck      {} times by something that moves", outcome.strikes)?;
    }
    for line in outcome.surroundings.iter().flat_map(|surroundings| surroundings.summary()) {
        writeln!(text, "work        {line}")?;
    }
    let reasons: Vec<_> =
        outcome.reasons.iter().map(|(reason, ticks)| format!("{reason:?} {ticks}")).collect();
    writeln!(text, "reasons     {}", reasons.join(", "))?;
    if let Some(report) = report {
        writeln!(text, "worst tick  {} instructions", outcome.most_instructions)?;
        for (name, number) in report.numbers() {
            writeln!(text, "{name}  {number}")?;
        }
    }
    writeln!(text, "trace hash  {:016x}", outcome.trace_hash)
}

fn gains(text: &str) -> Result<Gains, String> {
    let names = || PRESETS.map(|(name, _)| name).join(", ");
    let known = PRESETS.iter().find(|(name, _)| *name == text);
    known.map(|&(_, gains)| gains).ok_or_else(|| format!("the presets are {}", names()))
}

/// A parser for a picture's path: a name of another kind is a mistake in the command line.
fn picture_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| picture::Kind::of(&path).map(|_| path))
}
