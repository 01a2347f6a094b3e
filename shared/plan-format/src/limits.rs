//! Every capacity of the format by its name. The compiler refuses what exceeds them and
//! the reader refuses blobs that claim more.

pub use math::grid::{MAX_COORDINATE_M, MAX_SIDE_CELLS, RESOLUTION_RANGE_M};

/// Parallel plans in one blob.
pub const MAX_PLANS: usize = 64;
/// Layers in one parallel plan.
pub const MAX_LAYERS: usize = 8;
/// Bytes of a name, UTF-8.
pub const MAX_NAME_BYTES: usize = 32;
/// Bytes of a whole blob.
pub const MAX_BLOB_BYTES: usize = 64 << 20;
/// Layers in one blob.
pub const MAX_BLOB_LAYERS: usize = MAX_PLANS * MAX_LAYERS;
/// Checks that validating the cells may take for each of their words: a bit more than the most
/// that a word of a table leads to (a superblock's 16 blocks and 79 entries). So time at boot is
/// bounded by the blob's bytes, and only tables that lie on one another exceed it.
pub const MAX_CHECKS_PER_WORD: u32 = 100;
/// Checks from one beat of [`crate::Blob::parse_paced`] to the next, about.
pub const CHECKS_PER_BEAT: u32 = 1 << 16;
/// Bytes under the checksum from one beat to the next.
pub const CHECKSUM_BYTES_PER_BEAT: usize = 1 << 16;
/// Farthest map coordinate of the geodetic reference, metres. Fixes are refused 20 km from the
/// reference, so one that is farther from the grid than this is useless.
pub const MAX_ORIGIN_M: f64 = 2.0 * MAX_COORDINATE_M;

/// Behaviours of a mission.
pub const MAX_BEHAVIOURS: usize = 16;
/// Live components of all behaviours together: the robot's pool.
pub const MAX_COMPONENTS: usize = 32;
/// How deep frames may lie in frames at one time; tail recursion adds nothing.
pub const MAX_DEPTH: usize = 8;
/// Decomposition steps in one tick.
pub const MAX_STEPS: usize = 8;
/// Aspects of interest.
pub const MAX_INPUTS: usize = 32;
/// Input channels in the percepts.
pub const MAX_CHANNELS: usize = 8;
/// Digital outputs.
pub const MAX_OUTPUTS: usize = 16;
/// Rows of all rule bases together.
pub const MAX_RULES: usize = 128;
/// Rule bases.
pub const MAX_RULE_BASES: usize = 64;
/// Facts: the bits of a `u64`.
pub const MAX_FACTS: usize = 64;
/// Descriptions of frames and actions.
pub const MAX_DESCRIPTIONS: usize = 128;
/// Atomic actions.
pub const MAX_ACTIONS: usize = 64;
/// Plan frames.
pub const MAX_FRAMES: usize = 64;
/// Productions of all frames together.
pub const MAX_PRODUCTIONS: usize = 128;
/// Edges of all productions together.
pub const MAX_EDGES: usize = 512;
/// Edges of one production: the live plan keeps a bit for each.
pub const MAX_PRODUCTION_EDGES: usize = 16;
/// Productions of one frame: the live plan keeps a bit for each that was tried.
pub const MAX_ALTERNATIVES: usize = 16;
/// Vertices of one production.
pub const MAX_VERTICES: usize = 16;
/// Protection intervals of all productions together.
pub const MAX_INTERVALS: usize = 128;

const _: () = assert!(MAX_FACTS == u64::BITS as usize);
const _: () = assert!(MAX_VERTICES <= u32::BITS as usize);
const _: () = assert!(MAX_COMPONENTS <= u32::BITS as usize, "sets of components are u32");
const _: () = assert!(MAX_BEHAVIOURS <= u16::BITS as usize, "sets of behaviours are u16");
const _: () = assert!(MAX_BLOB_LAYERS <= u16::MAX as usize);
const _: () = assert!((MAX_BLOB_BYTES / 4) as u64 * MAX_CHECKS_PER_WORD as u64 <= u32::MAX as u64);
const _: () = assert!(MAX_NAME_BYTES <= u8::MAX as usize);
const _: () = assert!(MAX_SIDE_CELLS <= 1 << 14, "a cell index must fit 28 bits");
