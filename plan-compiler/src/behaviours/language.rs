//! From the tables of a mission file to [`Syntax`].

mod components;
mod doing;
mod inputs;
mod mates;
mod numbers;
mod templates;

use super::graph_text::tidy;
use super::syntax::{Behaviour, Literal, Row, Rules, Syntax};
use super::{DEFAULT_DORMANT, DEFAULT_DWELL_S, DEFAULT_HYSTERESIS, DEFAULT_UNCONDITIONAL};
use crate::team::Team;
use crate::toml::{Fields, Report, Span, Spanned, Text, key_span};
pub(crate) use inputs::channel_of;
use maps::problem::{Problem, Source};
use plan_format::limits;
use plan_format::mission::{Inference, Label, SwitchPoint};
use std::sync::Arc;
use templates::Entry;
use toml_edit::{Item, TableLike};

/// The tables of a mission file that are read here.
pub const TABLES: [&str; 5] = ["inputs", "facts", "actions", "frames", "behaviours"];

/// Longest time that a file may give, seconds.
const MAX_TIME_S: f64 = 1e6;

/// The lowest and the highest result of any rule base: the centres of gravity of NB and PB alone.
pub(super) const REACH: [f32; 2] = [1.0 / 18.0, 17.0 / 18.0];

/// Reads the behaviour tables of a mission file. The result contains everything that was
/// understood.
pub fn read(
    source: &Arc<Source>,
    file: &dyn TableLike,
    team: &Team,
    problems: &mut Vec<Problem>,
) -> Syntax {
    let mut report = Report { source, problems };
    let mut syntax = Syntax::default();
    let is_there = TABLES.iter().any(|table| file.contains_key(table));
    syntax.source = is_there.then(|| Arc::clone(source));
    let entries = templates::expand(&mut report, file, &mut syntax);
    for table in TABLES {
        is_section(&mut report, file, table);
    }
    let [inputs, facts, actions, frames, behaviours] = &entries;
    let all = entries.iter().flatten();
    let unusable = all.filter(|entry| unusable(&entry.raw).is_some());
    syntax.broken.extend(unusable.map(|entry| tidy(entry.raw.trim()).into_owned()));
    each(&mut report, inputs, |report, name, item| {
        keep(
            &mut syntax.inputs,
            &mut syntax.broken,
            name.clone(),
            inputs::input(report, team, name, item),
        );
    });
    each(&mut report, facts, |report, name, item| {
        let fact = inputs::fact(report, team, name.clone(), item);
        keep(&mut syntax.facts, &mut syntax.broken, name, fact);
    });
    each(&mut report, actions, |report, name, item| {
        keep(
            &mut syntax.actions,
            &mut syntax.broken,
            name.clone(),
            components::action(report, name, item),
        );
    });
    each(&mut report, frames, |report, name, item| {
        keep(
            &mut syntax.frames,
            &mut syntax.broken,
            name.clone(),
            components::frame(report, name, item),
        );
    });
    each(&mut report, behaviours, |report, name, item| {
        syntax.behaviours.extend(behaviour(report, name, item));
    });
    syntax
}

/// Keeps a definition, or its name if it could not be understood.
fn keep<T>(all: &mut Vec<T>, broken: &mut Vec<String>, name: Text, definition: Option<T>) {
    match definition {
        Some(definition) => all.push(definition),
        None => broken.push(name.value),
    }
}

/// Reports a key that must be a section and is something else.
fn is_section(report: &mut Report<'_>, file: &dyn TableLike, table: &str) {
    if let Some(item) = file.get(table).filter(|item| !item.is_table_like()) {
        let span = item.span().unwrap_or_else(|| key_span(file, table));
        report.wrong_type(table, item, &span, "a section", &format!("[{table}.NAME]"));
    }
}

