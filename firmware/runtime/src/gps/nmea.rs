//! NMEA 0183: merges GGA and RMC of one epoch.
//!
//! GGA has the place, its quality and HDOP; RMC has its validity and the velocity. They belong to
//! one epoch if they have the same time, in either order. What counts:
//!
//! | RMC | a GGA of a measured quality is then |
//! |---|---|
//! | valid, of the same epoch | a valid solution with velocity |
//! | void, or not clearly valid, with or without a time | void, like all after it until an RMC of another epoch is valid |
//! | missing in this epoch | not a solution yet: RMC may still arrive |
//! | missing in most or all epochs | a valid solution without velocity |
//!
//! RMC alone has no accuracy and is never a solution. A second talker adds nothing to an epoch
//! whose GGA has a fix, and without a fix it removes nothing.

use super::Solution;
use super::fields::{self, Gga, Rmc, Sentence, Talker};
use super::sentence::{Heard, Reader};

/// What a byte completes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Message {
    /// A solution.
    Solution(Solution),
    /// A GGA that is not a solution yet.
    Position,
    /// A sentence without a place.
    Other,
    /// A sentence without checksum or with a wrong one.
    Unchecked,
}

#[derive(Default)]
pub(super) struct Decoder {
    reader: Reader,
    epoch: Epoch,
    pace: Pace,
    /// Time of the last RMC if it was void: no GGA counts until an RMC of another time is valid.
    void: Option<Option<u32>>,
    /// Time of the last sentence that has a time, milliseconds of the day.
    time_ms: Option<u32>,
}

/// The sentences of the current epoch so far.
#[derive(Clone, Copy, Default)]
struct Epoch {
    /// Milliseconds of the day.
    time_ms: Option<u32>,
    gga: Option<Gga>,
    rmc: Option<Rmc>,
}

/// Whether RMC accompanies GGA, learned from past epochs.
#[derive(Clone, Copy, Default)]
struct Pace {
    /// Rises with each epoch of GGA alone, falls with each epoch of both.
    lone: u8,
    /// The decoder does not wait for RMC.
    is_lone: bool,
}

impl Pace {
    /// An epoch of GGA alone adds this, an epoch of both subtracts 1. So the decoder waits for an
    /// RMC that is lost now and then, but not for one that accompanies every second GGA.
    const STEP: u8 = 2;
    /// Two consecutive epochs of GGA alone end the waiting.
    const LONE_AT: u8 = 2 * Self::STEP;
    /// Most consecutive epochs of both that it takes to wait again.
    const MOST: u8 = 10;

    fn learn(&mut self, epoch: &Epoch) {
        match epoch {
            Epoch { gga: None, .. } => return,
            Epoch { rmc: Some(_), .. } => self.lone = self.lone.saturating_sub(1),
            Epoch { rmc: None, .. } => self.lone = (self.lone + Self::STEP).min(Self::MOST),
        }
        self.is_lone = self.lone >= Self::LONE_AT || self.is_lone && self.lone > 0;
    }
}

impl Decoder {
    pub(super) fn push(&mut self, byte: u8) -> Option<Message> {
        let sentence = match self.reader.push(byte)? {
            Heard::Sentence(body) => fields::parse(body),
            Heard::Unchecked => return Some(Message::Unchecked),
        };
        Some(match sentence {
            Some(Sentence::Gga(gga)) => self.gga(gga).map_or(Message::Position, Message::Solution),
            Some(Sentence::Rmc(rmc)) => self.rmc(rmc).map_or(Message::Other, Message::Solution),
            None => Message::Other,
        })
    }

    /// The receiver's clock, milliseconds of the day; `None` before the first sentence with a time.
    pub(super) fn time_ms(&self) -> Option<u32> {
        self.time_ms
    }

    /// Whether the current epoch has a valid RMC, even one without a course.
    pub(super) fn has_rmc(&self) -> bool {
        self.epoch.rmc.is_some_and(|rmc| rmc.is_valid)
    }

    fn gga(&mut self, gga: Gga) -> Option<Solution> {
        if gga.time_ms.is_none() {
            // Only a receiver without a fix has no time, and its sentence belongs to no epoch. A
            // second talker without a fix does not void the first talker's fix; the first talker
            // will report its own loss.
            let first = self.epoch.gga.filter(|first| first.has_fix);
            let is_second = first.is_some_and(|first| first.talker != gga.talker);
            return (!is_second).then(|| solution(&gga, None));
        }
        self.enter(gga.time_ms, self.epoch.gga.map(|gga| gga.talker), gga.talker);
        if self.epoch.gga.is_some_and(|first| first.has_fix || !gga.has_fix) {
            return None;
        }
        self.epoch.gga = Some(gga);
        self.solution()
    }

    fn rmc(&mut self, rmc: Rmc) -> Option<Solution> {
        if !rmc.is_valid {
            return self.void(rmc);
        }
        // An RMC without a time belongs to no epoch.
        rmc.time_ms?;
        self.enter(rmc.time_ms, self.epoch.rmc.map(|rmc| rmc.talker), rmc.talker);
        if self.void.is_some_and(|void_ms| void_ms != rmc.time_ms) {
            self.void = None;
        }
        if self.epoch.rmc.is_some() {
            return None;
        }
        self.epoch.rmc = Some(rmc);
        self.solution()
    }

    /// Applies a void RMC to its epoch and to all GGA that follow. Without a time, its epoch is the
    /// current one.
    fn void(&mut self, rmc: Rmc) -> Option<Solution> {
        if rmc.time_ms.is_some() {
            self.enter(rmc.time_ms, self.epoch.rmc.map(|rmc| rmc.talker), rmc.talker);
        }
        self.void = Some(self.epoch.time_ms);
        self.epoch.rmc = Some(rmc);
        self.solution()
    }

    /// Begins a new epoch if the time changes, or if this epoch already has such a sentence of
    /// this talker: some receivers print whole seconds at any rate. `earlier` is the talker of that
    /// sentence.
    fn enter(&mut self, time_ms: Option<u32>, earlier: Option<Talker>, talker: Talker) {
        self.time_ms = time_ms;
        if self.epoch.time_ms == time_ms && earlier != Some(talker) {
            return;
        }
        self.pace.learn(&self.epoch);
        self.epoch = Epoch { time_ms, ..Epoch::default() };
    }

    /// The solution of the epoch so far; `None` while RMC may still arrive.
    fn solution(&self) -> Option<Solution> {
        let gga = self.epoch.gga?;
        match self.epoch.rmc {
            _ if self.void.is_some() => Some(solution(&Gga { has_fix: false, ..gga }, None)),
            Some(rmc) => Some(solution(&gga, rmc.velocity_mmps)),
            None if self.pace.is_lone => Some(solution(&gga, None)),
            None => None,
        }
    }
}

fn solution(gga: &Gga, velocity_mmps: Option<[i32; 2]>) -> Solution {
    let &Gga { has_fix: is_valid, place, accuracy_mm, time_ms: receiver_ms, .. } = gga;
    Solution { is_valid, place, accuracy_mm, velocity_mmps, receiver_ms }
}
