//! `cargo experiment`: runs the team experiment of Wagner and Arkin and prints its table.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use harness::experiment::curves::{self, Point};
use harness::experiment::variation::{Condition, Variation};
use harness::experiment::{Campaign, Row, Trial, figures, table};
use harness::stdout;
use indicatif::{ProgressBar, ProgressStyle};
use plan_compiler::output;

const AFTER: &str = "\
Three robots cross three streets, each with the firmware's own tick. The rows are those of the
paper's table 1: reactive, 66:34, 34:66, plan, parallel, serial. The map was chosen, and the README
tells how. The numbers are the same on every machine.

Exit status: 0 done, 2 the command line is wrong, 3 a file is missing or wrong, or an output cannot be
written.";

/// Runs the team experiment of Wagner and Arkin and prints its table beside theirs.
#[derive(Parser)]
#[command(name = "cargo experiment", after_help = AFTER)]
struct Arguments {
    /// Trials of each row; each 30 of them have their own posts
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    trials: u32,
    /// Seed of the starts and the noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Seed of the posts
    #[arg(long, value_name = "F", default_value_t = 1)]
    field: u64,
    /// Only these rows
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = row)]
    rows: Vec<Row>,
    /// Change a setting on which a finding depends: no-turn-limit, constant-speed, no-posts,
    /// common-goal, independent-starts, open-area, waits-only
    #[arg(long, value_name = "NAME", value_parser = variant)]
    variant: Option<Variation>,
    /// Go beyond the paper: a table for each of wrong maps, GPS errors, unmapped posts, a lost robot,
    /// a bad radio, a computed attenuating area
    #[arg(long, conflicts_with_all = ["variant", "merge", "csv", "json", "shard"])]
    beyond: bool,
    /// Run only every N-th trial of each row, from number I on; --merge puts the parts together
    #[arg(long, value_name = "I/N", value_parser = shard, default_value = "0/1")]
    shard: (u32, u32),
    /// Run nothing: print the table of these files that --csv wrote
    #[arg(long, value_name = "FILES", num_args = 1.., conflicts_with_all = ["shard", "rows", "trials", "seed", "field", "variant"])]
    merge: Vec<PathBuf>,
    /// Write every trial to a file
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw to this folder: means and the routes of the first trial of each row; with --merge means;
    /// with --beyond curves
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON object with the numbers of every trial
    #[arg(long)]
    json: bool,
}

fn row(name: &str) -> Result<Row, String> {
    let names = || Row::ALL.map(Row::name).join(", ");
    Row::named(name).ok_or_else(|| format!("not a row; the rows are {}", names()))
}

fn variant(name: &str) -> Result<Variation, String> {
    let names = || Variation::variants().into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    Variation::named(name)
        .ok_or_else(|| format!("not a variant; the variants are {}", names().join(", ")))
}

fn shard(text: &str) -> Result<(u32, u32), String> {
    let parsed = text
        .split_once('/')
        .and_then(|(index, count)| Some((index.parse::<u32>().ok()?, count.parse::<u32>().ok()?)));
    let fitting = parsed.filter(|(index, count)| index < count);
    fitting.ok_or_else(|| "write I/N with I below N, for example 0/4".to_owned())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()).and_then(|text| stdout::print(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{}", message.trim_end());
            ExitCode::from(3)
        }
    }
}

fn run(arguments: &Arguments) -> Result<String, String> {
    if let Some(problem) = arguments.csv.as_deref().and_then(output::check) {
        return Err(problem.message);
    }
    if arguments.beyond {
        return beyond(arguments);
    }
    let (campaign, trials) = if arguments.merge.is_empty() {
        let campaign = campaign(arguments, arguments.variant.unwrap_or_default());
        if let Some(folder) = &arguments.figures {
            figures::draw_routes(folder, &campaign)?;
        }
        (campaign.command(), run_with_bar(&campaign)?)
    } else {
        merge(&arguments.merge)?
    };
    if let Some(folder) = &arguments.figures {
        figures::draw_bars(folder, &trials)?;
    }
    if let Some(path) = &arguments.csv {
        let text = table::csv(&campaign, &trials);
        output::write_file(path, |out| out.write_all(text.as_bytes()))
            .map_err(|problem| problem.message)?;
    }
    Ok(if arguments.json { table::json(&trials) } else { table::text(&trials) })
}

fn campaign(arguments: &Arguments, variation: Variation) -> Campaign {
    let is_wanted = |row: &Row| arguments.rows.is_empty() || arguments.rows.contains(row);
    Campaign {
        rows: Row::ALL.into_iter().filter(is_wanted).collect(),
        trials: arguments.trials,
        seed: arguments.seed,
        field: arguments.field,
        variation,
        shard: arguments.shard,
    }
}

fn run_with_bar(campaign: &Campaign) -> Result<Vec<Trial>, String> {
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} trials, {eta} left");
    let bar = ProgressBar::new(campaign.count() as u64);
    bar.set_style(style.expect("the template is well-formed"));
    let trials = campaign.run(&|| bar.inc(1))?;
    bar.finish_and_clear();
    Ok(trials)
}

/// The means under each condition beyond the paper, the paper's own first.
fn beyond(arguments: &Arguments) -> Result<String, String> {
    let usual = run_with_bar(&campaign(arguments, Variation::default()))?;
    let mut text = format!("as in the paper\n{}\n", table::short(&usual));
    let mut points = Vec::new();
    for Condition { name, axis, variation } in Variation::beyond() {
        let trials = run_with_bar(&campaign(arguments, variation))?;
        text += &format!("{name}\n{}\n", table::short(&trials));
        points.extend(axis.map(|(axis, value)| Point { axis, value, trials }));
    }
    if let Some(folder) = &arguments.figures {
        curves::draw(folder, &usual, &points)?;
    }
    Ok(text)
}

fn merge(paths: &[PathBuf]) -> Result<(String, Vec<Trial>), String> {
    let read = |path: &PathBuf| {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
        let (campaign, trials) =
            table::read_csv(&text).map_err(|reason| format!("{name}: {reason}"))?;
        Ok((name, campaign, trials))
    };
    table::merge(paths.iter().map(read).collect::<Result<_, String>>()?)
}
