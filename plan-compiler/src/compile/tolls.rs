//! The tolls and the speed limits of each layer, from what the mission says about it.

use super::obstacles::Added;
use crate::input::Input;
use crate::layers::Limits;
use crate::mission::{CostMap, LayerRule, Named, SpeedZone};
use crate::tolls::{LEAST, MOST, Tolls};
use maps::problem::Problem;
use maps::raster::{RasterOptions, keep_out, rasterise};
use maps::{Bitmap, Feature};
use plan_format::{Cell, Grid};

/// Different speed limits in one blob.
const MAX_LIMITS: usize = 15;

/// An error if there are more different speed limits than a blob holds.
pub(super) fn too_many_limits(input: &Input<'_>) -> Option<Problem> {
    let zones = input.mission.layers.iter().flat_map(|rule| &rule.tolls.speed);
    let mut different: Vec<f64> = Vec::new();
    let last = zones.filter(|zone| {
        let is_new = !different.contains(&zone.limit_mps);
        different.extend(is_new.then_some(zone.limit_mps));
        is_new && different.len() > MAX_LIMITS
    });
    let place = &last.last()?.area.place;
    let message =
        format!("{} different speed limits, but a blob holds {MAX_LIMITS}", different.len());
    let problem = Problem::error(message).at(&place.source, place.span.clone(), "the last one");
    Some(problem.help("give some areas the same limit"))
}

/// What the tolls of one layer need to know of the layers from the least constrained one up to it.
pub(super) struct Site<'a> {
    pub(super) input: &'a Input<'a>,
    pub(super) grid: &'a Grid,
    pub(super) options: RasterOptions,
    /// What they add as obstacles.
    pub(super) added: &'a [Added<'a>],
}

impl Site<'_> {
    /// Multiplies by the tolls that a layer adds, and lowers the speed limits to its own. Reports
    /// products that were cut.
    pub(super) fn add(
        &self,
        rule: &LayerRule,
        tolls: &mut Tolls,
        limits: &mut Limits,
        problems: &mut Vec<Problem>,
    ) {
        let mut cut = tolls.multiply(&self.areas(rule));
        if let Some(costs) = &rule.tolls.costs {
            match self.of_cells(costs) {
                Ok(factors) => cut += tolls.multiply(&factors),
                Err(problem) => problems.push(problem),
            }
        }
        cut += tolls.multiply(&self.bands(rule));
        for zone in &rule.tolls.speed {
            let cells = self.cells_of(&zone.area);
            limits.lower(&cells, zone.limit_mps);
            let factor = self.factor(zone);
            cut += tolls.multiply(&self.tolls(|cell| if cells.get(cell) { factor } else { LEAST }));
        }
        if cut > 0 {
            let place = &rule.name.place;
            problems.push(
                Problem::warning(format!(
                    "in layer `{}`, tolls multiply to more than {} in {cut} cells, and are cut to it",
                    rule.name.name,
                    MOST / LEAST,
                ))
                .at(&place.source, place.span.clone(), "this layer")
                .help("lower the factors, or list what the robot must not enter as `areas`"),
            );
        }
    }

    fn tolls(&self, eighths: impl FnMut(Cell) -> u32) -> Tolls {
        Tolls::from_fn(self.grid.columns, self.grid.rows, eighths)
    }

    /// The factors of areas; where they overlap, of the last one.
    fn areas(&self, rule: &LayerRule) -> Tolls {
        let areas = rule.tolls.areas.iter();
        let areas: Vec<(Bitmap, u32)> =
            areas.map(|(area, eighths)| (self.cells_of(area), *eighths)).collect();
        self.tolls(|cell| {
            let last = areas.iter().rev().find(|(cells, _)| cells.get(cell));
            last.map_or(LEAST, |&(_, eighths)| eighths)
        })
    }

    /// The factors of a cost map, which must have the grid's cells.
    fn of_cells(&self, costs: &CostMap) -> Result<Tolls, Problem> {
        let (factors, grid) = (&costs.factors, self.grid);
        if (factors.columns, factors.rows) == (grid.columns, grid.rows) {
            let index = |cell: Cell| (cell.row * grid.columns + cell.column) as usize;
            return Ok(self.tolls(|cell| factors.eighths[index(cell)].into()));
        }
        let message = format!("{} does not have the cells of the plan", costs.path.display());
        let label = format!("{} columns and {} rows", factors.columns, factors.rows);
        let help = format!("the plan has {} columns and {} rows", grid.columns, grid.rows);
        let place = &costs.place;
        Err(Problem::error(message).at(&place.source, place.span.clone(), label).help(help))
    }

    /// The factors of bands around obstacles; where they overlap, the highest.
    fn bands(&self, rule: &LayerRule) -> Tolls {
        let bands = rule.tolls.clearance.iter();
        let bands: Vec<(Bitmap, u32)> =
            bands.map(|band| (self.within(band.within_m), band.eighths)).collect();
        self.tolls(|cell| {
            let all = bands.iter().filter(|(cells, _)| cells.get(cell));
            all.map(|&(_, eighths)| eighths).max().unwrap_or(LEAST)
        })
    }

    /// The cells that an area touches. Closed lines are areas.
    fn cells_of(&self, area: &Named) -> Bitmap {
        let is_it = |feature: &Feature| feature.name == area.name;
        let options = RasterOptions { robot_radius_m: 0.0, fill_walls: true };
        rasterise(self.input.map, self.grid, &is_it, &options)
    }

    /// The cells in which the body is this close to an obstacle: as if the robot were larger.
    fn within(&self, within_m: f64) -> Bitmap {
        let robot_radius_m = self.options.robot_radius_m + within_m;
        let options = RasterOptions { robot_radius_m, ..self.options };
        let adds = |feature: &Feature| self.added.iter().any(|added| added.adds(feature));
        let mut cells = rasterise(self.input.map, self.grid, &adds, &options);
        for mask in self.added.iter().flat_map(|added| &added.masks) {
            keep_out(&mask.cells, self.grid, robot_radius_m, &mut cells);
        }
        cells
    }

    /// The factor of a speed zone, eighths: by default how much longer the robot takes at the limit
    /// than at its top speed.
    fn factor(&self, zone: &SpeedZone) -> u32 {
        zone.eighths.unwrap_or_else(|| {
            let fastest = f64::from(self.input.mission.parameters.vehicle.max_speed_mps);
            let slower = (fastest / zone.limit_mps).clamp(1.0, f64::from(MOST / LEAST));
            (slower * f64::from(LEAST) + 0.5) as u32
        })
    }
}
