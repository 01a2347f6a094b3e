//! Finding the plan: the blob in its region of flash, or what the build falls back on.

use math::Vec2;
use plan_format::{Blob, BlobError, Origin, Parameters};

use crate::log;

/// What to drive by when the blob is refused. A build decides it; the default stands still
/// and takes manual commands only.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fallback {
    /// Speeds and limits.
    pub parameters: Parameters,
    /// Where the fallback's metres lie on the globe.
    pub origin: Option<Origin>,
    /// Where to go by the reactive schemas alone; `None`: nowhere.
    pub goal: Option<Vec2>,
}

/// What there is to drive by.
#[derive(Clone, Copy, Debug)]
pub struct Loaded<'a> {
    /// The validated blob, or the fallback.
    pub blob: Blob<'a>,
    /// Why the blob was refused, if it was.
    pub refusal: Option<BlobError>,
}

/// Validates the blob in `region`, once; after that no look-up can fail.
pub fn load<'a>(region: &'a [u8], fallback: &Fallback) -> Loaded<'a> {
    load_paced(region, fallback, || ())
}

/// As [`load`], for a robot whose watchdog is awake: `beat` is called while the work goes on, and
/// feeds it. The work is bounded by the blob's length, and so are the calls, so a blob cannot keep
/// the robot from starting; a processor that hangs in it is reset when the next beat is late.
pub fn load_paced<'a>(region: &'a [u8], fallback: &Fallback, beat: impl FnMut()) -> Loaded<'a> {
    match Blob::parse_paced(region, beat) {
        Ok(blob) => {
            info!("blob loaded");
            Loaded { blob, refusal: None }
        }
        Err(refusal) => {
            warn!("plan refused: {}", log::debug(&refusal));
            let Fallback { parameters, origin, goal } = *fallback;
            Loaded { blob: Blob::without_map(parameters, origin, goal), refusal: Some(refusal) }
        }
    }
}

/// The flash that the linker script keeps for the plans, from `_plan_start` to `_plan_end`. The
/// blob's header says how much of it counts. Empty if the symbols are in the wrong order.
#[cfg(target_os = "none")]
#[expect(unsafe_code, reason = "the linker knows where the region lies, the compiler does not")]
pub fn plan_region() -> &'static [u8] {
    unsafe extern "C" {
        static _plan_start: u8;
        static _plan_end: u8;
    }
    let (start, end) = (&raw const _plan_start, &raw const _plan_end);
    let length = end.addr().saturating_sub(start.addr());
    // SAFETY: every linker script lays both symbols around memory that the chip has, that
    // belongs to no section of the program and that the program does not write. Bytes need no
    // alignment.
    unsafe { core::slice::from_raw_parts(start, length) }
}
