//! This board's motors, button, light and watchdog.

use embassy_stm32::gpio::{Input, Level, Output};
use embassy_stm32::peripherals::{IWDG1, TIM3};
use embassy_stm32::timer::Channel;
use embassy_stm32::timer::simple_pwm::SimplePwm;
use embassy_stm32::wdg::IndependentWatchdog;
use robot_io::{CommandRecord, Commands, Percepts};
use runtime::mixer::Mixer;
use runtime::{ArmButton, Observer, Robot, time};

/// Measure these on the rover. The blob's parameters have its limits.
const MIXER: Mixer = Mixer { track_m: 0.4, full_speed_mps: 2.0 };
/// Channels of the left motor: ahead, astern.
const LEFT: [Channel; 2] = [Channel::Ch1, Channel::Ch2];
/// Channels of the right motor: ahead, astern.
const RIGHT: [Channel; 2] = [Channel::Ch3, Channel::Ch4];

/// Two motors behind an H bridge with two inputs each, such as a DRV8833.
pub(crate) struct Rover {
    motors: SimplePwm<'static, TIM3>,
    button: Input<'static>,
    arming: ArmButton,
    watchdog: IndependentWatchdog<'static, IWDG1>,
    pace: time::Pace,
}

impl Rover {
    /// A rover with stopped motors and a running watchdog.
    pub(crate) fn new(
        mut motors: SimplePwm<'static, TIM3>,
        button: Input<'static>,
        mut watchdog: IndependentWatchdog<'static, IWDG1>,
    ) -> Self {
        // The timer starts with duties of 0.
        for channel in LEFT.into_iter().chain(RIGHT) {
            motors.channel(channel).enable();
        }
        watchdog.unleash();
        Self { motors, button, arming: ArmButton::default(), watchdog, pace: time::Pace::default() }
    }
}

impl Robot for Rover {
    async fn wait(&mut self) -> Option<u64> {
        Some(self.pace.next().await)
    }

    /// The kit has no compass, odometry or range sensors: the heading is the course of the fixes,
    /// and only the plan keeps the rover away from obstacles. Add your sensors here.
    async fn sense(&mut self, percepts: &mut Percepts) {
        percepts.operator = self.arming.read(self.button.is_high());
    }

    async fn act(&mut self, record: &CommandRecord) {
        let [left, right] = MIXER.mix(&record.commands);
        turn(&mut self.motors, LEFT, left);
        turn(&mut self.motors, RIGHT, right);
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.pet();
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

/// Sets the two inputs of one motor, ahead and astern, for an output of -1 ..= 1.
fn turn(motors: &mut SimplePwm<'static, TIM3>, [ahead, astern]: [Channel; 2], output: f32) {
    for (channel, share) in [(ahead, output), (astern, -output)] {
        let mut channel = motors.channel(channel);
        let full = channel.max_duty_cycle();
        channel.set_duty_cycle((share.clamp(0.0, 1.0) * full as f32) as u32);
    }
}
