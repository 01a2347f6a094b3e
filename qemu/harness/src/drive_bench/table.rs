//! The benchmark's numbers as a table and as JSON.

use super::{Campaign, Row, Run, Setting, rows};
use crate::shards::{self, Part};
use math::scalar::wide;
use std::fmt::Write as _;

/// The numbers of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbers {
    /// Runs with a route.
    pub runs: usize,
    /// Courses without a route in the plan; they are not driven.
    pub without_route: usize,
    /// Share of runs that arrived without contact.
    pub success: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
    /// Share of runs with a contact.
    pub contacts: f64,
    /// Share of runs in which a disc ran into the robot.
    pub strikes: f64,
    /// Mean time of the successful runs, seconds.
    pub time_s: f64,
    /// Mean of time over the time of the shortest path at top speed, over the successful runs.
    pub stretch: f64,
    /// Mean turn per metre of the successful runs, rad/m.
    pub turn_per_m: f64,
    /// Smallest gap to an obstacle in any run, metres; infinite if none came near.
    pub closest_m: f64,
    /// Mean score of the BARN challenge.
    pub score: f64,
}

impl Numbers {
    /// The numbers of these runs.
    pub fn of(runs: &[&Run]) -> Self {
        let driven: Vec<&&Run> = runs.iter().filter(|run| run.has_route).collect();
        let count = |is: &dyn Fn(&Run) -> bool| driven.iter().filter(|run| is(run)).count();
        let successes: Vec<&&&Run> = driven.iter().filter(|run| run.is_success()).collect();
        let mean = |value: &dyn Fn(&Run) -> f64| {
            let sum: f64 = successes.iter().map(|run| value(run)).sum();
            sum / successes.len() as f64
        };
        let share = |part: usize| part as f64 / driven.len() as f64;
        let score: f64 = driven.iter().map(|run| run.score()).sum();
        Self {
            runs: driven.len(),
            without_route: runs.len() - driven.len(),
            success: share(successes.len()),
            interval: wilson(successes.len(), driven.len()),
            contacts: share(count(&|run| run.contacts > 0)),
            strikes: share(count(&|run| run.strikes > 0)),
            time_s: mean(&|run| run.time_s),
            stretch: mean(&|run| run.time_s / run.optimal_s),
            turn_per_m: mean(&|run| run.turn_rad / run.distance_m),
            closest_m: driven.iter().filter_map(|run| run.closest_m).fold(f64::INFINITY, f64::min),
            score: score / driven.len() as f64,
        }
    }
}

/// The 95 % interval of a share (Wilson 1927), which holds for shares of 0 and 1 too.
pub fn wilson(part: usize, whole: usize) -> [f64; 2] {
    const Z: f64 = 1.959_964;
    if whole == 0 {
        return [0.0, 1.0];
    }
    let (n, p) = (whole as f64, part as f64 / whole as f64);
    let middle = p + Z * Z / (2.0 * n);
    let half = Z * wide::sqrt(p * (1.0 - p) / n + Z * Z / (4.0 * n * n));
    let scale = 1.0 + Z * Z / n;
    [((middle - half) / scale).max(0.0), ((middle + half) / scale).min(1.0)]
}

/// What a row differs in, for people.
pub fn name(setting: &Setting) -> String {
    let mut name = match setting.unmapped_percent {
        0 => "mapped".to_owned(),
        100 => "unmapped".to_owned(),
        percent => format!("{percent} % unmapped"),
    };
    if setting.has_discs {
        name += ", discs";
    }
    if setting.has_usual_sensors {
        name += ", usual sensors";
    }
    name
}

/// The rows of the runs, in order, each with its runs.
fn grouped(runs: &[Run]) -> Vec<(Row, Vec<&Run>)> {
    let of = |number: usize| runs.iter().filter(|run| run.row == number).collect::<Vec<_>>();
    let all = rows().into_iter().enumerate().map(|(number, row)| (row, of(number)));
    all.filter(|(_, runs)| !runs.is_empty()).collect()
}

