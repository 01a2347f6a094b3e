//! Speeds, brakes and distances must agree: a robot that cannot stop within what it sees, or whose
//! fixes are refused at its own speed, would not do what its mission says.

use super::Given;
use maps::numbers::metres;
use maps::problem::Problem;
use math::scalar::wide;
use plan_format::Parameters;
use plan_format::parameters::Vehicle;

/// The highest speed from which a vehicle stops within a distance, m/s.
fn speed_within(vehicle: &Vehicle, distance_m: f64) -> f64 {
    let braking = f64::from(vehicle.braking_mps2);
    let latency_s = f64::from(vehicle.latency_us) / 1e6;
    let root = wide::sqrt(latency_s * latency_s + 2.0 * distance_m.max(0.0) / braking);
    braking * (root - latency_s)
}

/// Contradictions between a robot's speed, its brakes, its sensors and its distances.
pub(crate) fn check(parameters: &Parameters, given: &Given) -> Vec<Problem> {
    let checks = [
        below_two_ticks,
        beyond_reach,
        faster_than_fixes,
        margin_in_stop_distance,
        sphere_in_stopping_distance,
    ];
    checks.iter().filter_map(|check| check(parameters, given)).collect()
}

/// The problem at the first of these keys that the file sets.
fn at(problem: Problem, given: &Given, keys: &[&str]) -> Problem {
    match keys.iter().find_map(|key| given.place(key)) {
        Some(place) => problem.at(&place.source, place.span.clone(), "given here"),
        None => problem,
    }
}

/// `key (value unit)`, and whether it is a default.
fn named(key: &str, value: f32, unit: &str, given: &Given) -> String {
    let whose = if given.has(key) { "" } else { ", the default" };
    format!("`{key}` ({value} {unit}{whose})")
}

/// The control loop alone takes two ticks.
fn below_two_ticks(parameters: &Parameters, given: &Given) -> Option<Problem> {
    let vehicle = &parameters.vehicle;
    if vehicle.latency_us >= Vehicle::LEAST_LATENCY_US {
        return None;
    }
    let key = "vehicle.latency";
    let least = metres(f64::from(Vehicle::LEAST_LATENCY_US) / 1e6);
    let message = format!(
        "{} is below the {least} s that two ticks take: the robot counts with {least} s",
        named(key, vehicle.latency_us as f32 / 1e6, "s", given)
    );
    let help = format!("measure from the reading to the effect of the brakes, or write {least}");
    Some(at(Problem::warning(message).help(help), given, &[key]))
}

/// The robot must see an obstacle before it is too late to stop.
fn beyond_reach(parameters: &Parameters, given: &Given) -> Option<Problem> {
    let vehicle = &parameters.vehicle.with_least_latency();
    let room = [vehicle.reach_m, -vehicle.radius_m, -vehicle.stop_distance_m].map(f64::from);
    let room_m: f64 = room.iter().sum();
    let needed_m = f64::from(vehicle.stopping_distance_m(vehicle.max_speed_mps));
    if needed_m <= room_m + 1e-3 {
        return None;
    }
    let reach = named("vehicle.reach", vehicle.reach_m, "m", given);
    let max = named("vehicle.max_speed", vehicle.max_speed_mps, "m/s", given);
    let message = format!(
        "the robot needs {} m to stop from {max}, but sees only {} m ahead of its stop distance: \
         {reach} less the body and the stop distance",
        metres((needed_m * 100.0).ceil() / 100.0),
        metres((room_m * 100.0).floor().max(0.0) / 100.0),
    );
    let fitting = wide::floor(speed_within(vehicle, room_m) * 100.0) / 100.0;
    let help = if fitting > 0.0 {
        format!(
            "max_speed may be {} at most, or give what the robot has: `vehicle.reach` in m, \
             `vehicle.braking` in m/s^2, `vehicle.latency` in s",
            metres(fitting)
        )
    } else {
        "the sensors must see farther than the body and the stop distance: `vehicle.reach`".into()
    };
    let keys = ["max_speed", "reach", "braking", "latency", "stop_distance", "radius"];
    let keys = keys.map(|key| format!("vehicle.{key}"));
    Some(at(Problem::error(message).help(help), given, &keys.each_ref().map(String::as_str)))
}

/// A robot that drives faster than `max_jump` would refuse its own fixes.
fn faster_than_fixes(parameters: &Parameters, given: &Given) -> Option<Problem> {
    let (max, jump) = (parameters.vehicle.max_speed_mps, parameters.fixes.max_jump_mps);
    if max <= jump {
        return None;
    }
    let max_named = named("vehicle.max_speed", max, "m/s", given);
    let jump_named = named("fixes.max_jump", jump, "m/s", given);
    let message =
        format!("{max_named} is above {jump_named}: the robot would refuse its own fixes");
    let help = format!("max_jump must be above {max}, and by more than fixes scatter in a second");
    Some(at(Problem::error(message).help(help), given, &["fixes.max_jump", "vehicle.max_speed"]))
}

/// Inside the stop distance the robot does not move towards an obstacle, so a smaller margin would
/// leave it standing before an obstacle that its schemas do not repel it from.
fn margin_in_stop_distance(parameters: &Parameters, given: &Given) -> Option<Problem> {
    let (margin, stop) = (parameters.schemas.avoid_margin_m, parameters.vehicle.stop_distance_m);
    if margin >= stop {
        return None;
    }
    let keys = ["schemas.avoid_margin", "vehicle.stop_distance"];
    let margin_named = named(keys[0], margin, "m", given);
    let stop_named = named(keys[1], stop, "m", given);
    let message = format!(
        "{margin_named} is below {stop_named}: the robot stands before obstacles instead of \
         avoiding them"
    );
    let help = "`avoid_margin` must be at least `stop_distance`; leave either out, and it follows \
                from the other";
    Some(at(Problem::error(message).help(help), given, &keys))
}

