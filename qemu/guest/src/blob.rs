//! The region that holds the plans, as QEMU's loader filled it.

use plan_format::Blob;
use static_cell::StaticCell;

unsafe extern "C" {
    static _plan_start: u8;
    static _plan_end: u8;
}

/// The whole region. The blob's header says how much of it counts.
pub fn region() -> &'static [u8] {
    // SAFETY: the linker's symbols span memory that exists in the machine, is not used for
    // anything else and that nobody writes after the loader.
    unsafe { runtime::blob::region(&raw const _plan_start, &raw const _plan_end) }
}

/// The plan in the region, or one to stand still by. A refusal is told to the harness. Once.
pub fn load() -> &'static Blob<'static> {
    static BLOB: StaticCell<Blob<'static>> = StaticCell::new();
    let loaded = runtime::load(region(), &runtime::Fallback::default());
    if let Some(refusal) = loaded.refusal {
        semihosting::eprintln!("plan refused: code {}, {}", refusal.code(), refusal);
    }
    BLOB.init(loaded.blob)
}
