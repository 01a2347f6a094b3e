//! The goals: which there are, their cells, and the layers of each.

use super::candidate::{Candidate, PlacedLayer, with_place};
use super::nearest_free::nearest_free;
use super::{MAX_SUGGESTIONS, globe, members};
use crate::goals::name_of;
use crate::input::Input;
use crate::layers::Layer;
use crate::mission::{Goal, GoalAt, tidy_name};
use crate::pack::Numbered;
use maps::Point;
use maps::names::nearest;
use maps::numbers::pair;
use maps::problem::{Place, Problem, has_errors};
use plan_format::{Grid, limits};
use std::collections::{BTreeMap, HashSet};

/// A goal on the grid.
pub(super) struct Placed {
    pub(super) name: String,
    /// Metres; several for a plan that leads to the cheapest of them.
    pub(super) at: Vec<Point>,
    pub(super) layers: Vec<PlacedLayer>,
}

/// All goals that can be planned for, in order: at least one, unless there is an error.
pub(super) fn place(
    input: &Input<'_>,
    grid: &Grid,
    layers: &[Layer],
    problems: &mut Vec<Problem>,
) -> Vec<Placed> {
    let asked = asked(input);
    let candidates = if asked.is_empty() {
        points_of_map(input, problems)
    } else {
        let points = points_by_name(input);
        asked.iter().filter_map(|goal| candidate(input, &points, goal, problems)).collect()
    };
    let placed =
        candidates.iter().filter_map(|goal| place_one(input, goal, grid, layers, problems));
    let mut placed: Vec<Placed> = placed.collect();
    if placed.len() > limits::MAX_PLANS {
        problems.push(beyond_capacity(placed.len(), !asked.is_empty()));
        placed.truncate(limits::MAX_PLANS);
    }
    if placed.is_empty() && asked.is_empty() && !has_errors(problems) {
        placed.extend(home(input, grid, layers, problems));
    }
    placed
}

/// Reports duplicate goal names. Needs no grid, so it is reported whatever else is wrong.
pub(super) fn check_names(input: &Input<'_>, problems: &mut Vec<Problem>) {
    let mut seen = HashSet::new();
    for goal in asked(input) {
        if !seen.insert(&goal.name) {
            let message = format!("goal `{}` is named twice", goal.name);
            problems.push(
                with_place(Problem::error(message), goal.place.as_ref(), "the second time")
                    .help("give each goal a name of its own"),
            );
        }
    }
}

/// Index of the plan that the robot follows.
pub(super) fn followed(input: &Input<'_>, goals: &[Placed], problems: &mut Vec<Problem>) -> u16 {
    let (wanted, place) = match (&input.options.plan, &input.mission.plan) {
        (Some(name), _) => (name, None),
        (None, Some(named)) => (&named.name, Some(&named.place)),
        (None, None) => return 0,
    };
    if let Some(index) = goals.iter().position(|goal| goal.name == *wanted) {
        return index as u16;
    }
    let asked = asked(input).iter().map(|goal| goal.name.as_str());
    // Those of the map, if no goal was asked for.
    let mut names: Vec<&str> = asked.collect();
    if names.is_empty() {
        names = goals.iter().map(|goal| goal.name.as_str()).collect();
    }
    if names.is_empty() || names.contains(&wanted.as_str()) {
        // The reason for having no such goal has been reported.
        return 0;
    }
    problems.push(if place.is_some() && !input.options.goals.is_empty() {
        let first = goals.first().map(|goal| goal.name.as_str()).unwrap_or_default();
        let message = format!(
            "--goal replaces the mission's goals, and with them the plan `{wanted}` to follow; \
             the robot follows `{first}`"
        );
        with_place(Problem::warning(message), place, "asked for here")
    } else {
        let help = match nearest(wanted, names.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("the plans are: {}", names.join(", ")),
        };
        let error = Problem::error(format!("there is no plan `{wanted}` to follow"));
        with_place(error, place, "asked for here").help(help)
    });
    0
}

/// The goals of the command line; without any, those of the mission.
fn asked<'a>(input: &Input<'a>) -> &'a [Goal] {
    if input.options.goals.is_empty() {
        input.mission.goals.as_deref().unwrap_or_default()
    } else {
        &input.options.goals
    }
}

/// The positions of the map's points by name; the first of equal names counts.
fn points_by_name(input: &Input<'_>) -> BTreeMap<String, Point> {
    let mut points = BTreeMap::new();
    for point in input.map.points.iter().chain(&input.map.start) {
        points.entry(point.name.clone()).or_insert(point.at);
    }
    points
}