/// Calls `with` for every entry of a table that has a valid name.
fn each(
    report: &mut Report<'_>,
    entries: &[Entry<'_>],
    mut with: impl FnMut(&mut Report<'_>, Text, &Item),
) {
    for entry in entries {
        let Some(name) = name(report, &entry.raw, entry.span.clone()) else { continue };
        let before = report.problems.len();
        with(report, name, &entry.item);
        if let Some(values) = &entry.values {
            of_copy(report, before, entry, values);
        }
    }
}

/// Says where the values of a copy are written, in the mistakes from `first` on. Mistakes that
/// another copy of the same definition has too are left out: they are not due to the values.
fn of_copy(report: &mut Report<'_>, first: usize, entry: &Entry<'_>, values: &Span) {
    let raw = &entry.raw;
    let before = report.source.text.get(..values.start).unwrap_or_default();
    let (line, column) = (before.split('\n').count(), before.rsplit('\n').next());
    let column = column.map_or(0, |text| text.chars().count()) + 1;
    let place = format!("`{raw}` is used in line {line}, column {column}");
    for mut problem in report.problems.split_off(first) {
        // Keys of a copy are written nowhere.
        if let Some(place) = problem.place.as_mut().filter(|place| place.span == (0..0)) {
            place.span = entry.span.clone();
        }
        let is_known = report.problems.iter().any(|known| is_same(known, &problem, raw));
        if !is_known {
            let help = problem.help.take().unwrap_or_default();
            report.problems.push(problem.help(format!("{help}; {place}")));
        }
    }
}

/// Whether two mistakes differ at most in the values of a parametrised definition.
fn is_same(known: &Problem, new: &Problem, raw: &str) -> bool {
    let template = raw.split_inclusive('(').next().unwrap_or(raw);
    let without_values = |message: &str| -> String {
        let mut parts = message.split(template);
        let first = parts.next().unwrap_or_default().to_owned();
        let after =
            |part: &str| part.split_once(')').map_or(String::new(), |(_, rest)| rest.into());
        parts.fold(first, |all, part| all + template + &after(part))
    };
    let span = |problem: &Problem| problem.place.as_ref().map(|place| place.span.clone());
    span(known) == span(new) && without_values(&known.message) == without_values(&new.message)
}

/// A name that fits the format and can be written in graphs and conditions.
fn name(report: &mut Report<'_>, raw: &str, span: Span) -> Option<Text> {
    let Some(reason) = unusable(raw) else {
        return Some(Spanned { value: raw.trim().to_owned(), span });
    };
    report.error(format!("`{raw}` cannot be a name"), &span, &reason, "choose another name");
    None
}

/// Why a text cannot be a name.
pub(super) fn unusable(raw: &str) -> Option<String> {
    let name = raw.trim();
    if name.is_empty() {
        Some("a name must not be empty".to_owned())
    } else if name.len() > limits::MAX_NAME_BYTES {
        let (most, own) = (limits::MAX_NAME_BYTES, name.len());
        Some(format!("a name has at most {most} bytes; this one has {own}"))
    } else if name.contains(|c: char| c.is_control() || matches!(c, '\'' | '"')) {
        Some("a name must not contain quotes or control characters".to_owned())
    } else if matches!(name, "entry" | "exit") || name.starts_with("not ") {
        Some("this has a special meaning in graphs and conditions".to_owned())
    } else {
        None
    }
}

const BEHAVIOUR: &[&str] = &[
    "plan",
    "criticality",
    "inference",
    "dormant",
    "unconditional",
    "hysteresis",
    "dwell_s",
    "switch",
    "once",
    "start_up",
    "shut_down",
    "resources",
];

fn behaviour(report: &mut Report<'_>, name: Text, item: &Item) -> Option<Behaviour> {
    let path = format!("behaviours.{}", name.as_str());
    let example = "criticality = { fuel = \"PB PB PM PM NB NB NB\" }";
    let fields = Fields::open(
        report,
        path,
        item,
        name.span.clone(),
        BEHAVIOUR,
        &format!("{{ {example} }}"),
    )?;
    let switch = [("earliest", SwitchPoint::Earliest), ("best", SwitchPoint::Best)];
    let frame = |report: &mut Report<'_>, key| {
        let name = fields.text(report, key, "\"FRAME\"")?;
        Some(Spanned { value: tidy(name.as_str()).into_owned(), span: name.span })
    };
    let level = |report: &mut Report<'_>, key: &str, default: f32| {
        let given = fields.number(report, key, 0.0..=1.0, "");
        let span = given.as_ref().map_or(fields.span.clone(), |given| given.span.clone());
        Spanned { value: given.map_or(default, |given| given.value as f32), span }
    };
    let dormant = level(report, "dormant", DEFAULT_DORMANT);
    let unconditional = level(report, "unconditional", DEFAULT_UNCONDITIONAL);
    // These would make the comparison of both thresholds fail too. The lints report the others.
    let [low, high] = REACH;
    if unconditional.value < low {
        unreachable(report, "unconditional", unconditional.value, &unconditional.span);
    }
    if dormant.value > high {
        unreachable(report, "dormant", dormant.value, &dormant.span);
    }
    let hysteresis = level(report, "hysteresis", DEFAULT_HYSTERESIS).value;
    let root = frame(report, "plan").unwrap_or_else(|| name.clone());
    let start_up = frame(report, "start_up");
    let shut_down = frame(report, "shut_down");
    let dwell_ms =
        milliseconds(report, &fields, "dwell_s").unwrap_or((DEFAULT_DWELL_S * 1e3) as u32);
    let switch_point = fields.word(report, "switch", &switch).unwrap_or(SwitchPoint::Earliest);
    let once = fields.flag(report, "once").unwrap_or(false);
    let resources = fields.texts(report, "resources", "arm");
    let rules = rules(report, &fields, "criticality");
    if fields.lacks("criticality") {
        let message = format!("behaviour `{}` has no criticality", name.as_str());
        report.error(message, &name.span, "this behaviour", &format!("add {example}"));
    }
    // After a mistake an empty rule base stands in, so that the other names are looked up.
    let empty = Rules { rows: Vec::new(), inference: Inference::Min, span: name.span.clone() };
    let rules = rules.unwrap_or(empty);
    Some(Behaviour {
        name,
        root,
        start_up,
        shut_down,
        rules,
        dormant,
        unconditional,
        hysteresis,
        dwell_ms,
        switch_point,
        once,
        resources,
    })
}

