//! Splits overlay text into tokens: words, quoted strings, numbers.

use crate::problem::{Problem, Source};
use std::ops::Range;
use std::sync::Arc;

/// Unknown characters that are reported one by one; the rest are counted.
const MAX_UNKNOWN_REPORTED: usize = 20;

/// One token and its bytes in the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) span: Range<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A keyword or a bare name, with its trailing `*`.
    Word,
    /// A quoted name; the span includes the quotes.
    Quoted,
    /// A finite number.
    Number(f64),
    /// The colon of `CONTROL MEASURES:`.
    Colon,
    /// A token that was reported already; the parser does not report it again.
    Broken,
}

/// The tokens of a text.
#[derive(Debug, Default)]
pub(super) struct Lexed {
    pub(super) tokens: Vec<Token>,
    /// Resolution from the comment `--RESOLUTION 1.0`, metres; the last one counts.
    pub(super) resolution_m: Option<f64>,
}

/// Splits a text into tokens.
pub(super) fn lex(source: &Arc<Source>, problems: &mut Vec<Problem>) -> Lexed {
    let mut lexer = Lexer { source, problems, at: 0, unknown: 0, lexed: Lexed::default() };
    while lexer.at < source.text.len() {
        lexer.step();
    }
    if let Some(more @ 1..) = lexer.unknown.checked_sub(MAX_UNKNOWN_REPORTED) {
        let message = format!("{more} more unknown characters are skipped");
        lexer.problems.push(Problem::warning(message));
    }
    lexer.lexed
}

struct Lexer<'a> {
    source: &'a Arc<Source>,
    problems: &'a mut Vec<Problem>,
    /// Bytes consumed.
    at: usize,
    /// Runs of unknown characters so far.
    unknown: usize,
    lexed: Lexed,
}

impl Lexer<'_> {
    /// Consumes white space, a comment or a token; always at least one character.
    fn step(&mut self) {
        let rest = &self.source.text[self.at..];
        let Some(first) = rest.chars().next() else { return };
        if first.is_whitespace() {
            self.at += first.len_utf8();
        } else if rest.starts_with("--") {
            let length = line_length(rest);
            self.look_for_resolution(&rest[..length]);
            self.at += length;
        } else if first == '"' {
            self.quoted(rest);
        } else if let Some(length) = number_length(rest) {
            self.number(rest, length);
        } else if first.is_alphabetic() {
            let length = word_length(rest);
            self.push(Kind::Word, length);
        } else if first == ':' && self.after_measures() {
            self.push(Kind::Colon, 1);
        } else {
            self.skip_unknown(rest);
        }
    }

    fn push(&mut self, kind: Kind, length: usize) {
        self.lexed.tokens.push(Token { kind, span: self.at..self.at + length });
        self.at += length;
    }

    fn quoted(&mut self, rest: &str) {
        // A quote ends on its line. Stop at the first quote: the file may be one long line.
        let inside = rest[1..].find(['"', '\n', '\r']);
        if let Some(inside) = inside.filter(|&inside| rest[1 + inside..].starts_with('"')) {
            return self.push(Kind::Quoted, inside + 2);
        }
        let line = &rest[..line_length(rest)];
        let written = line.trim_end().len();
        self.problems.push(
            Problem::error("a quoted name is not closed")
                .at(self.source, self.at..self.at + written, "no closing quote on this line")
                .help("close the name with \" on the same line"),
        );
        self.push(Kind::Broken, line.len());
    }

    fn number(&mut self, rest: &str, length: usize) {
        let whole = rest[length..]
            .find(|c| !matches!(c, '0'..='9' | '.'))
            .map_or(rest.len(), |after| length + after);
        let value: Option<f64> =
            rest[..length].parse().ok().filter(|value: &f64| value.is_finite());
        match value {
            Some(value) if whole == length => self.push(Kind::Number(value), length),
            _ => {
                let label = if whole > length { "more than one point" } else { "too large" };
                self.problems.push(
                    Problem::error(format!("{} is not a number", &rest[..whole]))
                        .at(self.source, self.at..self.at + whole, label)
                        .help("write a number as 12, -0.5 or 1.2e3"),
                );
                self.push(Kind::Broken, whole);
            }
        }
    }

    fn skip_unknown(&mut self, rest: &str) {
        let known = |c: char| {
            c.is_whitespace() || c.is_alphanumeric() || matches!(c, '"' | '-' | '+' | '.')
        };
        let first = rest.chars().next().map_or(1, char::len_utf8);
        let length = first + rest[first..].find(known).unwrap_or(rest.len() - first);
        self.unknown += 1;
        if self.unknown <= MAX_UNKNOWN_REPORTED {
            let help = match rest.as_bytes()[0] {
                b'#' => "begin comments with -- instead",
                b'\'' => "put names in double quotes",
                _ => "remove it, or put the name that it belongs to in quotes",
            };
            self.problems.push(
                Problem::warning(format!("{:?} means nothing here", &rest[..length]))
                    .at(self.source, self.at..self.at + length, "skipped")
                    .help(help),
            );
        }
        self.at += length;
    }

    fn after_measures(&self) -> bool {
        self.lexed.tokens.last().is_some_and(|token| {
            self.source.text[token.span.clone()].eq_ignore_ascii_case("MEASURES")
        })
    }

    /// The original plan generator keeps its cell size in a comment, `--RESOLUTION 1.0`.
    fn look_for_resolution(&mut self, comment: &str) {
        let mut words = comment.trim_start_matches('-').split_whitespace();
        if !words.next().is_some_and(|word| word.eq_ignore_ascii_case("RESOLUTION")) {
            return;
        }
        // Prose that begins with the word is not a command.
        let Some(value) = words.next().and_then(|word| word.parse::<f64>().ok()) else { return };
        if value > 0.0 && value.is_finite() {
            self.lexed.resolution_m = Some(value);
        } else {
            self.problems.push(
                Problem::error("the resolution must be above zero")
                    .at(self.source, self.at..self.at + comment.trim_end().len(), "metres per cell")
                    .help("write for example --RESOLUTION 1.0"),
            );
        }
    }
}

