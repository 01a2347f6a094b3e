//! Runs a mission in lockstep with a simulated world at the other end of two pipes.
//!
//! At the end of the run it prints its memory use, one name and number per line.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    let blob = guest::blob::load();
    let pipe = guest::pipe::Pipe::open();
    let tally = guest::counter::Tally::start();
    guest::executor::run(|spawner| spawner.spawn(robot(blob, pipe, tally).unwrap()), finish)
}

/// The runtime's tasks, joined into one future in static memory.
#[cfg(target_os = "none")]
#[embassy_executor::task]
fn robot(
    blob: &'static plan_format::Blob<'static>,
    pipe: guest::pipe::Pipe,
    tally: guest::counter::Tally,
) -> impl Future<Output = ()> + 'static {
    runtime::lockstep::run(*blob, pipe, tally)
}

/// Size of a function's return type, bytes.
#[cfg(target_os = "none")]
const fn output_bytes<A, B, C, R>(_: &impl Fn(A, B, C) -> R) -> usize {
    size_of::<R>()
}

/// Ends the image: in lockstep no task waits for time, so idle means that the run is over.
#[cfg(target_os = "none")]
fn finish() {
    semihosting::eprintln!("control-state-bytes {}", size_of::<controller::State>());
    semihosting::eprintln!("plan-view-bytes {}", size_of::<plan_format::Blob<'_>>());
    let run = |blob, pipe: guest::pipe::Pipe, tally: guest::counter::Tally| {
        runtime::lockstep::run(blob, pipe, tally)
    };
    semihosting::eprintln!("tasks-bytes {}", output_bytes(&run));
    semihosting::eprintln!("static-bytes {}", guest::memory::static_bytes());
    semihosting::eprintln!("stack-bytes {}", guest::memory::stack_bytes());
    semihosting::process::exit(0)
}

#[cfg(not(target_os = "none"))]
fn main() {
    guest::explain();
}
