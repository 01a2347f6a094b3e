//! Merges the holes of a polygon that share edges.
//!
//! OpenStreetMap lets inner rings share edges: they are then one hole, and the edge is not a wall.
//! Edges that two holes share are removed, and the remaining edges are joined to rings.

use crate::model::Point;
use std::collections::HashMap;

/// A point as a key: points are equal if all their bits are.
type Key = [u64; 2];

fn key(point: &Point) -> Key {
    // Adding zero turns a negative zero into a positive one.
    point.map(|at| (at + 0.0).to_bits())
}

/// Merges rings until no two share an edge. Rings do not repeat their first point.
pub(super) fn merged(rings: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
    let edges = |ring: &Vec<Point>| -> Vec<[Point; 2]> {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(a, b)| [*a, *b]).filter(|[a, b]| a != b).collect()
    };
    let sorted = |[a, b]: &[Point; 2]| {
        let (a, b) = (key(a), key(b));
        if a < b { [a, b] } else { [b, a] }
    };
    let mut times: HashMap<[Key; 2], usize> = HashMap::new();
    for edge in rings.iter().flat_map(edges) {
        *times.entry(sorted(&edge)).or_default() += 1;
    }
    if times.values().all(|times| *times == 1) {
        return rings;
    }
    let all = rings.iter().flat_map(edges);
    // An edge that occurs an even number of times has a hole on both sides.
    let mut left: Vec<[Point; 2]> = Vec::new();
    for edge in all {
        if times.get_mut(&sorted(&edge)).is_some_and(|times| std::mem::take(times) % 2 == 1) {
            left.push(edge);
        }
    }
    joined(&left)
}

/// Joins edges to rings. Every point has an even number of edges.
fn joined(edges: &[[Point; 2]]) -> Vec<Vec<Point>> {
    let mut at: HashMap<Key, Vec<usize>> = HashMap::new();
    for (index, edge) in edges.iter().enumerate() {
        edge.iter().for_each(|end| at.entry(key(end)).or_default().push(index));
    }
    let mut is_used = vec![false; edges.len()];
    let mut rings = Vec::new();
    for start in 0..edges.len() {
        if is_used[start] {
            continue;
        }
        is_used[start] = true;
        let [first, mut here] = edges[start];
        let mut ring = vec![first];
        while key(&here) != key(&first) {
            ring.push(here);
            let Some(waiting) = at.get_mut(&key(&here)) else { break };
            let Some(next) = std::iter::from_fn(|| waiting.pop()).find(|next| !is_used[*next])
            else {
                break;
            };
            is_used[next] = true;
            let [a, b] = edges[next];
            here = if key(&a) == key(&here) { b } else { a };
        }
        rings.push(ring);
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> Vec<Point> {
        vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]]
    }

    #[test]
    fn holes_that_share_an_edge_are_one() {
        let mut turned = square(1.0, 0.0);
        turned.reverse();
        for other in [square(1.0, 0.0), turned] {
            let merged = merged(vec![square(0.0, 0.0), other]);
            assert_eq!(merged.len(), 1, "{merged:?}");
            // Six points: both ends of the shared edge stay, no longer as corners.
            assert_eq!(merged[0].len(), 6);
        }
    }

    #[test]
    fn holes_that_share_no_edge_stay_separate() {
        for other in [square(1.0, 1.0), square(5.0, 0.0)] {
            let rings = vec![square(0.0, 0.0), other];
            assert_eq!(merged(rings.clone()), rings);
        }
        assert_eq!(merged(Vec::new()), Vec::<Vec<Point>>::new());
    }

    #[test]
    fn a_ring_of_holes_keeps_the_island_within() {
        let around = (0..9).filter(|n| *n != 4).map(|n| square(f64::from(n % 3), f64::from(n / 3)));
        let merged = merged(around.collect());
        let mut corners: Vec<usize> = merged.iter().map(Vec::len).collect();
        corners.sort_unstable();
        assert_eq!(corners, [4, 12]);
    }
}
