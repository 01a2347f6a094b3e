//! One file a command: each reads files, calls the library, prints.

mod build;
mod comms;
mod completions;
mod convert;
mod cover;
mod description;
mod explain;
mod export;
mod graph;
mod inspect;
mod man;
mod progress;
mod project;
mod query;
mod render;
mod verify;

use crate::cli::{Cli, Command, LayerName};
use maps::formats::Format;
use maps::formats::foreign;
use maps::names::nearest;
use maps::problem::{Problem, Severity, draw};
use maps::source;
use maps::terminal::{quoted, safe};
use plan_compiler::{output, trace};
use plan_format::{Blob, Layer, MAGIC, ParallelPlan};
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input is wrong in these ways; warnings may be among them.
    Wrong(Vec<Problem>),
    /// The command line is wrong.
    Usage(String),
    /// Standard output cannot be written to.
    Output(io::Error),
}

impl From<Problem> for Failure {
    fn from(problem: Problem) -> Self {
        Self::Wrong(vec![problem])
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

/// Runs the command that was asked for.
pub(crate) fn run(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        Command::Build(args) => build::run(args, cli.quiet),
        Command::Inspect(args) => inspect::run(args),
        Command::Query(args) => query::run(args),
        Command::Export(args) => export::run(args),
        Command::Render(args) => render::run(args, cli.quiet),
        Command::Comms(args) => comms::run(args, cli.quiet),
        Command::Cover(args) => cover::run(args, cli.quiet),
        Command::Graph(args) => graph::run(args, cli.quiet),
        Command::Verify(args) => verify::run(args, cli.quiet),
        Command::Convert(args) => convert::run(args, cli.quiet),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => man::run(args),
        Command::Explain(args) => explain::run(args, cli.quiet),
    }
}

/// Prints problems and notes; when quiet, no notes.
pub(crate) fn tell(problems: &[Problem], quiet: bool) {
    let least = if quiet { Severity::Warning } else { Severity::Note };
    let shown = problems.iter().filter(|problem| problem.severity >= least).cloned();
    crate::eprint(&draw(&shown.collect::<Vec<_>>(), crate::colour()));
}

/// Writes text for a person to standard output, made safe since it may contain names from files.
fn print_text(text: &str) -> Result<(), Failure> {
    print(safe(text).as_bytes())
}

/// Writes a value as JSON to standard output.
fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_vec_pretty(value).map_err(io::Error::from)?;
    text.push(b'\n');
    print(&text)
}

/// The name of a file without its folder.
fn file_name(path: &Path) -> String {
    Path::new(path.file_name().unwrap_or(path.as_os_str())).display().to_string()
}

/// Writes bytes to standard output.
fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    Ok(out.flush()?)
}

/// Refuses an output that cannot be written or that is an input, for commands that have no other
/// problems to report with it.
fn refuse_output(output: &Path, inputs: &[impl AsRef<Path>]) -> Result<(), Failure> {
    let problems = output::check_against(output, inputs);
    if problems.is_empty() { Ok(()) } else { Err(Failure::Wrong(problems)) }
}

/// The bytes of a blob.
fn read_blob(path: &Path) -> Result<Vec<u8>, Failure> {
    Ok(source::read_bytes(path)?)
}

/// Adds to a failure that a further input cannot be read either.
fn with_unreadable(failure: Failure, input: Option<&PathBuf>) -> Failure {
    // Reading from a pipe would wait.
    let input = input.filter(|input| !input.exists() || input.is_file());
    match (failure, input.and_then(|input| source::read_bytes(input).err())) {
        (Failure::Wrong(mut problems), Some(problem)) => {
            problems.push(problem);
            Failure::Wrong(problems)
        }
        (failure, _) => failure,
    }
}

/// The plan in a blob's bytes.
fn open<'b>(path: &Path, bytes: &'b [u8]) -> Result<Blob<'b>, Failure> {
    Blob::parse_exact(bytes).map_err(|error| {
        let name = path.display();
        if let Some(kind) = foreign::wrapped(bytes) {
            return Problem::error(format!("{name} is {kind}, which is for flashing only"))
                .help("use the blob itself: `plan-compiler build MAP -o plans.bin` writes it")
                .into();
        }
        if let Some(kind) = other_kind(path, bytes) {
            return Problem::error(format!("{name} is {kind}, not a plan blob"))
                .help(help_for_kind(path, &kind))
                .into();
        }
        Problem::error(format!("{name} is refused: {error}"))
            .help("use a blob that `plan-compiler build MAP -o plans.bin` wrote, or build it again")
            .into()
    })
}

/// A trace.
const TRACE: &str = "a trace";
/// A mission file.
const MISSION: &str = "a mission file";

/// The kind of a file that is not a blob, if it is recognised.
fn other_kind(path: &Path, bytes: &[u8]) -> Option<String> {
    if bytes.starts_with(&MAGIC) {
        return None;
    }
    if bytes.starts_with(trace::MAGIC) {
        return Some(TRACE.into());
    }
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    if extension == "toml" {
        return Some(MISSION.into());
    }
    let is_of = |format: &Format| format.extensions().contains(&extension.as_str());
    let format = Format::ALL.into_iter().find(is_of)?;
    Some(format!("a map ({})", format.name()))
}

/// Which command takes a file of another kind.
fn help_for_kind(path: &Path, kind: &str) -> String {
    let name = quoted(path);
    match kind {
        TRACE => format!("show it with `plan-compiler explain {name}`"),
        _ => format!("compile it first: `plan-compiler build {name} -o plans.bin`"),
    }
}

/// The layer with a name; without a name, the only layer of the blob.
fn find<'b>(
    blob: &Blob<'b>,
    name: Option<&LayerName>,
) -> Result<(ParallelPlan<'b>, Layer<'b>), Failure> {
    let mut all =
        blob.parallel_plans().flat_map(|plan| plan.layers().map(move |layer| (plan, layer)));
    let Some(name) = name else {
        return match (all.next(), all.next()) {
            (Some(only), None) => Ok(only),
            (Some(_), Some(_)) => {
                let known = known_layers(blob);
                Err(Failure::Usage(format!(
                    "the blob contains several layers; choose one: --layer {}",
                    known.join(" or --layer ")
                )))
            }
            (None, _) => Err(Problem::error("the blob contains no plans").into()),
        };
    };
    let found = all.find(|(plan, layer)| plan.name() == name.plan && layer.name() == name.layer);
    found.ok_or_else(|| {
        let wanted = format!("{}/{}", name.plan, name.layer);
        let known = known_layers(blob);
        let meant = nearest(&wanted, known.iter().map(String::as_str));
        let meant = meant.map_or(String::new(), |meant| format!("did you mean {meant}? "));
        let help = match known.is_empty() {
            true => "the blob contains no plans".into(),
            false => format!("{meant}the blob contains: {}", known.join(", ")),
        };
        Problem::error(format!("there is no layer {wanted}")).help(help).into()
    })
}

/// The names of a blob's layers; beyond a dozen, only their number.
fn known_layers(blob: &Blob<'_>) -> Vec<String> {
    const LISTED: usize = 12;
    let mut names = blob
        .parallel_plans()
        .flat_map(|plan| plan.layers().map(move |l| format!("{}/{}", plan.name(), l.name())));
    let mut known: Vec<String> = names.by_ref().take(LISTED).collect();
    let more = names.count();
    if more > 0 {
        known.push(format!("{more} more, which `plan-compiler inspect` lists"));
    }
    known
}
