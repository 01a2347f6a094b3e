//! The link's protocol: telemetry down, the operator's orders up, one packet each.
//!
//! [`crate::operator`] keeps the orders, [`crate::silence`] decides what link loss does. The
//! operator must repeat the packets at least four times within the timeout. Robots of a team that
//! share a channel send each other their news, at 5 Hz. Telemetry never
//! delays a tick: the newest record replaces an unsent one.

use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::{Read, Write};
use heapless::Vec;
use robot_io::Heard;
use robot_io::packet::{self, Decoder, Downlink, MAX_PACKET_BYTES, Uplink};

use crate::slots::{Slots, Telemetry};

/// Reads packets from `reader` into the slots of orders, poses and mates' news until the reader ends.
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
                        Some(Uplink::News(news)) => {
                            // A serial radio does not report the quality of a packet.
                            slots.mates.hear(clock_us(), Heard { news, quality: 1.0 });
                        }
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

/// Shortest time between two packets with news for mates, microseconds.
pub const NEWS_PERIOD_US: u64 = 200_000;

/// Sends the newest record whenever there is one, and the news for mates. Never returns.
pub async fn telemetry_task<M: RawMutex>(mut writer: impl Write, telemetry: &Telemetry<M>) {
    let mut last_news_us = None;
    loop {
        let record = telemetry.wait().await;
        send(&mut writer, packet::encode(&Downlink::Telemetry(record))).await;
        let is_due = |last_us| record.time_us.saturating_sub(last_us) >= NEWS_PERIOD_US;
        if let Some(news) = record.news.filter(|_| last_news_us.is_none_or(is_due)) {
            last_news_us = Some(record.time_us);
            send(&mut writer, packet::encode(&Uplink::News(news))).await;
        }
    }
}

async fn send(writer: &mut impl Write, packet: Option<Vec<u8, MAX_PACKET_BYTES>>) {
    let Some(bytes) = packet else { return };
    if writer.write_all(&bytes).await.is_err() || writer.flush().await.is_err() {
        warn!("link: record not sent");
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
    use robot_io::{
        Checks, CommandRecord, Commands, Manual, News, Operator, Pose, Reason, Receiver,
    };

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
            news: None,
            goal: None,
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

    /// What one robot sends, a mate hears: news at 5 Hz among the telemetry of 20 Hz.
    #[test]
    fn news_for_mates_are_sent_at_5_hz_and_heard() {
        let telemetry = Telemetry::<NoopRawMutex>::new();
        let air = Pipe::<NoopRawMutex, 4096>::new();
        let robot = async {
            for tick in 0..20_u64 {
                telemetry.signal(CommandRecord {
                    time_us: tick * 50_000,
                    commands: Commands::stop(Reason::Driving),
                    trace_hash: 1,
                    instructions: 2,
                    receiver: Receiver::Sound,
                    checks: Checks::default(),
                    news: Some(News {
                        robot: 2,
                        position_m: Some([1.0, 2.0]),
                        signal: tick as u16,
                    }),
                    goal: Some(1),
                });
                yield_now().await;
            }
        };
        block_on(select(telemetry_task(&air, &telemetry), robot));
        let mut bytes = [0; 4096];
        let count = air.try_read(&mut bytes).unwrap();
        let mut decoder = Decoder::default();
        let uplinks = bytes[..count].iter().filter_map(|&byte| decoder.push::<Uplink>(byte));
        assert_eq!(uplinks.count(), 5, "at 0, 0.2, 0.4, 0.6 and 0.8 s");
        let slots = Slots::<NoopRawMutex>::new();
        block_on(operator_task(&bytes[..count], &slots, || 9));
        let news = slots.mates.latest(0b100)[0].heard.news;
        assert_eq!(news, News { robot: 2, position_m: Some([1.0, 2.0]), signal: 16 });
    }
}
