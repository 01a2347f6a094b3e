//! `cargo soak`: ten million ticks of random missions and inputs.

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use std::process::ExitCode;

/// Runs random missions with random inputs through the whole tick and checks its invariants.
#[derive(Parser)]
struct Arguments {
    /// Least number of ticks to run.
    #[arg(long, default_value_t = 10_000_000, allow_negative_numbers = true)]
    ticks: u64,
    /// Seed of the first mission; each further mission uses the next.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left")
        .expect("the template is well-formed");
    let bar = ProgressBar::new(arguments.ticks).with_style(style);
    let result = soak::soak(arguments.seed, arguments.ticks, &mut |ticks| {
        bar.set_position(ticks);
    });
    bar.finish_and_clear();
    match result {
        Ok(summary) => {
            println!("{} ticks in {} missions", summary.ticks, summary.missions);
            println!("{} corrupted missions refused", summary.refused);
            println!("at most {} components, {} actions", summary.components, summary.running);
            for (kind, count) in &summary.decisions {
                println!("{count:>12} {kind}");
            }
            println!("trace hash {:016x}", summary.hash);
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::FAILURE
        }
    }
}
