//! The link's protocol: telemetry down, the operator's orders up, one packet each.
//!
//! [`crate::operator`] keeps the orders, [`crate::silence`] decides what link loss does. The
//! operator must repeat the packets at least four times within the timeout. Telemetry never
//! delays a tick: the newest record replaces an unsent one.

use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::{Read, Write};
use robot_io::packet::{self, Decoder, Downlink, Uplink};

use crate::slots::{Slots, Telemetry};

/// Reads packets from `reader` into the slots of orders and poses until the reader ends.
pub async fn operator_task<M: RawMutex>(
    mut reader: impl Read,
    slots: &Slots<M>,
    clock_us: impl Fn() -> u64,
) {
    let mut decoder = Decoder::default();
    let mut chunk = [0; 64];
    loop {
        match reader.read(&mut chunk).await {
            Ok(0) => return,
            Ok(count) => {
                for &byte in chunk.get(..count).unwrap_or_default() {
                    match decoder.push(byte) {
                        Some(Uplink::Operator(heard)) => slots.operator.hear(clock_us(), heard),
                        Some(Uplink::Pose(pose)) => slots.poses.hear(clock_us(), pose),
                        None => {}
                    }
                }
            }
            Err(_) => {
                warn!("link: bytes lost");
                // A reader that always fails at once must not starve the other tasks.
                yield_now().await;
            }
        }
    }
}

/// Sends the newest record whenever there is one. Never returns.
pub async fn telemetry_task<M: RawMutex>(mut writer: impl Write, telemetry: &Telemetry<M>) {
    loop {
        let record = telemetry.wait().await;
        let Some(bytes) = packet::encode(&Downlink::Telemetry(record)) else { continue };
        if writer.write_all(&bytes).await.is_err() || writer.flush().await.is_err() {
            warn!("link: record not sent");
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
    use plan_format::Parameters;
    use robot_io::{Checks, CommandRecord, Commands, Manual, Operator, Pose, Reason, Receiver};

    const BY_HAND: Operator = Operator {
        is_armed: true,
        is_emergency_stop: false,
        manual: Some(Manual { speed_mps: 1.0, turn_rate_radps: 0.0 }),
    };

    #[test]
    fn the_newest_record_is_sent_and_older_ones_are_not() {
        let record = |time_us| CommandRecord {
            time_us,
            commands: Commands::stop(Reason::NoFix),
            trace_hash: 1,
            instructions: 2,
            receiver: Receiver::Silent,
            checks: Checks::PLAN,
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
    fn packets_reach_their_slots_through_garbage() {
        let slots = Slots::<NoopRawMutex>::new();
        let pose = Pose { time_us: 99, position_m: [1.0, 2.0], heading_rad: None, accuracy_mm: 50 };
        let mut bytes = [0x55; 300];
        for (at, uplink) in [(100, Uplink::Operator(BY_HAND)), (200, Uplink::Pose(pose))] {
            let packet = packet::encode(&uplink).unwrap();
            bytes[at] = 0;
            bytes[at + 1..=at + packet.len()].copy_from_slice(&packet);
        }
        block_on(operator_task(&bytes[..], &slots, || 7));
        let heard = slots.operator.at(7, &Parameters::default().link).map(|orders| orders.operator);
        assert_eq!(heard, Some(BY_HAND));
        assert_eq!(slots.poses.latest(), Some(Pose { time_us: 7, ..pose }), "it arrived at 7 us");
    }
}
