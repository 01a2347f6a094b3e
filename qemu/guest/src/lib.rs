//! The QEMU board: the shared code of the images in `src/bin`.
//!
//! The robot's runtime on an emulated Cortex-M4F (mps2-an386) or, from the same source, a Cortex-M3
//! without FPU (lm3s6965evb). For the runtime this is one more board. The images:
//!
//! - `mission`: runs in lockstep with a simulated world over semihosting pipes, in discrete time.
//!   The clock is the tick number, so the trace does not depend on the speed of the host.
//! - `instructions`: counts the instructions of a look-up, of a tick and of validating the blob.
//! - `panic_free`: links only if a tick cannot panic.
//! - `uart`: runs on an emulated UART, timer interrupts and WFI, with bytes as they arrive.
//!
//! Invariants: equal records give equal traces on both machines and on a host; an image that
//! panics or faults reports it and ends with status 101.
//!
//! Deliberately absent: peripherals that no test needs, and any decision about driving.
#![cfg_attr(target_os = "none", no_std)]
#![allow(unsafe_code)]

#[cfg(target_os = "none")]
pub mod blob;
#[cfg(target_os = "none")]
pub mod counter;
#[cfg(target_os = "none")]
pub mod executor;
#[cfg(target_os = "none")]
mod fault;
#[cfg(target_os = "none")]
pub mod memory;
#[cfg(target_os = "none")]
pub mod pipe;

/// Explains an image that was started on a host.
#[cfg(not(target_os = "none"))]
pub fn explain() {
    eprintln!("This image runs in QEMU, not on the host. Try `cargo demo` or `cargo mission`.");
}
