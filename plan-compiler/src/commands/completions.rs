//! `completions`: what a shell sources to complete the command line.

use super::{Failure, print};
use crate::cli::{Cli, Completions};
use clap::CommandFactory;

pub(super) fn run(args: &Completions) -> Result<(), Failure> {
    let mut command = Cli::command();
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, name, &mut script);
    print(&script)
}
