//! `cargo fault-table`: every fault of every part of the robot, on three maps.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use harness::fault_table::{Case, Filled, MISSION, Row, Run, fill, record, rows, run_count};
use harness::shell;
use indicatif::{ProgressBar, ProgressStyle};
use plan_compiler::output;

const JUDGEMENT: &str = "\
A run is sound if the robot arrives within three times its time without a fault plus 60 s, or stands
still for a true reason within the time that the column `within s` states; and if it neither left the
map nor touched an obstacle. Each fault lasts from a random time to the end.

`stood` counts the runs that end standing, `latest s` is the longest time from the fault until the
robot stood. Notes below the table say what no robot with these sensors can know or do. The first row
is without a fault; there, every robot must arrive.

Exit status: 0 all judged runs are sound, 1 some are not, 2 the command line is wrong, 3 a map of the
table is missing or wrong, or an output could not be written.";

/// Tries every fault of every part of the robot from random times on three maps.
#[derive(Parser)]
#[command(name = "cargo fault-table", after_help = JUDGEMENT)]
struct Arguments {
    /// Runs of each fault on each map
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=10_000), allow_negative_numbers = true)]
    seeds: u64,
    /// Seed of the first run; each further run uses the next
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Only this part: gps, compass, odometry, ranges, link, battery, clock or actuators
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// Only this kind: lost, frozen, offset, delayed, garbled or intermittent
    #[arg(long, value_name = "NAME")]
    kind: Option<String>,
    /// List the runs that are not sound, each with the world file that repeats it
    #[arg(long)]
    failures: bool,
    /// Write a trace of each run that is not sound to this folder, for `plan-compiler explain`
    #[arg(long, value_name = "FOLDER")]
    traces: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let is_wanted = |row: &Row| {
        let is = |wanted: &Option<String>, name: &str| wanted.as_deref().is_none_or(|w| w == name);
        is(&arguments.sensor, row.channel.name()) && is(&arguments.kind, row.kind)
    };
    let rows: Vec<Row> = rows().into_iter().filter(is_wanted).collect();
    // The row without a fault is always there.
    if rows.is_empty() {
        eprintln!("no fault has this sensor and kind; see cargo fault-table --help");
        return ExitCode::from(2);
    }
    if let Some(folder) = &arguments.traces
        && let Err(message) = shell::create_folder(folder)
    {
        eprintln!("{message}");
        return ExitCode::from(3);
    }
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} runs, {eta} left");
    let bar = ProgressBar::new(run_count(&rows, arguments.seeds));
    bar.set_style(style.expect("the template is well-formed"));
    let table = fill(&rows, arguments.seed, arguments.seeds, &|| bar.inc(1));
    bar.finish_and_clear();
    let table = match table {
        Ok(table) => table,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(3);
        }
    };
    if let Some(folder) = &arguments.traces
        && let Err(message) = write_traces(folder, &table)
    {
        eprintln!("{message}");
        return ExitCode::from(3);
    }
    let text = match (arguments.json, arguments.failures) {
        (true, has_failures) => json(&table, has_failures),
        (false, false) => text(&table),
        (false, true) => text(&table) + &table.iter().map(failures).collect::<String>(),
    };
    if let Err(message) = shell::print(&text) {
        eprintln!("{message}");
        return ExitCode::from(3);
    }
    ExitCode::from(u8::from(!table.iter().all(Filled::is_sound)))
}

fn write_traces(folder: &Path, table: &[Filled]) -> Result<(), String> {
    for filled in table {
        for run in filled.failures() {
            let Case { map, seed, .. } = run.journey;
            let is_without = filled.row == Row::WITHOUT;
            let part = if is_without { "without" } else { filled.row.channel.name() };
            let name = format!("{part}-{}-{map}-{seed}.trace", filled.row.kind);
            let path = folder.join(name);
            let trace = record(&filled.row, &run.journey)?;
            let written = output::write_file(&path, |out| out.write_all(&trace.to_bytes()));
            written.map_err(|problem| problem.message)?;
        }
    }
    Ok(())
}

