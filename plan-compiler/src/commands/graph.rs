//! `graph`: behaviours and their plans as graphs.

use super::{Failure, open, read_blob, refuse_output, tell};
use crate::cli::Graph;
use maps::problem::{Problem, has_errors};
use maps::source;
use plan_compiler::behaviours::draw::{Drawn, dot, picture};
use plan_compiler::behaviours::{self, Plans};
use plan_compiler::render::png;
use plan_compiler::{mission, output};
use plan_format::mission::Mission;
use std::path::Path;

pub(super) fn run(args: &Graph, quiet: bool) -> Result<(), Failure> {
    let extension = args.output.extension().and_then(|extension| extension.to_str());
    let draw: fn(&Drawn<'_>) -> Result<Vec<u8>, String> =
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("dot" | "gv") => |drawn| Ok(dot(drawn).into_bytes()),
            Some("svg") => |drawn| Ok(picture(drawn).into_bytes()),
            Some("png") => |drawn| png(&picture(drawn)),
            _ => {
                let message = "the output's name must end in .dot, .svg or .png";
                return Err(Failure::Usage(message.into()));
            }
        };
    refuse_output(&args.output, &[&args.input])?;
    let is_mission = args.input.extension().is_some_and(|extension| extension == "toml");
    let bytes = if is_mission {
        let section = of_mission(&args.input, args.robot.as_deref(), quiet)?;
        let mission = Mission::parse(&section)
            .map_err(|error| Problem::error(format!("the mission cannot be run: {error}")))?;
        drawn(args, &Drawn { mission, plans: &[] }, draw)?
    } else {
        let blob = read_blob(&args.input)?;
        let plan = open(&args.input, &blob)?;
        let plans: Vec<String> = plan.parallel_plans().map(|plan| plan.name().to_owned()).collect();
        drawn(args, &Drawn { mission: plan.mission(), plans: &plans }, draw)?
    };
    Ok(output::write_file(&args.output, |out| out.write_all(&bytes))?)
}

fn drawn(
    args: &Graph,
    drawn: &Drawn<'_>,
    draw: fn(&Drawn<'_>) -> Result<Vec<u8>, String>,
) -> Result<Vec<u8>, Failure> {
    if drawn.mission.plan_frames().is_empty() {
        let message = format!("{} has no behaviours", args.input.display());
        let help = "define behaviours in a mission file, as BEHAVIOURS.md describes";
        return Err(Problem::error(message).help(help).into());
    }
    draw(drawn).map_err(|reason| {
        Problem::error(format!("cannot draw {}: {reason}", args.output.display())).into()
    })
}

/// The mission section as a build writes it, but without the map: every plan that the mission names
/// is assumed to exist.
fn of_mission(path: &Path, robot: Option<&str>, quiet: bool) -> Result<Vec<u8>, Failure> {
    let (text, mut problems) = source::read_text(path)?;
    let (mission, mistakes) = mission::parse_for(&text, robot);
    problems.extend(mistakes);
    let draft = behaviours::compile(&mission.behaviours, &Plans::Any, &mut problems);
    let section = match draft {
        Some(draft) if !has_errors(&problems) => draft.write(),
        _ => return Err(Failure::Wrong(problems)),
    };
    tell(&problems, quiet);
    section.map_err(|error| Problem::error(format!("the mission cannot be run: {error}")).into())
}
