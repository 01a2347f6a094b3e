//! A robot that lives on records: the world says what it senses, the robot answers what it
//! does, tick by tick. It runs the same [`gps_task`] and [`control_task`] as a board.
//!
//! Three ways to use it, from simple to flexible:
//! - [`run`] blocks until the [`Link`] ends: for a simulated world that is itself the link,
//!   and for the QEMU guest, whose link are two pipes.
//! - [`drive`] is the same as a future, for an executor.
//! - a [`Mailbox`] is a link that is fed from outside, one [`Mailbox::step`] a tick, for a
//!   simulator that wants to ask and be answered.
//!
//! Invariants: the clock is the tick number times the period; all GPS bytes of a record are
//! decoded before its tick, so the result does not depend on the order in which an executor
//! polls; the same records give the same answers.

use core::cell::Cell;
use core::pin::Pin;
use core::task::{Context, Waker};

use embassy_futures::select::select;
use embassy_futures::{block_on, yield_now};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::pipe::Pipe;
use plan_format::Blob;
use robot_io::limits::MAX_GPS_BYTES;
use robot_io::{CommandRecord, Percepts, SensorRecord};

use crate::control::{Robot, TICK_PERIOD_US, control_task};
use crate::gps::{FixSlot, gps_task};

/// The other end: a world, simulated, recorded or at the end of a pipe.
pub trait Link {
    /// Whether [`Link::receive`] can answer at once. While it cannot, other tasks run.
    fn is_ready(&self) -> bool {
        true
    }

    /// What the robot senses at the next tick; `None` ends the run.
    fn receive(&mut self) -> Option<SensorRecord>;

    /// What the robot answers.
    fn send(&mut self, record: &CommandRecord);

    /// Called after the tick with all that it saw, for whoever keeps a trace to replay.
    fn keep(&mut self, _percepts: &Percepts) {}

    /// Called right before the tick, to start counting instructions where that can be done.
    fn start_count(&mut self) {}

    /// Instructions since [`Link::start_count`]; 0 where they cannot be counted.
    fn stop_count(&mut self) -> u32 {
        0
    }
}

/// Drives by `plan` until the link ends.
pub fn run(blob: Blob<'_>, link: impl Link) {
    block_on(drive(blob, link));
}

/// Drives by `plan` until the link ends, as a future.
pub async fn drive(blob: Blob<'_>, link: impl Link) {
    let gps = Pipe::<NoopRawMutex, MAX_GPS_BYTES>::new();
    let now_us = Cell::new(0);
    let fixes = FixSlot::<NoopRawMutex>::new();
    let mut robot =
        LockstepRobot { link, gps: &gps, now_us: &now_us, record: SensorRecord::default() };
    select(gps_task(&gps, &fixes, || now_us.get()), control_task(blob, &mut robot, &fixes)).await;
}

struct LockstepRobot<'a, L> {
    link: L,
    gps: &'a Pipe<NoopRawMutex, MAX_GPS_BYTES>,
    now_us: &'a Cell<u64>,
    record: SensorRecord,
}

impl<L: Link> Robot for LockstepRobot<'_, L> {
    async fn wait(&mut self) -> Option<u64> {
        while !self.link.is_ready() {
            yield_now().await;
        }
        self.record = self.link.receive()?;
        let now_us = self.now_us.get().saturating_add(TICK_PERIOD_US);
        self.now_us.set(now_us);
        // The pipe holds a whole record and is empty here, so this never waits.
        self.gps.write_all(&self.record.gps).await;
        // Once the pipe is empty its reader has stored what the bytes meant: it does not
        // yield in between.
        while !self.gps.is_empty() {
            yield_now().await;
        }
        Some(now_us)
    }

    async fn sense(&mut self, percepts: &mut Percepts) {
        percepts.heading_rad = self.record.heading_rad;
        percepts.speed_mps = self.record.speed_mps;
        percepts.turn_rate_radps = self.record.turn_rate_radps;
        percepts.ranges.clone_from(&self.record.ranges);
        percepts.inputs = self.record.inputs;
        percepts.operator = self.record.operator;
    }

    fn start_count(&mut self) {
        self.link.start_count();
    }

    fn keep(&mut self, percepts: &Percepts) {
        self.link.keep(percepts);
    }

    fn stop_count(&mut self) -> u32 {
        self.link.stop_count()
    }

    async fn act(&mut self, record: &CommandRecord) {
        self.link.send(record);
    }
}

/// A link that is fed by hand. The robot's future waits in [`Link::receive`] between steps.
///
/// ```
/// # use plan_format::{Parameters, Blob};
/// # use robot_io::SensorRecord;
/// use runtime::lockstep::{Mailbox, drive};
/// # let plan = Blob::without_map(Parameters::default(), None, None);
/// let mailbox = Mailbox::default();
/// let mut robot = core::pin::pin!(drive(plan, &mailbox));
/// let first = mailbox.step(robot.as_mut(), SensorRecord::default()).unwrap();
/// let second = mailbox.step(robot.as_mut(), SensorRecord::default()).unwrap();
/// assert_eq!(first.commands.speed_mps, 0.0, "it is not armed");
/// assert_eq!(second.time_us - first.time_us, runtime::TICK_PERIOD_US);
/// ```
#[derive(Default)]
pub struct Mailbox {
    record: Cell<Option<SensorRecord>>,
    answer: Cell<Option<CommandRecord>>,
    seen: Cell<Option<Percepts>>,
    is_full: Cell<bool>,
}

impl Mailbox {
    /// Hands `record` to `robot`, a [`drive`] over this mailbox, and polls it until it has
    /// answered. `None` if the future is not over this mailbox.
    pub fn step<F: Future<Output = ()> + ?Sized>(
        &self,
        mut robot: Pin<&mut F>,
        record: SensorRecord,
    ) -> Option<CommandRecord> {
        // The first poll takes the record, the second decodes its GPS bytes and ticks; the
        // rest is slack.
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
}

impl Mailbox {
    /// What the last step's tick saw, once: the percepts of a trace.
    pub fn take_percepts(&self) -> Option<Percepts> {
        self.seen.take()
    }
}

impl Link for &Mailbox {
    fn keep(&mut self, percepts: &Percepts) {
        self.seen.set(Some(percepts.clone()));
    }

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
