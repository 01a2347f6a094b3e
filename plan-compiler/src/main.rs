//! The `plan-compiler` command: parses its arguments, runs one command, decides the exit status.

mod cli;
mod commands;
mod tips;

use clap::Parser;
use commands::Failure;
use maps::terminal::{safe, safe_line};
use std::io::{self, IsTerminal};
use std::process::ExitCode;
use tips::Tip;

/// The input is wrong.
const WRONG_INPUT: u8 = 1;
/// The command line is wrong.
const WRONG_USAGE: u8 = 2;

fn main() -> ExitCode {
    let cli = match cli::Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            let arguments = std::env::args_os().skip(1);
            let arguments: Vec<String> =
                arguments.map(|argument| argument.to_string_lossy().into_owned()).collect();
            match tips::of(&error, &arguments) {
                Some(Tip::Instead(message)) => say(&message),
                tip => {
                    print_usage(&error, &arguments);
                    if let Some(Tip::Besides(message)) = tip {
                        say(&message);
                    }
                }
            }
            return if error.use_stderr() { WRONG_USAGE.into() } else { ExitCode::SUCCESS };
        }
    };
    match commands::run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Wrong(problems)) => {
            commands::tell(&problems, cli.quiet);
            WRONG_INPUT.into()
        }
        Err(Failure::Usage(message)) => {
            say(&format!("error: {message}\n\nFor more information, try '--help'.\n"));
            WRONG_USAGE.into()
        }
        // The reader of the output closed the pipe.
        Err(Failure::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(Failure::Output(error)) => {
            say(&format!("error: cannot write to standard output: {error}\n"));
            WRONG_INPUT.into()
        }
    }
}

/// Whether standard error is a person's terminal that wants colours.
fn colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|set| set.is_empty())
}

/// Prints help, or what is wrong with the command line. The message quotes arguments; if one
/// contains control characters, the message is made safe for a terminal and loses its colours.
fn print_usage(error: &clap::Error, arguments: &[String]) {
    let is_hostile = arguments.iter().any(|argument| safe_line(argument) != *argument);
    if error.use_stderr() && is_hostile {
        say(&error.render().to_string());
    } else {
        // A failure to print help cannot be reported either.
        let _ = error.print();
    }
}

/// Writes text for a person to standard error.
fn say(text: &str) {
    eprint(&safe(text));
}

/// Writes text that is already safe for a terminal to standard error. Ignores failure, which cannot
/// be reported anywhere.
fn eprint(text: &str) {
    use std::io::Write;
    let _ = io::stderr().write_all(text.as_bytes());
}
