//! What the trials show of the paper's findings (W, section 5).

use super::metric::Metric;
use super::statistics::{Difference, Summary};
use super::{Row, Trial};

/// Distances this far apart count as equal, as a share of their mean.
pub const DISTANCE_BOUND: f64 = 0.05;
/// Shares of time as one network this far apart count as equal.
pub const SHARE_BOUND: f64 = 0.02;

/// The rows without regard to communication.
pub const SIMPLE: [Row; 4] = [Row::Reactive, Row::MostlyReactive, Row::MostlyPlan, Row::Plan];

/// A claim of the paper and whether the trials bear it out.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The claim, and what was found.
    pub text: String,
    /// Whether it holds for the means.
    pub holds: bool,
}

/// Summaries of the rows.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'t>(pub &'t [Trial]);

impl Rows<'_> {
    /// The values of a metric in a row, in the order of the trials.
    pub fn values(&self, row: Row, metric: Metric) -> Vec<f64> {
        self.0.iter().filter(|trial| trial.row == row).map(|trial| metric.of(trial)).collect()
    }

    /// The summary of a metric in a row; `None` without trials.
    pub fn summary(&self, row: Row, metric: Metric) -> Option<Summary> {
        let summary = Summary::of(&self.values(row, metric));
        (summary.count > 0).then_some(summary)
    }

    fn mean(&self, row: Row, metric: Metric) -> Option<f64> {
        self.summary(row, metric).map(|summary| summary.mean)
    }
}

/// The findings for which there are trials.
pub fn findings(trials: &[Trial]) -> Vec<Finding> {
    let rows = Rows(trials);
    let all = [times(&rows), distances(&rows), networks(&rows), coverage(&rows)];
    all.into_iter().flatten().collect()
}

/// That the mean of a metric is less in one row than in another.
fn less(rows: &Rows<'_>, part: &str, metric: Metric, low: Row, high: Row) -> Option<Finding> {
    let (a, b) = (rows.mean(low, metric)?, rows.mean(high, metric)?);
    let (scale, heading) = (metric.scale(), metric.heading());
    let text = format!(
        "({part}) {heading}: {} {:.1} < {} {:.1}",
        low.name(),
        a * scale,
        high.name(),
        b * scale
    );
    Some(Finding { text, holds: a < b })
}

/// (a) A mix is fastest, and the reactive schemas alone are slower than any plan but the serial one.
fn times(rows: &Rows<'_>) -> Vec<Finding> {
    let order = [Row::MostlyPlan, Row::MostlyReactive, Row::Plan, Row::Reactive, Row::Serial];
    let pairs = order.windows(2).filter_map(|pair| less(rows, "a", Metric::Time, pair[0], pair[1]));
    pairs.collect()
}

/// (b) The simple rows drive alike, and the parallel plan drives farther.
fn distances(rows: &Rows<'_>) -> Vec<Finding> {
    let farther = SIMPLE.map(|row| less(rows, "b", Metric::Distance, row, Row::Parallel));
    let alike = alike(rows, "b", Metric::Distance, |mean| DISTANCE_BOUND * mean);
    farther.into_iter().flatten().chain(alike).collect()
}

/// (c) Plans that mind communication keep the team together; the others do not, all alike.
fn networks(rows: &Rows<'_>) -> Vec<Finding> {
    let level = |row: Row, low: f64, high: f64| {
        let share = rows.mean(row, Metric::OneNetwork)?;
        let text = format!(
            "(c) one network: {} {:.1} % is {:.0} to {:.0} %",
            row.name(),
            share * 100.0,
            low * 100.0,
            high * 100.0
        );
        Some(Finding { text, holds: (low..=high).contains(&share) })
    };
    let simple = SIMPLE.map(|row| level(row, 0.0, 0.35));
    let minding = [level(Row::Parallel, 0.95, 1.0), level(Row::Serial, 0.6, 0.9)];
    let alike = alike(rows, "c", Metric::OneNetwork, |_| SHARE_BOUND);
    simple.into_iter().chain(minding).flatten().chain(alike).collect()
}

/// (d) Reactive robots see more as they loiter, and a serial plan sees more than a parallel one.
fn coverage(rows: &Rows<'_>) -> Vec<Finding> {
    let more = SIMPLE[1..].iter();
    let more = more.filter_map(|&row| less(rows, "d", Metric::Coverage, row, Row::Reactive));
    more.chain(less(rows, "d", Metric::Coverage, Row::Parallel, Row::Serial)).collect()
}

/// That the means of the simple rows differ by at most a bound, which depends on their mean, and
/// whether each pair's difference is shown to be within it.
fn alike(
    rows: &Rows<'_>,
    part: &str,
    metric: Metric,
    bound: impl Fn(f64) -> f64,
) -> Option<Finding> {
    let found = SIMPLE.map(|row| rows.summary(row, metric));
    let summaries: Vec<(Row, Summary)> =
        SIMPLE.iter().zip(found).filter_map(|(&row, found)| Some((row, found?))).collect();
    if summaries.len() < SIMPLE.len() {
        return None;
    }
    let mean = summaries.iter().map(|(_, summary)| summary.mean).sum::<f64>() / SIMPLE.len() as f64;
    let bound = bound(mean);
    let mut pairs = Vec::new();
    for (index, (row, a)) in summaries.iter().enumerate() {
        pairs.extend(
            summaries[..index].iter().map(|(other, b)| (*row, *other, Difference::of(a, b))),
        );
    }
    let shown = pairs.iter().filter(|(.., difference)| difference.is_within(bound)).count();
    let count = pairs.len();
    let (a, b, most) =
        pairs.into_iter().reduce(|a, b| if b.2.mean.abs() > a.2.mean.abs() { b } else { a })?;
    let (scale, heading) = (metric.scale(), metric.heading());
    let text = format!(
        "({part}) {heading}: the four differ by at most {:.1}, within {:.1} ({} to {}: {:.1}); 90 % \
         intervals of {shown} of {count} pairs are within",
        most.mean.abs() * scale,
        bound * scale,
        a.name(),
        b.name(),
        most.mean * scale,
    );
    Some(Finding { text, holds: most.mean.abs() <= bound })
}
