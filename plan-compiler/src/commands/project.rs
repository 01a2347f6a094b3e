//! The project that a command line asks for.

use crate::cli::{CornersRule, MapOptions};
use crate::commands::Failure;
use maps::problem::Problem;
use plan_compiler::input::Options;
use plan_compiler::mission::Goal;
use plan_compiler::project::{Project, Request, is_mission, load};
use plan_compiler::recipe;
use plan_compiler::search::Corners;
use plan_format::Blob;
use std::path::Path;

/// Loads a map and its mission; `None` where the map cannot be relied on. `bytes` are those of the
/// file at `path` if they have been read: a pipe cannot be read twice.
pub(crate) fn read(
    path: &Path,
    bytes: Option<Vec<u8>>,
    goals: &[Goal],
    args: &MapOptions,
    problems: &mut Vec<Problem>,
) -> Result<Option<Project>, Failure> {
    let options = options(goals, args);
    let request = Request { path: path.into(), bytes, options, ..Request::default() };
    load_with(request, args.mission.as_deref(), problems)
}

/// Loads a map and its mission with these options; `None` where the map cannot be relied on.
pub(crate) fn read_with(
    path: &Path,
    options: Options,
    mission: Option<&Path>,
    problems: &mut Vec<Problem>,
) -> Result<Option<Project>, Failure> {
    let request = Request { path: path.into(), options, ..Request::default() };
    load_with(request, mission, problems)
}

/// Loads the map, or the mission that names it, that a blob is to be compared with: with the options
/// that the blob was built with where the command line gives no others.
pub(crate) fn read_for(
    (bytes, blob): (&[u8], &Blob<'_>),
    path: &Path,
    mut options: Options,
    mission: Option<&Path>,
    problems: &mut Vec<Problem>,
) -> Result<Option<Project>, Failure> {
    let recipe = recipe::of_blob(bytes);
    if let Some(recipe) = &recipe {
        options.reading = recipe.reading(&options.reading);
        options.resolution_m = options.resolution_m.or(Some(blob.grid().resolution_m));
    }
    let request = Request { path: path.into(), options, recipe, ..Request::default() };
    load_with(request, mission, problems)
}

fn load_with(
    request: Request,
    mission: Option<&Path>,
    problems: &mut Vec<Problem>,
) -> Result<Option<Project>, Failure> {
    if is_mission(&request.path) && mission.is_some() {
        return Err(Failure::Usage("a mission is built without --mission".into()));
    }
    Ok(load(Request { mission: mission.map(Path::to_owned), ..request }, problems))
}

/// What the command line says.
pub(crate) fn options(goals: &[Goal], args: &MapOptions) -> Options {
    Options {
        goals: goals.to_vec(),
        plan: None,
        robot: args.robot.clone(),
        resolution_m: args.resolution,
        robot_radius_m: args.robot_radius,
        corners: args.corners.map(|rule| match rule {
            CornersRule::Forbid => Corners::Forbid,
            CornersRule::Allow => Corners::Allow,
        }),
        fill_walls: args.fill_walls,
        reading: args.reading.options(),
        max_memory_bytes: None,
    }
}
