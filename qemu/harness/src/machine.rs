//! Which machine QEMU plays, and how it is started.

use std::io::{self, Write};
use std::process::{Command, Stdio};
use std::time::Duration;

use board_table::Region;
use tempfile::NamedTempFile;

use crate::setup::{self, SetupError};

/// A guest that says nothing for this long hangs.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// The emulated boards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// Arm MPS2 with AN386: Cortex-M4 with FPU.
    CortexM4F,
    /// TI LM3S6965: Cortex-M3, floats in software.
    CortexM3,
}

/// How the image is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// As for a robot.
    Release,
    /// Overflow checks and debug assertions on.
    Debug,
}

/// The guest could not be started.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// Something is not installed or does not build.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The plans do not fit the machine's plan region.
    #[error("{bytes} bytes of plans do not fit the {capacity} of {machine}")]
    TooLarge {
        /// Bytes of the blob.
        bytes: usize,
        /// Bytes of the region.
        capacity: usize,
        /// The machine.
        machine: &'static str,
    },
    /// A file or process failed.
    #[error("QEMU cannot be started: {0}")]
    Io(#[from] io::Error),
}

impl Machine {
    /// QEMU's name for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CortexM4F => "mps2-an386",
            Self::CortexM3 => "lm3s6965evb",
        }
    }

    /// The triple that its images are built for.
    pub fn target(self) -> &'static str {
        &self.row().target
    }

    /// Where the plans lie.
    pub fn plan_region(self) -> Region {
        self.row().memory.plans
    }

    fn row(self) -> &'static board_table::Machine {
        board_table::Machine::find(self.name()).expect("a test finds every machine in boards.toml")
    }

    /// QEMU with an image of the guest and the plans in their region, not started yet. All
    /// three standard streams are pipes. The file of plans must live until QEMU ends.
    pub fn command(
        self,
        bin: &str,
        build: Build,
        plans: &[u8],
    ) -> Result<(Command, NamedTempFile), StartError> {
        let Region { address, bytes: capacity } = self.plan_region();
        if plans.len() > capacity {
            let (bytes, machine) = (plans.len(), self.name());
            return Err(StartError::TooLarge { bytes, capacity, machine });
        }
        setup::qemu()?;
        let profile = match build {
            Build::Release => "firmware",
            Build::Debug => "firmware-debug",
        };
        let image = setup::built("guest", bin, profile, Some(self.target()))?;
        let mut file = NamedTempFile::new()?;
        file.write_all(plans)?;
        // In QEMU's option syntax a comma in a value is written twice.
        let path = file.path().to_string_lossy().replace(',', ",,");
        let mut command = Command::new(setup::QEMU);
        command.args(["-machine", self.name(), "-display", "none", "-monitor", "none"]);
        command.args(["-semihosting-config", "enable=on,target=native"]);
        command.arg("-kernel").arg(image);
        command.arg("-device");
        command.arg(format!("loader,file={path},addr={address:#x},force-raw=on"));
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        Ok((command, file))
    }

    /// As [`Machine::command`], with time that is a function of the instructions run: 128 ns
    /// each, whatever the host does.
    pub fn counting_command(
        self,
        bin: &str,
        build: Build,
        plans: &[u8],
    ) -> Result<(Command, NamedTempFile), StartError> {
        let (mut command, file) = self.command(bin, build, plans)?;
        command.args(["-icount", "shift=7", "-serial", "none"]);
        Ok((command, file))
    }
}

#[cfg(test)]
mod tests {
    use super::Machine;

    #[test]
    fn every_machine_has_a_row_with_a_target_of_its_own() {
        let targets = [Machine::CortexM4F, Machine::CortexM3].map(Machine::target);
        assert_ne!(targets[0], targets[1]);
        assert_eq!(board_table::MACHINES.len(), targets.len());
    }
}
