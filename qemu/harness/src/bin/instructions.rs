//! `cargo instructions`: what a look-up and a tick cost on a Cortex-M4F, counted in QEMU.

use std::process::ExitCode;

use clap::Parser;
use harness::counts::{LIMITS, golden, measure};

/// Counts instructions and bytes of the release firmware, prints them, and compares them with
/// the golden file.
#[derive(Parser)]
#[command(name = "cargo instructions")]
struct Arguments {
    /// Write what was counted to the golden file
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

/// Whether the counts are those of the golden file.
fn count(arguments: &Arguments) -> Result<bool, String> {
    let counted = measure()?;
    for line in counted.lines() {
        let limit = LIMITS.iter().find(|(name, _)| line.split(' ').next() == Some(name));
        let limit = limit.map(|(_, most)| format!("  (at most {most})")).unwrap_or_default();
        println!("{line}{limit}");
    }
    let path = golden();
    let said = |error: std::io::Error| format!("{}: {error}", path.display());
    if arguments.update {
        std::fs::write(&path, &counted).map_err(said)?;
        return Ok(true);
    }
    // A file that is not there yet knows no count.
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    for line in kept.lines().filter(|line| !counted.lines().any(|new| new == *line)) {
        eprintln!("the golden file says: {line}");
    }
    if kept != counted {
        eprintln!("If the new counts are meant, run: cargo instructions --update");
    }
    Ok(kept == counted)
}
