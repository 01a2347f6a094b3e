//! Decodes a receiver's bytes into fixes: UBX and NMEA, mixed in any order.
//!
//! | message | receivers | content |
//! |---|---|---|
//! | UBX NAV-PVT, 92 bytes | u-blox 8, M8, 9, F9, 10 and later | place, accuracy, velocity |
//! | UBX NAV-PVT, 84 bytes | u-blox 7 | the same |
//! | NMEA 0183 GGA and RMC, versions 2.1 to 4.11, any talker | any | place, estimated accuracy, velocity |
//! | GGA alone | any | place, estimated accuracy |
//!
//! A message counts only if its checksum is right; a sentence without one is refused. While
//! NAV-PVT arrives, NMEA is ignored, because only NAV-PVT reports its accuracy. The decoder
//! switches to NMEA after four seconds without NAV-PVT, and back after two NAV-PVT within four
//! seconds, so the sources do not alternate. In doubt a solution is not valid.
//!
//! Everything here is pure except [`gps_task`], which only carries bytes.
//!
//! Deliberately absent: configuration of the receiver, height, date, other sentences (GNS, GLL,
//! VTG) and messages (SiRF, SBF, RTCM, UBX before NAV-PVT).

use core::cell::Cell;

use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;
use math::GeoPoint;
use robot_io::{Fix, Receiver};

mod fields;
mod health;
mod nmea;
mod sentence;
mod ubx;

pub use health::{Health, Heard};
use nmea::Message as Sentence;
use ubx::Message;

/// One solution of the receiver: a [`Fix`] without its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solution {
    /// As in [`Fix`].
    pub is_valid: bool,
    /// As in [`Fix`].
    pub place: GeoPoint,
    /// As in [`Fix`].
    pub accuracy_mm: u32,
    /// As in [`Fix`].
    pub velocity_mmps: Option<[i32; 2]>,
    /// As in [`Fix`].
    pub receiver_ms: Option<u32>,
}

impl Solution {
    /// The fix whose last byte arrived at `time_us`.
    pub fn at(self, time_us: u64) -> Fix {
        let Self { is_valid, place, accuracy_mm, velocity_mmps, receiver_ms } = self;
        Fix { time_us, is_valid, place, accuracy_mm, velocity_mmps, receiver_ms }
    }
}

/// Decodes a receiver's bytes one at a time, so the result does not depend on how a UART splits
/// the stream. Total: any bytes, any length.
#[derive(Default)]
pub struct Decoder {
    ubx: ubx::Decoder,
    nmea: nmea::Decoder,
    source: Source,
    heard: Heard,
}

/// Which of the two protocols counts. They differ in accuracy and delay, so a mixture of both
/// would jump back and forth.
#[derive(Clone, Copy, Default)]
enum Source {
    /// NMEA, and no NAV-PVT has ever arrived. The first one will count.
    #[default]
    Nmea,
    /// NAV-PVT; the last one arrived at this time of the NMEA clock.
    Ubx { last_ms: Option<u32> },
    /// NMEA, because NAV-PVT became too rare. NAV-PVT will count again after two of them in
    /// quick succession.
    NmeaAgain { last_ms: Option<u32> },
}

impl Decoder {
    /// Longest interval between two NAV-PVT, by the clock of the NMEA sentences, milliseconds.
    /// After that NAV-PVT counts as switched off. A robot stops after half of it without a fix.
    const UBX_IS_OFF_AFTER_MS: u32 = 4_000;

    /// Takes the next byte. Returns the solution that it completes.
    pub fn push(&mut self, byte: u8) -> Option<Solution> {
        // Both decoders get every byte: neither knows whether the other is inside a message.
        let nmea = self.nmea.push(byte);
        let ubx = self.ubx.push(byte);
        self.heard.sound |= ubx.is_some() || nmea.is_some_and(|nmea| nmea != Sentence::Unchecked);
        self.heard.unchecked |= nmea == Some(Sentence::Unchecked);
        self.heard.position |= matches!(nmea, Some(Sentence::Position | Sentence::Solution(_)));
        let (solution, has_velocity) = match (ubx, nmea) {
            (Some(Message::Solution(solution)), _) => {
                self.heard.position = true;
                self.believes_ubx().then_some((solution, true))
            }
            (_, Some(Sentence::Solution(solution))) => {
                self.believes_nmea().then_some((solution, self.nmea.has_rmc()))
            }
            _ => None,
        }?;
        self.heard.solution = true;
        self.heard.valid |= solution.is_valid;
        self.heard.velocity |= solution.is_valid && has_velocity;
        Some(solution)
    }

