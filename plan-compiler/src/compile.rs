//! Map and mission in, blob out.
//!
//! Decides what the blob contains: the grid, the layers and their obstacles, the goals, and the
//! plan that the robot follows. Layers nest by construction (see [`crate::layers`]).
//!
//! A goal that a person named must be reachable: otherwise it is an error. A goal that only the map
//! names is left out with a warning. Nothing is allocated before all numbers are known to be within
//! [`plan_format::limits`].
//!
//! Deliberately absent: files and the command line.

mod added;
mod area;
mod candidate;
mod globe;
mod goals;
mod members;
mod memory;
mod nearest_free;
mod obstacles;
mod radio;
mod speed_limits;
mod tolls;
mod warnings;

pub use memory::{Need, gib};

use crate::behaviours::{self, PlanNames, Plans};
use crate::input::Input;
use crate::layers::{Layer, Stack};
use crate::mission::{RadioRule, brakes, follow, layer_gains};
use crate::pack::{pack_with_limits, with_goals};
use crate::recipe;
use crate::search::{Corners, MAX_COST, Query, Solver, is_cut_short};
use crate::tolls::Tolls;
use crate::width::{self, LayerPassages};
use candidate::PlacedLayer;
use goals::Placed;
use maps::numbers::metres;
use maps::problem::has_errors;
use maps::radio::Model;
use maps::{Bitmap, Point, Problem};
use math::MapFrame;
use memory::Levels;
use plan_format::grid::cost_metres;
use plan_format::mission::MissionDraft;
use plan_format::parameters::Vehicle;
use plan_format::{
    Cell, Draft, Grid, LayerDraft, Origin, Parameters, PlanDraft, WriteError, limits,
    write_with_recipe,
};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Progress steps of one layer: the search and the packing.
pub const STEPS_A_LAYER: usize = 2;

/// Reports progress as (steps done, steps in all), from any thread. A layer takes
/// [`STEPS_A_LAYER`] steps.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Problems beyond this number come without a suggestion, which takes time to find.
const MAX_SUGGESTIONS: usize = 300;

/// More packed bytes than this cannot fit a blob, even if equal layers are stored once.
const PACKED_BUDGET_BYTES: usize = 16 * limits::MAX_BLOB_BYTES;

/// Compiles the input to a blob. Adds every problem it finds to `problems`; returns `None` if any of
/// them is an error. Nothing is searched after an error.
pub fn compile(
    input: &Input<'_>,
    progress: Progress<'_>,
    problems: &mut Vec<Problem>,
) -> Option<Vec<u8>> {
    prepare(input, problems)?.finish(progress, problems)
}

