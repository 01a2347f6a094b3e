//! Mistakes that keep a file from being TOML.
//!
//! A parser that goes on after a mistake takes what follows for a part of the broken value, and
//! reports what is right. So each statement is read alone, and has one mistake at most.

use crate::toml::{Report, Span, key_span};
use maps::problem::{Problem, Source};
use std::sync::Arc;
use toml_edit::{Document, Item, TableLike, TomlError, Value};

/// A file with more mistakes is not TOML at all; a few are enough.
const MAX_LISTED: usize = 10;
/// What the parser reports about a key that stands twice in one table.
const DUPLICATE: &str = "duplicate key";

/// Reports the mistakes in a file; `first` is the parser's first one.
pub(super) fn report(report: &mut Report<'_>, first: &TomlError) {
    if first.message() == DUPLICATE {
        return duplicates(report, first);
    }
    let statements = statements(&report.source.text);
    let mut at = 0;
    while at < statements.len() && report.problems.len() < MAX_LISTED {
        at += match mistake(report, &statements[at..]) {
            Ok(count) => count,
            Err(problem) => {
                report.problems.push(problem);
                1
            }
        };
    }
    if report.problems.is_empty() {
        report.syntax(first);
    }
}

/// How many lines that look like statements form the first statement, or the mistake in it.
fn mistake(report: &Report<'_>, statements: &[Span]) -> Result<usize, Problem> {
    /// A value with more such lines than this is not understood anyway.
    const MAX_LINES: usize = 50;
    let text = &report.source.text;
    let Some(own) = statements.first() else { return Ok(1) };
    let part = |count: usize| {
        let end = statements.get(count - 1).map_or(text.len(), |last| last.end);
        &text[own.start..end]
    };
    let Err(error) = Document::parse(part(1)) else { return Ok(1) };
    if error.message() == DUPLICATE {
        // It is reported once the file is TOML otherwise.
        return Ok(1);
    }
    let mut counts = 2..=MAX_LINES.min(statements.len());
    if let Some(count) = counts.find(|&count| Document::parse(part(count)).is_ok()) {
        return Ok(count);
    }
    // Spaces keep every place where it is.
    let alone = " ".repeat(own.start) + part(1);
    let error = Document::parse(alone.as_str()).err().unwrap_or(error);
    let source = Arc::new(Source { name: report.source.name.clone(), text: alone });
    let mut problems = Vec::new();
    Report { source: &source, problems: &mut problems }.syntax(&error);
    let Some(mut problem) = problems.into_iter().next() else { return Ok(1) };
    if let Some(place) = &mut problem.place {
        place.source = Arc::clone(report.source);
    }
    Err(problem)
}

/// The lines that look like statements of their own, `[section]` or `key = value`, each with the
/// lines that follow it. A line of a longer value has a greater indent than the value's first line.
fn statements(text: &str) -> Vec<Span> {
    let mut starts: Vec<usize> = vec![0];
    let (mut start, mut most) = (0, usize::MAX);
    for line in text.split_inclusive('\n') {
        let indent = line.len() - line.trim_start().len();
        let is_header = line.trim_start().starts_with('[') && !line.contains(',');
        if indent <= most && (is_header || is_assignment(line)) {
            starts.push(start);
            most = if is_header { usize::MAX } else { indent };
        }
        start += line.len();
    }
    let ends = starts.iter().copied().skip(1).chain([text.len()]);
    starts.iter().zip(ends).map(|(&start, end)| start..end).collect()
}

/// Whether a line looks like `key = value`.
fn is_assignment(line: &str) -> bool {
    let key = line.split_once('=').map_or("", |(key, _)| key.trim());
    let is_of_key = |c: char| c.is_alphanumeric() || "_-.'\" (,)".contains(c);
    !key.is_empty() && key.chars().all(is_of_key)
}

/// Reports every key that stands twice in one table, with the place of the first.
fn duplicates(report: &mut Report<'_>, first: &TomlError) {
    let (text, spans) = renamed(&report.source.text, first);
    let document = Document::parse(text.as_str()).ok();
    for span in spans {
        let source = &report.source.text;
        let name = source[span.clone()].trim_matches(['"', '\'']);
        let table = document.as_ref().and_then(|file| table_with(file.as_table(), &span));
        let first = table.map(|table| key_span(table, name)).filter(|first| !first.is_empty());
        let label = first.map_or("again".into(), |first| {
            let line = source[..first.start].split('\n').count();
            format!("the first one is in line {line}")
        });
        let help = match is_header(source, &span) {
            true => "rename or remove one of the two, or put its lines below the first one",
            false => "rename or remove one of the two",
        };
        report.error(format!("`{name}` is there twice"), &span, &label, help);
    }
}

