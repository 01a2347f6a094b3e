//! Packets: how a value crosses a serial line that loses, flips and inserts bytes.
//!
//! A packet is the value's postcard bytes and their CRC-16 (CCITT-FALSE, little-endian), both
//! stuffed by COBS so that no byte is 0, and a closing 0. After any error on the line, the
//! decoder resynchronises at the next 0.
//!
//! Invariants: [`Decoder::push`] is total and keeps at most [`MAX_STUFFED_BYTES`]; the decoder
//! never accepts a packet with one flipped bit. Deliberately absent: addresses, sequence
//! numbers, acknowledgements. Each packet carries a whole state, so the next one makes up for a
//! lost one.

use heapless::Vec;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::limits::MAX_WIRE_BYTES;
use crate::{CommandRecord, News, Operator, Pose};

const CRC_BYTES: usize = 2;
/// Bytes of the longest packet before stuffing.
const MAX_PLAIN_BYTES: usize = MAX_WIRE_BYTES + CRC_BYTES;
/// Bytes of the longest packet after stuffing, without the closing 0: one more for each 254.
pub const MAX_STUFFED_BYTES: usize = MAX_PLAIN_BYTES + MAX_PLAIN_BYTES / 254 + 1;
/// Bytes of the longest packet on the wire.
pub const MAX_PACKET_BYTES: usize = MAX_STUFFED_BYTES + 1;

/// What a robot sends. Append new kinds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Downlink {
    /// What the robot did in a tick.
    Telemetry(CommandRecord),
}

/// What a robot receives. Append new kinds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Uplink {
    /// The operator's orders; repeated, because silence counts as link loss.
    Operator(Operator),
    /// A pose from another source than the GPS receiver. Its arrival counts, not its `time_us`.
    Pose(Pose),
    /// News of a mate. Robots send this kind to each other.
    News(News),
}

/// The packet of `value`, with the closing 0; `None` if it is too long.
pub fn encode<T: Serialize>(value: &T) -> Option<Vec<u8, MAX_PACKET_BYTES>> {
    let mut plain = [0; MAX_PLAIN_BYTES];
    let length = postcard::to_slice(value, &mut plain).ok()?.len();
    let (value_bytes, rest) = plain.split_at_mut_checked(length)?;
    rest.get_mut(..CRC_BYTES)?.copy_from_slice(&crc16(value_bytes).to_le_bytes());
    stuff(plain.get(..length + CRC_BYTES)?)
}

/// The value in a payload; `None` unless the payload is exactly one value of this type.
fn value<T: DeserializeOwned>(payload: &[u8]) -> Option<T> {
    let (value, rest) = postcard::take_from_bytes(payload).ok()?;
    rest.is_empty().then_some(value)
}

/// Finds packets in a stream of bytes.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    /// Unstuffed bytes of the arriving packet.
    plain: Vec<u8, MAX_STUFFED_BYTES>,
    /// Bytes to copy before the next code byte.
    left: u8,
    /// Whether a 0 follows the current block.
    owes_zero: bool,
    /// Whether the packet is broken; the decoder skips bytes up to the next 0.
    is_broken: bool,
}

impl Decoder {
    /// Takes the next byte. Returns the value if the byte closes a valid packet.
    pub fn push<T: DeserializeOwned>(&mut self, byte: u8) -> Option<T> {
        if byte != 0 {
            self.unstuff(byte);
            return None;
        }
        let value = self.payload().and_then(value);
        *self = Self::default();
        value
    }

    fn unstuff(&mut self, byte: u8) {
        if self.left > 0 {
            self.left -= 1;
            self.keep(byte);
            return;
        }
        if self.owes_zero {
            self.keep(0);
        }
        self.left = byte - 1;
        self.owes_zero = byte != 0xff;
    }

    fn keep(&mut self, byte: u8) {
        self.is_broken |= self.plain.push(byte).is_err();
    }

    /// The payload; `None` if the packet is incomplete or its checksum is wrong.
    fn payload(&self) -> Option<&[u8]> {
        if self.is_broken || self.left > 0 {
            return None;
        }
        let (payload, crc) = self.plain.split_last_chunk::<CRC_BYTES>()?;
        (crc16(payload) == u16::from_le_bytes(*crc)).then_some(payload)
    }
}

/// COBS (Cheshire and Baker 1999) with the closing 0.
fn stuff(plain: &[u8]) -> Option<Vec<u8, MAX_PACKET_BYTES>> {
    let mut packet = Vec::new();
    let mut blocks = plain.split(|&byte| byte == 0);
    blocks.try_for_each(|block| {
        let mut chunks = block.chunks_exact(254);
        for full in chunks.by_ref() {
            packet.push(0xff).ok()?;
            packet.extend_from_slice(full).ok()?;
        }
        let rest = chunks.remainder();
        packet.push(rest.len() as u8 + 1).ok()?;
        packet.extend_from_slice(rest).ok()
    })?;
    packet.push(0).ok()?;
    Some(packet)
}

/// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xffff. Computed bit by bit: packets are short
/// and rare, and a table would cost 512 bytes of flash.
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xffff, |crc, &byte| {
        (0..8).fold(crc ^ (u16::from(byte) << 8), |crc, _| {
            if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Checks, Commands, Manual, Reason, Receiver};

    /// The values of all valid packets in a stream.
    fn read_all(bytes: &[u8]) -> Vec<Uplink, 8> {
        let mut decoder = Decoder::default();
        bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
    }

    fn uplink(speed_mps: f32) -> Uplink {
        let manual = Some(Manual { speed_mps, turn_rate_radps: 0.0 });
        Uplink::Operator(Operator { is_armed: true, is_emergency_stop: false, manual })
    }

    #[test]
    fn the_checksum_is_crc_16_ccitt_false() {
        assert_eq!(crc16(b"123456789"), 0x29b1);
    }

    #[test]
    fn the_bytes_of_a_packet() {
        // Operator, not armed, stopped, no manual command; then the checksum of 00 00 01 00.
        let stop = Operator { is_emergency_stop: true, ..Operator::default() };
        let [low, high] = crc16(&[0, 0, 1, 0]).to_le_bytes();
        let packet = encode(&Uplink::Operator(stop)).unwrap();
        assert_eq!(packet, [1, 1, 2, 1, 3, low, high, 0]);
    }

    #[test]
    fn stuffing_agrees_with_the_examples_of_its_inventors() {
        assert_eq!(stuff(&[]).unwrap(), [1, 0]);
        assert_eq!(stuff(&[0]).unwrap(), [1, 1, 0]);
        assert_eq!(stuff(&[0x45, 0, 0x2c, 0x4c]).unwrap(), [2, 0x45, 3, 0x2c, 0x4c, 0]);
    }

    #[test]
    fn what_is_stuffed_comes_out_again_at_every_length() {
        for length in 0..=MAX_PLAIN_BYTES - CRC_BYTES {
            for step in [0_usize, 1, 2, 7] {
                let plain: Vec<u8, MAX_PLAIN_BYTES> =
                    (0..length).map(|i| (i * step % 5 * 51) as u8).collect();
                let mut sealed = plain.clone();
                sealed.extend_from_slice(&crc16(&plain).to_le_bytes()).unwrap();
                let packet = stuff(&sealed).unwrap();
                let (last, stuffed) = packet.split_last().unwrap();
                assert!(*last == 0 && !stuffed.contains(&0));
                let mut decoder = Decoder::default();
                stuffed.iter().for_each(|&byte| decoder.unstuff(byte));
                assert_eq!(decoder.payload(), Some(&plain[..]), "length {length} step {step}");
            }
        }
    }

    #[test]
    fn telemetry_comes_back() {
        let record = CommandRecord {
            time_us: u64::MAX,
            commands: Commands { speed_mps: 1.5, ..Commands::stop(Reason::Manual) },
            trace_hash: 0x0102_0300_0000_0004,
            instructions: u32::MAX,
            receiver: Receiver::NoVelocity,
            checks: Checks::HEADING,
            news: Some(News::default()),
            goal: Some(u8::MAX),
        };
        let packet = encode(&Downlink::Telemetry(record)).unwrap();
        let mut decoder = Decoder::default();
        let back = packet.iter().find_map(|&byte| decoder.push(byte));
        assert_eq!(back, Some(Downlink::Telemetry(record)));
    }

    /// Robots that share a channel hear each other's telemetry too.
    #[test]
    fn telemetry_of_a_mate_is_never_taken_for_an_order() {
        for time_us in 0..3 {
            for is_short in [false, true] {
                let record = CommandRecord {
                    time_us,
                    commands: Commands::stop(Reason::Driving),
                    trace_hash: if is_short { 0 } else { u64::MAX },
                    instructions: 0,
                    receiver: Receiver::default(),
                    checks: Checks::default(),
                    news: None,
                    goal: None,
                };
                let packet = encode(&Downlink::Telemetry(record)).unwrap();
                assert_eq!(read_all(&packet), Vec::<Uplink, 8>::new());
            }
        }
    }

    #[test]
    fn a_packet_with_one_flipped_bit_is_refused_and_the_next_is_read() {
        for speed_mps in [0.0, 1.0, -0.7, 1e-3, 253.9] {
            let (sent, next) = (uplink(speed_mps), uplink(0.25));
            let packet = encode(&sent).unwrap();
            for bit in 0..packet.len() * 8 {
                let mut bytes = packet.clone();
                bytes[bit / 8] ^= 1 << (bit % 8);
                // A lost closing 0 joins two packets: the decoder must read the one after them.
                let mut stream: Vec<u8, 512> = Vec::new();
                for part in [&bytes, &encode(&uplink(9.0)).unwrap(), &encode(&next).unwrap()] {
                    stream.extend_from_slice(part).unwrap();
                }
                let read = read_all(&stream);
                assert!(!read.contains(&sent), "speed {speed_mps} bit {bit}");
                assert!(read.iter().all(|uplink| [self::uplink(9.0), next].contains(uplink)));
                assert_eq!(read.last(), Some(&next), "speed {speed_mps} bit {bit}");
            }
        }
    }

    #[test]
    fn the_decoder_resynchronises_after_any_garbage() {
        let packet = encode(&uplink(0.5)).unwrap();
        // A small generator of random bytes saves a dependency.
        let mut state = 1_u32;
        for length in (0..600).chain([5_000]) {
            let mut decoder = Decoder::default();
            for _ in 0..length {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let read: Option<Uplink> = decoder.push((state >> 24) as u8);
                assert_eq!(read, None);
            }
            let _: Option<Uplink> = decoder.push(0);
            let read = packet.iter().find_map(|&byte| decoder.push(byte));
            assert_eq!(read, Some(uplink(0.5)), "after {length} bytes");
        }
    }

    #[test]
    fn bytes_after_the_value_refuse_the_packet() {
        assert_eq!(
            value::<Uplink>(&[0, 1, 0, 0]),
            Some(Uplink::Operator(Operator { is_armed: true, ..Operator::default() }))
        );
        assert_eq!(value::<Uplink>(&[0, 1, 0, 0, 0]), None);
        assert_eq!(value::<Uplink>(&[]), None);
    }
}
