//! The stack of layers and the blocked cells of each.

use super::Input;
use crate::bitmap::Bitmap;
use crate::map::{Feature, Role};
use crate::mission::{Named, nearest};
use crate::problem::Problem;
use crate::raster::{RasterOptions, rasterise};
use plan_format::{Grid, limits};
use std::collections::HashSet;

/// Obstacles.
const PHYSICAL: &str = "physical";
/// Obstacles and areas that weaken radio.
const COMMS: &str = "comms";

/// A layer before any goal: its name and its blocked cells.
pub(super) struct Level {
    pub(super) name: String,
    pub(super) blocked: Bitmap,
}

/// The layers from the least to the most constrained: `physical`, `comms` where the map has
/// attenuating areas, and the mission's in its order; `None` after an error.
pub(super) fn levels(
    input: &Input<'_>,
    grid: &Grid,
    robot_radius_m: f64,
    problems: &mut Vec<Problem>,
) -> Option<Vec<Level>> {
    let names = names(input);
    if names.len() > limits::MAX_LAYERS {
        let message = format!("{} layers, but a plan holds {}", names.len(), limits::MAX_LAYERS);
        problems.push(Problem::error(message).mend("join areas of several layers into one"));
        return None;
    }
    check_areas(input, problems);
    let fill_walls = input.options.fill_walls || input.mission.fill_walls.unwrap_or(false);
    let options = RasterOptions { robot_radius_m, fill_walls };
    let level = |(index, name): (usize, &&str)| {
        // The first layer in which a feature is an obstacle; it is one in all that follow.
        let is_obstacle = |feature: &Feature| {
            (0..=index).any(|lower| is_added(input, names.get(lower).unwrap_or(&""), feature))
        };
        Level {
            name: (*name).to_owned(),
            blocked: rasterise(input.map, grid, &is_obstacle, &options),
        }
    };
    Some(names.iter().enumerate().map(level).collect())
}

/// The names of all layers.
fn names<'a>(input: &Input<'a>) -> Vec<&'a str> {
    let rules = || input.mission.layers.iter().map(|rule| rule.name.name.as_str());
    let comms = input.map.has_attenuating_areas() && !rules().any(|name| name == COMMS);
    std::iter::once(PHYSICAL)
        .chain(comms.then_some(COMMS))
        .chain(rules().filter(|name| *name != PHYSICAL))
        .collect()
}

/// Whether a layer makes an obstacle of a feature that the layer before it may lack.
fn is_added(input: &Input<'_>, layer: &str, feature: &Feature) -> bool {
    let by_role = match feature.role {
        Role::Obstacle => layer == PHYSICAL,
        Role::Attenuating => layer == COMMS,
        Role::Zone => false,
    };
    let mut rules = input.mission.layers.iter().filter(|rule| rule.name.name == layer);
    by_role || rules.any(|rule| rule.areas.iter().any(|area| area.name == feature.name))
}

/// Every area that the mission names must be in the map.
fn check_areas(input: &Input<'_>, problems: &mut Vec<Problem>) {
    let features = input.map.features.iter().map(|feature| feature.name.as_str());
    let known: HashSet<&str> = features.filter(|name| !name.is_empty()).collect();
    for area in input.mission.layers.iter().flat_map(|rule| &rule.areas) {
        if !known.contains(area.name.as_str()) {
            problems.push(unknown_area(area, &known));
        }
    }
}

fn unknown_area(area: &Named, known: &HashSet<&str>) -> Problem {
    /// More names than this help nobody.
    const LISTED: usize = 12;
    let mut sorted: Vec<&str> = known.iter().copied().collect();
    sorted.sort_unstable();
    let mend = match nearest(&area.name, sorted.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None if sorted.is_empty() => "the map gives no area a name".into(),
        None if sorted.len() > LISTED => {
            format!("the map has: {}, ...", sorted[..LISTED].join(", "))
        }
        None => format!("the map has: {}", sorted.join(", ")),
    };
    Problem::error(format!("the map has no area named `{}`", area.name))
        .at(&area.place.source, area.place.span.clone(), "asked for here")
        .mend(mend)
}
