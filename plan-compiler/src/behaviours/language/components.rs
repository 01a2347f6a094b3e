//! Actions, frames and productions.

use super::doing::doing;
use super::{MAX_TIME_S, literals, name, rules, tidy};
use crate::behaviours::graph_text;
use crate::behaviours::syntax::{Action, Description, Doing, PlanFrame, Production};
use crate::behaviours::{DEFAULT_THRESHOLD, DEFAULT_TIMEOUT_S};
use crate::toml::{Fields, Report, Spanned, Text, key_span, part_of};
use toml_edit::{Item, Value};

const ACTION: &[&str] = &[
    "do",
    "initial",
    "transient",
    "goal",
    "add",
    "delete",
    "until",
    "timeout_s",
    "max_speed",
    "min_distance",
    "resources",
];

/// Shortest timeout of an action, seconds.
const MIN_TIMEOUT_S: f64 = 0.1;
/// Lowest maximum speed, m/s: with 0, what drives would never arrive.
const LOWEST_MAX_SPEED_MPS: f64 = 0.01;

pub(super) fn action(report: &mut Report<'_>, name: Text, item: &Item) -> Option<Action> {
    let path = format!("actions.{}", name.as_str());
    let example = "{ do = \"go-to 10, 20\" }";
    let fields = Fields::open(report, path, item, name.span.clone(), ACTION, example)?;
    let description = description(report, &fields);
    let until = literals(report, &fields, "until");
    let resources = fields.texts(report, "resources", "arm");
    if fields.lacks("do") {
        let message = format!("action `{}` does nothing", name.as_str());
        report.error(message, &name.span, "this action", &format!("add {}", &example[2..21]));
    }
    // After a mistake another action stands in, so that the names in the rest are looked up.
    let text = fields.text(report, "do", "\"go-to 10, 20\"");
    let path = format!("{}.do", fields.path);
    let kind = text.and_then(|text| doing(report, &path, &text));
    let kind = kind.unwrap_or(Doing::Signal { code: 0 });
    let own_ms = match kind {
        Doing::Hold { for_ms }
        | Doing::Wait { for_ms }
        | Doing::Wander { for_ms }
        | Doing::MoveAhead { for_ms, .. } => for_ms,
        _ => 0,
    };
    let given = fields.number(report, "timeout_s", MIN_TIMEOUT_S..=MAX_TIME_S, "s");
    let given_ms = given.as_ref().map(|given| (given.value * 1e3).round() as u32);
    if let Some(given) = given.filter(|_| given_ms.is_some_and(|given_ms| given_ms <= own_ms)) {
        let message = format!("action `{}` times out before it can end", name.as_str());
        let help = format!("write a timeout_s above {} s", f64::from(own_ms) / 1e3);
        report.error(message, &given.span, "not above the action's own time", &help);
    }
    let timeout_ms = given_ms.unwrap_or((DEFAULT_TIMEOUT_S * 1e3) as u32 + own_ms);
    Some(Action { name, kind, description, until, timeout_ms, resources })
}

fn description(report: &mut Report<'_>, fields: &Fields<'_>) -> Description {
    let max_speed = fields.number(report, "max_speed", LOWEST_MAX_SPEED_MPS..=50.0, "m/s");
    let min_distance = fields.number(report, "min_distance", 0.0..=1e3, "m");
    Description {
        initial: literals(report, fields, "initial"),
        transient: literals(report, fields, "transient"),
        goal: literals(report, fields, "goal"),
        add: facts(report, fields, "add"),
        delete: facts(report, fields, "delete"),
        max_speed_mps: max_speed.map(|speed| speed.value as f32),
        min_distance_m: min_distance.map_or(0.0, |distance| distance.value as f32),
    }
}

/// The names of facts.
fn facts(report: &mut Report<'_>, fields: &Fields<'_>, key: &str) -> Vec<Text> {
    let names = fields.texts(report, key, "ploughed").into_iter();
    names.map(|text| Spanned { value: tidy(text.as_str()).into_owned(), span: text.span }).collect()
}

const FRAME: &[&str] = &[
    "productions",
    "threshold",
    "until",
    "timeout_s",
    "initial",
    "transient",
    "goal",
    "add",
    "delete",
    "max_speed",
    "min_distance",
];
const FRAME_EXAMPLE: &str = "productions = [\"entry -> a -> b -> exit\"]";

