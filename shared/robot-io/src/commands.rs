//! What the robot is told to do in one tick, and why.

use serde::{Deserialize, Serialize};

/// The result of one tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Commands {
    /// Speed ahead, m/s.
    pub speed_mps: f32,
    /// Turn rate, rad/s counter-clockwise.
    pub turn_rate_radps: f32,
    /// Digital outputs, bit by bit.
    pub outputs: u16,
    /// A code for whoever listens, from a mission's `signal` action; 0 for none.
    pub signal: u16,
    /// Why.
    pub reason: Reason,
}

impl Commands {
    /// Stand still, and say why.
    pub const fn stop(reason: Reason) -> Self {
        Self { speed_mps: 0.0, turn_rate_radps: 0.0, outputs: 0, signal: 0, reason }
    }
}

/// Why the robot does what it does. The codes are part of the wire format: new ones are
/// added at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Reason {
    /// Driving by plan and schemas.
    Driving,
    /// The goal is reached.
    AtGoal,
    /// In a blocked cell, following the escape out of it.
    Escaping,
    /// There is no map: driving by reactive schemas alone, or standing still where no goal is
    /// known either.
    NoPlan,
    /// No layer has a route from here.
    NoRoute,
    /// The position is outside the map.
    OffMap,
    /// No fix has arrived yet, and as far as can be told none was sent.
    NoFix,
    /// The last usable fix is too old.
    StaleFix,
    /// The receiver does not vouch for its fix, or it is not accurate enough.
    PoorFix,
    /// A fix implies an impossible jump.
    JumpedFix,
    /// A fix is too far from the map's reference.
    DistantFix,
    /// The heading is not known yet: creeping ahead or waiting.
    NoHeading,
    /// Something is inside the stop distance in the direction of motion.
    ObstacleStop,
    /// Not armed.
    Disarmed,
    /// The emergency stop is pressed.
    EmergencyStop,
    /// Driven by hand.
    Manual,
    /// The plan does not say where on the globe its map lies, so no fix can be used.
    NoOrigin,
    /// The mission's behaviours hold the robot still.
    Holding,
    /// No behaviour of the mission is critical.
    Idle,
    /// No fix has arrived yet: what the receiver sends is no message. The baud rate is wrong or
    /// the protocol unknown.
    UnreadableReceiver,
    /// No fix has arrived yet: the receiver's sentences have no checksum or a wrong one.
    UncheckedReceiver,
    /// No fix has arrived yet: the receiver sends messages, but none with a position.
    NoPositionMessage,
}
