//! `cargo drive-bench`: drives suites of courses with default parameters and prints a table.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use harness::drive_bench::{self, Campaign, Drives, Row, Run, Suite, is_worse, rows, table};
use harness::setup::root;
use harness::{picture, shell};
use indicatif::{ProgressBar, ProgressStyle};
use plan_compiler::output;
use plan_compiler::trace::story::Story;

const AFTER: &str = "\
The robot gets what a user measures: radius, top speed and cell size. The suite barn uses the worlds
of the BARN challenge where they lie in ../shared/data/barn or --barn names their folder, and seeded
fields of the same kind elsewhere. Success is arrival without contact; score is the challenge's, at
most 0.5. A disc strikes a robot that stands, moves away or could not have seen it in time to stop;
that is not a contact. The numbers are the same on every machine.

Exit status: 0 done, 1 a run touched something, 2 the command line is wrong, 3 a file is missing,
wrong or cannot be written.";

/// Drives suites of courses with default parameters and prints a table.
#[derive(Parser)]
#[command(name = "cargo drive-bench", after_help = AFTER)]
struct Arguments {
    /// Only these suites: barn, doors, corridors, courtyards, city, campus
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = suite)]
    suites: Vec<Suite>,
    /// Only rows whose setting or vehicle contains this text, for example discs or boat
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    /// Courses of courtyards, city and seeded barn, and of campus up to 20; doors always has 120 and
    /// corridors 12
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=10_000), allow_negative_numbers = true)]
    count: u32,
    /// Seed of the first generated course; each further one uses the next
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Folder with the worlds of the BARN challenge as overlays, and optimal_times.tsv
    #[arg(long, value_name = "FOLDER", conflicts_with = "seeded")]
    barn: Option<PathBuf>,
    /// Use seeded fields of posts although the worlds of the challenge are here
    #[arg(long)]
    seeded: bool,
    /// Drive only every COUNT-th run, from number INDEX on; --merge puts the parts together
    #[arg(long, value_name = "INDEX/COUNT", value_parser = shard, default_value = "0/1")]
    shard: (usize, usize),
    /// Drive nothing: print the table of these files that --json wrote
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["shard", "suites", "only", "count", "seed", "barn", "seeded", "gallery"])]
    merge: Vec<PathBuf>,
    /// Draw the worst runs to this folder, each with a trace for `plan-compiler explain`
    #[arg(long, value_name = "FOLDER")]
    gallery: Option<PathBuf>,
    /// Print one JSON object with every run
    #[arg(long)]
    json: bool,
}

fn suite(name: &str) -> Result<Suite, String> {
    let names = || Suite::ALL.map(Suite::name).join(", ");
    Suite::named(name).ok_or_else(|| format!("not a suite; the suites are {}", names()))
}

fn shard(text: &str) -> Result<(usize, usize), String> {
    let parsed = text.split_once('/').and_then(|(index, count)| {
        Some((index.parse::<usize>().ok()?, count.parse::<usize>().ok()?))
    });
    let fitting = parsed.filter(|(index, count)| index < count);
    fitting.ok_or_else(|| "write INDEX/COUNT with INDEX below COUNT, for example 0/4".to_owned())
}

/// Why there is no table.
enum Failure {
    /// The command line is wrong.
    Usage(String),
    /// A file is missing or wrong, or an output could not be written.
    Files(String),
}

fn main() -> ExitCode {
    let (message, status) = match run(&Arguments::parse()) {
        Ok(has_contacts) => return ExitCode::from(u8::from(has_contacts)),
        Err(Failure::Usage(message)) => (message, 2),
        Err(Failure::Files(message)) => (message, 3),
    };
    eprintln!("{}", message.trim_end());
    ExitCode::from(status)
}

/// Whether a run touched something.
fn run(arguments: &Arguments) -> Result<bool, Failure> {
    let (campaign, runs) = if arguments.merge.is_empty() {
        drive(arguments)?
    } else {
        merge(&arguments.merge).map_err(Failure::Files)?
    };
    let text = if arguments.json { table::json(&campaign, &runs) } else { table::text(&runs) };
    shell::print(&text).map_err(Failure::Files)?;
    Ok(runs.iter().any(|run| run.contacts > 0))
}

