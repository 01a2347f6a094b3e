//! Leaves dead ends that the map does not show.
//!
//! With the map, the advice leads around every dead end. An obstacle that is not on the map closes
//! the way instead, and attraction pushes the robot against it. Three rules lead out; a trace shows
//! which one acts as [`Rule`]:
//!
//! | rule | when | direction |
//! |---|---|---|
//! | [`Rule::None`] | the wanted direction is open | the wanted one |
//! | [`Rule::Swirl`] | it is closed | the open direction next to it |
//! | [`Rule::Detour`] | it was closed, and there was no progress for a time | along the obstacle, which stays on one side |
//!
//! A direction is open if the body can drive its own radius in it, and in a detour also the radius of
//! the vehicle's tightest circle. Progress is a way to the goal that is shorter than ever before. It
//! ends a detour as soon as the wanted direction is open. A detour without progress ends after a time;
//! the next one takes the other side and lasts twice as long, up to eight times the first. If the
//! longest ones to either side did not help, the obstacle closes the way, as far as the robot can
//! tell.
//!
//! Sources: MissionLab's swirl schema; Lumelsky and Stepanov 1987, "Path-planning strategies for a
//! point mobile automaton", and Kamon and Rivlin 1997, DistBug, for the rules of leaving.
//! Memory is one record of fixed size.

use math::{Vec2, scalar, vector};
use plan_format::parameters::Vehicle;
use serde::{Deserialize, Serialize};

use crate::drive::circle_m;
use crate::obstacles::{Body, Obstacles};

/// Directions that are tried around the robot.
const DIRECTIONS: usize = 24;
/// Least distance from what the body passes, metres.
const ASIDE_M: f32 = 0.015;
/// Progress is a way shorter by this, metres.
const PROGRESS_M: f32 = 0.1;
/// A detour tries directions from this far on the obstacle's side on, radians from straight ahead.
const HUG_RAD: f32 = 1.7;
/// Time of the first detour, microseconds.
const FIRST_DETOUR_US: u64 = 10_000_000;
/// The time of detours doubles this often at most.
const MOST_DOUBLINGS: u8 = 3;

/// The rule that chose the direction of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Rule {
    /// The blended vector, unchanged.
    #[default]
    None,
    /// The open direction next to the blended vector.
    Swirl,
    /// Along an obstacle on the right or on the left.
    Detour,
    /// Astern, to turn where there is no room to turn ahead ([`crate::back_out`]).
    BackOut,
}

/// The side to which the robot turns away from an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Side {
    Left,
    Right,
}

impl Side {
    const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    const fn sign(self) -> f32 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Progress towards one goal, and the detours that were tried. Part of the controller's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detours {
    /// The shortest way to the goal so far, and when; `None` before the first tick.
    best: Option<Best>,
    /// The detour under way: its side and when it began.
    under_way: Option<(Side, u64)>,
    /// Side of the last detour that did not help.
    last: Option<Side>,
    /// Detours that did not help since the last progress.
    tried: u8,
}

/// The shortest way to a goal so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Best {
    destination_m: [f32; 2],
    way_m: f32,
    time_us: u64,
}

/// What the choice of a tick depends on.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'p> {
    /// Time that never goes back, microseconds.
    pub time_us: u64,
    /// The destination, map metres; only compared with that of the tick before.
    pub destination: Vec2,
    /// Length of the way to the goal, metres.
    pub way_m: f32,
    /// The vehicle.
    pub vehicle: &'p Vehicle,
    /// What is near.
    pub near: &'p Obstacles,
    /// Begin a detour after this time without progress, microseconds.
    pub patience_us: u32,
}

impl Detours {
    /// Whether the longest detours to either side did not help.
    pub const fn are_exhausted(&self) -> bool {
        self.tried >= MOST_DOUBLINGS + 2
    }

