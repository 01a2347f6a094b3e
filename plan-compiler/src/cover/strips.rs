//! Strips on the rows of a sweep: first part by part, at equal distances; then where gaps are left,
//! beside slanted edges and in bays.

use super::Settings;
use super::rows::{Rows, Span};
use math::scalar::wide;

/// Strips end this far inside the ground, so that rounded coordinates are in it, metres.
pub(super) const INSET_M: f64 = 2e-3;

/// A strip: a span of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Laid {
    pub(super) row: usize,
    pub(super) span: Span,
}

/// All strips of an area.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) rows: Rows,
    /// The strips of each part, in the order of their rows.
    pub(super) parts: Vec<Vec<Laid>>,
    /// The strips that fill gaps.
    pub(super) gaps: Vec<Laid>,
}

impl Layout {
    pub(super) fn all(&self) -> impl Iterator<Item = &Laid> {
        self.parts.iter().flatten().chain(&self.gaps)
    }

    pub(super) fn count(&self) -> usize {
        self.all().count()
    }

    pub(super) fn length_m(&self) -> f64 {
        self.all().map(|laid| laid.span[1] - laid.span[0]).sum()
    }
}

/// A part of the area that no obstacle splits: one span a row.
struct Part {
    first: usize,
    spans: Vec<Span>,
}

/// Lays strips over the rows.
pub(super) fn lay(rows: Rows, settings: &Settings) -> Layout {
    let tool = Tool::of(&rows, settings);
    let mut left = rows.spans.clone();
    let parts: Vec<Vec<Laid>> = parts(&rows, settings)
        .iter()
        .map(|part| tool.strips_of(part))
        .filter(|strips| !strips.is_empty())
        .collect();
    parts.iter().flatten().for_each(|laid| tool.pass(laid, &mut left));
    let gaps = tool.fill(&rows, &mut left);
    Layout { rows, parts, gaps }
}

/// Splits the rows where the number of spans changes. Spans as short as the steps of a slanted edge
/// in cells do not count.
fn parts(rows: &Rows, settings: &Settings) -> Vec<Part> {
    let shortest = (2.0 * rows.resolution_m).min(settings.width_m / 2.0);
    let meet = |a: &Span, b: &Span| a[0] < b[1] && b[0] < a[1];
    let (mut open, mut closed): (Vec<Part>, Vec<Part>) = (Vec::new(), Vec::new());
    for (row, all) in rows.spans.iter().enumerate() {
        let spans = all.iter().filter(|span| span[1] - span[0] >= shortest).copied();
        let spans: Vec<Span> = spans.collect();
        let above = |last: &Span| spans.iter().filter(|span| meet(span, last)).count();
        let lasts: Vec<Span> = open.iter().filter_map(|part| part.spans.last().copied()).collect();
        let mut next: Vec<Part> = Vec::new();
        for span in &spans {
            let mut below = lasts.iter().zip(0..).filter(|(last, _)| meet(span, last));
            let only = match (below.next(), below.next()) {
                (Some((last, index)), None) if above(last) == 1 => Some(index),
                _ => None,
            };
            match only {
                Some(index) => {
                    let part: &mut Part = &mut open[index];
                    let spans = std::mem::take(&mut part.spans);
                    next.push(Part { first: part.first, spans });
                    next.last_mut().into_iter().for_each(|part| part.spans.push(*span));
                }
                None => next.push(Part { first: row, spans: vec![*span] }),
            }
        }
        closed.extend(open.drain(..).filter(|part| !part.spans.is_empty()));
        open = next;
    }
    closed.extend(open);
    closed.sort_by_key(|part| part.first);
    closed
}

/// What a strip covers, in rows.
struct Tool {
    /// Greatest distance of neighbouring strips, rows.
    apart: f64,
    /// How far it reaches beside a strip, metres.
    reach_m: f64,
    step_m: f64,
    /// Gaps up to this size stay, m².
    leave_m2: f64,
    /// Shorter strips are made longer where their row has room, metres.
    short_m: f64,
    /// No strip is shorter than this before its ends move inwards, metres.
    least_m: f64,
}

