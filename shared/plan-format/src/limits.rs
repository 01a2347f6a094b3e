//! Every capacity of the format by its name. The compiler refuses what exceeds them and
//! the reader refuses blobs that claim more.

/// Parallel plans in one blob.
pub const MAX_PLANS: usize = 64;
/// Layers in one parallel plan.
pub const MAX_LAYERS: usize = 8;
/// Bytes of a name, UTF-8.
pub const MAX_NAME_BYTES: usize = 32;
/// Cells along one side of the grid.
pub const MAX_SIDE_CELLS: u32 = 16_384;
/// Bytes of a whole blob.
pub const MAX_BLOB_BYTES: usize = 64 << 20;
/// Smallest and largest side of a cell, metres.
pub const RESOLUTION_RANGE_M: (f64, f64) = (0.001, 1_000.0);
/// Farthest coordinate of the grid from the map's origin, metres. Single-precision
/// positions keep a step of 8 mm there.
pub const MAX_COORDINATE_M: f64 = 100_000.0;
/// Farthest map coordinate of the geodetic reference, metres. Fixes are refused 20 km from the
/// reference, so one that is farther from the grid than this serves nobody.
pub const MAX_ORIGIN_M: f64 = 2.0 * MAX_COORDINATE_M;

const _: () = assert!(MAX_PLANS * MAX_LAYERS <= u16::MAX as usize);
const _: () = assert!(MAX_NAME_BYTES <= u8::MAX as usize);
const _: () = assert!(MAX_SIDE_CELLS <= 1 << 14, "a cell index must fit 28 bits");
