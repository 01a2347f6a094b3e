//! From a receiver's bytes to a fix: UBX and NMEA, mixed as they come.
//!
//! | read | from | gives |
//! |---|---|---|
//! | UBX NAV-PVT, 92 bytes | u-blox 8, M8, 9, F9, 10 and later | place, accuracy, velocity |
//! | UBX NAV-PVT, 84 bytes | u-blox 7 | the same |
//! | NMEA 0183 GGA and RMC, versions 2.1 to 4.11, any talker | any | place, estimated accuracy, velocity |
//! | GGA alone | any | place, estimated accuracy |
//!
//! A message counts only if its checksum is right; a sentence without one is refused. Where
//! NAV-PVT comes, NMEA is ignored: NAV-PVT says how accurate it is, NMEA does not. It is left
//! for NMEA when none has come for four seconds, and believed again when two have come within
//! four seconds, so the two never take turns. In doubt a solution is not valid.
//!
//! Everything here is pure but [`gps_task`], which only carries bytes.
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

/// What one solution of the receiver says; a [`Fix`] that has not been given a time yet.
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
}

impl Solution {
    /// The fix whose last byte arrived at `time_us`.
    pub fn at(self, time_us: u64) -> Fix {
        let Self { is_valid, place, accuracy_mm, velocity_mmps } = self;
        Fix { time_us, is_valid, place, accuracy_mm, velocity_mmps }
    }
}

/// Reads a receiver's bytes, one at a time, so that the result cannot depend on how a UART
/// cuts the stream into pieces. Total: any bytes, any length.
#[derive(Default)]
pub struct Decoder {
    ubx: ubx::Decoder,
    nmea: nmea::Decoder,
    source: Source,
    heard: Heard,
}

/// Which of the two languages is believed. They differ in accuracy and delay, so a mixture of
/// both would jump to and fro.
#[derive(Clone, Copy, Default)]
enum Source {
    /// NMEA, and no NAV-PVT has ever come. The first one will be believed.
    #[default]
    Nmea,
    /// NAV-PVT, the last of which came at this time of the NMEA clock.
    Ubx { last_ms: Option<u32> },
    /// NMEA, since NAV-PVT had become too rare. It will be believed again when two come as soon
    /// after each other as they should.
    NmeaAgain { last_ms: Option<u32> },
}

impl Decoder {
    /// NAV-PVT that comes less often than this, by the clock of the NMEA sentences beside it,
    /// counts as switched off, milliseconds. A robot stops when it has no fix for half as long.
    const UBX_IS_OFF_AFTER_MS: u32 = 4_000;

    /// Takes the next byte; answers with the solution that it completes.
    pub fn push(&mut self, byte: u8) -> Option<Solution> {
        // Both see every byte: neither can know whether the other is inside a message.
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

    /// What has been heard since this was asked last.
    pub fn take_heard(&mut self) -> Heard {
        core::mem::take(&mut self.heard)
    }

    /// Whether a NAV-PVT that has just come counts.
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

    /// Whether a solution of NMEA that has just come counts.
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

/// Whether NAV-PVT is switched off, by the times of the last one and of now.
fn is_long_ago(last_ms: Option<u32>, now_ms: Option<u32>) -> bool {
    const DAY_MS: u32 = 86_400_000;
    let (Some(last_ms), Some(now_ms)) = (last_ms, now_ms) else { return false };
    // At midnight the clock begins anew; a leap second lasts a little beyond the day.
    let elapsed_ms = (now_ms % DAY_MS + DAY_MS - last_ms % DAY_MS) % DAY_MS;
    // More than half a day is a little backwards: a sentence that came late.
    (Decoder::UBX_IS_OFF_AFTER_MS..DAY_MS / 2).contains(&elapsed_ms)
}

/// The latest fix and how the receiver fares, shared between tasks.
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

    /// The latest fix, whether valid or not; `None` before the first.
    pub fn latest(&self) -> Option<Fix> {
        self.0.lock(Cell::get).0
    }

    /// How the receiver fares at `now_us`.
    pub fn receiver(&self, now_us: u64) -> Receiver {
        self.0.lock(Cell::get).1.receiver(now_us)
    }

    /// Replaces the latest fix.
    pub fn store(&self, fix: Fix) {
        self.0.lock(|cell| cell.set((Some(fix), cell.get().1)));
    }

    /// Notes what the bytes that came by `now_us` held.
    pub fn hear(&self, now_us: u64, heard: &Heard) {
        self.0.lock(|cell| {
            let (fix, mut health) = cell.get();
            health.hear(now_us, heard);
            cell.set((fix, health));
        });
    }
}

/// Bytes taken from the reader at once.
const CHUNK_BYTES: usize = 64;

/// Carries bytes from `reader` through a [`Decoder`] into `fixes` until the reader ends.
///
/// Between reading bytes and storing what they mean it does not yield, so whoever sees the
/// reader's buffer empty also sees the fix. A reading error loses bytes, which the checksums
/// notice, and nothing else.
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
                // A reader that fails at once each time must not starve the other tasks.
                yield_now().await;
            }
        }
    }
}
