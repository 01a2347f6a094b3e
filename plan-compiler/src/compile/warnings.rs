//! What a build allows and its user probably did not mean.

use crate::input::Input;
use maps::Bitmap;
use maps::Unknown;
use maps::numbers::metres;
use maps::problem::Problem;
use plan_format::{Counts, Grid};

/// Cells of another size than the file's own by this factor are worth a word.
const FAR_FROM_OWN: f64 = 10.0;
/// On so few cells along the longer side no robot finds a way.
const FEW_CELLS: u32 = 8;
/// Where obstacles leave less than this share free, there is hardly a map.
const HARDLY_FREE: f64 = 0.1;
/// Where less than this share of what the file says is free stays so, ways have closed.
const LITTLE_LEFT: f64 = 1.0 / 3.0;
/// A goal that a smaller share of the free cells has a route to is probably shut in.
const FEW_REACH: f64 = 0.1;

/// A warning about cells that are far coarser or finer than the map, where somebody asked for them.
pub(super) fn of_cells(input: &Input<'_>, grid: &Grid) -> Option<Problem> {
    let asked = input.options.resolution_m.or(input.mission.resolution_m)?;
    let own = input.map.resolution_m.filter(|own| *own > 0.0);
    let ratio = own.map_or(1.0, |own| asked / own);
    let (columns, rows, side) = (grid.columns, grid.rows, metres(grid.resolution_m));
    if ratio * FAR_FROM_OWN <= 1.0 {
        let own = metres(own.unwrap_or_default());
        let message = format!("cells of {side} m are far finer than the map's own, {own} m");
        let help = "nothing more is known in them, and plans take the more memory; leave the \
                    resolution out for the map's own";
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
        let help = "an obstacle blocks every cell that it touches, so narrow ways close; choose a \
                    finer --resolution";
        Problem::warning(message).help(help)
    })
}

/// A warning where obstacles take nearly everything, or most of what the file says is free.
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
        // Of such a file it is known how much was free before.
        Some(cells) => {
            // Beside a turned image there is nothing that the file says.
            let counts = cells.turned_from.unwrap_or_else(|| cells.counts());
            let unknown = if cells.unknown_as == Unknown::Free { counts.unknown } else { 0 };
            let own = (counts.free + unknown) as f64;
            let sides = grid.resolution_m / cells.resolution_m;
            let share = free * sides * sides / own;
            (own > 0.0 && share < LITTLE_LEFT).then(|| {
                format!(
                    "of the area that the map says is free {} is left: obstacles{grown} block every \
                     cell of {side} m that they touch",
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

/// A warning about a goal that hardly any free cell has a route to, in the first layer of its plan
/// where that is so.
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
            "it is shut in, perhaps by a door that the robot's radius or coarse cells close; \
             `plan-compiler render` shows where",
        ),
    )
}
