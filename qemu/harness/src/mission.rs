//! Compiles a map and its mission into a scenario.

use std::path::Path;

use maps::problem::{self, Place, Problem, Source, has_errors};
use plan_compiler::compile::compile;
use plan_compiler::input::Options;
use plan_compiler::mission::{Goal, Named};
use plan_compiler::project::{self, Request};
use plan_format::parameters::Gains;
use sim::scenario::place_on_globe;
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
/// A map without a place on the globe gets one, with a note. The error lists all problems, as
/// `plan-compiler build` does.
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
    // A world beside the mission has precedence, for a map may have several missions.
    let mut surroundings = Surroundings::beside(path, problems);
    if surroundings.is_none() && !has_errors(problems) {
        surroundings = Surroundings::beside(&project.inputs[0], problems);
    }
    let mission = &mut project.mission;
    if let Some(name) = &changes.plan {
        mission.plan = Some(from_command_line(name));
    }
    mission.parameters.gains = changes.gains.unwrap_or(mission.parameters.gains);
    let note = place_on_globe(&mut project.map);
    let blob = compile(&project.input(), &|_, _| (), problems)?;
    let mut scenario = Scenario::new(project.map, blob, surroundings);
    scenario.notes.extend(note);
    Some(scenario)
}

/// A plan's name that the option `--plan` gives.
fn from_command_line(name: &str) -> Named {
    let source = Source { name: "--plan".to_owned(), text: name.to_owned() };
    let place = Place { source: source.into(), span: 0..name.len(), label: "asked for".to_owned() };
    Named { name: name.to_owned(), place }
}
