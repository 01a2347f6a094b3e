//! Who drives: whatever answers a record of sensors with a record of commands.

use robot_io::{CommandRecord, SensorRecord};

/// A robot's controller in lockstep with the world: one exchange is one tick.
pub trait Pilot {
    /// Hands over what the sensors brought since the last tick and runs one tick.
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError>;
}

/// The robot did not answer.
#[derive(Debug, thiserror::Error)]
pub enum PilotError {
    /// The connection to it broke.
    #[error("the robot's connection broke: {0}")]
    Connection(#[from] std::io::Error),
    /// It answered with something that is no command record.
    #[error("the robot's answer is no command record: {0}")]
    Answer(String),
    /// It went away.
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
