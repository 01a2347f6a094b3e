//! Facts and input sources about team mates.

use crate::behaviours::syntax::FactSyntax;
use crate::behaviours::syntax::InputSource;
use crate::team::Team;
use crate::toml::{Fields, Report, Text};
use plan_format::mission::Mates;

const MATES_HELP: &str = "write the name of another robot of the team, \"all\" or \"any\"";

/// The mates that a fact names: one by its name, `all` or `any`.
fn mates(
    report: &mut Report<'_>,
    fields: &Fields<'_>,
    key: &str,
    team: &Team,
    missing: bool,
) -> Option<Mates> {
    let text = fields.text(report, key, "\"all\"")?;
    if !has_team(report, team, &text) {
        return None;
    }
    let robots = match text.as_str() {
        "all" | "any" => team.mate_bits(),
        _ => one(report, team, &text, MATES_HELP)?,
    };
    Some(Mates { robots, all: text.as_str() != "any", missing })
}

/// The bit of a mate that is named.
fn one(report: &mut Report<'_>, team: &Team, text: &Text, how: &str) -> Option<u8> {
    let number = team.number(text.as_str());
    match number {
        Some(number) if number == team.robot => {
            let message = format!("`{}` is the robot itself, not a mate", text.as_str());
            let help = "its mates may name it: write this in their parts, [robots.NAME.facts] or \
                        [robots.NAME.inputs]";
            report.error(message, &text.span, "this robot", help);
            return None;
        }
        Some(_) => {}
        None => report.unknown("mate", text, team.mates(), how),
    }
    number.map(|number| 1 << number)
}

fn has_team(report: &mut Report<'_>, team: &Team, text: &Text) -> bool {
    let has_team = !team.robots.is_empty();
    if !has_team {
        let message = format!("`{}` is a mate, but the mission has no team", text.as_str());
        let help = "add [team] with robots = [\"NAME\", \"NAME\"]";
        report.error(message, &text.span, "this mate", help);
    }
    has_team
}

/// `linked = MATES`.
pub(super) fn linked(
    report: &mut Report<'_>,
    fields: &Fields<'_>,
    team: &Team,
) -> Option<FactSyntax> {
    Some(FactSyntax::Linked(mates(report, fields, "linked", team, false)?))
}

/// `mate = MATES` with `within`, `near` and `within`, or `signals`.
pub(super) fn mate(
    report: &mut Report<'_>,
    fields: &Fields<'_>,
    team: &Team,
) -> Option<FactSyntax> {
    let missing = fields.flag(report, "missing").unwrap_or(false);
    let mates = mates(report, fields, "mate", team, missing);
    let has = |key: &str| fields.item(key).is_some();
    match (has("signals"), has("within")) {
        (true, false) => {
            let code = fields.number(report, "signals", 1.0..=65_535.0, "")?;
            if code.value.fract() != 0.0 {
                let path = format!("{}.signals", fields.path);
                report.out_of_range(&path, &code.span, "a whole number from 1 to 65535");
                return None;
            }
            Some(FactSyntax::MateSignals { mates: mates?, code: code.value as u16 })
        }
        (false, true) => {
            let radius_m = fields.number(report, "within", 0.01..=1e5, "m")?.value as f32;
            if !has("near") {
                return Some(FactSyntax::MateNear { mates: mates?, radius_m });
            }
            let (expected, example) = ("a place: two finite numbers", "near = [12.5, 40.0]");
            let at = fields.numbers(report, "near", expected, example)?;
            Some(FactSyntax::MateAt { mates: mates?, at, radius_m })
        }
        (both, _) => {
            let (label, help) = if both {
                ("two questions in one fact", "split it into two facts")
            } else {
                ("nothing is asked of this mate", "add within = 5, or signals = 1")
            };
            let message = format!("`{}` needs either `within` or `signals`", fields.path);
            report.error(message, &fields.span, label, help);
            None
        }
    }
}

/// `mate-distance NAME` or `mate-distance nearest`.
pub(super) fn distance(report: &mut Report<'_>, team: &Team, name: &Text) -> Option<InputSource> {
    if !has_team(report, team, name) {
        return None;
    }
    let robots = match name.as_str() {
        "nearest" => team.mate_bits(),
        _ => one(report, team, name, "write the name of another robot of the team, or nearest")?,
    };
    Some(InputSource::MateDistance(robots))
}

/// `mate-link NAME`.
pub(super) fn link(report: &mut Report<'_>, team: &Team, name: &Text) -> Option<InputSource> {
    if !has_team(report, team, name) {
        return None;
    }
    let robots = one(report, team, name, "write the name of another robot of the team")?;
    Some(InputSource::MateLink(robots.trailing_zeros() as u8))
}
