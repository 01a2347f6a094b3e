//! Sizes of layers on maps of every kind.

mod tolls;

use super::draft;
use maps::Bitmap;
use plan_compiler::field::Field;
use plan_compiler::search::{Corners, Query, Solver};
use plan_compiler::terrain::Terrain;
use plan_format::{Blob, Cell, write};

/// Cells along a side of a city.
const CITY: u32 = 1024;

/// Sizes on one map, bytes per cell.
#[derive(Clone, Copy)]
struct Size {
    /// Of a whole blob with one layer.
    first: f64,
    /// Of a further layer with another goal.
    further: f64,
}

#[test]
fn cities_fit_their_budget() {
    let mut sizes: Vec<Size> =
        (1..=4).map(|seed| size(&format!("city {seed}"), &city(seed))).collect();
    if let Some(folder) = it::real_data("movingai") {
        let text = std::fs::read_to_string(folder.join("Berlin_0_1024.map")).unwrap();
        let lines: Vec<&[u8]> = text.lines().skip(4).map(str::as_bytes).collect();
        let blocked =
            |cell: Cell| lines[(CITY - 1 - cell.row) as usize][cell.column as usize] != b'.';
        sizes.push(size("Berlin", &Bitmap::from_fn(CITY, CITY, blocked)));
    }
    let mean = sizes.iter().map(|size| size.first).sum::<f64>() / sizes.len() as f64;
    assert!(mean <= 0.15, "{mean} bytes a cell on average");
    assert!(sizes.iter().all(|size| size.first <= 0.22 && size.further <= 0.18));
}

#[test]
fn rectangles_fit_their_budget() {
    for seed in 1..=3 {
        // A fifth of the map under rectangles with sides of 2 to 40 cells.
        let map = rectangles(&mut Random(seed), 250, 20, 2..41);
        let Size { first, .. } = size(&format!("rectangles {seed}"), &map);
        assert!(first * 250.0 * 250.0 <= 12_000.0, "{first} bytes a cell");
    }
}

/// On maps without repetition, roots, palettes and descriptors save nothing. Each block can fall
/// back to plain cells.
#[test]
fn noise_and_mazes_take_less_than_plain_arrays() {
    for percent in [1, 5, 20, 40] {
        let mut random = Random(percent.into());
        let map = Bitmap::from_fn(256, 256, |_| random.below(100) < percent);
        assert!(size(&format!("noise {percent} %"), &map).first < 2.5);
    }
    assert!(size("maze", &maze(251)).first < 2.5);
    assert!(size("nothing", &Bitmap::new(512, 512)).first < 0.01);
}

/// Builds the blobs of a map and prints their sizes as a line of the table.
fn size(name: &str, map: &Bitmap) -> Size {
    let (columns, rows) = (map.columns(), map.rows());
    let mut solver = Solver::new();
    let terrain = Terrain::new(map.clone());
    let fields = free_goals(map).map(|goal| {
        solver.solve(&Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid })
    });
    let bytes = |fields: &[Field]| write(&draft(fields)).unwrap();
    let (one, two) = (bytes(&fields[..1]), bytes(&fields));
    let a_cell = |bytes: usize| bytes as f64 / (f64::from(columns) * f64::from(rows));
    let size = Size { first: a_cell(one.len()), further: a_cell(two.len() - one.len()) };
    let layer = Blob::parse(&one).unwrap().parallel_plan(0).unwrap().layer(0).unwrap();
    println!(
        "{name:>14}: {:7} bytes, {:.3} a cell, {:.3} a further layer, {:.1} raw",
        one.len(),
        size.first,
        size.further,
        a_cell(layer.raw_bytes()),
    );
    assert!(layer.bytes() < layer.raw_bytes());
    size
}

/// A goal in the middle and one in the north-west, in the first free cells north-east of there.
fn free_goals(map: &Bitmap) -> [Cell; 2] {
    let (columns, rows) = (map.columns(), map.rows());
    [(columns / 2, rows / 2), (columns / 5, rows * 7 / 10)].map(|(column, row)| {
        let cells = (row..rows).flat_map(|row| (column..columns).map(move |column| (column, row)));
        let mut cells = cells.map(|(column, row)| Cell::new(column, row));
        cells.find(|&cell| !map.get(cell)).expect("a free cell")
    })
}

/// Random numbers that are the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u32) -> u32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % u64::from(end)) as u32
    }

    fn within(&mut self, range: std::ops::Range<u32>) -> u32 {
        range.start + self.below(range.end - range.start)
    }
}

/// A rectangle of cells: west, south, east, north.
type Rectangle = [u32; 4];

fn fill(map: &mut Bitmap, [west, south, east, north]: Rectangle, value: bool) {
    for row in south..north.min(map.rows()) {
        for column in west..east.min(map.columns()) {
            map.set(Cell::new(column, row), value);
        }
    }
}

