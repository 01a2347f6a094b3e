//! Where to from here? The look-up of a parallel plan, and the choice of its layer.
//!
//! [`advise`] decides which layer of a parallel plan is followed and what it advises in the
//! robot's cell. The rule is the paper's first one: the most constrained layer that has a
//! route from here. Whether a layer has a route is one read of the robot's own cell, so all
//! layers are compared within one tick.
//!
//! - [`Selection::Static`] chooses once, in the first cell from which any layer has a route.
//!   A choice is never revised. Where the chosen layer later has no route, because the robot
//!   was pushed there, the answer is [`Kind::NoRoute`] and the mission's policy decides; a
//!   mission that wants the next layer instead asks for the dynamic selection.
//! - [`Selection::Dynamic`] chooses every tick, back to a more constrained layer too.
//!
//! In an obstacle of the followed layer the advice is the way out of it. An obstacle of a
//! less constrained layer is left first, and no way out leads into one.
//!
//! Invariants: constant time, whatever the map; total: no route, a blocked cell and a
//! position off the map are answers, not errors; an advised step never enters an obstacle of
//! a less constrained layer.
//!
//! Source: W (Wagner and Arkin, "Internalized Plans for Communication-Sensitive Robot Team
//! Behaviors"), sections 2.2 and 2.3; escapes from blocked cells are our own addition.
//!
//! Deliberately absent: searching, smoothing of the eight directions (the blend does that),
//! selection by gains.
#![no_std]

use plan_format::parameters::Selection;
use plan_format::{Answer, Cell, Direction, ParallelPlan, Step};
use serde::{Deserialize, Serialize};

/// What a parallel plan advises in one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// What kind of advice it is.
    pub kind: Kind,
    /// The advised step; `None` unless the kind is [`Kind::Move`] or [`Kind::Escape`].
    pub direction: Option<Direction>,
    /// Index of the layer that gave the advice, 0 for the least constrained; `None` where no
    /// layer was asked or none has anything to say.
    pub layer: Option<u8>,
    /// Cost to the goal in units of 1/5741 cell (see [`plan_format::grid::cost_metres`]);
    /// `None` where no route is known.
    pub cost: Option<u32>,
}

/// The kinds of advice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A first step of an optimal route.
    Move,
    /// This is the goal's cell.
    Goal,
    /// A step out of an obstacle.
    Escape,
    /// There is no route from here.
    NoRoute,
    /// The position is outside the map.
    OffMap,
}

/// The layer that a static selection has settled on. Part of the controller's state.
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
/// `choice` is read and set by the static selection only.
pub fn advise(
    plan: &ParallelPlan<'_>,
    cell: Option<Cell>,
    selection: Selection,
    choice: &mut Choice,
) -> Advice {
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

/// The paper's first rule. One read for each layer.
fn most_constrained_with_route(plan: &ParallelPlan<'_>, cell: Cell) -> Option<(u8, Advice)> {
    layers(plan).rev().find_map(|layer| Some((layer, route(look_up(plan, layer, cell), layer)?)))
}

/// The advice of the one layer that was chosen.
fn followed(plan: &ParallelPlan<'_>, cell: Cell, layer: u8) -> Advice {
    let answer = look_up(plan, layer, cell);
    match (route(answer, layer), answer) {
        (Some(advice), _) => advice,
        (None, Answer::Blocked { .. }) => out_of(plan, cell, layer),
        (None, Answer::OffMap) => Advice::OFF_MAP,
        (None, _) => Advice::without_route(Kind::NoRoute, Some(layer)),
    }
}

/// The way out of an obstacle of `layer`.
///
/// Layers are nested, so the first one that blocks the cell holds the obstacle that matters
/// most. Its way out is the shortest through blocked cells and may pass through obstacles of
/// the layers below, in which the robot is not: then the layer just below is followed instead.
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

/// The advice where no layer has a route. Only the least constrained layer's way out counts:
/// a cell that is free in it and has no route is walled in.
fn out_of_the_least_constrained(plan: &ParallelPlan<'_>, cell: Cell) -> Advice {
    match step(plan, 0, cell) {
        Step::Blocked { escape: Some(direction) } => escaping(direction, 0),
        Step::OffMap => Advice::OFF_MAP,
        _ => Advice::without_route(Kind::NoRoute, None),
    }
}

fn step_is_blocked(plan: &ParallelPlan<'_>, layer: u8, cell: Cell, direction: Direction) -> bool {
    // A step off the map either has no target or one that is answered as off the map.
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

/// As [`look_up`], where the cost is not needed.
fn step(plan: &ParallelPlan<'_>, layer: u8, cell: Cell) -> Step {
    plan.layer(usize::from(layer)).map_or(Step::OffMap, |layer| layer.step(cell))
}

/// Indices of the layers, the least constrained first.
fn layers(plan: &ParallelPlan<'_>) -> core::ops::Range<u8> {
    // The format allows far fewer than 256 layers.
    0..plan.layer_count() as u8
}
