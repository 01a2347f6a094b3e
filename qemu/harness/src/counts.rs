//! What the plans cost a robot, counted to the instruction in QEMU.

use std::path::{Path, PathBuf};

use crate::mission::{Changes, Scenario};
use crate::setup::root;
use crate::{Build, Machine};

/// A name and what may be counted for it at most.
///
/// The look-up gives direction and cost; state and stack are those of the control code.
pub const LIMITS: &[(&str, u64)] = &[
    ("blob-validation", 30_000_000),
    ("look-up-worst", 400),
    ("tick-8-obstacles-worst", 6_000),
    ("tick-stack-bytes", 4_096),
    ("control-state-bytes", 8_192),
    ("plan-view-bytes", 512),
    ("behaviours-tick-worst", 20_000),
    ("behaviours-tick-stack-bytes", 8_192),
];

/// Where the counts stand that the tests hold.
pub fn golden() -> PathBuf {
    root().join("tests/golden/instructions.txt")
}

/// Counts on the emulated Cortex-M4F: a line of a name and a number each. The campus has the plans,
/// and the mission of [`soak::fixtures::budget`] the behaviours.
pub fn measure() -> Result<String, String> {
    let map: &Path = &root().join("tests/maps/campus.opar");
    let plans = count(&Scenario::compile(map, &Changes::default())?.blob)?;
    let blob = soak::fixtures::blob(soak::fixtures::budget()).map_err(|error| error.to_string())?;
    let all = count(&blob)?;
    let behaviours = all.lines().filter(|line| line.starts_with("behaviours-"));
    Ok(behaviours.fold(plans, |said, line| said + line + "\n"))
}

fn count(blob: &[u8]) -> Result<String, String> {
    let machine = Machine::CortexM4F;
    let (mut command, _plans) = machine
        .counting_command("instructions", Build::Release, blob)
        .map_err(|error| error.to_string())?;
    let output = command.output().map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        Ok(said)
    } else {
        let why = String::from_utf8_lossy(&output.stderr).into_owned();
        Err(format!("the guest ended with {}: {said}{why}", output.status))
    }
}
