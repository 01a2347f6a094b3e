//! The world file: `yard.world.toml` beside `yard.ovl` or `yard.mission.toml`.
//!
//! It describes the simulated world beyond the map: the start, the work, how the truth differs from
//! the map, and the conditions. `plan-compiler/WORLD.md` documents it. Reading reports every
//! mistake with its place and how to fix it.

mod conditions;
mod reader;
mod truth;
mod work;

use crate::{Conditions, Difference, Missing, Surroundings};
use maps::Map;
use maps::names::nearest;
use maps::problem::{self, Place, Problem, Source, has_errors};
use maps::source;
use reader::{Reader, Section};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml_edit::Document;

/// The keys of a world.
const KEYS: [&str; 22] = [
    "start",
    "heading",
    "time_limit",
    "gps_sigma",
    "signal",
    "tanks",
    "fields",
    "truth",
    "extra",
    "missing",
    "unmapped",
    "removed",
    "shift",
    "turn",
    "scale",
    "discs",
    "gps",
    "compass",
    "ranges",
    "pose",
    "wheels",
    "body",
];

/// The contents of a world file.
#[derive(Clone, Debug)]
pub struct WorldFile {
    /// The start, and what the robot's work changes.
    pub surroundings: Surroundings,
    /// How the true world differs from the map.
    pub difference: Difference,
    /// Sensors, body, moving discs and faults.
    pub conditions: Conditions,
    /// The files that were read: the world file, and those of the map of the truth.
    pub files: Vec<PathBuf>,
    /// Where the file names each of the missing obstacles.
    missing_at: Vec<Place>,
}

impl WorldFile {
    /// Reads the world file beside a map or a mission; `None` if there is none or it has a mistake.
    /// All its mistakes are added to `problems`.
    pub fn beside(path: &Path, problems: &mut Vec<Problem>) -> Option<Self> {
        let path = path_beside(path);
        if !path.exists() {
            return None;
        }
        match source::read_text(&path) {
            Ok((text, found)) => {
                problems.extend(found);
                let folder = path.parent().unwrap_or(Path::new(""));
                let mut world = parse(&text, Some(folder), problems)?;
                world.files.push(path);
                Some(world)
            }
            Err(problem) => {
                problems.push(problem);
                None
            }
        }
    }

    /// Reports the missing obstacles that are not among the obstacles of the map or the truth.
    pub fn check(&self, map: &Map, problems: &mut Vec<Problem>) {
        let base = self.difference.truth.as_deref().unwrap_or(map);
        for (missing, place) in self.difference.missing.iter().zip(&self.missing_at) {
            if missing.is_in(base) {
                continue;
            }
            let names = base.features.iter().map(|feature| feature.name.as_str());
            let (message, help) = match missing {
                Missing::Named(name) => (
                    format!("no obstacle is called `{name}`"),
                    match nearest(name, names.filter(|name| !name.is_empty())) {
                        Some(meant) => format!("did you mean `{meant}`?"),
                        None => "name one of the map's obstacles, or write at = [X, Y] and within \
                                 = 1"
                        .to_owned(),
                    },
                ),
                Missing::Near { at: [x, y], within_m } => (
                    format!("no obstacle is within {within_m} m of ({x}, {y})"),
                    "give a point of the obstacle in the map's metres, or a larger `within`"
                        .to_owned(),
                ),
            };
            let Place { source, span, .. } = place;
            let problem = Problem::error(message).at(source, span.clone(), "not on the map");
            problems.push(problem.help(help));
        }
    }
}

impl std::str::FromStr for WorldFile {
    type Err = String;

    /// Reads the text of a world file. The map that `truth` names is not read, as a text lies in no
    /// folder.
    fn from_str(text: &str) -> Result<Self, String> {
        let source = Source { name: "the world".to_owned(), text: text.to_owned() };
        let mut problems = Vec::new();
        let read = parse(&source.into(), None, &mut problems);
        read.ok_or_else(|| problem::draw(&problems, false))
    }
}

/// The path of the world file beside a map or a mission.
fn path_beside(path: &Path) -> PathBuf {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    match name.strip_suffix(".mission.toml") {
        Some(plain) => path.with_file_name(format!("{plain}.world.toml")),
        None => path.with_extension("world.toml"),
    }
}

/// The world in a text in a folder; `None` if it has a mistake. All mistakes are added to
/// `problems`.
fn parse(
    source: &Arc<Source>,
    folder: Option<&Path>,
    problems: &mut Vec<Problem>,
) -> Option<WorldFile> {
    let mut reader = Reader { source, problems: Vec::new() };
    let mut of_truth = Vec::new();
    let world = match Document::parse(source.text.as_str()) {
        Ok(document) => {
            let top = Section { table: document.as_table(), path: "", at: &(0..0) };
            reader.unknown_keys(&top, &[&KEYS[..], &["faults"]].concat());
            reader.world(&top, folder, &mut of_truth)
        }
        Err(error) => {
            let help = "each line is `key = value`, `[section]` or `# comment`";
            reader.error("this is not TOML", error.span().unwrap_or(0..0), error.message(), help);
            None
        }
    };
    let world = world.filter(|_| !has_errors(&reader.problems));
    reader.problems.sort_by_key(|problem| problem.place.as_ref().map(|place| place.span.start));
    problems.append(&mut reader.problems);
    problems.append(&mut of_truth);
    world
}

impl Reader<'_> {
    fn world(
        &mut self,
        top: &Section<'_>,
        folder: Option<&Path>,
        of_truth: &mut Vec<Problem>,
    ) -> Option<WorldFile> {
        let surroundings = self.surroundings(top);
        let about = surroundings.as_ref().map(|surroundings| surroundings.start);
        let conditions = self.conditions(top);
        let (difference, missing_at) =
            self.difference(top, about.unwrap_or_default(), folder, of_truth);
        let truth = top.get("truth").and_then(|(item, _)| item.as_str());
        let mut files: Vec<PathBuf> =
            folder.zip(truth).map(|(folder, name)| folder.join(name)).into_iter().collect();
        files.extend(difference.truth.iter().flat_map(|map| map.files.iter().cloned()));
        Some(WorldFile { surroundings: surroundings?, difference, conditions, files, missing_at })
    }
}

impl std::str::FromStr for Surroundings {
    type Err = String;

    /// Reads the text of a world file and keeps the part that the robot's work changes.
    fn from_str(text: &str) -> Result<Self, String> {
        text.parse::<WorldFile>().map(|file| file.surroundings)
    }
}

#[cfg(test)]
mod tests;
