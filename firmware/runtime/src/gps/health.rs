//! Judges the receiver from its bytes of the last seconds.

use robot_io::Receiver;

/// An event counts as missing after this time, microseconds. Receivers must send a position at
/// least once a second.
const PATIENCE_US: u64 = 3_000_000;

/// What a piece of the stream contained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// A message with the right checksum.
    pub sound: bool,
    /// A sentence without checksum or with a wrong one.
    pub unchecked: bool,
    /// A message with a position, valid or not.
    pub position: bool,
    /// A solution.
    pub solution: bool,
    /// A valid solution.
    pub valid: bool,
    /// A valid solution of a receiver that reports velocity, at least while it moves.
    pub velocity: bool,
}

/// When each kind of event was last heard, microseconds. The default is [`Health::NEW`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Time of the first byte after silence.
    began_us: u64,
    byte_us: Option<u64>,
    sound_us: Option<u64>,
    unchecked_us: Option<u64>,
    position_us: Option<u64>,
    solution_us: Option<u64>,
    valid_us: Option<u64>,
    velocity_us: Option<u64>,
}

impl Health {
    /// The health before the first byte.
    pub const NEW: Self = Self {
        began_us: 0,
        byte_us: None,
        sound_us: None,
        unchecked_us: None,
        position_us: None,
        solution_us: None,
        valid_us: None,
        velocity_us: None,
    };

    /// Stores what the bytes up to `now_us` contained.
    pub fn hear(&mut self, now_us: u64, heard: &Heard) {
        if !is_recent(self.byte_us, now_us) {
            self.began_us = now_us;
        }
        self.byte_us = Some(now_us);
        for (is_heard, last_us) in [
            (heard.sound, &mut self.sound_us),
            (heard.unchecked, &mut self.unchecked_us),
            (heard.position, &mut self.position_us),
            (heard.solution, &mut self.solution_us),
            (heard.valid, &mut self.valid_us),
            (heard.velocity, &mut self.velocity_us),
        ] {
            if is_heard {
                *last_us = Some(now_us);
            }
        }
    }

    /// State of the receiver at `now_us`.
    pub fn receiver(&self, now_us: u64) -> Receiver {
        let recent = |last_us| is_recent(last_us, now_us);
        // Not recent, although the bytes began long enough ago.
        let missing = |last_us| !recent(last_us) && !recent(Some(self.began_us));
        if !recent(self.byte_us) {
            Receiver::Silent
        } else if recent(self.velocity_us) {
            Receiver::Sound
        } else if recent(self.valid_us) {
            Receiver::NoVelocity
        } else if recent(self.solution_us) {
            Receiver::NoFix
        } else if missing(self.sound_us) && recent(self.unchecked_us) {
            Receiver::Unchecked
        } else if missing(self.sound_us) {
            Receiver::Unreadable
        } else if missing(self.position_us) {
            Receiver::NoPosition
        } else {
            Receiver::Heard
        }
    }
}

/// Whether an event happened within [`PATIENCE_US`].
fn is_recent(last_us: Option<u64>, now_us: u64) -> bool {
    last_us.is_some_and(|last_us| now_us.saturating_sub(last_us) <= PATIENCE_US)
}
