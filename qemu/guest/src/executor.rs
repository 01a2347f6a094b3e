//! Runs embassy tasks and waits for interrupts with WFI.
//!
//! embassy's own thread executor waits with WFE, which QEMU treats as a busy loop.

use core::sync::atomic::{AtomicBool, Ordering};
use embassy_executor::{Spawner, raw};
use static_cell::StaticCell;

/// Some task can run.
static IS_PENDING: AtomicBool = AtomicBool::new(false);

#[unsafe(export_name = "__pender")]
fn pender(_context: *mut ()) {
    IS_PENDING.store(true, Ordering::Release);
}

/// Runs the tasks that `init` spawns, for ever. `idle` is called, with interrupts off, when
/// every task waits: it sleeps or ends the mission.
pub fn run(init: impl FnOnce(Spawner), mut idle: impl FnMut()) -> ! {
    static EXECUTOR: StaticCell<raw::Executor> = StaticCell::new();
    let executor: &'static raw::Executor = EXECUTOR.init(raw::Executor::new(core::ptr::null_mut()));
    init(executor.spawner());
    loop {
        // SAFETY: the executor is initialised and this is the only place that polls it, from
        // thread mode.
        unsafe { executor.poll() };
        // Interrupts off, so that none can slip in between the look and the sleep; WFI wakes
        // for a pending one all the same.
        cortex_m::interrupt::free(|_| {
            if !IS_PENDING.swap(false, Ordering::Acquire) {
                idle();
            }
        });
    }
}
