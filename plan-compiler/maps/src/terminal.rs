//! Text of files and command lines, made safe for a terminal.
//!
//! Names, excerpts and file names come from untrusted files. A terminal obeys escape sequences in
//! them, and characters that change the writing direction misrepresent the text. All output for
//! people passes through here; JSON does its own escaping.

use std::borrow::Cow;
use std::path::Path;

/// Replaces a character that has no visible picture.
const UNSHOWN: char = '\u{fffd}';

/// Replaces control characters by their pictures, except line ends and tabs.
pub fn safe(text: &str) -> Cow<'_, str> {
    replaced(text, |character| match character {
        '\n' | '\t' => None,
        other => picture(other),
    })
}

/// As [`safe`], but also replaces line ends: one in a name would begin another message.
pub fn safe_line(text: &str) -> Cow<'_, str> {
    replaced(text, picture)
}

/// The replacement of a character that must not reach a terminal.
pub(crate) fn picture(character: char) -> Option<char> {
    match character {
        '\0'..='\u{1f}' => char::from_u32(0x2400 + u32::from(character)),
        '\u{7f}' => Some('\u{2421}'),
        // C1 controls; some are escape sequences in one character.
        '\u{80}'..='\u{9f}' => Some(UNSHOWN),
        // Bidirectional marks, embeddings, overrides and isolates.
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            Some(UNSHOWN)
        }
        // Unicode line and paragraph separators.
        '\u{2028}' | '\u{2029}' => Some(UNSHOWN),
        _ => None,
    }
}

/// A file's name as one word of a shell's command, for commands that a message shows.
pub fn quoted(path: &Path) -> String {
    let name = path.display().to_string();
    // A name that begins with a hyphen would be an option.
    let name = if name.starts_with('-') { format!("./{name}") } else { name };
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._/+-".contains(c);
    match !name.is_empty() && name.chars().all(is_plain) {
        true => name,
        false => format!("'{}'", name.replace('\'', "'\\''")),
    }
}

fn replaced(text: &str, instead: impl Fn(char) -> Option<char>) -> Cow<'_, str> {
    if text.chars().all(|character| instead(character).is_none()) {
        return Cow::Borrowed(text);
    }
    text.chars().map(|character| instead(character).unwrap_or(character)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_one_word_of_a_command() {
        for (name, word) in [
            ("maps/yard-1.osm", "maps/yard-1.osm"),
            ("C++_2.bin", "C++_2.bin"),
            ("-yard.osm", "./-yard.osm"),
            ("my yard.osm", "'my yard.osm'"),
            ("yard(1).osm", "'yard(1).osm'"),
            ("ya$(id)rd.osm", "'ya$(id)rd.osm'"),
            ("it's.osm", "'it'\\''s.osm'"),
            ("Höfe.osm", "'Höfe.osm'"),
            ("", "''"),
        ] {
            assert_eq!(quoted(Path::new(name)), word);
        }
    }

    #[test]
    fn controls_are_shown_and_letters_stay() {
        for (text, shown) in [
            ("Tür 5 °\t東\n", "Tür 5 °\t東\n"),
            ("a\u{1b}]0;owned\u{7}b", "a␛]0;owned␇b"),
            ("\u{9b}31m \u{7f}", "\u{fffd}31m ␡"),
            ("abc\u{202e}fed\u{2066}", "abc\u{fffd}fed\u{fffd}"),
            ("a\r\nb", "a␍\nb"),
        ] {
            assert_eq!(safe(text), shown);
        }
        assert_eq!(safe_line("a\nb\tc"), "a␊b␉c");
        assert!(matches!(safe("plain"), Cow::Borrowed(_)));
    }
}
