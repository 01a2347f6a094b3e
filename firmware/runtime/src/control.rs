//! The control loop: wait, sense, decide, act.

use controller::State;
use embassy_sync::blocking_mutex::raw::RawMutex;
use plan_format::Blob;
use robot_io::{CommandRecord, Percepts, TraceHash};

use crate::gps::FixSlot;

/// Time from tick to tick, microseconds: 20 Hz.
pub const TICK_PERIOD_US: u64 = 50_000;

/// The hardware, or what stands for it. Its calls come in the order of this list, once a tick.
#[allow(async_fn_in_trait, reason = "tasks run on one thread and need no Send")]
pub trait Robot {
    /// Waits for the next tick and gives its time in microseconds since start, which never
    /// decreases; `None` ends the control task, which a real robot never does.
    async fn wait(&mut self) -> Option<u64>;

    /// Fills in heading, odometry, ranges and operator. Time, fix and what is known of the
    /// receiver are there already.
    async fn sense(&mut self, percepts: &mut Percepts);

    /// Called right before the tick, to start counting instructions where that can be done.
    fn start_count(&mut self) {}

    /// Instructions since [`Robot::start_count`]; 0 where they cannot be counted.
    fn stop_count(&mut self) -> u32 {
        0
    }

    /// Called after the tick with all that it saw, for whoever keeps a trace to replay.
    fn keep(&mut self, _percepts: &Percepts) {}

    /// Carries out the commands of one tick. The record around them is the tick's telemetry.
    async fn act(&mut self, record: &CommandRecord);

    /// Called when a tick is complete, and before the first tick only while the blob is checked
    /// ([`crate::load_paced`]): a watchdog that is fed here bites when any part of either hangs.
    fn feed_watchdog(&mut self) {}
}

/// Drives `robot` by `plan` until [`Robot::wait`] says that there is nothing more to do.
///
/// A tick takes the newest fix there is; it never waits for one.
pub async fn control_task<M: RawMutex>(blob: Blob<'_>, robot: &mut impl Robot, fixes: &FixSlot<M>) {
    let mut state = State::new(&blob);
    let mut trace = TraceHash::default();
    while let Some(time_us) = robot.wait().await {
        let receiver = fixes.receiver(time_us);
        let mut percepts =
            Percepts { time_us, fix: fixes.latest(), receiver, ..Percepts::default() };
        robot.sense(&mut percepts).await;
        let percepts = percepts.sanitised();

        robot.start_count();
        let commands = controller::tick(&blob, &mut state, &percepts);
        let instructions = robot.stop_count();

        robot.keep(&percepts);
        trace.record(&percepts, &commands);
        let trace_hash = trace.get();
        let record = CommandRecord { time_us, commands, trace_hash, instructions, receiver };
        robot.act(&record).await;
        robot.feed_watchdog();
    }
}