/// The text with another name, of the same length, for each key that is there twice, and where
/// these keys are. The parser reports only the first one.
fn renamed(text: &str, first: &TomlError) -> (String, Vec<Span>) {
    let (mut text, mut spans) = (text.to_owned(), Vec::new());
    let mut next = first.span();
    while let Some(span) =
        next.take().filter(|span| !text.get(span.clone()).is_none_or(str::is_empty))
    {
        let other = |letter: char| {
            let mut other = text.clone();
            other.replace_range(span.clone(), &letter.to_string().repeat(span.len()));
            let error = Document::parse(other.as_str()).err();
            let is_free = error.as_ref().and_then(TomlError::span).as_ref() != Some(&span);
            is_free.then_some((other, error))
        };
        let found = ('a'..='z').rev().find_map(other);
        spans.push(span);
        let Some((other, error)) = found.filter(|_| spans.len() < MAX_LISTED) else { break };
        text = other;
        next = error.filter(|error| error.message() == DUPLICATE).and_then(|error| error.span());
    }
    (text, spans)
}

/// Whether a key is in the header of a section.
fn is_header(text: &str, key: &Span) -> bool {
    let line = text[..key.start].rsplit('\n').next().unwrap_or("");
    line.trim_start().starts_with('[')
}

/// The table that has a key at a place.
fn table_with<'t>(table: &'t dyn TableLike, span: &Span) -> Option<&'t dyn TableLike> {
    if table.iter().any(|(key, _)| key_span(table, key) == *span) {
        return Some(table);
    }
    table.iter().find_map(|(_, item)| match item {
        Item::ArrayOfTables(tables) => tables.iter().find_map(|table| table_with(table, span)),
        Item::Value(Value::Array(array)) => {
            let tables = array.iter().filter_map(Value::as_inline_table);
            tables.into_iter().find_map(|table| table_with(table, span))
        }
        item => item.as_table_like().and_then(|table| table_with(table, span)),
    })
}

#[cfg(test)]
mod tests {
    use crate::mission::parse;
    use maps::problem::Source;
    use std::sync::Arc;

    /// The mistakes in a text: line, message and label.
    fn mistakes(text: &str) -> Vec<String> {
        let source = Arc::new(Source { name: "m".into(), text: text.into() });
        let line = |start: usize| text[..start].matches('\n').count() + 1;
        let problems = parse(&source).1;
        let shown = problems.iter().map(|problem| {
            let place = problem.place.as_ref().expect("a place");
            format!("{} {}: {}", line(place.span.start), problem.message, place.label)
        });
        shown.collect()
    }

    #[test]
    fn a_missing_bracket_is_one_mistake() {
        for text in [
            "[facts]\na = { near = [1, 2, within = 1 }\nb = { near = [1, 2], within = 1 }\nc = true\n",
            "[facts]\na = [1, 2\n'b c' = [1]\n[actions]\nd = { do = 'hold 1 s' }\n",
            "[facts]\na = {{ near = [1, 2] }\n",
            "[facts\na = true\n",
        ] {
            assert_eq!(mistakes(text).len(), 1, "{text}\n{:?}", mistakes(text));
        }
    }

    #[test]
    fn each_broken_statement_is_a_mistake() {
        let all =
            mistakes("[facts]\na = [1, 2\nb = true\nc = \n[actions]\nd = { do = 'x' }\ne e = 1\n");
        let lines: Vec<&str> = all.iter().map(|one| &one[..1]).collect();
        assert_eq!(lines, ["2", "4", "7"], "{all:?}");
        let text = "[frames]\n  a = 1 2\n  b = [\n    { c = 1,\n      d = 2 },\n  ]\n  e = [\n    { f,\n      g = 1 },\n  ]\n  h = \n";
        let all = mistakes(text);
        let lines: Vec<&str> = all.iter().map(|one| one.split(' ').next().unwrap()).collect();
        assert_eq!(lines, ["2", "8", "11"], "{all:?}");
    }

    #[test]
    fn a_key_that_is_there_twice_is_shown_with_the_first_one() {
        let text = "[actions]\na = 1\nb = 2\na = 3\n'go on' = 1\n\"go on\" = 2\n\
                    [frames.rest]\n[frames.rest]\nc = { d = 1, d = 2 }\n";
        let expected = [
            "4 `a` is there twice: the first one is in line 2",
            "6 `go on` is there twice: the first one is in line 5",
            "8 `rest` is there twice: the first one is in line 7",
            "9 `d` is there twice: the first one is in line 9",
        ];
        assert_eq!(mistakes(text), expected);
    }
}
