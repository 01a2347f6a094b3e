//! This board's motors, button, light and watchdog.

use embassy_nrf::Peri;
use embassy_nrf::gpio::{AnyPin, Input, Level, Output, OutputDrive, Pull};
use embassy_nrf::peripherals::{PWM0, WDT};
use embassy_nrf::pwm::{DutyCycle, Prescaler, SimpleConfig, SimplePwm};
use embassy_nrf::wdt::{self, HaltConfig, Watchdog, WatchdogHandle};
use robot_io::{CommandRecord, Commands, Percepts};
use runtime::mixer::Mixer;
use runtime::{ArmButton, Observer, Robot, time};

/// Measure these on the rover. The blob's parameters have its limits.
const MIXER: Mixer = Mixer { track_m: 0.4, full_speed_mps: 2.0 };
/// PWM steps: the 16 MHz clock divided by them gives 20 kHz, which is inaudible.
const FULL_DUTY: u16 = 800;
/// Watchdog timeout, in periods of 32,768 Hz: five ticks. The check of the blob feeds the watchdog
/// at least every three million instructions, a twentieth of a second. A reset floats the motor
/// pins, and the motor driver then coasts.
const WATCHDOG_PERIODS: u32 = 32_768 / 4;

/// Two motors behind an H bridge with two inputs each, such as a DRV8833.
pub(crate) struct Rover {
    motors: SimplePwm<'static>,
    button: Input<'static>,
    arming: ArmButton,
    watchdog: Option<WatchdogHandle>,
    pace: time::Pace,
}

impl Rover {
    /// A rover with stopped motors. `motor_pins`: left ahead, left astern, right ahead, right
    /// astern.
    pub(crate) fn new(
        pwm: Peri<'static, PWM0>,
        motor_pins: [Peri<'static, AnyPin>; 4],
        button: Peri<'static, AnyPin>,
        watchdog: Peri<'static, WDT>,
    ) -> Self {
        let mut pwm_config = SimpleConfig::default();
        pwm_config.prescaler = Prescaler::Div1;
        pwm_config.max_duty = FULL_DUTY;
        let [a, b, c, d] = motor_pins;
        let mut motors = SimplePwm::new_4ch(pwm, a, b, c, d, &pwm_config);
        motors.set_all_duties([DutyCycle::inverted(0); 4]);

        let mut config = wdt::Config::default();
        config.timeout_ticks = WATCHDOG_PERIODS;
        // The motors go on while a debugger halts the processor.
        config.action_during_debug_halt = HaltConfig::Run;
        // Fails only if the watchdog already runs with other settings, as after a reset by a
        // debugger; then it works from the next power-up on.
        let watchdog = Watchdog::try_new::<_, 1>(watchdog, config).ok().map(|(_, [handle])| handle);
        if watchdog.is_none() {
            defmt::warn!("no watchdog until the next power-up");
        }
        Self {
            motors,
            button: Input::new(button, Pull::Up),
            arming: ArmButton::default(),
            watchdog,
            pace: time::Pace::default(),
        }
    }
}

impl Robot for Rover {
    async fn wait(&mut self) -> Option<u64> {
        Some(self.pace.next().await)
    }

    /// The kit has no compass, odometry or range sensors: the heading is the course of the fixes,
    /// and only the plan keeps the rover away from obstacles. Add your sensors here.
    async fn sense(&mut self, percepts: &mut Percepts) {
        percepts.operator = self.arming.read(self.button.is_low());
    }

    async fn act(&mut self, record: &CommandRecord) {
        let [left, right] = MIXER.mix(&record.commands).map(duties);
        self.motors.set_all_duties([left[0], left[1], right[0], right[1]]);
    }

    fn feed_watchdog(&mut self) {
        if let Some(watchdog) = &mut self.watchdog {
            watchdog.pet();
        }
    }
}

/// An LED, lit while the order to arm stands: the robot may drive off at any moment.
pub(crate) struct Light(Output<'static>);

impl Light {
    /// An LED that is off.
    pub(crate) fn new(pin: Peri<'static, AnyPin>) -> Self {
        Self(Output::new(pin, Level::High, OutputDrive::Standard))
    }
}

impl Observer for Light {
    fn after(&mut self, percepts: &Percepts, _commands: &Commands) -> u32 {
        self.0.set_level(if percepts.operator.is_armed { Level::Low } else { Level::High });
        0
    }
}

/// The two inputs of one motor, ahead and astern, for an output of -1 ..= 1.
fn duties(output: f32) -> [DutyCycle; 2] {
    let ahead = (output.max(0.0) * f32::from(FULL_DUTY)) as u16;
    let astern = ((-output).max(0.0) * f32::from(FULL_DUTY)) as u16;
    // With inverted polarity the pin is high while the counter is below the duty.
    [DutyCycle::inverted(ahead), DutyCycle::inverted(astern)]
}