/// Obstacles should repel before the brakes have to act.
fn sphere_in_stopping_distance(parameters: &Parameters, given: &Given) -> Option<Problem> {
    let key = "schemas.avoid_sphere";
    let (vehicle, schemas) = (parameters.vehicle.with_least_latency(), &parameters.schemas);
    let stopping_m = f64::from(vehicle.stopping_distance_m(vehicle.max_speed_mps));
    // From the body. The sphere begins at the margin.
    let brakes_m = stopping_m + f64::from(vehicle.stop_distance_m);
    let margin_m = f64::from(schemas.avoid_margin_m);
    let repels_m = margin_m + f64::from(schemas.avoid_sphere_m);
    if !given.has(key) || repels_m + 1e-3 >= brakes_m {
        return None;
    }
    let up = |m: f64| metres((m * 100.0 - 0.01).ceil() / 100.0);
    let message = format!(
        "with {}, obstacles repel up to {} m from the body, but the robot brakes for them from {} m \
         on at {} m/s: it brakes before they repel it",
        named(key, schemas.avoid_sphere_m, "m", given),
        metres((repels_m * 100.0 + 0.01).floor() / 100.0),
        up(brakes_m),
        vehicle.max_speed_mps
    );
    let least = up(brakes_m - margin_m);
    let help = format!("leave avoid_sphere out, or make it at least {least}");
    Some(at(Problem::warning(message).help(help), given, &[key]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::tests::read as parse;

    /// The contradictions in a mission file, as text; their help.
    fn read(file: &str) -> (Vec<String>, Vec<String>) {
        let (mission, problems) = parse(file);
        assert_eq!(problems, [""; 0], "{file}");
        let found = check(&mission.parameters, mission.given.as_ref().unwrap());
        found.iter().for_each(|problem| assert!(problem.place.is_some(), "{problem}"));
        let help = found.iter().map(|problem| problem.help.clone().unwrap()).collect();
        (found.iter().map(ToString::to_string).collect(), help)
    }

    #[test]
    fn a_speed_and_its_stopping_distance_are_inverse() {
        let mut vehicle = Parameters::default().vehicle;
        for (braking, latency_us) in [(2.0, 100_000), (0.5, 200_000), (9.0, 1_000_000)] {
            (vehicle.braking_mps2, vehicle.latency_us) = (braking, latency_us);
            for speed in [0.0, 0.1, 1.6, 20.0] {
                let back = speed_within(&vehicle, vehicle.stopping_distance_m(speed).into());
                assert!((back - f64::from(speed)).abs() < 1e-5, "{back} {speed}");
            }
        }
        assert_eq!(speed_within(&vehicle, -1.0), 0.0);
    }

    #[test]
    fn the_speed_that_is_offered_fits() {
        for rest in ["", "braking = 0.3\n", "latency = 1.5\nradius = 2\n", "reach = 3\n"] {
            let (_, help) = read(&format!("[vehicle]\nmax_speed = 14.5\n{rest}"));
            let [help] = &help[..] else { panic!("{help:?}") };
            let speed = help.split(' ').nth(3).unwrap();
            let with = |speed: f64| read(&format!("[vehicle]\nmax_speed = {speed}\n{rest}")).1;
            let speed: f64 = speed.parse().unwrap_or_else(|_| panic!("{help}"));
            assert_eq!(with(speed), [""; 0], "{rest}");
            assert_eq!(with(speed + 0.02).len(), 1, "{rest}");
        }
        let (problems, _) = read("[vehicle]\nreach = 0.3\n");
        assert!(problems[0].contains("sees only 0 m"), "{problems:?}");
    }

    #[test]
    fn contradictions_are_reported() {
        for (file, expected) in [
            (
                "[vehicle]\nmax_speed = 5\n[fixes]\nmax_jump = 4\n",
                "`vehicle.max_speed` (5 m/s) is above `fixes.max_jump` (4 m/s): the robot would \
                 refuse its own fixes",
            ),
            (
                "[vehicle]\nstop_distance = 0.4\n[schemas]\navoid_margin = 0.3\n",
                "`schemas.avoid_margin` (0.3 m) is below `vehicle.stop_distance` (0.4 m): the \
                 robot stands before obstacles instead of avoiding them",
            ),
            (
                "[vehicle]\nmax_speed = 2\n[schemas]\navoid_sphere = 1.1\n",
                "with `schemas.avoid_sphere` (1.1 m), obstacles repel up to 1.12 m from the body, \
                 but the robot brakes for them from 1.22 m on at 2 m/s: it brakes before they repel it",
            ),
            ("[schemas]\navoid_margin = 2\navoid_sphere = 0.5\n", ""),
            (
                "[vehicle]\nlatency = 0.05\n",
                "`vehicle.latency` (0.05 s) is below the 0.1 s that two ticks take: the robot counts \
                 with 0.1 s",
            ),
            ("[vehicle]\nlatency = 0.1\n", ""),
            ("[vehicle]\nmax_speed = 2\n[schemas]\navoid_sphere = 1.2\n", ""),
            ("[vehicle]\nstop_distance = 0.4\n[schemas]\navoid_margin = 0.4\n", ""),
        ] {
            let (problems, _) = read(file);
            assert_eq!(problems.join("\n"), expected, "{file}");
        }
    }
}