fn drive(arguments: &Arguments) -> Result<(Campaign, Vec<Run>), Failure> {
    let mut suites = Vec::new();
    for &suite in if arguments.suites.is_empty() { &Suite::ALL[..] } else { &arguments.suites } {
        if !suites.contains(&suite) {
            suites.push(suite);
        }
    }
    let Arguments { only, count, seed, seeded, shard, .. } = arguments;
    let beside = root().join("../shared/data/barn");
    let barn =
        arguments.barn.clone().or_else(|| Some(beside).filter(|path| path.is_dir() && !seeded));
    if barn.is_none() && !seeded && suites.contains(&Suite::Barn) {
        eprintln!("the worlds of the BARN challenge are not here; seeded fields replace them");
    }
    let is_wanted = |row: &Row| {
        let names = [table::name(&row.setting), row.setting.vehicle.name().to_owned()];
        suites.contains(&row.suite) && names.iter().any(|name| name.contains(only))
    };
    let wanted: Vec<usize> =
        rows().iter().enumerate().filter(|(_, row)| is_wanted(row)).map(|(n, _)| n).collect();
    if wanted.is_empty() {
        let message = format!(
            "none of the rows of these suites contains {only:?}; the settings and vehicles are in the \
             table of cargo drive-bench"
        );
        return Err(Failure::Usage(message));
    }
    if let Some(folder) = &arguments.gallery {
        shell::create_folder(folder).map_err(Failure::Files)?;
    }
    let courses = drive_bench::courses(&suites, barn.as_deref(), *count as usize, *seed);
    let plan = Drives { courses: courses.map_err(Failure::Files)?, rows: wanted, shard: *shard };
    let campaign = Campaign {
        has_challenge: barn.is_some() && suites.contains(&Suite::Barn),
        suites,
        only: only.clone(),
        count: *count,
        seed: *seed,
        runs: plan.count_of_all(),
    };
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} runs, {eta} left");
    let bar = ProgressBar::new(plan.count() as u64);
    bar.set_style(style.expect("the template is well-formed"));
    let runs = plan.drive(&|| bar.inc(1)).map_err(Failure::Files)?;
    bar.finish_and_clear();
    if let Some(folder) = &arguments.gallery {
        gallery(folder, &plan, &runs).map_err(Failure::Files)?;
    }
    Ok((campaign, runs))
}

fn merge(paths: &[PathBuf]) -> Result<(Campaign, Vec<Run>), String> {
    let read = |path: &PathBuf| {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
        let (campaign, runs) = table::read(&text)
            .ok_or_else(|| format!("{name}: not an object that cargo drive-bench --json wrote"))?;
        Ok((name, campaign, runs))
    };
    table::merge(paths.iter().map(read).collect::<Result<_, String>>()?)
}

/// How many of the worst runs are drawn.
const GALLERY: usize = 12;

fn gallery(folder: &Path, plan: &Drives, runs: &[Run]) -> Result<(), String> {
    let mut worst: Vec<&Run> = runs.iter().filter(|run| run.has_route).collect();
    worst.sort_by(|a, b| is_worse(b, a).cmp(&is_worse(a, b)));
    for run in worst.into_iter().take(GALLERY) {
        let all = rows();
        let row = all[run.row];
        let is_it =
            |course: &&drive_bench::Course| course.suite == row.suite && course.name == run.course;
        let Some(course) = plan.courses.iter().find(is_it) else { continue };
        let (driven, trace) = drive_bench::record(run.row, &row.setting, course)?;
        let name = format!("{:04} {}", run.number, run.course).replace([' ', ','], "-");
        let path = folder.join(format!("{name}.trace"));
        let written = output::write_file(&path, |out| out.write_all(&trace.to_bytes()));
        written.map_err(|problem| problem.message)?;
        let route = &driven.outcome.route;
        let (turns, steps) = (Vec::new(), Vec::new());
        let story = Story { turns, steps, engaged: vec![0; route.len()] };
        let path = folder.join(format!("{name}.png"));
        picture::draw(&driven.scenario, &driven.start, route, &story, &driven.outcome, &path)?;
    }
    Ok(())
}
