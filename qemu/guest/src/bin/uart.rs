//! The robot on real peripherals: GPS bytes come and telemetry goes on UART0, ticks are paced
//! by a timer's interrupts, and the core sleeps in between.
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
    use runtime::{FixSlot, Robot, Telemetry, control_task, gps_task, telemetry_task};
    use static_cell::StaticCell;

    struct UartRobot {
        pace: Pace,
        telemetry: &'static Telemetry<NoopRawMutex>,
    }

    impl Robot for UartRobot {
        async fn wait(&mut self) -> Option<u64> {
            Some(self.pace.next().await)
        }

        async fn sense(&mut self, percepts: &mut Percepts) {
            percepts.operator = Operator { is_armed: true, ..Operator::default() };
        }

        async fn act(&mut self, record: &CommandRecord) {
            self.telemetry.signal(*record);
        }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        static FIXES: StaticCell<FixSlot<NoopRawMutex>> = StaticCell::new();
        static TELEMETRY: StaticCell<Telemetry<NoopRawMutex>> = StaticCell::new();
        let blob = guest::blob::load();
        let uart = Uart::start();
        let fixes = &*FIXES.init(FixSlot::new());
        let telemetry = &*TELEMETRY.init(Telemetry::new());
        let init = |spawner: Spawner| {
            spawner.spawn(gps(uart.reader(), fixes).unwrap());
            spawner.spawn(control(blob, telemetry, fixes).unwrap());
            spawner.spawn(link(uart, telemetry).unwrap());
        };
        guest::executor::run(init, cortex_m::asm::wfi)
    }

    #[embassy_executor::task]
    async fn gps(reader: &'static super::uart::Received, fixes: &'static FixSlot<NoopRawMutex>) {
        gps_task(reader, fixes, now_us).await;
    }

    #[embassy_executor::task]
    async fn control(
        blob: &'static Blob<'static>,
        telemetry: &'static Telemetry<NoopRawMutex>,
        fixes: &'static FixSlot<NoopRawMutex>,
    ) {
        let mut robot = UartRobot { pace: Pace::default(), telemetry };
        control_task(*blob, &mut robot, fixes).await;
    }

    #[embassy_executor::task]
    async fn link(uart: Uart, telemetry: &'static Telemetry<NoopRawMutex>) {
        telemetry_task(uart, telemetry).await;
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
