//! Strips as a mission file: a behaviour whose plan drives them one after the other.
//!
//! One `go-to` action for each end of a strip, made from two definitions with parameters, so that what
//! holds for all strips (the tool's output, the speed) is written once. A parallel plan leads to the
//! first strip, and wherever the transition to the next one leads around obstacles; or to every strip, for
//! missions in which other behaviours lead the robot away in between. A strip is protected from its
//! start to its end: it is a fact that the robot is at its start, which its drive needs.

mod earlier;

pub use earlier::other_behaviours;

use super::{Cover, Strip, Transition};
use earlier::Earlier;
use maps::numbers::metres;
use maps::problem::Problem;
use maps::{NamedPoint, Point};
use plan_format::limits;
use std::collections::BTreeSet;
use toml_edit::{DocumentMut, Item, RawString, Table, TableLike, Value};

/// What a mission is written from.
#[derive(Clone, Copy, Debug)]
pub struct Writing<'a> {
    /// The mission to add to; `None` for a new one.
    pub base: Option<&'a str>,
    /// The map, relative to the file that is written.
    pub map: &'a str,
    /// The map's named points, which are goals where the base has no table of goals.
    pub points: &'a [NamedPoint],
    /// Keys and values that replace those of the base.
    pub set: &'a [(&'static str, Value)],
    /// Width of the tool, metres.
    pub width_m: f64,
    /// Whether a plan leads to every strip.
    pub plan_each: bool,
    /// Speed at which timeouts are estimated, m/s.
    pub speed_mps: f64,
    /// What the first line says.
    pub title: &'a str,
}

/// Starts the first line.
const TITLE: &str = "# Strips by `plan-compiler cover`";
/// Turning points of a transition that are driven to one by one; for more, a plan is followed.
const MAX_VIA: usize = 2;
/// Strips of one production.
const STRIPS_A_PRODUCTION: usize = 8;

/// The text of a mission that drives the strips.
///
/// # Errors
/// Returns that the strips exceed what a mission holds, or that the base cannot be added to.
pub fn mission(cover: &Cover, writing: &Writing<'_>) -> Result<String, Problem> {
    let legs: Vec<Leg<'_>> = legs(cover, writing.plan_each);
    let mut document = match writing.base {
        Some(text) => text
            .parse::<DocumentMut>()
            .map_err(|error| Problem::error(format!("the mission cannot be added to: {error}")))?,
        None => DocumentMut::new(),
    };
    if document.get("team").and_then(|team| team.get("robots")).is_some() {
        let message = "the mission is one of a team, and strips are those of one robot";
        let help = "cover the area with a mission of its own: give the map instead";
        return Err(Problem::error(message).help(help));
    }
    let earlier = Earlier::of(writing.base.unwrap_or_default(), &document);
    earlier.forget(&mut document);
    let legs = legs.as_slice();
    check(legs, &document)?;
    head(&mut document, writing);
    goals(&mut document, &earlier, legs, writing.points)?;
    let mut table =
        |name: &str, key: &str, value: String| put(&mut document, &earlier, [name, key], &value);
    table("behaviours", COVER, "{ criticality = { \"area covered\" = \"PS NB\" } }".to_owned())?;
    frames(legs, &mut table)?;
    for fact in [DONE, AT_STRIP] {
        table("facts", fact, "false".to_owned())?;
    }
    actions(legs, writing.speed_mps, &mut table)?;
    Ok(titled(&document.to_string(), writing.title))
}

/// The behaviour and its plan.
const COVER: &str = "cover";
/// The fact that holds at the end.
const DONE: &str = "area covered";
/// The fact that the robot is at the start of its strip.
const AT_STRIP: &str = "at strip";
const PASS: &str = "pass(x, y)";
const DRIVE: &str = "drive(x, y)";
const WORK: &str = "work(x, y)";
const SKIP: &str = "skip strip";
/// Actions that every run writes anew.
const OURS: [&str; 4] = [PASS, DRIVE, WORK, SKIP];

/// A strip and the transition to it.
struct Leg<'c> {
    number: usize,
    strip: &'c Strip,
    transition: Option<&'c Transition>,
    /// Whether a plan leads to the strip.
    has_plan: bool,
}

impl Leg<'_> {
    fn name(&self) -> String {
        format!("strip {}", self.number)
    }

    /// Its components.
    fn components(&self) -> Vec<String> {
        let work = format!("work({})", coordinates(self.strip.to));
        if self.has_plan {
            return vec![format!("go to {}", self.name()), work];
        }
        let via = self.transition.map_or(&[][..], |transition| &transition.via);
        let passes = via.iter().map(|at| format!("pass({})", coordinates(*at)));
        let drive = format!("drive({})", coordinates(self.strip.from));
        passes.chain([drive, work]).collect()
    }
}

