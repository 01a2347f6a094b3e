//! The ways of a multipolygon, joined to rings.
//!
//! Source: the wiki of OpenStreetMap, "Relation:multipolygon/Algorithm": ways that share an end
//! node are joined, turned round where needed, until the line closes. Where more than two ends
//! meet, the file's order decides; the filling of polygons bears rings that touch themselves.

use crate::map::Point;
use geo::{Coord, Intersects, LineString, Polygon};
use std::collections::HashMap;

/// Lists of nodes.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Joined {
    /// Whose last node is their first.
    pub(super) closed: Vec<Vec<i64>>,
    /// Whose ends meet nothing.
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
        // Onwards from the end; then, where that does not close it, from the beginning.
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

/// A ring has three nodes, and the first again.
fn is_closed(line: &[i64]) -> bool {
    line.len() > 3 && line.first() == line.last()
}

/// A way that goes on where a line ends.
fn next_way(
    line: &[i64],
    at_end: &mut HashMap<i64, Vec<usize>>,
    is_used: &[bool],
) -> Option<usize> {
    if is_closed(line) {
        return None;
    }
    let waiting = at_end.get_mut(line.last()?)?;
    // Each way is looked at once for each of its ends, however many meet there.
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

/// Whether a ring holds another, its outline included.
pub(super) fn holds(outer: &[Point], inner: &[Point]) -> bool {
    let outline = LineString::from_iter(outer.iter().map(|&[x, y]| Coord { x, y }));
    let polygon = Polygon::new(outline, Vec::new());
    inner.iter().all(|&[x, y]| polygon.intersects(&Coord { x, y }))
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
        // Turned round, and out of order.
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
        assert!(holds(&outer, &[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]));
        assert!(holds(&outer, &[[0.0, 0.0], [2.0, 1.0], [2.0, 4.0]]));
        assert!(!holds(&outer, &[[1.0, 1.0], [5.0, 1.0], [2.0, 2.0]]));
    }
}
