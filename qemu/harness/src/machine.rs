//! The machines that QEMU emulates, and how QEMU is started.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

use board_table::Region;
use tempfile::NamedTempFile;

use crate::setup::{self, SetupError};

/// A guest that answers nothing for this long counts as hung.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// The emulated boards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// Arm MPS2 with AN386: Cortex-M4 with FPU.
    CortexM4F,
    /// TI LM3S6965: Cortex-M3, floats in software.
    CortexM3,
}

/// How the guest's image is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// As for a robot.
    Release,
    /// With overflow checks and debug assertions.
    Debug,
}

/// The guest could not be started.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// Something is not installed or does not build.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The blob does not fit the machine's plan region.
    #[error("the blob has {bytes} bytes, but the plan region of {machine} has only {capacity}")]
    TooLarge {
        /// Size of the blob, bytes.
        bytes: usize,
        /// Size of the region, bytes.
        capacity: usize,
        /// QEMU's name of the machine.
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

    /// The target triple of its images.
    pub fn target(self) -> &'static str {
        &self.row().target
    }

    /// The region of its memory that holds the plans.
    pub fn plan_region(self) -> Region {
        self.row().memory.plans
    }

    fn row(self) -> &'static board_table::Machine {
        board_table::Machine::find(self.name()).expect("a test finds every machine in boards.toml")
    }

    /// The image of the guest's program `bin`, which is built if it is not there or not up to date.
    pub fn image(self, bin: &str, build: Build) -> Result<PathBuf, StartError> {
        let profile = match build {
            Build::Release if self == Self::CortexM3 => "firmware-small",
            Build::Release => "firmware",
            Build::Debug => "firmware-debug",
        };
        Ok(setup::built("guest", bin, profile, Some(self.target()))?)
    }

    /// A command, not yet started, that runs the guest's program `bin` in QEMU with the blob `plans`
    /// in its region. All three standard streams are pipes. The returned file holds the blob and
    /// must live until QEMU ends.
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
        let image = self.image(bin, build)?;
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

    /// As [`Machine::command`], but the guest's time advances by 128 ns per instruction,
    /// independently of the host.
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
