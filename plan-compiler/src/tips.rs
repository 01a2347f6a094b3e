//! Hints on what was probably meant, for command lines that clap refuses.

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use maps::terminal::quoted;
use std::path::Path;

/// Words that other programs use for our commands.
const SYNONYMS: [(&str, &str); 14] = [
    ("compile", "build"),
    ("make", "build"),
    ("plan", "build"),
    ("generate", "build"),
    ("info", "inspect"),
    ("show", "inspect"),
    ("list", "inspect"),
    ("draw", "render"),
    ("plot", "render"),
    ("picture", "render"),
    ("route", "query"),
    ("check", "verify"),
    ("prove", "verify"),
    ("trace", "explain"),
];

/// A hint about a command line.
pub(crate) enum Tip {
    /// Printed after the message of clap.
    Besides(String),
    /// Printed instead of the message of clap, which compares letters only.
    Instead(String),
}

/// What was probably meant; `None` if the message of clap is enough.
pub(crate) fn of(error: &Error, arguments: &[String]) -> Option<Tip> {
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let word = context(error, ContextKind::InvalidSubcommand)?;
            let (_, command) = SYNONYMS.iter().find(|(other, _)| *other == word)?;
            Some(Tip::Instead(format!(
                "error: unrecognized subcommand '{word}'\n\n  tip: `{word}` is called `{command}` \
                 here: plan-compiler {command} ...\n\nFor more information, try '--help'.\n"
            )))
        }
        ErrorKind::UnknownArgument => {
            let stray = context(error, ContextKind::InvalidArg)?;
            let tip = stray_word(&stray, arguments)?;
            Some(Tip::Besides(format!("\n  tip: {tip}\n")))
        }
        _ => None,
    }
}

/// A hint about a word that belongs to the one before it.
fn stray_word(stray: &str, arguments: &[String]) -> Option<String> {
    if stray.starts_with('-') {
        return None;
    }
    let at = arguments.iter().position(|argument| argument == stray)?;
    let before = arguments.get(at.checked_sub(1)?)?;
    if arguments.first().is_some_and(|command| command == "man") {
        return Some("give one command, or none for the page of the program".to_owned());
    }
    let joined = format!("{before} {stray}");
    let is_number = stray.parse::<f64>().is_ok();
    if is_number && before.ends_with(',') {
        return Some(format!("write a point without a space: {before}{stray}"));
    }
    // The name may contain several spaces: try all words up to this one, then fewer.
    let whole = (0..at).map(|first| arguments[first..=at].join(" "));
    let file = whole.into_iter().find(|name| Path::new(name).exists());
    let name = file.unwrap_or(joined);
    let is_shell = |word: &str| [">", "<", "|"].contains(&word);
    let is_name = !before.starts_with('-') && !is_shell(before) && !is_shell(stray);
    is_name.then(|| format!("put a name with spaces in quotes: {}", quoted(Path::new(&name))))
}

fn context(error: &Error, kind: ContextKind) -> Option<String> {
    match error.get(kind)? {
        ContextValue::String(text) => Some(text.clone()),
        _ => None,
    }
}
