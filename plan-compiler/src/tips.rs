//! A line on what was probably meant, for command lines that clap refuses.

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
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

/// What was probably meant, as a line; `None` where clap says it all.
pub(crate) fn of(error: &Error, arguments: &[String]) -> Option<String> {
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let word = context(error, ContextKind::InvalidSubcommand)?;
            let (_, command) = SYNONYMS.iter().find(|(other, _)| *other == word)?;
            Some(format!("`{word}` is called `{command}` here: plan-compiler {command} ..."))
        }
        ErrorKind::UnknownArgument => {
            let stray = context(error, ContextKind::InvalidArg)?;
            stray_word(&stray, arguments)
        }
        // The end of a goal may have been taken for something else; its beginning tells.
        _ => None,
    }
}

/// A word that belongs to the one before it.
fn stray_word(stray: &str, arguments: &[String]) -> Option<String> {
    if stray.starts_with('-') {
        return None;
    }
    let at = arguments.iter().position(|argument| argument == stray)?;
    let before = arguments.get(at.checked_sub(1)?)?;
    let joined = format!("{before} {stray}");
    let is_number = stray.parse::<f64>().is_ok();
    if is_number && before.ends_with(',') {
        return Some(format!("write a point without a blank: {before}{stray}"));
    }
    // The name may have more than one blank: what stands from the first word on.
    let whole = (0..at).map(|first| arguments[first..=at].join(" "));
    let file = whole.into_iter().find(|name| Path::new(name).exists());
    let name = file.unwrap_or(joined);
    (!before.starts_with('-')).then(|| format!("put a name with blanks in quotes: \"{name}\""))
}

fn context(error: &Error, kind: ContextKind) -> Option<String> {
    match error.get(kind)? {
        ContextValue::String(text) => Some(text.clone()),
        _ => None,
    }
}
