//! UBX: NAV-PVT, the one message with position, accuracy and velocity of one epoch.
//!
//! It is 92 bytes long since u-blox 8 and 84 bytes long in u-blox 7 (protocol 14); other lengths
//! are ignored. The decoder keeps the last bytes and checks at each byte whether a whole message
//! ends there, so earlier bytes that look like the start of another message cannot hide one.

use math::GeoPoint;

use super::Solution;

/// What a byte completes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Message {
    /// NAV-PVT.
    Solution(Solution),
    /// Another message with the right checksum.
    Other,
}

/// Lengths of NAV-PVT.
const PAYLOADS: [u8; 2] = [PAYLOAD, PAYLOAD_OF_U_BLOX_7];
const PAYLOAD: u8 = 92;
const PAYLOAD_OF_U_BLOX_7: u8 = 84;

/// The first two bytes of every message.
const SYNC: [u8; 2] = [0xb5, 0x62];

/// Bytes before and after the payload.
const HEADER: usize = 6;
const CHECKSUM: usize = 2;

/// Bytes that are kept: a power of two, at least the longest NAV-PVT with header and checksum.
const KEPT: usize = 128;
const _: () = assert!(KEPT >= PAYLOAD as usize + HEADER + CHECKSUM);

#[derive(Clone, Copy)]
pub(super) struct Decoder {
    /// The last bytes; byte number n is at n modulo [`KEPT`].
    bytes: [u8; KEPT],
    /// Number of the next byte.
    next: usize,
    others: Others,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { bytes: [0; KEPT], next: 0, others: Others::default() }
    }
}

impl Decoder {
    pub(super) fn push(&mut self, byte: u8) -> Option<Message> {
        self.bytes[self.next % KEPT] = byte;
        self.next = self.next.wrapping_add(1);
        let is_other = self.others.push(byte);
        let solution = PAYLOADS.iter().find_map(|&payload| self.nav_pvt(payload));
        solution.map(Message::Solution).or(is_other.then_some(Message::Other))
    }

    /// The NAV-PVT of this length that ends with the last byte.
    fn nav_pvt(&self, payload: u8) -> Option<Solution> {
        let length = HEADER + usize::from(payload) + CHECKSUM;
        let message = Window { bytes: &self.bytes, start: self.next.wrapping_sub(length) };
        let header = [SYNC[0], SYNC[1], 0x01, 0x07, payload, 0];
        let is_nav_pvt = header.iter().enumerate().all(|(at, &byte)| message.byte(at) == byte);
        if !is_nav_pvt {
            return None;
        }
        let end = length - CHECKSUM;
        let sums = (SYNC.len()..end).fold(Sums(0, 0), |sums, at| sums.with(message.byte(at)));
        let is_sound = sums == Sums(message.byte(end), message.byte(end + 1));
        is_sound.then(|| message.solution(payload == PAYLOAD))
    }
}

/// A message among the kept bytes.
struct Window<'a> {
    bytes: &'a [u8; KEPT],
    start: usize,
}

impl Window<'_> {
    fn byte(&self, at: usize) -> u8 {
        self.bytes[self.start.wrapping_add(at) % KEPT]
    }

    /// A byte of the payload.
    fn u8(&self, at: usize) -> u8 {
        self.byte(HEADER + at)
    }

    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes([0, 1, 2, 3].map(|i| self.u8(at + i)))
    }

    fn i32(&self, at: usize) -> i32 {
        self.u32(at) as i32
    }

    /// The solution in this message. `has_flags3`: the longer message has a flag for an invalid
    /// position.
    fn solution(&self, has_flags3: bool) -> Solution {
        let place = GeoPoint { lat_e7: self.i32(28), lon_e7: self.i32(24) };
        // Dead reckoning alone (1) and time alone (5) are not fixes.
        let has_position = matches!(self.u8(20), 2..=4);
        let is_ok = self.u8(21) & 1 != 0;
        let is_refused = has_flags3 && self.u8(78) & 1 != 0;
        Solution {
            is_valid: is_ok && has_position && !is_refused && place.is_valid(),
            place,
            accuracy_mm: self.u32(40),
            velocity_mmps: Some([self.i32(52), self.i32(48)]),
            receiver_ms: Some(self.u32(0)),
        }
    }
}

/// The 8-bit Fletcher checksum.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Sums(u8, u8);

impl Sums {
    fn with(self, byte: u8) -> Self {
        let a = self.0.wrapping_add(byte);
        Self(a, self.1.wrapping_add(a))
    }
}

/// Recognises messages of any kind, to distinguish UBX from noise. It may miss a message after a
/// false start; that does no harm.
#[derive(Clone, Copy)]
struct Others {
    /// Number of bytes of this message so far.
    count: u16,
    payload: u16,
    sums: Sums,
    /// First byte of the checksum.
    first: u8,
}

/// Longer messages count as noise. The longest message that receivers send unasked, raw
/// measurements of 255 signals, has 8,176 bytes.
const LONGEST_PAYLOAD: u16 = 8_192;

impl Default for Others {
    fn default() -> Self {
        Self { count: 0, payload: 0, sums: Sums(0, 0), first: 0 }
    }
}

impl Others {
    /// Whether this byte ends a message with the right checksum.
    fn push(&mut self, byte: u8) -> bool {
        let end = HEADER as u16 + self.payload;
        match self.count {
            0 if byte != SYNC[0] => return false,
            1 if byte != SYNC[1] => return self.restart(byte),
            4 => self.payload = byte.into(),
            5 => self.payload |= u16::from(byte) << 8,
            _ => {}
        }
        match self.count {
            0 | 1 => {}
            2..=5 => self.sums = self.sums.with(byte),
            count if count < end => self.sums = self.sums.with(byte),
            count if count == end => self.first = byte,
            _ => {
                let is_sound = self.sums == Sums(self.first, byte);
                self.restart(byte);
                return is_sound;
            }
        }
        self.count += 1;
        if self.payload > LONGEST_PAYLOAD {
            return self.restart(byte);
        }
        false
    }

    /// Waits for the next message; this byte may begin it.
    fn restart(&mut self, byte: u8) -> bool {
        *self = Self { count: u16::from(byte == SYNC[0]), ..Self::default() };
        false
    }
}