    /// What was heard since the last call.
    pub fn take_heard(&mut self) -> Heard {
        core::mem::take(&mut self.heard)
    }

    /// Whether the NAV-PVT that has just arrived counts.
    fn believes_ubx(&mut self) -> bool {
        let now_ms = self.nmea.time_ms();
        let is_believed = match self.source {
            Source::NmeaAgain { last_ms } => !is_long_ago(last_ms, now_ms),
            Source::Nmea | Source::Ubx { .. } => true,
        };
        self.source = if is_believed {
            Source::Ubx { last_ms: now_ms }
        } else {
            Source::NmeaAgain { last_ms: now_ms }
        };
        is_believed
    }

    /// Whether the NMEA solution that has just arrived counts.
    fn believes_nmea(&mut self) -> bool {
        let now_ms = self.nmea.time_ms();
        match self.source {
            Source::Ubx { last_ms: None } => self.source = Source::Ubx { last_ms: now_ms },
            Source::Ubx { last_ms } if is_long_ago(last_ms, now_ms) => {
                self.source = Source::NmeaAgain { last_ms };
            }
            _ => {}
        }
        !matches!(self.source, Source::Ubx { .. })
    }
}

/// Whether the time since the last NAV-PVT means that it is switched off.
fn is_long_ago(last_ms: Option<u32>, now_ms: Option<u32>) -> bool {
    const DAY_MS: u32 = 86_400_000;
    let (Some(last_ms), Some(now_ms)) = (last_ms, now_ms) else { return false };
    // The clock restarts at midnight; a leap second extends a little beyond the day.
    let elapsed_ms = (now_ms % DAY_MS + DAY_MS - last_ms % DAY_MS) % DAY_MS;
    // More than half a day means a small step back: a late sentence.
    (Decoder::UBX_IS_OFF_AFTER_MS..DAY_MS / 2).contains(&elapsed_ms)
}

/// The latest fix and the health of the receiver, shared between tasks.
pub struct FixSlot<M: RawMutex>(Mutex<M, Cell<(Option<Fix>, Health)>>);

impl<M: RawMutex> Default for FixSlot<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> FixSlot<M> {
    /// An empty slot.
    pub const fn new() -> Self {
        Self(Mutex::new(Cell::new((None, Health::NEW))))
    }

    /// The latest fix, valid or not; `None` before the first.
    pub fn latest(&self) -> Option<Fix> {
        self.0.lock(Cell::get).0
    }

    /// State of the receiver at `now_us`.
    pub fn receiver(&self, now_us: u64) -> Receiver {
        self.0.lock(Cell::get).1.receiver(now_us)
    }

    /// Replaces the latest fix.
    pub fn store(&self, fix: Fix) {
        self.0.lock(|cell| cell.set((Some(fix), cell.get().1)));
    }

    /// Stores what the bytes up to `now_us` contained.
    pub fn hear(&self, now_us: u64, heard: &Heard) {
        self.0.lock(|cell| {
            let (fix, mut health) = cell.get();
            health.hear(now_us, heard);
            cell.set((fix, health));
        });
    }
}

/// Most bytes in one read.
const CHUNK_BYTES: usize = 64;

/// Carries bytes from `reader` through a [`Decoder`] into `fixes` until the reader ends.
///
/// It does not yield between reading bytes and storing the fix, so the fix is there as soon as
/// the reader's buffer is empty. A read error only loses bytes, and the checksums detect that.
pub async fn gps_task<M: RawMutex>(
    mut reader: impl Read,
    fixes: &FixSlot<M>,
    clock_us: impl Fn() -> u64,
) {
    let mut decoder = Decoder::default();
    let mut chunk = [0; CHUNK_BYTES];
    loop {
        match reader.read(&mut chunk).await {
            Ok(0) => return,
            Ok(count) => {
                let now_us = clock_us();
                let bytes = chunk.get(..count).unwrap_or_default();
                for solution in bytes.iter().filter_map(|&byte| decoder.push(byte)) {
                    fixes.store(solution.at(now_us));
                }
                fixes.hear(now_us, &decoder.take_heard());
            }
            Err(_) => {
                warn!("GPS: bytes lost");
                // A reader that always fails at once must not starve the other tasks.
                yield_now().await;
            }
        }
    }
}
