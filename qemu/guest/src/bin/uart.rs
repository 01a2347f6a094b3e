//! Drives a mission in lockstep with the harness.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    let mut pipe = guest::pipe::Pipe::open().expect("pipes");
    let mut b = [0u8; 1024];
    let counter = guest::counter::Counter::start();
    let mut n = 0u32;
    while pipe.read(&mut b) {
        let m = counter.mark();
        n += 1;
        let c = counter.since(m);
        b[..4].copy_from_slice(&n.to_le_bytes());
        b[4..8].copy_from_slice(&c.to_le_bytes());
        b[8..12].copy_from_slice(&guest::plan::region()[..4]);
        pipe.write(&b[..64]);
    }
    semihosting::eprintln!("stack_bytes {}", guest::stack::high_water_bytes());
    semihosting::process::exit(0)
}

#[cfg(not(target_os = "none"))]
fn main() {
    guest::explain();
}
