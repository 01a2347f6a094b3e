//! Cuts the openings of gates out of fences.

use crate::model::Point;
use math::scalar::wide;

/// The pieces of a line between its openings.
///
/// `width_m` gives the width of the opening at each point, half of it to either side. On a closed
/// line an opening continues across the first point.
pub(super) fn cut(line: &[Point], width_m: impl Fn(usize) -> Option<f64>) -> Vec<Vec<Point>> {
    // Distance of each point along the line.
    let mut along = Vec::with_capacity(line.len());
    let mut length = 0.0;
    for (index, point) in line.iter().enumerate() {
        if let Some(before) = index.checked_sub(1).and_then(|before| line.get(before)) {
            length += wide::hypot(point[0] - before[0], point[1] - before[1]);
        }
        along.push(length);
    }
    let is_closed = line.len() > 2 && line.first() == line.last();
    let mut gaps: Vec<[f64; 2]> = Vec::new();
    for (index, at) in along.iter().enumerate() {
        let Some(half) = width_m(index).map(|width| width / 2.0) else { continue };
        gaps.push([at - half, at + half]);
        if is_closed {
            // The parts beyond the seam.
            gaps.push([at - half + length, at + half + length]);
            gaps.push([at - half - length, at + half - length]);
        }
    }
    if gaps.is_empty() {
        return vec![line.to_vec()];
    }
    gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut pieces = Vec::new();
    let mut from = 0.0;
    for [start, end] in gaps.into_iter().chain([[length, length]]) {
        if start > from {
            pieces.extend(part(line, &along, [from, start.min(length)]));
        }
        from = end.max(from);
    }
    pieces
}

/// The part of a line between two distances along it; `None` if it has no length.
fn part(line: &[Point], along: &[f64], [from, to]: [f64; 2]) -> Option<Vec<Point>> {
    let mut points = vec![point_at(line, along, from)?];
    let first = along.partition_point(|at| *at <= from);
    let end = along.partition_point(|at| *at < to);
    points.extend(line.get(first..end.max(first)).into_iter().flatten());
    points.push(point_at(line, along, to)?);
    (to > from).then_some(points)
}

fn point_at(line: &[Point], along: &[f64], at: f64) -> Option<Point> {
    let after = along.partition_point(|reached| *reached < at).min(line.len().checked_sub(1)?);
    let before = after.saturating_sub(1);
    let (a, b) = (line.get(before)?, line.get(after)?);
    let (low, high) = (along.get(before)?, along.get(after)?);
    let share = if high > low { (at - low) / (high - low) } else { 1.0 };
    Some([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(line: &[Point], gates: &[(usize, f64)], expected: &[&[Point]]) {
        let width = |index| gates.iter().find(|(at, _)| *at == index).map(|(_, width)| *width);
        assert_eq!(cut(line, width), expected, "{line:?} {gates:?}");
    }

    #[test]
    fn a_gate_takes_its_width_out_of_a_line() {
        let fence = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]];
        check(&fence, &[], &[&fence]);
        check(&fence, &[(1, 2.0)], &[&[[0.0, 0.0], [9.0, 0.0]], &[[10.0, 1.0], [10.0, 10.0]]]);
        check(&fence, &[(0, 4.0)], &[&[[2.0, 0.0], [10.0, 0.0], [10.0, 10.0]]]);
        check(&fence, &[(1, 50.0)], &[]);
        check(&[[3.0, 3.0]], &[(0, 1.0)], &[]);
    }

    #[test]
    fn a_ring_has_no_end() {
        let ring = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let left: &[Point] = &[[1.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 1.0]];
        check(&ring, &[(0, 2.0)], &[left]);
        check(&ring, &[(4, 2.0)], &[left]);
    }

    #[test]
    fn openings_may_touch() {
        let fence = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [9.0, 0.0]];
        check(&fence, &[(1, 2.0), (2, 2.0)], &[&[[3.0, 0.0], [9.0, 0.0]]]);
    }
}
