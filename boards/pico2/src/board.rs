//! Pins, clocks and tasks.

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_rp::gpio::{Input, Level, Output, Pull};
use embassy_rp::pwm::Pwm;
use embassy_rp::uart::{
    self, BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx,
};
use embassy_rp::watchdog::Watchdog;
use embassy_rp::{bind_interrupts, peripherals};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::{Duration, with_timeout};
use embedded_io_async::{ErrorType, Read};
use plan_format::Blob;
use runtime::{Fallback, Robot, Slots, time};
use static_cell::ConstStaticCell;

use crate::robot::{self, Light, Rover};

/// The receiver's baud rate: factory setting of u-blox series 9 and 10 (8 and older: 9600).
const GPS_BAUD: u32 = 38_400;
/// Baud rate of the radio modem.
const LINK_BAUD: u32 = 115_200;
/// Bytes that a UART buffers while the processor is busy: 20 ms at 115,200 baud.
const UART_BYTES: usize = 256;

/// What the tasks share.
static SLOTS: Slots<CriticalSectionRawMutex> = Slots::new();

bind_interrupts!(struct Interrupts {
    UART0_IRQ => BufferedInterruptHandler<peripherals::UART0>;
    UART1_IRQ => BufferedInterruptHandler<peripherals::UART1>;
});

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_rp::init(embassy_rp::config::Config::default());
    // The drivers use these buffers as long as the program runs.
    static GPS_RX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static GPS_TX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static LINK_RX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static LINK_TX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);

    // The motors stop and the watchdog starts before the program reads any data from outside. The
    // check of a blob takes up to seconds and feeds the watchdog; if it hangs, the watchdog resets
    // the rover, which restarts with its motors stopped.
    let left = Pwm::new_output_ab(p.PWM_SLICE0, p.PIN_16, p.PIN_17, robot::stopped());
    let right = Pwm::new_output_ab(p.PWM_SLICE1, p.PIN_18, p.PIN_19, robot::stopped());
    let button = Input::new(p.PIN_15, Pull::Up);
    let watchdog = Watchdog::new(p.WATCHDOG);
    let mut rover = Rover::new(left, right, button, watchdog);
    let light = Light(Output::new(p.PIN_25, Level::Low));
    // Without a valid blob this rover stands still and accepts manual commands only.
    let region = runtime::plan_region();
    let loaded = runtime::load_paced(region, &Fallback::default(), || rover.feed_watchdog());

    // After the check, during which bytes would be lost or grow old.
    let gps = BufferedUart::new(
        p.UART1,
        p.PIN_4,
        p.PIN_5,
        Interrupts,
        GPS_TX.take(),
        GPS_RX.take(),
        at(GPS_BAUD),
    );
    let link = BufferedUart::new(
        p.UART0,
        p.PIN_0,
        p.PIN_1,
        Interrupts,
        LINK_TX.take(),
        LINK_RX.take(),
        at(LINK_BAUD),
    );
    // This board does not configure the receiver, so it sends nothing to it.
    let (_, gps) = gps.split();
    let (telemetry, operator) = link.split();
    // Each task is spawned once, so spawning cannot fail.
    spawner.spawn(gps_task(gps).unwrap());
    spawner.spawn(operator_task(operator).unwrap());
    spawner.spawn(telemetry_task(telemetry).unwrap());
    spawner.spawn(control_task(loaded.blob, rover, light).unwrap());
}

#[embassy_executor::task]
async fn gps_task(reader: BufferedUartRx) {
    runtime::gps_task(Persistent(reader), &SLOTS.fixes, time::now_us).await;
}

#[embassy_executor::task]
async fn operator_task(reader: BufferedUartRx) {
    runtime::operator_task(Persistent(reader), &SLOTS, time::now_us).await;
}

#[embassy_executor::task]
async fn telemetry_task(writer: BufferedUartTx) {
    runtime::telemetry_task(writer, &SLOTS.telemetry).await;
}

#[embassy_executor::task]
async fn control_task(blob: Blob<'static>, mut rover: Rover, light: Light) {
    runtime::control_task(blob, &mut rover, &SLOTS, light).await;
}

/// A UART that is read anew every second: of errors in a row its driver may miss one, and would then
/// wait without end (embassy pull request 7014).
struct Persistent(BufferedUartRx);

impl ErrorType for Persistent {
    type Error = uart::Error;
}

impl Read for Persistent {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Self::Error> {
        loop {
            let read = Read::read(&mut self.0, bytes);
            if let Ok(read) = with_timeout(Duration::from_secs(1), read).await {
                return read;
            }
        }
    }
}

fn at(baudrate: u32) -> uart::Config {
    let mut config = uart::Config::default();
    config.baudrate = baudrate;
    config
}
