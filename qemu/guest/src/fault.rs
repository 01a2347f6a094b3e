//! Panics and faults: reports the first one to the harness and stops the machine.

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

/// Exit status of an image that panicked or faulted, as in Rust programs.
const FAILED: i32 = 101;

/// Set by the first panic, so that a panic while formatting its message cannot recurse.
static IS_PANICKING: AtomicBool = AtomicBool::new(false);

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    if !IS_PANICKING.swap(true, Ordering::Relaxed) {
        semihosting::eprintln!("{info}");
    }
    semihosting::process::exit(FAILED)
}

// SAFETY: runs once, at the highest priority, and never returns.
#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    semihosting::eprintln!("hard fault at {:#010x}", frame.pc());
    semihosting::process::exit(FAILED)
}
