//! Joins the ways of a multipolygon to rings.
//!
//! Source: the wiki of OpenStreetMap, "Relation:multipolygon/Algorithm": ways that share an end
//! node are joined, reversed if needed, until the line closes. If more than two ends meet, the
//! file's order decides; polygon filling accepts rings that touch themselves.

use crate::model::Point;
use geo::coordinate_position::CoordPos;
use geo::{Coord, CoordinatePosition, LineString, Polygon};
use std::collections::HashMap;

/// Joined ways, as lists of nodes.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Joined {
    /// Lines that end at their first node.
    pub(super) closed: Vec<Vec<i64>>,
    /// Lines with unconnected ends.
    pub(super) open: Vec<Vec<i64>>,
}

/// Joins ways at their ends.
pub(super) fn join(ways: &[&[i64]]) -> Joined {
    let mut at_end: HashMap<i64, Vec<usize>> = HashMap::new();
    for (index, way) in ways.iter().enumerate() {
        for end in [way.first(), way.last()].into_iter().flatten() {
            at_end.entry(*end).or_default().push(index);
        }
    }
    let mut joined = Joined::default();
    let mut is_used = vec![false; ways.len()];
    for (index, way) in ways.iter().enumerate() {
        if way.is_empty() || std::mem::replace(&mut is_used[index], true) {
            continue;
        }
        let mut line = way.to_vec();
        // Extend the end; if the line does not close, reverse it and extend the beginning.
        for _ in 0..2 {
            while let Some(next) = next_way(&line, &mut at_end, &is_used) {
                is_used[next] = true;
                append(&mut line, ways[next]);
            }
            if is_closed(&line) {
                break;
            }
            line.reverse();
        }
        if is_closed(&line) { joined.closed.push(line) } else { joined.open.push(line) }
    }
    joined
}

/// A ring has at least three nodes and repeats the first.
fn is_closed(line: &[i64]) -> bool {
    line.len() > 3 && line.first() == line.last()
}

/// An unused way that continues a line.
fn next_way(
    line: &[i64],
    at_end: &mut HashMap<i64, Vec<usize>>,
    is_used: &[bool],
) -> Option<usize> {
    if is_closed(line) {
        return None;
    }
    let waiting = at_end.get_mut(line.last()?)?;
    // Each way is visited once per end, regardless of how many meet there.
    while let Some(way) = waiting.pop() {
        if !is_used[way] {
            return Some(way);
        }
    }
    None
}

fn append(line: &mut Vec<i64>, way: &[i64]) {
    if way.first() == line.last() {
        line.extend(way.iter().skip(1));
    } else {
        line.extend(way.iter().rev().skip(1));
    }
}

/// Most corners of a hole that are tested until one does not lie on the outline.
const MAX_CORNERS: usize = 256;
/// Most steps for finding the holes of one relation's rings.
const MAX_STEPS: usize = 1 << 30;

/// Finds which holes lie in which rings.
pub(super) struct Fit<'a> {
    holes: &'a [Vec<Point>],
    boxes: Vec<Rect>,
    steps_left: usize,
    /// Holes that were ignored because the steps ran out: that blocks more, not less.
    pub(super) undecided: usize,
}

impl<'a> Fit<'a> {
    pub(super) fn new(holes: &'a [Vec<Point>]) -> Self {
        let boxes = holes.iter().map(|hole| rect(hole)).collect();
        Self { holes, boxes, steps_left: MAX_STEPS, undecided: 0 }
    }

    /// Indices of the holes inside a ring or on its outline.
    pub(super) fn holes_of(&mut self, ring: &[Point]) -> Vec<usize> {
        let around = rect(ring);
        let outline = LineString::from_iter(ring.iter().map(|&[x, y]| Coord { x, y }));
        let polygon = Polygon::new(outline, Vec::new());
        let mut held = Vec::new();
        for (index, (hole, within)) in self.holes.iter().zip(&self.boxes).enumerate() {
            if self.steps_left == 0 {
                self.undecided += 1;
                continue;
            }
            self.steps_left -= 1;
            if hole.is_empty() || !around.contains(within) {
                continue;
            }
            // Rings do not cross, so one corner decides unless it lies on the outline.
            let corners = hole.iter().take(MAX_CORNERS).map(|&[x, y]| Coord { x, y });
            let steps = ring.len().saturating_mul(hole.len().min(MAX_CORNERS));
            self.steps_left = self.steps_left.saturating_sub(steps);
            let places = corners.map(|corner| polygon.coordinate_position(&corner));
            let mut decided = places.filter(|place| *place != CoordPos::OnBoundary);
            if decided.next() != Some(CoordPos::Outside) {
                held.push(index);
            }
        }
        held
    }
}

/// West, south, east, north.
struct Rect([f64; 4]);

fn rect(ring: &[Point]) -> Rect {
    let none = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    Rect(ring.iter().fold(none, |[west, south, east, north], &[x, y]| {
        [west.min(x), south.min(y), east.max(x), north.max(y)]
    }))
}

impl Rect {
    fn contains(&self, other: &Self) -> bool {
        let (Self([west, south, east, north]), Self(other)) = (self, other);
        *west <= other[0] && *south <= other[1] && *east >= other[2] && *north >= other[3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(ways: &[&[i64]], closed: &[&[i64]], open: &[&[i64]]) {
        let owned = |lines: &[&[i64]]| lines.iter().map(|line| line.to_vec()).collect();
        assert_eq!(join(ways), Joined { closed: owned(closed), open: owned(open) }, "{ways:?}");
    }

    #[test]
    fn ways_become_rings() {
        check(&[&[1, 2, 3, 1]], &[&[1, 2, 3, 1]], &[]);
        check(&[&[1, 2], &[2, 3], &[3, 1]], &[&[1, 2, 3, 1]], &[]);
        // Reversed and out of order.
        check(&[&[1, 2], &[4, 1], &[3, 2], &[3, 4]], &[&[1, 2, 3, 4, 1]], &[]);
        check(&[&[1, 2, 3], &[7, 8, 9, 7], &[1, 3]], &[&[1, 2, 3, 1], &[7, 8, 9, 7]], &[]);
        check(&[], &[], &[]);
    }

    #[test]
    fn what_does_not_close_stays_one_line() {
        check(&[&[2, 3], &[1, 2], &[3, 4]], &[], &[&[1, 2, 3, 4]]);
        check(&[&[1, 2], &[], &[5]], &[], &[&[1, 2], &[5]]);
        check(&[&[1, 2, 1]], &[], &[&[1, 2, 1]]);
    }

    #[test]
    fn a_ring_holds_what_lies_in_it_or_on_it() {
        let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let holes = [
            vec![[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]],
            vec![[0.0, 0.0], [2.0, 1.0], [2.0, 4.0]],
            vec![[1.0, 1.0], [5.0, 1.0], [2.0, 2.0]],
            outer.to_vec(),
            Vec::new(),
        ];
        assert_eq!(Fit::new(&holes).holes_of(&outer), [0, 1, 3]);
        // A notch: inside the box of the ring but outside the ring.
        let notched = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.5], [0.0, 4.0]];
        let holes = [vec![[1.5, 3.0], [2.5, 3.0], [2.0, 2.0]]];
        assert!(Fit::new(&holes).holes_of(&notched).is_empty());
    }

    #[test]
    fn the_search_for_holes_is_bounded() {
        let holes = vec![vec![[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]; 40];
        let mut fit = Fit { steps_left: 100, ..Fit::new(&holes) };
        let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let held = fit.holes_of(&outer).len();
        assert_eq!((held, fit.undecided), (8, 32));
    }
}
