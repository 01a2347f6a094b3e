//! Warnings about what is allowed but was probably not meant.

use crate::input::Input;
use crate::toml::Text;
use maps::Bitmap;
use maps::Unknown;
use maps::numbers::metres;
use maps::problem::Problem;
use plan_format::{Counts, Grid};

/// Cells that differ from the file's own size by this factor get a warning.
const FAR_FROM_OWN: f64 = 10.0;
/// With fewer cells than this along the longer side, a map is too coarse to drive by.
const FEW_CELLS: u32 = 8;
/// A map with a smaller share of free cells than this gets a warning.
const HARDLY_FREE: f64 = 0.1;
/// If less than this share of the file's free area stays free, passages have probably closed.
const LITTLE_LEFT: f64 = 1.0 / 3.0;
/// A goal that a smaller share of the free cells can reach is probably enclosed.
const FEW_REACH: f64 = 0.1;

/// Warns about a tolerance that the cells are too large for: a robot in the goal's cell is at the goal.
pub(super) fn of_tolerance(input: &Input<'_>, grid: &Grid) -> Option<Problem> {
    let key = "schemas.goal_tolerance";
    let place = input.mission.given.as_ref()?.place(key)?;
    let tolerance_m = f64::from(input.mission.parameters.schemas.goal_tolerance_m);
    let finest_m = tolerance_m * std::f64::consts::SQRT_2;
    if grid.resolution_m <= finest_m + 1e-6 {
        return None;
    }
    let message = format!(
        "`{key}` is {} m, but in cells of {} m the robot stops anywhere in the goal's cell",
        metres(tolerance_m),
        metres(grid.resolution_m)
    );
    let help = format!(
        "make the cells {} m at most with `resolution`, or the tolerance larger",
        metres((finest_m * 1000.0).floor() / 1000.0)
    );
    let problem = Problem::warning(message).help(help);
    Some(problem.at(&place.source, place.span.clone(), "given here"))
}

/// Warns about a requested cell size that is far coarser or finer than the map.
pub(super) fn of_cells(input: &Input<'_>, grid: &Grid) -> Option<Problem> {
    let asked = input.options.resolution_m.or(input.mission.resolution_m)?;
    let own = input.map.resolution_m.filter(|own| *own > 0.0);
    let ratio = own.map_or(1.0, |own| asked / own);
    let (columns, rows, side) = (grid.columns, grid.rows, metres(grid.resolution_m));
    if ratio * FAR_FROM_OWN <= 1.0 {
        let own = metres(own.unwrap_or_default());
        let message = format!("cells of {side} m are far finer than the map's own, {own} m");
        let help = "finer cells add no knowledge and need more memory; leave the \
                    resolution out to use the map's own";
        return Some(Problem::warning(message).help(help));
    }
    let is_coarse =
        ratio >= FAR_FROM_OWN || (ratio > 1.0 || own.is_none()) && columns.max(rows) < FEW_CELLS;
    is_coarse.then(|| {
        let of_own =
            own.map_or(String::new(), |own| format!(", whose own cells are {} m", metres(own)));
        let [width, height] = input.map.extent.size.map(metres);
        let message = format!(
            "cells of {side} m are coarse for this map{of_own}: {width} m x {height} m are \
             {columns} x {rows} cells"
        );
        let help = "an obstacle blocks every cell that it touches, so narrow passages close; choose a \
                    finer --resolution";
        Problem::warning(message).help(help)
    })
}

/// Warns of actions that drive to a place off the map or inside an obstacle.
pub(super) fn of_places(input: &Input<'_>, grid: &Grid, blocked: &Bitmap) -> Vec<Problem> {
    let syntax = &input.mission.behaviours;
    let Some(source) = &syntax.source else { return Vec::new() };
    let trouble = |(name, [x, y]): (&Text, [f32; 2])| {
        let (x, y) = (f64::from(x), f64::from(y));
        let (place, label) = match grid.cell_at(x, y) {
            None => (
                "off the map",
                "the robot stops at the edge of the map, unless \
                `trouble.off_map` lets it drive on",
            ),
            Some(cell) if blocked.get(cell) => ("inside an obstacle", "the robot will not arrive"),
            Some(_) => return None,
        };
        let (name, span) = (name.as_str(), name.span.clone());
        let message = format!("`{name}` drives to {}, {}, {place}", metres(x), metres(y));
        let help = "choose a place on free ground";
        Some(Problem::warning(message).at(source, span, label).help(help))
    };
    syntax.places().filter_map(trouble).collect()
}

/// Warns if obstacles cover nearly everything, or most of the file's free area.
pub(super) fn nearly_blocked(
    input: &Input<'_>,
    grid: &Grid,
    radius_m: f64,
    blocked: &Bitmap,
) -> Option<Problem> {
    let all = grid.cells() as f64;
    let free = all - blocked.count() as f64;
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let side = metres(grid.resolution_m);
    let grown = match radius_m {
        radius if radius > 0.0 => format!(", grown by the robot's radius of {} m,", metres(radius)),
        _ => String::new(),
    };
    let message = match &input.map.cells {
        // A file with cells tells how much was free before.
        Some(cells) => {
            // The file says nothing about the area beside a turned image.
            let counts = cells.turned_from.unwrap_or_else(|| cells.counts());
            let unknown = if cells.unknown_as == Unknown::Free { counts.unknown } else { 0 };
            let own = (counts.free + unknown) as f64;
            let sides = grid.resolution_m / cells.resolution_m;
            let share = free * sides * sides / own;
            (own > 0.0 && share < LITTLE_LEFT).then(|| {
                format!(
                    "only {} of the map's free area is left: obstacles{grown} block every cell of \
                     {side} m that they touch",
                    percent(share)
                )
            })
        }
        None => (free < HARDLY_FREE * all).then(|| {
            let share = percent(1.0 - free / all);
            format!("obstacles{grown} block {share} of the map's cells of {side} m")
        }),
    };
    let help = if radius_m > 0.0 {
        "choose a finer --resolution or a smaller --robot-radius; `plan-compiler render` shows what \
         is left"
    } else {
        "choose a finer --resolution, or check the area and the units of the map; `plan-compiler \
         render` shows what is left"
    };
    message.map(|message| Problem::warning(message).help(help))
}

/// Warns about a goal that hardly any free cell can reach, for the first such layer of its plan.
pub(super) fn few_reach<'a>(
    goal: &str,
    mut layers: impl Iterator<Item = (&'a str, Counts)>,
) -> Option<Problem> {
    let free = |counts: &Counts| f64::from(counts.free) + f64::from(counts.unreachable);
    let (layer, counts) =
        layers.find(|(_, counts)| f64::from(counts.free) < FEW_REACH * free(counts))?;
    let (with, free) = (counts.free, free(&counts));
    Some(
        Problem::warning(format!(
            "only {with} of {free} free cells have a route to goal `{goal}` in layer `{layer}`"
        ))
        .help(
            "it is enclosed, perhaps because the robot's radius or coarse cells close a door; \
             `plan-compiler render` shows where",
        ),
    )
}
