//! Looks up a parallel plan: which layer to follow, and where to go from here.
//!
//! [`advise`] decides which layer of a parallel plan the robot follows and what that layer
//! advises in the robot's cell. The rule is the paper's first one: the most constrained layer
//! that has a route from here. One read of the robot's cell shows whether a layer has a route,
//! so one tick compares all layers.
//!
//! - [`Selection::Static`] chooses once, in the first cell from which any layer has a route, and
//!   never revises the choice. If the robot is pushed to a cell where the chosen layer has no
//!   route, the answer is [`Kind::NoRoute`] and the mission's policy decides. A mission that
//!   wants the next layer instead selects dynamically.
//! - [`Selection::Dynamic`] chooses every tick, and returns to a more constrained layer too.
//! - [`Selection::Gains`] follows the layer with the lowest cost times its gain, the paper's second
//!   rule. [`advise_by_gains`] takes gains that change while the robot drives.
//!
//! In an obstacle of the followed layer the advice is the escape from it. The robot leaves an
//! obstacle of a less constrained layer first, and no escape leads into one.
//!
//! ```
//! use advice::{Advice, Choice, Kind, advise};
//! use plan_format::parameters::Selection;
//! use plan_format::{Blob, Cell};
//! /// Index of the layer to follow in `cell` of the blob's first parallel plan.
//! fn layer(blob: &Blob<'_>, cell: Cell) -> Option<u8> {
//!     let plan = blob.parallel_plan(0)?;
//!     let advice = advise(&plan, Some(cell), Selection::Dynamic, &mut Choice::default());
//!     (advice.kind == Kind::Move).then_some(advice.layer?)
//! }
//! # assert_eq!(layer(&Blob::without_map(Default::default(), None, None), Cell::new(0, 0)), None);
//! ```
//!
//! Invariants: constant time on every map; total: no route, a blocked cell and a position off
//! the map are answers, not errors; an advised step never enters an obstacle of a less
//! constrained layer.
//!
//! Source: W (Wagner and Arkin, "Internalized Plans for Communication-Sensitive Robot Team
//! Behaviors"), sections 2.2 and 2.3; the escapes from blocked cells are an addition.
//!
//! Deliberately absent: searching, smoothing of the eight directions (the blend does that).
#![no_std]

use plan_format::limits::MAX_LAYERS;
use plan_format::parameters::Selection;
use plan_format::{Answer, Cell, Direction, ParallelPlan, Step};
use serde::{Deserialize, Serialize};

/// What a parallel plan advises in one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// Kind of advice.
    pub kind: Kind,
    /// The advised step; `None` unless the kind is [`Kind::Move`] or [`Kind::Escape`].
    pub direction: Option<Direction>,
    /// Index of the layer that gave the advice, 0 for the least constrained; `None` if no layer
    /// gave any.
    pub layer: Option<u8>,
    /// Cost to the goal in units of 1/5741 cell (see [`plan_format::grid::cost_metres`]);
    /// `None` without a route.
    pub cost: Option<u32>,
}

/// A kind of advice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A first step of an optimal route.
    Move,
    /// The robot is in the goal's cell.
    Goal,
    /// A step out of an obstacle.
    Escape,
    /// There is no route from here.
    NoRoute,
    /// The position is outside the map.
    OffMap,
}

/// The layer that a static selection, or one by gains, chose. Part of the controller's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choice(Option<u8>);

impl Choice {
    /// The chosen layer, 0 for the least constrained; `None` before the choice.
    pub fn layer(self) -> Option<u8> {
        self.0
    }
}

impl Advice {
    /// The position is outside the map.
    pub const OFF_MAP: Self = Self::without_route(Kind::OffMap, None);

    const fn without_route(kind: Kind, layer: Option<u8>) -> Self {
        Self { kind, direction: None, layer, cost: None }
    }
}

/// What `plan` advises in `cell` (`None`: off the map).
///
/// Selection by gains uses the gains of the blob; [`advise_by_gains`] takes others. The dynamic
/// selection neither reads nor sets `choice`.
pub fn advise(
    plan: &ParallelPlan<'_>,
    cell: Option<Cell>,
    selection: Selection,
    choice: &mut Choice,
) -> Advice {
    if let Selection::Gains(rule) = selection {
        return advise_by_gains(plan, cell, &rule.of_channels(&[]), rule.hysteresis, choice);
    }
    let Some(cell) = cell else { return Advice::OFF_MAP };
    if let (Selection::Static, Some(layer)) = (selection, choice.0) {
        return followed(plan, cell, layer);
    }
    let Some((layer, advice)) = most_constrained_with_route(plan, cell) else {
        return out_of_the_least_constrained(plan, cell);
    };
    if selection == Selection::Static {
        choice.0 = Some(layer);
    }
    advice
}

