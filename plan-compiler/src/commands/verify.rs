//! `verify`: every cell proved anew.

use super::progress::{with_patience, with_progress};
use super::{Failure, open, print, print_text, project, read_blob, tell};
use crate::cli::Verify;
use plan_compiler::compile::{blocked, has_errors, metres, pair};
use plan_compiler::problem::Problem;
use plan_compiler::verify::{self, Report};
use plan_format::Plan;
use serde::Serialize;
use std::io;

pub(super) fn run(args: &Verify, quiet: bool) -> Result<(), Failure> {
    let bytes = read_blob(&args.plans)?;
    let plan = open(&args.plans, &bytes)?;
    let mut problems = Vec::new();
    let proof = with_progress(quiet, |progress| verify::verify(&plan, progress));
    let damaged = "the blob is not what the compiler wrote; build it anew";
    add(&proof, damaged, &mut problems);
    let comparing = || compare(args, &plan, &mut problems);
    let compared = with_patience(quiet, "comparing with the map", comparing)?;
    if has_errors(&problems) {
        return Err(Failure::Wrong(problems));
    }
    tell(&problems, quiet);
    if args.json {
        let proved = Proved {
            layers: proof.layers,
            cells: proof.cells,
            cuts_corners: proof.cuts_corners,
            compared_with_map: args.input.is_some(),
        };
        let json = serde_json::to_string_pretty(&proved).map_err(io::Error::from)?;
        return print(format!("{json}\n").as_bytes());
    }
    if !quiet {
        let rule = if proof.cuts_corners { "corners allowed" } else { "no corner is cut" };
        let (name, layers, cells) = (args.plans.display(), proof.layers, proof.cells);
        let text = format!("{name}: {cells} cells of {layers} layers proved; {rule}{compared}\n");
        return print_text(&text);
    }
    Ok(())
}

/// What `--json` prints.
#[derive(Serialize)]
struct Proved {
    layers: usize,
    cells: usize,
    cuts_corners: bool,
    compared_with_map: bool,
}

/// Compares with the map, if one is given.
fn compare(
    args: &Verify,
    plan: &Plan<'_>,
    problems: &mut Vec<Problem>,
) -> Result<&'static str, Failure> {
    let Some(input) = &args.input else { return Ok("") };
    let Some(project) = project::read(input, None, &[], &args.map, problems)? else {
        return Ok("");
    };
    let Some(grid) = plan_compiler::compile::grid(&project.input(), problems) else {
        return Ok("");
    };
    if grid != *plan.grid() {
        let (ours, theirs) = (plan.grid(), grid);
        let text = |grid: &plan_format::Grid| {
            let (side, corner) = (metres(grid.resolution_m), pair(grid.corner_m));
            format!("{} x {} cells of {side} m from {corner}", grid.columns, grid.rows)
        };
        let message = format!("the plans have {}, the map {}", text(ours), text(&theirs));
        problems.push(Problem::error(message).mend(OTHER_OPTIONS));
    } else if let Some(expected) = blocked(&project.input(), &grid, problems) {
        add(&verify::compare(plan, &expected), OTHER_OPTIONS, problems);
    }
    Ok("; obstacles as in the map")
}

/// Where a blob and a map disagree, one of them may have changed since.
const OTHER_OPTIONS: &str =
    "give the options that the blob was built with; if the map has changed, build it anew";

/// Each violation as an error, the last with how to mend them all.
fn add(report: &Report, mend: &str, problems: &mut Vec<Problem>) {
    for violation in &report.violations {
        let (at, cell) = (pair(violation.at), violation.cell);
        problems.push(Problem::error(format!(
            "{}: column {}, row {} at {at}: {}",
            violation.layer, cell.column, cell.row, violation.what
        )));
    }
    let more = report.count - report.violations.len();
    if more > 0 {
        problems.push(Problem::error(format!("{more} more cells are wrong")));
    }
    if let (Some(last), 1..) = (problems.last_mut(), report.count) {
        last.mend = Some(mend.to_owned());
    }
}
