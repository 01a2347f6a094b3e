//! How the true world differs from the map.
//!
//! Two maps come out of one: the map that the robot's plans are compiled from, and the true world
//! that its sensors see and its body touches. An obstacle is a feature of the map, or a connected
//! part of its occupied cells.

use crate::{Placement, Point, Random, Stream, World};
use maps::bitmap::Bitmap;
use maps::{CellMap, Map, Role, Shape};
use plan_format::Cell;
use std::collections::HashSet;

/// How the true world differs from the map; by default not at all.
#[derive(Clone, Debug)]
pub struct Difference {
    /// The map of what is truly there. Its obstacles replace those of the robot's map.
    pub truth: Option<Box<Map>>,
    /// Obstacles that are there and that the map does not show, in true metres.
    pub extra: Vec<Shape>,
    /// Obstacles that the map shows and that are not there.
    pub missing: Vec<Missing>,
    /// Share of the map's obstacles that the robot does not know, 0 to 1. They are there.
    pub unmapped: f64,
    /// Share of the obstacles that are not there, 0 to 1. The robot's map shows them.
    pub removed: f64,
    /// Where the obstacles truly lie, compared with the map.
    pub placement: Placement,
}

/// Obstacles that are not there.
#[derive(Clone, Debug, PartialEq)]
pub enum Missing {
    /// All with this name.
    Named(String),
    /// All that come this near to a point, metres.
    Near {
        /// The point.
        at: Point,
        /// The distance.
        within_m: f64,
    },
}

/// A map and a true world that differ.
#[derive(Clone, Debug)]
pub struct Worlds {
    /// What the robot's plans are compiled from.
    pub known: Map,
    /// What is truly there.
    pub truth: World,
    /// Shapes of obstacles that are there and not in `known`.
    pub unmapped: Vec<Shape>,
    /// Shapes of obstacles that are in `known` and not there.
    pub absent: Vec<Shape>,
}

impl Default for Difference {
    fn default() -> Self {
        Self {
            truth: None,
            extra: Vec::new(),
            missing: Vec::new(),
            unmapped: 0.0,
            removed: 0.0,
            placement: Placement::HERE,
        }
    }
}

/// One obstacle of a map.
#[derive(Clone, Debug)]
enum Obstacle {
    /// Index of a feature.
    Feature(usize),
    /// Connected occupied cells.
    Cells(Vec<Cell>),
}

impl Difference {
    /// A share of the obstacles is there and not on the map; otherwise the map is right.
    pub fn unmapped(share: f64) -> Self {
        Self { unmapped: share, ..Self::default() }
    }

    /// Whether the world is as on the map.
    pub fn is_none(&self) -> bool {
        self.truth.is_none()
            && self.extra.is_empty()
            && self.missing.is_empty()
            && self.unmapped == 0.0
            && self.removed == 0.0
            && self.placement == Placement::HERE
    }

    /// The robot's map and the true world. The seed chooses which obstacles are unmapped or
    /// removed; a larger share includes the smaller one. The counts are the shares, rounded.
    pub fn apply(&self, map: &Map, seed: u64) -> Worlds {
        let base = self.truth.as_deref().unwrap_or(map);
        let mut random = Random::new(seed, Stream::Obstacles);
        let (unknown, rest) = drawn(obstacles(map), self.unmapped, &mut random);
        let (removed, _) = match &self.truth {
            Some(truth) => drawn(obstacles(truth), self.removed, &mut random),
            // Of the whole map, but none of those that are unmapped: they are there.
            None => {
                let count = (self.removed * (unknown.len() + rest.len()) as f64).round();
                let share = if rest.is_empty() { 0.0 } else { count / rest.len() as f64 };
                drawn(rest, share, &mut random)
            }
        };
        let known = without(map, &unknown);
        let mut there = without(base, &removed);
        let gone = obstacles(&there)
            .into_iter()
            .filter(|obstacle| self.missing.iter().any(|missing| missing.holds(&there, obstacle)));
        let gone: Vec<Obstacle> = gone.collect();
        there = without(&there, &gone);
        let placement = self.placement;
        let placed = shapes(&there).map(|shape| placement.shape(shape));
        let solid: Vec<Shape> = placed.chain(self.extra.iter().cloned()).collect();
        let truth = World::placed(&solid, there.cells.as_ref(), placement);
        let true_shapes: Vec<Shape> = all_shapes(&there)
            .iter()
            .map(|shape| placement.shape(shape))
            .chain(self.extra.iter().cloned())
            .collect();
        let known_shapes = all_shapes(&known);
        Worlds {
            unmapped: difference(&true_shapes, &known_shapes),
            absent: difference(&known_shapes, &true_shapes),
            known,
            truth,
        }
    }
}