/// The positions of places that are given like goals; a name is that of a goal or of a point of the
/// map.
pub(super) fn places(
    input: &Input<'_>,
    places: &[Goal],
    problems: &mut Vec<Problem>,
) -> Vec<(String, Point)> {
    let mut points = points_by_name(input);
    for goal in asked(input) {
        // Mistakes in goals are reported where goals are placed.
        let at = positions(input, &points, goal, "this goal", &mut Vec::new());
        for (index, at) in at.iter().flatten().enumerate() {
            points.insert(name_of(&goal.name, index, goal.at.len()), *at);
        }
    }
    let place = |place: &Goal| {
        let at = positions(input, &points, place, "this place", problems)?;
        Some((place.name.clone(), *at.first()?))
    };
    places.iter().filter_map(place).collect()
}

/// Where a goal is, or each of several; `None` after an error.
fn positions(
    input: &Input<'_>,
    points: &BTreeMap<String, Point>,
    goal: &Goal,
    label: &str,
    problems: &mut Vec<Problem>,
) -> Option<Vec<Point>> {
    let all: Vec<Option<Point>> = (0..)
        .zip(&goal.at)
        .map(|(index, at)| {
            let name = name_of(&goal.name, index, goal.at.len());
            position(input, points, (&name, at, goal.place.as_ref()), label, problems)
        })
        .collect();
    all.into_iter().collect()
}

/// Where one goal is, from its name, how its position was given, and its place in the mission; `None`
/// after an error.
fn position(
    input: &Input<'_>,
    points: &BTreeMap<String, Point>,
    (name, at, place): (&str, &GoalAt, Option<&Place>),
    label: &str,
    problems: &mut Vec<Problem>,
) -> Option<Point> {
    match at {
        GoalAt::Position(at) => Some(*at),
        GoalAt::Globe(globe) => match globe::position(input, name, *globe) {
            Ok(at) => Some(at),
            Err(problem) => {
                problems.push(with_place(problem, place, label));
                None
            }
        },
        GoalAt::PointOfMap(point) => {
            if let Some(at) = points.get(point.as_str()) {
                return Some(*at);
            }
            let message = format!("the map has no point named `{point}`");
            let error = with_place(Problem::error(message), place, label);
            let meant = || nearest(point, points.keys().map(String::as_str));
            let meant = if problems.len() < MAX_SUGGESTIONS { meant() } else { None };
            problems.push(match meant {
                Some(meant) => error.help(format!("did you mean `{meant}`?")),
                None => error.help(format!("give a position: {name} = [x, y]")),
            });
            None
        }
    }
}

fn candidate<'a>(
    input: &Input<'_>,
    points: &BTreeMap<String, Point>,
    goal: &'a Goal,
    problems: &mut Vec<Problem>,
) -> Option<Candidate<'a>> {
    let at = positions(input, points, goal, "this goal", problems)?;
    let (name, layers) = (goal.name.clone(), goal.layers.as_deref());
    Some(Candidate { name, at, layers, place: goal.place.clone(), asked: true })
}

/// The map's named points, without duplicates and impossible names.
fn points_of_map<'a>(input: &Input<'a>, problems: &mut Vec<Problem>) -> Vec<Candidate<'a>> {
    let mut seen = HashSet::new();
    let mut candidates = Vec::new();
    for point in &input.map.points {
        let place = input.source.map(|source| Place {
            source: source.clone(),
            span: point.span.clone(),
            label: String::new(),
        });
        let mut candidate = Candidate {
            name: point.name.clone(),
            at: vec![point.at],
            layers: None,
            place,
            asked: false,
        };
        match tidy_name(&point.name) {
            Err(reason) => {
                let message = format!("point `{}` cannot name a plan", point.name);
                problems.push(candidate.problem(message, &reason));
            }
            Ok(name) if !seen.insert(name) => {
                let message = format!("point `{name}` is in the map twice");
                problems.push(candidate.problem(message, "the second time"));
            }
            Ok(name) => {
                candidate.name = name.to_owned();
                candidates.push(candidate);
            }
        }
    }
    candidates
}

fn place_one(
    input: &Input<'_>,
    goal: &Candidate<'_>,
    grid: &Grid,
    layers: &[Layer],
    problems: &mut Vec<Problem>,
) -> Option<Placed> {
    let free = members::free(input, goal, grid, &layers.first()?.terrain.blocked, problems)?;
    let layers = own_layers(goal, &free, layers, problems)?;
    Some(Placed { name: goal.name.clone(), at: goal.at.clone(), layers })
}

