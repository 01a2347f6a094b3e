//! A project as its files hold it: a map, and the mission that lies beside it or names it.
//!
//! The one loader, for the command line, the simulator's commands and any other program. Paths
//! go in; a [`Project`] comes out, or every mistake in its files.

use crate::input::{Input, Options};
use crate::mission::{self, CostSource, Mission};
use crate::recipe::Recipe;
use maps::formats::{self, Loaded};
use maps::problem::{Problem, Source, has_errors};
use maps::{Map, source};
use std::iter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What to load.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// A map, or a mission file that names its map.
    pub path: PathBuf,
    /// The bytes of the file at `path`, if they have been read: a pipe cannot be read twice.
    pub bytes: Option<Vec<u8>>,
    /// The mission file of a map; otherwise `MAP.mission.toml` beside the map, if there is one. Not
    /// used where `path` is a mission.
    pub mission: Option<PathBuf>,
    /// What outranks the mission.
    pub options: Options,
    /// How the blob to be compared with was built: the default for what neither the options nor a
    /// mission that was asked for set.
    pub recipe: Option<Recipe>,
}

/// Everything that was loaded.
#[derive(Clone, Debug)]
pub struct Project {
    /// The files that were read: an output must not replace them. The map is the first.
    pub inputs: Vec<PathBuf>,
    /// The map.
    pub map: Map,
    /// The map's text, for excerpts; binary maps have none.
    pub source: Option<Arc<Source>>,
    /// The mission; the default one where there is no file.
    pub mission: Mission,
    /// The options, completed by mission and recipe.
    pub options: Options,
}

impl Project {
    /// What the compiler takes.
    pub fn input(&self) -> Input<'_> {
        Input {
            map: &self.map,
            source: self.source.as_ref(),
            mission: &self.mission,
            options: &self.options,
        }
    }
}

/// Whether a path names a mission file.
pub fn is_mission(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "toml")
}

/// Loads a project; `None` where its map cannot be relied on. Mistakes in the mission are among the
/// problems, and the rest is loaded as far as it was understood.
pub fn load(request: Request, problems: &mut Vec<Problem>) -> Option<Project> {
    let Request { path, mut bytes, mission: given, mut options, recipe } = request;
    let is_mission = is_mission(&path);
    let is_asked = is_mission || given.is_some();
    let mission_path = if is_mission {
        Some(path.clone())
    } else {
        given.or_else(|| Some(path.with_extension("mission.toml")).filter(|path| path.is_file()))
    };
    let mission_bytes = if is_mission { bytes.take() } else { None };
    if options.robot.is_none() {
        options.robot = recipe.as_ref().and_then(|recipe| recipe.robot.clone());
    }
    let robot = options.robot.as_deref();
    let mission =
        mission_path.as_deref().map(|path| read_mission(path, mission_bytes, robot, problems));
    let mut mission = match mission {
        Some(None) if is_mission => return None,
        mission => mission.flatten().unwrap_or_else(Mission::of_no_file),
    };
    if let Some(recipe) = recipe {
        recipe.complete(&mut options, &mut mission, is_asked);
    }
    let map_path = match (&mission.map, is_mission) {
        (Some(map), true) => map.clone(),
        // A text that is not TOML may name its map.
        (None, true) if mission.given.is_none() => return None,
        (None, true) => {
            problems.push(
                Problem::error(format!("{} does not name its map", path.display()))
                    .help("add a line map = \"NAME.opar\" at the top, or build the map instead"),
            );
            return None;
        }
        (_, false) => path,
    };
    options.reading = mission.reading(options.reading);
    let Loaded { map, source, problems: found } = match bytes {
        Some(bytes) => formats::load_bytes(&map_path, bytes, &options.reading),
        None => formats::load(&map_path, &options.reading),
    };
    let is_incomplete = has_errors(&found);
    let named_at = mission.map_place.as_ref().filter(|_| is_mission);
    problems.extend(found.into_iter().map(|mut problem| match (&problem.place, named_at) {
        (None, Some(at)) => {
            let help = problem.help.take();
            problem.help = help.map(|help| help.replace("the current folder", "the mission file"));
            problem.at(&at.source, at.span.clone(), "named here")
        }
        _ => problem,
    }));
    let map = map.filter(|_| !is_incomplete)?;
    let named = source.as_ref().and_then(|text| formats::pcf::map_path(&map_path, &text.text));
    let others = named.into_iter().chain(map.files.iter().cloned()).chain(mission_path);
    let inputs = iter::once(map_path).chain(others).chain(files(&mission)).collect();
    Some(Project { inputs, map, source, mission, options })
}

/// The files that a mission names, besides its map.
fn files(mission: &Mission) -> impl Iterator<Item = PathBuf> {
    let masks = mission.masks.iter().flat_map(|mask| iter::once(&mask.path).chain(&mask.files));
    let speeds = mission.speed_masks.iter().flat_map(|mask| [&mask.path, &mask.shades.image]);
    let costs = mission.layers.iter().filter_map(|rule| rule.tolls.costs.as_ref());
    let costs = costs.flat_map(|costs| {
        let image = match &costs.factors {
            CostSource::Image(image) => Some(&image.shades.image),
            CostSource::Array(_) => None,
        };
        iter::once(&costs.path).chain(image)
    });
    masks.chain(speeds).chain(costs).cloned()
}

fn read_mission(
    path: &Path,
    bytes: Option<Vec<u8>>,
    robot: Option<&str>,
    problems: &mut Vec<Problem>,
) -> Option<Mission> {
    let text = match bytes {
        Some(bytes) => source::decode(path, bytes),
        None => source::read_text(path),
    };
    match text {
        Ok((text, found)) => {
            let (mission, mistakes) = mission::parse_for(&text, robot);
            problems.extend(found.into_iter().chain(mistakes));
            Some(mission)
        }
        Err(problem) => {
            problems.push(problem);
            None
        }
    }
}
