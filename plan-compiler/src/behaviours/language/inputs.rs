//! Inputs and facts.

use super::numbers::Numbers;
use super::{mates, milliseconds, rules};
use crate::behaviours::DEFAULT_MISSING_HOLD_S;
use crate::behaviours::syntax::{Fact, FactSyntax, Input, InputSource};
use crate::team::Team;
use crate::toml::{Fields, Report, Spanned, Text};
use maps::names::nearest;
use plan_format::limits::{MAX_CHANNELS, MAX_OUTPUTS};
use robot_io::percepts::channel;
use toml_edit::Item;

const INPUT: &[&str] = &["source", "rules", "inference", "universe", "missing", "channel", "full"];
const SOURCES: &[&str] = &[
    "battery",
    "fuel",
    "link",
    "custom",
    "distance",
    "time",
    "cost-to-goal",
    "price",
    "range-left",
    "output",
    "mates-linked",
    "oldest-news",
    "mate-distance",
    "mate-link",
];
/// Number of channels whose meaning the user defines.
const CUSTOM_COUNT: u8 = MAX_CHANNELS as u8 - channel::CUSTOM;
const SOURCES_HELP: &str = "write battery, fuel, link, custom N, distance X, Y, time, \
    cost-to-goal PLAN, price PLAN/LAYER, range-left PLAN, output N, mates-linked, oldest-news, \
    mate-distance NAME or mate-link NAME";

pub(super) fn input(
    report: &mut Report<'_>,
    team: &Team,
    name: Text,
    item: &Item,
) -> Option<Input> {
    let path = format!("inputs.{}", name.as_str());
    let example = "{ source = \"fuel\", missing = { then = 0.0 } }";
    let fields = Fields::open(report, path, item, name.span.clone(), INPUT, example)?;
    let source = match (fields.item("source"), fields.item("rules")) {
        (Some(_), None) => {
            let text = fields.text(report, "source", "\"fuel\"");
            text.and_then(|text| self::source(report, team, &fields, &text))
        }
        (None, Some(_)) => rules(report, &fields, "rules").map(InputSource::Rules),
        (None, None) if !fields.lacks("source") || !fields.lacks("rules") => None,
        (both, _) => {
            let (message, help) = match both {
                Some(_) => ("has both a source and rules", "keep one of the two"),
                None => ("has no source", "add source = \"fuel\", or rules over other inputs"),
            };
            let message = format!("input `{}` {message}", name.as_str());
            report.error(message, &name.span, "this input", help);
            None
        }
    };
    let is_of_tank = matches!(source, Some(InputSource::RangeLeft { .. }) | None);
    for key in ["channel", "full"].into_iter().filter(|_| !is_of_tank) {
        if let Some((_, span)) = fields.item(key) {
            let message = format!("`{}.{key}` has no meaning here", fields.path);
            let help = "only source = \"range-left PLAN\" has a channel and a full tank";
            report.error(message, &span, "not for this source", help);
        }
    }
    let universe = universe(report, &fields, source.as_ref(), &name);
    let (hold_ms, missing) = missing(report, &fields, source.as_ref(), universe, &name);
    Some(Input { name, source: source?, universe: universe?, hold_ms, missing })
}

fn universe(
    report: &mut Report<'_>,
    fields: &Fields<'_>,
    source: Option<&InputSource>,
    name: &Text,
) -> Option<[f32; 2]> {
    if let Some((_, span)) = fields.item("universe") {
        let expected = "two finite numbers: the values that are fully NB and fully PB";
        let ends = fields.numbers(report, "universe", expected, "universe = [0.0, 1.0]")?;
        if ends[0].to_bits() == ends[1].to_bits() || !(ends[1] - ends[0]).is_normal() {
            let message = format!("the universe of `{}` is a single value", name.as_str());
            report.error(message, &span, "its ends are the same", "write universe = [0.0, 1.0]");
            return None;
        }
        return Some(ends);
    }
    use InputSource::{Channel, MateLink, Output, Rules};
    match source {
        Some(Channel(_) | MateLink(_) | Output(_) | Rules(_)) | None => Some([0.0, 1.0]),
        Some(_) => {
            let message = format!("input `{}` has no universe", name.as_str());
            let help = "add universe = [LOW, HIGH]: the values that are fully NB and fully PB";
            report.error(message, &name.span, "this input has no natural ends", help);
            None
        }
    }
}

