//! This board's motors, button, light and watchdog.

use embassy_rp::gpio::{Input, Level, Output};
use embassy_rp::pwm::{self, Pwm};
use embassy_rp::watchdog::Watchdog;
use embassy_time::Duration;
use robot_io::{CommandRecord, Commands, Percepts};
use runtime::mixer::Mixer;
use runtime::{ArmButton, Observer, Robot, time};

/// Measure these on the rover. The blob's parameters have its limits.
const MIXER: Mixer = Mixer { track_m: 0.4, full_speed_mps: 2.0 };
/// PWM steps: the 150 MHz clock divided by them gives 20 kHz, which is inaudible.
const FULL_DUTY: u16 = 7_500;
/// Watchdog timeout: five ticks. The check of the blob feeds the watchdog too.
const WATCHDOG: Duration = Duration::from_millis(250);

/// Two motors behind an H bridge with two inputs each, such as a DRV8833.
pub(crate) struct Rover {
    left: Pwm<'static>,
    right: Pwm<'static>,
    button: Input<'static>,
    arming: ArmButton,
    watchdog: Watchdog,
    pace: time::Pace,
}

impl Rover {
    /// A rover with motors set by [`stopped`] and a running watchdog.
    pub(crate) fn new(
        left: Pwm<'static>,
        right: Pwm<'static>,
        button: Input<'static>,
        mut watchdog: Watchdog,
    ) -> Self {
        // The motors go on while a debugger halts the processor.
        watchdog.pause_on_debug(false);
        watchdog.start(WATCHDOG);
        Self {
            left,
            right,
            button,
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
        let [left, right] = MIXER.mix(&record.commands);
        self.left.set_config(&turning(left));
        self.right.set_config(&turning(right));
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.feed(WATCHDOG);
    }
}

/// An LED, lit while the order to arm stands: the robot may drive off at any moment.
pub(crate) struct Light(pub(crate) Output<'static>);

impl Observer for Light {
    fn after(&mut self, percepts: &Percepts, _commands: &Commands) -> u32 {
        self.0.set_level(if percepts.operator.is_armed { Level::High } else { Level::Low });
        0
    }
}

/// PWM settings of a stopped motor.
pub(crate) fn stopped() -> pwm::Config {
    turning(0.0)
}

/// PWM settings of the two inputs of one motor, A ahead and B astern, for an output of -1 ..= 1.
fn turning(output: f32) -> pwm::Config {
    let duty = |share: f32| (share.clamp(0.0, 1.0) * f32::from(FULL_DUTY)) as u16;
    let mut config = pwm::Config::default();
    // The counter takes FULL_DUTY values, from 0.
    config.top = FULL_DUTY - 1;
    config.compare_a = duty(output);
    config.compare_b = duty(-output);
    config
}
