//! Splits OPAR text into a title and numbers.

use std::ops::Range;

/// A number and its bytes in the file.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) number: f64,
    pub(super) span: Range<usize>,
}

/// A file split into its title and its numbers.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub(super) title: Option<Range<usize>>,
    /// The number that begins the title line, if any.
    pub(super) title_number: Option<Value>,
    /// Numbers after the title.
    pub(super) numbers: Vec<Value>,
    /// First tokens that look like a number but are not.
    pub(super) garbled: Vec<Range<usize>>,
}

impl Lines {
    pub(super) fn split(text: &str) -> Self {
        let mut lines = Self::default();
        let mut start = 0;
        for line in text.split_inclusive(['\n', '\r']) {
            let at = start + line.len() - line.trim_start().len();
            start += line.len();
            let content = line.trim();
            if content.is_empty() || content.starts_with('#') {
                continue;
            }
            let token = content.split_whitespace().next().unwrap_or(content);
            let span = at..at + token.len();
            let number = number(token).map(|number| Value { number, span: span.clone() });
            if lines.title.is_none() {
                lines.title = Some(at..at + content.len());
                lines.title_number = number;
            } else if let Some(number) = number {
                lines.numbers.push(number);
            } else if looks_like_a_number(token) {
                lines.garbled.push(span.clone());
                // It keeps its place, so that later values keep their meaning.
                let number = self::number(&token.replace(',', ".")).unwrap_or(0.0);
                lines.numbers.push(Value { number, span });
            }
        }
        lines
    }

    pub(super) fn values(&self) -> Vec<Value> {
        self.numbers.clone()
    }

    pub(super) fn values_and_title(&self) -> Vec<Value> {
        self.title_number.iter().chain(&self.numbers).cloned().collect()
    }
}

/// Parses a finite number; words such as `inf` and `nan` are annotations here.
fn number(token: &str) -> Option<f64> {
    if !begins_like_a_number(token)
        || token.contains(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E'))
    {
        return None;
    }
    token.parse().ok().filter(|number: &f64| number.is_finite())
}

fn begins_like_a_number(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))
}

/// Whether a token has only digits and marks, with at least one digit: `12,5` is a mistake, `2nd`
/// a word.
fn looks_like_a_number(token: &str) -> bool {
    begins_like_a_number(token)
        && token.contains(|c: char| c.is_ascii_digit())
        && token
            .chars()
            .all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ',' | 'e' | 'E'))
}
