//! Wayfield on the Adafruit Feather STM32F405: a rover with two motors, a GPS receiver and a radio.
//!
//! `board.rs` connects tasks to pins, as below; `robot.rs` drives this board's motors and reads
//! its button. All decisions are in other crates. To add a board, copy the folder (see
//! `boards/README.md`).
//!
//! ```text
//! GPS --- USART3 -> gps -------- SLOTS.fixes -----+
//! radio - USART6 -> operator --- SLOTS.operator --+--> control --> TIM3, TIM4 --> motors
//! radio <- USART6 - telemetry <- SLOTS.telemetry -+
//! ```
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
#[path = "../../fault.rs"]
mod fault;
#[cfg(target_os = "none")]
mod robot;

/// Explains itself when started on a host.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an STM32F405RG. In its folder, with the board connected:");
    println!("    cargo run --profile firmware");
}
