//! Pins, clocks and tasks.

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_stm32::gpio::{Input, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::time::{Hertz, khz, mhz};
use embassy_stm32::timer::low_level::CountingMode;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embassy_stm32::usart::{self, BufferedUart, BufferedUartRx, BufferedUartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, peripherals, rcc};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use plan_format::Blob;
use runtime::{Fallback, Robot, Slots, time};
use static_cell::ConstStaticCell;

use crate::robot::{Light, Rover};

/// The receiver's baud rate: factory setting of u-blox series 9 and 10 (8 and older: 9600).
const GPS_BAUD: u32 = 38_400;
/// Baud rate of the radio modem.
const LINK_BAUD: u32 = 115_200;
/// Bytes that a UART buffers while the processor is busy: 20 ms at 115,200 baud.
const UART_BYTES: usize = 256;
/// PWM frequency, inaudible.
const PWM: Hertz = khz(20);
/// The crystal of the kit. For another crystal, change this and the divider in [`clocks`].
const CRYSTAL: Hertz = mhz(12);
/// Watchdog timeout: five ticks. The check of the blob feeds the watchdog too. The chip's slow
/// clock, 17 to 47 kHz instead of 32, makes it 170 to 470 ms.
const WATCHDOG_US: u32 = 250_000;

/// What the tasks share.
static SLOTS: Slots<CriticalSectionRawMutex> = Slots::new();

bind_interrupts!(struct Interrupts {
    USART3 => usart::BufferedInterruptHandler<peripherals::USART3>;
    USART6 => usart::BufferedInterruptHandler<peripherals::USART6>;
});

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_stm32::init(clocks());
    // The drivers use these buffers as long as the program runs.
    static GPS_RX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static GPS_TX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static LINK_RX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);
    static LINK_TX: ConstStaticCell<[u8; UART_BYTES]> = ConstStaticCell::new([0; UART_BYTES]);

    // The motors stop and the watchdog starts before the program reads any data from outside. The
    // check of a blob takes up to seconds and feeds the watchdog; if it hangs, the watchdog resets
    // the rover, which restarts with its motors stopped.
    let left = SimplePwm::new(
        p.TIM3,
        Some(PwmPin::new(p.PA6, OutputType::PushPull)),
        Some(PwmPin::new(p.PA7, OutputType::PushPull)),
        None,
        None,
        PWM,
        CountingMode::EdgeAlignedUp,
    );
    let right = SimplePwm::new(
        p.TIM4,
        None,
        None,
        Some(PwmPin::new(p.PB8, OutputType::PushPull)),
        Some(PwmPin::new(p.PB9, OutputType::PushPull)),
        PWM,
        CountingMode::EdgeAlignedUp,
    );
    let button = Input::new(p.PC3, Pull::Up);
    let watchdog = IndependentWatchdog::new(p.IWDG, WATCHDOG_US);
    let mut rover = Rover::new(left, right, button, watchdog);
    let light = Light(Output::new(p.PC1, Level::Low, Speed::Low));
    // Without a valid blob this rover stands still and accepts manual commands only.
    let region = runtime::plan_region();
    let loaded = runtime::load_paced(region, &Fallback::default(), || rover.feed_watchdog());

    // After the check, during which bytes would be lost or grow old.
    let gps = BufferedUart::new(
        p.USART3,
        p.PB11,
        p.PB10,
        GPS_TX.take(),
        GPS_RX.take(),
        Interrupts,
        at(GPS_BAUD),
    )
    .unwrap();
    let link = BufferedUart::new(
        p.USART6,
        p.PC7,
        p.PC6,
        LINK_TX.take(),
        LINK_RX.take(),
        Interrupts,
        at(LINK_BAUD),
    )
    .unwrap();
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
async fn gps_task(reader: BufferedUartRx<'static>) {
    runtime::gps_task(reader, &SLOTS.fixes, time::now_us).await;
}

#[embassy_executor::task]
async fn operator_task(reader: BufferedUartRx<'static>) {
    runtime::operator_task(reader, &SLOTS, time::now_us).await;
}

#[embassy_executor::task]
async fn telemetry_task(writer: BufferedUartTx<'static>) {
    runtime::telemetry_task(writer, &SLOTS.telemetry).await;
}

#[embassy_executor::task]
async fn control_task(blob: Blob<'static>, mut rover: Rover, light: Light) {
    runtime::control_task(blob, &mut rover, &SLOTS, light).await;
}

fn at(baudrate: u32) -> usart::Config {
    let mut config = usart::Config::default();
    config.baudrate = baudrate;
    // A line without a sender is idle.
    config.rx_pull = Pull::Up;
    config
}

/// 168 MHz from the crystal; the timers of the motors and of the time driver run at 84 MHz.
fn clocks() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(rcc::Hse { freq: CRYSTAL, mode: rcc::HseMode::Oscillator });
    rcc.pll_src = rcc::PllSource::HSE;
    rcc.pll = Some(rcc::Pll {
        prediv: rcc::PllPreDiv::DIV12,
        mul: rcc::PllMul::MUL336,
        divp: Some(rcc::PllPDiv::DIV2),
        divq: None,
        divr: None,
    });
    rcc.sys = rcc::Sysclk::PLL1_P;
    rcc.ahb_pre = rcc::AHBPrescaler::DIV1;
    rcc.apb1_pre = rcc::APBPrescaler::DIV4;
    rcc.apb2_pre = rcc::APBPrescaler::DIV2;
    config
}
