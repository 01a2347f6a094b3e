//! `verify`: re-proves every cell.

use super::description::{self, OnePassage};
use super::progress::{with_patience, with_progress};
use super::project;
use super::{Failure, open, print_json, print_text, read_blob, tell, with_unreadable};
use crate::cli::Verify;
use maps::numbers::{metres, pair};
use maps::problem::{Problem, has_errors};
use plan_compiler::compile::layers;
use plan_compiler::layers::Stack;
use plan_compiler::project::{Project, is_mission};
use plan_compiler::search::Corners;
use plan_compiler::verify::{self, Report};
use plan_compiler::width::{self, Need};
use plan_format::{Blob, Origin};
use serde::Serialize;

pub(super) fn run(args: &Verify, quiet: bool) -> Result<(), Failure> {
    let input = args.input.as_ref();
    let bytes = read_blob(&args.plans).map_err(|failure| with_unreadable(failure, input))?;
    let plan = open(&args.plans, &bytes).map_err(|failure| with_unreadable(failure, input))?;
    let mut problems = Vec::new();
    let proof = with_progress(quiet, 1, |progress| verify::verify(&plan, progress));
    let damaged = "the blob differs from what the compiler wrote; build it again";
    add(&proof, damaged, &mut problems);
    let comparing = || compare(args, &bytes, &plan, &proof, &mut problems);
    let compared = with_patience(quiet, "comparing with the map", comparing)?;
    if has_errors(&problems) {
        return Err(Failure::Wrong(problems));
    }
    let passages = || width::of_blob(&plan, &bytes);
    let passages = with_patience(quiet, "measuring passages", passages);
    let need = Need::of(plan.parameters());
    problems.extend(width::warnings(&passages, &need));
    tell(&problems, quiet);
    if args.json {
        let narrow = passages.iter().flat_map(|layer| {
            let closed = layer.passages.iter().filter(|passage| need.exceeds(passage));
            closed.map(|passage| Narrow {
                layer: format!("{}/{}", layer.plan, layer.layer),
                needed_width_m: description::rounded(need.width_m),
                passage: description::passage(passage, &need),
            })
        });
        let proved = Proved {
            layers: proof.layers,
            cells: proof.cells,
            cuts_corners: proof.cuts_corners,
            compared_with_map: args.input.is_some(),
            too_narrow: narrow.collect(),
        };
        return print_json(&proved);
    }
    if !quiet {
        let rule = if proof.cuts_corners { "corners allowed" } else { "no corner is cut" };
        let (name, layers, cells) = (args.plans.display(), proof.layers, proof.cells);
        let text = format!("{name}: {cells} cells of {layers} layers proved; {rule}{compared}\n");
        return print_text(&text);
    }
    Ok(())
}

/// The output of `--json`.
#[derive(Serialize)]
struct Proved {
    layers: usize,
    cells: usize,
    cuts_corners: bool,
    compared_with_map: bool,
    /// Passages that the robot's own distances may close.
    too_narrow: Vec<Narrow>,
}

/// A passage that is too narrow, and the layer that uses it.
#[derive(Serialize)]
struct Narrow {
    layer: String,
    needed_width_m: f64,
    #[serde(flatten)]
    passage: OnePassage,
}

/// Compares with the map, if one is given.
fn compare(
    args: &Verify,
    bytes: &[u8],
    blob: &Blob<'_>,
    proof: &Report,
    problems: &mut Vec<Problem>,
) -> Result<&'static str, Failure> {
    let Some(input) = &args.input else { return Ok("") };
    let (asked, mission) = (project::options(&[], &args.map), args.map.mission.as_deref());
    let Some(project) = project::read_for((bytes, blob), input, asked, mission, problems)? else {
        return Ok("");
    };
    let is_asked = is_mission(input) || args.map.mission.is_some();
    let of_mission = project.mission.corners.filter(|_| is_asked);
    if let Some(asked) = project.options.corners.or(of_mission).filter(|_| proof.count == 0) {
        problems.extend(compare_corners(blob, proof.cuts_corners, asked));
    }
    let expected = compare_cells(blob, &project, problems);
    let layers = expected.as_ref().map_or(&[][..], Stack::layers);
    let has_tolls = layers.iter().any(|layer| layer.terrain.tolls.is_some());
    let has_limits = layers.iter().any(|layer| !layer.limits.is_none());
    Ok(match (has_tolls, has_limits) {
        (false, false) => "; the obstacles match the map",
        (true, false) => "; obstacles and tolls match the map",
        (false, true) => "; obstacles and speed limits match the map",
        (true, true) => "; obstacles, tolls and speed limits match the map",
    })
}

/// Reports plans that keep another rule for corners than the one that is asked for. Plans that are right
/// by both rules, since no step passes a corner, keep both.
fn compare_corners(blob: &Blob<'_>, cuts_corners: bool, asked: Corners) -> Option<Problem> {
    let (own, other) = match asked {
        Corners::Forbid => ("allow", "forbid"),
        Corners::Allow => ("forbid", "allow"),
    };
    if cuts_corners == (asked == Corners::Allow)
        || verify::verify_by(blob, asked, &|_, _| ()).count == 0
    {
        return None;
    }
    let message = format!("the plans were built with --corners {own}, not {other}");
    Some(Problem::error(message).help(OTHER_OPTIONS))
}

/// Reports how plans and a map differ: in the grid, the place on the globe, the blocked cells, the
/// tolls or the speed limits. Returns the map's layers, if they could be compared.
pub(super) fn compare_cells(
    blob: &Blob<'_>,
    project: &Project,
    problems: &mut Vec<Problem>,
) -> Option<Stack> {
    let input = project.input();
    let grid = plan_compiler::compile::grid(&input, problems)?;
    if grid != *blob.grid() {
        let text = |grid: &plan_format::Grid| {
            let (side, corner) = (metres(grid.resolution_m), pair(grid.corner_m));
            format!("{} x {} cells of {side} m from {corner}", grid.columns, grid.rows)
        };
        let message = format!("the plans have {}, the map {}", text(blob.grid()), text(&grid));
        problems.push(Problem::error(message).help(OTHER_OPTIONS));
        return None;
    }
    let origin = plan_compiler::compile::origin(&input);
    if origin != blob.origin() {
        let text = |origin: Option<Origin>| match origin {
            Some(Origin { place, at_m, heading_rad }) => format!(
                "{}, {} at {}, heading {} rad",
                place.lat_deg(),
                place.lon_deg(),
                pair(at_m),
                metres(heading_rad)
            ),
            None => "no place on the globe".to_owned(),
        };
        let (ours, theirs) = (text(blob.origin()), text(origin));
        let message = format!("the plans' origin is {ours}; the map's is {theirs}");
        problems.push(Problem::error(message).help(OTHER_OPTIONS));
        return None;
    }
    let expected = layers(&input, &grid, problems)?;
    add(&verify::compare(blob, &expected), OTHER_OPTIONS, problems);
    Some(expected)
}

/// Help for a blob and a map that disagree.
const OTHER_OPTIONS: &str = "check that the plans were built from this map; if it has changed, \
     build them again. Options given here override those of the build";

/// Adds one error per violation; the last carries the help.
fn add(report: &Report, help: &str, problems: &mut Vec<Problem>) {
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
        last.help = Some(help.to_owned());
    }
}
