//! Numbers inside a text, such as `hold 5 s`, each with its range.

use crate::toml::{Report, Text, part_of};
use std::ops::{Range, RangeInclusive};

/// Reads the numbers of one text. A number out of range is kept as a mistake, and the nearest one
/// in range stands in, so that the other numbers are read too.
pub(super) struct Numbers<'t> {
    text: &'t Text,
    /// Where each wrong number is in the text, and what it may be.
    wrong: Vec<(Range<usize>, String)>,
}

impl<'t> Numbers<'t> {
    pub(super) fn of(text: &'t Text) -> Self {
        Self { text, wrong: Vec::new() }
    }

    /// A number in a range, in a unit; `part` is a part of the text. `None` if it is not a number.
    pub(super) fn number(
        &mut self,
        part: &str,
        range: RangeInclusive<f64>,
        unit: &str,
    ) -> Option<f64> {
        let number: f64 = part.trim().parse().ok()?;
        if !range.contains(&number) {
            self.add(part, "a number", &range, unit);
            return Some(*range.start());
        }
        Some(number)
    }

    /// A number without a fraction, in a range.
    pub(super) fn whole(&mut self, part: &str, range: RangeInclusive<u16>) -> Option<u16> {
        let number: f64 = part.trim().parse().ok()?;
        let ends = f64::from(*range.start())..=f64::from(*range.end());
        if !ends.contains(&number) || number.fract() != 0.0 {
            self.add(part, "a whole number", &ends, "");
            return Some(*range.start());
        }
        Some(number as u16)
    }

    fn add(&mut self, part: &str, kind: &str, range: &RangeInclusive<f64>, unit: &str) {
        let part = part.trim();
        // `part` lies in the text, so the difference of the addresses is its place.
        let start = (part.as_ptr() as usize).wrapping_sub(self.text.as_str().as_ptr() as usize);
        let (low, high) = (range.start(), range.end());
        let expected = format!("{kind} from {low} to {high} {unit}").trim_end().to_owned();
        self.wrong.push((start..start.saturating_add(part.len()), expected));
    }

    /// Reports the numbers that are out of range; whether there are none.
    pub(super) fn report(self, report: &mut Report<'_>, path: &str) -> bool {
        for (part, expected) in &self.wrong {
            let span = part_of(report.source, self.text, part.clone());
            report.out_of_range(path, &span, expected);
        }
        self.wrong.is_empty()
    }
}
