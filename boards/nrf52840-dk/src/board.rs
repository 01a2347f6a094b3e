//! Pins, clocks and tasks.

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_nrf::buffered_uarte::{self, BufferedUarte, BufferedUarteRx, BufferedUarteTx};
use embassy_nrf::config::{Config, HfclkSource, LfclkSource};
use embassy_nrf::uarte::{self, Baudrate};
use embassy_nrf::{bind_interrupts, peripherals};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embedded_io_async::{ErrorType, Read};
use plan_format::Blob;
use runtime::{Fallback, Robot, Slots, time};
use static_cell::ConstStaticCell;

use crate::robot::{Light, Rover};

/// The receiver's baud rate: factory setting of u-blox series 9 and 10 (8 and older: 9600).
const GPS_BAUD: Baudrate = Baudrate::Baud38400;
/// Baud rate of the radio modem or of the kit's USB port.
const LINK_BAUD: Baudrate = Baudrate::Baud115200;
/// Bytes that a UART buffers, in two halves, while the processor is busy: 11 ms at 115,200 baud.
const UART_BYTES: usize = 256;

/// What the tasks share.
static SLOTS: Slots<CriticalSectionRawMutex> = Slots::new();

bind_interrupts!(struct Interrupts {
    UARTE0 => buffered_uarte::InterruptHandler<peripherals::UARTE0>;
    UARTE1 => buffered_uarte::InterruptHandler<peripherals::UARTE1>;
});

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_nrf::init(clocks());
    // The drivers use these buffers by DMA as long as the program runs.
    static GPS_RX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static GPS_TX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static LINK_RX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static LINK_TX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);

    let motors = [p.P1_03.into(), p.P1_04.into(), p.P1_05.into(), p.P1_06.into()];
    // The motors stop and the watchdog starts before the program reads any data from outside. The
    // check of a blob takes up to seconds and feeds the watchdog; if it hangs, the watchdog resets
    // the rover, which restarts with its motors stopped.
    let mut rover = Rover::new(p.PWM0, motors, p.P0_11.into(), p.WDT);
    let light = Light::new(p.P0_13.into());
    // Without a valid blob this rover stands still and accepts manual commands only.
    let region = runtime::plan_region();
    let loaded = runtime::load_paced(region, &Fallback::default(), || rover.feed_watchdog());

    // After the check, during which bytes would be lost or grow old.
    let gps = BufferedUarte::new(
        p.UARTE1,
        p.TIMER1,
        p.PPI_CH0,
        p.PPI_CH1,
        p.PPI_GROUP0,
        p.P1_01,
        p.P1_02,
        Interrupts,
        at(GPS_BAUD),
        GPS_RX.take(),
        GPS_TX.take(),
    );
    let link = BufferedUarte::new(
        p.UARTE0,
        p.TIMER2,
        p.PPI_CH2,
        p.PPI_CH3,
        p.PPI_GROUP1,
        p.P0_08,
        p.P0_06,
        Interrupts,
        at(LINK_BAUD),
        LINK_RX.take(),
        LINK_TX.take(),
    );
    // This board does not configure the receiver, so it sends nothing to it.
    let (gps, _) = gps.split();
    let (operator, telemetry) = link.split();
    // Each task is spawned once, so spawning cannot fail.
    spawner.spawn(gps_task(gps).unwrap());
    spawner.spawn(operator_task(operator).unwrap());
    spawner.spawn(telemetry_task(telemetry).unwrap());
    spawner.spawn(control_task(loaded.blob, rover, light).unwrap());
}

#[embassy_executor::task]
async fn gps_task(reader: BufferedUarteRx<'static>) {
    runtime::gps_task(Lossless(reader), &SLOTS.fixes, time::now_us).await;
}

#[embassy_executor::task]
async fn operator_task(reader: BufferedUarteRx<'static>) {
    runtime::operator_task(Lossless(reader), &SLOTS, time::now_us).await;
}

#[embassy_executor::task]
async fn telemetry_task(writer: BufferedUarteTx<'static>) {
    runtime::telemetry_task(writer, &SLOTS.telemetry).await;
}

#[embassy_executor::task]
async fn control_task(blob: Blob<'static>, mut rover: Rover, light: Light) {
    runtime::control_task(blob, &mut rover, &SLOTS, light).await;
}

/// The kit's crystals: the oscillators inside the chip are too inexact for UARTs and time.
fn clocks() -> Config {
    let mut config = Config::default();
    config.hfclk_source = HfclkSource::ExternalXtal;
    config.lfclk_source = LfclkSource::ExternalXtal;
    config
}

/// A UART that resets the chip once it has lost bytes. Its driver counts bytes apart from storing them,
/// so after a loss all later ones would arrive late, orders to stop included.
struct Lossless(BufferedUarteRx<'static>);

impl ErrorType for Lossless {
    type Error = buffered_uarte::Error;
}

impl Read for Lossless {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Self::Error> {
        let read = self.0.read(bytes).await;
        if read.is_err() {
            defmt::error!("a UART has lost bytes");
            cortex_m::peripheral::SCB::sys_reset();
        }
        read
    }
}

fn at(baudrate: Baudrate) -> uarte::Config {
    let mut config = uarte::Config::default();
    config.baudrate = baudrate;
    config
}
