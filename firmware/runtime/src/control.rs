//! The control loop: wait, sense, decide, act.

use controller::State;
use embassy_sync::blocking_mutex::raw::RawMutex;
use plan_format::Blob;
use robot_io::{CommandRecord, Commands, Percepts, TraceHash};

use crate::operator::Authority;
use crate::slots::Slots;

/// Time from tick to tick, microseconds: 20 Hz.
pub const TICK_PERIOD_US: u64 = 50_000;

/// The hardware, or its replacement. Every tick calls these functions once, in this order.
#[allow(async_fn_in_trait, reason = "tasks run on one thread and need no Send")]
pub trait Robot {
    /// Waits for the next tick. Returns its time in microseconds since start, which never
    /// decreases. `None` ends the control task; a real robot never returns it.
    async fn wait(&mut self) -> Option<u64>;

    /// Fills in heading, odometry, inputs and, on a robot with buttons, the operator's orders. A
    /// robot with a range finder fills in the ranges of its last complete scan and that scan's
    /// time, an empty scan included. [`Authority`] decides between the buttons and the link. Time,
    /// fix, state of the receiver, and the pose and the mates' news that the link brought are set; a
    /// robot with its own source of poses replaces the pose.
    async fn sense(&mut self, percepts: &mut Percepts);

    /// Carries out the commands of one tick. The record around them is the tick's telemetry.
    async fn act(&mut self, record: &CommandRecord);

    /// Feeds the watchdog. Called after each complete tick, and before the first tick while
    /// [`crate::load_paced`] checks the blob, so the watchdog resets the chip if any part of
    /// either hangs. A robot without a watchdog does nothing here; its comment gives the reason.
    fn feed_watchdog(&mut self);
}

/// Watches the ticks from outside: counts instructions, keeps a trace, lights an LED. It cannot
/// change what the robot does. `()` does nothing.
pub trait Observer {
    /// Called immediately before the tick.
    fn before(&mut self) {}

    /// Called immediately after the tick, with its arguments and its result. Returns the
    /// instructions since [`Observer::before`]; 0 if they are not counted.
    fn after(&mut self, _percepts: &Percepts, _commands: &Commands) -> u32 {
        0
    }
}

impl Observer for () {}

/// Drives `robot` by `blob` until [`Robot::wait`] returns `None`; `observer` watches each tick.
///
/// A tick uses the newest fix and never waits for one.
pub async fn control_task<M: RawMutex>(
    blob: Blob<'_>,
    robot: &mut impl Robot,
    slots: &Slots<M>,
    mut observer: impl Observer,
) {
    let mut state = State::new(&blob);
    let mut trace = TraceHash::default();
    let mut authority = Authority::default();
    let team = blob.parameters().team.mates();
    while let Some(time_us) = robot.wait().await {
        let receiver = slots.fixes.receiver(time_us);
        let fix = slots.fixes.latest();
        let pose = slots.poses.latest();
        let mates = slots.mates.latest(team);
        let mut percepts = Percepts { time_us, fix, receiver, pose, mates, ..Percepts::default() };
        robot.sense(&mut percepts).await;
        let radio = slots.operator.at(time_us, &blob.parameters().link);
        percepts.operator = authority.decide(percepts.operator, radio);
        percepts.is_link_lost = radio.is_some_and(|radio| radio.is_link_lost);
        let percepts = percepts.sanitised();

        observer.before();
        let commands = controller::tick(&blob, &mut state, &percepts);
        let instructions = observer.after(&percepts, &commands);

        trace.record(&percepts, &commands);
        let trace_hash = trace.get();
        let checks = state.checks();
        let news = state.team.news(&blob.parameters().team);
        let goal = state.goal();
        let record = CommandRecord {
            time_us,
            commands,
            trace_hash,
            instructions,
            receiver,
            checks,
            news,
            goal,
        };
        robot.act(&record).await;
        slots.telemetry.signal(record);
        robot.feed_watchdog();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_futures::block_on;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use plan_format::Parameters;
    use robot_io::{Operator, Reason};

    const ARMED: Operator = Operator { is_armed: true, is_emergency_stop: false, manual: None };

    /// A robot without a receiver; its button arms it at once.
    struct Armed<'s> {
        slots: &'s Slots<NoopRawMutex>,
        ticks: u64,
        reasons: [Option<Reason>; 4],
        feeds: usize,
    }

    impl Robot for Armed<'_> {
        async fn wait(&mut self) -> Option<u64> {
            self.ticks += 1;
            // After the second tick the operator sends one packet over the link, then stays silent.
            if self.ticks == 3 {
                self.slots.operator.hear(0, Operator::default());
            }
            (self.ticks <= 4).then_some(self.ticks * 10_000_000)
        }

        async fn sense(&mut self, percepts: &mut Percepts) {
            percepts.operator = ARMED;
        }

        async fn act(&mut self, record: &CommandRecord) {
            self.reasons[self.ticks as usize - 1] = Some(record.commands.reason);
        }

        fn feed_watchdog(&mut self) {
            self.feeds += 1;
        }
    }

    #[test]
    fn the_link_outranks_the_button_in_arming_from_its_first_packet_on() {
        let slots = Slots::new();
        let mut robot = Armed { slots: &slots, ticks: 0, reasons: [None; 4], feeds: 0 };
        let blob = Blob::without_map(Parameters::default(), None, None);
        block_on(control_task(blob, &mut robot, &slots, ()));
        let [by_button, again, by_link, silent] = robot.reasons;
        assert_eq!(by_button, again);
        assert_ne!(by_button, Some(Reason::Disarmed));
        assert_eq!([by_link, silent], [Some(Reason::Disarmed); 2]);
        assert_eq!(robot.feeds, 4, "the watchdog is fed once a tick");
        assert_eq!(slots.telemetry.try_take().map(|record| record.time_us), Some(40_000_000));
    }
}