fn rectangles(
    random: &mut Random,
    side: u32,
    percent: usize,
    sides: std::ops::Range<u32>,
) -> Bitmap {
    let mut map = Bitmap::new(side, side);
    while map.count() * 100 < percent * (side * side) as usize {
        let (west, south) = (random.below(side), random.below(side));
        let (width, height) = (random.within(sides.clone()), random.within(sides.clone()));
        fill(&mut map, [west, south, west + width, south + height], true);
    }
    map
}

/// A city of blocks between streets: parks with trees, buildings around courtyards, and houses, with
/// avenues across them. It has about twice as many walls as the real city.
fn city(seed: u64) -> Bitmap {
    let random = &mut Random(seed);
    let mut map = Bitmap::new(CITY, CITY);
    let (columns, rows) = (between_streets(random), between_streets(random));
    for &(west, east) in &columns {
        for &(south, north) in &rows {
            let block = [west, south, east, north];
            match random.below(10) {
                0 => park(&mut map, random, block),
                1..=4 => courtyard(&mut map, random, block),
                _ => houses(&mut map, random, block),
            }
        }
    }
    for _ in 0..random.within(1..4) {
        avenue(&mut map, random);
    }
    map
}

fn between_streets(random: &mut Random) -> Vec<(u32, u32)> {
    let mut blocks = Vec::new();
    let mut at = random.below(40);
    while at + 16 < CITY {
        let end = (at + random.within(50..170)).min(CITY);
        if end - at > 16 {
            blocks.push((at, end));
        }
        at = end + random.within(6..16);
    }
    blocks
}

fn park(map: &mut Bitmap, random: &mut Random, [west, south, east, north]: Rectangle) {
    for _ in 0..(east - west) * (north - south) / 600 {
        let (column, row) = (random.within(west..east), random.within(south..north));
        let size = random.within(1..4);
        fill(map, [column, row, column + size, row + size], true);
    }
}

fn courtyard(map: &mut Bitmap, random: &mut Random, block: Rectangle) {
    fill(map, block, true);
    let [west, south, east, north] = block;
    let depth = random.within(9..18);
    if east - west > 2 * depth + 8 && north - south > 2 * depth + 8 {
        fill(map, [west + depth, south + depth, east - depth, north - depth], false);
        let passage = random.within(west + depth..east - depth - 4);
        fill(map, [passage, south, passage + 4, south + depth], false);
    }
}

fn houses(map: &mut Bitmap, random: &mut Random, [west, south, east, north]: Rectangle) {
    let mut column = west;
    while column + 8 < east {
        let width = random.within(20..60).min(east - column);
        let mut row = south;
        while row + 8 < north {
            let height = random.within(20..60).min(north - row);
            let gap = random.within(1..5).min(width / 3).min(height / 3);
            if random.below(5) > 0 {
                let house = [column + gap, row + gap, column + width - gap, row + height - gap];
                fill(map, house, true);
            }
            row += height;
        }
        column += width;
    }
}

/// A street straight across the city in any direction.
fn avenue(map: &mut Bitmap, random: &mut Random) {
    let [from, to] = [random.below(CITY), random.below(CITY)].map(i64::from);
    let (is_upright, width) = (random.below(2) == 0, i64::from(random.within(8..20)));
    let side = i64::from(CITY);
    for along in 0..side {
        let middle = from + (to - from) * along / side;
        for across in (middle - width / 2).max(0)..(middle + width / 2).min(side) {
            let (column, row) = if is_upright { (across, along) } else { (along, across) };
            map.set(Cell::new(column as u32, row as u32), false);
        }
    }
}

/// A maze with corridors of one cell, by depth-first search. The side is odd.
fn maze(side: u32) -> Bitmap {
    let mut random = Random(1);
    let mut map = Bitmap::from_fn(side, side, |_| true);
    let mut path = vec![(1u32, 1u32)];
    map.set(Cell::new(1, 1), false);
    while let Some(&(column, row)) = path.last() {
        let ways = [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().filter(|&(dx, dy)| {
            let next = (column.wrapping_add_signed(2 * dx), row.wrapping_add_signed(2 * dy));
            next.0 < side && next.1 < side && map.get(Cell::new(next.0, next.1))
        });
        let ways: Vec<(i32, i32)> = ways.collect();
        let Some(&(dx, dy)) = ways.get(random.below(4) as usize % ways.len().max(1)) else {
            path.pop();
            continue;
        };
        let (column, row) = (column.wrapping_add_signed(dx), row.wrapping_add_signed(dy));
        map.set(Cell::new(column, row), false);
        let (column, row) = (column.wrapping_add_signed(dx), row.wrapping_add_signed(dy));
        map.set(Cell::new(column, row), false);
        path.push((column, row));
    }
    map
}
