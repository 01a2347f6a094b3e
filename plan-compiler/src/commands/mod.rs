//! One file a command: each reads files, calls the library, prints.

mod build;
mod completions;
mod convert;
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
use plan_compiler::image;
use plan_compiler::mission::nearest;
use plan_compiler::problem::{Problem, Severity, draw};
use plan_compiler::terminal::safe;
use plan_compiler::{output, source};
use plan_format::{Layer, ParallelPlan, Plan};
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// Why a command did not do what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input is wrong in these ways; warnings may be among them.
    Wrong(Vec<Problem>),
    /// The command line asks for what cannot be.
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
        Command::Graph(args) => graph::run(args, cli.quiet),
        Command::Verify(args) => verify::run(args, cli.quiet),
        Command::Convert(args) => convert::run(args, cli.quiet),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => man::run(args),
        Command::Explain(args) => explain::run(args),
    }
}

/// Prints what is worth knowing about work that was done; when quiet, only what is probably not
/// meant.
fn tell(problems: &[Problem], quiet: bool) {
    let least = if quiet { Severity::Warning } else { Severity::Note };
    let told = problems.iter().filter(|problem| problem.severity >= least).cloned();
    crate::eprint(&draw(&told.collect::<Vec<_>>(), crate::colour()));
}

/// Writes text for a person to standard output. Names in it may be anybody's.
fn print_text(text: &str) -> Result<(), Failure> {
    print(safe(text).as_bytes())
}

/// Writes what was asked for to standard output.
fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    Ok(out.flush()?)
}

/// A file that replaced its own input, by a symbolic link perhaps, would cost somebody a day, and
/// one that cannot be written the work.
fn check_output(output: &Path, inputs: &[impl AsRef<Path>], problems: &mut Vec<Problem>) {
    problems.extend(output::check(output));
    let Ok(replaced) = fs::canonicalize(output) else { return };
    if inputs.iter().any(|input| fs::canonicalize(input).is_ok_and(|input| input == replaced)) {
        let message = format!("the output {} is also the input", output.display());
        problems.push(Problem::error(message).mend("choose another -o"));
    }
}

/// As [`check_output`], for a command that has found nothing else wrong yet.
fn refuse_output(output: &Path, inputs: &[impl AsRef<Path>]) -> Result<(), Failure> {
    let mut problems = Vec::new();
    check_output(output, inputs, &mut problems);
    if problems.is_empty() { Ok(()) } else { Err(Failure::Wrong(problems)) }
}

/// The bytes of a blob.
fn read_blob(path: &Path) -> Result<Vec<u8>, Failure> {
    Ok(source::read_bytes(path)?)
}

/// The plan in a blob's bytes.
fn open<'b>(path: &Path, bytes: &'b [u8]) -> Result<Plan<'b>, Failure> {
    Plan::parse_exact(bytes).map_err(|error| {
        let name = path.display();
        if let Some(kind) = image::wrapped(bytes) {
            return Problem::error(format!("{name} is {kind}, which is for flashing only"))
                .mend("name the blob itself: `plan-compiler build MAP -o plans.bin` writes it")
                .into();
        }
        Problem::error(format!("{name} is refused: {error}"))
            .mend("name a blob that `plan-compiler build MAP -o plans.bin` wrote, or build it anew")
            .into()
    })
}

/// Every parallel plan of a blob.
fn parallel_plans<'b>(plan: &Plan<'b>) -> impl Iterator<Item = ParallelPlan<'b>> {
    let plan = *plan;
    (0..plan.plan_count()).filter_map(move |index| plan.parallel_plan(index))
}

/// Every layer of a parallel plan.
fn layers<'b>(plan: ParallelPlan<'b>) -> impl Iterator<Item = Layer<'b>> {
    (0..plan.layer_count()).filter_map(move |index| plan.layer(index))
}

/// The layer of a name.
fn find<'b>(plan: &Plan<'b>, name: &LayerName) -> Result<(ParallelPlan<'b>, Layer<'b>), Failure> {
    let parallel = plan.find(&name.plan);
    let layer = parallel
        .and_then(|plan| layers(plan).find(|layer| layer.name() == name.layer).map(|l| (plan, l)));
    layer.ok_or_else(|| {
        let wanted = format!("{}/{}", name.plan, name.layer);
        let known: Vec<String> = parallel_plans(plan)
            .flat_map(|plan| layers(plan).map(move |l| format!("{}/{}", plan.name(), l.name())))
            .collect();
        let mend = match nearest(&wanted, known.iter().map(String::as_str)) {
            Some(meant) => format!("did you mean {meant}?"),
            None if known.is_empty() => "the blob holds no plan at all".into(),
            None => format!("the blob holds: {}", known.join(", ")),
        };
        Problem::error(format!("there is no layer {wanted}")).mend(mend).into()
    })
}