impl Missing {
    fn holds(&self, map: &Map, obstacle: &Obstacle) -> bool {
        match self {
            Self::Named(name) => match obstacle {
                Obstacle::Feature(index) => map.features[*index].name == *name,
                Obstacle::Cells(_) => false,
            },
            Self::Near { at, within_m } => {
                let shapes = shapes_of(map, obstacle);
                !World::new(&shapes).is_clear(*at, *within_m)
            }
        }
    }

    /// Whether a map has such an obstacle.
    pub fn is_in(&self, map: &Map) -> bool {
        obstacles(map).iter().any(|obstacle| self.holds(map, obstacle))
    }
}

/// The map's obstacles in a fixed order.
fn obstacles(map: &Map) -> Vec<Obstacle> {
    let features = map.features.iter().enumerate();
    let features = features.filter(|(_, feature)| feature.role == Role::Obstacle);
    let parts = map.cells.iter().flat_map(|cells| connected(&cells.occupied));
    features.map(|(index, _)| Obstacle::Feature(index)).chain(parts.map(Obstacle::Cells)).collect()
}

/// Draws a share of the obstacles; returns those and the rest.
fn drawn(
    mut all: Vec<Obstacle>,
    share: f64,
    random: &mut Random,
) -> (Vec<Obstacle>, Vec<Obstacle>) {
    if share <= 0.0 {
        return (Vec::new(), all);
    }
    // Shuffled as by Fisher and Yates.
    for index in (1..all.len()).rev() {
        let other = (random.unit() * (index + 1) as f64) as usize;
        all.swap(index, other);
    }
    let count = ((share * all.len() as f64).round() as usize).min(all.len());
    let rest = all.split_off(count);
    (all, rest)
}

/// The map without some of its obstacles.
fn without(map: &Map, gone: &[Obstacle]) -> Map {
    let mut map = map.clone();
    let features = gone.iter().filter_map(|obstacle| match obstacle {
        Obstacle::Feature(index) => Some(*index),
        Obstacle::Cells(_) => None,
    });
    let features: HashSet<usize> = features.collect();
    let mut index = 0;
    map.features.retain(|_| {
        index += 1;
        !features.contains(&(index - 1))
    });
    if let Some(cells) = &mut map.cells {
        for obstacle in gone {
            if let Obstacle::Cells(part) = obstacle {
                part.iter().for_each(|&cell| cells.occupied.set(cell, false));
            }
        }
    }
    map
}

/// The shapes of the obstacles that are features.
fn shapes(map: &Map) -> impl Iterator<Item = &Shape> {
    let features = map.features.iter().filter(|feature| feature.role == Role::Obstacle);
    features.map(|feature| &feature.shape)
}

/// The shapes of all obstacles.
fn all_shapes(map: &Map) -> Vec<Shape> {
    obstacles(map).iter().flat_map(|obstacle| shapes_of(map, obstacle)).collect()
}

/// The shapes of an obstacle; cells become squares.
fn shapes_of(map: &Map, obstacle: &Obstacle) -> Vec<Shape> {
    match (obstacle, &map.cells) {
        (Obstacle::Feature(index), _) => vec![map.features[*index].shape.clone()],
        (Obstacle::Cells(part), Some(cells)) => {
            part.iter().map(|&cell| square(cells, cell)).collect()
        }
        (Obstacle::Cells(_), None) => Vec::new(),
    }
}

fn square(cells: &CellMap, cell: Cell) -> Shape {
    let corner = |east: u32, north: u32| {
        let metres =
            |axis: usize, count: u32| cells.corner[axis] + f64::from(count) * cells.resolution_m;
        [metres(0, cell.column + east), metres(1, cell.row + north)]
    };
    Shape::Polygon(vec![vec![corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]])
}

