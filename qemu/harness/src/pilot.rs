//! The robot in QEMU, driven in lockstep.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{Read, Write};
use std::process::{Child, ChildStdin, ExitStatus};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::{self, JoinHandle};

use robot_io::limits::COMMAND_RECORD_BYTES;
use robot_io::{CommandRecord, SensorRecord};
use sim::{Pilot, PilotError};
use tempfile::NamedTempFile;

use crate::machine::{Build, Machine, PATIENCE, StartError};

type Answer = [u8; COMMAND_RECORD_BYTES];

/// A running guest; dropping it kills the guest.
pub struct QemuPilot {
    child: Child,
    /// `None` after the end of the mission.
    to_guest: Option<ChildStdin>,
    answers: Receiver<Answer>,
    /// Reads the guest's console to the end.
    console: Option<JoinHandle<String>>,
    /// Deleted together with the guest that reads it.
    _plans: NamedTempFile,
}

/// What a guest reports about itself at the end of a mission: names and numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    numbers: BTreeMap<String, u64>,
    /// The whole console output, numbers included.
    pub console: String,
}

impl QemuPilot {
    /// Boots a machine with a blob, sound or damaged. Installs missing tools first.
    pub fn boot(machine: Machine, build: Build, plans: &[u8]) -> Result<Self, StartError> {
        let (mut command, plans) = machine.counting_command("mission", build, plans)?;
        let mut child = command.spawn()?;
        let to_guest = child.stdin.take();
        let mut from_guest = child.stdout.take().expect("its output is a pipe");
        let mut console = child.stderr.take().expect("its console is a pipe");
        // In lockstep at most one answer is in flight.
        let (sender, answers) = sync_channel(1);
        thread::spawn(move || {
            let mut answer = [0; COMMAND_RECORD_BYTES];
            while from_guest.read_exact(&mut answer).is_ok() && sender.send(answer).is_ok() {}
        });
        let console = thread::spawn(move || {
            let mut text = Vec::new();
            // If reading fails, the text so far is still useful.
            let _ = console.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        Ok(Self { child, to_guest, answers, console: Some(console), _plans: plans })
    }

    /// Ends the mission and returns the guest's report. Fails if the guest hangs or ends with an
    /// error.
    pub fn finish(mut self) -> Result<Report, PilotError> {
        drop(self.to_guest.take());
        if let Err(RecvTimeoutError::Timeout) = self.answers.recv_timeout(PATIENCE) {
            return Err(self.hangs());
        }
        let (status, console) = self.end()?;
        if status.success() { Ok(Report::parse(console)) } else { Err(ended(status, &console)) }
    }

    /// Waits for a guest that has closed its pipes, and returns its console output.
    fn end(&mut self) -> Result<(ExitStatus, String), PilotError> {
        let status = self.child.wait()?;
        let console = self.console.take().and_then(|thread| thread.join().ok());
        Ok((status, console.unwrap_or_default()))
    }

    fn hangs(&mut self) -> PilotError {
        // Killing fails only for a guest that has ended; either way its console ends.
        let _ = self.child.kill();
        let console = self.end().map(|(_, console)| console).unwrap_or_default();
        let seconds = PATIENCE.as_secs();
        PilotError::Ended(format!("no answer within {seconds} s; its console: {}", console.trim()))
    }

    fn broke(&mut self) -> PilotError {
        match self.end() {
            Ok((status, console)) => ended(status, &console),
            Err(error) => error,
        }
    }
}

fn ended(status: ExitStatus, console: &str) -> PilotError {
    PilotError::Ended(format!("{status}; its console: {}", console.trim()))
}

impl Pilot for QemuPilot {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        let bytes = sensors.to_bytes().ok_or_else(|| {
            PilotError::Answer("the sensor record is too large to send".to_owned())
        })?;
        let sent = self.to_guest.as_mut().is_some_and(|pipe| pipe.write_all(&bytes).is_ok());
        if !sent {
            return Err(self.broke());
        }
        match self.answers.recv_timeout(PATIENCE) {
            Ok(answer) => CommandRecord::from_bytes(&answer)
                .ok_or_else(|| PilotError::Answer(format!("{answer:02x?}"))),
            Err(RecvTimeoutError::Timeout) => Err(self.hangs()),
            Err(RecvTimeoutError::Disconnected) => Err(self.broke()),
        }
    }
}

impl Drop for QemuPilot {
    fn drop(&mut self) {
        // Both calls fail only if the guest has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl fmt::Debug for QemuPilot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("QemuPilot").field("process", &self.child.id()).finish_non_exhaustive()
    }
}

impl Report {
    /// Takes the numbers from the lines with a name and a number.
    pub fn parse(console: String) -> Self {
        let numbers = console.lines().filter_map(|line| {
            let (name, number) = line.split_once(' ')?;
            Some((name.to_owned(), number.trim().parse().ok()?))
        });
        Self { numbers: numbers.collect(), console }
    }

    /// A number by its name.
    pub fn get(&self, name: &str) -> Option<u64> {
        self.numbers.get(name).copied()
    }

    /// All numbers, by name.
    pub fn numbers(&self) -> impl Iterator<Item = (&str, u64)> {
        self.numbers.iter().map(|(name, &number)| (name.as_str(), number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_the_lines_with_a_name_and_a_number() {
        let report = Report::parse("plan refused: code 3\nstack-bytes 100\nodd\n".to_owned());
        assert_eq!(report.numbers().collect::<Vec<_>>(), [("stack-bytes", 100)]);
    }
}
