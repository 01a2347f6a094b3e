//! `cargo demo`: compiles a map, runs a robot with its plan in QEMU, and draws a picture.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use harness::mission::{self, Changes};
use harness::{Build, Machine, QemuPilot, picture, setup};
use indicatif::{ProgressBar, ProgressStyle};
use plan_compiler::{output, render};
use sim::scenario::route_m;
use sim::{
    HostPilot, Outcome, Pilot, Point, Robot, Scenario, SensorSettings, Sensors, Simulation, Start,
};

/// Compiles a map of a campus, boots the robot's firmware in QEMU, drives to the goal and draws
/// the route. Installs Rust targets and QEMU if they are missing.
#[derive(Parser)]
#[command(name = "cargo demo")]
struct Arguments {
    /// Speed of the display on a terminal relative to real time; 0 for as fast as possible
    #[arg(long, default_value_t = 20.0, value_name = "FACTOR", allow_negative_numbers = true)]
    pace: f64,
    /// Seed of the sensors' noise
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
}

/// In the south-east, behind the workshop.
const START: Point = [200.5, 20.5];
/// West.
const HEADING_RAD: f64 = 3.0;

fn main() -> ExitCode {
    match demonstrate(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn demonstrate(arguments: &Arguments) -> Result<bool, String> {
    let say = |error: &dyn std::error::Error| error.to_string();
    let started = Instant::now();
    let map = setup::root().join("tests/maps/campus.opar");
    let scenario = mission::scenario(&map, &Changes::default())?;
    let took_ms = started.elapsed().as_millis();
    println!("compiled   campus.opar: {} bytes of plans in {took_ms} ms", scenario.blob.len());

    println!("setting up QEMU and compiling the firmware; the first time, this takes minutes");
    let pilot = QemuPilot::boot(Machine::CortexM4F, Build::Release, &scenario.blob);
    let mut pilot = pilot.map_err(|error| say(&error))?;
    println!("booted     the firmware on an emulated Cortex-M4F");

    let sensors = SensorSettings::USUAL;
    let start = Start { position: START, heading_rad: HEADING_RAD, seed: arguments.seed, sensors };
    let robot = scenario.robot(&start, &mut pilot)?;
    let outcome = run(robot, &scenario, arguments.pace).map_err(|error| say(&error))?;
    pilot.finish().map_err(|error| say(&error))?;

    let host = scenario.robot(&start, HostPilot::new(scenario.plan()))?;
    let host = host.run(&scenario.truth).map_err(|error| say(&error))?;
    let is_same = host.trace_hash == outcome.trace_hash;
    summarise(&outcome, is_same);
    let picture = draw(&scenario, &outcome)?;
    println!("picture    {}", picture.display());
    Ok(outcome.reached() && outcome.touches == 0 && is_same)
}

/// Runs to the end, and shows the progress on a terminal.
fn run<P: Pilot>(
    robot: Robot<Box<dyn Sensors>, P>,
    scenario: &Scenario,
    pace: f64,
) -> Result<Outcome, sim::PilotError> {
    let (plan, layer) = (scenario.plan(), scenario.layer_from(START));
    // `None` if noise has pushed the robot into a cell without a route.
    let left_m = |at: Point| layer.and_then(|layer| route_m(&plan, &layer, at));
    let whole_m = left_m(START).unwrap_or_default();
    let mut to_go_m = whole_m;
    let bar = ProgressBar::new(whole_m as u64);
    let template = "driving    [{bar:40}] {msg}";
    bar.set_style(ProgressStyle::with_template(template).expect("a sound template"));
    let is_shown = std::io::stderr().is_terminal() && pace > 0.0;
    let began = Instant::now();
    let mut simulation = Simulation::new(&scenario.truth, [robot]);
    while !simulation.is_over() {
        simulation.step()?;
        let robot = &simulation.robots()[0];
        let (outcome, commands) = (robot.outcome(), robot.commands());
        to_go_m = left_m(robot.body().position).unwrap_or(to_go_m);
        bar.set_position((whole_m - to_go_m).max(0.0) as u64);
        bar.set_message(format!(
            "{:5.1} s  {to_go_m:5.1} m to go  {:3.1} m/s  {:?}",
            outcome.time_s, commands.speed_mps, commands.reason
        ));
        if is_shown {
            let due = Duration::from_secs_f64(outcome.time_s / pace);
            std::thread::sleep(due.saturating_sub(began.elapsed()));
        }
    }
    bar.finish_and_clear();
    Ok(simulation.robots()[0].outcome().clone())
}

fn summarise(outcome: &Outcome, is_same: bool) {
    let ending = outcome.ending.map_or_else(|| "unfinished".to_owned(), |e| format!("{e:?}"));
    println!(
        "drove      {ending}: {:.1} m in {:.1} s of simulated time, {} ticks",
        outcome.distance_m, outcome.time_s, outcome.ticks
    );
    println!("closest    {:.2} m to an obstacle, {} contacts", outcome.closest_m, outcome.touches);
    println!("worst tick {} instructions", outcome.most_instructions);
    let verdict =
        if is_same { "the same on this computer" } else { "NOT the same on this computer" };
    println!("trace hash {:016x}, {verdict}", outcome.trace_hash);
}

/// Draws the map, the advice and the route as SVG and PNG, and returns the path of the PNG.
fn draw(scenario: &Scenario, outcome: &Outcome) -> Result<PathBuf, String> {
    let routes = [render::Piece { name: "driven route", style: 0, points: &outcome.route }];
    let mut marks = vec![(render::Mark::Start, START, "start")];
    marks.extend(picture::end(outcome, &outcome.route));
    let overlay = render::Overlay {
        features: &scenario.map.features,
        routes: &routes,
        marks: &marks,
        ..render::Overlay::default()
    };
    let layer = scenario.layer_from(START).ok_or("there is no route to draw")?;
    let (plan, parallel) = (scenario.plan(), scenario.parallel_plan());
    let svg = render::picture(&plan, &parallel, &layer, &overlay, render::Style::default());
    let png = render::png(&svg)?;
    let folder = setup::target_folder().join("demo");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let write = |path: &Path, bytes: &[u8]| {
        output::write_file(path, |out| out.write_all(bytes)).map_err(|problem| problem.message)
    };
    write(&folder.join("campus.svg"), svg.as_bytes())?;
    let path = folder.join("campus.png");
    write(&path, &png)?;
    Ok(path)
}