fn line_length(text: &str) -> usize {
    text.find(['\n', '\r']).unwrap_or(text.len())
}

/// Length of a name: letters, digits, `_`, `-`; between them `.` and `/` for file names and
/// `LD/LC`; then an optional `*`.
fn word_length(text: &str) -> usize {
    let is_inner = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-');
    let mut length = 0;
    loop {
        let rest = &text[length..];
        length += rest.find(|c| !is_inner(c)).unwrap_or(rest.len());
        let mut next = text[length..].chars();
        let joined = matches!(next.next(), Some('.' | '/')) && next.next().is_some_and(is_inner);
        if !joined {
            return length + usize::from(text[length..].starts_with('*'));
        }
        length += 1;
    }
}

/// Length of `[+-] digits [. digits] [e [+-] digits]` at the start of a text; a digit must stand
/// before or after the point.
fn number_length(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes.get(from..).map_or(0, |rest| rest.iter().take_while(|b| b.is_ascii_digit()).count())
    };
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut length = sign(0);
    let whole = digits(length);
    length += whole;
    let mut fraction = 0;
    if bytes.get(length) == Some(&b'.') {
        fraction = digits(length + 1);
        if whole + fraction > 0 {
            length += 1 + fraction;
        }
    }
    if whole + fraction == 0 {
        return None;
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let exponent = length + 1 + sign(length + 1);
        if digits(exponent) > 0 {
            length = exponent + digits(exponent);
        }
    }
    Some(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: &str) {
        let source = Arc::new(Source { name: "a.ovl".into(), text: text.into() });
        let mut problems = Vec::new();
        let lexed = lex(&source, &mut problems);
        let mut got: Vec<String> = lexed
            .tokens
            .iter()
            .map(|token| match token.kind {
                Kind::Number(value) => format!("{value}"),
                Kind::Broken => "BROKEN".into(),
                _ => text[token.span.clone()].into(),
            })
            .collect();
        got.extend(lexed.resolution_m.map(|metres| format!("({metres} m)")));
        got.extend(problems.iter().map(|problem| format!("[{problem}]")));
        assert_eq!(got.join(" | "), expected, "{text:?}");
    }

    #[test]
    fn words_numbers_and_strings() {
        check("PP Start-Place_1* 1 2", "PP | Start-Place_1* | 1 | 2");
        check("a** b*c", "a* | b* | c | [\"*\" means nothing here]");
        check(
            "island-3d.hm LD/LC a. b/",
            "island-3d.hm | LD/LC | a | b | [\".\" means nothing here] | [\"/\" means nothing here]",
        );
        check(
            "1 -2 +3 .5 5. -.5 1e3 1.5E-2 2e",
            "1 | -2 | 3 | 0.5 | 5 | -0.5 | 1000 | 0.015 | 2 | e",
        );
        check("1-2 3FIXED", "1 | -2 | 3 | FIXED");
        check(r#"PP "a -- b*" "" 1"#, r#"PP | "a -- b*" | "" | 1"#);
        check("Stra\u{df}e 1", "Stra\u{df}e | 1");
    }

    #[test]
    fn comments_run_to_the_end_of_the_line() {
        check("1 -- 2\n3 --4\r\n5 --6\r7", "1 | 3 | 5 | 7");
        check("---- x", "");
    }

    #[test]
    fn a_comment_may_give_the_resolution() {
        check("--RESOLUTION 1.0", "(1 m)");
        check("-- resolution 0.25 m\n1", "1 | (0.25 m)");
        check("-- RESOLUTION is good", "");
        check("--RESOLUTION 0", "[the resolution must be above zero]");
        check("--RESOLUTION inf", "[the resolution must be above zero]");
    }

    #[test]
    fn the_colon_belongs_to_measures_only() {
        check("Measures : a", "Measures | : | a");
        check("a: b", "a | b | [\":\" means nothing here]");
    }

    #[test]
    fn mistakes_are_reported_once_each() {
        check("1, 2", "1 | 2 | [\",\" means nothing here]");
        check("PP \"Home 1 2\nPP", "PP | BROKEN | PP | [a quoted name is not closed]");
        check("1.2.3 4", "BROKEN | 4 | [1.2.3 is not a number]");
        check("1e999", "BROKEN | [1e999 is not a number]");
        check("\u{1f600}# 5", "5 | [\"\u{1f600}#\" means nothing here]");
        check(
            &"; ".repeat(25),
            &format!(
                "{}[5 more unknown characters are skipped]",
                "[\";\" means nothing here] | ".repeat(20)
            ),
        );
    }
}
