//! The robot on emulated peripherals: UART0 receives GPS bytes and sends telemetry, a timer's
//! interrupts pace the ticks, and the core sleeps in between.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_code, reason = "interrupt handlers, in the module")]

#[cfg(all(target_os = "none", machine = "mps2-an386"))]
#[path = "../uart.rs"]
mod uart;

#[cfg(all(target_os = "none", machine = "mps2-an386"))]
mod robot {
    use super::uart::Uart;
    use embassy_executor::Spawner;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use plan_format::Blob;
    use robot_io::{CommandRecord, Operator, Percepts};
    use runtime::time::{Pace, now_us};
    use runtime::{Robot, Slots, control_task, gps_task, telemetry_task};
    use static_cell::StaticCell;

    struct UartRobot {
        pace: Pace,
    }

    impl Robot for UartRobot {
        async fn wait(&mut self) -> Option<u64> {
            Some(self.pace.next().await)
        }

        async fn sense(&mut self, percepts: &mut Percepts) {
            percepts.operator = Operator { is_armed: true, ..Operator::default() };
        }

        /// This machine has no motors.
        async fn act(&mut self, _record: &CommandRecord) {}

        /// This machine has no watchdog: the harness notices that a robot hangs.
        fn feed_watchdog(&mut self) {}
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        static SLOTS: StaticCell<Slots<NoopRawMutex>> = StaticCell::new();
        let blob = guest::blob::load();
        let uart = Uart::start();
        let slots = &*SLOTS.init(Slots::new());
        let init = |spawner: Spawner| {
            spawner.spawn(gps(uart.reader(), slots).unwrap());
            spawner.spawn(control(blob, slots).unwrap());
            spawner.spawn(telemetry(uart, slots).unwrap());
        };
        guest::executor::run(init, cortex_m::asm::wfi)
    }

    #[embassy_executor::task]
    async fn gps(reader: &'static super::uart::Received, slots: &'static Slots<NoopRawMutex>) {
        gps_task(reader, &slots.fixes, now_us).await;
    }

    #[embassy_executor::task]
    async fn control(blob: &'static Blob<'static>, slots: &'static Slots<NoopRawMutex>) {
        let mut robot = UartRobot { pace: Pace::default() };
        control_task(*blob, &mut robot, slots, ()).await;
    }

    #[embassy_executor::task]
    async fn telemetry(uart: Uart, slots: &'static Slots<NoopRawMutex>) {
        telemetry_task(uart, &slots.telemetry).await;
    }
}

#[cfg(all(target_os = "none", not(machine = "mps2-an386")))]
#[cortex_m_rt::entry]
fn main() -> ! {
    panic!("this image is for the mps2-an386 only");
}

#[cfg(not(target_os = "none"))]
fn main() {
    guest::explain();
}
