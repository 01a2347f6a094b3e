//! Typed values out of TOML tables, with a place for every mistake.

use crate::mission::{nearest, number, with_article};
use crate::problem::{Problem, Source};
use std::ops::{Range, RangeInclusive};
use std::sync::Arc;
use toml_edit::{Item, TableLike, Value};

/// Bytes of the mission file.
pub type Span = Range<usize>;

/// A value and where it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its bytes in the mission file.
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

/// Gathers the mistakes in one file.
pub(super) struct Report<'r> {
    pub(super) source: &'r Arc<Source>,
    pub(super) problems: &'r mut Vec<Problem>,
}

impl Report<'_> {
    pub(super) fn error(
        &mut self,
        message: impl Into<String>,
        span: &Span,
        label: &str,
        mend: &str,
    ) {
        self.add(Problem::error(message), span, label, mend);
    }

    pub(super) fn warning(
        &mut self,
        message: impl Into<String>,
        span: &Span,
        label: &str,
        mend: &str,
    ) {
        self.add(Problem::warning(message), span, label, mend);
    }

    fn add(&mut self, problem: Problem, span: &Span, label: &str, mend: &str) {
        self.problems.push(problem.at(self.source, span.clone(), label).mend(mend));
    }

    /// A name that stands for nothing, with the one that was probably meant.
    pub(super) fn unknown<'c>(
        &mut self,
        what: &str,
        name: &Text,
        known: impl Iterator<Item = &'c str> + Clone,
        how: &str,
    ) {
        let mend = match nearest(name.as_str(), known.clone()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => how.to_owned(),
        };
        self.error(
            format!("there is no {what} `{}`", name.as_str()),
            &name.span,
            "unknown name",
            &mend,
        );
    }

    pub(super) fn wrong_type(
        &mut self,
        path: &str,
        item: &Item,
        span: &Span,
        expected: &str,
        example: &str,
    ) {
        let label = format!("this is {}", with_article(item.type_name()));
        self.error(
            format!("`{path}` must be {expected}"),
            span,
            &label,
            &format!("write {example}"),
        );
    }
}

/// A table whose keys are known.
pub(super) struct Fields<'t> {
    pub(super) path: String,
    table: &'t dyn TableLike,
    /// Where the table's name is written.
    pub(super) span: Span,
}

impl<'t> Fields<'t> {
    /// Opens a table and says which of its keys are not known.
    pub(super) fn open(
        report: &mut Report<'_>,
        path: String,
        item: &'t Item,
        span: Span,
        known: &[&str],
        example: &str,
    ) -> Option<Self> {
        let Some(table) = item.as_table_like() else {
            let here = item.span().unwrap_or(span);
            report.wrong_type(&path, item, &here, "a table", example);
            return None;
        };
        let fields = Self { path, table, span };
        for (key, _) in table.iter().filter(|(key, _)| !known.contains(key)) {
            let mend = match nearest(key, known.iter().copied()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("known here: {}", known.join(", ")),
            };
            let message = format!("`{key}` is not a key of `{}`", fields.path);
            report.error(message, &key_span(table, key), "unknown key", &mend);
        }
        Some(fields)
    }

    /// An item and where its value is written.
    pub(super) fn item(&self, key: &str) -> Option<(&'t Item, Span)> {
        let item = self.table.get(key).filter(|item| !item.is_none())?;
        Some((item, item.span().unwrap_or_else(|| self.key_span(key))))
    }

    /// Where a key is written.
    pub(super) fn key_span(&self, key: &str) -> Span {
        key_span(self.table, key)
    }

    fn path(&self, key: &str) -> String {
        format!("{}.{key}", self.path)
    }

    /// A number in a range, in a unit.
    pub(super) fn number(
        &self,
        report: &mut Report<'_>,
        key: &str,
        range: RangeInclusive<f64>,
        unit: &str,
    ) -> Option<Spanned<f64>> {
        let (item, span) = self.item(key)?;
        let (low, high) = (range.start(), range.end());
        let expected = format!("a number from {low} to {high} {unit}").trim_end().to_owned();
        match item.as_value().and_then(number) {
            Some(value) if range.contains(&value) => Some(Spanned { value, span }),
            Some(_) => {
                let message = format!("`{}` is out of range", self.path(key));
                report.error(message, &span, "this number", &format!("write {expected}"));
                None
            }
            None => {
                let typical = if range.contains(&1.0) { 1.0 } else { *low };
                let example = format!("{key} = {typical:?}");
                report.wrong_type(&self.path(key), item, &span, &expected, &example);
                None
            }
        }
    }

