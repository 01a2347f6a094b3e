//! `cargo instructions`: counts the instructions of a look-up and a tick on a Cortex-M4F in QEMU.

use std::process::ExitCode;

use clap::Parser;
use harness::counts::{LIMITS, golden, measure};

/// Counts instructions and bytes of the release firmware, prints them, and compares them with
/// the golden file.
#[derive(Parser)]
#[command(name = "cargo instructions")]
struct Arguments {
    /// Write the counts to the golden file
    #[arg(long)]
    update: bool,
}

fn main() -> ExitCode {
    match count(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Prints the counts, and returns whether they equal those of the golden file.
fn count(arguments: &Arguments) -> Result<bool, String> {
    let counted = measure()?;
    for line in counted.lines() {
        let limit = LIMITS.iter().find(|(name, _)| line.split(' ').next() == Some(name));
        let limit = limit.map(|(_, most)| format!("  (at most {most})")).unwrap_or_default();
        println!("{line}{limit}");
    }
    let path = golden();
    if arguments.update {
        let written = std::fs::write(&path, &counted);
        written.map_err(|error| format!("{}: {error}", path.display()))?;
        return Ok(true);
    }
    // A missing golden file counts as empty.
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    for line in kept.lines().filter(|line| !counted.lines().any(|new| new == *line)) {
        eprintln!("the golden file has: {line}");
    }
    if kept != counted {
        eprintln!("If the new counts are intended, run: cargo instructions --update");
    }
    Ok(kept == counted)
}
