//! Mistakes in a TOML file, each with its place.

use maps::names::nearest;
use maps::problem::{Place, Problem, Source};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml_edit::Item;

/// Bytes of the file.
pub type Span = Range<usize>;

/// A value and where it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its bytes in the file.
    pub span: Span,
}

/// A text and where it is written.
pub type Text = Spanned<String>;

impl Text {
    /// The text.
    pub fn as_str(&self) -> &str {
        &self.value
    }
}

/// Collects the mistakes in one file.
pub(crate) struct Report<'r> {
    pub(crate) source: &'r Arc<Source>,
    pub(crate) problems: &'r mut Vec<Problem>,
}

impl Report<'_> {
    /// A place in the file, without a label.
    pub(crate) fn place(&self, span: &Span) -> Place {
        Place { source: Arc::clone(self.source), span: span.clone(), label: String::new() }
    }

    /// The path of a file that the text names relative to its own folder.
    pub(crate) fn beside(&self, name: &str) -> PathBuf {
        Path::new(&self.source.name).parent().unwrap_or(Path::new("")).join(name)
    }

    pub(crate) fn error(
        &mut self,
        message: impl Into<String>,
        span: &Span,
        label: &str,
        help: &str,
    ) {
        self.add(Problem::error(message), span, label, help);
    }

    pub(crate) fn warning(
        &mut self,
        message: impl Into<String>,
        span: &Span,
        label: &str,
        help: &str,
    ) {
        self.add(Problem::warning(message), span, label, help);
    }

    fn add(&mut self, problem: Problem, span: &Span, label: &str, help: &str) {
        self.problems.push(problem.at(self.source, span.clone(), label).help(help));
    }

    /// An unknown name, with the known name that was probably meant.
    pub(crate) fn unknown<'c>(
        &mut self,
        what: &str,
        name: &Text,
        known: impl Iterator<Item = &'c str>,
        how: &str,
    ) {
        let message = format!("there is no {what} `{}`", name.as_str());
        let help = meant(name.as_str(), known).unwrap_or_else(|| how.to_owned());
        self.error(message, &name.span, "unknown name", &help);
    }

    /// A key that its table does not have; `table` names the table in the message.
    pub(crate) fn unknown_key<'c>(
        &mut self,
        table: &str,
        key: &str,
        span: &Span,
        known: impl Iterator<Item = &'c str>,
        how: &str,
    ) {
        let help = meant(key, known).unwrap_or_else(|| how.to_owned());
        self.error(format!("`{key}` is not a key of {table}"), span, "unknown key", &help);
    }

    /// A word that is not one of those that a key takes.
    pub(crate) fn unknown_word<'c>(
        &mut self,
        path: &str,
        word: &str,
        span: &Span,
        known: impl Iterator<Item = &'c str> + Clone,
    ) {
        let label = match nearest(word, known.clone()) {
            Some(meant) => format!("did you mean \"{meant}\"?"),
            None => "not an allowed word".into(),
        };
        let known: Vec<String> = known.map(|word| format!("\"{word}\"")).collect();
        let help = format!("write {}", known.join(" or "));
        self.error(format!("`{path}` cannot be \"{word}\""), span, &label, &help);
    }

    /// A number outside the range that `expected` describes.
    pub(crate) fn out_of_range(&mut self, path: &str, span: &Span, expected: &str) {
        let message = format!("`{path}` is out of range");
        self.error(message, span, "this number", &format!("write {expected}"));
    }

    /// A value that does not have the type that `expected` describes.
    pub(crate) fn wrong_type(
        &mut self,
        path: &str,
        item: &Item,
        span: &Span,
        expected: &str,
        example: &str,
    ) {
        let label = format!("this is {}", with_article(item.type_name()));
        let message = format!("`{path}` must be {expected}");
        self.error(message, span, &label, &format!("write {example}"));
    }
}

/// A question about what was probably meant, if a known word is similar.
fn meant<'c>(word: &str, known: impl Iterator<Item = &'c str>) -> Option<String> {
    nearest(word, known).map(|meant| format!("did you mean `{meant}`?"))
}

/// Where a part of a text is in the file; the whole text if the file writes it with escapes.
pub(crate) fn part_of(source: &Source, text: &Text, part: Span) -> Span {
    let raw = source.text.get(text.span.clone()).unwrap_or("");
    match raw.find(text.as_str()) {
        Some(at) => {
            let start = text.span.start + at;
            start + part.start..start + part.end
        }
        None => text.span.clone(),
    }
}

fn with_article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}
