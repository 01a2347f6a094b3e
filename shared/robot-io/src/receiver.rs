//! How the GPS receiver fares: why there is a fix, or why there is none.

use serde::{Deserialize, Serialize};

/// What the bytes of the GPS receiver add up to. The codes are part of the wire format: new
/// ones are added at the end.
///
/// [`Silent`](Self::Silent) to [`NoPosition`](Self::NoPosition) say why a receiver that is
/// connected never gives a solution; each has another cause and another remedy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Receiver {
    /// Nothing has come for a while, or ever: no power, or a loose wire.
    #[default]
    Silent,
    /// Something comes, too little yet to tell what.
    Heard,
    /// Bytes come that are no message: the baud rate is wrong or the protocol unknown.
    Unreadable,
    /// Sentences come without a checksum or with a wrong one: checksums are switched off, or
    /// the line is bad.
    Unchecked,
    /// Sound messages come, but no GGA and no NAV-PVT that can be read: switch one of them on.
    NoPosition,
    /// Solutions come, and the receiver vouches for none: it does not see enough satellites.
    NoFix,
    /// Valid solutions come by GGA without RMC: no velocity, so no course; switch RMC on.
    NoVelocity,
    /// Valid solutions come, with velocity; many receivers leave the course out while they stand
    /// still.
    Sound,
}
