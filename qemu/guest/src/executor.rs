//! Runs embassy tasks and waits for interrupts with WFI.
//!
//! embassy's own thread executor waits with WFE, which QEMU treats as a busy loop.

use core::sync::atomic::{AtomicBool, Ordering};
use embassy_executor::{Spawner, raw};
use static_cell::StaticCell;

/// Set when a task can run.
static IS_PENDING: AtomicBool = AtomicBool::new(false);

#[unsafe(export_name = "__pender")]
fn pender(_context: *mut ()) {
    IS_PENDING.store(true, Ordering::Release);
}

/// Runs the tasks that `init` spawns and never returns. When every task waits, it calls `idle` with
/// interrupts off: `idle` sleeps or ends the run.
pub fn run(init: impl FnOnce(Spawner), mut idle: impl FnMut()) -> ! {
    static EXECUTOR: StaticCell<raw::Executor> = StaticCell::new();
    let executor: &'static raw::Executor = EXECUTOR.init(raw::Executor::new(core::ptr::null_mut()));
    init(executor.spawner());
    loop {
        // SAFETY: the executor is initialised, and only this line polls it, in thread mode.
        unsafe { executor.poll() };
        // Interrupts are off so that none can occur between the check and the sleep; WFI still
        // wakes for a pending one.
        cortex_m::interrupt::free(|_| {
            if !IS_PENDING.swap(false, Ordering::Acquire) {
                idle();
            }
        });
    }
}