/// The connected parts of the occupied cells; cells that share an edge are connected.
fn connected(occupied: &Bitmap) -> Vec<Vec<Cell>> {
    let mut left = occupied.clone();
    let mut parts = Vec::new();
    for seed in occupied.iter() {
        if !left.get(seed) {
            continue;
        }
        let (mut part, mut next) = (Vec::new(), vec![seed]);
        left.set(seed, false);
        while let Some(cell) = next.pop() {
            part.push(cell);
            let Cell { column, row } = cell;
            let (west, south) = (column.checked_sub(1), row.checked_sub(1));
            let beside = [
                west.map(|west| Cell::new(west, row)),
                south.map(|south| Cell::new(column, south)),
                (column + 1 < left.columns()).then(|| Cell::new(column + 1, row)),
                (row + 1 < left.rows()).then(|| Cell::new(column, row + 1)),
            ];
            for cell in beside.into_iter().flatten() {
                if left.get(cell) {
                    left.set(cell, false);
                    next.push(cell);
                }
            }
        }
        parts.push(part);
    }
    parts
}

/// The shapes of `these` that `those` do not contain.
fn difference(these: &[Shape], those: &[Shape]) -> Vec<Shape> {
    let known: HashSet<Vec<u64>> = those.iter().map(bits).collect();
    these.iter().filter(|shape| !known.contains(&bits(shape))).cloned().collect()
}

