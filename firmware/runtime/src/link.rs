//! The radio link: telemetry down, the human in charge up.
//!
//! What silence means is decided here, once, and it is never "go on as if nothing was":
//!
//! | last heard | then silence |
//! |---|---|
//! | nothing yet | not armed, unless at the board's own button |
//! | emergency stop | stays pressed, for ever |
//! | driven by hand | stands still, not armed: nobody may be surprised by autonomy |
//! | armed | by [`Silence`]: not armed, or the mission goes on |
//!
//! Telemetry never holds up a tick: the newest record replaces one that was not sent.

use core::cell::Cell;

use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use embedded_io_async::{Read, Write};
use robot_io::frame::{self, Decoder, Downlink, Uplink};
use robot_io::{CommandRecord, Operator};

/// The operator's frames count as silent after this long, microseconds. They are to be
/// repeated at least four times as often.
pub const LINK_TIMEOUT_US: u64 = 1_000_000;

/// What an armed robot does when the operator falls silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Silence {
    /// It is no longer armed.
    Disarms,
    /// Its mission goes on: for plans that lead out of the radio's range.
    Allows,
}

/// The operator as last heard, shared between tasks.
pub struct OperatorSlot<M: RawMutex> {
    heard: Mutex<M, Cell<Option<(u64, Operator)>>>,
    silence: Silence,
}

impl<M: RawMutex> OperatorSlot<M> {
    /// Nothing heard yet.
    pub const fn new(silence: Silence) -> Self {
        Self { heard: Mutex::new(Cell::new(None)), silence }
    }

    /// Notes what was heard at `time_us`.
    pub fn hear(&self, time_us: u64, operator: Operator) {
        self.heard.lock(|cell| cell.set(Some((time_us, operator))));
    }

    /// What the operator says at `now_us`, silence taken into account; `None` if nothing was
    /// ever heard, so that a board without a radio can ask its buttons.
    pub fn at(&self, now_us: u64) -> Option<Operator> {
        let (time_us, heard) = self.heard.lock(Cell::get)?;
        if now_us.saturating_sub(time_us) <= LINK_TIMEOUT_US {
            return Some(heard);
        }
        let goes_on = self.silence == Silence::Allows && heard.manual.is_none();
        Some(Operator {
            is_armed: heard.is_armed && goes_on,
            is_emergency_stop: heard.is_emergency_stop,
            manual: None,
        })
    }
}

/// The newest record that is still to be sent.
pub type Telemetry<M> = Signal<M, CommandRecord>;

/// Reads frames from `reader` into `operator` until the reader ends.
pub async fn operator_task<M: RawMutex>(
    mut reader: impl Read,
    operator: &OperatorSlot<M>,
    clock_us: impl Fn() -> u64,
) {
    let mut decoder = Decoder::default();
    let mut chunk = [0; 64];
    loop {
        match reader.read(&mut chunk).await {
            Ok(0) => return,
            Ok(count) => {
                for &byte in chunk.get(..count).unwrap_or_default() {
                    if let Some(Uplink::Operator(said)) = decoder.push(byte) {
                        operator.hear(clock_us(), said);
                    }
                }
            }
            Err(_) => {
                warn!("link: bytes lost");
                // A reader that fails at once each time must not starve the other tasks.
                yield_now().await;
            }
        }
    }
}

/// Sends each record that it gets to see.
pub async fn telemetry_task<M: RawMutex>(mut writer: impl Write, telemetry: &Telemetry<M>) {
    loop {
        let record = telemetry.wait().await;
        let Some(bytes) = frame::encode(&Downlink::Telemetry(record)) else { continue };
        if writer.write_all(&bytes).await.is_err() || writer.flush().await.is_err() {
            warn!("link: a record was not sent");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_futures::block_on;
    use embassy_futures::select::select;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use embassy_sync::pipe::Pipe;
    use robot_io::{Commands, Manual, Reason, Receiver};

    const ARMED: Operator = Operator { is_armed: true, is_emergency_stop: false, manual: None };
    const BY_HAND: Operator =
        Operator { manual: Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.0 }), ..ARMED };
    const NOT_ARMED: Operator =
        Operator { is_armed: false, is_emergency_stop: false, manual: None };

    /// What a robot that heard `said` at 5 s makes of it at the limit and just after.
    fn check(silence: Silence, said: Operator, after: Operator) {
        let slot = OperatorSlot::<NoopRawMutex>::new(silence);
        slot.hear(5_000_000, said);
        assert_eq!(slot.at(5_000_000), Some(said));
        assert_eq!(slot.at(5_000_000 + LINK_TIMEOUT_US), Some(said));
        assert_eq!(slot.at(5_000_001 + LINK_TIMEOUT_US), Some(after));
    }

    #[test]
    fn silence_has_a_meaning_for_each_state() {
        assert_eq!(OperatorSlot::<NoopRawMutex>::new(Silence::Allows).at(0), None);
        check(Silence::Disarms, ARMED, NOT_ARMED);
        check(Silence::Allows, ARMED, ARMED);
        for silence in [Silence::Disarms, Silence::Allows] {
            check(silence, BY_HAND, NOT_ARMED);
            let stopped = Operator { is_emergency_stop: true, ..BY_HAND };
            check(silence, stopped, Operator { is_emergency_stop: true, ..NOT_ARMED });
        }
    }

    #[test]
    fn the_newest_record_is_sent_and_older_ones_are_not() {
        let record = |time_us| CommandRecord {
            time_us,
            commands: Commands::stop(Reason::NoFix),
            trace_hash: 1,
            instructions: 2,
            receiver: Receiver::Silent,
        };
        let telemetry = Telemetry::<NoopRawMutex>::new();
        let wire = Pipe::<NoopRawMutex, 512>::new();
        let robot = async {
            for times in [[1, 2], [3, 4]] {
                times.into_iter().for_each(|time_us| telemetry.signal(record(time_us)));
                yield_now().await;
            }
        };
        block_on(select(telemetry_task(&wire, &telemetry), robot));
        let mut bytes = [0; 512];
        let count = wire.try_read(&mut bytes).unwrap();
        let mut decoder = Decoder::default();
        let mut sent = bytes[..count].iter().filter_map(|&byte| decoder.push(byte));
        assert_eq!(sent.next(), Some(Downlink::Telemetry(record(2))));
        assert_eq!(sent.next(), Some(Downlink::Telemetry(record(4))));
        assert_eq!(sent.next(), None);
    }

    #[test]
    fn frames_reach_the_slot_through_garbage() {
        let slot = OperatorSlot::<NoopRawMutex>::new(Silence::Disarms);
        let frame = frame::encode(&Uplink::Operator(BY_HAND)).unwrap();
        let mut bytes = [0x55; 200];
        bytes[100] = 0;
        bytes[101..101 + frame.len()].copy_from_slice(&frame);
        block_on(operator_task(&bytes[..], &slot, || 7));
        assert_eq!(slot.at(7), Some(BY_HAND));
    }
}
