//! Speed limits by masks, and how many different limits a blob holds.
//!
//! A cell has the lowest limit of the pixels that it overlaps. Masks with many shades have more limits
//! than a blob holds: then some of them are lowered to the next lower one, those first that slow the
//! robot least over all their cells. A limit is never raised.

use super::tolls::{slower, too_high};
use crate::field;
use crate::input::Input;
use crate::layers::Limits;
use crate::mission::SpeedMask;
use crate::tolls::{LEAST, Tolls};
use maps::Bitmap;
use maps::problem::{Place, Problem};
use plan_format::{Cell, Grid};
use std::collections::BTreeMap;

/// Different speed limits in one blob.
const MAX_LIMITS: usize = 15;
/// Lowest limit, m/s: as for speed zones.
const LOWEST_MPS: f64 = 0.05;

/// The limits of all masks of a mission on a grid.
pub(super) struct MaskLimits<'a> {
    input: &'a Input<'a>,
    grid: &'a Grid,
    masks: Vec<OneMask<'a>>,
}

struct OneMask<'a> {
    mask: &'a SpeedMask,
    /// By cell, cm/s.
    limits: Vec<Limit>,
}

/// What a mask says about a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Limit {
    None,
    /// At most this, cm/s.
    At(u16),
    /// Below the lowest limit.
    TooLow,
}

impl<'a> MaskLimits<'a> {
    /// Reads the masks over a grid, and lowers limits until all limits of the mission fit a blob.
    pub(super) fn new(input: &'a Input<'a>, grid: &'a Grid, problems: &mut Vec<Problem>) -> Self {
        let mut masks = Vec::new();
        for mask in &input.mission.speed_masks {
            if let Some(problem) = misplaced(mask, grid) {
                problems.push(problem);
            }
            if mask.shades.fits(grid) {
                masks.push(OneMask { mask, limits: limits(input, mask, grid) });
            }
        }
        let mut all = Self { input, grid, masks };
        all.lower(problems);
        all
    }