fn text(table: &[Filled]) -> String {
    let mut text = String::from(
        "sensor     kind          runs  reached  stood  neither  untrue  left map  touched  \
         latest s  within s  sound  reasons\n",
    );
    let mut notes = String::new();
    for filled in table {
        let Row { kind, .. } = filled.row;
        let name = name(filled);
        let neither = filled.count(|run| !run.is_reached && run.stood.is_none());
        let latest = filled.latest_stand_s().map_or("-".to_owned(), |s| format!("{s:.1}"));
        let verdict = match (filled.row.is_judged(), filled.is_sound()) {
            (false, _) => "-",
            (true, true) => "yes",
            (true, false) => "NO",
        };
        let reasons = filled.reasons();
        let reasons = reasons.iter().map(|(reason, count)| format!("{reason} {count}"));
        let reasons = reasons.collect::<Vec<_>>().join(", ");
        let line = format!(
            "{name:<9}  {kind:<12}  {:>4}  {:>7}  {:>5}  {neither:>7}  {:>6}  {:>8}  {:>7}  \
             {latest:>8}  {:>8}  {verdict:<5}  {reasons}",
            filled.runs.len(),
            filled.count(|run| run.is_reached),
            filled.count(|run| run.stood.is_some()),
            filled.count(|run| run.stood.is_some() && !run.stands_truly(&filled.row)),
            filled.count(|run| run.has_left),
            filled.count(|run| run.has_touched),
            filled.row.within_s(),
        );
        text += line.trim_end();
        text += "\n";
        if let Some(limit) = filled.row.limit() {
            notes += &format!("{name} {kind}: {limit}\n");
        }
    }
    text + &notes
}

/// Each run of a row that is not sound: a line, and the world file that repeats it.
fn failures(filled: &Filled) -> String {
    let runs = filled.failures().map(|run| {
        let Case { map, seed, .. } = run.journey;
        let world = run.journey.world(&filled.row);
        let world: String = world.lines().map(|line| format!("    {line}\n")).collect();
        format!(
            "{} {}: {map} --seed {seed}: {}; it repeats with {} in the mission and this world \
             file:\n{world}",
            name(filled),
            filled.row.kind,
            what(run),
            MISSION.trim().replace('\n', " "),
        )
    });
    runs.collect()
}

/// What is wrong with a run.
fn what(run: &Run) -> String {
    match run {
        Run { has_touched: true, .. } => "touched an obstacle".to_owned(),
        Run { has_left: true, .. } => "left the map".to_owned(),
        Run { stood: Some((reason, _)), .. } => format!("stands: {reason:?}"),
        _ => format!("neither arrived nor stands; at the end {:?}", run.last),
    }
}

/// What fails in a row.
fn name(filled: &Filled) -> &'static str {
    if filled.row == Row::WITHOUT { "-" } else { filled.row.channel.name() }
}

/// The object of `--json`. Programs rely on its names. `failures` is there with `--failures`.
fn json(table: &[Filled], has_failures: bool) -> String {
    let rows = table.iter().map(|filled| {
        let stood_s: Vec<f64> = filled.runs.iter().filter_map(|run| Some(run.stood?.1)).collect();
        let mut object = serde_json::json!({
            "sensor": name(filled),
            "kind": filled.row.kind,
            "runs": filled.runs.len(),
            "reached": filled.count(|run| run.is_reached),
            "stood": filled.reasons(),
            "stood_after_s": stood_s,
            "neither": filled.count(|run| !run.is_reached && run.stood.is_none()),
            "untrue": filled.count(|run| run.stood.is_some() && !run.stands_truly(&filled.row)),
            "left_map": filled.count(|run| run.has_left),
            "touched": filled.count(|run| run.has_touched),
            "within_s": filled.row.within_s(),
            "limit": filled.row.limit(),
            "judged": filled.row.is_judged(),
            "sound": filled.is_sound(),
        });
        if has_failures {
            let failures = filled.failures().map(|run| {
                serde_json::json!({
                    "map": run.journey.map,
                    "seed": run.journey.seed,
                    "what": what(run),
                    "mission": MISSION,
                    "world": run.journey.world(&filled.row),
                })
            });
            object["failures"] = failures.collect();
        }
        object
    });
    let rows: Vec<serde_json::Value> = rows.collect();
    format!("{}\n", serde_json::json!({ "rows": rows }))
}
