//! A map and its mission, compiled into a scenario.

use std::path::Path;

use maps::problem::has_errors;
use maps::problem::{self, Place, Problem, Source};
use plan_compiler::compile::compile;
use plan_compiler::input::Options;
use plan_compiler::mission::{Goal, Named};
use plan_compiler::project::{self, Request};
use plan_format::parameters::Gains;
use sim::{Scenario, Surroundings};

/// The mixes of the paper by their names in a mission file (W, section 4).
pub const PRESETS: [(&str, Gains); 4] = [
    ("100:0", Gains::REACTIVE_ONLY),
    ("66:34", Gains::MOSTLY_REACTIVE),
    ("34:66", Gains::MOSTLY_PLAN),
    ("0:100", Gains::PLAN_ONLY),
];

/// What is to be different from the mission file.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// The parallel plan to follow.
    pub plan: Option<String>,
    /// The gains.
    pub gains: Option<Gains>,
    /// Goals instead of those of mission and map.
    pub goals: Vec<Goal>,
}

/// Compiles a map, with the mission file beside it, or a mission file that names its map.
/// The error lists everything that is wrong, as `plan-compiler build` does.
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
    let options = Options { goals: changes.goals.clone(), ..Options::default() };
    let request = Request { path: path.into(), options, ..Request::default() };
    let mut project = project::load(request, problems)?;
    // Beside the mission, which may be one of several of its map; otherwise beside the map.
    let mut surroundings = Surroundings::beside(path, problems);
    if surroundings.is_none() && !has_errors(problems) {
        surroundings = Surroundings::beside(&project.inputs[0], problems);
    }
    let mission = &mut project.mission;
    if let Some(name) = &changes.plan {
        mission.plan = Some(asked_for(name));
    }
    mission.parameters.gains = changes.gains.unwrap_or(mission.parameters.gains);
    let blob = compile(&project.input(), &|_, _| (), problems)?;
    Some(Scenario::new(project.map, blob, surroundings))
}

/// A name that stands in no file.
fn asked_for(name: &str) -> Named {
    let source = Source { name: "--plan".to_owned(), text: name.to_owned() };
    let place = Place { source: source.into(), span: 0..name.len(), label: "asked for".to_owned() };
    Named { name: name.to_owned(), place }
}