    /// Some finite numbers.
    pub(super) fn numbers<const N: usize>(
        &self,
        report: &mut Report<'_>,
        key: &str,
        expected: &str,
        example: &str,
    ) -> Option<[f32; N]> {
        let (item, span) = self.item(key)?;
        let array = item.as_value().and_then(Value::as_array);
        let numbers = array.map(|array| {
            array.iter().filter_map(number).map(|value| value as f32).collect::<Vec<f32>>()
        });
        let numbers = numbers
            .filter(|numbers| array.is_some_and(|array| array.len() == numbers.len()))
            .filter(|numbers| numbers.iter().all(|value| value.is_finite()))
            .and_then(|numbers| <[f32; N]>::try_from(numbers).ok());
        if numbers.is_none() {
            report.wrong_type(&self.path(key), item, &span, expected, example);
        }
        numbers
    }

    /// A text that says something.
    pub(super) fn text(&self, report: &mut Report<'_>, key: &str, example: &str) -> Option<Text> {
        let (item, span) = self.item(key)?;
        match item.as_str().map(str::trim) {
            Some(text) if !text.is_empty() => Some(Spanned { value: text.to_owned(), span }),
            Some(_) => {
                let message = format!("`{}` is empty", self.path(key));
                report.error(message, &span, "this text", &format!("write {key} = {example}"));
                None
            }
            None => {
                let example = format!("{key} = {example}");
                report.wrong_type(&self.path(key), item, &span, "a text", &example);
                None
            }
        }
    }

    /// A list of texts, or one text.
    pub(super) fn texts(&self, report: &mut Report<'_>, key: &str, example: &str) -> Vec<Text> {
        let Some((item, span)) = self.item(key) else { return Vec::new() };
        let text = |value: &Value| {
            let span = value.span().unwrap_or_else(|| span.clone());
            value.as_str().map(|text| Spanned { value: text.trim().to_owned(), span })
        };
        let texts: Option<Vec<Text>> = match item.as_value() {
            Some(Value::Array(array)) => array.iter().map(text).collect(),
            Some(value) => text(value).map(|text| vec![text]),
            None => None,
        };
        texts.unwrap_or_else(|| {
            let example = format!("{key} = [\"{example}\"]");
            report.wrong_type(&self.path(key), item, &span, "a list of texts", &example);
            Vec::new()
        })
    }

    /// One of several words.
    pub(super) fn word<T: Copy>(
        &self,
        report: &mut Report<'_>,
        key: &str,
        words: &[(&str, T)],
    ) -> Option<T> {
        let text = self.text(report, key, &format!("\"{}\"", words.first()?.0))?;
        let found = words.iter().find(|(word, _)| *word == text.as_str());
        if found.is_none() {
            let known: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
            let label = match nearest(text.as_str(), words.iter().map(|(word, _)| *word)) {
                Some(meant) => format!("did you mean \"{meant}\"?"),
                None => "not one of its words".into(),
            };
            let message = format!("`{}` cannot be \"{}\"", self.path(key), text.as_str());
            report.error(message, &text.span, &label, &format!("write {}", known.join(" or ")));
        }
        found.map(|(_, value)| *value)
    }
}

/// Where a key is written.
pub(super) fn key_span(table: &dyn TableLike, key: &str) -> Span {
    table.key(key).and_then(toml_edit::Key::span).unwrap_or(0..0)
}

/// Where a part of a text is written, if the text is written as it is meant; else the whole.
pub(super) fn part_of(source: &Source, text: &Text, part: Span) -> Span {
    let raw = source.text.get(text.span.clone()).unwrap_or("");
    match raw.find(text.as_str()) {
        Some(at) => {
            let start = text.span.start + at;
            start + part.start..start + part.end
        }
        None => text.span.clone(),
    }
}
