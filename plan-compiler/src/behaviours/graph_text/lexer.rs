//! The lexer: names, arrows and brackets.

use super::{Mistake, tidy};
use crate::toml::Span;

/// A token of the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// Consecutive words, or anything in quotes.
    Name(String),
    /// `->`
    Arrow,
    /// `-`, which begins a named edge.
    Dash,
    /// `(`
    Open,
    /// `)`
    Close,
    /// `|`
    Bar,
    /// `;`
    Semicolon,
}

/// The tokens of a text.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, Vec<Mistake>> {
    let (mut tokens, mut mistakes): (Vec<Token>, Vec<Mistake>) = (Vec::new(), Vec::new());
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let length = match first {
            _ if first.is_whitespace() => first.len_utf8(),
            '\'' | '"' => match text[at + 1..].find(first) {
                Some(length) => {
                    let name = text[at + 1..at + 1 + length].trim().to_owned();
                    tokens.push(Token { kind: Kind::Name(name), span: at..at + length + 2 });
                    length + 2
                }
                None => {
                    let help = "close the quote, or remove it";
                    let span = at..text.len();
                    mistakes.push(Mistake::new("a quote is not closed", &span, "from here", help));
                    text.len() - at
                }
            },
            _ if is_of_name(first) => {
                let length = word(&text[at..]);
                add_word(&mut tokens, text, at..at + length);
                length
            }
            '(' if values(&tokens, text, at).is_some() => {
                let length = values(&tokens, text, at).unwrap_or(1);
                add_values(&mut tokens, &text[at..at + length], at + length);
                length
            }
            _ => match symbol(&text[at..]) {
                Some((kind, length)) => {
                    tokens.push(Token { kind, span: at..at + length });
                    length
                }
                None => {
                    let span = at..at + first.len_utf8();
                    let message = format!("`{first}` is not allowed in a graph");
                    let help = "write for example entry -> a -> (b | c) -> exit";
                    mistakes.push(Mistake::new(message, &span, "this character", help));
                    first.len_utf8()
                }
            },
        };
        at += length;
    }
    if mistakes.is_empty() { Ok(tokens) } else { Err(mistakes) }
}

fn is_of_name(character: char) -> bool {
    character.is_alphanumeric() || matches!(character, '_' | '.' | '/' | '+')
}

/// The length of a word; a hyphen within it belongs to it.
fn word(text: &str) -> usize {
    let mut characters = text.char_indices().peekable();
    while let Some((at, character)) = characters.next() {
        let next = characters.peek().map(|&(_, next)| next);
        let is_inside = character == '-' && at > 0 && next.is_some_and(is_of_name);
        if !is_of_name(character) && !is_inside {
            return at;
        }
    }
    text.len()
}

/// Adds a word; consecutive words form one name.
fn add_word(tokens: &mut Vec<Token>, text: &str, span: Span) {
    let word = &text[span.clone()];
    if let Some(Token { kind: Kind::Name(name), span: before }) = tokens.last_mut()
        && !text[before.clone()].starts_with(['\'', '"'])
    {
        name.push(' ');
        name.push_str(word);
        before.end = span.end;
    } else {
        tokens.push(Token { kind: Kind::Name(word.to_owned()), span });
    }
}

/// The length of the values `(10, 12)` that follow a name directly.
fn values(tokens: &[Token], text: &str, at: usize) -> Option<usize> {
    let last = tokens.last().filter(|token| token.span.end == at)?;
    let is_name =
        matches!(last.kind, Kind::Name(_)) && !text[last.span.clone()].ends_with(['\'', '"']);
    let length = text[at..].find(')')? + 1;
    let inside = &text[at + 1..at + length - 1];
    (is_name && !inside.contains(['(', '|', ';']) && !inside.contains("->")).then_some(length)
}

/// Makes values a part of the name before them.
fn add_values(tokens: &mut [Token], values: &str, end: usize) {
    if let Some(Token { kind: Kind::Name(name), span }) = tokens.last_mut() {
        name.push_str(values);
        *name = tidy(name).into_owned();
        span.end = end;
    }
}

fn symbol(text: &str) -> Option<(Kind, usize)> {
    let all = [
        ("->", Kind::Arrow),
        ("-", Kind::Dash),
        ("(", Kind::Open),
        (")", Kind::Close),
        ("|", Kind::Bar),
        (";", Kind::Semicolon),
    ];
    all.into_iter().find(|(symbol, _)| text.starts_with(symbol)).map(|(s, kind)| (kind, s.len()))
}
