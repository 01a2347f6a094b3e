//! A robot in lockstep with its world: at each tick the world sends a sensor record and the
//! robot answers with a command record. It runs the same [`gps_task`] and [`control_task`] as a
//! board.
//!
//! Three ways to use it, from simple to flexible:
//! - [`run_blocking`] returns when the [`Transport`] ends: for a world in the same thread.
//! - [`run`] is the same as a future, for an executor; the QEMU guest runs it over two pipes.
//! - A [`Mailbox`] is a transport that its caller feeds, one [`Mailbox::step`] per tick: for a
//!   simulator that calls the robot.
//!
//! Invariants: a sound clock is the tick number times the period; all GPS bytes of a record are
//! decoded before its tick, so the result does not depend on the executor's polling order; equal
//! records give equal answers.

use core::cell::Cell;
use core::pin::Pin;
use core::task::{Context, Waker};

use embassy_futures::select::select;
use embassy_futures::{block_on, yield_now};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::pipe::Pipe;
use plan_format::Blob;
use robot_io::limits::MAX_GPS_BYTES;
use robot_io::{CommandRecord, Commands, Percepts, SensorRecord};

use crate::control::{Observer, Robot, TICK_PERIOD_US, control_task};
use crate::gps::gps_task;
use crate::slots::Slots;

/// Carries records to and from a world: simulated, recorded or behind a pipe.
pub trait Transport {
    /// Whether [`Transport::receive`] can return at once. Other tasks run while it cannot.
    fn is_ready(&self) -> bool {
        true
    }

    /// The sensor record of the next tick; `None` ends the run.
    fn receive(&mut self) -> Option<SensorRecord>;

    /// Sends the robot's answer.
    fn send(&mut self, record: &CommandRecord);
}

/// Runs the robot of `blob` until the transport ends.
pub fn run_blocking(blob: Blob<'_>, transport: impl Transport, observer: impl Observer) {
    block_on(run(blob, transport, observer));
}

/// Runs the robot of `blob` until the transport ends, as a future.
pub async fn run(blob: Blob<'_>, transport: impl Transport, observer: impl Observer) {
    let gps = Pipe::<NoopRawMutex, MAX_GPS_BYTES>::new();
    let now_us = Cell::new(0);
    let slots = Slots::<NoopRawMutex>::new();
    let mut robot = LockstepRobot {
        transport,
        gps: &gps,
        now_us: &now_us,
        sound_us: 0,
        slots: &slots,
        record: SensorRecord::default(),
        scan_us: None,
    };
    select(
        gps_task(&gps, &slots.fixes, || now_us.get()),
        control_task(blob, &mut robot, &slots, observer),
    )
    .await;
}

struct LockstepRobot<'a, T> {
    transport: T,
    gps: &'a Pipe<NoopRawMutex, MAX_GPS_BYTES>,
    now_us: &'a Cell<u64>,
    /// What a sound clock shows.
    sound_us: u64,
    slots: &'a Slots<NoopRawMutex>,
    /// The last record; its ranges are the last scan.
    record: SensorRecord,
    /// Time of the last scan.
    scan_us: Option<u64>,
}

impl<T> LockstepRobot<'_, T> {
    /// Takes over the record that arrived at `now_us`. What is missing in it keeps its last value
    /// and time.
    fn hear(&mut self, now_us: u64, record: SensorRecord) {
        if let Some(operator) = record.radio {
            self.slots.operator.hear(now_us, operator);
        }
        if let Some(pose) = record.pose {
            self.slots.poses.hear(now_us, pose);
        }
        for &heard in &record.heard {
            self.slots.mates.hear(now_us, heard);
        }
        if record.ranges.is_some() {
            self.scan_us = Some(now_us);
        }
        let ranges = record.ranges.or_else(|| self.record.ranges.take());
        self.record = SensorRecord { ranges, ..record };
    }
}

