//! Sizes of layers with tolls on generated cities, as means.

use super::{CITY, Random, city, draft, free_goals};
use maps::Bitmap;
use plan_compiler::field::Field;
use plan_compiler::search::{Corners, Query, Solver};
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::{LEAST, Tolls};
use plan_format::{Blob, Cell, write};

/// Cities whose mean is tested; `CITIES=8` prints the table of the README.
const TESTED: u64 = 2;

/// What tolls there are in a city.
struct Texture {
    name: &'static str,
    /// Most bytes a cell, as a mean over the cities.
    most: f64,
    tolls: fn(&City) -> Tolls,
}

const TEXTURES: [Texture; 6] = [
    Texture { name: "none", most: 0.15, tolls: |_| Tolls::none(CITY, CITY) },
    Texture { name: "one band", most: 0.45, tolls: |city| city.bands(&[16]) },
    Texture { name: "three bands", most: 0.45, tolls: |city| city.bands(&[24, 16, 12]) },
    Texture { name: "areas", most: 0.45, tolls: City::areas },
    Texture {
        name: "areas and bands",
        most: 0.65,
        tolls: |city| {
            let mut tolls = city.areas();
            tolls.multiply(&city.bands(&[24, 16, 12]));
            tolls
        },
    },
    Texture { name: "gradient", most: 1.3, tolls: City::gradient },
];

struct City {
    seed: u64,
    map: Bitmap,
    /// Cells from each cell to the nearest obstacle, row by row, up to [`FARTHEST`].
    distances: Vec<f64>,
}

/// Beyond this distance, cells, a gradient is below half an eighth.
const FARTHEST: u32 = 80;

impl City {
    fn new(seed: u64) -> Self {
        let map = city(seed);
        let distances = distances(&map);
        Self { seed, map, distances }
    }

    /// Bands of one cell each around obstacles.
    fn bands(&self, eighths: &[u32]) -> Tolls {
        self.tolls(|_, distance| eighths.get(distance as usize - 1).copied().unwrap_or(LEAST))
    }

    /// 1 + 5 / d, where d is the distance from an obstacle in cells.
    fn gradient(&self) -> Tolls {
        self.tolls(|_, distance| (f64::from(LEAST) * (1.0 + 5.0 / distance)).round() as u32)
    }

    /// Rectangles of 30 to 100 cells a side with factors 1.5 and 2 over about a third of the map.
    fn areas(&self) -> Tolls {
        let random = &mut Random(self.seed);
        let mut factors = vec![LEAST; (CITY * CITY) as usize];
        let mut covered = 0;
        while covered < CITY * CITY * 2 / 5 {
            let [west, south] = [random.below(CITY), random.below(CITY)];
            let [width, height] = [random.within(30..101), random.within(30..101)];
            let factor = if random.below(2) == 0 { 12 } else { 16 };
            for row in south..(south + height).min(CITY) {
                let row = &mut factors[(row * CITY) as usize..][..CITY as usize];
                row[west as usize..(west + width).min(CITY) as usize].fill(factor);
            }
            covered += width * height;
        }
        Tolls::from_fn(CITY, CITY, |cell| factors[index(cell)])
    }

    fn tolls(&self, eighths: impl Fn(Cell, f64) -> u32) -> Tolls {
        let distance = |cell: Cell| self.distances[index(cell)].max(1.0);
        Tolls::from_fn(CITY, CITY, |cell| eighths(cell, distance(cell)))
    }
}

fn index(cell: Cell) -> usize {
    (cell.row * CITY + cell.column) as usize
}

/// Cells between the centres of each cell and of the nearest obstacle.
fn distances(map: &Bitmap) -> Vec<f64> {
    // Along the column first, then the least over the row.
    let mut along = vec![FARTHEST; (CITY * CITY) as usize];
    for column in 0..CITY {
        for rows in [(0..CITY).collect::<Vec<_>>(), (0..CITY).rev().collect()] {
            let mut distance = FARTHEST;
            for cell in rows.into_iter().map(|row| Cell::new(column, row)) {
                distance = if map.get(cell) { 0 } else { (distance + 1).min(FARTHEST) };
                along[index(cell)] = along[index(cell)].min(distance);
            }
        }
    }
    let mut distances = Vec::with_capacity(along.len());
    for row in along.chunks(CITY as usize) {
        for column in 0..CITY {
            let mut least = FARTHEST * FARTHEST;
            let mut aside = 0;
            while aside * aside < least {
                for other in [column.wrapping_sub(aside), column + aside] {
                    let here = row.get(other as usize).copied().unwrap_or(FARTHEST);
                    least = least.min(aside * aside + here * here);
                }
                aside += 1;
            }
            distances.push(math::scalar::wide::sqrt(f64::from(least)));
        }
    }
    distances
}

/// Bytes a cell of a blob with one layer, and of a further layer with another goal.
fn sizes(city: &City, tolls: &Tolls) -> [f64; 2] {
    let terrain = Terrain::new(city.map.clone()).with_tolls(tolls.clone());
    let mut solver = Solver::new();
    let fields: [Field; 2] = free_goals(&city.map).map(|goal| {
        solver.solve(&Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid })
    });
    let [one, two] = [&fields[..1], &fields].map(|fields| write(&draft(fields)).unwrap());
    for bytes in [&one, &two] {
        let blob = Blob::parse(bytes).unwrap();
        for layer in blob.parallel_plans().flat_map(|plan| plan.layers()) {
            assert!(layer.bytes() < layer.raw_bytes(), "city {}", city.seed);
        }
    }
    let a_cell = |bytes: usize| bytes as f64 / f64::from(CITY * CITY);
    [a_cell(one.len()), a_cell(two.len() - one.len())]
}

#[test]
fn cities_with_tolls_fit_their_budget() {
    let count = std::env::var("CITIES").map_or(TESTED, |count| count.parse().expect("a number"));
    let mut sums = TEXTURES.map(|_| [0.0, 0.0, 0.0f64]);
    for city in (1..=count).map(City::new) {
        for (texture, [first, further, largest]) in TEXTURES.iter().zip(&mut sums) {
            let [one, more] = sizes(&city, &(texture.tolls)(&city));
            *first += one / count as f64;
            *further += more / count as f64;
            *largest = largest.max(one);
        }
    }
    println!("| tolls of {count} cities | first layer, mean | largest | further layer, mean |");
    println!("|---|---|---|---|");
    for (texture, [first, further, largest]) in TEXTURES.iter().zip(sums) {
        println!("| {} | {first:.3} | {largest:.3} | {further:.3} |", texture.name);
    }
    for (texture, [first, further, _]) in TEXTURES.iter().zip(sums) {
        assert!(first <= texture.most && further <= texture.most, "{}: {first}", texture.name);
    }
}
