//! Means, Welch's t-test and equivalence bounds.
//!
//! Sources: Welch 1947 for unequal variances; Schuirmann 1987 for two one-sided tests, which show
//! that a difference is small. A p-value above 0.05 shows nothing.

use math::scalar::wide;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Number, mean and standard deviation of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Number of values.
    pub count: usize,
    /// Mean; NaN without values.
    pub mean: f64,
    /// Standard deviation; 0 with fewer than two values.
    pub sd: f64,
}

impl Summary {
    /// The summary of a sample.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len();
        let mean = values.iter().sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        let variance = if count < 2 { 0.0 } else { squares / (count - 1) as f64 };
        Self { count, mean, sd: wide::sqrt(variance) }
    }

    /// Variance of the mean.
    fn variance_of_mean(&self) -> f64 {
        self.sd * self.sd / self.count as f64
    }
}

/// The difference of two means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// First mean less the second.
    pub mean: f64,
    /// Its standard error.
    error: f64,
    /// Degrees of freedom after Welch and Satterthwaite.
    freedom: f64,
}

impl Difference {
    /// The difference between two samples.
    pub fn of(a: &Summary, b: &Summary) -> Self {
        let (u, v) = (a.variance_of_mean(), b.variance_of_mean());
        let weight = |part: f64, count: usize| part * part / (count as f64 - 1.0);
        let freedom = (u + v) * (u + v) / (weight(u, a.count) + weight(v, b.count));
        Self { mean: a.mean - b.mean, error: wide::sqrt(u + v), freedom }
    }

    /// The distribution of the statistic; `None` if the samples do not vary or are too small.
    fn student(&self) -> Option<StudentsT> {
        StudentsT::new(0.0, 1.0, self.freedom).ok().filter(|_| self.error > 0.0)
    }

    /// The two-sided p-value of no difference.
    pub fn p(&self) -> f64 {
        let t = (self.mean / self.error).abs();
        match self.student() {
            Some(student) => 2.0 * (1.0 - student.cdf(t)).max(student.cdf(-t)).min(0.5),
            None if self.mean == 0.0 => 1.0,
            None => 0.0,
        }
    }

    /// Whether the difference is shown to be within `bound` on either side, at 95 %: its 90 %
    /// interval lies within.
    pub fn is_within(&self, bound: f64) -> bool {
        let [low, high] = self.interval();
        -bound < low && high < bound
    }

    /// The 90 % interval of the difference.
    pub fn interval(&self) -> [f64; 2] {
        let reach = self.student().map_or(0.0, |student| student.inverse_cdf(0.95) * self.error);
        [self.mean - reach, self.mean + reach]
    }
}

/// The median; NaN without values.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => f64::NAN,
        count if count % 2 == 0 => 0.5 * (sorted[middle - 1] + sorted[middle]),
        _ => sorted[middle],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Student's data on sleep, for which R's documentation of `t.test` has t = -1.8608, 17.776
    /// degrees of freedom, p = 0.07939.
    #[test]
    fn welch_as_in_a_published_example() {
        let a = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let b = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
        let found = Difference::of(&Summary::of(&a), &Summary::of(&b));
        assert!((found.mean / found.error + 1.860_8).abs() < 1e-4, "{found:?}");
        assert!((found.freedom - 17.776).abs() < 1e-3, "{found:?}");
        assert!((found.p() - 0.079_39).abs() < 1e-5, "{}", found.p());
    }

    /// Quantiles of Student's table: with 10 degrees of freedom 5 % lie beyond 2.228 on both sides,
    /// and 5 % beyond 1.812 on one.
    #[test]
    fn quantiles_are_those_of_the_table() {
        let difference = |mean| Difference { mean, error: 1.0, freedom: 10.0 };
        assert!((difference(2.228_138_9).p() - 0.05).abs() < 1e-6);
        let [low, high] = difference(0.5).interval();
        assert!((high - 0.5 - 1.812_461).abs() < 1e-5 && (low + high - 1.0).abs() < 1e-12);
        assert!(difference(0.5).is_within(2.32) && !difference(0.5).is_within(2.31));
    }

    #[test]
    fn samples_that_do_not_vary_differ_or_do_not() {
        let [same, other] = [&[1.0; 5], &[2.0; 5]].map(|values| Summary::of(values));
        assert_eq!(Difference::of(&same, &same).p(), 1.0);
        assert_eq!(Difference::of(&same, &other).p(), 0.0);
        assert_eq!((median(&[3.0, 1.0, 2.0]), median(&[4.0, 1.0])), (2.0, 2.5));
    }
}