impl<T: Transport> Robot for LockstepRobot<'_, T> {
    async fn wait(&mut self) -> Option<u64> {
        while !self.transport.is_ready() {
            yield_now().await;
        }
        let record = self.transport.receive()?;
        self.sound_us = self.sound_us.saturating_add(TICK_PERIOD_US);
        let now_us = record.clock_us.unwrap_or(self.sound_us);
        self.now_us.set(now_us);
        self.hear(now_us, record);
        // The pipe has room for a whole record and is empty here, so this never waits.
        self.gps.write_all(&self.record.gps).await;
        // Once the pipe is empty its reader has stored the fix: it does not yield in between.
        while !self.gps.is_empty() {
            yield_now().await;
        }
        Some(now_us)
    }

    async fn sense(&mut self, percepts: &mut Percepts) {
        percepts.heading_rad = self.record.heading_rad;
        percepts.speed_mps = self.record.speed_mps;
        percepts.turn_rate_radps = self.record.turn_rate_radps;
        percepts.scan_us = self.scan_us;
        if let Some(ranges) = &self.record.ranges {
            percepts.ranges.clone_from(ranges);
        }
        percepts.inputs = self.record.inputs;
        percepts.operator = self.record.operator;
    }

    async fn act(&mut self, record: &CommandRecord) {
        self.transport.send(record);
    }

    /// The world notices that a robot hangs, so there is no watchdog.
    fn feed_watchdog(&mut self) {}
}

/// A transport that its caller feeds, and an observer that keeps the last tick's percepts. The
/// robot's future waits in [`Transport::is_ready`] between steps.
///
/// ```
/// # use plan_format::{Parameters, Blob};
/// # use robot_io::SensorRecord;
/// use runtime::lockstep::{Mailbox, run};
/// # let blob = Blob::without_map(Parameters::default(), None, None);
/// let mailbox = Mailbox::default();
/// let mut robot = core::pin::pin!(run(blob, &mailbox, &mailbox));
/// let first = mailbox.step(robot.as_mut(), SensorRecord::default()).unwrap();
/// let second = mailbox.step(robot.as_mut(), SensorRecord::default()).unwrap();
/// assert_eq!(first.commands.speed_mps, 0.0, "it is not armed");
/// assert_eq!(second.time_us - first.time_us, runtime::TICK_PERIOD_US);
/// ```
#[derive(Default)]
pub struct Mailbox {
    record: Cell<Option<SensorRecord>>,
    answer: Cell<Option<CommandRecord>>,
    percepts: Cell<Option<Percepts>>,
    is_full: Cell<bool>,
}

impl Mailbox {
    /// Passes `record` to `robot`, a [`run`] over this mailbox, and polls it until it answers.
    /// `None` if `robot` does not run over this mailbox.
    pub fn step<F: Future<Output = ()> + ?Sized>(
        &self,
        mut robot: Pin<&mut F>,
        record: SensorRecord,
    ) -> Option<CommandRecord> {
        // The first poll takes the record, the second decodes its GPS bytes and ticks; the others
        // are reserve.
        const MAX_POLLS: usize = 8;
        self.answer.set(None);
        self.record.set(Some(record));
        self.is_full.set(true);
        let mut context = Context::from_waker(Waker::noop());
        for _ in 0..MAX_POLLS {
            let is_over = robot.as_mut().poll(&mut context).is_ready();
            let answer = self.answer.take();
            if is_over || answer.is_some() {
                return answer;
            }
        }
        None
    }

    /// Takes the percepts of the last step's tick, for a trace; `None` if they are taken already.
    pub fn take_percepts(&self) -> Option<Percepts> {
        self.percepts.take()
    }
}

impl Observer for &Mailbox {
    fn after(&mut self, percepts: &Percepts, _commands: &Commands) -> u32 {
        self.percepts.set(Some(percepts.clone()));
        0
    }
}

impl Transport for &Mailbox {
    fn is_ready(&self) -> bool {
        self.is_full.get()
    }

    fn receive(&mut self) -> Option<SensorRecord> {
        self.is_full.set(false);
        self.record.take()
    }

    fn send(&mut self, record: &CommandRecord) {
        self.answer.set(Some(*record));
    }
}
