//! The memory that a build needs, computed before the build starts.
//!
//! The searches in flight and the packing of their fields need nearly all of it: a fixed number of
//! bytes a cell. As many searches run at once as fit the limit. If not even one fits, the build is
//! refused.

use super::area::two_digits_up;
use maps::numbers::metres;
use maps::problem::Problem;
use math::scalar::wide;
use plan_format::{Grid, limits};

/// Default limit of a build's memory, bytes.
pub(super) const DEFAULT_LIMIT_BYTES: u64 = 4 << 30;
/// Upper bound of the bytes a cell for one search and its packing: measured 27 on open maps and 45
/// in mazes of narrow corridors.
const SEARCH_BYTES_PER_CELL: u64 = 48;
/// What tolls add to that: measured 48 on maps with areas and 58 with a factor of its own for each cell.
const TOLLED_SEARCH_BYTES_PER_CELL: u64 = 64;
/// Bytes a cell for the tolls and the speed limits of a layer.
const TOLLS_BYTES_PER_CELL: u64 = 3;
/// Upper bound of the bytes for everything else, packed layers of common maps included.
const BASE_BYTES: u64 = 64 << 20;

/// The layers of a build.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels {
    pub(super) count: usize,
    /// Whether any of them has tolls or speed limits.
    pub(super) have_tolls: bool,
}

/// What a build needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Number of searches that run at once.
    pub in_flight: usize,
    /// Bytes in total.
    pub bytes: u64,
}

impl Need {
    /// The need of `jobs` searches over the terrains of a grid; `None` if even one search at a
    /// time exceeds the limit.
    pub(super) fn within(
        limit_bytes: u64,
        grid: &Grid,
        levels: Levels,
        jobs: usize,
        threads: usize,
    ) -> Option<Self> {
        let (fixed, search) = parts(grid, levels);
        let room = limit_bytes.checked_sub(fixed)? / search.max(1);
        let in_flight = room.min(threads as u64).min(jobs.max(1) as u64);
        let bytes = fixed + in_flight * search;
        (in_flight > 0).then_some(Self { in_flight: in_flight as usize, bytes })
    }
}

/// The fixed bytes of a build, and the bytes of each search in flight.
fn parts(grid: &Grid, levels: Levels) -> (u64, u64) {
    let (cells, count) = (grid.cells() as u64, levels.count as u64);
    let tolls = if levels.have_tolls { count * cells * TOLLS_BYTES_PER_CELL } else { 0 };
    (BASE_BYTES + count * cells.div_ceil(8) + tolls, cells * search_bytes_per_cell(levels))
}

fn search_bytes_per_cell(levels: Levels) -> u64 {
    if levels.have_tolls { TOLLED_SEARCH_BYTES_PER_CELL } else { SEARCH_BYTES_PER_CELL }
}

/// Returns an error if not even one search at a time fits the limit.
pub(super) fn check(limit_bytes: u64, grid: &Grid, levels: Levels) -> Option<Problem> {
    if Need::within(limit_bytes, grid, levels, 1, 1).is_some() {
        return None;
    }
    let (fixed, search) = parts(grid, levels);
    let (columns, rows, needed) = (grid.columns, grid.rows, fixed + search);
    let message = format!(
        "{columns} x {rows} cells need up to {} of memory to search, but a build may use {}",
        gib(needed),
        gib(limit_bytes)
    );
    let tenths = wide::ceil(10.0 * needed as f64 / GIB) / 10.0;
    // The number of cells that fit.
    let tolls = if levels.have_tolls { levels.count as u64 * TOLLS_BYTES_PER_CELL } else { 0 };
    let all = search_bytes_per_cell(levels) + tolls + 1;
    let room = limit_bytes.saturating_sub(BASE_BYTES) / all;
    let coarser = grid.resolution_m * wide::sqrt(grid.cells() as f64 / room as f64);
    let coarser = if coarser <= limits::RESOLUTION_RANGE_M.1 {
        format!(", a --resolution of {} or coarser", metres(two_digits_up(coarser)))
    } else {
        String::new()
    };
    Some(Problem::error(message).help(format!(
        "--max-memory {tenths} if the machine has that much{coarser}, or a smaller area"
    )))
}

const GIB: f64 = (1u64 << 30) as f64;

/// An amount of memory as text.
pub fn gib(bytes: u64) -> String {
    let gib = bytes as f64 / GIB;
    if gib < 1.0 { format!("{:.0} MiB", gib * 1024.0) } else { format!("{gib:.1} GiB") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels(count: usize) -> Levels {
        Levels { count, have_tolls: false }
    }

    fn grid(side: u32) -> Grid {
        Grid { columns: side, rows: side, resolution_m: 0.5, corner_m: [0.0, 0.0] }
    }

    #[test]
    fn as_many_searches_run_as_there_is_room_for() {
        let in_flight = |side, jobs, threads| {
            Need::within(DEFAULT_LIMIT_BYTES, &grid(side), levels(2), jobs, threads)
                .map(|n| n.in_flight)
        };
        assert_eq!(in_flight(250, 8, 4), Some(4));
        assert_eq!(in_flight(250, 2, 4), Some(2));
        assert_eq!(in_flight(250, 0, 4), Some(1));
        assert_eq!(in_flight(8192, 8, 4), Some(1));
        assert_eq!(in_flight(16_384, 8, 4), None);
        let all = Need::within(u64::MAX, &grid(16_384), levels(1), 1, 8).unwrap();
        assert_eq!(all.bytes, (64 << 20) + (1 << 25) + 48 * (1 << 28));
        let tolled = Levels { count: 1, have_tolls: true };
        let tolled = Need::within(u64::MAX, &grid(16_384), tolled, 1, 8).unwrap();
        assert_eq!(tolled.bytes - all.bytes, 19 * (1 << 28));
    }

    #[test]
    fn what_is_advised_fits() {
        let tolled = Levels { count: 2, have_tolls: true };
        for (limit_bytes, levels) in [200 << 20, DEFAULT_LIMIT_BYTES]
            .into_iter()
            .flat_map(|bytes| [(bytes, levels(2)), (bytes, tolled)])
        {
            let help = check(limit_bytes, &grid(16_384), levels).unwrap().help.unwrap();
            let number = |after: &str| -> f64 {
                let text = help.split_once(after).unwrap().1;
                text.split([' ', ',']).next().unwrap().parse().unwrap()
            };
            let more = (number("--max-memory ") * GIB) as u64;
            assert!(check(more, &grid(16_384), levels).is_none(), "{help}");
            let side = (f64::from(16_384) * 0.5 / number("--resolution of ")) as u32;
            assert!(check(limit_bytes, &grid(side), levels).is_none(), "{help}");
        }
    }
}
