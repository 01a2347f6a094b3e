//! What the robot is to do in one tick, and why.

use serde::{Deserialize, Serialize};

/// The result of one tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Commands {
    /// Speed ahead, m/s.
    pub speed_mps: f32,
    /// Turn rate, rad/s counter-clockwise.
    pub turn_rate_radps: f32,
    /// Digital outputs, one bit each.
    pub outputs: u16,
    /// Code of a mission's `signal` action, for telemetry; 0 for none.
    pub signal: u16,
    /// Why the robot does this.
    pub reason: Reason,
}

impl Commands {
    /// Commands that stand still, for this reason.
    pub const fn stop(reason: Reason) -> Self {
        Self { speed_mps: 0.0, turn_rate_radps: 0.0, outputs: 0, signal: 0, reason }
    }
}

/// Why the robot does what it does. The codes are part of the wire format: append new ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Reason {
    /// It drives by plan and schemas.
    Driving,
    /// It has reached the goal.
    AtGoal,
    /// It is in a blocked cell and follows the escape out of it.
    Escaping,
    /// There is no map: it drives by reactive schemas only, or stands still if it has no goal
    /// either.
    NoPlan,
    /// No layer has a route from here.
    NoRoute,
    /// The position is outside the map, or every way that is left leads off it.
    OffMap,
    /// No fix has arrived yet, and no sign that the receiver sent one.
    NoFix,
    /// The last usable fix is too old.
    StaleFix,
    /// The receiver reports its fix as not valid, or the fix is not accurate enough.
    PoorFix,
    /// The fix implies an impossible jump.
    JumpedFix,
    /// The fix is too far from the map's reference.
    DistantFix,
    /// The heading is not known yet: the robot creeps ahead or waits.
    NoHeading,
    /// An obstacle is inside the stop distance, in the direction of travel.
    ObstacleStop,
    /// The operator has not armed the robot.
    Disarmed,
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The operator drives by hand.
    Manual,
    /// The blob does not place its map on the globe, so the robot cannot use fixes.
    NoOrigin,
    /// The mission's running action is `hold`.
    Holding,
    /// No behaviour of the mission is critical.
    Idle,
    /// No fix has arrived yet: the receiver's bytes form no message. The baud rate is wrong or
    /// the protocol unknown.
    UnreadableReceiver,
    /// No fix has arrived yet: the receiver's sentences have a missing or wrong checksum.
    UncheckedReceiver,
    /// No fix has arrived yet: the receiver sends messages without a position.
    NoPositionMessage,
    /// The range finder has worked and reports nothing any more, or the mission requires one and
    /// none reports.
    SilentRanges,
    /// The range finder repeats one scan although the robot moves, or its readings are impossible.
    FaultyRanges,
    /// The receiver repeats one solution, or its position does not follow the robot's motion.
    FrozenFix,
    /// The compass contradicts the course over ground or the turn rate, and nothing else shows the
    /// heading.
    WrongHeading,
    /// The robot is commanded to move and stays in one place.
    NoProgress,
    /// The robot's clock stands still, or leaps again and again.
    ClockStopped,
    /// The link to the operator is silent, and that disarmed the robot.
    LinkLost,
    /// The robot is outside the fence around the place where it was armed.
    OutsideFence,
    /// A check before arming fails; [`crate::Checks`] names it.
    NotReady,
    /// The battery's charge is below the mission's threshold.
    LowBattery,
}
