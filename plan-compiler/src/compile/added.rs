//! What each layer adds: roles of features, areas that the mission names, masks.

use super::MAX_SUGGESTIONS;
use super::area::reach;
use super::obstacles::Added;
use super::speed_limits::{self, MaskLimits};
use super::{radio, tolls};
use crate::input::Input;
use crate::layers::Stack;
use crate::mission::{COMMS, Mask, Named, PHYSICAL};
use maps::names::nearest;
use maps::numbers::pair;
use maps::problem::Problem;
use maps::raster::{RasterOptions, keep_out, rasterise};
use plan_format::{Grid, limits};
use std::collections::HashSet;

/// The stack from the least to the most constrained layer: `physical`, `comms` where the map has
/// attenuating areas or the mission has a radio, and the mission's in its order; `None` after an
/// error.
pub(super) fn stack(
    input: &Input<'_>,
    grid: &Grid,
    robot_radius_m: f64,
    problems: &mut Vec<Problem>,
) -> Option<Stack> {
    let names = names(input);
    if names.len() > limits::MAX_LAYERS {
        let message = format!("{} layers, but a plan holds {}", names.len(), limits::MAX_LAYERS);
        problems.push(Problem::error(message).help("join areas of several layers into one"));
        return None;
    }
    check_areas(input, problems);
    let fill_walls = input.options.fill_walls || input.mission.fill_walls.unwrap_or(false);
    let options = RasterOptions { robot_radius_m, fill_walls };
    let mask_limits = MaskLimits::new(input, grid, problems);
    let mut stack = Stack::default();
    let mut all: Vec<Added<'_>> = Vec::new();
    for name in names {
        all.push(Added::by(input, name));
        let Some(added) = all.last() else { continue };
        let mut blocked = rasterise(input.map, grid, &|feature| added.adds(feature), &options);
        if let Some(rule) = input.mission.radio.as_ref().filter(|_| name == COMMS) {
            blocked.add_all(&radio::out_of_reach(input, rule, grid, problems));
        }
        for mask in &added.masks {
            keep_out(&mask.cells, grid, robot_radius_m, &mut blocked);
        }
        let rules = input.mission.layers.iter().filter(|rule| rule.name.name == name);
        let rules: Vec<_> = rules.filter(|rule| !rule.tolls.is_empty()).collect();
        if rules.is_empty() && !mask_limits.has(name) {
            stack.add(name, blocked);
            continue;
        }
        let site = tolls::Site { input, grid, options, added: &all };
        let mut solid = blocked.clone();
        if let Some(below) = stack.layers().last() {
            solid.add_all(&below.terrain.blocked);
        }
        stack.add_with_tolls(name, blocked, |tolls, limits| {
            rules.iter().for_each(|rule| site.add(rule, tolls, limits, problems));
            mask_limits.add(name, &|cell| !solid.get(cell), tolls, limits, problems);
        });
    }
    problems.extend(speed_limits::too_many(input));
    problems.extend(input.mission.masks.iter().filter_map(|mask| beside(mask, grid)));
    Some(stack)
}

/// Warns about a mask that does not overlap the map.
fn beside(mask: &Mask, grid: &Grid) -> Option<Problem> {
    let theirs = mask.cells.extent();
    let ours = [grid.columns, grid.rows].map(|cells| f64::from(cells) * grid.resolution_m);
    let is_beside = (0..2).any(|axis| {
        let (low, high) = (theirs.corner[axis], theirs.corner[axis] + theirs.size[axis]);
        high <= grid.corner_m[axis] || low >= grid.corner_m[axis] + ours[axis]
    });
    let end = [0, 1].map(|axis| theirs.corner[axis] + theirs.size[axis]);
    let message = format!("the mask {} does not overlap the map", mask.path.display());
    let label = format!("it extends from {} to {}", pair(theirs.corner), pair(end));
    is_beside.then(|| {
        Problem::warning(message)
            .at(&mask.place.source, mask.place.span.clone(), label)
            .help(format!("check its `origin`; {}", reach(grid)))
    })
}

/// The names of all layers.
fn names<'a>(input: &Input<'a>) -> Vec<&'a str> {
    let rules = || input.mission.layers.iter().map(|rule| rule.name.name.as_str());
    let has_weak_links = input.map.has_attenuating_areas() || input.mission.radio.is_some();
    let comms = has_weak_links && !rules().any(|name| name == COMMS);
    std::iter::once(PHYSICAL)
        .chain(comms.then_some(COMMS))
        .chain(rules().filter(|name| *name != PHYSICAL))
        .collect()
}

/// Reports every area that the mission names and the map lacks.
fn check_areas(input: &Input<'_>, problems: &mut Vec<Problem>) {
    let features = input.map.features.iter().map(|feature| feature.name.as_str());
    let known: HashSet<&str> = features.filter(|name| !name.is_empty()).collect();
    let mut sorted: Vec<&str> = known.iter().copied().collect();
    sorted.sort_unstable();
    let rules = input.mission.layers.iter();
    for area in rules.flat_map(|rule| rule.areas.iter().chain(rule.tolls.names())) {
        if !known.contains(area.name.as_str()) {
            let error = Problem::error(format!("the map has no area named `{}`", area.name)).at(
                &area.place.source,
                area.place.span.clone(),
                "asked for here",
            );
            // Of many mistakes, only the first need a suggestion.
            let needs_advice = problems.len() < MAX_SUGGESTIONS;
            problems.push(if needs_advice {
                error.help(other_areas(area, &sorted))
            } else {
                error
            });
        }
    }
}

fn other_areas(area: &Named, sorted: &[&str]) -> String {
    /// Listing more names than this does not help.
    const LISTED: usize = 12;
    match nearest(&area.name, sorted.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None if sorted.is_empty() => "the map gives no area a name".into(),
        None if sorted.len() > LISTED => {
            format!("the map has: {}, ...", sorted[..LISTED].join(", "))
        }
        None => format!("the map has: {}", sorted.join(", ")),
    }
}
