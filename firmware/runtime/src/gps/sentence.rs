//! NMEA 0183: from bytes to sentences with the right checksum.
//!
//! A sentence ends with the second digit of its checksum, so the line end does not matter. A `$`
//! always begins a new sentence.

/// Most bytes between `$` and `*`. The standard allows 79; many decimals and the name of a
/// reference station can exceed that.
const BODY_BYTES: usize = 192;

/// What a byte completes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Heard<'a> {
    /// A sentence with the right checksum: the bytes between `$` and `*`.
    Sentence(&'a [u8]),
    /// A sentence without a checksum, or with a wrong one.
    Unchecked,
}

/// Finds sentences in a stream of bytes.
pub(super) struct Reader {
    body: [u8; BODY_BYTES],
    length: usize,
    /// Exclusive or of the body so far.
    sum: u8,
    part: Part,
}

/// The part of a sentence that the next byte belongs to.
#[derive(Clone, Copy)]
enum Part {
    Outside,
    Body,
    FirstDigit,
    /// Carries the value of the first digit.
    SecondDigit(u8),
}

impl Default for Reader {
    fn default() -> Self {
        Self { body: [0; BODY_BYTES], length: 0, sum: 0, part: Part::Outside }
    }
}

impl Reader {
    /// Takes the next byte.
    pub(super) fn push(&mut self, byte: u8) -> Option<Heard<'_>> {
        let part = core::mem::replace(&mut self.part, Part::Outside);
        match (part, byte) {
            (_, b'$') => {
                (self.length, self.sum, self.part) = (0, 0, Part::Body);
                None
            }
            (Part::Body, b'*') => {
                self.part = Part::FirstDigit;
                None
            }
            (Part::Body, b' '..=b'~') => {
                self.keep(byte);
                None
            }
            (Part::Body, b'\r' | b'\n') => self.unchecked(),
            // Not a sentence.
            (Part::Outside | Part::Body, _) => None,
            (Part::FirstDigit, _) => match digit(byte) {
                Some(first) => {
                    self.part = Part::SecondDigit(first);
                    None
                }
                None => self.unchecked(),
            },
            (Part::SecondDigit(first), _) => match digit(byte) {
                Some(second) if first << 4 | second == self.sum => {
                    self.body.get(..self.length).map(Heard::Sentence)
                }
                _ => self.unchecked(),
            },
        }
    }

    /// Keeps a byte of the body; drops a body that is too long.
    fn keep(&mut self, byte: u8) {
        if let Some(slot) = self.body.get_mut(self.length) {
            *slot = byte;
            self.length += 1;
            self.sum ^= byte;
            self.part = Part::Body;
        }
    }

    /// Reports a missing or wrong checksum if the body looks like a sentence, not like noise.
    fn unchecked(&self) -> Option<Heard<'_>> {
        let (address, rest) = self.body.get(..self.length)?.split_at_checked(5)?;
        let is_address = address.iter().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit());
        (is_address && rest.contains(&b',')).then_some(Heard::Unchecked)
    }
}

/// The value of a hexadecimal digit.
fn digit(byte: u8) -> Option<u8> {
    match byte {
        b'0'..=b'9' => Some(byte - b'0'),
        b'A'..=b'F' => Some(byte - b'A' + 10),
        b'a'..=b'f' => Some(byte - b'a' + 10),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::String;
    use std::vec::Vec;

    /// Compares what the reader hears: sentences, and `?` for a missing or wrong checksum.
    fn check(bytes: &[u8], expected: &[&str]) {
        let mut reader = Reader::default();
        let heard: Vec<String> = bytes
            .iter()
            .filter_map(|&byte| {
                reader.push(byte).map(|heard| match heard {
                    Heard::Sentence(body) => String::from_utf8_lossy(body).into_owned(),
                    Heard::Unchecked => "?".into(),
                })
            })
            .collect();
        assert_eq!(heard, expected, "{}", String::from_utf8_lossy(bytes));
    }

    #[test]
    fn a_sentence_ends_with_its_checksum_whatever_follows() {
        for end in ["", "\r\n", "\n", "\r", "\r\r\n", "  \r\n", "\t\n", "\0"] {
            for sum in ["*6a", "*6A"] {
                let text = ["$GPXYZ,1;", sum, end].concat();
                check(text.repeat(2).as_bytes(), &["GPXYZ,1;"; 2]);
            }
        }
    }

    #[test]
    fn no_checksum_and_a_wrong_one_are_heard_as_such() {
        check(b"$GPXYZ,1;\r\n$GPXYZ,1;*6B\r\n$GPXYZ,1;*\r\n$GPXYZ,1;*6\r\n", &["?"; 4]);
        check(b"$GPXYZ,1;\r\n$GPXYZ,1;*6A\r\n", &["?", "GPXYZ,1;"]);
        // Noise with a `$` in it is not a sentence.
        check(b"$\r\n$1\n$ab cd ef,\r\n$GP\xffYZ,1\r\n$GPXYZ\r\n", &[]);
    }

    #[test]
    fn a_dollar_sign_begins_a_sentence_and_a_long_one_is_dropped() {
        check(b"+GPSRD:$GPXY$GPXYZ,1;*6A", &["GPXYZ,1;"]);
        check(b"$GPXYZ,1;*$GPXYZ,1;*6$GPXYZ,1;*6A", &["GPXYZ,1;"]);
        for (length, is_read) in [(BODY_BYTES, true), (BODY_BYTES + 1, false)] {
            let body = "A".repeat(length);
            let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
            let text = std::format!("${body}*{sum:02X}\r\n$GPXYZ,1;*6A");
            let expected = if is_read { &[&body[..], "GPXYZ,1;"][..] } else { &["GPXYZ,1;"] };
            check(text.as_bytes(), expected);
        }
    }
}
