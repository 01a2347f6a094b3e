//! `completions`: what a shell sources to complete the command line.

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

/// What the script for bash calls the state in which only the program has been typed.
fn state(name: &str) -> String {
    name.replace('-', "__")
}

/// And what clap_complete 4.6 calls it where it lists what may follow, if the name has a hyphen
/// (clap's issue 6421): left so, nothing would be completed after a command.
fn mangled(name: &str) -> String {
    name.replace('-', "__subcmd__")
}
