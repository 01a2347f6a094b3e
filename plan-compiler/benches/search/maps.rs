//! Maps for the benchmark, drawn from seeds.

use ::maps::Bitmap;
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::{LEAST, MOST, Tolls};
use plan_format::{Cell, Direction};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The map classes, square.
pub(crate) fn all(side: u32) -> Vec<(&'static str, Bitmap)> {
    vec![
        ("empty", Bitmap::new(side, side)),
        ("rectangles", rectangles(side)),
        ("city", city(side)),
        ("noise", noise(side)),
        ("maze", maze(side)),
    ]
}

/// Cities with tolls, square.
pub(crate) fn tolled(side: u32) -> Vec<(&'static str, Terrain)> {
    let map = city(side);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let any = Tolls::from_fn(side, side, |_| random.random_range(LEAST..=MOST));
    let kinds = [("city, bands", bands(&map)), ("city, areas", areas(side)), ("city, random", any)];
    kinds.map(|(name, tolls)| (name, Terrain::new(map.clone()).with_tolls(tolls))).into()
}

/// Three bands around obstacles, one cell each: factors 3, 2 and 1.5.
fn bands(map: &Bitmap) -> Tolls {
    let side = map.columns();
    let near = |cell: Cell, radius: u32| {
        let reach = |at: u32| at.saturating_sub(radius)..side.min(at + radius + 1);
        reach(cell.row).any(|row| reach(cell.column).any(|column| map.get(Cell::new(column, row))))
    };
    let factors = [24, 16, 12];
    Tolls::from_fn(side, side, |cell| {
        (1..=3)
            .find(|&radius| near(cell, radius))
            .map_or(LEAST, |radius| factors[radius as usize - 1])
    })
}

/// Rectangles of 30 to 99 cells a side with factors 1.5 and 2 over about a third of the map.
fn areas(side: u32) -> Tolls {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut factors = vec![LEAST; (side * side) as usize];
    let mut covered = 0;
    while covered < side * side * 2 / 5 {
        let [west, south] = [(); 2].map(|()| random.random_range(0..side));
        let [width, height] = [(); 2].map(|()| random.random_range(30..100));
        let factor = if random.random_range(0..2) == 0 { 12 } else { 16 };
        for row in south..side.min(south + height) {
            for column in west..side.min(west + width) {
                factors[(row * side + column) as usize] = factor;
            }
        }
        covered += width * height;
    }
    Tolls::from_fn(side, side, |cell| factors[(cell.row * side + cell.column) as usize])
}

/// The cells of a map in row-major order.
pub(crate) fn cells(map: &Bitmap) -> impl Iterator<Item = Cell> + use<> {
    let (columns, rows) = (map.columns(), map.rows());
    (0..rows).flat_map(move |row| (0..columns).map(move |column| Cell::new(column, row)))
}

/// The free cell nearest to the middle.
pub(crate) fn central(map: &Bitmap) -> Cell {
    let middle = [map.columns() / 2, map.rows() / 2];
    let distance = |cell: &Cell| {
        let [x, y] = [cell.column.abs_diff(middle[0]), cell.row.abs_diff(middle[1])];
        u64::from(x).pow(2) + u64::from(y).pow(2)
    };
    cells(map).filter(|&cell| !map.get(cell)).min_by_key(distance).expect("a free cell")
}

/// Rectangles of 4 to 23 cells a side until 20 % is covered.
fn rectangles(side: u32) -> Bitmap {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut map = Bitmap::new(side, side);
    while map.count() < (side * side / 5) as usize {
        let [column, row] = [(); 2].map(|()| random.random_range(0..side));
        let [width, height] = [(); 2].map(|()| random.random_range(4..24));
        fill(&mut map, column, row, width, height);
    }
    map
}

fn fill(map: &mut Bitmap, column: u32, row: u32, width: u32, height: u32) {
    for row in row..row + height {
        map.fill(row, column, column + width);
    }
}

/// Streets of 6 to 13 cells between blocks of 30 to 89, built up along their edges with
/// houses of different depths and gaps between them; one block in eight is a park.
fn city(side: u32) -> Bitmap {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut map = Bitmap::new(side, side);
    let mut row = 0;
    while row < side {
        let depth = random.random_range(30..90);
        let mut column = random.random_range(0..20);
        while column < side {
            let width = random.random_range(30..90);
            if random.random_range(0..8) != 0 {
                houses(&mut random, &mut map, [column, row], [width, depth]);
            }
            column += width + random.random_range(6..14);
        }
        row += depth + random.random_range(6..14);
    }
    map
}

/// Houses along the four edges of a block.
fn houses(random: &mut ChaCha8Rng, map: &mut Bitmap, [x, y]: [u32; 2], [width, depth]: [u32; 2]) {
    for far in [false, true] {
        let mut along = 0;
        while along < width {
            let house = random.random_range(8..20).min(width - along);
            let deep = random.random_range(6..14);
            fill(map, x + along, if far { y + depth - deep } else { y }, house, deep);
            along += house + if random.random_range(0..3) == 0 { 3 } else { 0 };
        }
        let mut along = 14;
        while along + 14 < depth {
            let house = random.random_range(8..20).min(depth - 14 - along);
            let deep = random.random_range(6..14);
            fill(map, if far { x + width - deep } else { x }, y + along, deep, house);
            along += house + if random.random_range(0..3) == 0 { 3 } else { 0 };
        }
    }
}

/// Every fifth cell blocked, at random.
fn noise(side: u32) -> Bitmap {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    Bitmap::from_fn(side, side, |_| random.random_range(0..5) == 0)
}

/// Largest side of a maze with only one route between any two cells; in larger ones the route could
/// exceed the largest representable cost.
const LARGEST_TREE: u32 = 2_048;

/// Corridors one cell wide that branch at random, with one route between any two cells up to
/// [`LARGEST_TREE`].
fn maze(side: u32) -> Bitmap {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut map = Bitmap::from_fn(side, side, |_| true);
    let start = Cell::new(1, 1);
    map.set(start, false);
    let mut trail = vec![start];
    while let Some(&cell) = trail.last() {
        let steps = [Direction::E, Direction::N, Direction::W, Direction::S];
        let ways: Vec<[Cell; 2]> = steps
            .into_iter()
            .filter_map(|direction| {
                let wall = cell.neighbour(direction, side - 1, side - 1)?;
                let next = wall.neighbour(direction, side - 1, side - 1)?;
                map.get(next).then_some([wall, next])
            })
            .filter(|[_, next]| next.column > 0 && next.row > 0)
            .collect();
        match ways.choose(&mut random) {
            Some(&[wall, next]) => {
                map.set(wall, false);
                map.set(next, false);
                trail.push(next);
            }
            None => {
                trail.pop();
            }
        }
    }
    if side > LARGEST_TREE {
        for wall in cells(&map).filter(|cell| (cell.column + cell.row) % 2 == 1) {
            let is_inside = [wall.column, wall.row].iter().all(|&at| 0 < at && at < side - 2);
            if is_inside && random.random_range(0..50) == 0 {
                map.set(wall, false);
            }
        }
    }
    map
}