pub(super) fn frame(report: &mut Report<'_>, name: Text, item: &Item) -> Option<PlanFrame> {
    let path = format!("frames.{}", name.as_str());
    let example = format!("{{ {FRAME_EXAMPLE} }}");
    let fields = Fields::open(report, path, item, name.span.clone(), FRAME, &example)?;
    let description = description(report, &fields);
    let given = fields.number(report, "threshold", 0.0..=1.0, "");
    let threshold = Spanned {
        span: given.as_ref().map_or(name.span.clone(), |given| given.span.clone()),
        value: given.map_or(DEFAULT_THRESHOLD, |given| given.value as f32),
    };
    let until = literals(report, &fields, "until");
    let timeout = fields.number(report, "timeout_s", MIN_TIMEOUT_S..=MAX_TIME_S, "s");
    let timeout_ms = timeout.map_or(0, |timeout| (timeout.value * 1e3).round() as u32);
    let found = fields.item("productions").map(|(item, _)| items(item)).unwrap_or_default();
    // What was not understood is missing here; after an error nothing else is judged by it.
    let productions = found.iter().enumerate();
    let productions =
        productions.filter_map(|(number, item)| production(report, &name, number, item)).collect();
    if found.is_empty() && (fields.lacks("productions") || fields.item("productions").is_some()) {
        let message = format!("frame `{}` has no production", name.as_str());
        report.error(
            message,
            &name.span,
            "it cannot be carried out",
            &format!("add {FRAME_EXAMPLE}"),
        );
    }
    Some(PlanFrame { name, description, threshold, until, timeout_ms, productions })
}

/// The entries of a list in any of the forms of TOML; a single text is a list of one.
fn items(item: &Item) -> Vec<Item> {
    match item {
        Item::ArrayOfTables(tables) => tables.iter().cloned().map(Item::Table).collect(),
        Item::Value(Value::Array(array)) => array.iter().cloned().map(Item::Value).collect(),
        Item::Value(value) => vec![Item::Value(value.clone())],
        _ => Vec::new(),
    }
}

const PRODUCTION: &[&str] = &["name", "applicable", "inference", "graph", "protect", "work"];

/// A table, or only the text of the graph.
fn production(
    report: &mut Report<'_>,
    frame: &Text,
    number: usize,
    item: &Item,
) -> Option<Production> {
    let span = item.span().unwrap_or_else(|| frame.span.clone());
    if let Some(text) = item.as_str() {
        let text = Spanned { value: text.to_owned(), span };
        let graph = graph(report, &text)?;
        return Some(Production {
            name: frame.clone(),
            rules: None,
            graph,
            text,
            protect: Vec::new(),
            work: Vec::new(),
        });
    }
    let path = format!("frames.{}.productions[{number}]", frame.as_str());
    let example = "{ graph = \"entry -> a -> b -> exit\" }";
    let fields = Fields::open(report, path, item, span.clone(), PRODUCTION, example)?;
    let own = fields
        .text(report, "name", "\"NAME\"")
        .and_then(|own| name(report, own.as_str(), own.span.clone()));
    let rules = rules(report, &fields, "applicable");
    let protect = fields.texts(report, "protect", "on field from forward to back");
    let work = work(report, &fields);
    if fields.lacks("graph") {
        let message = format!("`{}` has no graph", fields.path);
        report.error(message, &span, "this production", "add graph = \"entry -> a -> b -> exit\"");
    }
    let text = fields.text(report, "graph", "\"entry -> a -> b -> exit\"")?;
    let graph = graph(report, &text)?;
    let name = own.unwrap_or_else(|| Spanned { value: frame.value.clone(), span });
    Some(Production { name, rules, graph, text, protect, work })
}

fn graph(report: &mut Report<'_>, text: &Text) -> Option<graph_text::Graph> {
    match graph_text::parse(text.as_str()) {
        Ok(mut graph) => {
            for edge in &mut graph.edges {
                edge.span = part_of(report.source, text, edge.span.clone());
            }
            Some(graph)
        }
        Err(mistakes) => {
            for mistake in mistakes {
                let span = part_of(report.source, text, mistake.span);
                report.error(mistake.message, &span, &mistake.label, &mistake.help);
            }
            None
        }
    }
}

/// `work = { forward = 10 }`
fn work(report: &mut Report<'_>, fields: &Fields<'_>) -> Vec<(Text, u16)> {
    let Some((item, _)) = fields.item("work") else { return Vec::new() };
    let span = fields.key_span("work");
    let Some(table) = item.as_table_like() else {
        let path = format!("{}.work", fields.path);
        report.wrong_type(&path, item, &span, "a table of numbers", "work = { forward = 10 }");
        return Vec::new();
    };
    let known: Vec<&str> = table.iter().map(|(key, _)| key).collect();
    let path = format!("{}.work", fields.path);
    let Some(all) = Fields::open(report, path, item, span, &known, "{ forward = 10 }") else {
        return Vec::new();
    };
    let cost = |report: &mut Report<'_>, key: &str| {
        let number = all.number(report, key, 0.0..=65_535.0, "")?;
        let value = tidy(key.trim()).into_owned();
        let name = Spanned { value, span: key_span(table, key) };
        Some((name, number.value.round() as u16))
    };
    known.iter().filter_map(|key| cost(report, key)).collect()
}
