//! Reads the values of a world file by their keys: numbers, points, names, tables.

use crate::Point;
use maps::names::nearest;
use maps::problem::{Problem, Source};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use toml_edit::{Item, TableLike, Value};

/// Largest coordinate of a point, metres.
pub(super) const FARTHEST_M: f64 = 1e6;

/// Reads a file and gathers its mistakes.
pub(super) struct Reader<'s> {
    pub(super) source: &'s Arc<Source>,
    pub(super) problems: Vec<Problem>,
}

/// One table of the file, with its path for messages and the span of its name.
#[derive(Clone, Copy)]
pub(super) struct Section<'t> {
    pub(super) table: &'t dyn TableLike,
    pub(super) path: &'t str,
    pub(super) at: &'t Range<usize>,
}

impl Section<'_> {
    pub(super) fn key(&self, key: &str) -> String {
        if self.path.is_empty() { format!("`{key}`") } else { format!("`{}.{key}`", self.path) }
    }

    /// The value of a key, and its span.
    pub(super) fn get(&self, key: &str) -> Option<(&Item, Range<usize>)> {
        let item = self.table.get(key)?;
        Some((item, item.span().unwrap_or_else(|| self.at.clone())))
    }
}

impl Reader<'_> {
    pub(super) fn error(
        &mut self,
        message: impl Into<String>,
        at: Range<usize>,
        label: &str,
        help: &str,
    ) {
        self.problems.push(Problem::error(message).at(self.source, at, label).help(help));
    }

    /// Every table below a table, by its name.
    pub(super) fn all<T>(
        &mut self,
        top: &Section<'_>,
        key: &str,
        mut read: impl FnMut(&mut Self, &Section<'_>) -> Option<T>,
    ) -> BTreeMap<String, T> {
        let mut found = BTreeMap::new();
        let Some((item, at)) = top.get(key) else { return found };
        let Some(tables) = item.as_table_like() else {
            let help = format!("write [{key}.NAME] and its keys below it");
            self.error(format!("`{key}` must be tables"), at, "not a table", &help);
            return found;
        };
        for (name, item) in tables.iter() {
            let at = tables.key(name).and_then(toml_edit::Key::span).unwrap_or_else(|| at.clone());
            let path = format!("{key}.{name}");
            match item.as_table_like() {
                Some(table) => {
                    let section = Section { table, path: &path, at: &at };
                    found.extend(read(self, &section).map(|value| (name.to_owned(), value)));
                }
                None => {
                    let help = format!("write [{path}] and its keys below it");
                    self.error(format!("`{path}` must be a table"), at, "not a table", &help);
                }
            }
        }
        found
    }

    pub(super) fn unknown_keys(&mut self, section: &Section<'_>, known: &[&str]) {
        for (key, _) in section.table.iter().filter(|(key, _)| !known.contains(key)) {
            let help = match nearest(key, known.iter().copied()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("the keys here are {}", known.join(", ")),
            };
            let at = section.table.key(key).and_then(toml_edit::Key::span);
            let at = at.unwrap_or_else(|| section.at.clone());
            let message = format!("{} is not a key of a world", section.key(key));
            self.error(message, at, "unknown key", &help);
        }
    }

    pub(super) fn missing(&mut self, section: &Section<'_>, key: &str, help: &str) {
        let message = format!("{} is missing", section.key(key));
        self.error(message, section.at.clone(), "here", help);
    }

    pub(super) fn needed_number(
        &mut self,
        section: &Section<'_>,
        key: &str,
        range: (f64, f64),
        example: &str,
    ) -> Option<f64> {
        if section.get(key).is_none() {
            self.missing(section, key, &format!("write {key} = {example}"));
        }
        self.number(section, key, range, example)
    }

    pub(super) fn number(
        &mut self,
        section: &Section<'_>,
        key: &str,
        (low, high): (f64, f64),
        example: &str,
    ) -> Option<f64> {
        let (item, at) = section.get(key)?;
        let number = item.as_value().and_then(number_of);
        let number = number.filter(|number| (low..=high).contains(number));
        if number.is_none() {
            let message = format!("{} must be a number from {low} to {high}", section.key(key));
            let help = format!("write {key} = {example}");
            self.error(message, at, "not a number in this range", &help);
        }
        number
    }

    /// The tables of a list, such as all `[[discs]]`; an empty list if there are none.
    pub(super) fn list<T>(
        &mut self,
        top: &Section<'_>,
        key: &str,
        mut read: impl FnMut(&mut Self, &Section<'_>) -> Option<T>,
    ) -> Vec<T> {
        let Some((item, at)) = top.get(key) else { return Vec::new() };
        let inline = item.as_array().map(|array| array.iter().map(Value::as_inline_table));
        let tables: Option<Vec<&dyn TableLike>> = match (item.as_array_of_tables(), inline) {
            (Some(tables), _) => Some(tables.iter().map(|table| table as &dyn TableLike).collect()),
            (None, Some(inline)) => {
                inline.map(|table| table.map(|t| t as &dyn TableLike)).collect()
            }
            (None, None) => None,
        };
        let Some(tables) = tables else {
            let help = format!("write [[{key}]] and the keys of one below it, once for each");
            self.error(format!("`{key}` must be a list of tables"), at, "not a list", &help);
            return Vec::new();
        };
        let spans: Vec<Option<Range<usize>>> = match (item.as_array_of_tables(), item.as_array()) {
            (Some(tables), _) => tables.iter().map(|table| table.span()).collect(),
            (None, Some(array)) => array.iter().map(Value::span).collect(),
            (None, None) => Vec::new(),
        };
        let mut found = Vec::new();
        for (index, table) in tables.into_iter().enumerate() {
            let at = spans.get(index).cloned().flatten().unwrap_or_else(|| at.clone());
            let path = format!("{key}[{index}]");
            found.extend(read(self, &Section { table, path: &path, at: &at }));
        }
        found
    }

    /// Reads one table, such as `[gps]`, if it is there.
    pub(super) fn table<T>(
        &mut self,
        top: &Section<'_>,
        key: &str,
        read: impl FnOnce(&mut Self, &Section<'_>) -> T,
    ) -> Option<T> {
        let (item, at) = top.get(key)?;
        let Some(table) = item.as_table_like() else {
            let help = format!("write [{key}] and its keys below it");
            self.error(format!("`{key}` must be a table"), at, "not a table", &help);
            return None;
        };
        Some(read(self, &Section { table, path: key, at: &at }))
    }

    /// One of several words.
    pub(super) fn word<T: Copy>(
        &mut self,
        section: &Section<'_>,
        key: &str,
        words: &[(&str, T)],
    ) -> Option<T> {
        let (item, at) = section.get(key)?;
        let found = words.iter().find(|(word, _)| item.as_str() == Some(word));
        if found.is_none() {
            let known = || words.iter().map(|&(word, _)| word);
            let meant = item.as_str().and_then(|word| nearest(word, known()));
            let help = match meant {
                Some(meant) => format!("did you mean \"{meant}\"?"),
                None => format!("write one of \"{}\"", known().collect::<Vec<_>>().join("\", \"")),
            };
            self.error(format!("{} is not known", section.key(key)), at, "unknown word", &help);
        }
        found.map(|&(_, value)| value)
    }

    /// A list of at least `least` points.
    pub(super) fn points(
        &mut self,
        section: &Section<'_>,
        key: &str,
        least: usize,
    ) -> Option<Vec<Point>> {
        let (item, at) = section.get(key)?;
        let points = item.as_array().and_then(|list| list.iter().map(point_of).collect());
        let points = points.filter(|points: &Vec<Point>| points.len() >= least);
        if points.is_none() {
            let message = format!("{} must be a list of {least} or more points", section.key(key));
            let help = format!(
                "write {key} = [[0, 0], [5, 0]{}]",
                [", [5, 5]", ""][usize::from(least < 3)]
            );
            self.error(message, at, "not such a list", &help);
        }
        points
    }

    /// A point, if the key is there.
    pub(super) fn point(&mut self, section: &Section<'_>, key: &str) -> Option<Point> {
        section.get(key)?;
        self.needed_point(section, key)
    }

    pub(super) fn whole(
        &mut self,
        section: &Section<'_>,
        key: &str,
        low: i64,
        high: i64,
    ) -> Option<i64> {
        let (item, at) = section.get(key)?;
        let number = item.as_integer().filter(|number| (low..=high).contains(number));
        if number.is_none() {
            let name = section.key(key);
            let message = format!("{name} must be a whole number from {low} to {high}");
            let help = format!("write {key} = {}", low.max(1));
            self.error(message, at, "not a whole number in this range", &help);
        }
        number
    }

    pub(super) fn needed_point(&mut self, section: &Section<'_>, key: &str) -> Option<Point> {
        let help = format!("write {key} = [X, Y] in the map's metres, x east, y north");
        let Some((item, at)) = section.get(key) else {
            self.missing(section, key, &help);
            return None;
        };
        let point = item.as_value().and_then(point_of);
        if point.is_none() {
            self.error(format!("{} must be a point", section.key(key)), at, "not a point", &help);
        }
        point
    }
}

pub(super) fn number_of(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|integer| integer as f64))
}

pub(super) fn point_of(value: &Value) -> Option<Point> {
    let pair = value.as_array().filter(|pair| pair.len() == 2)?;
    let number = |index| {
        pair.get(index).and_then(number_of).filter(|number: &f64| number.abs() <= FARTHEST_M)
    };
    Some([number(0)?, number(1)?])
}
