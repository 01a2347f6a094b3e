//! Compiles a map and its mission into a scenario.

use std::path::Path;

use maps::Map;
use maps::problem::{self, Problem, Severity, Source, has_errors};
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::{Goal, parse};
use plan_compiler::mutual_waits;
use plan_compiler::output;
use plan_compiler::project::{self, Request};
use plan_format::parameters::{Blend, Gains};
use sim::scenario::place_on_globe;
use sim::{Conditions, Difference, Scenario, WorldFile, Worlds};

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
    /// The robot of the mission's team; it runs alone.
    pub robot: Option<String>,
    /// The parallel plan to follow.
    pub plan: Option<String>,
    /// The gains.
    pub gains: Option<Gains>,
    /// Goals that replace those of mission and map, unless empty.
    pub goals: Vec<Goal>,
    /// Seed that chooses the obstacles which a world file leaves out by shares.
    pub seed: u64,
}

/// Compiles a map with the mission file beside it, or a mission file that names its map.
/// A map without a place on the globe gets one, with a note. The error lists all problems, as
/// `plan-compiler build` does; without an error the warnings go to standard error.
pub fn scenario(path: &Path, changes: &Changes) -> Result<Scenario, String> {
    scenario_for(path, changes, &[])
}

/// As [`scenario`]; also refuses files to write that cannot be written, or that would replace a file
/// that was read.
pub fn scenario_for(path: &Path, changes: &Changes, outputs: &[&Path]) -> Result<Scenario, String> {
    let mut problems = Vec::new();
    let scenario = read_and_compile(path, changes, outputs, &mut problems);
    let Some(scenario) = scenario.filter(|_| !has_errors(&problems)) else {
        return Err(problem::draw(&problems, false));
    };
    problems.retain(|problem| problem.severity == Severity::Warning);
    eprint!("{}", problem::draw(&problems, false));
    Ok(scenario)
}

/// Compiles a map in memory into a scenario. `mission` is the text of a mission file without a map,
/// and may be empty. The world differs from the map as `difference` says; `seed` chooses the
/// obstacles that its shares leave out. A map without a place on the globe gets one, with a note.
pub fn of_map(
    map: &Map,
    mission: &str,
    difference: &Difference,
    seed: u64,
) -> Result<Scenario, String> {
    let source = Source { name: "the mission".to_owned(), text: mission.to_owned() };
    let (mission, mut problems) = parse(&source.into());
    let mut worlds = difference.apply(map, seed);
    let note = place_on_globe(&mut worlds.known);
    let options = Options::default();
    let input = Input { map: &worlds.known, source: None, mission: &mission, options: &options };
    let blob = compile(&input, &|_, _| (), &mut problems).filter(|_| !has_errors(&problems));
    let blob = blob.ok_or_else(|| problem::draw(&problems, false))?;
    let mut scenario = Scenario::new(worlds.known.clone(), blob, None).in_world(worlds);
    scenario.notes.extend(note);
    Ok(scenario)
}

fn read_and_compile(
    path: &Path,
    changes: &Changes,
    outputs: &[&Path],
    problems: &mut Vec<Problem>,
) -> Option<Scenario> {
    let Changes { goals, plan, robot, .. } = changes.clone();
    let options = Options { goals, plan, robot, ..Options::default() };
    let request = Request { path: path.into(), options, ..Request::default() };
    let mut project = project::load(request, problems)?;
    // A world beside the mission has precedence, for a map may have several missions.
    let mut world = WorldFile::beside(path, problems);
    if world.is_none() && !has_errors(problems) {
        world = WorldFile::beside(&project.inputs[0], problems);
    }
    let mut inputs = project.inputs.clone();
    inputs.extend(world.iter().flat_map(|world| world.files.iter().cloned()));
    for output in outputs {
        problems.extend(output::check_against(output, &inputs));
    }
    // The plans know the map as the world file leaves it.
    let worlds = world.as_ref().filter(|world| !world.difference.is_none()).map(|world| {
        world.check(&project.map, problems);
        world.difference.apply(&project.map, changes.seed)
    });
    if let Some(worlds) = &worlds {
        project.map = worlds.known.clone();
    }
    let mission = &mut project.mission;
    if let Some(gains) = changes.gains {
        // As in a mission file: a mix of the paper goes with the paper's blend.
        (mission.parameters.gains, mission.parameters.blend) = (gains, Blend::Paper);
    }
    if let Some(source) = &mission.behaviours.source {
        problems.extend(mutual_waits::check(source, &mission.team));
    }
    let note = place_on_globe(&mut project.map);
    let blob = compile(&project.input(), &|_, _| (), problems)?;
    let (surroundings, conditions) = match world {
        Some(world) => (Some(world.surroundings), world.conditions),
        None => (None, Conditions::default()),
    };
    let map = project.map.clone();
    let mut scenario = Scenario::new(project.map, blob, surroundings).under(conditions);
    if let Some(worlds) = worlds {
        scenario = scenario.in_world(Worlds { known: map, ..worlds });
    }
    scenario.notes.extend(note);
    Some(scenario)
}
