//! The tolls and the speed limits of each layer, from what the mission says about it.

use super::obstacles::Added;
use crate::input::Input;
use crate::layers::Limits;
use crate::mission::{CostMap, CostSource, LayerRule, Named};
use crate::tolls::{LEAST, MOST, Tolls};
use maps::problem::{Place, Problem};
use maps::raster::{RasterOptions, keep_out, rasterise};
use maps::{Bitmap, Feature};
use plan_format::{Cell, Grid};

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
            let factor = zone.eighths.unwrap_or_else(|| slower(self.input, zone.limit_mps));
            cut += tolls.multiply(&self.tolls(|cell| if cells.get(cell) { factor } else { LEAST }));
        }
        problems.extend(too_high(cut, &rule.name.name, &rule.name.place, "this layer"));
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
        let grid = self.grid;
        costs.factors.on(grid).ok_or_else(|| {
            let [columns, rows] = costs.factors.size();
            let message = format!("{} does not have the cells of the plan", costs.path.display());
            let label = format!("{columns} columns and {rows} rows");
            let help = format!("the plan has {} columns and {} rows", grid.columns, grid.rows);
            let help = match costs.factors {
                CostSource::Array(_) => help,
                CostSource::Image(_) => {
                    help + "; name a ROS map, a YAML file with `resolution` and `origin`, to lay the \
                            image over them"
                }
            };
            let place = &costs.place;
            Problem::error(message).at(&place.source, place.span.clone(), label).help(help)
        })
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
}

/// A warning if products of factors were cut in some cells of a layer.
pub(super) fn too_high(cut: usize, layer: &str, place: &Place, label: &str) -> Option<Problem> {
    let most = MOST / LEAST;
    let message = format!(
        "in layer `{layer}`, tolls multiply to more than {most} in {cut} cells, and are cut to it"
    );
    (cut > 0).then(|| {
        Problem::warning(message)
            .at(&place.source, place.span.clone(), label)
            .help("lower the factors, or list what the robot must not enter as `areas`")
    })
}

/// The factor of cells with a speed limit, eighths: how much longer the robot takes at the limit than
/// at its top speed.
pub(super) fn slower(input: &Input<'_>, limit_mps: f64) -> u32 {
    let fastest = f64::from(input.mission.parameters.vehicle.max_speed_mps);
    let slower = (fastest / limit_mps).clamp(1.0, f64::from(MOST / LEAST));
    (slower * f64::from(LEAST) + 0.5) as u32
}
