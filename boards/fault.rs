//! Panics and faults, on every board: the chip resets at once.
//!
//! The motors' PWM goes on while a processor is halted or loops, so an endless loop would drive the
//! robot on until the watchdog ends it. A reset releases the pins; on the RP2350, where it resets the
//! cores only, the start of the program stops the PWM. The message of a panic is in the log, if a probe
//! reads it in time.

#![allow(unsafe_code, reason = "a handler of faults is an unsafe function")]

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    defmt::error!("{}", defmt::Display2Format(info));
    SCB::sys_reset()
}

// SAFETY: it touches nothing of the program and never returns.
#[cortex_m_rt::exception]
unsafe fn HardFault(_frame: &cortex_m_rt::ExceptionFrame) -> ! {
    SCB::sys_reset()
}
