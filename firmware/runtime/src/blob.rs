//! Loads the blob from its region of flash, or falls back on what the build provides.

use math::Vec2;
use plan_format::{Blob, BlobError, Origin, Parameters};

/// What replaces a refused blob. The build chooses it; the default stands still and accepts
/// manual commands only.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fallback {
    /// Speeds and limits.
    pub parameters: Parameters,
    /// Place of the fallback's map metres on the globe.
    pub origin: Option<Origin>,
    /// Goal for the reactive schemas, map metres; `None` to stand still.
    pub goal: Option<Vec2>,
}

/// The blob to drive by.
#[derive(Clone, Copy, Debug)]
pub struct Loaded<'a> {
    /// The validated blob, or the fallback.
    pub blob: Blob<'a>,
    /// Why the flashed blob was refused; `None` if it was not.
    pub refusal: Option<BlobError>,
}

/// Validates the blob in `region` once; after that no look-up can fail.
pub fn load<'a>(region: &'a [u8], fallback: &Fallback) -> Loaded<'a> {
    load_paced(region, fallback, || ())
}

/// As [`load`], for a robot with a running watchdog: calls `beat` at intervals to feed it.
///
/// The blob's length bounds the work and the number of calls, so no blob can keep the robot from
/// starting. If the processor hangs, the next call is late and the watchdog resets it.
pub fn load_paced<'a>(region: &'a [u8], fallback: &Fallback, beat: impl FnMut()) -> Loaded<'a> {
    match Blob::parse_paced(region, beat) {
        Ok(blob) => {
            info!("blob loaded");
            Loaded { blob, refusal: None }
        }
        Err(refusal) => {
            warn!("blob refused: {}", refusal);
            let Fallback { parameters, origin, goal } = *fallback;
            Loaded { blob: Blob::without_map(parameters, origin, goal), refusal: Some(refusal) }
        }
    }
}

/// The flash that the linker script reserves for the plans, from `_plan_start` to `_plan_end`. The
/// blob's header has its length. Empty if the symbols are in the wrong order.
#[cfg(target_os = "none")]
#[expect(unsafe_code, reason = "only the linker knows where the region lies")]
pub fn plan_region() -> &'static [u8] {
    unsafe extern "C" {
        static _plan_start: u8;
        static _plan_end: u8;
    }
    let (start, end) = (&raw const _plan_start, &raw const _plan_end);
    let length = end.addr().saturating_sub(start.addr());
    // SAFETY: every linker script puts both symbols around memory that exists on the chip,
    // belongs to no section of the program and is never written by the program. Bytes need no
    // alignment.
    unsafe { core::slice::from_raw_parts(start, length) }
}
