//! This board's motors, button, light and watchdog.

use embassy_nrf::Peri;
use embassy_nrf::gpio::{AnyPin, Input, Level, Output, OutputDrive, Pull};
use embassy_nrf::peripherals::{PWM0, WDT};
use embassy_nrf::pwm::{DutyCycle, Prescaler, SimpleConfig, SimplePwm};
use embassy_nrf::wdt::{self, HaltConfig, Watchdog, WatchdogHandle};
use robot_io::{CommandRecord, Commands, Operator, Percepts};
use runtime::drive::Differential;
use runtime::{Observer, Robot, time};

/// Measure these on the rover; the plan's parameters hold its limits.
const BODY: Differential = Differential { track_m: 0.4, full_speed_mps: 2.0 };
/// PWM steps: the 16 MHz clock divided by them gives 20 kHz, which nobody hears.
const FULL_DUTY: u16 = 800;
/// The watchdog bites when five ticks are missed, or when the check of the blob has not gone on for
/// as long: between two of its beats lie at most some three million instructions, a twentieth of
/// a second. In periods of 32,768 Hz. The reset floats
/// the motor pins, which a motor driver reads as: coast.
const WATCHDOG_PERIODS: u32 = 32_768 / 4;

/// Two motors behind an H bridge with two inputs each, such as a DRV8833.
pub(crate) struct Rover {
    motors: SimplePwm<'static>,
    button: Input<'static>,
    was_pressed: bool,
    is_armed: bool,
    watchdog: Option<WatchdogHandle>,
    pace: time::Pace,
}

impl Rover {
    /// Motors stand still. `motor_pins`: left ahead, left astern, right ahead, right astern.
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
        config.action_during_debug_halt = HaltConfig::Pause;
        // Refused only if it runs already with other settings, as after a reset by a
        // debugger; then the next power-up has it.
        let watchdog = Watchdog::try_new::<_, 1>(watchdog, config).ok().map(|(_, [handle])| handle);
        if watchdog.is_none() {
            defmt::warn!("no watchdog until the next power-up");
        }
        Self {
            motors,
            button: Input::new(button, Pull::Up),
            was_pressed: false,
            is_armed: false,
            watchdog,
            pace: time::Pace::default(),
        }
    }

    /// Each press of the button arms or disarms. Read once a tick, which is slower than contacts
    /// bounce.
    fn by_button(&mut self) -> Operator {
        let is_pressed = self.button.is_low();
        self.is_armed ^= is_pressed && !self.was_pressed;
        self.was_pressed = is_pressed;
        Operator { is_armed: self.is_armed, ..Operator::default() }
    }
}

impl Robot for Rover {
    async fn wait(&mut self) -> Option<u64> {
        Some(self.pace.next().await)
    }

    /// The kit alone has no compass, odometry or range sensors: the heading is the course of
    /// the fixes, and nothing but the plan keeps the rover off obstacles. Add yours here.
    async fn sense(&mut self, percepts: &mut Percepts) {
        percepts.operator = self.by_button();
    }

    async fn act(&mut self, record: &CommandRecord) {
        let [left, right] = BODY.mix(&record.commands).map(duties);
        self.motors.set_all_duties([left[0], left[1], right[0], right[1]]);
    }

    fn feed_watchdog(&mut self) {
        if let Some(watchdog) = &mut self.watchdog {
            watchdog.pet();
        }
    }
}

/// The light, lit while the robot is armed.
pub(crate) struct Light(Output<'static>);

impl Light {
    /// Dark.
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

/// The two inputs of one motor, ahead and astern, for a drive of -1 ..= 1.
fn duties(drive: f32) -> [DutyCycle; 2] {
    let ahead = (drive.max(0.0) * f32::from(FULL_DUTY)) as u16;
    let astern = ((-drive).max(0.0) * f32::from(FULL_DUTY)) as u16;
    // Inverted polarity means: high while the counter is below the duty.
    [DutyCycle::inverted(ahead), DutyCycle::inverted(astern)]
}
