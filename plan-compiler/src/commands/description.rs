//! The contents of a blob as JSON.

use plan_format::{Blob, Counts, FORMAT_VERSION, Grid, Layer};
use serde::Serialize;

/// The JSON object. Programs rely on these names.
#[derive(Serialize)]
pub(super) struct Description<'b> {
    format_version: u16,
    bytes: usize,
    columns: u32,
    rows: u32,
    resolution_m: f64,
    corner_m: [f64; 2],
    origin: Option<Place>,
    /// Bytes of all layers without packing.
    raw_bytes: u64,
    plans: Vec<Parallel<'b>>,
}

#[derive(Serialize)]
struct Place {
    lat_deg: f64,
    lon_deg: f64,
    at_m: [f64; 2],
    heading_rad: f64,
}

#[derive(Serialize)]
struct Parallel<'b> {
    name: &'b str,
    goal_m: [f64; 2],
    layers: Vec<OneLayer<'b>>,
}

#[derive(Serialize)]
struct OneLayer<'b> {
    name: &'b str,
    bytes: usize,
    bytes_per_cell: f64,
    raw_bytes: u64,
    free: u32,
    blocked: u32,
    unreachable: u32,
}

/// Bits of a cell without packing: 4 of direction and 32 of cost.
const RAW_BITS: u64 = 4 + 32;

/// Bytes of a layer without packing.
pub(super) fn raw_bytes(grid: &Grid) -> u64 {
    (grid.cells() as u64 * RAW_BITS).div_ceil(8)
}

/// Bytes of a layer per cell.
pub(super) fn bytes_per_cell(grid: &Grid, bytes: usize) -> f64 {
    bytes as f64 / grid.cells().max(1) as f64
}

/// Describes a blob, which is `bytes` long.
pub(super) fn describe<'b>(blob: &Blob<'b>, bytes: usize) -> Description<'b> {
    let grid = blob.grid();
    let origin = blob.origin().map(|origin| Place {
        lat_deg: origin.place.lat_deg(),
        lon_deg: origin.place.lon_deg(),
        at_m: origin.at_m,
        heading_rad: origin.heading_rad,
    });
    let one_layer = |layer: Layer<'b>| {
        let Counts { free, blocked, unreachable } = layer.counts();
        OneLayer {
            name: layer.name(),
            bytes: layer.bytes(),
            bytes_per_cell: bytes_per_cell(grid, layer.bytes()),
            raw_bytes: raw_bytes(grid),
            free,
            blocked,
            unreachable,
        }
    };
    let plans = blob.parallel_plans().map(|parallel| Parallel {
        name: parallel.name(),
        goal_m: parallel.goal_m(),
        layers: parallel.layers().map(one_layer).collect(),
    });
    let plans: Vec<Parallel<'b>> = plans.collect();
    let layers: usize = plans.iter().map(|plan| plan.layers.len()).sum();
    Description {
        format_version: FORMAT_VERSION,
        bytes,
        columns: grid.columns,
        rows: grid.rows,
        resolution_m: grid.resolution_m,
        corner_m: grid.corner_m,
        origin,
        raw_bytes: raw_bytes(grid) * layers as u64,
        plans,
    }
}
