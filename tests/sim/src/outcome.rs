//! When and how a robot's run ends, and its result.

use crate::{Point, Surroundings};
use robot_io::Reason;

/// The conditions that end a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Time limit, seconds.
    pub time_s: f64,
    /// Position of the goal, metres. Of several, the robot reports the one that it reaches.
    pub goal: Point,
    /// Largest true distance from the goal at which a reported arrival counts, metres.
    pub goal_tolerance_m: f64,
    /// A robot that stays this long within `trapped_within_m` of one point is trapped, seconds.
    pub trapped_after_s: f64,
    /// Radius of the area that a trapped robot does not leave, metres.
    pub trapped_within_m: f64,
    /// Whether arriving at the goal ends the run. A mission of behaviours may visit several goals;
    /// its run ends when its work is done.
    pub ends_at_goal: bool,
    /// A robot that stands still off the map or without a route for this long ends its run,
    /// seconds.
    pub stranded_after_s: f64,
    /// In a world that names no work, behaviours that worked and then stay idle for this long are
    /// done, seconds.
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
    /// The robot is at the goal and reports it.
    Reached,
    /// All work is done, and the robot has nothing left to do.
    Done,
    /// The robot stayed near one point for too long.
    Trapped,
    /// The robot stands still outside the map.
    OffMap,
    /// The robot stands still where no layer has a route.
    NoRoute,
    /// The time limit was reached.
    OutOfTime,
}

impl Ending {
    /// Its name in machine-readable output.
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

/// The result of a robot's run so far, or at its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// How the run ended; `None` while it is under way.
    pub ending: Option<Ending>,
    /// Ticks so far.
    pub ticks: u64,
    /// Simulated time so far, seconds.
    pub time_s: f64,
    /// Distance driven, metres.
    pub distance_m: f64,
    /// Sum of all turns to either side, radians.
    pub turn_rad: f64,
    /// Smallest gap between the body and an obstacle, another body or a disc, metres; infinite if
    /// none came within 10 m.
    pub closest_m: f64,
    /// How often the robot began to touch an obstacle, another body or a disc by its own motion.
    pub touches: u32,
    /// How often another body or a disc ran into the robot, which stood, moved away from it or could
    /// not have seen it in time to stop.
    pub strikes: u32,
    /// The route, a point for every half metre.
    pub route: Vec<Point>,
    /// Number of ticks per reason, in the order of first appearance.
    pub reasons: Vec<(Reason, u64)>,
    /// Of a plan with several goals, the number of the one that the robot approached or reached last.
    pub goal: Option<u8>,
    /// The trace hash after the last tick.
    pub trace_hash: u64,
    /// Most instructions in one tick; 0 where they are not counted.
    pub most_instructions: u32,
    /// The surroundings as the robot's work has left them, if the scenario has any.
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
