//! Links only if no panic can be reached from what reads a blob or ticks.
//!
//! Its panic handler calls a function that does not exist. The linker drops the handler if
//! nothing can panic, and otherwise names that function as missing. Never run. Only of release
//! images: debug ones check for overflow, and that check is a panic.
//!
//! Covered: validation, look-ups, the whole tick with its behaviours, trace hash, records and
//! the link's frames. Deliberately absent: the parsers of UBX and NMEA, which are made by others
//! and can panic as far as the compiler sees, and the executor.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod gate {
    #![allow(unsafe_code, reason = "the missing function, and memory for its arguments")]

    use controller::State;
    use core::hint::black_box;
    use plan_format::{Answer, Plan};
    use robot_io::frame::{Decoder, Uplink};
    use robot_io::{CommandRecord, Percepts, SensorRecord, TraceHash};

    unsafe extern "C" {
        fn a_panic_can_be_reached() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        // SAFETY: it does not exist, so a program that calls it does not link.
        unsafe { a_panic_can_be_reached() }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let region: &[u8] = black_box(&[]);
        if let Ok(plan) = Plan::parse(region) {
            look_up(&plan);
            let mut state = State::new(&plan);
            let mut trace = TraceHash::default();
            let mut link = Decoder::default();
            loop {
                black_box(link.push::<Uplink>(black_box(0)));
                let percepts: Percepts = black_box(Percepts::default());
                let commands = controller::tick(&plan, &mut state, &percepts);
                trace.record(&percepts, &commands);
                let record = CommandRecord {
                    time_us: 0,
                    commands,
                    trace_hash: trace.get(),
                    instructions: 0,
                };
                black_box(record.to_bytes());
                black_box(SensorRecord::from_bytes(region));
            }
        }
        cortex_m::asm::udf()
    }

    fn look_up(plan: &Plan<'_>) {
        let layers = plan.find(black_box("")).and_then(|parallel| parallel.layer(black_box(1)));
        let cell = plan.cell_at(black_box(math::Vec2::new(1.0, 2.0)));
        black_box(layers.zip(cell).map_or(Answer::OffMap, |(layer, cell)| layer.look_up(cell)));
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    guest::explain();
}