    /// The direction to drive and the rule that chose it. `wanted` is the blended vector; both are
    /// in the robot's axes, and the result has the length of `wanted`, at most 1 if it is turned.
    pub fn choose(&mut self, situation: &Situation<'_>, wanted: Vec2) -> (Vec2, Rule) {
        let length = vector::length(wanted);
        if length == 0.0 {
            return (wanted, Rule::None);
        }
        let vehicle = situation.vehicle;
        let body = Body { radius_m: vehicle.radius_m, aside_m: ASIDE_M };
        // A vehicle that needs a circle comes this much closer to an obstacle while it turns along it.
        let circle_m = if self.under_way.is_some() { circle_m(vehicle) } else { 0.0 };
        let length_m = vehicle.radius_m + circle_m;
        let openings = situation.near.openings(&body, length_m);
        let is_open = |direction: Vec2| openings.contain(direction);
        let ahead = wanted / length;
        let is_ahead_open = is_open(ahead);
        self.advance(situation, is_ahead_open);
        let (chosen, rule) = match self.under_way {
            None if is_ahead_open => return (wanted, Rule::None),
            None => (self.swirl(situation, ahead, is_open), Rule::Swirl),
            Some((side, _)) => {
                let start = vector::from_angle(-side.sign() * HUG_RAD);
                let mut around = directions(start, side);
                (around.find(|&direction| is_open(direction)), Rule::Detour)
            }
        };
        // If nothing is open, the brakes decide.
        chosen.map_or((wanted, Rule::None), |direction| (direction * length.min(1.0), rule))
    }

    /// Takes note of progress, and ends a detour that helped or lasted too long.
    fn advance(&mut self, situation: &Situation<'_>, is_ahead_open: bool) {
        let &Situation { time_us, destination, way_m, .. } = situation;
        let fresh = Best { destination_m: destination.into(), way_m, time_us };
        let best = match self.best {
            Some(best) if best.destination_m == fresh.destination_m => best,
            _ => {
                *self = Self { best: Some(fresh), ..Self::default() };
                return;
            }
        };
        if way_m < best.way_m - PROGRESS_M {
            let under_way = self.under_way.filter(|_| !is_ahead_open);
            *self = Self { best: Some(fresh), under_way, ..Self::default() };
            return;
        }
        let Some((side, since_us)) = self.under_way else { return };
        let limit_us = FIRST_DETOUR_US << self.tried.min(MOST_DOUBLINGS);
        if time_us.saturating_sub(since_us) > limit_us {
            self.under_way = None;
            self.last = Some(side);
            self.tried = self.tried.saturating_add(1);
            // The next detour needs the same patience as the first.
            self.best = Some(Best { time_us, ..best });
        }
    }

    /// The open direction nearest to `ahead`, on either side. Begins a detour if there was no
    /// progress for too long.
    fn swirl(
        &mut self,
        situation: &Situation<'_>,
        ahead: Vec2,
        is_open: impl Fn(Vec2) -> bool,
    ) -> Option<Vec2> {
        let both = directions(ahead, Side::Left).zip(directions(ahead, Side::Right));
        let mut found = both.take(DIRECTIONS / 2 + 1).filter_map(|(left, right)| {
            match [is_open(left), is_open(right)] {
                // Of two that are equally near, the one that is nearer to the robot's heading.
                [true, true] if left.x >= right.x => Some((left, Side::Left)),
                [true, false] => Some((left, Side::Left)),
                [_, true] => Some((right, Side::Right)),
                [false, false] => None,
            }
        });
        let (direction, side) = found.next()?;
        let best_us = self.best.map_or(situation.time_us, |best| best.time_us);
        if situation.time_us.saturating_sub(best_us) > u64::from(situation.patience_us) {
            let side = self.last.map_or(side, Side::other);
            self.under_way = Some((side, situation.time_us));
        }
        Some(direction)
    }
}

/// All directions around the robot, from `start` on towards a side.
fn directions(start: Vec2, side: Side) -> impl Iterator<Item = Vec2> {
    const STEP_RAD: f32 = scalar::TAU / DIRECTIONS as f32;
    let step = vector::from_angle(side.sign() * STEP_RAD);
    let mut next = start;
    core::iter::repeat_with(move || {
        let direction = next;
        next = Vec2::new(
            direction.x * step.x - direction.y * step.y,
            direction.x * step.y + direction.y * step.x,
        );
        direction
    })
    .take(DIRECTIONS)
}
