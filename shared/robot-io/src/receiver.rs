//! State of the GPS receiver: why there is a fix, or why not.

use serde::{Deserialize, Serialize};

/// State of the GPS receiver, judged from its bytes. The codes are part of the wire format:
/// append new ones.
///
/// [`Silent`](Self::Silent) to [`NoPosition`](Self::NoPosition) are reasons why a connected
/// receiver gives no solution; each has its own cause and remedy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Receiver {
    /// No bytes recently, or ever: no power, or a loose wire.
    #[default]
    Silent,
    /// Bytes arrive, too few yet to judge.
    Heard,
    /// Bytes arrive but form no message: the baud rate is wrong or the protocol unknown.
    Unreadable,
    /// Sentences arrive with a missing or wrong checksum: checksums are switched off, or the
    /// line is bad.
    Unchecked,
    /// Valid messages arrive, but no readable GGA or NAV-PVT: switch one of them on.
    NoPosition,
    /// Solutions arrive, none of them valid: the receiver does not see enough satellites.
    NoFix,
    /// Valid solutions arrive by GGA without RMC: no velocity, so no course; switch RMC on.
    NoVelocity,
    /// Valid solutions arrive, with velocity. Many receivers omit the course while they stand
    /// still.
    Sound,
}
