//! Compares the search with other crates that find the same field, on the same maps in the same
//! run.
//!
//! `cargo bench -p wayfield-plan-compiler --bench search` measures with criterion and prints the table
//! of `BENCHMARKS.md`: nanoseconds per cell of the map (free or not) for one whole field from one goal. It
//! uses one thread, reuses buffers if the crate can, and measures each kind of vector unit of the
//! machine. The table also shows how many times faster the search is than the fastest other crate
//! under the same corner rule and tolls, the extra time for escapes from blocked cells, and the time to pack
//! the field into a layer. Every other crate's costs are compared with the search's before it is
//! timed.
//!
//! `SIDES=250,1024,4096` chooses other sizes; above 1,024 the crates that keep costs in hash maps
//! are left out, since they would need gigabytes. `ROUNDS=5` measures everything five times: a
//! shared machine may be slow for minutes, which would distort some rows only.

mod maps;
mod peers;

use ::maps::Bitmap;
use criterion::{Criterion, SamplingMode, Throughput};
use peers::{Eikonal, GridSearch, Ground, Petgraph, pathfinding};
use plan_compiler::field::{Field, UNREACHED};
use plan_compiler::pack::pack;
use plan_compiler::search::{Corners, Query, Solver, Vectors};
use plan_compiler::terrain::Terrain;
use plan_format::Cell;
use plan_format::grid::STRAIGHT_STEP;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Duration;

const RULES: [(Corners, &str); 2] = [(Corners::Forbid, "forbid"), (Corners::Allow, "allow")];
const WITH_ESCAPES: &str = "wayfield + escapes";
const PACKING: &str = "wayfield packing";
/// Prefix of the benchmarks of the search itself, before the kind of vector unit.
const OURS: &str = "wayfield";
/// Largest side for the crates with hash maps.
const LARGEST_HASHED: u32 = 1_024;

fn main() {
    let output = Path::new(env!("CARGO_TARGET_TMPDIR")).join("search-bench");
    // The table must not show results of an earlier run.
    let _ = std::fs::remove_dir_all(&output);
    let mut criterion = Criterion::default()
        .output_directory(&output)
        .without_plots()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800))
        .configure_from_args();
    let mut names = Vec::new();
    for round in 1..=rounds() {
        for side in sides() {
            for (name, map) in maps::all(side) {
                let goal = maps::central(&map);
                for (corners, rule) in RULES {
                    let group = format!("{name} {side} {rule}");
                    let terrain = Terrain::new(map.clone());
                    measure(&mut criterion, &in_round(&group, round), &terrain, goal, corners);
                    if round == 1 {
                        names.push((group, f64::from(side) * f64::from(side)));
                    }
                }
            }
            for (name, terrain) in maps::tolled(side) {
                let goal = maps::central(&terrain.blocked);
                let group = format!("{name} {side} forbid");
                let name = in_round(&group, round);
                measure(&mut criterion, &name, &terrain, goal, Corners::Forbid);
                if round == 1 {
                    names.push((group, f64::from(side) * f64::from(side)));
                }
            }
        }
    }
    criterion.final_summary();
    print_table(&output, &names);
}

fn ours(vectors: Vectors) -> String {
    format!("{OURS} {}", vectors.name())
}

fn in_round(group: &str, round: u32) -> String {
    format!("{group} round {round}")
}

/// Number of rounds. Each round measures everything.
fn rounds() -> u32 {
    std::env::var("ROUNDS").map_or(2, |chosen| chosen.parse().expect("ROUNDS is a number"))
}

fn sides() -> Vec<u32> {
    let chosen = std::env::var("SIDES").unwrap_or_else(|_| "250,1024".into());
    chosen.split(',').map(|side| side.trim().parse().expect("SIDES is a list of numbers")).collect()
}

