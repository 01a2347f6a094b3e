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

/// A guest under way. It is killed when this is dropped.
pub struct QemuPilot {
    child: Child,
    /// `None` once the mission is over.
    to_guest: Option<ChildStdin>,
    answers: Receiver<Answer>,
    /// What the guest says on its console, read to the end.
    console: Option<JoinHandle<String>>,
    /// Deleted together with the guest that reads it.
    _plans: NamedTempFile,
}

/// What a guest says about itself when a mission is over: names and numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    numbers: BTreeMap<String, u64>,
    /// Everything it said, numbers included.
    pub console: String,
}

impl QemuPilot {
    /// Boots a machine with a blob of plans, sound or not. What is missing is set up first.
    pub fn boot(machine: Machine, build: Build, plans: &[u8]) -> Result<Self, StartError> {
        let (mut command, plans) = machine.counting_command("mission", build, plans)?;
        let mut child = command.spawn()?;
        let to_guest = child.stdin.take();
        let mut from_guest = child.stdout.take().expect("its output is a pipe");
        let mut console = child.stderr.take().expect("its console is a pipe");
        // In lockstep there is never more than one answer under way.
        let (sender, answers) = sync_channel(1);
        thread::spawn(move || {
            let mut answer = [0; COMMAND_RECORD_BYTES];
            while from_guest.read_exact(&mut answer).is_ok() && sender.send(answer).is_ok() {}
        });
        let console = thread::spawn(move || {
            let mut text = Vec::new();
            // A console that breaks off still says what came before.
            let _ = console.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        Ok(Self { child, to_guest, answers, console: Some(console), _plans: plans })
    }

    /// Ends the mission and returns what the guest says about it.
    pub fn finish(mut self) -> Result<Report, PilotError> {
        drop(self.to_guest.take());
        if let Err(RecvTimeoutError::Timeout) = self.answers.recv_timeout(PATIENCE) {
            return Err(self.hangs());
        }
        let (status, console) = self.end()?;
        if status.success() { Ok(Report::parse(console)) } else { Err(ended(status, &console)) }
    }

    /// The guest has closed its pipes: waits for it and takes what it said.
    fn end(&mut self) -> Result<(ExitStatus, String), PilotError> {
        let status = self.child.wait()?;
        let console = self.console.take().and_then(|thread| thread.join().ok());
        Ok((status, console.unwrap_or_default()))
    }

    fn hangs(&mut self) -> PilotError {
        // The console ends only when the guest does; whether it can be killed shows there.
        let _ = self.child.kill();
        let console = self.end().map(|(_, console)| console).unwrap_or_default();
        let seconds = PATIENCE.as_secs();
        PilotError::Ended(format!("no answer within {seconds} s; it said: {}", console.trim()))
    }

    fn broke(&mut self) -> PilotError {
        match self.end() {
            Ok((status, console)) => ended(status, &console),
            Err(error) => error,
        }
    }
}

fn ended(status: ExitStatus, console: &str) -> PilotError {
    PilotError::Ended(format!("{status}; it said: {}", console.trim()))
}

impl Pilot for QemuPilot {
    fn exchange(&mut self, sensors: &SensorRecord) -> Result<CommandRecord, PilotError> {
        let bytes = sensors.to_bytes().ok_or_else(|| {
            PilotError::Answer("a sensor record does not fit its bytes".to_owned())
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
        // Both fail only for a guest that has ended already.
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
    /// Reads the lines that are a name and a number.
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
