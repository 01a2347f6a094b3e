//! The trials as a table beside the paper's, as JSON, and as raw numbers.

use std::fmt::Write as _;

use super::findings::{Finding, Rows, findings};
use super::metric::{COMPARED, Metric};
use super::statistics::{Difference, Summary, median};
use super::{Row, Trial};
use crate::shards::{self, Part};

/// Trials of a row in one of the paper's experiments (W, section 4).
pub const REPLICATE: usize = 30;

/// Metrics that the paper's table has, in the order of [`COMPARED`].
const TESTED: [Metric; 4] = [Metric::Time, Metric::Distance, Metric::Connected, Metric::OneNetwork];

/// The rows that have trials.
fn present(trials: &[Trial]) -> Vec<Row> {
    Row::ALL.into_iter().filter(|row| trials.iter().any(|trial| trial.row == *row)).collect()
}

/// The table for people.
pub fn text(trials: &[Trial]) -> String {
    let mut text = means(trials);
    text += &tests(trials);
    text += "\nFindings of the paper, by the means:\n";
    for Finding { text: claim, holds } in findings(trials) {
        let _ = writeln!(text, "  {}  {claim}", if holds { "yes" } else { " NO" });
    }
    for row in present(trials) {
        let stuck: Vec<String> = trials
            .iter()
            .filter(|trial| trial.row == row && trial.unfinished > 0)
            .map(|trial| format!("{} ({} robots)", trial.number, trial.unfinished))
            .collect();
        if !stuck.is_empty() {
            let list = stuck.join(", ");
            let _ = writeln!(text, "Unfinished trials of {}: {list}", row.name());
        }
    }
    text
}

/// Means and standard deviations, the paper's below ours.
fn means(trials: &[Trial]) -> String {
    let mut text = format!("{:10}", "");
    for metric in Metric::ALL {
        let _ = write!(text, "{:>18}", metric.heading());
    }
    text += "\n";
    for row in present(trials) {
        let _ = write!(text, "{:10}", row.name());
        let rows = Rows(trials);
        for metric in Metric::ALL {
            let summary = rows.summary(row, metric).map(|Summary { mean, sd, .. }| (mean, sd));
            let scaled = summary.map(|(mean, sd)| (mean * metric.scale(), sd * metric.scale()));
            let _ = write!(text, "{:>18}", cell(scaled));
        }
        let _ = write!(text, "\n{:>10}", "paper ");
        for metric in Metric::ALL {
            let _ = write!(text, "{:>18}", cell(metric.in_paper(row)));
        }
        text += "\n";
    }
    text + "The paper's times are steps of unknown length; its table has no areas.\n"
}

/// The means alone, and how many trials did not finish.
pub fn short(trials: &[Trial]) -> String {
    let rows = Rows(trials);
    let mut text = format!("{:10}", "");
    for metric in Metric::ALL {
        let _ = write!(text, "{:>16}", metric.heading());
    }
    text += "  unfinished\n";
    for row in present(trials) {
        let _ = write!(text, "{:10}", row.name());
        for metric in Metric::ALL {
            let mean = rows.summary(row, metric).map_or(f64::NAN, |summary| summary.mean);
            let _ = write!(text, "{:>16.1}", mean * metric.scale());
        }
        let of_row = trials.iter().filter(|trial| trial.row == row);
        let unfinished = of_row.clone().filter(|trial| trial.unfinished > 0).count();
        let _ = writeln!(text, "{:>6} of {}", unfinished, of_row.count());
    }
    text
}

fn cell(summary: Option<(f64, f64)>) -> String {
    summary.map_or_else(|| "-".to_owned(), |(mean, sd)| format!("{mean:.1} ({sd:.1})"))
}

/// Welch's tests of the pairs that the paper compares: of every replicate of 30 trials, the median
/// p-value and the number below 0.05, and the paper's p-value.
fn tests(trials: &[Trial]) -> String {
    let rows = Rows(trials);
    let mut text = String::new();
    for (a, b, paper) in COMPARED {
        for (metric, paper) in TESTED.into_iter().zip(paper) {
            let (left, right) = (rows.values(a, metric), rows.values(b, metric));
            let replicates = left.chunks_exact(REPLICATE).zip(right.chunks_exact(REPLICATE));
            let ps: Vec<f64> = replicates
                .map(|(a, b)| Difference::of(&Summary::of(a), &Summary::of(b)).p())
                .collect();
            if ps.is_empty() {
                continue;
            }
            let below = ps.iter().filter(|p| **p < 0.05).count();
            let _ = writeln!(
                text,
                "  {:8} {:8} {:14} {:>8}   {below:>3} of {:<3} {paper:>8.2}",
                a.name(),
                b.name(),
                metric.name(),
                p_value(median(&ps)),
                ps.len(),
            );
        }
    }
    if text.is_empty() {
        return text;
    }
    let head = "\nWelch's two-sided t-tests, 30 trials a row:\n  rows              metric         \
                median p   p < .05    paper's p\n";
    format!("{head}{text}")
}