/// The numbers of a shape as bits, and its kind.
fn bits(shape: &Shape) -> Vec<u64> {
    let points =
        |points: &[Point]| -> Vec<u64> { points.iter().flatten().map(|x| x.to_bits()).collect() };
    match shape {
        Shape::Circle { centre, radius } => {
            [vec![0, radius.to_bits()], points(&[*centre])].concat()
        }
        Shape::Polyline(line) => [vec![1], points(line)].concat(),
        Shape::Polygon(rings) => {
            let rings = rings.iter().map(|ring| [vec![ring.len() as u64], points(ring)].concat());
            [vec![2], rings.flatten().collect()].concat()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::{Extent, Feature};

    fn post(x: f64, name: &str) -> Feature {
        Feature {
            shape: Shape::Circle { centre: [x, 0.0], radius: 0.25 },
            role: Role::Obstacle,
            name: name.to_owned(),
            height_m: None,
            span: 0..0,
        }
    }

    /// Twenty posts a metre apart, named by their parity, and a zone, which is not an obstacle.
    fn posts() -> Map {
        let mut map = Map::empty(Extent { corner: [-1.0, -1.0], size: [22.0, 2.0] });
        let names = ["even", "odd"];
        map.features = (0..20).map(|i| post(f64::from(i), names[i as usize % 2])).collect();
        map.features.insert(3, Feature { role: Role::Zone, ..post(3.5, "zone") });
        map
    }

    fn count(map: &Map) -> usize {
        obstacles(map).len()
    }

    #[test]
    fn a_share_is_unmapped_and_still_there() {
        let map = posts();
        let worlds = Difference::unmapped(0.3).apply(&map, 1);
        assert_eq!((count(&worlds.known), worlds.known.features.len()), (14, 15));
        assert_eq!((worlds.unmapped.len(), worlds.absent.len()), (6, 0));
        for x in 0..20 {
            assert!(worlds.truth.is_inside([f64::from(x), 0.0]), "{x}");
        }
        let again = Difference::unmapped(0.3).apply(&map, 1);
        assert_eq!(again.unmapped, worlds.unmapped);
        assert_ne!(Difference::unmapped(0.3).apply(&map, 2).unmapped, worlds.unmapped);
        let more = Difference::unmapped(0.5).apply(&map, 1);
        let is_in_more = |shape: &Shape| more.unmapped.contains(shape);
        assert!(more.unmapped.len() == 10 && worlds.unmapped.iter().all(is_in_more));
        assert_eq!(count(&Difference::unmapped(1.0).apply(&map, 1).known), 0);
    }

    #[test]
    fn removed_obstacles_are_mapped_and_never_the_unmapped_ones() {
        let map = posts();
        for seed in 0..20 {
            let both = Difference { unmapped: 0.3, removed: 0.5, ..Difference::default() };
            let worlds = both.apply(&map, seed);
            assert_eq!((worlds.unmapped.len(), worlds.absent.len()), (6, 10));
            let there = (0..20).filter(|&x| worlds.truth.is_inside([f64::from(x), 0.0]));
            assert_eq!(there.count(), 10);
        }
    }

    #[test]
    fn named_and_near_obstacles_are_missing_and_extra_ones_are_there() {
        let map = posts();
        let missing =
            vec![Missing::Named("odd".into()), Missing::Near { at: [4.0, 1.0], within_m: 0.8 }];
        let extra = vec![Shape::Circle { centre: [7.0, 0.0], radius: 0.1 }];
        let worlds = Difference { missing, extra, ..Difference::default() }.apply(&map, 1);
        assert_eq!(count(&worlds.known), 20);
        assert_eq!((worlds.unmapped.len(), worlds.absent.len()), (1, 11));
        for (x, is_there) in [(0.0, true), (1.0, false), (4.0, false), (6.0, true), (7.0, true)] {
            assert_eq!(worlds.truth.is_inside([x, 0.0]), is_there, "{x}");
        }
        assert!(!Missing::Named("zone".into()).is_in(&map));
    }

    #[test]
    fn another_map_replaces_the_obstacles() {
        let mut other = posts();
        other.features.truncate(1);
        other.features.push(post(30.0, "new"));
        let difference = Difference { truth: Some(Box::new(other)), ..Difference::default() };
        let worlds = difference.apply(&posts(), 1);
        assert_eq!((count(&worlds.known), worlds.unmapped.len(), worlds.absent.len()), (20, 1, 19));
        assert!(worlds.truth.is_inside([0.0, 0.0]) && worlds.truth.is_inside([30.0, 0.0]));
        assert!(!worlds.truth.is_inside([5.0, 0.0]));
    }

    /// The shares of the map and of the truth are drawn apart.
    #[test]
    fn obstacles_of_the_truth_are_removed() {
        let mut other = posts();
        other.features.truncate(3);
        let difference = Difference {
            truth: Some(Box::new(other)),
            unmapped: 0.5,
            removed: 1.0,
            ..Difference::default()
        };
        let worlds = difference.apply(&posts(), 1);
        assert_eq!((count(&worlds.known), worlds.absent.len()), (10, 10));
        assert!(worlds.unmapped.is_empty() && worlds.truth.bounds().is_none());
    }

    /// A quarter turn about (1, 0), then 3 m north, at twice the size.
    #[test]
    fn the_world_is_turned_scaled_and_shifted() {
        let placement = Placement {
            about: [1.0, 0.0],
            turn_rad: std::f64::consts::FRAC_PI_2,
            scale: 2.0,
            shift: [0.0, 3.0],
        };
        let difference = Difference { placement, ..Difference::default() };
        let worlds = difference.apply(&posts(), 1);
        for (at, is_there) in
            [([1.0, 3.0], true), ([1.0, 5.0], true), ([1.0, 5.49], true), ([1.0, 5.6], false)]
        {
            assert_eq!(worlds.truth.is_inside(at), is_there, "{at:?}");
        }
        assert_eq!((worlds.unmapped.len(), worlds.absent.len()), (20, 20));
        let back = placement.undo(placement.apply([4.0, -7.0]));
        assert!((back[0] - 4.0).abs() < 1e-12 && (back[1] + 7.0).abs() < 1e-12);
    }

    /// Two blocks of cells, one of them L-shaped, that touch at a corner only.
    #[test]
    fn connected_cells_are_one_obstacle() {
        let occupied = Bitmap::from_fn(5, 5, |cell| {
            matches!((cell.column, cell.row), (0 | 1, 0) | (1, 1) | (2 | 3, 2))
        });
        let cells = CellMap {
            resolution_m: 0.5,
            corner: [0.0, 0.0],
            unknown: Bitmap::new(5, 5),
            occupied,
            unknown_as: maps::Unknown::Free,
            turned_from: None,
        };
        let map = Map::of_cells(cells);
        assert_eq!(count(&map), 2);
        let worlds = Difference::unmapped(0.5).apply(&map, 3);
        let left = worlds.known.cells.as_ref().map(|cells| cells.occupied.count());
        assert_eq!(left.expect("cells") + worlds.unmapped.len(), 5);
        assert!(worlds.truth.is_inside([0.7, 0.7]) && worlds.truth.is_inside([1.2, 1.2]));
        let placement = Placement { shift: [10.0, 0.0], ..Placement::HERE };
        let moved = Difference { placement, ..Difference::default() }.apply(&map, 3).truth;
        assert!(moved.is_inside([10.7, 0.7]) && !moved.is_inside([0.7, 0.7]));
        assert_eq!(moved.range([9.0, 0.25], 0.0, 9.0), Some(1.0));
    }
}
