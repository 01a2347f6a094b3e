//! What an action does: the text of its key `do`.

use super::MAX_TIME_S;
use super::inputs::pair;
use super::numbers::Numbers;
use crate::behaviours::syntax::Doing;
use crate::toml::{Report, Spanned, Text};
use maps::names::nearest;
use plan_format::limits::MAX_OUTPUTS;

const VERBS: &[&str] = &[
    "follow",
    "go-to",
    "return",
    "hold",
    "wait",
    "wander",
    "move-ahead",
    "dock",
    "signal",
    "set-output",
];
const DOING_HELP: &str = "write follow PLAN at 34:66, go-to X, Y, return, hold 5 s, wait 5 s, wander 5 s, \
    move-ahead 90 for 5 s, dock X, Y facing 90 from 3 m, signal 3 or set-output 2 on";

/// The smallest and the largest radius of a dock, metres.
const DOCK_M: [f64; 2] = [0.01, 500.0];

/// Reads what an action does; `path` is the key.
pub(super) fn doing(report: &mut Report<'_>, path: &str, text: &Text) -> Option<Doing> {
    let (verb, rest) = text.as_str().split_once(' ').unwrap_or((text.as_str(), ""));
    let rest = rest.trim();
    let mut numbers = Numbers::of(text);
    let found = match verb {
        "follow" if !rest.is_empty() => follow(&mut numbers, rest, text),
        "go-to" => pair(rest).map(Doing::GoTo),
        "hold" => seconds(&mut numbers, rest).map(|for_ms| Doing::Hold { for_ms }),
        "wait" => seconds(&mut numbers, rest).map(|for_ms| Doing::Wait { for_ms }),
        "wander" => seconds(&mut numbers, rest).map(|for_ms| Doing::Wander { for_ms }),
        "signal" => numbers.whole(rest, 1..=u16::MAX).map(|code| Doing::Signal { code }),
        "set-output" => set_output(&mut numbers, rest),
        "move-ahead" => move_ahead(&mut numbers, rest),
        "dock" => dock(&mut numbers, rest),
        "return" if rest.is_empty() => Some(Doing::Return),
        _ => None,
    };
    if found.is_none() {
        let label = match nearest(verb, VERBS.iter().copied()) {
            Some(meant) if meant != verb => format!("did you mean `{meant}`?"),
            Some(meant) => format!("not a form of `{meant}`"),
            None => "unknown action".into(),
        };
        report.error(
            format!("`{}` is not an action", text.as_str()),
            &text.span,
            &label,
            DOING_HELP,
        );
        return None;
    }
    found.filter(|_| numbers.report(report, path))
}

/// `PLAN at 34:66`: the weights of reactive schemas and of advice, in percent.
fn follow(numbers: &mut Numbers<'_>, rest: &str, text: &Text) -> Option<Doing> {
    let (plan, gains) = rest.rsplit_once(" at ").unwrap_or((rest, "34:66"));
    let (reactive, advice) = gains.split_once(':')?;
    let mut share = |part: &str| Some((numbers.number(part, 0.0..=100.0, "")? as f32) / 100.0);
    let plan = Spanned { value: plan.trim().to_owned(), span: text.span.clone() };
    Some(Doing::Follow { plan, reactive: share(reactive)?, advice: share(advice)? })
}

/// `5 s`, in milliseconds.
fn seconds(numbers: &mut Numbers<'_>, text: &str) -> Option<u32> {
    let seconds = numbers.number(text.strip_suffix('s')?, 0.0..=MAX_TIME_S, "s")?;
    Some((seconds * 1e3).round() as u32)
}

/// `90 for 5 s`
fn move_ahead(numbers: &mut Numbers<'_>, rest: &str) -> Option<Doing> {
    let (degrees, time) = rest.split_once(" for ")?;
    let direction_rad = direction(numbers, degrees)?;
    Some(Doing::MoveAhead { direction_rad, for_ms: seconds(numbers, time)? })
}

/// `X, Y facing 90 from 3 m`
fn dock(numbers: &mut Numbers<'_>, rest: &str) -> Option<Doing> {
    let (at, rest) = rest.split_once(" facing ")?;
    let (degrees, radius) = rest.split_once(" from ")?;
    let [low, high] = DOCK_M;
    let direction_rad = direction(numbers, degrees)?;
    let radius_m = numbers.number(radius.trim().strip_suffix('m')?, low..=high, "m")?;
    Some(Doing::Dock { at: pair(at)?, direction_rad, radius_cm: (radius_m * 1e2).round() as u16 })
}

/// A compass heading in degrees, clockwise from north, as radians counter-clockwise from east.
fn direction(numbers: &mut Numbers<'_>, degrees: &str) -> Option<f32> {
    let degrees = numbers.number(degrees, -360.0..=360.0, "degrees")?;
    Some((90.0 - degrees).to_radians() as f32)
}

/// `2 on`
fn set_output(numbers: &mut Numbers<'_>, rest: &str) -> Option<Doing> {
    let (output, state) = rest.split_once(' ')?;
    let is_on = match state.trim() {
        "on" => true,
        "off" => false,
        _ => return None,
    };
    let output = numbers.whole(output, 0..=(MAX_OUTPUTS - 1) as u16)?;
    Some(Doing::SetOutput { output: output as u8, is_on })
}
