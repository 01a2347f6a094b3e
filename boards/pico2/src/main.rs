//! Wayfield on the Raspberry Pi Pico 2: a rover with two motors, a GPS receiver and a radio.
//!
//! This file is the architecture of the firmware: which task runs on which pins. Everything
//! that decides lies in other crates; `robot.rs` is what this board does to a motor and a
//! button. To make another board, copy the folder (see `boards/README.md`).
//!
//! ```text
//! GPS --- UART1  -> gps -------- SLOTS.fixes -----+
//! radio - UART0  -> operator --- SLOTS.operator --+--> control --> PWM0, PWM1 --> motors
//! radio <- UART0  - telemetry <- SLOTS.telemetry -+
//! ```
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod robot;

/// What happens when the program for the board is started on a host.
#[cfg(not(target_os = "none"))]
fn main() {
    println!(
        "This program runs on a Raspberry Pi Pico 2. In its folder, with the board connected:"
    );
    println!("    cargo run --profile firmware");
}