/// The grid of a map under a mission; `None` after an error.
pub fn grid(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<Grid> {
    area::grid(input, problems)
}

/// How far obstacles are grown, metres; `None` after an error.
pub fn robot_radius(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<f64> {
    area::robot_radius(input, problems)
}

/// How far the map extends, for help.
pub fn reach(grid: &Grid) -> String {
    area::reach(grid)
}

/// Where the map lies on the globe, as a blob carries it.
pub fn origin(input: &Input<'_>) -> Option<Origin> {
    area::origin(input, &mut Vec::new())
}

/// The transform between the map's metres and the globe; `None` if the map has no place there.
pub fn map_frame(input: &Input<'_>) -> Option<MapFrame> {
    globe::frame(input)
}

/// The layers of a map under a mission, for proofs; `None` after an error.
pub fn layers(input: &Input<'_>, grid: &Grid, problems: &mut Vec<Problem>) -> Option<Stack> {
    let radius = area::robot_radius(input, problems)?;
    added::stack(input, grid, radius, problems)
}

/// The positions of places to reach by radio, each with its name. Reports places that are not known,
/// and warns about those without a useful position.
pub fn places(
    input: &Input<'_>,
    rule: &RadioRule,
    model: &Model,
    grid: &Grid,
    problems: &mut Vec<Problem>,
) -> Vec<(String, Point)> {
    radio::places(input, rule, model, grid, problems)
}

/// A build after all decisions and before any search.
pub struct Prepared {
    grid: Grid,
    origin: Option<Origin>,
    parameters: Parameters,
    /// How far the obstacles were grown, metres.
    grown_m: f64,
    corners: Corners,
    stack: Stack,
    goals: Vec<Placed>,
    mission: MissionDraft,
    recipe: String,
    need: Need,
}

/// The short first half of [`compile`]: all decisions. Returns `None` if there is an error among the
/// problems.
pub fn prepare(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<Prepared> {
    let prepared = decide(input, problems);
    prepared.filter(|_| !has_errors(problems))
}

fn decide(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<Prepared> {
    let radius = area::robot_radius(input, problems);
    let grid = area::grid(input, problems);
    goals::check_names(input, problems);
    let (grid, radius) = (grid?, radius?);
    problems.extend(too_narrow(input, radius));
    let origin = area::origin(input, problems);
    let limit_bytes = input.options.max_memory_bytes.unwrap_or(memory::DEFAULT_LIMIT_BYTES);
    let have_tolls = has_tolls(input);
    let at_first = match have_tolls {
        // Tolls take much more than other layers, so only those that there are count.
        true => Levels { count: input.mission.layers.len() + 2, have_tolls },
        false => Levels { count: limits::MAX_LAYERS, have_tolls },
    };
    if let Some(problem) = memory::check(limit_bytes, &grid, at_first) {
        problems.push(problem);
        return None;
    }
    let stack = added::stack(input, &grid, radius, problems)?;
    let layers = stack.layers();
    let physical = &layers.first()?.terrain.blocked;
    if physical.count() == grid.cells() {
        problems.push(no_free_cell(&grid, radius));
        return None;
    }
    problems.extend(warnings::of_cells(input, &grid));
    problems.extend(warnings::of_tolerance(input, &grid));
    problems.extend(warnings::nearly_blocked(input, &grid, radius, physical));
    problems.extend(warnings::of_places(input, &grid, physical));
    let names: Vec<&str> = layers.iter().map(|layer| layer.name.as_str()).collect();
    let selection = layer_gains::selection(input.mission, &names, problems);
    let goals = goals::place(input, &grid, layers, problems);
    let plan = goals::followed(input, &goals, problems);
    let mut parameters =
        Parameters { plan, selection, vehicle: vehicle(input, radius), ..input.mission.parameters };
    if let Some(given) = &input.mission.given {
        // Once more: an option may have changed the radius.
        follow::complete(&mut parameters, given);
        problems.extend(brakes::check(&parameters, given));
    }
    let corners = input.options.corners.or(input.mission.corners).unwrap_or(Corners::Forbid);
    let plans = plan_names(&goals, layers);
    let mission = behaviours::compile(&input.mission.behaviours, &plans, problems)?;
    let jobs = goals.iter().map(|goal| goal.layers.len()).sum();
    let levels = Levels { count: layers.len(), have_tolls };
    let threads = thread::available_parallelism().map_or(1, |threads| threads.get());
    let need = Need::within(limit_bytes, &grid, levels, jobs, threads)?;
    let recipe = recipe::write(input, radius, &radio::known_places(input));
    Some(Prepared {
        grid,
        origin,
        parameters,
        grown_m: radius,
        corners,
        stack,
        goals,
        mission,
        recipe,
        need,
    })
}

/// Whether any layer has tolls or speed limits.
fn has_tolls(input: &Input<'_>) -> bool {
    let mut rules = input.mission.layers.iter();
    !input.mission.speed_masks.is_empty() || rules.any(|rule| !rule.tolls.is_empty())
}

/// What behaviours may refer to by name.
fn plan_names(goals: &[Placed], all: &[Layer]) -> Plans {
    let layers = |goal: &Placed| {
        let own = goal.layers.iter().filter_map(|own| all.get(usize::from(own.rank)));
        own.map(|layer| layer.name.clone()).collect()
    };
    let plans =
        goals.iter().map(|goal| PlanNames { name: goal.name.clone(), layers: layers(goal) });
    Plans::Known(plans.collect())
}

/// The mission's vehicle. Its body has the radius that obstacles are grown by, unless the mission
/// sets `vehicle.radius`.
fn vehicle(input: &Input<'_>, radius: f64) -> Vehicle {
    let vehicle = input.mission.parameters.vehicle;
    let grown = radius > 0.0 && !input.mission.body_radius_given;
    Vehicle { radius_m: if grown { radius as f32 } else { vehicle.radius_m }, ..vehicle }
}

/// Warns if the body is wider than the obstacles are grown: it would scrape along them.
fn too_narrow(input: &Input<'_>, radius: f64) -> Option<Problem> {
    let body = input.mission.parameters.vehicle.radius_m;
    // Single precision loses at most half a millimetre.
    if !input.mission.body_radius_given || f64::from(body) <= radius + 5e-4 {
        return None;
    }
    let radius = metres(radius);
    let message = format!(
        "obstacles are grown by {radius} m, less than the vehicle's radius of {body} m: the robot \
         is advised to go where it does not fit"
    );
    let help = "leave robot_radius out, or make it at least vehicle.radius";
    Some(Problem::warning(message).help(help))
}

fn no_free_cell(grid: &Grid, radius: f64) -> Problem {
    let (columns, rows, side) = (grid.columns, grid.rows, metres(grid.resolution_m));
    let problem = Problem::error(format!(
        "the map has no free cell: obstacles touch all {columns} x {rows} cells of {side} m"
    ));
    problem.help(if radius > 0.0 {
        "make the robot's radius smaller, or the cells: --resolution"
    } else {
        "make the cells smaller with --resolution, or check the area and the units of the map"
    })
}

/// What one search has to find: a layer of a plan.
type Job<'a> = (&'a Placed, &'a PlacedLayer, &'a Layer);

impl Prepared {
    /// The memory that the second half needs.
    pub fn need(&self) -> Need {
        self.need
    }

    /// The long second half of [`compile`]: searches, packs and writes.
    pub fn finish(&self, progress: Progress<'_>, problems: &mut Vec<Problem>) -> Option<Vec<u8>> {
        let plans = self.search(progress, problems).or_else(|| {
            problems.push(too_large(None));
            None
        })?;
        let draft = Draft {
            grid: self.grid,
            origin: self.origin,
            parameters: self.parameters,
            plans,
            mission: self.mission.clone(),
        };
        match write_with_recipe(&draft, &self.recipe) {
            Ok(blob) => Some(blob),
            Err(WriteError::TooLarge { bytes }) => {
                problems.push(too_large(Some(bytes)));
                None
            }
            Err(other) => {
                problems.push(Problem::error(other.to_string()));
                None
            }
        }
    }

    /// Every plan with its packed layers; `None` if they exceed what any blob can hold.
    fn search<'p>(
        &'p self,
        progress: Progress<'_>,
        problems: &mut Vec<Problem>,
    ) -> Option<Vec<PlanDraft>> {
        let layers = self.stack.layers();
        let of_goal = |goal: &'p Placed| {
            goal.layers.iter().map(move |own| (goal, own, &layers[usize::from(own.rank)]))
        };
        let jobs: Vec<Job<'p>> = self.goals.iter().flat_map(of_goal).collect();
        let steps = jobs.len() * STEPS_A_LAYER;
        progress(0, steps);
        let (done, bytes) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let need = width::Need::of(&self.parameters);
        let none = Bitmap::default();
        // The first layer is `physical`.
        let solid = layers.first().map_or(&none, |layer| &layer.terrain.blocked);
        let site = width::Site { grid: &self.grid, solid, grown_m: self.grown_m, need };
        let solve = |solver: &mut Solver, &(goal, own, layer): &Job<'_>| {
            if bytes.load(Ordering::Relaxed) > PACKED_BUDGET_BYTES {
                return None;
            }
            let step = || progress(done.fetch_add(1, Ordering::Relaxed) + 1, steps);
            let goals: Vec<Cell> = own.goals.iter().map(|&(_, cell)| cell).collect();
            let query = Query { terrain: &layer.terrain, goals: &goals, corners: self.corners };
            let field = solver.solve(&query);
            step();
            let is_cut_short = is_cut_short(&query, &field);
            let passages = LayerPassages {
                plan: goal.name.clone(),
                layer: layer.name.clone(),
                passages: width::passages(&field, &site),
            };
            let mut packed = pack_with_limits(&field, &layer.limits);
            if goal.at.len() > 1 {
                packed = with_goals(packed, &own.goals)?;
            }
            bytes.fetch_add(packed.bytes(), Ordering::Relaxed);
            step();
            let draft = LayerDraft { name: layer.name.clone(), rank: own.rank, packed };
            Some((draft, is_cut_short, passages))
        };
        let solve_all = || jobs.par_iter().map_init(Solver::new, solve).collect::<Option<Vec<_>>>();
        // A machine may refuse new threads: then use rayon's shared pool.
        let solved = match rayon::ThreadPoolBuilder::new().num_threads(self.need.in_flight).build()
        {
            Ok(pool) => pool.install(solve_all),
            Err(_) => solve_all(),
        };
        let solved = solved?;
        for ((goal, _, layer), (_, is_cut_short, _)) in jobs.iter().zip(&solved) {
            problems.extend(is_cut_short.then(|| too_far(&goal.name, layer, &self.grid)));
        }
        let mut left = solved.as_slice();
        for goal in &self.goals {
            let (own, others) = left.split_at(goal.layers.len().min(left.len()));
            let counts = own.iter().map(|(l, ..)| (l.name.as_str(), l.packed.counts()));
            problems.extend(warnings::few_reach(&goal.name, counts));
            left = others;
        }
        let (solved, passages): (Vec<LayerDraft>, Vec<LayerPassages>) =
            solved.into_iter().map(|(layer, _, passages)| (layer, passages)).unzip();
        problems.extend(width::warnings(&passages, &need));
        let mut solved = solved.into_iter();
        let plans = self.goals.iter().map(|goal| PlanDraft {
            name: goal.name.clone(),
            goals_m: goal.at.clone(),
            layers: solved.by_ref().take(goal.layers.len()).collect(),
        });
        Some(plans.collect())
    }
}

/// Warns that some cells are farther from the goal than the largest representable cost.
fn too_far(plan: &str, layer: &Layer, grid: &Grid) -> Problem {
    let unit = layer.terrain.tolls.as_ref().map_or(0, Tolls::unit);
    let farthest = metres(cost_metres(MAX_COST >> unit, grid.resolution_m).floor());
    let name = &layer.name;
    let far = if layer.terrain.tolls.is_some() { "cost more" } else { "are farther" };
    let problem = Problem::warning(format!(
        "layer `{plan}/{name}` marks cells unreachable that {far} than {farthest} m from the goal, the \
         largest representable cost"
    ));
    problem.help(if unit > 0 {
        "use a coarser --resolution, or whole numbers as toll factors"
    } else {
        "use a coarser --resolution: a route can have about 700,000 cells"
    })
}

fn too_large(bytes: Option<usize>) -> Problem {
    let limit = limits::MAX_BLOB_BYTES;
    let message = match bytes {
        Some(bytes) => format!("the plans take {bytes} bytes, but the format holds {limit}"),
        None => format!("the plans take far more than the {limit} bytes that the format holds"),
    };
    Problem::error(message)
        .help("use a coarser --resolution, a smaller area, or fewer goals and layers")
}
