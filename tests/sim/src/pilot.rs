//! The interface to a robot's controller: it answers a sensor record with a command record.

use plan_format::Blob;
use robot_io::{CommandRecord, Commands, Percepts, SensorRecord};
use runtime::Observer;
use runtime::lockstep::{Mailbox, Transport, run};
use std::fmt;
use std::pin::Pin;
use std::rc::Rc;

/// A robot's controller in lockstep with the simulation: one exchange is one tick.
pub trait Pilot {
    /// Hands over the sensor data since the last tick and runs one tick.
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError>;
}

/// The robot did not answer, or not with a command record.
#[derive(Debug, thiserror::Error)]
pub enum PilotError {
    /// The connection to the robot broke.
    #[error("the robot's connection broke: {0}")]
    Connection(#[from] std::io::Error),
    /// The answer is not a command record.
    #[error("the robot's answer is not a command record: {0}")]
    Answer(String),
    /// The robot ended.
    #[error("the robot ended: {0}")]
    Ended(String),
}

impl<P: Pilot + ?Sized> Pilot for &mut P {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        (**self).exchange(sensors)
    }
}

impl<P: Pilot + ?Sized> Pilot for Box<P> {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        (**self).exchange(sensors)
    }
}

/// The robot in this process: a board's runtime whose records come from the simulation.
pub struct HostPilot<'p> {
    mailbox: Rc<Mailbox>,
    robot: Pin<Box<dyn Future<Output = ()> + 'p>>,
}

impl<'p> HostPilot<'p> {
    /// A robot before its first tick.
    pub fn new(blob: Blob<'p>) -> Self {
        let mailbox = Rc::new(Mailbox::default());
        let shared = || Shared(Rc::clone(&mailbox));
        let robot = Box::pin(run(blob, shared(), shared()));
        Self { mailbox, robot }
    }

    /// The percepts of the last exchange's tick, as a trace records them.
    pub fn take_percepts(&self) -> Option<Percepts> {
        self.mailbox.take_percepts()
    }
}

impl Pilot for HostPilot<'_> {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        let answer = self.mailbox.step(self.robot.as_mut(), sensors.clone());
        answer.ok_or_else(|| PilotError::Ended("it does not wait for its mailbox".to_owned()))
    }
}

impl fmt::Debug for HostPilot<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("HostPilot").finish_non_exhaustive()
    }
}

/// A robot in this process, and the percepts of all its ticks.
#[derive(Debug)]
pub struct Recorder<'p> {
    pilot: HostPilot<'p>,
    percepts: Vec<Percepts>,
}

impl<'p> Recorder<'p> {
    /// Records a robot from now on.
    pub fn new(pilot: HostPilot<'p>) -> Self {
        Self { pilot, percepts: Vec::new() }
    }

    /// The percepts of each tick, in order.
    pub fn finish(self) -> Vec<Percepts> {
        self.percepts
    }
}

impl Pilot for Recorder<'_> {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        let answer = self.pilot.exchange(sensors)?;
        self.percepts.extend(self.pilot.take_percepts());
        Ok(answer)
    }
}

/// A mailbox that the robot and its owner share.
struct Shared(Rc<Mailbox>);

impl Observer for Shared {
    fn after(&mut self, percepts: &Percepts, commands: &Commands) -> u32 {
        (&*self.0).after(percepts, commands)
    }
}

impl Transport for Shared {
    fn is_ready(&self) -> bool {
        (&*self.0).is_ready()
    }

    fn receive(&mut self) -> Option<SensorRecord> {
        (&*self.0).receive()
    }

    fn send(&mut self, record: &CommandRecord) {
        (&*self.0).send(record);
    }
}