    /// Lowers limits until all fit.
    fn lower(&mut self, problems: &mut Vec<Problem>) {
        let zones = self.input.mission.layers.iter().flat_map(|rule| &rule.tolls.speed);
        // How many cells have each limit of a mask; none for a limit of a zone, which stays.
        let mut cells: BTreeMap<u16, Option<usize>> = BTreeMap::new();
        for zone in zones {
            cells.insert(Limits::in_cmps(zone.limit_mps), None);
        }
        for limit in self.masks.iter().flat_map(|one| &one.limits) {
            if let Limit::At(limit) = limit
                && let Some(count) = cells.entry(*limit).or_insert(Some(0))
            {
                *count += 1;
            }
        }
        let different = cells.len();
        while cells.len() > MAX_LIMITS {
            let pairs = cells.iter().zip(cells.iter().skip(1));
            let loss = |lower: u16, limit: u16, count: usize| {
                count as f64 * f64::from(limit - lower) / f64::from(limit)
            };
            let best = pairs
                .filter_map(|((&lower, _), (&limit, &count))| {
                    Some((loss(lower, limit, count?), lower, limit, count?))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            // Only limits of zones are left: those are reported elsewhere.
            let Some((_, lower, limit, count)) = best else { return };
            cells.remove(&limit);
            if let Some(Some(lower)) = cells.get_mut(&lower) {
                *lower += count;
            }
        }
        let Some(first) = self.masks.first().filter(|_| cells.len() < different) else { return };
        let mut most = 0.0f64;
        let place = &first.mask.place;
        for limit in self.masks.iter_mut().flat_map(|one| &mut one.limits) {
            if let Limit::At(at) = limit
                && let Some((&level, _)) = cells.range(..=*at).next_back()
            {
                most = most.max(1.0 - f64::from(level) / f64::from(*at));
                *at = level;
            }
        }
        let percent = (most * 100.0).ceil();
        let message = format!(
            "{different} different speed limits, but a blob holds {MAX_LIMITS}: some are lowered, by at \
             most {percent} %"
        );
        problems.push(
            Problem::warning(message)
                .at(&place.source, place.span.clone(), "of this mask and the others")
                .help("draw the masks with fewer shades, without soft edges"),
        );
    }

    /// Whether a layer has a mask.
    pub(super) fn has(&self, layer: &str) -> bool {
        self.masks.iter().any(|one| one.mask.layer == layer)
    }

    /// Multiplies by the factors of a layer's masks, and lowers the speed limits to theirs. Reports
    /// free cells in which the robot could not drive at all.
    pub(super) fn add(
        &self,
        layer: &str,
        is_free: &dyn Fn(Cell) -> bool,
        tolls: &mut Tolls,
        limits: &mut Limits,
        problems: &mut Vec<Problem>,
    ) {
        let Grid { columns, rows, .. } = *self.grid;
        for OneMask { mask, limits: of_cells } in
            self.masks.iter().filter(|m| m.mask.layer == layer)
        {
            let at = |cell: Cell| of_cells[(cell.row * columns + cell.column) as usize];
            let mut different: Vec<u16> =
                of_cells.iter().filter_map(|limit| limit.cmps()).collect();
            different.sort_unstable();
            different.dedup();
            for &limit in &different {
                let cells = Bitmap::from_fn(columns, rows, |cell| at(cell) == Limit::At(limit));
                limits.lower(&cells, f64::from(limit) / 100.0);
            }
            let factor = |limit: Limit| match limit.cmps() {
                Some(limit) => {
                    mask.eighths.unwrap_or_else(|| slower(self.input, f64::from(limit) / 100.0))
                }
                None => LEAST,
            };
            let cut = tolls.multiply(&Tolls::from_fn(columns, rows, |cell| factor(at(cell))));
            problems.extend(too_high(cut, layer, &mask.place, "this mask"));
            let is_idle = of_cells.iter().all(|&limit| limit == Limit::None);
            let stuck = |cell: &Cell| at(*cell) == Limit::TooLow && is_free(*cell);
            let all = field::cells(self.grid);
            problems.extend(too_low(mask, all.filter(stuck).map(|cell| self.grid.centre(cell))));
            if is_idle && mask.shades.overlaps(self.grid) {
                problems.push(without_effect(mask));
            }
        }
    }
}

impl Limit {
    fn cmps(self) -> Option<u16> {
        if let Self::At(limit) = self { Some(limit) } else { None }
    }
}

/// An error or a warning if a mask does not lie on the grid.
fn misplaced(mask: &SpeedMask, grid: &Grid) -> Option<Problem> {
    let at = |problem: Problem, label: String| {
        let Place { source, span, .. } = &mask.place;
        problem.at(source, span.clone(), label)
    };
    let (name, size) = (mask.path.display(), [mask.shades.columns, mask.shades.rows]);
    if !mask.shades.fits(grid) {
        let message = format!("{name} does not have the cells of the plan");
        let label = format!("{} columns and {} rows", size[0], size[1]);
        let help = format!(
            "the plan has {} columns and {} rows; name a ROS map, a YAML file with `resolution` and \
             `origin`, to lay the image over them",
            grid.columns, grid.rows
        );
        return Some(at(Problem::error(message), label).help(help));
    }
    let message = format!("the mask {name} does not overlap the map");
    (!mask.shades.overlaps(grid)).then(|| {
        at(Problem::warning(message), String::new())
            .help(format!("check its `origin`; {}", super::area::reach(grid)))
    })
}

/// The limit of each cell by a mask.
fn limits(input: &Input<'_>, mask: &SpeedMask, grid: &Grid) -> Vec<Limit> {
    let fastest = f64::from(input.mission.parameters.vehicle.max_speed_mps);
    let of_number = |number: u8| match mask.speed_mps(number, fastest) {
        Some(speed) if speed < LOWEST_MPS => Limit::TooLow,
        Some(speed) if speed < fastest => Limit::At(Limits::in_cmps(speed)),
        _ => Limit::None,
    };
    let strictest = |cell| {
        let limits = mask.shades.over(grid, cell).iter().map(of_number);
        limits.fold(Limit::None, |strictest, limit| match (strictest, limit) {
            (Limit::TooLow, _) | (_, Limit::TooLow) => Limit::TooLow,
            (Limit::At(a), Limit::At(b)) => Limit::At(a.min(b)),
            (Limit::None, other) | (other, Limit::None) => other,
        })
    };
    field::cells(grid).map(strictest).collect()
}

/// An error if a mask stops the robot in free cells, whose centres these are.
fn too_low(mask: &SpeedMask, mut stuck: impl Iterator<Item = [f64; 2]>) -> Option<Problem> {
    let first = stuck.next()?;
    let count = 1 + stuck.count();
    let message = format!(
        "{} gives {count} free cells a speed below {LOWEST_MPS} m/s, the first at {}",
        mask.path.display(),
        maps::numbers::pair(first),
    );
    let help = "keep the robot out of them by a mask `keepout`, or draw them in another shade: \
                limit = base + multiplier x number, and number 0 sets no limit";
    let Place { source, span, .. } = &mask.place;
    Some(Problem::error(message).at(source, span.clone(), "this mask").help(help))
}

/// A warning about a mask without a limit below the top speed.
fn without_effect(mask: &SpeedMask) -> Problem {
    let Place { source, span, .. } = &mask.place;
    let message = format!("{} limits no speed", mask.path.display());
    Problem::warning(message)
        .at(source, span.clone(), "no limit below vehicle.max_speed")
        .help("check `type`, `base` and `multiplier`, and the `mode` of its YAML file")
}

/// An error if the zones of a mission have more different speed limits than a blob holds.
pub(super) fn too_many(input: &Input<'_>) -> Option<Problem> {
    let zones = input.mission.layers.iter().flat_map(|rule| &rule.tolls.speed);
    let mut different: Vec<u16> = Vec::new();
    let last = zones.filter(|zone| {
        let limit = Limits::in_cmps(zone.limit_mps);
        let is_new = !different.contains(&limit);
        different.extend(is_new.then_some(limit));
        is_new && different.len() > MAX_LIMITS
    });
    let place = &last.last()?.area.place;
    let message =
        format!("{} different speed limits, but a blob holds {MAX_LIMITS}", different.len());
    let problem = Problem::error(message).at(&place.source, place.span.clone(), "the last one");
    Some(problem.help("give some areas the same limit"))
}
