//! Traces: what a robot saw, tick by tick, with the plans that it drove by.
//!
//! A tick is a pure function, so the percepts and the blob are enough to have the whole mission
//! again, inside and out, bit for bit. The file holds the eight bytes `WAYTRACE`, the version (2)
//! as `u16`, the trace hash of the mission as `u64`, the blob's length as `u32` and the blob, then
//! for each tick the length as `u16` and the percepts in postcard; all numbers little-endian.

pub mod story;

use plan_format::Blob;
use robot_io::{Percepts, TraceHash};
use thiserror::Error;

/// The first bytes of every trace.
pub const MAGIC: &[u8; 8] = b"WAYTRACE";
const VERSION: u16 = 2;

/// A mission as a robot saw it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The plans, as the robot had them.
    pub blob: Vec<u8>,
    /// What each tick saw.
    pub percepts: Vec<Percepts>,
    /// The trace hash that the robot had at the end.
    pub hash: u64,
}

/// Why bytes are no trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TraceError {
    /// Other bytes at the beginning.
    #[error("this is no trace: it does not begin with WAYTRACE")]
    Magic,
    /// A newer or older trace.
    #[error("this trace is of version {0}; this program reads version {VERSION}")]
    Version(u16),
    /// The file ends early.
    #[error("the trace ends within tick {0}: it was cut off")]
    Truncated(usize),
    /// A tick that cannot be read.
    #[error("tick {0} of the trace is damaged")]
    Damaged(usize),
}

impl Trace {
    /// The bytes of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(&self.hash.to_le_bytes());
        bytes.extend_from_slice(&(self.blob.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&self.blob);
        let mut buffer = [0; robot_io::limits::MAX_WIRE_BYTES];
        for percepts in &self.percepts {
            let encoded =
                postcard::to_slice(percepts, &mut buffer).expect("the largest percept fits");
            bytes.extend_from_slice(&(encoded.len() as u16).to_le_bytes());
            bytes.extend_from_slice(encoded);
        }
        bytes
    }

    /// Reads the bytes of a file. Whether the blob is sound is for [`Blob::parse_exact`] to say.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TraceError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(TraceError::Magic)?;
        let cut = TraceError::Truncated(0);
        let (version, rest) = rest.split_first_chunk().ok_or(cut)?;
        let version = u16::from_le_bytes(*version);
        if version != VERSION {
            return Err(TraceError::Version(version));
        }
        let (hash, rest) = rest.split_first_chunk().ok_or(cut)?;
        let (length, rest) = rest.split_first_chunk().ok_or(cut)?;
        let (blob, mut rest) =
            rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or(cut)?;
        let mut percepts = Vec::new();
        while !rest.is_empty() {
            let tick = percepts.len();
            let (length, after) = rest.split_first_chunk().ok_or(TraceError::Truncated(tick))?;
            let (encoded, after) = after
                .split_at_checked(u16::from_le_bytes(*length).into())
                .ok_or(TraceError::Truncated(tick))?;
            let (seen, unread) =
                postcard::take_from_bytes(encoded).map_err(|_| TraceError::Damaged(tick))?;
            if !unread.is_empty() {
                return Err(TraceError::Damaged(tick));
            }
            percepts.push(seen);
            rest = after;
        }
        Ok(Self { blob: blob.to_vec(), percepts, hash: u64::from_le_bytes(*hash) })
    }

    /// The trace hash of the same mission, driven again by this build.
    pub fn replayed_hash(&self, blob: &Blob<'_>) -> u64 {
        let mut state = controller::State::new(blob);
        let mut hash = TraceHash::default();
        for percepts in &self.percepts {
            let commands = controller::tick(blob, &mut state, percepts);
            hash.record(percepts, &commands);
        }
        hash.get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace() -> Trace {
        let percepts = |tick: u64| Percepts { time_us: tick * 50_000, ..Percepts::default() };
        Trace { blob: vec![1, 2, 3], percepts: (0..4).map(percepts).collect(), hash: 0x1234 }
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(Trace::from_bytes(&trace().to_bytes()), Ok(trace()));
    }

    #[test]
    fn what_is_no_trace_says_why() {
        let bytes = trace().to_bytes();
        let ends: Vec<usize> = (0..=4)
            .map(|ticks| {
                let percepts = trace().percepts[..ticks].to_vec();
                Trace { percepts, ..trace() }.to_bytes().len()
            })
            .collect();
        for length in 0..bytes.len() {
            let read = Trace::from_bytes(&bytes[..length]);
            // A trace that was cut off between two ticks is a shorter trace.
            assert_eq!(read.is_ok(), ends.contains(&length), "cut to {length}: {read:?}");
        }
        let mut other = bytes.clone();
        other[8] += 1;
        assert_eq!(Trace::from_bytes(&other), Err(TraceError::Version(VERSION + 1)));
        let mut damaged = bytes;
        let last = damaged.len() - 1;
        damaged[last] = 0xff;
        assert_eq!(Trace::from_bytes(&damaged), Err(TraceError::Damaged(3)));
    }
}
