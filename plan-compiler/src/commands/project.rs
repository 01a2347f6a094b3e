//! The input of a build: a map, and the mission that lies beside it or names it.

use crate::cli::{CornersRule, MapOptions};
use crate::commands::Failure;
use maps::formats::{self, Loaded};
use maps::problem::{Problem, Source};
use maps::source;
use maps::{Feature, Map};
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::{self, Goal, Mission};
use plan_compiler::recipe::{self, Recipe};
use plan_compiler::search::Corners;
use plan_format::Blob;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Everything that was read.
pub(crate) struct Project {
    /// The files that were read: what an output must not replace.
    pub(crate) inputs: Vec<PathBuf>,
    map: Map,
    source: Option<Arc<Source>>,
    mission: Mission,
    options: Options,
}

impl Project {
    /// Lets searches take so much memory.
    pub(crate) fn limit_memory(&mut self, bytes: Option<u64>) {
        self.options.max_memory_bytes = bytes;
    }

    /// The exact shapes of the map.
    pub(crate) fn features(self) -> Vec<Feature> {
        self.map.features
    }

    /// What the compiler takes.
    pub(crate) fn input(&self) -> Input<'_> {
        Input {
            map: &self.map,
            source: self.source.as_ref(),
            mission: &self.mission,
            options: &self.options,
        }
    }
}

/// Reads a map and its mission; `None` where the map cannot be relied on. `bytes` are those of the
/// file at `path` if it has been read already: a pipe can be read no second time.
pub(crate) fn read(
    path: &Path,
    bytes: Option<Vec<u8>>,
    goals: &[Goal],
    args: &MapOptions,
    problems: &mut Vec<Problem>,
) -> Result<Option<Project>, Failure> {
    read_as((path, bytes), options(goals, args), args.mission.as_deref(), None, problems)
}

/// Reads the map, or the mission that names it, which a blob is to be compared with: with the
/// options that it was built with where the command line gives no others.
pub(crate) fn read_for(
    (blob, plan): (&[u8], &Blob<'_>),
    path: &Path,
    mut asked: Options,
    mission: Option<&Path>,
    problems: &mut Vec<Problem>,
) -> Result<Option<Project>, Failure> {
    let recipe = recipe::of_blob(blob);
    if let Some(recipe) = &recipe {
        asked.reading = recipe.reading(&asked.reading);
        asked.resolution_m = asked.resolution_m.or(Some(plan.grid().resolution_m));
    }
    read_as((path, None), asked, mission, recipe, problems)
}

fn read_as(
    (path, mut bytes): (&Path, Option<Vec<u8>>),
    mut options: Options,
    mission_given: Option<&Path>,
    recipe: Option<Recipe>,
    problems: &mut Vec<Problem>,
) -> Result<Option<Project>, Failure> {
    let is_mission = path.extension().is_some_and(|extension| extension == "toml");
    if is_mission && mission_given.is_some() {
        return Err(Failure::Usage("a mission is built without --mission".into()));
    }
    let beside = || Some(path.with_extension("mission.toml")).filter(|path| path.is_file());
    let mission_path = match mission_given {
        _ if is_mission => Some(path.to_owned()),
        Some(given) => Some(given.to_owned()),
        None => beside(),
    };
    let mission_bytes = if is_mission { bytes.take() } else { None };
    let mission = mission_path.as_deref().map(|path| read_mission(path, mission_bytes, problems));
    let mut mission = match mission {
        Some(None) if is_mission => return Ok(None),
        mission => mission.flatten().unwrap_or_default(),
    };
    if let Some(recipe) = recipe {
        let is_asked = is_mission || mission_given.is_some();
        recipe.complete(&mut options, &mut mission, is_asked);
    }
    let map_path = match (&mission.map, is_mission) {
        (Some(map), true) => map.clone(),
        (None, true) => {
            problems.push(
                Problem::error(format!("{} does not name its map", path.display()))
                    .help("add a line map = \"NAME.opar\" at the top, or build the map instead"),
            );
            return Ok(None);
        }
        (_, false) => path.to_owned(),
    };
    options.reading = mission.reading(options.reading);
    let Loaded { map, source, problems: found } = match bytes {
        Some(bytes) => formats::load_bytes(&map_path, bytes, &options.reading),
        None => formats::load(&map_path, &options.reading),
    };
    let incomplete = maps::problem::has_errors(&found);
    let named_at = mission.map_place.as_ref().filter(|_| is_mission);
    problems.extend(found.into_iter().map(|problem| match (&problem.place, named_at) {
        (None, Some(at)) => problem.at(&at.source, at.span.clone(), "named here"),
        _ => problem,
    }));
    let Some(map) = map.filter(|_| !incomplete) else { return Ok(None) };
    let named = source.as_ref().and_then(|text| formats::pcf::map_path(&map_path, &text.text));
    Ok(Some(Project {
        source,
        inputs: {
            let masks = mission.masks.iter().map(|mask| mask.path.clone());
            std::iter::once(map_path).chain(named).chain(mission_path).chain(masks).collect()
        },
        map,
        mission,
        options,
    }))
}

fn read_mission(
    path: &Path,
    bytes: Option<Vec<u8>>,
    problems: &mut Vec<Problem>,
) -> Option<Mission> {
    let text = match bytes {
        Some(bytes) => source::decode(path, bytes),
        None => source::read_text(path),
    };
    match text {
        Ok((text, found)) => {
            let (mission, mistakes) = mission::parse(&text);
            problems.extend(found.into_iter().chain(mistakes));
            Some(mission)
        }
        Err(problem) => {
            problems.push(problem);
            None
        }
    }
}

/// What the command line says.
pub(crate) fn options(goals: &[Goal], args: &MapOptions) -> Options {
    Options {
        goals: goals.to_vec(),
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
