//! `man`: the manual page of the program, or of one of its commands.

use super::{Failure, print};
use crate::cli::{Cli, Man};
use clap::CommandFactory;

pub(super) fn run(args: &Man) -> Result<(), Failure> {
    // `build` gives the commands their full names and the global options.
    let mut command = Cli::command();
    command.build();
    let page = match &args.command {
        None => command,
        Some(wanted) => {
            let found = command.get_subcommands().find(|one| one.get_name() == wanted).cloned();
            let found = found.map(|one| one.version(env!("CARGO_PKG_VERSION")));
            found.ok_or_else(|| {
                let names = command.get_subcommands().map(|one| one.get_name());
                let names: Vec<&str> = names.filter(|&name| name != "help").collect();
                Failure::Usage(format!(
                    "there is no command {wanted}; the commands are {}",
                    names.join(", ")
                ))
            })?
        }
    };
    let mut roff = Vec::new();
    clap_mangen::Man::new(page).render(&mut roff)?;
    print(&roff)
}
