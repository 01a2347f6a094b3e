//! Drives a mission in lockstep with a simulated world at the other end of two pipes.
//!
//! When the mission is over it says what memory it took, a name and a number a line.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
use embassy_executor::Spawner;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    let nothing_to_do = || panic!("every task waits, and in lockstep none ever does");
    guest::executor::run(|spawner: Spawner| spawner.spawn(mission().unwrap()), nothing_to_do)
}

/// The runtime's tasks, joined into one future that lies in static memory as on any board.
#[cfg(target_os = "none")]
#[embassy_executor::task]
async fn mission() {
    let pipe = guest::pipe::Pipe::open(guest::counter::Counter::start());
    let robot = runtime::lockstep::drive(guest::plan::load(), pipe);
    let runtime_bytes = size_of_val(&robot);
    robot.await;
    semihosting::eprintln!("control-state-bytes {}", size_of::<controller::State>());
    semihosting::eprintln!("runtime-state-bytes {runtime_bytes}");
    semihosting::eprintln!("stack-bytes {}", guest::stack::high_water_bytes());
    semihosting::process::exit(0)
}

#[cfg(not(target_os = "none"))]
fn main() {
    guest::explain();
}
