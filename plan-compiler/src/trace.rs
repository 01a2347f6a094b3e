//! Traces: the percepts of a run, tick by tick, with the blob that the robot used.
//!
//! A tick is a pure function, so the percepts and the blob are enough to repeat the whole run bit
//! for bit. The file contains the eight bytes `WAYTRACE`, the version (4) as `u16`, the trace hash
//! of the run as `u64`, the blob's length as `u32` and the blob, then for each tick the length as
//! `u16` and the percepts in postcard; all numbers are little-endian.

pub mod fold;
pub mod story;

use plan_format::Blob;
use robot_io::{Percepts, TraceHash};
use thiserror::Error;

/// The first bytes of every trace.
pub const MAGIC: &[u8; 8] = b"WAYTRACE";
const VERSION: u16 = 4;

/// A recorded run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The blob that the robot used.
    pub blob: Vec<u8>,
    /// The percepts of each tick.
    pub percepts: Vec<Percepts>,
    /// The robot's trace hash at the end.
    pub hash: u64,
}

/// Why bytes are not a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TraceError {
    /// The first bytes are wrong.
    #[error("not a trace: it does not begin with WAYTRACE")]
    Magic,
    /// The trace has another version.
    #[error("the trace has version {0}; this program reads version {VERSION}")]
    Version(u16),
    /// The file ends early.
    #[error("the trace is cut off in tick {0}")]
    Truncated(usize),
    /// A tick cannot be read.
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

    /// Reads the bytes of a file. Does not check the blob; [`Blob::parse_exact`] does.
    ///
    /// # Errors
    /// Fails if the bytes are not a complete trace of this version.
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

    /// The trace hash of the same run, repeated by this build.
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
