//! Links only if reading a blob, the tick, and the robot's inputs and outputs cannot panic.
//!
//! The panic handler calls a function that does not exist. If nothing can panic, the linker drops
//! the handler; otherwise it reports that function as missing. The image is never run. It proves
//! this for release images only: debug images check for overflow, and that check can panic.
//!
//! Covered: validation, look-ups, the whole tick with its behaviours, trace hash, records, the
//! packets of the link in both directions, and the receiver's drivers from bytes to fix and state.
//! Deliberately absent: the polling of the tasks and the third-party executor, which can panic as
//! far as the compiler knows, and the drivers of the board.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod gate {
    #![allow(unsafe_code, reason = "the missing function, and memory for its arguments")]

    use controller::State;
    use core::hint::black_box;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use plan_format::{Answer, Blob};
    use robot_io::packet::{Decoder, Downlink, Uplink, encode};
    use robot_io::{CommandRecord, Percepts, SensorRecord, TraceHash};
    use runtime::{FixSlot, gps};

    unsafe extern "C" {
        fn a_panic_can_be_reached() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        // SAFETY: the function does not exist, so a program that calls it does not link.
        unsafe { a_panic_can_be_reached() }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let region: &[u8] = black_box(&[]);
        if let Ok(blob) = Blob::parse(region) {
            look_up(&blob);
            let mut state = State::new(&blob);
            let mut trace = TraceHash::default();
            let mut link = Decoder::default();
            let mut receiver = gps::Decoder::default();
            let fixes = FixSlot::<NoopRawMutex>::new();
            loop {
                hear(&mut receiver, &fixes);
                black_box(link.push::<Uplink>(black_box(0)));
                let time_us = black_box(0);
                let percepts = Percepts {
                    time_us,
                    fix: fixes.latest(),
                    receiver: fixes.receiver(time_us),
                    ..black_box(Percepts::default())
                };
                let commands = controller::tick(&blob, &mut state, &percepts);
                trace.record(&percepts, &commands);
                let record = CommandRecord {
                    time_us,
                    commands,
                    trace_hash: trace.get(),
                    instructions: 0,
                    receiver: percepts.receiver,
                    checks: state.checks(),
                    news: state.team.news(&blob.parameters().team),
                    goal: state.goal(),
                };
                black_box(encode(&Downlink::Telemetry(record)));
                black_box(record.to_bytes());
                black_box(SensorRecord::from_bytes(region));
            }
        }
        cortex_m::asm::udf()
    }

    /// Does what the GPS task does with the bytes of one read.
    fn hear(receiver: &mut gps::Decoder, fixes: &FixSlot<NoopRawMutex>) {
        let now_us = black_box(0);
        for &byte in black_box(&[0; 64]) {
            if let Some(solution) = receiver.push(byte) {
                fixes.store(solution.at(now_us));
            }
        }
        fixes.hear(now_us, &receiver.take_heard());
    }

    fn look_up(blob: &Blob<'_>) {
        let layers = blob.find(black_box("")).and_then(|parallel| parallel.layer(black_box(1)));
        let cell = blob.cell_at(black_box(math::Vec2::new(1.0, 2.0)));
        black_box(layers.zip(cell).map_or(Answer::OffMap, |(layer, cell)| layer.look_up(cell)));
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    guest::explain();
}