fn measure(criterion: &mut Criterion, name: &str, terrain: &Terrain, goal: Cell, corners: Corners) {
    let map = &terrain.blocked;
    let mut group = criterion.benchmark_group(name);
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(u64::from(map.columns()) * u64::from(map.rows())));

    let mut solver = Solver::new();
    let query = Query { terrain, goals: &[goal], corners };
    let mut field = solver.solve(&query);
    let check = Check { field: field.clone(), map };
    for vectors in Vectors::all() {
        let mut solver = Solver::new().with_vectors(vectors);
        group.bench_function(ours(vectors), |b| {
            b.iter(|| solver.routes_into(black_box(&query), &mut field));
        });
    }
    group.bench_function(WITH_ESCAPES, |b| {
        b.iter(|| solver.solve_into(black_box(&query), &mut field));
    });

    group.bench_function(PACKING, |b| b.iter(|| pack(black_box(&check.field))));

    let ground = Ground::new(&query);
    let mut grid_search = GridSearch::new(&ground);
    grid_search.solve(goal);
    check.compare("grid_search", |cell| grid_search.cost(cell).map(f64::from));
    group.bench_function("grid_search", |b| b.iter(|| grid_search.solve(black_box(goal))));

    if corners == Corners::Allow {
        let eikonal = Eikonal::new(map);
        let result = eikonal.solve(goal);
        check.compare("eikonal", |cell| {
            let distance = result.distance()[[cell.row as usize, cell.column as usize]];
            distance.is_finite().then(|| distance * f64::from(STRAIGHT_STEP))
        });
        group.bench_function("eikonal", |b| b.iter(|| eikonal.solve(black_box(goal))));
    } else if map.columns() <= LARGEST_HASHED {
        let costs = pathfinding(&ground);
        check.compare("pathfinding", |cell| costs(cell).map(f64::from));
        group.bench_function("pathfinding", |b| {
            b.iter(|| pathfinding(black_box(&ground)));
        });
        let petgraph = Petgraph::new(&ground);
        let costs = petgraph.solve(goal);
        check.compare("petgraph", |cell| costs(cell).map(f64::from));
        group.bench_function("petgraph", |b| b.iter(|| petgraph.solve(black_box(goal))));
    }
    group.finish();
}

/// The field that the other crates must find.
struct Check<'a> {
    field: Field,
    map: &'a Bitmap,
}

impl Check<'_> {
    fn compare(&self, name: &str, cost: impl Fn(Cell) -> Option<f64>) {
        for (cell, &ours) in maps::cells(self.map).zip(&self.field.cost) {
            let theirs = cost(cell);
            assert_eq!(theirs.is_none(), ours == UNREACHED, "{name} {cell:?}");
            // Some crates use floating point and the exact square root of two.
            let apart = theirs.map_or(0.0, |theirs| (theirs - f64::from(ours)).abs());
            assert!(apart <= f64::from(ours) * 1e-7 + 1e-6, "{name} {cell:?} {theirs:?} {ours}");
        }
    }
}

/// The best nanoseconds per cell of each benchmark of a group in all rounds.
fn results(output: &Path, group: &str, cells: f64) -> BTreeMap<String, f64> {
    let mut best: BTreeMap<String, f64> = BTreeMap::new();
    for (name, time) in (1..=rounds()).flat_map(|round| written(output, &in_round(group, round))) {
        best.entry(name).and_modify(|best| *best = best.min(time)).or_insert(time);
    }
    best.values_mut().for_each(|time| *time /= cells);
    best
}

/// The best nanoseconds of each benchmark of a group that criterion has written.
fn written(output: &Path, group: &str) -> BTreeMap<String, f64> {
    let read = |folder: PathBuf| -> Option<(String, f64)> {
        let text = std::fs::read_to_string(folder.join("new/sample.json")).ok()?;
        let sample: serde_json::Value = serde_json::from_str(&text).ok()?;
        let numbers = |name: &str| -> Option<Vec<f64>> {
            sample[name].as_array()?.iter().map(serde_json::Value::as_f64).collect()
        };
        let each = numbers("times")?.into_iter().zip(numbers("iters")?);
        let best = each.map(|(time, count)| time / count).fold(f64::INFINITY, f64::min);
        Some((folder.file_name()?.to_str()?.to_owned(), best))
    };
    let folders = std::fs::read_dir(output.join(group)).into_iter().flatten().flatten();
    folders.filter_map(|entry| read(entry.path())).collect()
}

fn print_table(output: &Path, groups: &[(String, f64)]) {
    let ours: Vec<String> = Vectors::all().into_iter().map(ours).collect();
    let others = [WITH_ESCAPES, PACKING, "grid_search", "eikonal", "pathfinding", "petgraph"];
    let columns: Vec<&str> = ours.iter().map(String::as_str).chain(others).collect();
    println!(
        "\nns per cell, the best of all samples; times faster than the fastest other crate, with \
         each kind of vector unit\n"
    );
    println!("| map, side, corners | {} | faster |", columns.join(" | "));
    println!("|---|{}---|", "---|".repeat(columns.len()));
    for (group, cells) in groups {
        let results = results(output, group, *cells);
        // A filter on the command line leaves rows out.
        if results.is_empty() {
            continue;
        }
        let shown: Vec<String> = columns
            .iter()
            .map(|&column| results.get(column).map_or(String::new(), |time| format!("{time:.2}")))
            .collect();
        let others = results.iter().filter(|(name, _)| !name.starts_with(OURS));
        let fastest = others.map(|(_, &time)| time).fold(f64::INFINITY, f64::min);
        let faster: Vec<String> = ours
            .iter()
            .filter_map(|ours| results.get(ours))
            .filter(|_| fastest.is_finite())
            .map(|ours| format!("{:.0} x", fastest / ours))
            .collect();
        println!("| {group} | {} | {} |", shown.join(" | "), faster.join(", "));
    }
}
