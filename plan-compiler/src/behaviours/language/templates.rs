//! Parametrised definitions: `"drive to(x, y)" = { do = "go-to {x}, {y}" }` defines an action for
//! each pair of values with which it is named elsewhere, such as `drive to(10, 12)` in a graph.
//!
//! A definition with parameters is copied for each use, with the values in the place of `{x}` and
//! `{y}`. The compiled mission has ordinary components only (H: "parametrised operators").

use super::TABLES;
use crate::behaviours::syntax::Syntax;
use crate::toml::{Report, Span, Text, key_span, part_of};
use maps::problem::Problem;
use std::borrow::Cow;
use std::ops::Range;
use toml_edit::{Array, InlineTable, Item, Table, TableLike, Value};

/// Most copies in one mission; more than the robot has room for.
const MAX_COPIES: usize = 500;

/// One definition: its name as written, where, and its contents.
pub(super) struct Entry<'t> {
    pub(super) raw: String,
    pub(super) span: Span,
    pub(super) item: Cow<'t, Item>,
    /// Where the values are written, if this is a copy.
    pub(super) values: Option<Span>,
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
/// Names that could not be filled in go to `syntax.broken`.
pub(super) fn expand<'t>(
    report: &mut Report<'_>,
    file: &'t dyn TableLike,
    syntax: &mut Syntax,
) -> Entries<'t> {
    let (mut entries, mut templates) = definitions(report, file, syntax);
    undefined_parameters(report, &mut entries, &mut templates, syntax);
    let mut uses = Vec::new();
    for entry in entries.iter().flatten() {
        find_uses(report, &entry.item, &entry.span, &templates, &mut uses);
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
            let noun = if expected == 1 { "parameter" } else { "parameters" };
            let message = format!("`{}` has {expected} {noun}, not {given}", template.name);
            let help = format!("write {}({})", template.name, template.parameters.join(", "));
            if !syntax.broken.contains(&raw) {
                report.error(message, &use_.span, "used here", &help);
                syntax.broken.push(raw);
            }
            continue;
        }
        copies += 1;
        if copies > MAX_COPIES {
            let message = format!("`{}` is used with more values than fit", template.name);
            let help = "let its values not depend on themselves";
            report.error(message, &template.span, "this definition", help);
            // The copies are of no use, and each would have mistakes of its own.
            for entries in &mut entries {
                entries.retain(|entry| entry.values.is_none());
            }
            let names = templates.iter().map(|template| template.name.to_owned());
            syntax.broken_templates.extend(names);
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
        find_uses(report, &item, &use_.span, &templates, &mut uses);
        let values = Some(use_.span);
        entries[table].push(Entry { raw, span, item: Cow::Owned(item), values });
    }
    for template in templates.iter().filter(|template| !template.is_used) {
        let message = format!("`{}` is never used", template.name);
        let help = "name it with its values in a graph or a condition, or remove it";
        let unused = Problem::warning(message).help(help);
        syntax.unused.push(unused.at(report.source, template.span.clone(), "defined here"));
    }
    entries
}

/// The definitions without parameters, and those with parameters.
fn definitions<'t>(
    report: &mut Report<'_>,
    file: &'t dyn TableLike,
    syntax: &mut Syntax,
) -> (Entries<'t>, Vec<Template<'t>>) {
    let (mut entries, mut templates): (Entries<'t>, Vec<Template<'t>>) = Default::default();
    for (table, name) in TABLES.iter().enumerate() {
        let Some(definitions) = file.get(name).and_then(Item::as_table_like) else { continue };
        for (raw, item) in definitions.iter() {
            let span = key_span(definitions, raw);
            let Some((name, parameters)) = parametrised(raw, item) else {
                let (raw, item) = (raw.to_owned(), Cow::Borrowed(item));
                entries[table].push(Entry { raw, span, item, values: None });
                continue;
            };
            if let Some(twice) = twice(&parameters) {
                let message = format!("`{raw}` has two parameters `{twice}`");
                report.error(message, &span, "this name", "give each parameter its own name");
                syntax.broken_templates.push(name.to_owned());
                continue;
            }
            let is_used = false;
            templates.push(Template { table, name, parameters, span, item, is_used });
        }
    }
    (entries, templates)
}

/// The first name that stands twice in a list.
fn twice<'n>(names: &[&'n str]) -> Option<&'n str> {
    let again = |&(index, name): &(usize, &&str)| names[..index].contains(name);
    names.iter().enumerate().find(again).map(|(_, name)| *name)
}

