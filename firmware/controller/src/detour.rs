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
//! tell. A detour also ends once there has been nothing on the obstacle's side for a whole turn: the
//! obstacle has gone.
//!
//! Sources: MissionLab's swirl schema; Lumelsky and Stepanov 1987, "Path-planning strategies for a
//! point mobile automaton", and Kamon and Rivlin 1997, DistBug, for the rules of leaving.
//! Memory is one record of fixed size.

use math::{Vec2, scalar, vector};
use plan_format::parameters::Vehicle;
use serde::{Deserialize, Serialize};

use crate::arc::Body;
use crate::drive::circle_m;
use crate::obstacles::Obstacles;

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
    /// Time in which the robot drove, microseconds: the times below are counted by it, so that waiting
    /// for something else does not begin a detour.
    now_us: u64,
    /// The detour under way.
    under_way: Option<UnderWay>,
    /// Side of the last detour that did not help.
    last: Option<Side>,
    /// Detours that did not help since the last progress.
    tried: u8,
}

/// A detour under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct UnderWay {
    side: Side,
    since_us: u64,
    /// Angle that the robot has turned since there was something on the obstacle's side, radians.
    lost_rad: f32,
}

/// The shortest way to a goal so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Best {
    destination_m: [f32; 2],
    /// The layer that says how long the way is.
    layer: Option<u8>,
    way_m: f32,
    time_us: u64,
}