/// How long the last value is kept, in milliseconds, and the value used after that. Required for
/// every input whose value may be missing.
fn missing(
    report: &mut Report<'_>,
    fields: &Fields<'_>,
    source: Option<&InputSource>,
    universe: Option<[f32; 2]>,
    name: &Text,
) -> (u32, f32) {
    use InputSource::{MateLink, MatesLinked, Output, Rules, Time};
    let low = universe.map_or(0.0, |[low, _]| low);
    let default_ms = (DEFAULT_MISSING_HOLD_S * 1e3) as u32;
    let Some((item, _)) = fields.item("missing") else {
        let is_always_known =
            matches!(source, Some(Time | Output(_) | Rules(_) | MatesLinked | MateLink(_)) | None);
        if !is_always_known {
            let message = format!(
                "input `{}` does not say which value replaces a missing one",
                name.as_str()
            );
            let help =
                format!("add missing = {{ hold_s = {DEFAULT_MISSING_HOLD_S}, then = {low:?} }}");
            report.error(message, &name.span, "its value may be missing", &help);
        }
        return (default_ms, low);
    };
    let path = format!("{}.missing", fields.path);
    let (span, example) = (fields.key_span("missing"), "missing = { hold_s = 2.0, then = 0.0 }");
    let Some(policy) = Fields::open(report, path, item, span, &["hold_s", "then"], example) else {
        return (default_ms, low);
    };
    if policy.lacks("then") {
        let message = format!("`{}` has no `then`", policy.path);
        let help = format!("add then = {low:?}: the value that replaces a missing one");
        report.error(message, &policy.span, "no value after the hold time", &help);
    }
    let hold_ms = milliseconds(report, &policy, "hold_s").unwrap_or(default_ms);
    let then = policy.number(report, "then", -1e9..=1e9, "");
    (hold_ms, then.map_or(low, |then| then.value as f32))
}

/// The number of an input channel by its name in a mission file: `battery`, `fuel`, `link` or
/// `custom N`.
pub(crate) fn channel_of(text: &str) -> Option<u8> {
    let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
    match (word, rest.trim()) {
        ("battery", "") => Some(channel::BATTERY),
        ("fuel", "") => Some(channel::FUEL),
        ("link", "") => Some(channel::LINK),
        ("custom", number) => {
            let number = number.parse::<u8>().ok();
            let number = number.filter(|number| (1..=CUSTOM_COUNT).contains(number));
            number.map(|number| channel::CUSTOM + number - 1)
        }
        _ => None,
    }
}

