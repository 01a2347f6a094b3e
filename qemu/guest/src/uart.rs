//! UART0 and the two timers of the MPS2 board, with their interrupts.
//!
//! Registers from Arm's CMSDK (DDI 0479), sections 4.2 and 4.3.

use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use core::task::Waker;
use critical_section::{CriticalSection, Mutex};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

/// Capacity for unread bytes from the line: 90 ms at 115,200 baud.
const RECEIVED_BYTES: usize = 1024;

/// The received bytes, for a task to read.
pub(crate) type Received = Pipe<CriticalSectionRawMutex, RECEIVED_BYTES>;

static RECEIVED: Received = Pipe::new();

const UART0_RECEIVE: u16 = 0;
const TIMER0: u16 = 8;
const TIMER1: u16 = 9;

/// One 32-bit register.
#[derive(Clone, Copy)]
struct Register(usize);

impl Register {
    fn read(self) -> u32 {
        // SAFETY: only the constants below are registers, each of a peripheral of this machine. The
        // only side effect of a read is to take a byte from the UART, as intended.
        unsafe { (self.0 as *const u32).read_volatile() }
    }

    fn write(self, value: u32) {
        // SAFETY: as above; only this module writes them.
        unsafe { (self.0 as *mut u32).write_volatile(value) }
    }
}

mod uart0 {
    use super::Register;
    pub(super) const DATA: Register = Register(0x4000_4000);
    pub(super) const STATE: Register = Register(0x4000_4004);
    pub(super) const CONTROL: Register = Register(0x4000_4008);
    pub(super) const INTERRUPT: Register = Register(0x4000_400c);
    pub(super) const DIVIDER: Register = Register(0x4000_4010);
    pub(super) const SENDER_IS_FULL: u32 = 1;
    pub(super) const RECEIVER_IS_FULL: u32 = 2;
    /// Switches on sender, receiver and an interrupt for each received byte.
    pub(super) const ON: u32 = 0b1011;
    pub(super) const RECEIVED: u32 = 2;
}

struct Timer {
    control: Register,
    value: Register,
    reload: Register,
    interrupt: Register,
}

impl Timer {
    const fn at(base: usize) -> Self {
        Self {
            control: Register(base),
            value: Register(base + 4),
            reload: Register(base + 8),
            interrupt: Register(base + 12),
        }
    }
}

/// Counts down without end; the clock.
const CLOCK: Timer = Timer::at(0x4000_0000);
/// Counts down once; wakes the executor at the next deadline.
const ALARM: Timer = Timer::at(0x4000_1000);
const TIMER_ON: u32 = 0b1001;
/// Both timers run at 25 MHz, embassy's clock at 1 MHz.
const COUNTS_PER_TICK: u64 = 25;

struct TimerDriver {
    /// How often the clock has wrapped.
    wraps: Mutex<Cell<u32>>,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(
    static DRIVER: TimerDriver = TimerDriver {
        wraps: Mutex::new(Cell::new(0)),
        queue: Mutex::new(RefCell::new(Queue::new())),
    }
);

impl Driver for TimerDriver {
    fn now(&self) -> u64 {
        critical_section::with(|cs| self.now_at(cs))
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            if self.queue.borrow_ref_mut(cs).schedule_wake(at, waker) {
                self.arm(cs);
            }
        });
    }
}

impl TimerDriver {
    fn now_at(&self, cs: CriticalSection<'_>) -> u64 {
        let counted = |register: Register| u64::from(u32::MAX - register.read());
        let mut counts = counted(CLOCK.value);
        let mut wraps = self.wraps.borrow(cs).get();
        if CLOCK.interrupt.read() != 0 {
            // The clock has wrapped and its interrupt is pending: count the wrap here, read again.
            wraps = wraps.wrapping_add(1);
            counts = counted(CLOCK.value);
        }
        ((u64::from(wraps) << 32) + counts) / COUNTS_PER_TICK
    }

    /// Wakes the tasks that are due and sets the alarm for the next deadline.
    fn arm(&self, cs: CriticalSection<'_>) {
        let now = self.now_at(cs);
        let next = self.queue.borrow_ref_mut(cs).next_expiration(now);
        ALARM.control.write(0);
        if next != u64::MAX {
            // For a deadline beyond the timer's range, the alarm calls this function again.
            let counts = next.saturating_sub(now).saturating_mul(COUNTS_PER_TICK);
            ALARM.value.write(counts.clamp(1, u64::from(u32::MAX)) as u32);
            ALARM.control.write(TIMER_ON);
        }
    }
}

// SAFETY: the handler shares data with the tasks only in critical sections.
#[cortex_m_rt::exception]
unsafe fn DefaultHandler(interrupt: i16) {
    critical_section::with(|cs| match u16::try_from(interrupt) {
        Ok(UART0_RECEIVE) => {
            uart0::INTERRUPT.write(uart0::RECEIVED);
            while uart0::STATE.read() & uart0::RECEIVER_IS_FULL != 0 {
                // A byte without room is lost, as on any UART; checksums detect that.
                let _ = RECEIVED.try_write(&[uart0::DATA.read() as u8]);
            }
        }
        Ok(TIMER0) => {
            CLOCK.interrupt.write(1);
            let wraps = DRIVER.wraps.borrow(cs);
            wraps.set(wraps.get().wrapping_add(1));
        }
        Ok(TIMER1) => {
            ALARM.control.write(0);
            ALARM.interrupt.write(1);
            DRIVER.arm(cs);
        }
        _ => panic!("unexpected interrupt {interrupt}"),
    });
}

/// An interrupt's number, for the interrupt controller.
#[derive(Clone, Copy)]
struct Line(u16);

// SAFETY: these are the machine's interrupt numbers, and they never change.
unsafe impl cortex_m::interrupt::InterruptNumber for Line {
    fn number(self) -> u16 {
        self.0
    }
}

/// Both directions of UART0.
pub(crate) struct Uart(());

impl Uart {
    /// Starts UART0, the clock and their interrupts. Call it once, before any task runs.
    pub(crate) fn start() -> Self {
        CLOCK.reload.write(u32::MAX);
        CLOCK.value.write(u32::MAX);
        CLOCK.control.write(TIMER_ON);
        // The alarm fires once: the reloaded value is far away.
        ALARM.reload.write(u32::MAX);
        // 25 MHz / 217 = 115,207 baud.
        uart0::DIVIDER.write(217);
        uart0::CONTROL.write(uart0::ON);
        for line in [UART0_RECEIVE, TIMER0, TIMER1].map(Line) {
            // SAFETY: no critical section relies yet on these interrupts being masked.
            unsafe { cortex_m::peripheral::NVIC::unmask(line) };
        }
        Self(())
    }

    /// The received bytes.
    pub(crate) fn reader(&self) -> &'static Received {
        &RECEIVED
    }
}

impl embedded_io_async::ErrorType for Uart {
    type Error = Infallible;
}

impl embedded_io_async::Write for Uart {
    /// Blocks while the line is busy: 87 us per byte, about 40 bytes per packet.
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for &byte in bytes {
            while uart0::STATE.read() & uart0::SENDER_IS_FULL != 0 {}
            uart0::DATA.write(byte.into());
        }
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
