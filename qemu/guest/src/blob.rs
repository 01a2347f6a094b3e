//! Loads the blob from the region that QEMU's loader filled.

use plan_format::Blob;
use static_cell::StaticCell;

/// The blob in the region, or a fallback that stands still. Reports a refusal to the harness. Call
/// it once only.
pub fn load() -> &'static Blob<'static> {
    static BLOB: StaticCell<Blob<'static>> = StaticCell::new();
    let loaded = runtime::load(runtime::plan_region(), &runtime::Fallback::default());
    if let Some(refusal) = loaded.refusal {
        semihosting::eprintln!("plan refused: code {}, {}", refusal.code(), refusal);
    }
    BLOB.init(loaded.blob)
}
