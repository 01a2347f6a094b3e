//! Mutations of seeds, the same on every run and every machine.

/// An endless iterator over mutations of some seeds.
#[derive(Clone, Debug)]
pub struct Mutations<'s> {
    seeds: &'s [Vec<u8>],
    random: Random,
}

/// Byte sequences that often break readers of texts and numbers.
const WORDS: &[&[u8]] = &[
    b"0",
    b"-1",
    b"1e9",
    b"1e308",
    b"-0.0",
    b"nan",
    b"inf",
    b"16384",
    b"4294967295",
    b"\"",
    b"\\",
    b"[",
    b"]",
    b"{",
    b"}",
    b"<",
    b">",
    b",",
    b"\n",
    b"\r",
    b"\t",
    b"*",
    b"/",
    b"\xc3\xbc",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"\x80\x80\x80\x80\x80\x01",
    b"\x1b[31m",
];

impl<'s> Mutations<'s> {
    /// The mutations that a random seed number gives.
    pub fn new(seeds: &'s [Vec<u8>], number: u64) -> Self {
        Self { seeds, random: Random::new(number) }
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        let at = self.random.below(bytes.len() + 1);
        let end = (at + 1 + self.random.below(16)).min(bytes.len());
        match self.random.below(9) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let again = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
            3 | 4 => {
                let word = WORDS[self.random.below(WORDS.len())];
                bytes.splice(at..end, word.iter().copied());
            }
            5 => {
                let other = &self.seeds[self.random.below(self.seeds.len())];
                let from = self.random.below(other.len() + 1);
                let to = (from + self.random.below(64)).min(other.len());
                bytes.splice(at..at, other[from..to].iter().copied());
            }
            6 => {
                if let Some(digit) = bytes[at..].iter_mut().find(|byte| byte.is_ascii_digit()) {
                    *digit = b'0' + self.random.below(10) as u8;
                }
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << self.random.below(8);
                }
            }
        }
    }
}

impl Iterator for Mutations<'_> {
    type Item = Vec<u8>;

    /// Ends only if there is no seed.
    fn next(&mut self) -> Option<Vec<u8>> {
        if self.seeds.is_empty() {
            return None;
        }
        let mut bytes = self.seeds[self.random.below(self.seeds.len())].clone();
        for _ in 0..=self.random.below(4) {
            self.change(&mut bytes);
        }
        Some(bytes)
    }
}

/// A small random number generator (xorshift64*, after Marsaglia). Only repeatability matters here.
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Uniform in `0..limit`.
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        ((self.next() >> 32) as usize * limit) >> 32
    }

    /// Uniform in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1 << 24) as f32
    }
}
