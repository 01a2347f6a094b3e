//! From a receiver's bytes to a fix: UBX and NMEA, mixed as they come.
//!
//! A receiver may talk either language or both; a solution counts only if its checksum is
//! right. Where UBX solutions arrive, NMEA is ignored: NAV-PVT says how accurate it is, NMEA
//! does not. Everything here is pure but [`gps_task`], which only carries bytes.
//!
//! Deliberately absent: configuration of the receiver, height, GNS sentences.

use core::cell::Cell;

use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;
use math::GeoPoint;
use robot_io::Fix;

mod nmea;
mod ubx;

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
    /// NMEA solutions since the last UBX solution.
    since_ubx: Option<u8>,
}

impl Decoder {
    /// NMEA solutions without a UBX solution after which UBX counts as switched off. Both
    /// come at the receiver's rate, so one or two may stand between two UBX solutions.
    const UBX_IS_OFF_AFTER: u8 = 5;

    /// Takes the next byte; answers with the solution that it completes.
    pub fn push(&mut self, byte: u8) -> Option<Solution> {
        // Both see every byte: neither can know whether the other is inside a message.
        let nmea = self.nmea.push(byte);
        if let Some(solution) = self.ubx.push(byte) {
            self.since_ubx = Some(0);
            return Some(solution);
        }
        let solution = nmea?;
        self.since_ubx = self
            .since_ubx
            .map(|count| count.saturating_add(1))
            .filter(|&count| count < Self::UBX_IS_OFF_AFTER);
        if self.since_ubx.is_some() { None } else { Some(solution) }
    }
}

/// The latest fix, shared between tasks.
pub struct FixSlot<M: RawMutex>(Mutex<M, Cell<Option<Fix>>>);

impl<M: RawMutex> Default for FixSlot<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> FixSlot<M> {
    /// An empty slot.
    pub const fn new() -> Self {
        Self(Mutex::new(Cell::new(None)))
    }

    /// The latest fix, whether valid or not; `None` before the first.
    pub fn latest(&self) -> Option<Fix> {
        self.0.lock(Cell::get)
    }

    /// Replaces the latest fix.
    pub fn store(&self, fix: Fix) {
        self.0.lock(|cell| cell.set(Some(fix)));
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
                let bytes = chunk.get(..count).unwrap_or_default();
                for solution in bytes.iter().filter_map(|&byte| decoder.push(byte)) {
                    fixes.store(solution.at(clock_us()));
                }
            }
            Err(_) => {
                warn!("GPS: bytes lost");
                // A reader that fails at once each time must not starve the other tasks.
                yield_now().await;
            }
        }
    }
}
