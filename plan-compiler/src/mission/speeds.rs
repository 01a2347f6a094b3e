//! The speeds of a vehicle must agree with each other: a robot whose cautious speed is above its
//! base speed would drive faster near obstacles than in the open.
//!
//! A speed that the file leaves out follows those that it gives: see `follow`. Two that are given,
//! and one that is given against a default that cannot follow it, must not contradict each other.

use crate::toml::{Report, number};
use maps::Problem;
use plan_format::parameters::{Steering, Vehicle};
use std::ops::Range;
use toml_edit::{Item, TableLike};

/// Reports speeds that contradict each other.
pub(super) fn check(report: &mut Report<'_>, root: &dyn TableLike, vehicle: &Vehicle) {
    let Some(table) = root.get("vehicle").and_then(Item::as_table_like) else { return };
    let given = |key: &str| {
        let item = table.get(key)?;
        number(item.as_value()?)?;
        Some(item.span().unwrap_or(0..0))
    };
    let [cautious, base, max] = ["cautious_speed", "base_speed", "max_speed"].map(given);
    let mut error = |message: String, at: Option<Range<usize>>, help: String| {
        let problem = Problem::error(message).help(help);
        report.problems.push(match at {
            Some(span) => problem.at(report.source, span, "this speed"),
            None => problem,
        });
    };
    for (name, speed, at) in
        [("max_speed", vehicle.max_speed_mps, &max), ("base_speed", vehicle.base_speed_mps, &base)]
    {
        // A derived speed is not reported beside the speed that it derives from.
        if speed == 0.0 && at.is_some() {
            let help = format!("write a speed above 0 m/s, for example {name} = 0.5");
            error(format!("`vehicle.{name}` is 0: the robot would never move"), at.clone(), help);
        }
    }
    for [lower, upper] in [
        [("base_speed", vehicle.base_speed_mps, &base), ("max_speed", vehicle.max_speed_mps, &max)],
        [
            ("cautious_speed", vehicle.cautious_speed_mps, &cautious),
            ("base_speed", vehicle.base_speed_mps, &base),
        ],
    ] {
        if lower.1 > upper.1 && upper.1 > 0.0 {
            let [low, high] = [lower, upper].map(|(name, speed, at)| with_origin(name, speed, at));
            let message = format!("{low} is above {high}");
            let help = format!("`{}` may be at most `{}`", lower.0, upper.0);
            error(message, lower.2.clone().or_else(|| upper.2.clone()), help);
        }
    }
    turning(report, table, vehicle);
}

/// A speed and whether it is a default.
fn with_origin(name: &str, speed: f32, at: &Option<Range<usize>>) -> String {
    let whose = if at.is_some() { "" } else { ", the default" };
    format!("`vehicle.{name}` ({speed} m/s{whose})")
}

/// Warns about turning limits that do not fit the steering.
fn turning(report: &mut Report<'_>, table: &dyn TableLike, vehicle: &Vehicle) {
    let radius = table.get("min_turn_radius");
    let place = |item: Option<&Item>| item.and_then(Item::span);
    let is_car = vehicle.steering == Steering::Ackermann;
    let problem = if is_car && vehicle.min_turn_radius_m == 0.0 {
        let message = "an Ackermann vehicle with a `min_turn_radius` of 0 turns on the spot";
        let problem = Problem::warning(message)
            .help("give its smallest turning circle: min_turn_radius = 1.5");
        place(radius.or(table.get("steering"))).map(|span| (problem, span))
    } else if !is_car && vehicle.min_turn_radius_m > 0.0 {
        let message = "`vehicle.min_turn_radius` has no effect: the steering is not \"ackermann\"";
        let problem = Problem::warning(message)
            .help("write steering = \"ackermann\", or leave min_turn_radius out");
        place(radius).map(|span| (problem, span))
    } else {
        None
    };
    let problem = problem.map(|(problem, span)| problem.at(report.source, span, "given here"));
    report.problems.extend(problem);
}

#[cfg(test)]
mod tests {
    use crate::mission::{Mission, parse};
    use maps::problem::{Severity, Source};
    use std::sync::Arc;

    fn read(vehicle: &str) -> (Mission, Vec<String>) {
        let text = format!("[vehicle]\n{vehicle}\n");
        let source = Arc::new(Source { name: "m.mission.toml".into(), text });
        let (mission, problems) = parse(&source);
        let said = problems.iter().map(|problem| {
            let mark = if problem.severity == Severity::Error { "error" } else { "warning" };
            assert!(problem.help.is_some() && problem.place.is_some(), "{problem:?}");
            format!("{mark}: {problem}")
        });
        (mission, said.collect())
    }

    #[test]
    fn speeds_that_are_left_out_follow_those_given() {
        for (vehicle, speeds) in [
            ("max_speed = 0.5", [0.3, 0.5, 0.5]),
            ("max_speed = 0.2", [0.2, 0.2, 0.2]),
            ("max_speed = 3", [0.3, 3.0, 3.0]),
            ("base_speed = 0.1", [0.1, 0.1, 1.6]),
            ("cautious_speed = 1.4", [1.4, 1.6, 1.6]),
            ("cautious_speed = 0", [0.0, 1.6, 1.6]),
        ] {
            let (mission, problems) = read(vehicle);
            assert_eq!(problems, [""; 0], "{vehicle}");
            let of = mission.parameters.vehicle;
            assert_eq!([of.cautious_speed_mps, of.base_speed_mps, of.max_speed_mps], speeds);
        }
    }

    #[test]
    fn speeds_that_contradict_each_other_are_errors() {
        for (vehicle, expected) in [
            (
                "base_speed = 2\nmax_speed = 1",
                &["error: `vehicle.base_speed` (2 m/s) is above `vehicle.max_speed` (1 m/s)"][..],
            ),
            (
                "base_speed = 2",
                &[
                    "error: `vehicle.base_speed` (2 m/s) is above `vehicle.max_speed` (1.6 m/s, the default)",
                ],
            ),
            (
                "cautious_speed = 1\nbase_speed = 0.5",
                &[
                    "error: `vehicle.cautious_speed` (1 m/s) is above `vehicle.base_speed` (0.5 m/s)",
                ],
            ),
            (
                "cautious_speed = 3\nbase_speed = 2\nmax_speed = 1",
                &[
                    "error: `vehicle.base_speed` (2 m/s) is above `vehicle.max_speed` (1 m/s)",
                    "error: `vehicle.cautious_speed` (3 m/s) is above `vehicle.base_speed` (2 m/s)",
                ],
            ),
            ("max_speed = 0", &["error: `vehicle.max_speed` is 0: the robot would never move"]),
            ("base_speed = 0", &["error: `vehicle.base_speed` is 0: the robot would never move"]),
            ("max_speed = -1", &["error: `vehicle.max_speed` is out of range"]),
            ("max_turn_rate = 0", &["error: `vehicle.max_turn_rate` is out of range"]),
            ("max_turn_rate = -0.5", &["error: `vehicle.max_turn_rate` is out of range"]),
            (
                "min_turn_radius = 2",
                &[
                    "warning: `vehicle.min_turn_radius` has no effect: the steering is not \"ackermann\"",
                ],
            ),
            (
                "steering = \"ackermann\"",
                &["warning: an Ackermann vehicle with a `min_turn_radius` of 0 turns on the spot"],
            ),
        ] {
            assert_eq!(read(vehicle).1, expected, "{vehicle}");
        }
    }
}