fn source(
    report: &mut Report<'_>,
    team: &Team,
    fields: &Fields<'_>,
    text: &Text,
) -> Option<InputSource> {
    let (word, rest) = text.as_str().split_once(' ').unwrap_or((text.as_str(), ""));
    let rest = rest.trim();
    let named = |name: &str| Spanned { value: name.to_owned(), span: text.span.clone() };
    let mut numbers = Numbers::of(text);
    let _ = match word {
        "custom" => numbers.whole(rest, 1..=u16::from(CUSTOM_COUNT)),
        "output" => numbers.whole(rest, 0..=(MAX_OUTPUTS - 1) as u16),
        _ => None,
    };
    if !numbers.report(report, &format!("{}.source", fields.path)) {
        return None;
    }
    let found = match (word, rest) {
        ("battery" | "fuel" | "link" | "custom", _) => {
            channel_of(text.as_str()).map(InputSource::Channel)
        }
        ("distance", place) => pair(place).map(InputSource::DistanceTo),
        ("time", "") => Some(InputSource::Time),
        ("mates-linked", "") => Some(InputSource::MatesLinked),
        ("oldest-news", "") => Some(InputSource::OldestNews),
        ("mate-distance", name) if !name.is_empty() => {
            return mates::distance(report, team, &named(name));
        }
        ("mate-link", name) if !name.is_empty() => {
            return mates::link(report, team, &named(name));
        }
        ("cost-to-goal", plan) if !plan.is_empty() => Some(InputSource::CostToGoal(named(plan))),
        ("range-left", plan) if !plan.is_empty() => {
            return range_left(report, fields, named(plan));
        }
        ("price", both) => both
            .split_once('/')
            .map(|(plan, layer)| InputSource::Price(named(plan.trim()), named(layer.trim()))),
        ("output", number) => number
            .parse::<u8>()
            .ok()
            .filter(|&number| usize::from(number) < MAX_OUTPUTS)
            .map(InputSource::Output),
        _ => None,
    };
    if found.is_none() {
        let label = match nearest(word, SOURCES.iter().copied()) {
            Some(meant) if meant != word => format!("did you mean `{meant}`?"),
            Some("custom") => format!("the number is 1 to {CUSTOM_COUNT}"),
            Some("output") => format!("the number is 0 to {}", MAX_OUTPUTS - 1),
            _ => "this source".into(),
        };
        let message = format!("`{}` is not an input source", text.as_str());
        report.error(message, &text.span, &label, SOURCES_HELP);
    }
    found
}

/// The range that a tank still gives, less the cost to the goal of a plan.
fn range_left(report: &mut Report<'_>, fields: &Fields<'_>, plan: Text) -> Option<InputSource> {
    let channel = match fields.item("channel") {
        None => Some(channel::FUEL),
        Some(_) => fields.text(report, "channel", "\"fuel\"").and_then(|name| {
            let channel = channel_of(name.as_str());
            if channel.is_none() {
                let known = ["battery", "fuel", "link", "custom 1"].into_iter();
                let how = format!("write battery, fuel, link or custom 1 to {CUSTOM_COUNT}");
                report.unknown("channel", &name, known, &how);
            }
            channel
        }),
    };
    if fields.lacks("full") {
        let message = format!("`{}` does not say how far a full tank leads", fields.path);
        let help = "add full = 400: the metres that the robot drives with a full tank";
        report.error(message, &fields.span, "no `full`", help);
    }
    let full = fields.number(report, "full", 0.01..=1e7, "m");
    Some(InputSource::RangeLeft { plan, channel: channel?, full_m: full?.value as f32 })
}

/// `X, Y`, metres.
pub(super) fn pair(text: &str) -> Option<[f32; 2]> {
    let (x, y) = text.split_once(',')?;
    let both = [x.trim().parse::<f32>().ok()?, y.trim().parse::<f32>().ok()?];
    both.iter().all(|number| number.is_finite()).then_some(both)
}

const FACT: &[&str] = &[
    "input",
    "at_least",
    "at_most",
    "near",
    "within",
    "inside",
    "no_progress",
    "for_s",
    "linked",
    "mate",
    "signals",
    "missing",
];
/// A fact has exactly one of these keys.
const KINDS: [&str; 6] = ["input", "near", "inside", "no_progress", "linked", "mate"];
const FACT_HELP: &str = "write false or true for a symbol's initial value, { inside = [W, S, E, N] }, \
    { near = [X, Y], within = M }, { input = \"fuel\", at_least = 0.9 }, \
    { no_progress = 0.5, for_s = 10 }, { linked = \"all\" } or { mate = \"NAME\", within = M }";