impl Tool {
    fn of(rows: &Rows, settings: &Settings) -> Self {
        let (step_m, cell_m) = (rows.step_m, rows.resolution_m);
        Self {
            apart: ((settings.width_m - settings.overlap_m) / step_m).max(1.0),
            // The ground is known to half a cell; a part of that keeps the steps of edges from
            // counting as gaps.
            reach_m: settings.width_m / 2.0 + cell_m / 4.0,
            step_m,
            leave_m2: settings.leave_m2.max(cell_m * cell_m / 32.0),
            short_m: settings.width_m / 2.0,
            least_m: cell_m / 2.0 + 2.0 * INSET_M,
        }
    }

    /// How far the tool reaches along a row beyond the ends of a strip this many rows away; `None`
    /// if it does not reach the row.
    fn beyond(&self, rows_away: usize) -> Option<f64> {
        let away = rows_away as f64 * self.step_m;
        let left = self.reach_m * self.reach_m - away * away;
        (left >= 0.0).then(|| wide::sqrt(left))
    }

    fn rows_reached(&self) -> usize {
        wide::floor(self.reach_m / self.step_m) as usize
    }

    /// The strips of a part at equal distances; a part that is lower than half a strip has none.
    fn strips_of(&self, part: &Part) -> Vec<Laid> {
        let height = part.spans.len() as f64;
        if height < self.apart / 2.0 {
            return Vec::new();
        }
        let count = wide::ceil(height / self.apart - 1e-6).max(1.0);
        let row = |index: usize| ((index as f64 + 0.5) * height / count) as usize;
        let laid = |index: usize| {
            let row = row(index).min(part.spans.len() - 1);
            Laid { row: part.first + row, span: part.spans[row] }
        };
        (0..count as usize).map(laid).collect()
    }

    /// Takes what a strip covers out of what is left.
    fn pass(&self, laid: &Laid, left: &mut [Vec<Span>]) {
        let first = laid.row.saturating_sub(self.rows_reached());
        let reached = left.iter_mut().enumerate().skip(first).take(2 * self.rows_reached() + 1);
        for (row, spans) in reached {
            if let Some(beyond) = self.beyond(row.abs_diff(laid.row)) {
                let covered = [laid.span[0] - beyond, laid.span[1] + beyond];
                *spans = spans.iter().flat_map(|span| without(*span, covered)).collect();
            }
        }
    }

    /// Lays strips until no gap is left that counts: over each gap the one that covers the most of
    /// it, among equals the shortest.
    fn fill(&self, rows: &Rows, left: &mut [Vec<Span>]) -> Vec<Laid> {
        let mut laid = Vec::new();
        loop {
            let gaps: Vec<Gap> = gaps(left);
            let gaps: Vec<&Gap> =
                gaps.iter().filter(|gap| gap.area_m2(self.step_m) > self.leave_m2).collect();
            if gaps.is_empty() {
                return laid;
            }
            for gap in gaps {
                match self.best_over(gap, rows) {
                    Some(strip) => {
                        self.pass(&strip, left);
                        laid.push(strip);
                    }
                    None => gap.leave(left),
                }
            }
        }
    }

