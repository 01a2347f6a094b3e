//! NMEA 0183: GGA and RMC of one epoch, merged.
//!
//! GGA has the place, its quality and HDOP; RMC says whether to believe it, and the velocity.
//! They belong to one epoch if they have the same time, in either order. What counts:
//!
//! | RMC | then a GGA of a measured quality is |
//! |---|---|
//! | valid, of the same epoch | a valid solution with velocity |
//! | void, or not clearly valid, with or without a time | void, and so are all after it until an RMC of another epoch is valid |
//! | none in this epoch | not served, as RMC may still come ... |
//! | none in most epochs, or never | ... and where it rarely does, a valid solution without velocity |
//!
//! RMC alone says nothing about accuracy and is never a solution. A second talker adds nothing
//! to an epoch whose GGA has a fix, and one without a fix takes nothing away.

use super::Solution;
use super::fields::{self, Gga, Rmc, Sentence, Talker};
use super::sentence::{Heard, Reader};

/// What a byte completes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Message {
    /// A solution.
    Solution(Solution),
    /// A GGA that is no solution yet.
    Position,
    /// A sentence that says nothing about the place.
    Other,
    /// A sentence without checksum or with a wrong one.
    Unchecked,
}

#[derive(Default)]
pub(super) struct Decoder {
    reader: Reader,
    epoch: Epoch,
    pace: Pace,
    /// The last RMC was void, and its time: no GGA counts until one of another time is valid.
    void: Option<Option<u32>>,
    /// Time of the last sentence that has one, milliseconds of the day.
    time_ms: Option<u32>,
}

/// What has arrived of the current epoch.
#[derive(Clone, Copy, Default)]
struct Epoch {
    /// Milliseconds of the day.
    time_ms: Option<u32>,
    gga: Option<Gga>,
    rmc: Option<Rmc>,
}

/// Whether RMC comes with each GGA, learned from the epochs that are over.
#[derive(Clone, Copy, Default)]
struct Pace {
    /// Rises with each epoch of GGA alone, falls with each that had both.
    lone: u8,
    /// RMC is not waited for.
    is_lone: bool,
}

impl Pace {
    /// What an epoch of GGA alone adds; one with both takes away 1. So RMC that comes every
    /// second time is not waited for, and one that is lost now and then is.
    const STEP: u8 = 2;
    /// Two epochs of GGA alone, one after the other, are enough to stop waiting.
    const LONE_AT: u8 = 2 * Self::STEP;
    /// How long both must come, at most, to wait again.
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

    /// The receiver's clock, milliseconds of the day, as far as its sentences say it.
    pub(super) fn time_ms(&self) -> Option<u32> {
        self.time_ms
    }

    /// Whether a valid RMC is part of the current epoch, even if it leaves the course out.
    pub(super) fn has_rmc(&self) -> bool {
        self.epoch.rmc.is_some_and(|rmc| rmc.is_valid)
    }

    fn gga(&mut self, gga: Gga) -> Option<Solution> {
        if gga.time_ms.is_none() {
            // Only a receiver that has no fix has no time, and nothing else belongs to it. A second
            // talker that has none takes nothing from the first, which will say itself when it
            // has lost its own.
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
        // One without a time belongs to nothing.
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

    /// A void RMC: of the current epoch if it does not say which, and of all GGA to come.
    fn void(&mut self, rmc: Rmc) -> Option<Solution> {
        if rmc.time_ms.is_some() {
            self.enter(rmc.time_ms, self.epoch.rmc.map(|rmc| rmc.talker), rmc.talker);
        }
        self.void = Some(self.epoch.time_ms);
        self.epoch.rmc = Some(rmc);
        self.solution()
    }

    /// Begins a new epoch if `time_ms` is not the current one's, or if its talker has said such a
    /// sentence already: some receivers print whole seconds however often they send.
    fn enter(&mut self, time_ms: Option<u32>, said: Option<Talker>, talker: Talker) {
        self.time_ms = time_ms;
        if self.epoch.time_ms == time_ms && said != Some(talker) {
            return;
        }
        self.pace.learn(&self.epoch);
        self.epoch = Epoch { time_ms, ..Epoch::default() };
    }

    /// The solution that the latest sentence completes.
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
    let &Gga { has_fix: is_valid, place, accuracy_mm, .. } = gga;
    Solution { is_valid, place, accuracy_mm, velocity_mmps }
}
