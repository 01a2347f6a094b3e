//! When a robot's run ends, how, and what came of it.

use crate::{Point, Surroundings};
use robot_io::Reason;

/// When a run ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Longer runs are given up, seconds.
    pub time_s: f64,
    /// Where the robot shall arrive, metres.
    pub goal: Point,
    /// The robot says that it has arrived, and truly is within this distance, metres.
    pub goal_tolerance_m: f64,
    /// The robot is trapped when it stays this long ...
    pub trapped_after_s: f64,
    /// ... within this distance of one spot, metres.
    pub trapped_within_m: f64,
    /// Whether arriving at the goal ends the run. Where behaviours decide, a goal is one stop
    /// of several, and work that is to be done ends it instead.
    pub ends_at_goal: bool,
    /// A robot that stands still off the map or without a route for so long will not go on,
    /// seconds.
    pub stranded_after_s: f64,
    /// Behaviours that have worked and then have nothing to do for so long are done where the
    /// world names no work, seconds.
    pub idle_after_s: f64,
}

impl Limits {
    /// Usual limits for a map of a few hundred metres.
    pub fn to_goal(goal: Point) -> Self {
        Self {
            time_s: 900.0,
            goal,
            goal_tolerance_m: 1.5,
            trapped_after_s: 60.0,
            trapped_within_m: 5.0,
            ends_at_goal: true,
            stranded_after_s: 10.0,
            idle_after_s: 60.0,
        }
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Ending {
    /// The robot is at the goal and knows it.
    Reached,
    /// All work is done, and the robot has nothing left to do.
    Done,
    /// It stayed at one spot for too long.
    Trapped,
    /// It stands still outside the map.
    OffMap,
    /// It stands still where no layer has a route.
    NoRoute,
    /// It went on for too long.
    OutOfTime,
}

impl Ending {
    /// Its name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Done => "done",
            Self::Trapped => "trapped",
            Self::OffMap => "off-map",
            Self::NoRoute => "no-route",
            Self::OutOfTime => "out-of-time",
        }
    }
}

/// What came of a robot's run, up to its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// How it ended; `None` while it is under way.
    pub ending: Option<Ending>,
    /// Ticks so far.
    pub ticks: u64,
    /// Simulated time so far, seconds.
    pub time_s: f64,
    /// Length of the way, metres.
    pub distance_m: f64,
    /// How far it has turned in all, either way, radians.
    pub turn_rad: f64,
    /// Smallest gap between body and obstacle, metres; infinite if none came near.
    pub closest_m: f64,
    /// How often contact with an obstacle began.
    pub touches: u32,
    /// Where the robot was, a point for every half metre.
    pub route: Vec<Point>,
    /// How many ticks gave which reason, in the order of their first appearance.
    pub reasons: Vec<(Reason, u64)>,
    /// The trace hash after the last tick.
    pub trace_hash: u64,
    /// The most instructions that one tick took, where that can be counted.
    pub most_instructions: u32,
    /// What the robot's work has made of its surroundings, where there are any.
    pub surroundings: Option<Surroundings>,
}

impl Outcome {
    /// Whether the robot has arrived, or has done its work.
    pub fn reached(&self) -> bool {
        matches!(self.ending, Some(Ending::Reached | Ending::Done))
    }

    /// Number of ticks that gave a reason.
    pub fn ticks_of(&self, reason: Reason) -> u64 {
        self.reasons.iter().find(|(seen, _)| *seen == reason).map_or(0, |&(_, ticks)| ticks)
    }
}
