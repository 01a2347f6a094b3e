//! The QEMU board: what the images in `src/bin` share.
//!
//! The robot's own runtime on an emulated Cortex-M4F (mps2-an386) or, from the same source, a
//! Cortex-M3 without FPU (lm3s6965evb). To the runtime this is one more board. The images:
//!
//! - `mission`: in lockstep with a simulated world over semihosting pipes, in discrete time:
//!   the clock is the number of the tick. Nothing depends on how fast the host is, so a mission
//!   gives the same trace on every run.
//! - `instructions`: counts what a look-up, a tick and a validation of the blob cost.
//! - `panic_free`: links only if a tick cannot panic.
//! - `uart`: on a real (emulated) UART, timer interrupts and WFI, with bytes as they come.
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

/// What an image does when it is run on a host.
#[cfg(not(target_os = "none"))]
pub fn explain() {
    eprintln!("This image runs in QEMU, not on the host. Try `cargo demo` or `cargo mission`.");
}
