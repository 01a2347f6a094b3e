//! Counts instructions exactly, because QEMU derives time from them.

use robot_io::{Commands, Percepts};
use runtime::Observer;

/// The instruction counter. The harness runs the machine with `-icount shift=7`: an instruction
/// takes 128 ns, so CMSDK TIMER0 at 25 MHz counts 3.2 per instruction.
#[derive(Clone, Copy)]
pub struct Counter(());

#[cfg(machine = "mps2-an386")]
mod timer0 {
    pub(super) const CONTROL: *mut u32 = 0x4000_0000 as *mut u32;
    pub(super) const VALUE: *mut u32 = 0x4000_0004 as *mut u32;
    pub(super) const RELOAD: *mut u32 = 0x4000_0008 as *mut u32;
}

#[cfg(machine = "mps2-an386")]
impl Counter {
    /// Starts the timer. It wraps after 32 bits: 171 s of machine time.
    pub fn start() -> Self {
        // SAFETY: these are registers of TIMER0 on this machine; nothing else in the image uses it.
        unsafe {
            timer0::RELOAD.write_volatile(u32::MAX);
            timer0::VALUE.write_volatile(u32::MAX);
            timer0::CONTROL.write_volatile(1);
        }
        Self(())
    }

    fn down_counts(self) -> u32 {
        // SAFETY: as in `start`; reading has no side effect.
        unsafe { timer0::VALUE.read_volatile() }
    }
}

#[cfg(not(machine = "mps2-an386"))]
impl Counter {
    /// Does nothing: this machine has no such timer, and every count is 0.
    pub fn start() -> Self {
        Self(())
    }

    fn down_counts(self) -> u32 {
        0
    }
}

impl Counter {
    /// A mark for [`Counter::since`].
    pub fn mark(self) -> u32 {
        self.down_counts()
    }

    /// Instructions since the mark.
    pub fn since(self, mark: u32) -> u32 {
        let counts = u64::from(mark.wrapping_sub(self.down_counts()));
        // 3.2 counts per instruction, rounded to nearest; the result fits 32 bits.
        ((counts * 10 + 16) / 32) as u32
    }
}

/// Counts the instructions of each tick.
pub struct Tally {
    counter: Counter,
    mark: u32,
}

impl Tally {
    /// Starts the counter.
    pub fn start() -> Self {
        let counter = Counter::start();
        Self { counter, mark: counter.mark() }
    }
}

impl Observer for Tally {
    fn before(&mut self) {
        self.mark = self.counter.mark();
    }

    fn after(&mut self, _percepts: &Percepts, _commands: &Commands) -> u32 {
        self.counter.since(self.mark)
    }
}