/// Reports a threshold that no rule base reaches.
pub(super) fn unreachable(report: &mut Report<'_>, key: &str, level: f32, span: &Span) {
    let message = format!("`{key}` cannot be reached: rules result in 1/18 to 17/18");
    let label = format!("{level} lies outside 0.0556 to 0.9444");
    report.error(message, span, &label, "choose a value in between");
}

/// A rule base: a table with one row per input. The key `inference` is beside it.
fn rules(report: &mut Report<'_>, fields: &Fields<'_>, key: &str) -> Option<Rules> {
    let words = [("min", Inference::Min), ("product", Inference::Product)];
    let inference = fields.word(report, "inference", &words).unwrap_or(Inference::Min);
    let (item, span) = fields.item(key)?;
    let Some(table) = item.as_table_like() else {
        let example = format!("{key} = {{ fuel = \"PB PB PM PM NB NB NB\" }}");
        let path = format!("{}.{key}", fields.path);
        report.wrong_type(&path, item, &span, "a table of rules", &example);
        return None;
    };
    let span = fields.key_span(key);
    if table.is_empty() {
        let message = format!("`{}.{key}` has no rule", fields.path);
        let help = "add a row for an input, for example fuel = \"PB PB PM PM NB NB NB\"";
        report.error(message, &span, "an empty table decides nothing", help);
        return None;
    }
    let rows: Vec<Option<(Text, Row)>> = table
        .iter()
        .map(|(input, item)| {
            let name =
                Spanned { value: tidy(input.trim()).into_owned(), span: key_span(table, input) };
            Some((name, row(report, input, item, key_span(table, input))?))
        })
        .collect();
    Some(Rules { rows: rows.into_iter().flatten().collect(), inference, span })
}

const LABELS: [&str; 7] = ["NB", "NM", "NS", "ZO", "PS", "PM", "PB"];

/// Seven labels: the result for each label of the input. Two labels: the results for a fact that
/// does not hold, and for one that holds.
fn row(report: &mut Report<'_>, input: &str, item: &Item, key: Span) -> Option<Row> {
    let span = item.span().unwrap_or(key);
    let quoted = if input.contains(' ') { format!("\"{input}\"") } else { input.to_owned() };
    let help =
        format!("write {quoted} = \"PB PB PM PM NB NB NB\", for NB NM NS ZO PS PM PB in turn");
    let Some(text) = item.as_str() else {
        report.wrong_type(input, item, &span, "a row of seven labels", &help[6..]);
        return None;
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    let unknown: Vec<&str> = words.iter().copied().filter(|word| !LABELS.contains(word)).collect();
    if let Some(word) = unknown.first() {
        let message = format!("`{word}` is not a label");
        report.error(message, &span, "labels are NB NM NS ZO PS PM PB", &help);
        return None;
    }
    let labels = words.iter().filter_map(|word| LABELS.iter().position(|label| label == word));
    let labels: Vec<Label> = labels.map(|index| Label::from_index(index as u8)).collect();
    match *labels.as_slice() {
        [a, b, c, d, e, f, g] => Some(Row::OfInput([a, b, c, d, e, f, g])),
        [unless, holds] => Some(Row::OfFact([unless, holds])),
        _ => {
            let message =
                format!("the row of `{input}` has {} labels instead of seven", labels.len());
            let help =
                format!("{help}; the row of a fact has two, for `does not hold` and `holds`");
            report.error(message, &span, "one for each label of the input", &help);
            None
        }
    }
}

/// Facts that must hold, and facts after `not` that must not hold.
fn literals(report: &mut Report<'_>, fields: &Fields<'_>, key: &str) -> Vec<Literal> {
    let texts = fields.texts(report, key, "on field").into_iter();
    texts.map(|text| literal(once_negated(report, text))).collect()
}

/// Reports a condition with more than one `not`, and returns what it means.
fn once_negated(report: &mut Report<'_>, text: Text) -> Text {
    let mut name = text.as_str();
    let mut count = 0;
    while let Some(rest) = name.strip_prefix("not ") {
        (name, count) = (rest.trim_start(), count + 1);
    }
    if count < 2 {
        return text;
    }
    let meant = if count % 2 == 0 { name.to_owned() } else { format!("not {name}") };
    let message = format!("`{}` has more than one `not`", text.as_str());
    report.error(message, &text.span, "this condition", &format!("write \"{meant}\""));
    Spanned { value: meant, span: text.span }
}

/// `on field`, or `not on field`.
pub(super) fn literal(text: Text) -> Literal {
    let is_negated = text.as_str().starts_with("not ");
    let name = text.as_str().strip_prefix("not ").unwrap_or(text.as_str());
    let name = tidy(name.trim().trim_matches(['\'', '"'])).into_owned();
    Literal { fact: Spanned { value: name, span: text.span }, is_negated }
}

/// A time in seconds, in milliseconds.
fn milliseconds(report: &mut Report<'_>, fields: &Fields<'_>, key: &str) -> Option<u32> {
    let seconds = fields.number(report, key, 0.0..=MAX_TIME_S, "s")?;
    Some((seconds.value * 1e3).round() as u32)
}