/// The table for people, with the row of ROS's DWA on the challenge's worlds.
pub fn text(runs: &[Run]) -> String {
    let mut text = String::from(
        "suite       setting                 vehicle       runs  success (95 %)      contacts  \
         struck  time s  x shortest  turn/m  closest m  score\n",
    );
    for (row, runs) in grouped(runs) {
        let numbers = Numbers::of(&runs);
        let [low, high] = numbers.interval;
        // A row may have no success, and no obstacle near.
        let or_dash = |number: f64, decimals: usize| match number.is_finite() {
            true => format!("{number:.decimals$}"),
            false => "-".to_owned(),
        };
        let closest = or_dash(numbers.closest_m, 3);
        let (time_s, stretch) = (or_dash(numbers.time_s, 1), or_dash(numbers.stretch, 2));
        let turn_per_m = or_dash(numbers.turn_per_m, 2);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{:<10}  {:<22}  {:<12}  {:>4}  {:.3} ({:.3}-{:.3})  {:>8.3}  {:>6.3}  {time_s:>6}  \
             {stretch:>10}  {turn_per_m:>6}  {closest:>9}  {:.3}",
            row.suite.name(),
            name(&row.setting),
            row.setting.vehicle.name(),
            numbers.runs,
            numbers.success,
            low,
            high,
            numbers.contacts,
            numbers.strikes,
            numbers.score,
        );
        if numbers.without_route > 0 {
            let _ = writeln!(text, "            {} more without a route", numbers.without_route);
        }
    }
    text + "For comparison, 500 runs of ROS's DWA on the challenge's worlds without a map: success \
            0.850, contacts 0.056, time 33.1 s, score 0.159.\n"
}

/// The object of `--json`. Programs rely on its names; `--merge` reads its campaign and its runs.
pub fn json(campaign: &Campaign, runs: &[Run]) -> String {
    let rows = grouped(runs).into_iter().map(|(row, runs)| {
        let numbers = Numbers::of(&runs);
        serde_json::json!({
            "suite": row.suite,
            "unmapped_percent": row.setting.unmapped_percent,
            "discs": row.setting.has_discs,
            "usual_sensors": row.setting.has_usual_sensors,
            "vehicle": row.setting.vehicle,
            "runs": numbers.runs,
            "without_route": numbers.without_route,
            "success": numbers.success,
            "success_interval": numbers.interval,
            "contacts": numbers.contacts,
            "struck": numbers.strikes,
            "time_s": numbers.time_s,
            "stretch": numbers.stretch,
            "turn_per_m": numbers.turn_per_m,
            "closest_m": numbers.closest_m.is_finite().then_some(numbers.closest_m),
            "score": numbers.score,
        })
    });
    let rows: Vec<serde_json::Value> = rows.collect();
    serde_json::json!({ "campaign": campaign, "rows": rows, "runs": runs }).to_string() + "\n"
}

/// The campaign and the runs of an object that [`json`] wrote; `None` if it is not one.
pub fn read(text: &str) -> Option<(Campaign, Vec<Run>)> {
    let mut object: serde_json::Value = serde_json::from_str(text).ok()?;
    let campaign = serde_json::from_value(object.get_mut("campaign")?.take()).ok()?;
    Some((campaign, serde_json::from_value(object.get_mut("runs")?.take()).ok()?))
}