/// Reports `{z}` in a definition that has no parameter `z`, and takes the definition out: its texts
/// mean nothing.
fn undefined_parameters(
    report: &mut Report<'_>,
    entries: &mut Entries<'_>,
    templates: &mut Vec<Template<'_>>,
    syntax: &mut Syntax,
) {
    let names: Vec<String> = entries.iter().flatten().map(|entry| entry.raw.clone()).collect();
    for entries in entries {
        entries.retain(|entry| {
            let name = entry.raw.trim();
            let how = |parameter: &str| {
                format!("write a value instead, or define it as \"{name}({parameter})\"")
            };
            // Names may contain braces.
            let is_name = |brace: &str| names.iter().any(|name| name.contains(brace));
            let is_right = has_no_other(report, &entry.item, &entry.span, name, &how, &is_name);
            if !is_right {
                syntax.broken.push(name.to_owned());
            }
            is_right
        });
    }
    templates.retain(|template| {
        let written = format!("{}({})", template.name, template.parameters.join(", "));
        let how = |_: &str| {
            let all: Vec<String> = template.parameters.iter().map(|p| format!("{{{p}}}")).collect();
            format!("write {}, or add it to the name", all.join(" or "))
        };
        let known = |brace: &str| {
            template.parameters.contains(&&brace[1..brace.len() - 1])
                || names.iter().any(|name| name.contains(brace))
        };
        let is_right = has_no_other(report, template.item, &template.span, &written, &how, &known);
        if !is_right {
            syntax.broken_templates.push(template.name.to_owned());
        }
        is_right
    });
}

/// Whether the texts of a definition have known parameters only; reports each other one once.
fn has_no_other(
    report: &mut Report<'_>,
    item: &Item,
    at: &Span,
    name: &str,
    how: &dyn Fn(&str) -> String,
    is_known: &dyn Fn(&str) -> bool,
) -> bool {
    let mut reported: Vec<String> = Vec::new();
    each_text(item, &mut |text, span| {
        for range in braces(text) {
            let brace = &text[range.clone()];
            if is_known(brace) || reported.iter().any(|known| known == brace) {
                continue;
            }
            let place = place(report, text, span.clone(), range.clone(), at);
            let message = format!("`{brace}` is not a parameter of `{name}`");
            let help = how(&brace[1..brace.len() - 1]);
            report.error(message, &place, "unknown parameter", &help);
            reported.push(brace.to_owned());
        }
    });
    reported.is_empty()
}

/// Every `{name}` in a text.
fn braces(text: &str) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    for (open, _) in text.match_indices('{') {
        let inside = text[open + 1..].split('}').next().unwrap_or("");
        let end = open + inside.len() + 2;
        let is_name = |character: char| is_of_name(character) || matches!(character, ' ' | '-');
        if end <= text.len() && !inside.is_empty() && inside.chars().all(is_name) {
            found.push(open..end);
        }
    }
    found
}

/// Where a part of a text is written; `at` if the text is of a copy.
fn place(
    report: &Report<'_>,
    text: &str,
    span: Option<Span>,
    part: Range<usize>,
    at: &Span,
) -> Span {
    let Some(span) = span else { return at.clone() };
    part_of(report.source, &Text { value: text.to_owned(), span }, part)
}

/// The name and the parameters of `NAME(x, y)`, if the definition uses one of them.
fn parametrised<'t>(raw: &'t str, item: &Item) -> Option<(&'t str, Vec<&'t str>)> {
    let (name, rest) = raw.trim().split_once('(')?;
    let inside = rest.strip_suffix(')')?;
    let parameters: Vec<&str> = inside.split(',').map(str::trim).collect();
    let mut is_used = false;
    each_text(item, &mut |text, _| {
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
fn find_uses(
    report: &Report<'_>,
    item: &Item,
    at: &Span,
    templates: &[Template<'_>],
    uses: &mut Vec<Use>,
) {
    each_text(item, &mut |text, span| {
        for (index, template) in templates.iter().enumerate() {
            for (start, _) in text.match_indices(template.name) {
                let before = &text[..start];
                let is_part = before.trim_end().ends_with(is_of_name) && !is_keyword_before(before);
                let end = start + template.name.len();
                let inside = text[end..].strip_prefix('(').and_then(|rest| rest.split_once(')'));
                let Some((values, _)) = inside.filter(|_| !is_part) else { continue };
                let part = start..end + values.len() + 2;
                let span = place(report, text, span.clone(), part, at);
                let values = values.split(',').map(|value| value.trim().to_owned()).collect();
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

/// Calls `with` for every text and every key of a definition, and where it is written; copies are
/// written nowhere.
fn each_text(item: &Item, with: &mut dyn FnMut(&str, Option<Span>)) {
    match item {
        Item::Value(value) => each_text_of(value, with),
        Item::Table(table) => each_text_of_table(table, with),
        Item::ArrayOfTables(tables) => {
            tables.iter().for_each(|table| each_text_of_table(table, with));
        }
        Item::None => {}
    }
}

fn each_text_of_table(table: &Table, with: &mut dyn FnMut(&str, Option<Span>)) {
    for (key, item) in table.iter() {
        with(key, table.key(key).and_then(toml_edit::Key::span));
        each_text(item, with);
    }
}

fn each_text_of(value: &Value, with: &mut dyn FnMut(&str, Option<Span>)) {
    match value {
        Value::String(text) => with(text.value(), text.span()),
        Value::Array(array) => array.iter().for_each(|value| each_text_of(value, with)),
        Value::InlineTable(table) => {
            for (key, value) in table.iter() {
                with(key, table.key(key).and_then(toml_edit::Key::span));
                each_text_of(value, with);
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