/// What the choice of a tick depends on.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'p> {
    /// Time since the last tick, seconds.
    pub elapsed_s: f32,
    /// Present turn rate, rad/s.
    pub turn_rate_radps: f32,
    /// The destination, map metres; only compared with that of the tick before.
    pub destination: Vec2,
    /// Length of the way to the goal, metres.
    pub way_m: f32,
    /// The layer that was followed; only compared with that of the tick before.
    pub layer: Option<u8>,
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
        // Adding a half rounds to the nearest microsecond.
        self.now_us += (situation.elapsed_s * 1e6 + 0.5) as u64;
        self.advance(situation, is_ahead_open);
        let (chosen, rule) = match self.under_way {
            None if is_ahead_open => return (wanted, Rule::None),
            None => (self.swirl(situation, ahead, is_open), Rule::Swirl),
            Some(detour) => {
                let start = vector::from_angle(-detour.side.sign() * HUG_RAD);
                self.watch(detour, is_open(start), situation);
                let mut around = directions(start, detour.side);
                (around.find(|&direction| is_open(direction)), Rule::Detour)
            }
        };
        // If nothing is open, the brakes decide.
        chosen.map_or((wanted, Rule::None), |direction| (direction * length.min(1.0), rule))
    }

    /// Takes note of progress, and ends a detour that helped or lasted too long.
    fn advance(&mut self, situation: &Situation<'_>, is_ahead_open: bool) {
        let &Situation { destination, layer, way_m, .. } = situation;
        let time_us = self.now_us;
        let fresh = Best { destination_m: destination.into(), layer, way_m, time_us };
        let known = self.best.filter(|best| best.destination_m == fresh.destination_m);
        let Some(known) = known else {
            *self = Self { now_us: time_us, best: Some(fresh), ..Self::default() };
            return;
        };
        // Ways of different layers do not compare.
        let best = if known.layer == layer { known } else { Best { layer, way_m, ..known } };
        self.best = Some(best);
        if way_m < best.way_m - PROGRESS_M {
            let under_way = self.under_way.filter(|_| !is_ahead_open);
            *self = Self { now_us: time_us, best: Some(fresh), under_way, ..Self::default() };
            return;
        }
        let Some(detour) = self.under_way else { return };
        let limit_us = FIRST_DETOUR_US << self.tried.min(MOST_DOUBLINGS);
        if time_us.saturating_sub(detour.since_us) > limit_us {
            self.last = Some(detour.side);
            self.tried = self.tried.saturating_add(1);
            self.end();
        }
    }

    /// Ends a detour whose obstacle has gone: a whole turn has not shown it. The robot turns towards where
    /// it was, as around a corner, and would turn on and on.
    fn watch(&mut self, detour: UnderWay, is_lost: bool, situation: &Situation<'_>) {
        let turned_rad = situation.turn_rate_radps.abs() * situation.elapsed_s;
        let lost_rad = if is_lost { detour.lost_rad + turned_rad } else { 0.0 };
        self.under_way = Some(UnderWay { lost_rad, ..detour });
        if lost_rad > scalar::TAU {
            self.end();
        }
    }

    /// Ends a detour. The next one needs the same patience as the first.
    fn end(&mut self) {
        self.under_way = None;
        self.best = self.best.map(|best| Best { time_us: self.now_us, ..best });
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
        let best_us = self.best.map_or(self.now_us, |best| best.time_us);
        if self.now_us.saturating_sub(best_us) > u64::from(situation.patience_us) {
            let side = self.last.map_or(side, Side::other);
            self.under_way = Some(UnderWay { side, since_us: self.now_us, lost_rad: 0.0 });
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

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::scan::points;
    use plan_format::Parameters;
    use robot_io::RangeReading;
    use std::vec::Vec;

    /// A wall across the way, closer than the body can drive up to.
    const WALL: &[(f32, f32)] = &[(-0.5, 0.45), (0.0, 0.4), (0.5, 0.45)];
    const TICK_S: f32 = 0.05;
    /// The patience of these tests: 20 ticks.
    const PATIENCE_US: u32 = 1_000_000;

    /// The rule and the direction of one tick of a robot that wants to go straight ahead.
    fn tick(
        detours: &mut Detours,
        readings: &[(f32, f32)],
        layer: Option<u8>,
        way_m: f32,
    ) -> (Vec2, Rule) {
        tick_to(detours, readings, layer, way_m, Vec2::new(9.0, 0.0))
    }

    /// The same on the way to another destination.
    fn tick_to(
        detours: &mut Detours,
        readings: &[(f32, f32)],
        layer: Option<u8>,
        way_m: f32,
        destination: Vec2,
    ) -> (Vec2, Rule) {
        let reading = |&(bearing_rad, distance_m)| RangeReading { bearing_rad, distance_m };
        let readings: Vec<RangeReading> = readings.iter().map(reading).collect();
        let near = Obstacles::near(&readings, &points(&readings), 5.0, &[], 0.0);
        let situation = Situation {
            elapsed_s: TICK_S,
            turn_rate_radps: 2.0,
            destination,
            way_m,
            layer,
            vehicle: &Parameters::default().vehicle,
            near: &near,
            patience_us: PATIENCE_US,
        };
        detours.choose(&situation, Vec2::new(1.0, 0.0))
    }

    /// The numbers of the ticks that make a detour, of the first `ticks`.
    fn detour_ticks(ticks: u32, mut at: impl FnMut(u32) -> (Vec2, Rule)) -> Vec<u32> {
        (0..ticks).filter(|&tick| at(tick).1 == Rule::Detour).collect()
    }

    /// A robot that is held up begins a detour after its patience, along the wall.
    #[test]
    fn a_detour_begins_after_the_patience_and_ends_with_progress() {
        let mut detours = Detours::default();
        let held = detour_ticks(40, |_| tick(&mut detours, WALL, None, 5.0));
        assert_eq!(held.first(), Some(&22));
        let (direction, rule) = tick(&mut detours, WALL, None, 4.8);
        assert_eq!(rule, Rule::Detour, "the way is shorter, but closed");
        assert!(direction.x.abs() < 0.5, "along the wall: {direction:?}");
        assert_eq!(tick(&mut detours, &[], None, 4.6).1, Rule::None);
    }

    /// Somebody stood in the way and has gone. The robot turns towards where he was, as it does around a
    /// corner: after a whole turn, of 63 ticks at 2 rad/s, it goes on.
    #[test]
    fn a_detour_ends_once_its_obstacle_has_gone() {
        // An obstacle at its side, whichever that is.
        const BESIDE: &[(f32, f32)] = &[(-1.7, 0.4), (1.7, 0.4)];
        let mut detours = Detours::default();
        detour_ticks(30, |_| tick(&mut detours, WALL, None, 5.0));
        assert_eq!(tick(&mut detours, BESIDE, None, 5.0).1, Rule::Detour);
        let alone = detour_ticks(100, |_| tick(&mut detours, &[], None, 5.0));
        assert_eq!(alone, (0..63).collect::<Vec<_>>());
        // A corner that comes into sight again in time goes on being passed.
        let mut detours = Detours::default();
        detour_ticks(30, |_| tick(&mut detours, WALL, None, 5.0));
        let corner = detour_ticks(100, |at| {
            tick(&mut detours, if at % 30 == 0 { BESIDE } else { &[] }, None, 5.0)
        });
        assert_eq!(corner.len(), 100);
    }

    /// Ways by different layers do not compare: over the shorter one, the robot seemed to have come
    /// close to its goal.
    #[test]
    fn another_layer_begins_a_new_comparison_of_ways() {
        let mut detours = Detours::default();
        let mut way = (0..200).map(|at| {
            (Some(u8::from(at == 10)), if at == 10 { 30.0 } else { 50.0 - 0.2 * at as f32 })
        });
        let mut at = |readings: &[(f32, f32)]| {
            let (layer, way_m) = way.next().expect("there are more");
            tick(&mut detours, readings, layer, way_m).1
        };
        for _ in 0..60 {
            assert_eq!(at(&[]), Rule::None);
        }
        // It has got on until now, so a wall begins no detour at once.
        assert_eq!([at(WALL), at(WALL)], [Rule::Swirl; 2]);
    }

    /// A wall across the way and beside the robot. On the left it reaches farther.
    const NICHE: &[(f32, f32)] =
        &[(-1.7, 0.4), (-0.5, 0.45), (0.0, 0.4), (0.5, 0.45), (0.9, 0.4), (1.7, 0.4)];

    /// Detours take turns: the first one is to the side on which an open direction is nearer, each lasts
    /// twice as long as the one before, up to eight times, and each needs the patience anew. Five that did
    /// not help are enough.
    #[test]
    fn detours_take_turns_and_become_longer() {
        let mut detours = Detours::default();
        let mut legs: Vec<(u32, bool)> = Vec::new();
        let (mut length, mut waited, mut exhausted_at) = (0, Vec::new(), None);
        let (mut waits, mut is_to_the_left) = (0, false);
        for at in 0..5_000_u32 {
            let (direction, rule) = tick(&mut detours, NICHE, None, 5.0);
            if rule == Rule::Detour {
                (length, is_to_the_left) = (length + 1, direction.y > 0.0);
                if waits > 0 {
                    waited.push(waits);
                }
                waits = 0;
            } else {
                assert_eq!(rule, Rule::Swirl);
                assert!(
                    direction.y < 0.0,
                    "the open direction on the right is nearer: {direction:?}"
                );
                if length > 0 {
                    legs.push((length, is_to_the_left));
                }
                (length, waits) = (0, waits + 1);
            }
            if detours.are_exhausted() {
                exhausted_at.get_or_insert(at);
            }
        }
        // Ticks of 50 ms: 10, 20, 40, 80 and 80 s, each after a second.
        let ticks: Vec<u32> = legs.iter().map(|leg| leg.0).collect();
        assert_eq!(ticks[..5], [200, 400, 800, 1_600, 1_600], "{legs:?}");
        assert!(legs.windows(2).all(|pair| pair[0].1 != pair[1].1), "{legs:?}");
        assert!(waited.iter().all(|ticks| (21..=22).contains(ticks)), "{waited:?}");
        assert_eq!(
            exhausted_at,
            Some(ticks[..5].iter().sum::<u32>() + waited[..5].iter().sum::<u32>())
        );
    }

    /// With another destination everything begins anew; a way that is shorter by less than a decimetre is
    /// not progress.
    #[test]
    fn another_destination_begins_anew() {
        let mut detours = Detours::default();
        assert_eq!(detour_ticks(30, |_| tick(&mut detours, NICHE, None, 5.0)).first(), Some(&22));
        let mut elsewhere = |at: u32| {
            tick_to(&mut detours, NICHE, None, 5.0 - 0.002 * at as f32, Vec2::new(9.0, 1.0))
        };
        assert_eq!(detour_ticks(40, &mut elsewhere).first(), Some(&22));
    }
}
