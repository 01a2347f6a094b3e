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
            _ => match (values_apart(&tokens, text, at), symbol(&text[at..])) {
                (Some(mistake), _) => {
                    let length = mistake.span.end - at;
                    mistakes.push(mistake);
                    length
                }
                (None, Some((kind, length))) => {
                    tokens.push(Token { kind, span: at..at + length });
                    length
                }
                (None, None) => {
                    let rest = &text[at..];
                    let begins = |&(at, character): &(usize, char)| {
                        character.is_whitespace()
                            || is_of_name(character)
                            || matches!(character, '\'' | '"')
                            || symbol(&rest[at..]).is_some()
                    };
                    let length = rest.char_indices().find(begins).map_or(rest.len(), |(at, _)| at);
                    mistakes.push(not_allowed(&rest[..length], at));
                    length
                }
            },
        };
        at += length;
    }
    if mistakes.is_empty() { Ok(tokens) } else { Err(mistakes) }
}

/// Characters that a graph cannot have, `at` a place in the text.
fn not_allowed(characters: &str, at: usize) -> Mistake {
    let message = format!("`{characters}` is not allowed in a graph");
    let label = if characters.chars().count() == 1 { "this character" } else { "these characters" };
    let is_arrow = characters.contains(['>', '→', '⇒', '⟶']);
    let help = match is_arrow {
        true => "write an arrow as ->",
        false => "write for example entry -> a -> (b | c) -> exit",
    };
    Mistake::new(message, &(at..at + characters.len()), label, help)
}

/// Values in brackets that follow a name after a space, as a mistake.
fn values_apart(tokens: &[Token], text: &str, at: usize) -> Option<Mistake> {
    let rest = text[at..].strip_prefix('(')?;
    let end = text[..at].trim_end().len();
    let last = tokens.last().filter(|token| token.span.end == end && end < at)?;
    let Kind::Name(name) = &last.kind else { return None };
    let is_quoted = text[last.span.clone()].ends_with(['\'', '"']);
    if is_quoted || matches!(name.as_str(), "entry" | "exit") {
        return None;
    }
    let (inside, _) = rest.split_once(')')?;
    if inside.contains(['(', '|', ';']) || inside.contains("->") {
        return None;
    }
    let message = format!("the values of `{name}` follow after a space");
    let help = format!("write {name}({inside})");
    let span = last.span.start..at + inside.len() + 2;
    Some(Mistake::new(message, &span, "this name", &help))
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
