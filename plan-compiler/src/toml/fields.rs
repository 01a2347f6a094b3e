//! Typed values out of a table whose keys are known.

use super::number;
use super::report::{Report, Span, Spanned, Text};
use maps::names::nearest;
use std::ops::RangeInclusive;
use toml_edit::{Item, TableLike, Value};

/// A table whose keys are known.
pub(crate) struct Fields<'t> {
    pub(crate) path: String,
    table: &'t dyn TableLike,
    /// Where the table's name is written.
    pub(crate) span: Span,
    /// Its unknown keys, which are reported.
    unknown: Vec<&'t str>,
}

impl<'t> Fields<'t> {
    /// Opens a table and reports its unknown keys.
    pub(crate) fn open(
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
        let unknown = table.iter().map(|(key, _)| key).filter(|key| !known.contains(key));
        let fields = Self { path, table, span, unknown: unknown.collect() };
        for &key in &fields.unknown {
            let (table_name, how) =
                (format!("`{}`", fields.path), format!("known here: {}", known.join(", ")));
            let span = key_span(table, key);
            report.unknown_key(&table_name, key, &span, known.iter().copied(), &how);
        }
        Some(fields)
    }

    /// Whether a key is missing, and none of the unknown ones is a misspelling of it.
    pub(crate) fn lacks(&self, key: &str) -> bool {
        let is_meant = |unknown: &&str| nearest(unknown, std::iter::once(key)).is_some();
        self.item(key).is_none() && !self.unknown.iter().any(is_meant)
    }

    /// An item and where its value is written.
    pub(crate) fn item(&self, key: &str) -> Option<(&'t Item, Span)> {
        let item = self.table.get(key).filter(|item| !item.is_none())?;
        Some((item, item.span().unwrap_or_else(|| self.key_span(key))))
    }

    /// Where a key is written; the table's name, if the table is a copy of a parametrised one.
    pub(crate) fn key_span(&self, key: &str) -> Span {
        let key = self.table.key(key).and_then(toml_edit::Key::span);
        key.unwrap_or_else(|| self.span.clone())
    }

    fn path(&self, key: &str) -> String {
        format!("{}.{key}", self.path)
    }

    /// A number in a range, in a unit.
    pub(crate) fn number(
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
                report.out_of_range(&self.path(key), &span, &expected);
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

    /// `N` finite numbers.
    pub(crate) fn numbers<const N: usize>(
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

    /// A text that is not empty.
    pub(crate) fn text(&self, report: &mut Report<'_>, key: &str, example: &str) -> Option<Text> {
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

    /// `true` or `false`.
    pub(crate) fn flag(&self, report: &mut Report<'_>, key: &str) -> Option<bool> {
        let (item, span) = self.item(key)?;
        let flag = item.as_bool();
        if flag.is_none() {
            let example = format!("{key} = true");
            report.wrong_type(&self.path(key), item, &span, "true or false", &example);
        }
        flag
    }

    /// A list of texts, or one text.
    pub(crate) fn texts(&self, report: &mut Report<'_>, key: &str, example: &str) -> Vec<Text> {
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
    pub(crate) fn word<T: Copy>(
        &self,
        report: &mut Report<'_>,
        key: &str,
        words: &[(&str, T)],
    ) -> Option<T> {
        let text = self.text(report, key, &format!("\"{}\"", words.first()?.0))?;
        let found = words.iter().find(|(word, _)| *word == text.as_str());
        if found.is_none() {
            let known = words.iter().map(|(word, _)| *word);
            report.unknown_word(&self.path(key), text.as_str(), &text.span, known);
        }
        found.map(|(_, value)| *value)
    }
}

/// Where a key is written.
pub(crate) fn key_span(table: &dyn TableLike, key: &str) -> Span {
    table.key(key).and_then(toml_edit::Key::span).unwrap_or(0..0)
}
