//! Compiles a map and its mission into a scenario.

use std::path::Path;

use maps::formats::{self, ReadOptions};
use maps::problem::has_errors;
use maps::problem::{self, Place, Problem, Source};
use maps::source;
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::{self, Goal, Mission, Named};
use plan_format::parameters::Gains;
use sim::{Scenario, Surroundings};

/// The gains of the paper's mixes by their names in a mission file (W, section 4).
pub const PRESETS: [(&str, Gains); 4] = [
    ("100:0", Gains::REACTIVE_ONLY),
    ("66:34", Gains::MOSTLY_REACTIVE),
    ("34:66", Gains::MOSTLY_PLAN),
    ("0:100", Gains::PLAN_ONLY),
];

/// Changes to the mission file; by default none.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// The parallel plan to follow.
    pub plan: Option<String>,
    /// The gains.
    pub gains: Option<Gains>,
    /// Goals that replace those of mission and map, unless empty.
    pub goals: Vec<Goal>,
}

/// Compiles a map with the mission file beside it, or a mission file that names its map.
/// The error lists all problems, as `plan-compiler build` does.
pub fn scenario(path: &Path, changes: &Changes) -> Result<Scenario, String> {
    let mut problems = Vec::new();
    let scenario = read_and_compile(path, changes, &mut problems);
    let scenario = scenario.filter(|_| !has_errors(&problems));
    scenario.ok_or_else(|| problem::draw(&problems, false))
}

fn read_and_compile(
    path: &Path,
    changes: &Changes,
    problems: &mut Vec<Problem>,
) -> Option<Scenario> {
    let is_mission = path.extension().is_some_and(|extension| extension == "toml");
    let beside = path.with_extension("mission.toml");
    let mut mission = match path {
        path if is_mission => read_mission(path, problems)?,
        _ if beside.exists() => read_mission(&beside, problems).unwrap_or_default(),
        _ => Mission::default(),
    };
    let map_path = match (&mission.map, is_mission) {
        (Some(map), true) => map.clone(),
        (None, true) => {
            let message = format!("{} does not name its map", path.display());
            let help = "add map = \"FILE\" to it, or give the map's file instead";
            problems.push(Problem::error(message).help(help));
            return None;
        }
        (_, false) => path.to_owned(),
    };
    // A world beside the mission has precedence, for a map may have several missions.
    let mut surroundings = Surroundings::beside(path, problems);
    if surroundings.is_none() && is_mission && !has_errors(problems) {
        surroundings = Surroundings::beside(&map_path, problems);
    }
    if let Some(name) = &changes.plan {
        mission.plan = Some(from_command_line(name));
    }
    mission.parameters.gains = changes.gains.unwrap_or(mission.parameters.gains);
    let (map, found) = formats::read(&map_path, &mission.reading(ReadOptions::default()));
    let is_incomplete = has_errors(&found);
    problems.extend(found);
    let map = map.filter(|_| !is_incomplete)?;
    let options = Options { goals: changes.goals.clone(), ..Options::default() };
    let input = Input { map: &map, source: None, mission: &mission, options: &options };
    let blob = compile(&input, &|_, _| (), problems)?;
    Some(Scenario::new(map, blob, surroundings))
}

fn read_mission(path: &Path, problems: &mut Vec<Problem>) -> Option<Mission> {
    let (text, found) = source::read_text(path).map_err(|problem| problems.push(problem)).ok()?;
    let (mission, mistakes) = mission::parse(&text);
    problems.extend(found.into_iter().chain(mistakes));
    if has_errors(problems) { None } else { Some(mission) }
}

/// A plan's name that the option `--plan` gives.
fn from_command_line(name: &str) -> Named {
    let source = Source { name: "--plan".to_owned(), text: name.to_owned() };
    let place = Place { source: source.into(), span: 0..name.len(), label: "asked for".to_owned() };
    Named { name: name.to_owned(), place }
}