/// Puts the runs of several files together, each with its name. The error is a message for the user:
/// files of different campaigns, a run that is in two files, or one that is in none.
pub fn merge(files: Vec<Part<Campaign, Run>>) -> Result<(Campaign, Vec<Run>), String> {
    let (campaign, merged) = shards::merge(
        files,
        |campaign| format!("{campaign:?}"),
        |run| run.number,
        |run| format!("run {} ({}) is in two files", run.number, run.course),
    )?;
    let absent = (0..).zip(&merged).find(|(number, run)| run.number != *number);
    if merged.len() < campaign.runs {
        return Err(format!(
            "{} of {} runs are in none of the files, the first of them run {}: add the file of its \
             shard",
            campaign.runs - merged.len(),
            campaign.runs,
            absent.map_or(merged.len(), |(number, _)| number),
        ));
    }
    Ok((campaign, merged))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(number: usize, is_reached: bool, contacts: u32, time_s: f64) -> Run {
        Run {
            number,
            row: 0,
            course: format!("course {number}"),
            has_route: number != 9,
            is_reached,
            contacts,
            strikes: contacts / 2,
            time_s,
            optimal_s: 5.0,
            distance_m: 10.0,
            turn_rad: 4.0,
            closest_m: Some(0.1 + number as f64),
            trace_hash: u64::MAX,
        }
    }

    fn campaign() -> Campaign {
        let (suites, only) = (vec![crate::drive_bench::Suite::Doors], String::new());
        Campaign { suites, only, count: 4, seed: 1, has_challenge: false, runs: 4 }
    }

    #[test]
    fn files_that_are_put_together_are_one_run_to_the_last_byte() {
        // 13.55 is another number.
        let runs: Vec<Run> =
            (0..4).map(|number| run(number, true, 0, 13.549999999999999)).collect();
        let whole = json(&campaign(), &runs);
        let part = |numbers: &[usize]| {
            let runs: Vec<Run> = numbers.iter().map(|&number| runs[number].clone()).collect();
            let (campaign, runs) = read(&json(&campaign(), &runs)).expect("it was written");
            (format!("{numbers:?}"), campaign, runs)
        };
        let merged = merge(vec![part(&[1, 3]), part(&[0, 2])]).expect("they fit");
        assert_eq!(json(&merged.0, &merged.1), whole);
        let mistake = |files| merge(files).expect_err("they do not fit");
        assert!(mistake(vec![part(&[0, 2])]).contains("2 of 4 runs are in none"));
        assert!(mistake(vec![part(&[0, 1, 2])]).contains("the first of them run 3"));
        assert!(mistake(vec![part(&[0, 1]), part(&[1, 2])]).contains("run 1 (course 1) is in two"));
        let other = Campaign { seed: 2, ..campaign() };
        let other = ("other".to_owned(), other, part(&[1, 3]).2);
        assert!(mistake(vec![part(&[0, 2]), other]).contains("are of different campaigns"));
    }

    #[test]
    fn the_score_is_that_of_the_challenge() {
        for (is_reached, contacts, time_s, score) in [
            (true, 0, 5.0, 0.5),
            (true, 0, 10.0, 0.5),
            (true, 0, 20.0, 0.25),
            (true, 0, 100.0, 0.125),
            (true, 1, 10.0, 0.0),
            (false, 0, 10.0, 0.0),
        ] {
            assert_eq!(run(0, is_reached, contacts, time_s).score(), score, "{time_s}");
        }
    }

    #[test]
    fn a_row_counts_what_was_driven() {
        let runs = [
            run(0, true, 0, 10.0),
            run(1, true, 2, 8.0),
            run(2, false, 0, 99.0),
            run(9, false, 0, 0.0),
        ];
        let numbers = Numbers::of(&runs.iter().collect::<Vec<_>>());
        assert_eq!((numbers.runs, numbers.without_route), (3, 1));
        assert!((numbers.success - 1.0 / 3.0).abs() < 1e-12);
        assert!((numbers.contacts - 1.0 / 3.0).abs() < 1e-12);
        assert!((numbers.strikes - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!((numbers.time_s, numbers.stretch, numbers.turn_per_m), (10.0, 2.0, 0.4));
        assert_eq!(numbers.closest_m, 0.1);
        assert!((numbers.score - 0.5 / 3.0).abs() < 1e-12);
        assert_eq!(read(&json(&campaign(), &runs)), Some((campaign(), runs.to_vec())));
    }

    /// Values of the published formula.
    #[test]
    fn the_interval_is_wilsons() {
        for (part, whole, expected) in
            [(50, 50, [0.9287, 1.0]), (0, 50, [0.0, 0.0713]), (5, 10, [0.2366, 0.7634])]
        {
            let interval = wilson(part, whole);
            for (bound, wanted) in interval.iter().zip(expected) {
                assert!((bound - wanted).abs() < 1e-4, "{part} of {whole}: {interval:?}");
            }
        }
    }
}
