//! The capacities of the format. The compiler refuses a mission that exceeds one; the reader
//! refuses a blob that claims more.

pub use math::grid::{MAX_COORDINATE_M, MAX_SIDE_CELLS, RESOLUTION_RANGE_M};

/// Parallel plans in one blob.
pub const MAX_PLANS: usize = 64;
/// Layers in one parallel plan.
pub const MAX_LAYERS: usize = 8;
/// Goals of one parallel plan.
pub const MAX_GOALS: usize = 16;
/// Bytes of a name, UTF-8.
pub const MAX_NAME_BYTES: usize = 32;
/// Bytes of a whole blob.
pub const MAX_BLOB_BYTES: usize = 64 << 20;
/// Layers in one blob.
pub const MAX_BLOB_LAYERS: usize = MAX_PLANS * MAX_LAYERS;
/// Checks that validation may spend per word of section `cells`: slightly more than one word of a
/// table can require (a superblock's 16 blocks and 79 entries). So the blob's length bounds the
/// time at boot, and only overlapping tables exceed the limit.
pub const MAX_CHECKS_PER_WORD: u32 = 100;
/// Approximate number of checks between two beats of [`crate::Blob::parse_paced`].
pub const CHECKS_PER_BEAT: u32 = 1 << 16;
/// Bytes that the checksum covers between two beats.
pub const CHECKSUM_BYTES_PER_BEAT: usize = 1 << 16;
/// Farthest map coordinate of the geodetic reference, metres. A reference farther from the grid is
/// useless, because fixes more than 20 km from it are refused.
pub const MAX_ORIGIN_M: f64 = 2.0 * MAX_COORDINATE_M;

/// Behaviours of a mission.
pub const MAX_BEHAVIOURS: usize = 16;
/// Live components of all behaviours together: the robot's pool.
pub const MAX_COMPONENTS: usize = 48;
/// Levels of a live plan; tail recursion adds none.
pub const MAX_DEPTH: usize = 8;
/// Decomposition steps in one tick.
pub const MAX_STEPS: usize = 8;
/// Aspects of interest.
pub const MAX_INPUTS: usize = 32;
/// Input channels in the percepts.
pub const MAX_CHANNELS: usize = 8;
/// Robots of a team.
pub const MAX_ROBOTS: usize = 5;
/// Digital outputs.
pub const MAX_OUTPUTS: usize = 16;
/// Rows of all rule bases together.
pub const MAX_RULES: usize = 128;
/// Rule bases.
pub const MAX_RULE_BASES: usize = 64;
/// Facts: the bits of a `u64`.
pub const MAX_FACTS: usize = 64;
/// Facts about want of progress: the robot measures it anew for each.
pub const MAX_PROGRESS_FACTS: usize = 4;
/// Descriptions of plan frames and actions.
pub const MAX_DESCRIPTIONS: usize = 128;
/// Atomic actions.
pub const MAX_ACTIONS: usize = 64;
/// Plan frames.
pub const MAX_FRAMES: usize = 64;
/// Productions of all plan frames together.
pub const MAX_PRODUCTIONS: usize = 128;
/// Edges of all productions together.
pub const MAX_EDGES: usize = 512;
/// Edges of one production: a live plan frame keeps a bit for each.
pub const MAX_PRODUCTION_EDGES: usize = 16;
/// Productions of one plan frame, which keeps a bit for each that it has tried.
pub const MAX_ALTERNATIVES: usize = 16;
/// Vertices of one production.
pub const MAX_VERTICES: usize = 16;
/// Protection intervals of all productions together.
pub const MAX_INTERVALS: usize = 128;
/// Bytes of all names of a mission together: as many names as the limits above allow, each of
/// [`MAX_NAME_BYTES`].
pub const MAX_MISSION_NAMES_BYTES: usize = MAX_NAME_BYTES
    * (MAX_INPUTS + MAX_FACTS + MAX_ACTIONS + MAX_FRAMES + MAX_PRODUCTIONS + MAX_BEHAVIOURS);

const _: () = assert!(MAX_GOALS <= 1 << crate::layout::GOAL_BITS);
const _: () = assert!(MAX_FACTS == u64::BITS as usize);
const _: () = assert!(MAX_VERTICES <= u32::BITS as usize);
const _: () = assert!(MAX_BEHAVIOURS <= u16::BITS as usize, "sets of behaviours are u16");
const _: () = assert!(MAX_BLOB_LAYERS <= u16::MAX as usize);
const _: () = assert!((MAX_BLOB_BYTES / 4) as u64 * MAX_CHECKS_PER_WORD as u64 <= u32::MAX as u64);
const _: () = assert!(MAX_NAME_BYTES <= u8::MAX as usize);
const _: () = assert!(MAX_MISSION_NAMES_BYTES < u16::MAX as usize, "offsets of names are u16");
const _: () = assert!(MAX_SIDE_CELLS <= 1 << 14, "a cell index must fit 28 bits");
