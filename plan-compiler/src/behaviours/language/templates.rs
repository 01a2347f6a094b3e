//! Parametrised definitions: `"drive to(x, y)" = { do = "go-to {x}, {y}" }` defines an action for
//! each pair of values with which it is named elsewhere, such as `drive to(10, 12)` in a graph.
//!
//! A definition with parameters is copied for each use, with the values in the place of `{x}` and
//! `{y}`. The compiled mission has ordinary components only (H: "parametrised operators").

use super::TABLES;
use crate::toml::{Report, Span, key_span};
use std::borrow::Cow;
use toml_edit::{Array, InlineTable, Item, Table, TableLike, Value};

/// Most copies in one mission; more than the robot has room for.
const MAX_COPIES: usize = 500;

/// One definition: its name as written, where, and its contents.
pub(super) struct Entry<'t> {
    pub(super) raw: String,
    pub(super) span: Span,
    pub(super) item: Cow<'t, Item>,
}

/// The definitions of all tables, in the order of [`TABLES`].
pub(super) type Entries<'t> = [Vec<Entry<'t>>; TABLES.len()];

/// A definition with parameters.
struct Template<'t> {
    /// Index in [`TABLES`].
    table: usize,
    name: &'t str,
    parameters: Vec<&'t str>,
    span: Span,
    item: &'t Item,
    is_used: bool,
}

/// All definitions of a file, with a copy of each parametrised one for every use.
/// Names that could not be filled in go to `broken`.
pub(super) fn expand<'t>(
    report: &mut Report<'_>,
    file: &'t dyn TableLike,
    broken: &mut Vec<String>,
) -> Entries<'t> {
    let mut entries: Entries<'t> = Default::default();
    let mut templates: Vec<Template<'t>> = Vec::new();
    for (table, name) in TABLES.iter().enumerate() {
        let Some(definitions) = file.get(name).and_then(Item::as_table_like) else { continue };
        for (raw, item) in definitions.iter() {
            let span = key_span(definitions, raw);
            match parametrised(raw, item) {
                Some((name, parameters)) => {
                    let is_used = false;
                    templates.push(Template { table, name, parameters, span, item, is_used });
                }
                None => {
                    let (raw, item) = (raw.to_owned(), Cow::Borrowed(item));
                    entries[table].push(Entry { raw, span, item });
                }
            }
        }
    }
    let mut uses = Vec::new();
    for entry in entries.iter().flatten() {
        find_uses(&entry.item, &entry.span, &templates, &mut uses);
    }
    let mut copies = 0;
    while let Some(use_) = uses.pop() {
        let template = &mut templates[use_.template];
        template.is_used = true;
        let raw = format!("{}({})", template.name, use_.values.join(", "));
        if entries[template.table].iter().any(|entry| entry.raw == raw) {
            continue;
        }
        if use_.values.len() != template.parameters.len() {
            let (expected, given) = (template.parameters.len(), use_.values.len());
            let message = format!("`{}` has {expected} parameters, not {given}", template.name);
            let help = format!("write {}({})", template.name, template.parameters.join(", "));
            if !broken.contains(&raw) {
                report.error(message, &use_.span, "used here", &help);
                broken.push(raw);
            }
            continue;
        }
        copies += 1;
        if copies > MAX_COPIES {
            let message = format!("`{}` is used with more values than fit", template.name);
            let help = "let its values not depend on themselves";
            report.error(message, &template.span, "this definition", help);
            break;
        }
        let pairs: Vec<(String, &str)> = template
            .parameters
            .iter()
            .zip(&use_.values)
            .map(|(parameter, value)| (format!("{{{parameter}}}"), value.as_str()))
            .collect();
        let (table, span) = (template.table, template.span.clone());
        let item = filled(template.item, &pairs);
        find_uses(&item, &span, &templates, &mut uses);
        entries[table].push(Entry { raw, span, item: Cow::Owned(item) });
    }
    for template in templates.iter().filter(|template| !template.is_used) {
        let message = format!("`{}` is never used", template.name);
        let help = "name it with its values in a graph or a condition, or remove it";
        report.warning(message, &template.span, "defined here", help);
    }
    entries
}

/// The name and the parameters of `NAME(x, y)`, if the definition uses one of them.
fn parametrised<'t>(raw: &'t str, item: &Item) -> Option<(&'t str, Vec<&'t str>)> {
    let (name, rest) = raw.trim().split_once('(')?;
    let inside = rest.strip_suffix(')')?;
    let parameters: Vec<&str> = inside.split(',').map(str::trim).collect();
    let mut is_used = false;
    each_text(item, None, &mut |text, _| {
        is_used |= parameters.iter().any(|parameter| text.contains(&format!("{{{parameter}}}")));
    });
    (is_used && !name.trim().is_empty()).then(|| (name.trim(), parameters))
}

