//! `completions`: a script for a shell that completes the command line.

use super::{Failure, print};
use crate::cli::{Cli, Completions};
use clap::CommandFactory;
use clap_complete::Shell;

pub(super) fn run(args: &Completions) -> Result<(), Failure> {
    let mut command = Cli::command();
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, &name, &mut script);
    if args.shell == Shell::Bash {
        script = String::from_utf8_lossy(&script).replace(&mangled(&name), &state(&name)).into();
    }
    print(&script)
}

/// The name that the bash script has for the state after the program's name.
fn state(name: &str) -> String {
    name.replace('-', "__")
}

/// The wrong name for the same state that clap_complete 4.6 writes if the program's name contains a
/// hyphen (clap's issue 6421). With it, nothing would be completed after a command.
fn mangled(name: &str) -> String {
    name.replace('-', "__subcmd__")
}