    /// `None` if only a strip that is too short would cover more than a hundredth of the gap.
    fn best_over(&self, gap: &Gap, rows: &Rows) -> Option<Laid> {
        /// Rows that are tried, about.
        const TRIED: usize = 24;
        const LEAST_SHARE: f64 = 0.01;
        let reached = self.rows_reached();
        let first = gap.first().saturating_sub(reached);
        let last = (gap.last() + reached).min(rows.spans.len() - 1);
        let step = ((last - first) / TRIED).max(1);
        let longest = gap.0.iter().max_by(|a, b| length(&a.1).total_cmp(&length(&b.1)))?;
        let [west, east] = gap
            .0
            .iter()
            .fold(longest.1, |[west, east], (_, span)| [west.min(span[0]), east.max(span[1])]);
        let tried = (first..=last).step_by(step).chain([longest.0]);
        let strips = tried.flat_map(|row| {
            let spans = rows.spans[row].iter().filter(|span| span[0] < east && west < span[1]);
            let over = |span: &Span| [span[0].max(west), span[1].min(east)];
            spans.map(move |span| Laid { row, span: stretched(over(span), *span, self.short_m) })
        });
        let strips = strips.filter(|strip| length(&strip.span) >= self.least_m);
        let gained = |strip: &Laid| -> f64 {
            let of = |(row, span): &(usize, Span)| {
                let beyond = self.beyond(row.abs_diff(strip.row)).unwrap_or(f64::NEG_INFINITY);
                let [from, to] = [strip.span[0] - beyond, strip.span[1] + beyond];
                (to.min(span[1]) - from.max(span[0])).max(0.0)
            };
            gap.0.iter().map(of).sum()
        };
        let best = strips.map(|strip| (gained(&strip), strip)).reduce(|best, next| {
            let is_better = next.0 > best.0 + 1e-9
                || next.0 > best.0 - 1e-9 && length(&next.1.span) < length(&best.1.span) - 1e-9;
            if is_better { next } else { best }
        });
        let whole: f64 = gap.0.iter().map(|(_, span)| length(span)).sum();
        best.filter(|(gained, _)| *gained >= LEAST_SHARE * whole).map(|(_, strip)| strip)
    }
}

/// A span made as long as this on both sides, as far as it stays inside another.
fn stretched(span: Span, [from, to]: Span, least_m: f64) -> Span {
    let missing = least_m - length(&span);
    if missing <= 0.0 {
        return span;
    }
    let start = (span[0] - missing / 2.0).min(to - least_m).max(from);
    [start, (start + least_m).min(to)]
}

fn length(span: &Span) -> f64 {
    span[1] - span[0]
}

/// A span less another: nothing, one or two spans.
fn without(span: Span, other: Span) -> impl Iterator<Item = Span> {
    let [from, to] = span;
    let pieces = if other[1] <= from || to <= other[0] {
        [span, [to, to]]
    } else {
        [[from, other[0]], [other[1], to]]
    };
    pieces.into_iter().filter(|piece| length(piece) > 1e-9)
}

/// Spans of neighbouring rows that touch and that no strip covers.
struct Gap(Vec<(usize, Span)>);

impl Gap {
    fn first(&self) -> usize {
        self.0.iter().map(|(row, _)| *row).min().unwrap_or(0)
    }

    fn last(&self) -> usize {
        self.0.iter().map(|(row, _)| *row).max().unwrap_or(0)
    }

    /// Takes it out of what is left: no strip covers it.
    fn leave(&self, left: &mut [Vec<Span>]) {
        for (row, span) in &self.0 {
            left[*row].retain(|other| other != span);
        }
    }

    fn area_m2(&self, step_m: f64) -> f64 {
        self.0.iter().map(|(_, span)| length(span)).sum::<f64>() * step_m
    }
}

/// The gaps of what is left, from the lowest row.
fn gaps(left: &[Vec<Span>]) -> Vec<Gap> {
    let mut taken: Vec<Vec<bool>> = left.iter().map(|spans| vec![false; spans.len()]).collect();
    let mut gaps = Vec::new();
    for row in 0..left.len() {
        for index in 0..left[row].len() {
            if std::mem::replace(&mut taken[row][index], true) {
                continue;
            }
            let (mut gap, mut edge) = (Vec::new(), vec![(row, index)]);
            while let Some((row, index)) = edge.pop() {
                let span = left[row][index];
                gap.push((row, span));
                for beside in [row.checked_sub(1), Some(row + 1)].into_iter().flatten() {
                    for (other, at) in left.get(beside).into_iter().flatten().zip(0..) {
                        let meets = other[0] < span[1] && span[0] < other[1];
                        if meets && !std::mem::replace(&mut taken[beside][at], true) {
                            edge.push((beside, at));
                        }
                    }
                }
            }
            gaps.push(Gap(gap));
        }
    }
    gaps
}