/// A use of a template.
struct Use {
    template: usize,
    values: Vec<String>,
    span: Span,
}

/// Finds `NAME(VALUES)` in every text of a definition.
fn find_uses(item: &Item, at: &Span, templates: &[Template<'_>], uses: &mut Vec<Use>) {
    each_text(item, Some(at), &mut |text, span| {
        for (index, template) in templates.iter().enumerate() {
            for (at, _) in text.match_indices(template.name) {
                let is_part =
                    text[..at].trim_end().ends_with(is_of_name) && !is_keyword_before(&text[..at]);
                let rest = &text[at + template.name.len()..];
                let inside = rest.strip_prefix('(').and_then(|rest| rest.split_once(')'));
                let Some((values, _)) = inside.filter(|_| !is_part) else { continue };
                let values = values.split(',').map(|value| value.trim().to_owned()).collect();
                let span = span.cloned().unwrap_or(0..0);
                uses.push(Use { template: index, values, span });
            }
        }
    });
}

fn is_of_name(character: char) -> bool {
    character.is_alphanumeric() || matches!(character, '_' | '.' | '/' | '+')
}

/// Whether a text ends with a word after which a name begins: `not`, `and`, `from` or `to`.
fn is_keyword_before(text: &str) -> bool {
    matches!(text.split_whitespace().last(), Some("not" | "and" | "from" | "to"))
}

/// Calls `with` for every text and every key of a definition.
fn each_text<'s>(item: &Item, at: Option<&'s Span>, with: &mut dyn FnMut(&str, Option<&'s Span>)) {
    match item {
        Item::Value(value) => each_text_of(value, at, with),
        Item::Table(table) => {
            for (key, item) in table.iter() {
                with(key, at);
                each_text(item, at, with);
            }
        }
        Item::ArrayOfTables(tables) => {
            for (key, item) in tables.iter().flat_map(|table| table.iter()) {
                with(key, at);
                each_text(item, at, with);
            }
        }
        Item::None => {}
    }
}

fn each_text_of<'s>(
    value: &Value,
    at: Option<&'s Span>,
    with: &mut dyn FnMut(&str, Option<&'s Span>),
) {
    match value {
        Value::String(text) => with(text.value(), at),
        Value::Array(array) => array.iter().for_each(|value| each_text_of(value, at, with)),
        Value::InlineTable(table) => {
            for (key, value) in table.iter() {
                with(key, at);
                each_text_of(value, at, with);
            }
        }
        _ => {}
    }
}

/// A copy of a definition with values in the place of parameters.
fn filled(item: &Item, pairs: &[(String, &str)]) -> Item {
    match item {
        Item::Value(value) => Item::Value(filled_value(value, pairs)),
        Item::Table(table) => Item::Table(filled_table(table, pairs)),
        Item::ArrayOfTables(tables) => {
            Item::ArrayOfTables(tables.iter().map(|table| filled_table(table, pairs)).collect())
        }
        Item::None => Item::None,
    }
}

fn filled_table(table: &Table, pairs: &[(String, &str)]) -> Table {
    table.iter().map(|(key, item)| (filled_text(key, pairs), filled(item, pairs))).collect()
}

fn filled_value(value: &Value, pairs: &[(String, &str)]) -> Value {
    match value {
        Value::String(text) => {
            // A text that is a parameter and nothing else becomes a number, if its value is one.
            let whole = pairs.iter().find(|(parameter, _)| text.value() == parameter);
            let number = whole.and_then(|(_, value)| value.parse::<f64>().ok());
            match number {
                Some(number) => Value::from(number),
                None if text.value().contains('{') => Value::from(filled_text(text.value(), pairs)),
                None => value.clone(),
            }
        }
        Value::Array(array) => {
            let values = array.iter().map(|value| filled_value(value, pairs));
            Value::Array(values.collect::<Array>())
        }
        Value::InlineTable(table) => {
            let pairs_of = table
                .iter()
                .map(|(key, value)| (filled_text(key, pairs), filled_value(value, pairs)));
            Value::InlineTable(pairs_of.collect::<InlineTable>())
        }
        _ => value.clone(),
    }
}

fn filled_text(text: &str, pairs: &[(String, &str)]) -> String {
    pairs.iter().fold(text.to_owned(), |text, (parameter, value)| text.replace(parameter, value))
}