fn p_value(p: f64) -> String {
    if p < 1e-3 { format!("{p:.0e}") } else { format!("{p:.3}") }
}

/// The object of `--json`, which programs rely on: a list of numbers a row, one for each trial.
pub fn json(trials: &[Trial]) -> String {
    let rows = Rows(trials);
    let objects = present(trials).into_iter().map(|row| {
        let unfinished = trials.iter().filter(|t| t.row == row && t.unfinished > 0);
        let robots = trials.iter().filter(|trial| trial.row == row);
        let robots: Vec<u32> = robots.map(|trial| trial.unfinished).collect();
        serde_json::json!({
            "name": row.name(),
            "time_s": rows.values(row, Metric::Time),
            "distance_m": rows.values(row, Metric::Distance),
            "connected_s": rows.values(row, Metric::Connected),
            "one_network": rows.values(row, Metric::OneNetwork),
            "connectivity": rows.values(row, Metric::Connectivity),
            "coverage_m2": rows.values(row, Metric::Coverage),
            "coverage_disc_m2": rows.values(row, Metric::CoverageDisc),
            "unfinished": unfinished.count(),
            "unfinished_robots": robots,
        })
    });
    let objects: Vec<serde_json::Value> = objects.collect();
    format!("{}\n", serde_json::json!({ "rows": objects }))
}

/// The raw trials, a line each, after a line that describes the campaign. Numbers are written so
/// that reading them gives the same bits.
pub fn csv(campaign: &str, trials: &[Trial]) -> String {
    let mut text = format!("# {campaign}\nrow,trial");
    Metric::ALL.iter().for_each(|metric| text = format!("{text},{}", metric.name()));
    text += ",unfinished\n";
    for trial in trials {
        let _ = write!(text, "{},{}", trial.row.name(), trial.number);
        for metric in Metric::ALL {
            let _ = write!(text, ",{}", metric.of(trial));
        }
        let _ = writeln!(text, ",{}", trial.unfinished);
    }
    text
}

/// Reads what [`csv`] wrote: the campaign and its trials. The error names the line.
pub fn read_csv(text: &str) -> Result<(String, Vec<Trial>), String> {
    let mut lines = text.lines().enumerate();
    let campaign = lines.next().and_then(|(_, line)| line.strip_prefix("# "));
    let campaign = campaign.ok_or("line 1: not a file that cargo experiment --csv wrote")?;
    let mut trials = Vec::new();
    for (index, line) in lines.skip(1) {
        let trial = read_line(line).ok_or_else(|| {
            format!("line {}: not a trial that cargo experiment --csv wrote: {line}", index + 1)
        })?;
        trials.push(trial);
    }
    Ok((campaign.to_owned(), trials))
}

fn read_line(line: &str) -> Option<Trial> {
    let mut words = line.split(',');
    let row = Row::named(words.next()?)?;
    let number = words.next()?.parse().ok()?;
    let mut trial = Trial { row, number, ..Trial::NONE };
    for metric in Metric::ALL {
        let value: f64 = words.next()?.parse().ok()?;
        *metric.of_mut(&mut trial) = Some(value).filter(|value| value.is_finite())?;
    }
    trial.unfinished = words.next()?.parse().ok()?;
    words.next().is_none().then_some(trial)
}

/// Puts the trials of several files together. The error is a message for the user: files of
/// different campaigns, a trial that is in two files, or one that is in none.
pub fn merge(files: Vec<Part<String, Trial>>) -> Result<(String, Vec<Trial>), String> {
    let (campaign, merged) = shards::merge(
        files,
        Clone::clone,
        |trial| (trial.row.index(), trial.number),
        |trial| format!("trial {} of {} is there twice", trial.number, trial.row.name()),
    )?;
    match missing(&campaign, &merged) {
        Some(message) => Err(message),
        None => Ok((campaign, merged)),
    }
}

/// Which of a campaign's trials are not there; `None` if all are.
fn missing(campaign: &str, trials: &[Trial]) -> Option<String> {
    let option = |name: &str| campaign.split(' ').skip_while(|word| *word != name).nth(1);
    let count: u32 = option("--trials").and_then(|count| count.parse().ok()).unwrap_or(0);
    let rows = option("--rows").unwrap_or_default().split(',').filter_map(Row::named);
    let mut absent: Vec<(Row, u32)> =
        rows.flat_map(|row| (0..count).map(move |n| (row, n))).collect();
    absent.retain(|&(row, number)| {
        trials.binary_search_by_key(&(row.index(), number), |t| (t.row.index(), t.number)).is_err()
    });
    let &(row, number) = absent.first()?;
    Some(format!(
        "{} of the trials are in none of the files, the first of them trial {number} of {}: add the \
         file of its shard",
        absent.len(),
        row.name()
    ))
}
