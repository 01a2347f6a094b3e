//! `build`: map in, blob out.

use super::{Failure, layers, parallel_plans, project, tell};
use crate::cli::Build;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use plan_compiler::compile::{compile, pair};
use plan_compiler::output;
use plan_compiler::problem::Problem;
use plan_format::Plan;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

pub(super) fn run(args: &Build, quiet: bool) -> Result<(), Failure> {
    let started = Instant::now();
    let mut problems = Vec::new();
    let project = project::read(&args.input, &args.goals, &args.map, &mut problems)?;
    let compiled = project.and_then(|project| {
        check_output(&args.output, &project.inputs, &mut problems);
        with_progress(quiet, |progress| compile(&project.input(), progress, &mut problems))
    });
    let Some(blob) = compiled else { return Err(Failure::Wrong(problems)) };
    if let Err(problem) = output::write_file(&args.output, |out| out.write_all(&blob)) {
        problems.push(problem);
        return Err(Failure::Wrong(problems));
    }
    tell(&problems, quiet);
    if !quiet {
        crate::eprint(&summary(&args.output, &blob, started.elapsed()));
    }
    Ok(())
}

/// A blob that replaced its own map would cost somebody a day.
fn check_output(output: &Path, inputs: &[PathBuf], problems: &mut Vec<Problem>) {
    let Ok(replaced) = fs::canonicalize(output) else { return };
    if inputs.iter().any(|input| fs::canonicalize(input).is_ok_and(|input| input == replaced)) {
        let message = format!("the output {} is also the input", output.display());
        problems.push(Problem::error(message).mend("choose another -o, for example plans.bin"));
    }
}

/// Does `work`, and shows on a terminal how far it is once it takes longer than a second.
fn with_progress<T>(quiet: bool, work: impl FnOnce(&(dyn Fn(usize, usize) + Sync)) -> T) -> T {
    const PATIENCE: Duration = Duration::from_secs(1);
    if quiet {
        return work(&|_, _| {});
    }
    let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::hidden());
    let style = ProgressStyle::with_template("{spinner} layer {pos} of {len} {wide_bar} {elapsed}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let (done, waiting) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        let shown = bar.clone();
        scope.spawn(move || {
            // Hidden by itself where standard error is no terminal.
            if waiting.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(Duration::from_millis(100));
            }
        });
        let result = work(&|layers_done, layers| {
            bar.set_length(layers as u64);
            bar.set_position(layers_done as u64);
        });
        drop(done);
        bar.finish_and_clear();
        result
    })
}

fn summary(path: &Path, blob: &[u8], took: Duration) -> String {
    let mut text = String::new();
    // The compiler has read it back already; a summary is no reason to fail.
    let Ok(plan) = Plan::parse_exact(blob) else { return text };
    let grid = plan.grid();
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{}: {} bytes, {} x {} cells of {} m, {} ms",
        path.display(),
        blob.len(),
        grid.columns,
        grid.rows,
        grid.resolution_m,
        took.as_millis()
    );
    for parallel in parallel_plans(&plan) {
        let _ = writeln!(text, "  {} to {}", parallel.name(), pair(parallel.goal_m()));
        for layer in layers(parallel) {
            let counts = layer.counts();
            let _ = writeln!(
                text,
                "    {}: {} cells with a route, {} without, {} blocked",
                layer.name(),
                counts.free,
                counts.unreachable,
                counts.blocked
            );
        }
    }
    text
}