fn legs(cover: &Cover, plan_each: bool) -> Vec<Leg<'_>> {
    let transitions = [None].into_iter().chain(cover.transitions.iter().map(Some));
    let legs = cover.strips.iter().zip(transitions).zip(1..);
    legs.map(|((strip, transition), number)| {
        let is_around =
            transition.is_none_or(|transition| transition.leaves || transition.via.len() > MAX_VIA);
        Leg { number, strip, transition, has_plan: plan_each || is_around }
    })
    .collect()
}

fn coordinates([x, y]: Point) -> String {
    // Adding 0 turns -0 into 0.
    format!("{}, {}", metres(rounded(x)), metres(rounded(y)))
}

fn rounded(metres: f64) -> f64 {
    (metres * 1e3).round() / 1e3 + 0.0
}

/// Reports strips that exceed what a mission holds.
fn check(legs: &[Leg<'_>], document: &DocumentMut) -> Result<(), Problem> {
    let count = |table: &str, ours: &[&str]| {
        let table = document.get(table).and_then(Item::as_table_like);
        table.map_or(0, |table| table.iter().filter(|(name, _)| !ours.contains(name)).count())
    };
    let names: BTreeSet<String> = legs.iter().flat_map(Leg::components).collect();
    let actions = names.len() + 1;
    let own = count("actions", &OURS);
    let plans = legs.iter().filter(|leg| leg.has_plan).count();
    let goals = count("goals", &[]);
    let exceeds = [
        (actions + own, limits::MAX_ACTIONS, "actions"),
        (plans + goals, limits::MAX_PLANS, "plans"),
    ];
    let Some((needed, limit, what)) = exceeds.into_iter().find(|(n, limit, _)| n > limit) else {
        return Ok(());
    };
    let message =
        format!("{} strips need {needed} {what}, but a mission holds {limit}", legs.len());
    Err(Problem::error(message).help(
        "use a greater --width, leave small gaps with --leave, cover the area in parts with \
         --corner, or write the strips only: -o strips.csv",
    ))
}

/// Keys at the top.
fn head(document: &mut DocumentMut, writing: &Writing<'_>) {
    let map = ("map", Value::from(writing.map));
    for (key, value) in [map].into_iter().chain(writing.set.iter().cloned()) {
        let value = Item::Value(value);
        // A value that is replaced keeps the comments before its key.
        match document.get_mut(key) {
            Some(old) => *old = value,
            None => {
                document.insert(key, value);
            }
        }
    }
    // A robot that stops a metre before the end of its strip leaves a gap there.
    let schemas = document.entry("schemas").or_insert_with(|| Item::Table(Table::new()));
    if let Some(table) = schemas.as_table_like_mut() {
        let given = table.get(TOLERANCE).and_then(Item::as_value);
        if given.is_none_or(|value| {
            value.decor().suffix().and_then(RawString::as_str) == Some(OF_COVER)
        }) {
            let tolerance = rounded((writing.width_m / 4.0).clamp(0.1, 1.0));
            let mut value = Value::from(tolerance);
            value.decor_mut().set_suffix(OF_COVER);
            table.insert(TOLERANCE, Item::Value(value));
        }
    }
}

const TOLERANCE: &str = "goal_tolerance";
/// Follows the tolerance that depends on the width, so that the next run can tell it from the user's.
const OF_COVER: &str = " # by cover, from the width";

/// Goals of the transitions that follow a plan.
fn goals(
    document: &mut DocumentMut,
    earlier: &Earlier,
    legs: &[Leg<'_>],
    points: &[NamedPoint],
) -> Result<(), Problem> {
    let behaves = document.contains_key("behaviours");
    if !document.contains_key("goals") && behaves {
        // Without a table of goals, the named points of the map are the goals.
        for point in points {
            let name = Value::from(point.name.as_str()).to_string();
            put(document, earlier, ["goals", &point.name], &name)?;
        }
    }
    for leg in legs.iter().filter(|leg| leg.has_plan) {
        let at = format!("[{}]", coordinates(leg.strip.from));
        put(document, earlier, ["goals", &leg.name()], &at)?;
    }
    Ok(())
}

type Put<'p> = dyn FnMut(&str, &str, String) -> Result<(), Problem> + 'p;

/// The plan: productions of a few strips each.
fn frames(legs: &[Leg<'_>], table: &mut Put<'_>) -> Result<(), Problem> {
    let name = |group: &[Leg<'_>]| match group {
        [first, .., last] => format!("strips {} to {}", first.number, last.number),
        [only] => format!("strips {}", only.number),
        [] => String::new(),
    };
    let all: Vec<String> = legs.chunks(STRIPS_A_PRODUCTION).map(name).collect();
    let production = |names: &[String]| format!("\"entry -> {} -> exit\"", names.join(" -> "));
    let whole = format!("{{ productions = [{}], add = [\"{DONE}\"] }}", production(&all));
    table("frames", COVER, whole)?;
    for group in legs.chunks(STRIPS_A_PRODUCTION) {
        let names: Vec<String> = group.iter().map(Leg::name).collect();
        table("frames", &name(group), format!("{{ productions = [{}] }}", production(&names)))?;
    }
    for leg in legs {
        let drive = production(&leg.components());
        let skip = production(&[SKIP.to_owned()]);
        table("frames", &leg.name(), format!("{{ productions = [{drive}, {skip}] }}"))?;
    }
    Ok(())
}

fn actions(legs: &[Leg<'_>], speed_mps: f64, table: &mut Put<'_>) -> Result<(), Problem> {
    let longest = legs.iter().map(|leg| leg.strip.length_m()).fold(0.0, f64::max);
    let transitions =
        legs.iter().filter_map(|leg| leg.transition).map(|transition| transition.length_m);
    let farthest = transitions.fold(0.0, f64::max);
    // Three times as long as at full speed, and a minute to turn.
    let timeout = |metres: f64| (60.0 + 3.0 * metres / speed_mps.max(0.05)).ceil();
    let go_to = |metres: f64, rest: &str| {
        format!("{{ do = \"go-to {{x}}, {{y}}\", timeout_s = {}{rest} }}", timeout(metres))
    };
    let arrives = format!(", add = [\"{AT_STRIP}\"]");
    if legs.iter().any(|leg| {
        !leg.has_plan && leg.transition.is_some_and(|transition| !transition.via.is_empty())
    }) {
        table("actions", PASS, go_to(farthest, ""))?;
    }
    if legs.iter().any(|leg| !leg.has_plan) {
        table("actions", DRIVE, go_to(farthest, &arrives))?;
    }
    let works = format!(", initial = [\"{AT_STRIP}\"], delete = [\"{AT_STRIP}\"]");
    table("actions", WORK, go_to(longest, &works))?;
    table("actions", SKIP, "{ do = \"wait 1 s\" }".to_owned())?;
    for leg in legs.iter().filter(|leg| leg.has_plan) {
        let name = leg.name();
        let follow = format!("{{ do = \"follow {name}\"{arrives} }}");
        table("actions", &format!("go to {name}"), follow)?;
    }
    Ok(())
}

/// Sets a key of a table. A key that is there must be one of an earlier run.
fn put(
    document: &mut DocumentMut,
    earlier: &Earlier,
    [name, key]: [&str; 2],
    value: &str,
) -> Result<(), Problem> {
    let value: Value = value.parse().map_err(|error| {
        // Only a name of the map that TOML cannot hold.
        Problem::error(format!("`{key}` cannot be written: {error}"))
    })?;
    let item = document.entry(name).or_insert_with(|| Item::Table(Table::new()));
    let table: &mut dyn TableLike = item
        .as_table_like_mut()
        .ok_or_else(|| Problem::error(format!("`{name}` of the mission is not a table")))?;
    match table.get_mut(key) {
        Some(old) if earlier.stays(name, key) => *old = Item::Value(value),
        Some(_) => {
            let message = format!("the mission has `{key}` in [{name}], a name that strips need");
            let help = format!("rename `{key}` wherever the mission uses it");
            return Err(Problem::error(message).help(help));
        }
        None => {
            table.insert(key, Item::Value(value));
        }
    }
    Ok(())
}

/// Whether a line is the title that a run writes.
fn is_title(line: &str) -> bool {
    line.starts_with(TITLE)
}

/// The text below one title.
fn titled(text: &str, title: &str) -> String {
    let title = format!("{TITLE}: {title}");
    if !text.lines().any(is_title) {
        return format!("{title}\n{text}");
    }
    let lines = text.split('\n').map(|line| if is_title(line) { &title } else { line });
    lines.collect::<Vec<_>>().join("\n")
}