/// What `plan` advises in `cell` (`None`: off the map) if a metre of each layer counts as much as its
/// gain, by the layers' ranks: the advice of the layer with the lowest weighted cost, and among
/// equals of the most constrained one.
///
/// The layer of the last tick, in `choice`, is followed until another one is better by the share
/// `hysteresis` of its weighted cost, or until it has no route. Gains are read in every tick, so a
/// change counts in the next one. Source: W, section 5, "cost functions".
pub fn advise_by_gains(
    plan: &ParallelPlan<'_>,
    cell: Option<Cell>,
    gains: &[f32; MAX_LAYERS],
    hysteresis: f32,
    choice: &mut Choice,
) -> Advice {
    let Some(cell) = cell else { return Advice::OFF_MAP };
    let mut best: Option<(f32, Advice)> = None;
    let mut followed: Option<(f32, Advice)> = None;
    for index in layers(plan).rev() {
        let Some(layer) = plan.layer(usize::from(index)) else { continue };
        let Some(advice) = route(layer.look_up(cell), index) else { continue };
        let gain = gains.get(layer.rank()).copied().unwrap_or(1.0);
        let weighted = gain * advice.cost.unwrap_or(0) as f32;
        if best.is_none_or(|(lowest, _)| weighted < lowest) {
            best = Some((weighted, advice));
        }
        if choice.0 == Some(index) {
            followed = Some((weighted, advice));
        }
    }
    let Some((lowest, best)) = best else { return out_of_the_least_constrained(plan, cell) };
    let advice = match followed {
        Some((weighted, followed)) if lowest >= weighted * (1.0 - hysteresis) => followed,
        _ => best,
    };
    choice.0 = advice.layer;
    advice
}

/// The paper's first rule. One read per layer.
fn most_constrained_with_route(plan: &ParallelPlan<'_>, cell: Cell) -> Option<(u8, Advice)> {
    layers(plan).rev().find_map(|layer| Some((layer, route(look_up(plan, layer, cell), layer)?)))
}

/// The advice of the chosen layer.
fn followed(plan: &ParallelPlan<'_>, cell: Cell, layer: u8) -> Advice {
    let answer = look_up(plan, layer, cell);
    match (route(answer, layer), answer) {
        (Some(advice), _) => advice,
        (None, Answer::Blocked { .. }) => out_of(plan, cell, layer),
        (None, Answer::OffMap) => Advice::OFF_MAP,
        (None, _) => Advice::without_route(Kind::NoRoute, Some(layer)),
    }
}

/// The advice in an obstacle of `layer`.
///
/// Layers are nested, so the obstacle of the first layer that blocks the cell matters most. Its
/// escape is the shortest path through blocked cells and may lead into an obstacle of a layer
/// below. In that case the layer just below gives the advice.
fn out_of(plan: &ParallelPlan<'_>, cell: Cell, layer: u8) -> Advice {
    let blocks = |&layer: &u8| is_blocked(plan, layer, cell);
    let first = layers(plan).take_while(|&below| below < layer).find(blocks).unwrap_or(layer);
    let nothing = Advice::without_route(Kind::NoRoute, Some(first));
    let escape = match step(plan, first, cell) {
        Step::Blocked { escape } => escape,
        _ => None,
    };
    let Some(below) = first.checked_sub(1) else {
        return escape.map_or(nothing, |direction| escaping(direction, first));
    };
    match escape {
        Some(direction) if !step_is_blocked(plan, below, cell, direction) => {
            escaping(direction, first)
        }
        _ => route(look_up(plan, below, cell), below).unwrap_or(nothing),
    }
}

/// The advice if no layer has a route. Only the least constrained layer's escape counts: a cell
/// that is free in that layer but has no route is walled in.
fn out_of_the_least_constrained(plan: &ParallelPlan<'_>, cell: Cell) -> Advice {
    match step(plan, 0, cell) {
        Step::Blocked { escape: Some(direction) } => escaping(direction, 0),
        Step::OffMap => Advice::OFF_MAP,
        _ => Advice::without_route(Kind::NoRoute, None),
    }
}

fn step_is_blocked(plan: &ParallelPlan<'_>, layer: u8, cell: Cell, direction: Direction) -> bool {
    // A step off the map has no target cell, or one that the layer answers as off the map.
    let target = cell.neighbour(direction, u32::MAX, u32::MAX);
    target.is_some_and(|target| is_blocked(plan, layer, target))
}

fn is_blocked(plan: &ParallelPlan<'_>, layer: u8, cell: Cell) -> bool {
    matches!(step(plan, layer, cell), Step::Blocked { .. })
}

fn route(answer: Answer, layer: u8) -> Option<Advice> {
    let (kind, direction, cost) = match answer {
        Answer::Move { direction, cost } => (Kind::Move, Some(direction), cost),
        Answer::Goal => (Kind::Goal, None, 0),
        _ => return None,
    };
    Some(Advice { kind, direction, layer: Some(layer), cost: Some(cost) })
}

fn escaping(direction: Direction, layer: u8) -> Advice {
    Advice { kind: Kind::Escape, direction: Some(direction), layer: Some(layer), cost: None }
}

fn look_up(plan: &ParallelPlan<'_>, layer: u8, cell: Cell) -> Answer {
    plan.layer(usize::from(layer)).map_or(Answer::OffMap, |layer| layer.look_up(cell))
}

/// As [`look_up`], without the cost.
fn step(plan: &ParallelPlan<'_>, layer: u8, cell: Cell) -> Step {
    plan.layer(usize::from(layer)).map_or(Step::OffMap, |layer| layer.step(cell))
}

/// Indices of the layers, least constrained first.
fn layers(plan: &ParallelPlan<'_>) -> core::ops::Range<u8> {
    // The format allows far fewer than 256 layers.
    0..plan.layer_count() as u8
}