pub(super) fn fact(report: &mut Report<'_>, team: &Team, name: Text, item: &Item) -> Option<Fact> {
    if let Some(is_set) = item.as_bool() {
        return Some(Fact { name, kind: FactSyntax::Symbol { is_set } });
    }
    let path = format!("facts.{}", name.as_str());
    let fields = Fields::open(report, path, item, name.span.clone(), FACT, &FACT_HELP[6..])?;
    let has = |key: &str| fields.item(key).is_some();
    // `near` is a place of the robot, or of the mate.
    let near = has("near") && !has("mate");
    let kinds = [has("input"), near, has("inside"), has("no_progress"), has("linked"), has("mate")];
    let kind = match kinds {
        [true, false, false, false, false, false] => level(report, &fields),
        [false, true, false, false, false, false] => self::near(report, &fields),
        [false, false, true, false, false, false] => inside(report, &fields, &name),
        [false, false, false, true, false, false] => no_progress(report, &fields),
        [false, false, false, false, true, false] => mates::linked(report, &fields, team),
        [false, false, false, false, false, true] => mates::mate(report, &fields, team),
        _ if kinds == [false; 6] && KINDS.iter().any(|key| !fields.lacks(key)) => None,
        [false, false, false, false, false, false] => {
            let message = format!("fact `{}` has no condition", name.as_str());
            report.error(message, &name.span, "this fact", FACT_HELP);
            None
        }
        _ => {
            let message = format!("fact `{}` has more than one condition", name.as_str());
            report.error(message, &name.span, "this fact", "split it into several facts");
            None
        }
    };
    Some(Fact { name, kind: kind? })
}

fn level(report: &mut Report<'_>, fields: &Fields<'_>) -> Option<FactSyntax> {
    let input = fields.text(report, "input", "\"fuel\"");
    let low = fields.number(report, "at_least", -1e9..=1e9, "");
    let high = fields.number(report, "at_most", -1e9..=1e9, "");
    let value =
        |end: &Option<Spanned<f64>>, open| end.as_ref().map_or(open, |end| end.value as f32);
    let (low_m, high_m) = (value(&low, f32::NEG_INFINITY), value(&high, f32::INFINITY));
    if fields.item("at_least").is_none() && fields.item("at_most").is_none() {
        if !fields.lacks("at_least") || !fields.lacks("at_most") {
            return None;
        }
        let message = format!("`{}` has neither `at_least` nor `at_most`", fields.path);
        report.error(message, &fields.span, "always true", "add at_least = 0.9, for example");
        return None;
    }
    if let (Some(low), Some(high)) = (&low, &high)
        && low.value > high.value
    {
        let message = format!("`{}` never holds", fields.path);
        report.error(message, &low.span, "above its `at_most`", "swap the two numbers");
        return None;
    }
    Some(FactSyntax::Level { input: input?, low: low_m, high: high_m })
}

fn near(report: &mut Report<'_>, fields: &Fields<'_>) -> Option<FactSyntax> {
    let example = "near = [12.5, 40.0]";
    let at = fields.numbers(report, "near", "a place: two finite numbers", example);
    let within = fields.number(report, "within", 0.01..=1e5, "m");
    if fields.lacks("within") {
        let message = format!("`{}` has no `within`", fields.path);
        report.error(message, &fields.span, "no distance given", "add within = 2.0, in metres");
    }
    Some(FactSyntax::Near { at: at?, radius_m: within?.value as f32 })
}

fn inside(report: &mut Report<'_>, fields: &Fields<'_>, name: &Text) -> Option<FactSyntax> {
    let expected = "a rectangle: west, south, east, north";
    let sides = fields.numbers(report, "inside", expected, "inside = [0, 0, 60, 40]")?;
    let [west, south, east, north] = sides;
    if west < east && south < north {
        return Some(FactSyntax::Inside(sides));
    }
    let message = format!("the rectangle of `{}` is empty", name.as_str());
    let span = fields.item("inside").map_or(fields.span.clone(), |(_, span)| span);
    report.error(
        message,
        &span,
        "west, south, east, north",
        "write west below east and south below north",
    );
    None
}

fn no_progress(report: &mut Report<'_>, fields: &Fields<'_>) -> Option<FactSyntax> {
    let distance = fields.number(report, "no_progress", 0.01..=1e5, "m");
    let time = fields.number(report, "for_s", 0.1..=super::MAX_TIME_S, "s");
    if fields.lacks("for_s") {
        let message = format!("`{}` has no `for_s`", fields.path);
        report.error(message, &fields.span, "no time given", "add for_s = 10");
    }
    let within_ms = (time?.value * 1e3).round() as u32;
    Some(FactSyntax::NoProgress { distance_m: distance?.value as f32, within_ms })
}