/// The layers of one goal: those that it names; without names, all in which it is free, or one of
/// several is.
fn own_layers(
    goal: &Candidate<'_>,
    free: &[Numbered],
    layers: &[Layer],
    problems: &mut Vec<Problem>,
) -> Option<Vec<PlacedLayer>> {
    let placed = |rank: usize| {
        let terrain = &layers[rank].terrain;
        let goals = free.iter().copied().filter(|&(_, cell)| terrain.is_free(cell)).collect();
        PlacedLayer { rank: rank as u8, goals }
    };
    let Some(wanted) = goal.layers else {
        let all = (0..layers.len()).map(placed);
        let (own, inside): (Vec<_>, Vec<_>) = all.partition(|layer| !layer.goals.is_empty());
        if !inside.is_empty() {
            let names = inside.iter().map(|layer| layers[usize::from(layer.rank)].name.as_str());
            let names = names.collect::<Vec<_>>().join("`, `");
            let is = members::is_of(goal);
            let message = format!(
                "goal `{}` {is} inside an area that layer `{names}` avoids; its plan has no such layer",
                goal.name
            );
            problems.push(with_place(Problem::warning(message), goal.place.as_ref(), "this goal"));
        }
        problems.extend(members::left_out_of_layers(goal, free, &own, layers));
        return Some(own);
    };
    let mut ranks = Vec::new();
    for layer in wanted {
        let error = |message: String, help: String| {
            with_place(Problem::error(message), Some(&layer.place), "asked for here").help(help)
        };
        match layers.iter().position(|known| known.name == layer.name) {
            None => {
                let names = layers.iter().map(|known| known.name.as_str()).collect::<Vec<_>>();
                let message = format!("there is no layer `{}`", layer.name);
                problems.push(error(message, format!("the layers are: {}", names.join(", "))));
            }
            Some(rank) if placed(rank).goals.is_empty() => {
                let (name, is, layer) = (&goal.name, members::is_of(goal), &layer.name);
                let message =
                    format!("goal `{name}` {is} inside an area that layer `{layer}` avoids");
                let help = "move the goal, or leave the layer out of its `layers`";
                problems.push(error(message, help.into()));
            }
            Some(rank) => ranks.push(rank),
        }
    }
    ranks.sort_unstable();
    ranks.dedup();
    if ranks.is_empty() && wanted.is_empty() {
        let message = format!("goal `{}` has an empty list of layers", goal.name);
        problems.push(
            goal.problem(message, "this goal").help("name a layer, or leave `layers` out for all"),
        );
    }
    let own: Vec<PlacedLayer> = ranks.into_iter().map(placed).collect();
    problems.extend(members::left_out_of_layers(goal, free, &own, layers));
    (!own.is_empty()).then_some(own)
}

/// The plan `home` of a map without goals: it leads to the robots' start.
fn home(
    input: &Input<'_>,
    grid: &Grid,
    layers: &[Layer],
    problems: &mut Vec<Problem>,
) -> Option<Placed> {
    let Some(start) = &input.map.start else {
        problems.push(
            Problem::error("there is no goal, and the map does not say where robots start")
                .help("give one: --goal NAME=X,Y in the map's metres, x east, y north"),
        );
        return None;
    };
    let cell = nearest_free(grid, &layers.first()?.terrain.blocked, start.at)?;
    let stays = grid.cell_at(start.at[0], start.at[1]) == Some(cell);
    let at = if stays { start.at } else { grid.centre(cell) };
    let moved = if stays { "" } else { ", the nearest free cell to it" };
    let message =
        format!("there is no goal; plan `home` leads to where robots start, {}{moved}", pair(at));
    problems.push(Problem::note(message).help("give goals of your own: --goal NAME=X,Y"));
    let free = (0..).zip(layers).filter(|(_, layer)| layer.terrain.is_free(cell));
    let free = free.map(|(rank, _)| PlacedLayer { rank, goals: vec![(0, cell)] }).collect();
    Some(Placed { name: "home".into(), at: vec![at], layers: free })
}

fn beyond_capacity(goals: usize, asked: bool) -> Problem {
    let limit = limits::MAX_PLANS;
    if asked {
        Problem::error(format!("{goals} goals, but a blob holds {limit} plans"))
            .help("build several blobs, or name fewer goals")
    } else {
        let message = format!(
            "the map names {goals} goals, but a blob holds {limit} plans; the last {} are left out",
            goals - limit
        );
        Problem::warning(message).help("name the goals you need: --goal NAME=X,Y")
    }
}
